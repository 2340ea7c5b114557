// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/crossing_test.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The 12 coordinates as integers: each times the same power of two.
template <typename Integer>
int orientationOfIntegers(const double* const (&points)[4], int lowest_exponent) {
  Integer x[4][3];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      int exponent = 0;
      const double fraction = std::frexp(points[i][k], &exponent);
      x[i][k] = static_cast<std::int64_t>(std::ldexp(fraction, 53));
      if (fraction != 0) x[i][k] <<= exponent - lowest_exponent;
    }
  Integer d[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[i][k] = x[i == 0 ? 0 : i + 1][k] - x[1][k];
  const Integer volume = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
                         d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
                         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
  return volume.sign();
}

int exactOrientation(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                     const double (&c)[3]) {
  namespace mp = boost::multiprecision;
  const double* const points[4] = {p, a, b, c};
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  for (const double* point : points)
    for (int k = 0; k < 3; ++k) {
      int exponent = 0;
      if (std::frexp(point[k], &exponent) == 0) continue;
      lowest = std::min(lowest, exponent);
      highest = std::max(highest, exponent);
    }
  if (lowest > highest) return 0;
  // Coordinates of 53 + (highest - lowest) bits and a sign; a difference has one bit
  // more, a product of three of them three times as many, the sum of six such three bits
  // more: 3 (53 + 100 + 1) + 3 = 465 < 512.
  if (highest - lowest <= 100)
    return orientationOfIntegers<mp::number<
        mp::cpp_int_backend<512, 512, mp::signed_magnitude, mp::unchecked, void>>>(
        points, lowest);
  return orientationOfIntegers<mp::cpp_int>(points, lowest);
}

}  // namespace

int orientation(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                const double (&c)[3]) {
  double u[3], v[3], w[3];
  double u_max = 0, v_max = 0, w_max = 0;
  for (int k = 0; k < 3; ++k) {
    u[k] = p[k] - a[k];
    v[k] = b[k] - a[k];
    w[k] = c[k] - a[k];
    u_max = std::max(u_max, std::abs(u[k]));
    v_max = std::max(v_max, std::abs(v[k]));
    w_max = std::max(w_max, std::abs(w[k]));
  }
  const double volume = u[0] * (v[1] * w[2] - v[2] * w[1]) +
                        u[1] * (v[2] * w[0] - v[0] * w[2]) +
                        u[2] * (v[0] * w[1] - v[1] * w[0]);
  // Differences and products rounded once: a component of v x w has an error of 2 (2 + 1)
  // + 2 = 8 units of 2^-53 VW, the volume of 3 (2 + 8 + 2) + 10 = 46 units of UVW.
  // Nothing underflows while VW and UVW are well above 2^-1022.
  const double size = u_max * (v_max * w_max);
  if (v_max * w_max > 0x1p-900 && size > 0x1p-900 && size < 0x1p900 &&
      std::abs(volume) > 48 * 0x1p-53 * size)
    return volume > 0 ? 1 : -1;
  return exactOrientation(p, a, b, c);
}

bool isCrossing(const double (&p)[3], const double (&q)[3], const double (&a)[3],
                const double (&b)[3], const double (&c)[3]) {
  const int side_p = orientation(p, a, b, c);
  if (side_p == 0) return false;
  const int side_q = orientation(q, a, b, c);
  if (side_q != -side_p) return false;
  // The line pq passes strictly inside if it turns the same way around all three edges.
  const int turn = orientation(q, p, a, b);
  return turn != 0 && orientation(q, p, b, c) == turn && orientation(q, p, c, a) == turn;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

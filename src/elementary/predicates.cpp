// SPDX-License-Identifier: BSD-3-Clause
#include "elementary/predicates.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cassert>
#include <cmath>
#include <type_traits>

#include "numerics/double_double.h"
#include "numerics/error_bounds.h"
#include "numerics/integer_coordinates.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

namespace mp = boost::multiprecision;

/// Digits of an orientation whose coordinates have n digits: a difference has one more, a
/// product of three differences three times as many, a sum of six products three more.
constexpr int orientationDigits(int n) { return 3 * (n + 1) + 3; }
constexpr int kFewDigits = 40, kManyDigits = 168;
static_assert(orientationDigits(kFewDigits) <= 128, "digits of FewDigits");
static_assert(orientationDigits(kManyDigits) <= 512, "digits of ManyDigits");

using FewDigits = mp::int128_t;
using ManyDigits =
    mp::number<mp::cpp_int_backend<512, 512, mp::signed_magnitude, mp::unchecked, void>,
               mp::et_off>;

/// Calls compute(zero) with a zero of an integer type that is long enough for an
/// orientation.
/// @param digits  the number of digits of a coordinate
template <typename Compute>
int withIntegers(int digits, Compute&& compute) {
  assert(digits > 0);
  if (digits <= kFewDigits) return compute(FewDigits{0});
  if (digits <= kManyDigits) return compute(ManyDigits{0});
  return compute(mp::cpp_int{0});
}

template <typename Integer>
int orientationOfIntegers(const double* const (&points)[4], int lowest) {
  Integer x[4][3];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) x[i][k] = toInteger<Integer>(points[i][k], lowest);
  Integer d[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[i][k] = x[i == 0 ? 0 : i + 1][k] - x[1][k];
  const Integer volume = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
                         d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
                         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
  return volume.sign();
}

/// Sign of the volume in double-double; 0 if this does not decide. norms: those of the
/// differences, in a range in which no underflow or overflow matters.
int accurateOrientation(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                        const double (&c)[3], const double (&norms)[3]) {
  AccurateVector u, v, w, n;
  bool is_double = true;
  for (int k = 0; k < 3; ++k) {
    u[k] = DoubleDouble::difference(p[k], a[k]);
    v[k] = DoubleDouble::difference(b[k], a[k]);
    w[k] = DoubleDouble::difference(c[k], a[k]);
    is_double &= v[k].lo == 0 && w[k].lo == 0;
  }
  cross(v, w, n);
  double size = 0;
  for (const DoubleDouble& component : n) size = std::max(size, std::abs(component.hi));
  // A component of n has two products, which are exact for plain doubles, and their
  // difference. The volume has three products of size UN and sums of 2 and 3 UN: 11 *
  // 2^-104 UN. Underflows are less than 2^-1060 for each.
  const double n_error = (is_double ? 0 : 2 * kProductBound * (norms[1] * norms[2])) +
                         kSumBound * size + 0x1p-1060;
  const double bound =
      3.5 * (norms[0] * n_error) + 12 * kSumBound * (norms[0] * size) + 0x1p-1060;
  assert(bound > 0);
  const double volume = dot(u, n).hi;
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

int exactOrientation(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                     const double (&c)[3]) {
  const double* const points[4] = {p, a, b, c};
  DigitRange range;
  for (const double* point : points)
    for (int k = 0; k < 3; ++k) range.add(point[k]);
  if (range.isEmpty()) return 0;
  return withIntegers(range.numDigits(), [&](const auto& zero) {
    return orientationOfIntegers<std::decay_t<decltype(zero)>>(points, range.lowest);
  });
}

/// Sign of (b0 - a0) (d1 - c1) - (b1 - a1) (d0 - c0).
template <typename Integer>
int crossSignOfIntegers(const double (&x)[8], int lowest) {
  Integer n[8];
  for (int i = 0; i < 8; ++i) n[i] = toInteger<Integer>(x[i], lowest);
  const Integer left = (n[1] - n[0]) * (n[3] - n[2]);
  const Integer right = (n[5] - n[4]) * (n[7] - n[6]);
  return left.compare(right);
}

int exactCrossSign(const double (&x)[8]) {
  DigitRange range;
  for (const double value : x) range.add(value);
  if (range.isEmpty()) return 0;
  const int sign = withIntegers(range.numDigits(), [&](const auto& zero) {
    return crossSignOfIntegers<std::decay_t<decltype(zero)>>(x, range.lowest);
  });
  return sign < 0 ? -1 : sign > 0 ? 1 : 0;
}

/// Whether difference is p - q without rounding.
bool isExactDifference(double p, double q, double difference) {
  // Knuth's TwoSum; the rounding error of a difference is a double.
  const double q_virtual = p - difference;
  const double p_virtual = difference + q_virtual;
  return (p - p_virtual) + (q_virtual - q) == 0;
}

/// Sign of s t - u v for products that neither overflow nor lose bits below 2^-1074.
int compareProducts(double s, double t, double u, double v) {
  const double left = s * t, right = u * v;
  if (left != right) return left > right ? 1 : -1;  // rounding keeps the order
  const double left_rest = std::fma(s, t, -left), right_rest = std::fma(u, v, -right);
  return left_rest > right_rest ? 1 : left_rest < right_rest ? -1 : 0;
}

int turn(const double (&a)[3], const double (&b)[3], const double (&c)[3], int axis) {
  return crossSign(a, b, a, c, axis);
}

/// Whether a corner of one feature is at a corner of the other at t = 0, as in triangle
/// soup and where blocks stand side by side.
bool doCornersMeet(ContinuousContactKind kind, const FeaturePoints& x) {
  const int num_first = kind == ContinuousContactKind::kVertexFace ? 1 : 2;
  for (int i = 0; i < num_first; ++i)
    for (int j = num_first; j < 4; ++j)
      if (std::equal(x[i].t0, x[i].t0 + 3, x[j].t0)) return true;
  return false;
}

/// Whether p lies on the closed segment qr.
bool isOnSegment(const double (&p)[3], const double (&q)[3], const double (&r)[3]) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < std::min(q[k], r[k]) || p[k] > std::max(q[k], r[k])) return false;
  return turn(q, r, p, 0) == 0 && turn(q, r, p, 1) == 0 && turn(q, r, p, 2) == 0;
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
  // No underflow or overflow happens if VW and UVW are in this range.
  const double size = u_max * (v_max * w_max);
  // Fast answer for layers in a plane of constant x, y or z.
  for (int k = 0; k < 3; ++k)
    if (u[k] == 0 && v[k] == 0 && w[k] == 0) return 0;
  if (isInRange(v_max * w_max) && isInRange(size)) {
    if (std::abs(volume) > kVolumeBound * size) return volume > 0 ? 1 : -1;
    if (const int sign = accurateOrientation(p, a, b, c, {u_max, v_max, w_max})) {
      assert(sign == exactOrientation(p, a, b, c));
      return sign;
    }
  }
  return exactOrientation(p, a, b, c);
}

int crossSign(const double (&a)[3], const double (&b)[3], const double (&c)[3],
              const double (&d)[3], int axis) {
  assert(axis >= 0 && axis < 3);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double s = b[i] - a[i], t = d[j] - c[j], u = b[j] - a[j], v = d[i] - c[i];
  if ((s == 0 || t == 0) && (u == 0 || v == 0)) return 0;
  // Differences and products are rounded once, and so is the difference of the products:
  // the error is within 4 units of 2^-53 of |st| + |uv|. In this range no underflow
  // matters.
  const double size = std::abs(s * t) + std::abs(u * v), value = s * t - u * v;
  const bool in_range = isInRange(size);
  if (in_range && std::abs(value) > 5 * kUnit * size) return value > 0 ? 1 : -1;
  // If the products cancel, both are near size / 2.
  if (in_range && isExactDifference(b[i], a[i], s) && isExactDifference(d[j], c[j], t) &&
      isExactDifference(b[j], a[j], u) && isExactDifference(d[i], c[i], v)) {
    const int sign = compareProducts(s, t, u, v);
    assert(sign == exactCrossSign({a[i], b[i], c[j], d[j], a[j], b[j], c[i], d[i]}));
    return sign;
  }
  return exactCrossSign({a[i], b[i], c[j], d[j], a[j], b[j], c[i], d[i]});
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

bool isOnTriangle(const double (&p)[3], const double (&a)[3], const double (&b)[3],
                  const double (&c)[3]) {
  if (orientation(p, a, b, c) != 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    // Along an axis in which the triangle has a projected area, the projection of its
    // plane is one to one.
    const int side = turn(a, b, c, axis);
    if (side != 0)
      return side * turn(a, b, p, axis) >= 0 && side * turn(b, c, p, axis) >= 0 &&
             side * turn(c, a, p, axis) >= 0;
  }
  return isOnSegment(p, a, b) || isOnSegment(p, b, c) || isOnSegment(p, c, a);
}

bool doSegmentsTouch(const double (&a)[3], const double (&b)[3], const double (&c)[3],
                     const double (&d)[3]) {
  if (orientation(c, a, b, d) != 0) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (crossSign(a, b, c, d, axis) != 0)
      return turn(a, b, c, axis) * turn(a, b, d, axis) <= 0 &&
             turn(c, d, a, axis) * turn(c, d, b, axis) <= 0;
  // Parallel: an end of one lies on the other.
  return isOnSegment(a, c, d) || isOnSegment(b, c, d) || isOnSegment(c, a, b) ||
         isOnSegment(d, a, b);
}

bool doTouchAtStart(ContinuousContactKind kind, const FeaturePoints& x) {
  if (doCornersMeet(kind, x)) return true;
  return kind == ContinuousContactKind::kVertexFace
             ? isOnTriangle(x[0].t0, x[1].t0, x[2].t0, x[3].t0)
             : doSegmentsTouch(x[0].t0, x[1].t0, x[2].t0, x[3].t0);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The definition of a contact at one time, in a form that differs from the library's:
// points are projected to a coordinate plane, and orientations decide there. For exact
// numbers only: boost's cpp_rational, or integers that cannot overflow.
#ifndef FCL_TEST_SUPPORT_RATIONAL_GEOMETRY_H
#define FCL_TEST_SUPPORT_RATIONAL_GEOMETRY_H

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>

#include "elementary/elementary.h"

namespace fcl {
namespace test {

using Rational = boost::multiprecision::cpp_rational;

template <typename N>
using ExactPoint = std::array<N, 3>;

template <typename N>
int signOf(const N& x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

template <typename N>
ExactPoint<N> minus(const ExactPoint<N>& a, const ExactPoint<N>& b) {
  return {N(a[0] - b[0]), N(a[1] - b[1]), N(a[2] - b[2])};
}

template <typename N>
N dot(const ExactPoint<N>& a, const ExactPoint<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename N>
ExactPoint<N> cross(const ExactPoint<N>& a, const ExactPoint<N>& b) {
  return {N(a[1] * b[2] - a[2] * b[1]), N(a[2] * b[0] - a[0] * b[2]),
          N(a[0] * b[1] - a[1] * b[0])};
}

/// @brief Sign of the volume (p - a) . ((b - a) x (c - a)).
template <typename N>
int volumeSign(const ExactPoint<N>& p, const ExactPoint<N>& a, const ExactPoint<N>& b,
               const ExactPoint<N>& c) {
  return signOf(N(dot(minus(p, a), cross(minus(b, a), minus(c, a)))));
}

/// @brief Orientation of a, b, c with coordinate `dropped` left out.
template <typename N>
int turn(const ExactPoint<N>& a, const ExactPoint<N>& b, const ExactPoint<N>& c,
         std::size_t dropped) {
  return signOf(cross(minus(b, a), minus(c, a))[dropped]);
}

/// @brief The index of a coordinate in which n is not zero; 3 if there is none.
template <typename N>
std::size_t nonzeroAxis(const ExactPoint<N>& n) {
  std::size_t k = 0;
  while (k < 3 && n[k] == 0) ++k;
  return k;
}

template <typename N>
bool isOnSegment(const ExactPoint<N>& p, const ExactPoint<N>& a, const ExactPoint<N>& b) {
  if (nonzeroAxis(cross(minus(p, a), minus(b, a))) != 3) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if ((p[k] < a[k] && p[k] < b[k]) || (p[k] > a[k] && p[k] > b[k])) return false;
  return true;
}

template <typename N>
bool isOnTriangle(const ExactPoint<N>& p, const ExactPoint<N>& a, const ExactPoint<N>& b,
                  const ExactPoint<N>& c) {
  const ExactPoint<N> n = cross(minus(b, a), minus(c, a));
  const std::size_t axis = nonzeroAxis(n);
  if (axis == 3)
    return isOnSegment(p, a, b) || isOnSegment(p, b, c) || isOnSegment(p, c, a);
  if (dot(minus(p, a), n) != 0) return false;
  const int way = signOf(n[axis]);
  return turn(a, b, p, axis) * way >= 0 && turn(b, c, p, axis) * way >= 0 &&
         turn(c, a, p, axis) * way >= 0;
}

template <typename N>
bool doSegmentsMeet(const ExactPoint<N>& a, const ExactPoint<N>& b,
                    const ExactPoint<N>& c, const ExactPoint<N>& d) {
  if (isOnSegment(a, c, d) || isOnSegment(b, c, d) || isOnSegment(c, a, b) ||
      isOnSegment(d, a, b))
    return true;
  const std::size_t axis = nonzeroAxis(cross(minus(b, a), minus(d, c)));
  if (axis == 3 || volumeSign(a, b, c, d) != 0) return false;
  return turn(a, b, c, axis) * turn(a, b, d, axis) < 0 &&
         turn(c, d, a, axis) * turn(c, d, b, axis) < 0;
}

/// @brief Whether the features of four points touch: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
template <typename N>
bool doTouch(fcl::ContinuousContactKind kind, const std::array<ExactPoint<N>, 4>& p) {
  return kind == fcl::ContinuousContactKind::kVertexFace
             ? isOnTriangle(p[0], p[1], p[2], p[3])
             : doSegmentsMeet(p[0], p[1], p[2], p[3]);
}

/// @brief The points of a pair at time numerator / denominator, times the denominator.
/// @tparam N  coordinates must be exact in it
template <typename N>
std::array<ExactPoint<N>, 4> pointsAt(const detail::deformable::VertexPath* x,
                                      const N& numerator, const N& denominator) {
  std::array<ExactPoint<N>, 4> p;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      p[i][k] = N(denominator - numerator) * N(x[i].t0[k]) + numerator * N(x[i].t1[k]);
  return p;
}

}  // namespace test
}  // namespace fcl

#endif

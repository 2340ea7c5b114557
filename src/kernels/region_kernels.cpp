// SPDX-License-Identifier: BSD-3-Clause
//
// The directions in which triangles face, and the sides that a point sees of them.
#include <cstddef>
#include <cstdint>
#include <utility>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/region_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"
#include "numerics/error_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// The product of a vector with axis kAxis, without its error bound.
template <std::size_t kAxis>
HWY_INLINE Doubles along(const Vectors& a) {
  constexpr int x = kAxes[kAxis][0], y = kAxes[kAxis][1], z = kAxes[kAxis][2];
  static_assert(x > 0 || (x == 0 && (y > 0 || (y == 0 && z > 0))), "what comes first");
  Doubles sum = x ? a.x : y ? a.y : a.z;
  if constexpr (x && y) sum = y > 0 ? sum + a.y : sum - a.y;
  if constexpr ((x || y) && z) sum = z > 0 ? sum + a.z : sum - a.z;
  return sum;
}

/// The normals of eight triangles during a step, and the bounds on the rounding of their
/// products with an axis. No number is a NaN.
struct BoundedNormals {
  MovingNormals n;
  Doubles bound, minus_bound;
};

/// If all triangles face axis kAxis or its opposite, the bit of that direction; else 0.
template <std::size_t kAxis>
HWY_INLINE std::uint32_t facedAlong(const BoundedNormals& normals) {
  const MovingNormals& n = normals.n;
  const Doubles a = along<kAxis>(n.first), b = along<kAxis>(n.middle),
                c = along<kAxis>(n.last);
  if (!isAnyNegative(smaller(smaller(a, b), c) - normals.bound)) return 1U << kAxis;
  const bool down = !isAnyNegative(normals.minus_bound - larger(larger(a, b), c));
  return std::uint32_t{down} << (kAxis + kNumAxes);
}

template <std::size_t... kAxis>
HWY_INLINE std::uint32_t facedAlongAll(const BoundedNormals& normals,
                                       std::index_sequence<kAxis...>) {
  return (... | facedAlong<kAxis>(normals));
}

/// Whether no coordinate is a NaN. Infinities of different signs count as one.
HWY_INLINE bool areNumbers(const Vectors& a) {
  const Doubles sum = a.x + a.y + a.z;
  return bits(sum == sum) == (1U << kEight) - 1;
}

std::uint32_t facedDirections(const TreeVertex* vertices, const TreeTriangle* triangles,
                              std::size_t count) {
  const TreeVertex* x[3][kEight];
  for (std::size_t i = 0; i < kEight; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k][i] = &vertices[triangles[i < count ? i : 0].place[k]];
  const MovingVectors first = loadPaths(x[0]), v = loadPaths(x[1]) - first,
                      w = loadPaths(x[2]) - first;
  const MovingNormals n = cross(v, w);
  const Doubles size =
      max(maxNorm(v.t0), maxNorm(v.t1)) * max(maxNorm(w.t0), maxNorm(w.t1));
  if (bits(isInRange(size)) != (1U << kEight) - 1 || !areNumbers(n.first) ||
      !areNumbers(n.middle) || !areNumbers(n.last))
    return 0;
  return facedAlongAll(
      {n, broadcast<kEight>(kFanBound) * size, broadcast<kEight>(-kFanBound) * size},
      std::make_index_sequence<kNumAxes>());
}

/// The signs of the volume of three moving vectors, for eight of them: lanes in which it
/// is certainly positive (negative) during the whole step.
struct VolumeSigns {
  unsigned positive, negative;
};

/// @param size  the product of their norms, in the range of the bounds
HWY_INLINE VolumeSigns volumeSigns(const MovingVectors& u, const MovingNormals& n,
                                   const Doubles& size) {
  // Bernstein coefficients; the inner ones are times 3, and have a larger bound.
  const Doubles outer0 = dot(u.t0, n.first), outer1 = dot(u.t1, n.last),
                inner0 = dot(u.t1, n.first) + dot(u.t0, n.middle),
                inner1 = dot(u.t1, n.middle) + dot(u.t0, n.last);
  const Doubles outer = broadcast<kEight>(kOuterBound) * size,
                inner = broadcast<kEight>(kInnerBound) * size;
  const Doubles zero = broadcast<kEight>(0.);
  return {bits((outer0 > outer) & (outer1 > outer) & (inner0 > inner) & (inner1 > inner)),
          bits((outer0 < zero - outer) & (outer1 < zero - outer) &
               (inner0 < zero - inner) & (inner1 < zero - inner))};
}

/// The same vector eight times.
HWY_INLINE Vectors vectorsOf(const double* x) {
  return {broadcast<kEight>(x[0]), broadcast<kEight>(x[1]), broadcast<kEight>(x[2])};
}

EightViews viewFrom(const TreeVertex& point, const double (&ray)[3],
                    const TreeVertex* vertices, const TreeTriangle* triangles,
                    std::size_t count) {
  const TreeVertex* x[3][kEight];
  for (std::size_t i = 0; i < kEight; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k][i] = &vertices[triangles[i < count ? i : 0].place[k]];
  const MovingVectors center = {vectorsOf(point.t0), vectorsOf(point.t1)},
                      u = loadPaths(x[0]) - center, v = loadPaths(x[1]) - center,
                      w = loadPaths(x[2]) - center;
  const Doubles u_norm = max(maxNorm(u.t0), maxNorm(u.t1)),
                v_norm = max(maxNorm(v.t0), maxNorm(v.t1)),
                w_norm = max(maxNorm(w.t0), maxNorm(w.t1));
  const Doubles size = u_norm * (v_norm * w_norm);
  const VolumeSigns signs = volumeSigns(u, cross(v, w), size);
  const unsigned known =
      bits(isInRange(size) & isInRange(v_norm * w_norm)) & ((1U << count) - 1);
  EightViews views{signs.positive & known, signs.negative & known, 0};

  // In terms of the corners the ray is a sum whose weights are volumes of the ray and two
  // corners, divided by the volume of all corners. It misses if one of them is negative.
  const Vectors r = vectorsOf(ray);
  const Doubles most = max(max(u_norm, v_norm), w_norm),
                ray_size = maxNorm(r) * (most * most),
                bound = broadcast<kEight>(kVolumeBound) * ray_size,
                minus_bound = broadcast<kEight>(0.) - bound;
  const Doubles a = dot(r, cross(v.t0, w.t0)), b = dot(r, cross(w.t0, u.t0)),
                c = dot(r, cross(u.t0, v.t0));
  const unsigned below = bits((a < minus_bound) | (b < minus_bound) | (c < minus_bound)),
                 above = bits((a > bound) | (b > bound) | (c > bound));
  views.missed = bits(isInRange(ray_size) & isInRange(most * most)) &
                 ((views.left & below) | (views.right & above));
  return views;
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

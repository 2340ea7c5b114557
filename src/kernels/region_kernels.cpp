// SPDX-License-Identifier: BSD-3-Clause
//
// The directions in which triangles face.
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

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

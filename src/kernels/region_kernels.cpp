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

#include "error_bounds.h"
#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// A vector, or what is left of one, times an axis.
template <std::size_t kAxis>
HWY_INLINE Doubles along(const Vectors& a) {
  constexpr int x = kAxes[kAxis][0], y = kAxes[kAxis][1], z = kAxes[kAxis][2];
  static_assert(x > 0 || (x == 0 && (y > 0 || (y == 0 && z > 0))), "what comes first");
  Doubles sum = x ? a.x : y ? a.y : a.z;
  if constexpr (x && y) sum = y > 0 ? sum + a.y : sum - a.y;
  if constexpr ((x || y) && z) sum = z > 0 ? sum + a.z : sum - a.z;
  return sum;
}

/// The normals of eight triangles during a step: Bernstein coefficients, the middle one
/// twice, and bounds on their rounding along an axis. No number is a NaN.
struct MovingNormals {
  Vectors first, middle, last;
  Doubles bound, minus_bound;
};

/// Bits of an axis and of its opposite that all triangles face.
template <std::size_t kAxis>
HWY_INLINE std::uint32_t facedAlong(const MovingNormals& n) {
  const Doubles a = along<kAxis>(n.first), b = along<kAxis>(n.middle),
                c = along<kAxis>(n.last);
  if (!isAnyNegative(smaller(smaller(a, b), c) - n.bound)) return 1U << kAxis;
  const bool down = !isAnyNegative(n.minus_bound - larger(larger(a, b), c));
  return std::uint32_t{down} << (kAxis + kNumAxes);
}

template <std::size_t... kAxis>
HWY_INLINE std::uint32_t facedAlongAll(const MovingNormals& n,
                                       std::index_sequence<kAxis...>) {
  return (... | facedAlong<kAxis>(n));
}

/// Whether no coordinate is a NaN; infinities of both signs are one.
HWY_INLINE bool areNumbers(const Vectors& a) {
  const Doubles sum = a.x + a.y + a.z;
  return bits(sum == sum) == (1U << kEight) - 1;
}

/// Eight triangles' edges from their first vertices at one time.
struct EdgePairs {
  Vectors v, w;
};

/// @param row  row(k, i) points to vertex k of triangle i
template <typename Row>
HWY_INLINE EdgePairs edgesOf(const Row& row) {
  Vectors x[3];
  for (std::size_t k = 0; k < 3; ++k)
    loadColumns([&row, k](std::size_t i) HWY_ATTR { return row(k, i); }, x[k].x, x[k].y,
                x[k].z);
  return {x[1] - x[0], x[2] - x[0]};
}

std::uint32_t facedDirections(const TreeVertex* vertices, const TreeTriangle* triangles,
                              std::size_t count) {
  const TreeVertex* x[3][kEight];
  for (std::size_t i = 0; i < kEight; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k][i] = &vertices[triangles[i < count ? i : 0].place[k]];
  const EdgePairs e0 = edgesOf([&x](std::size_t k, std::size_t i)
                                   HWY_ATTR { return x[k][i]->t0; }),
                  e1 = edgesOf([&x](std::size_t k, std::size_t i)
                                   HWY_ATTR { return x[k][i]->t1; });
  MovingNormals n;
  n.first = cross(e0.v, e0.w);
  n.middle = cross(e0.v, e1.w) + cross(e1.v, e0.w);
  n.last = cross(e1.v, e1.w);
  const Doubles size =
      max(maxNorm(e0.v), maxNorm(e1.v)) * max(maxNorm(e0.w), maxNorm(e1.w));
  const unsigned in_range =
      bits((size >= broadcast<kEight>(kTiny)) & (size <= broadcast<kEight>(kHuge)));
  if (in_range != (1U << kEight) - 1 || !areNumbers(n.first) || !areNumbers(n.middle) ||
      !areNumbers(n.last))
    return 0;
  n.bound = broadcast<kEight>(kFanBound) * size;
  n.minus_bound = broadcast<kEight>(-kFanBound) * size;
  return facedAlongAll(n, std::make_index_sequence<kNumAxes>());
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

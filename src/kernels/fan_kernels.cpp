// SPDX-License-Identifier: BSD-3-Clause
//
// The proof that fans stay embedded.
#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/fan_kernels.cpp"
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

/// On which side of a ray the spokes of eight fans lie at one time: a bit a fan where
/// spoke i lies before (after) it beyond doubt, turning the fan's way.
struct SidesOfRay {
  unsigned before[VertexFans::kMaxSpokes], after[VertexFans::kMaxSpokes];

  /// @param across  its product with what lies before the ray is above the bound
  HWY_INLINE void set(std::size_t i, const Vectors& spoke, const Vectors& across,
                      const Doubles& bound, const Doubles& minus_bound) {
    const Doubles g = dot(spoke, across);
    before[i] = bits(g > bound);
    after[i] = bits(g < minus_bound);
  }
};

/// Fans that go round once: the ray lies in one sector.
HWY_INLINE unsigned goRoundOnce(const SidesOfRay& at0, std::size_t count) {
  unsigned decided = ~0U, once = 0, again = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned within = at0.before[i] & at0.after[i + 1 < count ? i + 1 : 0];
    decided &= at0.before[i] | at0.after[i];
    again |= once & within;
    once |= within;
  }
  return decided & once & ~again;
}

/// Fans of which no sector ever covers the ray: each has its first spoke after it all the
/// time, or its last one before.
HWY_INLINE unsigned leaveFree(const SidesOfRay& at0, const SidesOfRay& at1,
                              std::size_t count) {
  unsigned free = ~0U;
  for (std::size_t i = 0; i + 1 < count; ++i)
    free &= (at0.after[i] & at1.after[i]) | (at0.before[i + 1] & at1.before[i + 1]);
  return free;
}

unsigned areFansEmbedded(const TreeVertex* vertices, const EightFans& fans) {
  const std::size_t count = fans.count;
  const MovingVectors center = loadPaths(fans.center);
  MovingVectors spokes[VertexFans::kMaxSpokes + 1];
  Doubles u_norm = broadcast<kEight>(kLeastNorm);
  for (std::size_t i = 0; i < count; ++i) {
    const TreeVertex* x[kEight];
    for (std::size_t lane = 0; lane < kEight; ++lane)
      x[lane] = vertices + fans.spokes[lane][i];
    spokes[i] = loadPaths(x) - center;
    u_norm = max(u_norm, max(maxNorm(spokes[i].t0), maxNorm(spokes[i].t1)));
  }
  spokes[count] = spokes[0];

  // All triangles face d.
  const std::size_t num_triangles = fans.is_closed ? count : count - 1;
  MovingNormals normals[VertexFans::kMaxSpokes];
  const Doubles zero = broadcast<kEight>(0.);
  Vectors d = {zero, zero, zero};
  for (std::size_t i = 0; i < num_triangles; ++i) {
    normals[i] = cross(spokes[i], spokes[i + 1]);
    d = d + (normals[i].first + normals[i].last);
  }
  const Doubles d_norm = maxNorm(d), size = u_norm * u_norm * d_norm;
  const Doubles turned = broadcast<kEight>(kFanBound) * size;
  DoubleMask facing = isInRange(u_norm * u_norm) & isInRange(size);
  for (std::size_t i = 0; i < num_triangles; ++i)
    facing = facing & (dot(normals[i].first, d) > turned) &
             (dot(normals[i].middle, d) > turned) & (dot(normals[i].last, d) > turned);
  const unsigned left = bits(facing);
  if (left == 0) return 0;

  // The ray: through the middle of the first sector of a closed fan; away from an open
  // one.
  Vectors ray = {zero, zero, zero};
  if (fans.is_closed) {
    const Vectors &p = spokes[0].t0, &q = spokes[1].t0;
    const Doubles a = maxNorm(p), b = maxNorm(q);
    ray = {b * p.x + a * q.x, b * p.y + a * q.y, b * p.z + a * q.z};
  } else {
    for (std::size_t i = 0; i < count; ++i) ray = ray - (spokes[i].t0 + spokes[i].t1);
  }
  const Doubles ray_norm = maxNorm(ray), ray_size = u_norm * ray_norm * d_norm;
  const unsigned in_range = bits(isInRange(ray_norm * d_norm) & isInRange(ray_size));
  const Doubles bound = broadcast<kEight>(kRayBound) * ray_size,
                minus_bound = zero - bound;
  const Vectors across = cross(ray, d);
  SidesOfRay at0, at1;
  for (std::size_t i = 0; i < count; ++i) {
    at0.set(i, spokes[i].t0, across, bound, minus_bound);
    if (!fans.is_closed) at1.set(i, spokes[i].t1, across, bound, minus_bound);
  }
  return left & in_range &
         (fans.is_closed ? goRoundOnce(at0, count) : leaveFree(at0, at1, count));
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

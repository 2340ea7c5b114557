// SPDX-License-Identifier: BSD-3-Clause
//
// The proof that a fan stays embedded.
#include <algorithm>
#include <cmath>

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

struct Vector {
  double x, y, z;
};

HWY_INLINE double maxNorm(const Vector& a) {
  return std::max(std::max(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

HWY_INLINE Vector difference(const double* p, const double* q) {
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}

HWY_INLINE Doubles dot(const Vectors& a, const Vector& b) {
  return a.x * broadcast<kEight>(b.x) + a.y * broadcast<kEight>(b.y) +
         a.z * broadcast<kEight>(b.z);
}

HWY_INLINE Vector sumOfLanes(const Vectors& a) {
  return {sumOfLanes(a.x), sumOfLanes(a.y), sumOfLanes(a.z)};
}

/// The spokes of a fan, with room for whole lanes: a closed fan is followed by its first
/// spoke, an open one by its last, so that what follows spans no triangle.
class Spokes {
 public:
  HWY_INLINE Spokes(const TreeVertex* vertices, const TreeVertex& center,
                    const VertexFan& fan, std::size_t num_blocks)
      : center_(center) {
    std::size_t i = 0;
    for (; i < fan.count; ++i) spokes_[i] = vertices + fan.spokes[i];
    const TreeVertex* next = spokes_[fan.is_closed ? 0 : i - 1];
    for (; i <= num_blocks * kEight; ++i) spokes_[i] = next;
  }

  const TreeVertex& operator[](std::size_t i) const { return *spokes_[i]; }

  /// Eight from spoke i on, as differences to the center, at t = 0 and at t = 1.
  HWY_INLINE Vectors at0(std::size_t i) const {
    const TreeVertex* const* from = spokes_ + i;
    return minus(center_.t0,
                 [from](std::size_t lane) HWY_ATTR { return from[lane]->t0; });
  }
  HWY_INLINE Vectors at1(std::size_t i) const {
    const TreeVertex* const* from = spokes_ + i;
    return minus(center_.t1,
                 [from](std::size_t lane) HWY_ATTR { return from[lane]->t1; });
  }

 private:
  template <typename Row>
  HWY_INLINE Vectors minus(const double (&center)[4], const Row& spoke) const {
    Vectors p;
    loadColumns(spoke, p.x, p.y, p.z);
    return {p.x - broadcast<kEight>(center[0]), p.y - broadcast<kEight>(center[1]),
            p.z - broadcast<kEight>(center[2])};
  }

  const TreeVertex& center_;
  const TreeVertex* spokes_[VertexFans::kMaxSpokes + kEight];
};

bool isFanEmbedded(const TreeVertex* vertices, const TreeVertex& center,
                   const VertexFan& fan) {
  if (fan.count < 2) return false;
  const std::size_t num_blocks = (fan.count + kEight - 1) / kEight;
  const Spokes spokes(vertices, center, fan, num_blocks);

  constexpr std::size_t kMaxBlocks = VertexFans::kMaxSpokes / kEight;
  Vectors u0[kMaxBlocks], u1[kMaxBlocks];
  Vectors first[kMaxBlocks], middle[kMaxBlocks], last[kMaxBlocks];
  Vector d = {0, 0, 0};
  Doubles norm = broadcast<kEight>(kLeastNorm);
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const Vectors v0 = u0[b] = spokes.at0(b * kEight),
                  v1 = u1[b] = spokes.at1(b * kEight), w0 = spokes.at0(b * kEight + 1),
                  w1 = spokes.at1(b * kEight + 1);
    norm = max(norm, max(maxNorm(v0), maxNorm(v1)));
    first[b] = cross(v0, w0);
    middle[b] = cross(v0, w1) + cross(v1, w0);
    last[b] = cross(v1, w1);
    const Vector sum = sumOfLanes(first[b] + last[b]);
    d = {d.x + sum.x, d.y + sum.y, d.z + sum.z};
  }
  const double u_norm = largest(norm), d_norm = maxNorm(d);
  const double size = u_norm * u_norm * d_norm;
  if (!(u_norm * u_norm >= kTiny && size >= kTiny && size <= kHuge)) return false;

  const std::size_t num_triangles = fan.is_closed ? fan.count : fan.count - 1;
  const auto triangles_bits = (1U << num_triangles) - 1;
  const Doubles turned = broadcast<kEight>(kFanBound * size);
  unsigned keep = 0;
  for (std::size_t b = 0; b < num_blocks; ++b)
    keep |= bits((dot(first[b], d) > turned) & (dot(middle[b], d) > turned) &
                 (dot(last[b], d) > turned))
            << (b * kEight);
  if ((keep & triangles_bits) != triangles_bits) return false;

  // The ray: through the middle of the first sector of a closed fan; away from an open
  // one.
  Vector r = {0, 0, 0};
  if (fan.is_closed) {
    const Vector p = difference(spokes[0].t0, center.t0),
                 q = difference(spokes[1].t0, center.t0);
    const double a = maxNorm(p), b = maxNorm(q);
    r = {b * p.x + a * q.x, b * p.y + a * q.y, b * p.z + a * q.z};
  } else {
    for (std::size_t i = 0; i < fan.count; ++i) {
      const Vector p = difference(center.t0, spokes[i].t0),
                   q = difference(center.t1, spokes[i].t1);
      r = {r.x + (p.x + q.x), r.y + (p.y + q.y), r.z + (p.z + q.z)};
    }
  }
  const Vector e = {r.y * d.z - r.z * d.y, r.z * d.x - r.x * d.z, r.x * d.y - r.y * d.x};
  const double r_norm = maxNorm(r), ray_size = u_norm * r_norm * d_norm;
  if (!(r_norm * d_norm >= kTiny && ray_size >= kTiny && ray_size <= kHuge)) return false;
  const Doubles bound = broadcast<kEight>(kRayBound * ray_size);
  const Doubles minus_bound = broadcast<kEight>(-kRayBound * ray_size);
  // Spokes that lie before and after the ray beyond doubt, turning the fan's way.
  unsigned before0 = 0, after0 = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const Doubles g = dot(u0[b], e);
    before0 |= bits(g > bound) << (b * kEight);
    after0 |= bits(g < minus_bound) << (b * kEight);
  }
  if (fan.is_closed) {
    if (((before0 | after0) & triangles_bits) != triangles_bits) return false;
    const unsigned after_next = (after0 & triangles_bits) >> 1 | (after0 & 1U)
                                                                     << (fan.count - 1);
    return __builtin_popcount(before0 & after_next & triangles_bits) == 1;
  }
  unsigned before1 = 0, after1 = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const Doubles g = dot(u1[b], e);
    before1 |= bits(g > bound) << (b * kEight);
    after1 |= bits(g < minus_bound) << (b * kEight);
  }
  // A sector misses the ray while its first spoke is after it or its last one before.
  const unsigned misses = (after0 & after1) | (before0 & before1) >> 1;
  return (misses & triangles_bits) == triangles_bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

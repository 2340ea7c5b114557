// SPDX-License-Identifier: BSD-3-Clause
//
// The proof that fans stay embedded, and that their features stay apart.
#include <cassert>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/fan_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"
#include "mesh/vertex_fans.h"
#include "numerics/error_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// The paths of the outer ends of spoke i, of eight fans.
FCL_CCD_INLINE MovingVectors loadSpokes(const TreeVertex* vertices, const EightFans& fans,
                                        std::size_t i) {
  const TreeVertex* x[kEight];
  for (std::size_t lane = 0; lane < kEight; ++lane)
    x[lane] = vertices + fans.spokes[lane][i];
  return loadPaths(x);
}

/// The spokes of eight short fans, and the normals of their triangles.
class ShortFans {
 public:
  FCL_CCD_INLINE ShortFans(const TreeVertex* vertices, const EightFans& fans) {
    const MovingVectors center = loadPaths(fans.center);
    for (std::size_t i = 0; i < fans.count; ++i)
      spokes_[i] = loadSpokes(vertices, fans, i) - center;
    spokes_[fans.count] = spokes_[0];
  }

  FCL_CCD_INLINE const MovingVectors& spoke(std::size_t i) const { return spokes_[i]; }
  FCL_CCD_INLINE const MovingNormals& makeNormal(std::size_t i) {
    return normals_[i] = cross(spokes_[i], spokes_[i + 1]);
  }
  FCL_CCD_INLINE const MovingNormals& normal(std::size_t i) const { return normals_[i]; }

 private:
  MovingVectors spokes_[VertexFans::kShort + 1];
  MovingNormals normals_[VertexFans::kShort];
};

/// The spokes and normals of long fans, which are computed when they are needed.
class LongFans {
 public:
  FCL_CCD_INLINE LongFans(const TreeVertex* vertices, const EightFans& fans)
      : vertices_(vertices), fans_(fans), center_(loadPaths(fans.center)) {}

  FCL_CCD_INLINE MovingVectors spoke(std::size_t i) const {
    return loadSpokes(vertices_, fans_, i < fans_.count ? i : 0) - center_;
  }
  FCL_CCD_INLINE MovingNormals makeNormal(std::size_t i) const { return normal(i); }
  FCL_CCD_INLINE MovingNormals normal(std::size_t i) const {
    return cross(spoke(i), spoke(i + 1));
  }

 private:
  const TreeVertex* vertices_;
  const EightFans& fans_;
  MovingVectors center_;
};

/// The side of a ray on which a spoke lies at one time, for eight fans. A bit is set if
/// the spoke is certainly before (after) the ray, in the order of the fan's spokes.
struct SideOfRay {
  unsigned before, after;
};

/// @param across  a direction. A spoke is before the ray if its product with this
/// direction is above the bound
FCL_CCD_INLINE SideOfRay sideOfRay(const Vectors& spoke, const Vectors& across,
                                   const Doubles& bound, const Doubles& minus_bound) {
  const Doubles g = dot(spoke, across);
  return {bits(g > bound), bits(g < minus_bound)};
}

/// Finds the fans in which each height of each triangle, seen along d, stays above a
/// distance. The area seen is at least the least of its Bernstein coefficients, and a
/// side is never longer than at its ends.
/// @param norm  of the spokes
/// @param turned  bound on the rounding of a product of a normal and d
template <typename Fans>
FCL_CCD_INLINE DoubleMask areHigh(Fans& fans, std::size_t num_triangles, const Vectors& d,
                                  const Doubles& norm, const Doubles& turned,
                                  double distance) {
  // The rim is a difference of differences: 2^-51 of the norm in a coordinate, and it is
  // below 4 norms long.
  const Doubles rounding = broadcast<kEight>(0x1p-46) * norm * norm;
  const Doubles length = dot(d, d),
                least = broadcast<kEight>(distance * kUpward) * squareRoot(length);
  const auto longest = [](const MovingVectors& side) HWY_ATTR {
    return max(dot(side.t0, side.t0), dot(side.t1, side.t1));
  };
  DoubleMask high = isInRange(length);
  for (std::size_t i = 0; i < num_triangles; ++i) {
    const MovingVectors p = fans.spoke(i), q = fans.spoke(i + 1);
    const MovingNormals normal = fans.normal(i);
    const Doubles area =
        min(min(dot(normal.first, d), broadcast<kEight>(0.5) * dot(normal.middle, d)),
            dot(normal.last, d)) -
        turned;
    const Doubles side = max(max(longest(p), longest(q)), longest(q - p)) + rounding;
    high = high & (area > least * squareRoot(side));
  }
  return high;
}

/// Eight fans, and what their proofs have in common.
template <typename Fans>
struct FansToProve {
  Fans& fans;
  std::size_t count;
  bool is_closed;
  /// Bound on the norm of the spokes.
  Doubles norm;
  /// The sum of the normals, and its norm.
  Vectors d;
  Doubles d_norm;

  FCL_CCD_INLINE std::size_t numTriangles() const {
    return is_closed ? count : count - 1;
  }
};

/// Makes the normals of the fans.
template <typename Fans>
FCL_CCD_INLINE FansToProve<Fans> prepare(Fans& fans, std::size_t count, bool is_closed) {
  const Doubles zero = broadcast<kEight>(0.);
  FansToProve<Fans> out{
      fans, count, is_closed, broadcast<kEight>(kLeastNorm), {zero, zero, zero}, zero};
  for (std::size_t i = 0; i < count; ++i) {
    const MovingVectors spoke = fans.spoke(i);
    out.norm = max(out.norm, max(maxNorm(spoke.t0), maxNorm(spoke.t1)));
  }
  for (std::size_t i = 0; i < out.numTriangles(); ++i) {
    const MovingNormals normal = fans.makeNormal(i);
    out.d = out.d + (normal.first + normal.last);
  }
  out.d_norm = maxNorm(out.d);
  return out;
}

/// The fans all of whose triangles face d, and are high enough for a distance.
template <typename Fans>
FCL_CCD_INLINE unsigned areFacing(const FansToProve<Fans>& x, double distance) {
  const Doubles size = x.norm * x.norm * x.d_norm;
  const Doubles turned = broadcast<kEight>(kFanBound) * size;
  DoubleMask facing = isInRange(x.norm * x.norm) & isInRange(size);
  for (std::size_t i = 0; i < x.numTriangles(); ++i) {
    const MovingNormals normal = x.fans.normal(i);
    facing = facing & (dot(normal.first, x.d) > turned) &
             (dot(normal.middle, x.d) > turned) & (dot(normal.last, x.d) > turned);
  }
  if (distance > 0)
    facing = facing & areHigh(x.fans, x.numTriangles(), x.d, x.norm, turned, distance);
  return bits(facing);
}

/// A ray through the middle of the first sector of a closed fan, or away from an open
/// one.
template <typename Fans>
FCL_CCD_INLINE Vectors rayOf(const FansToProve<Fans>& x) {
  if (x.is_closed) {
    const Vectors p = x.fans.spoke(0).t0, q = x.fans.spoke(1).t0;
    const Doubles a = maxNorm(p), b = maxNorm(q);
    return {b * p.x + a * q.x, b * p.y + a * q.y, b * p.z + a * q.z};
  }
  const Doubles zero = broadcast<kEight>(0.);
  Vectors ray = {zero, zero, zero};
  for (std::size_t i = 0; i < x.count; ++i) {
    const MovingVectors spoke = x.fans.spoke(i);
    ray = ray - (spoke.t0 + spoke.t1);
  }
  return ray;
}

/// The closed fans that go round once: exactly one sector contains the ray.
/// @param side  the sides of the ray on which a vector is
template <typename Fans, typename Side>
FCL_CCD_INLINE unsigned goRoundOnce(const FansToProve<Fans>& x, Side&& side) {
  const SideOfRay first = side(x.fans.spoke(0).t0);
  SideOfRay at = first;
  unsigned decided = ~0U, once = 0, again = 0;
  for (std::size_t i = 0; i < x.count; ++i) {
    const SideOfRay next = i + 1 < x.count ? side(x.fans.spoke(i + 1).t0) : first;
    const unsigned within = at.before & next.after;
    decided &= at.before | at.after;
    again |= once & within;
    once |= within;
    at = next;
  }
  return decided & once & ~again;
}

/// The open fans of which no sector ever covers the ray: its first spoke is after the ray
/// all the time, or its last spoke before it.
template <typename Fans, typename Side>
FCL_CCD_INLINE unsigned leaveRayFree(const FansToProve<Fans>& x, Side&& side) {
  unsigned free = ~0U, after = 0;
  for (std::size_t i = 0; i < x.count; ++i) {
    const MovingVectors spoke = x.fans.spoke(i);
    const SideOfRay at0 = side(spoke.t0), at1 = side(spoke.t1);
    if (i > 0) free &= after | (at0.before & at1.before);
    after = at0.after & at1.after;
  }
  return free;
}

template <typename Fans>
FCL_CCD_INLINE unsigned areEmbedded(Fans&& fans, std::size_t count, bool is_closed,
                                    double distance) {
  const auto x = prepare(fans, count, is_closed);
  const unsigned left = areFacing(x, distance);
  if (left == 0) return 0;

  const Vectors ray = rayOf(x);
  const Doubles ray_norm = maxNorm(ray), ray_size = x.norm * ray_norm * x.d_norm;
  const unsigned in_range = bits(isInRange(ray_norm * x.d_norm) & isInRange(ray_size));
  const Doubles bound = broadcast<kEight>(kRayBound) * ray_size,
                minus_bound = broadcast<kEight>(0.) - bound;
  const Vectors across = cross(ray, x.d);
  const auto side = [&](const Vectors& spoke)
                        HWY_ATTR { return sideOfRay(spoke, across, bound, minus_bound); };
  return left & in_range & (is_closed ? goRoundOnce(x, side) : leaveRayFree(x, side));
}

unsigned areFansEmbedded(const TreeVertex* vertices, const EightFans& fans,
                         double distance) {
  assert(fans.count >= (fans.is_closed ? 3U : 2U) && distance >= 0);
  // The ends of an open fan may come near each other through the gap.
  if (distance > 0 && !fans.is_closed) return 0;
  if (fans.count <= VertexFans::kShort)
    return areEmbedded(ShortFans(vertices, fans), fans.count, fans.is_closed, distance);
  return areEmbedded(LongFans(vertices, fans), fans.count, fans.is_closed, distance);
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

// SPDX-License-Identifier: BSD-3-Clause
//
// The directions in which triangles face, the sides that a point sees of them, and how
// high they are.
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/region_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "base/bits.h"
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
FCL_CCD_INLINE Doubles along(const Vectors& a) {
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
FCL_CCD_INLINE std::uint32_t facedAlong(const BoundedNormals& normals) {
  const MovingNormals& n = normals.n;
  const Doubles a = along<kAxis>(n.first), b = along<kAxis>(n.middle),
                c = along<kAxis>(n.last);
  if (!isAnyNegative(smaller(smaller(a, b), c) - normals.bound)) return 1U << kAxis;
  const bool down = !isAnyNegative(normals.minus_bound - larger(larger(a, b), c));
  return std::uint32_t{down} << (kAxis + kNumAxes);
}

template <std::size_t... kAxis>
FCL_CCD_INLINE std::uint32_t facedAlongAll(const BoundedNormals& normals,
                                           std::index_sequence<kAxis...>) {
  return (... | facedAlong<kAxis>(normals));
}

/// Whether no coordinate is a NaN. Infinities of different signs count as one.
FCL_CCD_INLINE bool areNumbers(const Vectors& a) {
  const Doubles sum = a.x + a.y + a.z;
  return bits(sum == sum) == (1U << kEight) - 1;
}

/// The corners of up to eight triangles. The first one fills up the lanes beyond them.
FCL_CCD_INLINE void findCorners(const TreeVertex* vertices, const TreeTriangle* triangles,
                                std::size_t count, const TreeVertex* (&x)[3][kEight]) {
  for (std::size_t i = 0; i < kEight; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k][i] = &vertices[triangles[i < count ? i : 0].place[k]];
}

std::uint32_t facedDirections(const TreeVertex* vertices, const TreeTriangle* triangles,
                              std::size_t count) {
  assert(1 <= count && count <= kEight);
  const TreeVertex* x[3][kEight];
  findCorners(vertices, triangles, count, x);
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

/// The volume of three moving vectors, as Bernstein coefficients in t. The inner ones are
/// times 3.
struct MovingVolumes {
  Doubles outer0, inner0, inner1, outer1;

  FCL_CCD_INLINE MovingVolumes(const MovingVectors& u, const MovingNormals& n)
      : outer0(dot(u.t0, n.first)),
        inner0(dot(u.t1, n.first) + dot(u.t0, n.middle)),
        inner1(dot(u.t1, n.middle) + dot(u.t0, n.last)),
        outer1(dot(u.t1, n.last)) {}
};

/// The signs of the volume of three moving vectors, for eight of them: lanes in which it
/// is certainly positive (negative) during the whole step.
struct VolumeSigns {
  unsigned positive, negative;
};

/// @param size  the product of their norms, in the range of the bounds
FCL_CCD_INLINE VolumeSigns signsOf(const MovingVolumes& volumes, const Doubles& size) {
  const auto& [outer0, inner0, inner1, outer1] = volumes;
  const Doubles outer = broadcast<kEight>(kOuterBound) * size,
                inner = broadcast<kEight>(kInnerBound) * size;
  const Doubles zero = broadcast<kEight>(0.);
  return {bits((outer0 > outer) & (outer1 > outer) & (inner0 > inner) & (inner1 > inner)),
          bits((outer0 < zero - outer) & (outer1 < zero - outer) &
               (inner0 < zero - inner) & (inner1 < zero - inner))};
}

/// The same vector eight times.
FCL_CCD_INLINE Vectors vectorsOf(const double* x) {
  return {broadcast<kEight>(x[0]), broadcast<kEight>(x[1]), broadcast<kEight>(x[2])};
}

/// Sizes with squares in the range of the bounds.
FCL_CCD_INLINE DoubleMask hasSquare(const Doubles& size) {
  return (size >= all(0x1p-400)) & (size <= all(0x1p400));
}

FCL_CCD_INLINE Doubles squareOf(const Vectors& a) { return dot(a, a); }

/// The largest square of a vector during the step.
FCL_CCD_INLINE Doubles largestSquare(const MovingVectors& v) {
  return max(squareOf(v.t0), squareOf(v.t1));
}

/// A bound on the square of a cross product during the step: of its length and two times
/// the rounding. (a + b)^2 is at most (1 + s) a^2 + (1 + 1 / s) b^2, for any s.
/// @param rounding  of a component
FCL_CCD_INLINE Doubles largestSquare(const MovingNormals& n, const Doubles& rounding) {
  constexpr double kShare = 0x1p-34;
  const Doubles most =
      max(max(squareOf(n.first), all(0.25) * squareOf(n.middle)), squareOf(n.last));
  return most * all(kUpward * (1 + kShare)) +
         all(4 * kUpward * (1 + 1 / kShare)) * (rounding * rounding);
}

/// Eight triangles of a surface, as vectors from a point to their corners.
struct Sights {
  MovingVectors u, v, w;
  MovingNormals vw;
  MovingVolumes volumes;

  FCL_CCD_INLINE Sights(const MovingVectors& a, const MovingVectors& b,
                        const MovingVectors& c)
      : u(a), v(b), w(c), vw(cross(b, c)), volumes(a, vw) {}
};

/// The volume of the point and a triangle is that of the vectors to its corners. Divided
/// by the length of the normal it is the distance from the plane. Divided by the length
/// of the cross product of two of the vectors it is the height of the third one over
/// their plane.
/// @param most  a bound on the coordinates of the vectors
FCL_CCD_INLINE void takeLeast(const Sights& x, const Doubles& most, LeastSight& sight) {
  const auto& [u, v, w, vw, volumes] = x;
  const auto& [outer0, inner0, inner1, outer1] = volumes;
  const Doubles size = most * most * most;
  const MovingNormals wu = cross(w, u), uv = cross(u, v);
  const Doubles third = all(1. / 3),
                least =
                    max(min(min(outer0, outer1), third * min(inner0, inner1)),
                        all(0) - max(max(outer0, outer1), third * max(inner0, inner1))) -
                    all(kInnerBound) * size;
  const Doubles volume = select(hasSquare(size), max(least, all(0)), all(0)),
                square = volume * volume;
  // A component of a cross product is off by 20 u of the product of two norms, the middle
  // one by 44 u.
  const Doubles rounding = all(64 * kUnit) * (most * most);
  const MovingNormals normal = {vw.first + wu.first + uv.first,
                                vw.middle + wu.middle + uv.middle,
                                vw.last + wu.last + uv.last};
  const Doubles sines = max(max(largestSquare(u) * largestSquare(vw, rounding),
                                largestSquare(v) * largestSquare(wu, rounding)),
                            largestSquare(w) * largestSquare(uv, rounding));
  const DoubleMask is_known = volume > all(0);
  const auto take = [&is_known](const Doubles& bound, double(&least)[kEight]) HWY_ATTR {
    store(min(load<kEight>(least), select(is_known, bound, all(0))), least);
    assert(*std::min_element(least, least + kEight) >= 0);
  };
  take(square / largestSquare(normal, all(4) * rounding), sight.distance_square);
  take(square / sines, sight.sine_square);
}

template <bool kWithLeast>
FCL_CCD_INLINE EightViews viewFromHere(const TreeVertex& point, const double (&ray)[3],
                                       const TreeVertex* vertices,
                                       const TreeTriangle* triangles, std::size_t count,
                                       LeastSight* least) {
  assert(1 <= count && count <= kEight);
  const TreeVertex* x[3][kEight];
  findCorners(vertices, triangles, count, x);
  const MovingVectors center = {vectorsOf(point.t0), vectorsOf(point.t1)};
  const Sights sights(loadPaths(x[0]) - center, loadPaths(x[1]) - center,
                      loadPaths(x[2]) - center);
  const MovingVectors &u = sights.u, &v = sights.v, &w = sights.w;
  const Doubles u_norm = max(maxNorm(u.t0), maxNorm(u.t1)),
                v_norm = max(maxNorm(v.t0), maxNorm(v.t1)),
                w_norm = max(maxNorm(w.t0), maxNorm(w.t1)),
                most = max(max(u_norm, v_norm), w_norm);
  const Doubles size = u_norm * (v_norm * w_norm);
  const VolumeSigns signs = signsOf(sights.volumes, size);
  const unsigned known =
      bits(isInRange(size) & isInRange(v_norm * w_norm)) & ((1U << count) - 1);
  EightViews views{signs.positive & known, signs.negative & known, 0};
  if (kWithLeast) takeLeast(sights, most, *least);

  // In terms of the corners the ray is a sum whose weights are volumes of the ray and two
  // corners, divided by the volume of all corners. It misses if one of them is negative.
  const Vectors r = vectorsOf(ray);
  const Doubles ray_size = maxNorm(r) * (most * most),
                bound = broadcast<kEight>(kVolumeBound) * ray_size,
                minus_bound = broadcast<kEight>(0.) - bound;
  const Doubles a = dot(r, sights.vw.first), b = dot(r, cross(w.t0, u.t0)),
                c = dot(r, cross(u.t0, v.t0));
  const unsigned below = bits((a < minus_bound) | (b < minus_bound) | (c < minus_bound)),
                 above = bits((a > bound) | (b > bound) | (c > bound));
  views.missed = bits(isInRange(ray_size) & isInRange(most * most)) &
                 ((views.left & below) | (views.right & above));
  assert((views.left & views.right) == 0 && views.left + views.right < 1U << count);
  return views;
}

EightViews viewFrom(const TreeVertex& point, const double (&ray)[3],
                    const TreeVertex* vertices, const TreeTriangle* triangles,
                    std::size_t count, LeastSight* least) {
  return least ? viewFromHere<true>(point, ray, vertices, triangles, count, least)
               : viewFromHere<false>(point, ray, vertices, triangles, count, nullptr);
}

std::uint32_t lowCorners(const TreeVertex* vertices, const MovingKdopNode& node,
                         const int (&direction)[3], double distance) {
  assert(node.triangles != 0 && distance >= 0);
  const TreeVertex* x[3][kEight];
  const auto first = static_cast<std::size_t>(lowestBit(node.triangles));
  for (std::size_t i = 0; i < kEight; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k][i] = &vertices[node.places[k][node.triangles >> i & 1U ? i : first]];
  const MovingVectors a = loadPaths(x[0]), b = loadPaths(x[1]), c = loadPaths(x[2]),
                      v = b - a, w = c - a;
  const MovingNormals n = cross(v, w);
  const double d[3] = {double(direction[0]), double(direction[1]), double(direction[2])};
  const Vectors along = vectorsOf(d);
  const Doubles size =
      max(maxNorm(v.t0), maxNorm(v.t1)) * max(maxNorm(w.t0), maxNorm(w.t1));
  const Doubles area =
      min(min(dot(n.first, along), all(0.5) * dot(n.middle, along)), dot(n.last, along)) -
      all(kFanBound) * size;
  const Doubles square = area * area,
                least = all(distance * distance * kUpward *
                            (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
  const DoubleMask is_seen = hasSquare(size) & (area > all(0));
  const auto lowOver = [&](const MovingVectors& side) HWY_ATTR {
    return node.triangles & ~bits(is_seen & (square > least * largestSquare(side)));
  };
  return lowOver(c - b) | lowOver(w) << 8 | lowOver(v) << 16;
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors of three coordinates, eight side by side.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#include <limits>

#include "kernels/lanes.h"
#include "mesh/tree_nodes.h"
#include "numerics/error_bounds.h"

#if defined(FCL_CCD_VECTORS_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_VECTORS_INCLUDED
#undef FCL_CCD_VECTORS_INCLUDED
#else
#define FCL_CCD_VECTORS_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// roundUp() of eight numbers.
/// @param pad  the pad of roundUp(), with FLT_MIN already added
FCL_CCD_INLINE Floats roundedUp(const Doubles& value, const Floats& pad) {
  const Floats f = narrowed(max(broadcast<kEight>(double{kLeastHalf}), value));
  const Floats up = f + (abs(f) * broadcast<kEight>(kOutward) + pad);
  return select(up == up, up, broadcast<kEight>(std::numeric_limits<float>::infinity()));
}

/// The same number in eight lanes.
FCL_CCD_INLINE Doubles all(double x) { return broadcast<kEight>(x); }

/// Three coordinates of eight vectors.
struct Vectors {
  Doubles x, y, z;
};

FCL_CCD_INLINE Vectors loadVectors(const double (&v)[3][8]) {
  return {load<kEight>(v[0]), load<kEight>(v[1]), load<kEight>(v[2])};
}

FCL_CCD_INLINE Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
FCL_CCD_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
FCL_CCD_INLINE Vectors operator*(const Doubles& s, const Vectors& a) {
  return {s * a.x, s * a.y, s * a.z};
}
FCL_CCD_INLINE Vectors select(const DoubleMask& mask, const Vectors& a,
                              const Vectors& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
FCL_CCD_INLINE Doubles dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
FCL_CCD_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

FCL_CCD_INLINE Doubles maxNorm(const Vectors& a) {
  return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

/// The lanes in which the bounds on errors of this size hold: see kTiny.
FCL_CCD_INLINE DoubleMask isInRange(const Doubles& size) {
  return (size >= broadcast<kEight>(kTiny)) & (size <= broadcast<kEight>(kHuge));
}

/// Vectors at t = 0 and at t = 1.
struct MovingVectors {
  Vectors t0, t1;
};

FCL_CCD_INLINE MovingVectors operator-(const MovingVectors& a, const MovingVectors& b) {
  return {a.t0 - b.t0, a.t1 - b.t1};
}

FCL_CCD_INLINE MovingVectors loadPaths(const TreeVertex* const (&x)[kEight]) {
  MovingVectors p;
  loadColumns([&x](std::size_t lane) HWY_ATTR { return x[lane]->t0; }, p.t0.x, p.t0.y,
              p.t0.z);
  loadColumns([&x](std::size_t lane) HWY_ATTR { return x[lane]->t1; }, p.t1.x, p.t1.y,
              p.t1.z);
  return p;
}

/// The product of a matrix with the same numbers in all lanes and a vector.
FCL_CCD_INLINE Vectors product(const double (&m)[9], const Vectors& v) {
  return {all(m[0]) * v.x + all(m[1]) * v.y + all(m[2]) * v.z,
          all(m[3]) * v.x + all(m[4]) * v.y + all(m[5]) * v.z,
          all(m[6]) * v.x + all(m[7]) * v.y + all(m[8]) * v.z};
}

FCL_CCD_INLINE Vectors allOf(const double (&v)[3]) {
  return {all(v[0]), all(v[1]), all(v[2])};
}

/// Whether (1 - t) g0 + t g1 + 4 t (1 - t) bend is above 0 for all t in [0, 1]: a bend
/// below 0 has to be above minus the square of the mean of the roots of g0 and g1. The
/// factor is more than the rounding of both sides, a few units.
FCL_CCD_INLINE DoubleMask staysAbove(const Doubles& g0, const Doubles& g1,
                                     const Doubles& bend) {
  const Doubles zero = all(0), sum = g0 + g1,
                root = squareRoot(max(g0, zero)) * squareRoot(max(g1, zero));
  return (g0 > zero) & (g1 > zero) & (sum + (root + root) > all(-4 * kUpward) * bend);
}

/// The cross product of two moving vectors, as Bernstein coefficients in t. The middle
/// one is times 2.
struct MovingNormals {
  Vectors first, middle, last;
};

FCL_CCD_INLINE MovingNormals cross(const MovingVectors& v, const MovingVectors& w) {
  return {cross(v.t0, w.t0), cross(v.t0, w.t1) + cross(v.t1, w.t0), cross(v.t1, w.t1)};
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif

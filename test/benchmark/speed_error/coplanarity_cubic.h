// SPDX-License-Identifier: BSD-3-Clause
//
// What the solvers to compare with have in common: the cubic that vanishes when the four
// points of a pair are coplanar, and the inside test, in plain floating point. N is
// double, or CountedNumber where operations are counted.
#ifndef FCL_BENCHMARK_COPLANARITY_CUBIC_H
#define FCL_BENCHMARK_COPLANARITY_CUBIC_H

#include "elementary/elementary.h"

namespace fcl {
namespace test {

template <typename N>
struct Vec {
  N x, y, z;
};

template <typename N>
Vec<N> operator+(const Vec<N>& a, const Vec<N>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename N>
Vec<N> operator-(const Vec<N>& a, const Vec<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename N>
Vec<N> operator*(const N& s, const Vec<N>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <typename N>
N dot(const Vec<N>& a, const Vec<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename N>
Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// @brief A pair (VF p; a, b, c or EE a b; c, d) relative to one of its points: VF u =
/// p-a, v = b-a, w = c-a; EE u = c-a, v = b-a, w = d-c.
template <typename N>
struct RelativePair {
  Vec<N> u0, u1, v0, v1, w0, w1;
  bool is_vertex_face;

  RelativePair(fcl::ContinuousContactKind kind,
               const detail::deformable::FeaturePoints& x)
      : is_vertex_face(kind == fcl::ContinuousContactKind::kVertexFace) {
    const bool vf = is_vertex_face;
    set(vf ? x[0] : x[2], vf ? x[1] : x[0], u0, u1);
    set(vf ? x[2] : x[1], vf ? x[1] : x[0], v0, v1);
    set(x[3], vf ? x[1] : x[2], w0, w1);
  }

 private:
  /// Differences of coordinates are not counted as operations: every method has them.
  static void set(const detail::deformable::VertexPath& p,
                  const detail::deformable::VertexPath& q, Vec<N>& at_0, Vec<N>& at_1) {
    at_0 = {N(p.t0[0] - q.t0[0]), N(p.t0[1] - q.t0[1]), N(p.t0[2] - q.t0[2])};
    at_1 = {N(p.t1[0] - q.t1[0]), N(p.t1[1] - q.t1[1]), N(p.t1[2] - q.t1[2])};
  }
};

/// @brief u . (v x w) over time: b[0] (1-t)^3 + b[1] t (1-t)^2 + b[2] t^2 (1-t) +
/// b[3] t^3, the Bernstein coefficients with the inner ones times 3. With the paper's
/// names they are A, 2C + F, 2D + E, B.
template <typename N>
struct CoplanarityCubic {
  N b[4];

  explicit CoplanarityCubic(const RelativePair<N>& pair) {
    const Vec<N> n0 = cross(pair.v0, pair.w0), n1 = cross(pair.v1, pair.w1);
    const Vec<N> twice_middle = n0 + n1 - cross(pair.v1 - pair.v0, pair.w1 - pair.w0);
    b[0] = dot(pair.u0, n0);
    b[1] = dot(pair.u0, twice_middle) + dot(pair.u1, n0);
    b[2] = dot(pair.u1, twice_middle) + dot(pair.u0, n1);
    b[3] = dot(pair.u1, n1);
  }

  /// @brief The paper's filter: coefficients of one sign, without regard to rounding.
  bool hasOneSign() const {
    const N zero(0);
    return (b[0] > zero && b[1] > zero && b[2] > zero && b[3] > zero) ||
           (b[0] < zero && b[1] < zero && b[2] < zero && b[3] < zero);
  }

  /// @brief Zero throughout: coplanar all the time.
  bool isFlat() const { return !(size() > N(0)); }

  N size() const {
    N sum(0);
    for (const N& c : b) sum = sum + (c < N(0) ? N(0) - c : c);
    return sum;
  }
};

/// @brief c[0] + c[1] t + c[2] t^2 + c[3] t^3.
template <typename N>
struct PowerCubic {
  N c[4];

  explicit PowerCubic(const CoplanarityCubic<N>& f) {
    const N three_b0 = N(3) * f.b[0];
    c[0] = f.b[0];
    c[1] = f.b[1] - three_b0;
    c[2] = three_b0 - (f.b[1] + f.b[1]) + f.b[2];
    c[3] = f.b[3] - f.b[0] + (f.b[1] - f.b[2]);
  }
  N operator()(const N& t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
  N derivative(const N& t) const {
    const N three_c3 = N(3) * c[3];
    return c[1] + t * (c[2] + c[2] + t * three_c3);
  }
};

/// @brief Whether the features touch at time t, given that their points are coplanar
/// then: barycentric (VF) or line (EE) coordinates in [-tol, 1 + tol]. False for a
/// triangle without area and for parallel edges.
template <typename N>
bool areInside(const RelativePair<N>& pair, const N& t, const N& tol) {
  const Vec<N> u = pair.u0 + t * (pair.u1 - pair.u0);
  const Vec<N> v = pair.v0 + t * (pair.v1 - pair.v0);
  const Vec<N> w = pair.w0 + t * (pair.w1 - pair.w0);
  const Vec<N> n = cross(v, w);
  const N area = dot(n, n);
  if (!(area > N(0))) return false;
  const N least = N(0) - tol * area, most = area - least;
  const N along_v = dot(cross(u, w), n);
  if (along_v < least || along_v > most) return false;
  if (pair.is_vertex_face) {
    const N along_w = dot(cross(v, u), n);
    return !(along_w < least) && !(along_v + along_w > most);
  }
  const N along_w = dot(cross(u, v), n);
  return !(along_w < least) && !(along_w > most);
}

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "plain_solvers.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <utility>

#include "coplanarity_cubic.h"
#include "fcl/narrowphase/detail/traversal/collision/intersect.h"
#include "interval_newton.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::FeaturePoints;
using fcl::ContinuousContactKind;

double size(const Vec<double>& a) {
  return std::max(std::max(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

/// Roots of the derivative inside (0, 1), in order.
int turningPoints(const PowerCubic<double>& f, double (&t)[2]) {
  const double a = 3 * f.c[3], half_b = f.c[2], c = f.c[1];
  const double discriminant = half_b * half_b - a * c;
  if (!(discriminant >= 0)) return 0;
  const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
  double first = q / a, second = c / q;  // infinite or NaN where there is none
  if (second < first) std::swap(first, second);
  int count = 0;
  for (const double root : {first, second})
    if (root > 0 && root < 1) t[count++] = root;
  return count;
}

/// The root in [lo, hi], at whose ends f has opposite signs and between which it is
/// monotone: Newton, bisection where that leaves the bracket.
double bracketedRoot(const PowerCubic<double>& f, double lo, double hi) {
  const bool rises = f(lo) < 0;
  double t = 0.5 * (lo + hi);
  for (int i = 0; i < 64; ++i) {
    const double value = f(t);
    if (value == 0) return t;
    ((value < 0) == rises ? lo : hi) = t;
    double next = t - value / f.derivative(t);
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (std::abs(next - t) <= DBL_EPSILON * next) return next;
    t = next;
  }
  return t;
}

Vector3<double> at0(const detail::deformable::VertexPath& p) {
  return {p.t0[0], p.t0[1], p.t0[2]};
}
Vector3<double> at1(const detail::deformable::VertexPath& p) {
  return {p.t1[0], p.t1[1], p.t1[2]};
}

}  // namespace

bool passesPlainFilter(ContinuousContactKind kind, const FeaturePoints& x) {
  return !CoplanarityCubic<double>(RelativePair<double>(kind, x)).hasOneSign();
}

SolverAnswer solveCubic(ContinuousContactKind kind, const FeaturePoints& x,
                        double inside_tol) {
  const RelativePair<double> pair(kind, x);
  const CoplanarityCubic<double> cubic(pair);
  const PowerCubic<double> f(cubic);
  // About the rounding of a value, by the vectors that it is made of: relative to the
  // coefficients alone, contacts of bodies at rest are lost, whose coefficients are
  // nothing but rounding.
  const double zero_tol = 8 * DBL_EPSILON * (size(pair.u0) + size(pair.u1)) *
                          (size(pair.v0) + size(pair.v1)) *
                          (size(pair.w0) + size(pair.w1));
  double t[4] = {0};
  double turns[2];
  int ends = 1;
  for (int i = 0, count = turningPoints(f, turns); i < count; ++i) t[ends++] = turns[i];
  t[ends++] = 1;
  double before = f(t[0]);
  for (int i = 0; i < ends; ++i) {
    if (std::abs(before) <= zero_tol && areInside(pair, t[i], inside_tol))
      return {true, t[i]};
    if (i + 1 == ends) break;
    const double after = f(t[i + 1]);
    if ((before < 0) != (after < 0)) {
      const double root = bracketedRoot(f, t[i], t[i + 1]);
      if (areInside(pair, root, inside_tol)) return {true, root};
    }
    before = after;
  }
  return {false, 0};
}

SolverAnswer solveByIntervalNewton(ContinuousContactKind kind, const FeaturePoints& x,
                                   double resolution, bool filter) {
  const RelativePair<double> pair(kind, x);
  const CoplanarityCubic<double> cubic(pair);
  if (filter && cubic.hasOneSign()) return {false, 0};
  const double toc = firstTimeByIntervalNewton(pair, cubic, resolution, resolution);
  return {toc >= 0, toc};
}

SolverAnswer solveByFcl(ContinuousContactKind kind, const FeaturePoints& x) {
  using Fcl = detail::Intersect<double>;
  SolverAnswer answer{};
  Vector3<double> position;
  answer.contact =
      kind == ContinuousContactKind::kVertexFace
          ? Fcl::intersect_VF(at0(x[1]), at0(x[2]), at0(x[3]), at0(x[0]), at1(x[1]),
                              at1(x[2]), at1(x[3]), at1(x[0]), &answer.toc, &position)
          : Fcl::intersect_EE(at0(x[0]), at0(x[1]), at0(x[2]), at0(x[3]), at1(x[0]),
                              at1(x[1]), at1(x[2]), at1(x[3]), &answer.toc, &position);
  return answer;
}

}  // namespace test
}  // namespace fcl

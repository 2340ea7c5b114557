// SPDX-License-Identifier: BSD-3-Clause
//
// After Gilbert, Johnson, Keerthi 1988. The nearest point of a simplex is found by trying
// all of its faces, which is slow and has no special cases.
#include "convex_piece.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

#include "real_distance.h"

namespace fcl {
namespace test {
namespace {

const Real kInfinity = std::numeric_limits<Real>::infinity();

RealVector localSupport(const ConvexPiece& piece, const RealVector& d, Real t) {
  using Kind = ConvexPiece::Kind;
  if (piece.kind == Kind::kEllipsoid) {
    const RealVector scaled = piece.size.cwiseProduct(d);
    const Real length = scaled.norm();
    return length > 0 ? RealVector(piece.size.cwiseProduct(scaled) / length)
                      : RealVector(RealVector::Zero());
  }
  if (piece.kind == Kind::kCone || piece.kind == Kind::kCylinder) {
    const Real across = sqrt(Real(d[0] * d[0] + d[1] * d[1]));
    RealVector rim(0, 0, -piece.size[1]);
    if (across > 0) rim.head<2>() = piece.size[0] * d.head<2>() / across;
    if (piece.kind == Kind::kCylinder) {
      if (d[2] > 0) rim[2] = piece.size[1];
      return rim;
    }
    const RealVector tip(0, 0, piece.size[1]);
    return tip.dot(d) > rim.dot(d) ? tip : rim;
  }
  RealVector best = RealVector::Zero();
  Real most = -kInfinity;
  for (std::size_t i = 0; i < piece.t0.size(); ++i) {
    const RealVector p = (1 - t) * piece.t0[i] + t * piece.t1[i];
    if (p.dot(d) <= most) continue;
    most = p.dot(d);
    best = p;
  }
  return best;
}

/// A simplex of points of the difference of two cores.
struct Simplex {
  std::array<RealVector, 4> point;
  int count{0};

  bool has(const RealVector& p) const {
    return std::any_of(point.begin(), point.begin() + count,
                       [&p](const RealVector& q) { return q == p; });
  }
};

/// The weights of sides a, b, c (as many as there are) with which a point comes nearest
/// to the origin from p. Any weights give a point of the plane: rounding is no fault.
bool solveWeights(int n, const RealVector& p, const RealVector (&side)[3],
                  Real (&weight)[3]) {
  const RealVector &a = side[0], &b = side[1], &c = side[2];
  if (n == 3) {
    const Real volume = a.dot(b.cross(c));
    weight[0] = -p.dot(b.cross(c)) / volume;
    weight[1] = -p.dot(c.cross(a)) / volume;
    weight[2] = -p.dot(a.cross(b)) / volume;
    return volume != 0;
  }
  const Real aa = a.dot(a), x = -a.dot(p);
  if (n == 1) {
    weight[0] = x / aa;
    return aa > 0;
  }
  const Real ab = a.dot(b), bb = b.dot(b), y = -b.dot(p), area = aa * bb - ab * ab;
  weight[0] = (x * bb - y * ab) / area;
  weight[1] = (y * aa - x * ab) / area;
  return area > 0;
}

/// The nearest point to the origin of the plane through some points, if it lies in their
/// hull.
bool nearestOfFace(const Simplex& s, unsigned mask, RealVector& nearest) {
  std::array<std::size_t, 4> id{};
  int n = 0;
  for (unsigned i = 0; i < static_cast<unsigned>(s.count); ++i)
    if (mask >> i & 1U) id[static_cast<std::size_t>(n++)] = i;
  const RealVector p = s.point[id[0]];
  nearest = p;
  if (n == 1) return true;
  RealVector side[3];
  for (int i = 1; i < n; ++i) side[i - 1] = s.point[id[static_cast<std::size_t>(i)]] - p;
  Real weight[3], rest = 1;
  if (!solveWeights(n - 1, p, side, weight)) return false;
  for (int i = 0; i < n - 1; ++i) {
    if (!(weight[i] >= 0)) return false;
    rest -= weight[i];
    nearest += weight[i] * side[i];
  }
  return rest >= 0;
}

/// Reduces a simplex to the face that has its nearest point.
RealVector reduce(Simplex& s) {
  Real least = kInfinity;
  unsigned best = 1;
  RealVector nearest = s.point[0];
  for (unsigned mask = 1; mask < 1U << s.count; ++mask) {
    RealVector p;
    if (!nearestOfFace(s, mask, p) || !(p.norm() < least)) continue;
    least = p.norm();
    best = mask;
    nearest = p;
  }
  Simplex face;
  for (int i = 0; i < s.count; ++i)
    if (best >> i & 1U)
      face.point[static_cast<std::size_t>(face.count++)] =
          s.point[static_cast<std::size_t>(i)];
  s = face;
  return nearest;
}

GapBounds coreBounds(const PosedPiece& a, const PosedPiece& b) {
  constexpr int kMostSteps = 60;
  const auto differenceAt = [&](const RealVector& d) -> RealVector {
    return a.support(d) - b.support(-d);
  };
  Simplex simplex;
  RealVector v = differenceAt(b.translation - a.translation + RealVector(1e-3L, 0, 0));
  simplex.point[0] = v;
  simplex.count = 1;
  Real lower = 0;
  const Real size = std::max<Real>(v.norm(), 1);
  for (int step = 0; step < kMostSteps; ++step) {
    const Real length = v.norm();
    if (length < 1e-17L * size) {
      // Inside of a tetrahedron they overlap; on a face they touch.
      return {0, simplex.count == 4 ? 0 : length};
    }
    const RealVector p = differenceAt(-v);
    lower = std::max<Real>(lower, v.dot(p) / length);
    if (length - lower < 1e-16L * size || simplex.has(p)) return {lower, length};
    simplex.point[static_cast<std::size_t>(simplex.count++)] = p;
    v = reduce(simplex);
    if (simplex.count == 4) return {0, 0};
  }
  return {lower, v.norm()};
}

/// Of a flat and a bounded piece.
GapBounds flatBounds(const PosedPiece& flat, const PosedPiece& other) {
  const RealVector n = flat.rotation * flat.piece->normal;
  const Real length = n.norm(),
             offset = flat.piece->offset * length + n.dot(flat.translation),
             r = other.piece->radius,
             lowest = (n.dot(other.support(-n)) - offset) / length - r,
             highest = (n.dot(other.support(n)) - offset) / length + r;
  Real gap = std::max<Real>(lowest, 0);
  if (flat.piece->kind == ConvexPiece::Kind::kPlane) gap = std::max<Real>(gap, -highest);
  return {gap, gap};
}

bool isTriangle(const ConvexPiece& piece) {
  return piece.t0.size() == 3 && piece.radius == 0;
}

void cornersOf(const PosedPiece& posed, RealVector (&out)[3]) {
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = posed.rotation *
                 ((1 - posed.t) * posed.piece->t0[k] + posed.t * posed.piece->t1[k]) +
             posed.translation;
}

/// Whether an edge of one triangle passes through the inside of the other.
bool passThrough(const RealVector (&a)[3], const RealVector (&b)[3]) {
  const RealVector n = (b[1] - b[0]).cross(b[2] - b[0]);
  for (int k = 0; k < 3; ++k) {
    const RealVector &p = a[k], &q = a[(k + 1) % 3];
    const Real from = n.dot(p - b[0]), to = n.dot(q - b[0]);
    if ((from > 0) == (to > 0)) continue;
    const RealVector at = p + from / (from - to) * (q - p);
    if (n.dot((b[1] - b[0]).cross(at - b[0])) > 0 &&
        n.dot((b[2] - b[1]).cross(at - b[1])) > 0 &&
        n.dot((b[0] - b[2]).cross(at - b[2])) > 0)
      return true;
  }
  return false;
}

GapBounds triangleBounds(const PosedPiece& a, const PosedPiece& b) {
  RealVector x[3], y[3];
  cornersOf(a, x);
  cornersOf(b, y);
  if (passThrough(x, y) || passThrough(y, x)) return {0, 0};
  Real least = kInfinity;
  for (int i = 0; i < 3; ++i) {
    least = std::min({least, pointToTriangle(x[i], y[0], y[1], y[2]),
                      pointToTriangle(y[i], x[0], x[1], x[2])});
    for (int k = 0; k < 3; ++k)
      least =
          std::min(least, segmentToSegment(x[i], x[(i + 1) % 3], y[k], y[(k + 1) % 3]));
  }
  return {least, least};
}

}  // namespace

Real ConvexPiece::reach() const {
  if (isFlat()) return abs(offset);
  Real most = kind == Kind::kPoints ? Real{0} : size.norm();
  for (const auto* points : {&t0, &t1})
    for (const RealVector& p : *points) most = std::max<Real>(most, p.norm());
  return most + radius;
}

RealVector PosedPiece::support(const RealVector& direction) const {
  return rotation * localSupport(*piece, rotation.transpose() * direction, t) +
         translation;
}

GapBounds gapBounds(const PosedPiece& a, const PosedPiece& b) {
  if (a.piece->isFlat()) return flatBounds(a, b);
  if (b.piece->isFlat()) return flatBounds(b, a);
  if (isTriangle(*a.piece) && isTriangle(*b.piece)) return triangleBounds(a, b);
  GapBounds bounds = coreBounds(a, b);
  const Real radii = a.piece->radius + b.piece->radius;
  bounds.lower = std::max<Real>(bounds.lower - radii, 0);
  bounds.upper = std::max<Real>(bounds.upper - radii, 0);
  return bounds;
}

namespace {

/// A time in contact, halved towards one that is not.
Real firstBetween(const GapAt& gap, Real apart, Real meets, Real distance) {
  for (int i = 0; i < 50; ++i) {
    const Real middle = (apart + meets) / 2;
    (gap(middle).upper <= distance ? meets : apart) = middle;
  }
  return meets;
}

/// The least distance of a span, by golden sections.
void refine(const GapAt& gap, Real lo, Real hi, Sampled& out) {
  const Real golden = (sqrt(Real{5}) - 1) / 2;
  Real x = hi - golden * (hi - lo), y = lo + golden * (hi - lo);
  Real at_x = gap(x).upper, at_y = gap(y).upper;
  for (int i = 0; i < 40; ++i) {
    if (at_x < at_y) {
      hi = y, y = x, at_y = at_x;
      at_x = gap(x = hi - golden * (hi - lo)).upper;
    } else {
      lo = x, x = y, at_x = at_y;
      at_y = gap(y = lo + golden * (hi - lo)).upper;
    }
  }
  const Real least = std::min(at_x, at_y);
  if (least >= out.least) return;
  out.least = least;
  out.least_at = at_x < at_y ? x : y;
}

}  // namespace

Sampled sampleStep(const GapAt& gap, Real speed, Real distance) {
  constexpr int kSamples = 128;
  Sampled out;
  out.least = kInfinity;
  out.least_at = 0;
  // The last two samples.
  Real t[2] = {0, 0}, upper[2] = {kInfinity, kInfinity};
  for (Real now = 0;;) {
    const GapBounds bounds = gap(now);
    if (bounds.upper < out.least) {
      out.least = bounds.upper;
      out.least_at = now;
    }
    if (bounds.upper <= distance) {
      out.first = now > 0 ? firstBetween(gap, t[1], now, distance) : Real{0};
      return out;
    }
    // Lower than before and after: the least distance may be between two samples.
    if (upper[1] <= upper[0] && upper[1] <= bounds.upper && now > t[0]) {
      refine(gap, t[0], now, out);
      if (out.least <= distance) {
        out.first = firstBetween(gap, t[0], out.least_at, distance);
        return out;
      }
    }
    if (now >= 1) return out;
    t[0] = t[1], upper[0] = upper[1];
    t[1] = now, upper[1] = bounds.upper;
    const Real far = (bounds.lower - distance) / std::max<Real>(speed, 1e-9L);
    now = std::min<Real>(1, now + std::max<Real>(far, Real{1} / kSamples));
  }
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "motion_references.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "fcl/narrowphase/distance.h"
#include "real_distance.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;
using Kind = ReferenceMotion::Kind;

/// No contact.
constexpr double kNever = 2;
constexpr double kTocErr = 1e-4;
const Real kInfinity = std::numeric_limits<Real>::infinity();

/// The distance of a point from the inside of a triangle; infinite beside it.
Real pointToInside(const RealVector& p, const RealVector (&f)[3]) {
  const RealVector n = (f[1] - f[0]).cross(f[2] - f[0]);
  for (int k = 0; k < 3; ++k)
    if (n.dot((f[(k + 1) % 3] - f[k]).cross(p - f[k])) < 0) return kInfinity;
  return n.norm() > 0 ? abs(n.dot(p - f[0])) / n.norm() : kInfinity;
}

/// Bound on the velocity of points within `reach` of the origin of the body.
double speedBound(const ReferenceMotion& motion, double reach) {
  constexpr double kUpward = 1 + 1e-9;
  if (motion.kind == Kind::kSpline) {
    double turn = 0, way = 0;
    for (int i = 0; i < 3; ++i) {
      turn = std::max(turn,
                      (motion.rotation_points[i + 1] - motion.rotation_points[i]).norm());
      way = std::max(
          way, (motion.translation_points[i + 1] - motion.translation_points[i]).norm());
    }
    return kUpward * (way + turn * reach);
  }
  const double w = motion.angle;
  if (motion.kind == Kind::kInterpolation) {
    const double way =
        (motion.end * motion.reference - motion.beginning * motion.reference).norm();
    return kUpward * (way + w * (reach + motion.reference.norm()));
  }
  // A screw: a point goes along an arc around the axis, whose chord is the way across.
  const Vector3<double> way = motion.end.translation() - motion.beginning.translation();
  const double slide = motion.axis.dot(way), across = (way - slide * motion.axis).norm(),
               arc = w > 0 ? across * w / (2 * std::sin(w / 2)) : across;
  return kUpward * (std::abs(slide) + arc + w * reach) + 1e-12;
}

double reachOf(const Body& body) {
  double reach = 0;
  for (const auto& p : body.mesh.vertices) reach = std::max(reach, p.norm());
  return reach;
}

/// Text of a case that fails.
template <typename... Parts>
std::string complaint(const Parts&... parts) {
  std::ostringstream out;
  out.precision(17);
  (out << ... << parts);
  return out.str();
}

Vec toVec(const Vector3<double>& x) { return {x[0], x[1], x[2]}; }

Vector3<double> applied(const Pose& pose, const Vector3<double>& x) {
  Vector3<double> out;
  for (int k = 0; k < 3; ++k)
    out[k] = pose.rotation[3 * k] * x[0] + pose.rotation[3 * k + 1] * x[1] +
             pose.rotation[3 * k + 2] * x[2] + pose.translation[k];
  return out;
}

ReferenceMotion motionOfKind(Random& random, Kind kind) {
  ReferenceMotion motion;
  do motion = randomMotion(random, 1);
  while (motion.kind != kind);
  return motion;
}

}  // namespace

Real triangleDistance(const RealVector (&a)[3], const RealVector (&b)[3]) {
  Real least = kInfinity;
  for (int i = 0; i < 3; ++i) {
    least = std::min({least, pointToInside(a[i], b), pointToInside(b[i], a)});
    for (int j = 0; j < 3; ++j)
      least =
          std::min(least, segmentToSegment(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return least;
}

bool doTrianglesCross(const RealVector (&a)[3], const RealVector (&b)[3]) {
  const auto passes = [](const RealVector& p, const RealVector& q,
                         const RealVector(&f)[3]) {
    const RealVector n = (f[1] - f[0]).cross(f[2] - f[0]);
    const Real from = n.dot(p - f[0]), to = n.dot(q - f[0]);
    if ((from > 0) == (to > 0)) return false;
    const RealVector at = p + (from / (from - to)) * (q - p);
    return pointToInside(at, f) < kInfinity;
  };
  for (int k = 0; k < 3; ++k)
    if (passes(a[k], a[(k + 1) % 3], b) || passes(b[k], b[(k + 1) % 3], a)) return true;
  return false;
}

double provedApart(const Body& a, const ReferenceMotion& motion_a, const Body& b,
                   const ReferenceMotion& motion_b, double near) {
  const double speed =
      speedBound(motion_a, reachOf(a)) + speedBound(motion_b, reachOf(b));
  double t = 0;
  while (t <= 1) {
    DistanceResult<double> result;
    const double gap =
        distance(a.model.get(), asTransform(motion_a.at(t)), b.model.get(),
                 asTransform(motion_b.at(t)), DistanceRequest<double>(), result);
    if (gap <= near) return t;
    // FCL's distance has a far smaller error than a quarter of `near`.
    t += (gap - 0.25 * near) / std::max(speed, 1e-300);
  }
  return kNever;
}

std::string spanDisagreement(std::uint64_t number, MotionTally& tally) {
  Random random(number ^ 0x2545f491);
  const int kind = static_cast<int>(number % 3);
  const MotionPath path = motionOfKind(random, static_cast<Kind>(kind)).path();
  const double t0 = random.uniform(0, 0.9),
               t1 = t0 + (1 - t0) * std::exp2(-random.uniform(0, 8)), dt = t1 - t0,
               s = random.uniform(0.05, 0.95);
  const AccelerationBound bound = path.acceleration(t0, t1);
  const Vector3<double> center = random.point(1);
  const double radius = random.uniform(0, 0.5);
  const Vector3<double> x = center + radius * randomDirection(random),
                        to = x + random.point(0.5);
  const double moving = std::max(bound.of(toVec(x), 0), bound.of(toVec(to), 0)) +
                        bound.per_displacement * (to - x).norm();
  const struct {
    Vector3<double> to;
    double most;
  } points[2] = {{x, bound.of(toVec(center), radius)}, {to, moving}};
  ++tally.cases;
  for (int i = 0; i < 2; ++i) {
    const auto at = [&](double t) {
      return applied(path.pose(t), Vector3<double>((1 - t) * x + t * points[i].to));
    };
    const Vector3<double> off = (1 - s) * at(t0) + s * at(t1) - at(t0 + s * dt);
    // A point is at most M s (1 - s) dt^2 / 2 from the straight line.
    const double ratio = (off.norm() - 8 * path.positionError(2)) /
                         (0.5 * points[i].most * s * (1 - s) * dt * dt + 1e-300);
    tally.worst_bound[kind][i] = std::max(tally.worst_bound[kind][i], ratio);
    if (!(ratio <= 1))
      return complaint("kind ", kind, i ? ", deforming" : ", rigid", ", [", t0, ", ", t1,
                       "]: deviation ", ratio, " times the bound");
  }
  return {};
}

namespace {

/// A vector under a rotation by v about an axis: still + across cos(v) + beside sin(v).
struct Turned {
  Turned(const RealVector& axis, const RealVector& from)
      : still(axis * axis.dot(from)), across(from - still), beside(axis.cross(from)) {}
  RealVector at(Real angle) const {
    return still + cos(angle) * across + sin(angle) * beside;
  }
  RealVector still, across, beside;
};

/// A function A + B cos(v) + C sin(v).
struct Harmonic {
  Real a{0}, b{0}, c{0};
  void add(const RealVector& weight, const Turned& x) {
    a += weight.dot(x.still);
    b += weight.dot(x.across);
    c += weight.dot(x.beside);
  }
  /// Calls visit(v) for the roots in [0, most], most < pi: (A - B) u^2 + 2 C u + (A + B)
  /// = 0 for u = tan(v / 2).
  template <typename Visit>
  void forEachRoot(Real most, Visit&& visit) const {
    const Real square = a - b, root = c * c - (a - b) * (a + b);
    if (root < 0) return;
    const Real q = -(c + copysign(sqrt(root), c));
    for (const Real& u : {q / square, (a + b) / q}) {
      const Real v = 2 * atan(u);
      if (v >= 0 && v <= most) visit(v);
    }
  }
};

/// A triangle that turns about an axis through the origin, and one that rests.
struct TurningPair {
  RealVector axis;
  Real angle;
  RealVector turning[3], resting[3];

  void turnedTo(Real v, RealVector (&out)[3]) const {
    for (int k = 0; k < 3; ++k) out[k] = Turned(axis, turning[k]).at(v);
  }

  /// The first angle at which the triangles touch; infinite if they do not.
  Real firstContact() const {
    Real first = kInfinity;
    const auto vertexFace = [&](const RealVector& p, const RealVector(&f)[3],
                                const RealVector& about) {
      Harmonic volume;
      const RealVector n = (f[1] - f[0]).cross(f[2] - f[0]);
      volume.a = -n.dot(f[0]);
      const Turned x(about, p);
      volume.add(n, x);
      volume.forEachRoot(angle, [&](Real v) {
        if (pointToInside(x.at(v), f) < kInfinity) first = std::min(first, v);
      });
    };
    for (int k = 0; k < 3; ++k) {
      vertexFace(turning[k], resting, axis);
      // Seen from the triangle that turns, the other one turns back.
      vertexFace(resting[k], turning, -axis);
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        // f . ((r - R p) x R e) with the edges p + s e and r + t f.
        const RealVector p = turning[i], e = turning[(i + 1) % 3] - p, r = resting[j],
                         f = resting[(j + 1) % 3] - r;
        Harmonic volume;
        volume.add(f.cross(r), Turned(axis, e));
        volume.add(f, Turned(axis, e.cross(p)));
        volume.forEachRoot(angle, [&](Real v) {
          const RealVector q = Turned(axis, p).at(v), u = Turned(axis, e).at(v),
                           w = r - q, n = u.cross(f);
          const Real square = n.squaredNorm(), x = w.cross(f).dot(n) / square,
                     y = w.cross(u).dot(n) / square;
          if (x >= 0 && x <= 1 && y >= 0 && y <= 1) first = std::min(first, v);
        });
      }
    return first;
  }
};

TestMesh meshOf(const RealVector (&corner)[3]) {
  TestMesh mesh;
  for (const auto& p : corner) mesh.vertices.push_back(p.cast<double>());
  mesh.triangles = {Triangle(0, 1, 2)};
  return mesh;
}

/// Puts the resting triangle at right angles to a direction, where the turning one
/// reaches it, deeper or less far by 1e-2 to 1e-6.
void graze(Random& random, TurningPair& pair) {
  RealVector toward = randomDirection(random).cast<Real>();
  if (random.index(2)) toward = pair.axis.cross(toward).normalized();
  Real reach = -kInfinity;
  for (const auto& corner : pair.turning) {
    const Turned x(pair.axis, corner);
    const Real across = toward.dot(x.across), beside = toward.dot(x.beside),
               peak = atan2(beside, across);
    for (const Real& v : {Real{0}, pair.angle, peak})
      if (v >= 0 && v <= pair.angle) reach = std::max(reach, toward.dot(x.at(v)));
  }
  const Real depth =
      (random.index(2) ? 1 : -1) * pow(Real{10}, -static_cast<Real>(2 + random.index(5)));
  const RealVector side = toward.unitOrthogonal(), other = toward.cross(side),
                   center = (reach - depth) * toward;
  const RealVector corners[3] = {center - 9 * side - 9 * other, center + 18 * side,
                                 center - 9 * side + 18 * other};
  // The reference is about the rounded corners.
  for (int k = 0; k < 3; ++k) pair.resting[k] = corners[k].cast<double>().cast<Real>();
}

}  // namespace

std::string turnDisagreement(std::uint64_t number, MotionTally& tally) {
  Random random(number ^ 0x9d2c5680);
  constexpr double kAngles[] = {1e-10, 1e-5, 0.1, 1, 2, 2.967};
  ReferenceMotion motion;
  motion.kind = number % 3 ? Kind::kInterpolation : Kind::kScrew;
  motion.turn(randomDirection(random), kAngles[random.index(6)]);
  TurningPair pair{motion.axis.cast<Real>().normalized(), motion.angle, {}, {}};
  for (auto* side : {&pair.turning, &pair.resting}) {
    const Vector3<double> center = random.point(1);
    for (auto& p : *side) p = (center + random.point(0.6)).cast<Real>();
  }
  const bool grazes = number % 2;
  if (grazes) graze(random, pair);
  const Body a(meshOf(pair.turning)), b(meshOf(pair.resting));
  const bool swapped = random.index(2);
  const CurvedAnswer answer = swapped
                                  ? ask(b, MotionPath::still(Pose()), a, motion.path())
                                  : ask(a, motion.path(), b, MotionPath::still(Pose()));
  const double toc = timeOf(answer);
  const Real first = pair.firstContact() / pair.angle;
  ++tally.cases;
  tally.grazes += grazes;
  tally.contacts += toc <= 1;
  tally.sampled += first <= 1;
  // Triangles that cross at the beginning may touch again later.
  if (first <= 1 && toc > first * (1 + Real{1e-15L}) + 1e-15L / pair.angle)
    return complaint("late: ", toc, " instead of ", static_cast<double>(first));
  if (toc <= 1) {
    RealVector then[3];
    pair.turnedTo(pair.angle * toc, then);
    const Real gap = triangleDistance(then, pair.resting);
    const bool cross = toc == 0 && doTrianglesCross(then, pair.resting);
    tally.crossings += cross;
    if (gap > answer.touching && !cross)
      return complaint("false: at ", toc, " they are ", static_cast<double>(gap),
                       " apart");
  }
  return {};
}

namespace {

/// Corners of a triangle at a time, by the formula of the motion.
void cornersAt(const Body& body, const ReferenceMotion& motion, std::int32_t triangle,
               double t, RealVector (&out)[3]) {
  const Triangle& ids = body.mesh.triangles[static_cast<std::size_t>(triangle)];
  for (int k = 0; k < 3; ++k) out[k] = motion.at(t) * body.mesh.vertices[ids[k]];
}

/// The same motion with a rigid motion on top. Not for splines, whose rotation vectors
/// would turn on another path.
ReferenceMotion onTop(const Transform3<double>& top, ReferenceMotion motion) {
  motion.beginning = top * motion.beginning;
  motion.end = top * motion.end;
  motion.axis = top.linear() * motion.axis;
  return motion;
}

/// Asks the same in other forms.
/// @return what is wrong; empty if nothing
std::string otherForms(Random& random, const Body& a, const ReferenceMotion& motion_a,
                       const Body& b, const ReferenceMotion& motion_b, double toc) {
  const auto timeFor = [&](const ReferenceMotion& x, const ReferenceMotion& y) {
    return timeOf(ask(a, x.path(), b, y.path()));
  };
  const double swapped = timeOf(ask(b, motion_b.path(), a, motion_a.path()));
  if (!(std::abs(swapped - toc) <= 1e-6))
    return complaint("swapped: ", swapped, " instead of ", toc);
  if (motion_a.kind != Kind::kSpline && motion_b.kind != Kind::kSpline) {
    Transform3<double> top = Transform3<double>::Identity();
    top.linear() = randomRotation(random);
    top.translation() = random.point(3);
    const double moved = timeFor(onTop(top, motion_a), onTop(top, motion_b));
    if (!(std::abs(moved - toc) <= 1e-6))
      return complaint("with a rigid motion on top: ", moved, " instead of ", toc);
  }
  const double back = timeFor(motion_a.reversed(), motion_b.reversed());
  if ((back <= 1) != (toc <= 1)) return complaint("reversed: ", back, ", forward ", toc);
  // The last contact is not before the first one.
  if (toc <= 1 && !(toc <= 1 - back + 1e-9))
    return complaint("reversed: ", back, ", forward ", toc);
  const Vector3<double> origin(1e6, -3e5, 7e5);
  ReferenceMotion x = motion_a, y = motion_b;
  for (auto* motion : {&x, &y}) motion->move(origin);
  const double there = timeFor(x, y);
  // Rounded as at the far place, so that both places have the same motion.
  for (auto* motion : {&x, &y}) motion->move(-origin);
  const double here = timeFor(x, y);
  if (!(std::abs(there - here) <= 1e-6))
    return complaint("far away: ", there, " instead of ", here);
  return {};
}

}  // namespace

std::string meshDisagreement(const std::vector<Body>& bodies, std::uint64_t number,
                             int samples, MotionTally& tally) {
  constexpr double kNear = 1e-6;
  Random random(number ^ 0xefc60000);
  const Body &a = bodies[random.index(bodies.size())],
             &b = bodies[random.index(bodies.size())];
  const ReferenceMotion motion_a = randomMotion(random, 1);
  ReferenceMotion motion_b = randomMotion(random, 1);
  const bool grazes = number % 2;
  if (grazes) makeGrazing(random, a, motion_a, b, motion_b);
  const CurvedAnswer answer = ask(a, motion_a.path(), b, motion_b.path());
  const double toc = timeOf(answer);
  const double apart = provedApart(a, motion_a, b, motion_b, kNear),
               sampled = sampledTime(a, motion_a, b, motion_b, samples);
  ++tally.cases;
  tally.grazes += grazes;
  tally.contacts += toc <= 1;
  tally.sampled += sampled <= 1;
  tally.advanced += apart <= 1;
  if (toc > sampled + 1e-9)
    return complaint(toc > 1 ? "missed: " : "late: ", toc, ", samples find ", sampled);
  if (toc < apart)
    return complaint(apart > 1 ? "false: " : "early: ", toc, ", apart until ", apart);
  if (toc <= 1) {
    const CurvedContact& contact = answer.contacts[0];
    if (contact.certainty == ContactCertainty::kGivenUp)
      return complaint("given up: ", toc);
    if (!(contact.toc_hi - contact.toc_lo <= kTocErr))
      return complaint("bracket of ", contact.toc_hi - contact.toc_lo);
    RealVector x[2][3];
    cornersAt(a, motion_a, contact.triangle[0], toc, x[0]);
    cornersAt(b, motion_b, contact.triangle[1], toc, x[1]);
    const Real gap = triangleDistance(x[0], x[1]);
    const bool cross = toc == 0 && doTrianglesCross(x[0], x[1]);
    tally.crossings += cross;
    if (gap > answer.touching && !cross)
      return complaint("false: at ", toc, " they are ", static_cast<double>(gap),
                       " apart");
  }
  return otherForms(random, a, motion_a, b, motion_b, toc);
}

}  // namespace test
}  // namespace fcl

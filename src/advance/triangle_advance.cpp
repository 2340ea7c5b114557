// SPDX-License-Identifier: BSD-3-Clause
#include "advance/triangle_advance.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "advance/advancement.h"
#include "elementary/predicates.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

Vec edge(const Vec (&x)[3], int k) { return x[(k + 1) % 3] - x[k]; }
Vec normal(const Vec (&x)[3]) { return cross(x[1] - x[0], x[2] - x[0]); }

double clampedUnit(double x) { return x > 0 ? (x < 1 ? x : 1) : 0; }

/// The nearest points of an edge pq and an edge rs, as fractions of the edges. An edge
/// may be a point.
void nearestOnEdges(const Vec& p, const Vec& u, const Vec& r, const Vec& v, double& s,
                    double& t) {
  const Vec w = p - r;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w),
               vw = dot(v, w);
  if (!(vv > 0)) {
    t = 0;
    s = uu > 0 ? clampedUnit(-uw / uu) : 0;
    return;
  }
  const double area = uu * vv - uv * uv;
  s = area > 0 ? clampedUnit((uv * vw - uw * vv) / area) : 0;
  t = (uv * s + vw) / vv;
  if (t < 0 || t > 1) {
    t = clampedUnit(t);
    s = uu > 0 ? clampedUnit((uv * t - uw) / uu) : 0;
  }
  assert(!(s < 0 || s > 1) && !(t < 0 || t > 1));
}

/// A vertex against the inside of a face.
bool nearestOnFace(const Vec& p, const Vec (&f)[3], Vec& foot) {
  const Vec n = cross(f[1] - f[0], f[2] - f[0]);
  for (int k = 0; k < 3; ++k)
    if (!(dot(cross(f[(k + 1) % 3] - f[k], p - f[k]), n) > 0)) return false;
  const double square = dot(n, n);
  if (!(square > 0)) return false;
  foot = p - (dot(n, p - f[0]) / square) * n;
  return true;
}

/// The point of a face that is nearest to a point whose foot is inside. It is a point of
/// the face also where this is so thin that its normal rounds by much more than the
/// corners: only the place between the longest edge and the third corner is as uncertain
/// as the normal, and it is kept between them.
Vec pointOnFace(const Vec& p, const Vec (&f)[3]) {
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if (norm(edge(f, k)) > norm(edge(f, longest))) longest = k;
  const Vec &from = f[longest], along = edge(f, longest),
            to_third = f[(longest + 2) % 3] - from;
  const double square = dot(along, along);
  // Twice, since the first difference cancels.
  Vec across = to_third - (dot(to_third, along) / square) * along;
  across = across - (dot(across, along) / square) * along;
  const double height = clampedUnit(dot(p - from, across) / dot(across, across));
  const Vec base = from + height * to_third;
  const double rest = clampedUnit(dot(p - base, along) / square);
  return base + std::min(rest, 1 - height) * along;
}

/// Gap along a direction: b's least minus a's greatest coordinate.
double gapAlong(const Vec& n, const Vec (&a)[3], const Vec (&b)[3]) {
  return std::min(std::min(dot(n, b[0]), dot(n, b[1])), dot(n, b[2])) -
         std::max(std::max(dot(n, a[0]), dot(n, a[1])), dot(n, a[2]));
}

/// Keeps the direction, or its opposite, if it shows a larger gap than the best so far.
void tryDirection(const Vec& d, const Vec (&a)[3], const Vec (&b)[3], Vec& best,
                  double& gap) {
  constexpr double kLeast = 0x1p-500;
  Vec long_enough = d;
  double length = norm(d);
  // The products of three edges of tiny triangles.
  if (!(length > kLeast)) {
    long_enough = (1 / kLeast) * d;
    length = norm(long_enough);
    if (!(length > kLeast)) return;
  }
  const Vec n = (1 / length) * long_enough, opposite = -1. * n;
  assert(isUnit(n) || !(length < HUGE_VAL));
  const double along = gapAlong(n, a, b), against = gapAlong(opposite, a, b);
  if (along > gap) {
    gap = along;
    best = n;
  }
  if (against > gap) {
    gap = against;
    best = opposite;
  }
}

/// The part of a vector that is perpendicular to another one.
Vec across(const Vec& edge, const Vec& v) { return cross(edge, cross(v, edge)); }

/// The direction along which nearest features are apart. It has less rounding than the
/// line between their nearest points.
Vec directionOf(const NearestFeatures& near, const Vec (&a)[3], const Vec (&b)[3]) {
  switch (near.kind) {
    case NearestFeatures::Kind::kVertexOfA:
      return normal(b);
    case NearestFeatures::Kind::kVertexOfB:
      return normal(a);
    default:
      if (near.inside_a && near.inside_b) return cross(edge(a, near.a), edge(b, near.b));
      if (near.inside_a) return across(edge(a, near.a), near.between);
      if (near.inside_b) return across(edge(b, near.b), near.between);
      return near.between;
  }
}

}  // namespace

NearestFeatures nearestFeatures(const Vec (&a)[3], const Vec (&b)[3],
                                const NumCorners& count) {
  NearestFeatures best{};
  best.square = HUGE_VAL;
  const auto keep = [&best](const Vec& on_a, const Vec& on_b) {
    const Vec between = on_b - on_a;
    const double square = dot(between, between);
    if (!(square < best.square)) return false;
    best.square = square;
    best.between = between;
    best.point = on_a;
    best.inside_a = best.inside_b = true;
    return true;
  };
  Vec foot;
  for (int k = 0; k < 3; ++k) {
    if (k < count.a && count.b == 3 && nearestOnFace(a[k], b, foot) && keep(a[k], foot)) {
      best.kind = NearestFeatures::Kind::kVertexOfA;
      best.a = k;
    }
    if (k < count.b && count.a == 3 && nearestOnFace(b[k], a, foot) && keep(foot, b[k])) {
      best.kind = NearestFeatures::Kind::kVertexOfB;
      best.b = k;
    }
  }
  for (int i = 0; i < NumCorners::edgesOf(count.a); ++i)
    for (int j = 0; j < NumCorners::edgesOf(count.b); ++j) {
      double s, t;
      nearestOnEdges(a[i], edge(a, i), b[j], edge(b, j), s, t);
      if (!keep(lerp(a[i], a[(i + 1) % 3], s), lerp(b[j], b[(j + 1) % 3], t))) continue;
      best.kind = NearestFeatures::Kind::kEdges;
      best.a = i;
      best.b = j;
      best.inside_a = s > 0 && s < 1;
      best.inside_b = t > 0 && t < 1;
    }
  return best;
}

TriangleAdvance::TriangleAdvance(const MotionPath& path_a, const BodyTriangle& a,
                                 const MotionPath& path_b, const BodyTriangle& b,
                                 double t0, double t1, const BodyTolerance& tolerance)
    : path_{&path_a, &path_b},
      triangle_{&a, &b},
      count_(a, b),
      t1_(t1),
      tolerance_(tolerance),
      acceleration_(0),
      jerk_(0) {
  for (int body = 0; body < 2; ++body) {
    const AccelerationBound bound = path_[body]->acceleration(t0, t1);
    const double most = accelerationOf(bound, *triangle_[body]);
    for (int k = 0; k < 3; ++k)
      if (norm(triangle_[body]->corner[1][k] - triangle_[body]->corner[0][k]) > 0 ||
          !(bound.jerk < HUGE_VAL))
        jerk_ = HUGE_VAL;
    acceleration_ += most;
    if (jerk_ < HUGE_VAL) jerk_ += most * bound.jerk * kUpward;
  }
  assert(!(acceleration_ < 0) && !(jerk_ < 0) && !(tolerance.distance < 0));
}

void TriangleAdvance::cornersAt(double t, Vec (&p)[2][3]) const {
  assert(isTimeOfStep(t));
  for (int body = 0; body < 2; ++body) {
    const Pose pose = path_[body]->pose(t);
    const int count = count_.of(body);
    for (int i = 0; i < count; ++i)
      p[body][i] =
          posed(pose, triangle_[body]->corner[0][i], triangle_[body]->corner[1][i], t);
    for (int i = count; i < 3; ++i) p[body][i] = p[body][count - 1];
  }
}

TriangleAdvance::State TriangleAdvance::at(double t) const {
  assert(isTimeOfStep(t));
  State state;
  for (int body = 0; body < 2; ++body) {
    const Pose pose = path_[body]->pose(t);
    const PoseRate rate = path_[body]->rate(t);
    const int count = count_.of(body);
    for (int i = 0; i < count; ++i) {
      const MovingPoint point = posedVertex(pose, rate, triangle_[body]->corner[0][i],
                                            triangle_[body]->corner[1][i], t);
      state.p[body][i] = point.position;
      state.v[body][i] = point.velocity;
    }
    for (int i = count; i < 3; ++i) {
      state.p[body][i] = state.p[body][count - 1];
      state.v[body][i] = state.v[body][count - 1];
    }
  }
  return state;
}

/// Positions and velocities of the corners along a direction, relative to a's first.
struct TriangleAdvance::Projection {
  Projection(const State& state, const Vec& direction, const NumCorners& num)
      : count(num) {
    for (int body = 0; body < 2; ++body)
      for (int i = 0; i < count.of(body); ++i) {
        along[body][i] = dot(direction, state.p[body][i] - state.p[0][0]);
        speed[body][i] = dot(direction, state.v[body][i]);
      }
  }

  /// The largest step, at most the longest one, during which all pairs of vertices
  /// are provably further apart than the margin; negative if they are not now. The gap of
  /// a pair is at least g + v h - M h^2 / 2. This is concave in h: if it is positive at
  /// the end of a step, it is positive before.
  double stepLength(double margin, double rate_margin, double most_approach,
                    double longest) const {
    assert(!(margin < 0) && !(rate_margin < 0) && !(most_approach < 0));
    double h = longest;
    for (int i = 0; i < count.a; ++i)
      for (int j = 0; j < count.b; ++j) {
        const double gap = along[1][j] - along[0][i] - margin,
                     rate = speed[1][j] - speed[0][i] - rate_margin;
        if (!(gap > 0)) return -1;
        if (gap + h * (rate - 0.5 * most_approach * h) >= 0) continue;
        // The positive root, in the form that does not cancel.
        const double root = std::sqrt(rate * rate + 2 * most_approach * gap);
        h = rate < 0 ? 2 * gap / (root - rate) : (root + rate) / most_approach;
      }
    assert(longest < 0 || !(h < 0 || h > longest * kUpward));
    return h;
  }

  const NumCorners& count;
  double along[2][3];
  double speed[2][3];
};

/// The largest acceleration of the corners towards each other at t along the direction;
/// negative if they are accelerated away. For turns only.
double TriangleAdvance::greatestApproach(double t, const Vec& direction) const {
  double most[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int body = 0; body < 2; ++body) {
    const double side = body == 0 ? 1 : -1;
    const PoseRate bend = path_[body]->turnAccelerationAt(t);
    // Turned into the frame of the body: three products a corner.
    const Vec n = side * direction, along = rotatedBack(bend.rotation, n);
    const double all = dot(n, vecOf(bend.translation));
    for (int i = 0; i < count_.of(body); ++i)
      most[body] = std::max(most[body], dot(along, triangle_[body]->corner[0][i]) + all);
  }
  return most[0] + most[1];
}

/// The bound on the acceleration is that of all directions. For a step of at most H it is
/// also the present acceleration along this direction plus H times the bound on the third
/// derivative. H is doubled as long as the step allows it.
double TriangleAdvance::step(double t, const State& state, const Vec& direction) const {
  const Projection along(state, direction, count_);
  const double margin = 2 * tolerance_.position + tolerance_.distance, longest = t1_ - t;
  double best = along.stepLength(margin, tolerance_.rate, acceleration_, longest);
  if (best < 0 || best >= longest || !(jerk_ < HUGE_VAL)) return best;
  // Its rounding is far less than this part of the bound.
  const double approach = greatestApproach(t, direction) + 0x1p-40 * acceleration_;
  // It is one of the accelerations that the bound is for.
  assert(!(approach > (acceleration_ * kUpward + tolerance_.position) * kUpward));
  const auto within = [&](double horizon) {
    const double most = std::min(std::max(approach + jerk_ * horizon, 0.), acceleration_);
    return along.stepLength(margin, tolerance_.rate, most, horizon);
  };
  best = std::max(best, within(longest));
  // H is doubled until it is the whole span or the step no longer reaches it.
  while (best > 0 && 2 * best < longest) {
    const double horizon = 2 * best, h = within(horizon);
    best = std::max(best, h);
    if (h < horizon) break;
  }
  return best;
}

/// A direction along which the nearest features, which were found before, are apart. All
/// others are tried only if it shows less than half of the distance.
Vec TriangleAdvance::directionOfNearest(const State& state) const {
  const auto &a = state.p[0], &b = state.p[1];
  Vec direction = nearest_.between;
  double gap = -HUGE_VAL;
  tryDirection(directionOf(nearest_, a, b), a, b, direction, gap);
  if (gap > 0.5 * std::sqrt(nearest_.square)) return direction;
  tryDirection(nearest_.between, a, b, direction, gap);
  // For parallel edges.
  tryDirection(across(edge(a, nearest_.a), nearest_.between), a, b, direction, gap);
  tryDirection(across(edge(b, nearest_.b), nearest_.between), a, b, direction, gap);
  tryDirection(normal(a), a, b, direction, gap);
  tryDirection(normal(b), a, b, direction, gap);
  for (int i = 0; i < 9; ++i)
    tryDirection(cross(edge(a, i / 3), edge(b, i % 3)), a, b, direction, gap);
  return direction;
}

TriangleAdvance::Answer TriangleAdvance::advance(double& t, double t_stop, int& steps,
                                                 AdvanceCounts& counts) {
  const Answer answer = deformable::advance(
      t, t1_, t_stop, steps, counts, [this](double time) { return at(time); },
      [this](const State& state) {
        nearest_ = nearestFeatures(state.p[0], state.p[1], count_);
        return std::sqrt(nearest_.square) + tolerance_.position <=
               tolerance_.distance + tolerance_.touching;
      },
      [this](double time, const State& state) {
        return step(time, state, directionOfNearest(state));
      });
  if (answer == Answer::kGivenUp && t == 0 && isCrossingAt(0)) return Answer::kContact;
  return answer;
}

Vec TriangleAdvance::directionAt(double t) const {
  const State state = at(t);
  const auto &a = state.p[0], &b = state.p[1];
  const NearestFeatures near = nearestFeatures(a, b, count_);
  Vec direction = {0, 0, 0};
  double gap = 0;
  tryDirection(normal(a), a, b, direction, gap);
  tryDirection(normal(b), a, b, direction, gap);
  gap += tolerance_.position;
  tryDirection(directionOf(near, a, b), a, b, direction, gap);
  tryDirection(near.between, a, b, direction, gap);
  assert(isUnit(direction) || maxNorm(direction) == 0);
  return direction;
}

/// The foot on the plane of a thin face may be beside the face by much more than
/// rounding.
NearestFeatures TriangleAdvance::nearestAt(double t) const {
  Vec p[2][3];
  cornersAt(t, p);
  NearestFeatures near = nearestFeatures(p[0], p[1], count_);
  if (near.kind == NearestFeatures::Kind::kEdges) return near;
  const bool is_of_a = near.kind == NearestFeatures::Kind::kVertexOfA;
  const Vec &vertex = is_of_a ? p[0][near.a] : p[1][near.b],
            on_face = pointOnFace(vertex, p[is_of_a ? 1 : 0]);
  near.point = is_of_a ? vertex : on_face;
  near.between = (is_of_a ? on_face : vertex) - near.point;
  near.square = dot(near.between, near.between);
  return near;
}

bool TriangleAdvance::isCrossingAt(double t) const {
  Vec p[2][3];
  cornersAt(t, p);
  double x[2][3][3];
  for (int body = 0; body < 2; ++body)
    for (int i = 0; i < 3; ++i) {
      x[body][i][0] = p[body][i].x;
      x[body][i][1] = p[body][i].y;
      x[body][i][2] = p[body][i].z;
    }
  for (int body = 0; body < 2; ++body)
    for (int k = 0; k < 3; ++k)
      if (isCrossing(x[body][k], x[body][(k + 1) % 3], x[1 - body][0], x[1 - body][1],
                     x[1 - body][2]))
        return true;
  return false;
}

bool TriangleAdvance::provesCrossing(const Vec (&p)[2][3]) const {
  double x[2][3][3];
  double size = 0;
  for (int body = 0; body < 2; ++body)
    for (int i = 0; i < 3; ++i) {
      const Vec from = p[body][i] - p[0][0];
      x[body][i][0] = from.x;
      x[body][i][1] = from.y;
      x[body][i][2] = from.z;
      size = std::max(size, norm(from));
    }
  // A volume u . (v x w) of vectors below 2 size. Each vector has an error of at most 2
  // e, in all 3 * 2 e (2 size)^2. The rounding is below that, since e is above 16 u size.
  assert(!(tolerance_.position < 16 * kUnit * size));
  const double bound = 48 * tolerance_.position * size * size;
  const auto volume = [](const double(&p)[3], const double(&a)[3], const double(&b)[3],
                         const double(&c)[3]) {
    const Vec o = {a[0], a[1], a[2]};
    return dot(Vec{p[0], p[1], p[2]} - o,
               cross(Vec{b[0], b[1], b[2]} - o, Vec{c[0], c[1], c[2]} - o));
  };
  const auto sign = [bound](double v) { return v > bound ? 1 : v < -bound ? -1 : 0; };
  for (int body = 0; body < 2; ++body)
    for (int k = 0; k < 3; ++k) {
      const auto& p = x[body][k];
      const auto& q = x[body][(k + 1) % 3];
      const auto& f = x[1 - body];
      const int side = sign(volume(p, f[0], f[1], f[2]));
      if (side == 0 || sign(volume(q, f[0], f[1], f[2])) != -side) continue;
      const int turn = sign(volume(q, p, f[0], f[1]));
      if (turn != 0 && sign(volume(q, p, f[1], f[2])) == turn &&
          sign(volume(q, p, f[2], f[0])) == turn)
        return true;
    }
  return false;
}

double TriangleAdvance::proveContact(double t, double width) const {
  const State state = at(t);
  double speed = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      speed = std::max(speed, norm(state.v[1][j] - state.v[0][i]));
  return provedTimeAfter(t, width, tolerance_.position, speed, 0,
                         [this](double time) { return provesContactAt(time); });
}

bool TriangleAdvance::provesContactAt(double t) const {
  if (tolerance_.distance > 0)
    return std::sqrt(nearestAt(t).square) + tolerance_.position <= tolerance_.distance;
  Vec p[2][3];
  cornersAt(t, p);
  return provesCrossing(p);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

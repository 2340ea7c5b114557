// SPDX-License-Identifier: BSD-3-Clause
//
// Advancement of eight pairs of features on the paths of turns.
//
// The pair is a polygon, as in kernels/advance_kernels.cpp: the features are apart while
// a direction has all its corners on one side. For a corner z let |z''| <= M. A direction
// n that turns by m a unit of time, at right angles to n, has after h <= 1 / |m|
//
//   (n + h m) . z(t + h) >= n . z + h (m . z + n . z') + h^2 (m . z' - M / sqrt(2)),
//
// since |n + h m| <= sqrt(2) and z(t + h) differs by at most M h^2 / 2 from z + h z'.
// Where m is 0 the last term is M / 2. The first root of the right side is the step.
//
// Rounding. e is TurningRequest::position_error, the bound on the error of a distance
// between posed points along a unit direction. The poses are those of MotionPath, with
// the same bits, so that it holds here. The error of n . z is e, that of h m . z too,
// since h |m| <= 1; those of n . z' and h m . z' are bounded by rate_error. So a
// direction that does not turn keeps at least e of a gap of 2 e, one that turns e / 4 of
// 9/4 e. The nearest point of the polygon is within 64 u L of that of the exact polygon
// of these corners, the longest of which is L (DistanceTolerance). Lanes where this is
// more than e / 2 stay open. Then a pair at which advancement comes to rest is within 9/4
// e + e + e / 2 < 4 e, the least value of `touching`.
#include "advance/turning_pairs.h"

#include <cassert>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "advance/turning_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "elementary/distance_advance.h"
#include "kernels/lanes.h"
#include "kernels/nearest_points.h"
#include "kernels/vectors.h"
#include "numerics/error_bounds.h"
#include "paths/sine.h"
#if defined(FCL_CCD_USE_HIGHWAY)
#include "kernels/targets.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

constexpr unsigned kAllOfEight = (1U << kEight) - 1;

struct SinesCosines {
  Doubles sine, cosine;
};

FCL_CCD_INLINE Doubles series(const Doubles& q, const double (&terms)[8]) {
  Doubles sum = all(terms[0]);
  for (int k = 1; k < 8; ++k) sum = sum * q + all(terms[k]);
  return sum;
}

/// sineCosine() of angles in [0, 3.2].
FCL_CCD_INLINE SinesCosines sinesCosines(const Doubles& x) {
  assert(isAll((x >= all(0)) & (x <= all(3.2))));
  // A sum with it is rounded to an integer.
  constexpr double kInteger = 0x1.8p52;
  const Doubles zero = all(0),
                quadrant = (x * all(kTwoOverPi) + all(kInteger)) - all(kInteger);
  const Doubles r = ((x - quadrant * all(kHalfPi[0])) - quadrant * all(kHalfPi[1])) -
                    quadrant * all(kHalfPi[2]);
  const Doubles q = r * r;
  const Doubles s = r + r * (q * series(q, kSineSeries)),
                c = all(1) - (all(0.5) * q - (q * q) * series(q, kCosineSeries));
  const DoubleMask is_first = quadrant < all(0.5), is_second = quadrant < all(1.5);
  return {select(is_first, s, select(is_second, c, zero - s)),
          select(is_first, c, select(is_second, zero - s, zero - c))};
}

/// A matrix and a vector in each lane.
struct Poses {
  Doubles rotation[9], translation[3];

  FCL_CCD_INLINE Vectors rotated(const Vectors& v) const {
    const Doubles(&m)[9] = rotation;
    return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
            m[6] * v.x + m[7] * v.y + m[8] * v.z};
  }
  FCL_CCD_INLINE Vectors shift() const {
    return {translation[0], translation[1], translation[2]};
  }
};

/// MotionPath::pose().
FCL_CCD_INLINE Poses posesAt(const Turn& turn, const Doubles& t) {
  Doubles sine = all(0), cosine = all(0);
  if (turn.angle > 0) {
    const Doubles angle = all(turn.angle) * t;
    const SinesCosines at = sinesCosines(angle);
    const Doubles half = sinesCosines(all(0.5) * angle).sine;
    sine = at.sine;
    cosine = select(angle >= all(1), all(1) - at.cosine, all(2) * half * half);
  }
  Poses out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] =
        all(turn.beginning.rotation[i]) +
        (sine * all(turn.sine_rotation[i]) + cosine * all(turn.cosine_rotation[i]) +
         t * all(turn.linear_rotation[i]));
  for (int k = 0; k < 3; ++k)
    out.translation[k] =
        all(turn.beginning.translation[k]) +
        (sine * all(turn.sine_translation[k]) + cosine * all(turn.cosine_translation[k]) +
         t * all(turn.linear_translation[k]));
  return out;
}

/// MotionPath::rate().
FCL_CCD_INLINE Poses ratesAt(const Turn& turn, const Doubles& t) {
  Doubles sine = all(0), cosine = all(0);
  if (turn.angle > 0) {
    const SinesCosines at = sinesCosines(all(turn.angle) * t);
    sine = all(turn.angle) * at.sine;
    cosine = all(turn.angle) * at.cosine;
  }
  Poses out;
  for (int i = 0; i < 9; ++i)
    out.rotation[i] = cosine * all(turn.sine_rotation[i]) +
                      sine * all(turn.cosine_rotation[i]) + all(turn.linear_rotation[i]);
  for (int k = 0; k < 3; ++k)
    out.translation[k] = cosine * all(turn.sine_translation[k]) +
                         sine * all(turn.cosine_translation[k]) +
                         all(turn.linear_translation[k]);
  return out;
}

/// The corners of a body's triangles at a time, and their velocities.
struct Corners {
  Vectors position[3], velocity[3];
};

/// @param count  the number of corners that are wanted
FCL_CCD_INLINE void setPositions(const TurningPairs& pairs, int k,
                                 const TurningBody& body, const Poses& poses,
                                 const Doubles& t, int count, Corners& out) {
  for (int i = 0; i < count; ++i) {
    Vectors x = loadVectors(pairs.corner[k][0][i]);
    if (body.deforms) x = (all(1) - t) * x + t * loadVectors(pairs.corner[k][1][i]);
    out.position[i] = poses.rotated(x) + poses.shift();
  }
}

FCL_CCD_INLINE void setCorners(const TurningPairs& pairs, int k, const TurningBody& body,
                               const Doubles& t, int count, Corners& out) {
  const Poses poses = posesAt(*body.turn, t), rates = ratesAt(*body.turn, t);
  setPositions(pairs, k, body, poses, t, count, out);
  for (int i = 0; i < count; ++i) {
    Vectors x = loadVectors(pairs.corner[k][0][i]);
    Vectors moving{all(0), all(0), all(0)};
    if (body.deforms) {
      const Vectors to = loadVectors(pairs.corner[k][1][i]);
      moving = poses.rotated(to - x);
      x = (all(1) - t) * x + t * to;
    }
    out.velocity[i] = (rates.rotated(x) + moving) + rates.shift();
  }
}

/// The number of corners that a feature of each body has.
struct FeatureSizes {
  int of[2];

  FCL_CCD_INLINE explicit FeatureSizes(ContinuousContactKind kind)
      : of{kind == ContinuousContactKind::kEdgeEdge ? 2 : 1,
           kind == ContinuousContactKind::kEdgeEdge ? 2 : 3} {}
};

/// The polygons of the pairs at a time.
struct TurningPolygons {
  Vectors corner[4], velocity[4];
  /// The largest length of a corner.
  Doubles size;
  int count;

  FCL_CCD_INLINE TurningPolygons(const TurningPairs& pairs, const TurningBody (&body)[2],
                                 const Doubles& t)
      : size(all(0)), count(pairs.kind == ContinuousContactKind::kVertexFace ? 3 : 4) {
    const FeatureSizes sizes(pairs.kind);
    Corners of[2];
    for (int k = 0; k < 2; ++k) setCorners(pairs, k, body[k], t, sizes.of[k], of[k]);
    for (int k = 0; k < count; ++k) {
      const CornerPoints p = DifferencePolygon::pointsOf(pairs.kind, k);
      const int first = p.first, second = p.second - sizes.of[0];
      corner[k] = of[1].position[second] - of[0].position[first];
      velocity[k] = of[1].velocity[second] - of[0].velocity[first];
      size = larger(size, dot(corner[k], corner[k]));
    }
    size = squareRoot(size);
  }

  FCL_CCD_INLINE int next(int k) const { return k + 1 < count ? k + 1 : 0; }
};

/// Bounds on the acceleration of the points of one body's features: accelerationOf().
FCL_CCD_INLINE Doubles accelerations(const TurningPairs& pairs, int k,
                                     const TurningBody& body, int count) {
  const AccelerationBound& bound = body.acceleration;
  const auto of = [&](const Vectors& x) HWY_ATTR {
    const double(&m)[9] = bound.turn;
    const Vectors v = {
        all(m[0]) * x.x + all(m[1]) * x.y + all(m[2]) * x.z + all(bound.offset[0]),
        all(m[3]) * x.x + all(m[4]) * x.y + all(m[5]) * x.z + all(bound.offset[1]),
        all(m[6]) * x.x + all(m[7]) * x.y + all(m[8]) * x.z + all(bound.offset[2])};
    return squareRoot(dot(v, v)) + all(bound.per_distance) * squareRoot(dot(x, x)) +
           all(bound.constant);
  };
  Doubles most = all(0);
  for (int i = 0; i < count; ++i) {
    const Vectors x = loadVectors(pairs.corner[k][0][i]);
    Doubles here = of(x);
    if (body.deforms) {
      const Vectors to = loadVectors(pairs.corner[k][1][i]), way = to - x;
      here = max(here, of(to)) + all(bound.per_displacement) * squareRoot(dot(way, way));
    }
    most = max(most, here);
  }
  // More than the rounding.
  return most * all(1 + 0x1p-39);
}

/// The ends of the steps that a direction proves; -infinity: none.
FCL_CCD_INLINE Doubles stepsAlong(const TurningPolygons& x, const Vectors& n,
                                  const Vectors& turn, const Doubles& longest,
                                  double margin, double rate_margin,
                                  const Doubles& least_bend) {
  const Doubles zero = all(0);
  Doubles h = longest;
  DoubleMask proves = longest > zero;
  for (int k = 0; k < x.count; ++k) {
    const Doubles gap = dot(n, x.corner[k]) - all(margin),
                  rate =
                      dot(n, x.velocity[k]) + dot(turn, x.corner[k]) - all(rate_margin),
                  bend = dot(turn, x.velocity[k]) - least_bend;
    proves = proves & (gap > zero);
    h = min(firstRoots(gap, rate, bend), h);
  }
  return select(proves, h, all(-HUGE_VAL));
}

/// Eight pairs on their way.
class TurningAdvance {
 public:
  FCL_CCD_INLINE TurningAdvance(const TurningPairs& pairs, const TurningBody (&body)[2],
                                const TurningRequest& request)
      : pairs_(pairs),
        body_(body),
        request_(request),
        t_(load<kEight>(pairs.first)),
        acceleration_(accelerations(pairs, 0, body[0], FeatureSizes(pairs.kind).of[0]) +
                      accelerations(pairs, 1, body[1], FeatureSizes(pairs.kind).of[1])) {
    assert(isAll((t_ >= all(0)) & (t_ <= all(1))));
    assert(request.touching >= 4 * request.position_error && request.rate_error >= 0);
    advance();
  }

  /// The lanes that need more than plain steps.
  FCL_CCD_INLINE unsigned open() const { return open_; }
  FCL_CCD_INLINE const DoubleMask& contacts() const { return is_contact_; }
  /// Until when the features are apart; the first time of contact.
  FCL_CCD_INLINE const Doubles& time() const { return t_; }

 private:
  FCL_CCD_INLINE void advance() {
    // Most pairs take three or four.
    constexpr int kMostStepsTogether = 16;
    const Doubles last = load<kEight>(pairs_.last);
    const double e = request_.position_error, most = request_.touching - 1.5 * e;
    for (int step = 0;; ++step) {
      const TurningPolygons x(pairs_, body_, t_);
      const NearestPoints near = nearestPoints(x, x.corner);
      const Doubles rounding = all(128 * kUnit) * x.size;
      open_ |= ~bits(near.is_sure & (rounding <= all(e)));
      is_contact_ = near.distance <= all(most);
      unsigned left = ~(open_ | bits(is_contact_)) & kAllOfEight;
      if (left == 0) return;
      const Doubles until = t_ + longestSteps(x, near, left) * all(1 - 0x1p-48);
      open_ |= left & ~bits(until > t_);
      const DoubleMask is_soon = until <= last;
      left &= ~open_ & bits(is_soon);
      if (step == kMostStepsTogether) open_ |= left;
      if (left == 0 || step == kMostStepsTogether) return;
      t_ = select((near.distance > all(most)) & (until > t_) & is_soon, until, t_);
    }
  }

  /// @param left  the lanes that matter
  FCL_CCD_INLINE Doubles longestSteps(const TurningPolygons& x, const NearestPoints& near,
                                      unsigned left) const {
    // A turn that is not at right angles makes the direction longer than sqrt(2): by less
    // than this with h |m| <= 1.
    constexpr double kMostAlong = 0x1p-13, kHalfRoot = 0.7073;
    const double e = request_.position_error, rate_error = request_.rate_error;
    const NearestSides sides(x, x.corner, near);
    const Vectors n = directionsApart(near, sides), none{all(0), all(0), all(0)};
    const Vectors turn = turnsApart(x, x.corner, near, sides, n);
    const Doubles speed = squareRoot(dot(turn, turn));
    const DoubleMask is_across = abs(dot(turn, n)) <= all(kMostAlong) * speed;
    const Doubles longest = select(is_across, all(1 - 0x1p-40) / speed, all(0));
    const Doubles turning = stepsAlong(x, n, turn, longest, 2.25 * e, 2 * rate_error,
                                       all(kHalfRoot) * acceleration_);
    // The answer of a lane must not depend on the others.
    const DoubleMask is_enough = (turning > all(0)) & (turning < longest);
    if ((left & ~bits(is_enough)) == 0) return turning;
    const Doubles fixed = stepsAlong(x, n, none, all(HUGE_VAL), 2 * e, rate_error,
                                     all(0.5) * acceleration_);
    return select(is_enough, turning, max(fixed, turning));
  }

  const TurningPairs& pairs_;
  const TurningBody (&body_)[2];
  const TurningRequest& request_;
  Doubles t_, acceleration_;
  DoubleMask is_contact_;
  unsigned open_{0};
};

/// The lanes in which an edge of one triangle provably passes through the other, as
/// TriangleAdvance::provesCrossing() shows it.
FCL_CCD_INLINE DoubleMask doCross(const Corners& a, const Corners& b,
                                  double position_error) {
  const Doubles zero = all(0);
  Vectors x[2][3];
  Doubles size = zero;
  for (int i = 0; i < 3; ++i) {
    x[0][i] = a.position[i] - a.position[0];
    x[1][i] = b.position[i] - a.position[0];
    for (int k = 0; k < 2; ++k) size = max(size, dot(x[k][i], x[k][i]));
  }
  const Doubles bound = all(48 * position_error) * size, below = zero - bound;
  const auto volume =
      [](const Vectors& p, const Vectors& o, const Vectors& q, const Vectors& r)
          HWY_ATTR { return dot(p - o, cross(q - o, r - o)); };
  // On which sides of the other triangle the corners are, and how edges pass each other.
  Doubles side[2][3], pass[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 2; ++k)
      side[k][i] = volume(x[k][i], x[1 - k][0], x[1 - k][1], x[1 - k][2]);
    for (int j = 0; j < 3; ++j)
      pass[i][j] = volume(x[0][(i + 1) % 3], x[0][i], x[1][j], x[1][(j + 1) % 3]);
  }
  DoubleMask crosses = zero > zero;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 2; ++k) {
      const Doubles &from = side[k][i], &to = side[k][(i + 1) % 3];
      const Doubles(&u)[3] = pass[i];
      const Doubles along[3] = {k == 0 ? u[0] : pass[0][i], k == 0 ? u[1] : pass[1][i],
                                k == 0 ? u[2] : pass[2][i]};
      const DoubleMask is_left =
          (along[0] > bound) & (along[1] > bound) & (along[2] > bound);
      const DoubleMask is_right =
          (along[0] < below) & (along[1] < below) & (along[2] < below);
      crosses =
          crosses | ((((from > bound) & (to < below)) | ((from < below) & (to > bound))) &
                     (is_left | is_right));
    }
  return crosses;
}

/// TriangleAdvance::proveContact(). A contact at the beginning has exactly the time 0.
/// @param is_wanted  the lanes in which there is a contact
FCL_CCD_INLINE Doubles upperEnds(const TurningPairs& pairs, const TurningBody (&body)[2],
                                 const TurningRequest& request, const Doubles& t,
                                 const DoubleMask& is_wanted) {
  Corners of[2];
  for (int k = 0; k < 2; ++k) setCorners(pairs, k, body[k], t, 3, of[k]);
  Doubles speed = all(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vectors v = of[1].velocity[j] - of[0].velocity[i];
      speed = max(dot(v, v), speed);
    }
  const Doubles one = all(1),
                longest = min(min(all(request.toc_err), all(request.t_max) - t), one - t);
  Doubles hi = t,
          h = max(all(request.position_error) / max(squareRoot(speed), all(0x1p-500)),
                  all(0x1p-52));
  DoubleMask is_left = is_wanted & (t > all(0));
  while (bits(is_left) != 0) {
    const Doubles time = min(t + min(h, longest), one);
    for (int k = 0; k < 2; ++k)
      setPositions(pairs, k, body[k], posesAt(*body[k].turn, time), time, 3, of[k]);
    hi = select(is_left & doCross(of[0], of[1], request.position_error), time, hi);
    is_left = is_left & (hi == t) & (h < longest);
    h = all(4) * h;
  }
  return hi;
}

TurningAnswers turningAnswers(const TurningPairs& pairs, const TurningBody (&body)[2],
                              const TurningRequest& request) {
  const TurningAdvance advance(pairs, body, request);
  TurningAnswers out;
  out.open = advance.open() & kAllOfEight;
  out.yes = bits(advance.contacts()) & ~out.open;
  store(advance.time(), out.toc_lo);
  store(upperEnds(pairs, body, request, advance.time(), advance.contacts()), out.toc_hi);
  assert((out.open & out.yes) == 0 && out.areBrackets(pairs));
  return out;
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#if !defined(FCL_CCD_USE_HIGHWAY) || HWY_ONCE
namespace fcl {
namespace detail {
namespace deformable {

#if defined(FCL_CCD_USE_HIGHWAY)
HWY_EXPORT(turningAnswers);
#endif

TurningAnswers advanceTurning(const TurningPairs& pairs, const TurningBody (&body)[2],
                              const TurningRequest& request) {
#if defined(FCL_CCD_USE_HIGHWAY)
  return HWY_DYNAMIC_DISPATCH(turningAnswers)(pairs, body, request);
#else
  return HWY_NAMESPACE::turningAnswers(pairs, body, request);
#endif
}

std::vector<decltype(&advanceTurning)> allTurningKernels() {
#if defined(FCL_CCD_USE_HIGHWAY) && (HWY_TARGETS & (HWY_TARGETS - 1)) != 0
  return ofEachTarget(HWY_DISPATCH_TABLE(turningAnswers));
#else
  return {&advanceTurning};
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "path_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "motion_references.h"
#include "paths/motion_path.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::MotionPath;

RealVector applied(const BoundedMotion::Placement& at, const RealVector& x) {
  RealVector out;
  for (int k = 0; k < 3; ++k)
    out[k] = Real{at.rotation[3 * k]} * x[0] + Real{at.rotation[3 * k + 1]} * x[1] +
             Real{at.rotation[3 * k + 2]} * x[2] + Real{at.translation[k]};
  return out;
}

/// First and second derivatives by differences of the sixth order. Points that turn by w
/// radians have relative errors of (w h)^6 / 100 and 1e-19 / (w h)^2: h is 1e-3 / w.
struct Derivatives {
  RealVector first, second;
};
template <typename Function>
Derivatives derivatives(const Function& p, Real t, Real h) {
  const RealVector at = p(t);
  RealVector odd[4], even[4];
  for (int k = 1; k < 4; ++k) {
    const RealVector after = p(t + k * h), before = p(t - k * h);
    odd[k] = after - before;
    even[k] = after - 2 * at + before;
  }
  return {(45 * odd[1] - 9 * odd[2] + odd[3]) / (60 * h),
          (270 * even[1] - 27 * even[2] + 2 * even[3]) / (180 * h * h)};
}

Real stepOf(const BoundedMotion& motion) {
  return 1e-3L / std::max(1., motion.angularSpeedBound(0, 1));
}

double ratio(Real x, Real bound) {
  if (x == 0) return 0;
  return static_cast<double>(x / bound);
}

}  // namespace

int pathCases(int count) {
  const char* times = std::getenv("FCL_CCD_TEST_PATHS");
  return manyRounds(count) * (times ? std::atoi(times) : 1);
}

RoundingParts roundingParts(const BoundedMotion& motion, const ExactPath& exact,
                            const Vector3<double>& x, double t) {
  const MotionPath path = MotionPath::bounded(motion);
  const RealVector point = x.cast<Real>();
  const Real pose = (applied(motion.placementAt(t), point) - exact(t) * x).norm();
  const Derivatives of =
      derivatives([&](Real s) { return exact(s) * x; }, Real{t}, stepOf(motion));
  const Real rate = (applied(motion.rateAt(t), point) - of.first).norm();
  return {ratio(pose, path.positionError(x.norm())),
          ratio(rate, path.rateError(x.norm()) + 1e-14L * of.first.norm() + 1e-15L)};
}

RoundingParts ownRoundingParts(const BoundedMotion& motion, const RealPose& pose,
                               const RealPose& rate, const Vector3<double>& direction,
                               double t) {
  const BoundedMotion::Rounding more = motion.moreRounding();
  const auto part = [&](BoundedMotion::Placement at, const RealPose& exact,
                        double rotation, double translation) {
    const RealVector origin = applied(at, RealVector::Zero());
    std::fill(at.translation, at.translation + 3, 0);
    const RealVector x = applied(at, direction.cast<Real>());
    return std::max(ratio((x - exact.rotation * direction.cast<Real>()).norm(), rotation),
                    ratio((origin - exact.translation).norm(), translation));
  };
  return {part(motion.placementAt(t), pose, more.rotation, more.translation),
          part(motion.rateAt(t), rate, more.rotation_rate, more.translation_rate)};
}

RoundingParts greatest(const RoundingParts& x, const RoundingParts& y) {
  return {std::max(x.pose, y.pose), std::max(x.rate, y.rate)};
}

BoundParts boundParts(const BoundedMotion& motion, const ExactPath& exact,
                      const Vector3<double>& center, double radius, double t0, double t1,
                      Random& random) {
  constexpr int kTimes = 24, kPoints = 6;
  Real most = 0, most_turn = 0;
  for (int i = 0; i <= kTimes; ++i) {
    // Derivatives need some room at times where the path may have a knot.
    const Real h = std::min<Real>(stepOf(motion), (Real{t1} - Real{t0}) / 16);
    const Real t = t0 + 3 * h + (Real{t1} - Real{t0} - 6 * h) * i / kTimes;
    for (int k = 0; k < kPoints; ++k) {
      const Vector3<double> x = center + radius * (k ? randomDirection(random)
                                                     : Vector3<double>::Zero().eval());
      most = std::max(
          most, derivatives([&](Real s) { return exact(s) * x; }, t, h).second.norm());
      const auto turned_at = [&](Real s) -> RealVector {
        return exact(s).rotation.col(k % 3);
      };
      const RealVector turned = derivatives(turned_at, t, h).first;
      most_turn = std::max(most_turn, turned.norm());
    }
  }
  const double c[3] = {center[0], center[1], center[2]};
  // Differences round, by 1e-19 / h^2.
  const Real noise = 1e-9L;
  return {ratio(std::max<Real>(0, most - noise * (1 + most)),
                motion.accelerationBound(c, radius, t0, t1)),
          ratio(std::max<Real>(0, most_turn - noise * (1 + most_turn)),
                motion.angularSpeedBound(t0, t1))};
}

namespace {

constexpr int kSamples = 512;

/// The least value near a low sample, by golden sections.
Real refined(const std::function<Real(Real)>& f, Real lo, Real hi) {
  const Real golden = (sqrt(Real{5}) - 1) / 2;
  Real x = hi - golden * (hi - lo), y = lo + golden * (hi - lo), at_x = f(x), at_y = f(y),
       least = std::min({f(lo), f(hi), at_x, at_y});
  for (int i = 0; i < 40; ++i) {
    if (at_x < at_y) {
      hi = y, y = x, at_y = at_x;
      at_x = f(x = hi - golden * (hi - lo));
    } else {
      lo = x, x = y, at_x = at_y;
      at_y = f(y = lo + golden * (hi - lo));
    }
    least = std::min({least, at_x, at_y});
  }
  return least;
}

/// The distances at samples of the step, and the least one.
struct Samples {
  std::vector<Real> at;
  Real least;

  explicit Samples(const std::function<Real(Real)>& distance) {
    for (int i = 0; i <= kSamples; ++i) at.push_back(distance(Real(i) / kSamples));
    least = *std::min_element(at.begin(), at.end());
    const Real low = least + (*std::max_element(at.begin(), at.end()) - least) / 64;
    for (int i = 0; i <= kSamples; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool is_low = at[k] <= low && (i == 0 || at[k] <= at[k - 1]) &&
                          (i == kSamples || at[k] <= at[k + 1]);
      if (is_low)
        least = std::min(least, refined(distance, Real(std::max(i - 1, 0)) / kSamples,
                                        Real(std::min(i + 1, kSamples)) / kSamples));
    }
  }

  /// The first time at which the distance is below `wanted`, between two samples of
  /// which the first is above it; 2: not at a sample.
  Real firstBelow(const std::function<Real(Real)>& distance, Real wanted) const {
    std::size_t i = 0;
    while (i < at.size() && at[i] >= wanted) ++i;
    if (i == at.size()) return 2;
    if (i == 0) return 0;
    Real lo = Real(i - 1) / kSamples, hi = Real(i) / kSamples;
    for (int k = 0; k < 60; ++k) {
      const Real middle = (lo + hi) / 2;
      (distance(middle) < wanted ? hi : lo) = middle;
    }
    return hi;
  }
};

struct Answer {
  bool is_collide;
  double time;
};

Answer ask(const CollisionGeometry<double>& moves, const MotionBase<double>& motion,
           const CollisionGeometry<double>& rests, const Vector3<double>& at,
           double min_distance) {
  Transform3<double> tf = Transform3<double>::Identity();
  tf.translation() = at;
  const TranslationMotion<double> still(tf, tf);
  ContinuousContactRequest<double> request;
  request.query = ContinuousQuery::kFirst;
  request.toc_err = 1e-9;
  request.min_distance = min_distance;
  ContinuousContactResult<double> result;
  const double time = continuousCollide(&moves, &motion, &rests, &still, request, result);
  return {result.is_collide, time};
}

/// A distance near the least one, to graze at; not positive: there is none.
double grazing(Real least, Random& random) {
  const double by = (random.index(2) ? 1 : -1) * std::pow(10, random.uniform(-9, -2));
  return static_cast<double>(least) + by;
}

/// Compares an answer with the distances of two objects that touch at `wanted`.
std::string compared(const std::function<Real(Real)>& distance, const Samples& samples,
                     Real wanted, const Answer& answer, PathTally& tally) {
  const auto [is_collide, time] = answer;
  const Real tolerance = 1e-11L;
  const Real first = samples.firstBelow(distance, wanted);
  ++(is_collide ? tally.contacts : tally.misses);
  const auto tell = [&, at = time](const char* what) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "%s: time %.17g, first sample %.17g, distance then %g, at least %g",
                  what, at, static_cast<double>(first),
                  static_cast<double>(distance(at) - wanted),
                  static_cast<double>(samples.least - wanted));
    return std::string(text);
  };
  if (samples.least < wanted - tolerance && !is_collide) return tell("missed");
  if (samples.least > wanted + tolerance && is_collide) return tell("invented");
  if (!is_collide) return {};
  if (time > first + 1e-15L) return tell("late");
  // Within the tolerance and toc_err of touching.
  const Real speed = (distance(Real{time} + 1e-7L) - distance(time)) / 1e-7L;
  if (time > 0 && distance(time) > wanted + tolerance + 4e-9L * abs(speed))
    return tell("early");
  return {};
}

}  // namespace

std::string ballDisagreement(const MotionBase<double>& motion, const ExactPath& exact,
                             Random& random, PathTally& tally) {
  const Vector3<double> origin = Vector3<double>::Zero(),
                        at = (exact(random.uniform(0, 1)) * origin).cast<double>() +
                             random.point(1.2);
  const std::function<Real(Real)> distance = [&](Real t) {
    return (exact(t) * origin - at.cast<Real>()).norm();
  };
  const Samples samples(distance);
  const double own = random.uniform(0.05, 0.3);
  double other = random.uniform(0.05, 0.5);
  if (random.index(2)) {
    other = grazing(samples.least, random) - own;
    if (other < 0.01) return {};
    ++tally.grazes;
  }
  const Answer answer = ask(Sphere<double>(own), motion, Sphere<double>(other), at, 0);
  return compared(distance, samples, Real{own} + Real{other}, answer, tally);
}

std::string triangleDisagreement(const MotionBase<double>& motion, const ExactPath& exact,
                                 Random& random, PathTally& tally) {
  using Model = BVHModel<OBBRSS<double>>;
  const auto corners = [&random] {
    return std::vector<Vector3<double>>{random.point(.6), random.point(.6),
                                        random.point(.6)};
  };
  const auto moves = corners(), rests = corners();
  const Vector3<double> at =
      (exact(random.uniform(0, 1)) * moves[0]).cast<double>() + random.point(0.5);
  RealVector resting[3];
  for (std::size_t k = 0; k < 3; ++k) resting[k] = (rests[k] + at).cast<Real>();
  const std::function<Real(Real)> distance = [&](Real t) -> Real {
    const RealPose pose = exact(t);
    const RealVector moving[3] = {pose * moves[0], pose * moves[1], pose * moves[2]};
    if (doTrianglesCross(moving, resting)) return -1;
    return triangleDistance(moving, resting);
  };
  const Samples samples(distance);
  double wanted = 0;
  if (random.index(2)) {
    wanted = grazing(samples.least, random);
    if (wanted < 0.01) return {};
    ++tally.grazes;
  }
  const TestMesh a{moves, {Triangle(0, 1, 2)}}, b{rests, {Triangle(0, 1, 2)}};
  const Answer answer =
      ask(*makeModel<Model>(a), motion, *makeModel<Model>(b), at, wanted);
  return compared(distance, samples, wanted, answer, tally);
}

}  // namespace test
}  // namespace fcl

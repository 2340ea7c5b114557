// SPDX-License-Identifier: BSD-3-Clause
//
// Shapes that pass each other at small or constant distances, in how many steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "advance/convex_advance.h"
#include "curved/body_approach.h"
#include "curved/curved_query.h"
#include "sanitizer.h"
#include "turning_bodies.h"

namespace fcl {
namespace test {
namespace {
using namespace detail::deformable;

/// The z axis from -half to half, moved.
struct Rod {
  ReferenceMotion motion;
  double half;

  RealVector middle(Real t) const { return motion.at(t).translation; }
  RealVector along(Real t) const {
    return motion.at(t).rotation.col(2) * static_cast<Real>(half);
  }
};

/// The distance of the rods' lines, if the nearest points are inside of both; 9 if not.
Real distanceInside(const Rod& a, const Rod& b, Real t) {
  const RealVector u = a.along(t), v = b.along(t), w = b.middle(t) - a.middle(t),
                   n = u.cross(v);
  const Real square = n.squaredNorm();
  if (!(square > 0.01L)) return 9;
  // w + y v - x u is parallel to n.
  const Real x = w.cross(v).dot(n) / square, y = w.cross(u).dot(n) / square;
  if (abs(x) > 0.9L || abs(y) > 0.9L) return 9;
  return abs(w.dot(n)) / sqrt(square);
}

/// The least distance of an end of a rod from the other one.
Real distanceOfEnds(const Rod& a, const Rod& b, Real t) {
  Real least = 9;
  for (const auto& [from, to] : {std::make_pair(&a, &b), std::make_pair(&b, &a)})
    for (const Real side : {-1, 1}) {
      const RealVector along = to->along(t),
                       way = from->middle(t) + side * from->along(t) - to->middle(t);
      const Real share = std::clamp<Real>(way.dot(along) / along.squaredNorm(), -1, 1);
      least = std::min(least, (way - share * along).norm());
    }
  return least;
}

/// The time at which the distance is least, if the rods are nearest inside of both then
/// and clearly further apart at other times; negative if not.
Real timeOfLeast(const Rod& a, const Rod& b) {
  constexpr int kSamples = 32;
  const Real step = 1.L / kSamples, clearly = 0.02L, too_near = 0.05L;
  const auto inside = [&](Real t) { return distanceInside(a, b, t); };
  int best = 0;
  for (int i = 0; i <= kSamples; ++i)
    if (inside(i * step) < inside(best * step)) best = i;
  if (best < 3 || best > kSamples - 3) return -1;
  Real lo = (best - 1) * step, hi = (best + 1) * step;
  for (int round = 0; round < 70; ++round) {
    const Real x = (2 * lo + hi) / 3, y = (lo + 2 * hi) / 3;
    if (inside(x) < inside(y))
      hi = y;
    else
      lo = x;
  }
  const Real least = inside(lo), near = 1e-6L;
  if (least < too_near) return -1;
  if (!(least <= inside(lo - near)) || inside(lo - near) > 2) return -1;
  if (!(least <= inside(lo + near)) || inside(lo + near) > 2) return -1;
  for (int i = 0; i <= kSamples; ++i)
    if (std::abs(i - best) > 2 && inside(i * step) < least + clearly) return -1;
  for (int i = 0; i <= kSamples; ++i)
    if (distanceOfEnds(a, b, i * step) < least + clearly) return -1;
  return lo;
}

Rod randomRod(Random& random) {
  Rod rod{randomMotion(random, 0.5), random.uniform(1.5, 3)};
  rod.motion.kind = random.uniform(0, 1) < 0.5 ? ReferenceMotion::Kind::kScrew
                                               : ReferenceMotion::Kind::kInterpolation;
  return rod;
}

/// The common normal of two edges turns with neither of them.
TEST(FCL_CONVEX_ADVANCE, edgesThatTurnPastEachOther) {
  constexpr int kMostSteps = 1000;
  int count = 0;
  for (int seed = 0; count < rounds(60); ++seed) {
    SCOPED_TRACE(seed);
    ASSERT_LT(seed, 20000);
    Random random(4100 + seed);
    const Rod a = randomRod(random), b = randomRod(random);
    const Real time = timeOfLeast(a, b);
    if (time < 0) continue;
    ++count;
    const Real least = distanceInside(a, b, time);
    const double gap = std::pow(10, random.uniform(-10, -3));
    const auto ask = [&](double radius) {
      const ConvexShape one(EdgeCore(a.half), radius), other(EdgeCore(b.half), radius);
      return queryCurved({one, a.motion.path()}, {other, b.motion.path()}, {});
    };
    const double radius = static_cast<double>(least) / 2;
    const CurvedAnswer apart = ask(radius - gap / 2), touching = ask(radius + gap / 2);
    EXPECT_TRUE(apart.contacts.empty()) << gap;
    EXPECT_LT(std::max(apart.counts.steps, touching.counts.steps), kMostSteps) << gap;
    ASSERT_EQ(touching.contacts.size(), 1) << gap;
    EXPECT_LE(touching.contacts[0].toc_lo, static_cast<double>(time)) << gap;
    EXPECT_NEAR(
        static_cast<double>(distanceInside(a, b, touching.contacts[0].toc_lo) - least),
        gap, 1e-3 * gap + 1e-11);
  }
}

/// All acceleration is at right angles to the axis, along which they are apart.
TEST(FCL_CONVEX_ADVANCE, turnsAtConstantHeight) {
  const ConvexShape box = ConvexShape::cuboid({0.5, 0.5, 0.5});
  const Body floor({{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {Triangle(0, 1, 2)}});
  const BodyOnPath still(floor, ReferenceMotion().path());
  ReferenceMotion motion;
  motion.beginning.translation()[2] = motion.end.translation()[2] = 0.51;
  motion.turn(Vector3<double>::UnitZ(), 1.5);
  ApproachOptions options;
  options.rel_err = 1e-9;
  BodyApproach approach({box, motion.path()}, still.body, options);
  ASSERT_TRUE(approach.search());
  const ApproachAnswer answer = approach.answer();
  EXPECT_LE(answer.lo, 0.01);
  EXPECT_NEAR(answer.hi, 0.01, 1e-12);
  EXPECT_LE(answer.hi - answer.lo, 1.1e-11);
  EXPECT_LT(answer.counts.steps, 100);
}

/// A search for the distance 0 would halve what it has shown without an end.
TEST(FCL_CONVEX_ADVANCE, pointThroughATriangle) {
  const ConvexShape point(EdgeCore(0), 0);
  const Body floor({{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {Triangle(0, 1, 2)}});
  const BodyOnPath still(floor, ReferenceMotion().path());
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    Random random(500 + i);
    ReferenceMotion motion = randomMotion(random, 0.9);
    motion.kind = ReferenceMotion::Kind::kScrew;
    motion.beginning.translation()[2] = 1;
    motion.end.translation()[2] = -1;
    BodyApproach approach({point, motion.path()}, still.body, {});
    EXPECT_FALSE(approach.search());
    EXPECT_LT(approach.answer().counts.steps, 100);
  }
}

/// Boxes whose edges meet come to the contact by twice as many digits in each step; along
/// a fixed direction some took 25.
TEST(FCL_CONVEX_ADVANCE, edgesMeetInFewSteps) {
  constexpr int kMostSteps = 16;
  constexpr double kMostMean = 6;
  double steps = 0;
  int count = 0;
  for (int seed = 0; seed < rounds(300); ++seed) {
    SCOPED_TRACE(seed);
    Random random(7300 + seed);
    const auto boxOf = [&random] {
      return ConvexShape::cuboid(
          {random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)});
    };
    ReferenceMotion motion[2] = {randomMotion(random, 0.3), randomMotion(random, 0.3)};
    for (int k = 0; k < 2; ++k) {
      motion[k].kind = ReferenceMotion::Kind::kScrew;
      motion[k].beginning.translation()[0] += k == 0 ? -2 : 2;
    }
    const CurvedAnswer answer =
        queryCurved({boxOf(), motion[0].path()}, {boxOf(), motion[1].path()}, {});
    if (answer.contacts.empty()) continue;
    ++count;
    steps += static_cast<double>(answer.counts.steps);
    EXPECT_LE(answer.counts.steps, kMostSteps);
    EXPECT_EQ(answer.contacts[0].certainty, ContactCertainty::kCrossing);
  }
  EXPECT_GT(count, rounds(300) / 2);
  EXPECT_LE(steps / count, kMostMean);
}

/// Times that seem too early come last, but they come: features may be apart again later.
TEST(FCL_CONVEX_ADVANCE, unlikelyTimesAreTriedLast) {
  constexpr double kWidth = 1e-2, kError = 1e-14, kSpeed = 1;
  double latest = 1, earliest = 0;
  int count = 0;
  const auto find = [&](double likely) {
    count = 0;
    return provedTimeAfter(0, kWidth, kError, kSpeed, likely, [&](double time) {
      ++count;
      return earliest <= time && time <= latest;
    });
  };
  for (const double likely : {0., 1e-10, 1e-3, 1.}) {
    SCOPED_TRACE(likely);
    earliest = 0;
    latest = 1e-12;
    EXPECT_LE(find(likely), latest);
    EXPECT_GT(find(likely), 0);
    latest = 1;
    EXPECT_GE(find(likely), std::min(likely, kWidth));
    EXPECT_EQ(count, 1);
    earliest = 1;
    EXPECT_EQ(find(likely), 0);
  }
}

/// A box that leaves a floor and comes back as fast: at its last step it came nearer by
/// nearly nothing in the mean. The proof of the contact may not wait until it has passed.
TEST(FCL_CONVEX_ADVANCE, contactAfterAReturnIsProved) {
  const ConvexShape box = ConvexShape::cuboid({5e-4, 5e-4, 5e-4});
  const Body floor({{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {Triangle(0, 1, 2)}});
  const BodyOnPath still(floor, ReferenceMotion().path());
  for (const double gap : {1e-12, 3e-12, 1e-9, 1e-5}) {
    SCOPED_TRACE(gap);
    // The height is gap + 0.4 t - t^2 / 2.
    double control[4][3] = {};
    const double turn[4][3] = {};
    for (int i = 0; i < 4; ++i) {
      const double t = i - 1;
      control[i][2] = 5e-4 + gap + 0.4 * t - 0.5 * t * t + 1. / 6;
    }
    const MovingBody body(box, MotionPath::spline(control, turn));
    const MovingConvex sets[2] = {movingConvexOf(body, 0), movingConvexOf(still.body, 0)};
    ConvexAdvance pair(sets[0], sets[1], 0, 1, BodyTolerance(body, still.body, 0));
    double time = 0;
    int steps = 100;
    AdvanceCounts counts;
    ASSERT_EQ(pair.advance(time, 1, steps, counts), AdvanceAnswer::kContact);
    EXPECT_NEAR(time, 0.8, 4 * gap + 1e-11);
    EXPECT_GT(pair.proveContact(time, 1e-2), time);
    EXPECT_LE(pair.proveContact(time, 1e-2), time + 1e-10);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

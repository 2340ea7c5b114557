// SPDX-License-Identifier: BSD-3-Clause
//
// Short series of what fcl_ccd_oracle_check compares at length: queries of bodies that
// turn against dense sampling, certified advancement and closed forms.
#include "motion_references.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fcl {
namespace test {
namespace {

TEST(MotionReferences, TriangleDistance) {
  const RealVector a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto to = [&](const RealVector& p, const RealVector& q, const RealVector& r) {
    const RealVector b[3] = {p, q, r};
    EXPECT_EQ(triangleDistance(a, b), triangleDistance(b, a));
    return static_cast<double>(triangleDistance(a, b));
  };
  // Face and vertex, two edges, edge and vertex, two vertices, a shared vertex.
  EXPECT_DOUBLE_EQ(to({0.2, 0.2, 0.5}, {0, 0, 2}, {1, 0, 3}), 0.5);
  EXPECT_DOUBLE_EQ(to({0.5, -0.25, -1}, {0.5, -0.25, 1}, {0.5, -2, 0}), 0.25);
  EXPECT_DOUBLE_EQ(to({0.5, -0.5, 0}, {0, -2, 0}, {1, -2, 0}), 0.5);
  EXPECT_DOUBLE_EQ(to({4, 4, 0}, {9, 4, 0}, {9, 9, 0}), std::sqrt(24.5));
  EXPECT_DOUBLE_EQ(to({1, 0, 0}, {2, 0, 0}, {2, 1, 5}), 0);
}

// No span deviates by more than the bound, and the bound is nearly reached by each kind
// of motion, rigid and deforming.
TEST(MotionReferences, BoundOnTheAcceleration) {
  MotionTally tally;
  for (std::uint64_t number = 0; number < 30000; ++number)
    ASSERT_EQ(spanDisagreement(number, tally), "") << number;
  for (const auto& kind : tally.worst_bound)
    for (const double worst : kind) {
      EXPECT_GE(worst, 0.5) << "a bound that is never nearly reached";
    }
}

TEST(MotionReferences, ClosedFormsOfTurns) {
  MotionTally tally;
  for (std::uint64_t number = 0; number < 10000; ++number)
    ASSERT_EQ(turnDisagreement(number, tally), "") << number;
  EXPECT_GE(tally.sampled, 1500u);
  EXPECT_GE(tally.crossings, 500u);
  // What else is reported touches within the tolerance.
  EXPECT_LE(tally.contacts, tally.sampled + tally.crossings + 10);
}

// Dense samples see no contact before the query, and advancement none after it.
TEST(MotionReferences, SamplesAndAdvancement) {
  const std::vector<Body> bodies = makeBodies();
  MotionTally tally;
  for (std::uint64_t number = 40; number < 48; ++number)
    EXPECT_EQ(meshDisagreement(bodies, number, 300, tally), "") << number;
  EXPECT_GE(tally.sampled, 3u);
  EXPECT_GE(tally.contacts, tally.sampled);
  EXPECT_GE(tally.advanced, tally.contacts);
}

// With advancement alone: a graze that samples pass over.
TEST(MotionReferences, AdvancementProvesThatBodiesAreApart) {
  const Body ball(makeIcosphere(2, 0.5)), other(makeIcosphere(2, 0.5));
  for (const double gap : {1e-2, 1e-3, 1e-4}) {
    // Around the z axis, on a circle with the other ball beside it.
    ReferenceMotion turn, rest;
    turn.reference = {-2, 0, 0};
    turn.turn(Vector3<double>::UnitZ(), 1);
    turn.end.translation() = turn.reference - turn.end.linear() * turn.reference;
    rest.beginning.translation() = rest.end.translation() =
        AngleAxis<double>(0.4, Vector3<double>::UnitZ()) *
            Vector3<double>(3 + gap, 0, 0) -
        Vector3<double>(2, 0, 0);
    EXPECT_EQ(provedApart(ball, turn, other, rest, 1e-6), 2);
    EXPECT_TRUE(ask(ball, turn.path(), other, rest.path()).contacts.empty());
    rest.move(Vector3<double>(0, 0, 0) - 0.05 * rest.end.translation().normalized());
    const double apart = provedApart(ball, turn, other, rest, 1e-6),
                 toc = timeOf(ask(ball, turn.path(), other, rest.path()));
    EXPECT_LE(apart, toc);
    EXPECT_NEAR(apart, toc, 1e-4);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// A shape that FCL has not: a core and a radius. Against distances in closed form.
#include <gtest/gtest.h>

#include <functional>

#include "curved/shape_contacts.h"
#include "sanitizer.h"
#include "turning_bodies.h"

namespace fcl {
namespace test {
namespace {
using namespace detail::deformable;
using Point = Vector3<double>;
const Point kHalf(0.4, 0.25, 0.1);
constexpr double kRounded = 0.15, kBall = 0.2, kTimes = 4000;
void expectContact(const MovingBody& box, const MovingBody& other, double min_distance,
                   const std::function<double(double)>& distance) {
  QueryOptions options;
  options.min_distance = min_distance;
  const QueryAnswer answer = queryShapeContacts(box, other, options);
  double first = 0;
  while (first <= kTimes && distance(first / kTimes) > min_distance) ++first;
  ASSERT_EQ(answer.shape_contacts.empty(), first > kTimes);
  if (first > kTimes) return;
  EXPECT_LE(answer.shape_contacts[0].toc_lo, first / kTimes);
  EXPECT_GE(answer.shape_contacts[0].toc_hi, (first - 1) / kTimes);
  if (first == 0) return;
  EXPECT_NEAR(distance(answer.shape_contacts[0].toc_lo), min_distance, 1e-9);
}

TEST(FCL_SHAPE_ROUNDED, boxMeetsABallAndATriangle) {
  const ConvexShape rounded(BoxCore({kHalf[0], kHalf[1], kHalf[2]}), kRounded);
  const ConvexShape ball(EdgeCore(0), kBall);
  const Body floor({{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {Triangle(0, 1, 2)}});
  for (int i = 0; i < rounds(100); ++i) {
    SCOPED_TRACE(i);
    Random random(7600 + i);
    ReferenceMotion motion = randomMotion(random, 0.9), way = randomMotion(random, 0.9);
    const double min_distance = i % 2 * 0.05;
    const auto pose = [&](double t) { return asTransform(motion.at(t)); };
    expectContact(
        {rounded, motion.path()}, {ball, way.path()}, min_distance, [&](double t) {
          const Point x = pose(t).inverse() * asTransform(way.at(t)).translation();
          return (x.cwiseAbs() - kHalf).cwiseMax(0).norm() - kRounded - kBall;
        });
    motion.move(Point(0, 0, 1));
    const BodyOnPath still(floor, ReferenceMotion().path());
    expectContact({rounded, motion.path()}, still.body, min_distance, [&](double t) {
      return pose(t).translation()[2] - pose(t).linear().row(2).cwiseAbs().dot(kHalf) -
             kRounded;
    });
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The gap of two convex sets that are placed so that it is known: the point of one set
// that is farthest along a direction lies at a distance from the one of the other set
// that is farthest in the opposite direction.
#include "shapes/convex_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mesh_generators.h"
#include "paths/posed_vector.h"
#include "posed_shape.h"
#include "shapes/curved_gap.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

constexpr double kRounding = 1e-14;
constexpr int kNumPairs = 200;

Vec randomUnit(Random& random) {
  const Vector3<double> d = randomDirection(random);
  return {d[0], d[1], d[2]};
}

ConvexShape randomConvex(const std::string& kind, Random& random) {
  const double size = random.uniform(0.2, 1), height = random.uniform(0.2, 2);
  if (kind == "ellipsoid") return ConvexShape::ellipsoid({size, height, 0.5});
  if (kind == "cone") return ConvexShape::cone(size, height);
  if (kind == "cylinder") return ConvexShape::cylinder(size, height);
  std::vector<Vec> points;
  for (int i = 0; i < 8; ++i) points.push_back(randomUnit(random));
  return ConvexShape::hull(points);
}

struct Case {
  ConvexShape shape[2];
  PosedConvex set[2];
  /// From the first set to the second one, and the gap along it.
  Vec direction;
  double gap;

  PosedConvex moved(int k, const Vec& way) const {
    PosedConvex out = set[k];
    for (Vec& corner : out.corner) corner = corner + way;
    const double add[3] = {way.x, way.y, way.z};
    for (int i = 0; i < 3; ++i) out.pose.translation[i] += add[i];
    return out;
  }
};

Pose randomPose(Random& random) {
  const Matrix3<double> turn =
      AngleAxis<double>(random.uniform(0, 3), randomDirection(random)).toRotationMatrix();
  Pose pose;
  for (int i = 0; i < 9; ++i) pose.rotation[i] = turn(i / 3, i % 3);
  return pose;
}

/// A direction, and the point of the set that is farthest along it. Of a triangle the
/// middle of an edge, at right angles to the direction.
Vec touchingPoint(const PosedConvex& set, Random& random, Vec& direction) {
  int id;
  if (set.shape) return set.support(direction, id);
  const Vec edge = set.corner[1] - set.corner[0],
            away = 0.5 * (set.corner[0] + set.corner[1]) - set.corner[2],
            across = cross(edge, cross(away, edge));
  direction = (1 / norm(across)) * across +
              random.uniform(-1, 1) * (1 / norm(cross(edge, away))) * cross(edge, away);
  direction = (1 / norm(direction)) * direction;
  return 0.5 * (set.corner[0] + set.corner[1]);
}

void setCase(const std::string& kind, double gap, Random& random, Case& out) {
  out.gap = gap;
  for (int k = 0; k < 2; ++k)
    out.set[k] = {&out.shape[k], nullptr, randomPose(random), {}};
  if (kind == "triangle") {
    out.set[1].shape = nullptr;
    for (Vec& corner : out.set[1].corner) corner = randomUnit(random);
  }
  Vec back = randomUnit(random);
  const Vec second = touchingPoint(out.set[1], random, back);
  out.direction = -1. * back;
  int id;
  const Vec first = out.set[0].support(out.direction, id);
  out.set[1] = out.moved(1, first - second + gap * out.direction);
}

struct Counts {
  /// Of all pairs, by Newton's method alone; and those that are found to overlap.
  int answered{0}, overlapping{0};
};

/// @param gap  negative: they overlap by that much along the direction
/// @param is_close  whether the points are at most twice as far apart as the gap
Counts checkPairs(const std::string& kind1, const std::string& kind2, double gap,
                  bool is_close) {
  Counts counts;
  Random random(17);
  for (int i = 0; i < kNumPairs; ++i) {
    SCOPED_TRACE(i);
    Case at{{randomConvex(kind1, random), randomConvex(kind2, random)}, {}, {}, 0};
    setCase(kind2, gap, random, at);
    const Vec guess = at.direction + 0.1 * randomUnit(random);
    ConvexGap newton{};
    newton.gap = -HUGE_VAL;
    counts.answered += CurvedGapSearch(at.set[0], at.set[1], 0, 0)
                           .run((1 / norm(guess)) * guess, newton);
    const ConvexGap found = convexGap(at.set[0], at.set[1], guess, 0, 0);
    counts.overlapping += found.depth > 0;
    EXPECT_LE(found.depth, std::max(-gap, 0.) + kRounding);
    if (gap > 0) {
      EXPECT_LE(found.gap, gap + kRounding);
      EXPECT_GE(found.distance, gap - kRounding);
      if (is_close) {
        EXPECT_LE(found.distance, 2 * found.gap + kRounding);
      }
    } else if (found.depth > 0) {
      EXPECT_LE(found.gap, kRounding);
    }
    // The order of the sets does not matter.
    const ConvexGap swapped = convexGap(at.set[1], at.set[0], -1. * guess, 0, 0);
    EXPECT_EQ(found.gap, swapped.gap);
    EXPECT_EQ(found.distance, swapped.distance);
    EXPECT_EQ(found.depth, swapped.depth);
  }
  return counts;
}

const char* const kAll[] = {"ellipsoid", "cone", "cylinder", "hull", "triangle"};

TEST(ConvexGap, OfAnEllipsoidIsFoundByNewtonsMethod) {
  for (const char* kind : kAll)
    for (const double gap : {1., 1e-2, 1e-4, 1e-8, 1e-11}) {
      SCOPED_TRACE(std::string(kind) + ", gap " + std::to_string(gap));
      const Counts counts = checkPairs("ellipsoid", kind, gap, true);
      EXPECT_GE(counts.answered, 0.95 * kNumPairs);
      EXPECT_EQ(counts.overlapping, 0);
    }
}

/// Where two tips are nearest to each other, the other method comes before this one, and
/// its points have about half of their digits.
TEST(ConvexGap, OfCirclesIsFoundByNewtonsMethodAsARule) {
  for (const char* circle : {"cone", "cylinder"})
    for (const char* kind : kAll)
      for (const double gap : {1., 1e-2, 1e-4, 1e-8, 1e-11}) {
        SCOPED_TRACE(std::string(circle) + ", " + kind + ", gap " + std::to_string(gap));
        const Counts counts = checkPairs(circle, kind, gap, gap >= 1e-4);
        if (gap >= 1e-4) {
          EXPECT_GE(counts.answered, 0.6 * kNumPairs);
        }
        EXPECT_EQ(counts.overlapping, 0);
      }
}

TEST(ConvexGap, ShallowOverlapsOfAnEllipsoidAreProvedByNewtonsMethod) {
  for (const char* kind : kAll)
    for (const double gap : {-1e-4, -1e-8, -1e-11}) {
      SCOPED_TRACE(std::string(kind) + ", gap " + std::to_string(gap));
      const Counts counts = checkPairs("ellipsoid", kind, gap, true);
      EXPECT_GE(counts.answered, 0.96 * kNumPairs);
      EXPECT_EQ(counts.overlapping, kNumPairs);
    }
}

/// The corners that were nearest before only begin the search: those of the same sets in
/// other poses, near or far, give the same gap.
TEST(FCL_CONVEX_GAP, knownCornersChangeNothing) {
  for (const char* kind : {"hull", "triangle"}) {
    SCOPED_TRACE(kind);
    Random random(23);
    int with_corners = 0;
    for (int i = 0; i < kNumPairs; ++i) {
      SCOPED_TRACE(i);
      Case at{{randomConvex("hull", random), randomConvex("hull", random)}, {}, {}, 0};
      setCase(kind, random.uniform(0.01, 1), random, at);
      constexpr double kNearly = 1 - 1e-9;
      const auto gapOf = [&](const PosedConvex& b, const NearestCorners& known) {
        // With this tolerance the search goes on until it has the largest gap.
        ConvexGap gap = convexGap(at.set[0], b, at.direction, 0, 0, known);
        for (int k = 0; k < 60 && gap.gap < kNearly * gap.distance; ++k)
          gap = convexGap(at.set[0], b, gap.direction, std::max(gap.gap, 0.), 0, known);
        return gap;
      };
      const ConvexGap before = gapOf(at.set[1], {});
      EXPECT_NEAR(before.gap, before.distance, 1e-8);
      with_corners += before.nearest.count > 0 ? 1 : 0;
      for (const double way : {1e-6, 0.1, 3.}) {
        const PosedConvex moved = at.moved(1, way * randomUnit(random));
        const ConvexGap fresh = gapOf(moved, {}), begun = gapOf(moved, before.nearest);
        EXPECT_EQ(fresh.depth > 0, begun.depth > 0);
        if (fresh.depth > 0) continue;
        EXPECT_NEAR(fresh.gap, begun.gap, 1e-8);
      }
      // The same corner three times.
      NearestCorners alike = before.nearest;
      alike.count = 3;
      for (auto& corner : alike.corner)
        std::copy(std::begin(before.nearest.corner[0]),
                  std::end(before.nearest.corner[0]), corner);
      EXPECT_NEAR(gapOf(at.set[1], alike).gap, before.gap, 1e-8);
    }
    EXPECT_EQ(with_corners, kNumPairs);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

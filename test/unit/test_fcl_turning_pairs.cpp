// SPDX-License-Identifier: BSD-3-Clause
//
// Eight pairs of features that turn (advance/turning_pairs.h) against one pair at a time,
// against sampled paths, and on each instruction set.
#include "advance/turning_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "advance/feature_advance.h"
#include "advance/triangle_advance.h"
#include "mesh_generators.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

constexpr int kLanes = TurningPairs::kWidth;

Vec toVec(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

Matrix3<double> randomTurn(Random& random, double angle) {
  return AngleAxis<double>(angle, random.point(1).normalized()).toRotationMatrix();
}

Pose toPose(const Matrix3<double>& rotation, const Vector3<double>& translation) {
  Pose pose;
  for (int i = 0; i < 9; ++i) pose.rotation[i] = rotation(i / 3, i % 3);
  for (int k = 0; k < 3; ++k) pose.translation[k] = translation[k];
  return pose;
}

/// @param kind  0: does not turn; 2: a screw
MotionPath randomPath(Random& random, std::size_t kind) {
  const double angle = kind == 0 ? 0 : std::pow(10, random.uniform(-4, 0.47));
  const Matrix3<double> rotation = randomTurn(random, 1);
  const Pose begin = toPose(rotation, random.point(0.1)),
             end = toPose(randomTurn(random, angle) * rotation, random.point(0.1));
  const Vector3<double> reference = random.point(0.5);
  if (kind == 2) return MotionPath::screw(begin, end);
  return MotionPath::interpolation(begin, end,
                                   {reference[0], reference[1], reference[2]});
}

/// A triangle that is near a place of the world at t.
BodyTriangle triangleNear(Random& random, const MotionPath& path, double t,
                          const Vector3<double>& place, bool deforms) {
  const Pose pose = path.pose(t);
  BodyTriangle out{};
  for (int i = 0; i < 3; ++i) {
    const Vec at = toVec(place + random.point(0.1)) - vecOf(pose.translation);
    out.corner[0][i] = out.corner[1][i] = rotatedBack(pose.rotation, at);
    if (deforms) out.corner[1][i] = out.corner[1][i] + toVec(random.point(0.03));
    out.vertex[i] = i;
  }
  return out;
}

/// Two bodies and eight pairs of features.
struct Scene {
  MotionPath path[2];
  bool deforms[2];
  BodyTriangle triangle[kLanes][2];
  TurningPairs pairs;

  explicit Scene(Random& random)
      : path{randomPath(random, random.index(3)), randomPath(random, random.index(3))},
        deforms{random.index(2) == 0, random.index(3) == 0} {
    pairs.kind = random.index(2) == 0 ? ContinuousContactKind::kVertexFace
                                      : ContinuousContactKind::kEdgeEdge;
    for (int lane = 0; lane < kLanes; ++lane) {
      const double t = random.uniform(0, 1);
      const Vector3<double> place = random.point(0.6);
      for (int k = 0; k < 2; ++k) {
        triangle[lane][k] = triangleNear(random, path[k], t, place, deforms[k]);
        pairs.setTriangle(lane, k, deforms[k], triangle[lane][k], 0);
      }
      pairs.first[lane] = random.index(2) == 0 ? 0 : random.uniform(0, 0.3);
      pairs.last[lane] = random.index(2) == 0 ? 1 : random.uniform(0.7, 1);
    }
  }

  bool isEdges() const { return pairs.kind == ContinuousContactKind::kEdgeEdge; }

  TurningBody body(int k) const {
    return {path[k].turn(), deforms[k], path[k].acceleration(0, 1)};
  }

  BodyTriangle feature(int lane, int k) const {
    if (!isEdges() && k == 1) return triangle[lane][1];
    return featureOf(triangle[lane][k], 0, isEdges() ? 1 : 0);
  }

  /// The distance of the features of a lane.
  double distance(int lane, double t) const {
    Vec at[2][3];
    for (int k = 0; k < 2; ++k) {
      const BodyTriangle x = feature(lane, k);
      const Pose pose = path[k].pose(t);
      for (int i = 0; i < 3; ++i)
        at[k][i] = posed(pose, (1 - t) * x.corner[0][i] + t * x.corner[1][i]);
    }
    const BodyTriangle a = feature(lane, 0), b = feature(lane, 1);
    return std::sqrt(nearestFeatures(at[0], at[1], {a, b}).square);
  }
};

/// The tolerance of bodies that contain all of these triangles, which move by less than
/// 0.1 in their frames.
BodyTolerance toleranceOf(const Scene& scene) {
  static const ConvexShape whole = ConvexShape::cuboid({1.2, 1.2, 1.2});
  BodyTolerance tolerance(MovingBody(whole, scene.path[0]),
                          MovingBody(whole, scene.path[1]), 0);
  tolerance.rate += 0x1p-46;
  return tolerance;
}

TEST(FCL_TURNING_PAIRS, contactsAreThoseOfOnePairAtATime) {
  constexpr double kTocErr = 1e-4;
  Random random(3);
  int num_contacts = 0, num_apart = 0, num_open = 0, num_proved = 0;
  for (int round = 0; round < 5000; ++round) {
    const Scene scene(random);
    const BodyTolerance tolerance = toleranceOf(scene);
    const TurningAnswers found = advanceTurning(
        scene.pairs, {scene.body(0), scene.body(1)},
        {tolerance.position, tolerance.rate, tolerance.touching, kTocErr, 1});
    for (int lane = 0; lane < kLanes; ++lane) {
      SCOPED_TRACE(testing::Message() << round << " " << lane);
      const double first = scene.pairs.first[lane], last = scene.pairs.last[lane];
      if (found.open >> lane & 1U) {
        ++num_open;
        continue;
      }
      const BodyTriangle a = scene.feature(lane, 0), b = scene.feature(lane, 1);
      double t = first;
      int steps = 10000;
      AdvanceCounts counts;
      TriangleAdvance single(scene.path[0], a, scene.path[1], b, first, last, tolerance);
      const bool is_contact =
          single.advance(t, last, steps, counts) == TriangleAdvance::Answer::kContact &&
          t <= last;
      ASSERT_EQ((found.yes >> lane & 1U) != 0, is_contact);
      const double end = is_contact ? found.toc_lo[lane] : last;
      // Further apart than the tolerance before.
      for (int i = 0; i < 50; ++i)
        ASSERT_GT(scene.distance(lane, first + i * (end - first) / 50),
                  is_contact && i == 0 ? 0 : 0.25 * tolerance.position);
      num_apart += !is_contact;
      if (!is_contact) continue;
      ++num_contacts;
      EXPECT_NEAR(end, t, 1e-7);
      EXPECT_LE(scene.distance(lane, end), tolerance.touching);
      const TriangleAdvance whole(scene.path[0], scene.triangle[lane][0], scene.path[1],
                                  scene.triangle[lane][1], end, last, tolerance);
      const double hi =
          end == 0
              ? 0
              : whole.proveContact(end, TriangleAdvance::bracketWidth(end, kTocErr, 1));
      EXPECT_EQ(found.toc_hi[lane], hi);
      num_proved += hi > end;
    }
  }
  EXPECT_GT(num_contacts, 3000);
  EXPECT_GT(num_apart, 3000);
  EXPECT_GT(num_proved, num_contacts / 2);
  EXPECT_LT(num_open, (num_contacts + num_apart) / 20);
}

TEST(FCL_TURNING_PAIRS, sameBitsOnAllMachines) {
  const auto all = allTurningKernels();
  Random random(4);
  for (int round = 0; round < 500; ++round) {
    const Scene scene(random);
    const BodyTolerance tolerance = toleranceOf(scene);
    const TurningBody body[2] = {scene.body(0), scene.body(1)};
    const TurningRequest request{tolerance.position, tolerance.rate, tolerance.touching,
                                 1e-4, 1};
    const TurningAnswers best = advanceTurning(scene.pairs, body, request);
    for (const auto kernel : all) {
      const TurningAnswers found = kernel(scene.pairs, body, request);
      ASSERT_EQ(found.open, best.open);
      ASSERT_EQ(found.yes, best.yes);
      for (int lane = 0; lane < kLanes; ++lane) {
        if ((best.yes >> lane & 1U) == 0) continue;
        ASSERT_EQ(found.toc_lo[lane], best.toc_lo[lane]);
        ASSERT_EQ(found.toc_hi[lane], best.toc_hi[lane]);
      }
    }
    // A pair does not depend on the others.
    for (int lane = 0; lane < kLanes; ++lane) {
      TurningPairs alone = scene.pairs;
      for (int k = 0; k < 2; ++k)
        alone.setTriangle(0, k, scene.deforms[k], scene.triangle[lane][k], 0);
      alone.first[0] = scene.pairs.first[lane];
      alone.last[0] = scene.pairs.last[lane];
      alone.fillUp(0);
      const TurningAnswers found = advanceTurning(alone, body, request);
      ASSERT_EQ(found.open & 1U, best.open >> lane & 1U);
      ASSERT_EQ(found.yes & 1U, best.yes >> lane & 1U);
      if ((found.yes & 1U) == 0) continue;
      ASSERT_EQ(found.toc_lo[0], best.toc_lo[lane]);
      ASSERT_EQ(found.toc_hi[0], best.toc_hi[lane]);
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

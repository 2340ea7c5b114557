// SPDX-License-Identifier: BSD-3-Clause
//
// Half turns. Both ways round are as long, so that the last rounding of the poses decides
// which one is shorter. A query follows the motion object: the reference is integrate().
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Pose = Transform3<double>;
using Vector = Vector3<double>;

constexpr double kPi = 3.14159265358979323846;

/// What is added to 180 degrees.
const std::vector<double>& angleOffsets() {
  static const std::vector<double> offsets = [] {
    std::vector<double> out{0};
    for (double offset = 1e-16; offset < 2e-3; offset *= 10)
      out.insert(out.end(), {offset, -offset});
    return out;
  }();
  return offsets;
}

/// Roll, pitch and yaw, in multiples of a step.
Pose gridPose(int i, int per_circle) {
  const double step = 2 * kPi / per_circle;
  const int roll = i % per_circle, pitch = i / per_circle % per_circle,
            yaw = i / per_circle / per_circle;
  Pose pose = Pose::Identity();
  pose.linear() = (AngleAxis<double>(yaw * step, Vector::UnitZ()) *
                   AngleAxis<double>(pitch * step, Vector::UnitY()) *
                   AngleAxis<double>(roll * step, Vector::UnitX()))
                      .toRotationMatrix();
  return pose;
}

/// The pose after about half a turn about an axis of the body.
Pose halfTurned(const Pose& pose, int i) {
  const double offset = angleOffsets()[i % angleOffsets().size()];
  const Vector axis = Vector::Unit(i / 7 % 3);
  Pose out = pose;
  if (offset == 0) {
    // Rounding has no part in this product.
    out.linear() =
        pose.linear() * (2 * axis * axis.transpose() - Matrix3<double>::Identity());
  } else {
    out.linear() =
        pose.linear() * AngleAxis<double>(kPi + offset, axis).toRotationMatrix();
  }
  return out;
}

Pose halfway(const MotionBase<double>& motion) {
  Pose tf;
  motion.integrate(0.5);
  motion.getCurrentTransform(tf);
  motion.integrate(0);
  return tf;
}

/// The path of a query, halfway.
Pose halfwayInQuery(const CollisionGeometry<double>& geometry,
                    const MotionBase<double>& motion) {
  detail::MovingGeometry<double> moving{};
  moving.geometry = &geometry;
  moving.path = detail::PathKind::kUnknown;
  EXPECT_TRUE(detail::readFclMotion(motion, moving));
  return detail::toTransform(detail::poseAt(moving, 0.5));
}

template <typename S>
Pose halfwayInQuery(const CollisionGeometry<S>& geometry, const Transform3<S>& beg,
                    const Transform3<S>& end, detail::PathKind path) {
  return detail::toTransform(
             detail::poseAt(detail::movingGeometry(&geometry, beg, end, path), S(0.5)))
      .template cast<double>();
}

void expectNear(const Pose& pose, const Pose& expected, double most) {
  ASSERT_LE((pose.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), most);
}

// Sanitizers make the test many times slower.
constexpr int stepOfPoses() { return kHasAddressSanitizer ? 101 : 1; }

class FCL_HALF_TURNS : public ::testing::Test {
 protected:
  const Sphere<double> sphere_{0.05};
  const Sphere<float> sphere_in_float_{0.05F};
  static constexpr int kPerCircle = 48;  // 7.5 degrees
};

TEST_F(FCL_HALF_TURNS, motionObjectsGoTheirOwnWay) {
  for (int i = 0; i < kPerCircle * kPerCircle * kPerCircle; i += stepOfPoses()) {
    Pose begin = gridPose(i, kPerCircle);
    Pose end = halfTurned(begin, i);
    begin.translation() = Vector(0.25, -1, 0.5);
    end.translation() = Vector(i % 5, 1, -0.125 * (i % 3));
    const ScrewMotion<double> screw(begin, end);
    const InterpMotion<double> turn(begin.linear(), begin.translation(), end.linear(),
                                    end.translation(), Vector(0.5, i % 2, -1));
    SCOPED_TRACE(i);
    expectNear(halfwayInQuery(sphere_, screw), halfway(screw), 1e-12);
    expectNear(halfwayInQuery(sphere_, turn), halfway(turn), 1e-12);
    if (HasFatalFailure()) return;
  }
}

TEST_F(FCL_HALF_TURNS, transformsGoTheWayOfFclsConstructors) {
  using detail::PathKind;
  for (int i = 0; i < kPerCircle * kPerCircle * kPerCircle; i += stepOfPoses()) {
    const Pose begin = gridPose(i, kPerCircle), end = halfTurned(begin, i);
    const Pose expected = halfway(ScrewMotion<double>(begin, end));
    SCOPED_TRACE(i);
    // A rigid body turns about its origin also with CCDM_TRANS, which is kStraight.
    for (const PathKind path : {PathKind::kScrew, PathKind::kTurn})
      expectNear(halfwayInQuery(sphere_, begin, end, path), expected, 1e-13);
    // In float FCL has no such motion. The rule is the same, on the given numbers.
    const Transform3<float> begin_in_float = begin.cast<float>(),
                            end_in_float = end.cast<float>();
    const Pose expected_in_float = halfway(
        ScrewMotion<double>(begin_in_float.cast<double>(), end_in_float.cast<double>()));
    for (const PathKind path : {PathKind::kScrew, PathKind::kTurn})
      expectNear(halfwayInQuery(sphere_in_float_, begin_in_float, end_in_float, path),
                 expected_in_float, 1e-5);
    if (HasFatalFailure()) return;
  }
}

/// Motions whose axis a program compiled with other instructions has rounded otherwise:
/// the other way of a half turn.
class OtherInterpMotion : public InterpMotion<double> {
 public:
  static void turnRound(InterpMotion<double>& motion) {
    motion.*(&OtherInterpMotion::angular_axis) *= -1;
  }
};
class OtherScrewMotion : public ScrewMotion<double> {
 public:
  static void turnRound(ScrewMotion<double>& motion) {
    motion.*(&OtherScrewMotion::axis) *= -1;
    motion.*(&OtherScrewMotion::linear_vel) *= -1;
  }
};

TEST_F(FCL_HALF_TURNS, theAxisOfTheObjectCountsNotThatOfItsPoses) {
  for (int i = 0; i < 1000; ++i) {
    Pose begin = gridPose(i, 10);
    Pose end = halfTurned(begin, 0);
    begin.translation() = Vector(1, -1, 2);
    InterpMotion<double> turn(begin.linear(), begin.translation(), end.linear(),
                              end.translation(), Vector(0, 1, 0));
    ScrewMotion<double> screw(begin, end);
    for (int round = 0; round < 2; ++round) {
      expectNear(halfwayInQuery(sphere_, turn), halfway(turn), 1e-12);
      expectNear(halfwayInQuery(sphere_, screw), halfway(screw), 1e-12);
      OtherInterpMotion::turnRound(turn);
      OtherScrewMotion::turnRound(screw);
    }
  }
}

// FCL's constructor of (tf1, tf2, O) leaves the axis as it was in memory.
TEST_F(FCL_HALF_TURNS, anAxisThatWasNeverSetIsNotRead) {
  const Pose begin = gridPose(123, 10), end = halfTurned(begin, 0);
  const Vector reference(0, 1, 0);
  using Motion = InterpMotion<double>;
  const Pose expected = halfway(Motion(begin.linear(), begin.translation(), end.linear(),
                                       end.translation(), reference));
  for (const double left_in_memory : {0., 1., -1., 1e300, std::nan("")}) {
    alignas(64) unsigned char memory[sizeof(Motion)];
    for (std::size_t k = 0; k + sizeof(double) <= sizeof(Motion); k += sizeof(double))
      *reinterpret_cast<double*>(memory + k) = left_in_memory;
    auto* motion = new (memory) Motion(begin, end, reference);
    expectNear(halfwayInQuery(sphere_, *motion), expected, 1e-13);
    motion->~Motion();
  }
}

/// A tetrahedron with a corner at (1, 0, 0), which passes a ball halfway.
TEST_F(FCL_HALF_TURNS, queriesHitWhatIsOnTheWay) {
  TestMesh mesh;
  mesh.vertices = {{1.01, 0, 0}, {0.99, 0.01, 0}, {0.99, -0.01, 0}, {1, 0, 0.01}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  const auto model = makeModel<BVHModel<OBBRSS<double>>>(mesh);
  int queries = 0;
  for (int i = 0; i < 24 * 24 * 24; i += 3 * stepOfPoses()) {
    const Pose begin = gridPose(i, 24), end = halfTurned(begin, i / 24);
    const ScrewMotion<double> screw(begin, end);
    const InterpMotion<double> turn(begin.linear(), begin.translation(), end.linear(),
                                    end.translation(), Vector::Zero());
    Pose at = Pose::Identity();
    at.translation() = halfway(screw) * Vector(1, 0, 0);
    // A turn about the x axis of the body does not move the corner.
    if ((at.translation() - begin * Vector(1, 0, 0)).norm() < 0.5) continue;
    ++queries;
    SCOPED_TRACE(i);
    ContinuousCollisionRequest<double> request;
    ContinuousCollisionResult<double> result;
    const auto expectHit = [&] {
      ASSERT_TRUE(result.is_collide);
      ASSERT_LT(result.time_of_contact, 0.5);
      ASSERT_GT(result.time_of_contact, 0.45);
      result = {};
    };
    const TranslationMotion<double> rest(at, at);
    continuousCollide(model.get(), &screw, &sphere_, &rest, request, result);
    expectHit();
    continuousCollide(&sphere_, &rest, model.get(), &turn, request, result);
    expectHit();
    for (const auto type : {CCDM_SCREW, CCDM_LINEAR, CCDM_TRANS}) {
      request.ccd_motion_type = type;
      continuousCollide(model.get(), begin, end, &sphere_, at, at, request, result);
      expectHit();
    }
    if (HasFatalFailure()) return;
    // On the other way nothing is hit.
    Pose other = at;
    other.translation() *= -1;
    continuousCollide(model.get(), begin, end, &sphere_, other, other, request, result);
    ASSERT_FALSE(result.is_collide);
  }
  EXPECT_GT(queries, 10);
}

}  // namespace
}  // namespace test
}  // namespace fcl

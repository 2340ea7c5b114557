// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel of boxes that turn against scalar code, bit for bit, and against sampled
// points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh_generators.h"
#include "motion/motion_boxes.h"
#include "numerics/moving_vector.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

Vec vecOf(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

Vec rotated(const double (&r)[9], const Vec& v) {
  return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
          r[6] * v.x + r[7] * v.y + r[8] * v.z};
}

Vec turnedBack(const double (&r)[9], const Vec& v) {
  return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
          r[2] * v.x + r[5] * v.y + r[8] * v.z};
}

/// Two boxes along a direction: b's center minus a's, and the sum of the reaches.
struct Projection {
  double between, reach;

  Projection(const MotionBox& a, const Pose& pose_a, const MotionBox& b,
             const Pose& pose_b, const Vec& d) {
    const Vec center =
        rotated(pose_a.rotation, vecOf(a.center)) + vecOf(pose_a.translation);
    const Vec body = turnedBack(pose_b.rotation, d);
    between = dot(body, vecOf(b.center)) + dot(d, vecOf(pose_b.translation) - center);
    reach = 0;
    for (int i = 0; i < 3; ++i)
      reach +=
          std::abs(dot(d, a.extent[i] * rotated(pose_a.rotation, vecOf(a.axis[i])))) +
          std::abs(dot(body, vecOf(b.axis[i]))) * b.extent[i];
  }
};

/// The kernel's computation for one pair, in the order of the kernel.
class ScalarWindow {
 public:
  ScalarWindow(const MotionBox (&a)[2], const SpanPoses& pose_a, const MotionBox (&b)[2],
               const SpanPoses& pose_b, double margin, const Vec& calm,
               double calm_margin)
      : a_(a), b_(b), pose_a_(pose_a), pose_b_(pose_b), margin_(margin) {
    const auto centerAt = [&a](int end, const Pose& pose) {
      return rotated(pose.rotation, vecOf(a[end].center)) + vecOf(pose.translation);
    };
    const Vec center_a = 0.5 * (centerAt(0, pose_a.beginning) + centerAt(1, pose_a.end));
    const Vec from = 0.5 * (vecOf(b[0].center) + vecOf(b[1].center));
    const Vec between = rotated(pose_b.middle.rotation, from) +
                        (vecOf(pose_b.middle.translation) - center_a);
    tryDirection((1 / std::max(std::sqrt(dot(between, between)), 0x1p-500)) * between);
    margin_ = calm_margin;
    tryDirection(calm);
    margin_ = margin;
    for (int i = 0; i < 3; ++i)
      tryDirection(rotated(pose_a.middle.rotation, vecOf(a[0].axis[i])));
    for (int i = 0; i < 3; ++i)
      tryDirection(rotated(pose_b.middle.rotation, vecOf(b[0].axis[i])));
  }

  bool mayMeet() const { return may_meet_; }
  double lo() const { return before_; }
  double hi() const { return 1 - after_; }

 private:
  void tryDirection(const Vec& d) {
    const Projection p0(a_[0], pose_a_.beginning, b_[0], pose_b_.beginning, d),
        p1(a_[1], pose_a_.end, b_[1], pose_b_.end, d);
    const double reach0 = p0.reach + margin_, reach1 = p1.reach + margin_,
                 depth0 = std::abs(p0.between) - reach0,
                 depth1 = std::abs(p1.between) - reach1,
                 other1 = (p0.between < 0 ? -p1.between : p1.between) - reach1,
                 other0 = (p1.between < 0 ? -p0.between : p0.between) - reach0;
    if (depth0 > 0 && other1 > 0) may_meet_ = false;
    if (depth0 > 0 && other1 <= 0)
      before_ = std::max(before_, depth0 / (depth0 - other1));
    if (depth1 > 0 && other0 <= 0) after_ = std::max(after_, depth1 / (depth1 - other0));
    if (before_ + after_ > 1) may_meet_ = false;
  }

  const MotionBox (&a_)[2];
  const MotionBox (&b_)[2];
  const SpanPoses& pose_a_;
  const SpanPoses& pose_b_;
  double margin_;
  bool may_meet_{true};
  double before_{0}, after_{0};
};

Vector3<double> randomUnit(Random& random) {
  const Vector3<double> v = random.point(1);
  return v.norm() > 0.1 ? Vector3<double>(v.normalized()) : Vector3<double>::UnitX();
}

Matrix3<double> randomRotation(Random& random, double most) {
  return AngleAxis<double>(random.uniform(0, most), randomUnit(random))
      .toRotationMatrix();
}

Pose toPose(const Matrix3<double>& rotation, const Vector3<double>& translation) {
  Pose pose;
  for (int i = 0; i < 9; ++i) pose.rotation[i] = rotation(i / 3, i % 3);
  for (int k = 0; k < 3; ++k) pose.translation[k] = translation[k];
  return pose;
}

SpanPoses randomPoses(Random& random, double reach, double turn) {
  const Matrix3<double> rotation = randomRotation(random, 3);
  const Vector3<double> axis = randomUnit(random), from = random.point(reach),
                        way = random.point(0.5 * reach);
  const double angle = random.uniform(0, turn);
  const auto at = [&](double t) {
    return toPose(AngleAxis<double>(t * angle, axis).toRotationMatrix() * rotation,
                  from + t * way);
  };
  return {at(0), at(0.5), at(1)};
}

MotionBox randomBox(Random& random) {
  MotionBox box{};
  const Matrix3<double> axes = randomRotation(random, 3);
  const Vector3<double> center = random.point(0.5);
  for (int i = 0; i < 3; ++i) {
    box.center[i] = center[i];
    for (int k = 0; k < 3; ++k) box.axis[i][k] = axes(k, i);
    box.extent[i] = random.index(8) == 0 ? 0 : random.uniform(0, 0.4);
  }
  return box;
}

TEST(MotionKernels, EqualScalarCode) {
  Random random(1);
  int met = 0, apart = 0, part = 0;
  for (int round = 0; round < 4000; ++round) {
    const double reach = random.uniform(0.2, 4);
    const SpanPoses pose_a = randomPoses(random, reach, 1),
                    pose_b = randomPoses(random, reach, 1);
    MotionBox a[2] = {randomBox(random), {}};
    a[1] = a[0];
    a[1].extent[0] *= 1.1;
    MotionBox b[8][2];
    MotionBoxes boxes[2] = {};
    double margin[8];
    const int count = 1 + static_cast<int>(random.index(8));
    for (int lane = 0; lane < 8; ++lane) {
      b[lane][0] = randomBox(random);
      b[lane][1] = b[lane][0];
      b[lane][1].center[1] += random.uniform(-0.1, 0.1);
      for (int end = 0; end < 2; ++end) boxes[end].set(lane, b[lane][end]);
      margin[lane] = random.index(4) == 0 ? 0 : random.uniform(0, 0.05);
    }
    const MotionBoxes* const ends[2] = {&boxes[0], &boxes[1]};
    const Vector3<double> unit = randomUnit(random);
    const Vec calm = {unit[0], unit[1], unit[2]};
    CalmDirection calms[2] = {};
    CalmDirection& used = calms[random.index(2)];
    used.direction = &calm;
    for (int lane = 0; lane < 8; ++lane) used.margin[lane] = 0.5 * margin[lane];
    MeetingWindows windows;
    motionKernels().meetingWindows(a, pose_a, ends, pose_b, margin, calms, count,
                                   windows);
    for (int lane = 0; lane < count; ++lane) {
      const ScalarWindow scalar(a, pose_a, b[lane], pose_b, margin[lane], calm,
                                used.margin[lane]);
      ASSERT_EQ((windows.mask >> lane & 1U) != 0, scalar.mayMeet());
      (scalar.mayMeet() ? met : apart) += 1;
      if (!scalar.mayMeet()) continue;
      ASSERT_EQ(windows.lo[lane], scalar.lo());
      ASSERT_EQ(windows.hi[lane], scalar.hi());
      part += scalar.lo() > 0 || scalar.hi() < 1;
    }
    ASSERT_EQ(windows.mask >> count, 0u);
  }
  // Each outcome occurs often.
  EXPECT_GT(met, 1000);
  EXPECT_GT(apart, 1000);
  EXPECT_GT(part, 500);
}

}  // namespace
}  // namespace test
}  // namespace fcl

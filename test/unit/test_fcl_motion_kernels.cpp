// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of boxes and triangles that turn against scalar code, bit for bit, and
// against points between the poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/vertex_frames.h"
#include "mesh_generators.h"
#include "numerics/moving_vector.h"
#include "shapes/body_boxes.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

/// Two boxes along a direction: b's center minus a's, and the sum of the reaches.
struct Projection {
  double between, reach;

  Projection(const BodyBox& a, const Pose& pose_a, const BodyBox& b, const Pose& pose_b,
             const Vec& d) {
    const Vec center =
        rotated(pose_a.rotation, vecOf(a.center)) + vecOf(pose_a.translation);
    const Vec body = rotatedBack(pose_b.rotation, d);
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
  ScalarWindow(const BodyBox (&a)[3], const SpanPoses& pose_a, const BodyBox (&b)[3],
               const SpanPoses& pose_b, double margin, const Vec& calm,
               double calm_margin)
      : a_(a),
        b_(b),
        pose_a_{&pose_a.beginning, &pose_a.middle, &pose_a.end},
        pose_b_{&pose_b.beginning, &pose_b.middle, &pose_b.end},
        margin_(margin) {
    const Vec center_a = rotated(pose_a.middle.rotation, vecOf(a[1].center)) +
                         vecOf(pose_a.middle.translation);
    const Vec between = rotated(pose_b.middle.rotation, vecOf(b[1].center)) +
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
  double gap() const { return gap_; }

 private:
  /// The gaps at the beginning, in the middle and at the end, to the side on which b is
  /// at one of these times.
  struct Gaps {
    double at[3];
    Gaps(const Projection (&p)[3], int side, double margin) {
      for (int k = 0; k < 3; ++k)
        at[k] =
            (p[side].between < 0 ? -p[k].between : p[k].between) - (p[k].reach + margin);
    }
    double least() const { return std::min({at[0], at[1], at[2]}); }
  };

  /// The part of the span before the gap closes, from where `first` is.
  static double lossOf(double first, double middle, double last) {
    return middle > 0 ? 0.5 + 0.5 * (middle / (middle - last))
                      : 0.5 * (first / (first - middle));
  }

  void tryDirection(const Vec& d) {
    const auto at = [&](int k) {
      return Projection(a_[k], *pose_a_[k], b_[k], *pose_b_[k], d);
    };
    const Projection p[3] = {at(0), at(1), at(2)};
    const Gaps from(p, 0, margin_), to(p, 2, margin_);
    const bool apart = from.at[0] > 0 && from.at[1] > 0 && from.at[2] > 0;
    if (apart) may_meet_ = false;
    if (from.at[0] > 0 && !apart)
      before_ = std::max(before_, lossOf(from.at[0], from.at[1], from.at[2]));
    if (to.at[2] > 0 && !apart)
      after_ = std::max(after_, lossOf(to.at[2], to.at[1], to.at[0]));
    if (before_ + after_ > 1) may_meet_ = false;
    gap_ = std::max({gap_, from.least(), to.least()});
  }

  const BodyBox (&a_)[3];
  const BodyBox (&b_)[3];
  const Pose* pose_a_[3];
  const Pose* pose_b_[3];
  double margin_;
  bool may_meet_{true};
  double before_{0}, after_{0};
  double gap_{-HUGE_VAL};
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

BodyBox randomBox(Random& random) {
  BodyBox box{};
  const Matrix3<double> axes = randomRotation(random, 3);
  const Vector3<double> center = random.point(0.5);
  for (int i = 0; i < 3; ++i) {
    box.center[i] = center[i];
    for (int k = 0; k < 3; ++k) box.axis[i][k] = axes(k, i);
    box.extent[i] = random.index(8) == 0 ? 0 : random.uniform(0, 0.4);
  }
  return box;
}

TEST(BodyKernels, EqualScalarCode) {
  Random random(1);
  int met = 0, apart = 0, part = 0;
  for (int round = 0; round < 4000; ++round) {
    const double reach = random.uniform(0.2, 4);
    const SpanPoses pose_a = randomPoses(random, reach, 1),
                    pose_b = randomPoses(random, reach, 1);
    BodyBox a[3] = {randomBox(random), {}, {}};
    a[1] = a[2] = a[0];
    a[1].extent[0] *= 1.05;
    a[2].extent[0] *= 1.1;
    BodyBox b[8][3];
    BodyBoxes boxes[3] = {};
    double margin[8];
    const int count = 1 + static_cast<int>(random.index(8));
    for (int lane = 0; lane < 8; ++lane) {
      b[lane][0] = randomBox(random);
      b[lane][1] = b[lane][2] = b[lane][0];
      const double way = random.uniform(-0.1, 0.1);
      b[lane][1].center[1] += 0.5 * way;
      b[lane][2].center[1] += way;
      for (int k = 0; k < 3; ++k) boxes[k].set(lane, b[lane][k]);
      margin[lane] = random.index(4) == 0 ? 0 : random.uniform(0, 0.05);
    }
    const Vector3<double> unit = randomUnit(random);
    const Vec calm = {unit[0], unit[1], unit[2]};
    CalmDirection calms[2] = {};
    CalmDirection& used = calms[random.index(2)];
    used.direction = &calm;
    for (int lane = 0; lane < 8; ++lane) used.margin[lane] = 0.5 * margin[lane];
    const BodyBox* const of_a[3] = {&a[0], &a[1], &a[2]};
    const BodyBoxes* const of_b[3] = {&boxes[0], &boxes[1], &boxes[2]};
    MeetingWindows windows, with_gaps;
    bodyKernels().meetingWindows(of_a, pose_a, of_b, pose_b, margin, calms, count,
                                 windows);
    bodyKernels().meetingWindowsWithGaps(of_a, pose_a, of_b, pose_b, margin, calms, count,
                                         with_gaps);
    ASSERT_EQ(with_gaps.mask, windows.mask);
    for (int lane = 0; lane < count; ++lane) {
      const ScalarWindow scalar(a, pose_a, b[lane], pose_b, margin[lane], calm,
                                used.margin[lane]);
      ASSERT_EQ((windows.mask >> lane & 1U) != 0, scalar.mayMeet());
      (scalar.mayMeet() ? met : apart) += 1;
      if (!scalar.mayMeet()) continue;
      ASSERT_EQ(windows.lo[lane], scalar.lo());
      ASSERT_EQ(windows.hi[lane], scalar.hi());
      ASSERT_EQ(with_gaps.lo[lane], scalar.lo());
      ASSERT_EQ(with_gaps.hi[lane], scalar.hi());
      ASSERT_EQ(with_gaps.gap[lane], scalar.gap());
      part += scalar.lo() > 0 || scalar.hi() < 1;
    }
    ASSERT_EQ(windows.mask >> count, 0u);
  }
  // Each outcome occurs often.
  EXPECT_GT(met, 1000);
  EXPECT_GT(apart, 1000);
  EXPECT_GT(part, 500);
}

/// The corners of a triangle at the beginning, in the middle and at the end of a span.
struct SpanCorners {
  Vec corner[3][3];
};

/// The kernel's decision for one pair and one half, in the order of the kernel.
class ScalarHalf {
 public:
  ScalarHalf(const SpanCorners& a, const SpanCorners& b, double deviation, double margin)
      : a_(a), b_(b), four_deviations_(4 * deviation), margin_(margin) {}

  bool mayMeet(int half) const {
    const SpanCorners* const x[2] = {&a_, &b_};
    Vec normal[2];
    for (int body = 0; body < 2; ++body) {
      const Vec(&p)[3] = x[body]->corner[1];
      normal[body] = cross(p[1] - p[0], p[2] - p[0]);
      if (parts(normal[body], half)) return false;
    }
    for (int body = 0; body < 2; ++body)
      for (int i = 0; i < 3; ++i) {
        const Vec(&p)[3] = x[body]->corner[1];
        if (parts(cross(normal[body], p[(i + 1) % 3] - p[i]), half)) return false;
      }
    return true;
  }

 private:
  static double gapIn(const Vec& d, const Vec (&a)[3], const Vec (&b)[3]) {
    const auto least = [&](const Vec(&x)[3]) {
      return std::min({dot(d, x[0]), dot(d, x[1]), dot(d, x[2])});
    };
    const auto most = [&](const Vec(&x)[3]) {
      return std::max({dot(d, x[0]), dot(d, x[1]), dot(d, x[2])});
    };
    return least(b) - most(a);
  }

  bool parts(const Vec& v, int half) const {
    Vec d = (1 / std::max(std::sqrt(dot(v, v)), 0x1p-500)) * v;
    const double along = gapIn(d, a_.corner[1], b_.corner[1]),
                 against = gapIn(d, b_.corner[1], a_.corner[1]);
    if (!(along > margin_ || against > margin_)) return false;
    if (against > along) d = -1. * d;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double g0 = gap(d, half, i, j), g1 = gap(d, half + 1, i, j),
                     lack = four_deviations_ - (g0 + g1);
        if (!(g0 > 0 && g1 > 0)) return false;
        if (!(lack < 0 || 4 * (1 - 0x1p-40) * (g0 * g1) > lack * lack)) return false;
      }
    return true;
  }

  double gap(const Vec& d, int at, int i, int j) const {
    return dot(d, b_.corner[at][j]) - (dot(d, a_.corner[at][i]) + margin_);
  }

  SpanCorners a_, b_;
  double four_deviations_;
  double margin_;
};

/// A triangle of about the size in the frame of its body, at t = 0 and t = 1.
void randomTriangle(Random& random, double size, double way, Vec (&out)[2][3]) {
  const Vector3<double> center = random.point(0.5);
  for (int i = 0; i < 3; ++i) {
    const Vector3<double> p = center + random.point(size), q = p + random.point(way);
    out[0][i] = {p[0], p[1], p[2]};
    out[1][i] = {q[0], q[1], q[2]};
  }
}

SpanCorners inWorld(const Vec (&x)[2][3], const double (&times)[3],
                    const SpanPoses& poses) {
  const Pose* const pose[3] = {&poses.beginning, &poses.middle, &poses.end};
  SpanCorners out;
  for (int at = 0; at < 3; ++at)
    for (int i = 0; i < 3; ++i)
      out.corner[at][i] =
          rotated(pose[at]->rotation, (1 - times[at]) * x[0][i] + times[at] * x[1][i]) +
          vecOf(pose[at]->translation);
  return out;
}

TEST(BodyKernels, HalvesEqualScalarCode) {
  const double times[3] = {0.25, 0.375, 0.5};
  Random random(2);
  int met = 0, apart = 0, one = 0;
  for (int round = 0; round < 4000; ++round) {
    const double reach = random.uniform(0, 0.5), size = random.uniform(0.05, 0.8);
    const SpanPoses pose_a = randomPoses(random, reach, 0.5),
                    pose_b = randomPoses(random, reach, 0.5);
    Vec of_a[2][3];
    randomTriangle(random, size, 0.1, of_a);
    const SpanCorners a = inWorld(of_a, times, pose_a);
    SpanTriangle triangle;
    for (int at = 0; at < 3; ++at)
      for (int i = 0; i < 3; ++i) {
        const Vec& p = a.corner[at][i];
        triangle.corner[at][i][0] = p.x;
        triangle.corner[at][i][1] = p.y;
        triangle.corner[at][i][2] = p.z;
      }
    const double margin = random.uniform(0, 0.01);
    Vec of_b[8][2][3];
    double deviation[8];
    BodyTriangles triangles;
    for (int lane = 0; lane < 8; ++lane) {
      deviation[lane] = random.index(4) == 0 ? 0 : random.uniform(0, 0.03);
      randomTriangle(random, size, 0.1, of_b[lane]);
      for (int frame = 0; frame < 2; ++frame)
        for (int i = 0; i < 3; ++i) {
          const Vec& x = of_b[lane][frame][i];
          triangles.corner[frame][i][0][lane] = x.x;
          triangles.corner[frame][i][1][lane] = x.y;
          triangles.corner[frame][i][2][lane] = x.z;
        }
    }
    const auto tested = static_cast<unsigned>(1 + random.index(255));
    unsigned meeting[2];
    bodyKernels().meetingHalves(triangle, triangles, times, pose_b, deviation, margin,
                                tested, meeting);
    for (int lane = 0; lane < 8; ++lane) {
      const ScalarHalf scalar(a, inWorld(of_b[lane], times, pose_b), deviation[lane],
                              margin);
      const bool is_tested = (tested >> lane & 1U) != 0;
      bool meets[2];
      for (int half = 0; half < 2; ++half) {
        meets[half] = (meeting[half] >> lane & 1U) != 0;
        ASSERT_EQ(meets[half], is_tested && scalar.mayMeet(half));
      }
      if (!is_tested) continue;
      (meets[0] || meets[1] ? met : apart) += 1;
      one += meets[0] != meets[1];
    }
    ASSERT_EQ((meeting[0] | meeting[1]) >> 8, 0u);
  }
  // Each outcome occurs often.
  EXPECT_GT(met, 1000);
  EXPECT_GT(apart, 1000);
  EXPECT_GT(one, 300);
}

// Triangles at the same height above each other at all three times. In between a corner
// deviates by less than the height, or by more.
TEST(BodyKernels, DeviationBetweenTheEndsOfAHalf) {
  SpanTriangle floor;
  BodyTriangles above = {};
  const double corner[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  constexpr double kHeight = 0.25;
  double deviation[8];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      for (auto& at : floor.corner) at[i][k] = corner[i][k];
      for (int lane = 0; lane < 8; ++lane)
        above.corner[0][i][k][lane] = k == 2 ? kHeight : corner[i][k];
    }
  for (int lane = 0; lane < 8; ++lane)
    deviation[lane] = kHeight * (1 + (lane < 4 ? -0x1p-30 : 0x1p-30));
  unsigned meeting[2];
  bodyKernels().meetingHalves(floor, above, nullptr, SpanPoses(), deviation, 0, 0xff,
                              meeting);
  EXPECT_EQ(meeting[0], 0xf0u);
  EXPECT_EQ(meeting[1], 0xf0u);
  // The requested distance is taken off first.
  bodyKernels().meetingHalves(floor, above, nullptr, SpanPoses(), deviation, 0x1p-20,
                              0xff, meeting);
  EXPECT_EQ(meeting[0], 0xffu);
}

}  // namespace
}  // namespace test
}  // namespace fcl

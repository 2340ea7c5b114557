// SPDX-License-Identifier: BSD-3-Clause
//
// Candidates of meshes that turn, against the contacts of the same meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "moving_mesh.h"
#include "scene_data.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Rigid = BVHModel<OBBRSS<double>>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Geometry = CollisionGeometry<double>;
using Motion = MotionBase<double>;

/// A pair of features, by side and sorted ids.
using Name = std::pair<bool, PairName>;
using Windows = std::map<Name, std::pair<double, double>>;

template <typename Pair>
Name featuresOf(const Pair& pair) {
  std::array<int, 4> v;
  std::copy(pair.vertices.begin(), pair.vertices.begin() + 4, v.begin());
  const bool is_face = pair.kind == ContinuousContactKind::kVertexFace;
  if (!is_face) std::sort(v.begin(), v.begin() + 2);
  std::sort(v.begin() + (is_face ? 1 : 2), v.end());
  return {pair.first_on_o1, {is_face ? 0 : 1, v[0], v[1], v[2], v[3]}};
}

/// The candidates by name; each must come once.
template <typename Ask>
Windows windowsOf(Ask&& ask) {
  Windows windows;
  EXPECT_TRUE(ask([&](const ContinuousCandidate* candidates, std::size_t count) {
    EXPECT_GE(count, 1U);
    for (std::size_t i = 0; i < count; ++i) {
      const ContinuousCandidate& c = candidates[i];
      EXPECT_LE(0, c.window_lo);
      EXPECT_LE(c.window_lo, c.window_hi);
      EXPECT_LE(c.window_hi, 1);
      EXPECT_TRUE(
          windows.emplace(featuresOf(c), std::pair(c.window_lo, c.window_hi)).second);
    }
    return true;
  }));
  return windows;
}

/// Every contact must be a candidate, and begin within its window.
/// @return the number of contacts
std::size_t expectContactsAmong(const Windows& windows,
                                const ContinuousContactResult<double>& result) {
  for (const auto& contact : result.contacts) {
    const auto at = windows.find(featuresOf(contact));
    if (at == windows.end()) {
      ADD_FAILURE() << "a contact is no candidate";
      continue;
    }
    EXPECT_GE(contact.toc_lo, at->second.first);
    EXPECT_LE(contact.toc_lo, at->second.second);
  }
  return result.contacts.size();
}

class MotionCandidates : public ::testing::Test {
 protected:
  /// Two crumpled sheets; each one deforms or not.
  static std::shared_ptr<Geometry> sheet(Random& random, bool deforms) {
    const MovingMesh mesh = crumpledSheet(random, 5, 0.2);
    const TestMesh at_start{mesh.t0, mesh.triangles};
    if (!deforms) return makeModel<Rigid>(at_start);
    auto model = makeModel<Model>(at_start);
    EXPECT_EQ(model->updateFrames(mesh.previous(), mesh.current(), mesh.t0.size()),
              BVH_OK);
    return model;
  }

  static Transform3<double> randomPose(Random& random, double angle) {
    Transform3<double> tf = Transform3<double>::Identity();
    tf.linear() =
        Eigen::AngleAxisd(angle, random.point(1).normalized()).toRotationMatrix();
    tf.translation() = random.point(0.4);
    return tf;
  }

  static std::shared_ptr<Motion> randomMotion(Random& random, std::uint64_t kind) {
    const Transform3<double> begin = randomPose(random, 0.3),
                             end = randomPose(random, 2.5);
    if (kind % 3 == 0) return std::make_shared<ScrewMotion<double>>(begin, end);
    if (kind % 3 == 1)
      return std::make_shared<InterpMotion<double>>(begin.linear(), begin.translation(),
                                                    end.linear(), end.translation(),
                                                    random.point(0.5));
    return std::make_shared<SplineMotion<double>>(
        random.point(0.3), random.point(0.3), random.point(0.3), random.point(0.3),
        random.point(1), random.point(1), random.point(1), random.point(1));
  }
};

TEST_F(MotionCandidates, HoldAllContactsOfMotions) {
  std::size_t contacts = 0, candidates = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto o1 = sheet(random, seed & 1), o2 = sheet(random, seed & 2);
    const auto motion1 = randomMotion(random, seed),
               motion2 = randomMotion(random, seed + 1);
    const Windows windows = windowsOf([&](const ContinuousCandidateSink& sink) {
      return continuousCandidates(o1.get(), motion1.get(), o2.get(), motion2.get(), sink);
    });
    ContinuousContactRequest<double> request;
    ContinuousContactResult<double> result;
    continuousCollide(o1.get(), motion1.get(), o2.get(), motion2.get(), request, result);
    contacts += expectContactsAmong(windows, result);
    candidates += windows.size();
  }
  EXPECT_GE(contacts, 3000U);
  EXPECT_GE(candidates, contacts);
}

TEST_F(MotionCandidates, HoldAllContactsBetweenTransforms) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto o1 = sheet(random, false), o2 = sheet(random, seed & 1);
    const Transform3<double> still = Transform3<double>::Identity(),
                             begin = randomPose(random, 0.1), end = randomPose(random, 1);
    const Windows windows = windowsOf([&](const ContinuousCandidateSink& sink) {
      return continuousCandidates(o1.get(), begin, end, o2.get(), still, still, sink);
    });
    ContinuousContactRequest<double> request;
    request.ccd_motion_type = CCDM_TRANS;  // the rotation counts all the same
    ContinuousContactResult<double> result;
    continuousCollide(o1.get(), begin, end, o2.get(), still, still, request, result);
    contacts += expectContactsAmong(windows, result);
  }
  EXPECT_GE(contacts, 300U);
}

/// A triangle on a wide arc meets another one far from the chord of the arc.
TEST_F(MotionCandidates, FollowTheArc) {
  const auto triangleAt = [](double angle) {
    const Vector3<double> out(std::cos(angle), std::sin(angle), 0), up(0, 0, 0.1);
    return makeModel<Rigid>(
        TestMesh{{out - up, 1.1 * out, out + up}, {Triangle(0, 1, 2)}});
  };
  constexpr double kTurn = 2.8;
  Transform3<double> still = Transform3<double>::Identity(), end = still;
  end.linear() = Eigen::AngleAxisd(kTurn, Vector3<double>::UnitZ()).toRotationMatrix();
  const auto moving = triangleAt(0);
  for (const double angle : {0.3, 0.7, 1.4, 2.1, 2.6}) {
    SCOPED_TRACE(angle);
    const auto other = triangleAt(angle);
    const Windows windows = windowsOf([&](const ContinuousCandidateSink& sink) {
      return continuousCandidates(moving.get(), still, end, other.get(), still, still,
                                  sink);
    });
    ContinuousContactRequest<double> request;
    request.ccd_motion_type = CCDM_LINEAR;
    ContinuousContactResult<double> result;
    continuousCollide(moving.get(), still, end, other.get(), still, still, request,
                      result);
    EXPECT_NEAR(result.time_of_contact, angle / kTurn, 1e-12);
    EXPECT_GE(expectContactsAmong(windows, result), 1U);
  }
}

/// Two balls of 1280 triangles that turn: what cannot meet is not handed out.
TEST_F(MotionCandidates, LeaveOutWhatIsApart) {
  const auto ball = makeModel<Rigid>(makeIcosphere(3, 1));
  const auto candidatesAt = [&](double distance) {
    Transform3<double> begin = Transform3<double>::Identity(), end = begin;
    begin.translation()[0] = end.translation()[0] = distance;
    end.linear() = Eigen::AngleAxisd(1.5, Vector3<double>::UnitX()).toRotationMatrix();
    const Transform3<double> still = Transform3<double>::Identity();
    return windowsOf([&](const ContinuousCandidateSink& sink) {
             return continuousCandidates(ball.get(), begin, end, ball.get(), still, still,
                                         sink);
           })
        .size();
  };
  EXPECT_EQ(candidatesAt(2.1), 0U);
  const std::size_t touching = candidatesAt(1.999);
  EXPECT_GE(touching, 10U);
  EXPECT_LE(touching, 5000U);
}

/// The caller's rounding mode changes no candidate, and is the caller's in the sink and
/// afterwards.
TEST_F(MotionCandidates, KeepTheCallersFloatingPointMode) {
  const auto ball = makeModel<Rigid>(makeIcosphere(2, 1));
  Transform3<double> still = Transform3<double>::Identity(), end = still;
  end.linear() = Eigen::AngleAxisd(1, Vector3<double>::UnitX()).toRotationMatrix();
  const auto ask = [&](int mode) {
    std::fesetround(mode);
    const Windows windows = windowsOf([&](const ContinuousCandidateSink& sink) {
      return continuousCandidates(
          ball.get(), still, end, ball.get(), still, still,
          [&](const ContinuousCandidate* candidates, std::size_t count) {
            EXPECT_EQ(std::fegetround(), mode);
            return sink(candidates, count);
          });
    });
    EXPECT_EQ(std::fegetround(), mode);
    std::fesetround(FE_TONEAREST);
    return windows;
  };
  const Windows expected = ask(FE_TONEAREST);
  EXPECT_EQ(ask(FE_UPWARD), expected);
  EXPECT_EQ(ask(FE_DOWNWARD), expected);
}

TEST_F(MotionCandidates, EndWhenTheSinkWantsNoMore) {
  const auto ball = makeModel<Rigid>(makeIcosphere(2, 1));
  Transform3<double> still = Transform3<double>::Identity(), end = still;
  end.linear() = Eigen::AngleAxisd(1, Vector3<double>::UnitX()).toRotationMatrix();
  int blocks = 0;
  EXPECT_FALSE(continuousCandidates(ball.get(), still, end, ball.get(), still, still,
                                    [&](const auto*, std::size_t) {
                                      ++blocks;
                                      return false;
                                    }));
  EXPECT_EQ(blocks, 1);
}

/// A motion of the program.
class Hop : public TranslationMotion<double> {
 public:
  using TranslationMotion<double>::TranslationMotion;
};

TEST_F(MotionCandidates, RefuseWhatIsNotKnown) {
  const auto ball = makeModel<Rigid>(makeIcosphere(1, 1));
  const Transform3<double> still = Transform3<double>::Identity();
  const TranslationMotion<double> rest(still, still);
  const Hop hop(still, still);
  const auto take = [](const ContinuousCandidate*, std::size_t) { return true; };
  const auto ask = [&](const Motion* motion1, const Motion* motion2,
                       const ContinuousCandidateSink& sink) {
    continuousCandidates(ball.get(), motion1, ball.get(), motion2, sink);
  };
  expectRefused([&] { ask(&rest, &hop, take); },
                "o2, a triangle mesh, follows a motion class");
  expectRefused([&] { ask(nullptr, &rest, take); }, "motion1 is null");
  expectRefused([&] { ask(&rest, &rest, nullptr); }, "sink is null");
}

}  // namespace
}  // namespace test
}  // namespace fcl

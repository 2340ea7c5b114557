// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of several balls on each kind of motion, against FCL's poses at many times: the
// time is never late, and no contact is missed. And what must not change an answer: parts
// that are far, the kind of the query, and a pose that is rounded.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/compound_geometry.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/joint_chain.h"
#include "fcl/math/motion/twist_motion.h"
#include "fcl/math/motion/waypoint_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "moving_objects.h"
#include "paths/motion_path.h"
#include "prepare/nearest_rotation.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Tf = Transform3<double>;
using Motion = std::shared_ptr<MotionBase<double>>;
using Compound = CompoundGeometry<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Rigid = BVHModel<OBBRSS<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;

Tf at(double x, double y, double z) { return Tf(Translation3<double>(x, y, z)); }

Tf randomPose(Random& random, double size) {
  Tf tf = Tf::Identity();
  tf.linear() = randomRotation(random);
  tf.translation() = random.point(size);
  return tf;
}

Tf turned(Random& random, const Tf& from, double way) {
  Tf to = from;
  to.linear() =
      AngleAxis<double>(random.uniform(.1, 2.9), randomDirection(random)).matrix() *
      from.linear();
  to.pretranslate(random.point(way));
  return to;
}

constexpr int kNumMotions = 8;

/// @param kind  below kNumMotions
Motion randomMotion(Random& random, int kind) {
  const Tf from = randomPose(random, 1), to = turned(random, from, 1);
  switch (kind) {
    case 0: {
      Tf shifted = from;
      shifted.pretranslate(random.point(2));
      return std::make_shared<TranslationMotion<double>>(from, shifted);
    }
    case 1:
      return std::make_shared<InterpMotion<double>>(from.linear(), from.translation(),
                                                    to.linear(), to.translation(),
                                                    random.point(1));
    case 2:
      return std::make_shared<ScrewMotion<double>>(from, to);
    case 3: {
      Vector t[4], r[4];
      for (int i = 0; i < 4; ++i) {
        t[i] = random.point(2);
        r[i] = random.point(2);
      }
      return std::make_shared<SplineMotion<double>>(t[0], t[1], t[2], t[3], r[0], r[1],
                                                    r[2], r[3]);
    }
    case 4:
      return std::make_shared<TwistMotion<double>>(
          from, random.point(1), random.point(6),
          random.index(2) == 0 ? ReferencePath::kScrew : ReferencePath::kStraight,
          random.point(1));
    case 5: {
      const aligned_vector<Tf> poses{from, to, turned(random, to, 1)};
      return std::make_shared<WaypointMotion<double>>(poses,
                                                      std::vector<double>{0, .4, 1});
    }
    case 6: {
      JointChain chain;
      for (int i = 0; i < 3; ++i)
        chain.addRevolute(randomPose(random, .5), randomDirection(random));
      const auto value = [&] { return random.uniform(-3, 3); };
      return ChainMotion(chain, {value(), value(), value()}, {value(), value(), value()})
          .link(2);
    }
    default:
      return std::make_shared<BoundedThrow>(random.point(1), random.point(2),
                                            random.point(3));
  }
}

Tf poseAt(const Motion& motion, double t) {
  motion->integrate(t);
  Tf tf;
  motion->getCurrentTransform(tf);
  return tf;
}

/// Balls at places on a body.
struct Balls {
  std::vector<Vector> centers;
  std::vector<double> radii;
  Compound compound;
  Motion motion;

  Balls(Random& random, int kind) : motion(randomMotion(random, kind)) {
    for (std::size_t n = 1 + random.index(5); n > 0; --n) {
      centers.push_back(random.point(1.2));
      radii.push_back(random.uniform(.05, .4));
      Tf offset = randomPose(random, 1);
      offset.translation() = centers.back();
      compound.addPart(std::make_shared<Sphere<double>>(radii.back()), offset);
    }
  }
};

/// The least gap of two balls at a time.
double gapAt(const Balls& a, const Balls& b, double t) {
  const Tf pose_a = poseAt(a.motion, t), pose_b = poseAt(b.motion, t);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.centers.size(); ++i)
    for (std::size_t k = 0; k < b.centers.size(); ++k)
      least = std::min(least, (pose_a * a.centers[i] - pose_b * b.centers[k]).norm() -
                                  a.radii[i] - b.radii[k]);
  return least;
}

TEST(CompoundMotions, BallsTouchWhereTheyAreOnEachMotion) {
  constexpr double kTolerance = 1e-9;
  Random random(41);
  int num_contacts = 0, num_free = 0;
  for (int n = 0; n < 6 * kNumMotions * kNumMotions; ++n) {
    SCOPED_TRACE("pair " + std::to_string(n));
    const Balls a(random, n % kNumMotions), b(random, n / kNumMotions % kNumMotions);
    Request request;
    request.query = n % 2 == 0 ? ContinuousQuery::kFirst : ContinuousQuery::kAll;
    request.min_distance = n % 3 == 0 ? .05 : 0;
    Result result;
    continuousCollide(&a.compound, a.motion.get(), &b.compound, b.motion.get(), request,
                      result);
    ++(result.is_collide ? num_contacts : num_free);
    constexpr int kTimes = 300;
    for (int i = 0; i <= kTimes; ++i) {
      const double t = double(i) / kTimes;
      if (t >= result.time_of_contact && result.is_collide) break;
      ASSERT_GE(gapAt(a, b, t), request.min_distance - kTolerance) << t;
    }
    if (!result.is_collide) continue;
    const ContinuousContact<double>& first = result.contacts.at(0);
    ASSERT_LE(gapAt(a, b, first.toc_hi), request.min_distance + 1e-7);
    const auto i = std::size_t(first.part1), k = std::size_t(first.part2);
    const double gap = (poseAt(a.motion, first.toc_hi) * a.centers.at(i) -
                        poseAt(b.motion, first.toc_hi) * b.centers.at(k))
                           .norm() -
                       a.radii[i] - b.radii[k];
    ASSERT_LE(gap, request.min_distance + 1e-7);
  }
  EXPECT_GT(num_contacts, 60);
  EXPECT_GT(num_free, 60);
}

using Values = std::vector<
    std::tuple<double, double, int, int, std::intptr_t, std::intptr_t, double, double>>;

Values valuesOf(const Result& result) {
  Values out;
  for (const auto& c : result.contacts)
    out.emplace_back(c.toc_lo, c.toc_hi, c.part1, c.part2, c.b1, c.b2, c.pos[0],
                     c.normal[1]);
  return out;
}

/// Parts that are far, and come last, leave all bits of an answer as they are.
TEST(CompoundMotions, FarPartsChangeNothing) {
  Random random(43);
  const auto mesh = makeModel<Rigid>(makeIcosphere(1, .2));
  int num_contacts = 0;
  for (int n = 0; n < 4 * kNumMotions * kNumMotions; ++n) {
    SCOPED_TRACE("pair " + std::to_string(n));
    Compound near[2], both[2];
    Motion motion[2];
    for (int side = 0; side < 2; ++side) {
      motion[side] = randomMotion(
          random, side == 0 ? n % kNumMotions : n / kNumMotions % kNumMotions);
      const auto add = [&](const std::shared_ptr<CollisionGeometry<double>>& geometry,
                           const Tf& offset, bool is_near) {
        if (is_near) near[side].addPart(geometry, offset);
        both[side].addPart(geometry, offset);
      };
      for (int i = 0; i < 2; ++i)
        add(std::make_shared<Box<double>>(.3, .2, .5), randomPose(random, .8), true);
      add(mesh, randomPose(random, .8), true);
      // So far that they do not meet those of the other body, however it moves.
      for (int i = 0; i < 3; ++i)
        add(mesh, at(side == 0 ? 100 : 300, i, 20 * random.uniform(-1, 1)), false);
    }
    for (const ContinuousQuery query :
         {ContinuousQuery::kFirst, ContinuousQuery::kAny, ContinuousQuery::kAll}) {
      Request request;
      request.query = query;
      request.min_distance = n % 3 == 0 ? .03 : 0;
      request.enable_crossings = query == ContinuousQuery::kAll;
      Result few, all;
      continuousCollide(&near[0], motion[0].get(), &near[1], motion[1].get(), request,
                        few);
      continuousCollide(&both[0], motion[0].get(), &both[1], motion[1].get(), request,
                        all);
      ASSERT_EQ(few.is_collide, all.is_collide);
      ASSERT_EQ(few.time_of_contact, all.time_of_contact);
      ASSERT_EQ(few.initially_crossing, all.initially_crossing);
      ASSERT_EQ(few.crossings.size(), all.crossings.size());
      ASSERT_EQ(few.counts.triangle_pairs, all.counts.triangle_pairs);
      ASSERT_EQ(valuesOf(few), valuesOf(all));
      num_contacts += few.is_collide ? 1 : 0;
    }
  }
  EXPECT_GT(num_contacts, 100);
}

/// Parts in another order have the same times to the bit, also where some touch together.
TEST(CompoundMotions, FirstDoesNotDependOnNumbers) {
  Random random(67);
  const auto mesh = makeModel<Rigid>(makeIcosphere(2, .2));
  const auto wall = makeModel<Rigid>(makeBox({3, 3, .1}, 4));
  int num_contacts = 0;
  for (int n = 0; n < 40; ++n) {
    std::vector<Tf> offsets;
    for (int i = 0; i < 5; ++i) {
      offsets.push_back(i % 2 == 0 ? randomPose(random, .3) : Tf::Identity());
      offsets.back().translation() = Vector(.5 * i - 1, 0, 1e-5 * (i % 3));
    }
    Compound forward, backward;
    for (int i = 0; i < 5; ++i) {
      forward.addPart(mesh, offsets[std::size_t(i)]);
      backward.addPart(mesh, offsets[std::size_t(4 - i)]);
    }
    const Tf from = at(0, 0, 1);
    Tf to = at(0, 0, -.1);
    if (n % 2 == 1) to.linear() = AngleAxis<double>(.5, Vector::UnitZ()).matrix();
    const ScrewMotion<double> motion(from, to);
    const TranslationMotion<double> still(Tf::Identity(), Tf::Identity());
    Request request;
    request.query = ContinuousQuery::kFirst;
    Result one, other, all;
    continuousCollide(&forward, &motion, wall.get(), &still, request, one);
    continuousCollide(&backward, &motion, wall.get(), &still, request, other);
    request.query = ContinuousQuery::kAll;
    continuousCollide(&forward, &motion, wall.get(), &still, request, all);
    ASSERT_EQ(one.is_collide, other.is_collide);
    ASSERT_EQ(one.time_of_contact, other.time_of_contact);
    ASSERT_EQ(one.contacts.size(), other.contacts.size());
    ASSERT_NEAR(one.time_of_contact, all.time_of_contact, request.toc_err);
    num_contacts += one.is_collide ? 1 : 0;
  }
  EXPECT_GT(num_contacts, 10);
}

/// A mesh that deforms, and a compound that turns between two transforms, against each
/// part by itself.
TEST(CompoundMotions, MeetsAMeshThatDeforms) {
  Random random(47);
  const TestMesh sheet = makeBox({1, 1, .05}, 5);
  const std::vector<std::shared_ptr<CollisionGeometry<double>>> all{
      makeModel<Rigid>(makeIcosphere(1, .2)), std::make_shared<Box<double>>(.3, .2, .4),
      std::make_shared<Sphere<double>>(.2)};
  int num_contacts = 0, num_free = 0;
  for (int n = 0; n < 60; ++n) {
    TestMesh next = sheet;
    for (Vector& v : next.vertices)
      v += .2 * random.point(1) + Vector(0, 0, .1 * (n % 7));
    const auto cloth = makeModel<Deformable>(sheet, next);
    const Tf from = randomPose(random, .1),
             to = n % 3 == 0 ? from : turned(random, from, .5);
    const Tf high = at(0, 0, 1.5) * from, low = at(0, 0, 1.5 - .3 * (n % 6)) * to;
    Request request;
    request.ccd_motion_type = n % 2 == 0 ? CCDM_LINEAR : CCDM_SCREW;
    Compound body;
    std::vector<Tf> offsets;
    for (const auto& part : all) {
      offsets.push_back(randomPose(random, .4));
      body.addPart(part, offsets.back());
    }
    Result result, one;
    continuousCollide(&body, high, low, cloth.get(), Tf::Identity(), Tf::Identity(),
                      request, result);
    double first = 1;
    bool touches = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Tf beg = high * offsets[i], end = low * offsets[i];
      // A turn of the body about its origin turns a part about this point.
      const Vector reference = offsets[i].inverse() * Vector(0, 0, 0);
      const InterpMotion<double> turn(beg.linear(), beg.translation(), end.linear(),
                                      end.translation(), reference);
      const ScrewMotion<double> screw(beg, end);
      const TranslationMotion<double> still(Tf::Identity(), Tf::Identity());
      const MotionBase<double>* motion = &turn;
      if (n % 2 == 1) motion = &screw;
      continuousCollide(all[i].get(), motion, cloth.get(), &still, request, one);
      first = std::min(first, one.time_of_contact);
      touches |= one.is_collide;
    }
    ASSERT_EQ(result.is_collide, touches) << n;
    ASSERT_NEAR(result.time_of_contact, first, request.toc_err + 1e-9) << n;
    ++(touches ? num_contacts : num_free);
  }
  EXPECT_GT(num_contacts, 10);
  EXPECT_GT(num_free, 1);
}

/// The nearest rotation to a pose is not rounded to float, which would move a part at the
/// end of a long arm out of its box.
TEST(CompoundMotions, FindsPartsWhereReplacedPosesPutThem) {
  Random random(53);
  constexpr double kArm = 1000, kRadius = .5;
  int num_contacts = 0, num_free = 0;
  for (int n = 0; n < 300; ++n) {
    CompoundGeometry<float> rod;
    rod.addPart(std::make_shared<Sphere<float>>(float(kRadius)), at(kArm, 0, 0));
    const Matrix3<float> rotation = 1.005f * randomRotation(random).cast<float>();
    Transform3<float> tf = Transform3<float>::Identity();
    tf.linear() = rotation;
    double nearest[9];
    for (int i = 0; i < 9; ++i) nearest[i] = double(rotation(i / 3, i % 3));
    ASSERT_TRUE(detail::deformable::toNearestRotation(nearest));
    Vector center;
    for (int i = 0; i < 3; ++i) center[i] = kArm * nearest[3 * i];
    // Where boxes of balls touch with these.
    const Vector direction = (n % 2 == 0 ? 1. : -1.) * Vector::Unit(n % 3);
    const Sphere<float> ball(float{kRadius});
    Transform3<float> place = Transform3<float>::Identity();
    place.translation() =
        (center + (2 * kRadius + random.uniform(-1e-4, 1e-4)) * direction).cast<float>();
    const double gap = (place.translation().cast<double>() - center).norm() - 2 * kRadius;
    if (std::abs(gap) < 1e-7) continue;
    ContinuousContactResult<float> result;
    continuousCollide(&rod, tf, tf, &ball, place, place,
                      ContinuousContactRequest<float>(), result);
    ASSERT_EQ(result.is_collide, gap < 0) << gap;
    ++(gap < 0 ? num_contacts : num_free);
  }
  EXPECT_GT(num_contacts, 30);
  EXPECT_GT(num_free, 30);
}

/// A part on the axis of its body is hardly accelerated, but not less than its path is.
TEST(CompoundMotions, BoundsHoldOnTheAxis) {
  using namespace detail::deformable;
  Random random(59);
  for (int n = 0; n < 300; ++n) {
    ReferenceMotion motion;
    motion.kind = n % 2 == 0 ? ReferenceMotion::Kind::kScrew
                             : ReferenceMotion::Kind::kInterpolation;
    motion.beginning = motion.end = randomPose(random, 2);
    motion.turn(randomDirection(random), random.uniform(.5, 3));
    motion.reference = random.point(1);
    const MotionPath body = motion.path();
    const Turn& turn = *body.turn();
    // a x (R c + T) + P = 0 at c.
    const Vec axis = turn.axis, from = vecOf(turn.beginning.translation),
              on_axis = cross(axis, vecOf(turn.sine_translation) - cross(axis, from));
    Tf offset = Tf::Identity();
    offset.translation() =
        motion.beginning.linear().transpose() *
        (Vector(on_axis.x, on_axis.y, on_axis.z) - motion.beginning.translation());
    offset.linear() = randomRotation(random);
    const MotionPath path = body.placed(toPose(offset));
    for (int i = 0; i < 20; ++i) {
      const Vector p = (i % 2 == 0 ? 0. : 1e-15) * random.point(1);
      const Vec x{p[0], p[1], p[2]};
      const PoseRate second = path.turnAccelerationAt(random.uniform(0, 1));
      ASSERT_LE(norm(rotated(second.rotation, x) + vecOf(second.translation)),
                path.acceleration(0, 1).of(x, 0));
    }
  }
}

/// A query refuses the same arguments, whether parts are near or far.
TEST(CompoundMotions, RefusesAlsoWhatIsFar) {
  const Tf here = Tf::Identity(), far = at(100, 0, 0);
  const auto sheet = makeModel<Rigid>(makeBox({1, 1, 1}, 1));
  Compound body;
  const auto ask = [&](const Request& request) {
    return errorOf([&] {
      Result result;
      continuousCollide(&body, far, far, sheet.get(), here, here, request, result);
    });
  };
  body.addPart(std::make_shared<Sphere<double>>(1));
  Request request;
  request.filter2.triangle_groups = {1, 2};
  expectMessage(ask(request), "request.filter2.triangle_groups has 2 entries");
  const TestMesh mesh = makeIcosphere(1, .2);
  const auto model = makeModel<Deformable>(mesh);
  body.addPart(model);
  EXPECT_EQ(ask(Request()), "");
  TestMesh moved = mesh;
  for (Vector& v : moved.vertices) v[0] -= 100;
  update(*model, moved);
  expectMessage(ask(Request()),
                "part 1 of a CompoundGeometry, o1, is a mesh that deforms");
}

/// FCL's constructor of two poses leaves the reference point as it was in memory.
TEST(CompoundMotions, NamesAReferencePointThatIsNotFinite) {
  Compound body;
  body.addPart(std::make_shared<Sphere<double>>(1));
  Random random(61);
  const Tf from = randomPose(random, 1), to = turned(random, from, 1);
  const Vector nowhere = Vector::Constant(std::numeric_limits<double>::quiet_NaN());
  const InterpMotion<double> turn(from.linear(), from.translation(), to.linear(),
                                  to.translation(), nowhere);
  const TranslationMotion<double> still(Tf::Identity(), Tf::Identity());
  expectMessage(errorOf([&] {
                  Result result;
                  continuousCollide(&body, &turn, &body, &still, Request(), result);
                }),
                "o1: the reference point of the InterpMotion is not finite");
}

}  // namespace
}  // namespace test
}  // namespace fcl

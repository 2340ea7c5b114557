// SPDX-License-Identifier: BSD-3-Clause
//
// Motion classes of a program that tell their bounds: against closed forms, and against
// FCL's motions on the same path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/bounded_motion.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/math/motion/twist_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "moving_mesh.h"
#include "paths/motion_path.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Rigid = BVHModel<OBBRSS<double>>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Vector = Vector3<double>;

/// What FCL wants of a motion class, for a turn about z by angle(t) while the origin goes
/// along way(t).
class Turn : public MotionBase<double>, public BoundedMotion {
 public:
  Placement placementAt(double t) const override {
    const double c = std::cos(angle(t)), s = std::sin(angle(t));
    const Vector at = way(t);
    return {{c, -s, 0, s, c, 0, 0, 0, 1}, {at[0], at[1], at[2]}};
  }
  Placement rateAt(double t) const override {
    const double c = angleRate(t) * std::cos(angle(t)),
                 s = angleRate(t) * std::sin(angle(t));
    const Vector at = wayRate(t);
    return {{-s, -c, 0, c, -s, 0, 0, 0, 0}, {at[0], at[1], at[2]}};
  }

  bool integrate(double t) const override {
    t_ = t;
    return true;
  }
  double computeMotionBound(const BVMotionBoundVisitor<double>&) const override {
    return 1e3;
  }
  double computeMotionBound(const TriangleMotionBoundVisitor<double>&) const override {
    return 1e3;
  }
  void getCurrentTransform(Transform3<double>& tf) const override {
    const Placement at = placementAt(t_);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) tf.linear()(i, k) = at.rotation[3 * i + k];
      tf.translation()[i] = at.translation[i];
    }
  }
  void getTaylorModel(TMatrix3<double>&, TVector3<double>&) const override {}

 protected:
  virtual double angle(double t) const = 0;
  virtual double angleRate(double t) const = 0;
  virtual Vector way(double t) const = 0;
  virtual Vector wayRate(double t) const = 0;

 private:
  mutable double t_{0};
};

double norm(const double (&v)[3]) { return std::hypot(v[0], v[1], v[2]); }

/// Swings by amplitude * sin(frequency * t), and falls by drop * t^2.
class Pendulum : public Turn {
 public:
  Pendulum(double amplitude, double frequency, double drop)
      : amplitude_(amplitude), frequency_(frequency), drop_(drop) {}

  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override {
    // |angle''| + angle'^2 is a bound on |R''|.
    const double rate = angularSpeedBound(t0, t1);
    return (amplitude_ * frequency_ * frequency_ + rate * rate) *
               (norm(center) + radius) +
           2 * drop_;
  }
  double angularSpeedBound(double, double) const override {
    return amplitude_ * frequency_;
  }
  /// When it has turned so far.
  double timeOf(double angle) const { return std::asin(angle / amplitude_) / frequency_; }

 protected:
  double angle(double t) const override { return amplitude_ * std::sin(frequency_ * t); }
  double angleRate(double t) const override {
    return amplitude_ * frequency_ * std::cos(frequency_ * t);
  }
  Vector way(double t) const override { return {0, 0, -drop_ * t * t}; }
  Vector wayRate(double t) const override { return {0, 0, -2 * drop_ * t}; }

 private:
  double amplitude_, frequency_, drop_;
};

/// Turns at constant speed while its origin goes straight, as FCL's InterpMotion.
class SteadyTurn : public Turn {
 public:
  SteadyTurn(double angle, const Vector& way) : angle_(angle), way_(way) {}

  double accelerationBound(const double (&center)[3], double radius, double,
                           double) const override {
    return angle_ * angle_ * (norm(center) + radius);
  }
  double angularSpeedBound(double, double) const override { return angle_; }

  InterpMotion<double> asInterpolation() const {
    const Matrix3<double> end =
        AngleAxis<double>(angle_, Vector::UnitZ()).toRotationMatrix();
    return InterpMotion<double>(Matrix3<double>::Identity(), Vector::Zero(), end, way_,
                                Vector::Zero());
  }

 protected:
  double angle(double t) const override { return angle_ * t; }
  double angleRate(double) const override { return angle_; }
  Vector way(double t) const override { return t * way_; }
  Vector wayRate(double) const override { return way_; }

 private:
  double angle_;
  Vector way_;
};

/// Rests until t = 0.3, and rises then.
class LateRise : public Turn {
 public:
  double accelerationBound(const double (&)[3], double, double,
                           double t1) const override {
    return t1 <= kStart ? 0 : kAcceleration;
  }
  double angularSpeedBound(double, double) const override { return 0; }

 protected:
  double angle(double) const override { return 0; }
  double angleRate(double) const override { return 0; }
  Vector way(double t) const override {
    return {0, 0, 0.5 * kAcceleration * std::pow(std::max(t - kStart, 0.), 2)};
  }
  Vector wayRate(double t) const override {
    return {0, 0, kAcceleration * std::max(t - kStart, 0.)};
  }

 private:
  static constexpr double kStart = 0.3, kAcceleration = 1e4;
};

constexpr double kHalfWidth = 0.0625;

/// A bar along x from the axis to 2.
TestMesh makeBar() { return moved(makeBox({1, kHalfWidth, kHalfWidth}, 4), 1, 0, 0); }

/// A plate that stands in a plane through the z axis, from a distance of kNear on.
constexpr double kNear = 1.05;
TestMesh makePlate(double angle) {
  const Vector out(std::cos(angle), std::sin(angle), 0), up(0, 0, 9);
  return {{kNear * out - up, 1.45 * out - up, 1.45 * out + up, kNear * out + up},
          {Triangle(0, 1, 2), Triangle(0, 2, 3)}};
}

class BoundedMotions : public ::testing::Test {
 protected:
  std::shared_ptr<Rigid> bar_ = makeModel<Rigid>(makeBar());
  TranslationMotion<double> still_{Transform3<double>::Identity(),
                                   Transform3<double>::Identity()};

  template <typename Request, typename Result>
  double collide(const CollisionGeometry<double>& o1, const MotionBase<double>& motion,
                 const CollisionGeometry<double>& o2, Result& result) const {
    Request request;
    request.toc_err = 1e-6;
    return continuousCollide(&o1, &motion, &o2, &still_, request, result);
  }
};

TEST_F(BoundedMotions, MeetAtTheTimeOfTheClosedForm) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Pendulum pendulum(random.uniform(0.8, 2.5), random.uniform(0.5, 1.5),
                            random.uniform(0, 3));
    const double farthest = pendulum.timeOf(0.7) < 1 ? 0.7 : 0.3,
                 angle = random.uniform(0.2, farthest);
    const auto plate = makeModel<Rigid>(makePlate(angle));
    // The side of the bar meets the near edge.
    const double time = pendulum.timeOf(angle - std::asin(kHalfWidth / kNear));
    ContinuousContactResult<double> result;
    const double found =
        collide<ContinuousContactRequest<double>>(*bar_, pendulum, *plate, result);
    ASSERT_TRUE(result.is_collide);
    EXPECT_NEAR(found, time, 1e-11);
    EXPECT_LE(found, time * (1 + 1e-15));
    EXPECT_FALSE(result.contacts.empty());
    ContinuousCollisionResult<double> plain;
    // Other triangles of the side meet the edge at the same time, up to rounding.
    const double first =
        collide<ContinuousCollisionRequest<double>>(*bar_, pendulum, *plate, plain);
    EXPECT_NEAR(first, found, 1e-12);
    EXPECT_LE(first, time * (1 + 1e-15));
    ContinuousContactRequest<double> request;
    request.toc_err = 1e-6;
    ContinuousContactResult<double> swapped;
    EXPECT_NEAR(
        continuousCollide(plate.get(), &still_, bar_.get(), &pendulum, request, swapped),
        time, 1e-11);
    EXPECT_EQ(swapped.contacts.size(), result.contacts.size());
    std::size_t candidates = 0;
    EXPECT_TRUE(continuousCandidates(bar_.get(), &pendulum, plate.get(), &still_,
                                     [&](const ContinuousCandidate*, std::size_t count) {
                                       candidates += count;
                                       return true;
                                     }));
    EXPECT_GE(candidates, result.contacts.size());
  }
}

/// The pendulum in a frame that turns, as does what it hits: the time stays the same.
class TurningPendulum : public Pendulum {
 public:
  TurningPendulum(double amplitude, double frequency, double frame)
      : Pendulum(amplitude, frequency, 0), frame_(frame) {}

  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override {
    const double rate = angularSpeedBound(t0, t1), swing = rate - frame_;
    return Pendulum::accelerationBound(center, radius, t0, t1) +
           (rate * rate - swing * swing) * (norm(center) + radius);
  }
  double angularSpeedBound(double t0, double t1) const override {
    return Pendulum::angularSpeedBound(t0, t1) + frame_;
  }

 protected:
  double angle(double t) const override { return Pendulum::angle(t) + frame_ * t; }
  double angleRate(double t) const override { return Pendulum::angleRate(t) + frame_; }

 private:
  double frame_;
};

TEST_F(BoundedMotions, MeetAtTheSameTimeInAFrameThatTurns) {
  const double angle = 0.6;
  const auto plate = makeModel<Rigid>(makePlate(angle));
  for (const double frame : {0., 1e-9, 0.5, 2.9}) {
    const TurningPendulum bar(1.5, 1.1, frame);
    const SteadyTurn turn(frame, Vector::Zero());
    ContinuousCollisionRequest<double> request;
    request.toc_err = 1e-6;
    ContinuousCollisionResult<double> result;
    const double found =
        continuousCollide(bar_.get(), &bar, plate.get(), &turn, request, result);
    EXPECT_NEAR(found, bar.timeOf(angle - std::asin(kHalfWidth / kNear)), 1e-11);
  }
}

TEST_F(BoundedMotions, MissWhatTheyDoNotReach) {
  const Pendulum pendulum(0.5, 3, 1);
  const auto plate = makeModel<Rigid>(makePlate(0.5 + 0.07));
  ContinuousContactResult<double> result;
  EXPECT_EQ(collide<ContinuousContactRequest<double>>(*bar_, pendulum, *plate, result),
            1);
  EXPECT_FALSE(result.is_collide);
}

/// Rigid meshes and meshes that deform in the frame that turns.
TEST_F(BoundedMotions, GiveTheAnswersOfFclsMotionOnTheSamePath) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh mesh = crumpledSheet(random, 5, 0.2);
    const TestMesh from{mesh.t0, mesh.triangles}, to{mesh.t1, mesh.triangles};
    const auto cloth = makeModel<Model>(from, to);
    const auto body = makeModel<Rigid>(from);
    const auto ball = makeModel<Rigid>(moved(makeIcosphere(2, 0.3), 0.4, 0.3, 0.3));
    const SteadyTurn turn(random.uniform(0.1, 2), random.point(0.5));
    const InterpMotion<double> interpolation = turn.asInterpolation();
    for (const CollisionGeometry<double>* o :
         {static_cast<const CollisionGeometry<double>*>(cloth.get()),
          static_cast<const CollisionGeometry<double>*>(body.get())}) {
      ContinuousContactResult<double> ours, fcls;
      collide<ContinuousContactRequest<double>>(*o, turn, *ball, ours);
      collide<ContinuousContactRequest<double>>(*o, interpolation, *ball, fcls);
      ASSERT_EQ(ours.contacts.size(), fcls.contacts.size());
      EXPECT_NEAR(ours.time_of_contact, fcls.time_of_contact, 1e-9);
      EXPECT_EQ(ours.initially_crossing, fcls.initially_crossing);
      contacts += ours.contacts.size();
    }
  }
  EXPECT_GE(contacts, 1000U);
}

/// The bound for a ball that goes along a line is one for the ball anywhere on it.
TEST_F(BoundedMotions, BoundBallsAlongALine) {
  using detail::deformable::MotionPath;
  using detail::deformable::Vec;
  const Pendulum pendulum(1, 2, 0.5);
  const auto bound = MotionPath::bounded(pendulum).acceleration(0.25, 0.75);
  const Vec begin{0.1, 0, 0}, end{-2, 1, 3};
  for (const bool turned : {false, true}) {
    const double whole = bound.between(turned ? end : begin, turned ? begin : end, 0.25);
    for (const double s : {0., 0.3, 0.5, 1.}) {
      const Vec at = (1 - s) * begin + s * end;
      EXPECT_GE(whole, pendulum.accelerationBound({at.x, at.y, at.z}, 0.25, 0.25, 0.75));
    }
  }
}

/// A pendulum that says that it rounds more.
class Rough : public Pendulum {
 public:
  using Pendulum::Pendulum;
  Rounding moreRounding() const override { return {1e-9, 1e-9, 1e-8, 1e-8}; }
};

TEST_F(BoundedMotions, HaveTheToleranceOfTheirRounding) {
  using detail::deformable::MotionPath;
  const Pendulum fine(1, 1, 0);
  const Rough rough(1, 1, 0);
  const MotionPath x = MotionPath::bounded(fine), y = MotionPath::bounded(rough);
  EXPECT_NEAR(y.positionError(2) - x.positionError(2), 1.2e-8, 1e-20);
  EXPECT_NEAR(y.rateError(2) - x.rateError(2), 1.2e-8, 1e-20);
  EXPECT_NEAR(y.rotationError() - x.rotationError(), 1e-9, 1e-20);
  // It touches a little earlier, and never later.
  const auto plate = makeModel<Rigid>(makePlate(0.5));
  ContinuousContactResult<double> exact, early;
  collide<ContinuousContactRequest<double>>(*bar_, fine, *plate, exact);
  collide<ContinuousContactRequest<double>>(*bar_, rough, *plate, early);
  EXPECT_LE(early.time_of_contact, exact.time_of_contact);
  EXPECT_NEAR(early.time_of_contact, exact.time_of_contact, 1e-6);
}

/// The true path is within the rounding of the computed one. The second frequency is one
/// of more than 8 radians, whose speed is bounded in spans.
TEST_F(BoundedMotions, BoundPathsThatAreOffByTheirRounding) {
  using detail::deformable::MotionPath;
  for (const double frequency : {1., 9.}) {
    const MotionPath fine = MotionPath::bounded(Pendulum(1, frequency, 1)),
                     rough = MotionPath::bounded(Rough(1, frequency, 1));
    EXPECT_GE(rough.speed(0), fine.speed(0) + 0.999e-8);
    EXPECT_GE(rough.largestTranslation(), fine.largestTranslation() + 2.999e-8);
  }
}

TEST_F(BoundedMotions, ReachShapes) {
  const Pendulum pendulum(1, 1, 0);
  const Sphere<double> sphere(0.5);
  ContinuousCollisionResult<double> plain;
  EXPECT_EQ(collide<ContinuousCollisionRequest<double>>(*bar_, pendulum, sphere, plain),
            0);
  EXPECT_TRUE(plain.is_collide);
  ContinuousContactResult<double> contacts;
  collide<ContinuousContactRequest<double>>(*bar_, pendulum, sphere, contacts);
  ASSERT_FALSE(contacts.contacts.empty());
  EXPECT_EQ(contacts.contacts.front().b2, -1);
}

/// Says one thing that is wrong.
class Wrong : public Pendulum {
 public:
  enum class What { kPlacement, kLater, kRate, kAcceleration, kSpeed, kRounding, kThrow };
  explicit Wrong(What what) : Pendulum(1, 1, 0), what_(what) {}
  Placement placementAt(double t) const override {
    Placement at = Pendulum::placementAt(t);
    if (what_ == What::kPlacement || (what_ == What::kLater && t > 0 && t < 1))
      at.translation[1] = std::nan("");
    if (what_ == What::kThrow && t > 0 && t < 1) throw std::runtime_error("no such time");
    return at;
  }
  Placement rateAt(double t) const override {
    Placement at = Pendulum::rateAt(t);
    if (what_ == What::kRate) at.rotation[3] = HUGE_VAL;
    return at;
  }
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override {
    return what_ == What::kAcceleration
               ? -1
               : Pendulum::accelerationBound(center, radius, t0, t1);
  }
  double angularSpeedBound(double t0, double t1) const override {
    return what_ == What::kSpeed ? HUGE_VAL : Pendulum::angularSpeedBound(t0, t1);
  }
  Rounding moreRounding() const override {
    return {0, 0, what_ == What::kRounding ? std::nan("") : 0, 0};
  }

 private:
  What what_;
};

/// With the bound for the whole step, steps would be 1e-6 of it as long as the ball
/// rests.
TEST_F(BoundedMotions, RestNearAnotherObject) {
  const LateRise rise;
  const Sphere<double> ball(1);
  const TranslationMotion<double> below(Matrix3<double>::Identity(),
                                        Vector(0, 0, -2 - 1e-8), Vector(0, 0, -2 - 1e-8));
  ContinuousContactRequest<double> request;
  for (const ContinuousQuery query : {ContinuousQuery::kFirst, ContinuousQuery::kAll}) {
    request.query = query;
    ContinuousContactResult<double> result;
    continuousCollide(&ball, &rise, &ball, &below, request, result);
    EXPECT_FALSE(result.is_collide);
  }
}

/// A plate turns in its plane, very near a ball. Its path is bent alike everywhere, so
/// that halves of a span need as many steps as the span.
TEST_F(BoundedMotions, SlideBesideAnotherObject) {
  const auto plate = makeModel<Rigid>({{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}},
                                       {Triangle(0, 1, 2), Triangle(0, 2, 3)}});
  const TwistMotion<double> turn(Transform3<double>::Identity(), Vector::Zero(),
                                 Vector::UnitZ());
  const Sphere<double> ball(0.1);
  for (const double gap : {1e-7, 1e-8, 2e-9}) {
    const Vector place(1, 0.3, 0.1 + gap);
    const TranslationMotion<double> rests(Matrix3<double>::Identity(), place, place);
    ContinuousContactRequest<double> request;
    for (const ContinuousQuery query : {ContinuousQuery::kFirst, ContinuousQuery::kAll}) {
      request.query = query;
      ContinuousContactResult<double> result;
      continuousCollide(plate.get(), &turn, &ball, &rests, request, result);
      EXPECT_FALSE(result.is_collide) << gap;
    }
  }
}

TEST_F(BoundedMotions, RefuseWhatIsNoNumber) {
  const auto plate = makeModel<Rigid>(makePlate(0.5));
  const auto ask = [&](Wrong::What what) {
    ContinuousContactResult<double> result;
    collide<ContinuousContactRequest<double>>(*bar_, Wrong(what), *plate, result);
  };
  expectRefused([&] { ask(Wrong::What::kPlacement); }, "o1: the transform");
  expectRefused([&] { ask(Wrong::What::kLater); }, "o1: BoundedMotion::placementAt()");
  expectRefused([&] { ask(Wrong::What::kRate); }, "o1: BoundedMotion::rateAt()");
  expectRefused([&] { ask(Wrong::What::kAcceleration); },
                "o1: BoundedMotion::accelerationBound()");
  expectRefused([&] { ask(Wrong::What::kSpeed); },
                "o1: BoundedMotion::angularSpeedBound()");
  expectRefused([&] { ask(Wrong::What::kRounding); },
                "o1: BoundedMotion::moreRounding()");
  EXPECT_THROW(ask(Wrong::What::kThrow), std::runtime_error);
}

}  // namespace
}  // namespace test
}  // namespace fcl

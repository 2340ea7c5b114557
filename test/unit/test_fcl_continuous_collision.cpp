// SPDX-License-Identifier: BSD-3-Clause
//
// The calls that FCL has: every signature, BV type and scalar, and which calls are
// answered here and which reach FCL. Contacts: test_fcl_continuous_contact.cpp.
#include "fcl/narrowphase/continuous_collision.h"

#include <cmath>
#include <memory>
#include <vector>

#include "fcl/broadphase/broadphase_dynamic_AABB_tree.h"
#include "fcl/broadphase/default_broadphase_callbacks.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

template <typename S>
using Geometry = std::shared_ptr<CollisionGeometry<S>>;

template <typename S>
Transform3<S> shift(double x, double y, double z) {
  Transform3<S> tf = Transform3<S>::Identity();
  tf.translation() = Vector3<double>(x, y, z).cast<S>();
  return tf;
}

Matrix3<double> rotation(double angle) {
  return AngleAxis<double>(angle, Vector3<double>(1, 2, 3).normalized())
      .toRotationMatrix();
}

/// FCL's other constructors do not set the reference point or the velocities.
InterpMotion<double> interpolation(const Transform3<double>& beg,
                                   const Transform3<double>& end) {
  return {beg.linear(), beg.translation(), end.linear(), end.translation(),
          Vector3<double>::Zero()};
}

/// A step of one object.
template <typename S>
struct Actor {
  Geometry<S> geometry;
  Transform3<S> beginning{Transform3<S>::Identity()};
  Transform3<S> end{Transform3<S>::Identity()};
};

/// The answers of all signatures, which must be equal.
template <typename S>
ContinuousCollisionResult<S> collideEveryWay(
    const Actor<S>& a, const Actor<S>& b,
    const ContinuousCollisionRequest<S>& request = ContinuousCollisionRequest<S>()) {
  const auto motion = [](const Actor<S>& actor) {
    return std::make_shared<TranslationMotion<S>>(actor.beginning, actor.end);
  };
  std::vector<ContinuousCollisionResult<S>> results(4);
  std::vector<S> returned;
  returned.push_back(continuousCollide(a.geometry.get(), a.beginning, a.end,
                                       b.geometry.get(), b.beginning, b.end, request,
                                       results[0]));
  const auto motion_a = motion(a), motion_b = motion(b);
  returned.push_back(continuousCollide(a.geometry.get(), motion_a.get(), b.geometry.get(),
                                       motion_b.get(), request, results[1]));
  const CollisionObject<S> object_a(a.geometry, a.beginning),
      object_b(b.geometry, b.beginning);
  returned.push_back(
      continuousCollide(&object_a, a.end, &object_b, b.end, request, results[2]));
  const ContinuousCollisionObject<S> moving_a(a.geometry, motion_a),
      moving_b(b.geometry, motion_b);
  returned.push_back(collide(&moving_a, &moving_b, request, results[3]));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(returned[i], results[i].time_of_contact) << "signature " << i;
    EXPECT_EQ(results[i].is_collide, results[0].is_collide) << "signature " << i;
    EXPECT_EQ(results[i].time_of_contact, results[0].time_of_contact)
        << "signature " << i;
    EXPECT_TRUE(results[i].contact_tf1.isApprox(results[0].contact_tf1));
    EXPECT_TRUE(results[i].contact_tf2.isApprox(results[0].contact_tf2));
  }
  return results[0];
}

template <typename BV>
class ContinuousCollide : public ::testing::Test {
 protected:
  using S = typename BV::S;
  using Plain = BVHModel<BV>;
  using Deformable = DeformableBVHModel<BV>;

  const TestMesh flat_ = makeSheet(4, 4);
  /// A roof whose top vertex is at height 0, below a face of flat_.
  const TestMesh roof_ = makeSheet(4, 4, [](double u, double v) {
    return Vector3<double>(u + 0.0625, v + 0.03125,
                           -std::abs(u - 0.5) - std::abs(v - 0.5));
  });

  /// The sheet from height z0 to z1, with every way to give this motion.
  std::vector<Actor<S>> actors(const TestMesh& sheet, double z0, double z1) const {
    const TestMesh first = moved(sheet, 0, 0, z0), last = moved(sheet, 0, 0, z1);
    const Transform3<S> beg = shift<S>(0, 0, z0), end = shift<S>(0, 0, z1);
    const Transform3<S> half_beg = shift<S>(0, 0, z0 - 0.5),
                        half_end = shift<S>(0, 0, z1 + 1);
    const TestMesh half_first = moved(sheet, 0, 0, 0.5),
                   half_last = moved(sheet, 0, 0, -1);
    return {{makeModel<Plain>(sheet), beg, end},
            {makeModel<Deformable>(sheet), beg, end},
            {makeModel<Plain>(first, last)},
            {makeModel<Deformable>(first, last)},
            {makeModel<Plain>(half_first, half_last), half_beg, half_end},
            {makeModel<Deformable>(half_first, half_last), half_beg, half_end}};
  }

  static void expectTime(const ContinuousCollisionResult<S>& result, double time) {
    EXPECT_TRUE(result.is_collide);
    // The coordinates were rounded to S.
    EXPECT_LE(static_cast<double>(result.time_of_contact),
              time + (sizeof(S) == 4 ? 1e-6 : 1e-15));
    EXPECT_GE(static_cast<double>(result.time_of_contact), time - 1.1e-4);
  }
};

// Each of FCL's types once, in one of the two scalars. With sanitizers, which take the
// compiler minutes for each, one type for each scalar.
#ifdef NDEBUG
using BVs = ::testing::Types<KDOP<double, 16>, OBBRSS<double>, AABB<double>, kIOS<double>,
                             KDOP<double, 24>, RSS<float>, OBB<float>, KDOP<float, 18>>;
#else
using BVs = ::testing::Types<OBBRSS<double>, KDOP<float, 16>>;
#endif
TYPED_TEST_SUITE(ContinuousCollide, BVs, );

TYPED_TEST(ContinuousCollide, SheetsMeetOnTime) {
  using S = typename TestFixture::S;
  for (const Actor<S>& moving : this->actors(this->flat_, 1, -3)) {
    for (const Actor<S>& still : this->actors(this->roof_, 0, 0)) {
      this->expectTime(collideEveryWay(moving, still), 0.25);
      const auto result = collideEveryWay(still, moving);
      this->expectTime(result, 0.25);
      // At some time between the time of contact and the end of its bracket.
      const Vector3<S> way = moving.end.translation() - moving.beginning.translation(),
                       gone = result.contact_tf2.translation() -
                              (moving.beginning.translation() +
                               result.time_of_contact * way);
      EXPECT_LE(gone.norm(), S(1.01e-4) * way.norm() + S(1e-6));
      EXPECT_GE(gone.dot(way), -S(1e-5));
    }
    for (const Actor<S>& other : this->actors(this->roof_, 0, 4))
      this->expectTime(collideEveryWay(moving, other), 0.125);
    for (const Actor<S>& apart : this->actors(this->roof_, -4, -5)) {
      const auto result = collideEveryWay(moving, apart);
      EXPECT_FALSE(result.is_collide);
      EXPECT_EQ(result.time_of_contact, 1);
    }
  }
}

TYPED_TEST(ContinuousCollide, ModelsAndMotionsStayAsTheyAre) {
  using S = typename TestFixture::S;
  using Plain = typename TestFixture::Plain;
  const auto pointsOf = [](const Vector3<S>* points, int count) {
    return points ? std::vector<Vector3<S>>(points, points + count)
                  : std::vector<Vector3<S>>();
  };
  for (const Actor<S>& a : this->actors(this->flat_, 1, -3)) {
    const Actor<S> b = this->actors(this->roof_, 0, 0)[2];
    const auto* model = dynamic_cast<const Plain*>(a.geometry.get());
    const auto vertices = pointsOf(model->vertices, model->num_vertices),
               previous = pointsOf(model->prev_vertices, model->num_vertices);
    const BVHBuildState state = model->build_state;
    const TranslationMotion<S> motion(a.beginning, a.end), still(b.beginning, b.end);
    motion.integrate(S(0.3));
    Transform3<S> before, after;
    motion.getCurrentTransform(before);
    ContinuousCollisionRequest<S> request;
    for (const auto solver : {CCDC_NAIVE, CCDC_CONSERVATIVE_ADVANCEMENT,
                              CCDC_RAY_SHOOTING, CCDC_POLYNOMIAL_SOLVER}) {
      request.ccd_solver_type = solver;
      for (int i = 0; i < 2; ++i) {
        request.num_max_iterations = i == 0 ? 10 : 1000;
        ContinuousCollisionResult<S> result;
        continuousCollide(a.geometry.get(), &motion, b.geometry.get(), &still, request,
                          result);
        this->expectTime(result, 0.25);
        this->expectTime(collideEveryWay(a, b, request), 0.25);
      }
    }
    motion.getCurrentTransform(after);
    EXPECT_TRUE(before.matrix() == after.matrix());
    EXPECT_EQ(model->build_state, state);
    EXPECT_TRUE(vertices == pointsOf(model->vertices, model->num_vertices));
    EXPECT_TRUE(previous == pointsOf(model->prev_vertices, model->num_vertices));
  }
}

TYPED_TEST(ContinuousCollide, WithoutATurnAllMotionTypesAreOne) {
  using S = typename TestFixture::S;
  const Actor<S> b = this->actors(this->roof_, 0, 0)[0];
  for (const Actor<S>& a : this->actors(this->flat_, 1, -3))
    for (const auto type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW, CCDM_SPLINE}) {
      ContinuousCollisionRequest<S> request;
      request.ccd_motion_type = type;
      this->expectTime(collideEveryWay(a, b, request), 0.25);
    }
}

// A rigid model's own boxes are used, no matter how FCL made them.
TYPED_TEST(ContinuousCollide, RigidModelsWithRefittedTrees) {
  using S = typename TestFixture::S;
  using Plain = typename TestFixture::Plain;
  const TestMesh sheet = bentSheet(8), next = shaken(sheet, 0.15, 3);
  const auto points = pointsAs<S>(next.vertices);
  const auto fresh = makeModel<Plain>(next);
  const auto refitted = makeModel<Plain>(sheet);
  ASSERT_EQ(refitted->beginReplaceModel(), BVH_OK);
  ASSERT_EQ(refitted->replaceSubModel(points), BVH_OK);
  ASSERT_EQ(refitted->endReplaceModel(), BVH_OK);
  const TestMesh ball = floatMesh(makeIcosphere(2, 0.2));
  const auto other = makeModel<Plain>(ball);
  Random random(6);
  std::size_t contacts = 0;
  for (int i = 0; i < 20; ++i) {
    const Vector3<double> way = random.point(0.6);
    const Transform3<S> start = shift<S>(0.5, 0.5, 0.1), beg = shift<S>(0, 0, 0),
                        end = shift<S>(way.x(), way.y(), way.z());
    ContinuousContactResult<S> expected, got;
    continuousCollide(fresh.get(), beg, end, other.get(), start, start,
                      ContinuousContactRequest<S>(), expected);
    continuousCollide(refitted.get(), beg, end, other.get(), start, start,
                      ContinuousContactRequest<S>(), got);
    expectSameContacts(got, expected);
    contacts += expected.contacts.size();
  }
  EXPECT_GT(contacts, 100u);
}

TYPED_TEST(ContinuousCollide, ConstantRotationMovesTheMesh) {
  using S = typename TestFixture::S;
  using Plain = typename TestFixture::Plain;
  using Deformable = typename TestFixture::Deformable;
  if (sizeof(S) == 4) GTEST_SKIP() << "a posed coordinate is a double";
  Transform3<double> tf1 = Transform3<double>::Identity(), tf2 = tf1;
  tf1.linear() = rotation(0.7);
  tf1.translation() = Vector3<double>(3, -2, 1);
  tf2.linear() = rotation(0.75);
  tf2.translation() = Vector3<double>(3.05, -2, 1.02);
  const auto posed = [](TestMesh mesh, const Transform3<double>& tf) {
    for (auto& p : mesh.vertices) {
      const Vector3<double> x = p;
      for (int k = 0; k < 3; ++k)
        p[k] = ((tf(k, 0) * x[0] + tf(k, 1) * x[1]) + tf(k, 2) * x[2]) + tf(k, 3);
    }
    return mesh;
  };
  const TestMesh sheet = bentSheet(6), a0 = shaken(sheet, 0.05, 1),
                 a1 = shaken(sheet, 0.1, 2), b0 = shaken(sheet, 0.05, 3),
                 b1 = shaken(sheet, 0.1, 4);
  const Transform3<S> t1 = tf1.cast<S>(), t2 = tf2.cast<S>();
  const auto expected =
      pairContacts<S>(*makeModel<Plain>(posed(a0, tf1), posed(a1, tf1)),
                      *makeModel<Plain>(posed(b0, tf2), posed(b1, tf2)));
  EXPECT_GT(expected.contacts.size(), 20u);
  const auto plain1 = makeModel<Plain>(a0, a1), plain2 = makeModel<Plain>(b0, b1);
  const auto deformable1 = makeModel<Deformable>(a0, a1),
             deformable2 = makeModel<Deformable>(b0, b1);
  expectSameContacts(pairContacts<S>(*plain1, t1, *plain2, t2), expected);
  expectSameContacts(pairContacts<S>(*deformable1, t1, *plain2, t2), expected);
  expectSameContacts(pairContacts<S>(*plain1, t1, *deformable2, t2), expected);
  expectSameContacts(pairContacts<S>(*deformable1, t1, *deformable2, t2), expected);
  // One of them rigid.
  expectSameContacts(pairContacts<S>(*makeModel<Plain>(a0), t1, *deformable2, t2),
                     pairContacts<S>(*makeModel<Plain>(posed(a0, tf1)),
                                     *makeModel<Plain>(posed(b0, tf2), posed(b1, tf2))));
}

TEST(ContinuousCollideMixed, BVTypesMix) {
  const TestMesh sheet = bentSheet(6), next = shaken(sheet, 0.2, 1),
                 other = moved(sheet, 0.02, 0.03, 0.1);
  const std::vector<Geometry<double>> first = {
      makeModel<BVHModel<AABB<double>>>(sheet, next),
      makeModel<DeformableBVHModel<OBBRSS<double>>>(sheet, next),
      makeModel<DeformableBVHModel<KDOP<double, 16>>>(sheet, next)};
  const std::vector<Geometry<double>> second = {
      makeModel<BVHModel<RSS<double>>>(other), makeModel<BVHModel<kIOS<double>>>(other),
      makeModel<BVHModel<OBB<double>>>(other),
      makeModel<BVHModel<KDOP<double, 24>>>(other),
      makeModel<DeformableBVHModel<KDOP<double, 18>>>(other)};
  const auto expected = pairContacts(*first[0], *second[0]);
  EXPECT_GT(expected.contacts.size(), 20u);
  for (const auto& a : first)
    for (const auto& b : second) expectSameContacts(pairContacts(*a, *b), expected);
}

TEST(ContinuousCollideStock, MissesTheThinSheet) {
  const auto model = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(4, 4));
  const Transform3<double> still = shift<double>(0, 0, 0), beg = shift<double>(0, 0, 1),
                           end = shift<double>(0, 0, -3);
  ContinuousCollisionResult<double> stock, ours;
  const ContinuousCollisionRequest<double> request;
  continuousCollide<double>(model.get(), beg, end, model.get(), still, still, request,
                            stock);
  EXPECT_TRUE(!stock.is_collide || stock.time_of_contact > 0.2501)
      << "FCL has become right: " << stock.time_of_contact;
  EXPECT_NEAR(
      continuousCollide(model.get(), beg, end, model.get(), still, still, request, ours),
      0.25, 1e-4);
}

/// A motion class of the program.
class OwnMotion : public TranslationMotion<double> {
 public:
  using TranslationMotion<double>::TranslationMotion;
};

/// What follows a motion class of the program that says nothing of itself reaches FCL.
/// @param name  of the first object that FCL alone can answer, with its kind
void expectOwnMotionAsInFcl(const Geometry<double>& o1, const Geometry<double>& o2,
                            const char* name) {
  const OwnMotion moving(shift<double>(2, 0, 0), shift<double>(-2, 0, 0)),
      still(shift<double>(0, 0.1, 0), shift<double>(0, 0.1, 0));
  ContinuousCollisionResult<double> ours, stock;
  const ContinuousCollisionRequest<double> request;
  EXPECT_EQ(
      continuousCollide(o1.get(), &moving, o2.get(), &still, request, ours),
      continuousCollide<double>(o1.get(), &moving, o2.get(), &still, request, stock));
  EXPECT_TRUE(ours.is_collide);
  EXPECT_EQ(ours.contact_tf1.matrix(), stock.contact_tf1.matrix());
  ContinuousContactResult<double> contacts;
  expectRefused(
      [&] {
        continuousCollide(o1.get(), &moving, o2.get(), &still,
                          ContinuousContactRequest<double>(), contacts);
      },
      std::string(name) + ", follows a motion class");
}

TEST(ContinuousCollideStock, OwnMotionsReachFcl) {
  const auto sphere = std::make_shared<Sphere<double>>(0.5);
  const auto box = std::make_shared<Box<double>>(1, 1, 1);
  const auto mesh = makeModel<BVHModel<OBBRSS<double>>>(makeIcosphere(2, 0.5));
  const auto small = makeModel<BVHModel<OBBRSS<double>>>(makeIcosphere(1, 0.2));
  const auto deformable =
      makeModel<DeformableBVHModel<OBBRSS<double>>>(makeIcosphere(2, 0.5));
  expectOwnMotionAsInFcl(mesh, small, "o1, a triangle mesh");
  expectOwnMotionAsInFcl(deformable, small, "o1, a triangle mesh");
  expectOwnMotionAsInFcl(sphere, box, "o1, a sphere");
  expectOwnMotionAsInFcl(mesh, sphere, "o1, a triangle mesh");
}

TEST(ContinuousCollideMotion, InterpMotionWithoutRotationIsAnsweredHere) {
  const auto model = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(4, 4));
  const auto motion = interpolation(shift<double>(0, 0, 1), shift<double>(0, 0, -3)),
             still = interpolation(shift<double>(0, 0, 0), shift<double>(0, 0, 0));
  ContinuousCollisionResult<double> result;
  EXPECT_NEAR(continuousCollide(model.get(), &motion, model.get(), &still,
                                ContinuousCollisionRequest<double>(), result),
              0.25, 1e-4);
}

// FCL's quaternions round: the end of a constant rotation may differ by rounding.
TEST(ContinuousCollideMotion, InterpMotionWithConstantRotationIsAnsweredHere) {
  const auto ball = makeModel<BVHModel<OBBRSS<double>>>(makeIcosphere(1, 0.5));
  const auto sheet = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(4, 4));
  const TranslationMotion<double> still(shift<double>(0, 0, 0), shift<double>(0, 0, 0));
  ContinuousContactRequest<double> request;
  request.toc_err = 1e-9;
  request.query = ContinuousQuery::kFirst;
  int num_rounded = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    Transform3<double> beginning = shift<double>(0.1, 0.2, 2),
                       end = shift<double>(0.1, 0.2, -2.1);
    beginning.linear() = end.linear() = rotation(0.0123 * i);
    const auto motion = interpolation(beginning, end);
    Transform3<double> first, last;
    motion.getCurrentTransform(first);
    motion.integrate(1);
    motion.getCurrentTransform(last);
    motion.integrate(0);
    num_rounded += first.linear() != last.linear();
    ContinuousContactResult<double> result, expected;
    continuousCollide(ball.get(), &motion, sheet.get(), &still, request, result);
    const TranslationMotion<double> straight(beginning, end);
    continuousCollide(ball.get(), &straight, sheet.get(), &still, request, expected);
    ASSERT_TRUE(expected.is_collide);
    ASSERT_NEAR(result.time_of_contact, expected.time_of_contact, 1e-8);
  }
  EXPECT_GT(num_rounded, 0);
}

// FCL's conservative advancement starts at the current pose of a motion.
TEST(ContinuousCollideMotion, OwnMotionsReachFclWhereTheyAre) {
  const auto model = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(4, 4));
  for (const double height : {0., 2.}) {
    ContinuousCollisionRequest<double> request;
    for (const auto solver : {CCDC_NAIVE, CCDC_CONSERVATIVE_ADVANCEMENT}) {
      request.ccd_solver_type = solver;
      ContinuousCollisionResult<double> ours, stock;
      double times[2];
      for (const bool in_fcl : {false, true}) {
        const OwnMotion falling(shift<double>(0.01, 0.02, 2),
                                shift<double>(0, 0, height)),
            still(shift<double>(0, 0, 0), shift<double>(0, 0, 0));
        times[in_fcl] =
            in_fcl ? continuousCollide<double>(model.get(), &falling, model.get(), &still,
                                               request, stock)
                   : continuousCollide(model.get(), &falling, model.get(), &still,
                                       request, ours);
      }
      EXPECT_EQ(times[0], times[1]) << solver;
      EXPECT_EQ(ours.is_collide, stock.is_collide) << solver;
      // FCL's conservative advancement misses this contact.
      EXPECT_EQ(ours.is_collide, height == 0 && solver == CCDC_NAIVE);
    }
  }
}

// The vertices of a deforming mesh go from the begin of such a motion to its end.
TEST(ContinuousCollideMotion, OwnMotionsOfDeformingMeshes) {
  const auto model = makeModel<DeformableBVHModel<OBBRSS<double>>>(
      makeSheet(4, 4), moved(makeSheet(4, 4), 0, 0, 0.5));
  const OwnMotion falling(shift<double>(0, 0, 1), shift<double>(0, 0, -3)),
      still(shift<double>(0, 0, 0), shift<double>(0, 0, 0));
  falling.integrate(0.5);
  ContinuousCollisionResult<double> result;
  EXPECT_NEAR(continuousCollide(model.get(), &falling, model.get(), &still,
                                ContinuousCollisionRequest<double>(), result),
              0.25, 1e-4);
  Transform3<double> after;
  falling.getCurrentTransform(after);
  EXPECT_EQ(after.translation().z(), 1);
}

// The vertices of a deforming mesh go straight from one pose to the other, unless the
// given motion turns. Then the frame in which they go straight turns.
TEST(ContinuousCollideMotion, DeformingMeshMayRotate) {
  const auto a = makeModel<DeformableBVHModel<OBBRSS<double>>>(
      makeSheet(4, 4), moved(makeSheet(4, 4), 0, 0, 0.5));
  const auto b = makeModel<BVHModel<OBBRSS<double>>>(bentSheet(4, 0.4));
  Transform3<double> end = shift<double>(0, 0, 0.5);
  end.linear() = rotation(0.4);
  const Transform3<double> still = Transform3<double>::Identity();
  TestMesh last = moved(makeSheet(4, 4), 0, 0, 0.5);
  for (auto& p : last.vertices) p = (end * p).eval();
  const auto straight = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(4, 4), last);
  ContinuousCollisionResult<double> got, expected;
  const ContinuousCollisionRequest<double> request;
  continuousCollide(a.get(), still, end, b.get(), still, still, request, got);
  continuousCollide(straight.get(), still, still, b.get(), still, still, request,
                    expected);
  EXPECT_TRUE(expected.is_collide);
  EXPECT_NEAR(got.time_of_contact, expected.time_of_contact, 1e-4);
  const auto motion = interpolation(still, end), none = interpolation(still, still);
  ContinuousCollisionResult<double> by_motion;
  continuousCollide(a.get(), &motion, b.get(), &none, request, by_motion);
  ContinuousCollisionRequest<double> turning = request;
  turning.ccd_motion_type = CCDM_LINEAR;
  continuousCollide(a.get(), still, end, b.get(), still, still, turning, expected);
  EXPECT_TRUE(expected.is_collide);
  EXPECT_EQ(by_motion.time_of_contact, expected.time_of_contact);
  EXPECT_NE(by_motion.time_of_contact, got.time_of_contact);
}

struct Found {
  ContinuousCollisionRequest<double> request;
  std::vector<double> times;
};

bool collideStep(CollisionObject<double>* o1, CollisionObject<double>* o2, void* data) {
  auto* found = static_cast<Found*>(data);
  ContinuousCollisionResult<double> result;
  found->times.push_back(continuousCollide(o1, o1->getTransform(), o2, o2->getTransform(),
                                           found->request, result));
  return false;
}

// The sheet is gone at the end of the step; its local AABB has both frames.
TEST(ContinuousCollideBroadphase, CallbackReachesUs) {
  const TestMesh sheet = makeSheet(4, 4);
  CollisionObject<double> moving(makeModel<DeformableBVHModel<OBBRSS<double>>>(
      moved(sheet, 0, 0, 1), moved(sheet, 0, 0, -3)));
  CollisionObject<double> still(makeModel<BVHModel<OBBRSS<double>>>(sheet)),
      far(makeModel<BVHModel<OBBRSS<double>>>(moved(sheet, 0, 0, 9)));
  DynamicAABBTreeCollisionManager<double> manager;
  for (auto* object : {&moving, &still, &far}) manager.registerObject(object);
  manager.setup();
  Found found;
  manager.collide(&found, collideStep);
  ASSERT_EQ(found.times.size(), 1u);
  EXPECT_NEAR(found.times[0], 0.25, 1e-4);
  EXPECT_LE(found.times[0], 0.25);
}

TEST(ContinuousCollideBroadphase, FclsCallbackReachesUs) {
  const auto sheet = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(4, 4));
  const auto motion = [](double z0, double z1) {
    return std::make_shared<TranslationMotion<double>>(shift<double>(0, 0, z0),
                                                       shift<double>(0, 0, z1));
  };
  ContinuousCollisionObject<double> o1(sheet, motion(1, -3)), o2(sheet, motion(0, 0));
  DefaultContinuousCollisionData<double> data;
  EXPECT_FALSE(DefaultContinuousCollisionFunction<double>(&o1, &o2, &data));
  EXPECT_TRUE(data.result.is_collide);
  EXPECT_NEAR(data.result.time_of_contact, 0.25, 1e-4);
}

}  // namespace
}  // namespace test
}  // namespace fcl

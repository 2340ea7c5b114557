// SPDX-License-Identifier: BSD-3-Clause
//
// The behaviour on which programs written for stock FCL rely.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "fcl/ccd_version.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/continuous_features.h"
#include "fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h"
#include "fcl/narrowphase/detail/traversal/collision_node.h"
#include "fcl/narrowphase/distance.h"
#include "mesh_generators.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Mesh = BVHModel<OBBRSS<double>>;

Transform3<double> at(const Vector3<double>& position) {
  Transform3<double> tf = Transform3<double>::Identity();
  tf.translation() = position;
  return tf;
}

Transform3<double> turned(const Vector3<double>& position, double angle) {
  Transform3<double> tf = at(position);
  tf.linear() = AngleAxis<double>(angle, Vector3<double>::UnitZ()).toRotationMatrix();
  return tf;
}

template <typename Model = Mesh>
std::shared_ptr<Model> makeCube(double side) {
  return makeModel<Model>(makeBox(Vector3<double>::Constant(side / 2)));
}

TEST(DropIn, VersionIsTheSameInWordsAndNumbers) {
  EXPECT_EQ(FCL_CCD_VERSION, std::to_string(FCL_CCD_MAJOR_VERSION) + "." +
                                 std::to_string(FCL_CCD_MINOR_VERSION) + "." +
                                 std::to_string(FCL_CCD_PATCH_VERSION));
  EXPECT_TRUE(FCL_CCD_VERSION_AT_LEAST(0, 2, 0));
  EXPECT_FALSE(FCL_CCD_VERSION_AT_LEAST(FCL_CCD_MAJOR_VERSION + 1, 0, 0));
  EXPECT_FALSE(FCL_CCD_VERSION_AT_LEAST(FCL_CCD_MAJOR_VERSION, FCL_CCD_MINOR_VERSION + 1,
                                        FCL_CCD_PATCH_VERSION));
}

/// How many of so many translations that end with the meshes in each other are met, and
/// how many have contacts for collide() at the pose of contact.
struct PoseCensus {
  int met{0};
  int with_contacts{0};
};

template <typename Model>
PoseCensus censusOf(const TestMesh& mesh, int count) {
  const auto model = makeModel<Model>(mesh);
  Random random(34);
  const Transform3<double> still = Transform3<double>::Identity();
  PoseCensus census;
  for (int i = 0; i < count; ++i) {
    Vector3<double> from = random.point(1);
    while (from.norm() < 0.1) from = random.point(1);
    from = 3 * from.normalized();
    ContinuousCollisionResult<double> result;
    continuousCollide(model.get(), still, still, model.get(), at(from),
                      at(random.point(0.3)), ContinuousCollisionRequest<double>(),
                      result);
    census.met += result.is_collide;
    CollisionResult<double> contacts;
    census.with_contacts +=
        collide(model.get(), result.contact_tf1, model.get(), result.contact_tf2,
                CollisionRequest<double>(), contacts) > 0;
  }
  return census;
}

// FCL's programs pose the objects at contact_tf and call collide() for the contacts.
TEST(DropIn, ObjectsMeetAtThePoseOfContact) {
  const auto cubes = censusOf<Mesh>(makeBox(Vector3<double>::Constant(0.5)), 1000);
  EXPECT_EQ(cubes.met, 1000);
  EXPECT_EQ(cubes.with_contacts, 1000);
  const auto balls = censusOf<BVHModel<OBB<double>>>(makeIcosphere(2, 0.5), 300);
  EXPECT_EQ(balls.met, 300);
  EXPECT_EQ(balls.with_contacts, 300);
}

TEST(DropIn, PoseOfContactIsAtTheUpperEndOfTheBracket) {
  const auto cube = makeCube(1);
  const Transform3<double> still = Transform3<double>::Identity();
  const auto beg = at({3, 0.1, 0.2}), end = at({0.1, 0.2, 0.1});
  ContinuousContactResult<double> result;
  continuousCollide(cube.get(), still, still, cube.get(), beg, end,
                    ContinuousContactRequest<double>(), result);
  ASSERT_FALSE(result.contacts.empty());
  const double hi = result.contacts.front().toc_hi;
  EXPECT_EQ(result.time_of_contact, result.contacts.front().toc_lo);
  EXPECT_GT(hi, result.time_of_contact);
  EXPECT_TRUE(result.contact_tf2.translation().isApprox(
      (1 - hi) * beg.translation() + hi * end.translation(), 1e-15));
}

/// A motion in memory that held something before.
template <typename Motion>
class MotionInUsedMemory {
 public:
  MotionInUsedMemory(const Transform3<double>& beg, const Transform3<double>& end,
                     double leftover) {
    double* const numbers = reinterpret_cast<double*>(memory_);
    for (std::size_t i = 0; i < sizeof(memory_) / sizeof(double); ++i)
      numbers[i] = leftover;
    motion_ = new (memory_) Motion(beg, end);
  }
  ~MotionInUsedMemory() { motion_->~Motion(); }
  MotionInUsedMemory(const MotionInUsedMemory&) = delete;
  MotionInUsedMemory& operator=(const MotionInUsedMemory&) = delete;

  const Motion& operator*() const { return *motion_; }

 private:
  alignas(64) unsigned char memory_[sizeof(Motion)];
  Motion* motion_;
};

template <typename Motion>
void expectTranslation(const Vector3<double>& beg, const Vector3<double>& end) {
  const auto cube = makeCube(1);
  const Transform3<double> still = Transform3<double>::Identity();
  ContinuousCollisionResult<double> expected;
  continuousCollide(cube.get(), still, still, cube.get(), at(beg), at(end),
                    ContinuousCollisionRequest<double>(), expected);
  ASSERT_TRUE(expected.is_collide);
  for (const double leftover : {0., 1e16, 1e300, -1e17}) {
    const MotionInUsedMemory<Motion> rest(still, still, leftover),
        moving(at(beg), at(end), leftover);
    ContinuousCollisionResult<double> result;
    continuousCollide(cube.get(), &*rest, cube.get(), &*moving,
                      ContinuousCollisionRequest<double>(), result);
    EXPECT_EQ(result.time_of_contact, expected.time_of_contact) << leftover;
    EXPECT_EQ(result.contact_tf2.matrix(), expected.contact_tf2.matrix()) << leftover;
  }
}

// FCL's constructor of two transforms leaves the reference point as it was in memory.
TEST(DropIn, InterpolationDoesNotDependOnMemory) {
  expectTranslation<InterpMotion<double>>({3, 0.1, 0.2}, {-3, 0.2, 0.1});
}

// Without a rotation FCL's screw goes |d| times too far.
TEST(DropIn, ScrewWithoutRotationEndsWhereItWasMadeTo) {
  expectTranslation<ScrewMotion<double>>({20, 0.1, 0.2}, {0.5, 0.2, 0.1});
  expectTranslation<ScrewMotion<double>>({1.5, 0.1, 0.2}, {0.5, 0.2, 0.1});
}

// Of shapes a rotation from two transforms is FCL's, whose interpolation reads that point
// too; of meshes it is ours.
template <typename Cube>
void expectRotationDoesNotDependOnMemory(const Cube& cube) {
  const Transform3<double> still = Transform3<double>::Identity();
  ContinuousCollisionRequest<double> request;
  request.ccd_motion_type = CCDM_LINEAR;
  double first = 0;
  for (const double leftover : {0., 1e17, -3e200}) {
    {
      std::vector<std::unique_ptr<double[]>> blocks;
      for (std::size_t size = 8; size < 200; size += 2)
        for (int i = 0; i < 8; ++i) {
          blocks.push_back(std::make_unique<double[]>(size));
          std::fill(blocks.back().get(), blocks.back().get() + size, leftover);
        }
    }
    ContinuousCollisionResult<double> result;
    const double time =
        continuousCollide(cube.get(), still, still, cube.get(), turned({3, 0, 0}, 0),
                          turned({0.5, 0, 0}, 1.5), request, result);
    EXPECT_TRUE(result.is_collide);
    if (leftover == 0) first = time;
    EXPECT_EQ(time, first) << leftover;
  }
}

TEST(DropIn, RotationDoesNotDependOnMemory) {
  expectRotationDoesNotDependOnMemory(makeCube(1));
  expectRotationDoesNotDependOnMemory(std::make_shared<Box<double>>(1, 1, 1));
}

/// A motion of the program's own, whose meshes are FCL's.
template <typename S>
class OwnMotion : public TranslationMotion<S> {
 public:
  using TranslationMotion<S>::TranslationMotion;
};

// FCL's polynomial solver moves the models that it is given and leaves them updated.
TEST(DropIn, PolynomialSolverLeavesModelsAsTheyWere) {
  const auto model = makeCube(1), other = makeCube(1);
  const Transform3<double> still = Transform3<double>::Identity();
  const Vector3<double> corner = model->vertices[0];
  ContinuousCollisionRequest<double> request;
  request.ccd_solver_type = CCDC_POLYNOMIAL_SOLVER;
  ContinuousCollisionResult<double> result;
  const OwnMotion<double> own(at({-5, 0, 0}), at({5, 0, 0})), rest(still, still);
  continuousCollide(model.get(), &own, other.get(), &rest, request, result);
  EXPECT_EQ(model->build_state, BVH_BUILD_STATE_PROCESSED);
  EXPECT_EQ(model->prev_vertices, nullptr);
  EXPECT_EQ(model->vertices[0], corner);
  // And back again, which is ours.
  continuousCollide(model.get(), at({5, 0, 0}), at({-5, 0, 0}), other.get(), still, still,
                    request, result);
  EXPECT_TRUE(result.is_collide);
  EXPECT_NEAR(result.time_of_contact, 0.4, 1e-4);
}

template <typename S>
void expectTight(const ContinuousFeatureTestResult<S>& result, double time) {
  EXPECT_TRUE(result.is_contact);
  EXPECT_LE(static_cast<double>(result.toc_lo), time);
  EXPECT_GE(static_cast<double>(result.toc_hi), time);
  EXPECT_LE(result.toc_hi - result.toc_lo, 4 * std::numeric_limits<S>::epsilon());
}

// FCL takes a tolerance of 0.
TEST(DropIn, ToleranceOfZeroIsAsTightAsDoublesAllow) {
  const auto cube = makeCube(1);
  const Transform3<double> still = Transform3<double>::Identity();
  const auto beg = at({3, 0.1, 0.2}), end = at({-3.1, 0.2, 0.1});
  const double exact = 2 / 6.1;
  ContinuousContactRequest<double> request;
  request.toc_err = 0;
  ContinuousContactResult<double> result;
  continuousCollide(cube.get(), still, still, cube.get(), beg, end, request, result);
  ASSERT_FALSE(result.contacts.empty());
  EXPECT_LE(result.time_of_contact, exact * (1 + 1e-15));
  EXPECT_GE(result.time_of_contact, exact * (1 - 1e-15));
  for (const auto& contact : result.contacts)
    EXPECT_LE(contact.toc_hi - contact.toc_lo,
              4 * std::numeric_limits<double>::epsilon());

  ContinuousCollisionRequest<double> first_request;
  first_request.toc_err = 0;
  ContinuousCollisionResult<double> first;
  continuousCollide(cube.get(), still, still, cube.get(), beg, end, first_request, first);
  EXPECT_EQ(first.time_of_contact, result.time_of_contact);

  detail::DeformableContinuousCollisionTraversalNode<double> node;
  node.toc_err = 0;
  CollisionResult<double> contacts;
  ASSERT_TRUE(detail::initialize(node, *cube, still, still, *cube, beg, end,
                                 CollisionRequest<double>(100), contacts));
  detail::collide<double>(&node);
  EXPECT_EQ(node.time_of_contact, result.time_of_contact);

  using V = Vector3<double>;
  const V f0(0, 0, 0), f1(4, 0, 0), f2(0, 4, 0);
  expectTight<double>(
      vertexFace<double>(V(1, 1, 1), f0, f1, f2, V(1, 1, -2), f0, f1, f2, 0), 1. / 3);
  using F = Vector3<float>;
  const F g0(-1, 0, 0), g1(1, 0, 0);
  expectTight<float>(edgeEdge<float>(F(0, -1, 1), F(0, 1, 1), g0, g1, F(0, -1, -2),
                                     F(0, 1, -2), g0, g1, 0),
                     1. / 3);
}

/// What a thread asks again and again; every answer must be the first one's.
template <typename Query>
void expectSameInThreads(int count, const Query& query) {
  const auto expected = query();
  std::vector<int> different(2, 0);
  std::vector<std::thread> threads;
  for (int& bad : different)
    threads.emplace_back([&] {
      for (int i = 0; i < count; ++i) bad += query() != expected;
    });
  for (std::thread& thread : threads) thread.join();
  for (const int bad : different) EXPECT_EQ(bad, 0);
}

/// Stock FCL crashes on most of these: its copies of a model share a fitter and a
/// splitter.
template <typename BV>
class DropInThreads : public ::testing::Test {};
#ifdef NDEBUG
using AllBVs = ::testing::Types<AABB<double>, OBB<double>, RSS<double>, kIOS<double>,
                                OBBRSS<double>, KDOP<double, 16>, KDOP<double, 18>,
                                KDOP<double, 24>, KDOP<float, 16>>;
#else
using AllBVs = ::testing::Types<AABB<double>, OBBRSS<double>, KDOP<float, 16>>;
#endif
TYPED_TEST_SUITE(DropInThreads, AllBVs, );

TYPED_TEST(DropInThreads, DiscreteQueriesOfOneModel) {
  using S = typename TypeParam::S;
  const auto model = makeModel<DeformableBVHModel<TypeParam>>(makeIcosphere(2, 1));
  const auto plain = makeModel<BVHModel<TypeParam>>(makeIcosphere(2, 1));
  Transform3<S> tf1 = Transform3<S>::Identity(), tf2 = tf1;
  tf1.translation() = Vector3<S>(S(0.1), 0, 0);
  tf2.translation() = Vector3<S>(0, S(1.9), S(0.1));
  const auto numContactsOf = [&](const BVHModel<TypeParam>& o) {
    CollisionResult<S> result;
    collide(&o, tf1, &o, tf2, CollisionRequest<S>(1000, true), result);
    return result.numContacts();
  };
  const std::size_t expected = numContactsOf(*plain);
  EXPECT_GT(expected, 0u);
  EXPECT_EQ(numContactsOf(*model), expected);
  expectSameInThreads(200, [&] { return numContactsOf(*model); });
}

TYPED_TEST(DropInThreads, ContinuousQueriesThatFclAnswers) {
  using S = typename TypeParam::S;
  const auto deformable = makeModel<DeformableBVHModel<TypeParam>>(makeIcosphere(2, 1));
  const auto plain = makeModel<BVHModel<TypeParam>>(makeIcosphere(2, 1));
  const Box<S> box(1, 1, 1);
  Transform3<S> beg = Transform3<S>::Identity(), end = beg, still = beg;
  beg.translation() = Vector3<S>(3, S(0.1), 0);
  end.linear() = AngleAxis<S>(1, Vector3<S>::UnitZ()).toRotationMatrix();
  const auto timeOf = [&](const CollisionGeometry<S>& o1, const CollisionGeometry<S>& o2,
                          CCDSolverType solver) {
    ContinuousCollisionRequest<S> request;
    request.ccd_solver_type = solver;
    ContinuousCollisionResult<S> result;
    // Of motions of its own a program gives each call its own.
    const OwnMotion<S> moving(beg, end), rest(still, still);
    return continuousCollide(&o1, &moving, &o2, &rest, request, result);
  };
  for (const auto& model : {std::static_pointer_cast<CollisionGeometry<S>>(deformable),
                            std::static_pointer_cast<CollisionGeometry<S>>(plain)}) {
    // In float tests have FCL's functions of two models only (fcl_in_float.h).
    if constexpr (std::is_same_v<S, double>)
      expectSameInThreads(20, [&] { return timeOf(*model, box, CCDC_NAIVE); });
    expectSameInThreads(20, [&] { return timeOf(*model, *model, CCDC_NAIVE); });
    // Of the others FCL prints that it has no distance.
    if (detail::hasDistanceFunction(model->getNodeType(), model->getNodeType()))
      for (const CollisionGeometry<S>* other :
           {static_cast<const CollisionGeometry<S>*>(&box),
            static_cast<const CollisionGeometry<S>*>(model.get())})
        expectSameInThreads(
            4, [&] { return timeOf(*model, *other, CCDC_CONSERVATIVE_ADVANCEMENT); });
  }
}

TYPED_TEST(DropInThreads, FclGetsCopiesOfWhatItWritesTo) {
  using S = typename TypeParam::S;
  const auto model = makeModel<BVHModel<TypeParam>>(makeIcosphere(1, 1));
  const Box<S> box(1, 1, 1);
  const NODE_TYPE volume = model->getNodeType();
  const bool turns = volume == BV_OBB || volume == BV_kIOS || volume == BV_OBBRSS;
  const auto isCopied = [&](const CollisionGeometry<S>& other, CCDSolverType solver) {
    ContinuousCollisionRequest<S> request;
    request.ccd_solver_type = solver;
    const CollisionGeometry<S>* o = model.get();
    return detail::geometryForFcl<S>(o, &other, request).get() != o;
  };
  EXPECT_EQ(isCopied(*model, CCDC_NAIVE), !turns);
  EXPECT_EQ(isCopied(box, CCDC_NAIVE), !turns && volume != BV_RSS);
  for (const CCDSolverType solver :
       {CCDC_CONSERVATIVE_ADVANCEMENT, CCDC_POLYNOMIAL_SOLVER})
    EXPECT_TRUE(isCopied(*model, solver) && isCopied(box, solver));
  ContinuousCollisionRequest<S> request;
  EXPECT_EQ(detail::geometryForFcl<S>(&box, model.get(), request).get(), &box);
}

/// A geometry of a type, which is all that FCL reads to choose a function.
class Typed : public CollisionGeometry<double> {
 public:
  explicit Typed(NODE_TYPE type) : type_(type) {}

  OBJECT_TYPE getObjectType() const override { return OT_BVH; }
  NODE_TYPE getNodeType() const override { return type_; }
  void computeLocalAABB() override {}

 private:
  NODE_TYPE type_;
};

/// Whether the libfcl of this program has a function. FCL's functions return at once when
/// the distance so far is 0. Without a function FCL returns the largest number.
bool fclHasDistanceFunction(NODE_TYPE mesh, NODE_TYPE other) {
  const Transform3<double> still = Transform3<double>::Identity();
  const Typed o1(mesh), o2(other);
  DistanceResult<double> result;
  result.min_distance = 0;
  return fcl::distance<double>(&o1, still, &o2, still, DistanceRequest<double>(),
                               result) == 0;
}

TEST(DropIn, DistanceFunctionsAreThoseThatFclHas) {
  ::testing::internal::CaptureStderr();  // FCL tells which functions it has not
  for (const NODE_TYPE mesh :
       {BV_AABB, BV_OBB, BV_RSS, BV_kIOS, BV_OBBRSS, BV_KDOP16, BV_KDOP18, BV_KDOP24})
    for (int other = 0; other < NODE_COUNT; ++other) {
      const auto type = static_cast<NODE_TYPE>(other);
      EXPECT_EQ(detail::hasDistanceFunction(mesh, type),
                fclHasDistanceFunction(mesh, type))
          << mesh << " " << other;
    }
  ::testing::internal::GetCapturedStderr();
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's discrete queries on a DeformableBVHModel. In every state and under any transform
// they are right, or they are refused.
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "fcl/broadphase/broadphase_dynamic_AABB_tree.h"
#include "fcl/broadphase/default_broadphase_callbacks.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/distance.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Geometry = CollisionGeometry<double>;
using Pose = Transform3<double>;
using TrianglePairs = std::vector<std::pair<int, int>>;

Pose randomPose(Random& random, double reach) {
  const Vector3<double> axis = random.point(1).normalized();
  Pose pose = Pose::Identity();
  pose.linear() = AngleAxis<double>(random.uniform(0, 6.28), axis).toRotationMatrix();
  pose.translation() = random.point(reach);
  return pose;
}

TrianglePairs collidingPairs(const Geometry& o1, const Pose& tf1, const Geometry& o2,
                             const Pose& tf2) {
  CollisionResult<double> result;
  collide(&o1, tf1, &o2, tf2, CollisionRequest<double>(1u << 20, true), result);
  TrianglePairs pairs;
  for (std::size_t i = 0; i < result.numContacts(); ++i)
    pairs.emplace_back(result.getContact(i).b1, result.getContact(i).b2);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

double distanceOf(const Geometry& o1, const Pose& tf1, const Geometry& o2,
                  const Pose& tf2) {
  DistanceResult<double> result;
  return distance(&o1, tf1, &o2, tf2, DistanceRequest<double>(), result);
}

template <typename BV>
class DiscreteQuery : public ::testing::Test {
 protected:
  using Model = DeformableBVHModel<BV>;
  using Plain = BVHModel<BV>;

  const TestMesh sheet_ = bentSheet(8);
  const TestMesh next_ = moved(shaken(sheet_, 0.1, 1), 0.3, -0.2, 0.5);
  const std::shared_ptr<Plain> plain_ = makeModel<Plain>(next_);
  const std::shared_ptr<Plain> other_ =
      makeModel<Plain>(floatMesh(makeIcosphere(2, 0.4)));

  /// Expects the answers of a plain model that was built from the current frame.
  void expectCollidesRight(const Model& model) {
    Random random(5);
    std::size_t pairs = 0;
    for (int i = 0; i < 20; ++i) {
      const Pose tf1 = i ? randomPose(random, 0.5) : Pose::Identity(),
                 tf2 = i != 1 ? randomPose(random, 0.5) : Pose::Identity();
      const TrianglePairs expected = collidingPairs(*plain_, tf1, *other_, tf2);
      pairs += expected.size();
      EXPECT_EQ(collidingPairs(model, tf1, *other_, tf2), expected);
      EXPECT_EQ(collidingPairs(*other_, tf2, model, tf1),
                collidingPairs(*other_, tf2, *plain_, tf1));
      EXPECT_EQ(collidingPairs(model, tf1, model, tf2),
                collidingPairs(*plain_, tf1, *plain_, tf2));
    }
    EXPECT_GT(pairs, 20u);
  }

  /// Collide and distance, for geometries, for objects, and in a broadphase.
  void expectRefusals(const std::shared_ptr<Model>& model) {
    const Pose identity = Pose::Identity();
    const char* word = "updateFclTree";
    expectRefused([&] { collidingPairs(*model, identity, *other_, identity); }, word);
    expectRefused([&] { collidingPairs(*other_, identity, *model, identity); }, word);
    expectRefused([&] { distanceOf(*model, identity, *other_, identity); }, word);
    expectRefused([&] { distanceOf(*other_, identity, *model, identity); }, word);
    CollisionObject<double> o1(model), o2(other_);
    CollisionResult<double> result;
    DistanceResult<double> distance_result;
    expectRefused([&] { collide(&o1, &o2, CollisionRequest<double>(), result); }, word);
    expectRefused([&] { collide(&o2, &o1, CollisionRequest<double>(), result); }, word);
    expectRefused([&] { distance(&o1, &o2, DistanceRequest<double>(), distance_result); },
                  word);
    DynamicAABBTreeCollisionManager<double> manager;
    manager.registerObject(&o1);
    manager.registerObject(&o2);
    manager.setup();
    DefaultCollisionData<double> collision;
    expectRefused([&] { manager.collide(&collision, DefaultCollisionFunction<double>); },
                  word);
    DefaultDistanceData<double> separation;
    expectRefused([&] { manager.distance(&separation, DefaultDistanceFunction<double>); },
                  word);
  }
};

using BVs = ::testing::Types<KDOP<double, 16>, AABB<double>, OBB<double>, OBBRSS<double>>;
TYPED_TEST_SUITE(DiscreteQuery, BVs, );

TYPED_TEST(DiscreteQuery, CollideIsRightAfterEveryUpdate) {
  using Model = typename TestFixture::Model;
  auto model = makeModel<Model>(this->next_);
  this->expectCollidesRight(*model);
  model = makeModel<Model>(this->sheet_, this->next_);
  this->expectCollidesRight(*model);
  this->expectCollidesRight(Model(*model));
  ASSERT_EQ(update(*model, this->sheet_), BVH_OK);
  ASSERT_EQ(model->updateFrames(model->vertices->data(), model->prev_vertices->data(),
                                this->sheet_.vertices.size(), FclTree::kUpdate),
            BVH_OK);
  this->expectCollidesRight(*model);
  ASSERT_EQ(update(*model, this->sheet_), BVH_OK);
  ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
  ASSERT_EQ(model->replaceSubModel(this->next_.vertices), BVH_OK);
  ASSERT_EQ(model->endReplaceModel(), BVH_OK);
  this->expectCollidesRight(*model);
}

TYPED_TEST(DiscreteQuery, SkippedTreeIsRefusedUntilUpdated) {
  using Model = typename TestFixture::Model;
  const auto model = std::make_shared<Model>();
  ASSERT_EQ(model->beginModel(), BVH_OK);
  ASSERT_EQ(model->addSubModel(this->sheet_.vertices, this->sheet_.triangles), BVH_OK);
  ASSERT_EQ(model->endModel(FclTree::kSkip), BVH_OK);
  this->expectRefusals(model);
  ASSERT_EQ(update(*model, this->next_), BVH_OK);
  this->expectRefusals(model);
  this->expectRefusals(std::make_shared<Model>(*model));
  ASSERT_EQ(model->updateFclTree(), BVH_OK);
  this->expectCollidesRight(*model);

  const double* next = this->next_.vertices[0].data();
  const double* sheet = this->sheet_.vertices[0].data();
  const std::size_t count = this->sheet_.vertices.size();
  ASSERT_EQ(update(*model, this->sheet_), BVH_OK);
  ASSERT_EQ(model->updateFrames(sheet, next, count), BVH_OK);
  this->expectRefusals(model);
  Model assigned;
  assigned = *model;
  ASSERT_EQ(model->updateFclTree(), BVH_OK);
  this->expectCollidesRight(*model);
  ASSERT_EQ(assigned.updateFclTree(), BVH_OK);
  this->expectCollidesRight(assigned);
  // An update that must not skip the tree brings it up to date as well.
  ASSERT_EQ(model->updateFrames(next, sheet, count), BVH_OK);
  ASSERT_EQ(update(*model, this->next_), BVH_OK);
  this->expectCollidesRight(*model);
}

TYPED_TEST(DiscreteQuery, SkippedAtBuildThenUpdateFramesBuilds) {
  using Model = typename TestFixture::Model;
  Model model;
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(this->sheet_.vertices, this->sheet_.triangles), BVH_OK);
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  ASSERT_EQ(model.updateFrames(model.vertices->data(), this->next_.vertices[0].data(),
                               this->next_.vertices.size(), FclTree::kUpdate),
            BVH_OK);
  EXPECT_TRUE(model.isFclTreeUpToDate());
  this->expectCollidesRight(model);
}

// FCL's oriented boxes of single thin triangles do not contain them. Bottom-up the tree
// is made of these boxes.
TEST(DiscreteQueryBoxes, ContainThinTriangles) {
  using Model = DeformableBVHModel<OBB<double>>;
  const TestMesh soup = makeTriangleSoup(40, 0.5, 0.8, 9);
  Random random(10);
  for (int exponent = 10; exponent < 60; ++exponent) {
    TestMesh thin = soup;
    for (std::size_t i = 0; i < thin.vertices.size(); i += 3)
      thin.vertices[i + 2] = 0.5 * (thin.vertices[i] + thin.vertices[i + 1]) +
                             std::ldexp(1, -exponent) * random.point(1);
    const auto model = makeModel<Model>(soup, thin);
    for (int i = 0; i < model->getNumBVs(); ++i) {
      const auto& node = model->getBV(i);
      if (!node.isLeaf()) continue;
      for (int k = 0; k < 3; ++k) {
        const Vector3<double> from_center =
            thin.vertices[thin.triangles[static_cast<std::size_t>(node.primitiveId())]
                                        [k]] -
            node.bv.To;
        const Vector3<double> along = node.bv.axis.transpose() * from_center;
        EXPECT_TRUE((along.cwiseAbs().array() <= node.bv.extent.array() + 1e-12).all())
            << exponent << ", " << i;
      }
    }
  }
}

template <typename BV>
class DiscreteDistanceOn : public ::testing::Test {};
using DistanceBVs =
    ::testing::Types<AABB<double>, RSS<double>, kIOS<double>, OBBRSS<double>>;
TYPED_TEST_SUITE(DiscreteDistanceOn, DistanceBVs, );

// Against models built from the current frame: the volumes that FCL merges when it refits
// an RSS tree bottom-up do not contain their children.
TYPED_TEST(DiscreteDistanceOn, MeshMeshIsRight) {
  using BV = TypeParam;
  const TestMesh sheet = bentSheet(6), next = shaken(sheet, 0.1, 3),
                 ball = floatMesh(makeIcosphere(1, 0.4));
  const auto model = makeModel<DeformableBVHModel<BV>>(sheet, next);
  const auto model_ball = makeModel<DeformableBVHModel<BV>>(moved(ball, 9, 0, 0), ball);
  const auto plain = makeModel<BVHModel<BV>>(next),
             plain_ball = makeModel<BVHModel<BV>>(ball);
  Random random(8);
  for (int i = 0; i < 10; ++i) {
    Pose tf1 = randomPose(random, 0.5), tf2 = randomPose(random, 0.5);
    tf2.translation().x() += 3;
    const double expected = distanceOf(*plain, tf1, *plain_ball, tf2);
    EXPECT_GT(expected, 0.1);
    EXPECT_NEAR(distanceOf(*model, tf1, *model_ball, tf2), expected, 1e-9);
    EXPECT_NEAR(distanceOf(*model, tf1, *plain_ball, tf2), expected, 1e-9);
    EXPECT_NEAR(distanceOf(*plain_ball, tf2, *model, tf1), expected, 1e-9);
    CollisionObject<double> o1(model, tf1), o2(model_ball, tf2);
    DistanceResult<double> result;
    EXPECT_NEAR(distance(&o1, &o2, DistanceRequest<double>(), result), expected, 1e-9);
    EXPECT_NEAR(result.min_distance, expected, 1e-9);
  }
}

/// Two of these have no distance function, and nothing is printed.
template <typename BV>
void expectNoMeshDistance() {
  const TestMesh sheet = bentSheet(4);
  const auto model = makeModel<DeformableBVHModel<BV>>(sheet, moved(sheet, 0, 0, 0.5));
  const auto plain = makeModel<BVHModel<BV>>(sheet);
  const Pose here = Pose::Identity();
  Pose there = here;
  there.translation().z() = 3;
  ::testing::internal::CaptureStderr();
  expectRefused([&] { distanceOf(*model, here, *model, there); }, "no distance function");
  expectRefused([&] { distanceOf(*model, here, *plain, there); }, "no distance function");
  expectRefused([&] { distanceOf(*plain, here, *model, there); }, "no distance function");
  CollisionObject<double> o1(model, here), o2(plain, there);
  DistanceResult<double> result;
  expectRefused([&] { distance(&o1, &o2, DistanceRequest<double>(), result); },
                "no distance function");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(DiscreteDistance, MeshMeshWithoutAFunctionIsRefused) {
  expectNoMeshDistance<KDOP<double, 16>>();
  expectNoMeshDistance<KDOP<double, 18>>();
  expectNoMeshDistance<KDOP<double, 24>>();
  expectNoMeshDistance<OBB<double>>();
  const TestMesh sheet = bentSheet(4);
  const auto box = makeModel<DeformableBVHModel<AABB<double>>>(sheet);
  const auto rss = makeModel<BVHModel<RSS<double>>>(sheet);
  const Pose here = Pose::Identity();
  expectRefused([&] { distanceOf(*box, here, *rss, here); },
                "o1 is a model of AABBs and o2 is a model of RSSs. FCL has no distance");
}

template <typename BV>
void expectShapeDistancesRight() {
  const TestMesh sheet = bentSheet(4), next = moved(sheet, 0, 0, 0.5);
  const auto model = makeModel<DeformableBVHModel<BV>>(sheet, next);
  const auto plain = makeModel<BVHModel<BV>>(next);
  const Sphere<double> sphere(0.25);
  const TriangleP<double> triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  Random random(9);
  for (int i = 0; i < 5; ++i) {
    Pose tf = randomPose(random, 0.4), tf_sphere = Pose::Identity();
    tf_sphere.translation().z() = 3;
    const double expected = distanceOf(*plain, tf, sphere, tf_sphere);
    EXPECT_GT(expected, 0.1);
    EXPECT_EQ(distanceOf(*model, tf, sphere, tf_sphere), expected);
    EXPECT_EQ(distanceOf(sphere, tf_sphere, *model, tf), expected);
    expectRefused([&] { distanceOf(*model, tf, triangle, tf_sphere); }, "no distance");
    expectRefused([&] { distanceOf(triangle, tf_sphere, *model, tf); }, "no distance");
  }
}

template <typename BV>
void expectNoShapeDistance() {
  const auto model = makeModel<DeformableBVHModel<BV>>(bentSheet(4));
  const Sphere<double> sphere(0.25);
  const Pose here = Pose::Identity();
  expectRefused([&] { distanceOf(*model, here, sphere, here); }, "no distance");
  expectRefused([&] { distanceOf(sphere, here, *model, here); }, "no distance");
}

TEST(DiscreteDistance, MeshShape) {
  expectShapeDistancesRight<RSS<double>>();
  expectShapeDistancesRight<kIOS<double>>();
  expectShapeDistancesRight<OBBRSS<double>>();
  expectNoShapeDistance<AABB<double>>();
  expectNoShapeDistance<KDOP<double, 16>>();
}

}  // namespace
}  // namespace test
}  // namespace fcl

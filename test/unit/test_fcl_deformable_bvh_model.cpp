// SPDX-License-Identifier: BSD-3-Clause
//
// The states of a DeformableBVHModel on every BV type and both scalars. What it refuses,
// and its state when memory runs out: test_fcl_deformable_bvh_model_errors.cpp. Discrete
// queries: test_fcl_deformable_discrete.cpp.
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include <limits>
#include <memory>
#include <utility>

#include "deformable_model_test.h"

namespace fcl {
namespace test {
namespace {

TYPED_TEST(DeformableModel, emptyHasFclsBox) {
  USING_FIXTURE;
  Model model;
  Plain plain;
  model.computeLocalAABB();
  plain.computeLocalAABB();
  EXPECT_TRUE(model.aabb_local.min_ == plain.aabb_local.min_);
  EXPECT_TRUE(model.aabb_local.max_ == plain.aabb_local.max_);
  EXPECT_TRUE(model.aabb_center == plain.aabb_center);
  EXPECT_EQ(model.aabb_radius, plain.aabb_radius);
}

TYPED_TEST(DeformableModel, BuildUpdateReplace) {
  USING_FIXTURE;
  const auto model = makeModel<Model>(kSheet);
  this->expectFrames(*model, kSheet, kSheet);
  EXPECT_FALSE(model->isDeforming());
  EXPECT_EQ(model->build_state, BVH_BUILD_STATE_PROCESSED);
  for (std::uint64_t n = 0; n < 3; ++n) {
    ASSERT_EQ(update(*model, frame(n)), BVH_OK);
    this->expectFrames(*model, n ? frame(n - 1) : kSheet, frame(n));
    EXPECT_TRUE(model->isDeforming());
    EXPECT_EQ(model->build_state, BVH_BUILD_STATE_PROCESSED);
  }
  ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
  ASSERT_EQ(model->replaceSubModel(this->points(frame(7))), BVH_OK);
  ASSERT_EQ(model->endReplaceModel(), BVH_OK);
  this->expectFrames(*model, frame(7), frame(7));
  EXPECT_FALSE(model->isDeforming());
  ASSERT_EQ(update(*model, kSheet), BVH_OK);
  this->expectFrames(*model, frame(7), kSheet);
}

TYPED_TEST(DeformableModel, PartsAddUpToTheWhole) {
  USING_FIXTURE;
  const TestMesh mesh = frame(1);
  const auto points = this->points(mesh);
  const std::vector<Vector3<S>> rest(points.begin() + 5, points.end());
  Model model;
  ASSERT_EQ(model.beginModel(), BVH_OK);
  for (const Vector3<S>& p : this->points(kSheet)) ASSERT_EQ(model.addVertex(p), BVH_OK);
  ASSERT_EQ(model.addSubModel({}, kSheet.triangles), BVH_OK);
  // FCL's addSubModel adds the number of existing vertices to the indices.
  for (int i = 0; i < model.num_tris; ++i) {
    Triangle& t = model.tri_indices[i];
    t = kSheet.triangles[static_cast<std::size_t>(i)];
  }
  ASSERT_EQ(model.endModel(), BVH_OK);
  ASSERT_EQ(model.beginUpdateModel(), BVH_OK);
  ASSERT_EQ(model.updateVertex(points[0]), BVH_OK);
  ASSERT_EQ(model.updateTriangle(points[1], points[2], points[3]), BVH_OK);
  ASSERT_EQ(model.updateVertex(points[4]), BVH_OK);
  ASSERT_EQ(model.updateSubModel(rest), BVH_OK);
  ASSERT_EQ(model.endUpdateModel(false), BVH_OK);
  this->expectFrames(model, kSheet, mesh);
  expectIdentical(selfContacts<S>(model),
                  selfContacts<S>(*makeModel<Model>(kSheet, mesh)));

  ASSERT_EQ(model.beginReplaceModel(), BVH_OK);
  ASSERT_EQ(model.replaceTriangle(points[0], points[1], points[2]), BVH_OK);
  ASSERT_EQ(model.replaceVertex(points[3]), BVH_OK);
  ASSERT_EQ(model.replaceVertex(points[4]), BVH_OK);
  ASSERT_EQ(model.replaceSubModel(rest), BVH_OK);
  ASSERT_EQ(model.endReplaceModel(true, false), BVH_OK);
  this->expectFrames(model, mesh, mesh);
}

TYPED_TEST(DeformableModel, AddTriangleMakesASoup) {
  USING_FIXTURE;
  const TestMesh soup = makeTriangleSoup(60, 0.5, 0.4, 3), next = shaken(soup, 0.3, 4);
  const auto points = this->points(floatMesh(soup));
  Model model;
  ASSERT_EQ(model.beginModel(), BVH_OK);
  for (const Triangle& t : soup.triangles)
    ASSERT_EQ(model.addTriangle(points[t[0]], points[t[1]], points[t[2]]), BVH_OK);
  ASSERT_EQ(model.endModel(), BVH_OK);
  ASSERT_EQ(model.num_vertices, 180);
  TestMesh in_order = floatMesh(soup), next_in_order = next;
  for (std::size_t i = 0; i < 180; ++i) {
    const std::size_t v = soup.triangles[i / 3][static_cast<int>(i % 3)];
    in_order.vertices[i] = floatMesh(soup).vertices[v];
    next_in_order.vertices[i] = next.vertices[v];
    in_order.triangles[i / 3] = Triangle(3 * (i / 3), 3 * (i / 3) + 1, 3 * (i / 3) + 2);
  }
  next_in_order.triangles = in_order.triangles;
  ASSERT_EQ(update(model, next_in_order), BVH_OK);
  this->expectFrames(model, in_order, next_in_order);
}

TYPED_TEST(DeformableModel, UpdateFramesGivesBothFrames) {
  USING_FIXTURE;
  const auto model = makeModel<Model>(kSheet);
  for (const FclTree tree : {FclTree::kSkip, FclTree::kUpdate}) {
    ASSERT_EQ(
        this->updateFrames(*model, this->points(frame(1)), this->points(frame(2)), tree),
        BVH_OK);
    this->expectFrames(*model, frame(1), frame(2));
    EXPECT_EQ(model->isFclTreeUpToDate(), tree == FclTree::kUpdate);
  }
}

TYPED_TEST(DeformableModel, UpdateFramesTakesItsOwnArrays) {
  USING_FIXTURE;
  const auto count = kSheet.vertices.size();
  for (const FclTree tree : {FclTree::kSkip, FclTree::kUpdate}) {
    const auto model = makeModel<Model>(frame(1), frame(2));
    const auto give = [&](const Vector3<S>* previous, const Vector3<S>* current) {
      return model->updateFrames(previous->data(), current->data(), count, tree);
    };
    ASSERT_EQ(give(model->vertices, model->prev_vertices), BVH_OK);
    this->expectFrames(*model, frame(2), frame(1));
    ASSERT_EQ(give(model->prev_vertices, model->vertices), BVH_OK);
    this->expectFrames(*model, frame(2), frame(1));
    const auto next = this->points(frame(3));
    ASSERT_EQ(give(model->vertices, next.data()), BVH_OK);
    this->expectFrames(*model, frame(1), frame(3));
    ASSERT_EQ(give(next.data(), model->prev_vertices), BVH_OK);
    this->expectFrames(*model, frame(3), frame(1));
    ASSERT_EQ(give(model->vertices, model->vertices), BVH_OK);
    this->expectFrames(*model, frame(1), frame(1));
  }
}

TYPED_TEST(DeformableModel, SkippedTreeServesContinuousQueries) {
  USING_FIXTURE;
  Model model;
  EXPECT_FALSE(model.isFclTreeUpToDate());
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  EXPECT_FALSE(model.isFclTreeUpToDate());
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  EXPECT_EQ(model.build_state, BVH_BUILD_STATE_BEGUN);
  EXPECT_THROW(model.getNodeType(), Exception);
  this->expectFrames(model, kSheet, kSheet);
  ASSERT_EQ(update(model, frame(1)), BVH_OK);
  this->expectFrames(model, kSheet, frame(1));
  EXPECT_FALSE(model.isFclTreeUpToDate());
  const Model copy(model);
  ASSERT_EQ(model.updateFclTree(), BVH_OK);
  EXPECT_TRUE(model.isFclTreeUpToDate());
  EXPECT_NO_THROW(model.getNodeType());
  this->expectFrames(model, kSheet, frame(1));
  EXPECT_THROW(copy.getNodeType(), Exception);
  this->expectFrames(copy, kSheet, frame(1));
  Model assigned;
  assigned = copy;
  EXPECT_FALSE(assigned.isFclTreeUpToDate());
  ASSERT_EQ(assigned.updateFclTree(), BVH_OK);
  ASSERT_EQ(update(assigned, frame(2)), BVH_OK);
  EXPECT_TRUE(assigned.isFclTreeUpToDate());
  this->expectFrames(assigned, frame(1), frame(2));
  this->expectFrames(copy, kSheet, frame(1));
}

// No update function of BVHModel is virtual.
TYPED_TEST(DeformableModel, NoticesChangesThroughTheBase) {
  USING_FIXTURE;
  const auto changed = makeModel<Model>(frame(1), frame(2));
  const auto other = makeModel<Plain>(moved(kSheet, 0.05, 0.03, 0.02));
  Plain& base = *changed;
  const auto expectLikePlain = [&](const Plain& plain) {
    expectIdentical(selfContacts<S>(*changed), selfContacts<S>(plain));
    // The tree decides which triangle of a rigid mesh stands for a shared feature.
    expectSameContacts(pairContacts<S>(*changed, *other), pairContacts<S>(plain, *other));
    expectSameContacts(pairContacts<S>(*other, *changed), pairContacts<S>(*other, plain));
  };
  ASSERT_EQ(update(base, frame(3)), BVH_OK);
  EXPECT_EQ(changed->updateFclTree(), BVH_OK);
  expectLikePlain(*makeModel<Plain>(frame(2), frame(3)));
  ASSERT_EQ(update(base, frame(4)), BVH_OK);
  expectLikePlain(*makeModel<Plain>(frame(3), frame(4)));
  ASSERT_EQ(update(*changed, frame(5)), BVH_OK);
  this->expectFrames(*changed, frame(4), frame(5));

  ASSERT_EQ(base.beginReplaceModel(), BVH_OK);
  expectRefused([&] { selfContacts<S>(*changed); }, "o: ");
  ASSERT_EQ(base.replaceSubModel(this->points(frame(6))), BVH_OK);
  ASSERT_EQ(base.endReplaceModel(), BVH_OK);
  expectLikePlain(*makeModel<Plain>(frame(6)));
  ASSERT_EQ(update(*changed, frame(7)), BVH_OK);
  this->expectFrames(*changed, frame(6), frame(7));

  // FCL clears the model, refuses the call, and leaks the arrays at the next call.
  ::testing::internal::CaptureStderr();
  ASSERT_EQ(base.beginModel(), BVH_ERR_BUILD_OUT_OF_SEQUENCE);
  EXPECT_NE(::testing::internal::GetCapturedStderr(), "");
  expectRefused([&] { selfContacts<S>(*changed); }, "not built");
  delete[] std::exchange(base.vertices, nullptr);
  delete[] std::exchange(base.tri_indices, nullptr);
  const TestMesh larger = bentSheet(9), larger_next = shaken(larger, 0.1, 9);
  ASSERT_EQ(base.beginModel(), BVH_OK);
  ASSERT_EQ(base.addSubModel(this->points(larger), larger.triangles), BVH_OK);
  ASSERT_EQ(base.endModel(), BVH_OK);
  expectLikePlain(*makeModel<Plain>(larger));
  ASSERT_EQ(update(*changed, larger_next), BVH_OK);
  this->expectFrames(*changed, larger, larger_next);
}

// While FCL's tree is not built, FCL accepts more triangles, as far as it has room.
TYPED_TEST(DeformableModel, GrowsAfterSteps) {
  USING_FIXTURE;
  const TestMesh soup = floatMesh(makeTriangleSoup(60, 0.4, 0.6, 5)),
                 next = shaken(soup, 0.1, 6);
  const auto points = this->points(soup);
  const auto add = [&](Model& model, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      EXPECT_EQ(model.addTriangle(points[3 * i], points[3 * i + 1], points[3 * i + 2]),
                BVH_OK);
  };
  Model model;
  ASSERT_EQ(model.beginModel(), BVH_OK);
  add(model, 0, 30);
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  const auto part = [](std::vector<Vector3<S>> all) {
    all.resize(90);
    return all;
  };
  ASSERT_EQ(model.updateFrames(part(this->points(next))[0].data(), part(points)[0].data(),
                               90, FclTree::kSkip),
            BVH_OK);
  add(model, 30, 60);
  // Between the calls it is a model under construction, which can be read and copied.
  model.computeLocalAABB();
  for (const auto& p : points) EXPECT_LE(p[0], model.aabb_local.max_[0]);
  Model copy(model);
  expectRefused([&] { selfContacts<S>(copy); }, "is not built");
  expectRefused([&] { selfContacts<S>(model); }, "has grown since endModel()");
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  ASSERT_EQ(model.updateFrames(points[0].data(), this->points(next)[0].data(),
                               points.size(), FclTree::kSkip),
            BVH_OK);
  Model whole;
  ASSERT_EQ(whole.beginModel(), BVH_OK);
  add(whole, 0, 60);
  ASSERT_EQ(whole.endModel(), BVH_OK);
  ASSERT_EQ(update(whole, next), BVH_OK);
  expectSameContacts(selfContacts<S>(model), selfContacts<S>(whole));
  EXPECT_GT(selfContacts<S>(whole).contacts.size(), 0U);
}

// FCL's copy of a model without vertices has no room for vertices, and does not check
// this.
TYPED_TEST(DeformableModel, CopiesGrowFromNothing) {
  USING_FIXTURE;
  const auto points = this->points(kSheet);
  for (const bool has_triangles : {false, true}) {
    Model original;
    ASSERT_EQ(original.beginModel(), BVH_OK);
    if (has_triangles) {
      ASSERT_EQ(original.addSubModel({}, kSheet.triangles), BVH_OK);
    }
    Model copy(original), assigned;
    assigned = original;
    for (Model* model : {&original, &copy, &assigned}) {
      if (has_triangles) {
        for (const Vector3<S>& p : points) ASSERT_EQ(model->addVertex(p), BVH_OK);
      } else {
        ASSERT_EQ(model->addSubModel(points, kSheet.triangles), BVH_OK);
      }
      ASSERT_EQ(model->endModel(), BVH_OK) << model->lastError();
      ASSERT_EQ(update(*model, frame(1)), BVH_OK);
      this->expectFrames(*model, kSheet, frame(1));
    }
  }
}

// The content and the size of a rigid model's previous frame do not matter.
TYPED_TEST(DeformableModel, GrowsThroughTheBase) {
  USING_FIXTURE;
  Model model;
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  Plain& base = model;
  const TestMesh other = moved(frame(1), 0.05, 0.03, 0.02);
  ASSERT_EQ(base.addSubModel(this->points(other), other.triangles), BVH_OK);
  ASSERT_EQ(base.endModel(), BVH_OK);
  base.prev_vertices[0][0] = std::numeric_limits<S>::quiet_NaN();
  Plain plain;
  ASSERT_EQ(plain.beginModel(), BVH_OK);
  ASSERT_EQ(plain.addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  ASSERT_EQ(plain.addSubModel(this->points(other), other.triangles), BVH_OK);
  ASSERT_EQ(plain.endModel(), BVH_OK);
  expectIdentical(selfContacts<S>(model), selfContacts<S>(plain));
  EXPECT_TRUE(selfContacts<S>(model).is_collide);
}

TYPED_TEST(DeformableModel, CopiesAreDeep) {
  USING_FIXTURE;
  auto original = makeModel<Model>(frame(1), frame(2));
  const auto answer = selfContacts<S>(*original);
  const auto copy = std::make_shared<Model>(*original);
  const auto assigned = makeModel<Model>(bentSheet(5));
  *assigned = *original;
  EXPECT_NE(copy->vertices, original->vertices);
  EXPECT_NE(assigned->prev_vertices, original->prev_vertices);
  const Model& self = *assigned;
  *assigned = self;
  ASSERT_EQ(update(*original, frame(3)), BVH_OK);
  for (const auto& model : {copy, assigned}) {
    expectIdentical(selfContacts<S>(*model), answer);
    this->expectFrames(*model, frame(1), frame(2));
  }
  original.reset();
  for (const auto& model : {copy, assigned}) {
    expectIdentical(selfContacts<S>(*model), answer);
    ASSERT_EQ(update(*model, frame(4)), BVH_OK);
    this->expectFrames(*model, frame(2), frame(4));
  }
  *assigned = Model();
  expectRefused([&] { selfContacts<S>(*assigned); }, "not built");
  // A copy of a model that was changed through its base class has this state, too.
  Plain& base = *copy;
  ASSERT_EQ(update(base, frame(5)), BVH_OK);
  const Model late(*copy);
  expectIdentical(selfContacts<S>(late), selfContacts<S>(*copy));
  EXPECT_GT(selfContacts<S>(late).contacts.size(), 50u);
}

TEST(DeformableModelMemory, PerTriangle) {
  const TestMesh sheet = bentSheet(100);
  const auto model =
      makeModel<DeformableBVHModel<KDOP<double, 16>>>(sheet, moved(sheet, 0, 0, 1));
  EXPECT_GT(model->deformableMemUsage(), sheet.triangles.size() * 64);
  EXPECT_LE(model->deformableMemUsage(), sheet.triangles.size() * 400);
}

}  // namespace
}  // namespace test
}  // namespace fcl

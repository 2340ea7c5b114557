// SPDX-License-Identifier: BSD-3-Clause
//
// The life of a DeformableBVHModel on every BV type and both scalars. Discrete queries:
// test_fcl_deformable_discrete.cpp.
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "allocation_failures.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/distance.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

const TestMesh kSheet = bentSheet(8);
/// The n-th frame of the sheet; crumpled enough for self-contacts.
TestMesh frame(std::uint64_t n) { return shaken(kSheet, 0.15, 100 + n); }

template <typename BV>
class DeformableModel : public ::testing::Test {
 protected:
  using S = typename BV::S;
  using Model = DeformableBVHModel<BV>;
  using Plain = BVHModel<BV>;
  using Points = std::vector<Vector3<S>>;

  static Points points(const TestMesh& mesh) { return pointsAs<S>(mesh.vertices); }

  static Points previousOf(const Plain& model) {
    return Points(model.prev_vertices, model.prev_vertices + model.num_vertices);
  }
  static Points currentOf(const Plain& model) {
    return Points(model.vertices, model.vertices + model.num_vertices);
  }

  static int updateFrames(Model& model, const Points& previous, const Points& current,
                          FclTree tree = FclTree::kSkip) {
    return model.updateFrames(previous[0].data(), current[0].data(), current.size(),
                              tree);
  }

  /// The frames are these, the boxes contain both, and a query answers as a plain model
  /// that went the same way.
  static void expectFrames(const Model& model, const TestMesh& previous,
                           const TestMesh& current) {
    EXPECT_TRUE(previousOf(model) == points(previous));
    EXPECT_TRUE(currentOf(model) == points(current));
    EXPECT_TRUE(model.lastError().empty()) << model.lastError();
    for (const TestMesh* mesh : {&previous, &current})
      for (const Vector3<S>& p : points(*mesh)) {
        EXPECT_TRUE(model.aabb_local.contain(p));
        EXPECT_LE((p - model.aabb_center).norm(), model.aabb_radius * (1 + S(1e-6)));
      }
    const auto plain = makeModel<Plain>(previous, current);
    const auto expected = selfContacts<S>(*plain);
    expectSameContacts(selfContacts<S>(model), expected);
    if (previousOf(model) != currentOf(model)) {
      EXPECT_GT(expected.contacts.size(), 5u);
    }
  }

  /// A refused call changes nothing, prints nothing, and says why.
  template <typename Call>
  static void expectRefusal(Model& model, int code, const std::string& word,
                            Call&& call) {
    const Points previous = previousOf(model), current = currentOf(model);
    const BVHBuildState state = model.build_state;
    const bool up_to_date = model.isFclTreeUpToDate();
    const auto before = selfContacts<S>(model);
    ::testing::internal::CaptureStderr();
    const int got = call();
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(got, code) << model.lastError();
    EXPECT_NE(model.lastError().find(word), std::string::npos) << model.lastError();
    EXPECT_TRUE(previousOf(model) == previous);
    EXPECT_TRUE(currentOf(model) == current);
    EXPECT_EQ(model.build_state, state);
    EXPECT_EQ(model.isFclTreeUpToDate(), up_to_date);
    expectIdentical(selfContacts<S>(model), before);
  }
};

using BVs =
    ::testing::Types<KDOP<double, 16>, OBBRSS<double>, AABB<double>, RSS<double>,
                     kIOS<double>, OBB<double>, KDOP<double, 18>, KDOP<double, 24>,
                     KDOP<float, 16>, OBBRSS<float>, AABB<float>, RSS<float>, kIOS<float>,
                     OBB<float>, KDOP<float, 18>, KDOP<float, 24>>;
TYPED_TEST_SUITE(DeformableModel, BVs, );

#define USING_FIXTURE                        \
  using Model = typename TestFixture::Model; \
  using Plain = typename TestFixture::Plain; \
  using S = typename TestFixture::S;         \
  (void)sizeof(Plain);                       \
  (void)sizeof(S)

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
  // FCL's addSubModel counts indices from the vertices that are there already.
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

TYPED_TEST(DeformableModel, RefusesBadFrames) {
  USING_FIXTURE;
  const S nan = std::numeric_limits<S>::quiet_NaN(),
          inf = std::numeric_limits<S>::infinity();
  const auto model = makeModel<Model>(frame(1), frame(2));
  const auto good = this->points(frame(3));
  for (const S bad : {nan, inf, -inf}) {
    auto points = good;
    points[17][1] = bad;
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, "vertex 17", [&] {
      model->beginUpdateModel();
      model->updateSubModel(points);
      return model->endUpdateModel();
    });
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, "vertex 17", [&] {
      model->beginReplaceModel();
      model->replaceSubModel(points);
      return model->endReplaceModel();
    });
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, "vertex 17 of the previous",
                        [&] { return this->updateFrames(*model, points, good); });
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, "vertex 17 of the current",
                        [&] { return this->updateFrames(*model, good, points); });
  }
  for (const std::size_t count : {std::size_t{0}, good.size() - 1, 50 * good.size()}) {
    auto points = good;
    points.resize(count, Vector3<S>::Zero());
    const std::string number = std::to_string(count) + " vertices";
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, number, [&] {
      model->beginUpdateModel();
      model->updateSubModel(points);
      return model->endUpdateModel();
    });
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, number, [&] {
      model->beginReplaceModel();
      for (const auto& p : points) model->replaceVertex(p);
      return model->endReplaceModel();
    });
    this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, number, [&] {
      return model->updateFrames(good[0].data(), good[0].data(), count);
    });
  }
  this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, "null", [&] {
    return model->updateFrames(nullptr, good[0].data(), good.size());
  });
  this->expectRefusal(*model, BVH_ERR_INCORRECT_DATA, "null", [&] {
    return model->updateFrames(good[0].data(), nullptr, good.size());
  });
  ASSERT_EQ(update(*model, frame(3)), BVH_OK);
  this->expectFrames(*model, frame(2), frame(3));
}

TYPED_TEST(DeformableModel, RefusesCallsOutOfOrder) {
  USING_FIXTURE;
  const auto model = makeModel<Model>(frame(1), frame(2));
  const auto p = this->points(frame(3));
  const int wrong = BVH_ERR_BUILD_OUT_OF_SEQUENCE;
  const auto refuse = [&](const char* word, auto call) {
    this->expectRefusal(*model, wrong, word, call);
  };
  refuse("endModel", [&] { return model->endModel(); });
  refuse("endUpdateModel", [&] { return model->endUpdateModel(); });
  refuse("endReplaceModel", [&] { return model->endReplaceModel(); });
  refuse("begin", [&] { return model->updateVertex(p[0]); });
  refuse("begin", [&] { return model->updateTriangle(p[0], p[1], p[2]); });
  refuse("begin", [&] { return model->updateSubModel(p); });
  refuse("begin", [&] { return model->replaceVertex(p[0]); });
  refuse("begin", [&] { return model->replaceTriangle(p[0], p[1], p[2]); });
  refuse("begin", [&] { return model->replaceSubModel(p); });

  // A query in the middle of an update has no right answer.
  ASSERT_EQ(model->beginUpdateModel(), BVH_OK);
  ASSERT_EQ(model->updateVertex(p[0]), BVH_OK);
  expectRefused([&] { selfContacts<S>(*model); }, "update");
  EXPECT_EQ(this->updateFrames(*model, p, p), wrong);
  EXPECT_NE(model->lastError().find("updateFrames"), std::string::npos);
  EXPECT_EQ(model->updateFclTree(), wrong);
  EXPECT_EQ(model->replaceVertex(p[0]), wrong);
  ASSERT_EQ(model->updateSubModel({p.begin() + 1, p.end()}), BVH_OK);
  ASSERT_EQ(model->endUpdateModel(), BVH_OK);
  this->expectFrames(*model, frame(2), frame(3));
}

TYPED_TEST(DeformableModel, RefusesToBuildNonsense) {
  USING_FIXTURE;
  const auto expectError = [](const Model& model, int code, int expected,
                              const char* word) {
    EXPECT_EQ(code, expected);
    EXPECT_NE(model.lastError().find(word), std::string::npos) << model.lastError();
  };
  ::testing::internal::CaptureStderr();
  const auto points = this->points(kSheet);
  Model model;
  expectError(model, model.endModel(), BVH_ERR_BUILD_OUT_OF_SEQUENCE, "beginModel");
  expectError(model, model.beginUpdateModel(), BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
              "beginUpdateModel");
  expectError(model, model.beginReplaceModel(), BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
              "beginReplaceModel");
  expectError(model, this->updateFrames(model, points, points),
              BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME, "updateFrames");
  expectError(model, model.updateFclTree(), BVH_ERR_BUILD_EMPTY_MODEL, "updateFclTree");
  expectRefused([&] { selfContacts<S>(model); }, "not built");

  ASSERT_EQ(model.beginModel(), BVH_OK);
  expectError(model, model.endModel(), BVH_ERR_BUILD_EMPTY_MODEL, "no triangles");
  ASSERT_EQ(model.addSubModel(points), BVH_OK);
  expectError(model, model.endModel(), BVH_ERR_BUILD_EMPTY_MODEL, "no triangles");
  expectRefused([&] { selfContacts<S>(model); }, "");
  ASSERT_EQ(model.addSubModel({}, {Triangle(0, 1, 2)}), BVH_OK);
  model.tri_indices[0] = Triangle(0, points.size(), 2);
  expectError(model, model.endModel(), BVH_ERR_INCORRECT_DATA,
              ("triangle 0 refers to vertex " + std::to_string(points.size())).c_str());
  model.tri_indices[0] = Triangle(0, 1, 10);
  const int num_vertices = std::exchange(model.num_vertices, (1 << 29) + 1);
  expectError(model, model.endModel(), BVH_ERR_INCORRECT_DATA,
              "536870913 vertices are more than 536870912");
  model.num_vertices = num_vertices;
  model.vertices[3][2] = std::numeric_limits<S>::quiet_NaN();
  expectError(model, model.endModel(), BVH_ERR_INCORRECT_DATA, "vertex 3 ");
  model.vertices[3][2] = std::numeric_limits<S>::infinity();
  expectError(model, model.endModel(FclTree::kSkip), BVH_ERR_INCORRECT_DATA, "vertex 3 ");
  model.vertices[3][2] = 0;
  EXPECT_EQ(model.endModel(), BVH_OK) << "a model stays open for correction";
  EXPECT_TRUE(model.lastError().empty());
  EXPECT_FALSE(selfContacts<S>(model).is_collide);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// No update function of BVHModel is virtual.
TYPED_TEST(DeformableModel, NoticesChangesThroughTheBase) {
  USING_FIXTURE;
  const auto changed = makeModel<Model>(frame(1), frame(2));
  const auto other = makeModel<Plain>(moved(kSheet, 0.05, 0.03, 0.02));
  Plain& base = *changed;
  const auto expectLikePlain = [&](const Plain& plain) {
    expectIdentical(selfContacts<S>(*changed), selfContacts<S>(plain));
    // Which of a rigid mesh's triangles stands for a shared feature depends on the tree.
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

  // FCL clears the model, refuses, and leaks the arrays at the next call.
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

// The base knows nothing of an update that is open.
TYPED_TEST(DeformableModel, RefusesToEndWhatTheBaseHasChanged) {
  USING_FIXTURE;
  const auto expectChanged = [](Model& model, int code) {
    EXPECT_EQ(code, BVH_ERR_BUILD_OUT_OF_SEQUENCE);
    EXPECT_NE(model.lastError().find("changed since"), std::string::npos);
    EXPECT_FALSE(model.isUpdateOpen());
  };
  const auto model = makeModel<Model>(frame(1), frame(2));
  Plain& base = *model;
  ASSERT_EQ(model->beginUpdateModel(), BVH_OK);
  ASSERT_EQ(model->updateSubModel(this->points(frame(3))), BVH_OK);
  ASSERT_EQ(update(base, frame(4)), BVH_OK);
  expectChanged(*model, model->endUpdateModel());
  ASSERT_EQ(update(*model, frame(5)), BVH_OK);
  this->expectFrames(*model, frame(4), frame(5));

  // A model of as many vertices that is not built yet.
  ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
  const Model copy(*model);
  ::testing::internal::CaptureStderr();
  ASSERT_EQ(model->beginModel(), BVH_ERR_BUILD_OUT_OF_SEQUENCE);
  ::testing::internal::GetCapturedStderr();
  delete[] std::exchange(base.vertices, nullptr);
  delete[] std::exchange(base.tri_indices, nullptr);
  ASSERT_EQ(model->beginModel(), BVH_OK);
  ASSERT_EQ(model->addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  ASSERT_EQ(model->replaceSubModel(this->points(frame(6))), BVH_OK);
  expectChanged(*model, model->endReplaceModel());
  ASSERT_EQ(model->endModel(), BVH_OK);
  ASSERT_EQ(update(*model, frame(7)), BVH_OK);
  this->expectFrames(*model, kSheet, frame(7));

  // The copy's update is open, and its own.
  Model assigned;
  assigned = copy;
  ASSERT_EQ(assigned.replaceSubModel(this->points(frame(6))), BVH_OK);
  ASSERT_EQ(assigned.endReplaceModel(), BVH_OK);
  this->expectFrames(assigned, frame(6), frame(6));
}

// While FCL's tree is not built, FCL takes more triangles, as far as it has room.
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
  // In between it is a model that is being built, and can be looked at and copied.
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

// FCL takes triangles before anything has begun, beyond its arrays, and after an update,
// without a previous frame for them.
TYPED_TEST(DeformableModel, RefusesToAddWhereNothingHasBegun) {
  USING_FIXTURE;
  const int wrong = BVH_ERR_BUILD_OUT_OF_SEQUENCE;
  const auto p = this->points(frame(3));
  const std::vector<Triangle> triangles = {Triangle(0, 1, 2)};
  Model empty;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(empty.addVertex(p[0]), wrong);
  EXPECT_EQ(empty.addTriangle(p[0], p[1], p[2]), wrong);
  EXPECT_EQ(empty.addSubModel(p), wrong);
  EXPECT_EQ(empty.addSubModel(p, triangles), wrong);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(empty.num_vertices, 0);
  EXPECT_EQ(empty.num_tris, 0);

  const auto model = makeModel<Model>(frame(1), frame(2));
  Plain& base = *model;
  for (int i = 0; i < 2; ++i) {
    const auto refuse = [&](auto call) {
      this->expectRefusal(*model, wrong, "beginModel", call);
    };
    refuse([&] { return model->addVertex(p[0]); });
    refuse([&] { return model->addTriangle(p[0], p[1], p[2]); });
    refuse([&] { return model->addSubModel(p); });
    refuse([&] { return model->addSubModel(p, triangles); });
    // And again, where FCL's state is that of an update.
    ASSERT_EQ(update(base, frame(3)), BVH_OK);
  }
}

// Its motion would be lost.
TYPED_TEST(DeformableModel, EndsOnceUnlessItGrows) {
  USING_FIXTURE;
  Model model;
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  ASSERT_EQ(this->updateFrames(model, this->points(frame(1)), this->points(frame(2))),
            BVH_OK);
  this->expectRefusal(model, BVH_ERR_BUILD_OUT_OF_SEQUENCE, "updateFclTree",
                      [&] { return model.endModel(); });
  ASSERT_EQ(model.addSubModel({}), BVH_OK) << "nothing is added";
  this->expectFrames(model, frame(1), frame(2));
  ASSERT_EQ(model.updateFclTree(), BVH_OK);
  this->expectFrames(model, frame(1), frame(2));
  EXPECT_TRUE(model.isFclTreeUpToDate());
}

// FCL's copy of a model without vertices has no room for any, and does not know it.
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

// FCL's queries would read a tree that is not there.
TYPED_TEST(DeformableModel, DiscreteQueriesRefuseWhatIsNotBuilt) {
  USING_FIXTURE;
  const auto built = makeModel<Model>(kSheet);
  const auto expectThrow = [&](const Model& model, const char* word) {
    EXPECT_FALSE(model.isFclTreeUpToDate());
    const auto tf = Transform3<S>::Identity();
    CollisionResult<S> result;
    expectRefused(
        [&] { collide(&model, tf, built.get(), tf, CollisionRequest<S>(), result); },
        word);
    DistanceResult<S> distances;
    expectRefused(
        [&] { distance(built.get(), tf, &model, tf, DistanceRequest<S>(), distances); },
        word);
  };
  Model model;
  expectThrow(model, "not built");
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  expectThrow(model, "not built");
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  expectThrow(model, "updateFclTree");
  ASSERT_EQ(model.addVertex(this->points(kSheet)[0]), BVH_OK);
  expectThrow(model, "has grown");
  expectThrow(Model(model), "not built");
}

// What a rigid model has in its previous frame is nobody's concern, nor how much.
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
  Plain plain;
  ASSERT_EQ(plain.beginModel(), BVH_OK);
  ASSERT_EQ(plain.addSubModel(this->points(kSheet), kSheet.triangles), BVH_OK);
  ASSERT_EQ(plain.addSubModel(this->points(other), other.triangles), BVH_OK);
  ASSERT_EQ(plain.endModel(), BVH_OK);
  expectIdentical(selfContacts<S>(model), selfContacts<S>(plain));
  EXPECT_TRUE(selfContacts<S>(model).is_collide);
}

TYPED_TEST(DeformableModel, QueriesRefuseTooManyTriangles) {
  using Plain = typename TestFixture::Plain;
  using S = typename TestFixture::S;
  const auto model = makeModel<Plain>(frame(1));
  for (int* count : {&model->num_tris, &model->num_vertices}) {
    const int before = std::exchange(*count, (1 << 29) + 1);
    expectRefused([&] { selfContacts<S>(*model); }, "o: 536870913 ");
    *count = before;
  }
  EXPECT_NO_THROW(selfContacts<S>(*model));
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
  // A copy of a model that was changed through its base knows it, too.
  Plain& base = *copy;
  ASSERT_EQ(update(base, frame(5)), BVH_OK);
  const Model late(*copy);
  expectIdentical(selfContacts<S>(late), selfContacts<S>(*copy));
  EXPECT_GT(selfContacts<S>(late).contacts.size(), 50u);
}

/// Whether the call runs out of memory, if so many allocations succeed.
template <typename Call>
bool failsAfter(int allocations, Call&& call) {
  allocations_left = allocations;
  bool fails = false;
  try {
    fails = call() != BVH_OK;
  } catch (const std::bad_alloc&) {
    fails = true;
  }
  allocations_left = -1;
  return fails;
}

/// What comes after an allocation that fails: many are tried, but not all.
int nextAllocation(int i) { return i + 1 + i / 8; }

// A model is as before, or, if an update was half done, refused until it has both frames.
TYPED_TEST(DeformableModel, UpdateWithoutMemory) {
  USING_FIXTURE;
  const auto p = this->points(frame(3)), q = this->points(frame(4));
  const std::function<int(Model&)> updates[] = {
      [&](Model& model) { return update(model, frame(3)); },
      [&](Model& model) {
        model.beginUpdateModel();
        model.updateSubModel(p);
        return model.endUpdateModel(false);
      },
      [&](Model& model) {
        model.beginReplaceModel();
        model.replaceSubModel(p);
        return model.endReplaceModel();
      },
      [&](Model& model) { return this->updateFrames(model, p, q); },
      [&](Model& model) { return this->updateFrames(model, p, q, FclTree::kUpdate); },
      [&](Model& model) { return model.updateFclTree(); }};
  const std::function<void(Model&)> beginnings[] = {
      [](Model& model) { model.endModel(); },
      [](Model& model) { model.endModel(FclTree::kSkip); },
      [&](Model& model) {
        model.endModel();
        this->updateFrames(model, p, q);
      },
      [&](Model& model) {
        model.endModel();
        EXPECT_EQ(update<Plain>(model, frame(2)), BVH_OK);
      }};
  const auto modelOf = [&](const auto& beginning) {
    auto model = std::make_unique<Model>();
    EXPECT_EQ(model->beginModel(), BVH_OK);
    EXPECT_EQ(model->addSubModel(this->points(frame(1)), kSheet.triangles), BVH_OK);
    beginning(*model);
    return model;
  };
  int num_refused = 0, num_unchanged = 0;
  for (const auto& beginning : beginnings)
    for (const auto& change : updates) {
      const auto before = modelOf(beginning), after = modelOf(beginning);
      const bool is_possible = change(*after) == BVH_OK;
      const auto answer_before = selfContacts<S>(*before),
                 answer_after = selfContacts<S>(*after);
      for (int i = 0;; i = nextAllocation(i)) {
        const auto model = modelOf(beginning);
        ::testing::internal::CaptureStderr();  // FCL tells that there is no memory
        const bool fails = failsAfter(i, [&] { return change(*model); });
        ::testing::internal::GetCapturedStderr();
        if (!fails || !is_possible) break;
        if (model->build_state == BVH_BUILD_STATE_UPDATE_BEGUN) {
          ++num_refused;
          expectRefused([&] { selfContacts<S>(*model); }, "the last update failed");
          expectRefused([&] { pairContacts<S>(*after, *model); }, "last update failed");
          expectRefused([&] { model->getNodeType(); }, "the last update failed");
          expectRefused([&] { const Model copy(*model); }, "failed");
          EXPECT_EQ(model->beginUpdateModel(), BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME);
          EXPECT_NE(model->updateFclTree(), BVH_OK);
          EXPECT_NE(model->lastError().find("failed"), std::string::npos);
        } else if (!model->isUpdateOpen()) {
          ++num_unchanged;
          // Frames are there before FCL's tree is built for them.
          const bool is_old = this->previousOf(*model) == this->previousOf(*before) &&
                              this->currentOf(*model) == this->currentOf(*before);
          expectIdentical(selfContacts<S>(*model), is_old ? answer_before : answer_after);
          if (!before->isFclTreeUpToDate()) {
            EXPECT_THROW(model->getNodeType(), Exception);
          }
        }
        if (model->isUpdateOpen()) continue;
        if (i % 2) {
          ASSERT_EQ(this->updateFrames(*model, p, q), BVH_OK);
          this->expectFrames(*model, frame(3), frame(4));
        } else {
          ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
          ASSERT_EQ(model->replaceSubModel(p), BVH_OK);
          ASSERT_EQ(model->endReplaceModel(), BVH_OK);
          ASSERT_EQ(update(*model, frame(4)), BVH_OK);
          this->expectFrames(*model, frame(3), frame(4));
        }
        ASSERT_FALSE(this->HasFailure());
      }
    }
  EXPECT_GT(num_refused, 20);
  EXPECT_GT(num_unchanged, 20);
}

TYPED_TEST(DeformableModel, BuildWithoutMemory) {
  USING_FIXTURE;
  for (const FclTree tree : {FclTree::kSkip, FclTree::kUpdate}) {
    int num_failures = 0;
    for (int i = 0;; i = nextAllocation(i)) {
      Model model;
      ASSERT_EQ(model.beginModel(), BVH_OK);
      ASSERT_EQ(model.addSubModel(this->points(frame(1)), kSheet.triangles), BVH_OK);
      ::testing::internal::CaptureStderr();
      const bool fails = failsAfter(i, [&] { return model.endModel(tree); });
      ::testing::internal::GetCapturedStderr();
      if (!fails) break;
      ++num_failures;
      expectRefused([&] { selfContacts<S>(model); }, "not built");
      EXPECT_EQ(this->updateFrames(model, this->points(frame(1)), this->points(frame(2))),
                BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME);
      // FCL does not give back what it had for its own tree.
      if (tree == FclTree::kUpdate) continue;
      ASSERT_EQ(model.endModel(tree), BVH_OK);
      ASSERT_EQ(update(model, frame(2)), BVH_OK);
      this->expectFrames(model, frame(1), frame(2));
    }
    EXPECT_GT(num_failures, 10);
  }
}

TYPED_TEST(DeformableModel, AssignmentWithoutMemory) {
  USING_FIXTURE;
  const auto other = makeModel<Model>(bentSheet(5));
  for (int i = 0;; ++i) {
    const auto model = makeModel<Model>(frame(1), frame(2));
    const bool fails = failsAfter(i, [&] {
      *model = *other;
      return BVH_OK;
    });
    EXPECT_TRUE(model->isInStep());
    if (!fails) break;
    ASSERT_LT(i, 200);
    this->expectFrames(*model, frame(1), frame(2));
  }
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

// SPDX-License-Identifier: BSD-3-Clause
//
// What a DeformableBVHModel refuses, and its state when memory runs out, on every BV type
// and both scalars.
#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "allocation_failures.h"
#include "deformable_model_test.h"
#include "fcl/narrowphase/distance.h"
#include "sanitizer.h"

namespace fcl {
namespace test {
namespace {

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

// The base class does not know that an update is open.
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

  // A model with the same number of vertices that is not built yet.
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

  // The copy has an open update of its own.
  Model assigned;
  assigned = copy;
  ASSERT_EQ(assigned.replaceSubModel(this->points(frame(6))), BVH_OK);
  ASSERT_EQ(assigned.endReplaceModel(), BVH_OK);
  this->expectFrames(assigned, frame(6), frame(6));
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
    // The same in FCL's state of an update.
    ASSERT_EQ(update(base, frame(3)), BVH_OK);
  }
}

// The motion of the model would be lost.
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

// FCL's queries would read a tree that does not exist.
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
    // In float the compiler would have to make all of FCL's distance functions.
    if constexpr (std::is_same_v<S, double>) {
      DistanceResult<S> distances;
      expectRefused(
          [&] { distance(built.get(), tf, &model, tf, DistanceRequest<S>(), distances); },
          word);
    }
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

/// Whether the call runs out of memory after this number of allocations.
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

/// The state after an allocation that fails. Many allocations are tried, but not all.
int nextAllocation(int i) { return i + 1 + i / 8; }

// A model is unchanged. Or, if an update was half done, it is refused until it has both
// frames.
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
          // The frames are set before FCL's tree is built for them.
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
      // FCL does not free the memory of its own tree.
      if (tree == FclTree::kUpdate) continue;
      ASSERT_EQ(model.endModel(tree), BVH_OK);
      ASSERT_EQ(update(model, frame(2)), BVH_OK);
      this->expectFrames(model, frame(1), frame(2));
    }
    EXPECT_GT(num_failures, 10);
  }
}

TYPED_TEST(DeformableModel, AddsWithoutMemory) {
  USING_FIXTURE;
  if (kHasAddressSanitizer)
    GTEST_SKIP()
        << "Not all of FCL's arrays are allocated by this program's operator new";
  const auto p = this->points(frame(3));
  const std::function<int(Model&)> additions[] = {
      [&](Model& model) { return model.addVertex(p[0]); },
      [&](Model& model) { return model.addTriangle(p[0], p[1], p[2]); },
      [&](Model& model) { return model.addSubModel(p); },
      [&](Model& model) { return model.addSubModel(p, kSheet.triangles); },
  };
  int num_failures = 0;
  for (const auto& add : additions)
    for (int i = 0;; ++i) {
      Model model;
      // No room for more.
      ASSERT_EQ(model.beginModel(static_cast<int>(kSheet.triangles.size()),
                                 static_cast<int>(p.size())),
                BVH_OK);
      for (const Vector3<S>& x : this->points(frame(1)))
        ASSERT_EQ(model.addVertex(x), BVH_OK);
      std::copy(kSheet.triangles.begin(), kSheet.triangles.end(), model.tri_indices);
      model.num_tris = static_cast<int>(kSheet.triangles.size());
      ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
      ASSERT_EQ(this->updateFrames(model, this->points(frame(1)), this->points(frame(2))),
                BVH_OK);
      ::testing::internal::CaptureStderr();  // FCL tells that there is no memory
      const bool fails = failsAfter(i, [&] { return add(model); });
      ::testing::internal::GetCapturedStderr();
      if (!fails) break;
      ++num_failures;
      model.setNumThreads(1);  // clears the error
      this->expectFrames(model, frame(1), frame(2));
    }
  // For vertices, and for triangles if there are any.
  EXPECT_GE(num_failures, 6);
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

}  // namespace
}  // namespace test
}  // namespace fcl

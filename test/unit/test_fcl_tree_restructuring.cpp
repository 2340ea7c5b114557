// SPDX-License-Identifier: BSD-3-Clause
//
// A part of a tree that has aged is rebuilt. This changes the time of a query and nothing
// else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "allocation_failures.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "generated_scenes.h"
#include "mesh_generators.h"
#include "moving_mesh.h"
#include "sanitizer.h"
#include "test_models.h"
#include "tree_checks.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<>;
using Result = ContinuousContactResult<double>;
using Points = std::vector<Vector3<double>>;
using detail::deformable::assignFeatures;

FrameSequence reversed(FrameSequence sequence) {
  std::reverse(sequence.frames.begin(), sequence.frames.end());
  return sequence;
}

/// A tree and the mesh that it is made for.
struct MovingTree {
  explicit MovingTree(const FrameSequence& sequence)
      : triangles(assignFeatures(sequence.triangles.data(), sequence.triangles.size(),
                                 sequence.frames[0].size())) {
    const VertexFrames frames = framesOf(sequence.frames[0], sequence.frames[0]);
    tree.build(sequence.triangles.data(), sequence.triangles.size(), frames);
    tree.refit(frames);
  }
  static VertexFrames framesOf(const Points& t0, const Points& t1) {
    return {t0[0].data(), t1[0].data(), t0.size()};
  }
  /// @return whether the tree was restructured
  bool step(const Points& t0, const Points& t1) {
    const bool has_changed = tree.restructure();
    tree.refit(framesOf(t0, t1));
    return has_changed;
  }

  std::vector<MeshTriangle> triangles;
  MovingKdopTree tree;
};

/// Goes through a sequence.
/// @return the number of steps that restructured the tree
int countRestructurings(const FrameSequence& sequence) {
  MovingTree moving(sequence);
  int count = 0;
  for (std::size_t i = 0; i + 1 < sequence.frames.size(); ++i)
    count += moving.step(sequence.frames[i], sequence.frames[i + 1]);
  return count;
}

double comparedBoxes(const Model& model) {
  Result result;
  continuousSelfCollide(&model, ContinuousContactRequest<double>(), result);
  return static_cast<double>(result.counts.node_pairs);
}

void build(const FrameSequence& sequence, std::size_t frame, Model& model) {
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(sequence.frames[frame], sequence.triangles), BVH_OK);
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
}

void update(const FrameSequence& sequence, std::size_t i, Model& model) {
  ASSERT_EQ(
      model.updateFrames(sequence.frames[i][0].data(), sequence.frames[i + 1][0].data(),
                         sequence.frames[i].size()),
      BVH_OK);
}

/// All data of the contacts that a user gets, to the bit and in order.
void expectSameContacts(const Model& x, const Model& y) {
  expectIdentical(selfContacts<double>(x), selfContacts<double>(y));
}

TEST(FCL_TREE_RESTRUCTURING, onlyWhereBoxesGrow) {
  const int mix = countRestructurings(makeMixingBalls(61));
  EXPECT_GE(mix, 2);
  EXPECT_LE(mix, 10);
  if (kHasAddressSanitizer) return;
  // Large components have trees of their own.
  EXPECT_EQ(countRestructurings(makeMixingBalls(61, 8)), 0);
  const int unfold = countRestructurings(reversed(makeCrumplingSheet(61)));
  EXPECT_GE(unfold, 1);
  EXPECT_LE(unfold, 4);
  EXPECT_EQ(countRestructurings(makeWavingCloth(61)), 0);
  EXPECT_EQ(countRestructurings(makeCrumplingSheet(61)), 0);
}

// A whole turn about three axes, a motion far away and back, and a change of size.
TEST(FCL_TREE_RESTRUCTURING, notByRigidMotionOrSize) {
  const FramePairMesh cloth = makeSmoothCloth(5000);
  for (const TestMesh& mesh :
       {makeSheet(40, 40), makeSheet(80, 20), makeIcosphere(3, 1), makeBox({1, 1, 1}, 12),
        makeTriangleSoup(2000, 1, 0.1, 5), TestMesh{cloth.previous, cloth.triangles}})
    for (int axis = 0; axis < 4; ++axis) {
      FrameSequence sequence{mesh.triangles, {}};
      for (int frame = 0; frame <= 24; ++frame) {
        Transform3<double> tf = Transform3<double>::Identity();
        const Vector3<double> about =
            axis < 3 ? Vector3<double>::Unit(axis) : Vector3<double>(0.6, 0.64, 0.48);
        tf.linear() =
            AngleAxis<double>(std::acos(-1.) * frame / 12, about).toRotationMatrix();
        tf.linear() *= std::pow(1.5, frame % 12);
        tf.translation()[axis % 3] = 1e3 * (frame % 5);
        sequence.frames.push_back(transformed(mesh, tf).vertices);
      }
      EXPECT_EQ(countRestructurings(sequence), 0) << "axis " << axis;
    }
}

TEST(FCL_TREE_RESTRUCTURING, structureAndBoxes) {
  for (const auto& sequence : {makeMixingBalls(16), reversed(makeCrumplingSheet(13))}) {
    MovingTree moving(sequence);
    ASSERT_NO_FATAL_FAILURE(expectBorders(moving.tree));
    int count = 0;
    for (std::size_t i = 0; i + 1 < sequence.frames.size(); ++i) {
      const Points &t0 = sequence.frames[i], &t1 = sequence.frames[i + 1];
      if (!moving.step(t0, t1)) continue;
      ++count;
      // Each check takes seconds under the address sanitizer.
      if (kHasAddressSanitizer && count > 1) continue;
      expectContainment(moving.tree, moving.triangles, MovingTree::framesOf(t0, t1));
      ASSERT_NO_FATAL_FAILURE(expectFans(moving.tree));
      ASSERT_NO_FATAL_FAILURE(expectBorders(moving.tree));
    }
    EXPECT_GE(count, 1);
  }
}

// Everything may move to any place. A scene that was scattered completely is not
// restructured again and again.
TEST(FCL_TREE_RESTRUCTURING, randomJumps) {
  constexpr std::uint64_t kSeed = 70;
  Random random(kSeed);
  for (const std::size_t count : {1U, 2U, 8U, 9U, 64U, 65U, 700U, 3000U}) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(count));
    TestMesh soup = makeTriangleSoup(static_cast<int>(count), 1, 0.01, 7);
    MovingTree moving({soup.triangles, {soup.vertices}});
    int changes = 0;
    for (int step = 0; step < 12; ++step) {
      TestMesh next = soup;
      for (std::size_t i = 0; i < count; ++i) {
        const Vector3<double> by = random.point(step % 3 ? 0.3 : 2);
        for (std::size_t k = 0; k < 3; ++k) next.vertices[3 * i + k] += by;
      }
      if (moving.step(soup.vertices, next.vertices)) {
        ++changes;
        expectContainment(moving.tree, moving.triangles,
                          MovingTree::framesOf(soup.vertices, next.vertices));
      }
      soup = next;
    }
    EXPECT_EQ(changes > 0, count > 8);
    EXPECT_LE(changes, 8);
  }
}

TEST(FCL_TREE_RESTRUCTURING, boxesWithoutBounds) {
  const TestMesh soup = makeTriangleSoup(500, 1, 0.01, 7);
  for (const double size : {1e-310, 1e-40, 1e36, 1e37, 1e38, 1e39, 1e300}) {
    Random random(71);
    TestMesh mesh = soup;
    MovingTree moving({mesh.triangles, {mesh.vertices}});
    for (int step = 0; step < 4; ++step) {
      const Points before = mesh.vertices;
      for (auto& p : mesh.vertices) p = random.point(size);
      moving.step(before, mesh.vertices);
      expectContainment(moving.tree, moving.triangles,
                        MovingTree::framesOf(before, mesh.vertices));
    }
  }
}

// A calm cloth next to balls that mix: its part of the tree stays.
TEST(FCL_TREE_RESTRUCTURING, onlyTheAgedPart) {
  const FrameSequence balls = makeMixingBalls(12), cloth = makeWavingCloth(12);
  FrameSequence both = balls;
  const std::size_t num_ball_vertices = balls.frames[0].size();
  for (const Triangle& t : cloth.triangles)
    both.triangles.emplace_back(t[0] + num_ball_vertices, t[1] + num_ball_vertices,
                                t[2] + num_ball_vertices);
  for (std::size_t i = 0; i < both.frames.size(); ++i)
    for (const auto& p : cloth.frames[i])
      both.frames[i].push_back(p + Vector3<double>(5, 0, 0));
  /// The triangle that follows each triangle in the tree.
  const auto followers = [&both](const MovingKdopTree& tree) {
    std::vector<std::uint32_t> next(both.triangles.size(), 0);
    for (std::size_t i = 0; i + 1 < next.size(); ++i)
      next[tree.triangles()[i].index] = tree.triangles()[i + 1].index;
    return next;
  };
  MovingTree moving(both);
  const auto first = followers(moving.tree);
  int count = 0;
  for (std::size_t i = 0; i + 1 < both.frames.size(); ++i)
    count += moving.step(both.frames[i], both.frames[i + 1]);
  EXPECT_GE(count, 1);
  const auto last = followers(moving.tree);
  std::size_t changed_balls = 0, changed_cloth = 0;
  for (std::size_t i = 0; i < first.size(); ++i)
    (i < balls.triangles.size() ? changed_balls : changed_cloth) += first[i] != last[i];
  EXPECT_LT(changed_cloth, cloth.triangles.size() / 100);
  EXPECT_GT(changed_balls, balls.triangles.size() / 20);
}

// Sheets that unfold on each other stay apart in the tree.
TEST(FCL_TREE_RESTRUCTURING, componentsStayApart) {
  const FrameSequence sheet = reversed(makeCrumplingSheet(13));
  FrameSequence stack = sheet;
  const std::size_t num_triangles = sheet.triangles.size(),
                    num_vertices = sheet.frames[0].size();
  constexpr std::size_t kSheets = 3;
  for (std::size_t k = 1; k < kSheets; ++k) {
    for (const Triangle& t : sheet.triangles)
      stack.triangles.emplace_back(t[0] + k * num_vertices, t[1] + k * num_vertices,
                                   t[2] + k * num_vertices);
    for (std::size_t i = 0; i < stack.frames.size(); ++i)
      for (const auto& p : sheet.frames[i])
        stack.frames[i].push_back(p + Vector3<double>(0, 0, 0.001 * double(k)));
  }
  MovingTree moving(stack);
  int count = 0;
  for (std::size_t i = 0; i + 1 < stack.frames.size(); ++i) {
    count += moving.step(stack.frames[i], stack.frames[i + 1]);
    std::size_t num_changes = 0;
    const auto& triangles = moving.tree.triangles();
    for (std::size_t t = 1; t < triangles.size(); ++t)
      num_changes +=
          triangles[t].index / num_triangles != triangles[t - 1].index / num_triangles;
    EXPECT_EQ(num_changes, kSheets - 1);
  }
  EXPECT_GE(count, 1);
}

// Sheets that are too small for trees of their own when the mesh is built, and that are
// in each other's nodes, separate in the tree when they slide apart in space. The
// children of a node are rebuilt, and they are fewer than the sheets.
TEST(FCL_TREE_RESTRUCTURING, componentsComeApart) {
  constexpr std::size_t kSheets = 6;
  const TestMesh sheet = makeSheet(5, 4);
  FrameSequence stack{{}, {{}, {}}};
  for (std::size_t k = 0; k < kSheets; ++k) {
    const std::size_t first = stack.frames[0].size();
    for (const Triangle& t : sheet.triangles)
      stack.triangles.emplace_back(t[0] + first, t[1] + first, t[2] + first);
    for (const auto& p : sheet.vertices) {
      stack.frames[0].push_back(p + Vector3<double>(0, 0, 0.001 * double(k)));
      stack.frames[1].push_back(p +
                                Vector3<double>(0.5 * double(k), 0, 0.001 * double(k)));
    }
  }
  const auto countChanges = [&](const MovingKdopTree& tree) {
    const auto& triangles = tree.triangles();
    std::size_t count = 0;
    for (std::size_t t = 1; t < triangles.size(); ++t)
      count += triangles[t].index / sheet.triangles.size() !=
               triangles[t - 1].index / sheet.triangles.size();
    return count;
  };
  MovingTree moving(stack);
  EXPECT_GE(countChanges(moving.tree), 4 * kSheets);
  EXPECT_FALSE(moving.step(stack.frames[0], stack.frames[1]));
  EXPECT_TRUE(moving.step(stack.frames[1], stack.frames[1]));
  EXPECT_EQ(countChanges(moving.tree), kSheets - 1);
}

// Balls that mix keep their shape: their patches, the lowest nodes, are split anew as a
// whole.
TEST(FCL_TREE_RESTRUCTURING, lowestNodesStay) {
  const FrameSequence sequence = makeMixingBalls(16);
  MovingTree moving(sequence);
  int count = 0;
  for (std::size_t i = 0; i + 1 < sequence.frames.size(); ++i) {
    const auto before = lowestNodes(moving.tree);
    if (!moving.step(sequence.frames[i], sequence.frames[i + 1])) continue;
    ++count;
    const auto after = lowestNodes(moving.tree);
    std::size_t num_kept = 0;
    for (const auto& node : before) num_kept += after.count(node);
    EXPECT_GT(num_kept, before.size() * 2 / 3);
  }
  EXPECT_GE(count, 1);
}

// The rebuilding of some parts in every other step does not make other parts look new: at
// the same time balls mix, little by little.
TEST(FCL_TREE_RESTRUCTURING, whatStaysKeepsItsAge) {
  constexpr std::uint64_t kSeed = 72;
  constexpr std::size_t kPerFrame = 8;
  Random random(kSeed);
  const FrameSequence balls = makeMixingBalls(9);
  const TestMesh soup = makeTriangleSoup(512, 1, 0.01, 8);
  FrameSequence step{balls.triangles, {{}, {}}};
  const std::size_t num_ball_vertices = balls.frames[0].size();
  for (const Triangle& t : soup.triangles)
    step.triangles.emplace_back(t[0] + num_ball_vertices, t[1] + num_ball_vertices,
                                t[2] + num_ball_vertices);
  /// The places to which the other triangles jump, far from each other.
  const auto scattered = [&] {
    Points points = soup.vertices;
    for (std::size_t i = 0; i < points.size(); i += 3) {
      const Vector3<double> by = Vector3<double>(1e4, 0, 0) + random.point(1e3);
      for (std::size_t k = 0; k < 3; ++k) points[i + k] += by;
    }
    return points;
  };
  const auto ballsAt = [&](std::size_t i) {
    const std::size_t frame = i / kPerFrame;
    const double t = static_cast<double>(i % kPerFrame) / kPerFrame;
    Points points = balls.frames[frame];
    if (t > 0)
      for (std::size_t k = 0; k < points.size(); ++k)
        points[k] += t * (balls.frames[frame + 1][k] - points[k]);
    return points;
  };
  Model kept;
  Points jumped;
  const std::size_t num_steps = kPerFrame * (balls.frames.size() - 1);
  for (std::size_t i = 0; i < num_steps; ++i) {
    if (i % 2 == 0) jumped = scattered();
    for (std::size_t k = 0; k < 2; ++k) {
      step.frames[k] = ballsAt(i + k);
      step.frames[k].insert(step.frames[k].end(), jumped.begin(), jumped.end());
    }
    if (i == 0) build(step, 0, kept);
    update(step, 0, kept);
  }
  EXPECT_GT(kept.numRestructurings(), num_steps / 4) << "seed " << kSeed;
  Model fresh;
  build(step, 0, fresh);
  update(step, 0, fresh);
  EXPECT_LT(comparedBoxes(kept), 1.35 * comparedBoxes(fresh)) << "seed " << kSeed;
}

TEST(FCL_TREE_RESTRUCTURING, contactsStayTheSame) {
  const FrameSequence sequence = makeMixingBalls(41);
  Model kept;
  build(sequence, 0, kept);
  EXPECT_EQ(kept.numRestructurings(), 0u);
  for (std::size_t i = 0; i + 1 < sequence.frames.size(); ++i) {
    const std::size_t before = kept.numRestructurings();
    if (i % 2 == 0) {
      update(sequence, i, kept);
    } else {
      ASSERT_EQ(kept.beginUpdateModel(), BVH_OK);
      ASSERT_EQ(kept.updateSubModel(sequence.frames[i + 1]), BVH_OK);
      ASSERT_EQ(kept.endUpdateModel(), BVH_OK);
    }
    // After each change of the tree, and sometimes without one.
    if (kept.numRestructurings() == before && i % 4 != 0) continue;
    Model fresh;
    build(sequence, i, fresh);
    update(sequence, i, fresh);
    expectSameContacts(kept, fresh);
    EXPECT_LT(comparedBoxes(kept), 1.4 * comparedBoxes(fresh)) << "step " << i;
    if (kept.numRestructurings() > before) {
      EXPECT_LT(comparedBoxes(kept), 1.15 * comparedBoxes(fresh)) << "step " << i;
    }
  }
  EXPECT_GE(kept.numRestructurings(), 2u);
  EXPECT_LE(kept.numRestructurings(), 8u);
}

TEST(FCL_TREE_RESTRUCTURING, copiesAreIndependent) {
  const FrameSequence sequence = makeMixingBalls(11);
  Model model;
  build(sequence, 0, model);
  std::size_t i = 0;
  Model before = model;
  for (; i + 1 < sequence.frames.size() && model.numRestructurings() == 0; ++i) {
    before = model;
    update(sequence, i, model);
  }
  ASSERT_EQ(model.numRestructurings(), 1u);
  EXPECT_EQ(before.numRestructurings(), 0u);
  Model copy = before;
  update(sequence, i - 1, copy);
  EXPECT_EQ(copy.numRestructurings(), 1u);
  expectSameBoxes(copy.movingTree(), model.movingTree());
  expectStructure(before.movingTree(),
                  assignFeatures(sequence.triangles.data(), sequence.triangles.size(),
                                 sequence.frames[0].size()));
  update(sequence, i, copy);
  update(sequence, i, model);
  expectSameBoxes(copy.movingTree(), model.movingTree());
  expectSameContacts(copy, model);
}

// Wherever memory runs out, the tree is unchanged.
TEST(FCL_TREE_RESTRUCTURING, withoutMemory) {
  const FrameSequence sequence = reversed(makeCrumplingSheet(3));
  MovingTree moving(sequence);
  ASSERT_FALSE(moving.step(sequence.frames[1], sequence.frames[2]));
  const MovingKdopTree before = moving.tree;
  constexpr int kChecked = kHasAddressSanitizer ? 64 : 1;
  int failures = 0;
  for (bool has_changed = false; !has_changed; ++failures) {
    allocations_left = failures;
    has_changed = moving.tree.restructure();
    allocations_left = -1;
    if (!has_changed && failures % kChecked == 0) {
      expectSameBoxes(moving.tree, before);
      expectStructure(moving.tree, moving.triangles);
    }
    ASSERT_FALSE(HasFailure());
    ASSERT_LT(failures, 200);
  }
  EXPECT_GT(failures, 20);
  moving.tree.refit(MovingTree::framesOf(sequence.frames[1], sequence.frames[2]));
  expectContainment(moving.tree, moving.triangles,
                    MovingTree::framesOf(sequence.frames[1], sequence.frames[2]));
}

}  // namespace
}  // namespace test
}  // namespace fcl

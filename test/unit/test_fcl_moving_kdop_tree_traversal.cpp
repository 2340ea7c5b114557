// SPDX-License-Identifier: BSD-3-Clause
//
// Traversals: every triangle pair whose boxes meet is visited, and none twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "moving_mesh.h"
#include "placed_mesh.h"
#include "query/deformable_query.h"
#include "real.h"
#include "test_models.h"
#include "traverse.h"
#include "tree/box_position.h"
#include "tree/moving_kdop_tree.h"
#include "tree_checks.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::coordinatesAt;
using test::kTimes;
using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;
using test::Real;

/// A mesh as a query uses it, with its triangles by the user's ids.
struct Body {
  const MeshInstance& instance;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Body(const MeshInstance& i, const std::vector<Triangle>& of) : instance(i) {
    for (const Triangle& t : of)
      triangles.push_back({static_cast<std::uint32_t>(t[0]),
                           static_cast<std::uint32_t>(t[1]),
                           static_cast<std::uint32_t>(t[2])});
  }
  /// The user's id of the triangle at a place of the tree.
  int index(int i) const {
    if (!instance.tree) return i;
    return static_cast<int>(
        instance.tree->triangles()[static_cast<std::size_t>(i)].index);
  }
};

using Visits = std::map<std::pair<int, int>, int>;

/// Whether the exact ranges of two triangles along the 8 directions meet at t.
bool doTrianglesOverlapAt(const Body& a, std::size_t i, const Body& b, std::size_t j,
                          double t) {
  Real lo[2][8], hi[2][8];
  const VertexPath first = a.instance.frames[a.triangles[i][0]];
  for (int side = 0; side < 2; ++side) {
    const Body& body = side ? b : a;
    const auto& triangle = body.triangles[side ? j : i];
    for (std::size_t c = 0; c < 3; ++c) {
      Real d[8];
      coordinatesAt(body.instance.frames[triangle[c]], t, first.t0, first.t0, d);
      for (int k = 0; k < 8; ++k) {
        lo[side][k] = c ? std::min(lo[side][k], d[k]) : d[k];
        hi[side][k] = c ? std::max(hi[side][k], d[k]) : d[k];
      }
    }
  }
  for (int k = 0; k < 8; ++k)
    if (lo[0][k] > hi[1][k] || lo[1][k] > hi[0][k]) return false;
  return true;
}

/// Calls visit with the tree to traverse.
template <typename Visit>
void withTree(const MeshInstance& mesh, Visit&& visit) {
  if (mesh.tree) {
    visit(*mesh.tree);
  } else {
    RigidTreeReader reader(mesh.rigid);
    visit(reader);
  }
}

Visits visitsOf(const Body& a, const Body& b, double latest = 1) {
  Visits visits;
  const bool self = &a == &b;
  const auto visit = [&](int i, int j, float earliest) {
    EXPECT_GE(earliest, 0);
    EXPECT_LE(earliest, latest);
    const int k = a.index(i), l = b.index(j);
    ++visits[self && l < k ? std::make_pair(l, k) : std::make_pair(k, l)];
  };
  const KdopShift shift = relativeShift(a.instance, b.instance);
  withTree(a.instance, [&](auto& tree_a) {
    withTree(b.instance, [&](auto& tree_b) {
      if constexpr (std::is_same_v<decltype(tree_a), decltype(tree_b)>)
        if (self) {
          test::traverse<true>(tree_a, tree_b, nullptr, visit, latest);
          return;
        }
      test::traverse<false>(tree_a, tree_b, &shift, visit, latest);
    });
  });
  return visits;
}

/// Expects that every pair that overlaps at a time up to latest is visited, and none
/// twice.
/// @return number of pairs that had to be visited
int expectVisits(const Body& a, const Body& b, double latest = 1) {
  const Visits visits = visitsOf(a, b, latest);
  for (const auto& [pair, times] : visits) {
    EXPECT_EQ(times, 1);
    EXPECT_TRUE(&a != &b || pair.first != pair.second);
  }
  int needed = 0;
  for (std::size_t i = 0; i < a.triangles.size(); ++i)
    for (std::size_t j = &a == &b ? i + 1 : 0; j < b.triangles.size(); ++j)
      for (const double t : kTimes)
        if (t <= latest && doTrianglesOverlapAt(a, i, b, j, t)) {
          ++needed;
          EXPECT_TRUE(visits.count({static_cast<int>(i), static_cast<int>(j)}))
              << i << " and " << j << " overlap at " << t;
          break;
        }
  return needed;
}

/// A mesh with a moving tree.
struct BodyOnPath : PreparedMovingMesh {
  Body body;

  explicit BodyOnPath(const MovingMesh& mesh, const Pose& beginning = Pose(),
                      const Pose& end = Pose())
      : PreparedMovingMesh(mesh, beginning, end), body(instance(), mesh.triangles) {}
};

TEST(FCL_MOVING_KDOP_TREE, traversalVisitsEveryOverlap) {
  constexpr std::uint64_t kSeed = 44;
  Random random(kSeed);
  int needed = 0;
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const MovingMesh a = i % 2 ? test::crumpledSheet(random, 5, 0.3)
                               : test::randomSoup(random, 40, 120, 3, 0.5);
    const MovingMesh b = test::crumpledSheet(random, 4, 0.5);
    const BodyOnPath pa(a), pb(b);
    for (const double latest : {1., 0.5, 0.}) {
      needed += expectVisits(pa.body, pa.body, latest);
      needed += expectVisits(pa.body, pb.body, latest);
    }
    const std::size_t all = visitsOf(pa.body, pa.body).size();
    EXPECT_LT(all, a.triangles.size() * (a.triangles.size() - 1) / 2);
    EXPECT_LE(visitsOf(pa.body, pa.body, 0).size(), all);
  }
  EXPECT_GT(needed, 10000);
}

/// A binary tree, in the form of MovingKdopTree::build(), that makes a root of eight
/// children: nodes of eight triangles, then single triangles.
std::vector<std::int32_t> rootOfNodesAndTriangles(unsigned num_nodes) {
  std::vector<std::int32_t> links(1);
  std::int32_t next = 0;
  const std::function<void(std::size_t, unsigned, unsigned)> fill =
      [&](std::size_t node, unsigned depth, unsigned lane) {
        const unsigned leaf_depth = depth >= 3 && lane % 8 < num_nodes ? 6 : 3;
        if (depth >= leaf_depth) {
          links[node] = ~next++;
          return;
        }
        const std::size_t left = links.size();
        links.resize(left + 2);
        links[node] = static_cast<std::int32_t>(left);
        // Lanes are filled level by level: the first decision is the lowest bit.
        fill(left, depth + 1, lane);
        fill(left + 1, depth + 1, lane | 1U << depth);
      };
  fill(0, 0, 0);
  return links;
}

// No step finds more pairs than a query has room for, and one step finds as many.
TEST(FCL_MOVING_KDOP_TREE, pairsOfAStep) {
  using SelfTraversal =
      deformable::Traversal<true, const MovingKdopTree, const MovingKdopTree>;
  std::size_t most = 0;
  for (unsigned num_nodes = 0; num_nodes <= 8; ++num_nodes) {
    const std::size_t count = 8 + 7 * num_nodes;
    MovingMesh mesh;  // all triangles in one place
    for (std::size_t i = 0; i < count; ++i) {
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
      for (const Vector3<double>& p :
           {Vector3<double>(0, 0, 0), Vector3<double>(1, 0, 0), Vector3<double>(0, 1, 0)})
        mesh.t0.push_back(p);
    }
    mesh.t1 = mesh.t0;
    MovingKdopTree tree;
    tree.build(mesh.triangles.data(), count, mesh.t0.size(),
               rootOfNodesAndTriangles(num_nodes));
    tree.refit(VertexFrames(mesh.previous(), mesh.current(), mesh.t0.size()));
    ASSERT_EQ(tree.node(0).count, 8);
    ASSERT_EQ(tree.node(0).triangles, 0xffU & (0xffU << num_nodes));
    SelfTraversal traversal(tree, tree, nullptr, deformable::SelfCulling(), nullptr,
                            deformable::kernels(), false);
    deformable::WorkList open;
    traversal.start(open);
    std::size_t all = 0;
    while (open.size() > 0) {
      const deformable::NodePair work = open[open.size() - 1];
      open.cut(open.size() - 1);
      std::size_t found = 0;
      traversal.step(work, open, [&found](int, int, float) { ++found; });
      EXPECT_LE(found, SelfTraversal::maxPairs());
      most = std::max(most, found);
      all += found;
    }
    EXPECT_EQ(all, count * (count - 1) / 2);
  }
  EXPECT_EQ(most, SelfTraversal::maxPairs());
}

// Trees of every small size, where nodes are full, nearly empty or mixed.
TEST(FCL_MOVING_KDOP_TREE, traversalOfSmallTrees) {
  constexpr std::uint64_t kSeed = 52;
  Random random(kSeed);
  const MovingMesh other = test::randomSoup(random, 11, 30, 1, 0.5);
  const BodyOnPath po(other);
  for (std::size_t count = 1; count < 80; ++count) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(count));
    const MovingMesh mesh = test::randomSoup(random, count, 3 * count, 1, 0.5);
    const BodyOnPath p(mesh);
    expectVisits(p.body, p.body);
    expectVisits(p.body, po.body);
    expectVisits(po.body, p.body, 0.5);
    ASSERT_FALSE(HasFailure());
  }
}

/// FCL's own tree, read as a tree with eight children per node.
template <typename BV>
void expectVisitsOfRigidTrees(std::uint64_t seed) {
  using S = typename BV::S;
  Random random(seed);
  int needed = 0;
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(i));
    const test::TestMesh sheet = test::floatMesh(test::makeSheet(5, 4)),
                         soup = test::floatMesh(
                             test::makeTriangleSoup(i % 2 ? 60 : 3, 0.6, 0.3, seed + 1));
    const auto model_a = test::makeModel<BVHModel<BV>>(sheet),
               model_b = test::makeModel<BVHModel<BV>>(soup);
    const auto random_pose = [&](const Matrix3<S>& rotation) {
      Transform3<S> tf = Transform3<S>::Identity();
      tf.linear() = rotation;
      tf.translation() = random.point(0.5).cast<S>();
      return tf;
    };
    const Matrix3<S> turned = AngleAxis<S>(static_cast<S>(random.uniform(0, 3)),
                                           random.point(1).cast<S>().normalized())
                                  .toRotationMatrix();
    const Matrix3<S> rotation = i < 3 ? Matrix3<S>(Matrix3<S>::Identity()) : turned;
    const test::PlacedMesh pa(*model_a, random_pose(rotation), random_pose(rotation),
                              "a"),
        pb(*model_b, random_pose(turned), random_pose(turned), "b");
    ASSERT_EQ(pa.instance().tree, nullptr);
    ASSERT_EQ(pb.instance().tree, nullptr);
    const Body a(pa.instance(), sheet.triangles), b(pb.instance(), soup.triangles);
    const MovingMesh mesh = test::crumpledSheet(random, 4, 0.3);
    Pose poses[2];
    for (Pose& pose : poses) pose.translation[2] = random.uniform(-0.3, 0.3);
    const BodyOnPath c(mesh, poses[0], poses[1]);
    for (const double latest : {1., 0.5, 0.}) {
      needed += expectVisits(a, b, latest);
      needed += expectVisits(b, a, latest);
      needed += expectVisits(a, a, latest);
      needed += expectVisits(a, c.body, latest);
      needed += expectVisits(c.body, b, latest);
    }
    EXPECT_LT(visitsOf(a, a).size(),
              a.triangles.size() * (a.triangles.size() - 1) * 2 / 5);
    EXPECT_LT(visitsOf(a, c.body).size(), a.triangles.size() * c.body.triangles.size());
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(needed, 3000);
}

TEST(FCL_MOVING_KDOP_TREE, traversalOfRigidTrees) {
  expectVisitsOfRigidTrees<AABB<double>>(53);
  expectVisitsOfRigidTrees<OBB<double>>(54);
  expectVisitsOfRigidTrees<KDOP<double, 16>>(55);
  expectVisitsOfRigidTrees<KDOP<float, 24>>(56);
  expectVisitsOfRigidTrees<OBBRSS<float>>(57);
  expectVisitsOfRigidTrees<kIOS<double>>(58);
}

TEST(FCL_MOVING_KDOP_TREE, oneTriangleAndNothingToVisit) {
  MovingMesh mesh;
  mesh.t0 = mesh.t1 = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const BodyOnPath one(mesh), other(mesh);
  EXPECT_TRUE(visitsOf(one.body, one.body).empty());
  EXPECT_EQ(visitsOf(one.body, other.body).size(), 1U);
}

TEST(FCL_MOVING_KDOP_TREE, treesFarFromEachOthersOrigin) {
  constexpr std::uint64_t kSeed = 45;
  Random random(kSeed);
  for (const double far : {0., 1e3, 1e6, 1e9, 1e15})
    for (const double size : {1e-3, 1., 1e5}) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(far) + ", " +
                   std::to_string(size));
      MovingMesh a = test::crumpledSheet(random, 4, 0.4);
      MovingMesh b = test::crumpledSheet(random, 5, 0.4);
      Pose pose_a[2], pose_b[2];
      for (int k = 0; k < 3; ++k) {
        // a is at its place by its pose, b half by its pose and half by its coordinates.
        for (int frame = 0; frame < 2; ++frame) {
          pose_a[frame].translation[k] = far * (k + 1);
          pose_b[frame].translation[k] = 0.5 * far * (k + 1) + (frame ? 0.1 * size : 0);
        }
        for (auto* points : {&a.t0, &a.t1})
          for (auto& p : *points) p[k] *= size;
        for (auto* points : {&b.t0, &b.t1})
          for (auto& p : *points) p[k] = size * p[k] + 0.5 * far * (k + 1);
      }
      const BodyOnPath pa(a, pose_a[0], pose_a[1]), pb(b, pose_b[0], pose_b[1]);
      EXPECT_GT(expectVisits(pa.body, pb.body), 100);
      EXPECT_GT(expectVisits(pb.body, pa.body), 100);
      // The traversal does not give up: most pairs are still culled if floats can
      // separate them.
      if (far <= 1e6 * size) {
        EXPECT_LT(visitsOf(pa.body, pb.body).size(),
                  a.triangles.size() * b.triangles.size() * 3 / 4);
      }
    }
}

// Beyond float's range boxes are unbounded, and all pairs have to be visited.
TEST(FCL_MOVING_KDOP_TREE, coordinatesBeyondFloat) {
  constexpr std::uint64_t kSeed = 47;
  Random random(kSeed);
  for (const double size : {1e36, 1e37, 1e38, 2e38, 1e39, 1e45, 1e53, 1e60, 1e300}) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(size));
    const MovingMesh a = test::randomSoup(random, 25, 60, size, size);
    const MovingMesh b = test::randomSoup(random, 15, 40, size, 0.1 * size);
    const BodyOnPath pa(a), pb(b);
    const std::size_t n = a.triangles.size(), m = b.triangles.size();
    EXPECT_GT(expectVisits(pa.body, pa.body), 10);
    EXPECT_GT(expectVisits(pa.body, pb.body), 10);
    if (size > 1e60) {
      EXPECT_EQ(visitsOf(pa.body, pa.body).size(), n * (n - 1) / 2);
      EXPECT_EQ(visitsOf(pa.body, pb.body).size(), n * m);
    }
  }
}

// Two triangles that touch at t = 0, where no float bounds them, and are apart at t = 1,
// where floats do.
TEST(FCL_MOVING_KDOP_TREE, unboundedInOneFrame) {
  MovingMesh mesh;
  for (const double side : {-1., 1.}) {
    for (int k = 0; k < 3; ++k) {
      mesh.t0.emplace_back(-1e45, k == 1 ? 1e36 : 0, k == 2 ? 1e36 : 0);
      mesh.t1.emplace_back(side * 1e36, k == 1 ? 1e36 : 0, k == 2 ? 1e36 : 0);
    }
  }
  mesh.t0.emplace_back(1e45, 0, 0);  // keeps the origin at 0
  mesh.t1.emplace_back(1e45, 0, 0);
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const BodyOnPath prepared(mesh);
  EXPECT_EQ(expectVisits(prepared.body, prepared.body), 1);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

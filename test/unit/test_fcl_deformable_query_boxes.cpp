// SPDX-License-Identifier: BSD-3-Clause
//
// The boxes that a query reads from the trees of rigid meshes. They contain everything
// below them, and their axes separate boxes that are apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kDOP.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "model/fcl_tree.h"
#include "placed_mesh.h"
#include "test_models.h"
#include "tree/rigid_tree.h"
#include "tree/separating_axes.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::Random;
using test::TestMesh;

/// Triangles below one of FCL's nodes.
std::vector<int> trianglesBelow(const std::vector<int>& links, int node) {
  std::vector<int> triangles, open{node};
  while (!open.empty()) {
    const int link = links[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (link < 0) {
      triangles.push_back(~link);
    } else {
      open.push_back(link);
      open.push_back(link + 1);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/// Each node's box contains the vertices below it, in both poses.
template <typename BV>
void expectBoxesAroundTheirTriangles(const TestMesh& mesh, const Pose& beginning,
                                     const Pose& end) {
  const auto model = test::makeModel<BVHModel<BV>>(mesh);
  const RigidTree tree = RigidTree(fclTree(*model), beginning).turned(beginning, end);
  const Pose* const poses[2] = {&beginning, &end};
  const auto rotated = [&poses](int frame, const Vector3<double>& p, int k) {
    const double(&r)[9] = poses[frame]->rotation;
    return r[3 * k] * p[0] + r[3 * k + 1] * p[1] + r[3 * k + 2] * p[2];
  };
  // A rotation and a sum in double, relative to the coordinates.
  double size = 0;
  for (const auto& p : mesh.vertices) size = std::max(size, p.norm());
  const double rounding = 16 * 0x1p-53 * size;
  const std::function<void(int, int)> expectInside = [&](int node, int below) {
    if (!model->getBV(below).isLeaf()) {
      expectInside(node, model->getBV(below).leftChild());
      expectInside(node, model->getBV(below).leftChild() + 1);
      return;
    }
    const detail::deformable::MovingKdop box = tree.box(node);
    MovingKdopNode opened;
    tree.open(0, opened);
    const Triangle& triangle =
        mesh.triangles[static_cast<std::size_t>(model->getBV(below).primitiveId())];
    for (int i = 0; i < 3; ++i) {
      const Vector3<double>& p = mesh.vertices[triangle[i]];
      for (auto frame : {0, 1}) {
        double q[3], d[8];
        for (int k = 0; k < 3; ++k) q[k] = rotated(frame, p, k) - tree.origin(frame)[k];
        kdopCoordinates(q, d);
        const float(&half)[16] = frame == 0 ? box.t0.half : box.t1.half;
        for (int j = 0; j < 8; ++j) {  // a NaN is unbounded
          ASSERT_FALSE(double{half[j]} < -d[j] - rounding) << node << " " << j;
          ASSERT_FALSE(double{half[j + 8]} < d[j] - rounding) << node << " " << j;
        }
      }
      for (int k = 0; k < 3; ++k)
        ASSERT_FALSE(double{opened.displacement[0]} <
                     std::abs(rotated(1, p, k) - rotated(0, p, k)) - 2 * rounding);
    }
  };
  for (int node = 0; node < model->getNumBVs(); ++node) expectInside(node, node);
}

TEST(FCL_DEFORMABLE_QUERY, boxesOfARigidTreeContainTheirTriangles) {
  test::Random random(47);
  Pose turned;
  const Matrix3<double> rotation =
      AngleAxis<double>(0.9, Vector3<double>(2, -1, 3).normalized()).toRotationMatrix();
  for (int k = 0; k < 9; ++k) turned.rotation[k] = rotation(k / 3, k % 3);
  for (const double scale : {1., 1e-6, 1e6, 1e-42, 1e30, 1e45}) {
    SCOPED_TRACE(scale);
    for (const double away : {0., 1e3}) {
      TestMesh mesh = test::bentSheet(6);
      const Vector3<double> far = random.point(away);
      for (auto& p : mesh.vertices) p = scale * (p + far);
      const std::pair<Pose, Pose> poses[] = {
          {Pose(), Pose()}, {turned, turned}, {Pose(), turned}, {turned, Pose()}};
      for (const auto& [beginning, end] : poses) {
        expectBoxesAroundTheirTriangles<OBBRSS<double>>(mesh, beginning, end);
        expectBoxesAroundTheirTriangles<AABB<double>>(mesh, beginning, end);
        expectBoxesAroundTheirTriangles<KDOP<double, 16>>(mesh, beginning, end);
        expectBoxesAroundTheirTriangles<KDOP<double, 24>>(mesh, beginning, end);
        expectBoxesAroundTheirTriangles<kIOS<double>>(mesh, beginning, end);
        expectBoxesAroundTheirTriangles<RSS<double>>(mesh, beginning, end);
      }
    }
  }
}

// A box of a rigid tree is at most a few units of float wider than the volume that it is
// made from.
TEST(FCL_DEFORMABLE_QUERY, boxesOfARigidTreeAreTight) {
  const auto model = test::makeModel<BVHModel<OBB<double>>>(test::bentSheet(12));
  const RigidTree tree(fclTree(*model), Pose());
  for (int node = 0; node < model->getNumBVs(); ++node) {
    const OBB<double>& obb = model->getBV(node).bv;
    const detail::deformable::MovingKdop box = tree.box(node);
    for (int k = 0; k < 3; ++k) {
      const double width = 2 * obb.axis.row(k).cwiseAbs().dot(obb.extent);
      EXPECT_NEAR(double{box.t0.half[k]} + double{box.t0.half[k + 8]}, width, 1e-5);
    }
  }
}

// A node of a rigid tree has up to eight of FCL's nodes below it, together all triangles
// below it, each with the box that the tree makes. In whatever order nodes are asked for,
// the table of the reader is right.
TEST(FCL_DEFORMABLE_QUERY, nodesOfARigidTree) {
  using Model = BVHModel<OBBRSS<double>>;
  const auto model = test::makeModel<Model>(test::bentSheet(20));
  const RigidTree tree(fclTree(*model), Pose());
  const int count = model->getNumBVs();
  ASSERT_GT(count, 1000);  // far more than the table of the reader has
  std::vector<int> links, leaf_of(static_cast<std::size_t>(model->num_tris), -1);
  for (int i = 0; i < count; ++i) {
    links.push_back(model->getBV(i).first_child);
    if (links.back() < 0) leaf_of[static_cast<std::size_t>(~links.back())] = i;
  }
  const auto expectRight = [&](const MovingKdopNode& node, int i) {
    std::vector<int> below;
    for (int lane = 0; lane < node.count; ++lane) {
      const bool leaf = node.isTriangle(lane);
      const int bv = leaf ? leaf_of[static_cast<std::size_t>(node.triangle(lane))]
                          : node.child[lane];
      ASSERT_EQ(links[static_cast<std::size_t>(bv)] < 0, leaf);
      const detail::deformable::MovingKdop box = node.box(lane), made = tree.box(bv);
      for (int k = 0; k < 16; ++k) {
        ASSERT_EQ(box.t0.half[k], made.t0.half[k]) << i;
        ASSERT_EQ(box.t1.half[k], made.t1.half[k]) << i;
      }
      for (const int t : trianglesBelow(links, bv)) below.push_back(t);
      // The node is full, unless there is nothing left to open.
      if (!leaf) {
        ASSERT_EQ(node.count, MovingKdopNode::kWidth);
      }
    }
    for (int lane = node.count; lane < MovingKdopNode::kWidth; ++lane)
      for (int k = 0; k < 16; ++k) {
        ASSERT_EQ(node.box(lane).t0.half[k], kLeastHalf);
        ASSERT_EQ(node.box(lane).t1.half[k], kLeastHalf);
      }
    std::sort(below.begin(), below.end());
    ASSERT_EQ(below, trianglesBelow(links, i));
  };
  RigidTreeReader reader(tree);
  test::Random random(31);
  for (int i = 0; i < 5000; ++i) {
    // Sometimes back to a few nodes, as traversals do.
    const auto node = static_cast<int>(random.uniform(0, i % 3 ? count : 40));
    expectRight(reader.node(node), node);
    ASSERT_FALSE(HasFailure());
  }
}

/// Two copies of a rigid mesh, the second of which moves.
template <typename BV>
struct RigidPair {
  using S = typename BV::S;
  std::shared_ptr<BVHModel<BV>> model;
  test::PlacedMesh a, b;
  SeparatingAxes axes;

  static Transform3<S> at(const Matrix3<S>& rotation, const Vector3<S>& translation) {
    Transform3<S> tf = Transform3<S>::Identity();
    tf.linear() = rotation;
    tf.translation() = translation;
    return tf;
  }
  RigidPair(const std::shared_ptr<BVHModel<BV>>& mesh, const Matrix3<S>& rotation,
            const Vector3<S>& from, const Vector3<S>& to)
      : model(mesh),
        a(*model, at(rotation, Vector3<S>::Zero()), at(rotation, Vector3<S>::Zero()),
          "a"),
        b(*model, at(rotation, from), at(rotation, to), "b"),
        axes(a.instance(), b.instance()) {}

  /// FCL's nodes above a vertex.
  std::vector<int> nodesAbove(std::size_t vertex) const {
    std::vector<int> nodes;
    const std::function<bool(int)> collect = [&](int node) {
      const auto& bv = model->getBV(node);
      bool above = false;
      if (bv.isLeaf()) {
        const Triangle& t = model->tri_indices[bv.primitiveId()];
        for (int k = 0; k < 3; ++k) above |= t[k] == vertex;
      } else {
        above = collect(bv.leftChild());
        above |= collect(bv.leftChild() + 1);
      }
      if (above) nodes.push_back(node);
      return above;
    };
    collect(0);
    return nodes;
  }
};

template <typename S>
Matrix3<S> someRotation() {
  return AngleAxis<S>(S(0.9), Vector3<S>(2, -1, 3).normalized()).toRotationMatrix();
}

/// If a vertex of one copy meets a vertex of the other at some time, no boxes above the
/// two are apart.
template <typename BV>
void expectTouchingBoxesAreNotApart(std::uint64_t seed) {
  using S = typename BV::S;
  Random random(seed);
  std::size_t apart = 0;
  for (const double scale : {1., 1e-6, 1e6})
    for (const double away : {0., 1e3}) {
      SCOPED_TRACE(std::to_string(scale) + ", " + std::to_string(away));
      TestMesh mesh = test::bentSheet(6);
      const Vector3<double> far = random.point(away);
      for (auto& p : mesh.vertices) p = scale * (p + far);
      const auto model = test::makeModel<BVHModel<BV>>(mesh);
      for (int i = 0; i < 40; ++i) {
        const Matrix3<S> rotation =
            i % 2 ? someRotation<S>() : Matrix3<S>(Matrix3<S>::Identity());
        const std::size_t va = random.index(mesh.vertices.size()),
                          vb = random.index(mesh.vertices.size());
        const Vector3<S> together =
            rotation * model->vertices[va] - rotation * model->vertices[vb];
        const Vector3<S> motion = random.point(scale).template cast<S>();
        const S t = S(random.index(5)) / 4;
        const RigidPair<BV> pair(model, rotation, together - t * motion,
                                 together + (1 - t) * motion);
        for (const int a : pair.nodesAbove(va))
          for (const int b : pair.nodesAbove(vb))
            ASSERT_FALSE(pair.axes.areApart(a, b)) << a << " " << b;
        for (int a = 0; a < model->getNumBVs(); a += 7)
          for (int b = 0; b < model->getNumBVs(); b += 5)
            apart += pair.axes.areApart(a, b);
      }
    }
  EXPECT_GT(apart, 1000U);
}

TEST(FCL_DEFORMABLE_QUERY, touchingBoxesAreNotApart) {
  expectTouchingBoxesAreNotApart<OBBRSS<double>>(71);
  expectTouchingBoxesAreNotApart<OBB<float>>(72);
  expectTouchingBoxesAreNotApart<kIOS<double>>(73);
  expectTouchingBoxesAreNotApart<AABB<double>>(74);
  expectTouchingBoxesAreNotApart<KDOP<float, 18>>(75);
}

// Boxes with a tiny gap between them are apart. Boxes that overlap by as little are not,
// boxes that pass through each other are not, and NaN is not.
TEST(FCL_DEFORMABLE_QUERY, boxesSideBySide) {
  using Vec = Vector3<double>;
  const auto model = test::makeModel<BVHModel<OBBRSS<double>>>(test::bentSheet(12));
  const Matrix3<double> rotation = someRotation<double>();
  const OBB<double>& obb = model->getBV(0).bv.obb;
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1., 1.}) {
      const Vec across = side * 2 * obb.extent[k] * (rotation * obb.axis.col(k));
      const Vec outside = across * (1 + 1e-9), inside = across * (1 - 1e-9);
      const auto areApart = [&](const Vec& from, const Vec& to) {
        return RigidPair<OBBRSS<double>>(model, rotation, from, to).axes.areApart(0, 0);
      };
      EXPECT_TRUE(areApart(outside, outside));
      EXPECT_TRUE(areApart(outside, 2 * outside));
      EXPECT_FALSE(areApart(inside, inside));
      EXPECT_FALSE(areApart(outside, inside));
      EXPECT_FALSE(areApart(inside, outside));
      EXPECT_FALSE(areApart(outside, -outside));
      EXPECT_FALSE(areApart(Vec(1e308, 1e308, 1e308), Vec(-1e308, -1e308, -1e308)));
    }
}

TEST(FCL_DEFORMABLE_QUERY, whenSeparatingAxesMayHelp) {
  using Vec = Vector3<double>;
  const Matrix3<double> identity = Matrix3<double>::Identity(),
                        rotation = someRotation<double>();
  const Vec from(1, 2, 3), to(1, 2.5, 3);
  const auto mesh = test::bentSheet(4);
  const auto obbs = test::makeModel<BVHModel<OBB<double>>>(mesh);
  const auto dops = test::makeModel<BVHModel<KDOP<double, 16>>>(mesh);
  EXPECT_TRUE((RigidPair<OBB<double>>(obbs, identity, from, from).axes.mayHelp(0)));
  EXPECT_TRUE((RigidPair<OBB<double>>(obbs, identity, from, to).axes.mayHelp(10)));
  EXPECT_FALSE((RigidPair<OBB<double>>(obbs, identity, from, to).axes.mayHelp(0.5)));
  using Dops = RigidPair<KDOP<double, 16>>;
  EXPECT_FALSE(Dops(dops, identity, from, to).axes.mayHelp(10));
  EXPECT_TRUE(Dops(dops, rotation, from, to).axes.mayHelp(10));
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

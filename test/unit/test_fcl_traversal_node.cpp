// SPDX-License-Identifier: BSD-3-Clause
//
// The traversal node in FCL's own drivers, against the public calls.
#include "fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/detail/traversal/collision_node.h"
#include "model/fcl_tree.h"
#include "test_models.h"
#include "tree/rigid_tree.h"

namespace fcl {
namespace test {
namespace {

template <typename S>
using Node = detail::DeformableContinuousCollisionTraversalNode<S>;

/// A contact in FCL's type.
using Row = std::array<double, 8>;

template <typename S>
Row rowOf(std::intptr_t b1, std::intptr_t b2, const Vector3<S>& pos,
          const Vector3<S>& normal) {
  Row row{static_cast<double>(b1), static_cast<double>(b2)};
  for (int k = 0; k < 3; ++k) {
    row[static_cast<std::size_t>(k + 2)] = static_cast<double>(pos[k]);
    row[static_cast<std::size_t>(k + 5)] = static_cast<double>(normal[k]);
  }
  return row;
}

template <typename S>
std::vector<Row> rowsOf(const CollisionResult<S>& result, std::size_t begin = 0) {
  std::vector<Row> rows;
  for (std::size_t i = begin; i < result.numContacts(); ++i) {
    const Contact<S>& c = result.getContact(i);
    rows.push_back(rowOf(c.b1, c.b2, c.pos, c.normal));
    EXPECT_EQ(c.penetration_depth, 0);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

template <typename S>
std::vector<Row> rowsOf(const ContinuousContactResult<S>& result) {
  std::vector<Row> rows;
  for (const auto& c : result.contacts)
    rows.push_back(rowOf(c.b1, c.b2, c.pos, c.normal));
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// One model with itself, or two models of which the first moves.
template <typename S>
struct PosedScene {
  std::shared_ptr<CollisionGeometry<S>> o1;
  std::shared_ptr<CollisionGeometry<S>> o2;  // null: o1 with itself
  Transform3<S> beg{Transform3<S>::Identity()};
  Transform3<S> end{Transform3<S>::Identity()};

  ContinuousContactResult<S> expected(std::size_t count, bool enable_contact) const {
    ContinuousContactRequest<S> request;
    request.num_max_contacts = count;
    request.enable_contact = enable_contact;
    ContinuousContactResult<S> result;
    const Transform3<S> still = Transform3<S>::Identity();
    if (o2)
      continuousCollide(o1.get(), beg, end, o2.get(), still, still, request, result);
    else
      continuousSelfCollide(o1.get(), request, result);
    return result;
  }

  void drive(Node<S>& node, const CollisionRequest<S>& request,
             CollisionResult<S>& result) const {
    const Transform3<S> still = Transform3<S>::Identity();
    if (o2) {
      ASSERT_TRUE(
          detail::initialize(node, *o1, beg, end, *o2, still, still, request, result));
      detail::collide(&node);
    } else {
      ASSERT_TRUE(detail::initialize(node, *o1, request, result));
      detail::selfCollide(&node);
    }
  }
};

template <typename S>
void expectNodeAgrees(const PosedScene<S>& scene, std::size_t at_least) {
  const std::size_t all = std::size_t{1} << 30;
  EXPECT_GE(scene.expected(all, true).contacts.size(), at_least);
  Contact<S> earlier;
  earlier.b1 = 77;
  for (const std::size_t count : {std::size_t{1}, std::size_t{5}, all})
    for (const bool enable_contact : {true, false})
      for (const bool had_one : {false, true}) {
        const auto expected = scene.expected(count, enable_contact);
        CollisionResult<S> result;
        if (had_one) result.addContact(earlier);
        Node<S> node;
        scene.drive(node, CollisionRequest<S>(count, enable_contact), result);
        EXPECT_EQ(node.time_of_contact, expected.time_of_contact);
        EXPECT_EQ(node.isInitiallyCrossing(), expected.initially_crossing);
        ASSERT_GE(result.numContacts(), std::size_t{had_one});
        if (had_one) {
          EXPECT_EQ(result.getContact(0).b1, 77);
        }
        EXPECT_EQ(rowsOf(result, had_one), rowsOf(expected))
            << "num_max_contacts " << count << " had one " << had_one;
        for (std::size_t i = had_one; i < result.numContacts(); ++i) {
          EXPECT_EQ(result.getContact(i).o1, scene.o1.get());
          EXPECT_EQ(result.getContact(i).o2, scene.o2 ? scene.o2.get() : scene.o1.get());
        }
        // A node can be used again.
        CollisionResult<S> again;
        scene.drive(node, CollisionRequest<S>(count, enable_contact), again);
        EXPECT_EQ(rowsOf(again), rowsOf(expected));
        EXPECT_EQ(node.time_of_contact, expected.time_of_contact);
      }
}

template <typename S>
void expectAgreement() {
  using Model = DeformableBVHModel<KDOP<S, 16>>;
  using Plain = BVHModel<OBBRSS<S>>;
  const TestMesh sheet = bentSheet(8), above = moved(sheet, 0.03, 0.02, 0.3),
                 below = moved(sheet, 0.05, -0.02, -0.3);
  const auto crumple = [](const TestMesh& mesh, std::uint64_t seed) {
    return shaken(mesh, 0.15, seed);
  };
  const auto falling = makeModel<Model>(shaken(above, 0.02, 1), crumple(below, 2));
  const auto plain = makeModel<Plain>(sheet, crumple(sheet, 3));
  const auto own = makeModel<Model>(sheet, crumple(sheet, 3));
  expectNodeAgrees<S>({falling, plain}, 100);
  expectNodeAgrees<S>({falling, own}, 100);
  expectNodeAgrees<S>({own, falling}, 100);
  PosedScene<S> posed{falling, own};
  posed.beg.translation() = Vector3<S>(S(0.1), 0, 0);
  posed.end.translation() = Vector3<S>(0, S(0.2), S(-0.1));
  expectNodeAgrees<S>(posed, 50);
  posed.end.linear() =
      AngleAxis<S>(S(0.3), Vector3<S>(1, 2, 3).normalized()).toRotationMatrix();
  expectNodeAgrees<S>(posed, 50);
  const TestMesh tangle = shaken(sheet, 0.3, 9);
  expectNodeAgrees<S>({makeModel<Model>(sheet, tangle), nullptr}, 50);
  expectNodeAgrees<S>({makeModel<Plain>(sheet, tangle), nullptr}, 50);
  // Crossing from the start, with contacts as well.
  expectNodeAgrees<S>({makeModel<Model>(tangle, sheet), nullptr}, 50);
  // Nothing meets.
  expectNodeAgrees<S>({makeModel<Model>(above, moved(above, 0, 0, 1)), plain}, 0);
  expectNodeAgrees<S>({makeModel<Model>(sheet), nullptr}, 0);
}

TEST(TraversalNode, AgreesWithThePublicCalls) { expectAgreement<double>(); }

TEST(TraversalNode, AgreesWithThePublicCallsInFloat) { expectAgreement<float>(); }

// The order of traversal decides which triangle of a rigid mesh stands for a feature.
TEST(TraversalNode, AgreesOnRigidMeshes) {
  using Plain = BVHModel<OBBRSS<double>>;
  PosedScene<double> scene{makeModel<Plain>(bentSheet(8, 0.5)),
                           makeModel<Plain>(shaken(bentSheet(8), 0.1, 4))};
  scene.end.translation() = Vector3<double>(0.01, 0.02, -1);
  const auto expected = scene.expected(std::size_t{1} << 30, true);
  CollisionResult<double> result;
  Node<double> node;
  scene.drive(node, CollisionRequest<double>(std::size_t{1} << 30, true), result);
  EXPECT_EQ(node.time_of_contact, expected.time_of_contact);
  const auto points = [](std::vector<Row> rows) {
    for (Row& row : rows) row[0] = row[1] = 0;
    std::sort(rows.begin(), rows.end());
    return rows;
  };
  EXPECT_GT(expected.contacts.size(), 100u);
  EXPECT_EQ(points(rowsOf(result)), points(rowsOf(expected)));
}

/// The number of nodes of a rigid tree, from node i on, with this property: they have
/// triangles, and a child with triangles only that takes the node's place when a
/// traversal reads both.
int countDisplaced(const detail::deformable::RigidTree& tree, int i) {
  detail::deformable::MovingKdopNode node, child;
  tree.open(i, node);
  int count = 0;
  bool is_displaced = false;
  for (int lane = 0; lane < node.count; ++lane) {
    if (node.isTriangle(lane)) continue;
    const int k = node.child[lane];
    tree.open(k, child);
    is_displaced |= node.triangles != 0 && child.triangles == child.lanes() &&
                    (k - i) % detail::deformable::RigidTreeReader::kSlots == 0;
    count += countDisplaced(tree, k);
  }
  return count + is_displaced;
}

/// Separate triangles with corners on a grid. Many touch, and they are so uneven that
/// nodes of FCL's tree have both single triangles and large subtrees.
TestMesh unevenSoup(int count, std::uint64_t seed) {
  TestMesh mesh = makeTriangleSoup(count, 1, 0.5, seed);
  for (Vector3<double>& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) p[k] = std::round(24 * p[k] * p[k] * p[k]);
  return mesh;
}

// A node that is compared with its children stays valid, whichever nodes are read in
// between.
TEST(TraversalNode, AgreesOnRigidMeshesWithThemselves) {
  using Plain = BVHModel<OBBRSS<double>>;
  using Model = DeformableBVHModel<OBBRSS<double>>;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 100 && count < 10; ++seed) {
    const TestMesh mesh = unevenSoup(150, seed);
    const auto rigid = makeModel<Plain>(mesh);
    const detail::deformable::RigidTree tree(detail::deformable::fclTree(*rigid),
                                             detail::deformable::Pose());
    if (countDisplaced(tree, 0) == 0) continue;
    ++count;
    SCOPED_TRACE("seed " + std::to_string(seed));
    expectSameContacts(selfContacts<double>(*rigid),
                       selfContacts<double>(*makeModel<Model>(mesh)));
    expectNodeAgrees<double>({rigid, nullptr}, 50);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(count, 10);
}

TEST(TraversalNode, CrossingAloneIsOneContact) {
  TestMesh face, needle;
  face.vertices = {{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}};
  needle.vertices = {{0, 0, -1}, {0.25, 0, 1}, {0.25, 0.125, 1}};
  face.triangles = needle.triangles = {Triangle(0, 1, 2)};
  using Model = DeformableBVHModel<KDOP<double, 16>>;
  const auto a = makeModel<Model>(face),
             b = makeModel<Model>(needle, moved(needle, 0.1, 0, 0));
  TestMesh both = face;
  append(both, needle);
  const auto one = makeModel<Model>(both);
  for (const PosedScene<double>& scene :
       {PosedScene<double>{a, b}, PosedScene<double>{one, nullptr}}) {
    for (const std::size_t count : {1u, 9u}) {
      CollisionResult<double> result;
      Node<double> node;
      scene.drive(node, CollisionRequest<double>(count, true), result);
      EXPECT_EQ(node.time_of_contact, 0);
      EXPECT_TRUE(node.isInitiallyCrossing());
      ASSERT_EQ(result.numContacts(), 1u);
      EXPECT_NEAR(std::abs(result.getContact(0).normal.z()), 1, 1e-12);
      EXPECT_NEAR(result.getContact(0).pos.z(), 0, 1e-12);
    }
  }
}

TEST(TraversalNode, InitializeTakesMeshesOfOursOnly) {
  const auto mesh = makeModel<BVHModel<OBBRSS<double>>>(bentSheet(4));
  const auto still = makeModel<DeformableBVHModel<OBBRSS<double>>>(bentSheet(4));
  const auto deforming = makeModel<DeformableBVHModel<OBBRSS<double>>>(
      bentSheet(4), shaken(bentSheet(4), 0.1, 1));
  const Sphere<double> sphere(1);
  const Transform3<double> here = Transform3<double>::Identity();
  Transform3<double> turned = here;
  turned.linear() = AngleAxis<double>(0.3, Vector3<double>::UnitZ()).toRotationMatrix();
  const CollisionRequest<double> request;
  CollisionResult<double> result;
  const auto accepts = [&](const CollisionGeometry<double>& o,
                           const Transform3<double>& beg, const Transform3<double>& end) {
    Node<double> node, swapped;
    const bool accepted =
        detail::initialize(node, o, beg, end, *mesh, here, here, request, result);
    EXPECT_EQ(
        detail::initialize(swapped, *mesh, here, here, o, beg, end, request, result),
        accepted);
    return accepted;
  };
  EXPECT_TRUE(accepts(*mesh, here, here));
  EXPECT_TRUE(accepts(*mesh, turned, turned));
  EXPECT_FALSE(accepts(*mesh, here, turned));
  EXPECT_FALSE(accepts(*still, here, turned));
  EXPECT_TRUE(accepts(*deforming, here, turned));
  EXPECT_FALSE(accepts(sphere, here, here));
  Node<double> node;
  EXPECT_FALSE(detail::initialize(node, sphere, request, result));
  EXPECT_TRUE(detail::initialize(node, *mesh, here, *still, turned, request, result));
  EXPECT_EQ(result.numContacts(), 0u);
}

TEST(TraversalNode, UnusableInputIsRefused) {
  const auto model = makeModel<DeformableBVHModel<OBBRSS<double>>>(
      bentSheet(4), shaken(bentSheet(4), 0.1, 1));
  CollisionResult<double> result;
  Node<double> node;
  expectRefused(
      [&] {
        detail::initialize(node, *model, CollisionRequest<double>(0, true), result);
      },
      "num_max_contacts");
  node.toc_err = -1;
  expectRefused(
      [&] { detail::initialize(node, *model, CollisionRequest<double>(), result); },
      "toc_err");
  ASSERT_EQ(model->beginUpdateModel(), BVH_OK);
  node.toc_err = 1e-4;
  expectRefused(
      [&] { detail::initialize(node, *model, CollisionRequest<double>(), result); },
      "model");
}

// A refused call changes nothing.
TEST(TraversalNode, StaysReadyWhenRefused) {
  const auto model = makeModel<DeformableBVHModel<OBBRSS<double>>>(
      bentSheet(6), shaken(bentSheet(6), 0.2, 1));
  CollisionResult<double> result, expected, other;
  Node<double> node, fresh;
  const CollisionRequest<double> request(1000, true);
  ASSERT_TRUE(detail::initialize(fresh, *model, request, expected));
  detail::selfCollide(&fresh);
  ASSERT_TRUE(detail::initialize(node, *model, request, result));
  expectRefused(
      [&] { detail::initialize(node, *model, CollisionRequest<double>(0, true), other); },
      "num_max_contacts");
  detail::selfCollide(&node);
  EXPECT_GT(result.numContacts(), 0u);
  EXPECT_EQ(result.numContacts(), expected.numContacts());
  EXPECT_EQ(node.time_of_contact, fresh.time_of_contact);
  EXPECT_EQ(other.numContacts(), 0u);
}

// The result keeps its old contacts, also when new ones had to be dropped.
TEST(TraversalNode, KeepsWhatTheResultHeld) {
  const auto model = makeModel<DeformableBVHModel<OBBRSS<double>>>(
      bentSheet(6), shaken(bentSheet(6), 0.2, 1));
  CollisionResult<double> result;
  result.addContact(Contact<double>(model.get(), nullptr, 7, 8));
  result.addCostSource(
      CostSource<double>(Vector3<double>(0, 0, 0), Vector3<double>(1, 1, 1), 3.), 10);
  Node<double> node;
  ASSERT_TRUE(
      detail::initialize(node, *model, CollisionRequest<double>(2, true), result));
  detail::selfCollide(&node);
  EXPECT_EQ(result.numContacts(), 3u);
  EXPECT_EQ(result.getContact(0).b1, 7);
  EXPECT_EQ(result.numCostSources(), 1u);
}

}  // namespace
}  // namespace test
}  // namespace fcl

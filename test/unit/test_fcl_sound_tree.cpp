// SPDX-License-Identifier: BSD-3-Clause
//
// The library tells which of FCL's trees bound their triangles. The trees that it reads
// do so.
#include "tree/sound_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "api/fcl_in_float.h"
#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/bvh/refit_top_down.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/distance.h"
#include "mesh/moving_kdop.h"
#include "test_models.h"
#include "tree/fcl_volumes.h"
#include "tree/rigid_tree.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::isTreeSound;
using detail::deformable::kdopCoordinates;
using detail::deformable::kHasSlabs;
using detail::deformable::OrientedBox;
using detail::deformable::orientedBoxOf;
using detail::deformable::Pose;
using detail::deformable::RigidTree;

/// Meshes whose triangles, or whose whole, have equal sides, right angles, no thickness
/// or no area.
struct NamedMesh {
  std::string name;
  TestMesh mesh;
  /// Whether a tree that FCL makes from the top down can be distinguished from others.
  bool can_be_told;
  /// Whether refitTopDown() can make a tree that can be distinguished.
  bool can_be_marked{true};
};
std::vector<NamedMesh> hardMeshes() {
  std::vector<NamedMesh> out;
  for (const int n : {1, 2, 3, 8})
    out.push_back({"floor of " + std::to_string(n), makeSheet(n, n), true});
  const auto strip = [](double u, double v) { return Vector3<double>(20 * u, v, 0); };
  out.push_back({"strip of squares", makeSheet(20, 1, strip), true});
  out.push_back({"slab", makeBox(Vector3<double>(1, 2, 0.01), 3), true});
  out.push_back({"box of 12", makeBox(Vector3<double>(1, 1, 1), 1), true});
  out.push_back({"finely cut box", makeBox(Vector3<double>(1, 1, 1), 4), true});
  out.push_back({"sphere", makeIcosphere(1, 1), true});
  out.push_back({"sphere with thin triangles", makeUvSphere(16, 6, 1), true});
  out.push_back({"specks far apart", makeTriangleSoup(40, 50, 0.01, 5), true});
  const auto wire = [](double u, double) { return Vector3<double>(u, 2 * u, 3 * u); };
  out.push_back({"wire", makeSheet(30, 1, wire), false});
  const auto point = [](double, double) { return Vector3<double>(1, 2, 3); };
  out.push_back({"point", makeSheet(5, 5, point), false, false});
  // A rotated copy: no axis of these boxes is a coordinate axis.
  const Matrix3<double> turn =
      AngleAxis<double>(0.7, Vector3<double>(1, 2, -1).normalized()).toRotationMatrix();
  for (std::size_t i = 0, n = out.size(); i < n; ++i) {
    NamedMesh copy = out[i];
    copy.name += ", turned";
    for (Vector3<double>& p : copy.mesh.vertices) p = turn * p;
    out.push_back(copy);
  }
  return out;
}

/// Calls visit(vertex) for the corners of all triangles below a node.
template <typename BV, typename Visit>
void forEachCorner(const BVHModel<BV>& model, int node, Visit&& visit) {
  const BVNode<BV>& below = model.getBV(node);
  if (!below.isLeaf()) {
    forEachCorner(model, below.leftChild(), visit);
    forEachCorner(model, below.rightChild(), visit);
    return;
  }
  const Triangle& triangle = model.tri_indices[below.primitiveId()];
  for (int i = 0; i < 3; ++i)
    visit(Vector3<double>(model.vertices[triangle[i]].template cast<double>()));
}

/// The 16-DOP and the oriented box of every node contain what is below it.
template <typename BV>
void expectBounds(const BVHModel<BV>& model, const Pose& pose) {
  const RigidTree tree(model, pose);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(
      pose.rotation);
  const Vector3<double> origin(tree.origin(0)[0], tree.origin(0)[1], tree.origin(0)[2]);
  for (int node = 0; node < model.getNumBVs(); ++node) {
    const MovingKdop box = tree.box(node);
    OrientedBox oriented;
    tree.orientedBox(node, oriented);
    // The promise of RigidTree about an oriented box: no coordinate below it is larger.
    double slack = 0;
    for (int k = 0; k < 3; ++k)
      slack += tree.slack() * (std::abs(oriented.center[k]) + oriented.extent[k]);
    forEachCorner(model, node, [&](const Vector3<double>& p) {
      const Vector3<double> turned = rotation * p;
      // The rounding of this test.
      const double rounding = 0x1p-48 * p.norm();
      const double q[3] = {turned[0] - origin[0], turned[1] - origin[1],
                           turned[2] - origin[2]};
      double d[8];
      kdopCoordinates(q, d);
      for (int j = 0; j < 8; ++j) {
        ASSERT_GE(double{box.t0.half[j]}, -d[j] - rounding) << node << " " << j;
        ASSERT_GE(double{box.t1.half[j + 8]}, d[j] - rounding) << node << " " << j;
      }
      for (int i = 0; i < 3; ++i) {
        double along = 0;
        for (int k = 0; k < 3; ++k)
          along += oriented.axis[i][k] * (turned[k] - oriented.center[k]);
        ASSERT_LE(std::abs(along), oriented.extent[i] + slack) << node << " " << i;
      }
    });
  }
}

template <typename BV>
void expectBoundsIfSound(const BVHModel<BV>& model) {
  if (!isTreeSound(model)) return;
  Pose turned;
  const Matrix3<double> rotation =
      AngleAxis<double>(0.9, Vector3<double>(2, -1, 3).normalized()).toRotationMatrix();
  for (int k = 0; k < 9; ++k) turned.rotation[k] = rotation(k / 3, k % 3);
  for (const Pose& pose : {Pose(), turned}) expectBounds(model, pose);
}

template <typename BV>
void replace(BVHModel<BV>& model, const TestMesh& mesh, bool refit = true,
             bool bottom_up = true) {
  using S = typename BV::S;
  ASSERT_EQ(model.beginReplaceModel(), BVH_OK);
  ASSERT_EQ(model.replaceSubModel(pointsAs<S>(mesh.vertices)), BVH_OK);
  ASSERT_EQ(model.endReplaceModel(refit, bottom_up), BVH_OK);
}

template <typename BV>
class FCL_SOUND_TREE : public testing::Test {};
// With sanitizers, which take ten times as long, one of each kind.
#ifdef NDEBUG
using Volumes =
    testing::Types<AABB<double>, OBB<double>, RSS<double>, OBBRSS<double>, kIOS<double>,
                   KDOP<double, 16>, KDOP<double, 18>, KDOP<double, 24>, AABB<float>,
                   OBB<float>, RSS<float>, OBBRSS<float>, kIOS<float>, KDOP<float, 16>,
                   KDOP<float, 18>, KDOP<float, 24>>;
#else
using Volumes = testing::Types<AABB<double>, OBBRSS<double>, kIOS<double>, RSS<float>,
                               KDOP<float, 16>>;
#endif
TYPED_TEST_SUITE(FCL_SOUND_TREE, Volumes, );

// Trees that FCL builds are read, also if their triangles have right angles.
TYPED_TEST(FCL_SOUND_TREE, builtTrees) {
  for (const NamedMesh& named : hardMeshes()) {
    SCOPED_TRACE(named.name);
    const auto model = makeModel<BVHModel<TypeParam>>(named.mesh);
    if (named.can_be_told || kHasSlabs<TypeParam>) {
      EXPECT_TRUE(isTreeSound(*model));
    }
    expectBoundsIfSound(*model);
    if (this->HasFailure()) return;
  }
}

// Trees that FCL refit after vertices went far: those that are called sound are sound.
TYPED_TEST(FCL_SOUND_TREE, replacedVertices) {
  constexpr int kTold = 15;  // nodes of which all can be measured
  std::uint64_t seed = 1;
  for (const NamedMesh& named : hardMeshes()) {
    SCOPED_TRACE(named.name);
    const auto model = makeModel<BVHModel<TypeParam>>(named.mesh);
    const bool is_small = model->getNumBVs() <= kTold;
    for (const double half : {0., 0.3, 10.}) {
      SCOPED_TRACE("shaken by " + std::to_string(half));
      const TestMesh next = shaken(named.mesh, half, seed++);
      for (int times = 0; times < 2; ++times) {
        replace(*model, next);
        if (!is_small) {
          EXPECT_EQ(isTreeSound(*model), kHasSlabs<TypeParam>);
        }
        expectBoundsIfSound(*model);
      }
      refitTopDown(*model);
      if (named.can_be_told || named.can_be_marked || half > 0) {
        EXPECT_TRUE(isTreeSound(*model));
      }
      expectBoundsIfSound(*model);
      replace(*model, next, true, false);
      if (named.can_be_told || half > 0) {
        EXPECT_TRUE(isTreeSound(*model));
      }
      expectBoundsIfSound(*model);
      replace(*model, next, false);
      if (named.can_be_told || half > 0) {
        EXPECT_TRUE(isTreeSound(*model));
      }
      expectBoundsIfSound(*model);
      if (this->HasFailure()) return;
    }
  }
}

// Coordinates of all sizes, and far from the origin, where floats have few digits left.
TYPED_TEST(FCL_SOUND_TREE, scalesAndOffsets) {
  using S = typename TypeParam::S;
  for (const NamedMesh& named : hardMeshes())
    for (const double scale : {1e-6, 1., 1e6})
      for (const double away : {0., 1e6}) {
        SCOPED_TRACE(named.name + ", scale " + std::to_string(scale) + ", away " +
                     std::to_string(away));
        TestMesh mesh = named.mesh;
        for (Vector3<double>& p : mesh.vertices)
          p = scale * (p + away * Vector3<double>(1, -0.7, 0.3));
        const auto model = makeModel<BVHModel<TypeParam>>(mesh);
        const bool is_told = named.can_be_told && (sizeof(S) == 8 || away == 0);
        if (is_told || kHasSlabs<TypeParam>) {
          EXPECT_TRUE(isTreeSound(*model));
        }
        expectBoundsIfSound(*model);
        replace(*model, mesh);
        expectBoundsIfSound(*model);
        refitTopDown(*model);
        if (is_told || kHasSlabs<TypeParam>) {
          EXPECT_TRUE(isTreeSound(*model));
        }
        expectBoundsIfSound(*model);
        if (this->HasFailure()) return;
      }
}

/// The largest distance by which a corner stands out of the oriented box of a node above
/// it, relative to the extents of the box.
template <typename BV>
double mostOutside(const BVHModel<BV>& model) {
  double most = 0;
  for (int node = 0; node < model.getNumBVs(); ++node) {
    const OrientedBox box = orientedBoxOf(model.getBV(node).bv);
    const double size = box.extent[0] + box.extent[1] + box.extent[2];
    forEachCorner(model, node, [&](const Vector3<double>& p) {
      for (int i = 0; i < 3; ++i) {
        double along = 0;
        for (int k = 0; k < 3; ++k) along += box.axis[i][k] * (p[k] - box.center[k]);
        most = std::max(most, (std::abs(along) - box.extent[i]) / size);
      }
    });
  }
  return most;
}

// The reason why trees that were refit from the bottom up are not read: in plain meshes,
// without any thin triangle, triangles stand out of FCL 0.7's sums of boxes.
TEST(FCL_SOUND_TREE, sumsOfBoxesLeaveTrianglesOut) {
  const auto model = makeModel<BVHModel<OBB<double>>>(makeIcosphere(3, 1));
  EXPECT_LT(mostOutside(*model), 1e-12);
  replace(*model, makeIcosphere(3, 1));
  EXPECT_GT(mostOutside(*model), 1e-2);
  EXPECT_FALSE(isTreeSound(*model));
  refitTopDown(*model);
  EXPECT_LT(mostOutside(*model), 1e-12);
}

/// Strips in which all of FCL's boxes have the same axes.
std::vector<TestMesh> meshesOfEqualAxes() {
  std::vector<TestMesh> out;
  for (const double half_width : {1e-4, 1e-2, 1.}) {
    const auto strip = [half_width](double u, double v) {
      return Vector3<double>(2 * u - 1, half_width * (2 * v - 1), 0);
    };
    out.push_back(makeSheet(256, 1, strip));
  }
  const Matrix3<double> turn =
      AngleAxis<double>(0.7, Vector3<double>(1, 2, -1).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    out.push_back(out[i]);
    for (Vector3<double>& p : out.back().vertices)
      p = turn * p + Vector3<double>(30, -20, 10);
  }
  return out;
}

/// The distance by which a vertex stands out of the root, at most.
template <typename BV>
double mostOutsideOfRoot(const BVHModel<BV>& model) {
  const OrientedBox box = orientedBoxOf(model.getBV(0).bv);
  double most = -1;
  for (int i = 0; i < model.num_vertices; ++i)
    for (int j = 0; j < 3; ++j) {
      double along = 0;
      for (int k = 0; k < 3; ++k)
        along += box.axis[j][k] * (double{model.vertices[i][k]} - box.center[k]);
      most = std::max(most, std::abs(along) - box.extent[j]);
    }
  return most;
}

/// FCL's answers to discrete queries of two models with a small ball at many places.
/// Distances in double only: libfcl has no distance function in float, and a compiler
/// takes half a minute to make it.
template <typename BV>
void expectSameAnswers(const BVHModel<BV>& a, const BVHModel<BV>& b) {
  using S = typename BV::S;
  const auto ball = makeModel<BVHModel<BV>>(makeIcosphere(1, 0.2));
  const Transform3<S> still = Transform3<S>::Identity();
  Random random(7);
  for (int i = 0; i < 40; ++i) {
    Transform3<S> tf = still;
    tf.translation() =
        a.vertices[i % a.num_vertices] + random.point(0.3).template cast<S>();
    int num_contacts[2];
    S distance[2] = {};
    for (int k = 0; k < 2; ++k) {
      const BVHModel<BV>& model = k == 0 ? a : b;
      CollisionResult<S> contacts;
      collide(&model, still, ball.get(), tf, CollisionRequest<S>(10000, true), contacts);
      num_contacts[k] = static_cast<int>(contacts.numContacts());
      if constexpr (std::is_same_v<S, double>) {
        DistanceResult<S> apart;
        distance[k] =
            fcl::distance(&model, still, ball.get(), tf, DistanceRequest<S>(true), apart);
      }
    }
    EXPECT_EQ(num_contacts[0], num_contacts[1]);
    EXPECT_EQ(distance[0], distance[1]);
  }
}

// refitTopDown() shows that the boxes are sound where FCL's axes do not, by a root that
// is wider. A refit from the bottom up makes another root.
TYPED_TEST(FCL_SOUND_TREE, refitTopDownMarksTheRoot) {
  if constexpr (!kHasSlabs<TypeParam>) {
    int num_marked = 0;
    for (const TestMesh& mesh : meshesOfEqualAxes()) {
      SCOPED_TRACE(std::to_string(mesh.triangles.size()) + " triangles");
      const auto model = makeModel<BVHModel<TypeParam>>(mesh);
      const auto plain = makeModel<BVHModel<TypeParam>>(mesh);
      replace(*plain, mesh, true, false);
      EXPECT_LT(mostOutsideOfRoot(*plain), 1e-4);
      refitTopDown(*model);
      EXPECT_TRUE(isTreeSound(*model));
      expectBoundsIfSound(*model);
      EXPECT_LE(mostOutsideOfRoot(*model), std::max(0., mostOutsideOfRoot(*plain)));
      const OrientedBox root = orientedBoxOf(model->getBV(0).bv),
                        old = orientedBoxOf(plain->getBV(0).bv);
      num_marked += !std::equal(root.extent, root.extent + 3, old.extent);
      for (int k = 0; k < 3; ++k)
        EXPECT_LT(root.extent[k], 2 * *std::max_element(old.extent, old.extent + 3));
      if (!std::is_same_v<TypeParam, OBB<typename TypeParam::S>>)
        expectSameAnswers(*model, *plain);
      replace(*model, mesh);
      EXPECT_FALSE(isTreeSound(*model));
      if (this->HasFailure()) return;
    }
    EXPECT_GT(num_marked, 0);
  }
}

// One that shows it already stays as FCL makes it.
TYPED_TEST(FCL_SOUND_TREE, refitTopDownKeepsWhatIsRecognised) {
  if constexpr (!kHasSlabs<TypeParam>) {
    const auto model = makeModel<BVHModel<TypeParam>>(makeIcosphere(2, 1));
    const auto refit = makeModel<BVHModel<TypeParam>>(makeIcosphere(2, 1));
    refitTopDown(*refit);
    replace(*model, makeIcosphere(2, 1), true, false);
    const OrientedBox root = orientedBoxOf(refit->getBV(0).bv),
                      old = orientedBoxOf(model->getBV(0).bv);
    EXPECT_TRUE(std::equal(root.extent, root.extent + 3, old.extent));
  }
}

/// Strips of up to ten triangles, and one triangle of which two or three corners are
/// equal. FCL gives the root of some of them axes that are not at right angles.
std::vector<TestMesh> meshesOfBadRoots() {
  std::vector<TestMesh> out(12);
  for (std::size_t n = 1; n <= 10; ++n) {
    TestMesh& strip = out[n - 1];
    for (std::size_t i = 0; i <= n; ++i) {
      const auto x = static_cast<double>(i);
      strip.vertices.emplace_back(x, 0, 0);
      strip.vertices.emplace_back(x, 1, 0.125 * x * x);
      if (i < n) strip.triangles.emplace_back(2 * i, 2 * i + 1, 2 * i + 2);
    }
  }
  const Vector3<double> p(0.5, 0.25, 0);
  out[10].vertices = {p, p, Vector3<double>(1, 1, 0)};
  out[11].vertices = {p, p, p};
  out[10].triangles = out[11].triangles = {Triangle(0, 1, 2)};
  return out;
}

/// The first contact of a model with a large box that comes down and turns. The other
/// uses of the root do not throw.
template <typename S>
S firstContact(const std::shared_ptr<CollisionGeometry<S>>& model) {
  const auto box = std::make_shared<Box<S>>(S{8}, S{8}, S{1});
  Transform3<S> from = Transform3<S>::Identity(), to = from;
  from.translation() = Vector3<S>(0, 0, 4);
  to.translation() = Vector3<S>(0, 0, -4);
  to.linear() = AngleAxis<S>(S{0.5}, Vector3<S>(1, 2, 3).normalized()).toRotationMatrix();
  const Transform3<S> still = Transform3<S>::Identity();
  ContinuousCollisionRequest<S> request;
  request.ccd_motion_type = CCDM_LINEAR;
  ContinuousCollisionResult<S> result;
  continuousCollide(model.get(), still, still, box.get(), from, to, request, result);
  EXPECT_TRUE(result.is_collide);
  // The mesh turns, too.
  ContinuousCollisionResult<S> both;
  continuousCollide(model.get(), to, from, model.get(), still, still, request, both);
  ContinuousCollisionObject<S> first(model,
                                     std::make_shared<TranslationMotion<S>>(still, from)),
      second(box, std::make_shared<TranslationMotion<S>>(from, still));
  ContinuousCollisionManager<S> manager;
  manager.registerObject(&first);
  manager.registerObject(&second);
  manager.setup();
  const SweptCollisionObject<S> swept(&first);
  EXPECT_LT(swept.getAABB().max_.norm(), 100);
  return result.time_of_contact;
}

// A root without axes at right angles does not bound the mesh. FCL answers such models.
TYPED_TEST(FCL_SOUND_TREE, rootsWithoutAxes) {
  using S = typename TypeParam::S;
  for (const TestMesh& mesh : meshesOfBadRoots()) {
    SCOPED_TRACE(std::to_string(mesh.vertices.size()) + " vertices");
    const auto model = makeModel<BVHModel<TypeParam>>(mesh);
    const S expected = firstContact<S>(makeModel<BVHModel<AABB<S>>>(mesh));
    for (int times = 0; times < 2; ++times) {
      if (isTreeSound(*model)) {
        EXPECT_LT(RigidTree(*model, Pose()).reach(), 100);
      }
      expectBoundsIfSound(*model);
      EXPECT_NEAR(firstContact<S>(model), expected, 1e-4);
      replace(*model, mesh);
    }
  }
}

// A few triangles without area are no reason for a new tree.
TYPED_TEST(FCL_SOUND_TREE, trianglesWithoutArea) {
  TestMesh mesh = makeIcosphere(2, 1);
  for (const std::size_t i : {0, 5, 9}) {
    mesh.triangles[i][1] = mesh.triangles[i][0];
    mesh.triangles[i + 20][2] = mesh.triangles[i + 20][1] = mesh.triangles[i + 20][0];
  }
  const auto model = makeModel<BVHModel<TypeParam>>(mesh);
  EXPECT_TRUE(isTreeSound(*model));
  expectBoundsIfSound(*model);
}

// One volume that cannot be a sum is enough. Numbers that are NaN prove nothing.
TEST(FCL_SOUND_TREE, whatIsNoNumber) {
  using Model = BVHModel<OBB<double>>;
  const auto model = makeModel<Model>(makeIcosphere(2, 1));
  for (int node = 0; node < model->getNumBVs(); ++node)
    model->getBV(node).bv.axis.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(isTreeSound(*model));
  const auto single = makeModel<Model>(makeSheet(1, 1));
  EXPECT_TRUE(isTreeSound(*single));
  single->vertices[1][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isTreeSound(*single));
  single->vertices[1][2] = 1;  // written without FCL: outside of the boxes
  EXPECT_FALSE(isTreeSound(*single));
}

TEST(FCL_SOUND_TREE, refitTopDownRefuses) {
  BVHModel<OBB<double>> empty;
  EXPECT_THROW(refitTopDown(empty), std::invalid_argument);
  const auto model = makeModel<BVHModel<OBB<double>>>(makeSheet(2, 2));
  ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
  EXPECT_THROW(refitTopDown(*model), std::invalid_argument);
  const auto updated = makeModel<BVHModel<OBB<double>>>(makeSheet(2, 2), bentSheet(2));
  EXPECT_THROW(refitTopDown(*updated), std::invalid_argument);
  const auto deformable =
      makeModel<DeformableBVHModel<OBB<double>>>(makeSheet(2, 2), bentSheet(2));
  EXPECT_THROW(refitTopDown<OBB<double>>(*deformable), std::invalid_argument);
}

}  // namespace
}  // namespace test
}  // namespace fcl

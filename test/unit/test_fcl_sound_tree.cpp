// SPDX-License-Identifier: BSD-3-Clause
//
// The library tells which of FCL's trees bound their triangles. The trees that it reads
// do so.
#include "model/sound_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/bvh/refit_top_down.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/distance.h"
#include "mesh/moving_kdop.h"
#include "model/fcl_tree.h"
#include "model/fcl_volumes.h"
#include "sanitizer.h"
#include "test_models.h"
#include "tree/rigid_tree.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::isTreeSound;
using detail::deformable::kdopCoordinates;
using detail::deformable::kHasSlabs;
using detail::deformable::MovingKdop;
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
  // The checks take time as the square of the size.
  constexpr std::size_t kMost = kHasAddressSanitizer ? 64 : 1000;
  out.erase(
      std::remove_if(out.begin(), out.end(),
                     [](const NamedMesh& x) { return x.mesh.triangles.size() > kMost; }),
      out.end());
  return out;
}

/// The corners of all triangles below a node, in the order of the tree.
template <typename BV>
void addCorners(const BVHModel<BV>& model, int node, std::vector<Vector3<double>>& out) {
  const BVNode<BV>& below = model.getBV(node);
  if (!below.isLeaf()) {
    addCorners(model, below.leftChild(), out);
    addCorners(model, below.rightChild(), out);
    return;
  }
  const Triangle& triangle = model.tri_indices[below.primitiveId()];
  for (int i = 0; i < 3; ++i)
    out.push_back(model.vertices[triangle[i]].template cast<double>());
}

/// For each node the corners below it.
using Corners = std::vector<std::vector<Vector3<double>>>;
template <typename BV>
Corners cornersOf(const BVHModel<BV>& model) {
  Corners out(static_cast<std::size_t>(model.getNumBVs()));
  for (int node = 0; node < model.getNumBVs(); ++node)
    addCorners(model, node, out[static_cast<std::size_t>(node)]);
  return out;
}

/// The 16-DOP and the oriented box of every node contain what is below it.
void expectBounds(const RigidTree& tree, const Pose& pose, const Corners& corners) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(
      pose.rotation);
  const Vector3<double> origin(tree.origin(0)[0], tree.origin(0)[1], tree.origin(0)[2]);
  for (int node = 0; node < static_cast<int>(corners.size()); ++node) {
    const MovingKdop box = tree.box(node);
    OrientedBox oriented;
    tree.orientedBox(node, oriented);
    // The promise of RigidTree about an oriented box: no coordinate below it is larger.
    double slack = 0;
    for (int k = 0; k < 3; ++k)
      slack += tree.slack() * (std::abs(oriented.center[k]) + oriented.extent[k]);
    for (const Vector3<double>& p : corners[static_cast<std::size_t>(node)]) {
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
    }
  }
}

template <typename BV>
void replace(BVHModel<BV>& model, const TestMesh& mesh, bool refit = true,
             bool bottom_up = true) {
  using S = typename BV::S;
  ASSERT_EQ(model.beginReplaceModel(), BVH_OK);
  ASSERT_EQ(model.replaceSubModel(pointsAs<S>(mesh.vertices)), BVH_OK);
  ASSERT_EQ(model.endReplaceModel(refit, bottom_up), BVH_OK);
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

/// A model, whatever its bounding volume is, so that the tests are compiled once.
class AnyModel {
 public:
  virtual ~AnyModel() = default;

  virtual bool isSound() const = 0;
  virtual RigidTree rigidTree(const Pose& pose) const = 0;
  virtual Corners corners() const = 0;
  /// Of a volume without slabs.
  virtual OrientedBox root() const = 0;
  virtual double firstContact() const = 0;
  /// @param other  a model on the same volume
  virtual void expectSameAnswers(const AnyModel& other) const = 0;
  virtual void replace(const TestMesh& mesh, bool refit = true,
                       bool bottom_up = true) = 0;
  virtual void refitTopDown() = 0;
};

template <typename BV>
class ModelOf : public AnyModel {
 public:
  explicit ModelOf(const TestMesh& mesh) : model_(makeModel<BVHModel<BV>>(mesh)) {}

  bool isSound() const override { return isTreeSound(*model_); }
  RigidTree rigidTree(const Pose& pose) const override {
    return RigidTree(detail::deformable::fclTree(*model_), pose);
  }
  Corners corners() const override { return cornersOf(*model_); }
  OrientedBox root() const override {
    if constexpr (kHasSlabs<BV>)
      throw std::logic_error("a volume with slabs");
    else
      return orientedBoxOf(model_->getBV(0).bv);
  }
  double firstContact() const override {
    return double{test::firstContact<typename BV::S>(model_)};
  }
  void expectSameAnswers(const AnyModel& other) const override {
    test::expectSameAnswers(*model_, *static_cast<const ModelOf&>(other).model_);
  }
  void replace(const TestMesh& mesh, bool refit, bool bottom_up) override {
    test::replace(*model_, mesh, refit, bottom_up);
  }
  void refitTopDown() override { fcl::refitTopDown(*model_); }

 private:
  std::shared_ptr<BVHModel<BV>> model_;
};

struct Volume {
  std::string name;
  bool is_float, has_slabs;
  /// FCL has distances of the models.
  bool has_distance;
  std::unique_ptr<AnyModel> (*make)(const TestMesh& mesh);
};

void PrintTo(const Volume& volume, std::ostream* out) { *out << volume.name; }

template <typename BV>
Volume volumeOf(const std::string& name) {
  using S = typename BV::S;
  return {name, std::is_same_v<S, float>, kHasSlabs<BV>, !std::is_same_v<BV, OBB<S>>,
          [](const TestMesh& mesh) -> std::unique_ptr<AnyModel> {
            return std::make_unique<ModelOf<BV>>(mesh);
          }};
}

// With sanitizers, which take ten times as long, one of each kind.
const Volume kVolumes[] = {volumeOf<AABB<double>>("AABB"),
                           volumeOf<OBBRSS<double>>("OBBRSS"),
                           volumeOf<kIOS<double>>("kIOS"),
                           volumeOf<RSS<float>>("RSS_float"),
                           volumeOf<KDOP<float, 16>>("KDOP16_float"),
#ifdef NDEBUG
                           volumeOf<OBB<double>>("OBB"),
                           volumeOf<RSS<double>>("RSS"),
                           volumeOf<KDOP<double, 16>>("KDOP16"),
                           volumeOf<KDOP<double, 18>>("KDOP18"),
                           volumeOf<KDOP<double, 24>>("KDOP24"),
                           volumeOf<AABB<float>>("AABB_float"),
                           volumeOf<OBB<float>>("OBB_float"),
                           volumeOf<OBBRSS<float>>("OBBRSS_float"),
                           volumeOf<kIOS<float>>("kIOS_float"),
                           volumeOf<KDOP<float, 18>>("KDOP18_float"),
                           volumeOf<KDOP<float, 24>>("KDOP24_float")
#endif
};

class FCL_SOUND_TREE : public testing::TestWithParam<Volume> {
 protected:
  std::unique_ptr<AnyModel> make(const TestMesh& mesh) const {
    return GetParam().make(mesh);
  }
};
INSTANTIATE_TEST_SUITE_P(Volumes, FCL_SOUND_TREE, testing::ValuesIn(kVolumes),
                         [](const auto& info) { return info.param.name; });

void expectBoundsIfSound(const AnyModel& model) {
  if (!model.isSound()) return;
  Pose turned;
  const Matrix3<double> rotation =
      AngleAxis<double>(0.9, Vector3<double>(2, -1, 3).normalized()).toRotationMatrix();
  for (int k = 0; k < 9; ++k) turned.rotation[k] = rotation(k / 3, k % 3);
  const Corners corners = model.corners();
  for (const Pose& pose : {Pose(), turned})
    expectBounds(model.rigidTree(pose), pose, corners);
}

// Trees that FCL builds are read, also if their triangles have right angles.
TEST_P(FCL_SOUND_TREE, builtTrees) {
  for (const NamedMesh& named : hardMeshes()) {
    SCOPED_TRACE(named.name);
    const auto model = make(named.mesh);
    if (named.can_be_told || GetParam().has_slabs) {
      EXPECT_TRUE(model->isSound());
    }
    expectBoundsIfSound(*model);
    if (HasFailure()) return;
  }
}

// Trees that FCL refit after vertices went far: those that are called sound are sound.
TEST_P(FCL_SOUND_TREE, replacedVertices) {
  constexpr std::size_t kTold = 15;  // nodes of which all can be measured
  std::uint64_t seed = 1;
  for (const NamedMesh& named : hardMeshes()) {
    SCOPED_TRACE(named.name);
    const auto model = make(named.mesh);
    const bool is_small = model->corners().size() <= kTold;
    for (const double half : {0., 0.3, 10.}) {
      SCOPED_TRACE("shaken by " + std::to_string(half));
      const TestMesh next = shaken(named.mesh, half, seed++);
      for (int times = 0; times < 2; ++times) {
        model->replace(next);
        if (!is_small) {
          EXPECT_EQ(model->isSound(), GetParam().has_slabs);
        }
        expectBoundsIfSound(*model);
      }
      model->refitTopDown();
      if (named.can_be_told || named.can_be_marked || half > 0) {
        EXPECT_TRUE(model->isSound());
      }
      expectBoundsIfSound(*model);
      model->replace(next, true, false);
      if (named.can_be_told || half > 0) {
        EXPECT_TRUE(model->isSound());
      }
      expectBoundsIfSound(*model);
      model->replace(next, false);
      if (named.can_be_told || half > 0) {
        EXPECT_TRUE(model->isSound());
      }
      expectBoundsIfSound(*model);
      if (HasFailure()) return;
    }
  }
}

// Coordinates of all sizes, and far from the origin, where floats have few digits left.
TEST_P(FCL_SOUND_TREE, scalesAndOffsets) {
  for (const NamedMesh& named : hardMeshes())
    for (const double scale : {1e-6, 1., 1e6})
      for (const double away : {0., 1e6}) {
        SCOPED_TRACE(named.name + ", scale " + std::to_string(scale) + ", away " +
                     std::to_string(away));
        TestMesh mesh = named.mesh;
        for (Vector3<double>& p : mesh.vertices)
          p = scale * (p + away * Vector3<double>(1, -0.7, 0.3));
        const auto model = make(mesh);
        const bool is_told = named.can_be_told && (!GetParam().is_float || away == 0);
        if (is_told || GetParam().has_slabs) {
          EXPECT_TRUE(model->isSound());
        }
        expectBoundsIfSound(*model);
        model->replace(mesh);
        expectBoundsIfSound(*model);
        model->refitTopDown();
        if (is_told || GetParam().has_slabs) {
          EXPECT_TRUE(model->isSound());
        }
        expectBoundsIfSound(*model);
        if (HasFailure()) return;
      }
}

/// The largest distance by which a corner stands out of the oriented box of a node above
/// it, relative to the extents of the box.
double mostOutside(const BVHModel<OBB<double>>& model) {
  const Corners corners = cornersOf(model);
  double most = 0;
  for (int node = 0; node < model.getNumBVs(); ++node) {
    const OrientedBox box = orientedBoxOf(model.getBV(node).bv);
    const double size = box.extent[0] + box.extent[1] + box.extent[2];
    for (const Vector3<double>& p : corners[static_cast<std::size_t>(node)])
      for (int i = 0; i < 3; ++i) {
        double along = 0;
        for (int k = 0; k < 3; ++k) along += box.axis[i][k] * (p[k] - box.center[k]);
        most = std::max(most, (std::abs(along) - box.extent[i]) / size);
      }
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
double mostOutsideOfRoot(const AnyModel& model) {
  const OrientedBox box = model.root();
  const Corners corners = model.corners();
  double most = -1;
  for (const Vector3<double>& p : corners[0])
    for (int j = 0; j < 3; ++j) {
      double along = 0;
      for (int k = 0; k < 3; ++k) along += box.axis[j][k] * (p[k] - box.center[k]);
      most = std::max(most, std::abs(along) - box.extent[j]);
    }
  return most;
}

// refitTopDown() shows that the boxes are sound where FCL's axes do not, by a root that
// is wider. A refit from the bottom up makes another root.
TEST_P(FCL_SOUND_TREE, refitTopDownMarksTheRoot) {
  if (GetParam().has_slabs) return;
  int num_marked = 0;
  for (const TestMesh& mesh : meshesOfEqualAxes()) {
    SCOPED_TRACE(std::to_string(mesh.triangles.size()) + " triangles");
    const auto model = make(mesh);
    const auto plain = make(mesh);
    plain->replace(mesh, true, false);
    EXPECT_LT(mostOutsideOfRoot(*plain), 1e-4);
    model->refitTopDown();
    EXPECT_TRUE(model->isSound());
    expectBoundsIfSound(*model);
    EXPECT_LE(mostOutsideOfRoot(*model), std::max(0., mostOutsideOfRoot(*plain)));
    const OrientedBox root = model->root(), old = plain->root();
    num_marked += !std::equal(root.extent, root.extent + 3, old.extent);
    for (int k = 0; k < 3; ++k)
      EXPECT_LT(root.extent[k], 2 * *std::max_element(old.extent, old.extent + 3));
    if (GetParam().has_distance) model->expectSameAnswers(*plain);
    model->replace(mesh);
    EXPECT_FALSE(model->isSound());
    if (HasFailure()) return;
  }
  EXPECT_GT(num_marked, 0);
}

// One that shows it already stays as FCL makes it.
TEST_P(FCL_SOUND_TREE, refitTopDownKeepsWhatIsRecognised) {
  if (GetParam().has_slabs) return;
  const auto model = make(makeIcosphere(2, 1));
  const auto refit = make(makeIcosphere(2, 1));
  refit->refitTopDown();
  model->replace(makeIcosphere(2, 1), true, false);
  const OrientedBox root = refit->root(), old = model->root();
  EXPECT_TRUE(std::equal(root.extent, root.extent + 3, old.extent));
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

// A root without axes at right angles does not bound the mesh. FCL answers such models.
TEST_P(FCL_SOUND_TREE, rootsWithoutAxes) {
  for (const TestMesh& mesh : meshesOfBadRoots()) {
    SCOPED_TRACE(std::to_string(mesh.vertices.size()) + " vertices");
    const auto model = make(mesh);
    const double expected = GetParam().is_float
                                ? ModelOf<AABB<float>>(mesh).firstContact()
                                : ModelOf<AABB<double>>(mesh).firstContact();
    for (int times = 0; times < 2; ++times) {
      if (model->isSound()) {
        EXPECT_LT(model->rigidTree(Pose()).largestCoordinate(), 100);
      }
      expectBoundsIfSound(*model);
      EXPECT_NEAR(model->firstContact(), expected, 1e-4);
      model->replace(mesh);
    }
  }
}

// A few triangles without area are no reason for a new tree.
TEST_P(FCL_SOUND_TREE, trianglesWithoutArea) {
  TestMesh mesh = makeIcosphere(2, 1);
  for (const std::size_t i : {0, 5, 9}) {
    mesh.triangles[i][1] = mesh.triangles[i][0];
    mesh.triangles[i + 20][2] = mesh.triangles[i + 20][1] = mesh.triangles[i + 20][0];
  }
  const auto model = make(mesh);
  EXPECT_TRUE(model->isSound());
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

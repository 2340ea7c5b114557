// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh that tears, breaks, grows or loses parts. The tree that follows it is sound, and
// every answer is that of a newly built model.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "allocation_failures.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/collision.h"
#include "generated_scenes.h"
#include "mesh/mesh_topology.h"
#include "mesh_forms.h"
#include "test_models.h"
#include "tree_checks.h"

namespace fcl {
namespace test {
namespace {

using Points = std::vector<Vector3<double>>;
using Triangles = std::vector<Triangle>;
using detail::deformable::assignFeatures;

VertexFrames framesOf(const Points& t0, const Points& t1) {
  return {t0[0].data(), t1[0].data(), t0.size()};
}

/// A mesh in its current frame. The next mesh is described relative to it.
struct ChangingMesh {
  Triangles triangles;
  Points points;
  std::vector<int> origins;

  std::size_t at(std::size_t i, int k) const { return triangles[i][k]; }
  void add(std::size_t a, std::size_t b, std::size_t c, int origin) {
    triangles.emplace_back(a, b, c);
    origins.push_back(origin);
  }
  /// The state before a change: the origin of each triangle is itself.
  void settle() {
    origins.resize(triangles.size());
    for (std::size_t i = 0; i < origins.size(); ++i) origins[i] = static_cast<int>(i);
  }
};

ChangingMesh changing(const TestMesh& mesh) {
  return {mesh.triangles, mesh.vertices, {}};
}

Points shakenBy(const Points& points, double half, Random& random) {
  Points out = points;
  for (Vector3<double>& p : out) p += random.point(half);
  return out;
}

/// Gives some corners of triangles a copy of their vertex: cracks.
void tear(ChangingMesh& mesh, int count, Random& random) {
  for (int n = 0; n < count; ++n) {
    const std::size_t i = random.index(mesh.triangles.size());
    const int k = static_cast<int>(random.index(3));
    mesh.points.push_back(Vector3<double>(mesh.points[mesh.at(i, k)]));
    std::size_t id[3] = {mesh.at(i, 0), mesh.at(i, 1), mesh.at(i, 2)};
    id[k] = mesh.points.size() - 1;
    mesh.triangles[i] = Triangle(id[0], id[1], id[2]);
  }
}

/// Cuts triangles into three.
void refine(ChangingMesh& mesh, int count, Random& random) {
  for (int n = 0; n < count; ++n) {
    const std::size_t i = random.index(mesh.triangles.size()), m = mesh.points.size();
    const std::size_t a = mesh.at(i, 0), b = mesh.at(i, 1), c = mesh.at(i, 2);
    mesh.points.push_back(
        Vector3<double>((mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3));
    mesh.triangles[i] = Triangle(a, b, m);
    mesh.add(b, c, m, mesh.origins[i]);
    mesh.add(c, a, m, mesh.origins[i]);
  }
}

/// Removes triangles. The numbers of all others stay in order.
void lose(ChangingMesh& mesh, std::size_t first, std::size_t count) {
  const auto from = static_cast<std::ptrdiff_t>(first),
             to = static_cast<std::ptrdiff_t>(first + count);
  mesh.triangles.erase(mesh.triangles.begin() + from, mesh.triangles.begin() + to);
  mesh.origins.erase(mesh.origins.begin() + from, mesh.origins.begin() + to);
}

/// Adds a piece without origins.
void grow(ChangingMesh& mesh, const TestMesh& part, const Vector3<double>& by) {
  const std::size_t first = mesh.points.size();
  for (const Vector3<double>& p : part.vertices) mesh.points.push_back(p + by);
  for (Triangle t : part.triangles)
    mesh.add(first + t[0], first + t[1], first + t[2], -1);
}

/// Joins vertices, so that sheets hang together and triangles become degenerate.
void weld(ChangingMesh& mesh, int count, Random& random) {
  std::vector<std::size_t> to(mesh.points.size());
  for (std::size_t v = 0; v < to.size(); ++v) to[v] = v;
  for (int n = 0; n < count; ++n) to[random.index(to.size())] = random.index(to.size());
  for (Triangle& t : mesh.triangles) t = Triangle(to[t[0]], to[t[1]], to[t[2]]);
}

/// Gives vertices other ids, and forgets those without a triangle.
void renumberVertices(ChangingMesh& mesh, Random& random) {
  std::vector<std::size_t> order(mesh.points.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = v;
  shuffle(order, random);
  constexpr std::size_t kUnused = ~std::size_t{0};
  std::vector<std::size_t> id(order.size(), kUnused);
  for (Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) id[t[k]] = 0;
  Points points;
  for (const std::size_t v : order) {
    if (id[v] == kUnused) continue;
    id[v] = points.size();
    points.push_back(mesh.points[v]);
  }
  mesh.points = std::move(points);
  for (Triangle& t : mesh.triangles) t = Triangle(id[t[0]], id[t[1]], id[t[2]]);
}

void shuffleTriangles(ChangingMesh& mesh, Random& random) {
  std::vector<std::size_t> order(mesh.triangles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  shuffle(order, random);
  const ChangingMesh before = mesh;
  for (std::size_t i = 0; i < order.size(); ++i) {
    mesh.triangles[i] = before.triangles[order[i]];
    mesh.origins[i] = before.origins[order[i]];
  }
}

/// Changes the order of some triangles' corners: rotated, or turned over.
void turn(ChangingMesh& mesh, int count, Random& random) {
  for (int n = 0; n < count; ++n) {
    Triangle& t = mesh.triangles[random.index(mesh.triangles.size())];
    t = n % 2 ? Triangle(t[1], t[2], t[0]) : Triangle(t[0], t[2], t[1]);
  }
}

/// One or several changes of any kind.
void change(ChangingMesh& mesh, Random& random) {
  for (int n = static_cast<int>(1 + random.index(3)); n > 0; --n) {
    const std::size_t count = mesh.triangles.size();
    switch (random.index(9)) {
      case 0:
        tear(mesh, 12, random);
        break;
      case 1:
        refine(mesh, 9, random);
        break;
      case 2:
        if (count > 40) lose(mesh, random.index(count - 20), 1 + random.index(20));
        break;
      case 3:
        grow(mesh, bentSheet(3), {random.uniform(-1, 1), random.uniform(-1, 1), 0.1});
        break;
      case 4:
        weld(mesh, 3, random);
        break;
      case 5:
        renumberVertices(mesh, random);
        break;
      case 6:
        if (random.index(4) == 0) shuffleTriangles(mesh, random);
        break;
      case 7:
        turn(mesh, 5, random);
        break;
      default:
        // A wrong hint.
        mesh.origins[random.index(mesh.origins.size())] = -1;
    }
  }
}

/// Moving tree and mesh, step by step.
struct MovingTree {
  explicit MovingTree(const ChangingMesh& mesh) {
    const VertexFrames frames = framesOf(mesh.points, mesh.points);
    tree.build(mesh.triangles.data(), mesh.triangles.size(), frames);
    tree.refit(frames);
  }
  void step(const ChangingMesh& mesh, const Points& t1, int num_threads = 1) {
    const VertexFrames frames = framesOf(mesh.points, t1);
    tree.changeTopology(mesh.triangles.data(), mesh.triangles.size(), mesh.origins,
                        frames, num_threads);
    tree.refit(frames, num_threads);
  }
  MovingKdopTree tree;
};

/// Expects the properties of every tree, also of owners, fans and borders.
void expectSound(const MovingKdopTree& tree, const ChangingMesh& mesh, const Points& t1) {
  const auto owners =
      assignFeatures(mesh.triangles.data(), mesh.triangles.size(), mesh.points.size());
  expectContainment(tree, owners, framesOf(mesh.points, t1));
  expectFans(tree);
  expectBorders(tree);
}

TEST(FCL_TOPOLOGY_CHANGE, randomChanges) {
  Random random(1);
  for (int run = 0; run < 12; ++run) {
    ChangingMesh mesh = changing(bentSheet(run % 2 ? 5 : 9));
    MovingTree moving(mesh);
    for (int step = 0; step < 12; ++step) {
      mesh.settle();
      change(mesh, random);
      const Points t1 = shakenBy(mesh.points, 0.05, random);
      moving.step(mesh, t1);
      ASSERT_NO_FATAL_FAILURE(expectSound(moving.tree, mesh, t1));
      ASSERT_FALSE(HasFailure()) << "run " << run << ", step " << step;
      mesh.points = t1;
    }
  }
}

TEST(FCL_TOPOLOGY_CHANGE, nothingChanges) {
  Random random(2);
  ChangingMesh mesh = changing(bentSheet(20));
  const MovingTree before(mesh);
  MovingTree after(mesh);
  mesh.settle();
  after.step(mesh, mesh.points);
  expectSameBoxes(before.tree, after.tree);
  renumberVertices(mesh, random);
  after.step(mesh, mesh.points);
  expectSameBoxes(before.tree, after.tree);
}

TEST(FCL_TOPOLOGY_CHANGE, allIsNew) {
  ChangingMesh mesh = changing(bentSheet(6));
  MovingTree moving(mesh);
  mesh = ChangingMesh();
  grow(mesh, bentSheet(12), {5, 0, 0});
  moving.step(mesh, mesh.points);
  expectSound(moving.tree, mesh, mesh.points);
}

TEST(FCL_TOPOLOGY_CHANGE, downToOneTriangle) {
  ChangingMesh mesh = changing(bentSheet(12));
  MovingTree moving(mesh);
  while (mesh.triangles.size() > 1) {
    mesh.settle();
    lose(mesh, mesh.triangles.size() / 3, (mesh.triangles.size() + 1) / 2);
    moving.step(mesh, mesh.points);
    ASSERT_NO_FATAL_FAILURE(expectSound(moving.tree, mesh, mesh.points));
    // The remaining triangles are in few nodes.
    const std::size_t fewest = (mesh.triangles.size() + 7) / 8;
    EXPECT_LE(moving.tree.numNodes(), 4 * fewest);
  }
  EXPECT_EQ(moving.tree.numNodes(), 1u);
}

// Nodes that are made from scattered remains are not nearly empty.
TEST(FCL_TOPOLOGY_CHANGE, whatIsLeftIsDrawnTogether) {
  ChangingMesh mesh = changing(bentSheet(40));
  MovingTree moving(mesh);
  mesh.settle();
  for (std::size_t i = 2; i < mesh.triangles.size(); i += 2)
    lose(mesh, i, std::min<std::size_t>(18, mesh.triangles.size() - i));
  moving.step(mesh, mesh.points);
  expectSound(moving.tree, mesh, mesh.points);
  EXPECT_LE(3 * moving.tree.numNodes(), mesh.triangles.size());
}

// A crack, and a part that is lost: all other nodes are unchanged.
TEST(FCL_TOPOLOGY_CHANGE, whatIsUntouchedStays) {
  constexpr int kSide = 64;
  ChangingMesh mesh = changing(makeSheet(kSide, kSide));
  mesh.settle();
  MovingTree moving(mesh);
  const auto before = lowestNodes(moving.tree);
  Random random(3);
  // In a corner of the sheet.
  std::vector<std::size_t> corner;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (mesh.points[mesh.at(i, 0)].head<2>().cwiseAbs().minCoeff() >= 0 &&
        (mesh.points[mesh.at(i, 0)] - mesh.points[0]).norm() < 0.2)
      corner.push_back(i);
  ASSERT_GT(corner.size(), 20u);
  for (std::size_t n = 0; n < corner.size(); n += 2) {
    const std::size_t i = corner[n], m = mesh.points.size();
    mesh.points.push_back(Vector3<double>(mesh.points[mesh.at(i, 0)]));
    mesh.triangles[i] = Triangle(m, mesh.at(i, 1), mesh.at(i, 2));
    mesh.add(m, mesh.at(i, 1), mesh.at(i, 0), n % 4 ? -1 : static_cast<int>(i));
  }
  moving.step(mesh, mesh.points);
  expectSound(moving.tree, mesh, mesh.points);
  const auto after = lowestNodes(moving.tree);
  std::size_t num_changed = 0;
  for (const auto& node : before) num_changed += after.count(node) == 0;
  EXPECT_GT(num_changed, 0u);
  EXPECT_LE(num_changed, corner.size());
  EXPECT_GT(before.size(), 8 * num_changed);
}

// Parts whose topology does not change continue to age. A tree that becomes poor is
// rebuilt, however often a triangle is torn off in between.
TEST(FCL_TOPOLOGY_CHANGE, whatStaysKeepsItsAge) {
  const FrameSequence balls = makeMixingBalls(30);
  ChangingMesh mesh{balls.triangles, balls.frames[0], {}};
  const auto model = makeModel<DeformableBVHModel<>>({mesh.points, mesh.triangles});
  std::size_t num_aged = 0;
  for (std::size_t i = 0; i + 1 < balls.frames.size(); ++i) {
    const double *t0 = balls.frames[i][0].data(), *t1 = balls.frames[i + 1][0].data();
    const std::size_t count = balls.frames[i].size();
    ASSERT_EQ(model->updateFrames(t0, t1, count), BVH_OK);
    num_aged = model->numRestructurings();
    Triangle& t = mesh.triangles[i];
    t = Triangle(t[1], t[2], t[0]);
    ASSERT_EQ(model->updateTopology(mesh.triangles, {}, t0, t1, count), BVH_OK);
    EXPECT_EQ(model->numRestructurings(), num_aged);
  }
  EXPECT_GT(num_aged, 0u);
}

int depthOf(const MovingKdopTree& tree) {
  std::vector<int> depth(tree.numNodes(), 1);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const MovingKdopNode& node = tree.node(static_cast<int>(i));
    for (int lane = 0; lane < node.count; ++lane)
      if (!node.isTriangle(lane))
        depth[static_cast<std::size_t>(node.child[lane])] = depth[i] + 1;
  }
  return *std::max_element(depth.begin(), depth.end());
}

// Pieces that are added one by one, each farther out than all others, and of any size.
TEST(FCL_TOPOLOGY_CHANGE, depthStaysBounded) {
  for (const double growth : {1.0, 1.1}) {
    ChangingMesh mesh = changing(bentSheet(2));
    MovingTree moving(mesh);
    double place = 1;
    for (int step = 0; step < 400; ++step) {
      place = growth * place + 1;
      mesh.settle();
      grow(mesh, bentSheet(2), {place, 0, 0});
      moving.step(mesh, mesh.points);
      ASSERT_LE(depthOf(moving.tree), 6);
    }
    expectSound(moving.tree, mesh, mesh.points);
  }
}

// A tree and fans that grew in small steps serve a query about as well as new ones.
TEST(FCL_TOPOLOGY_CHANGE, queriesStayCheap) {
  Random random(4);
  ChangingMesh mesh = changing(bentSheet(40));
  const auto model = makeModel<DeformableBVHModel<>>({mesh.points, mesh.triangles});
  for (int step = 0; step < 30; ++step) {
    mesh.settle();
    tear(mesh, 30, random);
    refine(mesh, 20, random);
    lose(mesh, random.index(mesh.triangles.size() - 30), 30);
    grow(mesh, bentSheet(3),
         {random.uniform(-1, 1), random.uniform(-1, 1), 0.1 + 0.1 * step});
    const Points t1 = shakenBy(mesh.points, 1e-4, random);
    ASSERT_EQ(model->updateTopology(mesh.triangles, mesh.origins, mesh.points[0].data(),
                                    t1[0].data(), t1.size()),
              BVH_OK)
        << model->lastError();
    const auto fresh = makeModel<DeformableBVHModel<>>({mesh.points, mesh.triangles},
                                                       {t1, mesh.triangles});
    const auto kept = selfContacts<double>(*model),
               expected = selfContacts<double>(*fresh);
    ASSERT_NO_FATAL_FAILURE(expectIdentical(kept, expected));
    EXPECT_LT(static_cast<double>(kept.counts.node_pairs),
              1.5 * static_cast<double>(expected.counts.node_pairs));
    mesh.points = t1;
  }
}

TEST(FCL_TOPOLOGY_CHANGE, threadsDoNotMatter) {
  Random random(5);
  ChangingMesh mesh = changing(bentSheet(60));
  MovingTree one(mesh), four(mesh);
  for (int step = 0; step < 4; ++step) {
    mesh.settle();
    for (int n = 0; n < 4; ++n) change(mesh, random);
    const Points t1 = shakenBy(mesh.points, 0.01, random);
    one.step(mesh, t1);
    four.step(mesh, t1, 4);
    ASSERT_NO_FATAL_FAILURE(expectSameBoxes(one.tree, four.tree));
    ASSERT_NO_FATAL_FAILURE(expectSound(four.tree, mesh, t1));
    mesh.points = t1;
  }
}

TEST(FCL_TOPOLOGY_CHANGE, boxesWithoutBounds) {
  const double huge = 0.4 * std::numeric_limits<double>::max();
  ChangingMesh mesh = changing(bentSheet(6));
  mesh.points[3] = {huge, -huge, huge};
  mesh.points[20] = {-huge, huge, huge};
  MovingTree moving(mesh);
  Random random(6);
  for (int step = 0; step < 5; ++step) {
    mesh.settle();
    change(mesh, random);
    grow(mesh, bentSheet(2), {0.1 * huge, 0, 0});
    moving.step(mesh, mesh.points);
    expectStructure(
        moving.tree,
        assignFeatures(mesh.triangles.data(), mesh.triangles.size(), mesh.points.size()));
    expectFans(moving.tree);
  }
}

template <typename BV>
class TopologyOfModel : public ::testing::Test {
 protected:
  using S = typename BV::S;
  using Model = DeformableBVHModel<BV>;

  static int step(Model& model, const ChangingMesh& mesh, const Points& t1,
                  FclTree tree = FclTree::kSkip) {
    const auto p = pointsAs<S>(mesh.points), q = pointsAs<S>(t1);
    return model.updateTopology(mesh.triangles, mesh.origins, p[0].data(), q[0].data(),
                                q.size(), tree);
  }

  static std::shared_ptr<Model> fresh(const ChangingMesh& mesh, const Points& t1) {
    return makeModel<Model>({mesh.points, mesh.triangles}, {t1, mesh.triangles});
  }
};

using BVs = ::testing::Types<KDOP<double, 16>, OBBRSS<double>, AABB<float>>;
TYPED_TEST_SUITE(TopologyOfModel, BVs, );

TYPED_TEST(TopologyOfModel, answersAreThoseOfANewModel) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  Random random(7);
  const auto other = makeModel<Model>(moved(bentSheet(7, 0.05), 0.03, 0.01, 0),
                                      moved(bentSheet(7, -0.05), 0.03, 0.01, 0));
  std::size_t num_contacts = 0, num_between = 0;
  for (int run = 0; run < 6; ++run) {
    ChangingMesh mesh = changing(bentSheet(8));
    const auto model = makeModel<Model>({mesh.points, mesh.triangles});
    for (int i = 0; i < 8; ++i) {
      mesh.settle();
      change(mesh, random);
      const Points t1 = shakenBy(mesh.points, 0.08, random);
      const FclTree tree = i % 3 ? FclTree::kSkip : FclTree::kUpdate;
      ASSERT_EQ(this->step(*model, mesh, t1, tree), BVH_OK) << model->lastError();
      EXPECT_EQ(model->isFclTreeUpToDate(), tree == FclTree::kUpdate);
      const auto expected = this->fresh(mesh, t1);
      const auto all = selfContacts<S>(*expected);
      num_contacts += all.contacts.size();
      ASSERT_NO_FATAL_FAILURE(expectIdentical(selfContacts<S>(*model), all));
      const auto between = pairContacts<S>(*expected, *other);
      num_between += between.contacts.size();
      ASSERT_NO_FATAL_FAILURE(expectIdentical(pairContacts<S>(*model, *other), between));
      EXPECT_EQ(model->num_vertices, expected->num_vertices);
      EXPECT_EQ(model->num_tris, expected->num_tris);
      EXPECT_TRUE(model->aabb_local.min_ == expected->aabb_local.min_);
      EXPECT_TRUE(model->aabb_local.max_ == expected->aabb_local.max_);
      EXPECT_EQ(model->aabb_radius, expected->aabb_radius);
      mesh.points = t1;
      // A step as usual comes after it.
      if (i % 2) continue;
      mesh.settle();
      const Points t2 = shakenBy(t1, 0.02, random);
      ASSERT_EQ(update(*model, {t2, mesh.triangles}), BVH_OK);
      ASSERT_NO_FATAL_FAILURE(expectIdentical(selfContacts<S>(*model),
                                              selfContacts<S>(*this->fresh(mesh, t2))));
      mesh.points = t2;
    }
  }
  EXPECT_GT(num_contacts, 1000u);
  EXPECT_GT(num_between, 1000u);
}

// Without origins, the number of a triangle tells which one it was.
TYPED_TEST(TopologyOfModel, originsMayBeLeftOut) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  Random random(8);
  ChangingMesh mesh = changing(bentSheet(8));
  const auto model = makeModel<Model>({mesh.points, mesh.triangles});
  for (int i = 0; i < 4; ++i) {
    mesh.settle();
    tear(mesh, 10, random);
    grow(mesh, bentSheet(3), {0.1 * i, 0, 0.2});
    if (i == 3) lose(mesh, 50, mesh.triangles.size() - 50);
    mesh.origins.clear();
    const Points t1 = shakenBy(mesh.points, 0.08, random);
    ASSERT_EQ(this->step(*model, mesh, t1), BVH_OK) << model->lastError();
    ASSERT_NO_FATAL_FAILURE(expectIdentical(selfContacts<S>(*model),
                                            selfContacts<S>(*this->fresh(mesh, t1))));
    mesh.points = t1;
  }
}

TYPED_TEST(TopologyOfModel, itsOwnArrays) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  const TestMesh sheet = bentSheet(8);
  const auto model = makeModel<Model>(sheet, shaken(sheet, 0.1, 11));
  const auto copy = *model;
  const Triangles all(model->tri_indices, model->tri_indices + model->num_tris);
  ASSERT_EQ(model->updateTopology(all, {}, model->prev_vertices->data(),
                                  model->vertices->data(),
                                  static_cast<std::size_t>(model->num_vertices)),
            BVH_OK);
  expectIdentical(selfContacts<S>(*model), selfContacts<S>(copy));
}

// After a change through the base class there is no tree that could follow.
TYPED_TEST(TopologyOfModel, outOfStep) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  Random random(10);
  ChangingMesh mesh = changing(bentSheet(8));
  const auto model = makeModel<Model>({mesh.points, mesh.triangles});
  EXPECT_EQ(update<BVHModel<TypeParam>>(*model, {mesh.points, mesh.triangles}), BVH_OK);
  ASSERT_FALSE(model->isInStep());
  mesh.settle();
  tear(mesh, 20, random);
  const Points t1 = shakenBy(mesh.points, 0.08, random);
  ASSERT_EQ(this->step(*model, mesh, t1), BVH_OK);
  EXPECT_TRUE(model->isInStep());
  expectIdentical(selfContacts<S>(*model), selfContacts<S>(*this->fresh(mesh, t1)));
}

TYPED_TEST(TopologyOfModel, refusals) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  ChangingMesh mesh = changing(bentSheet(8));
  const auto points = pointsAs<S>(mesh.points);
  const S* p = points[0].data();
  const std::size_t n = points.size();
  const auto model =
      makeModel<Model>({mesh.points, mesh.triangles},
                       {shaken(bentSheet(8), 0.2, 12).vertices, mesh.triangles});
  const auto before = selfContacts<S>(*model);
  EXPECT_GT(before.contacts.size(), 0u);
  const auto expectRefusal = [&](int code, const std::string& word, int got) {
    EXPECT_EQ(got, code);
    EXPECT_NE(model->lastError().find(word), std::string::npos) << model->lastError();
    expectIdentical(selfContacts<S>(*model), before);
  };
  const Triangles& all = mesh.triangles;
  expectRefusal(BVH_ERR_INCORRECT_DATA, "null frame",
                model->updateTopology(all, {}, nullptr, p, n));
  expectRefusal(BVH_ERR_INCORRECT_DATA, "null frame",
                model->updateTopology(all, {}, p, nullptr, n));
  expectRefusal(BVH_ERR_BUILD_EMPTY_MODEL, "no triangles",
                model->updateTopology({}, {}, p, p, n));
  expectRefusal(BVH_ERR_INCORRECT_DATA, "triangle 126 refers to vertex 80 of 80",
                model->updateTopology(all, {}, p, p, n - 1));
  expectRefusal(BVH_ERR_INCORRECT_DATA, "3 origins given for 128 triangles",
                model->updateTopology(all, {1, 2, 3}, p, p, n));
  std::vector<int> origins(all.size(), -1);
  for (const int bad : {-2, 128}) {
    origins[7] = bad;
    expectRefusal(BVH_ERR_INCORRECT_DATA,
                  "triangle 7 comes from triangle " + std::to_string(bad) + " of 128",
                  model->updateTopology(all, origins, p, p, n));
  }
  auto wrong = points;
  wrong[5][1] = std::numeric_limits<S>::quiet_NaN();
  expectRefusal(BVH_ERR_INCORRECT_DATA, "vertex 5 of the previous frame",
                model->updateTopology(all, {}, wrong[0].data(), p, n));
  expectRefusal(BVH_ERR_INCORRECT_DATA, "vertex 5 of the current frame",
                model->updateTopology(all, {}, p, wrong[0].data(), n));
  ASSERT_EQ(model->beginUpdateModel(), BVH_OK);
  EXPECT_EQ(model->updateTopology(all, {}, p, p, n), BVH_ERR_BUILD_OUT_OF_SEQUENCE);
  Model empty;
  EXPECT_EQ(empty.updateTopology(all, {}, p, p, n), BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME);
  EXPECT_NE(empty.lastError().find("not built"), std::string::npos);
}

TYPED_TEST(TopologyOfModel, withoutMemory) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  Random random(13);
  ChangingMesh mesh = changing(bentSheet(8));
  const Points t0 = shakenBy(mesh.points, 0.1, random);
  ChangingMesh after = mesh;
  after.settle();
  tear(after, 20, random);
  refine(after, 20, random);
  grow(after, bentSheet(4), {0, 0, 0.2});
  const Points t1 = shakenBy(after.points, 0.08, random);
  const auto p = pointsAs<S>(after.points), q = pointsAs<S>(t1);
  int num_unchanged = 0, num_refused = 0;
  for (const FclTree tree : {FclTree::kSkip, FclTree::kUpdate}) {
    // FCL's own tree allocates memory more often than the test can try.
    for (int i = 0;; i += tree == FclTree::kSkip ? 1 : 1 + i / 16) {
      const auto model = this->fresh(mesh, t0);
      const auto before = selfContacts<S>(*model);
      bool fails = false;
      ::testing::internal::CaptureStderr();  // FCL tells that there is no memory
      allocations_left = i;
      try {
        fails = model->updateTopology(after.triangles, after.origins, p[0].data(),
                                      q[0].data(), q.size(), tree) != BVH_OK;
      } catch (const std::bad_alloc&) {
        fails = true;
      }
      allocations_left = -1;
      ::testing::internal::GetCapturedStderr();
      if (fails && model->isInStep()) {
        ++num_unchanged;
        ASSERT_NO_FATAL_FAILURE(expectIdentical(selfContacts<S>(*model), before));
        EXPECT_TRUE(model->isFclTreeUpToDate());
        continue;
      }
      if (fails) {
        ++num_refused;
        expectRefused([&] { selfContacts<S>(*model); }, "the last update failed");
        expectRefused([&] { const Model copy(*model); }, "failed");
        ASSERT_EQ(this->step(*model, after, t1), BVH_OK) << model->lastError();
      }
      ASSERT_NO_FATAL_FAILURE(expectIdentical(selfContacts<S>(*model),
                                              selfContacts<S>(*this->fresh(after, t1))));
      if (!fails) break;
    }
  }
  EXPECT_GT(num_unchanged, 20);
  EXPECT_GT(num_refused, 0);
}

/// In double: FCL has no collide() for float that is compiled before.
template <typename BV>
class TopologyInDouble : public TopologyOfModel<BV> {};
using BVsInDouble = ::testing::Types<KDOP<double, 16>, OBBRSS<double>>;
TYPED_TEST_SUITE(TopologyInDouble, BVsInDouble, );

TYPED_TEST(TopologyInDouble, discreteQueries) {
  using S = typename TestFixture::S;
  using Model = typename TestFixture::Model;
  Random random(9);
  ChangingMesh mesh = changing(bentSheet(8));
  int marker = 0;
  const auto model = makeModel<Model>({mesh.points, mesh.triangles});
  model->setUserData(&marker);
  model->cost_density = S(3);
  mesh.settle();
  tear(mesh, 10, random);
  grow(mesh, bentSheet(5), {0, 0, 0.4});
  const auto count = [&](const CollisionGeometry<S>& geometry) {
    CollisionRequest<S> request;
    request.num_max_contacts = 100000;
    request.enable_contact = true;
    CollisionResult<S> result;
    const auto other = makeModel<Model>(moved(shaken(bentSheet(5), 0.1, 14), 0, 0, 0.4));
    const Transform3<S> identity = Transform3<S>::Identity();
    return collide<S>(&geometry, identity, other.get(), identity, request, result);
  };
  ASSERT_EQ(this->step(*model, mesh, mesh.points), BVH_OK);
  EXPECT_THROW(count(*model), Exception);
  ASSERT_EQ(model->updateFclTree(), BVH_OK);
  const auto expected = makeModel<Model>({mesh.points, mesh.triangles});
  EXPECT_GT(count(*expected), 10u);
  EXPECT_EQ(count(*model), count(*expected));
  mesh.settle();
  lose(mesh, 40, 20);
  ASSERT_EQ(this->step(*model, mesh, mesh.points, FclTree::kUpdate), BVH_OK);
  const auto smaller = makeModel<Model>({mesh.points, mesh.triangles});
  EXPECT_EQ(count(*model), count(*smaller));
  EXPECT_EQ(model->getUserData(), &marker);
  EXPECT_EQ(model->cost_density, S(3));
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// Public queries of octrees, against closed forms and against all occupied cells as
// convex shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/octree_cell.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Point = Vector3<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Pose = Transform3<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Map = std::shared_ptr<octomap::OcTree>;
using Octree = std::shared_ptr<OcTree<double>>;

constexpr double kTocErr = 1e-9;
constexpr double kResolution = 0.125;

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, z;
  return pose;
}

struct Moving {
  Geometry geometry;
  Pose begin, end;
};

Moving still(const Geometry& geometry) {
  return {geometry, Pose::Identity(), Pose::Identity()};
}

Request requestOf(ContinuousQuery query = ContinuousQuery::kFirst) {
  Request request;
  request.query = query;
  request.toc_err = kTocErr;
  request.ccd_motion_type = CCDM_LINEAR;
  return request;
}

Result ask(const Moving& a, const Moving& b, const Request& request = requestOf()) {
  Result result;
  continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(), b.begin, b.end,
                    request, result);
  return result;
}

Map makeMap() { return std::make_shared<octomap::OcTree>(kResolution); }

/// Marks the cell with the given lower corner, in cells.
void occupy(const Map& map, int x, int y, int z, bool is_occupied = true) {
  const auto middle = [](int i) { return static_cast<float>((i + 0.5) * kResolution); };
  map->updateNode(octomap::point3d(middle(x), middle(y), middle(z)), is_occupied);
}

Octree octreeOf(const Map& map) { return std::make_shared<OcTree<double>>(map); }

Octree oneCell() {
  const Map map = makeMap();
  occupy(map, 0, 0, 0);
  return octreeOf(map);
}

/// Goes down from z = 2 to z = -2 over the middle of the cell of oneCell().
Moving falling(const Geometry& geometry) {
  const double middle = 0.5 * kResolution;
  return {geometry, at(middle, middle, 2), at(middle, middle, -2)};
}

void expectFirst(const Moving& a, const Moving& b, double time) {
  const Result results[2] = {ask(a, b), ask(b, a)};
  for (const Result& result : results) {
    ASSERT_TRUE(result.is_collide);
    EXPECT_LE(result.time_of_contact, time + 1e-15);
    EXPECT_NEAR(result.time_of_contact, time, 1e-11);
    ASSERT_FALSE(result.contacts.empty());
    EXPECT_LE(result.contacts[0].toc_hi, time + kTocErr);
  }
  EXPECT_NEAR(results[0].time_of_contact, results[1].time_of_contact, 1e-11);
  EXPECT_LT((results[0].contacts[0].normal + results[1].contacts[0].normal).norm(), 1e-6);
  ContinuousCollisionRequest<double> own;
  own.ccd_motion_type = CCDM_LINEAR;
  own.toc_err = kTocErr;
  ContinuousCollisionResult<double> own_result;
  EXPECT_NEAR(continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(),
                                b.begin, b.end, own, own_result),
              time, 1e-11);
}

TEST(OctreeCollision, BallDropsOnACell) {
  const Octree octree = oneCell();
  const Moving ball = falling(std::make_shared<Sphere<double>>(0.5));
  expectFirst(ball, still(octree), (2 - 0.5 - kResolution) / 4);
  const Result result = ask(still(octree), ball);
  ASSERT_EQ(result.contacts.size(), 1u);
  const auto& contact = result.contacts[0];
  EXPECT_EQ(contact.kind, ContinuousContactKind::kShapes);
  EXPECT_EQ(contact.o1, octree.get());
  EXPECT_EQ(contact.b2, -1);
  EXPECT_LT((contact.normal - Point(0, 0, 1)).norm(), 1e-6);
  EXPECT_NEAR(contact.pos[2], kResolution, 1e-9);
  const OctreeCell<double> cell = octreeCell(*octree, contact.b1);
  EXPECT_EQ(cell.center, Point::Constant(0.5 * kResolution));
  EXPECT_EQ(cell.size, kResolution);
  EXPECT_EQ(cell.depth, 16u);
  EXPECT_EQ(cell.key, octomap::OcTreeKey(32768, 32768, 32768));
  EXPECT_THROW(octreeCell(*octree, -1), Exception);
  EXPECT_THROW(octreeCell(*octree, std::intptr_t{17} << 48), Exception);
}

TEST(OctreeCollision, QuadrotorFliesIntoAWall) {
  const Map map = makeMap();
  for (int y = -16; y < 16; ++y)
    for (int z = -16; z < 16; ++z) occupy(map, 0, y, z);
  const Geometry body = std::make_shared<Box<double>>(0.4, 0.4, 0.1);
  expectFirst({body, at(-0.5, 0.3, 0.2), at(1.5, 0.3, 0.2)}, still(octreeOf(map)), 0.15);
}

TEST(OctreeCollision, MeshesHaveOneContactForEachTriangleAndCell) {
  const TestMesh sheet =
      makeSheet(2, 2, [](double u, double v) { return Point(u - 0.5, v - 0.5, 0); });
  const Moving plate = falling(makeModel<BVHModel<OBBRSS<double>>>(sheet));
  const Octree octree = oneCell();
  expectFirst(plate, still(octree), (2 - kResolution) / 4);
  const Result result = ask(plate, still(octree), requestOf(ContinuousQuery::kAll));
  // The cell is below the middle of the sheet, where four or eight triangles meet.
  EXPECT_GE(result.contacts.size(), 4u);
  for (const auto& contact : result.contacts) {
    EXPECT_GE(contact.kind, ContinuousContactKind::kVertexShape);
    EXPECT_LE(contact.kind, ContinuousContactKind::kFaceShape);
    EXPECT_TRUE(contact.first_on_o1);
    EXPECT_GE(contact.b1, 0);
    EXPECT_EQ(octreeCell(*octree, contact.b2).size, kResolution);
  }
}

TEST(OctreeCollision, ClothFallsThroughACell) {
  const auto frame = [](double z) {
    return makeSheet(4, 4,
                     [z](double u, double v) { return Point(u - 0.5, v - 0.5, z); });
  };
  const auto cloth = makeModel<DeformableBVHModel<KDOP<double, 16>>>(frame(2), frame(-2));
  expectFirst(still(cloth), still(oneCell()), (2 - kResolution) / 4);
  // It deforms and turns.
  Moving turning = still(cloth);
  turning.end.linear() = AngleAxis<double>(1, Point::UnitZ()).toRotationMatrix();
  expectFirst(turning, still(oneCell()), (2 - kResolution) / 4);
}

/// Goes down from z = 2 to z = -2. A class that the library does not know.
class OwnMotion : public TranslationMotion<double> {
 public:
  OwnMotion() : TranslationMotion<double>(at(0, 0, 2), at(0, 0, -2)) {}
};

TEST(OctreeCollision, MotionClassesOfTheProgram) {
  const OwnMotion own;
  const TranslationMotion<double> rest(Pose::Identity(), Pose::Identity());
  const TestMesh sheet = bentSheet(2);
  const auto cloth =
      makeModel<DeformableBVHModel<KDOP<double, 16>>>(moved(sheet, .1, 0, 0), sheet);
  const Octree octree = oneCell();
  Result result;
  // The poses at both ends of the step count for a cloth.
  EXPECT_NEAR(
      continuousCollide(cloth.get(), &own, octree.get(), &rest, requestOf(), result),
      ask({cloth, at(0, 0, 2), at(0, 0, -2)}, still(octree)).time_of_contact, 1e-11);
  EXPECT_TRUE(result.is_collide);
  // FCL answers the others, and has no contacts.
  const Sphere<double> ball(0.5);
  EXPECT_THROW(continuousCollide(&ball, &own, octree.get(), &rest, requestOf(), result),
               Exception);
  EXPECT_THROW(
      continuousCollide(cloth.get(), &rest, octree.get(), &own, requestOf(), result),
      Exception);
}

/// The first time of a ball that drops on oneCell() or another octree; 1: none.
double dropTime(const Octree& octree) {
  return ask(falling(std::make_shared<Sphere<double>>(0.5)), still(octree))
      .time_of_contact;
}

TEST(OctreeCollision, Thresholds) {
  const double hit = (2 - 0.5 - kResolution) / 4;
  const Map map = makeMap();
  occupy(map, 0, 0, 0);
  occupy(map, 0, 0, 4, false);
  Octree octree = octreeOf(map);
  EXPECT_NEAR(dropTime(octree), hit, 1e-11) << "the free cell does not count";
  // One observation makes the probability 0.7.
  octree->setOccupancyThres(0.75);
  EXPECT_EQ(dropTime(octree), 1) << "the cell is uncertain";
  octree->setOccupancyThres(0.65);
  EXPECT_NEAR(dropTime(octree), hit, 1e-11);
  // And a free one 0.4.
  octree->setOccupancyThres(0.35);
  EXPECT_NEAR(dropTime(octree), (2 - 0.5 - 5 * kResolution) / 4, 1e-11);
}

TEST(OctreeCollision, NodesBelowTheThresholdHideTheirCells) {
  const Map map = makeMap();
  occupy(map, 0, 0, 0);
  occupy(map, 1, 1, 1);
  map->search(octomap::OcTreeKey(32768, 32768, 32768), 12)->setLogOdds(-1);
  const Octree octree = octreeOf(map);
  EXPECT_EQ(dropTime(octree), 1);
  // A node may be occupied without an occupied child.
  const Map stale = makeMap();
  occupy(stale, 0, 0, 0, false);
  stale->search(octomap::OcTreeKey(32768, 32768, 32768), 12)->setLogOdds(1);
  EXPECT_EQ(dropTime(octreeOf(stale)), 1);
}

TEST(OctreeCollision, EmptyOctrees) {
  const Map free = makeMap();
  occupy(free, 0, 0, 0, false);
  const Geometry plane = std::make_shared<Plane<double>>(Point(0, 0, 1), 0),
                 sheet = makeModel<BVHModel<OBBRSS<double>>>(bentSheet(2)),
                 ball = std::make_shared<Sphere<double>>(1);
  for (const Octree& octree : {octreeOf(makeMap()), octreeOf(free)})
    for (const Geometry& other : {plane, sheet, ball, Geometry(octree)})
      for (const auto& result :
           {ask(still(octree), falling(other)), ask(falling(other), still(octree))}) {
        EXPECT_FALSE(result.is_collide);
        EXPECT_EQ(result.time_of_contact, 1);
        EXPECT_TRUE(result.contacts.empty());
      }
}

TEST(OctreeCollision, PrunedNodesAreLargeCells) {
  const Map map = makeMap();
  for (int i = 0; i < 64; ++i) occupy(map, i & 3, i >> 2 & 3, i >> 4);
  map->prune();
  ASSERT_EQ(map->getNumLeafNodes(), 1u);
  const Octree octree = octreeOf(map);
  EXPECT_NEAR(dropTime(octree), (2 - 0.5 - 4 * kResolution) / 4, 1e-11);
  const Result result =
      ask(falling(std::make_shared<Sphere<double>>(0.5)), still(octree));
  ASSERT_EQ(result.contacts.size(), 1u);
  const OctreeCell<double> cell = octreeCell(*octree, result.contacts[0].b2);
  EXPECT_EQ(cell.size, 4 * kResolution);
  EXPECT_EQ(cell.center, Point::Constant(2 * kResolution));
  EXPECT_EQ(cell.depth, 14u);
  const octomap::OcTreeNode* node = map->search(cell.key, cell.depth);
  ASSERT_NE(node, nullptr);
  EXPECT_FALSE(map->nodeHasChildren(node));
}

TEST(OctreeCollision, ObjectsThatAreNotOccupiedAreNoObstacles) {
  const auto ball = std::make_shared<Sphere<double>>(0.5);
  ball->cost_density = 0.5;
  EXPECT_FALSE(ask(falling(ball), still(oneCell())).is_collide);
  ball->threshold_occupied = 0.5;
  EXPECT_TRUE(ask(falling(ball), still(oneCell())).is_collide);
}

TEST(OctreeCollision, Options) {
  const Map map = makeMap();
  for (int x = -8; x < 8; ++x)
    for (int y = -8; y < 8; ++y) occupy(map, x, y, 0);
  const Moving floor = still(octreeOf(map));
  const Moving ball = falling(std::make_shared<Sphere<double>>(0.5));
  const double hit = (2 - 0.5 - kResolution) / 4;
  Request request = requestOf();
  request.t_max = hit - 1e-6;
  EXPECT_FALSE(ask(ball, floor, request).is_collide);
  request.t_max = hit + 1e-6;
  EXPECT_TRUE(ask(ball, floor, request).is_collide);
  request = requestOf();
  request.min_distance = 0.1;
  EXPECT_NEAR(ask(ball, floor, request).time_of_contact, hit - 0.1 / 4, 1e-11);
  // A ball that starts within the distance and moves away.
  const Moving leaving{ball.geometry, at(0, 0, 0.55 + kResolution), at(0, 0, 2)};
  EXPECT_EQ(ask(leaving, floor, request).time_of_contact, 0);
  request.ignore_initially_closer = true;
  EXPECT_FALSE(ask(leaving, floor, request).is_collide);
  EXPECT_NEAR(ask(ball, floor, request).time_of_contact, hit - 0.1 / 4, 1e-11);
  request = requestOf();
  request.filter1.group = 2;
  request.filter2.mask = 5;
  EXPECT_FALSE(ask(ball, floor, request).is_collide);
  request = requestOf();
  request.accepts_triangles = [](std::intptr_t b1, std::intptr_t b2) {
    EXPECT_EQ(b1, -1);
    EXPECT_EQ(b2, -1);
    return false;
  };
  EXPECT_FALSE(ask(ball, floor, request).is_collide);
  request = requestOf(ContinuousQuery::kAny);
  EXPECT_EQ(ask(ball, floor, request).contacts.size(), 1u);
  request = requestOf(ContinuousQuery::kAll);
  const auto all = ask(ball, floor, request).contacts;
  EXPECT_GT(all.size(), 30u);
  for (std::size_t i = 1; i < all.size(); ++i)
    EXPECT_LE(std::make_pair(all[i - 1].toc_lo, all[i - 1].b2),
              std::make_pair(all[i].toc_lo, all[i].b2));
  request.num_max_contacts = 5;
  const Result cut = ask(ball, floor, request);
  EXPECT_TRUE(cut.contacts_cut);
  ASSERT_EQ(cut.contacts.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(cut.contacts[i].b2, all[i].b2);
}

TEST(OctreeCollision, HasNoCandidates) {
  const Geometry sheet = makeModel<BVHModel<OBBRSS<double>>>(bentSheet(2)),
                 octree = oneCell();
  const auto refusal = [](const Geometry& o1, const Geometry& o2) -> std::string {
    const Pose here = Pose::Identity();
    try {
      continuousCandidates(o1.get(), here, here, o2.get(), here, here,
                           [](const ContinuousCandidate*, std::size_t) { return true; });
    } catch (const Exception& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(sheet, octree).find("o2 is not a triangle mesh but an octree"),
            std::string::npos);
  EXPECT_NE(refusal(octree, sheet).find("o1 is not a triangle mesh"), std::string::npos);
}

TEST(OctreeCollision, Float) {
  const auto map = std::make_shared<octomap::OcTree>(0.1);
  map->updateNode(octomap::point3d(0.05f, 0.05f, 0.05f), true);
  const OcTree<float> octree(map);
  const Sphere<float> ball(0.5f);
  Transform3<float> begin = Transform3<float>::Identity(), end = begin;
  begin.translation() << 0.05f, 0.05f, 2;
  end.translation() << 0.05f, 0.05f, -2;
  const Transform3<float> here = Transform3<float>::Identity();
  ContinuousContactRequest<float> request;
  request.toc_err = 1e-6f;
  ContinuousContactResult<float> result;
  EXPECT_NEAR(continuousCollide(&ball, begin, end, &octree, here, here, request, result),
              0.35f, 1e-6f);
  ASSERT_EQ(result.contacts.size(), 1u);
  const OctreeCell<float> cell = octreeCell(octree, result.contacts[0].b2);
  EXPECT_EQ(cell.size, 0.1f);
  EXPECT_FLOAT_EQ(cell.center[1], 0.05f);
}

/// Each observation of a cell has another weight, so that nothing is pruned.
Map bumpyFloor(int half) {
  const Map map = makeMap();
  for (int x = -half; x < half; ++x)
    for (int y = -half; y < half; ++y) {
      const octomap::OcTreeKey key(static_cast<std::uint16_t>(32768 + x),
                                   static_cast<std::uint16_t>(32768 + y), 32768);
      map->setNodeValue(key, 1 + 0.01f * static_cast<float>((x + y) & 7), true);
    }
  map->updateInnerOccupancy();
  return map;
}

TEST(OctreeCollision, FewBoxesAreTested) {
  const Map map = bumpyFloor(64);
  const std::uint64_t num_cells = map->getNumLeafNodes();
  ASSERT_EQ(num_cells, 16384u);
  const Octree octree = octreeOf(map);
  const Moving ball = falling(std::make_shared<Sphere<double>>(0.5));
  EXPECT_LT(ask(ball, still(octree)).counts.node_pairs, num_cells / 10);
  const Geometry mesh = makeModel<BVHModel<OBBRSS<double>>>(makeBox({.3, .2, .1}, 4));
  EXPECT_LT(ask(falling(mesh), still(octree)).counts.node_pairs, num_cells / 2);
  // Beside the floor.
  const Result apart = ask({mesh, at(-8, 0, 1), at(8, 0, 1)}, still(octree));
  EXPECT_FALSE(apart.is_collide);
  EXPECT_LT(apart.counts.node_pairs, num_cells / 10);
  // A flat sheet above a thousand cells stops there. The boxes of nodes are as flat as
  // their cells.
  const Geometry sheet = makeModel<BVHModel<OBBRSS<double>>>(makeSheet(20, 20));
  const auto wide = std::make_shared<Box<double>>(4, 4, 0.01);
  for (const Geometry& flat : {sheet, Geometry(wide)}) {
    const Result above =
        ask({flat, at(-.5, -.5, 1), at(-.5, -.5, kResolution + 0.02)}, still(octree));
    EXPECT_FALSE(above.is_collide);
    EXPECT_LT(above.counts.node_pairs, 500u);
  }
}

TEST(OctreeCollision, BroadPhaseBoxesContainTheCells) {
  const auto floor = octreeOf(bumpyFloor(20));
  const TranslationMotion<double> fly(at(0, 0, 0), at(0, 0, 1));
  const auto motion = std::make_shared<TranslationMotion<double>>(fly);
  ContinuousCollisionObject<double> object(floor, motion);
  const SweptCollisionObjectd swept(&object);
  const AABB<double>& box = swept.getAABB();
  const double half = 20 * kResolution;
  for (int k = 0; k < 2; ++k) {
    EXPECT_LE(box.min_[k], -half);
    EXPECT_GE(box.min_[k], -1.3 * half);
    EXPECT_GE(box.max_[k], half);
    EXPECT_LE(box.max_[k], 1.3 * half);
  }
  EXPECT_LE(box.min_[2], 0);
  EXPECT_GE(box.max_[2], 1 + kResolution);
}

TEST(OctreeCollision, TheManagerFindsTheirContacts) {
  const auto motion = [](const Pose& begin, const Pose& end) {
    return std::make_shared<TranslationMotion<double>>(begin, end);
  };
  const auto rest = motion(Pose::Identity(), Pose::Identity());
  const Moving path = falling(std::make_shared<Sphere<double>>(0.5));
  const auto drop = motion(path.begin, path.end),
             aside = motion(at(3, 0, 0), at(3, 0, 1));
  ContinuousCollisionObject<double> octree(oneCell(), rest), ball(path.geometry, drop),
      other_ball(path.geometry, aside), empty(octreeOf(makeMap()), rest);
  ContinuousCollisionManager<double> manager;
  manager.registerObjects({&octree, &ball, &other_ball, &empty});
  ContinuousManagerResult<double> result;
  manager.collide(requestOf(ContinuousQuery::kAll), result);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].o1, &octree);
  EXPECT_EQ(result.pairs[0].o2, &ball);
  EXPECT_NEAR(result.time_of_contact, (2 - 0.5 - kResolution) / 4, 1e-11);
}

Pose randomPose(Random& random, double distance, double angle) {
  Pose pose = Pose::Identity();
  pose.translation() = random.point(distance);
  pose.linear() = AngleAxis<double>(random.uniform(-angle, angle),
                                    (random.point(1) + Point(0, 0, 1e-3)).normalized())
                      .toRotationMatrix();
  return pose;
}

/// About fifty cells, some of them pruned into larger ones.
Map randomMap(Random& random) {
  const Map map = makeMap();
  for (int i = 0; i < 40; ++i) {
    const auto place = [&] { return static_cast<int>(random.index(12)) - 6; };
    const int x = place(), y = place(), z = place();
    if (random.index(4) == 0)
      for (int k = 0; k < 8; ++k)
        occupy(map, 2 * (x / 2) + (k & 1), 2 * (y / 2) + (k >> 1 & 1),
               2 * (z / 2) + (k >> 2));
    else
      occupy(map, x, y, z, random.index(5) != 0);
  }
  map->prune();
  return map;
}

Geometry boxOf(const Point& center, double size) {
  auto corners = std::make_shared<std::vector<Point>>();
  for (int i = 0; i < 8; ++i)
    corners->push_back(
        center + 0.5 * size * Point(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  const int sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& side : sides) {
    faces->push_back(4);
    faces->insert(faces->end(), side, side + 4);
  }
  return std::make_shared<Convex<double>>(corners, 6, faces);
}

std::vector<Geometry> makeObjects() {
  const TestMesh brick = makeBox({.3, .2, .1}, 2);
  TestMesh bent = brick;
  for (auto& p : bent.vertices) p = 1.1 * p + Point(.1, .5 * p[0] * p[0], .2);
  return {std::make_shared<Box<double>>(.3, .2, .4),
          std::make_shared<Sphere<double>>(.2),
          std::make_shared<Capsule<double>>(.1, .4),
          std::make_shared<Ellipsoid<double>>(.1, .2, .3),
          std::make_shared<Cone<double>>(.2, .4),
          std::make_shared<Cylinder<double>>(.2, .3),
          boxOf(Point(.1, 0, 0), .3),
          std::make_shared<Plane<double>>(Point(.6, 0, .8), .1),
          std::make_shared<Halfspace<double>>(Point(.6, 0, -.8), -1),
          std::make_shared<TriangleP<double>>(Point(0, 0, 0), Point(.4, 0, .1),
                                              Point(0, .4, 0)),
          makeModel<BVHModel<OBBRSS<double>>>(brick),
          makeModel<DeformableBVHModel<KDOP<double, 16>>>(brick, bent)};
}

/// The first times of all pairs of a part of the object and a cell. The cells are convex
/// shapes in the frame of the octree.
using Times = std::map<std::pair<std::intptr_t, std::vector<double>>, double>;

Times bruteForce(const Moving& octree, const Moving& other, const Request& request) {
  Times times;
  for (const auto& cell : static_cast<OcTree<double>&>(*octree.geometry).toBoxes()) {
    const Geometry box = boxOf({cell[0], cell[1], cell[2]}, cell[3]);
    for (const auto& contact :
         ask({box, octree.begin, octree.end}, other, request).contacts)
      times[{contact.b2, {cell[0], cell[1], cell[2], cell[3]}}] = contact.toc_lo;
  }
  return times;
}

/// @return whether they touch
bool expectAsBruteForce(const Moving& octree, const Moving& other,
                        const Request& request) {
  const Times expected = bruteForce(octree, other, request);
  double first = 1;
  for (const auto& entry : expected) first = std::min(first, entry.second);
  Request asked = request;
  asked.query = ContinuousQuery::kFirst;
  EXPECT_NEAR(ask(octree, other, asked).time_of_contact, first, 1e-11);
  const Result back = ask(other, octree, request);
  EXPECT_NEAR(back.time_of_contact, first, 1e-11);
  EXPECT_EQ(back.contacts.size(), expected.size());
  const Result all = ask(octree, other, request);
  EXPECT_EQ(all.contacts.size(), expected.size());
  for (const auto& contact : all.contacts) {
    const auto cell =
        octreeCell(static_cast<const OcTree<double>&>(*octree.geometry), contact.b1);
    const auto same = expected.find(
        {contact.b2, {cell.center[0], cell.center[1], cell.center[2], cell.size}});
    EXPECT_NE(same, expected.end());
    if (same != expected.end()) {
      EXPECT_NEAR(contact.toc_lo, same->second, 1e-11);
    }
  }
  return !expected.empty();
}

TEST(OctreeCollision, AgreesWithAllCells) {
  Random random(20);
  const std::vector<Geometry> objects = makeObjects();
  int num_touching = 0;
  for (int scene = 0; scene < 10; ++scene)
    for (std::size_t i = 0; i < objects.size(); ++i) {
      SCOPED_TRACE("scene " + std::to_string(scene) + ", object " + std::to_string(i));
      const double turn = scene % 2 == 0 ? 0 : 1;
      const Moving octree{octreeOf(randomMap(random)), randomPose(random, .3, turn),
                          randomPose(random, .3, turn)};
      const Moving other{objects[i], randomPose(random, 1.5, turn),
                         randomPose(random, 1.5, turn)};
      Request request = requestOf(ContinuousQuery::kAll);
      if (scene % 3 == 1) request.ccd_motion_type = CCDM_SCREW;
      num_touching += expectAsBruteForce(octree, other, request) ? 1 : 0;
    }
  EXPECT_GT(num_touching, 60);
}

TEST(OctreeCollision, TwoOctrees) {
  Random random(21);
  for (int scene = 0; scene < 10; ++scene) {
    SCOPED_TRACE(scene);
    const Moving a{octreeOf(randomMap(random)), at(-2, 0, 0), randomPose(random, .3, 1)},
        b{octreeOf(randomMap(random)), at(2, 0, 0), randomPose(random, .3, 1)};
    double first = 1;
    for (const auto& cell : static_cast<OcTree<double>&>(*b.geometry).toBoxes())
      first = std::min(
          first, ask(a, {boxOf({cell[0], cell[1], cell[2]}, cell[3]), b.begin, b.end})
                     .time_of_contact);
    const Result result = ask(a, b);
    EXPECT_NEAR(result.time_of_contact, first, 1e-11);
    ASSERT_FALSE(result.contacts.empty());
    EXPECT_GE(result.contacts[0].b1, 0);
    EXPECT_GE(result.contacts[0].b2, 0);
    EXPECT_NEAR(ask(b, a).time_of_contact, first, 1e-11);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

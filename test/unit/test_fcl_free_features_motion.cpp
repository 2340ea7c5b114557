// SPDX-License-Identifier: BSD-3-Clause
//
// Models with free edges and free points that turn, or meet shapes and octrees. Against
// the answers for straight paths, and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "feature_distance.h"
#include "free_features.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Pose = Transform3<double>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Geometry = CollisionGeometry<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;
using Kind = ContinuousContactKind;

constexpr double kPi = 3.14159265358979323846;
constexpr double kTocErr = 1e-6;

Request requestAt(double distance, CCDMotionType motion = CCDM_SCREW) {
  Request request;
  request.toc_err = kTocErr;
  request.min_distance = distance;
  request.ccd_motion_type = motion;
  return request;
}

struct Motion {
  Pose begin, end;
};

Motion still() { return {Pose::Identity(), Pose::Identity()}; }

Motion randomMotion(Random& random, double angle) {
  const auto pose = [&](double turn) -> Pose {
    Pose pose(Eigen::AngleAxisd(turn, V(random.point(1)).normalized()));
    pose.translation() = random.point(1);
    return pose;
  };
  const Pose begin = pose(3);
  return {begin, begin * pose(angle)};
}

Motion turnAboutZ(double angle) {
  return {Pose::Identity(), Pose(Eigen::AngleAxisd(angle, V::UnitZ()))};
}

Result ask(const Geometry& a, const Motion& of_a, const Geometry& b, const Motion& of_b,
           const Request& request) {
  Result result;
  continuousCollide(&a, of_a.begin, of_a.end, &b, of_b.begin, of_b.end, request, result);
  return result;
}

Result askStraight(const FreeBody& a, const FreeBody& b, double distance) {
  return pairContacts(*freeModelOf<Model>(a), *freeModelOf<Model>(b),
                      requestAt(distance));
}

void expectSameContacts(const NamedContacts& found, const NamedContacts& truth) {
  ASSERT_EQ(found.size(), truth.size());
  for (auto p = found.begin(), q = truth.begin(); p != found.end(); ++p, ++q) {
    EXPECT_EQ(p->first, q->first);
    EXPECT_NEAR(p->second.first, q->second.first, 2 * kTocErr);
  }
}

/// Two bodies that make the same turn have the relative motion of bodies without it.
TEST(FCL_FREE_FEATURES_MOTION, commonTurn) {
  Random random(411);
  std::map<int, std::size_t> kinds;
  for (int i = 0; i < rounds(24); ++i) {
    const FreeBody a = randomBody(random, kBodySizes[i % 7], 0.2, OnGrid::kNever),
                   b = randomBody(random, kBodySizes[(i / 7 + 3 * i) % 7], 0.2,
                                  OnGrid::kNever);
    const auto model_a = freeModelOf<Model>(a), model_b = freeModelOf<Model>(b);
    const Motion motion = randomMotion(random, 0.1 + i % 3);
    for (const double distance : kDistances)
      for (const bool swaps : {false, true}) {
        SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
        const auto& x = swaps ? model_b : model_a;
        const auto& y = swaps ? model_a : model_b;
        Request request = requestAt(distance);
        request.ignore_initially_closer = distance > 0 && i % 3 == 0;
        if (i % 4 == 0) request.t_max = 0.6;
        const Result straight = pairContacts(*x, *y, request);
        const NamedContacts truth = namedContacts(straight, false);
        const Result result = ask(*x, motion, *y, motion, request);
        const NamedContacts found = namedContacts(result, false);
        ASSERT_EQ(found.size(), truth.size());
        for (auto p = found.begin(), q = truth.begin(); p != found.end(); ++p, ++q) {
          ASSERT_EQ(p->first, q->first);
          // The distance at t = 0 that takes the place of d is rounded in another way.
          const double rounding = request.ignore_initially_closer ? 1e-8 : 0;
          EXPECT_LE(p->second.first, q->second.second + rounding);
          EXPECT_GE(p->second.first, q->second.first - 1e-6);
        }
        EXPECT_EQ(result.initially_crossing, straight.initially_crossing);
        EXPECT_EQ(result.crossings.size(), straight.crossings.size());
        for (const Contact& c : result.contacts) ++kinds[static_cast<int>(c.kind)];
        for (const ContinuousQuery query :
             {ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
          Request other = request;
          other.query = query;
          const Result one = ask(*x, motion, *y, motion, other);
          ASSERT_EQ(one.is_collide, result.is_collide);
          if (query == ContinuousQuery::kFirst && one.is_collide) {
            EXPECT_NEAR(one.time_of_contact, straight.time_of_contact, 2 * kTocErr);
          }
        }
        if (distance > 0 || i % 4 == 0) continue;
        ContinuousCollisionResult<double> plain;
        continuousCollide(
            x.get(), motion.begin, motion.end, y.get(), motion.begin, motion.end,
            static_cast<const ContinuousCollisionRequest<double>&>(request), plain);
        EXPECT_EQ(plain.is_collide, result.is_collide);
      }
  }
  EXPECT_EQ(kinds.size(), 4U);
}

/// On a grid many features touch exactly. All of them are found; others come within the
/// tolerance of touching.
TEST(FCL_FREE_FEATURES_MOTION, commonTurnOnAGrid) {
  Random random(412);
  std::size_t contacts = 0;
  for (int i = 0; i < rounds(20); ++i) {
    const FreeBody a = randomBody(random, kBodySizes[i % 7], 0.2),
                   b = randomBody(random, kBodySizes[(i + 2) % 7], 0.2);
    const Motion motion = randomMotion(random, 1);
    const NamedContacts truth = namedContacts(askStraight(a, b, 0), false),
                        near = namedContacts(askStraight(a, b, 1e-11), false),
                        found = namedContacts(
                            ask(*freeModelOf<Model>(a), motion, *freeModelOf<Model>(b),
                                motion, requestAt(0)),
                            false);
    for (const auto& contact : truth) {
      const auto at = found.find(contact.first);
      ASSERT_NE(at, found.end());
      EXPECT_LE(at->second.first, contact.second.second);
    }
    contacts += truth.size();
    if (near.empty()) {
      EXPECT_TRUE(found.empty());
    }
  }
  EXPECT_GT(contacts, rounds(20U));
}

/// A rod turns by a right angle about its end.
TEST(FCL_FREE_FEATURES_MOTION, turningRod) {
  FreeBody rod, post, point, other;
  rod.t0 = rod.t1 = {{0, 0, 0}, {2, 0, 0}};
  rod.edges = {{0, 1}};
  const double post_angle = kPi / 5, angle = kPi / 3, d = 0.1;
  const V at_post(std::cos(post_angle), std::sin(post_angle), 0),
      at_point(std::cos(angle), std::sin(angle), 0);
  post.t0 = post.t1 = {at_post - V(0, 0, 1), at_post + V(0, 0, 1)};
  post.edges = {{1, 0}};
  point.t0 = point.t1 = {at_point};
  point.points = {0};
  other.t0 = other.t1 = {{1, 0, 0}};
  other.points = {0};
  const Motion turn = turnAboutZ(kPi / 2);
  for (const CCDMotionType motion : {CCDM_LINEAR, CCDM_SCREW}) {
    const auto expectOne = [&](const FreeBody& moving, const FreeBody& target,
                               double distance, Kind kind, double time) {
      for (const bool swaps : {false, true}) {
        const auto x = freeModelOf<Model>(moving), y = freeModelOf<Model>(target);
        const Request request = requestAt(distance, motion);
        const Result result = swaps ? ask(*y, still(), *x, turn, request)
                                    : ask(*x, turn, *y, still(), request);
        ASSERT_EQ(result.contacts.size(), 1U);
        const Contact& c = result.contacts[0];
        EXPECT_EQ(c.kind, kind);
        EXPECT_LE(c.toc_lo, time + 1e-15);
        EXPECT_NEAR(c.toc_lo, time, 1e-9);
        if (distance == 0) {
          EXPECT_EQ(c.toc_hi, c.toc_lo);
          EXPECT_TRUE(c.within_tolerance);
          continue;
        }
        EXPECT_GT(c.toc_hi, c.toc_lo);
        EXPECT_LE(c.toc_hi - c.toc_lo, kTocErr);
        EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
        EXPECT_NEAR((c.pos - (target.t0[0] + target.t0.back()) / 2).norm(), distance / 2,
                    1e-6);
      }
    };
    expectOne(rod, post, 0, Kind::kEdgeEdge, 0.4);
    const double lead = std::asin(d);
    expectOne(rod, post, d, Kind::kEdgeEdge, (post_angle - lead) / (kPi / 2));
    expectOne(rod, point, d, Kind::kVertexEdge, (angle - lead) / (kPi / 2));
    expectOne(other, point, d, Kind::kVertexVertex,
              (angle - 2 * std::asin(d / 2)) / (kPi / 2));
    // A point meets an edge or a point at a distance only.
    for (const FreeBody* moving : {&rod, &other}) {
      const Result none = ask(*freeModelOf<Model>(*moving), turn,
                              *freeModelOf<Model>(point), still(), requestAt(0, motion));
      EXPECT_FALSE(none.is_collide);
      EXPECT_TRUE(none.contacts.empty());
    }
  }
}

/// The least distance of two bodies of which each makes a screw motion, at a time.
double distanceAt(const FreeBody& a, const MotionBase<double>& motion_a,
                  const FreeBody& b, const MotionBase<double>& motion_b, double t) {
  Pose pose[2];
  motion_a.integrate(t);
  motion_a.getCurrentTransform(pose[0]);
  motion_b.integrate(t);
  motion_b.getCurrentTransform(pose[1]);
  detail::deformable::DistanceRequest asked;
  asked.distance = 1;
  double least = 1e9;
  AllPairs(a, b, asked)
      .forEach([&](Kind kind, int side, const auto& first, const auto& second) {
        const auto at = [&](int i, int id) -> V {
          const FreeBody& body = i == 0 ? a : b;
          const auto v = static_cast<std::size_t>(id);
          return pose[i] * V((1 - t) * body.t0[v] + t * body.t1[v]);
        };
        const auto p = [&](const std::vector<int>& ids, std::size_t k) {
          return at(&ids == &first ? side : 1 - side, ids[std::min(k, ids.size() - 1)]);
        };
        const double distance =
            kind == Kind::kVertexFace
                ? distanceToFace(p(first, 0), p(second, 0), p(second, 1), p(second, 2))
                : distanceOfEdges(p(first, 0), p(first, 1), p(second, 0), p(second, 1));
        least = std::min(least, distance);
      });
  return least;
}

/// Two bodies on motions of their own, against samples of their distance.
TEST(FCL_FREE_FEATURES_MOTION, ownTurnsAgainstSamples) {
  Random random(418);
  std::size_t later = 0;
  for (int i = 0; i < manyRounds(40); ++i) {
    const FreeBody a = randomBody(random, kBodySizes[i % 7], 0.2, OnGrid::kNever),
                   b = randomBody(random, kBodySizes[(i / 7 + 3 * i) % 7], 0.2,
                                  OnGrid::kNever);
    Motion of_a = randomMotion(random, 1 + i % 2), of_b = randomMotion(random, 1.5);
    of_a.begin.translation() += V(0, 0, 2);
    const ScrewMotion<double> motion_a(of_a.begin, of_a.end),
        motion_b(of_b.begin, of_b.end);
    for (const double distance : {0.001, 0.08}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      request.query = ContinuousQuery::kFirst;
      const Result result =
          ask(*freeModelOf<Model>(a), of_a, *freeModelOf<Model>(b), of_b, request);
      if (result.initially_crossing) continue;
      const double time = result.time_of_contact;
      constexpr int kSamples = kHasAddressSanitizer ? 6 : 200;
      for (int k = 0; k <= kSamples; ++k) {
        const double t = static_cast<double>(k) / kSamples;
        if (result.is_collide && t >= time) break;
        EXPECT_GT(distanceAt(a, motion_a, b, motion_b, t), distance - 1e-12) << t;
      }
      if (result.is_collide && time > 0) {
        EXPECT_NEAR(distanceAt(a, motion_a, b, motion_b, time), distance, 1e-9);
        ++later;
      }
    }
  }
  EXPECT_GT(later, rounds(20U) / 4);
}

/// A cable that turns through a sheet: VF of its end, EE with the border.
TEST(FCL_FREE_FEATURES_MOTION, rodAndSheet) {
  FreeBody rod, wide, narrow;
  rod.t0 = rod.t1 = {{1, 0, 0}, {2, 0, 0}};
  rod.edges = {{0, 1}};
  // In the plane at an angle of 45 degrees; the narrow one ends within the rod.
  const auto sheet = [](double from, double to) {
    FreeBody body;
    const double s = std::sqrt(0.5);
    body.t0 = {{from * s, from * s, -1}, {to * s, to * s, 0}, {from * s, from * s, 1}};
    body.t1 = body.t0;
    body.triangles = {{0, 1, 2}};
    return body;
  };
  wide = sheet(-1, 9);
  narrow = sheet(1.5, 9);
  const Motion turn = turnAboutZ(kPi / 2);
  Request request = requestAt(0);
  for (const ContinuousQuery query : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
    request.query = query;
    const Result through =
        ask(*freeModelOf<Model>(rod), turn, *freeModelOf<Model>(wide), still(), request);
    EXPECT_NEAR(through.time_of_contact, 0.5, 1e-9);
    // The rod lies in the plane at that time: both ends touch, up to rounding.
    const std::size_t least = query == ContinuousQuery::kAll ? 2 : 1;
    ASSERT_GE(through.contacts.size(), least);
    for (const Contact& c : through.contacts) {
      EXPECT_EQ(c.kind, Kind::kVertexFace);
      EXPECT_TRUE(c.first_on_o1);
    }
    const Result border = ask(*freeModelOf<Model>(narrow), still(),
                              *freeModelOf<Model>(rod), turn, request);
    EXPECT_NEAR(border.time_of_contact, 0.5, 1e-9);
    ASSERT_GE(border.contacts.size(), least);
    if (query == ContinuousQuery::kAll) {
      EXPECT_NE(border.contacts[0].kind, border.contacts[1].kind);
    }
  }
  // From a start in the middle of the turn it has passed through.
  request.query = ContinuousQuery::kAll;
  request.enable_crossings = true;
  FreeBody across = rod;
  across.t0 = across.t1 = {{1, 1, 0}, {2, -1, 0}};
  FreeBody wall = wide;
  wall.t0 = wall.t1 = {{1.5, -5, -5}, {1.5, 5, -5}, {1.5, 0, 5}};
  const Result crossing = ask(*freeModelOf<Model>(across), turnAboutZ(0.5),
                              *freeModelOf<Model>(wall), still(), request);
  EXPECT_EQ(crossing.time_of_contact, 0);
  EXPECT_TRUE(crossing.initially_crossing);
  ASSERT_EQ(crossing.crossings.size(), 1U);
  EXPECT_EQ(crossing.crossings[0].vertices, (std::array<int, 5>{{0, 1, 0, 1, 2}}));
}

/// Candidates of bodies with a common turn hold all pairs that come near.
TEST(FCL_FREE_FEATURES_MOTION, candidatesHoldAllThatComeNear) {
  Random random(413);
  std::size_t num_candidates = 0, num_possible = 0;
  for (int i = 0; i < rounds(14); ++i) {
    const FreeBody a = randomBody(random, kBodySizes[i % 7], 0.1),
                   b = randomBody(random, kBodySizes[(i + 3) % 7], 0.1);
    const Motion motion = randomMotion(random, 0.3);
    const ScrewMotion<double> screw(motion.begin, motion.end);
    for (const double distance : kDistances) {
      std::set<FeaturePairName> candidates;
      std::size_t count = 0;
      const auto model_a = freeModelOf<Model>(a), model_b = freeModelOf<Model>(b);
      EXPECT_TRUE(continuousCandidates(
          model_a.get(), &screw, model_b.get(), &screw,
          [&](const ContinuousCandidate* block, std::size_t size) {
            for (std::size_t k = 0; k < size; ++k)
              candidates.insert(pairName(block[k], false));
            count += size;
            return true;
          },
          distance));
      EXPECT_EQ(candidates.size(), count);
      detail::deformable::DistanceRequest asked;
      asked.distance = distance;
      std::set<FeaturePairName> possible;
      const AllPairs all(a, b, asked);
      all.forEach([&](Kind kind, int side, const auto& first, const auto& second) {
        possible.insert(pairName(kind, {side == 0, first}, {side != 0, second}));
      });
      for (const auto& name : candidates) EXPECT_EQ(possible.count(name), 1U);
      num_candidates += candidates.size();
      num_possible += possible.size();
      all.forEach([&](Kind kind, int side, const auto& first, const auto& second) {
        if (all.isContact(kind, side, first, second)) {
          EXPECT_EQ(
              candidates.count(pairName(kind, {side == 0, first}, {side != 0, second})),
              1U);
        }
      });
    }
  }
  EXPECT_LT(2 * num_candidates, num_possible);
}

/// The first time at which each triangle, free edge and free point touches.
using LeafTimes = std::map<std::intptr_t, double>;

LeafTimes firstTimes(const Result& result) {
  LeafTimes times;
  for (const Contact& c : result.contacts) {
    const bool is_new = times.emplace(c.b1, c.toc_lo).second;
    EXPECT_TRUE(is_new);
  }
  return times;
}

/// The same from contacts of features: those of vertices of the leaf.
LeafTimes firstTimes(const Result& result, const Model& model) {
  LeafTimes times;
  const int num_leaves = static_cast<int>(static_cast<std::size_t>(model.num_tris) +
                                          model.numFreeEdges() + model.numFreePoints());
  for (std::intptr_t b = 0; b < num_leaves; ++b) {
    std::set<int> ids;
    const Primitive p = model.primitive(b);
    if (p.kind == PrimitiveKind::kTriangle)
      for (int k = 0; k < 3; ++k)
        ids.insert(static_cast<int>(model.tri_indices[p.index][k]));
    else if (p.kind == PrimitiveKind::kFreeEdge)
      for (const std::size_t id : model.freeEdge(p.index))
        ids.insert(static_cast<int>(id));
    else
      ids.insert(static_cast<int>(model.freePoint(p.index)));
    for (const Contact& c : result.contacts) {
      const int num_first = c.kind == Kind::kEdgeEdge ? 2 : 1;
      bool is_here = true;
      for (int k = 0; k < c.numVertices(); ++k)
        if ((k < num_first) == c.first_on_o1)
          is_here &= ids.count(c.vertices[static_cast<std::size_t>(k)]) == 1;
      if (!is_here) continue;
      const auto [at, is_new] = times.emplace(b, c.toc_lo);
      if (!is_new) at->second = std::min(at->second, c.toc_lo);
    }
  }
  return times;
}

void expectSameTimes(const LeafTimes& found, const LeafTimes& truth) {
  ASSERT_EQ(found.size(), truth.size());
  for (auto x = found.begin(), y = truth.begin(); x != found.end(); ++x, ++y) {
    ASSERT_EQ(x->first, y->first);
    EXPECT_NEAR(x->second, y->second, 2 * kTocErr);
  }
}

/// Bodies above that fall on a shape around the origin.
FreeBody fallingBody(Random& random, const BodySize& size) {
  FreeBody body = randomBody(random, size, 0.2, OnGrid::kNever);
  for (V& p : body.t0) p += V(-0.5, -0.5, 2);
  for (V& p : body.t1) p += V(-0.5, -0.5, -1.5);
  return body;
}

/// Without free edges and points that are parts of others: with the free point of another
/// body these are no pair of their own.
FreeBody withoutParts(FreeBody body) {
  const BodyFeatures features(body);
  const auto is_part_edge = [&](const FreeEdge& e) {
    const int v = static_cast<int>(e[0]), w = static_cast<int>(e[1]);
    return features.free_edges.count({std::min(v, w), std::max(v, w)}) == 0;
  };
  const auto is_part_point = [&](std::size_t p) {
    return features.free_points.count({static_cast<int>(p)}) == 0;
  };
  auto& edges = body.edges;
  auto& points = body.points;
  edges.erase(std::remove_if(edges.begin(), edges.end(), is_part_edge), edges.end());
  points.erase(std::remove_if(points.begin(), points.end(), is_part_point), points.end());
  return body;
}

/// A ball is a free point at a distance, a capsule a free edge: both go straight.
TEST(FCL_FREE_FEATURES_MOTION, roundShapes) {
  Random random(414);
  FreeBody center, axis;
  center.t0 = center.t1 = {{0, 0, 0}};
  center.points = {0};
  axis.t0 = axis.t1 = {{0, 0, -0.4}, {0, 0, 0.4}};
  axis.edges = {{0, 1}};
  const double radius = 0.3;
  std::map<int, std::size_t> kinds;
  for (int i = 0; i < rounds(14); ++i) {
    const FreeBody body = withoutParts(fallingBody(random, kBodySizes[i % 7]));
    const auto model = freeModelOf<Model>(body);
    for (const double distance : {0., 0.1}) {
      for (const bool is_capsule : {false, true}) {
        const Sphere<double> sphere(radius);
        const Capsule<double> capsule(radius, 0.8);
        const Geometry& shape =
            is_capsule ? static_cast<const Geometry&>(capsule) : sphere;
        const Request request = requestAt(distance, CCDM_LINEAR);
        const Result result = ask(*model, still(), shape, still(), request);
        const auto core = freeModelOf<Model>(is_capsule ? axis : center);
        const LeafTimes truth =
            firstTimes(pairContacts(*model, *core, requestAt(radius + distance)), *model);
        expectSameTimes(firstTimes(result), truth);
        for (const Contact& c : result.contacts) {
          ++kinds[static_cast<int>(c.kind)];
          const std::set<int> ids(c.vertices.begin(),
                                  c.vertices.begin() + c.numVertices());
          EXPECT_EQ(ids.size(), static_cast<std::size_t>(c.numVertices()));
          if (model->primitive(c.b1).kind == PrimitiveKind::kFreePoint) {
            EXPECT_EQ(c.kind, Kind::kVertexShape);
          }
        }
        // The shape turns too: by about its axis, which changes nothing.
        const Result turned = ask(*model, still(), shape, turnAboutZ(1), request);
        expectSameTimes(firstTimes(turned), truth);
        // Swapped, and a turn of both.
        const Motion motion = randomMotion(random, 1);
        Request first = request;
        first.query = ContinuousQuery::kFirst;
        const Result swapped = ask(shape, motion, *model, motion, first);
        ASSERT_EQ(swapped.is_collide, !truth.empty());
        if (swapped.is_collide) {
          EXPECT_NEAR(swapped.time_of_contact, result.time_of_contact, 2 * kTocErr);
        }
      }
    }
  }
  EXPECT_GT(kinds[static_cast<int>(Kind::kVertexShape)], 0U);
  EXPECT_GT(kinds[static_cast<int>(Kind::kEdgeShape)], 0U);
}

/// A box is its surface for what begins outside. So is a cell of an octree.
TEST(FCL_FREE_FEATURES_MOTION, boxAndCell) {
  Random random(415);
  const double side = 0.5;
  FreeBody surface;
  static_cast<MovingMesh&>(surface) = still(makeBox(V(1, 1, 1) * (side / 2)));
  auto map = std::make_shared<octomap::OcTree>(side);
  map->updateNode(octomap::point3d(0.25F, 0.25F, 0.25F), true);
  const OcTree<double> octree{std::shared_ptr<const octomap::OcTree>(map)};
  Pose shift = Pose::Identity();
  shift.translation() = -V(1, 1, 1) * (side / 2);
  for (int i = 0; i < rounds(14); ++i) {
    const FreeBody body = fallingBody(random, kBodySizes[i % 7]);
    const auto model = freeModelOf<Model>(body), mesh = freeModelOf<Model>(surface);
    for (const double distance : {0., 0.05}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      const LeafTimes truth =
          firstTimes(pairContacts(*model, *mesh, requestAt(distance)), *model);
      const Request request = requestAt(distance, CCDM_LINEAR);
      const Box<double> box(side, side, side);
      expectSameTimes(firstTimes(ask(*model, still(), box, still(), request)), truth);
      expectSameTimes(firstTimes(ask(*model, still(), octree, {shift, shift}, request)),
                      truth);
    }
  }
}

/// A plane and a halfspace meet each leaf where its lowest vertex comes to it.
TEST(FCL_FREE_FEATURES_MOTION, flats) {
  Random random(416);
  const Plane<double> plane(V::UnitZ(), 0);
  const Halfspace<double> halfspace(V::UnitZ(), 0);
  for (int i = 0; i < rounds(14); ++i) {
    const FreeBody body = fallingBody(random, kBodySizes[i % 7]);
    const auto model = freeModelOf<Model>(body);
    LeafTimes truth;
    std::intptr_t leaf = 0;
    const auto add = [&](const std::vector<std::size_t>& ids) {
      double first = 1;
      for (const std::size_t id : ids) {
        const double from = body.t0[id].z(), to = body.t1[id].z();
        first = std::min(first, from / (from - to));
      }
      truth[leaf++] = first;
    };
    for (const Triangle& t : body.triangles) add({t[0], t[1], t[2]});
    for (const FreeEdge& e : body.edges) add({e[0], e[1]});
    for (const std::size_t p : body.points) add({p});
    for (const Geometry* flat :
         {static_cast<const Geometry*>(&plane), static_cast<const Geometry*>(&halfspace)})
      expectSameTimes(
          firstTimes(ask(*model, still(), *flat, still(), requestAt(0, CCDM_LINEAR))),
          truth);
  }
}

/// Bodies of one point have boxes without size, also while they are in contact for a long
/// time.
TEST(FCL_FREE_FEATURES_MOTION, bodiesWithoutSize) {
  FreeBody point, center;
  point.t0 = point.t1 = {{1, 0, 0}};
  point.points = {0};
  center.t0 = center.t1 = {{0.9, 0, 0}};
  center.points = {0};
  const auto moving = freeModelOf<Model>(point), target = freeModelOf<Model>(center);
  const Motion turn = turnAboutZ(kPi / 2);
  const Sphere<double> ball(1.5);
  for (const ContinuousQuery query : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
    Request request = requestAt(0.3);
    request.query = query;
    for (const Geometry* other : {static_cast<const Geometry*>(target.get()),
                                  static_cast<const Geometry*>(&ball)}) {
      const Result result = ask(*moving, turn, *other, still(), request);
      EXPECT_EQ(result.time_of_contact, 0);
      EXPECT_EQ(result.contacts.size(), 1U);
    }
    // Both make the same turn.
    const Result together = ask(*moving, turn, *target, turn, request);
    EXPECT_EQ(together.time_of_contact, 0);
  }
  Request exact = requestAt(0);
  EXPECT_FALSE(ask(*moving, turn, *moving, turn, exact).is_collide);
  // A triangle without size.
  FreeBody dot = point;
  dot.points.clear();
  dot.triangles = {{0, 0, 0}};
  EXPECT_TRUE(ask(*freeModelOf<Model>(dot), turn, *freeModelOf<Model>(dot), turn, exact)
                  .is_collide);
}

/// Groups name triangles, then edges, then points. Bodies that make the same turn have
/// the contacts of bodies without it.
TEST(FCL_FREE_FEATURES_MOTION, filters) {
  Random random(417);
  std::size_t contacts = 0;
  for (int i = 0; i < rounds(14); ++i) {
    const BodySize size{2, 4, 8};
    const auto a = freeModelOf<Model>(randomBody(random, size, 0.2, OnGrid::kNever)),
               b = freeModelOf<Model>(randomBody(random, size, 0.2, OnGrid::kNever));
    const Motion motion = randomMotion(random, 1);
    for (const double distance : kDistances) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      const auto fill = [&](const Model& model, ContinuousFilter& filter) {
        const std::size_t num_leaves = static_cast<std::size_t>(model.num_tris) +
                                       model.numFreeEdges() + model.numFreePoints();
        for (std::size_t leaf = 0; leaf < num_leaves; ++leaf) {
          const auto bit = static_cast<std::uint32_t>(random.index(3));
          filter.triangle_groups.push_back(1U << bit);
          filter.triangle_masks.push_back(7U & ~(1U << random.index(3)));
        }
      };
      // The first of these rounds accepts all pairs.
      if (i > 0) {
        fill(*a, request.filter1);
        fill(*b, request.filter2);
      } else {
        request.filter1.group = request.filter1.mask = 1;
        request.filter2.group = request.filter2.mask = 1;
      }
      const NamedContacts truth = namedContacts(pairContacts(*a, *b, request), false),
                          found =
                              namedContacts(ask(*a, motion, *b, motion, request), false);
      expectSameContacts(found, truth);
      contacts += found.size();
    }
  }
  EXPECT_GT(contacts, rounds(1000U));
}

/// Filters, free parts and a distance in blocks of pairs of triangles, of which the
/// earliest contacts are kept.
TEST(FCL_FREE_FEATURES_MOTION, threadsDoNotMatter) {
  Random random(421);
  std::size_t contacts = 0;
  for (int i = 0; i < rounds(6); ++i) {
    const BodySize size{6, 8, 16};
    const auto a = freeModelOf<Model>(randomBody(random, size, 0.2, OnGrid::kNever)),
               b = freeModelOf<Model>(randomBody(random, size, 0.2, OnGrid::kNever));
    const Motion of_a = randomMotion(random, 0.5),
                 of_b{of_a.begin, of_a.begin * randomMotion(random, 0.5).begin};
    Request request = requestAt(i % 3 == 0 ? 0 : 0.08);
    if (i % 2)
      request.accepts_triangles = [](std::intptr_t x, std::intptr_t y) {
        return (x + 2 * y) % 5 < 4;
      };
    if (i % 3 == 1) request.num_max_contacts = 50;
    const Result one = ask(*a, of_a, *b, of_b, request);
    request.num_threads = 3;
    const Result three = ask(*a, of_a, *b, of_b, request);
    EXPECT_EQ(three.contacts_cut, one.contacts_cut);
    EXPECT_EQ(three.time_of_contact, one.time_of_contact);
    ASSERT_EQ(three.contacts.size(), one.contacts.size());
    for (std::size_t k = 0; k < one.contacts.size(); ++k) {
      const Contact &x = three.contacts[k], &y = one.contacts[k];
      EXPECT_EQ(x.kind, y.kind);
      EXPECT_EQ(x.vertices, y.vertices);
      EXPECT_EQ(x.b1, y.b1);
      EXPECT_EQ(x.b2, y.b2);
      EXPECT_EQ(x.toc_lo, y.toc_lo);
      EXPECT_EQ(x.toc_hi, y.toc_hi);
      EXPECT_EQ(x.pos, y.pos);
    }
    contacts += one.contacts.size();
  }
  EXPECT_GT(contacts, rounds(300U));
}

/// FCL's own rigid models, whose triangles have no owners, and models in float.
TEST(FCL_FREE_FEATURES_MOTION, rigidMeshesAndFloat) {
  Random random(419);
  const auto rigid = makeModel<BVHModel<OBBRSS<double>>>(makeIcosphere(1, 0.4));
  std::size_t contacts = 0;
  for (int i = 0; i < rounds(14); ++i) {
    const auto model =
        freeModelOf<Model>(randomBody(random, kBodySizes[i % 7], 0.3, OnGrid::kNever));
    const Motion motion = randomMotion(random, 1);
    for (const double distance : kDistances) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      const Request request = requestAt(distance);
      const NamedContacts truth =
                              namedContacts(pairContacts(*model, *rigid, request), false),
                          found = namedContacts(
                              ask(*model, motion, *rigid, motion, request), false);
      expectSameContacts(found, truth);
      contacts += found.size();
    }
  }
  EXPECT_GT(contacts, rounds(300U));

  FreeBody rod, post;
  rod.t0 = rod.t1 = {{0, 0, 0}, {2, 0, 0}};
  rod.edges = {{0, 1}};
  post.t0 = post.t1 = {{0.75, 0.75, -1}, {0.75, 0.75, 1}};
  post.edges = {{0, 1}};
  using FloatModel = DeformableBVHModel<OBBRSS<float>>;
  const auto turning = freeModelOf<FloatModel>(rod),
             standing = freeModelOf<FloatModel>(post);
  const Transform3<float> still = Transform3<float>::Identity(),
                          turned(Eigen::AngleAxisf(static_cast<float>(kPi / 2),
                                                   Vector3<float>::UnitZ()));
  ContinuousContactRequest<float> request;
  request.ccd_motion_type = CCDM_SCREW;
  ContinuousContactResult<float> result;
  continuousCollide(turning.get(), still, turned, standing.get(), still, still, request,
                    result);
  ASSERT_EQ(result.contacts.size(), 1U);
  EXPECT_EQ(result.contacts[0].kind, Kind::kEdgeEdge);
  EXPECT_NEAR(result.time_of_contact, 0.5F, 1e-6F);
}

}  // namespace
}  // namespace test
}  // namespace fcl

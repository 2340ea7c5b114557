// SPDX-License-Identifier: BSD-3-Clause
//
// Models with free edges and free points: cables, rods, points of a cloud. Against all
// pairs of features tested one by one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <new>
#include <string>

#include "allocation_failures.h"
#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/distance.h"
#include "fcl/narrowphase/safe_displacements.h"
#include "feature_distance.h"
#include "free_features.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Plain = BVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;
using Kind = ContinuousContactKind;
using detail::deformable::DistanceRequest;

Request requestAt(double distance) {
  Request request;
  request.toc_err = 1e-6;
  request.min_distance = distance;
  return request;
}

NamedContacts allPairs(const FreeBody& a, const FreeBody& b, const Request& request) {
  DistanceRequest asked;
  asked.distance = request.min_distance;
  asked.toc_err = request.toc_err;
  asked.t_max = request.t_max;
  asked.ignores_initially_closer = request.ignore_initially_closer;
  return AllPairs(a, b, asked).find();
}

/// Brackets of touching features depend on their windows: both contain the time.
void expectSame(const NamedContacts& found, const NamedContacts& truth, bool exactly) {
  if (exactly) {
    EXPECT_EQ(found, truth);
    return;
  }
  ASSERT_EQ(found.size(), truth.size());
  for (auto x = found.begin(), y = truth.begin(); x != found.end(); ++x, ++y) {
    ASSERT_EQ(x->first, y->first);
    EXPECT_LE(x->second.first, y->second.second);
    EXPECT_LE(y->second.first, x->second.second);
  }
}

TEST(FCL_FREE_FEATURES, selfAgainstAllPairs) {
  Random random(391);
  std::map<int, std::size_t> kinds;
  std::size_t later = 0;
  for (int i = 0; i < rounds(35); ++i) {
    const FreeBody body = randomBody(random, kBodySizes[i % 7], i % 2 ? 0.3 : 0.05);
    const auto model = freeModelOf<Model>(body);
    for (const double distance : kDistances)
      for (const bool ignores : {false, true}) {
        if (ignores && distance == 0) continue;
        SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
        Request request = requestAt(distance);
        request.ignore_initially_closer = ignores;
        const Result result = selfContacts<double>(*model, request);
        const NamedContacts found = namedContacts(result, true);
        expectSame(found, allPairs(body, body, request), distance > 0);
        EXPECT_EQ(result.counts.feature_pairs,
                  result.counts.box_culled + result.counts.filter_culled +
                      result.counts.solver_culled + result.counts.exact_culled +
                      result.counts.contacts);
        for (const Contact& c : result.contacts) {
          ++kinds[static_cast<int>(c.kind)];
          later += c.toc_lo > 0;
        }
      }
  }
  EXPECT_EQ(kinds.size(), 4U);
  for (const auto& [kind, count] : kinds) EXPECT_GT(count, rounds(300U)) << kind;
  EXPECT_GT(later, rounds(1000U));
}

TEST(FCL_FREE_FEATURES, pairsAgainstAllPairs) {
  Random random(392);
  std::map<int, std::size_t> kinds;
  for (int i = 0; i < rounds(35); ++i) {
    const FreeBody a = randomBody(random, kBodySizes[i % 7], 0.2),
                   b = randomBody(random, kBodySizes[(i / 7 + 3 * i) % 7], 0.2);
    const auto model_a = freeModelOf<Model>(a), model_b = freeModelOf<Model>(b);
    for (const double distance : kDistances) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      request.ignore_initially_closer = distance > 0 && i % 3 == 0;
      const Result result = pairContacts(*model_a, *model_b, request);
      const NamedContacts found = namedContacts(result, false);
      expectSame(found, allPairs(a, b, request), distance > 0);
      expectSame(namedContacts(pairContacts(*model_b, *model_a, request), false),
                 allPairs(b, a, request), distance > 0);
      for (const Contact& c : result.contacts) ++kinds[static_cast<int>(c.kind)];
    }
  }
  EXPECT_EQ(kinds.size(), 4U);
}

/// A model whose vertices are posed is read by copies.
TEST(FCL_FREE_FEATURES, posedBodies) {
  Random random(393);
  for (int i = 0; i < rounds(12); ++i) {
    const FreeBody a = randomBody(random, kBodySizes[i % 7], 0.2),
                   b = randomBody(random, kBodySizes[(i + 3) % 7], 0.2);
    FreeBody moving = a;
    // Powers of two, so that poses round nothing on the grid.
    const V from(0.25, -0.5, 0.125), to(-0.25, 0.5, 0.5);
    for (V& p : moving.t0) p += from;
    for (V& p : moving.t1) p += to;
    const auto model_a = freeModelOf<Model>(a), model_b = freeModelOf<Model>(b);
    Transform3<double> still = Transform3<double>::Identity(), begin = still, end = still;
    begin.translation() = from;
    end.translation() = to;
    for (const double distance : kDistances) {
      const Request request = requestAt(distance);
      Result result;
      continuousCollide(model_a.get(), begin, end, model_b.get(), still, still, request,
                        result);
      const NamedContacts found = namedContacts(result, false),
                          truth = allPairs(moving, b, request);
      expectSame(found, truth, distance > 0);
    }
  }
}

/// FCL's own rigid model has no owners: its features are met several times.
TEST(FCL_FREE_FEATURES, cablesAndARigidMesh) {
  Random random(394);
  const TestMesh ball = makeIcosphere(1, 0.4);
  const auto rigid = makeModel<Plain>(ball);
  FreeBody still;
  still.t0 = still.t1 = ball.vertices;
  still.triangles = ball.triangles;
  std::size_t contacts = 0;
  for (int i = 0; i < rounds(12); ++i) {
    const FreeBody body = randomBody(random, {0, 6, 20}, 0.5);
    const auto model = freeModelOf<Model>(body);
    for (const double distance : kDistances) {
      const Request request = requestAt(distance);
      const NamedContacts found =
                              namedContacts(pairContacts(*model, *rigid, request), false),
                          truth = allPairs(body, still, request);
      ASSERT_EQ(found.size(), truth.size());
      for (auto x = found.begin(), y = truth.begin(); x != found.end(); ++x, ++y) {
        ASSERT_EQ(x->first, y->first);
        EXPECT_NEAR(x->second.first, y->second.first, 1e-6);
      }
      contacts += found.size();
    }
  }
  EXPECT_GT(contacts, rounds(100U));
}

TEST(FCL_FREE_FEATURES, firstAnyFewAndThreads) {
  Random random(395);
  for (int i = 0; i < rounds(20); ++i) {
    const FreeBody body = randomBody(random, {3, 12, 30}, 0.3);
    const auto model = freeModelOf<Model>(body);
    Request request = requestAt(kDistances[i % 4]);
    const Result all = selfContacts<double>(*model, request);
    if (all.contacts.empty()) continue;
    request.num_threads = 3;
    expectIdentical(selfContacts<double>(*model, request), all);
    request.num_threads = 1;
    request.num_max_contacts = 1 + random.index(all.contacts.size());
    const Result few = selfContacts<double>(*model, request);
    ASSERT_EQ(few.contacts.size(), request.num_max_contacts);
    for (std::size_t k = 0; k < few.contacts.size(); ++k)
      EXPECT_EQ(nameOf(few.contacts[k]), nameOf(all.contacts[k]));
    request.num_max_contacts = std::numeric_limits<std::size_t>::max();
    request.query = ContinuousQuery::kFirst;
    const Result first = selfContacts<double>(*model, request);
    EXPECT_EQ(first.time_of_contact, all.time_of_contact);
    EXPECT_EQ(first.initially_crossing, all.initially_crossing);
    request.query = ContinuousQuery::kAny;
    EXPECT_TRUE(selfContacts<double>(*model, request).is_collide);
    request.query = ContinuousQuery::kAll;
    request.t_max = 0.5;
    const NamedContacts until =
        namedContacts(selfContacts<double>(*model, request), true);
    if (request.min_distance > 0) {
      expectSame(until, allPairs(body, body, request), true);
    }
  }
}

/// b1 and b2 name leaves that hold the features.
TEST(FCL_FREE_FEATURES, whatContactsName) {
  Random random(396);
  std::map<PrimitiveKind, std::size_t> seen;
  for (int i = 0; i < rounds(8); ++i) {
    const FreeBody body = randomBody(random, {3, 8, 20}, 0.2);
    const auto model = freeModelOf<Model>(body);
    ASSERT_EQ(model->numFreeEdges(), body.edges.size());
    ASSERT_EQ(model->numFreePoints(), body.points.size());
    const auto idsOf = [&](std::intptr_t b) -> std::vector<int> {
      const Primitive p = model->primitive(b);
      ++seen[p.kind];
      if (p.kind == PrimitiveKind::kFreePoint)
        return {static_cast<int>(model->freePoint(p.index))};
      if (p.kind == PrimitiveKind::kFreeEdge) {
        const FreeEdge& e = model->freeEdge(p.index);
        EXPECT_EQ(e, body.edges[p.index]);
        return {static_cast<int>(e[0]), static_cast<int>(e[1])};
      }
      const Triangle& t = model->tri_indices[p.index];
      return {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])};
    };
    for (const double distance : kDistances)
      for (const Contact& c :
           selfContacts<double>(*model, requestAt(distance)).contacts) {
        const int first = c.kind == Kind::kEdgeEdge ? 2 : 1;
        const std::vector<int> ids[2] = {idsOf(c.b1), idsOf(c.b2)};
        for (int k = 0; k < c.numVertices(); ++k) {
          const auto& holder = ids[k < first ? 0 : 1];
          EXPECT_NE(std::find(holder.begin(), holder.end(),
                              c.vertices[static_cast<std::size_t>(k)]),
                    holder.end());
        }
        if (distance > 0 && c.toc_lo > 0) {
          EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
        }
      }
  }
  EXPECT_EQ(seen.size(), 3U);
}

TEST(FCL_FREE_FEATURES, filters) {
  Random random(397);
  const FreeBody body = randomBody(random, {3, 8, 20}, 0.3);
  const auto model = freeModelOf<Model>(body);
  const std::size_t num_leaves =
      body.triangles.size() + body.edges.size() + body.points.size();
  for (const double distance : {0., 0.2}) {
    Request request = requestAt(distance);
    const std::size_t unfiltered = selfContacts<double>(*model, request).contacts.size();
    // Only free leaves against each other.
    request.filter1.triangle_masks.assign(num_leaves, 2);
    request.filter1.triangle_groups.assign(num_leaves, 2);
    std::fill_n(request.filter1.triangle_groups.begin(), body.triangles.size(), 1U);
    const Result result = selfContacts<double>(*model, request);
    EXPECT_LT(result.contacts.size(), unfiltered);
    for (const Contact& c : result.contacts)
      for (const std::intptr_t b : {c.b1, c.b2})
        EXPECT_NE(model->primitive(b).kind, PrimitiveKind::kTriangle);
    EXPECT_GT(distance == 0 ? 1 : result.contacts.size(), 0U);
    FreeBody bare = body;
    bare.triangles.clear();
    if (distance > 0) {
      const auto alone = freeModelOf<Model>(bare);
      // An edge of the sheet is there too, as a free edge.
      EXPECT_GE(selfContacts<double>(*alone, requestAt(distance)).contacts.size(),
                result.contacts.size());
    }
    request.filter1.triangle_masks.pop_back();
    Result none;
    expectRefused([&] { continuousSelfCollide(model.get(), request, none); }, "entries");
  }
}

TEST(FCL_FREE_FEATURES, aCableThroughASheet) {
  FreeBody body;
  body.t0 =
      body.t1 = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, -1}, {0.25, 0.25, 1}};
  body.triangles = {{0, 1, 2}};
  body.edges = {{3, 4}};
  const auto model = freeModelOf<Model>(body);
  Request request;
  request.enable_crossings = true;
  const Result result = selfContacts<double>(*model, request);
  EXPECT_EQ(result.time_of_contact, 0);
  ASSERT_EQ(result.crossings.size(), 1U);
  EXPECT_EQ(result.crossings[0].vertices, (std::array<int, 5>{{3, 4, 0, 1, 2}}));
  EXPECT_EQ(result.crossings[0].b1, 1);
  EXPECT_EQ(result.crossings[0].b2, 0);
  EXPECT_TRUE(result.contacts.empty());
  // Cables never cross each other: they touch.
  FreeBody cables;
  cables.t0 = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 1}, {0, 1, 1}};
  cables.t1 = {{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}};
  cables.edges = {{0, 1}, {2, 3}};
  const Result meeting = selfContacts<double>(*freeModelOf<Model>(cables));
  ASSERT_EQ(meeting.contacts.size(), 1U);
  EXPECT_EQ(meeting.contacts[0].kind, Kind::kEdgeEdge);
  EXPECT_FALSE(meeting.initially_crossing);
  EXPECT_NEAR(meeting.time_of_contact, 0.5, 1e-4);
}

/// The falling edge meets the lying one at 0.5 and the ball at 0.25; a turning one is met
/// at once.
TEST(FCL_FREE_FEATURES, inAManager) {
  FreeBody body;
  body.t0 = body.t1 = {{0, -1, 1}, {0, 1, 1}};
  body.edges = {{0, 1}};
  const auto falling = freeModelOf<Model>(body);
  body.t0 = body.t1 = {{-1, 0, 0}, {1, 0, 0}};
  const auto lying = freeModelOf<Model>(body);
  const auto rest = Transform3<double>::Identity();
  Transform3<double> below = rest, turned = rest;
  below.translation() = V(0, 0, -2);
  turned.linear() = Eigen::AngleAxisd(1, V::UnitZ()).toRotationMatrix();
  const auto straight = std::make_shared<TranslationMotion<double>>(rest, below),
             still = std::make_shared<TranslationMotion<double>>(rest, rest);
  ContinuousCollisionObject<double> a(falling, straight), b(lying, still),
      screw(lying, std::make_shared<ScrewMotion<double>>(rest, turned)),
      ball(std::make_shared<Sphere<double>>(0.5), still);
  ContinuousCollisionManager<double> manager;
  manager.registerObjects({&a, &b});
  ContinuousManagerResult<double> result;
  const auto expectTime = [&](double time) {
    manager.collide(Request(), result);
    EXPECT_TRUE(result.is_collide);
    EXPECT_NEAR(result.time_of_contact, time, 1e-4);
  };
  expectTime(0.5);
  manager.unregisterObject(&b);
  manager.registerObject(&ball);
  expectTime(0.25);
  manager.registerObject(&screw);
  expectTime(0);
}

/// Candidates are all pairs that come near, each once.
TEST(FCL_FREE_FEATURES, candidatesAreAllThatComeNear) {
  Random random(398);
  for (int i = 0; i < rounds(14); ++i) {
    const FreeBody body = randomBody(random, kBodySizes[i % 7], 0.1);
    const auto model = freeModelOf<Model>(body);
    for (const double distance : kDistances) {
      std::set<FeaturePairName> candidates;
      std::size_t count = 0;
      EXPECT_TRUE(continuousSelfCandidates(
          model.get(),
          [&](const ContinuousCandidate* block, std::size_t size) {
            for (std::size_t k = 0; k < size; ++k)
              candidates.insert(pairName(block[k], true));
            count += size;
            return true;
          },
          distance));
      EXPECT_EQ(candidates.size(), count);
      DistanceRequest asked;
      asked.distance = distance;
      asked.toc_err = 1e-6;
      std::set<FeaturePairName> possible;
      AllPairs(body, body, asked)
          .forEach([&](Kind kind, int, const auto& first, const auto& second) {
            possible.insert(pairName(kind, {true, first}, {true, second}));
          });
      for (const auto& name : candidates) EXPECT_EQ(possible.count(name), 1U);
      // A contact may be one of parts; with d = 0 it is the pair itself.
      if (distance > 0) continue;
      for (const auto& contact : AllPairs(body, body, asked).find())
        EXPECT_EQ(candidates.count(contact.first), 1U);
    }
  }
}

/// The bounds are half of the least distance of a pair.
TEST(FCL_FREE_FEATURES, safeDisplacements) {
  Random random(399);
  const double most = 0.1, d = 0.01;
  for (int i = 0; i < rounds(14); ++i) {
    const FreeBody body = randomBody(random, kBodySizes[i % 7], 0.1);
    const auto model = freeModelOf<Model>(body);
    std::vector<double> expected(body.t0.size(), most);
    DistanceRequest asked;
    asked.distance = d;
    AllPairs(body, body, asked)
        .forEach([&](Kind kind, int, std::vector<int> first, std::vector<int> second) {
          const auto at = [&](int id) { return body.t1[static_cast<std::size_t>(id)]; };
          const double distance = kind == Kind::kVertexFace
                                      ? distanceToFace(at(first[0]), at(second[0]),
                                                       at(second[1]), at(second[2]))
                                      : distanceOfEdges(at(first[0]), at(first.back()),
                                                        at(second[0]), at(second.back()));
          first.insert(first.end(), second.begin(), second.end());
          for (const int id : first) {
            double& bound = expected[static_cast<std::size_t>(id)];
            bound = std::min(bound, std::max(0., 0.5 * (distance - d)));
          }
        });
    const std::vector<double> bounds = safeSelfDisplacements(model.get(), most, d);
    ASSERT_EQ(bounds.size(), expected.size());
    for (std::size_t v = 0; v < bounds.size(); ++v)
      EXPECT_NEAR(bounds[v], expected[v], 1e-9) << v;
  }
}

TEST(FCL_FREE_FEATURES, addedAndUpdatedAsTriangles) {
  Random random(400);
  const FreeBody body = randomBody(random, {4, 9, 20}, 0.3);
  const auto whole = freeModelOf<Model>(body);
  const Request request = requestAt(0.05);
  const Result expected = selfContacts<double>(*whole, request);
  ASSERT_GT(expected.contacts.size(), 20U);
  // In two submodels, frame by frame.
  Model parts;
  ASSERT_EQ(parts.beginModel(), BVH_OK);
  ASSERT_EQ(parts.addSubModel(body.t0, body.triangles), BVH_OK);
  ASSERT_EQ(parts.addSubModel({}, {}, {}), BVH_OK);
  EXPECT_EQ(parts.endModel(FclTree::kSkip), BVH_OK);
  FreeBody twice = body;
  const std::size_t count = body.t0.size();
  for (FreeEdge& edge : twice.edges) edge = {edge[0] + count, edge[1] + count};
  for (std::size_t& point : twice.points) point += count;
  for (std::size_t v = 0; v < count; ++v) {
    twice.t0.push_back(body.t0[v]);
    twice.t1.push_back(body.t1[v]);
  }
  // A model without FCL's tree is opened again.
  ASSERT_EQ(parts.addSubModel(body.t0, {}, body.edges, body.points), BVH_OK);
  expectRefused([&] { selfContacts<double>(parts); }, "endModel");
  ASSERT_EQ(parts.endModel(), BVH_OK);
  ASSERT_EQ(parts.beginUpdateModel(), BVH_OK);
  ASSERT_EQ(parts.updateSubModel(twice.t1), BVH_OK);
  ASSERT_EQ(parts.endUpdateModel(), BVH_OK);
  EXPECT_TRUE(parts.isDeforming());
  expectSame(namedContacts(selfContacts<double>(parts, request), true),
             allPairs(twice, twice, request), true);

  // Copies are independent.
  Model copy(*whole), assigned;
  assigned = *whole;
  ASSERT_EQ(whole->beginReplaceModel(), BVH_OK);
  ASSERT_EQ(whole->replaceSubModel(body.t1), BVH_OK);
  ASSERT_EQ(whole->endReplaceModel(), BVH_OK);
  EXPECT_FALSE(whole->isDeforming());
  expectIdentical(selfContacts<double>(copy, request), expected);
  expectIdentical(selfContacts<double>(assigned, request), expected);
  EXPECT_GT(copy.deformableMemUsage(), 1000U);

  // beginModel() forgets them.
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(copy.beginModel(), BVH_ERR_BUILD_OUT_OF_SEQUENCE);
  ::testing::internal::GetCapturedStderr();
  ASSERT_EQ(copy.beginModel(), BVH_OK);
  EXPECT_EQ(copy.numFreeEdges() + copy.numFreePoints(), 0U);
  ASSERT_EQ(copy.addEdge({0, 0, 0}, {1, 0, 0}), BVH_OK);
  ASSERT_EQ(copy.addPoint({0, 0, 0.25}), BVH_OK);
  ASSERT_EQ(copy.addPoint({0, 0, 0.5}), BVH_OK);
  ASSERT_EQ(copy.endModel(), BVH_OK);
  EXPECT_EQ(copy.num_tris, 0);
  const Result small = selfContacts<double>(copy, requestAt(0.3));
  ASSERT_EQ(small.contacts.size(), 2U);
  EXPECT_EQ(small.contacts[0].kind, Kind::kVertexVertex);
  EXPECT_EQ(small.time_of_contact, 0);
  // Without a distance nothing is found where a point meets a point or an edge.
  EXPECT_FALSE(selfContacts<double>(copy).is_collide);
}

/// Cables and points fly apart, so that the tree ages.
TEST(FCL_FREE_FEATURES, restructuredTree) {
  Random random(403);
  FreeBody body = randomBody(random, {0, 60, 60}, 0);
  const auto model = freeModelOf<Model>(body);
  for (int i = 0; i < 8; ++i) {
    body.t0 = body.t1;
    V way = V::Zero();
    for (std::size_t v = 0; v < body.t1.size(); ++v) {
      // A cable has five vertices.
      if (v % 5 == 0 || v >= 300) way = random.point(1);
      body.t1[v] += way;
    }
    ASSERT_EQ(model->updateFrames(body.previous(), body.current(), body.t0.size(),
                                  FclTree::kUpdate),
              BVH_OK);
    const Request request = requestAt(0.05);
    expectSame(namedContacts(selfContacts<double>(*model, request), true),
               allPairs(body, body, request), true);
  }
  EXPECT_GT(model->numRestructurings(), 0U);
}

/// A cable that is cut, and a mesh that gets free features and loses them.
TEST(FCL_FREE_FEATURES, changeOfTopology) {
  Random random(404);
  FreeBody body = randomBody(random, {3, 6, 10}, 0.2);
  body.edges.erase(body.edges.begin() + 2);
  body.points.pop_back();
  const auto fresh = freeModelOf<Model>(body);
  const auto sheet = makeModel<Model>(makeSheet(2, 2));
  sheet->cost_density = 3;
  const Request request = requestAt(0.1);
  const auto change = [&](Model& model, const FreeBody& to) {
    return model.updateTopology(to.triangles, to.edges, to.points, to.previous(),
                                to.current(), to.t0.size());
  };
  ASSERT_EQ(change(*sheet, body), BVH_OK) << sheet->lastError();
  EXPECT_EQ(sheet->cost_density, 3);
  expectIdentical(selfContacts<double>(*sheet, request),
                  selfContacts<double>(*fresh, request));
  EXPECT_TRUE(sheet->aabb_local.contain(body.t0[5]));
  // What is refused changes nothing.
  FreeBody bad = body;
  bad.edges[0][1] = 1000;
  EXPECT_EQ(change(*sheet, bad), BVH_ERR_INCORRECT_DATA);
  EXPECT_NE(sheet->lastError().find("free edge 0"), std::string::npos);
  bad = body;
  bad.t1[7][1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(change(*sheet, bad), BVH_ERR_INCORRECT_DATA);
  EXPECT_NE(sheet->lastError().find("vertex 7 of the current"), std::string::npos);
  expectIdentical(selfContacts<double>(*sheet, request),
                  selfContacts<double>(*fresh, request));
  bad = body;
  bad.triangles.clear();
  bad.edges.clear();
  bad.points.clear();
  EXPECT_EQ(change(*sheet, bad), BVH_ERR_BUILD_EMPTY_MODEL);
  bad.triangles = body.triangles;
  ASSERT_EQ(change(*sheet, bad), BVH_OK);
  EXPECT_EQ(sheet->numFreeEdges(), 0U);
  EXPECT_EQ(sheet->updateFclTree(), BVH_OK);
}

TEST(FCL_FREE_FEATURES, inFloatAndOtherVolumes) {
  Random random(401);
  FreeBody body = randomBody(random, {3, 6, 12}, 0.25);
  for (auto* frame : {&body.t0, &body.t1})
    for (V& p : *frame) p = p.cast<float>().cast<double>();
  ContinuousContactRequest<float> request;
  request.min_distance = 0.125F;
  Request in_double = requestAt(0.125);
  in_double.toc_err = request.toc_err;
  const auto truth = allPairs(body, body, in_double);
  const auto same = [&](const auto& model) {
    using S = typename std::decay_t<decltype(*model)>::S;
    ContinuousContactRequest<S> asked;
    asked.min_distance = S(0.125);
    asked.toc_err = S(request.toc_err);
    EXPECT_EQ(namedContacts(selfContacts<S>(*model, asked), true), truth);
  };
  same(freeModelOf<DeformableBVHModel<KDOP<float, 16>>>(body));
  same(freeModelOf<DeformableBVHModel<AABB<double>>>(body));
}

TEST(FCL_FREE_FEATURES, whatIsRefused) {
  const auto expectError = [](const Model& model, int code, int expected,
                              const std::string& word) {
    EXPECT_EQ(code, expected);
    EXPECT_NE(model.lastError().find(word), std::string::npos) << model.lastError();
  };
  const std::vector<V> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Model model;
  expectError(model, model.addEdge(points[0], points[1]), BVH_ERR_BUILD_OUT_OF_SEQUENCE,
              "beginModel");
  ASSERT_EQ(model.beginModel(), BVH_OK);
  expectError(model, model.addSubModel(points, {}, {{0, 3}}), BVH_ERR_INCORRECT_DATA,
              "free edge 0 refers to vertex 3 of 3");
  expectError(model, model.addSubModel(points, {}, {{0, 1}, {2, 2}}),
              BVH_ERR_INCORRECT_DATA, "free edge 1 joins vertex 2 to itself");
  expectError(model, model.addSubModel(points, {}, {}, {0, 7}), BVH_ERR_INCORRECT_DATA,
              "free point 1 refers to vertex 7 of 3");
  EXPECT_EQ(model.num_vertices, 0);
  expectError(model, model.endModel(), BVH_ERR_BUILD_EMPTY_MODEL, "no triangles");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ASSERT_EQ(model.addPoint({nan, 0, 0}), BVH_OK);
  expectError(model, model.endModel(), BVH_ERR_INCORRECT_DATA, "vertex 0");
  model.vertices[0] = {0, 0, 3};
  ASSERT_EQ(model.addSubModel(points, {{0, 1, 2}}, {{1, 0}}), BVH_OK);
  ASSERT_EQ(model.endModel(), BVH_OK);
  // The base class began another model, which has fewer vertices.
  Model other(model);
  Plain& base = other;
  ::testing::internal::CaptureStderr();
  base.beginModel();
  ::testing::internal::GetCapturedStderr();
  ASSERT_EQ(base.beginModel(), BVH_OK);
  ASSERT_EQ(base.addSubModel({points[0], points[1]}), BVH_OK);
  expectError(other, other.endModel(), BVH_ERR_INCORRECT_DATA, "free edge 0");

  // FCL's own tree and queries.
  EXPECT_FALSE(model.isFclTreeUpToDate());
  expectError(model, model.updateFclTree(), BVH_ERR_UNSUPPORTED_FUNCTION, "free edges");
  expectError(
      model, model.updateTopology({{0, 1, 2}}, {}, points[0].data(), points[0].data(), 3),
      BVH_ERR_UNSUPPORTED_FUNCTION, "free edges");
  const auto sheet = makeModel<Model>(makeSheet(2, 2));
  const Transform3<double> still = Transform3<double>::Identity();
  CollisionResult<double> discrete;
  expectRefused([&] { collide<double>(&model, still, sheet.get(), still, {}, discrete); },
                "free edges");
  DistanceResult<double> distance;
  expectRefused(
      [&] {
        fcl::distance<double>(sheet.get(), still, &model, still,
                              fcl::DistanceRequest<double>(), distance);
      },
      "free edges");

  Result result;

  // A change through the base class: FCL knows the triangles only.
  ASSERT_EQ(base.addSubModel(points, {{0, 1, 2}}), BVH_OK);
  ASSERT_EQ(base.endModel(), BVH_OK);
  expectRefused([&] { continuousSelfCollide(&other, Request(), result); }, "base class");
  // Both frames by its own function, and it is in step again.
  ASSERT_EQ(other.updateFrames(base.vertices[0].data(), base.vertices[0].data(), 5),
            BVH_OK);
  EXPECT_NO_THROW(continuousSelfCollide(&other, Request(), result));
}

/// Memory runs out at any place: the model stays open, and can be ended.
TEST(FCL_FREE_FEATURES, withoutMemory) {
  Random random(402);
  const FreeBody body = randomBody(random, {2, 3, 6}, 0.3);
  const Request request = requestAt(0.1);
  const Result expected = [&] {
    Model model;
    model.beginModel();
    model.addSubModel(body.t0, body.triangles, body.edges, body.points);
    model.endModel();
    return selfContacts<double>(model, request);
  }();
  bool is_done = false;
  for (int i = 0; !is_done; i += 1 + i / 8) {
    Model model;
    ASSERT_EQ(model.beginModel(), BVH_OK);
    const auto tries = [&](const auto& call) {
      allocations_left = i;
      bool fails = true;
      try {
        fails = call() != BVH_OK;
      } catch (const std::bad_alloc&) {
      }
      allocations_left = -1;
      return !fails;
    };
    ::testing::internal::CaptureStderr();
    const auto add = [&] {
      return model.addSubModel(body.t0, body.triangles, body.edges, body.points);
    };
    is_done = tries(add);
    if (!is_done) {
      EXPECT_EQ(model.num_vertices, 0);
      EXPECT_EQ(model.numFreeEdges() + model.numFreePoints(), 0U);
      ASSERT_EQ(add(), BVH_OK);
    }
    const bool has_ended = tries([&] { return model.endModel(); });
    is_done &= has_ended;
    if (!has_ended) {
      ASSERT_EQ(model.endModel(), BVH_OK) << model.lastError();
    }
    ::testing::internal::GetCapturedStderr();
    expectIdentical(selfContacts<double>(model, request), expected);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

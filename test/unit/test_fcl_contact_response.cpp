// SPDX-License-Identifier: BSD-3-Clause
//
// The response of examples/contact_response.h: layers, cables and points that are thrown
// into each other. The motions that it returns are asked about again, with a model of
// their own.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <vector>

#include "contact_response.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "sanitizer.h"

namespace fcl {
namespace test {
namespace {

using contact_response::Options;
using contact_response::Positions;
using contact_response::Report;
using Model = DeformableBVHModel<>;
using Result = ContinuousContactResult<double>;
using V = Vector3<double>;

constexpr double kTime = .01;

Options optionsOf(double min_distance, int impulse_rounds) {
  Options options{};
  options.margin = 1e-3;
  options.min_distance = min_distance;
  options.impulse_rounds = impulse_rounds;
  return options;
}

/// Bodies above each other, all of one mesh, with their motion.
struct Scene {
  Positions vertices, proposed, velocities;
  std::vector<Triangle> triangles;
  std::vector<FreeEdge> edges;
  std::vector<std::size_t> points;
  std::vector<double> inverse_masses;

  /// A sheet whose vertices go anywhere, or as one obstacle.
  void addLayer(Random& random, double height, bool is_obstacle) {
    const std::size_t first = vertices.size();
    TestMesh sheet = makeSheet(3, 3);
    Transform3<double> motion = Transform3<double>::Identity();
    motion.translation() = random.point(.4);
    motion.rotate(AngleAxis<double>(random.uniform(0, 1), random.point(1).normalized()));
    for (V p : sheet.vertices) {
      p += V(0, 0, height + .05 * random.uniform(0, 1));
      vertices.push_back(p);
      proposed.push_back(is_obstacle ? V(motion * p) : V(p + random.point(.4)));
      inverse_masses.push_back(is_obstacle ? 0 : random.uniform(.2, 3));
    }
    for (const Triangle& t : sheet.triangles)
      triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
  }

  void addCable(Random& random, double height) {
    for (int i = 0; i < 6; ++i) {
      if (i > 0) edges.push_back({vertices.size() - 1, vertices.size()});
      vertices.emplace_back(.2 * i, random.uniform(.2, .8), height);
      proposed.push_back(vertices.back() + random.point(.4));
      inverse_masses.push_back(1);
    }
  }

  void addPoint(Random& random, double height) {
    points.push_back(vertices.size());
    vertices.emplace_back(random.uniform(.2, .8), random.uniform(.2, .8), height);
    proposed.push_back(vertices.back() - V(0, 0, .5));
    inverse_masses.push_back(1);
  }

  std::shared_ptr<Model> model() const {
    auto model = std::make_shared<Model>();
    EXPECT_EQ(model->beginModel(), BVH_OK);
    EXPECT_EQ(model->addSubModel(vertices, triangles, edges, points), BVH_OK);
    EXPECT_EQ(model->endModel(FclTree::kSkip), BVH_OK);
    return model;
  }

  void roundVertices() {
    for (V& p : vertices) p = V(p.cast<float>().cast<double>());
  }

  Report respond(const Options& options) {
    velocities.assign(vertices.size(), V::Zero());
    return contact_response::respond(*model(), options, inverse_masses, vertices, kTime,
                                     proposed, velocities);
  }

  /// What an exact query finds on the way.
  Result found(double min_distance) const {
    const auto fresh = model();
    EXPECT_EQ(
        fresh->updateFrames(vertices[0].data(), proposed[0].data(), vertices.size()),
        BVH_OK);
    ContinuousContactRequest<double> request;
    request.min_distance = min_distance;
    request.ignore_initially_closer = min_distance > 0;
    Result result;
    continuousSelfCollide(fresh.get(), request, result);
    return result;
  }

  V momentum() const {
    V sum = V::Zero();
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (inverse_masses[v] > 0) sum += (proposed[v] - vertices[v]) / inverse_masses[v];
    return sum;
  }

  V angularMomentum() const {
    V sum = V::Zero();
    for (std::size_t v = 0; v < vertices.size(); ++v)
      sum += vertices[v].cross(proposed[v] - vertices[v]) / inverse_masses[v];
    return sum;
  }
};

Scene layers(Random& random, int count, bool has_obstacle, bool has_cable) {
  Scene scene;
  for (int i = 0; i < count; ++i)
    scene.addLayer(random, .15 * i, has_obstacle && i == count / 2);
  if (has_cable) {
    scene.addCable(random, .15 * count);
    for (int i = 0; i < 4; ++i) scene.addPoint(random, .15 * count + .1);
  }
  return scene;
}

// Whatever is thrown, the way is free in the end: by impulses, zones, or standing still.
TEST(FCL_CONTACT_RESPONSE, wayIsFree) {
  Random random(1);
  std::size_t contacts = 0, in_zones = 0, stopped = 0, by_impulses = 0;
  for (int i = 0; i < rounds(300); ++i) {
    SCOPED_TRACE(i);
    const double min_distance = i % 3 == 0 ? .02 : 0;
    Scene scene = layers(random, 2 + i % 4, i % 2 == 0, i % 5 == 0);
    Options options = optionsOf(min_distance, i % 7);
    options.rounds_to_float = i % 4 == 1;
    if (options.rounds_to_float) scene.roundVertices();
    const Positions asked = scene.proposed;
    const Report report = scene.respond(options);
    // The obstacle has all of its way or none.
    if (!options.rounds_to_float) {
      std::size_t moved = 0, stands = 0, all = 0;
      for (std::size_t v = 0; v < asked.size(); ++v) {
        if (scene.inverse_masses[v] > 0) continue;
        ++all;
        moved += scene.proposed[v] == asked[v];
        stands += scene.proposed[v] == scene.vertices[v];
      }
      EXPECT_TRUE(moved == all || stands == all);
      EXPECT_EQ(report.has_stopped_obstacle, moved < all);
    }
    EXPECT_FALSE(report.initially_crossing);
    if (options.rounds_to_float) {
      for (V& p : scene.proposed) ASSERT_EQ(p, V(p.cast<float>().cast<double>()));
    }
    EXPECT_EQ(report.unresolved, 0U);
    const Result left = scene.found(min_distance);
    ASSERT_TRUE(left.contacts.empty());
    ASSERT_FALSE(left.initially_crossing);
    contacts += report.contacts;
    in_zones += report.in_zones;
    stopped += report.stopped;
    by_impulses += report.contacts > 0 && report.in_zones + report.stopped == 0;
  }
  EXPECT_GT(contacts, rounds(10000U));
  EXPECT_GT(in_zones, rounds(1000U));
  EXPECT_GT(by_impulses, rounds(20U));
  EXPECT_LT(20 * stopped, in_zones);
}

// Layers that fall on an obstacle and lie there: each way is free, with fewer queries if
// the pairs of the step before are known.
TEST(FCL_CONTACT_RESPONSE, memorySavesQueries) {
  int queries[2] = {0, 0};
  for (int i = 0; i < 16; ++i) {
    SCOPED_TRACE(i);
    const bool has_memory = i % 2 == 1;
    Random random(60 + i / 2);
    Scene scene;
    scene.addLayer(random, 0, true);
    for (int layer = 1; layer < 4; ++layer) scene.addLayer(random, .06 * layer, false);
    if (i % 4 < 2) scene.addCable(random, .3);
    contact_response::Memory memory;
    Positions velocities(scene.vertices.size(), V::Zero());
    for (int step = 0; step < 12; ++step) {
      const auto model = scene.model();
      for (std::size_t v = 0; v < velocities.size(); ++v) {
        if (scene.inverse_masses[v] > 0) velocities[v] -= V(0, 0, 10 * kTime);
        scene.proposed[v] = scene.vertices[v] + kTime * velocities[v];
      }
      const Report report = contact_response::respond(
          *model, optionsOf(0, 10), scene.inverse_masses, scene.vertices, kTime,
          scene.proposed, velocities, has_memory ? &memory : nullptr);
      ASSERT_EQ(report.unresolved, 0U);
      const Result left = scene.found(0);
      ASSERT_TRUE(left.contacts.empty());
      ASSERT_FALSE(left.initially_crossing);
      queries[has_memory] += report.queries;
      scene.vertices = scene.proposed;
    }
  }
  EXPECT_LT(queries[1], queries[0]);
}

// Where nothing stands still, impulses and zones keep the momentum; velocities change as
// positions do.
TEST(FCL_CONTACT_RESPONSE, momentumIsKept) {
  Random random(2);
  int moved = 0;
  for (int i = 0; i < rounds(100); ++i) {
    SCOPED_TRACE(i);
    Scene scene = layers(random, 3, false, false);
    const Positions asked = scene.proposed;
    const V before = scene.momentum();
    const Report report = scene.respond(optionsOf(0, i % 5));
    for (std::size_t v = 0; v < asked.size(); ++v)
      ASSERT_EQ(scene.velocities[v], (scene.proposed[v] - asked[v]) / kTime);
    if (report.stopped > 0) continue;
    EXPECT_LE((scene.momentum() - before).norm(), 1e-12 * (1 + before.norm()));
    moved += report.contacts > 0;
  }
  EXPECT_GT(moved, rounds(50));
}

// A zone turns: of two triangles, one is thrown against the end of an edge of the other.
TEST(FCL_CONTACT_RESPONSE, zonesTurn) {
  Scene scene;
  scene.vertices = {{-1, 0, 0},     {1, 0, 0},     {0, .1, -.5},
                    {.8, -1, .001}, {.8, 1, .001}, {.9, 0, .9}};
  scene.triangles = {{0, 1, 2}, {3, 4, 5}};
  scene.inverse_masses.assign(6, 1);
  scene.proposed = scene.vertices;
  for (std::size_t v = 3; v < 6; ++v) scene.proposed[v].z() -= .002;
  const V momentum = scene.momentum(), angular = scene.angularMomentum();
  const Report report = scene.respond(optionsOf(0, 0));
  EXPECT_GE(report.in_zones, 4U);
  EXPECT_EQ(report.stopped, 0U);
  EXPECT_TRUE(scene.found(0).contacts.empty());
  EXPECT_LE((scene.momentum() - momentum).norm(), 1e-14);
  // That of the displacements: a turn by an angle has it up to the angle's square.
  EXPECT_LE((scene.angularMomentum() - angular).norm(), .002 * angular.norm());
}

// Pairs that are within the distance at the beginning may not come nearer, not even for a
// while: zones of such pairs go straight.
TEST(FCL_CONTACT_RESPONSE, zonesOfClosePairsMove) {
  Random random(8);
  std::size_t in_zones = 0, stopped = 0;
  for (int i = 0; i < rounds(40); ++i) {
    SCOPED_TRACE(i);
    const double min_distance = .5;  // more than an edge, and than the next layer
    Scene scene = layers(random, 2, false, false);
    const V before = scene.momentum();
    const Report report = scene.respond(optionsOf(min_distance, 0));
    ASSERT_TRUE(scene.found(min_distance).contacts.empty());
    EXPECT_LE((scene.momentum() - before).norm(), 1e-12 * (1 + before.norm()));
    in_zones += report.in_zones;
    stopped += report.stopped;
  }
  EXPECT_GT(in_zones, rounds(1000U));
  EXPECT_EQ(stopped, 0U);
}

// What an obstacle pushes moves with it, without another round of impulses.
TEST(FCL_CONTACT_RESPONSE, obstaclesKeepTheirWay) {
  Random random(4);
  Scene scene;
  scene.addLayer(random, 0, false);
  scene.addLayer(random, .2, true);
  for (std::size_t v = 0; v < scene.vertices.size(); ++v)
    scene.proposed[v] = scene.vertices[v] - V(0, 0, scene.inverse_masses[v] == 0 ? 1 : 0);
  const Positions asked = scene.proposed;
  const Report report = scene.respond(optionsOf(0, 0));
  EXPECT_GT(report.contacts, 0U);
  EXPECT_FALSE(report.has_stopped_obstacle);
  EXPECT_TRUE(scene.found(0).contacts.empty());
  for (std::size_t v = 0; v < asked.size(); ++v)
    if (scene.inverse_masses[v] == 0) {
      EXPECT_EQ(scene.proposed[v], asked[v]);
    }
}

// The same for an obstacle that turns, also where its positions are rounded.
TEST(FCL_CONTACT_RESPONSE, obstaclesTurnWithWhatTheyMeet) {
  for (const bool in_float : {false, true}) {
    SCOPED_TRACE(in_float);
    Random random(7);
    Scene scene;
    scene.addLayer(random, 0, false);
    scene.addLayer(random, .2, true);
    Transform3<double> motion(AngleAxis<double>(.5, V::UnitX()));
    motion.translation() = V(0, 0, -.3);
    scene.roundVertices();
    for (std::size_t v = 0; v < scene.vertices.size(); ++v)
      scene.proposed[v] = scene.inverse_masses[v] == 0 ? V(motion * scene.vertices[v])
                                                       : scene.vertices[v];
    Options options = optionsOf(0, 0);
    options.rounds_to_float = in_float;
    const Report report = scene.respond(options);
    EXPECT_GT(report.contacts, 0U);
    EXPECT_FALSE(report.has_stopped_obstacle);
    EXPECT_EQ(report.stopped, 0U);
    EXPECT_TRUE(scene.found(0).contacts.empty());
  }
}

// Two obstacles that meet cannot both go on, and the report says so.
TEST(FCL_CONTACT_RESPONSE, obstaclesThatMeetStandStill) {
  Random random(5);
  Scene scene;
  scene.addLayer(random, 0, true);
  scene.addLayer(random, .2, true);
  for (std::size_t v = 0; v < 16; ++v) scene.proposed[v] = scene.vertices[v];
  for (std::size_t v = 16; v < 32; ++v)
    scene.proposed[v] = scene.vertices[v] - V(.1, .1, 1);
  const Report report = scene.respond(optionsOf(0, 3));
  EXPECT_TRUE(report.has_stopped_obstacle);
  EXPECT_EQ(report.stopped, 32U);
  EXPECT_EQ(scene.proposed, scene.vertices);
}

TEST(FCL_CONTACT_RESPONSE, aStateThatCrossesIsNotChanged) {
  Scene scene;
  scene.vertices = {{-1, 0, 0},   {1, 0, 0},   {0, .1, -.5},
                    {0, -1, -.2}, {0, 1, -.2}, {.1, 0, .9}};
  scene.triangles = {{0, 1, 2}, {3, 4, 5}};
  scene.inverse_masses.assign(6, 1);
  scene.proposed = scene.vertices;
  for (V& p : scene.proposed) p += V(1, 2, 3);
  const Positions asked = scene.proposed;
  EXPECT_TRUE(scene.respond(optionsOf(0, 3)).initially_crossing);
  EXPECT_EQ(scene.proposed, asked);
}

TEST(FCL_CONTACT_RESPONSE, saysWhatDoesNotFit) {
  Random random(6);
  Scene scene;
  scene.addLayer(random, 0, false);
  const auto model = scene.model();
  scene.velocities.assign(scene.vertices.size(), V(1, 2, 3));
  const Scene before = scene;
  const auto respond = [&](const Options& options, double time) {
    contact_response::respond(*model, options, scene.inverse_masses, scene.vertices, time,
                              scene.proposed, scene.velocities);
  };
  Options options = optionsOf(0, 1);
  options.margin = 0;
  EXPECT_THROW(respond(options, kTime), std::invalid_argument);
  EXPECT_THROW(respond(optionsOf(-1, 1), kTime), std::invalid_argument);
  EXPECT_THROW(respond(optionsOf(0, -1), kTime), std::invalid_argument);
  EXPECT_THROW(respond(optionsOf(0, 1), 0), std::invalid_argument);
  options = optionsOf(0, 1);
  options.rounds_to_float = true;  // but the positions are no floats
  EXPECT_THROW(respond(options, kTime), std::invalid_argument);
  scene.inverse_masses[3] = -1;
  EXPECT_THROW(respond(optionsOf(0, 1), kTime), std::invalid_argument);
  scene.inverse_masses.pop_back();
  EXPECT_THROW(respond(optionsOf(0, 1), kTime), std::invalid_argument);
  scene.inverse_masses = before.inverse_masses;
  scene.velocities.pop_back();
  EXPECT_THROW(respond(optionsOf(0, 1), kTime), std::invalid_argument);
  scene.velocities = before.velocities;
  EXPECT_EQ(scene.proposed, before.proposed);
  scene.proposed[2].x() = std::nan("");
  EXPECT_THROW(respond(optionsOf(0, 1), kTime), std::runtime_error);
  EXPECT_EQ(scene.velocities, before.velocities);
}

}  // namespace
}  // namespace test
}  // namespace fcl

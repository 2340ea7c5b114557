// SPDX-License-Identifier: BSD-3-Clause
//
//   fcl_ccd_robots [EDGES [RANDOM_EDGES]] > robots.csv
//
// Speed and errors of edges of a planner: EDGES (1,000) for each length of an arm of six
// joints and 3,264 triangles among 12 thin bars, beside discrete checks of states on the
// way. doc/broad_phase.md explains the columns. Then RANDOM_EDGES (0) edges of random
// arms are compared with states every .001 radians: the number of those that are wrong is
// printed, and is the exit status.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arm_scenes.h"
#include "fcl/broadphase/broadphase_dynamic_AABB_tree.h"
#include "fcl/broadphase/collision_robot.h"
#include "fcl/narrowphase/collision.h"
#include "machine.h"
#include "timing.h"

namespace {

using namespace fcl::test;
using Robot = fcl::CollisionRobot<double>;
using Manager = fcl::ContinuousCollisionManager<double>;
using Object = fcl::ContinuousCollisionObject<double>;
using Request = fcl::ContinuousContactRequest<double>;
using Result = fcl::RobotEdgeResult<double>;
using Edge = std::pair<JointValues, JointValues>;

/// States this far apart, in the joint that moves most, tell which edges are free.
constexpr double kTrueStep = .001;

Request requestOf(fcl::ContinuousQuery query) {
  Request request;
  request.query = query;
  request.enable_contact = false;
  return request;
}

/// Edges that begin in a state without contact, as a planner has them. All values change
/// by up to `most`, and one by that.
std::vector<Edge> edgesOf(const ArmScene& scene, double most, int count) {
  Random random(1);
  std::vector<Edge> edges;
  while (static_cast<int>(edges.size()) < count) {
    const JointValues from = randomValues(random, scene.numJoints());
    if (scene.touching(from).exist()) continue;
    JointValues to = nearValues(random, from, most);
    const std::size_t i = random.index(to.size());
    to[i] = from[i] + (random.index(2) ? most : -most);
    edges.emplace_back(from, to);
  }
  return edges;
}

/// The same edge with a manager of objects in place of a CollisionRobot.
class Objects {
 public:
  explicit Objects(const ArmScene& scene) : scene_(scene), chain_(scene.chain()) {
    for (const ArmScene::Part& part : scene.parts())
      frames_.push_back(chain_.addFixed(part.origin, part.link));
  }

  bool isFree(const Edge& edge) const {
    const fcl::ChainMotion motion(chain_, edge.first, edge.second);
    std::vector<std::unique_ptr<Object>> objects;
    std::vector<Object*> all;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      objects.push_back(
          std::make_unique<Object>(scene_.parts()[i].geometry, motion.link(frames_[i])));
      all.push_back(objects.back().get());
    }
    Manager arm;
    arm.registerObjects(all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      // A group for each link. Neighbours may touch.
      const auto group = [](std::size_t link) { return std::uint32_t{2} << link; };
      arm.setFilter(
          all[i],
          {group(i), ~(group(i) | group(i + 1) | (i > 0 ? group(i - 1) : 0)), {}, {}});
    }
    const Request request = requestOf(fcl::ContinuousQuery::kAny);
    fcl::ContinuousManagerResult<double> result;
    arm.collide(scene_.manager(), request, result);
    if (result.is_collide) return false;
    arm.collide(request, result);
    return !result.is_collide;
  }

 private:
  const ArmScene& scene_;
  fcl::JointChain chain_;
  std::vector<int> frames_;
};

/// Discrete checks with FCL's manager.
class States {
 public:
  explicit States(const ArmScene& scene) : scene_(scene) {
    for (std::size_t i = 0; i < scene.numObstacles(); ++i) {
      fcl::Transform3<double> pose;
      scene.obstacle(i)->getMotion()->getCurrentTransform(pose);
      obstacles_.push_back(std::make_unique<fcl::CollisionObject<double>>(
          std::const_pointer_cast<fcl::CollisionGeometry<double>>(
              scene.obstacle(i)->collisionGeometry()),
          pose));
      obstacles_.back()->computeAABB();
      manager_.registerObject(obstacles_.back().get());
    }
    manager_.setup();
    for (const ArmScene::Part& part : scene.parts())
      parts_.push_back(std::make_unique<fcl::CollisionObject<double>>(part.geometry));
  }

  bool isFree(const Edge& edge, double step) {
    double most = 0;
    for (std::size_t i = 0; i < edge.first.size(); ++i)
      most = std::max(most, std::abs(edge.second[i] - edge.first[i]));
    const int count = std::max(1, static_cast<int>(std::ceil(most / step - 1e-9)));
    for (int i = 0; i <= count; ++i)
      if (!isFreeAt(valuesBetween(edge.first, edge.second, double(i) / count)))
        return false;
    return true;
  }

 private:
  static bool collide(fcl::CollisionObject<double>* x, fcl::CollisionObject<double>* y,
                      void* touches) {
    const fcl::CollisionRequest<double> request;
    fcl::CollisionResult<double> result;
    return *static_cast<bool*>(touches) = fcl::collide(x, y, request, result) > 0;
  }

  bool isFreeAt(const JointValues& values) {
    const auto poses = scene_.partPoses(values);
    bool touches = false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      parts_[i]->setTransform(poses[i]);
      parts_[i]->computeAABB();
      manager_.collide(parts_[i].get(), &touches, &States::collide);
      if (touches) return false;
      for (std::size_t k = 0; k < i; ++k)
        if (scene_.areTested(i, k) &&
            parts_[i]->getAABB().overlap(parts_[k]->getAABB()) &&
            collide(parts_[i].get(), parts_[k].get(), &touches))
          return false;
    }
    return true;
  }

  const ArmScene& scene_;
  std::vector<std::unique_ptr<fcl::CollisionObject<double>>> obstacles_, parts_;
  fcl::DynamicAABBTreeCollisionManager<double> manager_;
};

/// The least time of some runs, in microseconds, and how many answers are wrong.
template <typename IsFree>
void measure(const char* method, double length, const std::vector<Edge>& edges,
             const std::vector<char>& are_free, int runs, IsFree&& is_free) {
  double least = HUGE_VAL;
  std::size_t missed = 0, extra = 0;
  for (int run = 0; run < runs; ++run) {
    missed = extra = 0;
    const double time = cpuMillisecondsOf([&] {
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool free = is_free(edges[i]);
        missed += free && !are_free[i];
        extra += !free && are_free[i];
      }
    });
    least = std::min(least, time);
  }
  const auto num_free =
      static_cast<std::size_t>(std::count(are_free.begin(), are_free.end(), 1));
  std::printf("%s,%.2f,%zu,%zu,%.2f,%zu,%zu\n", method, length, edges.size(), num_free,
              1e3 * least / double(edges.size()), missed, extra);
  std::fflush(stdout);
}

void measureArm(double length, int count) {
  ArmScene scene;
  makeSixAxisArm(scene);
  const std::vector<Edge> edges = edgesOf(scene, length, count);
  const Robot robot = scene.robot();
  States states(scene);
  std::vector<char> are_free;
  for (const Edge& edge : edges) are_free.push_back(states.isFree(edge, kTrueStep));
  std::size_t num_box_pairs = 0, num_tested = 0;
  const auto check = [&](const Edge& edge, fcl::ContinuousQuery query) {
    Result result;
    robot.checkEdge(edge.first, edge.second, &scene.manager(), requestOf(query), result);
    num_box_pairs += result.num_box_pairs;
    num_tested += result.num_tested;
    return result.is_free;
  };
  constexpr int kRuns = 15, kFewRuns = 3;
  measure("edge_any", length, edges, are_free, kRuns,
          [&](const Edge& edge) { return check(edge, fcl::ContinuousQuery::kAny); });
  measure("edge_first", length, edges, are_free, kRuns,
          [&](const Edge& edge) { return check(edge, fcl::ContinuousQuery::kFirst); });
  std::fprintf(stderr, "%.1f radians: of each %.2f box pairs %.2f are tested\n", length,
               double(num_box_pairs) / (2. * kRuns * count),
               double(num_tested) / (2. * kRuns * count));
  const Objects objects(scene);
  measure("objects_any", length, edges, are_free, kRuns,
          [&](const Edge& edge) { return objects.isFree(edge); });
  for (const double step : {.05, .01}) {
    const std::string name = step < .02 ? "states_0.01" : "states_0.05";
    measure(name.c_str(), length, edges, are_free, kFewRuns,
            [&](const Edge& edge) { return states.isFree(edge, step); });
  }
}

/// Edges that are called free, while states on the way touch.
int countWrong(int count) {
  Random random(7);
  int num_wrong = 0, num_free = 0;
  for (int i = 0; i < count;) {
    ArmScene scene;
    makeRandomArm(random, scene);
    const Robot robot = scene.robot();
    for (int k = 0; k < 10 && i < count; ++k, ++i) {
      const JointValues from = randomValues(random, scene.numJoints()),
                        to = nearValues(random, from, random.uniform(0, 1.5));
      Result result;
      const bool is_free = robot.checkEdge(
          from, to, &scene.manager(), requestOf(fcl::ContinuousQuery::kFirst), result);
      num_free += is_free;
      // Until the contact it is free too.
      const JointValues end = valuesBetween(from, to, result.time_of_contact);
      if (result.time_of_contact == 0) continue;
      const SampledContact sampled = sampledContact(scene, from, end, kTrueStep);
      // The last state is the contact itself.
      if (sampled.bodies.exist() && (is_free || sampled.t < 1 - 1e-9)) ++num_wrong;
    }
  }
  std::fprintf(stderr, "%d random edges, %d free, %d wrong\n", count, num_free,
               num_wrong);
  return num_wrong;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  std::printf("method,radians,edges,free,us_per_edge,missed,extra\n");
  for (const double length : {.2, .5, 1.}) measureArm(length, count);
  std::fprintf(stderr, "%s\n", fcl::test::machineName().c_str());
  return argc > 2 && countWrong(std::atoi(argv[2])) > 0 ? 1 : 0;
}

// SPDX-License-Identifier: BSD-3-Clause
//
// Edges of a planner in SE(3) by OMPL: a plate of 2 mm among three walls of 2 mm with
// windows, with OMPL's own validator, which asks FCL about states on the way, and with
// the continuous one. Both are compared with dense samples. Then a planner finds a way
// through the windows.
//   example_se3_edges [FILE.obj FOR THAT WAY]
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/ScopedState.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "continuous_motion_validator.h"
#include "obj_file.h"

namespace {

namespace ob = ompl::base;
using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

void addBox(Mesh& mesh, double x, double y, double z, const fcl::Vector3d& center) {
  fcl::Transform3d pose = fcl::Transform3d::Identity();
  pose.translation() = center;
  Mesh box;
  fcl::generateBVHModel(box, fcl::Boxd(x, y, z), pose);
  std::vector<fcl::Vector3d> vertices(box.vertices, box.vertices + box.num_vertices);
  std::vector<fcl::Triangle> triangles(box.tri_indices, box.tri_indices + box.num_tris);
  mesh.addSubModel(vertices, triangles);
}

/// Walls across x, each with a window at another height.
std::shared_ptr<Mesh> walls() {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  for (int i = 0; i < 3; ++i) {
    const double x = .25 + .25 * i, low = i % 2 == 0 ? .2 : .5, thin = .002;
    addBox(*mesh, thin, 1, low, {x, .5, low / 2});
    addBox(*mesh, thin, 1, .7 - low, {x, .5, (low + .3 + 1) / 2});
    addBox(*mesh, thin, .3, .3, {x, .15, low + .15});
    addBox(*mesh, thin, .3, .3, {x, .85, low + .15});
  }
  mesh->endModel();
  return mesh;
}

std::shared_ptr<Mesh> plate() {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  addBox(*mesh, .12, .12, .002, fcl::Vector3d::Zero());
  mesh->endModel();
  return mesh;
}

struct Counts {
  int free{0}, missed{0};
  double microseconds{0};
};

}  // namespace

int main(int argc, char** argv) {
  ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
  ompl::RNG::setSeed(1);
  const std::shared_ptr<Mesh> robot = plate(), environment = walls();

  auto space = std::make_shared<ob::SE3StateSpace>();
  ob::RealVectorBounds bounds(3);
  bounds.setLow(0);
  bounds.setHigh(1);
  space->setBounds(bounds);
  ompl::geometric::SimpleSetup setup(space);
  const auto isValid = [&](const ob::State* state) {
    fcl::CollisionResultd result;
    fcl::collide(robot.get(), ContinuousMotionValidator::poseOf(state), environment.get(),
                 fcl::Transform3d::Identity(), fcl::CollisionRequestd(), result);
    return !result.isCollision();
  };
  const ob::SpaceInformationPtr& information = setup.getSpaceInformation();
  setup.setStateValidityChecker(isValid);
  const auto continuous =
      std::make_shared<ContinuousMotionValidator>(information, robot, environment);
  information->setMotionValidator(continuous);
  information->setup();
  const auto discrete = std::make_shared<ob::DiscreteMotionValidator>(information);

  // Edges between valid states that lie near each other.
  const auto sampler = space->allocStateSampler();
  ob::ScopedState<ob::SE3StateSpace> from(space), to(space), between(space);
  Counts with, without;
  int colliding = 0, false_contacts = 0;
  constexpr int kEdges = 2000, kSamples = 1000;
  for (int i = 0; i < kEdges;) {
    sampler->sampleUniform(from.get());
    sampler->sampleUniformNear(to.get(), from.get(), .6);
    if (!isValid(from.get()) || !isValid(to.get())) continue;
    ++i;
    bool hits = false;
    for (int k = 1; k < kSamples && !hits; ++k) {
      space->interpolate(from.get(), to.get(), double(k) / kSamples, between.get());
      hits = !isValid(between.get());
    }
    colliding += hits;
    const auto ask = [&](const ob::MotionValidator& validator, Counts& counts) {
      const auto begin = std::chrono::steady_clock::now();
      const bool is_free = validator.checkMotion(from.get(), to.get());
      counts.microseconds +=
          1e6 *
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
              .count() /
          kEdges;
      counts.free += is_free;
      counts.missed += is_free && hits;
      return is_free;
    };
    ask(*discrete, without);
    // A contact that the samples do not see is real if they do at its time.
    std::pair<ob::State*, double> last(nullptr, 1);
    if (!ask(*continuous, with) && !hits &&
        !continuous->checkMotion(from.get(), to.get(), last)) {
      bool is_seen = false;
      for (int k = 0; k <= kSamples && !is_seen; ++k) {
        space->interpolate(from.get(), to.get(),
                           std::min(1., last.second + 1e-3 * k / kSamples),
                           between.get());
        is_seen = !isValid(between.get());
      }
      false_contacts += !is_seen;
    }
  }
  std::printf("%d edges, %d of them in contact by %d samples\n", kEdges, colliding,
              kSamples);
  std::printf("states on the way: %3d called free, %2d of them wrong, %.0f us an edge\n",
              without.free, without.missed, without.microseconds);
  std::printf(
      "continuous:        %3d called free, %2d of them wrong, %d false, %.0f us an "
      "edge\n",
      with.free, with.missed, false_contacts, with.microseconds);

  // A way through all windows.
  ob::ScopedState<ob::SE3StateSpace> start(space), goal(space);
  start->setXYZ(.1, .5, .5);
  start->rotation().setIdentity();
  goal->setXYZ(.9, .5, .5);
  goal->rotation().setIdentity();
  setup.setStartAndGoalStates(start, goal);
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(information));
  const bool is_found = setup.solve(20.) == ob::PlannerStatus::EXACT_SOLUTION;
  std::printf("a way of %zu states: %s\n",
              is_found ? setup.getSolutionPath().getStateCount() : 0,
              is_found ? "found, and proved to be free" : "not found");
  if (is_found && argc > 1) {
    ObjFile file;
    const auto add = [&](const Mesh& mesh, const fcl::Transform3d& pose) {
      file.addMesh(
          std::vector<fcl::Vector3d>(mesh.vertices, mesh.vertices + mesh.num_vertices),
          std::vector<fcl::Triangle>(mesh.tri_indices, mesh.tri_indices + mesh.num_tris),
          pose);
    };
    add(*environment, fcl::Transform3d::Identity());
    ompl::geometric::PathGeometric way = setup.getSolutionPath();
    way.interpolate(60);
    for (const ob::State* state : way.getStates())
      add(*robot, ContinuousMotionValidator::poseOf(state));
    file.write(argv[1]);
  }
  return without.missed > 0 && with.missed == 0 && false_contacts == 0 && is_found ? 0
                                                                                   : 1;
}

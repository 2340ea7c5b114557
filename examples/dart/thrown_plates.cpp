// SPDX-License-Identifier: BSD-3-Clause
//
// Plates of 1 mm that are thrown at a plate of 1 mm, in steps of 1 ms: with
// dart::simulation::World::step(), and with the continuous step around it. Then chains of
// three such plates, and plates that fall onto it and each other and come to rest.
//   example_thrown_plates [THROWS] [FOLDER FOR WHERE THEY ARE IN THE END]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "continuous_step.h"
#include "obj_file.h"

namespace {

using namespace dart;

constexpr double kSkin = 1e-4;

void addBox(dynamics::BodyNode* body, const Eigen::Vector3d& size, double mass) {
  const auto shape = std::make_shared<dynamics::BoxShape>(size);
  body->createShapeNodeWith<dynamics::VisualAspect, dynamics::CollisionAspect,
                            dynamics::DynamicsAspect>(shape);
  dynamics::Inertia inertia;
  inertia.setMass(mass);
  inertia.setMoment(shape->computeInertia(mass));
  body->setInertia(inertia);
}

dynamics::SkeletonPtr target() {
  auto plate = dynamics::Skeleton::create("target");
  addBox(plate->createJointAndBodyNodePair<dynamics::WeldJoint>().second, {1, 1, .001},
         1);
  plate->setMobile(false);
  return plate;
}

/// Plates, each linked to the one before by a hinge.
dynamics::SkeletonPtr thrown(int links) {
  auto chain = dynamics::Skeleton::create("thrown");
  dynamics::BodyNode* body =
      chain->createJointAndBodyNodePair<dynamics::FreeJoint>().second;
  addBox(body, {.1, .1, .001}, .05);
  for (int i = 1; i < links; ++i) {
    dynamics::RevoluteJoint::Properties hinge;
    hinge.mName = "hinge " + std::to_string(i);
    hinge.mAxis = Eigen::Vector3d::UnitY();
    hinge.mDampingCoefficients[0] = 2e-3;
    hinge.mT_ParentBodyToJoint.translation() << .055, 0, 0;
    hinge.mT_ChildBodyToJoint.translation() << -.055, 0, 0;
    body = chain
               ->createJointAndBodyNodePair<dynamics::RevoluteJoint>(
                   body, hinge,
                   dynamics::BodyNode::AspectProperties("plate " + std::to_string(i)))
               .second;
    addBox(body, {.1, .1, .001}, .05);
  }
  return chain;
}

struct Outcome {
  int passed{0};
  double milliseconds{0};  // a step
};

Outcome throwPlates(double speed, int links, int throws, bool is_continuous,
                    const std::string& folder) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Outcome outcome;
  int steps = 0;
  double seconds = 0;
  ObjFile last;
  last.addPlate(1, 1, Eigen::Isometry3d::Identity());
  for (int i = 0; i < throws; ++i) {
    const auto world = simulation::World::create();
    world->setTimeStep(1e-3);
    world->setGravity(Eigen::Vector3d::Zero());
    world->addSkeleton(target());
    const auto plate = thrown(links);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << .2 * uniform(random), .2 * uniform(random), .15;
    pose.rotate(Eigen::AngleAxisd(.3 * uniform(random), Eigen::Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(.3 * uniform(random), Eigen::Vector3d::UnitY()));
    auto* joint = static_cast<dynamics::FreeJoint*>(plate->getJoint(0));
    joint->setTransform(pose);
    const Eigen::Vector3d spin(3 * uniform(random), 3 * uniform(random),
                               3 * uniform(random));
    joint->setLinearVelocity({0, 0, -speed});
    joint->setAngularVelocity(spin);
    world->addSkeleton(plate);
    ContinuousStep continuous(world, kSkin);
    const int count = static_cast<int>(.3 / speed / 1e-3) + 20;
    const auto begin = std::chrono::steady_clock::now();
    for (int step = 0; step < count; ++step)
      if (is_continuous)
        continuous.step();
      else
        world->step();
    seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    steps += count;
    bool has_passed = false;
    for (const dynamics::BodyNode* body : plate->getBodyNodes()) {
      has_passed |= !(body->getCOM().z() >= 0);
      last.addPlate(.1, .1, body->getWorldTransform());
    }
    outcome.passed += has_passed;
  }
  outcome.milliseconds = 1e3 * seconds / steps;
  if (!folder.empty())
    last.write(folder + "/plates_" + std::to_string(links) + "_" +
               std::to_string(static_cast<int>(speed)) +
               (is_continuous ? "_with.obj" : "_without.obj"));
  return outcome;
}

struct Rest {
  int passed{0};
  /// Of the plates that lie there in the end, in joule.
  double kinetic{0};
  /// Steps of the last second in which a way was cut.
  int cut{0};
  double milliseconds{0};  // a step
};

bool isAbove(const dynamics::Skeleton& plate) { return plate.getCOM().z() >= 0; }
/// Some plates slide over the border.
bool isOver(const dynamics::Skeleton& plate) {
  const Eigen::Vector3d place = plate.getCOM();
  return std::abs(place.x()) < .45 && std::abs(place.y()) < .45;
}

/// Plates come down one after the other, with gravity, and lie on each other.
Rest pilePlates(int count, bool is_continuous) {
  constexpr int kSteps = 3000, kLast = 1000;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto world = simulation::World::create();
  world->setTimeStep(1e-3);
  world->addSkeleton(target());
  std::vector<dynamics::SkeletonPtr> plates;
  for (int i = 0; i < count; ++i) {
    plates.push_back(thrown(1));
    plates.back()->setName("plate " + std::to_string(i));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << .1 * uniform(random), .1 * uniform(random), .3 + .4 * i;
    pose.rotate(Eigen::AngleAxisd(.5 * uniform(random), Eigen::Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(.5 * uniform(random), Eigen::Vector3d::UnitY()));
    auto* joint = static_cast<dynamics::FreeJoint*>(plates.back()->getJoint(0));
    joint->setTransform(pose);
    joint->setLinearVelocity({0, 0, -5});
    world->addSkeleton(plates.back());
  }
  ContinuousStep continuous(world, kSkin);
  Rest out;
  std::set<dynamics::SkeletonPtr> passed;
  const auto begin = std::chrono::steady_clock::now();
  for (int step = 0; step < kSteps; ++step) {
    int cuts = 0;
    if (is_continuous)
      cuts = continuous.step();
    else
      world->step();
    if (step >= kSteps - kLast && cuts > 0) ++out.cut;
    for (const auto& plate : plates)
      if (isOver(*plate) && !isAbove(*plate)) passed.insert(plate);
  }
  out.milliseconds =
      1e3 / kSteps *
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const auto& plate : plates)
    if (isAbove(*plate)) out.kinetic += plate->computeKineticEnergy();
  out.passed = static_cast<int>(passed.size());
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const int throws = argc > 1 ? std::atoi(argv[1]) : 10;
  const std::string folder = argc > 2 ? argv[2] : "";
  int passed = 0, passed_before = 0;
  for (const int links : {1, 3})
    for (const double speed : {2., 5., 10.}) {
      const Outcome without = throwPlates(speed, links, throws, false, folder),
                    with = throwPlates(speed, links, throws, true, folder);
      std::printf(
          "%d plates, %2.0f m/s: %d of %d pass through; with the continuous step %d; "
          "%.3f and %.3f ms a step\n",
          links, speed, without.passed, throws, with.passed, without.milliseconds,
          with.milliseconds);
      passed_before += without.passed;
      passed += with.passed;
    }
  // DART takes long for plates that lie in each other.
  const int pile = throws < 20 ? 4 : 10;
  const Rest without = pilePlates(pile, false), with = pilePlates(pile, true);
  std::printf(
      "%d plates fall: %d pass through, at last %.1e J; with the continuous step %d, "
      "%.1e J, %d of the last 1000 steps cut; %.3f and %.3f ms a step\n",
      pile, without.passed, without.kinetic, with.passed, with.kinetic, with.cut,
      without.milliseconds, with.milliseconds);
  passed += with.passed;
  return passed_before > 0 && passed == 0 && with.kinetic < 1e-3 ? 0 : 1;
}

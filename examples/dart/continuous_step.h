// SPDX-License-Identifier: BSD-3-Clause
//
// Continuous collision detection around dart::simulation::World::step(), to copy into a
// simulation. DART looks for contacts where bodies are at the beginning of a step. So
// thin and fast bodies pass through each other, and of those that overlap a little some
// are pushed out on the wrong side.
//
// Here each body has a core: the body without a skin. Skins may overlap, so that DART
// finds contacts and answers them, with friction and at rest. Cores never meet: the way
// of each pair of skeletons in the step is asked about, and where two cores would meet,
// both go only as far as they are free. In the next step DART sees their skins overlap.
//
// A body that is not in a chain moves in a step of DART by a constant twist. FCL calls
// this path CCDM_SCREW. For a body in a chain of joints it is one of the paths between
// the same poses, which is near the true one in a short step. Bodies of one skeleton are
// left to DART.
#ifndef CONTINUOUS_STEP_H
#define CONTINUOUS_STEP_H

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fcl/geometry/compound_geometry.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_contact.h>

#include <dart/dart.hpp>

class ContinuousStep {
 public:
  /// @param skin  in metres, a tenth of the thickness of the thinnest body for example
  ContinuousStep(dart::simulation::WorldPtr world, double skin)
      : world_(std::move(world)), skin_(skin) {
    for (std::size_t i = 0; i < world_->getNumSkeletons(); ++i) {
      const auto skeleton = world_->getSkeleton(i);
      ways_.push_back({skeleton, {}, 1, false});
      for (dart::dynamics::BodyNode* node : skeleton->getBodyNodes()) add(node, i);
    }
  }

  /// World::step(), in which the cores of no two skeletons meet. @return how often a way
  /// was cut
  int step() {
    for (Way& way : ways_) {
      way.begin = way.skeleton->getPositions();
      way.share = 1;
    }
    for (Body& body : bodies_) body.begin = body.node->getWorldTransform();
    world_->step();
    for (Body& body : bodies_) body.end = body.node->getWorldTransform();
    int count = 0;
    for (Contact first; findFirst(first); ++count) {
      // A little before the contact. After many cuts bodies stand still for this step:
      // two that stand do not meet.
      const double part = count < kCuts ? .999 * first.time : 0;
      for (const Body* body : {first.a, first.b}) cut(ways_[body->way], part);
    }
    for (Way& way : ways_) slowDown(way);
    return count;
  }

 private:
  /// Of one step.
  static constexpr int kCuts = 32;

  /// How a skeleton moves in the step.
  struct Way {
    dart::dynamics::SkeletonPtr skeleton;
    Eigen::VectorXd begin;
    /// The part of the step for which it goes with its velocities.
    double share;
    /// In the step before.
    bool was_cut;

    bool moves() const { return skeleton->isMobile() && skeleton->getNumDofs() > 0; }
  };
  struct Body {
    dart::dynamics::BodyNode* node;
    std::size_t way;
    std::shared_ptr<fcl::CollisionGeometryd> core;
    Eigen::Isometry3d begin, end;
  };

  void cut(Way& way, double part) {
    if (!way.moves()) return;
    way.share *= part;
    way.skeleton->setPositions(way.begin);
    if (way.share > 0)
      way.skeleton->integratePositions(way.share * world_->getTimeStep());
    for (Body& body : bodies_)
      if (&ways_[body.way] == &way)
        body.end = way.share > 0 ? body.node->getWorldTransform() : body.begin;
  }

  /// DART answers a contact in the step after the cut. A body whose way is cut again is
  /// held, by others or between them: it has the velocity with which it went.
  static void slowDown(Way& way) {
    const bool is_cut = way.share < 1;
    if (is_cut && way.was_cut)
      way.skeleton->setVelocities(way.share * way.skeleton->getVelocities());
    way.was_cut = is_cut;
  }

  std::shared_ptr<fcl::CollisionGeometryd> coreOf(
      const dart::dynamics::Shape& shape) const {
    using namespace dart::dynamics;
    const double r = skin_, d = 2 * skin_;
    if (const auto* box = dynamic_cast<const BoxShape*>(&shape))
      return std::make_shared<fcl::Boxd>(box->getSize() - Eigen::Vector3d::Constant(d));
    if (const auto* sphere = dynamic_cast<const SphereShape*>(&shape))
      return std::make_shared<fcl::Sphered>(sphere->getRadius() - r);
    if (const auto* ellipsoid = dynamic_cast<const EllipsoidShape*>(&shape))
      return std::make_shared<fcl::Ellipsoidd>(ellipsoid->getRadii() -
                                               Eigen::Vector3d::Constant(r));
    if (const auto* capsule = dynamic_cast<const CapsuleShape*>(&shape))
      return std::make_shared<fcl::Capsuled>(capsule->getRadius() - r,
                                             capsule->getHeight());
    if (const auto* cylinder = dynamic_cast<const CylinderShape*>(&shape))
      return std::make_shared<fcl::Cylinderd>(cylinder->getRadius() - r,
                                              cylinder->getHeight() - d);
    // Yours, for example a mesh as fcl::BVHModel.
    throw std::invalid_argument("ContinuousStep has no geometry for " + shape.getType());
  }

  /// A body node, if it has shapes that collide: several of them are a compound.
  void add(dart::dynamics::BodyNode* node, std::size_t way) {
    const auto shapes = node->getShapeNodesWith<dart::dynamics::CollisionAspect>();
    if (shapes.empty()) return;
    const bool is_at_origin =
        shapes.size() == 1 &&
        shapes[0]->getRelativeTransform().isApprox(Eigen::Isometry3d::Identity());
    std::shared_ptr<fcl::CollisionGeometryd> core;
    if (is_at_origin) {
      core = coreOf(*shapes[0]->getShape());
    } else {
      auto parts = std::make_shared<fcl::CompoundGeometryd>();
      for (const dart::dynamics::ShapeNode* shape : shapes)
        parts->addPart(coreOf(*shape->getShape()), shape->getRelativeTransform());
      core = parts;
    }
    bodies_.push_back({node, way, core, {}, {}});
  }

  struct Contact {
    double time{1};
    const Body *a{nullptr}, *b{nullptr};
  };

  /// Whether the cores of two bodies meet, or come nearer than they are by less than a
  /// hundredth of the skin.
  bool meet(const Body& a, const Body& b, Contact& contact) const {
    if (a.begin.isApprox(a.end, 0) && b.begin.isApprox(b.end, 0)) return false;
    fcl::ContinuousContactRequestd request;
    request.query = fcl::ContinuousQuery::kFirst;
    request.enable_contact = false;
    request.ccd_motion_type = fcl::CCDM_SCREW;
    request.toc_err = 1e-3;
    request.min_distance = .01 * skin_;
    request.ignore_initially_closer = true;
    fcl::ContinuousContactResultd result;
    fcl::continuousCollide(a.core.get(), a.begin, a.end, b.core.get(), b.begin, b.end,
                           request, result);
    contact = {result.time_of_contact, &a, &b};
    if (!result.is_collide || contact.time > 0) return result.is_collide;
    // Cores that overlap at the beginning, where a scene begins so, are left to DART.
    fcl::CollisionResultd overlap;
    fcl::collide(a.core.get(), a.begin, b.core.get(), b.begin, fcl::CollisionRequestd(),
                 overlap);
    return !overlap.isCollision();
  }

  bool findFirst(Contact& first) const {
    bool is_found = false;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        Contact contact;
        if (bodies_[i].way == bodies_[j].way || !meet(bodies_[i], bodies_[j], contact))
          continue;
        if (!is_found || contact.time < first.time) first = contact;
        is_found = true;
      }
    return is_found;
  }

  dart::simulation::WorldPtr world_;
  double skin_;
  std::vector<Way> ways_;
  std::vector<Body> bodies_;
};

#endif

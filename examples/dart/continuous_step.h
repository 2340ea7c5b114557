// SPDX-License-Identifier: BSD-3-Clause
//
// Continuous collision detection around dart::simulation::World::step(), to copy into a
// simulation. DART looks for contacts where bodies are at the beginning of a step. So
// thin and fast bodies pass through each other, and of those that overlap a little some
// are pushed out on the wrong side. Here the way of each pair of skeletons in the step is
// asked about. At the first time at which two come within a margin, an impulse takes
// their approach away, and the rest of the step begins there.
//
// A body that is not in a chain moves in a step of DART by a constant twist. FCL calls
// this path CCDM_SCREW. For a body in a chain of joints it is one of the paths between
// the same poses, which is near the true one in a short step. Bodies of one skeleton are
// left to DART.
#ifndef CONTINUOUS_STEP_H
#define CONTINUOUS_STEP_H

#include <algorithm>
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
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_contact.h>

#include <dart/dart.hpp>

class ContinuousStep {
 public:
  /// @param margin  in metres, below the thickness of the bodies
  ContinuousStep(dart::simulation::WorldPtr world, double margin)
      : world_(std::move(world)), margin_(margin) {
    for (std::size_t i = 0; i < world_->getNumSkeletons(); ++i)
      for (dart::dynamics::BodyNode* node : world_->getSkeleton(i)->getBodyNodes())
        add(node);
  }

  /// World::step(), in which no two skeletons that are apart come nearer than the margin.
  /// Those that overlap at the beginning are left to DART. @return the number of contacts
  int step() {
    setBegin();
    world_->step();
    double rest = world_->getTimeStep();
    for (Body& body : bodies_) body.end = body.node->getWorldTransform();
    int count = 0;
    Contact first;
    for (; count < kContacts; ++count) {
      if (!findFirst(first)) return count;
      // A little before the contact, so that the way until then is free.
      const double way = .999 * first.time * rest;
      moveFromBegin(way);
      setBegin();
      push(first);
      rest -= way;
      moveFromBegin(rest);
    }
    // What still meets stands still for the rest. Two that stand do not meet.
    for (; findFirst(first); ++count)
      for (Body* body : {first.a, first.b}) {
        const auto skeleton = body->node->getSkeleton();
        if (!moves(skeleton)) continue;
        skeleton->setPositions(body->positions);
        for (Body& other : bodies_)
          if (other.node->getSkeleton() == skeleton) other.end = other.begin;
      }
    return count;
  }

 private:
  /// The most contacts that a step answers.
  static constexpr int kContacts = 16;

  struct Body {
    dart::dynamics::BodyNode* node;
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
    Eigen::Isometry3d begin, end;  // of the step, or of its rest
    Eigen::VectorXd positions;     // of its skeleton, at the beginning
  };

  static bool moves(const dart::dynamics::ConstSkeletonPtr& skeleton) {
    return skeleton->isMobile() && skeleton->getNumDofs() > 0;
  }

  void setBegin() {
    for (Body& body : bodies_) {
      body.begin = body.node->getWorldTransform();
      body.positions = body.node->getSkeleton()->getPositions();
    }
  }

  /// Moves all from the beginning, for a time, by the velocities that they have.
  void moveFromBegin(double time) {
    dart::dynamics::SkeletonPtr last;
    for (Body& body : bodies_) {
      const auto skeleton = body.node->getSkeleton();
      if (skeleton != last && moves(skeleton)) {
        skeleton->setPositions(body.positions);
        skeleton->integratePositions(time);
      }
      last = skeleton;
      body.end = body.node->getWorldTransform();
    }
  }

  static std::shared_ptr<fcl::CollisionGeometryd> geometryOf(
      const dart::dynamics::Shape& shape) {
    using namespace dart::dynamics;
    if (const auto* box = dynamic_cast<const BoxShape*>(&shape))
      return std::make_shared<fcl::Boxd>(box->getSize());
    if (const auto* sphere = dynamic_cast<const SphereShape*>(&shape))
      return std::make_shared<fcl::Sphered>(sphere->getRadius());
    if (const auto* ellipsoid = dynamic_cast<const EllipsoidShape*>(&shape))
      return std::make_shared<fcl::Ellipsoidd>(ellipsoid->getRadii());
    if (const auto* capsule = dynamic_cast<const CapsuleShape*>(&shape))
      return std::make_shared<fcl::Capsuled>(capsule->getRadius(), capsule->getHeight());
    if (const auto* cylinder = dynamic_cast<const CylinderShape*>(&shape))
      return std::make_shared<fcl::Cylinderd>(cylinder->getRadius(),
                                              cylinder->getHeight());
    // Yours, for example a mesh as fcl::BVHModel.
    throw std::invalid_argument("ContinuousStep has no geometry for " + shape.getType());
  }

  /// A body node, if it has shapes that collide: several of them are a compound.
  void add(dart::dynamics::BodyNode* node) {
    fcl::CompoundGeometryd compound;
    std::shared_ptr<fcl::CollisionGeometryd> only;
    int count = 0;
    for (dart::dynamics::ShapeNode* shape :
         node->getShapeNodesWith<dart::dynamics::CollisionAspect>()) {
      only = geometryOf(*shape->getShape());
      compound.addPart(only, shape->getRelativeTransform());
      ++count;
    }
    if (count == 0) return;
    const bool is_at_origin =
        count == 1 && node->getShapeNodesWith<dart::dynamics::CollisionAspect>()[0]
                          ->getRelativeTransform()
                          .isApprox(Eigen::Isometry3d::Identity());
    if (!is_at_origin) only = std::make_shared<fcl::CompoundGeometryd>(compound);
    bodies_.push_back({node, only, {}, {}, {}});
  }

  struct Contact {
    double time;
    Body *a, *b;
    Eigen::Vector3d point, normal;  // from a to b
  };

  /// Whether the two, apart at the beginning, come within the margin.
  bool meet(Body& a, Body& b, Contact& contact) const {
    if (a.begin.isApprox(a.end, 0) && b.begin.isApprox(b.end, 0)) return false;
    fcl::ContinuousContactRequestd request;
    request.query = fcl::ContinuousQuery::kFirst;
    request.ccd_motion_type = fcl::CCDM_SCREW;
    request.toc_err = 1e-3;
    request.min_distance = margin_;
    request.ignore_initially_closer = true;
    fcl::ContinuousContactResultd result;
    fcl::continuousCollide(a.geometry.get(), a.begin, a.end, b.geometry.get(), b.begin,
                           b.end, request, result);
    if (!result.is_collide || result.time_of_contact == 0) return false;
    const auto& first = result.contacts[0];
    contact = {result.time_of_contact, &a, &b, first.pos, first.normal};
    return true;
  }

  bool findFirst(Contact& first) {
    bool is_found = false;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        Contact contact;
        if (bodies_[i].node->getSkeleton() == bodies_[j].node->getSkeleton() ||
            !meet(bodies_[i], bodies_[j], contact))
          continue;
        if (!is_found || contact.time < first.time) first = contact;
        is_found = true;
      }
    return is_found;
  }

  /// The impulse along the normal after which the two do not approach each other there.
  static void push(const Contact& contact) {
    double approach = 0, mobility = 0;
    const auto each = [&contact](const auto& call) {
      for (const int sign : {1, -1}) {
        dart::dynamics::BodyNode* node = (sign > 0 ? contact.a : contact.b)->node;
        const Eigen::Isometry3d inverse = node->getWorldTransform().inverse();
        const Eigen::Vector3d point = inverse * contact.point,
                              force = inverse.linear() * (sign * contact.normal);
        Eigen::Vector6d along;
        along << point.cross(force), force;
        call(node, along);
      }
    };
    each([&](dart::dynamics::BodyNode* node, const Eigen::Vector6d& along) {
      approach += along.dot(node->getSpatialVelocity());
      const auto skeleton = node->getSkeleton();
      if (!moves(skeleton)) return;
      skeleton->clearConstraintImpulses();
      node->getArticulatedInertia();  // computed for the positions where it stopped
      skeleton->updateBiasImpulse(node, along);
      skeleton->updateVelocityChange();
      mobility += along.dot(node->getBodyVelocityChange());
      skeleton->clearConstraintImpulses();
    });
    if (!(approach > 0) || !(mobility > 0)) return;
    each([&](dart::dynamics::BodyNode* node, const Eigen::Vector6d& along) {
      const auto skeleton = node->getSkeleton();
      if (!moves(skeleton)) return;
      node->addConstraintImpulse(-approach / mobility * along);
      skeleton->computeImpulseForwardDynamics();
      skeleton->clearConstraintImpulses();
      skeleton->clearInternalForces();  // to which DART has added the impulse
    });
  }

  dart::simulation::WorldPtr world_;
  double margin_;
  std::vector<Body> bodies_;
};

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// A motion validator for OMPL, to copy into a planner: of a rigid body in SE(3), whose
// answer is a proof. Between two states OMPL moves the origin of the body straight and
// turns it at a constant rate. FCL calls this path CCDM_LINEAR; the continuous query
// takes all of it, not samples.
#ifndef CONTINUOUS_MOTION_VALIDATOR_H
#define CONTINUOUS_MOTION_VALIDATOR_H

#include <algorithm>
#include <memory>
#include <utility>

#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_contact.h>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/SE3StateSpace.h>

class ContinuousMotionValidator : public ompl::base::MotionValidator {
 public:
  using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;

  /// @param robot  a mesh, a shape or a CompoundGeometry, in the frame of the states
  /// @param environment  the same, at its place; it does not move
  ContinuousMotionValidator(const ompl::base::SpaceInformationPtr& space, Geometry robot,
                            Geometry environment)
      : MotionValidator(space),
        robot_(std::move(robot)),
        environment_(std::move(environment)) {}

  /// Whether the way is free and the state at its end valid. Touching is not free.
  bool checkMotion(const ompl::base::State* from,
                   const ompl::base::State* to) const override {
    const bool is_free =
        si_->isValid(to) && timeOfContact(from, to, fcl::ContinuousQuery::kAny) > 1;
    ++(is_free ? valid_ : invalid_);
    return is_free;
  }

  /// The same. If it is not free, last_valid is a state a little before the contact, and
  /// its time.
  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to,
                   std::pair<ompl::base::State*, double>& last_valid) const override {
    const double toc = timeOfContact(from, to, fcl::ContinuousQuery::kFirst);
    const bool is_free = toc > 1 && si_->isValid(to);
    ++(is_free ? valid_ : invalid_);
    if (is_free) return true;
    last_valid.second = .999 * std::min(toc, 1.);
    if (last_valid.first != nullptr)
      si_->getStateSpace()->interpolate(from, to, last_valid.second, last_valid.first);
    return false;
  }

  /// The pose of a state.
  static fcl::Transform3d poseOf(const ompl::base::State* state) {
    const auto* pose = state->as<ompl::base::SE3StateSpace::StateType>();
    const auto& q = pose->rotation();
    fcl::Transform3d out = fcl::Transform3d::Identity();
    out.linear() = fcl::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
    out.translation() << pose->getX(), pose->getY(), pose->getZ();
    return out;
  }

 private:
  /// 2 if there is no contact.
  double timeOfContact(const ompl::base::State* from, const ompl::base::State* to,
                       fcl::ContinuousQuery query) const {
    fcl::ContinuousContactRequestd request;
    request.query = query;
    request.ccd_motion_type = fcl::CCDM_LINEAR;
    request.enable_contact = false;
    fcl::ContinuousContactResultd result;
    const fcl::Transform3d stays = fcl::Transform3d::Identity();
    fcl::continuousCollide(robot_.get(), poseOf(from), poseOf(to), environment_.get(),
                           stays, stays, request, result);
    return result.is_collide ? result.time_of_contact : 2;
  }

  Geometry robot_, environment_;
};

#endif

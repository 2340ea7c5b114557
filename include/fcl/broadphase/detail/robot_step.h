// SPDX-License-Identifier: BSD-3-Clause
//
// The border between CollisionRobot, which is compiled with the program, and the library:
// see query_numbers.h.
#ifndef FCL_BROADPHASE_DETAIL_ROBOT_STEP_H
#define FCL_BROADPHASE_DETAIL_ROBOT_STEP_H

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/swept_collision_object.h"
#include "fcl/math/motion/joint_chain.h"

namespace fcl {
namespace detail {

/// @brief A geometry of a robot, as the library has read it.
template <typename S>
class RobotPart;
template <typename S>
using RobotPartPtr = std::shared_ptr<const RobotPart<S>>;

/// @brief Reads a geometry.
/// @param link  a link of the tree, or -1: the base
/// @param origin  the frame of the geometry in that of the link
/// @param geometry  lives as long as the part
/// @param name  of the part in errors
/// @throws fcl::Exception  the library does not answer such a geometry; what queries
/// throw of it; the origin is no rotation and translation
template <typename S>
FCL_EXPORT RobotPartPtr<S> makeRobotPart(const JointTreePtr& tree, int link,
                                         const BoundedMotion::Placement& origin,
                                         const CollisionGeometry<S>* geometry,
                                         const std::string& name);

/// @brief How two links move relative to each other.
enum class LinkRelation {
  kFixed,       ///< not at all
  kNeighbours,  ///< one of them carries the joint that moves the other one
  kApart
};
/// @param link1, link2  of the tree, or -1: the base
FCL_EXPORT LinkRelation linkRelation(const JointTreePtr& tree, int link1, int link2);

/// @brief The joint values at t.
FCL_EXPORT std::vector<double> jointValuesAt(const ChainPathPtr& chain, double t);
FCL_EXPORT JointTreePtr jointTreeOf(const ChainPathPtr& chain);

/// @brief Two bodies whose boxes meet during [t_lo, t_hi]: two parts of the robot, or a
/// part and an obstacle.
struct RobotPair {
  double t_lo, t_hi;
  int part1;
  /// -1: `object` is the other body.
  int part2;
  void* object;
};

/// @brief What a RobotStep compares.
template <typename S>
struct RobotBodies {
  const std::vector<RobotPartPtr<S>>& parts;
  /// The groups and masks of the parts.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& filters;
  /// The pairs of parts that are tested.
  const std::vector<std::pair<int, int>>& own_pairs;
};

/// @brief The parts of a robot during a step.
template <typename S>
class FCL_EXPORT RobotStep {
 public:
  /// @param bodies  what it refers to lives as long as the step
  RobotStep(const RobotBodies<S>& bodies, const ChainPathPtr& chain);
  ~RobotStep();
  RobotStep(const RobotStep&) = delete;
  RobotStep& operator=(const RobotStep&) = delete;

  enum class Order {
    /// By t_lo.
    kTime,
    /// Obstacles by t_lo, then own pairs: most of these are of links near each other,
    /// whose boxes always meet, and few are in contact.
    kObstaclesFirst
  };

  /// @brief Pairs in an order that does not depend on the trees of the manager.
  /// @param obstacles  null: none
  std::vector<RobotPair> pairs(const ContinuousBroadPhase<S>* obstacles,
                               const BroadPhaseSettings& settings, Order order) const;

  /// @brief A part with its motion, which lives as long as the step.
  MovingGeometry<S> part(int number) const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace detail
}  // namespace fcl

#endif

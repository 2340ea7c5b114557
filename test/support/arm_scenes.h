// SPDX-License-Identifier: BSD-3-Clause
//
// Arms among obstacles, and FCL's discrete answer for a joint state. The poses of the
// links are products of Eigen's rotations: nothing of the library is asked.
#ifndef FCL_TEST_SUPPORT_ARM_SCENES_H
#define FCL_TEST_SUPPORT_ARM_SCENES_H

#include <memory>
#include <vector>

#include "fcl/broadphase/collision_robot.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

using JointValues = std::vector<double>;
using ArmGeometry = std::shared_ptr<CollisionGeometry<double>>;

/// @brief Two bodies of a scene that touch at a joint state.
struct ArmBodies {
  int part1{-1};
  /// One of them is -1.
  int part2{-1}, obstacle{-1};
  bool exist() const { return part1 >= 0; }
};

/// @brief An arm whose parts are numbered in the order in which they are added, and
/// obstacles at rest. Parts of the same link, and of links that a joint connects, may
/// touch.
class ArmScene {
 public:
  ArmScene() = default;
  ArmScene(const ArmScene&) = delete;
  ArmScene& operator=(const ArmScene&) = delete;

  /// @return the link
  int addJoint(const Transform3<double>& origin, const Vector3<double>& axis,
               bool slides = false);
  void addPart(int link, const ArmGeometry& geometry,
               const Transform3<double>& origin = Transform3<double>::Identity());
  void addObstacle(const ArmGeometry& geometry, const Transform3<double>& pose);

  const JointChain& chain() const { return chain_; }
  std::size_t numJoints() const { return joints_.size(); }
  std::size_t numParts() const { return parts_.size(); }
  std::size_t numObstacles() const { return obstacles_.size(); }
  /// @brief The robot with all parts, whose neighbours may touch.
  CollisionRobot<double> robot() const;
  const ContinuousCollisionManager<double>& manager() const { return manager_; }
  int numberOf(const ContinuousCollisionObject<double>* obstacle) const;
  ContinuousCollisionObject<double>* obstacle(std::size_t i) const {
    return obstacles_[i].object.get();
  }

  struct Part {
    int link;
    ArmGeometry geometry;
    Transform3<double> origin;
  };
  const std::vector<Part>& parts() const { return parts_; }
  /// @brief Whether two parts are tested with each other.
  bool areTested(std::size_t part1, std::size_t part2) const;

  std::vector<Transform3<double>> partPoses(const JointValues& values) const;
  /// @brief Two bodies that touch in this state, by FCL's discrete query, if any do.
  ArmBodies touching(const JointValues& values) const;
  /// @brief FCL's distance of two bodies in this state.
  double distance(const ArmBodies& bodies, const JointValues& values) const;

 private:
  struct Joint {
    Transform3<double> origin;
    Vector3<double> axis;
    bool slides;
  };
  struct Obstacle {
    ArmGeometry geometry;
    Transform3<double> pose;
    std::unique_ptr<ContinuousCollisionObject<double>> object;
  };
  JointChain chain_;
  std::vector<Joint> joints_;
  std::vector<Part> parts_;
  std::vector<Obstacle> obstacles_;
  ContinuousCollisionManager<double> manager_;
};

/// @brief An arm of 3 to 7 joints, with one or two parts for each link, among obstacles.
void makeRandomArm(Random& random, ArmScene& scene);

/// @brief An arm of six joints and 3,264 triangles, as industrial arms have them, among
/// 12 thin bars.
void makeSixAxisArm(ArmScene& scene);

/// @brief A state, or one near another state: each value changes by up to `most`.
JointValues randomValues(Random& random, std::size_t count);
JointValues nearValues(Random& random, const JointValues& values, double most);
JointValues valuesBetween(const JointValues& from, const JointValues& to, double t);

/// @brief The bodies that touch first in states between two that are at most `step` apart
/// in each joint, and the time.
struct SampledContact {
  ArmBodies bodies;
  double t{1};
};
SampledContact sampledContact(const ArmScene& scene, const JointValues& from,
                              const JointValues& to, double step);

}  // namespace test
}  // namespace fcl

#endif

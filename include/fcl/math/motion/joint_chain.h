// SPDX-License-Identifier: BSD-3-Clause
//
// Motions of the links of a robot whose joints move.
#ifndef FCL_MATH_MOTION_JOINT_CHAIN_H
#define FCL_MATH_MOTION_JOINT_CHAIN_H

#include <cassert>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "fcl/common/types.h"
#include "fcl/export.h"
#include "fcl/math/motion/detail/followed_motion.h"

namespace fcl {

namespace detail {

namespace deformable {
class JointTree;
class ChainPath;
}  // namespace deformable

enum class JointKind { kFixed, kRevolute, kPrismatic };

using JointTreePtr = std::shared_ptr<const deformable::JointTree>;
using ChainPathPtr = std::shared_ptr<const deformable::ChainPath>;

/// @brief The tree with one more joint and link. The other tree does not change.
FCL_EXPORT JointTreePtr withJoint(const JointTreePtr& tree, JointKind kind,
                                  const BoundedMotion::Placement& origin,
                                  const double (&axis)[3], int parent);

struct JointCounts {
  int links, values;
};
/// @brief Null: no tree, which has none.
FCL_EXPORT JointCounts jointCounts(const JointTreePtr& tree);

/// @brief Of values that change linearly, and of polynomials.
FCL_EXPORT ChainPathPtr makeChainPath(const JointTreePtr& tree,
                                      const BoundedMotion::Placement& base,
                                      const std::vector<double>& begin,
                                      const std::vector<double>& end);
FCL_EXPORT ChainPathPtr makeChainPath(const JointTreePtr& tree,
                                      const BoundedMotion::Placement& base,
                                      const std::vector<std::vector<double>>& values);

FCL_EXPORT std::shared_ptr<const BoundedMotion> makeLinkPath(const ChainPathPtr& chain,
                                                             int link);

FCL_EXPORT BoundedMotion::Placement placementOfUrdf(const double (&xyz)[3],
                                                    const double (&rpy)[3]);

}  // namespace detail

/// @brief The pose that a URDF writes as an origin, with xyz and rpy: a translation,
/// and turns about the fixed axes x, y and z, in this order, in radians.
/// @throws fcl::Exception  a number is not finite, or an angle beyond 2^20
inline Transform3<double> urdfOrigin(const Vector3<double>& xyz,
                                     const Vector3<double>& rpy) {
  Transform3<double> tf;
  detail::setTransform(
      detail::placementOfUrdf({xyz[0], xyz[1], xyz[2]}, {rpy[0], rpy[1], rpy[2]}), tf);
  return tf;
}

/// @brief The joints of a robot: where they are, and what they turn or slide about. It
/// says nothing about a motion; ChainMotion does.
///
/// Each joint carries a link, whose frame is that of the joint, as in a URDF: with the
/// value q, the frame of the link is `origin` in the frame of the link before it, turned
/// by q radians about `axis`, or moved by q along it. Links may branch, as the fingers of
/// a gripper do. A frame that is fixed to a link, such as the origin of a collision
/// geometry or a tool, is a link of a fixed joint. It costs queries no time.
///
/// Lengths have the unit of the geometries, angles are in radians. Copies are cheap and
/// independent. A chain that was moved from is empty.
///
/// Thread-safety: as of a standard container.
class JointChain {
 public:
  /// @brief As a parent: the base of the robot, and the link that was added last (of an
  /// empty chain the base).
  static constexpr int kBase = -1;
  static constexpr int kLast = -2;

  /// @brief Adds a joint that turns, by any angle.
  /// @param origin  the frame of the joint at the value 0, in the frame of the link
  /// `parent`. A rotation up to 2^-6 is replaced by the nearest one.
  /// @param axis  in the frame of the joint; of any length but 0
  /// @param parent  the number of a link, kBase or kLast
  /// @return the number of its link: 0, 1, ...
  /// @throws fcl::Exception  the axis is zero, a number is not finite, the origin is no
  /// rotation and translation, or there is no such parent; the chain is as before then
  int addRevolute(const Transform3<double>& origin, const Vector3<double>& axis,
                  int parent = kLast) {
    return add(detail::JointKind::kRevolute, origin, axis, parent);
  }

  /// @brief Adds a joint that slides along its axis; the rest is as for addRevolute().
  int addPrismatic(const Transform3<double>& origin, const Vector3<double>& axis,
                   int parent = kLast) {
    return add(detail::JointKind::kPrismatic, origin, axis, parent);
  }

  /// @brief Adds a frame that is fixed to the link `parent`. It has no value.
  int addFixed(const Transform3<double>& origin, int parent = kLast) {
    return add(detail::JointKind::kFixed, origin, Vector3<double>::UnitX(), parent);
  }

  int numLinks() const { return detail::jointCounts(tree_).links; }

  /// @brief The number of joints that move. Each has a value, in the order of the calls
  /// that added them.
  int numValues() const { return detail::jointCounts(tree_).values; }

  /// @brief For ChainMotion.
  const detail::JointTreePtr& tree() const { return tree_; }

 private:
  int add(detail::JointKind kind, const Transform3<double>& origin,
          const Vector3<double>& axis, int parent) {
    const int link = numLinks();
    tree_ = detail::withJoint(tree_, kind, detail::placementOf(origin),
                              {axis[0], axis[1], axis[2]},
                              parent == kLast ? link - 1 : parent);
    assert(numLinks() == link + 1);
    return link;
  }

  detail::JointTreePtr tree_;
};

template <typename S>
class LinkMotion;

/// @brief The motion of a JointChain during a step: each joint value goes linearly from
/// one number to another, or follows a polynomial. Links follow the exact paths: of a
/// revolute joint arcs, by any angle, also more than a turn.
///
/// Give each geometry of the robot the motion of its link. Queries compute the poses of
/// all links together, once for each time and thread. Bounds on accelerations and angular
/// speeds are derived for each link and span of time (doc/curved_paths.md).
///
/// It does not depend on the chain after it was made. Copies share all.
///
/// Thread-safety: it does not change.
class ChainMotion {
 public:
  /// @brief All values change at constant speed.
  /// @param begin, end  the value of each moving joint at t = 0 and t = 1
  /// @param base  the pose of the base in the world, at all times
  /// @throws fcl::Exception  a wrong number of values, a value that is not finite, an
  /// angle at t = 0 or t = 1 beyond 2^20 radians, a chain without joints, a base that is
  /// no rotation (up to 2^-6) and translation
  ChainMotion(const JointChain& chain, const std::vector<double>& begin,
              const std::vector<double>& end,
              const Transform3<double>& base = Transform3<double>::Identity())
      : path_(
            detail::makeChainPath(chain.tree(), detail::placementOf(base), begin, end)) {}

  /// @brief The value of joint i at t is the sum of values[i][k] t^k.
  /// @param values  coefficients for each moving joint, 1 to 16 of them
  /// @param base  as of the constructor
  /// @throws fcl::Exception  as the constructor; of an angle with more than two
  /// coefficients the sum of their sizes must be within 2^20
  static ChainMotion polynomial(
      const JointChain& chain, const std::vector<std::vector<double>>& values,
      const Transform3<double>& base = Transform3<double>::Identity()) {
    return ChainMotion(
        detail::makeChainPath(chain.tree(), detail::placementOf(base), values));
  }

  /// @brief The motion of a link.
  /// @param number  of the link in the chain
  /// @throws fcl::Exception  there is no such link
  template <typename S = double>
  std::shared_ptr<LinkMotion<S>> link(int number) const {
    return std::make_shared<LinkMotion<S>>(*this, number);
  }

  /// @brief For LinkMotion.
  const detail::ChainPathPtr& path() const { return path_; }

 private:
  explicit ChainMotion(detail::ChainPathPtr path) : path_(std::move(path)) {}

  detail::ChainPathPtr path_;
};

/// @brief The motion of a link of a chain, as FCL's and this library's queries take it.
/// @tparam S  double or float, as of the geometries. The path is the same.
///
/// Thread-safety: queries of this library may share it. FCL's integrate() changes it.
template <typename S>
class LinkMotion : public detail::FollowedMotion<S> {
 public:
  /// @brief As ChainMotion::link().
  LinkMotion(const ChainMotion& chain, int link)
      : detail::FollowedMotion<S>(detail::makeLinkPath(chain.path(), link)) {}
};

}  // namespace fcl

#endif

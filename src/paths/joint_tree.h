// SPDX-License-Identifier: BSD-3-Clause
//
// The joints and links of a robot, as numbers. Fixed joints are joined with the moving
// joint before them: a pose of a link costs no time for them.
#ifndef FCL_CCD_PATHS_JOINT_TREE_H
#define FCL_CCD_PATHS_JOINT_TREE_H

#include <string>
#include <vector>

#include "mesh/vertex_frames.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A pose that is a product of poses, with bounds on its rounding (spectral norm
/// and length).
struct RoundedPose {
  Pose pose;
  double rotation_error{0};
  double translation_error{0};
};

/// @brief x y. Rounds a rotation by 9 u, a coordinate by 3 u |y| + u |x + R y|.
RoundedPose operator*(const RoundedPose& x, const RoundedPose& y);

/// @brief Joints in an order in which each comes after the one that carries it.
class JointTree {
 public:
  enum class Type { kFixed, kRevolute, kPrismatic };

  /// @brief A joint that moves. Its frame turns about an axis through its origin, or
  /// slides along it.
  struct Joint {
    bool is_revolute;
    /// The moving joint that carries it; -1: the base.
    int parent;
    /// Its frame at the value 0, in the frame of `parent`.
    RoundedPose origin;
    /// In its own frame, a unit vector; and in the frame of `parent`.
    Vec axis, axis_in_parent;
    /// B [a] and B [a]^2 for the rotation B of `origin` and the axis a.
    double sine_rotation[9], cosine_rotation[9];
  };

  /// @brief What a joint moves, or a frame fixed to it.
  struct Link {
    /// The moving joint that carries it; -1: the base.
    int joint;
    /// In the frame of that joint.
    RoundedPose pose;
    /// The link that carries the joint of this one, which may be fixed; -1: the base.
    int parent{-1};
    bool is_moved{false};
  };

  /// @brief Adds a joint and its link, whose number is returned.
  /// @param origin  the frame of the joint in that of the link `parent`
  /// @param axis  in the frame of the joint; not used if it is fixed
  /// @param parent  the number of a link; -1: the base
  /// @pre origin is a rotation up to 2^-47, axis a unit vector, parent a link
  int add(Type type, const Pose& origin, const Vec& axis, int parent);

  const std::vector<Joint>& joints() const { return joints_; }
  const std::vector<Link>& links() const { return links_; }

 private:
  std::vector<Joint> joints_;
  std::vector<Link> links_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

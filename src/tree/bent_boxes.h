// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of points on bent paths (mesh/bend.h). A point deviates from its straight path by
// at most its bend s, and to the side of s. So along a direction n a box has to reach
// further by the largest positive n . s of its points, at both ends of the step.
#ifndef FCL_CCD_TREE_BENT_BOXES_H
#define FCL_CCD_TREE_BENT_BOXES_H

#include "mesh/bend.h"
#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Enlarges the boxes of a tree by the bends of its points.
class BentBoxes {
 public:
  /// @param origin  what the boxes at both ends of the step are relative to
  /// @param translation  of the mesh, in addition
  BentBoxes(const Bend& bend, const double (&origin)[2][3],
            const double (&translation)[2][3]);

  /// @brief Enlarges the boxes of a node, whose half-axes are no NaNs. Rounds outward.
  void enlarge(MovingKdopNode& node) const;

 private:
  /// The bend of a point with the mean r of its places at both ends, relative to the
  /// origins, is matrix . r + at_origin.
  float matrix_[9], at_origin_[3];
  /// Bounds on how much the bend changes with a coordinate, along an axis and along a
  /// diagonal direction; and on the rounding of all that does not depend on the box.
  float change_, diagonal_change_, rounding_;
};

/// @brief Enlarges the box of a vertex whose path is set. Rounds outward.
void enlarge(const Bend& bend, TreeVertex& vertex);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_SEPARATING_AXES_H
#define FCL_CCD_TREE_SEPARATING_AXES_H

#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two rigid meshes that translate: proves boxes of theirs apart that 16-DOPs do
/// not. A 16-DOP around an OBB is much wider than it, so that the DOPs alone overlap two
/// to three times as often.
class SeparatingAxes {
 public:
  /// @param a, b  must outlive this; areApart() is for meshes without moving trees.
  SeparatingAxes(const MeshInstance& a, const MeshInstance& b);

  /// @brief Whether areApart() is worth its time for two boxes with this sum of extents:
  /// not for boxes that are AABBs and for those that move far for their size.
  bool mayHelp(float extents) const { return least_extents_ <= extents; }

  /// @brief Proves that what is below node i of a's tree and node j of b's does not meet
  /// during the whole step: along one of the boxes' own axes (Gottschalk, Lin, Manocha
  /// 1996; the nine cross products of axes leave out few more) one is always on the same
  /// side of the other. NaN: not proved.
  bool areApart(int i, int j) const;

 private:
  const RigidTree& a_;
  const RigidTree& b_;
  /// Translation of b relative to a in both frames, and sum of the sizes of both.
  double translation_[2][3];
  double size_{0};
  float least_extents_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

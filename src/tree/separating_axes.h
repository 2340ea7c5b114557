// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_SEPARATING_AXES_H
#define FCL_CCD_TREE_SEPARATING_AXES_H

#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Proves boxes of two translating rigid meshes apart whose 16-DOPs overlap. A
/// 16-DOP around an OBB is much wider than the OBB. So without this test two to three
/// times as many boxes overlap.
class SeparatingAxes {
 public:
  /// @param a, b  meshes without moving trees; they must outlive this
  SeparatingAxes(const MeshInstance& a, const MeshInstance& b);

  /// @brief Whether areApart() is worth its time for two boxes with this sum of extents.
  /// It is not for AABBs, and not for boxes that move far relative to their size.
  bool mayHelp(float extents) const { return least_extents_ <= extents; }

  /// @brief Proves that the triangles below node i of a's tree and below node j of b's do
  /// not meet during the whole step. The proof is an axis of one of the two boxes along
  /// which one box is always on the same side of the other (Gottschalk, Lin, Manocha
  /// 1996). The nine cross products of axes are not tested, since they would prove few
  /// more. NaN: not proved.
  bool areApart(int i, int j) const;

 private:
  const RigidTree& a_;
  const RigidTree& b_;
  /// Translation of b relative to a in both frames, and a bound on the coordinates of all
  /// translations.
  double translation_[2][3];
  double size_{0};
  float least_extents_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_ORIENTED_BOX_H
#define FCL_CCD_TREE_ORIENTED_BOX_H

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A box around one of FCL's bounding volumes. Its points are center + sum of c_i
/// axis_i with |c_i| <= extent_i.
struct OrientedBox {
  double center[3];
  double axis[3][3];
  double extent[3];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

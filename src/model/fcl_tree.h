// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MODEL_FCL_TREE_H
#define FCL_CCD_MODEL_FCL_TREE_H

#include "tree/volume_tree.h"

namespace fcl {

template <typename BV>
class BVHModel;

namespace detail {
namespace deformable {

/// @brief FCL's tree of a mesh. It does not own the model.
/// @tparam BV  any of FCL's bounding volumes
/// @pre isTreeSound(model)
template <typename BV>
VolumeTree fclTree(const BVHModel<BV>& model);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

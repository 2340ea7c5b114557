// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_SOUND_TREE_H
#define FCL_CCD_TREE_SOUND_TREE_H

namespace fcl {

template <typename BV>
class BVHModel;

namespace detail {
namespace deformable {

/// @brief Proves that FCL's volumes bound the triangles below them, but for the rounding
/// that RigidTree adds. False: not proved; nothing can then be said of the tree.
///
/// FCL fits the volumes of a tree in one of two ways, always all of them. From the top
/// down (`endModel()`, `endReplaceModel(true, false)`) each is fitted to the vertices
/// below it: sound for every BV. From the bottom up (`endReplaceModel()`) it is the sum
/// of its two children: sound for AABBs and KDOPs only, since sums of the others can
/// leave out what they are sums of. So
///
/// (1) AABBs and KDOPs are sound;
/// (2) so is a tree in which one volume is certainly not the sum of its children;
/// (3) so is a small one whose boxes contain the corners of all triangles below them.
///
/// Looks at 64 nodes at most, for (2) as a rule at the root alone. Reads the tree as it
/// is at this moment; nothing is kept.
///
/// @tparam BV  any of FCL's
template <typename BV>
bool isTreeSound(const BVHModel<BV>& model);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MODEL_SOUND_TREE_H
#define FCL_CCD_MODEL_SOUND_TREE_H

namespace fcl {

template <typename BV>
class BVHModel;

namespace detail {
namespace deformable {

/// @brief Proves that FCL's volumes bound the triangles below them, up to the rounding
/// that RigidTree adds. False: not proved, and the tree must not be used.
///
/// FCL fits all volumes of a tree in one of two ways. From the top down (`endModel()`,
/// `endReplaceModel(true, false)`) each volume is fitted to the vertices below it. This
/// is sound for every BV. From the bottom up (`endReplaceModel()`) each volume is the sum
/// of its two children. This is sound for AABBs and KDOPs only: sums of other volumes can
/// leave out points of their terms. So
///
/// (1) AABBs and KDOPs are sound;
/// (2) a tree is sound if one of its volumes is certainly not the sum of its children;
/// (3) a small tree is sound if its boxes contain the corners of all triangles below
/// them.
///
/// (2) and (3) need a root with axes at right angles. RigidTree reads any other root as
/// unbounded, and then nothing bounds the size of the mesh. FCL makes such a root for one
/// triangle without area, and by the sum of some RSSs.
///
/// Reads at most 64 nodes, and for (2) most often the root alone. Reads the tree as it is
/// now, and keeps nothing.
///
/// @tparam BV  any of FCL's bounding volumes
template <typename BV>
bool isTreeSound(const BVHModel<BV>& model);

/// @brief Makes a tree that was fitted from the top down one that isTreeSound()
/// recognises: see refitTopDown().
/// @tparam BV  any of FCL's bounding volumes
/// @pre the tree was fitted from the top down
template <typename BV>
void markFittedFromTheTop(BVHModel<BV>& model);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

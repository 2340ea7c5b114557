// SPDX-License-Identifier: BSD-3-Clause
//
// Tight and sound volumes for a model whose vertices were replaced.
#ifndef FCL_GEOMETRY_BVH_REFIT_TOP_DOWN_H
#define FCL_GEOMETRY_BVH_REFIT_TOP_DOWN_H

#include <stdexcept>

#include "fcl/export.h"
#include "fcl/geometry/bvh/BVH_model.h"

namespace fcl {
namespace detail {

/// @brief Makes a tree that was fitted from the top down one that queries recognise. If
/// no volume shows it already, one volume, the root's as a rule, gets axes that FCL's sum
/// of its children cannot have. It contains the old one, and so FCL's queries stay
/// correct.
/// @pre the tree was fitted from the top down
template <typename BV>
FCL_EXPORT void markFittedFromTheTop(BVHModel<BV>& model);

}  // namespace detail

/// @brief Refits FCL's own tree of a rigid model so that each volume bounds the triangles
/// below it.
///
/// `endReplaceModel()` refits from the bottom up by default: it adds the volumes of two
/// children. FCL's sums of OBBs, RSSs, OBBRSSs and kIOSs can leave out parts of what they
/// are sums of, in meshes of any shape. FCL's own queries then miss contacts, and each
/// continuous query of this package builds a tree of its own. After this call queries
/// read FCL's tree again. `endReplaceModel(true, false)` instead of `endReplaceModel()`
/// has the same effect, without the cost of the first refit, in most models.
///
/// In some models all boxes have the same axes: wires, and strips of long rectangles.
/// Then FCL's boxes do not show how they were fitted, also after `endModel()`. This call
/// turns the axes of the root, whose box becomes up to twice as wide.
///
/// The vertices, the triangles and the shape of the tree stay. The cost is that of FCL's
/// refit from the top down, O(n log n) for n triangles. Nothing is needed for AABBs and
/// KDOPs, whose sums are sound. If FCL's calls change the vertices later, they also
/// replace these volumes: call this function again.
///
/// Thread-safety: do not call it at the same time as another call with the model.
///
/// @tparam BV  any of FCL's
/// @throws std::invalid_argument  the model is not built, or has begun an update or a
/// replacement, or has a previous frame. A DeformableBVHModel with two frames is such a
/// model; it does not need this call, see DeformableBVHModel::updateFclTree().
template <typename BV>
void refitTopDown(BVHModel<BV>& model) {
  if (model.build_state != BVH_BUILD_STATE_PROCESSED)
    throw std::invalid_argument(
        "refitTopDown(): the model is not built, or is being changed: call endModel() or "
        "endReplaceModel() first");
  if (model.prev_vertices)
    throw std::invalid_argument(
        "refitTopDown(): the model has a previous frame: use a model without an update");
  model.beginReplaceModel();
  for (int i = 0; i < model.num_vertices; ++i) model.replaceVertex(model.vertices[i]);
  model.endReplaceModel(true, false);
  detail::markFittedFromTheTop(model);
}

}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_FEATURE_KIND_H
#define FCL_CCD_MESH_FEATURE_KIND_H

namespace fcl {
namespace detail {
namespace deformable {

enum class FeatureKind { kVertexFace, kEdgeEdge };

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

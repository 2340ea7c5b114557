// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_CONTINUOUS_CONTACT_KIND_H
#define FCL_NARROWPHASE_CONTINUOUS_CONTACT_KIND_H

namespace fcl {

/// @brief Which features meet in a continuous contact.
enum class ContinuousContactKind {
  kVertexFace,    ///< a vertex meets a triangle
  kEdgeEdge,      ///< two edges meet
  kCrossing,      ///< an edge already passes through a triangle at t = 0
  kVertexEdge,    ///< a vertex comes near an edge; only with min_distance
  kVertexVertex,  ///< two vertices come near each other; only with min_distance
  kVertexShape,   ///< a vertex of a mesh meets a shape or a cell of an octree
  kEdgeShape,     ///< an edge of a mesh meets a shape or a cell
  kFaceShape,     ///< a triangle of a mesh meets a shape or a cell
  kShapes         ///< two shapes, or a shape and a cell, or two cells meet
};

}  // namespace fcl

#endif

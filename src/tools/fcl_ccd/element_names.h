// SPDX-License-Identifier: BSD-3-Clause
//
// What outputs call kinds of pairs, vertices and triangles.
#ifndef FCL_CCD_ELEMENT_NAMES_H
#define FCL_CCD_ELEMENT_NAMES_H

#include <string>

#include "scene.h"

namespace fcl_ccd {

/// @brief The name of a kind. The program has no shapes.
inline const char* nameOf(fcl::ContinuousContactKind kind) {
  using Kind = fcl::ContinuousContactKind;
  switch (kind) {
    case Kind::kVertexFace:
      return "vf";
    case Kind::kEdgeEdge:
      return "ee";
    case Kind::kVertexEdge:
      return "ve";
    case Kind::kVertexVertex:
      return "vv";
    default:
      return "crossing";
  }
}

/// @brief What is before the number of a triangle, a free edge or a free point.
inline const char* nameOf(fcl::PrimitiveKind kind) {
  switch (kind) {
    case fcl::PrimitiveKind::kFreeEdge:
      return "e";
    case fcl::PrimitiveKind::kFreePoint:
      return "p";
    default:
      return "";
  }
}

inline std::string nameOf(const SceneVertex& vertex) {
  return (vertex.of_b ? "b" : "") + std::to_string(vertex.id);
}

}  // namespace fcl_ccd

#endif

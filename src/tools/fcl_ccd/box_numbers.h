// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BOX_NUMBERS_H
#define FCL_CCD_BOX_NUMBERS_H

#include <array>
#include <cstddef>
#include <vector>

#include "fcl/narrowphase/continuous_contact_kind.h"
#include "mesh_io.h"
#include "truth_json.h"

namespace fcl_ccd {

/// @brief A VF or EE pair in a form that does not depend on the order of ids: the kind,
/// then the vertex and the sorted face, or two sorted edges in ascending order.
using PairKey = std::array<int, 5>;

/// @param ids  v, f0, f1, f2 or ea0, ea1, eb0, eb1
PairKey pairKey(fcl::ContinuousContactKind kind, std::array<int, 4> ids);

/// @brief The numbers of boxes in Sample-Scalable-CCD-Data: first the vertices, then the
/// edges, then the faces. Edges are sorted by their higher vertex, then by their lower
/// one (as igl::edges() has them).
class BoxNumbers {
 public:
  BoxNumbers(std::size_t num_vertices, const Triangles& triangles);

  /// @brief The pair of features that two boxes stand for.
  /// @throws std::runtime_error if a number is none of a box of the kind
  PairKey pairOf(fcl::ContinuousContactKind kind, const BoxPair& boxes) const;

 private:
  int vertexOf(long long box) const;
  const std::array<int, 2>& edgeOf(long long box) const;
  const std::array<int, 3>& faceOf(long long box) const;

  std::size_t num_vertices_;
  const Triangles& triangles_;
  std::vector<std::array<int, 2>> edges_;  ///< lower and higher vertex
};

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_BEND_H
#define FCL_CCD_MESH_BEND_H

namespace fcl {
namespace detail {
namespace deformable {

/// @brief How the paths of a mesh's vertices are bent. A vertex that is at x0 and x1 at
/// the ends of the step is at (1 - t) x0 + t x1 + 4 t (1 - t) s, up to an error that the
/// query knows, with s = matrix (x0 + x1) / 2 + offset.
struct Bend {
  /// Symmetric, by rows.
  double matrix[9];
  double offset[3];
};

/// @brief The bends of two meshes. Null: vertices go straight.
struct PairBends {
  const Bend* of[2]{nullptr, nullptr};
  bool isAny() const { return of[0] || of[1]; }
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

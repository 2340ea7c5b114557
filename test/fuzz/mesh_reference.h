// SPDX-License-Identifier: BSD-3-Clause
//
// All pairs of features of a mesh case, tested one by one.
#ifndef FCL_FUZZ_MESH_REFERENCE_H
#define FCL_FUZZ_MESH_REFERENCE_H

#include <vector>

#include "mesh_case.h"

namespace fcl {
namespace test {

struct MeshTruth {
  /// Sorted by name. Without a distance the brackets contain the first times, and are
  /// narrow. With a distance they are those that the library has to give, to the bit.
  std::vector<NamedBracket> contacts;
  /// Whether an edge passes through a face at t = 0.
  bool is_crossing;
};

/// @brief Boxes over the whole step leave out pairs; each other pair goes to the
/// elementary test, or to that at a distance.
MeshTruth bruteForce(const MeshCase& mesh_case);

}  // namespace test
}  // namespace fcl

#endif

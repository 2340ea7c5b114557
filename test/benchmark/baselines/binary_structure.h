// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_BASELINES_BINARY_STRUCTURE_H
#define FCL_BENCHMARK_BASELINES_BINARY_STRUCTURE_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief A binary tree with a triangle a leaf.
struct BinaryStructure {
  /// >= 0: the left child of a node, which the right one follows, both after the node; a
  /// leaf has the complement of its place among the leaves.
  std::vector<std::int32_t> links;
  /// The mesh's triangle at each leaf.
  std::vector<std::size_t> triangles;
};

/// @brief Splits at the mean along the longest axis of the centroids in the first frame;
/// in halves where that leaves one side with less than a sixteenth, which bounds the
/// depth.
BinaryStructure makeBinaryStructure(const FramePairMesh& mesh);

}  // namespace test
}  // namespace fcl

#endif

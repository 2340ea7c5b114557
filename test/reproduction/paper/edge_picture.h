// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_PAPER_EDGE_PICTURE_H
#define FCL_BENCHMARK_PAPER_EDGE_PICTURE_H

#include "pair_census.h"
#include "paper_scenes.h"
#include "pictures.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief The edges whose pairs are solved for, after each way of culling.
struct TestedEdgeSets {
  TestedEdges boxes;   // swept boxes
  TestedEdges plain;   // and the paper's filter
  TestedEdges moving;  // the library's boxes and filter
};

/// @brief The surface at t = 0 three times, side by side, with the edges in colour.
Image drawTestedEdges(SceneKind kind, const FramePairMesh& frame,
                      const TestedEdgeSets& sets);

}  // namespace test
}  // namespace fcl

#endif

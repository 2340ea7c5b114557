// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_BASELINES_MEASUREMENT_H
#define FCL_BENCHMARK_BASELINES_MEASUREMENT_H

#include "baselines/baseline.h"
#include "effort.h"
#include "scene_data.h"

namespace fcl {
namespace test {

struct BaselineFigures {
  /// The fastest of the repeats, its contacts sorted.
  BaselineStep step;
  /// Tree, owners, and what else is made once for a mesh.
  double ms_build{0};
};

/// @brief All self-contacts between two frames, as often as the effort says. A sequence
/// keeps its Baseline instead, and calls step() for each frame.
BaselineFigures measureBaseline(const FramePairMesh& mesh, const BaselineMethod& method,
                                const Effort& effort);

}  // namespace test
}  // namespace fcl

#endif

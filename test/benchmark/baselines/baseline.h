// SPDX-License-Identifier: BSD-3-Clause
//
// The methods of earlier papers, to compare with: one call a step, whatever the method.
// doc/baselines.md says what they are and how they were tuned.
#ifndef FCL_BENCHMARK_BASELINES_BASELINE_H
#define FCL_BENCHMARK_BASELINES_BASELINE_H

#include <cstddef>
#include <memory>
#include <vector>

#include "baselines/method.h"
#include "elementary/elementary.h"
#include "scene_data.h"
#include "speed_error/coplanarity_cubic.h"

namespace fcl {
namespace test {

/// @brief What a method found in a step, and what it took.
struct BaselineStep {
  /// Each once, in no order.
  std::vector<PairName> contacts;
  /// Pairs of triangles whose boxes overlap and that lie in no region that is left out.
  std::size_t triangle_pairs{0};
  /// Pairs of features whose boxes overlap: what a filter is asked.
  std::size_t feature_pairs{0};
  /// Pairs of features that the solver is asked.
  std::size_t elementary_tests{0};
  /// Regions that a normal cone and their contour leave out.
  std::size_t regions_left_out{0};
  double ms_update{0};
  double ms_traverse{0};
  double ms_test{0};

  double total() const { return ms_update + ms_traverse + ms_test; }
};

/// @brief Whether the features of a pair touch, its cubic known.
using TouchTest = bool (*)(fcl::ContinuousContactKind,
                           const detail::deformable::FeaturePoints&,
                           const RelativePair<double>&, const CoplanarityCubic<double>&);

/// @brief The solver of all these papers.
bool touchesByIntervalNewton(fcl::ContinuousContactKind,
                             const detail::deformable::FeaturePoints&,
                             const RelativePair<double>& pair,
                             const CoplanarityCubic<double>& cubic);

/// @brief A mesh, its tree and what else a method keeps from step to step.
class Baseline {
 public:
  virtual ~Baseline() = default;

  /// @brief All self-contacts between two frames of the mesh.
  virtual BaselineStep step(const FramePairMesh& mesh) = 0;
};

/// @brief Makes the structure by the first frame.
std::unique_ptr<Baseline> makeBaseline(const FramePairMesh& mesh,
                                       const BaselineMethod& method,
                                       TouchTest touches = touchesByIntervalNewton);

}  // namespace test
}  // namespace fcl

#endif

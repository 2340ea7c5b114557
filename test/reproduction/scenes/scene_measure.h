// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENES_SCENE_MEASURE_H
#define FCL_CCD_SCENES_SCENE_MEASURE_H

#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "paper_scenes.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief What is measured of a frame's motion as a whole, from its first positions to
/// its last: what a benchmark sees, unlike the simulator, which divides it into steps.
struct FrameFigures {
  std::size_t vertex_face{0};
  std::size_t edge_edge{0};
  /// pairs that were no contact of the frame before, and those of it that are none now
  std::size_t started{0};
  std::size_t ended{0};
  /// whether surfaces cross at the beginning
  bool crossing{false};
  double query_seconds{0};

  std::size_t contacts() const { return vertex_face + edge_edge; }
};

/// @brief Measures the frames of a scene, which must come in order.
class SceneMeasure {
 public:
  explicit SceneMeasure(int num_threads) : num_threads_(num_threads) {}

  /// @throws fcl::Exception if the library refuses the frame.
  FrameFigures measure(const SceneFrame& frame);

  /// @brief Contacts of the last frame.
  const ContinuousContactResult<double>& result() const { return result_; }

 private:
  int num_threads_;
  DeformableBVHModel<> model_;
  ContinuousContactResult<double> result_;
  std::vector<PairName> pairs_;  // sorted
};

}  // namespace test
}  // namespace fcl

#endif

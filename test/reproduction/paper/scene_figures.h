// SPDX-License-Identifier: BSD-3-Clause
//
// What is measured of a scene; tables.h writes it.
#ifndef FCL_BENCHMARK_PAPER_SCENE_FIGURES_H
#define FCL_BENCHMARK_PAPER_SCENE_FIGURES_H

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "effort.h"
#include "errors.h"
#include "frame_folder.h"
#include "scene_method.h"

namespace fcl {
namespace test {

/// @brief A method in a frame.
struct FrameRow {
  int frame{0};  // counted from 1
  double ms{0};
  std::size_t feature_pairs{0};
  std::size_t elementary_tests{0};
  Errors errors{};
};

/// @brief A method over all measured frames of a scene.
struct MethodFigures {
  std::string name, filter, kernels;
  std::vector<FrameRow> frames;
  /// How often it had to take in a topology, the first one included, and how long.
  int takes{0};
  double take_ms{0};

  double meanMs() const;
  double meanFeaturePairs() const;
  double meanElementaryTests() const;
  Errors errors() const;
};

struct SceneFigures {
  std::string scene;
  int paper_triangles{0};
  int every{1};
  /// Of the last frame measured, which has the most.
  std::size_t triangles{0};
  std::size_t vertices{0};
  std::size_t contacts{0};
  std::vector<MethodFigures> methods;

  /// @throws std::logic_error if it was not measured
  const MethodFigures& method(const char* name, const char* filter,
                              const char* kernels = "scalar") const;
  const MethodFigures& ours() const { return methods.front(); }
};

/// @brief Counts what is wrong about the answer to a frame, the i-th measured; the
/// answer's contacts are sorted.
using Score = std::function<Errors(std::size_t i, const FrameAnswer& answer)>;

/// @brief Runs a method through the frames. A frame's time is the least of as many
/// queries as the effort says, one after the other. Before every fifth frame the method
/// may renew its structure, which is not measured.
MethodFigures measureMethod(const ListedMethod& listed, const FrameFolder& folder,
                            const Effort& effort, const Score& score);

}  // namespace test
}  // namespace fcl

#endif

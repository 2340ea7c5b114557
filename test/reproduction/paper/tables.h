// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_PAPER_TABLES_H
#define FCL_BENCHMARK_PAPER_TABLES_H

#include <fstream>
#include <string>

#include "edge_picture.h"
#include "filter_figures.h"
#include "pair_census.h"
#include "scene_figures.h"

namespace fcl {
namespace test {

/// @brief The tables of the paper's experiments; doc/reproduction.md explains them.
class PaperTables {
 public:
  /// @throws std::runtime_error if the files cannot be written
  explicit PaperTables(const std::string& folder);

  /// @brief Table 1, and what is known of the scene.
  void addScene(const SceneFigures& scene);

  /// @brief Figure 8: what culling leaves to the solver.
  void addCulling(const SceneFigures& scene, const CandidateCounts& moving);

  /// @brief Figure 9: time over the frames.
  void addTimes(const SceneFigures& scene);

  /// @brief Figure 10: pairs that never get coplanar, over the frames.
  void addRatios(const SceneFigures& scene);

  /// @brief Figure 6: the edges of the pairs that are solved for, in one frame.
  void addEdges(const std::string& scene, int frame, const TestedEdgeSets& sets);

  /// @brief Cost of filter and solver.
  void addFilter(const std::string& scene, const FilterFigures& filter);

  /// @throws std::runtime_error if not everything could be written
  void finish();

 private:
  std::ofstream open(const std::string& name, const char* columns) const;

  std::string folder_;
  std::ofstream table1_, scenes_, topologies_, figure6_, figure8_, figure9_, figure10_,
      filter_;
};

}  // namespace test
}  // namespace fcl

#endif

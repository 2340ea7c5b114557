// SPDX-License-Identifier: BSD-3-Clause
//
// Every pair of features that a filter is asked, looked at outside of any measurement of
// time: which of them touch, a sample of them, and what is left of them.
#ifndef FCL_BENCHMARK_PAPER_PAIR_CENSUS_H
#define FCL_BENCHMARK_PAPER_PAIR_CENSUS_H

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <vector>

#include "baselines/baseline.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "frame_folder.h"
#include "mesh_generators.h"
#include "scene_data.h"
#include "speed_error/query_set.h"

namespace fcl {
namespace test {

/// @brief The edges of pairs of edges that the solver is asked.
struct TestedEdges {
  /// Both ends at t = 0, in a fixed order.
  using Segment = std::array<double, 6>;

  std::size_t pairs{0};
  std::set<Segment> edges;  // each once

  void add(const detail::deformable::FeaturePoints& edge_edge);
};

/// @brief A pair of features, and what is known of it.
struct MetPair {
  fcl::ContinuousContactKind kind;
  detail::deformable::FeaturePoints points;
  bool is_contact;
  bool is_culled;  // by the plain filter
};
using PairVisitor = std::function<void(const MetPair& pair)>;

/// @brief The pairs of features whose swept boxes overlap, each once (R-Triangles).
class SweptPairs {
 public:
  /// @brief Decides each pair by itself, by the library's elementary test over the whole
  /// step: what is found owes nothing to the library's tree, boxes and fans.
  /// @return the contacts, sorted
  std::vector<PairName> visit(const FramePairMesh& frame, const PairVisitor& visitor);

 private:
  TopologyWatch watch_;
  std::unique_ptr<Baseline> baseline_;
};

/// @brief Counts over the pairs that the library's own boxes leave.
struct CandidateCounts {
  std::size_t pairs{0};
  std::size_t left_by_plain{0};
  std::size_t contacts{0};
  std::size_t contacts_left_by_plain{0};

  CandidateCounts& operator+=(const CandidateCounts& other);
};

/// @brief The pairs of features that the library's filter is asked: their moving boxes
/// overlap.
class MovingPairs {
 public:
  /// @param contacts  of the frame, sorted
  /// @param edges  if not null, gets the edges that the library's filter leaves
  CandidateCounts count(const FramePairMesh& frame, const std::vector<PairName>& contacts,
                        TestedEdges* edges);

 private:
  TopologyWatch watch_;
  DeformableBVHModel<> model_;
};

/// @brief Pairs drawn evenly from all that were met.
class PairSample {
 public:
  explicit PairSample(std::size_t most) : most_(most) {}

  void add(const MetPair& pair);
  const QuerySet& pairs() const { return set_; }

 private:
  std::size_t most_;
  std::size_t met_{0};
  Random random_{1};
  QuerySet set_{};
};

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// What a tree hands out and takes, whatever its nodes look like.
#ifndef FCL_BENCHMARK_BASELINES_CANDIDATES_H
#define FCL_BENCHMARK_BASELINES_CANDIDATES_H

#include <cstdint>
#include <vector>

#include "mesh/moving_kdop.h"

namespace fcl {
namespace test {

/// @brief A pair of features whose boxes overlap: of one of the triangle pairs that were
/// asked for, and the window of the overlap.
struct Candidate {
  std::uint32_t pair;
  std::int32_t bit;
  detail::deformable::TimeWindow window;
};

/// @brief The inner nodes of a tree as regions of the surface, parents before children.
struct Regions {
  /// Children of region i: child[starts[i]] to child[starts[i + 1] - 1]; >= 0 a region, <
  /// 0 ~triangle. A node that is no region has none.
  std::vector<std::uint32_t> starts{0};
  std::vector<std::int32_t> children;

  std::size_t size() const { return starts.size() - 1; }
  void close() { starts.push_back(static_cast<std::uint32_t>(children.size())); }
};

}  // namespace test
}  // namespace fcl

#endif

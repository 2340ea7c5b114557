// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_QUERY_SET_H
#define FCL_BENCHMARK_QUERY_SET_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

/// @brief Whether the features touch, and a bracket of the first time at which they do.
struct Truth {
  bool contact;
  double toc_lo;
  double toc_hi;
};

/// @brief Elementary queries with their truth. The times are always those of
/// decideExactly(), to a few units in the last place.
struct QuerySet {
  std::string name;
  std::vector<MovingPair> queries;
  std::vector<Truth> truth;
};

/// @brief The hard queries under a folder, NAME/{vertex-face,edge-edge}.csv; whether they
/// touch is what the files say.
/// @throws std::runtime_error if a file cannot be read or decideExactly() disagrees
QuerySet readHardQueries(const std::string& folder);

/// @brief Two frames of a mesh and its true contacts.
struct SceneFolder {
  std::string name;
  std::string path;
  std::string previous;
  std::string current;
};

/// @brief What reaches the filter in a self-collision of the scene: feature pairs whose
/// moving boxes meet. Whether they touch is what true_pairs.csv.gz says.
/// @param sample  the number of queries that are kept, drawn evenly, in the order of the
/// traversal
/// @throws std::runtime_error as above
QuerySet collectScene(const SceneFolder& scene, std::size_t sample);

/// @brief Queries of all families of query_generators.h, half of them degenerate. Truth
/// is decideExactly() alone.
QuerySet generateQueries(std::size_t count, std::uint64_t seed);

}  // namespace test
}  // namespace fcl

#endif

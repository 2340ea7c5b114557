// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CSV_H
#define FCL_CCD_QUERY_CSV_H

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "mesh/vertex_frames.h"

namespace fcl_ccd {

/// @brief Four points with straight paths: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
struct ElementaryQuery {
  std::array<fcl::detail::deformable::VertexPath, 4> x;
  bool truth{false};
};

struct QueryList {
  std::vector<ElementaryQuery> queries;
  bool has_truth{false};       ///< whether every query tells if its features touch
  std::size_t num_rounded{0};  ///< coordinates that are not exactly a double
};

/// @brief Reads files of elementary queries, eight rows each: the four points at t = 0,
/// then at t = 1. A row is num,den,num,den,num,den with integers of any size, the exact
/// rational coordinates x, y, z, and optionally a seventh column, 0 or 1: whether the
/// features touch (the same in all eight rows).
/// A coordinate becomes the nearest double.
/// @throws std::runtime_error that names the file, the line and the cause.
QueryList readQueries(const std::vector<std::string>& paths);

}  // namespace fcl_ccd

#endif

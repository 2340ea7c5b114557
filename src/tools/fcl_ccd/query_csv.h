// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CSV_H
#define FCL_CCD_QUERY_CSV_H

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh/vertex_frames.h"

namespace fcl_ccd {

class RationalPoints;

/// @brief Four points with straight paths: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
struct ElementaryQuery {
  std::array<fcl::detail::deformable::VertexPath, 4> x;
  bool truth{false};
  std::optional<double> toc;  ///< the true first time of contact, if it is known
  /// Coordinates that are not exactly a double. In x they are the nearest ones.
  std::size_t num_not_doubles{0};
  /// The exact coordinates; null if all are doubles.
  std::shared_ptr<const RationalPoints> exact;
};

struct QueryList {
  std::vector<ElementaryQuery> queries;
  bool has_truth{false};  ///< whether every query tells if its features touch
};

/// @brief Reads a file of elementary queries, eight rows each: the four points at t = 0,
/// then at t = 1. A row has the exact coordinates x, y, z, as decimal numbers or each as
/// two integers of any size, numerator and denominator. Then may come whether the
/// features touch, 0 or 1, and after it the true first time of contact, which may be
/// empty (both are the same in all eight rows). All rows have as many fields. A first
/// line of names is skipped.
/// @throws std::runtime_error that names the file, the line, the field and the cause.
QueryList readQueries(const std::string& path);

}  // namespace fcl_ccd

#endif

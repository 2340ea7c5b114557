// SPDX-License-Identifier: BSD-3-Clause
//
// Arrays in the form that the page of a run has them: whole numbers as bytes, compressed
// with zlib, in base64. report_page/blocks.js reads them.
#ifndef FCL_CCD_PAGE_BLOCK_H
#define FCL_CCD_PAGE_BLOCK_H

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief A grid on which the page shows positions.
struct ViewGrid {
  std::array<double, 3> origin{};
  double spacing{1};  ///< a power of two

  /// @brief The grid of which so many cells make the diagonal of the vertices' box.
  static ViewGrid of(const Vertices& vertices, int cells);

  /// @brief The nearest node; far away from the origin, the last one there is.
  std::int32_t nodeOf(double x, std::size_t axis) const;
};

/// @brief Appends whole numbers, small ones in one byte.
/// @param numbers  below 2^31 in size
void appendNumbers(const std::vector<std::int64_t>& numbers, std::string& bytes);

/// @brief Appends the ids of all elements, as differences to the one before.
template <typename Ids>
void appendIds(const std::vector<Ids>& elements, std::string& bytes) {
  std::vector<std::int64_t> differences;
  std::int64_t last = 0;
  for (const Ids& element : elements)
    for (const int id : element) {
      differences.push_back(id - last);
      last = id;
    }
  appendNumbers(differences, bytes);
}

/// @brief Appends how the nodes of the vertices differ from those of an earlier frame, as
/// differences to the vertex before: all x, then y, then z.
/// @param before  of as many vertices; null: the origin
void appendMotion(const ViewGrid& grid, const Vertices* before, const Vertices& after,
                  std::string& bytes);

/// @brief The bytes compressed, in base64.
std::string packed(std::string_view bytes);

/// @brief The bytes in base64.
std::string base64(std::string_view bytes);

}  // namespace fcl_ccd

#endif

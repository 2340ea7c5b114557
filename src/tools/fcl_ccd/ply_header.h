// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PLY_HEADER_H
#define FCL_CCD_PLY_HEADER_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_ccd {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::size_t sizeOf(PlyType type);
bool isFloating(PlyType type);
bool isSigned(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type{PlyType::kFloat};
  bool is_list{false};
  PlyType count_type{PlyType::kUint8};  ///< type of a list's length
};

struct PlyElement {
  std::string name;
  unsigned long long count{0};
  std::vector<PlyProperty> properties;

  bool isVertex() const { return name == "vertex" || name == "vertices"; }
  bool isFace() const { return name == "face" || name == "faces"; }
  const PlyProperty* find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format{PlyFormat::kAscii};
  std::vector<PlyElement> elements;
};

/// @brief Removes the header from the front of a PLY file and returns it. It has one
/// vertex element with scalar x, y, z, and one face element with a list of vertex ids.
/// @throws std::runtime_error with the line and the cause.
PlyHeader takePlyHeader(std::string_view& file);

/// @brief The list of vertex ids of a face element, or null.
const PlyProperty* vertexIds(const PlyElement& face);

/// @brief The header as text, without comments and elements that have no property. Only
/// coordinates and vertex ids keep their names, so that a reader ignores the rest.
std::string plainPlyHeader(const PlyHeader& header);

}  // namespace fcl_ccd

#endif

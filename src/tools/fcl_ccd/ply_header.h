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
  bool isStrips() const { return name == "tristrips" || name == "tristrip"; }
  bool isEdge() const { return name == "edge" || name == "edges"; }
  const PlyProperty* find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format{PlyFormat::kAscii};
  std::vector<PlyElement> elements;
};

/// @brief Removes the header from the front of a PLY file and returns it. It has one
/// vertex element with scalar x, y, z, and at least one of: a face element and an element
/// of strips with a list of vertex ids, an edge element with vertex1 and vertex2.
/// @throws std::runtime_error with the line and the cause.
PlyHeader takePlyHeader(std::string_view& file);

/// @brief The list of vertex ids of an element of faces or strips, or null.
const PlyProperty* vertexIds(const PlyElement& faces);

}  // namespace fcl_ccd

#endif

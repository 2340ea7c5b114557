// SPDX-License-Identifier: BSD-3-Clause
#include "binary_ply.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "text_scan.h"

namespace fcl_ccd {
namespace {

bool hostIsBigEndian() {
  const std::uint16_t probe = 1;
  unsigned char first_byte = 0;
  std::memcpy(&first_byte, &probe, 1);
  return first_byte == 0;
}

/// @brief With its bytes in the opposite order; compilers have an instruction for it.
template <typename Bits>
Bits swapped(Bits bits) {
  unsigned char bytes[sizeof(bits)];
  std::memcpy(bytes, &bits, sizeof(bits));
  std::reverse(bytes, bytes + sizeof(bits));
  std::memcpy(&bits, bytes, sizeof(bits));
  return bits;
}

/// @brief Reads a value whose bytes are in the host's order, or (kSwap) in the opposite
/// order.
template <bool kSwap, typename Value, typename Bits>
Value load(const char* at) {
  Bits bits;
  static_assert(sizeof(Value) == sizeof bits, "same size");
  std::memcpy(&bits, at, sizeof bits);
  if (kSwap) bits = swapped(bits);
  Value value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

template <bool kSwap>
double loadCoordinate(const char* at, PlyType type) {
  switch (type) {
    case PlyType::kDouble:
      return load<kSwap, double, std::uint64_t>(at);
    case PlyType::kFloat:
      return static_cast<double>(load<kSwap, float, std::uint32_t>(at));
    case PlyType::kInt8:
      return load<kSwap, std::int8_t, std::uint8_t>(at);
    case PlyType::kUint8:
      return load<kSwap, std::uint8_t, std::uint8_t>(at);
    case PlyType::kInt16:
      return load<kSwap, std::int16_t, std::uint16_t>(at);
    case PlyType::kUint16:
      return load<kSwap, std::uint16_t, std::uint16_t>(at);
    case PlyType::kInt32:
      return load<kSwap, std::int32_t, std::uint32_t>(at);
    case PlyType::kUint32:
      return load<kSwap, std::uint32_t, std::uint32_t>(at);
  }
  return 0;
}

template <bool kSwap>
void decode(const char* at, const PlyVertexBlock& block, Vertices& vertices) {
  for (auto& vertex : vertices) {
    for (std::size_t k = 0; k < 3; ++k)
      vertex[k] = loadCoordinate<kSwap>(at + block.offsets[k], block.types[k]);
    at += block.stride;
  }
}

/// @brief The size of an item; 0 if it has lists or no properties.
std::size_t itemSize(const PlyElement& element) {
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.is_list) return 0;
    size += sizeOf(property.type);
  }
  return size;
}

/// @brief Whether an element without lists has the length that its header promises.
bool fits(const PlyElement& element, std::string_view body) {
  const std::size_t size = itemSize(element);
  return size > 0 && element.count <= body.size() / size;
}

PlyVertexBlock blockOf(const PlyElement& element, bool big_endian, std::size_t begin) {
  PlyVertexBlock block;
  block.begin = begin;
  block.count = static_cast<std::size_t>(element.count);
  block.stride = itemSize(element);
  block.big_endian = big_endian;
  const PlyProperty* const coordinates[3] = {element.find("x"), element.find("y"),
                                             element.find("z")};
  std::size_t offset = 0;
  for (const PlyProperty& property : element.properties) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (&property != coordinates[k]) continue;
      block.offsets[k] = offset;
      block.types[k] = property.type;
    }
    offset += sizeOf(property.type);
  }
  return block;
}

/// @brief Walks over elements with lists. Each function returns whether the file has the
/// requested data.
template <bool kSwap>
class ListReader {
 public:
  ListReader(std::string_view& body, std::size_t num_vertices)
      : body_(body), num_vertices_(num_vertices) {}

  bool readFaces(const PlyElement& element, Faces& faces) {
    const PlyProperty* const ids = vertexIds(element);
    // The count may be wrong: each face takes at least a byte.
    faces.corners.reserve(3 * static_cast<std::size_t>(std::min<unsigned long long>(
                                  element.count, body_.size() / 4)));
    for (unsigned long long i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties)
        if (!(&property == ids ? readCorners(property, faces) : skip(property)))
          return false;
    }
    return true;
  }

  bool skipItems(const PlyElement& element) {
    for (unsigned long long i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties)
        if (!skip(property)) return false;
    return true;
  }

 private:
  bool takeCount(PlyType type, std::size_t& count) {
    const std::size_t size = sizeOf(type);
    if (body_.size() < size) return false;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t shift = 8 * (kSwap == hostIsBigEndian() ? i : size - 1 - i);
      value |= std::uint32_t{static_cast<unsigned char>(body_[i])} << shift;
    }
    body_.remove_prefix(size);
    count = value;
    return !isSigned(type) || (value >> (8 * size - 1)) == 0;
  }

  bool skip(const PlyProperty& property) {
    std::size_t count = 1;
    if (property.is_list && !takeCount(property.count_type, count)) return false;
    if (count > body_.size() / sizeOf(property.type)) return false;
    body_.remove_prefix(count * sizeOf(property.type));
    return true;
  }

  bool readCorners(const PlyProperty& ids, Faces& faces) {
    constexpr std::size_t kIdSize = 4;
    std::size_t count = 0;
    if (!takeCount(ids.count_type, count) || count > body_.size() / kIdSize) return false;
    for (std::size_t k = 0; k < count; ++k) {
      // A negative id is out of range as well.
      const std::uint32_t id =
          load<kSwap, std::uint32_t, std::uint32_t>(body_.data() + k * kIdSize);
      if (id >= num_vertices_) return false;
      faces.corners.push_back(static_cast<int>(id));
    }
    body_.remove_prefix(count * kIdSize);
    return faces.endFace();
  }

  std::string_view& body_;
  std::size_t num_vertices_;
};

template <bool kSwap>
bool parseBody(const PlyHeader& header, std::string_view file, std::string_view body,
               PolygonMesh& mesh) {
  constexpr unsigned long long kMost = 0x7fffffff;
  std::size_t num_vertices = 0;
  for (const PlyElement& element : header.elements) {
    if (element.count > kMost) return false;
    if (element.isVertex()) num_vertices = static_cast<std::size_t>(element.count);
  }
  ListReader<kSwap> lists(body, num_vertices);
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    if (element.isVertex()) {
      if (!fits(element, body)) return false;
      const PlyVertexBlock block =
          blockOf(element, header.format == PlyFormat::kBigEndian,
                  static_cast<std::size_t>(body.data() - file.data()));
      mesh.vertices = decodeVertices(file, block);
      body.remove_prefix(block.end() - block.begin);
    } else if (element.isFace()) {
      if (sizeOf(vertexIds(element)->type) != sizeof(std::uint32_t) ||
          !lists.readFaces(element, mesh.faces))
        return false;
    } else if (element.isStrips() || element.isEdge() || !lists.skipItems(element)) {
      return false;
    }
  }
  std::string_view token;
  return !takeToken(body, token) && !mesh.vertices.empty() && mesh.faces.size() > 0;
}

}  // namespace

std::optional<PlyVertexBlock> findVertexBlock(std::string_view file) {
  std::string_view body = file;
  const PlyHeader header = takePlyHeader(body);
  const PlyElement& first = header.elements.front();
  if (header.format == PlyFormat::kAscii || !first.isVertex() || !fits(first, body))
    return std::nullopt;
  return blockOf(first, header.format == PlyFormat::kBigEndian,
                 static_cast<std::size_t>(body.data() - file.data()));
}

double loadPlyValue(const char* at, PlyType type, bool big_endian) {
  return big_endian != hostIsBigEndian() ? loadCoordinate<true>(at, type)
                                         : loadCoordinate<false>(at, type);
}

Vertices decodeVertices(std::string_view file, const PlyVertexBlock& block) {
  Vertices vertices(block.count);
  assert(block.end() <= file.size());
  const char* const at = file.data() + block.begin;
  if (block.big_endian != hostIsBigEndian())
    decode<true>(at, block, vertices);
  else
    decode<false>(at, block, vertices);
  return vertices;
}

void requireFinite(const Vertices& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto& p = vertices[i];
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      throw std::runtime_error("vertex " + std::to_string(i) +
                               " (counted from 0) has a coordinate that is not finite");
  }
}

bool parseBinaryPly(std::string_view file, PolygonMesh& mesh) {
  std::string_view body = file;
  const PlyHeader header = takePlyHeader(body);
  if (header.format == PlyFormat::kAscii) return false;
  if ((header.format == PlyFormat::kBigEndian) != hostIsBigEndian())
    return parseBody<true>(header, file, body, mesh);
  return parseBody<false>(header, file, body, mesh);
}

}  // namespace fcl_ccd

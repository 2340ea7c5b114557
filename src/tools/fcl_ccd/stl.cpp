// SPDX-License-Identifier: BSD-3-Clause
#include "stl.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "text_scan.h"

namespace fcl_ccd {
namespace {

constexpr std::size_t kTitleSize = 80;
constexpr std::size_t kBodyBegin = kTitleSize + 4;
/// The size of a facet: a normal and three corners in float, two bytes of attributes.
constexpr std::size_t kFacetSize = 50;
constexpr std::size_t kNormalSize = 12;

std::uint32_t loadLittleEndian(const char* at) {
  std::uint32_t bits = 0;
  for (int i = 3; i >= 0; --i) bits = (bits << 8) | static_cast<unsigned char>(at[i]);
  return bits;
}

double loadFloat(const char* at) {
  const std::uint32_t bits = loadLittleEndian(at);
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

bool isBinary(std::string_view file) {
  return file.size() >= kBodyBegin &&
         file.size() - kBodyBegin ==
             kFacetSize * std::size_t{loadLittleEndian(file.data() + kTitleSize)};
}

Vertices parseBinary(std::string_view file) {
  Vertices vertices;
  vertices.reserve((file.size() - kBodyBegin) / kFacetSize * 3);
  for (std::size_t facet = kBodyBegin; facet < file.size(); facet += kFacetSize) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const char* const at = file.data() + facet + kNormalSize + 12 * corner;
      vertices.push_back({loadFloat(at), loadFloat(at + 4), loadFloat(at + 8)});
    }
  }
  return vertices;
}

/// Reads the words of `solid NAME facet normal X Y Z outer loop vertex X Y Z ... endloop
/// endfacet ... endsolid NAME`. A file may hold several solids.
class AsciiStl {
 public:
  explicit AsciiStl(std::string_view file) : text_(file) {}

  Vertices parse() {
    while (nextLine()) {
      if (tokens_[0] == "solid" || tokens_[0] == "endsolid") continue;
      namingPlace([&] { return "line " + std::to_string(line_no_); }, [&] { addLine(); });
    }
    if (num_corners_ != 0)
      throw std::runtime_error("the file ends inside of a facet: it is cut short");
    return std::move(vertices_);
  }

 private:
  bool nextLine() {
    for (std::string_view line; takeLine(text_, line);) {
      ++line_no_;
      splitTokens(line, tokens_);
      if (!tokens_.empty()) return true;
    }
    return false;
  }

  void addLine() {
    const std::string_view word = tokens_[0];
    if (word == "vertex") {
      addVertex();
    } else if (word == "endloop") {
      if (num_corners_ != 3) throw std::runtime_error("a facet needs three vertices");
      num_corners_ = 0;
    } else if (word == "facet" || word == "outer" || word == "endfacet") {
      if (num_corners_ != 0) throw std::runtime_error("a loop has no end");
    } else {
      throw std::runtime_error(quoted(word) + " is not a word of STL; a binary file " +
                               "would be 84 + 50 bytes a facet long");
    }
  }

  void addVertex() {
    if (tokens_.size() != 4) throw std::runtime_error("a vertex needs three coordinates");
    std::array<double, 3> vertex{};
    for (std::size_t k = 0; k < 3; ++k) {
      fcl_ccd::requireFinite(tokens_[k + 1]);
      vertex[k] = std::strtod(std::string(tokens_[k + 1]).c_str(), nullptr);
    }
    vertices_.push_back(vertex);
    ++num_corners_;
  }

  std::string_view text_;
  std::vector<std::string_view> tokens_;
  std::size_t line_no_{0};
  std::size_t num_corners_{0};
  Vertices vertices_;
};

}  // namespace

PolygonMesh parseStl(std::string_view file) {
  PolygonMesh mesh;
  mesh.vertices = isBinary(file) ? parseBinary(file) : AsciiStl(file).parse();
  if (mesh.vertices.empty()) throw std::runtime_error("the mesh has no faces");
  if (mesh.vertices.size() > 0x7fffffff)
    throw std::runtime_error("more than 2,147,483,647 vertices");
  mesh.faces.corners.reserve(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.faces.corners.push_back(static_cast<int>(i));
  return mesh;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>

#include "mesh_readers.h"
#include "text_cursor.h"

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

std::size_t numFacets(std::string_view file) {
  return loadLittleEndian(file.data() + kTitleSize);
}

/// Whether the file is as long as its number of facets promises.
bool isExactlyBinary(std::string_view file) {
  return file.size() >= kBodyBegin &&
         file.size() - kBodyBegin == kFacetSize * numFacets(file);
}

/// Whether the file begins as text. A binary file has zeros where a text has none: in the
/// number of its facets, if these are fewer than 2^24, or in the first of them, and
/// mostly in its title.
bool beginsAsText(std::string_view file) {
  const std::string_view head = file.substr(0, kBodyBegin + kFacetSize);
  return std::all_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) >= ' ' || (c >= '\t' && c <= '\r');
  });
}

/// Some programs write bytes of their own behind the facets.
void requireWholeBinary(std::string_view file) {
  if (file.size() < kBodyBegin)
    throw std::runtime_error("the file ends in the title: it is cut short");
  const std::size_t whole = (file.size() - kBodyBegin) / kFacetSize;
  if (whole < numFacets(file))
    throw std::runtime_error(
        "the file ends before facet " + std::to_string(whole) + " of " +
        std::to_string(numFacets(file)) +
        " (counted from 0): it is cut short. (The file is not ascii STL: its beginning "
        "has bytes that are not text)");
  if (numFacets(file) == 0 && whole > 0)
    throw std::runtime_error("the title promises no facets, but " +
                             std::to_string(file.size() - kBodyBegin) +
                             " bytes follow: write the file again");
}

Vertices parseBinary(std::string_view file) {
  requireWholeBinary(file);
  assert(kBodyBegin + kFacetSize * numFacets(file) <= file.size());
  Vertices vertices(3 * numFacets(file));
  const char* at = file.data() + kBodyBegin + kNormalSize;
  for (std::size_t i = 0; i < vertices.size(); i += 3, at += kFacetSize)
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t k = 0; k < 3; ++k)
        vertices[i + corner][k] = loadFloat(at + 12 * corner + 4 * k);
  return vertices;
}

/// Reads the words of `solid NAME facet normal X Y Z outer loop vertex X Y Z ... endloop
/// endfacet ... endsolid NAME`, in any case of letters. A file may hold several solids.
/// Each of them has its end, so that a file that is cut short is noticed. The numbers of
/// a vertex or normal are on the line of its word, and a name ends with its line.
class AsciiStl {
 public:
  explicit AsciiStl(std::string_view file) : cursor_(file) {}

  Vertices parse() {
    return namingPlace(
        [&] { return cursor_.place(); },
        [&] {
          while (cursor_.skipToWord()) readStatement();
          if (place_ != kOutside)
            throw std::runtime_error("the file ends inside of a " +
                                     std::string(place_ == kSolid ? "solid" : "facet") +
                                     ": it is cut short");
          return std::move(vertices_);
        });
  }

 private:
  enum Place { kOutside, kSolid, kFacet, kLoop, kAfterLoop };

  enum class Word { kSolid, kFacet, kOuter, kVertex, kEndLoop, kEndFacet, kEndSolid };

  static bool isWord(std::string_view word, std::string_view lower) {
    return word.size() == lower.size() && beginsWith(word, lower);
  }
  static bool beginsWith(std::string_view word, std::string_view lower) {
    return word.size() >= lower.size() &&
           std::equal(lower.begin(), lower.end(), word.begin(), [](char a, char b) {
             return a == (b >= 'A' && b <= 'Z' ? static_cast<char>(b - 'A' + 'a') : b);
           });
  }

  /// Takes a statement's word: also `end loop` for `endloop`, `solidNAME` and
  /// `endsolidNAME`.
  Word takeStatement() {
    std::string_view word = cursor_.takeWord();
    if (isWord(word, "vertex")) return Word::kVertex;
    if (isWord(word, "facet")) return Word::kFacet;
    if (isWord(word, "outer")) return Word::kOuter;
    if (beginsWith(word, "solid")) return Word::kSolid;
    const std::string_view whole = word;
    if (isWord(word, "end") && cursor_.skipBlanks())
      word = cursor_.takeWord();
    else if (beginsWith(word, "end"))
      word.remove_prefix(3);
    if (word.size() < whole.size() || isWord(whole, "end")) {
      if (isWord(word, "loop")) return Word::kEndLoop;
      if (isWord(word, "facet")) return Word::kEndFacet;
      if (beginsWith(word, "solid")) return Word::kEndSolid;
    }
    throw BadWord(quoted(whole) + " is not a word of STL", word);
  }

  void readStatement() {
    switch (takeStatement()) {
      case Word::kSolid:
        go(kOutside, kSolid, "solid");
        cursor_.nextLine();
        break;
      case Word::kFacet:
        go(kSolid, kFacet, "facet");
        skipNormal();
        break;
      case Word::kOuter:
        go(kFacet, kLoop, "outer");
        if (cursor_.skipBlanks() && isWord(cursor_.peekWord(), "loop"))
          cursor_.takeWord();
        break;
      case Word::kVertex:
        if (place_ != kLoop) throw std::runtime_error("a vertex outside of a loop");
        readVertex();
        break;
      case Word::kEndLoop:
        if (place_ == kLoop && num_corners_ != 3)
          throw std::runtime_error("a facet needs three vertices");
        num_corners_ = 0;
        go(kLoop, kAfterLoop, "endloop");
        break;
      case Word::kEndFacet:
        go(kAfterLoop, kSolid, "endfacet");
        break;
      case Word::kEndSolid:
        go(kSolid, kOutside, "endsolid");
        cursor_.nextLine();
        break;
    }
  }

  void go(Place from, Place to, const char* word) {
    if (place_ != from) {
      constexpr const char* kExpected[] = {"solid", "facet or endsolid", "outer loop",
                                           "endloop", "endfacet"};
      throw std::runtime_error("expected " + std::string(kExpected[place_]) + ", found " +
                               word);
    }
    place_ = to;
  }

  /// Its numbers are not used: some programs write nan, or none.
  void skipNormal() {
    if (!cursor_.skipBlanks() || !isWord(cursor_.peekWord(), "normal")) return;
    cursor_.takeWord();
    for (int k = 0; k < 3 && cursor_.skipBlanks(); ++k) {
      if (isWord(cursor_.peekWord(), "outer")) return;
      cursor_.takeWord();
    }
  }

  void readVertex() {
    const std::array<double, 3> vertex = cursor_.takeVertex();
    if (num_corners_ == 3) throw std::runtime_error("a facet has three vertices");
    vertices_.push_back(vertex);
    ++num_corners_;
  }

  TextCursor<false, false> cursor_;
  Place place_{kOutside};
  int num_corners_{0};
  Vertices vertices_;
};

}  // namespace

PolygonMesh parseStl(std::string_view file) {
  PolygonMesh mesh;
  const bool is_text = !isExactlyBinary(file) && beginsAsText(file);
  mesh.vertices = is_text ? AsciiStl(file).parse() : parseBinary(file);
  if (mesh.vertices.size() > 0x7fffffff)
    throw std::runtime_error("more than 2,147,483,647 vertices");
  mesh.faces.corners.resize(mesh.vertices.size());
  std::iota(mesh.faces.corners.begin(), mesh.faces.corners.end(), 0);
  return mesh;
}

}  // namespace fcl_ccd

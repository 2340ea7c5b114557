// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "mesh_readers.h"
#include "text_cursor.h"

namespace fcl_ccd {
namespace {

/// Removes the prefixes for texture, colour and normal from the front of a header's word.
/// They have a fixed order, which not every program keeps.
std::string_view withoutPrefixes(std::string_view word) {
  for (;;) {
    if (word.substr(0, 2) == "ST")
      word.remove_prefix(2);
    else if (word.substr(0, 1) == "C" || word.substr(0, 1) == "N")
      word.remove_prefix(1);
    else
      return word;
  }
}

class OffReader {
 public:
  explicit OffReader(std::string_view file) : cursor_(file) {}

  PolygonMesh read() {
    return namingPlace(
        [&] { return cursor_.place(); },
        [&] {
          readHeader();
          mesh_.vertices.reserve(atMost(num_vertices_));
          readItems("vertex", num_vertices_, [&] { readVertex(); });
          mesh_.faces.corners.reserve(3 * atMost(num_faces_));
          readItems("face", num_faces_, [&] { readFace(); });
          if (cursor_.skipToWord())
            throw std::runtime_error("more lines than the header promises");
          return std::move(mesh_);
        });
  }

 private:
  /// `OFF` and the numbers of vertices, faces and edges, on one line or on two, also with
  /// the first number directly behind the word, or without the word.
  void readHeader() {
    if (!cursor_.skipToWord()) throw std::runtime_error("the file is empty");
    if (!cursor_.takeInteger(num_vertices_)) readKeyword();
    num_faces_ = takeCount();
    if (num_vertices_ < 0 || num_faces_ < 0)
      throw std::runtime_error("the number of vertices or faces is negative");
    if (num_vertices_ > std::numeric_limits<int>::max())
      throw std::runtime_error("more than 2,147,483,647 vertices");
    cursor_.nextLine();
  }

  /// The word and the number of vertices.
  void readKeyword() {
    const std::string_view word = cursor_.peekWord();
    std::string_view rest = withoutPrefixes(word);
    if (rest.substr(0, 3) != "OFF" && rest.substr(0, 3) != "off") refuse(word, rest);
    rest.remove_prefix(3);
    if (!rest.empty() && rest != "BINARY" && !parseInteger(rest, num_vertices_))
      refuse(word, rest);
    cursor_.takeWord();
    if (rest == "BINARY" ||
        (rest.empty() && cursor_.skipToWord() && cursor_.peekWord() == "BINARY"))
      throw std::runtime_error("binary OFF is not supported; use text OFF or PLY");
    if (!rest.empty()) return;
    if (cursor_.atEnd())
      throw std::runtime_error("the file ends before the number of vertices");
    num_vertices_ = takeCount();
  }

  [[noreturn]] static void refuse(std::string_view word, std::string_view rest) {
    if (rest.substr(0, 1) == "4" || rest.substr(0, 1) == "n")
      throw std::runtime_error(quoted(word) +
                               " is a mesh in more than three dimensions, " +
                               "which is not read; export it as OFF");
    throw std::runtime_error("a three-dimensional OFF mesh begins with OFF, not with " +
                             quoted(word));
  }

  long long takeCount() {
    long long count = 0;
    if (!cursor_.skipBlanks() || !cursor_.takeInteger(count)) {
      const std::string_view found = cursor_.peekWord();
      throw std::runtime_error("expected the numbers of vertices and faces, found " +
                               (found.empty() ? "the end of the line" : quoted(found)));
    }
    return count;
  }

  /// The count of a header may be wrong. An item takes at least six bytes.
  std::size_t atMost(long long count) const {
    return std::min(static_cast<std::size_t>(count), cursor_.bytesLeft() / 6 + 1);
  }

  template <typename ReadItem>
  void readItems(const char* what, long long count, ReadItem readItem) {
    for (long long i = 0; i < count; ++i, cursor_.nextLine()) {
      if (!cursor_.skipToWord())
        throw std::runtime_error("the file ends before " + std::string(what) + ' ' +
                                 std::to_string(i) + " of " + std::to_string(count) +
                                 " (counted from 0): it is cut short");
      readItem();
    }
  }

  void readVertex() { mesh_.vertices.push_back(cursor_.takeVertex()); }

  void readFace() {
    long long corners = 0;
    const std::string_view first = cursor_.peekWord();
    if (!cursor_.takeInteger(corners) || corners < 3)
      throw std::runtime_error(
          "a face begins with its number of vertices, at least 3, not with " +
          quoted(first));
    for (long long k = 0; k < corners; ++k) {
      if (!cursor_.skipBlanks())
        throw std::runtime_error("the line ends before the face's " +
                                 std::to_string(corners) + " vertex ids");
      mesh_.faces.corners.push_back(takeId());
    }
    mesh_.faces.endFace();
  }

  int takeId() {
    long long id = 0;
    const std::string_view word = cursor_.peekWord();
    if (!cursor_.takeInteger(id))
      throw BadWord(quoted(word) + " is not a vertex id", word);
    if (id < 0 || id >= num_vertices_)
      throw std::runtime_error("vertex id " + quoted(word) + " is out of range");
    return static_cast<int>(id);
  }

  TextCursor<true, false> cursor_;
  long long num_vertices_{0};
  long long num_faces_{0};
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh parseOff(std::string_view file) { return OffReader(file).read(); }

}  // namespace fcl_ccd

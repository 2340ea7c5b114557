// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "binary_ply.h"
#include "mesh_readers.h"
#include "ply_header.h"
#include "text_cursor.h"

namespace fcl_ccd {
namespace {

[[noreturn]] void failAtEnd() {
  throw std::runtime_error("the file ends here: it is cut short");
}

/// The values of an ascii body. Only blanks separate them: values may stand on lines as
/// they like.
class AsciiBody {
 public:
  AsciiBody(std::string_view file, std::size_t begin)
      : file_(file), begin_(begin), cursor_(file.substr(begin)) {}

  double takeCoordinate(PlyType type) {
    if (!isFloating(type)) return static_cast<double>(takeInteger(type));
    goToValue();
    if (type == PlyType::kDouble) return cursor_.takeNumber<double>();
    return static_cast<double>(cursor_.takeNumber<float>());
  }

  long long takeInteger(PlyType type) {
    goToValue();
    const std::string_view word = cursor_.peekWord();
    long long value = 0;
    if (!cursor_.takeInteger(value))
      throw std::runtime_error(quoted(word) + " is not an integer");
    const int bits = static_cast<int>(8 * sizeOf(type)) - (isSigned(type) ? 1 : 0);
    const long long end = 1LL << bits;
    if (value >= end || value < (isSigned(type) ? -end : 0))
      throw std::runtime_error(quoted(word) + " does not fit its type");
    return value;
  }

  /// Any numbers do, also those that are not finite. The loop ends at the latest with the
  /// file: each value takes a byte or throws.
  void skip(PlyType, unsigned long long count) {
    for (unsigned long long i = 0; i < count; ++i) {
      goToValue();
      const std::string_view word = cursor_.takeWord();
      double value = 0;
      const char* const end = word.data() + word.size();
      const auto parsed = parseDecimal(word.data(), end, value);
      if ((parsed.ec != std::errc() || parsed.ptr != end) &&
          classifyNumber(word) == NumberToken::kNotANumber)
        throw BadWord(quoted(word) + " is not a number", word);
    }
  }

  bool atEnd() { return !cursor_.skipToWord(); }
  std::size_t bytesLeft() const { return cursor_.bytesLeft(); }
  /// The least bytes of a value: a digit and a blank.
  static std::size_t sizeOfValue(PlyType) { return 2; }

  std::string place() const {
    const TextCursor<false, false> whole(file_);
    return "line " + std::to_string(whole.lineNo(begin_ + cursor_.offset()));
  }

 private:
  void goToValue() {
    if (!cursor_.skipToWord()) failAtEnd();
  }

  std::string_view file_;
  std::size_t begin_;
  TextCursor<false, false> cursor_;
};

/// The values of a binary body.
class BinaryBody {
 public:
  BinaryBody(std::string_view file, std::size_t begin, PlyFormat format)
      : file_(file),
        body_(file.substr(begin)),
        big_endian_(format == PlyFormat::kBigEndian) {}

  double takeCoordinate(PlyType type) {
    const double value = loadPlyValue(take(type), type, big_endian_);
    if (!std::isfinite(value)) throw std::runtime_error("a coordinate is not finite");
    return value;
  }

  long long takeInteger(PlyType type) {
    return static_cast<long long>(loadPlyValue(take(type), type, big_endian_));
  }

  void skip(PlyType type, unsigned long long count) {
    if (count > body_.size() / sizeOf(type)) failAtEnd();
    body_.remove_prefix(static_cast<std::size_t>(count) * sizeOf(type));
  }

  /// Blanks behind the body do no harm.
  bool atEnd() const { return body_.find_first_not_of(" \t\r\n") == body_.npos; }
  std::size_t bytesLeft() const { return body_.size(); }
  static std::size_t sizeOfValue(PlyType type) { return sizeOf(type); }
  std::string place() const {
    return "byte " + std::to_string(file_.size() - body_.size());
  }

 private:
  const char* take(PlyType type) {
    if (body_.size() < sizeOf(type)) failAtEnd();
    const char* const at = body_.data();
    body_.remove_prefix(sizeOf(type));
    return at;
  }

  std::string_view file_;
  std::string_view body_;
  bool big_endian_;
};

/// Reads the elements of a file, in its order.
template <typename Body>
class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Body body) : header_(header), body_(body) {}

  PolygonMesh read() {
    for (const PlyElement& element : header_.elements)
      if (element.isVertex()) num_vertices_ = element.count;
    if (num_vertices_ > 0x7fffffff)
      throw std::runtime_error("vertex " + std::to_string(num_vertices_) +
                               ": more than 2,147,483,647 vertices");
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      if (element.isVertex())
        readVertices(element);
      else if (element.isFace())
        readFaces(element);
      else if (element.isStrips())
        readStrips(element);
      else if (element.isEdge() && element.count > 0)
        readEdges(element);
      else
        readItems(element, [&](const PlyProperty& property) { skip(property); });
    }
    if (!body_.atEnd())
      throw std::runtime_error(body_.place() + ": more data than the header promises");
    return std::move(mesh_);
  }

 private:
  /// Calls readProperty for each property of each item.
  template <typename ReadProperty, typename EndItem>
  void readItems(const PlyElement& element, ReadProperty readProperty, EndItem endItem) {
    unsigned long long i = 0;
    const auto place = [&] {
      const bool is_known = element.isVertex() || element.isFace();
      return (is_known ? element.name : quoted(element.name)) + ' ' + std::to_string(i) +
             " of " + std::to_string(element.count) + " (counted from 0), " +
             body_.place();
    };
    namingPlace(place, [&] {
      for (; i < element.count; ++i) {
        for (const PlyProperty& property : element.properties) readProperty(property);
        endItem();
      }
    });
  }
  template <typename ReadProperty>
  void readItems(const PlyElement& element, ReadProperty readProperty) {
    readItems(element, readProperty, [] {});
  }

  /// The count of an element, or what the rest of the file has room for if this is less.
  std::size_t atMost(const PlyElement& element) const {
    std::size_t size = 0;
    for (const PlyProperty& property : element.properties)
      size += body_.sizeOfValue(property.is_list ? property.count_type : property.type);
    return static_cast<std::size_t>(
        std::min<unsigned long long>(element.count, body_.bytesLeft() / size + 1));
  }

  unsigned long long takeLength(const PlyProperty& list) {
    const long long length = body_.takeInteger(list.count_type);
    if (length < 0) throw std::runtime_error("a list has a negative length");
    return static_cast<unsigned long long>(length);
  }

  void skip(const PlyProperty& property) {
    body_.skip(property.type, property.is_list ? takeLength(property) : 1);
  }

  void readVertices(const PlyElement& element) {
    const PlyProperty* const names[3] = {element.find("x"), element.find("y"),
                                         element.find("z")};
    mesh_.vertices.reserve(atMost(element));
    std::array<double, 3> vertex{};
    readItems(
        element,
        [&](const PlyProperty& property) {
          for (std::size_t k = 0; k < 3; ++k)
            if (&property == names[k]) {
              vertex[k] = body_.takeCoordinate(property.type);
              return;
            }
          skip(property);
        },
        [&] { mesh_.vertices.push_back(vertex); });
  }

  /// The id, or -1 if it is out of range.
  int inRange(long long id) const {
    const bool in_range = id >= 0 && static_cast<unsigned long long>(id) < num_vertices_;
    return in_range ? static_cast<int>(id) : -1;
  }
  int takeId(PlyType type) { return inRange(body_.takeInteger(type)); }

  void readFaces(const PlyElement& element) {
    const PlyProperty* const ids = vertexIds(element);
    mesh_.faces.corners.reserve(3 * atMost(element));
    const std::size_t first = mesh_.faces.size();
    // Faces are checked when all of the body is known to be there.
    std::size_t num_good = first, num_whole = first, i = first;
    bool is_good = true;
    readItems(
        element,
        [&](const PlyProperty& property) {
          if (&property != ids) return skip(property);
          for (unsigned long long left = takeLength(property); left > 0; --left) {
            const int id = takeId(property.type);
            is_good &= id >= 0;
            mesh_.faces.corners.push_back(id);
          }
        },
        [&] {
          const bool is_whole = mesh_.faces.endFace();
          if (is_good && num_good == i) ++num_good;
          if (is_whole && num_whole == i) ++num_whole;
          ++i;
        });
    const auto nameOf = [&](std::size_t face) {
      return "face " + std::to_string(face - first) + " (counted from 0) has ";
    };
    if (num_good < i)
      throw std::runtime_error(nameOf(num_good) + "a vertex id that is out of range; " +
                               "there are " + std::to_string(num_vertices_) +
                               " vertices");
    if (num_whole < i)
      throw std::runtime_error(nameOf(num_whole) + "fewer than three vertices");
  }

  int requireId(PlyType type) {
    const int id = takeId(type);
    if (id < 0)
      throw std::runtime_error("a vertex id is out of range; there are " +
                               std::to_string(num_vertices_) + " vertices");
    return id;
  }

  /// Whether an id ends a strip: -1, also in a type that has no sign.
  bool isRestart(long long id, PlyType type) const {
    if (isSigned(type)) return id == -1;
    return id == (1LL << (8 * sizeOf(type))) - 1 &&
           static_cast<unsigned long long>(id) >= num_vertices_;
  }

  void readStrips(const PlyElement& element) {
    const PlyProperty* const ids = vertexIds(element);
    readItems(element, [&](const PlyProperty& property) {
      if (&property == ids)
        readStrip(takeLength(property), property.type);
      else
        skip(property);
    });
  }

  /// Each corner from the third on makes a triangle with the two before it, whose sides
  /// face alike. Triangles with a repeated corner only lead to the next part of a strip.
  void readStrip(unsigned long long length, PlyType type) {
    int a = -1, b = -1;
    bool is_odd = false;
    for (; length > 0; --length) {
      const long long value = body_.takeInteger(type);
      if (isRestart(value, type)) {
        a = b = -1;
        is_odd = false;
        continue;
      }
      const int c = inRange(value);
      if (c < 0)
        throw std::runtime_error("vertex id " + std::to_string(value) +
                                 " is out of range; there are " +
                                 std::to_string(num_vertices_) + " vertices");
      if (a >= 0) {
        if (a != b && b != c && a != c) addTriangle(is_odd ? b : a, is_odd ? a : b, c);
        is_odd = !is_odd;
      }
      a = b;
      b = c;
    }
  }

  void addTriangle(int a, int b, int c) {
    for (const int id : {a, b, c}) mesh_.faces.corners.push_back(id);
    mesh_.faces.endFace();
  }

  void readEdges(const PlyElement& element) {
    const PlyProperty* const ends[2] = {element.find("vertex1"), element.find("vertex2")};
    mesh_.free.edges.reserve(atMost(element));
    std::array<int, 2> edge{};
    readItems(
        element,
        [&](const PlyProperty& property) {
          if (&property == ends[0])
            edge[0] = requireId(property.type);
          else if (&property == ends[1])
            edge[1] = requireId(property.type);
          else
            skip(property);
        },
        [&] { mesh_.free.edges.push_back(edge); });
  }

  const PlyHeader& header_;
  Body body_;
  unsigned long long num_vertices_{0};
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh parsePly(std::string_view file) {
  std::string_view rest = file;
  const PlyHeader header = takePlyHeader(rest);
  const std::size_t begin = file.size() - rest.size();
  if (header.format == PlyFormat::kAscii)
    return PlyReader<AsciiBody>(header, {file, begin}).read();
  return PlyReader<BinaryBody>(header, {file, begin, header.format}).read();
}

}  // namespace fcl_ccd

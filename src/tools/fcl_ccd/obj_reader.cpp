// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh_readers.h"
#include "text_cursor.h"

namespace fcl_ccd {
namespace {

/// Statements of the format that have no vertices, faces, lines or points.
constexpr std::string_view kIgnored[] = {
    "vn",     "vt",   "vp",         "g",        "o",      "s",        "usemtl",
    "mtllib", "mg",   "usemap",     "maplib",   "bevel",  "c_interp", "d_interp",
    "lod",    "deg",  "bmat",       "step",     "cstype", "curv2",    "parm",
    "trim",   "hole", "scrv",       "sp",       "end",    "con",      "ctech",
    "stech",  "csh",  "shadow_obj", "trace_obj"};

/// Geometry that is not read. To skip it would be to lose contacts.
constexpr std::string_view kRefused[] = {"curv", "surf", "bsp", "bzp",
                                         "cdc",  "cdp",  "res", "call"};

template <std::size_t kSize>
bool isOneOf(const std::string_view (&words)[kSize], std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view file) : cursor_(file) {}

  PolygonMesh read() {
    namingPlace([&] { return cursor_.place(); },
                [&] {
                  for (; cursor_.skipToWord(); cursor_.nextLine()) readStatement();
                });
    // Faces may come before their vertices, so ids are compared with the count at the
    // end.
    if (largest_id_ > numVertices())
      throw std::runtime_error("line " + std::to_string(cursor_.lineNo(largest_at_)) +
                               ": vertex id " + std::to_string(largest_id_) +
                               " is out of range; there are " +
                               std::to_string(numVertices()));
    return std::move(mesh_);
  }

 private:
  long long numVertices() const { return static_cast<long long>(mesh_.vertices.size()); }

  void readStatement() {
    const std::string_view keyword = cursor_.takeWord();
    if (keyword == "v")
      readVertex();
    else if (keyword == "f" || keyword == "fo")  // fo: the same in old files
      readFace();
    else if (keyword == "l")
      readLine();
    else if (keyword == "p")
      readPoints();
    else if (isOneOf(kRefused, keyword))
      throw std::runtime_error(quoted(keyword) +
                               " is geometry that is not read; export " +
                               "the mesh as polygons");
    else if (!isOneOf(kIgnored, keyword))
      throw BadWord(quoted(keyword) + " is not an OBJ statement", keyword);
    else
      while (cursor_.skipBlanks()) cursor_.takeWord();
  }

  /// What follows the coordinates is a weight, which means something for curves only, or
  /// a colour.
  void readVertex() {
    const std::array<double, 3> vertex = cursor_.takeVertex();
    while (cursor_.skipBlanks()) cursor_.takeWord();
    if (mesh_.vertices.size() == std::numeric_limits<int>::max())
      throw std::runtime_error("more than 2,147,483,647 vertices");
    mesh_.vertices.push_back(vertex);
  }

  void readFace() {
    while (cursor_.skipBlanks()) mesh_.faces.corners.push_back(takeId());
    if (!mesh_.faces.endFace())
      throw std::runtime_error("a face needs at least three vertices");
  }

  void readLine() {
    int before = 0, count = 0;
    for (; cursor_.skipBlanks(); ++count) {
      const int id = takeId();
      if (count > 0) mesh_.free.edges.push_back({before, id});
      before = id;
    }
    if (count < 2)
      throw std::runtime_error(
          "a line needs at least two vertices; a single vertex is a point ('p')");
  }

  void readPoints() {
    const std::size_t count = mesh_.free.points.size();
    while (cursor_.skipBlanks()) mesh_.free.points.push_back(takeId());
    if (mesh_.free.points.size() == count)
      throw std::runtime_error("'p' needs at least one vertex");
  }

  /// A corner is `v`, `v/vt`, `v//vn` or `v/vt/vn`; ids start at 1, negative ids count
  /// back from the latest vertex. Returns the id counted from 0.
  int takeId() {
    const std::size_t at = cursor_.offset();
    const std::string_view corner = cursor_.takeWord();
    long long id = 0;
    const char* const end = corner.data() + corner.size();
    const auto parsed = std::from_chars(corner.data(), end, id);
    if (parsed.ec != std::errc() || (parsed.ptr != end && *parsed.ptr != '/'))
      id = requireInteger(corner);
    if (id < 0 && id >= -numVertices()) id += numVertices() + 1;
    if (id < 1 || id > std::numeric_limits<int>::max())
      throw std::runtime_error("vertex id " + quoted(corner) + " is out of range");
    if (id > largest_id_) {
      largest_id_ = id;
      largest_at_ = at;
    }
    return static_cast<int>(id - 1);
  }

  /// The id of a corner that has a plus or does not fit.
  static long long requireInteger(std::string_view corner) {
    const std::string_view word = corner.substr(0, corner.find('/'));
    long long id = 0;
    if (!parseInteger(word, id))
      throw BadWord(quoted(corner) + " is not a vertex id", corner);
    return id;
  }

  TextCursor<true, true> cursor_;
  PolygonMesh mesh_;
  long long largest_id_{0};
  std::size_t largest_at_{0};
};

}  // namespace

PolygonMesh parseObj(std::string_view file) { return ObjReader(file).read(); }

}  // namespace fcl_ccd

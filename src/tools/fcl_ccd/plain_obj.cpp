// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "plain_mesh.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

using Tokens = std::vector<std::string_view>;

/// Statements of the format that do not concern vertices and faces.
constexpr std::string_view kIgnored[] = {
    "vn",       "vt",       "vp",   "g",     "o",      "s",          "usemtl",
    "mtllib",   "l",        "p",    "mg",    "usemap", "maplib",     "bevel",
    "c_interp", "d_interp", "lod",  "deg",   "bmat",   "step",       "cstype",
    "curv",     "curv2",    "surf", "parm",  "trim",   "hole",       "scrv",
    "sp",       "end",      "con",  "ctech", "stech",  "bsp",        "bzp",
    "cdc",      "cdp",      "res",  "call",  "csh",    "shadow_obj", "trace_obj"};

bool isIgnored(std::string_view keyword) {
  return std::find(std::begin(kIgnored), std::end(kIgnored), keyword) !=
         std::end(kIgnored);
}

/// Takes one statement without its comments. Joins lines that end in a backslash outside
/// of a comment.
bool takeStatement(std::string_view& text, std::string& statement, std::size_t& line_no) {
  statement.clear();
  for (std::string_view line; takeLine(text, line);) {
    ++line_no;
    line = line.substr(0, line.find('#'));
    const bool continued = !line.empty() && line.back() == '\\';
    if (continued) line.remove_suffix(1);
    statement.append(line).append(1, ' ');
    if (!continued) return true;
  }
  return !statement.empty();
}

class PlainObj {
 public:
  void add(const Tokens& tokens, std::size_t line_no) {
    if (tokens[0] == "v")
      addVertex(tokens);
    else if (tokens[0] == "f")
      addFace(tokens, line_no);
    else if (!isIgnored(tokens[0]))
      throw std::runtime_error(quoted(tokens[0]) + " is not an OBJ statement");
  }

  /// Faces may come before their vertices, so ids are compared with the count at the end.
  std::string finish() {
    if (largest_id_ > num_vertices_)
      throw std::runtime_error("line " + std::to_string(largest_id_line_) +
                               ": vertex id " + std::to_string(largest_id_) +
                               " is out of range; there are " +
                               std::to_string(num_vertices_));
    return std::move(text_);
  }

 private:
  void addVertex(const Tokens& tokens) {
    if (tokens.size() < 4) throw std::runtime_error("a vertex needs three coordinates");
    text_ += 'v';
    for (std::size_t k = 1; k <= 3; ++k) {
      requireFinite(tokens[k]);
      text_.append(1, ' ').append(tokens[k]);
    }
    text_ += '\n';
    ++num_vertices_;
  }

  void addFace(const Tokens& tokens, std::size_t line_no) {
    if (tokens.size() < 4)
      throw std::runtime_error("a face needs at least three vertices");
    text_ += 'f';
    for (std::size_t k = 1; k < tokens.size(); ++k) {
      const long long id = vertexId(tokens[k]);
      if (id > largest_id_) {
        largest_id_ = id;
        largest_id_line_ = line_no;
      }
      text_.append(1, ' ').append(std::to_string(id));
    }
    text_ += '\n';
  }

  /// A corner is `v`, `v/vt`, `v//vn` or `v/vt/vn`; ids start at 1, negative ids count
  /// back from the latest vertex.
  long long vertexId(std::string_view corner) const {
    const std::string_view word = corner.substr(0, corner.find('/'));
    long long id = 0;
    if (!parseInteger(word, id))
      throw std::runtime_error(quoted(corner) + " is not a vertex id");
    if (id < 0 && id >= -num_vertices_) id += num_vertices_ + 1;
    if (id < 1 || id > std::numeric_limits<int>::max())
      throw std::runtime_error("vertex id " + quoted(word) + " is out of range");
    return id;
  }

  std::string text_;
  long long num_vertices_{0};
  long long largest_id_{0};
  std::size_t largest_id_line_{0};
};

}  // namespace

std::string plainObj(std::string_view file) {
  PlainObj plain;
  std::string statement;
  Tokens tokens;
  std::size_t line_no = 0;
  while (takeStatement(file, statement, line_no)) {
    splitTokens(statement, tokens);
    if (tokens.empty()) continue;
    namingPlace([&] { return "line " + std::to_string(line_no); },
                [&] { plain.add(tokens, line_no); });
  }
  return plain.finish();
}

}  // namespace fcl_ccd

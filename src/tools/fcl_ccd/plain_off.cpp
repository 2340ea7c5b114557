// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <vector>

#include "plain_mesh.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

using Tokens = std::vector<std::string_view>;

/// The lines of a file without comments and blank lines.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  bool next(Tokens& tokens) {
    for (std::string_view line; takeLine(text_, line);) {
      ++line_no_;
      splitTokens(line.substr(0, line.find('#')), tokens);
      if (!tokens.empty()) return true;
    }
    return false;
  }

  std::string place() const { return "line " + std::to_string(line_no_); }

 private:
  std::string_view text_;
  std::size_t line_no_{0};
};

struct Sizes {
  long long vertices{0};
  long long faces{0};
};

/// The word OFF, after optional prefixes for texture, colour and normal.
bool isOffKeyword(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N"})
    if (word.substr(0, prefix.size()) == prefix) word.remove_prefix(prefix.size());
  return word == "OFF";
}

/// Reads `OFF` and the numbers of vertices, faces and edges, on one line or on two.
Sizes readHeader(LineReader& lines) {
  Tokens tokens;
  if (!lines.next(tokens)) throw std::runtime_error("the file is empty");
  if (!isOffKeyword(tokens[0]))
    throw std::runtime_error(lines.place() + ": a three-dimensional OFF mesh begins " +
                             "with OFF, not with " + quoted(tokens[0]));
  tokens.erase(tokens.begin());
  if (tokens.empty() && !lines.next(tokens))
    throw std::runtime_error("the file ends before the number of vertices");
  if (tokens[0] == "BINARY")
    throw std::runtime_error("binary OFF is not supported; use text OFF or PLY");
  Sizes sizes;
  if (tokens.size() < 2 || !parseInteger(tokens[0], sizes.vertices) ||
      !parseInteger(tokens[1], sizes.faces) || sizes.vertices < 0 || sizes.faces < 0)
    throw std::runtime_error(lines.place() + ": expected the numbers of vertices and " +
                             "faces, found " + quoted(tokens[0]));
  return sizes;
}

void appendVertex(const Tokens& tokens, std::string& out) {
  if (tokens.size() < 3) throw std::runtime_error("a vertex needs three coordinates");
  for (std::size_t k = 0; k < 3; ++k) {
    requireFinite(tokens[k]);
    out.append(tokens[k]).append(1, k < 2 ? ' ' : '\n');
  }
}

void appendFace(const Tokens& tokens, long long num_vertices, std::string& out) {
  long long corners = 0;
  if (!parseInteger(tokens[0], corners) || corners < 3)
    throw std::runtime_error(
        "a face begins with its number of vertices, at least 3, not with " +
        quoted(tokens[0]));
  if (static_cast<unsigned long long>(corners) >= tokens.size())
    throw std::runtime_error("the line ends before the face's " +
                             std::to_string(corners) + " vertex ids");
  out.append(std::to_string(corners));
  for (std::size_t k = 1; k <= static_cast<std::size_t>(corners); ++k) {
    long long id = 0;
    if (!parseInteger(tokens[k], id))
      throw std::runtime_error(quoted(tokens[k]) + " is not a vertex id");
    if (id < 0 || id >= num_vertices)
      throw std::runtime_error("vertex id " + quoted(tokens[k]) + " is out of range");
    out.append(1, ' ').append(std::to_string(id));
  }
  out += '\n';
}

}  // namespace

std::string plainOff(std::string_view file) {
  LineReader lines(file);
  const Sizes sizes = readHeader(lines);
  std::string out = "OFF\n" + std::to_string(sizes.vertices) + ' ' +
                    std::to_string(sizes.faces) + " 0\n";
  out.reserve(file.size() + out.size());
  Tokens tokens;
  const auto readItems = [&](const char* what, long long count, auto append) {
    for (long long i = 0; i < count; ++i) {
      if (!lines.next(tokens))
        throw std::runtime_error("the file ends before " + std::string(what) + ' ' +
                                 std::to_string(i) + " of " + std::to_string(count) +
                                 " (counted from 0)");
      namingPlace([&] { return lines.place(); }, append);
    }
  };
  readItems("vertex", sizes.vertices, [&] { appendVertex(tokens, out); });
  readItems("face", sizes.faces, [&] { appendFace(tokens, sizes.vertices, out); });
  if (lines.next(tokens))
    throw std::runtime_error(lines.place() + ": more lines than the header promises");
  return out;
}

}  // namespace fcl_ccd

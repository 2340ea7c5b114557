// SPDX-License-Identifier: BSD-3-Clause
#include "ply_header.h"

#include <stdexcept>

#include "text_scan.h"

namespace fcl_ccd {
namespace {

using Tokens = std::vector<std::string_view>;

struct TypeName {
  std::string_view name;
  std::string_view sized_name;
  std::size_t size;
};

/// Names of the types, in the order of PlyType.
constexpr TypeName kTypes[] = {{"char", "int8", 1},     {"uchar", "uint8", 1},
                               {"short", "int16", 2},   {"ushort", "uint16", 2},
                               {"int", "int32", 4},     {"uint", "uint32", 4},
                               {"float", "float32", 4}, {"double", "float64", 8}};

const TypeName& info(PlyType type) { return kTypes[static_cast<std::size_t>(type)]; }

PlyType parseType(std::string_view word) {
  for (std::size_t i = 0; i < std::size(kTypes); ++i)
    if (word == kTypes[i].name || word == kTypes[i].sized_name)
      return static_cast<PlyType>(i);
  throw std::runtime_error("unknown type " + quoted(word));
}

PlyFormat parseFormat(const Tokens& tokens) {
  if (tokens.size() == 3 && tokens[2] == "1.0") {
    if (tokens[1] == "ascii") return PlyFormat::kAscii;
    if (tokens[1] == "binary_little_endian") return PlyFormat::kLittleEndian;
    if (tokens[1] == "binary_big_endian") return PlyFormat::kBigEndian;
  }
  throw std::runtime_error(
      "unknown format; expected ascii, binary_little_endian or binary_big_endian, and "
      "1.0");
}

PlyElement parseElement(const Tokens& tokens) {
  long long count = -1;
  if (tokens.size() != 3 || !parseInteger(tokens[2], count) || count < 0)
    throw std::runtime_error("expected 'element NAME COUNT'");
  PlyElement element;
  element.name = tokens[1];
  element.count = static_cast<unsigned long long>(count);
  return element;
}

PlyProperty parseProperty(const Tokens& tokens) {
  PlyProperty property;
  property.is_list = tokens.size() == 5 && tokens[1] == "list";
  if (!property.is_list && tokens.size() != 3)
    throw std::runtime_error(
        "expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
  property.name = tokens.back();
  property.type = parseType(tokens[tokens.size() - 2]);
  if (property.is_list) property.count_type = parseType(tokens[2]);
  if (property.is_list && isFloating(property.count_type))
    throw std::runtime_error("the length of a list cannot be a floating-point number");
  return property;
}

void requireVertex(const PlyElement& element) {
  for (const char* name : {"x", "y", "z"}) {
    const PlyProperty* property = element.find(name);
    if (property == nullptr || property->is_list)
      throw std::runtime_error("the vertices have no coordinate " + std::string(name));
  }
}

void requireFaces(const PlyElement& element) {
  const PlyProperty* ids = vertexIds(element);
  if (ids == nullptr || !ids->is_list || isFloating(ids->type))
    throw std::runtime_error("the element '" + element.name +
                             "' has no list vertex_indices or vertex_index of integers");
}

void requireEdge(const PlyElement& element) {
  for (const char* name : {"vertex1", "vertex2"}) {
    const PlyProperty* id = element.find(name);
    if (id == nullptr || id->is_list || isFloating(id->type))
      throw std::runtime_error("the element '" + element.name + "' has no property " +
                               name + " of an integer type");
  }
}

void requireMesh(const PlyHeader& header) {
  int vertex_elements = 0, face_elements = 0, others = 0;
  for (const PlyElement& element : header.elements) {
    if (element.isVertex()) {
      requireVertex(element);
      ++vertex_elements;
    } else if (element.isFace()) {
      requireFaces(element);
      ++face_elements;
    } else if (element.isStrips()) {
      requireFaces(element);
      ++others;
    } else if (element.isEdge() && element.count > 0) {
      requireEdge(element);
      ++others;
    }
  }
  if (vertex_elements != 1) throw std::runtime_error("expected one element 'vertex'");
  if (face_elements > 1) throw std::runtime_error("expected one element 'face'");
  if (face_elements + others == 0)
    throw std::runtime_error(
        "expected an element 'face', 'tristrips' or 'edge'. Free points are 'p' "
        "statements of an OBJ file");
}

/// @return whether the header ends with this line.
bool parseLine(const Tokens& tokens, bool& format_known, PlyHeader& header) {
  const std::string_view keyword = tokens[0];
  if (keyword == "end_header") return true;
  if (keyword == "format") {
    header.format = parseFormat(tokens);
    format_known = true;
  } else if (keyword == "element") {
    header.elements.push_back(parseElement(tokens));
  } else if (keyword == "property") {
    if (header.elements.empty()) throw std::runtime_error("property before any element");
    header.elements.back().properties.push_back(parseProperty(tokens));
  } else if (keyword != "comment" && keyword != "obj_info") {
    throw std::runtime_error("unknown header line " + quoted(keyword));
  }
  return false;
}

/// The lines of a header. All end as the first one does: LF, CR LF or CR. The body may
/// begin with any byte, also with LF, so that CR alone ends a line only if the first line
/// has no LF.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view& file) : file_(file) {
    const std::size_t end = file.find_first_of("\r\n");
    const bool is_cr = end != file.npos && file[end] == '\r' &&
                       (end + 1 == file.size() || file[end + 1] != '\n');
    end_ = is_cr ? '\r' : '\n';
  }

  bool take(std::string_view& line) {
    if (file_.empty()) return false;
    const std::size_t end = file_.find(end_);
    line = file_.substr(0, end);
    file_.remove_prefix(end == file_.npos ? file_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return true;
  }

 private:
  std::string_view& file_;
  char end_;
};

}  // namespace

std::size_t sizeOf(PlyType type) { return info(type).size; }

bool isFloating(PlyType type) {
  return type == PlyType::kFloat || type == PlyType::kDouble;
}

bool isSigned(PlyType type) {
  return isFloating(type) || type == PlyType::kInt8 || type == PlyType::kInt16 ||
         type == PlyType::kInt32;
}

const PlyProperty* PlyElement::find(std::string_view property) const {
  for (const PlyProperty& candidate : properties)
    if (candidate.name == property) return &candidate;
  return nullptr;
}

const PlyProperty* vertexIds(const PlyElement& faces) {
  const PlyProperty* ids = faces.find("vertex_indices");
  return ids != nullptr ? ids : faces.find("vertex_index");
}

PlyHeader takePlyHeader(std::string_view& file) {
  PlyHeader header;
  Tokens tokens;
  HeaderLines lines(file);
  std::string_view line;
  lines.take(line);
  splitTokens(line, tokens);
  if (tokens.size() != 1 || tokens[0] != "ply")
    throw std::runtime_error("line 1: a PLY file begins with 'ply'");

  bool format_known = false;
  for (std::size_t line_no = 2; lines.take(line); ++line_no) {
    splitTokens(line, tokens);
    if (tokens.empty()) continue;
    const bool ended =
        namingPlace([&] { return "line " + std::to_string(line_no); },
                    [&] { return parseLine(tokens, format_known, header); });
    if (!ended) continue;
    if (!format_known) throw std::runtime_error("the header names no format");
    requireMesh(header);
    return header;
  }
  throw std::runtime_error("the file ends before 'end_header'");
}

}  // namespace fcl_ccd

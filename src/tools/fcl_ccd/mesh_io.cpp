// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_io.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <string_view>

#include "binary_ply.h"
#include "file_bytes.h"
#include "mesh_readers.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

void requireFewEnough(std::size_t count, const char* what) {
  if (count > std::size_t{std::numeric_limits<int>::max()})
    throw std::runtime_error(std::string("more than 2,147,483,647 ") + what);
}

PolygonMesh parse(const std::string& extension, std::string_view bytes) {
  if (extension == "stl") return parseStl(bytes);
  const std::string_view mark = bytes.substr(0, 2);
  if (mark == "\xff\xfe" || mark == "\xfe\xff")
    throw std::runtime_error("the file is text in UTF-16; save it as UTF-8");
  if (extension == "obj") return parseObj(bytes);
  if (extension == "off") return parseOff(bytes);
  PolygonMesh mesh;
  // An unusual or wrong PLY goes to the careful reader.
  if (parseBinaryPly(bytes, mesh)) return mesh;
  return parsePly(bytes);
}

#ifndef NDEBUG
bool areIdsInRange(const PolygonMesh& mesh) {
  const auto isInRange = [&mesh](int id) {
    return id >= 0 && static_cast<std::size_t>(id) < mesh.vertices.size();
  };
  const std::vector<int>&corners = mesh.faces.corners, &points = mesh.free.points;
  return std::all_of(corners.begin(), corners.end(), isInRange) &&
         std::all_of(points.begin(), points.end(), isInRange) &&
         std::all_of(
             mesh.free.edges.begin(), mesh.free.edges.end(),
             [&](const auto& edge) { return isInRange(edge[0]) && isInRange(edge[1]); });
}
#endif

PolygonMesh parseWhole(const std::string& extension, std::string_view bytes) {
  PolygonMesh mesh = parse(extension, bytes);
  if (mesh.faces.size() == 0 && mesh.free.empty())
    throw std::runtime_error(
        "the mesh has no faces, lines or points. Free points are 'p' statements of an "
        "OBJ "
        "file");
  requireFinite(mesh.vertices);
  assert(areIdsInRange(mesh));
  // A polygon has fewer triangles than corners.
  requireFewEnough(mesh.faces.corners.size(), "corners of faces");
  requireFewEnough(mesh.free.edges.size(), "lines");
  requireFewEnough(mesh.free.points.size(), "points");
  return mesh;
}

std::string knownExtensionOf(const std::string& path) {
  std::string extension = extensionOf(path);
  if (!isMeshFormat(extension))
    throw std::runtime_error(
        "unknown mesh format; expected .obj, .ply, .off or .stl. Convert it first, for "
        "example with: meshio convert IN OUT.ply (Debian package meshio-tools)");
  return extension;
}

template <typename Read>
PolygonMesh namingFile(const std::string& path, Read read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(path + ": out of memory");
  } catch (const BadWord& error) {
    throw BadWord(path + ": " + error.what(), error.word());
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

/// Appends the bytes of a value, lowest first.
template <typename Bits>
void appendLittleEndian(Bits bits, std::string& out) {
  for (std::size_t i = 0; i < sizeof bits; ++i)
    out += static_cast<char>((bits >> (8 * i)) & 0xff);
}

void appendLittleEndian(double value, std::string& out) {
  std::uint64_t bits = 0;
  static_assert(sizeof bits == sizeof value, "IEEE double");
  std::memcpy(&bits, &value, sizeof bits);
  appendLittleEndian(bits, out);
}

}  // namespace

bool Faces::endFace() {
  assert(last_end_ <= corners.size());
  const std::size_t size = corners.size() - last_end_;
  if (size != 3 && ends.empty())
    for (std::size_t end = 3; end <= last_end_; end += 3) ends.push_back(end);
  last_end_ = corners.size();
  if (size != 3 || !ends.empty()) ends.push_back(last_end_);
  assert(ends.empty() ? corners.size() % 3 == 0 : ends.back() == corners.size());
  return size >= 3;
}

std::string extensionOf(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  std::string extension;
  if (dot != std::string::npos && path[dot] == '.') extension = path.substr(dot + 1);
  for (char& c : extension)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool isMeshFormat(const std::string& extension) {
  return extension == "obj" || extension == "off" || extension == "ply" ||
         extension == "stl";
}

PolygonMesh readPolygonMesh(const std::string& path) {
  return namingFile(path, [&] {
    const std::string extension = knownExtensionOf(path);
    return parseWhole(extension, readRegularFile(path));
  });
}

PolygonMesh parsePolygonMesh(const std::string& path, std::string_view bytes) {
  return namingFile(path, [&] { return parseWhole(knownExtensionOf(path), bytes); });
}

std::string encodePaintedPly(const Mesh& mesh, const std::vector<Colour>& colours) {
  if (colours.size() != mesh.vertices.size())
    throw std::invalid_argument("a painted mesh needs one colour a vertex");
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(mesh.vertices.size()) +
                    "\nproperty double x\nproperty double y\nproperty double z\n"
                    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                    "element face " +
                    std::to_string(mesh.triangles.size()) +
                    "\nproperty list uchar int vertex_indices\n";
  if (!mesh.edges.empty())
    out += "element edge " + std::to_string(mesh.edges.size()) +
           "\nproperty int vertex1\nproperty int vertex2\n";
  out += "end_header\n";
  out.reserve(out.size() + 27 * mesh.vertices.size() + 13 * mesh.triangles.size() +
              8 * mesh.edges.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (const double x : mesh.vertices[i]) appendLittleEndian(x, out);
    for (const std::uint8_t channel : colours[i]) out += static_cast<char>(channel);
  }
  for (const auto& triangle : mesh.triangles) {
    out += '\3';
    for (const int id : triangle) appendLittleEndian(static_cast<std::uint32_t>(id), out);
  }
  for (const auto& edge : mesh.edges)
    for (const int id : edge) appendLittleEndian(static_cast<std::uint32_t>(id), out);
  return out;
}

}  // namespace fcl_ccd

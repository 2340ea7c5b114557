// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_io.h"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>

#include <cctype>
#include <cstring>
#include <istream>
#include <limits>
#include <new>
#include <stdexcept>
#include <streambuf>
#include <utility>

#include "binary_ply.h"
#include "file_bytes.h"
#include "plain_mesh.h"
#include "stl.h"

namespace fcl_ccd {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

struct PolygonSoup {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
};

/// A stream buffer over bytes, without a copy.
class ByteStreamBuffer : public std::streambuf {
 public:
  explicit ByteStreamBuffer(std::string& bytes) {
    setg(bytes.data(), bytes.data(), bytes.data() + bytes.size());
  }
};

/// @brief Converts a text file to its plain form, and reads that with CGAL's polygon soup
/// reader.
PolygonSoup readSoup(const std::string& extension, std::string bytes) {
  if (extension == "obj")
    bytes = plainObj(bytes);
  else if (extension == "off")
    bytes = plainOff(bytes);
  else
    bytes = plainPly(bytes);

  ByteStreamBuffer buffer(bytes);
  std::istream stream(&buffer);
  PolygonSoup soup;
  const auto quiet = CGAL::parameters::verbose(false);
  bool read = false;
  if (extension == "obj")
    read = CGAL::IO::read_OBJ(stream, soup.points, soup.polygons, quiet);
  else if (extension == "off")
    read = CGAL::IO::read_OFF(stream, soup.points, soup.polygons, quiet);
  else
    read = CGAL::IO::read_PLY(stream, soup.points, soup.polygons, quiet);
  constexpr const char* kBadValue = "a number does not fit its type";
  if (!read && !stream.eof()) throw std::runtime_error(kBadValue);
  if (soup.points.empty()) throw std::runtime_error("the mesh has no vertices");
  if (soup.polygons.empty()) throw std::runtime_error("the mesh has no faces");
  if (!read) throw std::runtime_error(kBadValue);
  return soup;
}

Vertices takeVertices(const std::vector<Point>& points) {
  Vertices vertices;
  vertices.reserve(points.size());
  for (const Point& p : points) vertices.push_back({p.x(), p.y(), p.z()});
  return vertices;
}

Faces takeFaces(const PolygonSoup& soup) {
  Faces faces;
  for (std::size_t i = 0; i < soup.polygons.size(); ++i) {
    const auto faceName = [i] {
      return "face " + std::to_string(i) + " (counted from 0)";
    };
    for (const std::size_t id : soup.polygons[i]) {
      if (id >= soup.points.size())
        throw std::runtime_error(faceName() + " has a vertex id that is out of range; " +
                                 "there are " + std::to_string(soup.points.size()) +
                                 " vertices");
      faces.corners.push_back(static_cast<int>(id));
    }
    if (!faces.endFace())
      throw std::runtime_error(faceName() + " has fewer than three vertices");
  }
  return faces;
}

void requireFewEnough(std::size_t count, const char* what) {
  if (count > std::size_t{std::numeric_limits<int>::max()})
    throw std::runtime_error(std::string("more than 2,147,483,647 ") + what);
}

PolygonMesh parse(const std::string& extension, std::string bytes) {
  PolygonMesh mesh;
  if (extension == "stl") return parseStl(bytes);
  // An unusual or wrong binary PLY goes to the careful reader below.
  if (extension == "ply" && parseBinaryPly(bytes, mesh)) return mesh;
  const PolygonSoup soup = readSoup(extension, std::move(bytes));
  requireFewEnough(soup.points.size(), "vertices");
  mesh.faces = takeFaces(soup);
  mesh.vertices = takeVertices(soup.points);
  return mesh;
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
  const std::size_t size = corners.size() - last_end_;
  if (size != 3 && ends.empty())
    for (std::size_t end = 3; end <= last_end_; end += 3) ends.push_back(end);
  last_end_ = corners.size();
  if (size != 3 || !ends.empty()) ends.push_back(last_end_);
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
  try {
    const std::string extension = extensionOf(path);
    if (!isMeshFormat(extension))
      throw std::runtime_error(
          "unknown mesh format; expected .obj, .ply, .off or .stl. Convert it first, for "
          "example with: meshio convert IN OUT.ply (Debian package meshio-tools)");
    PolygonMesh mesh = parse(extension, readRegularFile(path));
    requireFinite(mesh.vertices);
    // A polygon has fewer triangles than corners.
    requireFewEnough(mesh.faces.corners.size(), "faces");
    return mesh;
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(path + ": out of memory");
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
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
                    "\nproperty list uchar int vertex_indices\nend_header\n";
  out.reserve(out.size() + 27 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (const double x : mesh.vertices[i]) appendLittleEndian(x, out);
    for (const std::uint8_t channel : colours[i]) out += static_cast<char>(channel);
  }
  for (const auto& triangle : mesh.triangles) {
    out += '\3';
    for (const int id : triangle) appendLittleEndian(static_cast<std::uint32_t>(id), out);
  }
  return out;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_MESH_GENERATORS_H
#define FCL_TEST_SUPPORT_MESH_GENERATORS_H

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "fcl/common/types.h"
#include "fcl/math/triangle.h"

namespace fcl {
namespace test {

/// @brief A triangle mesh in metres. Triangles are wound so that normals of a closed
/// surface point outward, and those of a flat sheet along +z.
struct TestMesh {
  std::vector<Vector3<double>> vertices;
  std::vector<Triangle> triangles;
};

/// @brief A small random number generator (splitmix64). Unlike the distributions of
/// <random>, it gives the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// @brief The next 64 random bits.
  std::uint64_t next();

  /// @brief Uniform in [lo, hi).
  double uniform(double lo, double hi);

  /// @brief Uniform in {0, ..., count - 1}; the bias is below count / 2^64.
  std::size_t index(std::size_t count) { return next() % count; }

  /// @brief Uniform in the box [-half, half]^3.
  Vector3<double> point(double half);

 private:
  std::uint64_t state_;
};

/// @brief The position of the vertex at (u, v) in [0, 1]^2 of a sheet.
using SheetPosition = std::function<Vector3<double>(double u, double v)>;

/// @brief A sheet of nx x ny quads, 2 nx ny triangles, (nx + 1)(ny + 1) vertices with x
/// running fastest; the diagonals alternate. Without `position`, the unit square in z =
/// 0.
TestMesh makeSheet(int nx, int ny, const SheetPosition& position = {});

/// @brief A sheet whose first column of vertices is also its last: nx x ny quads, nx (ny
/// + 1) vertices.
TestMesh makeTube(int nx, int ny, const SheetPosition& position);

/// @brief The radius of a tube at an angle about its axis and a height.
using TubeRadius = std::function<double(double angle, double z)>;

/// @brief A tube about the z axis, from z = -1 to 1, of `slices` x `rings` quads.
TestMesh makeRoundTube(int slices, int rings, const TubeRadius& radius);

/// @brief The radius of a round tube of so many slices in whose facets a cylinder of
/// radius 1 just fits.
double holeRadius(int slices);

/// @brief A sphere around the origin from `slices` >= 3 meridians and `stacks` >= 2
/// rings: 2 slices (stacks - 1) triangles.
TestMesh makeUvSphere(int slices, int stacks, double radius);

/// @brief A sphere around the origin: an icosahedron whose faces were split in four
/// `subdivisions` times; 20 * 4^subdivisions triangles.
TestMesh makeIcosphere(int subdivisions, double radius);

/// @brief A sphere around the origin: an icosahedron whose edges were divided into
/// `frequency` parts; 20 frequency^2 triangles, all of about the same size.
TestMesh makeGeodesicSphere(int frequency, double radius);

/// @brief A closed surface of revolution around the z axis, of 2 slices (points - 2)
/// triangles.
/// @param profile  radius and height, from the highest point of the axis to the lowest
/// one. The radii of the first and the last point are not used.
TestMesh makeLathe(int slices, const std::vector<std::array<double, 2>>& profile);

/// @brief A capsule from (0, 0, 0) to (0, 0, length), of about 4 slices (rings + 1)
/// triangles.
/// @param rings  number along the straight part, and along each end
TestMesh makeCapsule(int slices, int rings, double radius, double length);

/// @brief A box around the origin, each side split into `divisions`^2 quads; closed.
TestMesh makeBox(const Vector3<double>& half_extents, int divisions = 1);

/// @brief `count` separate random tetrahedra of about `size` inside [-half, half]^3;
/// they may overlap.
TestMesh makeTetrahedronSoup(int count, double half, double size, std::uint64_t seed);

/// @brief `count` separate random triangles of about `size` inside [-half, half]^3; they
/// may overlap.
TestMesh makeTriangleSoup(int count, double half, double size, std::uint64_t seed);

/// @brief Adds a copy of `part` to `mesh` as separate vertices and triangles.
void append(TestMesh& mesh, const TestMesh& part);

/// @brief The mesh with every vertex moved by `transform`.
TestMesh transformed(const TestMesh& mesh, const Transform3<double>& transform);

/// @brief Every edge of the triangles once, the lower index first, sorted.
std::vector<std::array<int, 2>> uniqueEdges(const std::vector<Triangle>& triangles);

}  // namespace test
}  // namespace fcl

#endif

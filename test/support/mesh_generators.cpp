// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_generators.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace fcl {
namespace test {
namespace {

const double kPi = std::acos(-1.0);

Triangle triangle(int a, int b, int c) {
  return Triangle(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                  static_cast<std::size_t>(c));
}

/// The icosahedron's vertices are the corners of three golden rectangles.
TestMesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TestMesh mesh;
  mesh.vertices = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                   {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                   {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (const auto& f : faces) mesh.triangles.push_back(triangle(f[0], f[1], f[2]));
  return mesh;
}

/// Splits each triangle in four at the middle of its edges.
TestMesh subdivided(const TestMesh& mesh) {
  TestMesh fine;
  fine.vertices = mesh.vertices;
  std::map<std::pair<std::size_t, std::size_t>, int> middle_of;
  const auto middle = [&](std::size_t a, std::size_t b) {
    const auto key = std::minmax(a, b);
    const auto found = middle_of.find(key);
    if (found != middle_of.end()) return found->second;
    const int id = static_cast<int>(fine.vertices.size());
    fine.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
    middle_of.emplace(key, id);
    return id;
  };
  for (const Triangle& t : mesh.triangles) {
    const int corner[3] = {static_cast<int>(t[0]), static_cast<int>(t[1]),
                           static_cast<int>(t[2])};
    const int m[3] = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
    for (int k = 0; k < 3; ++k)
      fine.triangles.push_back(triangle(corner[k], m[k], m[(k + 2) % 3]));
    fine.triangles.push_back(triangle(m[0], m[1], m[2]));
  }
  return fine;
}

}  // namespace

std::uint64_t Random::next() {
  state_ += 0x9E3779B97F4A7C15u;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

double Random::uniform(double lo, double hi) {
  return lo + (hi - lo) * (static_cast<double>(next() >> 11) * 0x1p-53);
}

Vector3<double> Random::point(double half) {
  const double x = uniform(-half, half);
  const double y = uniform(-half, half);
  const double z = uniform(-half, half);
  return {x, y, z};
}

TestMesh makeSheet(int nx, int ny, const SheetPosition& position) {
  TestMesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const double u = static_cast<double>(i) / nx;
      const double v = static_cast<double>(j) / ny;
      mesh.vertices.push_back(position ? position(u, v) : Vector3<double>(u, v, 0));
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i;
      const int b = a + 1;
      const int c = b + nx + 1;
      const int d = a + nx + 1;
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back(triangle(a, b, c));
        mesh.triangles.push_back(triangle(a, c, d));
      } else {
        mesh.triangles.push_back(triangle(a, b, d));
        mesh.triangles.push_back(triangle(b, c, d));
      }
    }
  return mesh;
}

TestMesh makeTube(int nx, int ny, const SheetPosition& position) {
  const TestMesh sheet = makeSheet(nx, ny, position);
  TestMesh mesh;
  const auto columns = static_cast<std::size_t>(nx);
  for (std::size_t v = 0; v < sheet.vertices.size(); ++v)
    if (v % (columns + 1) != columns) mesh.vertices.push_back(sheet.vertices[v]);
  const auto id = [&](std::size_t v) {
    return v / (columns + 1) * columns + v % (columns + 1) % columns;
  };
  for (const Triangle& t : sheet.triangles)
    mesh.triangles.emplace_back(id(t[0]), id(t[1]), id(t[2]));
  return mesh;
}

TestMesh makeRoundTube(int slices, int rings, const TubeRadius& radius) {
  return makeTube(slices, rings, [&](double u, double v) {
    const double angle = 2 * kPi * u, z = 2 * v - 1, r = radius(angle, z);
    return Vector3<double>(r * std::cos(angle), r * std::sin(angle), z);
  });
}

double holeRadius(int slices) { return 1 / std::cos(kPi / slices); }

TestMesh makeUvSphere(int slices, int stacks, double radius) {
  TestMesh mesh;
  mesh.vertices.emplace_back(0, 0, radius);
  for (int j = 1; j < stacks; ++j)
    for (int i = 0; i < slices; ++i) {
      const double polar = kPi * j / stacks;
      const double azimuth = 2 * kPi * i / slices;
      mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(azimuth),
                                 radius * std::sin(polar) * std::sin(azimuth),
                                 radius * std::cos(polar));
    }
  mesh.vertices.emplace_back(0, 0, -radius);
  const int south = static_cast<int>(mesh.vertices.size()) - 1;
  const auto id = [&](int ring, int i) { return 1 + ring * slices + i % slices; };
  for (int i = 0; i < slices; ++i) {
    mesh.triangles.push_back(triangle(0, id(0, i), id(0, i + 1)));
    for (int j = 0; j + 2 < stacks; ++j) {
      mesh.triangles.push_back(triangle(id(j, i), id(j + 1, i), id(j + 1, i + 1)));
      mesh.triangles.push_back(triangle(id(j, i), id(j + 1, i + 1), id(j, i + 1)));
    }
    mesh.triangles.push_back(triangle(id(stacks - 2, i), south, id(stacks - 2, i + 1)));
  }
  return mesh;
}

TestMesh makeIcosphere(int subdivisions, double radius) {
  TestMesh mesh = icosahedron();
  for (int level = 0; level < subdivisions; ++level) mesh = subdivided(mesh);
  for (Vector3<double>& v : mesh.vertices) v *= radius / v.norm();
  return mesh;
}

TestMesh makeGeodesicSphere(int frequency, double radius) {
  const TestMesh coarse = icosahedron();
  TestMesh mesh;
  // The corners between which a point lies, and its weights on them, identify it.
  std::map<std::array<std::size_t, 6>, int> id_of;
  const auto vertex = [&](const Triangle& t, int i, int j) {
    const int weights[3] = {frequency - i - j, i, j};
    std::array<std::array<std::size_t, 2>, 3> key{};
    Vector3<double> p = Vector3<double>::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto weight = static_cast<std::size_t>(weights[k]);
      key[static_cast<std::size_t>(k)] = {{weight > 0 ? t[k] + 1 : 0, weight}};
      p += weights[k] * coarse.vertices[t[k]];
    }
    std::sort(key.begin(), key.end());
    const auto inserted =
        id_of.emplace(std::array<std::size_t, 6>{{key[0][0], key[0][1], key[1][0],
                                                  key[1][1], key[2][0], key[2][1]}},
                      static_cast<int>(mesh.vertices.size()));
    if (inserted.second) mesh.vertices.push_back(p * (radius / p.norm()));
    return inserted.first->second;
  };
  for (const Triangle& t : coarse.triangles)
    for (int i = 0; i < frequency; ++i)
      for (int j = 0; i + j < frequency; ++j) {
        const int a = vertex(t, i, j), b = vertex(t, i + 1, j), c = vertex(t, i, j + 1);
        mesh.triangles.push_back(triangle(a, b, c));
        if (i + j + 1 < frequency)
          mesh.triangles.push_back(triangle(b, vertex(t, i + 1, j + 1), c));
      }
  return mesh;
}

TestMesh makeLathe(int slices, const std::vector<std::array<double, 2>>& profile) {
  const int stacks = static_cast<int>(profile.size()) - 1;
  TestMesh mesh = makeUvSphere(slices, stacks, 1);
  mesh.vertices.front() = {0, 0, profile.front()[1]};
  mesh.vertices.back() = {0, 0, profile.back()[1]};
  std::size_t v = 1;
  for (std::size_t j = 1; j + 1 < profile.size(); ++j)
    for (int i = 0; i < slices; ++i) {
      const double azimuth = 2 * kPi * i / slices;
      mesh.vertices[v++] = {profile[j][0] * std::cos(azimuth),
                            profile[j][0] * std::sin(azimuth), profile[j][1]};
    }
  return mesh;
}

TestMesh makeCapsule(int slices, int rings, double radius, double length) {
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i <= rings; ++i) {
    const double polar = 0.5 * kPi * i / rings;
    profile.push_back({{radius * std::sin(polar), length + radius * std::cos(polar)}});
  }
  for (int i = 1; i < rings; ++i)
    profile.push_back({{radius, length * (1 - static_cast<double>(i) / rings)}});
  for (int i = 0; i <= rings; ++i) {
    const double polar = 0.5 * kPi * (1 + static_cast<double>(i) / rings);
    profile.push_back({{radius * std::sin(polar), radius * std::cos(polar)}});
  }
  return makeLathe(slices, profile);
}

TestMesh makeBox(const Vector3<double>& half_extents, int divisions) {
  TestMesh mesh;
  std::map<std::array<int, 3>, int> id_of;
  const auto vertex = [&](const std::array<int, 3>& cell) {
    const auto inserted = id_of.emplace(cell, static_cast<int>(mesh.vertices.size()));
    if (inserted.second) {
      Vector3<double> p;
      for (int k = 0; k < 3; ++k)
        p[k] = half_extents[k] * (2.0 * cell[k] / divisions - 1);
      mesh.vertices.push_back(p);
    }
    return inserted.first->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int j = 0; j < divisions; ++j)
        for (int i = 0; i < divisions; ++i) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> cell;
            cell[axis] = side * divisions;
            cell[(axis + 1) % 3] = i + di;
            cell[(axis + 2) % 3] = j + dj;
            return vertex(cell);
          };
          const int a = corner(0, 0);
          const int b = side == 1 ? corner(1, 0) : corner(0, 1);
          const int c = corner(1, 1);
          const int d = side == 1 ? corner(0, 1) : corner(1, 0);
          mesh.triangles.push_back(triangle(a, b, c));
          mesh.triangles.push_back(triangle(a, c, d));
        }
  return mesh;
}

TestMesh makeTetrahedronSoup(int count, double half, double size, std::uint64_t seed) {
  TestMesh mesh;
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Vector3<double> center = random.point(half);
    Vector3<double> p[4];
    for (auto& corner : p) corner = center + random.point(size / 2);
    if ((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) < 0) std::swap(p[0], p[1]);
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), p, p + 4);
    mesh.triangles.push_back(triangle(first, first + 2, first + 1));
    mesh.triangles.push_back(triangle(first, first + 1, first + 3));
    mesh.triangles.push_back(triangle(first, first + 3, first + 2));
    mesh.triangles.push_back(triangle(first + 1, first + 2, first + 3));
  }
  return mesh;
}

TestMesh makeTriangleSoup(int count, double half, double size, std::uint64_t seed) {
  TestMesh mesh;
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Vector3<double> center = random.point(half);
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(center + random.point(size / 2));
    mesh.triangles.push_back(triangle(3 * i, 3 * i + 1, 3 * i + 2));
  }
  return mesh;
}

void append(TestMesh& mesh, const TestMesh& part) {
  const std::size_t shift = mesh.vertices.size();
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const Triangle& t : part.triangles)
    mesh.triangles.emplace_back(t[0] + shift, t[1] + shift, t[2] + shift);
}

TestMesh transformed(const TestMesh& mesh, const Transform3<double>& transform) {
  TestMesh moved = mesh;
  for (Vector3<double>& v : moved.vertices) v = transform * v;
  return moved;
}

std::vector<std::array<int, 2>> uniqueEdges(const std::vector<Triangle>& triangles) {
  std::vector<std::array<int, 2>> edges;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = static_cast<int>(t[k]);
      const int b = static_cast<int>(t[(k + 1) % 3]);
      edges.push_back({{std::min(a, b), std::max(a, b)}});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace test
}  // namespace fcl

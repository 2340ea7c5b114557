// SPDX-License-Identifier: BSD-3-Clause
#include "fragile_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace fcl {
namespace test {
namespace {

/// Sets of items that are united pair by pair. The lowest item of a set is its name.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int item) {
    while (at(item) != item) item = at(item) = at(at(item));
    return item;
  }
  void unite(int a, int b) {
    a = find(a);
    b = find(b);
    at(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& at(int item) { return parent_[static_cast<std::size_t>(item)]; }
  std::vector<int> parent_;
};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

FragileShell::FragileShell(ShellDesign design)
    : sheet_(std::move(design.sheet)),
      outer_(std::move(design.outer)),
      inner_(std::move(design.inner)),
      piece_of_(std::move(design.piece_of)) {
  num_pieces_ = 1 + *std::max_element(piece_of_.begin(), piece_of_.end());
  findNeighbours();
  findBonds();
  place(0, 0);
}

/// Sorts the edges by their vertices: the two sides of an edge become neighbours.
void FragileShell::findNeighbours() {
  std::vector<std::array<int, 3>> edges;
  edges.reserve(3 * sheet_.size());
  for (int corner = 0; corner < static_cast<int>(3 * sheet_.size()); ++corner) {
    const int a = sheetVertex(corner), b = sheetVertex(next(corner));
    edges.push_back({{std::min(a, b), std::max(a, b), corner}});
  }
  std::sort(edges.begin(), edges.end());
  neighbour_.assign(edges.size(), -1);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (edges[i][0] == edges[i + 1][0] && edges[i][1] == edges[i + 1][1]) {
      neighbour_[index(edges[i][2])] = edges[i + 1][2];
      neighbour_[index(edges[i + 1][2])] = edges[i][2];
    }
}

void FragileShell::findBonds() {
  std::map<std::pair<int, int>, std::size_t> bond_of;
  for (int corner = 0; corner < static_cast<int>(neighbour_.size()); ++corner) {
    const int other = neighbour_[index(corner)];
    if (other < corner) continue;
    const int a = piece_of_[index(corner / 3)], b = piece_of_[index(other / 3)];
    if (a == b) continue;
    const auto inserted = bond_of.emplace(std::minmax(a, b), bonds_.size());
    if (inserted.second)
      bonds_.push_back({inserted.first->first.first, inserted.first->first.second,
                        Vector3<double>::Zero(), 0, 0, false});
    Bond& bond = bonds_[inserted.first->second];
    for (const int v : {sheetVertex(corner), sheetVertex(next(corner))})
      bond.place += 0.25 * (outer_[index(v)] + inner_[index(v)]);
    ++bond.edges;
  }
  for (Bond& bond : bonds_) bond.place /= bond.edges;
}

void FragileShell::place(int first_vertex, int first_triangle) {
  first_triangle_ = first_triangle;
  const int layer = static_cast<int>(outer_.size());
  vertices_.clear();
  walls_.clear();
  has_wall_.assign(neighbour_.size(), 0);
  int next_triangle = first_triangle + static_cast<int>(2 * sheet_.size());
  for (int corner = 0; corner < static_cast<int>(neighbour_.size()); ++corner) {
    const int v = first_vertex + sheetVertex(corner);
    vertices_.push_back({v, v + layer});
    if (neighbour_[index(corner)] >= 0) continue;
    walls_.push_back({corner, next_triangle});
    has_wall_[index(corner)] = 1;
    next_triangle += 2;
  }
}

/// Both sides of a crack divide their walls along the same diagonal.
std::vector<Triangle> FragileShell::wallOf(int corner) const {
  const auto triangle = [](int a, int b, int c) {
    return Triangle(index(a), index(b), index(c));
  };
  const VertexPair& a = vertices_[index(corner)];
  const VertexPair& b = vertices_[index(next(corner))];
  if (sheetVertex(corner) < sheetVertex(next(corner)))
    return {triangle(b.outer, a.outer, b.inner), triangle(a.outer, a.inner, b.inner)};
  return {triangle(b.outer, a.outer, a.inner), triangle(b.outer, a.inner, b.inner)};
}

TestMesh FragileShell::mesh() const {
  TestMesh mesh;
  mesh.vertices = outer_;
  mesh.vertices.insert(mesh.vertices.end(), inner_.begin(), inner_.end());
  mesh.triangles.resize(2 * sheet_.size() + 2 * walls_.size(), Triangle(0, 0, 0));
  TopologyChange all;
  setTriangles(mesh.triangles, all);
  return mesh;
}

/// Writes the triangles of both layers and of all walls, and records those that change.
void FragileShell::setTriangles(std::vector<Triangle>& triangles,
                                TopologyChange& change) const {
  const auto set = [&](std::size_t id, const Triangle& t) {
    Triangle& old = triangles[id];
    if (old[0] == t[0] && old[1] == t[1] && old[2] == t[2]) return;
    old = t;
    if (id < change.first_new_triangle)
      change.changed_triangles.push_back(static_cast<int>(id));
  };
  const std::size_t first = index(first_triangle_);
  for (std::size_t t = 0; t < sheet_.size(); ++t) {
    const VertexPair* v = &vertices_[3 * t];
    set(first + t, Triangle(index(v[0].outer), index(v[1].outer), index(v[2].outer)));
    set(first + sheet_.size() + t,
        Triangle(index(v[0].inner), index(v[2].inner), index(v[1].inner)));
  }
  for (const Wall& wall : walls_) {
    const std::vector<Triangle> two = wallOf(wall.corner);
    for (int k = 0; k < 2; ++k) set(index(wall.triangle + k), two[index(k)]);
  }
}

std::vector<int> FragileShell::findParts() const {
  DisjointSets sets(index(num_pieces_));
  for (const Bond& bond : bonds_)
    if (!bond.is_broken) sets.unite(bond.piece_a, bond.piece_b);
  std::vector<int> part_of(index(num_pieces_), -1);
  int parts = 0;
  for (int piece = 0; piece < num_pieces_; ++piece) {
    const int first = sets.find(piece);
    part_of[index(piece)] = first == piece ? parts++ : part_of[index(first)];
  }
  return part_of;
}

std::vector<std::vector<int>> FragileShell::verticesOf(
    const std::vector<int>& part_of_piece) const {
  const int parts = 1 + *std::max_element(part_of_piece.begin(), part_of_piece.end());
  std::vector<std::vector<int>> vertices(index(parts));
  for (std::size_t corner = 0; corner < vertices_.size(); ++corner) {
    auto& part = vertices[index(part_of_piece[index(piece_of_[corner / 3])])];
    part.push_back(vertices_[corner].outer);
    part.push_back(vertices_[corner].inner);
  }
  for (auto& part : vertices) {
    std::sort(part.begin(), part.end());
    part.erase(std::unique(part.begin(), part.end()), part.end());
  }
  return vertices;
}

/// The corners at one vertex that are connected by triangles of one part.
std::vector<int> FragileShell::groupCorners(const std::vector<int>& part_of_piece) const {
  const auto part = [&](int corner) {
    return part_of_piece[index(piece_of_[index(triangleOf(corner))])];
  };
  DisjointSets sets(neighbour_.size());
  for (int corner = 0; corner < static_cast<int>(neighbour_.size()); ++corner) {
    const int other = neighbour_[index(corner)];
    if (other < corner || part(corner) != part(other)) continue;
    const bool opposed = sheetVertex(corner) == sheetVertex(next(other));
    sets.unite(corner, opposed ? next(other) : other);
    sets.unite(next(corner), opposed ? other : next(other));
  }
  std::vector<int> group_of(neighbour_.size());
  for (std::size_t corner = 0; corner < group_of.size(); ++corner)
    group_of[corner] = sets.find(static_cast<int>(corner));
  return group_of;
}

/// A direction along the bisector of the group's angle, projected along the wall's edge
/// at the vertex. It leads away from both borders of the group. The vertex stays on the
/// surface, in the triangle that the bisector crosses, and so does not come closer to
/// other surfaces.
void FragileShell::drawBack(const std::vector<int>& group_of,
                            const std::vector<char>& is_split, double gap,
                            std::vector<Vector3<double>>& positions) const {
  struct Side {
    int corner;
    Vector3<double> a, b;  // its edges, projected along the wall
  };
  std::map<int, std::vector<Side>> groups;
  for (int corner = 0; corner < static_cast<int>(group_of.size()); ++corner) {
    const int group = group_of[index(corner)];
    if (!is_split[index(group)]) continue;
    const VertexPair& at = vertices_[index(corner)];
    const Vector3<double>& p = positions[index(at.outer)];
    const Vector3<double> through = (p - positions[index(at.inner)]).normalized();
    const auto across = [&](int to) -> Vector3<double> {
      const Vector3<double> edge = positions[index(vertices_[index(to)].outer)] - p;
      return edge - through.dot(edge) * through;
    };
    groups[group].push_back({corner, across(next(corner)), across(next(next(corner)))});
  }
  std::vector<std::pair<int, Vector3<double>>> moves;
  for (const auto& entry : groups) {
    Vector3<double> bisector = Vector3<double>::Zero();
    double shortest = std::numeric_limits<double>::max();
    for (const Side& s : entry.second) {
      const double angle = std::atan2(s.a.cross(s.b).norm(), s.a.dot(s.b));
      bisector += angle * (s.a.normalized() + s.b.normalized()).normalized();
      shortest = std::min({shortest, s.a.norm(), s.b.norm()});
    }
    bisector *= gap * shortest / bisector.norm();
    // The triangle in whose edges the step has the least negative weight.
    double best = -std::numeric_limits<double>::max();
    int corner = 0;
    double weights[2] = {0, 0};
    for (const Side& s : entry.second) {
      const Vector3<double> n = s.a.cross(s.b);
      const double area2 = n.squaredNorm();
      if (area2 == 0) continue;
      const double x = bisector.cross(s.b).dot(n) / area2;
      const double y = s.a.cross(bisector).dot(n) / area2;
      if (std::min(x, y) <= best) continue;
      best = std::min(x, y);
      corner = s.corner;
      weights[0] = std::max(0.0, x);
      weights[1] = std::max(0.0, y);
    }
    const VertexPair& v = vertices_[index(corner)];
    const VertexPair& a = vertices_[index(next(corner))];
    const VertexPair& b = vertices_[index(next(next(corner)))];
    const auto step = [&](int from, int to_a, int to_b) -> Vector3<double> {
      const Vector3<double>& p = positions[index(from)];
      return weights[0] * (positions[index(to_a)] - p) +
             weights[1] * (positions[index(to_b)] - p);
    };
    moves.emplace_back(v.outer, step(v.outer, a.outer, b.outer));
    moves.emplace_back(v.inner, step(v.inner, a.inner, b.inner));
  }
  for (const auto& move : moves) positions[index(move.first)] += move.second;
}

void FragileShell::split(const std::vector<int>& part_of_piece, double gap,
                         std::vector<Triangle>& triangles,
                         std::vector<Vector3<double>>& positions,
                         TopologyChange& change) {
  const std::vector<int> group_of = groupCorners(part_of_piece);
  // The first group at a vertex keeps it, the others get copies.
  std::vector<int> keeper(positions.size(), -1);
  std::vector<char> is_split(group_of.size(), 0);
  for (std::size_t corner = 0; corner < group_of.size(); ++corner) {
    const int group = group_of[corner];
    VertexPair& pair = vertices_[corner];
    if (static_cast<int>(corner) != group) {
      pair = vertices_[index(group)];
      continue;
    }
    int& first = keeper[index(pair.outer)];
    if (first < 0) {
      first = group;
      continue;
    }
    is_split[index(first)] = is_split[index(group)] = 1;
    for (int* id : {&pair.outer, &pair.inner}) {
      change.split_from.push_back(*id);
      const Vector3<double> p = positions[index(*id)];
      *id = static_cast<int>(positions.size());
      positions.push_back(p);
    }
  }
  drawBack(group_of, is_split, gap, positions);
  for (int corner = 0; corner < static_cast<int>(neighbour_.size()); ++corner) {
    const int other = neighbour_[index(corner)];
    if (has_wall_[index(corner)] || other < 0) continue;
    if (part_of_piece[index(piece_of_[index(corner / 3)])] ==
        part_of_piece[index(piece_of_[index(other / 3)])])
      continue;
    walls_.push_back({corner, static_cast<int>(triangles.size())});
    has_wall_[index(corner)] = 1;
    triangles.resize(triangles.size() + 2, Triangle(0, 0, 0));
  }
  setTriangles(triangles, change);
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/vertex_weld.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <unordered_map>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using Position = std::array<double, 3>;

template <typename S>
Position positionOf(const S* coordinates, std::size_t vertex) {
  Position p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = static_cast<double>(coordinates[3 * vertex + k]);
  assert(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]));
  return p;
}

bool coincide(const Position& p, const Position& q, double eps) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(std::abs(p[k] - q[k]) <= eps)) return false;
  return true;
}

/// @brief A cell of a grid in which the vertices that have left a vertex are found.
struct Cell {
  int left;
  Position at;

  bool operator==(const Cell& other) const {
    return left == other.left && at == other.at;
  }
};

/// Cells are twice as wide as eps. So the quotients of vertices that coincide differ by
/// one half, and their cells by at most one, whatever is rounded. From 2^53 eps on,
/// numbers that differ do not coincide, and any cell does. With eps = 0 a cell is a
/// position.
double cellAlongAxis(double x, double eps) {
  const double cell = eps > 0 ? std::floor(0.5 * (x / eps)) : x;
  return (std::isfinite(cell) ? cell : x) + 0.0;  // -0.0 becomes 0.0
}

Cell cellOf(int left, const Position& p, double eps) {
  Cell cell{left, p};
  for (double& x : cell.at) x = cellAlongAxis(x, eps);
  return cell;
}

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::size_t hash = static_cast<std::size_t>(cell.left);
    for (const double x : cell.at) {
      // From splitmix64 (Steele, Lea, Flood 2014): spreads neighbouring cells.
      hash = (hash ^ std::hash<double>()(x)) * 0xbf58476d1ce4e5b9u;
      hash ^= hash >> 27;
    }
    return hash;
  }
};

template <typename Visit>
void forEachNeighbour(const Cell& cell, int width, Visit visit) {
  for (int i = -width; i <= width; ++i)
    for (int j = -width; j <= width; ++j)
      for (int k = -width; k <= width; ++k)
        visit(Cell{cell.left, {{cell.at[0] + i, cell.at[1] + j, cell.at[2] + k}}});
}

}  // namespace

template <typename S>
bool VertexWeld::refine(const S* coordinates) {
  bool changed = false;
  // A vertex that has left the vertex it was joined to may join another one that has left
  // its own. These are the ones that can be joined, by the cell of their position.
  std::unordered_map<Cell, std::vector<int>, CellHash> heads;
  for (std::size_t i = 0; i < map_.size(); ++i) {
    const int left = map_[i], own = static_cast<int>(i);
    const Position p = positionOf(coordinates, i);
    const auto coincidesWith = [&](int id) {
      return coincide(p, positionOf(coordinates, static_cast<std::size_t>(id)), eps_);
    };
    if (left == own || coincidesWith(left)) continue;
    const Cell cell = cellOf(left, p, eps_);
    int joined = own;
    forEachNeighbour(cell, eps_ > 0 ? 1 : 0, [&](const Cell& neighbour) {
      const auto found = heads.find(neighbour);
      if (found == heads.end()) return;
      for (const int id : found->second)
        if (id < joined && coincidesWith(id)) joined = id;
    });
    if (joined == own) heads[cell].push_back(own);
    map_[i] = joined;
    // The vertex that others are joined to is joined to itself, and has the least number.
    assert(joined <= own && map_[static_cast<std::size_t>(joined)] == joined);
    changed = true;
  }
  return changed;
}

template bool VertexWeld::refine(const double*);
template bool VertexWeld::refine(const float*);

std::size_t VertexWeld::numJoined() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < map_.size(); ++i)
    if (map_[i] != static_cast<int>(i)) ++count;
  return count;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

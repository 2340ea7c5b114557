// SPDX-License-Identifier: BSD-3-Clause
#include "weld.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>

namespace fcl_ccd {
namespace {

using Position = std::array<double, 3>;

bool coincide(const Position& p, const Position& q, double eps) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(std::abs(p[k] - q[k]) <= eps)) return false;
  return true;
}

/// @brief The grid cell of a position; with distance 0 the position itself. Beyond 2^53
/// cells from the origin the distance of neighbouring doubles is larger than a cell.
Position cellOf(const Position& p, double eps) {
  Position cell;
  for (std::size_t k = 0; k < 3; ++k)
    cell[k] = (eps > 0 ? std::floor(p[k] / eps) : p[k]) + 0.0;  // -0.0 becomes 0.0
  return cell;
}

struct CellHash {
  std::size_t operator()(const Position& cell) const {
    std::size_t hash = 0;
    for (const double x : cell) {
      // From splitmix64 (Steele, Lea, Flood 2014): spreads neighbouring cells.
      hash = (hash ^ std::hash<double>()(x)) * 0xbf58476d1ce4e5b9u;
      hash ^= hash >> 27;
    }
    return hash;
  }
};

template <typename Visit>
void forEachNeighbour(const Position& cell, int reach, Visit visit) {
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k)
        visit(Position{cell[0] + i, cell[1] + j, cell[2] + k});
}

}  // namespace

bool isSoup(const Vertices& vertices, const Triangles& triangles) {
  std::vector<char> used(vertices.size(), 0);
  for (const auto& triangle : triangles)
    for (const int id : triangle) {
      if (used[static_cast<std::size_t>(id)] != 0) return false;
      used[static_cast<std::size_t>(id)] = 1;
    }
  return Weld(vertices, 0).numJoined() > 0;
}

Weld::Weld(const Vertices& first_frame, double eps)
    : eps_(eps), map_(first_frame.size()) {
  // The vertices that others are joined to, by cell. Cells are as wide as the distance.
  std::unordered_map<Position, std::vector<int>, CellHash> lowest;
  const int reach = eps > 0 ? 1 : 0;
  for (std::size_t i = 0; i < map_.size(); ++i) {
    const Position cell = cellOf(first_frame[i], eps);
    int joined = static_cast<int>(i);
    forEachNeighbour(cell, reach, [&](const Position& neighbour) {
      const auto found = lowest.find(neighbour);
      if (found == lowest.end()) return;
      for (const int id : found->second)
        if (id < joined &&
            coincide(first_frame[i], first_frame[static_cast<std::size_t>(id)], eps))
          joined = id;
    });
    map_[i] = joined;
    if (joined == static_cast<int>(i)) lowest[cell].push_back(joined);
  }
}

void Weld::refine(const Vertices& frame) {
  // The vertices that are separated from a vertex, reduced to the lowest ids that others
  // of them coincide with. They are few, if there are any.
  std::vector<std::vector<int>> parted(map_.size());
  for (std::size_t i = 0; i < map_.size(); ++i) {
    const std::size_t lowest = static_cast<std::size_t>(map_[i]);
    if (lowest == i || coincide(frame[i], frame[lowest], eps_)) continue;
    std::vector<int>& heads = parted[lowest];
    const auto head = std::find_if(heads.begin(), heads.end(), [&](int id) {
      return coincide(frame[i], frame[static_cast<std::size_t>(id)], eps_);
    });
    map_[i] = head != heads.end() ? *head : static_cast<int>(i);
    if (head == heads.end()) heads.push_back(static_cast<int>(i));
  }
}

std::size_t Weld::numJoined() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < map_.size(); ++i)
    if (map_[i] != static_cast<int>(i)) ++count;
  return count;
}

void joinVertices(const std::vector<int>& map, Triangles& triangles) {
  for (auto& triangle : triangles)
    for (int& id : triangle) id = map[static_cast<std::size_t>(id)];
}

}  // namespace fcl_ccd

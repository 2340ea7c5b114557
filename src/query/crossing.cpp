// SPDX-License-Identifier: BSD-3-Clause
#include "query/crossing.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A crossing with its side, vertex ids and triangles as numbers that sort it. They are
/// made once, since a comparison that makes them takes most of the time of sorting.
struct NamedCrossing {
  std::array<std::uint64_t, 4> name;
  Crossing crossing;

  /// Whether edge and face are the same.
  bool hasFeaturesOf(const NamedCrossing& other) const {
    return std::equal(name.begin(), name.begin() + 3, other.name.begin());
  }
};

std::uint64_t joined(std::uint32_t high, std::uint32_t low) {
  return std::uint64_t{high} << 32 | low;
}

NamedCrossing named(const Crossing& c) {
  const auto [edge_lo, edge_hi] = std::minmax(c.edge[0], c.edge[1]);
  std::array<std::uint32_t, 3> face{c.face[0], c.face[1], c.face[2]};
  std::sort(face.begin(), face.end());
  return {{joined(c.first_on_a ? 0 : 1, edge_lo), joined(edge_hi, face[0]),
           joined(face[1], face[2]),
           joined(static_cast<std::uint32_t>(c.triangles[0]),
                  static_cast<std::uint32_t>(c.triangles[1]))},
          c};
}

}  // namespace

void sortCrossings(std::vector<Crossing>& crossings) {
  std::vector<NamedCrossing> all;
  all.reserve(crossings.size());
  for (const Crossing& crossing : crossings) all.push_back(named(crossing));
  std::sort(all.begin(), all.end(), [](const NamedCrossing& x, const NamedCrossing& y) {
    return x.name < y.name;
  });
  crossings.clear();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || !all[i].hasFeaturesOf(all[i - 1])) crossings.push_back(all[i].crossing);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

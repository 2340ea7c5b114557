// SPDX-License-Identifier: BSD-3-Clause
#include "query/crossing.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

template <std::size_t kCount>
std::array<std::uint32_t, kCount> sorted(const std::uint32_t (&ids)[kCount]) {
  std::array<std::uint32_t, kCount> out;
  std::copy(ids, ids + kCount, out.begin());
  std::sort(out.begin(), out.end());
  return out;
}

auto nameOf(const Crossing& c) {
  return std::make_tuple(!c.first_on_a, sorted(c.edge), sorted(c.face));
}

}  // namespace

void sortCrossings(std::vector<Crossing>& crossings) {
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& x, const Crossing& y) {
    return std::make_tuple(nameOf(x), x.triangles[0], x.triangles[1]) <
           std::make_tuple(nameOf(y), y.triangles[0], y.triangles[1]);
  });
  const auto is_same = [](const Crossing& x, const Crossing& y) {
    return nameOf(x) == nameOf(y);
  };
  crossings.erase(std::unique(crossings.begin(), crossings.end(), is_same),
                  crossings.end());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

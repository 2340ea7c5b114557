// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of boxes that meet, without a tree: for answers to compare with.
#ifndef FCL_BENCHMARK_SPEED_BOX_SWEEP_H
#define FCL_BENCHMARK_SPEED_BOX_SWEEP_H

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace fcl {
namespace test {

using Box = Eigen::AlignedBox3d;

/// @brief Calls visit(i, j) for all boxes a[i] and b[j] that meet, by a sweep along x.
template <typename Visit>
void forEachMeetingPair(const std::vector<Box>& a, const std::vector<Box>& b,
                        Visit&& visit) {
  struct Swept {
    Box box;
    std::size_t number;
  };
  std::vector<Swept> sorted;
  double widest = 0;
  for (std::size_t j = 0; j < b.size(); ++j) {
    sorted.push_back({b[j], j});
    widest = std::max(widest, b[j].sizes()[0]);
  }
  const auto startsBefore = [](const Swept& swept, double x) {
    return swept.box.min()[0] < x;
  };
  std::sort(sorted.begin(), sorted.end(), [&](const Swept& x, const Swept& y) {
    return startsBefore(x, y.box.min()[0]);
  });
  for (std::size_t i = 0; i < a.size(); ++i) {
    auto swept = std::lower_bound(sorted.begin(), sorted.end(), a[i].min()[0] - widest,
                                  startsBefore);
    for (; swept != sorted.end() && swept->box.min()[0] <= a[i].max()[0]; ++swept)
      if (swept->box.intersects(a[i])) visit(i, swept->number);
  }
}

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/binary_structure.h"

#include <algorithm>
#include <array>
#include <limits>

namespace fcl {
namespace test {
namespace {

struct Item {
  std::array<double, 3> centroid;
  std::size_t triangle;
};

/// @return how many go to the left
std::size_t split(Item* items, std::size_t count) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  double lo[3] = {kInf, kInf, kInf}, hi[3] = {-kInf, -kInf, -kInf}, sum[3] = {};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double c = items[i].centroid[k];
      lo[k] = std::min(lo[k], c);
      hi[k] = std::max(hi[k], c);
      sum[k] += c;
    }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  const double mean = sum[axis] / static_cast<double>(count);
  const Item* middle = std::partition(
      items, items + count, [&](const Item& item) { return item.centroid[axis] < mean; });
  const auto left = static_cast<std::size_t>(middle - items);
  if (left > count / 16 && count - left > count / 16) return left;
  std::nth_element(
      items, items + count / 2, items + count,
      [&](const Item& a, const Item& b) { return a.centroid[axis] < b.centroid[axis]; });
  return count / 2;
}

}  // namespace

BinaryStructure makeBinaryStructure(const FramePairMesh& mesh) {
  std::vector<Item> items(mesh.triangles.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vector3<double> sum =
        mesh.previous[t[0]] + mesh.previous[t[1]] + mesh.previous[t[2]];
    items[i] = {{sum[0], sum[1], sum[2]}, i};
  }
  BinaryStructure result;
  std::vector<std::int32_t>& links = result.links;
  struct Range {
    std::size_t first, count;
    std::int32_t node;
  };
  links.assign(1, 0);
  links.reserve(2 * items.size());
  std::vector<Range> open{{0, items.size(), 0}};
  while (!open.empty()) {
    const Range r = open.back();
    open.pop_back();
    auto& link = links[static_cast<std::size_t>(r.node)];
    if (r.count == 1) {
      link = ~static_cast<std::int32_t>(r.first);
      continue;
    }
    const std::size_t n = split(&items[r.first], r.count);
    const auto left = static_cast<std::int32_t>(links.size());
    link = left;
    links.resize(links.size() + 2);
    open.push_back({r.first + n, r.count - n, left + 1});
    open.push_back({r.first, n, left});
  }
  result.triangles.reserve(items.size());
  for (const Item& item : items) result.triangles.push_back(item.triangle);
  return result;
}

}  // namespace test
}  // namespace fcl

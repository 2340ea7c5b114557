// SPDX-License-Identifier: BSD-3-Clause
#include "tree/component_groups.h"

#include <cassert>

#include "tree/item_splitter.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

struct Group {
  Bounds bounds;
  std::size_t count{0};
};

/// Calls visit(group, first, last) for items [first, last) that follow each other.
template <typename Visit>
void forEachRun(const std::vector<std::uint32_t>& group_of, Visit&& visit) {
  for (std::size_t first = 0, last; first < group_of.size(); first = last) {
    last = first + 1;
    while (last < group_of.size() && group_of[last] == group_of[first]) ++last;
    visit(group_of[first], first, last);
  }
}

/// The groups that are not empty, in the order in which a tree would have them.
std::vector<std::uint32_t> inTreeOrder(const std::vector<Group>& groups) {
  UninitializedVector<TreeItem> centers;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].count == 0) continue;
    const Float4 center = 0.5f * groups[i].bounds.lo + 0.5f * groups[i].bounds.hi;
    centers.push_back({{center[0], center[1], center[2]}, static_cast<std::uint32_t>(i)});
  }
  return splitItems(std::move(centers), {}, MovingKdopNode::kWidth, 0).leaves;
}

}  // namespace

std::vector<std::size_t> groupItems(std::vector<std::uint32_t> component_of,
                                    std::size_t num_components, std::size_t least,
                                    UninitializedVector<TreeItem>& items) {
  assert(component_of.size() == items.size());
  std::vector<std::uint32_t> size(num_components, 0);
  for (const std::uint32_t i : component_of) {
    assert(i < num_components);
    ++size[i];
  }
  // Group 0 has all small components.
  std::vector<Group> groups(1);
  for (std::uint32_t& s : size) {
    const bool is_large = s >= least;
    s = is_large ? static_cast<std::uint32_t>(groups.size()) : 0;
    if (is_large) groups.emplace_back();
  }
  if (groups.size() == 1) return {};
  std::vector<std::uint32_t>& group_of = component_of;
  for (std::uint32_t& i : group_of) i = size[i];
  forEachRun(group_of, [&](std::uint32_t group, std::size_t first, std::size_t last) {
    Bounds bounds = groups[group].bounds;
    groups[group].count += last - first;
    for (; first < last; ++first) bounds.add(vectorOf(items[first]));
    groups[group].bounds = bounds;
  });
  const std::vector<std::uint32_t> order = inTreeOrder(groups);
  if (order.size() == 1) return {};
  std::vector<std::size_t> ends, next(groups.size());
  std::size_t end = 0;
  for (const std::uint32_t i : order) {
    next[i] = end;
    ends.push_back(end += groups[i].count);
  }
  assert(end == items.size());
  UninitializedVector<TreeItem> grouped(items.size());
  forEachRun(group_of, [&](std::uint32_t group, std::size_t first, std::size_t last) {
    std::size_t& to = next[group];
    std::copy(&items[first], &items[first] + (last - first), &grouped[to]);
    to += last - first;
  });
  items = std::move(grouped);
  return ends;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

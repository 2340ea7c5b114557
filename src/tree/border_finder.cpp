// SPDX-License-Identifier: BSD-3-Clause
#include "tree/border_finder.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

#ifndef NDEBUG

namespace {

/// Whether edges of a path follow each other, and each path ends where an edge begins.
bool isLinked(const RegionBorder& border) {
  std::vector<std::uint32_t> begins;
  for (std::size_t i = 0; i < border.size(); ++i) begins.push_back(border.from(i));
  std::sort(begins.begin(), begins.end());
  for (std::size_t i = 0, path = 0; i < border.size(); ++i) {
    const bool is_first = path < border.paths.size() && border.paths[path] == i;
    path += is_first;
    if (!is_first && (i == 0 || border.to(i - 1) != border.from(i))) return false;
    if (!std::binary_search(begins.begin(), begins.end(), border.to(i))) return false;
  }
  return !border.is_one_loop ||
         (border.paths.size() == 1 && border.to(border.size() - 1) == border.from(0));
}

}  // namespace

#endif

RegionBorder BorderFinder::find(const Region& region) {
  assert(region.first < region.last && region.first_place <= region.last_place);
  listEdges(region);
  return cancelOpposites() && linkPaths() ? border() : RegionBorder();
}

/// Lists the edges that may be left. The edges of some vertices cancel: all triangles
/// around the vertex are in the region and form a closed fan.
void BorderFinder::listEdges(const Region& region) {
  counts_.assign(region.last_place - region.first_place, 0);
  for (std::uint32_t i = region.first; i < region.last; ++i)
    for (const std::uint32_t place : tree_.triangles()[i].place) {
      assert(place < region.last_place);
      if (place >= region.first_place) ++counts_[place - region.first_place];
    }
  for (std::uint32_t v = region.first_place; v < region.last_place; ++v) {
    const VertexFan fan = tree_.fans()[v];
    std::uint32_t& count = counts_[v - region.first_place];
    count = fan.is_closed && count == fan.count ? 0 : 1;
  }
  const auto is_outer = [&](std::uint32_t place) {
    return place < region.first_place || counts_[place - region.first_place] != 0;
  };
  keys_.clear();
  for (std::uint32_t i = region.first; i < region.last; ++i) {
    const std::uint32_t(&v)[3] = tree_.triangles()[i].place;
    const bool outer[3] = {is_outer(v[0]), is_outer(v[1]), is_outer(v[2])};
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (!(outer[k] && outer[next])) continue;
      const std::uint64_t low = std::min(v[k], v[next]), high = std::max(v[k], v[next]);
      assert(high < std::uint64_t{1} << 31);
      keys_.push_back(low << 32 | high << 1 | std::uint64_t{v[k] > v[next]});
    }
  }
}

bool BorderFinder::cancelOpposites() {
  std::sort(keys_.begin(), keys_.end());
  edges_.clear();
  for (std::size_t i = 0; i < keys_.size();) {
    const std::uint64_t edge = keys_[i] >> 1;
    int left = 0;
    for (; i < keys_.size() && keys_[i] >> 1 == edge; ++i) left += keys_[i] & 1 ? -1 : 1;
    if (left == 0) continue;
    if (left != 1 && left != -1) return false;
    const auto low = static_cast<std::uint32_t>(edge >> 31),
               high = static_cast<std::uint32_t>(edge & 0x7fffffff);
    edges_.push_back(left > 0 ? Edge{low, high} : Edge{high, low});
  }
  return !edges_.empty();
}

/// Puts the edges in the order of paths. At each vertex as many edges start as end.
bool BorderFinder::linkPaths() {
  std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  const std::vector<Edge>& edges = unlinked_;
  unlinked_.swap(edges_);
  taken_.assign(edges.size(), 0);
  const auto begins_path = [&edges](std::size_t i) {
    return (i > 0 && edges[i - 1].from == edges[i].from) ||
           (i + 1 < edges.size() && edges[i + 1].from == edges[i].from);
  };
  edges_.clear();
  paths_.clear();
  const auto take = [&](std::size_t i) {
    paths_.push_back(static_cast<std::uint32_t>(edges_.size()));
    while (!taken_[i]) {
      taken_[i] = 1;
      edges_.push_back(edges[i]);
      const std::uint32_t at = edges[i].to;
      i = static_cast<std::size_t>(
          std::lower_bound(edges.begin(), edges.end(), at,
                           [](const Edge& e, std::uint32_t v) { return e.from < v; }) -
          edges.begin());
      if (i == edges.size() || edges[i].from != at) return false;
      if (begins_path(i)) break;
    }
    return true;
  };
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (begins_path(i) && !take(i)) return false;
  is_one_loop_ = paths_.empty();
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (!taken_[i] && !take(i)) return false;
  is_one_loop_ &= paths_.size() == 1;
  return true;
}

RegionBorder BorderFinder::border() const {
  RegionBorder border;
  border.points.reserve(edges_.size() + paths_.size());
  border.begins.reserve(edges_.size());
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    // Most edges begin where the previous one ends.
    if (i == 0 || edges_[i].from != edges_[i - 1].to)
      border.points.push_back(edges_[i].from);
    border.begins.push_back(static_cast<std::uint32_t>(border.points.size() - 1));
    border.points.push_back(edges_[i].to);
  }
  border.paths = paths_;
  border.is_one_loop = is_one_loop_;
  assert(border.size() == edges_.size() && isLinked(border));
  return border;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

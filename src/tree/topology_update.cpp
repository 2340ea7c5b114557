// SPDX-License-Identifier: BSD-3-Clause
//
// How a moving tree follows a mesh whose triangles differ from those of the previous
// step.
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/mesh_topology.h"
#include "mesh/vertex_corners.h"
#include "tree/moving_kdop_tree.h"
#include "tree/topology_difference.h"
#include "tree/tree_structure.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr std::uint32_t kNone = TopologyDifference::kNone;
constexpr std::size_t kChildren = MovingKdopNode::kWidth;

/// A possible child of a node, and four times its center.
struct Entry {
  float point[3];
  std::int32_t child;
};

/// Extents of the points of entries that are added one by one.
class Extents {
 public:
  float add(const Entry& entry) {
    float sum = 0;
    for (int k = 0; k < 3; ++k) {
      lo_[k] = std::min(lo_[k], entry.point[k]);
      hi_[k] = std::max(hi_[k], entry.point[k]);
      sum += width(k);
    }
    return sum;
  }
  float width(int axis) const { return hi_[axis] - lo_[axis]; }

 private:
  static constexpr float kInf = std::numeric_limits<float>::infinity();
  float lo_[3]{kInf, kInf, kInf}, hi_[3]{-kInf, -kInf, -kInf};
};

/// Splits entries along their longest axis at the lowest cost: the sum over both parts of
/// extents times number. No part has less than a quarter of the entries.
/// @return the beginning of the second part
Entry* splitEntries(Entry* first, Entry* last) {
  Extents all;
  for (const Entry* e = first; e != last; ++e) all.add(*e);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (all.width(k) > all.width(axis)) axis = k;
  std::sort(first, last, [axis](const Entry& a, const Entry& b) {
    return a.point[axis] != b.point[axis] ? a.point[axis] < b.point[axis]
                                          : a.child < b.child;
  });
  const auto count = static_cast<std::size_t>(last - first);
  std::vector<float> cost(count);
  Extents before, after;
  for (std::size_t i = 0; i + 1 < count; ++i)
    cost[i + 1] = before.add(first[i]) * static_cast<float>(i + 1);
  for (std::size_t i = count; i-- > 1;)
    cost[i] += after.add(first[i]) * static_cast<float>(count - i);
  const auto least = static_cast<std::ptrdiff_t>((count + 3) / 4);
  assert(least < static_cast<std::ptrdiff_t>(count) - least);
  return first +
         (std::min_element(cost.begin() + least, cost.end() - least) - cost.begin());
}

}  // namespace

/// A structure for new triangles. Each triangle hangs on the lowest node that has its
/// origin, or that is nearest to it. The structure is made from below, as in a B-tree: a
/// node becomes one new node, or several if it has too many children, and its parent then
/// has all of them. So no branch becomes longer than others. If all triangles of a node
/// fit into one node, they become one.
class MovingKdopTree::TopologyUpdate {
 public:
  TopologyUpdate(const MovingKdopTree& tree, const TopologyDifference& difference,
                 TriangleArray triangles, const VertexFrames& frames)
      : tree_(tree),
        triangles_(triangles),
        frames_(frames),
        parts_(tree.numNodes(), kNoPart) {
    hang(difference.origins());
    nodes_.reserve(tree.numNodes() + tree.numNodes() / 8);
    next_part_.reserve(nodes_.capacity());
    first_sizes_.reserve(nodes_.capacity());
    entry_of_.reserve(nodes_.capacity());
    // Children come after their parents.
    for (auto i = static_cast<std::int32_t>(tree.numNodes()); i-- > 0;)
      if (count(i) > 1 || i == 0) copy(i);
    root_ = joined(parts_[0]);
  }

  /// The structure in the order of a walk.
  /// @param first_sizes  of each node; not yet known for a new node
  TreeStructure structure(std::size_t num_triangles,
                          std::vector<NodeSize>& first_sizes) const {
    return walk(root_, nodes_, first_sizes_, num_triangles, first_sizes);
  }

 private:
  static constexpr std::int32_t kNoPart = -1;

  /// The triangles that hang on a node, not on nodes below it.
  struct Hung {
    const std::uint32_t *first, *last;
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };
  Hung hungOn(std::int32_t node) const {
    const auto i = static_cast<std::size_t>(node);
    return {hung_.data() + first_[i], hung_.data() + first_[i + 1]};
  }
  /// Number of triangles that hang on a node or below it.
  std::uint32_t count(std::int32_t node) const {
    return counts_[static_cast<std::size_t>(node)];
  }

  /// Four times the centroid of a triangle at t = 0, relative to the point between the
  /// tree's two origins.
  void pointOf(std::uint32_t triangle, float (&point)[3]) const {
    std::uint32_t ids[3];
    triangles_.copyIds(triangle, ids);
    double sum[3] = {0, 0, 0};
    for (const std::uint32_t id : ids) {
      double p[3];
      frames_.at(0, id, p);
      for (int k = 0; k < 3; ++k)
        sum[k] += p[k] - (0.5 * tree_.origin_[0][k] + 0.5 * tree_.origin_[1][k]);
    }
    for (int k = 0; k < 3; ++k) point[k] = clampedCoordinate(sum[k] * (4. / 3));
  }

  /// The lowest node near a triangle, found by going down to the nearest box.
  std::int32_t findNode(std::uint32_t triangle) const {
    float point[3];
    pointOf(triangle, point);
    for (std::int32_t i = 0;;) {
      const MovingKdopNode& node = tree_.node(i);
      float least = 0;
      int nearest = -1;
      for (int lane = 0; lane < node.count; ++lane) {
        float distance = 0;
        for (int k = 0; k < 3; ++k) {
          const float x = 0.25f * point[k];
          distance += std::max(
              0.f, std::max(-x - node.t1[2 * k][lane], x - node.t1[2 * k + 1][lane]));
        }
        if (nearest >= 0 && !(distance < least)) continue;
        nearest = lane;
        least = distance;
      }
      if (node.isTriangle(nearest)) return i;
      assert(node.child[nearest] > i);
      i = node.child[nearest];
    }
  }

  /// Hangs the triangles on nodes. On each node they have the order of the tree, then of
  /// their numbers.
  void hang(const std::vector<std::uint32_t>& origins) {
    const std::size_t num_nodes = tree_.numNodes();
    std::vector<std::int32_t> parents(tree_.triangles_.size());
    for (std::size_t i = 0; i < num_nodes; ++i) {
      const MovingKdopNode& node = tree_.nodes_[i];
      for (int lane = 0; lane < node.count; ++lane)
        if (node.isTriangle(lane))
          parents[static_cast<std::size_t>(node.triangle(lane))] =
              static_cast<std::int32_t>(i);
    }
    std::vector<std::int32_t> homes(origins.size());
    first_.assign(num_nodes + 1, 0);
    for (std::size_t i = 0; i < origins.size(); ++i) {
      homes[i] = origins[i] == kNone ? findNode(static_cast<std::uint32_t>(i))
                                     : parents[origins[i]];
      ++first_[static_cast<std::size_t>(homes[i]) + 1];
    }
    counts_.assign(first_.begin() + 1, first_.end());
    for (std::size_t i = 0; i < num_nodes; ++i) first_[i + 1] += first_[i];
    assert(first_[num_nodes] == origins.size());
    // Children come after their parents.
    for (std::size_t i = num_nodes; i-- > 0;) {
      const MovingKdopNode& node = tree_.nodes_[i];
      for (int lane = 0; lane < node.count; ++lane)
        if (!node.isTriangle(lane))
          counts_[i] += counts_[static_cast<std::size_t>(node.child[lane])];
    }
    assert(counts_[0] == origins.size());
    hung_.resize(origins.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < origins.size(); ++i)
      hung_[next[static_cast<std::size_t>(homes[i])]++] = static_cast<std::uint32_t>(i);
    const auto before = [&origins](std::uint32_t a, std::uint32_t b) {
      return origins[a] != origins[b] ? origins[a] < origins[b] : a < b;
    };
    for (std::size_t i = 0; i < num_nodes; ++i)
      std::sort(hung_.begin() + first_[i], hung_.begin() + first_[i + 1], before);
  }

  /// Makes the parts of a node of the tree: its new node, or several.
  void copy(std::int32_t i) {
    const MovingKdopNode& node = tree_.node(i);
    entries_.clear();
    if (count(i) <= kChildren) {
      gather(i);
    } else {
      addTriangles(i);
      for (int lane = 0; lane < node.count; ++lane)
        if (!node.isTriangle(lane)) addParts(node, lane);
    }
    assert(!entries_.empty());
    const bool is_one_node = entries_.size() == 1 && entries_[0].child >= 0;
    std::int32_t& part = parts_[static_cast<std::size_t>(i)];
    if (is_one_node) {
      part = entries_[0].child;
      return;
    }
    const auto num_triangles =
        std::count_if(node.child, node.child + node.count,
                      [](std::int32_t child) { return child < 0; });
    const bool is_as_before = entries_.size() == static_cast<std::size_t>(node.count) &&
                              hungOn(i).size() == static_cast<std::size_t>(num_triangles);
    const NodeSize first_size =
        is_as_before ? tree_.first_sizes_[static_cast<std::size_t>(i)] : NodeSize{};
    if (entries_.size() > kChildren)
      for (Entry& entry : entries_)
        if (entry.child < 0)
          pointOf(static_cast<std::uint32_t>(~entry.child), entry.point);
    part = group(entries_.data(), entries_.data() + entries_.size(), kNoPart, first_size);
  }

  /// Adds the triangles of a node, without their points, which are set where they are
  /// needed.
  void addTriangles(std::int32_t i) {
    const Hung hung = hungOn(i);
    for (const std::uint32_t* t = hung.first; t != hung.last; ++t)
      entries_.push_back({{}, ~static_cast<std::int32_t>(*t)});
  }

  /// Adds all triangles that hang on a node or below it.
  void gather(std::int32_t root) {
    std::vector<std::int32_t> open{root};
    while (!open.empty()) {
      const std::int32_t i = open.back();
      open.pop_back();
      addTriangles(i);
      const MovingKdopNode& node = tree_.node(i);
      for (int lane = node.count; lane-- > 0;)
        if (!node.isTriangle(lane) && count(node.child[lane]) > 0)
          open.push_back(node.child[lane]);
    }
  }

  /// Adds the parts of a child that is a node.
  void addParts(const MovingKdopNode& node, int lane) {
    const std::int32_t child = node.child[lane];
    if (count(child) <= 1) {
      gather(child);
      return;
    }
    const std::int32_t first = parts_[static_cast<std::size_t>(child)];
    assert(first != kNoPart);
    const bool is_one = next_part_[static_cast<std::size_t>(first)] == kNoPart;
    for (std::int32_t part = first; part != kNoPart;) {
      const auto k = static_cast<std::size_t>(part);
      entries_.push_back(entry_of_[k]);
      if (is_one) deformable::pointOf(node, lane, entries_.back().point);
      part = next_part_[k];
    }
  }

  /// Makes nodes of entries.
  /// @param next  the part that follows them
  /// @param first_size  the size of the node if one node has all entries
  /// @return the first part
  std::int32_t group(Entry* first, Entry* last, std::int32_t next,
                     const NodeSize& first_size) {
    const auto count = static_cast<std::size_t>(last - first);
    assert(count > 0);
    if (count > kChildren) {
      Entry* middle = splitEntries(first, last);
      return group(first, middle, group(middle, last, next, {}), {});
    }
    TreeChildren node{{}, static_cast<std::int32_t>(count)};
    const auto number = static_cast<std::int32_t>(nodes_.size());
    Entry as_entry{{}, number};
    for (std::size_t i = 0; i < count; ++i) {
      node.child[i] = first[i].child;
      for (int k = 0; k < 3; ++k)
        as_entry.point[k] += first[i].point[k] / static_cast<float>(count);
    }
    nodes_.push_back(node);
    first_sizes_.push_back(first_size);
    entry_of_.push_back(as_entry);
    next_part_.push_back(next);
    return number;
  }

  /// The root of parts: the part itself, if there is only one.
  std::int32_t joined(std::int32_t part) {
    while (next_part_[static_cast<std::size_t>(part)] != kNoPart) {
      entries_.clear();
      for (; part != kNoPart; part = next_part_[static_cast<std::size_t>(part)])
        entries_.push_back(entry_of_[static_cast<std::size_t>(part)]);
      part = group(entries_.data(), entries_.data() + entries_.size(), kNoPart, {});
    }
    return part;
  }

  const MovingKdopTree& tree_;
  TriangleArray triangles_;
  const VertexFrames& frames_;
  /// The triangles that hang on node i: hung_[first_[i]] ... hung_[first_[i + 1] - 1].
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> hung_;
  std::vector<std::uint32_t> counts_;

  /// The first part of each node of the tree.
  std::vector<std::int32_t> parts_;
  /// For each new node.
  std::vector<TreeChildren> nodes_;
  std::vector<NodeSize> first_sizes_;
  /// The node as an entry. It has a point if it is one of several parts.
  std::vector<Entry> entry_of_;
  std::vector<std::int32_t> next_part_;
  std::int32_t root_;
  /// The children of the next new node, or nodes.
  std::vector<Entry> entries_;
};

void MovingKdopTree::changeTopology(TriangleArray triangles, std::size_t num_triangles,
                                    const std::vector<int>& origins,
                                    const VertexFrames& frames, int num_threads) {
  assert(isConsistent() && free_.count() == 0 && num_triangles > 0 &&
         findOutOfRange(triangles, num_triangles, frames.size()) == 3 * num_triangles);
  const TopologyDifference difference(triangles_, vertex_ids_.size(), triangles,
                                      num_triangles, frames.size(), origins);
  MovingKdopTree next;
  const TreeStructure structure = TopologyUpdate(*this, difference, triangles, frames)
                                      .structure(num_triangles, next.first_sizes_);
  next.assignPlaces(structure, triangles, frames.size(), num_threads);
  next.inherit(*this, difference, num_threads);
  next.takeMemory(*this, structure);
  become(std::move(next), structure);
}

#ifndef NDEBUG

namespace {

/// Whether the vertices of a triangle had the places of another triangle's vertices.
bool areAtOldPlaces(const TreeTriangle& t, const std::vector<std::uint32_t>& old_places,
                    const TreeTriangle& origin) {
  return std::equal(
      t.place, t.place + 3, origin.place,
      [&](std::uint32_t now, std::uint32_t before) { return old_places[now] == before; });
}

}  // namespace

#endif

/// Takes over the fans and owners that are the same. Finds the others among the triangles
/// around them.
void MovingKdopTree::inherit(const MovingKdopTree& before,
                             const TopologyDifference& difference, int num_threads) {
  const std::size_t num_places = vertex_ids_.size();
  std::vector<std::uint32_t> place_of(difference.vertices().size(), kNone);
  std::vector<std::uint32_t> old_places(num_places);
  for (std::size_t v = 0; v < num_places; ++v) {
    place_of[vertex_ids_[v]] = static_cast<std::uint32_t>(v);
    old_places[v] = difference.vertices()[vertex_ids_[v]];
  }
  std::vector<std::uint32_t> new_places = difference.newIds();
  for (std::uint32_t& place : new_places)
    if (place != kNone) place = place_of[place];

  std::vector<TreeTriangle> changed;
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    TreeTriangle& t = triangles_[i];
    const bool is_same = std::all_of(t.place, t.place + 3, [&](std::uint32_t place) {
      return old_places[place] != kNone;
    });
    const std::uint32_t origin = difference.origins()[t.index];
    t.owned = origin == kNone ? 0 : before.triangles_[origin].owned;
    assert(!is_same || areAtOldPlaces(t, old_places, before.triangles_[origin]));
    if (is_same) continue;
    changed.push_back(t);
    places.push_back(i);
  }
  const VertexCorners corners(changed, num_places, num_threads);
  fans_ = VertexFans(before.fans_, old_places, new_places, corners);
  assignOwners(corners, num_threads, changed);
  for (std::size_t i = 0; i < places.size(); ++i) {
    TreeTriangle& t = triangles_[places[i]];
    unsigned found = 0;  // a bit for each vertex that is not the same
    for (unsigned k = 0; k < 3; ++k)
      found |= unsigned{old_places[t.place[k]] == kNone} << k;
    // Features that have only such vertices may have another owner.
    const unsigned edges = found & (found >> 1 | found << 2);
    const unsigned mask = found | edges << 3 | unsigned{found == 7} << 6;
    t.owned = (t.owned & ~mask) | (changed[i].owned & mask);
    assert(t.owned <= kOwnsAll);
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

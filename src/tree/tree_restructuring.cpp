// SPDX-License-Identifier: BSD-3-Clause
//
// Which parts of a moving tree have aged, and how they are rebuilt.
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <new>
#include <utility>

#include "tree/component_groups.h"
#include "tree/item_splitter.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A tree has aged if its nodes' boxes together are this many times as large as expected.
/// The number of boxes that a query compares then grows by about the same factor, and the
/// time of the query by half of that. Waves and folds stay below 1.03, any rotation below
/// 1.1.
constexpr double kAgedTree = 1.3;

/// Nodes that have grown by more than this are rebuilt. It was chosen by measuring: 1.1
/// and 1.2 give trees that are worse by up to 3%.
constexpr float kAgedNode = 1.15f;

}  // namespace

/// A structure in which the aged parts are new. A part is everything below the aged
/// children of one node. It is split anew from its lowest nodes, and from single
/// triangles where the lowest nodes have aged too.
class MovingKdopTree::Restructuring {
 public:
  explicit Restructuring(const MovingKdopTree& tree)
      : tree_(tree),
        component_of_(findComponents(tree.vertex_ids_.size(), tree.triangles_.size(),
                                     [&tree](std::size_t i, std::uint32_t (&v)[3]) {
                                       std::copy_n(tree.triangles_[i].place, 3, v);
                                     })) {
    nodes_.reserve(tree.numNodes() + tree.numNodes() / 8);
    first_sizes_.reserve(nodes_.capacity());
    take(0, 0);
    while (!open_.empty()) {
      const CopiedNode o = open_.back();
      open_.pop_back();
      copy(o);
    }
  }

  /// The structure in the order of a walk. Its leaves are triangles of the tree.
  /// @param first_sizes  of each node; not yet known for a new node
  TreeStructure structure(std::vector<NodeSize>& first_sizes) const {
    return walk(0, nodes_, first_sizes_, tree_.triangles_.size(), first_sizes);
  }

 private:
  struct CopiedNode {
    std::int32_t from;
    std::size_t to;
    int depth;
  };

  bool isAged(std::int32_t i) const {
    const auto k = static_cast<std::size_t>(i);
    return tree_.sizes_[k].box >
           kAgedNode * expectedBox(tree_.first_sizes_[k], tree_.sizes_[k]);
  }
  bool isLowest(std::int32_t i) const {
    const MovingKdopNode& node = tree_.node(i);
    return std::all_of(node.child, node.child + node.count,
                       [](std::int32_t child) { return child < 0; });
  }

  /// The component of the first triangle of a child.
  std::uint32_t componentOf(std::int32_t child) const {
    const std::uint32_t first =
        child < 0 ? static_cast<std::uint32_t>(~child) : tree_.firstTriangle(child);
    return component_of_[tree_.triangles_[first].place[0]];
  }

  std::size_t add(const NodeSize& first_size) {
    nodes_.push_back({{}, 0});
    first_sizes_.push_back(first_size);
    return nodes_.size() - 1;
  }
  /// The number in the new structure of a child in the tree.
  std::int32_t take(std::int32_t child, int depth) {
    if (child < 0) return child;
    const std::size_t to = add(tree_.first_sizes_[static_cast<std::size_t>(child)]);
    open_.push_back({child, to, depth});
    return static_cast<std::int32_t>(to);
  }
  void append(std::size_t to, std::int32_t child) {
    TreeChildren& node = nodes_[to];
    assert(node.count < MovingKdopNode::kWidth);
    node.child[node.count++] = child;
  }

  void copy(const CopiedNode& o) {
    const MovingKdopNode& from = tree_.node(o.from);
    items_.clear();
    names_.clear();
    std::size_t num_aged = 0;
    for (int lane = 0; lane < from.count; ++lane) {
      const std::int32_t child = from.child[lane];
      if (child >= 0 && isAged(child)) {
        dissolve(child);
        ++num_aged;
      } else {
        append(o.to, take(child, o.depth + 1));
      }
    }
    if (num_aged == 1) {
      const std::size_t to = add({});
      append(o.to, static_cast<std::int32_t>(to));
      split(to, MovingKdopNode::kWidth, o.depth + 1);
    } else if (num_aged > 1) {
      split(o.to, num_aged, o.depth);
    }
  }

  /// Makes items of the lowest nodes and triangles below a node.
  void dissolve(std::int32_t root) {
    std::vector<std::int32_t> open{root};
    while (!open.empty()) {
      const MovingKdopNode& node = tree_.node(open.back());
      open.pop_back();
      for (int lane = 0; lane < node.count; ++lane) {
        const std::int32_t child = node.child[lane];
        if (child >= 0 && (isAged(child) || !isLowest(child))) {
          open.push_back(child);
          continue;
        }
        TreeItem item{{}, static_cast<std::uint32_t>(names_.size())};
        pointOf(node, lane, item.point);
        items_.push_back(item);
        names_.push_back(child);
      }
    }
  }

  /// Appends the items to a node, in at most `max_parts` parts.
  void split(std::size_t to, std::size_t max_parts, int depth) {
    assert(!names_.empty() && items_.size() == names_.size());
    std::vector<std::uint32_t> components(names_.size());
    std::transform(names_.begin(), names_.end(), components.begin(),
                   [this](std::int32_t name) { return componentOf(name); });
    // Components are numbered from 0: the mesh may have far more components than these
    // items.
    std::vector<std::uint32_t> numbers = components;
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    for (std::uint32_t& component : components)
      component = static_cast<std::uint32_t>(
          std::lower_bound(numbers.begin(), numbers.end(), component) - numbers.begin());
    std::vector<std::size_t> ends =
        groupItems(std::move(components), numbers.size(),
                   kLeastComponent / MovingKdopNode::kWidth, items_);
    const TreeStructure tree = splitItems(items_, std::move(ends), max_parts, depth);
    const auto& parts = tree.nodes;
    assert(static_cast<std::size_t>(parts[0].count) <= max_parts);
    std::vector<std::size_t> number_of_part(parts.size(), to);
    // Children come after their parents.
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (int k = 0; k < parts[i].count; ++k) {
        std::int32_t child = parts[i].child[k];
        if (child < 0) {
          child = take(names_[tree.leaves[static_cast<std::size_t>(~child)]], depth + 1);
        } else {
          std::size_t& number = number_of_part[static_cast<std::size_t>(child)];
          number = add({});
          child = static_cast<std::int32_t>(number);
        }
        append(number_of_part[i], child);
      }
  }

  const MovingKdopTree& tree_;
  /// The component of each vertex, by its place.
  std::vector<std::uint32_t> component_of_;
  std::vector<TreeChildren> nodes_;
  std::vector<NodeSize> first_sizes_;
  /// Nodes that are still to be copied.
  std::vector<CopiedNode> open_;
  /// The items of the aged children, and the child of the tree that each item stands for.
  UninitializedVector<TreeItem> items_;
  std::vector<std::int32_t> names_;
};

/// The structure of the nodes below a root, in the order of a walk.
/// @param sizes  of each node when it was made
/// @param first_sizes  the same, in the order of the walk
TreeStructure MovingKdopTree::walk(std::int32_t root,
                                   const std::vector<TreeChildren>& nodes,
                                   const std::vector<NodeSize>& sizes,
                                   std::size_t num_leaves,
                                   std::vector<NodeSize>& first_sizes) {
  first_sizes.resize(nodes.size());
  const auto children = [&](std::int32_t i, std::size_t number) {
    // A walk begins with 0.
    const auto from = static_cast<std::size_t>(number == 0 ? root : i);
    assert(from < nodes.size() && number < first_sizes.size());
    first_sizes[number] = sizes[from];
    return nodes[from];
  };
  TreeStructure tree = inWalkOrder(num_leaves, children);
  first_sizes.resize(tree.nodes.size());
  return tree;
}

bool MovingKdopTree::restructure() {
  assert(isConsistent());
  double now = 0, expected = 0;
  for (std::size_t i = 1; i < sizes_.size(); ++i) {
    if (first_sizes_[i].triangles == 0) first_sizes_[i] = sizes_[i];
    now += sizes_[i].box;
    expected += expectedBox(first_sizes_[i], sizes_[i]);
  }
  const bool is_bounded = now < std::numeric_limits<float>::max();
  if (!is_bounded || !(now > kAgedTree * expected)) return false;
  try {
    adopt(Restructuring(*this));
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

/// Takes over a structure. Memory is allocated before anything changes.
void MovingKdopTree::adopt(const Restructuring& restructuring) {
  MovingKdopTree next;
  const TreeStructure structure = restructuring.structure(next.first_sizes_);
  assert(structure.leaves.size() == triangles_.size() && isPermutation(structure.leaves));
  next.free_ = free_;
  next.triangles_.resize(triangles_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    next.triangles_[i] = triangles_[structure.leaves[i]];
  next.findSubtrees(structure);
  const std::size_t num_ids =
      1 + *std::max_element(vertex_ids_.begin(), vertex_ids_.end());
  next.placeVertices(num_ids);
  const std::size_t count = vertex_ids_.size();
  assert(next.vertex_ids_.size() == count);
  std::vector<std::uint32_t> place_of(num_ids), new_places(count), old_places(count);
  for (std::size_t i = 0; i < count; ++i)
    place_of[next.vertex_ids_[i]] = static_cast<std::uint32_t>(i);
  for (std::size_t i = 0; i < count; ++i) {
    new_places[i] = place_of[vertex_ids_[i]];
    assert(next.vertex_ids_[new_places[i]] == vertex_ids_[i]);
    old_places[new_places[i]] = static_cast<std::uint32_t>(i);
  }
  const VertexFans fans = fans_;
  next.takeMemory(*this, structure);

  next.fans_ = std::move(fans_);
  next.fans_.renumber(fans, new_places, old_places);
  become(std::move(next), structure);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

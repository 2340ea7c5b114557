// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BROADPHASE_MOVING_BOX_TREE_H
#define FCL_CCD_BROADPHASE_MOVING_BOX_TREE_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "broadphase/moving_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A binary tree of boxes that move linearly during the step, one leaf for each
/// object. Objects are numbers >= 0. The box of a node at t = 0 contains those of its
/// children at t = 0, and the same at t = 1.
///
/// insert() and remove() take O(log n) steps: the heights of two siblings differ by at
/// most one, as in an AVL tree. build() takes O(n log n).
class MovingBoxTree {
 public:
  /// The tree has a copy of the box.
  struct Leaf {
    const LinearBox* box;
    std::int32_t object;
  };

  std::size_t size() const { return count_; }
  int height() const { return root_ < 0 ? 0 : nodes_[index(root_)].height; }

  /// @pre the object is not in the tree
  void insert(const Leaf& leaf);
  /// @pre the object is in the tree
  void remove(std::int32_t object);
  /// @brief A new tree of these leaves: halved at the median of the widest axis, nodes in
  /// the order of a traversal.
  void build(const std::vector<Leaf>& unordered);
  void clear();

  /// @brief Calls visit(object) for each object that a box, or a flat, may meet.
  template <typename Bounds, typename Visit>
  void visitMeeting(const Bounds& bounds, const LinearQuery& query, Visit&& visit) const;

  /// @brief Calls visit(object, object) for each two objects that may meet.
  template <typename Visit>
  void visitPairs(const LinearQuery& query, Visit&& visit) const;

  /// @brief Calls visit(object of this tree, object of the other tree).
  template <typename Visit>
  void visitPairs(const MovingBoxTree& other, const LinearQuery& query,
                  Visit&& visit) const;

  /// @brief For other searches: nodes are numbers below numNodes(), some of them unused.
  /// @return -1 if the tree is empty
  std::int32_t root() const { return root_; }
  std::size_t numNodes() const { return nodes_.size(); }
  bool isLeaf(std::int32_t node) const { return at(node).isLeaf(); }
  const LinearBox& boxOf(std::int32_t node) const { return at(node).box; }
  /// @pre it is no leaf
  std::int32_t childOf(std::int32_t node, int k) const {
    assert(!isLeaf(node) && (k == 0 || k == 1));
    return at(node).child[k];
  }
  /// @pre it is a leaf
  std::int32_t objectOf(std::int32_t leaf) const {
    assert(isLeaf(leaf) && leaf_of_[index(at(leaf).child[0])] == leaf);
    return at(leaf).child[0];
  }

 private:
  static constexpr std::int32_t kNone = -1;

  /// A cache line. A leaf has height 0 and its object in child[0].
  struct alignas(64) Node {
    LinearBox box;
    std::int32_t parent;
    std::int32_t child[2];
    std::int32_t height;
    bool isLeaf() const { return height == 0; }
  };
  /// A leaf, and four times the center of its box in the middle of the step.
  struct Middle {
    float at[3];
    std::uint32_t leaf;
  };
  struct OpenPair {
    std::int32_t first, second;
  };
  static constexpr std::size_t kPairsAtATime = 16;
  /// Pairs of nodes whose boxes may meet. There is always room for one more.
  struct PairStack {
    std::vector<OpenPair> pairs{std::vector<OpenPair>(4 * kPairsAtATime)};
    std::size_t size{0};
  };

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  const Node& at(std::int32_t node) const {
    assert(node >= 0 && index(node) < nodes_.size());
    return nodes_[index(node)];
  }
  Node& at(std::int32_t node) {
    assert(node >= 0 && index(node) < nodes_.size());
    return nodes_[index(node)];
  }
  bool isInTree(std::int32_t object) const {
    return object >= 0 && index(object) < leaf_of_.size() &&
           leaf_of_[index(object)] != kNone;
  }
  /// @brief Whether there is a leaf for each object, and one node less above them.
  bool isFull() const {
    return nodes_.size() - free_.size() == (count_ > 0 ? 2 * count_ - 1 : 0) &&
           (root_ == kNone) == (count_ == 0);
  }

  std::int32_t newNode();
  void setLeaf(std::int32_t object, std::int32_t node);
  void fit(std::int32_t node);
  std::int32_t leafBeside(const LinearBox& box) const;
  void replaceChild(std::int32_t parent, std::int32_t from, std::int32_t to);
  std::int32_t balance(std::int32_t node);
  void refitAbove(std::int32_t node);
  std::vector<Leaf> inThisOrder(const std::vector<Leaf>& leaves) const;
  void buildPart(const std::vector<Leaf>& leaves, Middle* first, Middle* last,
                 std::int32_t node);
  template <typename Visit>
  static void openPairs(const MovingBoxTree& a, const MovingBoxTree& b,
                        const LinearQuery& query, std::size_t rest, PairStack& stack,
                        Visit&& visit);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> free_;
  /// The leaf of each object.
  std::vector<std::int32_t> leaf_of_;
  std::int32_t root_{kNone};
  std::size_t count_{0};
};

template <typename Bounds, typename Visit>
void MovingBoxTree::visitMeeting(const Bounds& bounds, const LinearQuery& query,
                                 Visit&& visit) const {
  if (root_ == kNone) return;
  std::vector<std::int32_t> stack{root_};
  while (!stack.empty()) {
    const Node& node = at(stack.back());
    stack.pop_back();
    if (!mayMeet(node.box, bounds, query)) continue;
    if (node.isLeaf())
      visit(node.child[0]);
    else
      stack.insert(stack.end(), node.child, node.child + 2);
  }
}

/// Opens the wider of the nodes of each pair on the stack, until at most `rest` pairs are
/// left. What to open, and which children are near, is unpredictable, and is chosen
/// without branches. Several pairs are taken from the stack at a time: so the processor
/// works at one while another one waits for its memory.
template <typename Visit>
void MovingBoxTree::openPairs(const MovingBoxTree& a, const MovingBoxTree& b,
                              const LinearQuery& query, std::size_t rest,
                              PairStack& stack, Visit&& visit) {
  while (stack.size > rest) {
    OpenPair taken[kPairsAtATime];
    const std::size_t count = std::min(stack.size, kPairsAtATime);
    stack.size -= count;
    std::copy_n(stack.pairs.data() + stack.size, count, taken);
    if (stack.pairs.size() < stack.size + 2 * count + 1)
      stack.pairs.resize(2 * stack.pairs.size());
    OpenPair* top = stack.pairs.data() + stack.size;
    for (std::size_t i = 0; i < count; ++i) {
      const OpenPair pair = taken[i];
      const Node &x = a.at(pair.first), &y = b.at(pair.second);
      if ((x.height | y.height) == 0) {
        visit(x.child[0], y.child[0]);
        continue;
      }
      const float width_x = widthOf(x.box), width_y = widthOf(y.box);
      const bool opens_x = (x.isLeaf() ? -1 : width_x) >= (y.isLeaf() ? -1 : width_y);
      const Node *const opened = opens_x ? &x : &y, *const other = opens_x ? &y : &x,
                        *const nodes = opens_x ? a.nodes_.data() : b.nodes_.data();
      for (const std::int32_t child : opened->child) {
        top->first = opens_x ? child : pair.first;
        top->second = opens_x ? pair.second : child;
        top += mayMeet(nodes[index(child)].box, other->box, query);
      }
    }
    assert(top < stack.pairs.data() + stack.pairs.size());
    stack.size = static_cast<std::size_t>(top - stack.pairs.data());
  }
}

template <typename Visit>
void MovingBoxTree::visitPairs(const LinearQuery& query, Visit&& visit) const {
  if (root_ == kNone) return;
  PairStack pairs;
  std::vector<std::int32_t> stack{root_};
  while (!stack.empty()) {
    const Node& node = at(stack.back());
    stack.pop_back();
    if (node.isLeaf()) continue;
    if (mayMeet(at(node.child[0]).box, at(node.child[1]).box, query)) {
      assert(pairs.size < pairs.pairs.size());
      pairs.pairs[pairs.size++] = {node.child[0], node.child[1]};
      openPairs(*this, *this, query, kPairsAtATime, pairs, visit);
    }
    stack.insert(stack.end(), node.child, node.child + 2);
  }
  openPairs(*this, *this, query, 0, pairs, visit);
}

template <typename Visit>
void MovingBoxTree::visitPairs(const MovingBoxTree& other, const LinearQuery& query,
                               Visit&& visit) const {
  if (root_ == kNone || other.root_ == kNone) return;
  if (!mayMeet(at(root_).box, other.at(other.root_).box, query)) return;
  PairStack pairs;
  pairs.pairs[pairs.size++] = {root_, other.root_};
  openPairs(*this, other, query, 0, pairs, visit);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BROADPHASE_MOVING_BOX_TREE_H
#define FCL_CCD_BROADPHASE_MOVING_BOX_TREE_H

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
  struct Leaf {
    LinearBox box;
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

  /// @brief Calls visit(object) for each object that a box may meet.
  template <typename Visit>
  void visitMeeting(const LinearBox& box, const LinearQuery& query, Visit&& visit) const;

  /// @brief Calls visit(object, object) for each two objects that may meet.
  template <typename Visit>
  void visitPairs(const LinearQuery& query, Visit&& visit) const;

  /// @brief Calls visit(object of this tree, object of the other tree).
  template <typename Visit>
  void visitPairs(const MovingBoxTree& other, const LinearQuery& query,
                  Visit&& visit) const;

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
  using NodePair = std::pair<std::int32_t, std::int32_t>;

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  const Node& at(std::int32_t node) const { return nodes_[index(node)]; }
  Node& at(std::int32_t node) { return nodes_[index(node)]; }

  std::int32_t newNode();
  void setPlace(std::int32_t object, std::int32_t node);
  void fit(std::int32_t node);
  std::int32_t leafBeside(const LinearBox& box) const;
  void replaceChild(std::int32_t parent, std::int32_t from, std::int32_t to);
  std::int32_t balance(std::int32_t node);
  void refitAbove(std::int32_t node);
  std::vector<Leaf> inThisOrder(const std::vector<Leaf>& leaves) const;
  std::int32_t buildPart(const std::vector<Leaf>& leaves, Middle* first, Middle* last,
                         std::int32_t parent);
  template <typename Visit>
  static void visitCross(const MovingBoxTree& a, const MovingBoxTree& b,
                         const LinearQuery& query, std::vector<NodePair>& stack,
                         Visit&& visit);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> free_;
  /// The leaf of each object.
  std::vector<std::int32_t> place_;
  std::int32_t root_{kNone};
  std::size_t count_{0};
};

template <typename Visit>
void MovingBoxTree::visitMeeting(const LinearBox& box, const LinearQuery& query,
                                 Visit&& visit) const {
  if (root_ == kNone) return;
  std::vector<std::int32_t> stack{root_};
  while (!stack.empty()) {
    const Node& node = at(stack.back());
    stack.pop_back();
    if (!mayMeet(node.box, box, query)) continue;
    if (node.isLeaf())
      visit(node.child[0]);
    else
      stack.insert(stack.end(), node.child, node.child + 2);
  }
}

/// The pairs on the stack: their boxes may meet. Opens the wider of two nodes.
template <typename Visit>
void MovingBoxTree::visitCross(const MovingBoxTree& a, const MovingBoxTree& b,
                               const LinearQuery& query, std::vector<NodePair>& stack,
                               Visit&& visit) {
  while (!stack.empty()) {
    const NodePair pair = stack.back();
    stack.pop_back();
    const Node &x = a.at(pair.first), &y = b.at(pair.second);
    if (x.isLeaf() && y.isLeaf()) {
      visit(x.child[0], y.child[0]);
    } else if (y.isLeaf() || (!x.isLeaf() && widthOf(x.box) >= widthOf(y.box))) {
      for (const std::int32_t child : x.child)
        if (mayMeet(a.at(child).box, y.box, query)) stack.push_back({child, pair.second});
    } else {
      for (const std::int32_t child : y.child)
        if (mayMeet(x.box, b.at(child).box, query)) stack.push_back({pair.first, child});
    }
  }
}

template <typename Visit>
void MovingBoxTree::visitPairs(const LinearQuery& query, Visit&& visit) const {
  if (root_ == kNone) return;
  std::vector<NodePair> cross;
  std::vector<std::int32_t> stack{root_};
  while (!stack.empty()) {
    const Node& node = at(stack.back());
    stack.pop_back();
    if (node.isLeaf()) continue;
    if (mayMeet(at(node.child[0]).box, at(node.child[1]).box, query)) {
      cross.push_back({node.child[0], node.child[1]});
      visitCross(*this, *this, query, cross, visit);
    }
    stack.insert(stack.end(), node.child, node.child + 2);
  }
}

template <typename Visit>
void MovingBoxTree::visitPairs(const MovingBoxTree& other, const LinearQuery& query,
                               Visit&& visit) const {
  if (root_ == kNone || other.root_ == kNone) return;
  if (!mayMeet(at(root_).box, other.at(other.root_).box, query)) return;
  std::vector<NodePair> stack{{root_, other.root_}};
  visitCross(*this, other, query, stack, visit);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

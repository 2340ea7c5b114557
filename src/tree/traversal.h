// SPDX-License-Identifier: BSD-3-Clause
//
// One traversal for a pair of trees and for a tree with itself.
#ifndef FCL_CCD_TREE_TRAVERSAL_H
#define FCL_CCD_TREE_TRAVERSAL_H

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/attributes.h"
#include "base/bits.h"
#include "kernels/kernels.h"
#include "mesh/moving_kdop.h"
#include "tree/separating_axes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A piece of work: child `lane` of node `parent` of one tree against all children
/// of node `node` of the other tree. With lane < 0: a node with itself.
struct NodePair {
  std::int32_t parent;
  std::int32_t node;
  std::int16_t lane;
  /// The child is in tree b and the node in tree a.
  bool swapped;
  /// The boxes do not overlap before this time.
  float earliest;
};

/// @brief Pieces of work in the order in which they were added. Members are written
/// directly into the list: a processor has to wait when it loads a struct as a whole just
/// after it was stored in parts.
class WorkList {
 public:
  std::size_t size() const { return size_; }
  const NodePair& operator[](std::size_t i) const {
    assert(i < size_);
    return items_[i];
  }
  NodePair* data() { return items_.data(); }

  void add(std::int32_t parent, int lane, std::int32_t node, bool swapped,
           float earliest) {
    assert(parent >= 0 && node >= 0 && lane >= -1 && lane < MovingKdopNode::kWidth);
    assert(0 <= earliest && earliest <= 1);
    if (size_ == items_.size()) grow();
    NodePair& work = items_[size_++];
    work.parent = parent;
    work.node = node;
    work.lane = static_cast<std::int16_t>(lane);
    work.swapped = swapped;
    work.earliest = earliest;
  }
  /// @brief Keeps the first `size` pieces only.
  void cut(std::size_t size) {
    assert(size <= size_);
    size_ = size;
  }

 private:
  // Not inlined: it is rare, and would keep add() from being inlined.
  FCL_CCD_NOINLINE void grow() { items_.resize(2 * size_ + 64); }

  std::vector<NodePair> items_;
  std::size_t size_{0};
};

/// @brief Size of a child: the sum of its extents along x, y and z at t = 0. The larger
/// of two children is opened.
inline float extentOf(const MovingKdopNode& node, int lane) {
  float sum = node.t0[0][lane];
  for (int r = 1; r < 6; ++r) sum += node.t0[r][lane];
  return sum;
}

/// @brief The pairs that a traversal of a tree with itself leaves out. Null: none.
struct SelfCulling {
  /// For each vertex of the tree, whether its fan is embedded (findEmbeddedFans()). Pairs
  /// of triangles in one such fan are left out.
  const std::uint8_t* fans{nullptr};
  /// For each node, the vertex whose embedded fan contains it (findNodesInFans()), or the
  /// region in which its features are apart (findRegionsApart(); of a body only the root
  /// has it). Pairs below two nodes in the same one are left out.
  const std::uint32_t* nodes_in_fans{nullptr};
  /// For each node, whether it is an embedded region (EmbeddedRegions::nodes). Pairs
  /// below it are left out.
  const std::uint8_t* regions{nullptr};
};

/// @brief For each triangle of a tree, and for each node, bits of groups, and of the
/// groups that it meets.
struct TreeMarks {
  struct Mark {
    std::uint32_t groups{0};
    std::uint32_t masks{0};

    void add(const Mark& other) {
      groups |= other.groups;
      masks |= other.masks;
    }
    bool meets(const Mark& other) const {
      return (groups & other.masks) != 0 && (other.groups & masks) != 0;
    }
  };
  std::vector<Mark> triangles, nodes;

  /// @brief Those of a child of a node.
  const Mark& of(const MovingKdopNode& node, int lane) const {
    return node.isTriangle(lane)
               ? triangles[static_cast<std::size_t>(node.triangle(lane))]
               : nodes[static_cast<std::size_t>(node.child[lane])];
  }
};

/// @brief The marks of both trees: pairs of which they do not meet are left out. Null:
/// all count.
struct PairMarks {
  const TreeMarks* a{nullptr};
  const TreeMarks* b{nullptr};
};

/// @brief Visits every pair of triangles whose boxes overlap at some time.
///
/// @tparam TreeA, TreeB  const MovingKdopTree or RigidTreeReader
/// @tparam kSelf  tree_b is tree_a, and each unordered pair of different triangles is
/// visited once
template <bool kSelf, typename TreeA, typename TreeB>
class Traversal {
 public:
  /// @param shift  added to boxes of tree a: between the two trees' origins and
  /// translations, and a distance; null for kSelf without a distance
  /// @param axes  for two rigid trees: leaves out more pairs of nodes; null: not used
  /// @param timed  as in OverlapRequest
  /// @param marks  leaves out more pairs; both trees have them, or none
  Traversal(TreeA& tree_a, TreeB& tree_b, const KdopShift* shift,
            const SelfCulling& culling, const SeparatingAxes* axes,
            const Kernels& kernels, bool timed, const PairMarks& marks = {})
      : tree_a_(tree_a),
        tree_b_(tree_b),
        culling_(culling),
        axes_(axes),
        marks_{marks.a, marks.b},
        kernels_(kernels),
        request_{timed},
        is_shifted_(shift != nullptr) {
    assert(kSelf || shift);
    assert((marks.a == nullptr) == (marks.b == nullptr));
    if (shift) setShift(*shift);
  }

  /// @brief From here on this is added to boxes of tree a.
  /// @pre there was a shift
  void setShift(const KdopShift& shift) {
    assert(is_shifted_);
    assert(isValid(shift.t0) && isValid(shift.t1));
    // The shift of a box of tree b is the same, with opposite half-axes exchanged.
    for (int r = 0; r < 16; ++r) {
      const int j = MovingKdopNode::halfAxis(r);
      shift_[0][0][r] = shift_[1][0][r ^ 1] = shift.t0.half[j];
      shift_[0][1][r] = shift_[1][1][r ^ 1] = shift.t1.half[j];
    }
  }

  /// @brief Begins a task: what it does depends on nothing that came before.
  void beginTask() { trials_.begin(); }

  /// @brief Adds the first work: the whole of both trees.
  void start(WorkList& open) {
    if (kSelf)
      addSelf(0, open);
    else
      for (int lane = tree_a_.node(0).count; lane-- > 0;)
        open.add(0, lane, 0, false, 0.f);
  }

  /// @brief Does one piece of work: calls visit(triangle_a, triangle_b, earliest) for
  /// each pair of triangles, and adds the remaining work to `open`.
  /// @param work  may be in `open`, behind its end
  template <typename Visit>
  void step(const NodePair& work, WorkList& open, Visit&& visit) {
    const std::int32_t parent = work.parent, node = work.node;
    const int lane = work.lane;
    if (kSelf && lane < 0)
      openSelf(node, open, visit);
    else if (!kSelf && work.swapped)
      compare<true>(tree_b_.node(parent), parent, lane, tree_a_.node(node), node,
                    kAllLanes, open, visit);
    else
      compare<false>(tree_a_.node(parent), parent, lane, tree_b_.node(node), node,
                     kAllLanes, open, visit);
  }

  /// @brief After this call, boxes that do not meet until `latest` may be left out.
  /// @param pose_displacement  the sum of MeshInstance::poseDisplacement() of both meshes
  void leaveOutAfter(double latest, double pose_displacement) {
    request_.leaveOutAfter(latest, pose_displacement);
  }

  /// @brief The largest number of pairs that a step visits. Two nodes have at most one
  /// pair for each two lanes. A node with itself has more: each two of its triangles, and
  /// each of them with those of every child that has only triangles. These are 134 if
  /// four of its children are triangles.
  static constexpr std::size_t maxPairs() {
    constexpr std::size_t kWidth = MovingKdopNode::kWidth;
    std::size_t most = kWidth * kWidth;
    for (std::size_t i = 1; kSelf && i <= kWidth; ++i)
      most = std::max(most, i * (i - 1) / 2 + i * (kWidth - i) * kWidth);
    return most;
  }

  /// @brief Number of boxes that have been compared.
  std::uint64_t compared() const { return pairs_.compared; }

  /// @brief Number of triangle pairs whose boxes overlap and that lie in an embedded fan.
  std::uint64_t fanCulled() const { return pairs_.fan_culled; }

  void clearCounts() { pairs_.compared = pairs_.fan_culled = 0; }

 private:
  static constexpr unsigned kAllLanes = (1U << MovingKdopNode::kWidth) - 1;

  /// Adds a node with itself.
  void addSelf(std::int32_t i, WorkList& open) const {
    if (culling_.regions && culling_.regions[i]) return;
    if (marks_[0] && !mark(false, i).meets(mark(false, i))) return;
    if (!areInFan(i, i)) open.add(0, -1, i, false, 0.f);
  }

  /// The marks of a node of tree a or tree b.
  const TreeMarks::Mark& mark(bool of_b, std::int32_t node) const {
    return marks_[of_b]->nodes[static_cast<std::size_t>(node)];
  }

  /// Whether two nodes lie in the same fan.
  bool areInFan(std::int32_t i, std::int32_t j) const {
    const std::uint32_t* centers = culling_.nodes_in_fans;
    return kSelf && centers && centers[i] != MovingKdopNode::kNoPlace &&
           centers[i] == centers[j];
  }

  template <typename Visit>
  void openSelf(std::int32_t i, WorkList& open, Visit& visit) {
    // A reader's node is valid until the next call of node(), and compare() makes such
    // calls. So it is asked for again after compare(), also as the node of both trees.
    const unsigned lanes = tree_a_.node(i).lanes(), triangles = tree_a_.node(i).triangles;
    if (triangles)
      visitTriangles<false>(tree_a_.node(i), triangles, tree_a_.node(i), visit);
    for (int lane = 0; lanes >> lane != 0; ++lane) {
      const MovingKdopNode& node = tree_a_.node(i);
      unsigned later = lanes & ~((2U << lane) - 1);
      if (node.isTriangle(lane))
        later &= ~triangles;
      else
        addSelf(node.child[lane], open);
      if (later) compare<false>(node, i, lane, tree_b_.node(i), i, later, open, visit);
    }
  }

  /// Compares child `lane` of `parent`, node number i, with the children `lanes` of
  /// `node`, number j.
  template <bool kSwapped, typename Visit>
  void compare(const MovingKdopNode& parent, std::int32_t i, int lane,
               const MovingKdopNode& node, std::int32_t j, unsigned lanes, WorkList& open,
               Visit& visit) {
    assert(lane >= 0 && lane < parent.count);
    const bool is_triangle = parent.isTriangle(lane);
    const unsigned triangles = node.triangles;
    if (is_triangle) {
      if (triangles & lanes) visitTriangles<kSwapped>(parent, 1U << lane, node, visit);
      lanes &= ~triangles & node.lanes();
      if (lanes == 0) return;
    }
    const BoxView box{&parent.t0[0][lane], &parent.t1[0][lane], BoxView::kInNode,
                      parent.displacement[lane],
                      !kSelf || is_shifted_ ? shift_[kSwapped] : nullptr};
    pairs_.compared += static_cast<std::uint64_t>(node.count);
    float earliest[MovingKdopNode::kWidth];
    unsigned left = kernels_.overlapChildren(box, node, request_, earliest) & lanes;
    assert((left & ~node.lanes()) == 0);
    if (left == 0) return;
    // `parent` is not used after this, so a reader may replace it by its child.
    const std::int32_t mine = parent.child[lane];
    const float size = is_triangle ? 0.f : extentOf(parent, lane);
    if (!is_triangle && (left & triangles)) {
      const MovingKdopNode& child = kSwapped ? tree_b_.node(mine) : tree_a_.node(mine);
      if (child.triangles == child.lanes()) {
        if (!marks_[0] || mark(kSwapped, mine).meets(mark(!kSwapped, j)))
          visitTriangles<!kSwapped>(node, left & triangles, child, visit);
        left &= ~triangles;
      }
    }
    for (; left != 0; left &= left - 1) {
      const int k = lowestBit(left);
      if (marks_[0] &&
          !marks_[kSwapped]->of(parent, lane).meets(marks_[!kSwapped]->of(node, k)))
        continue;
      const bool both_nodes = !is_triangle && !node.isTriangle(k);
      if (both_nodes && areInFan(mine, node.child[k])) continue;
      const float other = both_nodes ? extentOf(node, k) : 0.f;
      if (both_nodes && axes_ &&
          areKeptApart(kSwapped ? node.child[k] : mine, kSwapped ? mine : node.child[k],
                       size + other))
        continue;
      if (is_triangle || (both_nodes && size < other))
        open.add(i, lane, node.child[k], kSwapped, earliest[k]);
      else
        open.add(j, k, mine, !kSwapped, earliest[k]);
    }
  }

  /// Whether an axis of one of the boxes of two nodes provably keeps them apart. Not
  /// inlined: most traversals have no axes.
  /// @param extents  the sum of those of both
  FCL_CCD_NOINLINE bool areKeptApart(std::int32_t a, std::int32_t b, float extents) {
    if (axes_->mayHelp(extents)) return axes_->areApart(a, b);
    if (!axes_->areOriented() || !trials_.isDue(extents)) return false;
    const bool is_apart = axes_->areApart(a, b);
    trials_.note(extents, is_apart);
    return is_apart;
  }

  /// Compares the triangles `lanes` of a node of tree a (kSwapped: b) with those of a
  /// node of the other tree, or of the same node.
  template <bool kSwapped, typename Visit>
  void visitTriangles(const MovingKdopNode& mine, unsigned lanes,
                      const MovingKdopNode& theirs, Visit& visit) {
    const bool is_shifted = !kSelf || is_shifted_;
    kernels_.overlapTriangles(
        {mine, theirs, lanes, is_shifted ? shift_[kSwapped] : nullptr, culling_.fans,
         request_, kSelf},
        pairs_);
    for (std::uint64_t left = pairs_.pairs; left != 0; left &= left - 1) {
      const int pair = lowestBit(left);
      const int i = pair / MovingKdopNode::kWidth, j = pair % MovingKdopNode::kWidth;
      const int x = mine.triangle(i), y = theirs.triangle(j);
      const float earliest = pairs_.earliest[i][j];
      assert(0 <= earliest && earliest <= 1);
      assert(!kSelf || x != y);
      if (marks_[0] && !marks_[kSwapped]->triangles[static_cast<std::size_t>(x)].meets(
                           marks_[!kSwapped]->triangles[static_cast<std::size_t>(y)]))
        continue;
      kSwapped ? visit(y, x, earliest) : visit(x, y, earliest);
    }
  }

  TreeA& tree_a_;
  TreeB& tree_b_;
  const SelfCulling culling_;
  const SeparatingAxes* axes_;
  const TreeMarks* const marks_[2];
  const Kernels& kernels_;
  OverlapRequest request_;
  bool is_shifted_;
  float shift_[2][2][16];
  LanePairs pairs_;
  AxisTrials trials_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

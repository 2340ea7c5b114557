// SPDX-License-Identifier: BSD-3-Clause
//
// The tree of feature_tree.h with the library's kernels: its binary structure in nodes of
// eight children, compared with a box at once, and boxes of features compared many at a
// time.
#ifndef FCL_BENCHMARK_BASELINES_WIDE_TREE_H
#define FCL_BENCHMARK_BASELINES_WIDE_TREE_H

#include <cstdint>
#include <vector>

#include "baselines/candidates.h"
#include "baselines/connectivity.h"
#include "baselines/method.h"
#include "scene_data.h"
#include "swept_tree.h"
#include "tree/moving_kdop_tree.h"
#include "tree/traversal.h"

namespace fcl {
namespace test {

/// @tparam kBoxes  swept boxes are moving boxes that are equal at t = 0 and t = 1
template <Boxes kBoxes>
class WideTree {
 public:
  using VertexPath = detail::deformable::VertexPath;

  /// @brief Structure, order and features, by the first frame.
  explicit WideTree(const FramePairMesh& mesh);

  const MeshConnectivity& connectivity() const { return connectivity_; }
  const std::vector<VertexPath>& paths() const { return paths_; }
  const std::vector<detail::deformable::TreeVertex>& vertices() const {
    return vertices_;
  }
  int originalVertex(std::uint32_t v) const { return static_cast<int>(original_[v]); }

  /// @brief Every node is a region.
  Regions regions() const;

  /// @brief Boxes of all nodes and vertices for a pair of frames.
  void refit(const FramePairMesh& mesh);

  /// @brief visit(i, j) for each two triangles whose boxes overlap.
  /// @param isLeftOut  isLeftOut(region): without those within the region
  template <typename IsLeftOut, typename Visit>
  void traverse(IsLeftOut&& isLeftOut, Visit&& visit) const {
    if constexpr (kBoxes == Boxes::kMoving)
      traverse(tree_, isLeftOut, visit);
    else
      traverse(swept_, isLeftOut, visit);
  }

  /// @brief Of the pairs of features of triangle pairs those whose boxes overlap.
  void findOverlaps(const std::vector<TrianglePairMask>& pairs,
                    std::vector<Candidate>& found);

 private:
  explicit WideTree(detail::deformable::MovingKdopTree tree);

  template <typename Tree, typename IsLeftOut, typename Visit>
  static void traverse(const Tree& tree, IsLeftOut& isLeftOut, Visit& visit) {
    namespace deformable = detail::deformable;
    deformable::Traversal<true, const Tree, const Tree> traversal(
        tree, tree, nullptr, deformable::SelfCulling(), nullptr, deformable::kernels(),
        false);
    deformable::WorkList open;
    traversal.start(open);
    while (open.size() > 0) {
      const deformable::NodePair work = open[open.size() - 1];
      open.cut(open.size() - 1);
      if (work.lane < 0 && isLeftOut(work.node)) continue;
      traversal.step(work, open, [&](int i, int j, float) { visit(i, j); });
    }
  }

  detail::deformable::MovingKdopTree tree_;
  MeshConnectivity connectivity_;
  std::vector<std::uint32_t> original_;
  SweptTree swept_;
  /// As the tree's; with swept boxes, if these are to be compared.
  std::vector<detail::deformable::TreeVertex> vertices_;
  std::vector<VertexPath> paths_;
  std::vector<detail::deformable::TrianglePair> triangle_pairs_;
  std::vector<std::uint16_t> masks_;
  std::vector<std::uint32_t> codes_;
  std::vector<detail::deformable::TimeWindow> windows_;
};

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_TRAVERSE_H
#define FCL_TEST_SUPPORT_TRAVERSE_H

#include <cstdint>
#include <vector>

#include "mesh/mesh_topology.h"
#include "self_culling/embedded_fans.h"
#include "tree/traversal.h"

namespace fcl {
namespace test {

/// @brief Does all steps of a traversal, without a query: visit(i, j, earliest) for
/// triangles i and j, which are places in the trees.
/// @param latest  pairs that start later are left out
/// @param culling, axes  those of Traversal
/// @return the number of compared boxes
template <bool kSelf, typename TreeA, typename TreeB, typename Visit>
std::uint64_t traverse(TreeA& a, TreeB& b, const detail::deformable::KdopShift* shift,
                       Visit&& visit, double latest = 1,
                       const detail::deformable::SelfCulling& culling = {},
                       const detail::deformable::SeparatingAxes* axes = nullptr) {
  namespace deformable = detail::deformable;
  deformable::Traversal<kSelf, TreeA, TreeB> traversal(a, b, shift, culling, axes,
                                                       deformable::kernels(), true);
  deformable::WorkList open;
  traversal.start(open);
  while (open.size() > 0) {
    const deformable::NodePair work = open[open.size() - 1];
    open.cut(open.size() - 1);
    if (work.earliest > latest) continue;
    traversal.step(work, open, [&](int i, int j, float earliest) {
      if (earliest <= latest) visit(i, j, earliest);
    });
  }
  return traversal.compared();
}

/// @brief For each vertex of the tree, whether its fan is embedded, as queries compute
/// it.
inline std::vector<std::uint8_t> embeddedFans(
    const detail::deformable::MovingKdopTree& tree) {
  const std::vector<std::uint8_t> left_out(tree.vertices().size(), 0);
  return findEmbeddedFans(tree, left_out, detail::deformable::kernels(), 1);
}

/// @brief The user's ids and the features of the triangle at place i of the tree.
inline detail::deformable::MeshTriangle triangleOf(
    const detail::deformable::MovingKdopTree& tree, int i) {
  const detail::deformable::TreeTriangle& t =
      tree.triangles()[static_cast<std::size_t>(i)];
  return {{t.id[0], t.id[1], t.id[2]}, t.owned};
}

}  // namespace test
}  // namespace fcl

#endif

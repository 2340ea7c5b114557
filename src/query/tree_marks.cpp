// SPDX-License-Identifier: BSD-3-Clause
#include "query/tree_marks.h"

#include <cassert>
#include <cstddef>

namespace fcl {
namespace detail {
namespace deformable {

TreeMarks treeMarksOf(const MovingKdopTree& tree, const TriangleMarks& marks) {
  TreeMarks out;
  // A feature has a vertex in common with each triangle that holds it.
  std::vector<TreeMarks::Mark> vertices(tree.vertices().size());
  for (const TreeTriangle& triangle : tree.triangles()) {
    const auto index = static_cast<std::int32_t>(triangle.index);
    for (const std::uint32_t place : triangle.place)
      vertices[place].add({marks.groupOf(index), marks.maskOf(index)});
  }
  out.triangles.resize(tree.triangles().size());
  for (std::size_t i = 0; i < out.triangles.size(); ++i)
    for (const std::uint32_t place : tree.triangles()[i].place)
      out.triangles[i].add(vertices[place]);
  out.nodes.resize(tree.numNodes());
  // Children come after their parents.
  for (std::size_t i = out.nodes.size(); i-- > 0;) {
    const MovingKdopNode& node = tree.node(static_cast<int>(i));
    for (int lane = 0; lane < node.count; ++lane) {
      assert(node.isTriangle(lane) || node.child[lane] > static_cast<std::int32_t>(i));
      out.nodes[i].add(out.of(node, lane));
    }
  }
  return out;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

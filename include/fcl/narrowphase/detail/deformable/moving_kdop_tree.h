// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_MOVING_KDOP_TREE_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_MOVING_KDOP_TREE_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "fcl/math/bv/moving_kdop.h"
#include "fcl/narrowphase/detail/deformable/mesh_topology.h"
#include "fcl/narrowphase/detail/deformable/uninitialized_vector.h"
#include "fcl/narrowphase/detail/deformable/vertex_fans.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Up to eight children, each a subtree or a triangle, with their moving boxes. A
/// row holds one half-axis of all children, so that one box is compared with eight at
/// once; the two half-axes of a direction follow each other. What holds at t = 0 lies
/// together: much of a first-contact query reads nothing else.
struct alignas(64) MovingKdopNode {
  static constexpr int kWidth = 8;
  static constexpr std::uint32_t kNoPlace = ~std::uint32_t{0};

  /// Row r at t = 0 and at t = 1.
  float t0[16][kWidth];
  float t1[16][kWidth];
  /// Vertices of the triangles, as places in the tree's order; kNoPlace for a node.
  std::uint32_t places[3][kWidth];
  /// Bound on the change of a coordinate of a vertex of the child in the step.
  float displacement[kWidth];
  /// >= 0: a node; < 0: ~triangle. The first `count` are in use.
  std::int32_t child[kWidth];
  std::int32_t count;
  /// Lanes that are triangles, a bit each: markTriangles().
  std::uint32_t triangles;

  bool isTriangle(int lane) const { return child[lane] < 0; }
  int triangle(int lane) const { return ~child[lane]; }

  /// @brief Lanes that are in use, a bit each.
  unsigned lanes() const { return (1U << count) - 1; }

  /// @brief To be called when the children are set.
  void markTriangles() {
    triangles = 0;
    for (int lane = 0; lane < count; ++lane)
      triangles |= unsigned{isTriangle(lane)} << lane;
  }

  /// @brief Half-axis of Kdop16 that a row holds.
  static constexpr int halfAxis(int row) { return row / 2 + row % 2 * 8; }

  /// @brief Row that holds a half-axis of Kdop16.
  static constexpr int rowOf(int half_axis) { return half_axis % 8 * 2 + half_axis / 8; }

  void setBox(int lane, const MovingKdop& box) {
    for (int r = 0; r < 16; ++r) {
      t0[r][lane] = box.t0.half[halfAxis(r)];
      t1[r][lane] = box.t1.half[halfAxis(r)];
    }
  }
  MovingKdop box(int lane) const {
    MovingKdop out;
    for (int r = 0; r < 16; ++r) {
      out.t0.half[halfAxis(r)] = t0[r][lane];
      out.t1.half[halfAxis(r)] = t1[r][lane];
    }
    return out;
  }
  /// @brief Fills the lanes that are not in use with boxes that overlap nothing.
  void clearRest() {
    for (int i = count; i < kWidth; ++i) {
      child[i] = 0;
      displacement[i] = 0;
      for (int r = 0; r < 16; ++r) t0[r][i] = t1[r][i] = kLeastHalf;
    }
  }
};

/// @brief A triangle where the tests read it.
struct TreeTriangle {
  /// Places of the vertices in the tree's order.
  std::uint32_t place[3];
  std::uint32_t owned;
  /// The user's ids of the vertices and of the triangle.
  std::uint32_t id[3];
  std::uint32_t index;
};

inline ThreeIds idsOf(const TreeTriangle& t) {
  static_assert(offsetof(TreeTriangle, id) + sizeof(ThreeIds) == sizeof(TreeTriangle),
                "one more number may be read");
  ThreeIds ids;
  std::memcpy(&ids, reinterpret_cast<const char*>(&t) + offsetof(TreeTriangle, id),
              sizeof(ids));
  return ids;
}

/// @brief A vertex where the tests read it: its path, t0[3] a bound on the change of a
/// coordinate in the step, which is a float (t1[3] is not used); and its moving box.
struct alignas(64) TreeVertex {
  double t0[4];
  double t1[4];
  MovingKdop box;

  double displacement() const { return t0[3]; }

  /// @brief Sets the path. Differences of doubles are rounded by 2^-53 of themselves,
  /// much less than roundUp() adds.
  void setPath(const double (&from)[3], const double (&to)[3]) {
    double moved = 0;
    for (int k = 0; k < 3; ++k) {
      t0[k] = from[k];
      t1[k] = to[k];
      moved = std::max(moved, std::fabs(to[k] - from[k]));
    }
    t0[3] = double{roundUp(moved, 0.f)};
    t1[3] = 0;
  }
};

class RegionBorders;
class TopologyDifference;
struct TreeChildren;
struct TreeStructure;

/// @brief A tree of moving 16-DOPs over the triangles of a mesh, eight children a node.
/// The structure is made by build() or from the links of another tree; refit() sets the
/// boxes for a pair of frames; restructure() renews what has aged; changeTopology()
/// follows a mesh that breaks. Triangles and vertices lie in the order in which the tree
/// meets them, so that neighbours on the surface are neighbours in memory.
///
/// Nodes lie in one array in the order of a walk, children after their parents: what is
/// below a node lies together and is refit in one backward pass.
class MovingKdopTree {
 public:
  /// @brief Makes the structure: large components apart from each other, surface-area
  /// splits of the triangles' centroids in frame 0, and halving at the bottom so that the
  /// lowest nodes are full.
  /// @param triangles  at least one, indices below frames.size() (not checked here)
  /// @param num_threads  as in parallelFor(); the tree does not depend on it
  void build(const Triangle* triangles, std::size_t num_triangles,
             const VertexFrames& frames, int num_threads = 1);

  /// @brief Takes the structure from a binary tree: links[i] >= 0 is the left child of
  /// node i (the right one follows it), links[i] < 0 is leaf ~links[i].
  /// @param num_threads  as in parallelFor(); the tree does not depend on it
  void build(const Triangle* triangles, std::size_t num_triangles,
             std::size_t num_vertices, const std::vector<std::int32_t>& links,
             int num_threads = 1);

  /// @brief Sets every box: the box interpolated at t contains the subtree's triangles at
  /// t, for every t in [0, 1], up to nothing: all rounding is outward.
  /// @param num_threads  as in parallelFor(); the boxes do not depend on it
  void refit(const VertexFrames& frames, int num_threads = 1);

  /// @brief Makes those parts of the structure anew that have aged, that is, whose boxes
  /// motion has made larger beside their triangles' than they were when the part was
  /// made; if all boxes together have become much larger. To be called before a refit,
  /// since it looks at the boxes of the last one and leaves none behind.
  /// @return whether the structure has changed; not if there is no memory for it
  bool restructure();

  /// @brief Follows a mesh that tears, breaks, grows or loses parts: nodes stay as they
  /// are unless triangles come to them or leave them. Leaves no boxes behind; an
  /// exception leaves the tree as it was.
  /// @param triangles  at least one, indices below frames.size() (not checked here)
  /// @param origins  for each of them the number of the one before that it was or was cut
  /// from, -1 for one that comes to where it lies in frame 0; empty: each was the one of
  /// its number, as far as there was one; a hint: no answer depends on it
  /// @param num_threads  as in parallelFor(); the tree does not depend on it
  /// @pre refit() has set the boxes
  void changeTopology(const Triangle* triangles, std::size_t num_triangles,
                      const std::vector<int>& origins, const VertexFrames& frames,
                      int num_threads = 1);

  const MovingKdopNode& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }
  std::size_t numNodes() const { return nodes_.size(); }

  /// @brief The first of the triangles below node i, which lie together.
  std::uint32_t firstTriangle(int i) const {
    return first_triangles_[static_cast<std::size_t>(i)];
  }

  /// @brief How many vertices the triangles before triangle i have.
  std::uint32_t placesBefore(std::size_t i) const;

  /// @brief Triangles and vertices in the tree's order.
  const std::vector<TreeTriangle>& triangles() const { return triangles_; }
  const UninitializedVector<TreeVertex>& vertices() const { return vertices_; }

  /// @brief The fans of the vertices in the tree's order.
  const VertexFans& fans() const { return fans_; }

  /// @brief The borders of nodes that queries have asked for; for any number of threads.
  RegionBorders& regionBorders() const { return *region_borders_; }

  /// @brief World point that the boxes of a frame (0 or 1) are relative to; the same of
  /// both, unless most of the mesh is far away from it.
  const double (&origin(int frame) const)[3] { return origin_[frame]; }

  /// @brief Largest distance of a vertex from the origin along an axis, in both frames.
  double reach() const { return reach_; }

  std::size_t memUsage() const;

 private:
  /// A part of the tree: nodes [first_node, last_node) below its root, and the vertices
  /// that are met there first.
  struct Subtree {
    std::uint32_t root, first_node, last_node, first_triangle, first_vertex, last_vertex;
  };
  /// Extents of a node's box, and of all triangles' boxes below together: along all eight
  /// directions, in both frames; and how many of the triangles are blurred.
  struct NodeSize {
    float box, triangles;
    std::uint32_t blurred;
  };
  /// Least and greatest coordinates.
  struct Range;
  class Restructuring;
  class TopologyUpdate;

  /// The box as it would be had it only grown as its triangles have.
  static float expectedBox(const NodeSize& first, const NodeSize& now) {
    return first.box * (now.triangles / first.triangles);
  }

  static TreeStructure walk(std::int32_t root, const std::vector<TreeChildren>& nodes,
                            const std::vector<NodeSize>& sizes, std::size_t num_leaves,
                            std::vector<NodeSize>& first_sizes);
  void adopt(const Restructuring& restructuring);
  void arrange(const TreeStructure& structure, const Triangle* triangles,
               std::size_t num_vertices, int num_threads);
  void place(const TreeStructure& structure, const Triangle* triangles,
             std::size_t num_vertices, int num_threads);
  void takeMemory(const MovingKdopTree& other, const TreeStructure& structure);
  void become(MovingKdopTree&& next, const TreeStructure& structure) noexcept;
  void inherit(const MovingKdopTree& before, const TopologyDifference& difference,
               int num_threads);
  void findSubtrees(const TreeStructure& structure);
  void placeVertices(std::size_t num_vertices);
  void setNodes(const TreeStructure& structure, int num_threads);
  void setNode(const TreeChildren& from, MovingKdopNode& node) const;
  Range rangeOf(const VertexFrames& frames, int num_threads) const;
  double medianOf(const VertexFrames& frames, int frame, int axis) const;
  void setReach(const Range& range);
  void fit(const VertexFrames& frames, int num_threads);
  void fitVertices(const Subtree& subtree, const VertexFrames& frames);
  void refit(MovingKdopNode& node, bool is_still);
  void refit(const Subtree& subtree, bool is_still);
  void refitGroups(const VertexFrames& frames, int num_threads);

  UninitializedVector<MovingKdopNode> nodes_;
  std::vector<std::uint32_t> first_triangles_;
  /// placesBefore() of every eighth triangle.
  std::vector<std::uint32_t> places_before_;
  std::vector<TreeTriangle> triangles_;
  UninitializedVector<TreeVertex> vertices_;
  /// The user's id of each vertex.
  std::vector<std::uint32_t> vertex_ids_;
  VertexFans fans_;
  /// Of the structure as it is, also of copies that have the same.
  std::shared_ptr<RegionBorders> region_borders_;
  /// What is refit independently, and the nodes above, parents first.
  std::vector<Subtree> subtrees_;
  std::vector<std::uint32_t> top_;
  /// Of each node as it is, and as it was when it was made; 0 as long as unknown.
  std::vector<NodeSize> sizes_;
  std::vector<NodeSize> first_sizes_;
  double origin_[2][3]{};
  double reach_{0};
  /// Triangles whose boxes have smaller extents are blurred.
  float blur_{0};
};

/// @brief Opens node i of a binary tree until there are eight nodes or only leaves.
/// @param link  link(i) >= 0: left child of i (the right one follows it); < 0: ~triangle
/// @param nodes  the nodes
/// @param children  the same, or ~triangle for leaves
/// @return number of entries
template <typename Link>
int openBinary(std::int32_t i, std::int32_t (&nodes)[MovingKdopNode::kWidth],
               std::int32_t (&children)[MovingKdopNode::kWidth], Link&& link) {
  int n = 1;
  nodes[0] = i;
  for (bool grew = true; grew;) {
    grew = false;
    const int before = n;
    for (int k = 0; k < before && n < MovingKdopNode::kWidth; ++k) {
      const std::int32_t left = link(nodes[k]);
      if (left < 0) continue;
      nodes[k] = left;
      nodes[n++] = left + 1;
      grew = true;
    }
  }
  for (int k = 0; k < n; ++k) {
    const std::int32_t left = link(nodes[k]);
    children[k] = left < 0 ? left : nodes[k];
  }
  return n;
}

/// @brief Box of a point relative to an origin, with `pad` for what was rounded before.
void fitPoint(const double* point, const double (&origin)[3], float pad, Kdop16& out);

/// @brief Where the boxes of a tree are in space: [frame][axis].
struct BoxPlace {
  /// What they are relative to.
  double origin[2][3];
  /// By which the mesh is moved on top.
  double translation[2][3];
  /// Of a RigidTree, as reach(); 0 of a MovingKdopTree, whose boxes have room for the
  /// rounding of what is relative to the origin.
  double reach;
};

/// @brief What to add to the sum of a box of one tree and one of another: outward by the
/// rounding of the numbers that make it, and of the moved coordinates themselves.
KdopShift relativeShift(const BoxPlace& a, const BoxPlace& b);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

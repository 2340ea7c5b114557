// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_MOVING_KDOP_TREE_H
#define FCL_CCD_TREE_MOVING_KDOP_TREE_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/uninitialized_vector.h"
#include "mesh/moving_kdop.h"
#include "mesh/tree_nodes.h"
#include "mesh/vertex_fans.h"
#include "mesh/vertex_frames.h"

namespace fcl {
namespace detail {
namespace deformable {

class RegionBorders;
class TopologyDifference;
struct TreeChildren;
struct TreeStructure;

/// @brief A tree of moving 16-DOPs over the triangles of a mesh, with eight children per
/// node. build() makes the structure, from triangles or from the links of another tree.
/// refit() sets the boxes for a pair of frames. restructure() rebuilds aged parts.
/// changeTopology() follows a mesh that breaks. Triangles and vertices are kept in the
/// order in which the tree meets them, so that neighbours on the surface are neighbours
/// in memory.
///
/// Nodes are in one array in the order of a walk, children after their parents. So all
/// nodes below a node follow each other, and one pass from back to front refits them.
class MovingKdopTree {
 public:
  /// @brief Makes the structure. Large components have trees of their own. At the top the
  /// triangles' centroids in frame 0 are split by surface area. At the bottom ranges are
  /// halved, so that the lowest nodes are full.
  /// @param triangles  at least one, indices below frames.size() (not checked here)
  /// @param num_threads  as in parallelFor(); the tree does not depend on it
  /// @param free  how many of the triangles, at their end, are free edges and free points
  void build(TriangleArray triangles, std::size_t num_triangles,
             const VertexFrames& frames, int num_threads = 1, FreeLeaves free = {});

  /// @brief Takes the structure from a binary tree: links[i] >= 0 is the left child of
  /// node i (the right child follows it), links[i] < 0 is leaf ~links[i].
  /// @param num_threads  as in parallelFor(); the tree does not depend on it
  void build(TriangleArray triangles, std::size_t num_triangles, std::size_t num_vertices,
             const std::vector<std::int32_t>& links, int num_threads = 1);

  /// @brief Sets all boxes. The box interpolated at t contains the subtree's triangles at
  /// t, for every t in [0, 1]. There is no tolerance: all rounding is outward.
  /// @param num_threads  as in parallelFor(); the boxes do not depend on it
  void refit(const VertexFrames& frames, int num_threads = 1);

  /// @brief Rebuilds the parts of the structure that have aged, if all boxes together
  /// have become much larger. A part has aged if motion has made its boxes larger,
  /// relative to those of its triangles, than they were when the part was made. Call it
  /// before a refit: it uses the boxes of the last refit, and leaves none behind.
  /// @return whether the structure has changed; false if there is not enough memory for
  /// it
  bool restructure();

  /// @brief Follows a mesh that tears, breaks, grows or loses parts. Nodes stay as they
  /// are, unless triangles come to them or leave them. Leaves no boxes behind. An
  /// exception leaves the tree unchanged.
  /// @param triangles  at least one, indices below frames.size() (not checked here)
  /// @param origins  for each triangle, the number of the previous triangle that it was
  /// or was cut from. -1: the triangle is new, and is added next to its position in frame
  /// 0. Empty: each triangle was the one of the same number, if there was one. It is a
  /// hint: no answer depends on it
  /// @param num_threads  as in parallelFor(); the tree does not depend on it
  /// @pre refit() has set the boxes; there are no free leaves
  void changeTopology(TriangleArray triangles, std::size_t num_triangles,
                      const std::vector<int>& origins, const VertexFrames& frames,
                      int num_threads = 1);

  const MovingKdopNode& node(int i) const {
    assert(i >= 0 && static_cast<std::size_t>(i) < nodes_.size());
    return nodes_[static_cast<std::size_t>(i)];
  }
  std::size_t numNodes() const { return nodes_.size(); }

  /// @brief The first of the triangles below node i. They follow each other.
  std::uint32_t firstTriangle(int i) const {
    assert(i >= 0 && static_cast<std::size_t>(i) < first_triangles_.size());
    return first_triangles_[static_cast<std::size_t>(i)];
  }

  /// @brief Number of vertices that the triangles before triangle i have.
  std::uint32_t placesBefore(std::size_t i) const;

  const FreeLeaves& freeLeaves() const { return free_; }

  /// @brief Triangles and vertices in the tree's order.
  const std::vector<TreeTriangle>& triangles() const { return triangles_; }
  const UninitializedVector<TreeVertex>& vertices() const { return vertices_; }

  /// @brief The fans of the vertices in the tree's order.
  const VertexFans& fans() const { return fans_; }

  /// @brief The borders of nodes that queries have asked for. Any number of threads may
  /// use them at the same time.
  RegionBorders& regionBorders() const { return *region_borders_; }

  /// @brief The world point that the boxes of a frame (0 or 1) are relative to. Both
  /// frames have the same, unless most of the mesh is far away from it.
  const double (&origin(int frame) const)[3] { return origin_[frame]; }

  /// @brief Largest distance of a vertex from the origin along an axis, in both frames.
  double largestCoordinate() const { return largest_coordinate_; }

  std::size_t memUsage() const;

 private:
  /// A part of the tree: nodes [first_node, last_node) below its root, and the vertices
  /// that are first met there.
  struct Subtree {
    std::uint32_t root, first_node, last_node, first_triangle, first_vertex, last_vertex;
  };
  /// Extents of a node's box, and the sum of those of the triangles below it, along all
  /// eight directions in both frames. The number of these triangles that are blurred.
  struct NodeSize {
    float box, triangles;
    std::uint32_t blurred;
  };
  /// Least and greatest coordinates.
  struct CoordinateBounds;
  class Restructuring;
  class TopologyUpdate;

  /// The size of a box that has grown as much as its triangles.
  static float expectedBox(const NodeSize& first, const NodeSize& now) {
    return first.box * (now.triangles / first.triangles);
  }

  static TreeStructure walk(std::int32_t root, const std::vector<TreeChildren>& nodes,
                            const std::vector<NodeSize>& sizes, std::size_t num_leaves,
                            std::vector<NodeSize>& first_sizes);
  bool isConsistent() const;
  void adopt(const Restructuring& restructuring);
  void markFreeLeaves();
  void arrange(const TreeStructure& structure, TriangleArray triangles,
               std::size_t num_vertices, int num_threads);
  void assignPlaces(const TreeStructure& structure, TriangleArray triangles,
                    std::size_t num_vertices, int num_threads);
  void takeMemory(const MovingKdopTree& other, const TreeStructure& structure);
  void become(MovingKdopTree&& next, const TreeStructure& structure) noexcept;
  void inherit(const MovingKdopTree& before, const TopologyDifference& difference,
               int num_threads);
  void findSubtrees(const TreeStructure& structure);
  void placeVertices(std::size_t num_vertices);
  void setNodes(const TreeStructure& structure, int num_threads);
  void setNode(const TreeChildren& from, MovingKdopNode& node) const;
  CoordinateBounds boundsOf(const VertexFrames& frames, int num_threads) const;
  double medianOf(const VertexFrames& frames, int frame, int axis) const;
  void setLargestCoordinate(const CoordinateBounds& bounds);
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
  FreeLeaves free_;
  UninitializedVector<TreeVertex> vertices_;
  /// The user's id of each vertex.
  std::vector<std::uint32_t> vertex_ids_;
  VertexFans fans_;
  /// They belong to the structure. Copies of the tree with the same structure share them.
  std::shared_ptr<RegionBorders> region_borders_;
  /// The parts that are refit independently, and the nodes above them, parents first.
  std::vector<Subtree> subtrees_;
  std::vector<std::uint32_t> top_;
  /// For each node the size now, and the size when it was made; 0 as long as unknown.
  std::vector<NodeSize> sizes_;
  std::vector<NodeSize> first_sizes_;
  double origin_[2][3]{};
  double largest_coordinate_{0};
  /// Triangles whose boxes have smaller extents are blurred: their boxes are mostly
  /// rounding.
  float blur_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

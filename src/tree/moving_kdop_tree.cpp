// SPDX-License-Identifier: BSD-3-Clause
#include "tree/moving_kdop_tree.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/prefetch.h"
#include "kernels/kernels.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_corners.h"
#include "tree/open_binary.h"
#include "tree/region_borders.h"
#include "tree/tree_builder.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr int kWidth = MovingKdopNode::kWidth;

/// The largest number of nodes that are refit together, while their vertices are in the
/// cache: 80 KB of nodes.
constexpr std::uint32_t kMaxSubtree = 64;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// The size of a task in vertices, and in subtrees. Subtrees come in groups of 4 MB of
/// nodes.
constexpr std::size_t kVertexBlock = 2048, kSubtreeBlock = 2, kSubtreeGroup = 64;

/// The size of a task in triangles while the tree is made.
constexpr std::size_t kTriangleBlock = 8192;

/// The number of places before a triangle is stored for every kPlacesBlock-th triangle.
constexpr std::size_t kPlacesBlock = 8;

/// Data in random order is prefetched this many steps before it is read.
constexpr std::size_t kAhead = 8;

/// Prefetches a node's boxes, which will be written soon.
void prefetchRows(const MovingKdopNode& node) {
  const char* at = reinterpret_cast<const char*>(&node);
  for (std::size_t i = 0; i < sizeof(node); i += 64) prefetchToWrite(at + i);
}

}  // namespace

void MovingKdopTree::build(TriangleArray triangles, std::size_t num_triangles,
                           const VertexFrames& frames, int num_threads, FreeLeaves free) {
  assert(num_triangles > 0 && free.count() <= num_triangles &&
         findOutOfRange(triangles, num_triangles, frames.size()) == 3 * num_triangles);
  arrange(splitTriangles(triangles, num_triangles, frames, num_threads, free), triangles,
          frames.size(), num_threads);
  free_ = free;
  markFreeLeaves();
}

/// A free leaf has no face, and what it shares with triangles is theirs: their numbers
/// are lower.
void MovingKdopTree::markFreeLeaves() {
  if (free_.count() == 0) return;
  const std::size_t num_faces = triangles_.size() - free_.count();
  constexpr std::uint32_t kNoFace = 0x3f;
  for (TreeTriangle& triangle : triangles_) {
    if (triangle.index < num_faces) continue;
    triangle.owned = (triangle.owned & kNoFace) | kFreeLeaf;
    // Else pairs of the leaf with triangles around a vertex would be culled.
    for ([[maybe_unused]] const std::uint32_t place : triangle.place)
      assert(fans_[place].count == 0);
  }
  assert(std::count_if(triangles_.begin(), triangles_.end(), [](const TreeTriangle& t) {
           return (t.owned & kFreeLeaf) != 0;
         }) == static_cast<std::ptrdiff_t>(free_.count()));
}

void MovingKdopTree::build(TriangleArray triangles, std::size_t num_triangles,
                           std::size_t num_vertices,
                           const std::vector<std::int32_t>& links, int num_threads) {
  assert(num_triangles > 0 && !links.empty() &&
         findOutOfRange(triangles, num_triangles, num_vertices) == 3 * num_triangles);
  const auto children = [&links](std::int32_t link, std::size_t) {
    std::int32_t nodes[kWidth];
    TreeChildren out{};
    out.count = openBinary(link, nodes, out.child, [&links](std::int32_t i) {
      return links[static_cast<std::size_t>(i)];
    });
    return out;
  };
  arrange(inWalkOrder(num_triangles, children), triangles, num_vertices, num_threads);
  free_ = {};
}

/// Whether arrays about the same things have the same sizes.
bool MovingKdopTree::isConsistent() const {
  return !nodes_.empty() && nodes_.size() == sizes_.size() &&
         nodes_.size() == first_sizes_.size() &&
         nodes_.size() == first_triangles_.size() && !vertices_.empty() &&
         vertices_.size() == vertex_ids_.size() && vertices_.size() == fans_.size() &&
         region_borders_;
}

/// Takes over a structure, and finds fans and owners.
void MovingKdopTree::arrange(const TreeStructure& structure, TriangleArray triangles,
                             std::size_t num_vertices, int num_threads) {
  assignPlaces(structure, triangles, num_vertices, num_threads);
  setNodes(structure, num_threads);
  UninitializedVector<TreeVertex>(vertex_ids_.size()).swap(vertices_);
  const VertexCorners corners(triangles_, vertex_ids_.size(), num_threads);
  fans_ = VertexFans(corners, num_threads);
  assignOwners(corners, num_threads, triangles_);
  assert(isConsistent());
}

/// Takes over the triangles of a structure, and gives the vertices their places.
void MovingKdopTree::assignPlaces(const TreeStructure& structure, TriangleArray triangles,
                                  std::size_t num_vertices, int num_threads) {
  const std::vector<std::uint32_t>& leaves = structure.leaves;
  assert(isInWalkOrder(structure) && isPermutation(leaves));
  triangles_.resize(leaves.size());
  parallelForBlocks(leaves.size(), kTriangleBlock, num_threads,
                    [&](std::size_t i, std::size_t last) {
                      for (; i < last; ++i) {
                        if (i + kAhead < last)
                          prefetchMemory(triangles.address(leaves[i + kAhead]));
                        triangles_[i].index = leaves[i];
                        triangles.copyIds(leaves[i], triangles_[i].id);
                      }
                    });
  findSubtrees(structure);
  placeVertices(num_vertices);
}

/// Allocates memory for nodes and vertices, if the memory of the other tree, which this
/// one will replace, is too small.
void MovingKdopTree::takeMemory(const MovingKdopTree& other,
                                const TreeStructure& structure) {
  const std::size_t num_nodes = structure.nodes.size(), num_vertices = vertex_ids_.size();
  sizes_.resize(num_nodes);
  region_borders_ = std::make_shared<RegionBorders>(num_nodes);
  // A tree that changes has a few more nodes each time.
  if (other.nodes_.capacity() < num_nodes) nodes_.reserve(num_nodes + num_nodes / 16);
  if (other.vertices_.capacity() < num_vertices)
    vertices_.reserve(num_vertices + num_vertices / 16);
}

/// Becomes another tree, which has all but nodes and vertices, and memory for them. It
/// runs on one thread, because a task would need more memory.
void MovingKdopTree::become(MovingKdopTree&& next,
                            const TreeStructure& structure) noexcept {
  if (next.nodes_.capacity() == 0) next.nodes_ = std::move(nodes_);
  if (next.vertices_.capacity() == 0) next.vertices_ = std::move(vertices_);
  assert(next.nodes_.capacity() >= structure.nodes.size() &&
         next.vertices_.capacity() >= next.vertex_ids_.size());
  next.nodes_.resize(structure.nodes.size());
  next.vertices_.resize(next.vertex_ids_.size());
  for (std::size_t i = 0; i < structure.nodes.size(); ++i)
    next.setNode(structure.nodes[i], next.nodes_[i]);
  *this = std::move(next);
  assert(isConsistent());
}

/// Finds the first triangle of each node, and the largest parts of the tree that are
/// refit together.
void MovingKdopTree::findSubtrees(const TreeStructure& structure) {
  const auto& nodes = structure.nodes;
  const auto isNode = [](std::int32_t child) { return child > 0; };
  // Children come after their parents.
  std::vector<std::uint32_t> size(nodes.size(), 1);
  first_triangles_.resize(nodes.size());
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const std::int32_t* child = nodes[i].child;
    const std::int32_t* leaf = std::find_if_not(child, child + nodes[i].count, isNode);
    // The node's own leaves come before those of its children.
    first_triangles_[i] = leaf != child + nodes[i].count
                              ? static_cast<std::uint32_t>(~*leaf)
                              : first_triangles_[static_cast<std::size_t>(*child)];
    for (int k = 0; k < nodes[i].count; ++k)
      if (isNode(child[k])) size[i] += size[static_cast<std::size_t>(child[k])];
  }
  assert(size[0] == nodes.size() && first_triangles_[0] == 0);
  top_.clear();
  subtrees_.clear();
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    const TreeChildren& node = nodes[i];
    const auto end = node.child + node.count;
    const std::int32_t* first = std::find_if(node.child, end, isNode);
    if (size[i] > kMaxSubtree) {
      top_.push_back(i);
      for (const std::int32_t* child = end; child-- != first;)
        if (isNode(*child)) open.push_back(static_cast<std::uint32_t>(*child));
      continue;
    }
    Subtree subtree{};
    subtree.root = i;
    if (size[i] > 1) subtree.first_node = static_cast<std::uint32_t>(*first);
    subtree.last_node = subtree.first_node + size[i] - 1;
    subtree.first_triangle = first_triangles_[i];
    assert(
        subtree.last_node <= nodes.size() &&
        (subtrees_.empty() || subtrees_.back().first_triangle < subtree.first_triangle));
    subtrees_.push_back(subtree);
  }
}

/// Gives the vertices places in the order in which triangles have them. Each vertex
/// belongs to the first subtree that has it.
void MovingKdopTree::placeVertices(std::size_t num_vertices) {
  constexpr std::uint32_t kNoPlace = MovingKdopNode::kNoPlace;
  std::vector<std::uint32_t> place_of(num_vertices, kNoPlace);
  // One more element, which is written but not counted.
  vertex_ids_.resize(num_vertices + 1);
  places_before_.resize((triangles_.size() + kPlacesBlock - 1) / kPlacesBlock);
  std::uint32_t num_places = 0;
  std::size_t i = 0;
  for (std::size_t s = 0; s < subtrees_.size(); ++s) {
    subtrees_[s].first_vertex = num_places;
    // Triangles of nodes above that are between two subtrees belong to the first of them.
    const bool is_last = s + 1 == subtrees_.size();
    const std::size_t end = is_last ? triangles_.size() : subtrees_[s + 1].first_triangle;
    for (; i < end; ++i) {
      if (i % kPlacesBlock == 0) places_before_[i / kPlacesBlock] = num_places;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t id = triangles_[i].id[k];
        assert(id < num_vertices);
        std::uint32_t& place = place_of[id];
        // No branch: it would be unpredictable.
        const bool is_new = place == kNoPlace;
        place = is_new ? num_places : place;
        vertex_ids_[num_places] = id;
        num_places += is_new;
        triangles_[i].place[k] = place;
      }
    }
    subtrees_[s].last_vertex = num_places;
  }
  assert(i == triangles_.size() && num_places <= num_vertices);
  vertex_ids_.resize(num_places);
}

std::uint32_t MovingKdopTree::placesBefore(std::size_t i) const {
  assert(i <= triangles_.size());
  if (i == triangles_.size()) return static_cast<std::uint32_t>(vertices_.size());
  std::uint32_t count = places_before_[i / kPlacesBlock];
  for (std::size_t k = i / kPlacesBlock * kPlacesBlock; k < i; ++k)
    for (const std::uint32_t place : triangles_[k].place)
      count = std::max(count, place + 1);
  assert(count <= vertices_.size());
  return count;
}

/// Sets everything in the nodes except the boxes.
void MovingKdopTree::setNodes(const TreeStructure& structure, int num_threads) {
  constexpr std::size_t kBlock = 1024;
  const std::size_t count = structure.nodes.size();
  // Restructured trees have a few more nodes.
  UninitializedVector<MovingKdopNode> nodes;
  nodes.reserve(count + count / 16);
  nodes.resize(count);
  nodes_.swap(nodes);
  parallelForBlocks(nodes_.size(), kBlock, num_threads,
                    [&](std::size_t i, std::size_t last) {
                      for (; i < last; ++i) setNode(structure.nodes[i], nodes_[i]);
                    });
  region_borders_ = std::make_shared<RegionBorders>(count);
  sizes_.assign(nodes_.size(), {});
  first_sizes_.assign(nodes_.size(), {});
}

/// Sets everything in a node except the boxes.
void MovingKdopTree::setNode(const TreeChildren& from, MovingKdopNode& node) const {
  node.count = from.count;
  std::copy(from.child, from.child + kWidth, node.child);
  node.markTriangles();
  for (int lane = 0; lane < kWidth; ++lane) {
    const bool is_triangle = (node.triangles >> lane & 1U) != 0;
    assert(!is_triangle ||
           static_cast<std::size_t>(node.triangle(lane)) < triangles_.size());
    for (int k = 0; k < 3; ++k)
      node.places[k][lane] =
          is_triangle ? triangles_[static_cast<std::size_t>(node.triangle(lane))].place[k]
                      : MovingKdopNode::kNoPlace;
  }
}

/// Bounds for each frame and axis.
struct MovingKdopTree::CoordinateBounds {
  double lo[2][3]{{kInf, kInf, kInf}, {kInf, kInf, kInf}};
  double hi[2][3]{{-kInf, -kInf, -kInf}, {-kInf, -kInf, -kInf}};

  void add(int frame, const double* p) {
    for (int k = 0; k < 3; ++k) {
      lo[frame][k] = std::min(lo[frame][k], p[k]);
      hi[frame][k] = std::max(hi[frame][k], p[k]);
    }
  }
};

MovingKdopTree::CoordinateBounds MovingKdopTree::boundsOf(const VertexFrames& frames,
                                                          int num_threads) const {
  std::vector<CoordinateBounds> bounds_of_blocks(vertex_ids_.size() / kVertexBlock + 1);
  parallelForBlocks(vertex_ids_.size(), kVertexBlock, num_threads,
                    [&](std::size_t first, std::size_t last) {
                      CoordinateBounds bounds;
                      for (std::size_t i = first; i < last; ++i) {
                        if (i + kAhead < last) frames.prefetch(vertex_ids_[i + kAhead]);
                        const VertexPath path = frames[vertex_ids_[i]];
                        bounds.add(0, path.t0);
                        bounds.add(1, path.t1);
                      }
                      bounds_of_blocks[first / kVertexBlock] = bounds;
                    });
  CoordinateBounds all;
  for (const CoordinateBounds& bounds : bounds_of_blocks)
    for (int frame = 0; frame < 2; ++frame) {
      all.add(frame, bounds.lo[frame]);
      all.add(frame, bounds.hi[frame]);
    }
  return all;
}

/// The median of the vertices' coordinates in a frame. It does not depend on the order of
/// the vertices.
double MovingKdopTree::medianOf(const VertexFrames& frames, int frame, int axis) const {
  std::vector<double> x;
  x.reserve(vertex_ids_.size());
  for (const std::uint32_t id : vertex_ids_) {
    double p[3];
    frames.at(frame, id, p);
    if (std::isfinite(p[axis])) x.push_back(p[axis]);
  }
  if (x.empty()) return 0;
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

void MovingKdopTree::setLargestCoordinate(const CoordinateBounds& bounds) {
  largest_coordinate_ = 0;
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k)
      largest_coordinate_ = std::max(largest_coordinate_,
                                     std::max(bounds.hi[frame][k] - origin_[frame][k],
                                              origin_[frame][k] - bounds.lo[frame][k]));
}

#ifndef NDEBUG

namespace {

/// Whether the boxes of vertices contain both ends of their ways, and are ordered.
bool containBothEnds(const TreeVertex* vertices, std::size_t count,
                     const double (&offsets)[2][3][8]) {
  for (std::size_t i = 0; i < count; ++i)
    for (int frame = 0; frame < 2; ++frame) {
      const double(&x)[3][8] = offsets[frame];
      const Kdop16& box = frame == 0 ? vertices[i].box.t0 : vertices[i].box.t1;
      if (!isOrdered(box) || !containsPoint(box, {x[0][i], x[1][i], x[2][i]}))
        return false;
    }
  return true;
}

/// Whether a child of a node contains what is below it: three vertices, or boxes.
bool containsBelow(const MovingKdopNode& node, int lane,
                   const UninitializedVector<MovingKdopNode>& nodes,
                   const UninitializedVector<TreeVertex>& vertices) {
  if (node.isTriangle(lane))
    return std::all_of(node.places, node.places + 3, [&](const auto& places) {
      const TreeVertex& vertex = vertices[places[lane]];
      return node.contains(lane, vertex.box, vertex.displacement());
    });
  const MovingKdopNode& child = nodes[static_cast<std::size_t>(node.child[lane])];
  for (int k = 0; k < child.count; ++k)
    if (!node.contains(lane, child.box(k), double{child.displacement[k]})) return false;
  return true;
}

}  // namespace

#endif

/// Sets the boxes of a node. Those of its children are set.
void MovingKdopTree::refit(MovingKdopNode& node, bool is_still) {
  float extents[kWidth];
  kernels().fitNode(vertices_.data(), nodes_.data(), is_still, node, extents);
  assert(node.isComparable());
  NodeSize& size = sizes_[static_cast<std::size_t>(&node - nodes_.data())];
  size.triangles = 0;
  size.blurred = 0;
  for (int lane = 0; lane < node.count; ++lane) {
    assert(containsBelow(node, lane, nodes_, vertices_));
    if (node.isTriangle(lane)) {
      size.triangles += extents[lane];
      size.blurred += !(extents[lane] >= blur_ && extents[lane] <= FLT_MAX);
      continue;
    }
    NodeSize& child = sizes_[static_cast<std::size_t>(node.child[lane])];
    child.box = extents[lane];
    size.triangles += child.triangles;
    size.blurred += child.blurred;
  }
}

/// Sets paths and boxes of the vertices of a subtree, eight at a time.
void MovingKdopTree::fitVertices(const Subtree& subtree, const VertexFrames& frames) {
  constexpr std::size_t kEight = 8;
  const Kernels& kernel = kernels();
  for (std::size_t first = subtree.first_vertex; first < subtree.last_vertex;
       first += kEight) {
    const std::size_t count = std::min(kEight, subtree.last_vertex - first);
    TreeVertex* const vertices = &vertices_[first];
    double offsets[2][3][kEight] = {};
    for (std::size_t i = 0; i < count; ++i) {
      if (first + i + kAhead < subtree.last_vertex)
        frames.prefetch(vertex_ids_[first + i + kAhead]);
      double path[2][3];
      for (int frame = 0; frame < 2; ++frame) {
        frames.at(frame, vertex_ids_[first + i], path[frame]);
        for (int k = 0; k < 3; ++k)
          offsets[frame][k][i] = path[frame][k] - origin_[frame][k];
      }
      vertices[i].setPath(path[0], path[1]);
    }
    kernel.fitPoints(offsets[0], 0, count, vertices);
    if (!frames.isStill())
      kernel.fitPoints(offsets[1], 1, count, vertices);
    else
      for (std::size_t i = 0; i < count; ++i) vertices[i].box.t1 = vertices[i].box.t0;
    assert(containBothEnds(vertices, count, offsets));
  }
}

/// Sets the boxes of a subtree. Those of its vertices are set.
void MovingKdopTree::refit(const Subtree& subtree, bool is_still) {
  for (std::size_t i = subtree.last_node; i-- > subtree.first_node;) {
    if (i > subtree.first_node + 1) prefetchRows(nodes_[i - 2]);
    refit(nodes_[i], is_still);
  }
  refit(nodes_[subtree.root], is_still);
}

/// The boxes are floats relative to an origin. If the origin is far from most of a mesh,
/// because a vertex flies off or the whole mesh jumps, these floats are mostly rounding.
/// Then the origin moves to the median of the vertices.
void MovingKdopTree::refit(const VertexFrames& frames, int num_threads) {
  assert(isConsistent());
  assert(*std::max_element(vertex_ids_.begin(), vertex_ids_.end()) < frames.size());
  const CoordinateBounds bounds = boundsOf(frames, num_threads);
  for (int k = 0; k < 3; ++k)
    origin_[0][k] = origin_[1][k] = 0.5 * std::min(bounds.lo[0][k], bounds.lo[1][k]) +
                                    0.5 * std::max(bounds.hi[0][k], bounds.hi[1][k]);
  setLargestCoordinate(bounds);
  // Rounding can make extents along eight directions in two frames larger by up to 2^-17
  // of the largest coordinate C: 32 half-axes of at most 2 C each, rounded outward by
  // 2^-22 of themselves.
  blur_ = roundUp(largest_coordinate_ * 0x1p-13, 0.f);
  fit(frames, num_threads);
  // A free point has no extent: it tells nothing about the rounding.
  assert(sizes_[0].blurred <= triangles_.size());
  const std::size_t num_points = free_.points;
  if (sizes_[0].blurred - num_points <= (triangles_.size() - num_points) / 2) return;
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k) origin_[frame][k] = medianOf(frames, frame, k);
  setLargestCoordinate(bounds);
  fit(frames, num_threads);
}

/// Sets all paths and boxes.
void MovingKdopTree::fit(const VertexFrames& frames, int num_threads) {
  if (numThreads(num_threads) > 1) {
    refitGroups(frames, num_threads);
  } else {
    for (const Subtree& subtree : subtrees_) {
      fitVertices(subtree, frames);
      refit(subtree, frames.isStill());
    }
  }
  for (std::size_t i = top_.size(); i-- > 0;) refit(nodes_[top_[i]], frames.isStill());
}

/// Refits the subtrees. A subtree may need vertices of the subtrees before it. So the
/// vertices of a group are fitted first, and are still in the cache for its nodes.
void MovingKdopTree::refitGroups(const VertexFrames& frames, int num_threads) {
  for (std::size_t first = 0; first < subtrees_.size(); first += kSubtreeGroup) {
    const Subtree* subtrees = &subtrees_[first];
    const std::size_t count = std::min(kSubtreeGroup, subtrees_.size() - first);
    parallelForBlocks(count, kSubtreeBlock, num_threads,
                      [&](std::size_t i, std::size_t last) {
                        for (; i < last; ++i) fitVertices(subtrees[i], frames);
                      });
    parallelForBlocks(count, kSubtreeBlock, num_threads,
                      [&](std::size_t i, std::size_t last) {
                        for (; i < last; ++i) refit(subtrees[i], frames.isStill());
                      });
  }
}

std::size_t MovingKdopTree::memUsage() const {
  return nodes_.capacity() * sizeof(nodes_[0]) +
         (first_triangles_.capacity() + places_before_.capacity()) *
             sizeof(std::uint32_t) +
         triangles_.capacity() * sizeof(triangles_[0]) +
         vertices_.capacity() * sizeof(vertices_[0]) +
         vertex_ids_.capacity() * sizeof(vertex_ids_[0]) +
         (sizes_.capacity() + first_sizes_.capacity()) * sizeof(NodeSize) +
         fans_.memUsage() + (region_borders_ ? region_borders_->memUsage() : 0);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

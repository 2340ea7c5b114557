// SPDX-License-Identifier: BSD-3-Clause
//
// The hierarchy that all the methods to compare with have: a binary tree of 16-DOPs, one
// triangle a leaf, and a box for each feature (Hutter, Fuhrmann 2007). Tuned where it
// costs nothing of the methods: triangles, edges and vertices lie in memory in the order
// of the leaves, and boxes are compared four floats at a time.
//
// Box is SweptBox, the paper's, or MovingKdop.
#ifndef FCL_BENCHMARK_BASELINES_FEATURE_TREE_H
#define FCL_BENCHMARK_BASELINES_FEATURE_TREE_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "baselines/binary_structure.h"
#include "baselines/candidates.h"
#include "baselines/connectivity.h"
#include "mesh/moving_kdop.h"
#include "mesh/vertex_frames.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief Four half-axes of a box.
inline detail::deformable::Float4 quad(const detail::deformable::Kdop16& box, int q) {
  detail::deformable::Float4 v;
  __builtin_memcpy(&v, box.half + 4 * q, sizeof(v));
  return v;
}

/// @brief One box around both frames.
struct SweptBox {
  detail::deformable::Kdop16 box;
};

inline void merge(const detail::deformable::Kdop16& a,
                  const detail::deformable::Kdop16& b, detail::deformable::Kdop16& out) {
  for (int q = 0; q < 4; ++q) {
    const auto x = quad(a, q), y = quad(b, q);
    const auto most = x > y ? x : y;
    __builtin_memcpy(out.half + 4 * q, &most, sizeof(most));
  }
}
inline void merge(const SweptBox& a, const SweptBox& b, SweptBox& out) {
  merge(a.box, b.box, out.box);
}
inline void merge(const detail::deformable::MovingKdop& a,
                  const detail::deformable::MovingKdop& b,
                  detail::deformable::MovingKdop& out) {
  merge(a.t0, b.t0, out.t0);
  merge(a.t1, b.t1, out.t1);
}

/// @brief Sets the box of a point, rounded outward and widened by `pad`.
inline void fit(const double (&point)[3], float pad, detail::deformable::Kdop16& out) {
  double d[8];
  detail::deformable::kdopCoordinates(point, d);
  for (int j = 0; j < 8; ++j) {
    out.half[j] = detail::deformable::roundUp(-d[j], pad);
    out.half[j + 8] = detail::deformable::roundUp(d[j], pad);
  }
}
inline void fit(const double (&t0)[3], const double (&t1)[3], float pad,
                detail::deformable::MovingKdop& out) {
  fit(t0, pad, out.t0);
  fit(t1, pad, out.t1);
}
inline void fit(const double (&t0)[3], const double (&t1)[3], float pad, SweptBox& out) {
  detail::deformable::MovingKdop both;
  fit(t0, t1, pad, both);
  merge(both.t0, both.t1, out.box);
}

/// @brief When boxes overlap; for swept boxes, all the time or never.
inline detail::deformable::TimeWindow overlap(const SweptBox& a, const SweptBox& b) {
  using detail::deformable::Float4;
  const Float4 zero = {0.f, 0.f, 0.f, 0.f};
  const Float4 s0 = quad(a.box, 0) + quad(b.box, 2), s1 = quad(a.box, 1) + quad(b.box, 3);
  const Float4 s2 = quad(a.box, 2) + quad(b.box, 0), s3 = quad(a.box, 3) + quad(b.box, 1);
  const Float4 m0 = s0 < s1 ? s0 : s1, m1 = s2 < s3 ? s2 : s3;
  const Float4 m = m0 < m1 ? m0 : m1;
  if (detail::deformable::isAny(m < zero)) return {1.f, 0.f};
  return {0.f, 1.f};
}
inline detail::deformable::TimeWindow overlap(const detail::deformable::MovingKdop& a,
                                              const detail::deformable::MovingKdop& b) {
  return detail::deformable::overlapWindow<false>(a, b, nullptr);
}

/// @brief A point in the middle, relative to which floats hold the boxes.
/// @return the largest distance of a vertex from it along an axis
inline double findOrigin(const FramePairMesh& mesh, double (&origin)[3]) {
  Vector3<double> lo = mesh.previous[0], hi = lo;
  for (const auto* points : {&mesh.previous, &mesh.current})
    for (const auto& p : *points) {
      lo = lo.cwiseMin(p);
      hi = hi.cwiseMax(p);
    }
  double reach = 0;
  for (int k = 0; k < 3; ++k) {
    origin[k] = 0.5 * (lo[k] + hi[k]);
    reach = std::max(reach, std::max(hi[k] - origin[k], origin[k] - lo[k]));
  }
  return reach;
}

/// @brief The triangles of a binary tree in terms of vertices that are numbered in the
/// order in which the leaves meet them.
struct OrderedTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// The mesh's id of each vertex.
  std::vector<std::size_t> original;

  OrderedTriangles(const FramePairMesh& mesh, const BinaryStructure& structure) {
    constexpr std::uint32_t kNone = ~0U;
    std::vector<std::uint32_t> new_id(mesh.previous.size(), kNone);
    triangles.reserve(structure.triangles.size());
    for (const std::size_t i : structure.triangles) {
      std::array<std::uint32_t, 3> v{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t vertex = mesh.triangles[i][static_cast<int>(k)];
        if (new_id[vertex] == kNone) {
          new_id[vertex] = static_cast<std::uint32_t>(original.size());
          original.push_back(vertex);
        }
        v[k] = new_id[vertex];
      }
      triangles.push_back(v);
    }
  }
};

template <typename Box>
class FeatureTree {
 public:
  using VertexPath = detail::deformable::VertexPath;

  /// @brief Structure, order and features, by the first frame.
  explicit FeatureTree(const FramePairMesh& mesh)
      : FeatureTree(mesh, makeBinaryStructure(mesh)) {}

  const MeshConnectivity& connectivity() const { return connectivity_; }
  const std::vector<VertexPath>& paths() const { return paths_; }
  int originalVertex(std::uint32_t v) const { return static_cast<int>(original_[v]); }

  /// @brief Every inner node is a region.
  Regions regions() const {
    Regions regions;
    for (const std::int32_t link : links_) {
      if (link >= 0)
        for (const std::int32_t child : {link, link + 1})
          regions.children.push_back(this->link(child) < 0 ? this->link(child) : child);
      regions.close();
    }
    return regions;
  }

  /// @brief Boxes of all nodes and features for a pair of frames.
  void refit(const FramePairMesh& mesh) {
    double origin[3];
    // Differences and sums along diagonals are rounded by less than 2^-50 of the reach.
    const float pad =
        detail::deformable::roundUp(findOrigin(mesh, origin) * 0x1p-50, 0.f);
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const double* p = mesh.previous[original_[i]].data();
      const double* q = mesh.current[original_[i]].data();
      double t0[3], t1[3];
      for (int k = 0; k < 3; ++k) {
        paths_[i].t0[k] = p[k];
        paths_[i].t1[k] = q[k];
        t0[k] = p[k] - origin[k];
        t1[k] = q[k] - origin[k];
      }
      fit(t0, t1, pad, vertex_boxes_[i]);
    }
    const auto& edges = connectivity_.edges();
    for (std::size_t i = 0; i < edges.size(); ++i)
      merge(vertex_boxes_[edges[i][0]], vertex_boxes_[edges[i][1]], edge_boxes_[i]);
    for (std::size_t i = links_.size(); i-- > 0;) {
      if (links_[i] < 0) {
        const auto& v = connectivity_.triangle(~links_[i]).v;
        merge(vertex_boxes_[v[0]], vertex_boxes_[v[1]], boxes_[i]);
        merge(boxes_[i], vertex_boxes_[v[2]], boxes_[i]);
      } else {
        const auto left = static_cast<std::size_t>(links_[i]);
        merge(boxes_[left], boxes_[left + 1], boxes_[i]);
      }
    }
  }

  /// @brief visit(i, j) for each two triangles whose boxes overlap.
  /// @param isLeftOut  isLeftOut(region): without those within the region
  template <typename IsLeftOut, typename Visit>
  void traverse(IsLeftOut&& isLeftOut, Visit&& visit) const {
    struct NodePair {
      std::int32_t a, b;
    };
    std::vector<NodePair> open{{0, 0}};
    const auto pushIfOverlapping = [&](int a, int b) {
      if (!overlap(box(a), box(b)).isEmpty()) open.push_back({a, b});
    };
    while (!open.empty()) {
      const NodePair pair = open.back();
      open.pop_back();
      const int link_a = link(pair.a), link_b = link(pair.b);
      if (pair.a == pair.b) {
        if (link_a < 0 || isLeftOut(pair.a)) continue;
        open.push_back({link_a + 1, link_a + 1});
        open.push_back({link_a, link_a});
        pushIfOverlapping(link_a, link_a + 1);
      } else if (link_a < 0 && link_b < 0) {
        visit(~link_a, ~link_b);
      } else if (link_a < 0) {
        pushIfOverlapping(pair.a, link_b);
        pushIfOverlapping(pair.a, link_b + 1);
      } else if (link_b < 0) {
        pushIfOverlapping(link_a, pair.b);
        pushIfOverlapping(link_a + 1, pair.b);
      } else {
        // Both: the four boxes are fetched once.
        for (const int a : {link_a, link_a + 1})
          for (const int b : {link_b, link_b + 1}) pushIfOverlapping(a, b);
      }
    }
  }

  /// @brief Of the pairs of features of triangle pairs those whose boxes overlap.
  void findOverlaps(const std::vector<TrianglePairMask>& pairs,
                    std::vector<Candidate>& found) const {
    for (std::size_t p = 0; p < pairs.size(); ++p)
      for (unsigned bits = pairs[p].pairs; bits != 0; bits &= bits - 1) {
        const int bit = __builtin_ctz(bits);
        const detail::deformable::TimeWindow window =
            overlapOf(pairs[p].a, pairs[p].b, bit);
        if (!window.isEmpty())
          found.push_back({static_cast<std::uint32_t>(p), bit, window});
      }
  }

 private:
  FeatureTree(const FramePairMesh& mesh, const BinaryStructure& structure)
      : FeatureTree(structure, OrderedTriangles(mesh, structure)) {}

  FeatureTree(const BinaryStructure& structure, OrderedTriangles ordered)
      : links_(structure.links),
        boxes_(links_.size()),
        node_of_(ordered.triangles.size()),
        original_(std::move(ordered.original)),
        connectivity_(std::move(ordered.triangles), original_.size()),
        paths_(original_.size()),
        vertex_boxes_(original_.size()),
        edge_boxes_(connectivity_.edges().size()) {
    for (std::size_t i = 0; i < links_.size(); ++i)
      if (links_[i] < 0)
        node_of_[static_cast<std::size_t>(~links_[i])] = static_cast<std::int32_t>(i);
  }

  int link(int node) const { return links_[static_cast<std::size_t>(node)]; }
  const Box& box(int node) const { return boxes_[static_cast<std::size_t>(node)]; }

  detail::deformable::TimeWindow overlapOf(int i, int j, int bit) const {
    const detail::deformable::FeaturePair pair = detail::deformable::featurePair(bit);
    if (pair.kind == fcl::ContinuousContactKind::kEdgeEdge)
      return overlap(edge_boxes_[connectivity_.edgeOf(i, pair.first)],
                     edge_boxes_[connectivity_.edgeOf(j, pair.second)]);
    const int with_vertex = pair.first_on_a ? i : j, face = pair.first_on_a ? j : i;
    return overlap(vertex_boxes_[connectivity_.triangle(with_vertex).v[pair.first]],
                   box(node_of_[static_cast<std::size_t>(face)]));
  }

  std::vector<std::int32_t> links_;
  std::vector<Box> boxes_;
  /// The place of each triangle's box among the nodes.
  std::vector<std::int32_t> node_of_;
  /// The mesh's id of each vertex.
  std::vector<std::size_t> original_;
  MeshConnectivity connectivity_;
  std::vector<VertexPath> paths_;
  std::vector<Box> vertex_boxes_;
  std::vector<Box> edge_boxes_;
};

}  // namespace test
}  // namespace fcl

#endif

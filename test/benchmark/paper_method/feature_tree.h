// SPDX-License-Identifier: BSD-3-Clause
//
// The hierarchy of Tang, Manocha, Tong 2010, to compare with: a binary tree of 16-DOPs,
// one triangle a leaf, and a box for each feature. Tuned where it costs nothing of the
// method: triangles, their features and their vertices lie in memory in the order of the
// leaves, and each triangle holds only the vertices and edges that it owns
// (representative triangles, Curtis et al. 2008), so that each VF and EE pair is met
// once.
//
// Box is SweptBox, the paper's, or MovingKdop.
#ifndef FCL_BENCHMARK_FEATURE_TREE_H
#define FCL_BENCHMARK_FEATURE_TREE_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "fcl/math/bv/moving_kdop.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief One box around both frames.
struct SweptBox {
  Kdop16 box;
};

inline void merge(const Kdop16& a, const Kdop16& b, Kdop16& out) {
  for (int q = 0; q < 4; ++q) {
    const auto x = detail::deformable::quad(a, q), y = detail::deformable::quad(b, q);
    const auto most = x > y ? x : y;
    __builtin_memcpy(out.half + 4 * q, &most, sizeof(most));
  }
}
inline void merge(const SweptBox& a, const SweptBox& b, SweptBox& out) {
  merge(a.box, b.box, out.box);
}
inline void merge(const MovingKdop& a, const MovingKdop& b, MovingKdop& out) {
  merge(a.t0, b.t0, out.t0);
  merge(a.t1, b.t1, out.t1);
}

/// @brief Sets the box of a point, rounded outward and widened by `pad`.
inline void fit(const double (&point)[3], float pad, Kdop16& out) {
  double d[8];
  detail::deformable::kdopCoordinates(point, d);
  for (int j = 0; j < 8; ++j) {
    out.half[j] = detail::deformable::roundUp(-d[j], pad);
    out.half[j + 8] = detail::deformable::roundUp(d[j], pad);
  }
}
inline void fit(const double (&t0)[3], const double (&t1)[3], float pad,
                MovingKdop& out) {
  fit(t0, pad, out.t0);
  fit(t1, pad, out.t1);
}
inline void fit(const double (&t0)[3], const double (&t1)[3], float pad, SweptBox& out) {
  MovingKdop both;
  fit(t0, t1, pad, both);
  merge(both.t0, both.t1, out.box);
}

/// @brief When boxes overlap; for swept boxes, all the time or never.
inline TimeWindow overlap(const SweptBox& a, const SweptBox& b) {
  using detail::deformable::Float4;
  using detail::deformable::quad;
  const Float4 zero = {0.f, 0.f, 0.f, 0.f};
  const Float4 s0 = quad(a.box, 0) + quad(b.box, 2), s1 = quad(a.box, 1) + quad(b.box, 3);
  const Float4 s2 = quad(a.box, 2) + quad(b.box, 0), s3 = quad(a.box, 3) + quad(b.box, 1);
  const Float4 m0 = s0 < s1 ? s0 : s1, m1 = s2 < s3 ? s2 : s3;
  const Float4 m = m0 < m1 ? m0 : m1;
  if (detail::deformable::isAny(m < zero)) return {1.f, 0.f};
  return {0.f, 1.f};
}
inline TimeWindow overlap(const MovingKdop& a, const MovingKdop& b) {
  return detail::deformable::overlapWindow<false>(a, b, nullptr);
}

template <typename Box>
class FeatureTree {
 public:
  using VertexPath = detail::deformable::VertexPath;

  /// @brief A triangle: its vertices in the order of the tree, and where its own features
  /// begin; they end where those of the next triangle begin.
  struct Leaf {
    std::array<std::uint32_t, 3> v;
    std::uint32_t first_vertex;
    std::uint32_t first_edge;
    bool owns_face;
    /// The place of its box among the nodes.
    std::int32_t node;

    bool has(std::uint32_t vertex) const {
      return v[0] == vertex || v[1] == vertex || v[2] == vertex;
    }
  };
  using Edge = std::array<std::uint32_t, 2>;

  /// @brief Structure, order and owners, by the first frame.
  explicit FeatureTree(const FramePairMesh& mesh) {
    std::vector<Item> items(mesh.triangles.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Triangle& t = mesh.triangles[i];
      const Vector3<double> sum =
          mesh.previous[t[0]] + mesh.previous[t[1]] + mesh.previous[t[2]];
      items[i] = {{sum[0], sum[1], sum[2]}, i};
    }
    makeNodes(items);
    makeLeaves(items, mesh);
    boxes_.resize(links_.size());
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
    for (std::size_t i = 0; i < edges_.size(); ++i)
      merge(vertex_boxes_[edges_[i][0]], vertex_boxes_[edges_[i][1]], edge_boxes_[i]);
    for (std::size_t i = links_.size(); i-- > 0;) {
      if (links_[i] < 0) {
        const Leaf& leaf = leaves_[static_cast<std::size_t>(~links_[i])];
        merge(vertex_boxes_[leaf.v[0]], vertex_boxes_[leaf.v[1]], boxes_[i]);
        merge(boxes_[i], vertex_boxes_[leaf.v[2]], boxes_[i]);
      } else {
        const auto left = static_cast<std::size_t>(links_[i]);
        merge(boxes_[left], boxes_[left + 1], boxes_[i]);
      }
    }
  }

  /// @brief The children of a node follow each other, after it; a leaf has the complement
  /// of its place among the leaves.
  int link(int node) const { return links_[static_cast<std::size_t>(node)]; }
  const Box& box(int node) const { return boxes_[static_cast<std::size_t>(node)]; }

  /// @brief The leaf and, one place on, where its features end.
  const Leaf* leaf(int i) const { return &leaves_[static_cast<std::size_t>(i)]; }
  const Box& faceBox(const Leaf* leaf) const { return box(leaf->node); }
  /// @brief A leaf's own vertices are neighbours, since vertices are numbered by leaves.
  const Box& vertexBox(std::uint32_t v) const { return vertex_boxes_[v]; }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  const Box& edgeBox(std::uint32_t e) const { return edge_boxes_[e]; }
  const VertexPath& path(std::uint32_t v) const { return paths_[v]; }
  int originalVertex(std::uint32_t v) const { return static_cast<int>(original_[v]); }

 private:
  struct Item {
    std::array<double, 3> centroid;
    std::size_t triangle;
  };

  /// Splits at the mean along the longest axis of the centroids; in halves where that
  /// leaves one side with less than a sixteenth, which bounds the depth.
  static std::size_t split(Item* items, std::size_t count) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    double lo[3] = {kInf, kInf, kInf}, hi[3] = {-kInf, -kInf, -kInf}, sum[3] = {};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double c = items[i].centroid[k];
        lo[k] = std::min(lo[k], c);
        hi[k] = std::max(hi[k], c);
        sum[k] += c;
      }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
    const double mean = sum[axis] / static_cast<double>(count);
    const Item* middle = std::partition(items, items + count, [&](const Item& item) {
      return item.centroid[axis] < mean;
    });
    const auto left = static_cast<std::size_t>(middle - items);
    if (left > count / 16 && count - left > count / 16) return left;
    std::nth_element(items, items + count / 2, items + count,
                     [&](const Item& a, const Item& b) {
                       return a.centroid[axis] < b.centroid[axis];
                     });
    return count / 2;
  }

  void makeNodes(std::vector<Item>& items) {
    struct Range {
      std::size_t first, count;
      std::int32_t node;
    };
    links_.assign(1, 0);
    links_.reserve(2 * items.size());
    std::vector<Range> open{{0, items.size(), 0}};
    while (!open.empty()) {
      const Range r = open.back();
      open.pop_back();
      auto& link = links_[static_cast<std::size_t>(r.node)];
      if (r.count == 1) {
        link = ~static_cast<std::int32_t>(r.first);
        continue;
      }
      const std::size_t n = split(&items[r.first], r.count);
      const auto left = static_cast<std::int32_t>(links_.size());
      link = left;
      links_.resize(links_.size() + 2);
      open.push_back({r.first + n, r.count - n, left + 1});
      open.push_back({r.first, n, left});
    }
  }

  /// The places at which a feature is met first, of all (feature, place).
  template <typename Feature>
  static std::vector<bool> firstOnes(std::vector<std::pair<Feature, std::size_t>> met) {
    std::vector<bool> is_first(met.size(), false);
    std::sort(met.begin(), met.end());
    for (std::size_t i = 0; i < met.size(); ++i)
      is_first[met[i].second] = i == 0 || met[i].first != met[i - 1].first;
    return is_first;
  }

  /// Renumbers the vertices; a feature belongs to the first leaf that has it.
  void makeLeaves(const std::vector<Item>& items, const FramePairMesh& mesh) {
    using Face = std::array<std::uint32_t, 3>;
    constexpr std::uint32_t kNone = ~0U;
    std::vector<std::uint32_t> new_id(mesh.previous.size(), kNone);
    std::vector<std::pair<Edge, std::size_t>> edges;
    std::vector<std::pair<Face, std::size_t>> faces;
    edges.reserve(3 * items.size());
    faces.reserve(items.size());
    leaves_.reserve(items.size() + 1);
    for (const Item& item : items) {
      const Triangle& t = mesh.triangles[item.triangle];
      Leaf leaf{};
      leaf.first_vertex = static_cast<std::uint32_t>(original_.size());
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& id = new_id[t[static_cast<int>(k)]];
        if (id == kNone) {
          id = static_cast<std::uint32_t>(original_.size());
          original_.push_back(t[static_cast<int>(k)]);
        }
        leaf.v[k] = id;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const auto e = std::minmax(leaf.v[k], leaf.v[(k + 1) % 3]);
        edges.push_back({{e.first, e.second}, edges.size()});
      }
      Face face = leaf.v;
      std::sort(face.begin(), face.end());
      faces.push_back({face, faces.size()});
      leaves_.push_back(leaf);
    }
    const std::vector<bool> owns_edge = firstOnes(edges), owns_face = firstOnes(faces);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      leaves_[i].owns_face = owns_face[i];
      leaves_[i].first_edge = static_cast<std::uint32_t>(edges_.size());
      for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
        if (owns_edge[k] && edges[k].first[0] != edges[k].first[1])
          edges_.push_back(edges[k].first);
    }
    leaves_.push_back({{},
                       static_cast<std::uint32_t>(original_.size()),
                       static_cast<std::uint32_t>(edges_.size()),
                       false,
                       -1});
    for (std::size_t i = 0; i < links_.size(); ++i)
      if (links_[i] < 0)
        leaves_[static_cast<std::size_t>(~links_[i])].node = static_cast<std::int32_t>(i);
    paths_.resize(original_.size());
    vertex_boxes_.resize(original_.size());
    edge_boxes_.resize(edges_.size());
  }

  /// A point in the middle, relative to which floats hold the boxes.
  /// @return the largest distance of a vertex from it along an axis
  static double findOrigin(const FramePairMesh& mesh, double (&origin)[3]) {
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

  std::vector<std::int32_t> links_;
  std::vector<Box> boxes_;
  std::vector<Leaf> leaves_;
  std::vector<Edge> edges_;
  std::vector<Box> edge_boxes_;
  std::vector<VertexPath> paths_;
  std::vector<Box> vertex_boxes_;
  /// The mesh's id of each vertex.
  std::vector<std::size_t> original_;
};

}  // namespace test
}  // namespace fcl

#endif

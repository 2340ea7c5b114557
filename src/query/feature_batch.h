// SPDX-License-Identifier: BSD-3-Clause
//
// From triangle pairs to pairs of features: the pairs that two triangles own and whose
// moving boxes meet.
#ifndef FCL_CCD_QUERY_FEATURE_BATCH_H
#define FCL_CCD_QUERY_FEATURE_BATCH_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "mesh/moving_kdop.h"
#include "query/pair_filter.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Names a vertex whose coordinates are not finite.
class NonFiniteVertex : public std::domain_error {
 public:
  explicit NonFiniteVertex(std::size_t vertex);

  std::size_t vertex() const { return vertex_; }

 private:
  std::size_t vertex_;
};

/// @brief Two triangles, as their trees count them, whose boxes do not overlap before
/// `earliest`.
struct LeafPair {
  std::int32_t a, b;
  float earliest;
};

/// @brief For comparisons with the beginnings of windows, floats that are rounded to
/// either side below FLT_MIN: what is above this begins after `latest`.
inline float lastBeginning(double latest) { return roundUp(latest, 0.f); }

/// @brief The triangles of a tree that are read where they lie.
struct TrianglesInPlace {
  const TreeTriangle* triangles;
  const TreeVertex* vertices;

  /// @param[out] x  the vertices, which the cache is told of
  const TreeTriangle* read(int i, const TreeVertex** x) const {
    const TreeTriangle& triangle = triangles[i];
    for (int k = 0; k < 3; ++k) {
      x[k] = vertices + triangle.place[k];
      for (int line = 0; line < 3; ++line)
        __builtin_prefetch(reinterpret_cast<const char*>(x[k]) + 64 * line);
    }
    return &triangle;
  }
  void prefetch(int i) const { __builtin_prefetch(triangles + i); }
};

/// @brief Reads the triangles of one mesh: those of a tree as they lie there, others into
/// a store of its own.
class TriangleReader {
 public:
  /// @brief So many reads leave the results of earlier ones in place.
  static constexpr std::size_t kStored = 256;

  /// @param mesh  kept by reference
  explicit TriangleReader(const MeshInstance& mesh);

  /// @param i  a triangle as the mesh's tree counts them
  /// @param[out] x  its vertices
  /// @throws NonFiniteVertex
  const TreeTriangle* read(int i, const TreeVertex** x) {
    if (in_place_.triangles) return in_place_.read(i, x);
    if (i != index_) readIntoStore(i);
    for (std::size_t k = 0; k < 3; ++k) x[k] = &vertices_[3 * stored_ + k];
    return &triangles_[stored_];
  }

  void prefetch(int i) const {
    if (in_place_.triangles) in_place_.prefetch(i);
  }

  /// @brief What read() does for a tree in place; of no triangles for another mesh.
  const TrianglesInPlace& inPlace() const { return in_place_; }

 private:
  void readIntoStore(int i);
  void pose(std::uint32_t id, TreeVertex& out) const;

  const MeshInstance& mesh_;
  TrianglesInPlace in_place_{nullptr, nullptr};
  /// The triangle that was read last into the store, and where it is.
  int index_{-1};
  std::size_t stored_{0};
  std::unique_ptr<TreeTriangle[]> triangles_;
  std::unique_ptr<TreeVertex[]> vertices_;
};

/// @brief Two features that do not touch outside [window_lo, window_hi].
struct FeatureCandidate : FeatureIds {
  double window_lo;
  double window_hi;
  /// The vertices in the order of the ids; valid as long as the batch is.
  const TreeVertex* x[4];
};

/// @brief Some triangle pairs and the pairs of features that they own.
class FeatureBatch {
 public:
  static constexpr std::size_t kMaxPairs = TriangleReader::kStored;

  /// @param a, b  kept by reference; the same object twice for a self-collision
  /// @param shift  between their trees; null for a self-collision
  FeatureBatch(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
               const Kernels& kernels);

  bool isSelf() const { return self_; }

  /// @brief Adds pairs that overlap no later than `latest`; at most kMaxPairs until
  /// clear().
  /// @param next  the first of them; after an error the one that it is about, and in the
  /// end `last`
  /// @param with_crossings  whether edges may cross faces at t = 0
  /// @param counts  triangle_pairs and adjacent_pairs are counted
  /// @throws NonFiniteVertex
  void add(const LeafPair*& next, const LeafPair* last, double latest,
           bool with_crossings, StageCounts& counts);

  void clear();

  /// @brief Leaves no triangles that are apart until `latest`, and the edges and faces
  /// whose boxes overlap at t = 0.
  /// @param latest  pairs that overlap only later are of no interest
  /// @param counts  plane_culled is counted
  void cullTriangles(double latest, StageCounts& counts);

  /// @brief Leaves the pairs of features of one kind whose moving boxes overlap, with
  /// their windows; after cullTriangles().
  /// @param counts  feature_pairs and box_culled are counted
  void cull(ContinuousContactKind kind, double latest, StageCounts& counts);

  /// @brief Leaves the pairs of one kind that a filter accepts.
  /// @return how many it does not
  std::size_t keep(ContinuousContactKind kind, const PairFilter& filter);

  /// @brief How many pairs of one kind are left.
  std::size_t size(ContinuousContactKind kind) const { return list(kind).size; }
  /// @brief Those pairs, features of pairs(), and their windows.
  const std::uint32_t* codes(ContinuousContactKind kind) const {
    return list(kind).codes.get();
  }
  const TimeWindow* windows(ContinuousContactKind kind) const {
    return list(kind).windows.get();
  }
  const TrianglePair* pairs() const { return pairs_.get(); }

  /// @brief The pair's one name, whatever triangles it is met in.
  void setCandidate(std::uint32_t code, const TimeWindow& window,
                    FeatureCandidate& out) const;

  /// @brief An edge of one triangle and the face of the other.
  struct EdgeAndFace {
    const TrianglePair* pair;
    /// The edge joins vertices edge and (edge + 1) % 3 of a (or b).
    unsigned edge;
    bool edge_on_a;
  };
  std::size_t numCrossings() const { return num_crossings_; }
  /// @brief The same as Kernels::mayCross() takes them.
  const std::uint32_t* crossings() const { return crossings_.get(); }
  EdgeAndFace crossing(std::size_t i) const;

 private:
  /// Has room for all pairs that kMaxPairs triangle pairs can own; not initialized.
  struct List {
    std::unique_ptr<std::uint32_t[]> codes;
    std::unique_ptr<TimeWindow[]> windows;
    std::size_t size{0};

    explicit List(std::size_t pairs_each);
  };

  const List& list(ContinuousContactKind kind) const {
    return lists_[kind == ContinuousContactKind::kEdgeEdge];
  }
  template <typename ReaderA, typename ReaderB>
  void addFrom(ReaderA& reader_a, ReaderB& reader_b, const LeafPair*& next,
               const LeafPair* last, double latest, bool with_crossings,
               StageCounts& counts);
  void leaveOutApart(double latest, StageCounts& counts);

  TriangleReader reader_a_, reader_b_;
  bool self_;
  const KdopShift* shift_;
  KdopShift turned_shift_;
  const Kernels& kernels_;
  std::unique_ptr<TrianglePair[]> pairs_;
  /// The pairs of features of each triangle pair that are to be looked at.
  std::unique_ptr<std::uint16_t[]> owned_;
  /// The edges of each triangle pair that may pass through the other triangle at t = 0:
  /// bits 0-2 for a's, 3-5 for b's.
  std::unique_ptr<std::uint16_t[]> edges_;
  bool has_edges_{false};
  /// Features of each triangle pair that are further apart at t = 0 do not meet until the
  /// time after which nothing matters.
  std::unique_ptr<float[]> gaps_;
  std::size_t num_pairs_{0};
  List lists_[2];
  std::unique_ptr<std::uint32_t[]> crossings_;
  std::size_t num_crossings_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

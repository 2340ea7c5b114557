// SPDX-License-Identifier: BSD-3-Clause
//
// From triangle pairs to pairs of features: the pairs that two triangles own and whose
// moving boxes meet.
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_FEATURE_BATCH_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_FEATURE_BATCH_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "fcl/math/bv/moving_kdop.h"
#include "fcl/narrowphase/detail/deformable/feature_pairs.h"
#include "fcl/narrowphase/detail/deformable/kernels.h"
#include "fcl/narrowphase/detail/deformable/mesh_instance.h"
#include "fcl/narrowphase/detail/deformable/stage_counts.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Names a vertex whose coordinates are not finite.
class NonFiniteVertex : public std::domain_error {
 public:
  explicit NonFiniteVertex(std::size_t vertex);
};

/// @brief A triangle as the tests read it.
struct TriangleSide {
  const TreeTriangle* triangle;
  const TreeVertex* x[3];
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
  /// @throws NonFiniteVertex
  const TriangleSide& read(int i) {
    if (i == index_) return side_;
    if (direct_) {
      side_.triangle = &mesh_.tree->triangles()[static_cast<std::size_t>(i)];
      for (int k = 0; k < 3; ++k)
        side_.x[k] = &mesh_.tree->vertices()[side_.triangle->place[k]];
    } else {
      readIntoStore(i);
    }
    index_ = i;
    return side_;
  }

 private:
  void readIntoStore(int i);
  void pose(std::uint32_t id, TreeVertex& out) const;

  const MeshInstance& mesh_;
  bool direct_;
  int index_{-1};
  TriangleSide side_;
  std::unique_ptr<TreeTriangle[]> triangles_;
  std::unique_ptr<TreeVertex[]> vertices_;
  std::size_t next_{0};
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

  /// @brief Adds triangle i of a and triangle j of b, as their trees count them; at most
  /// kMaxPairs until clear().
  /// @param with_crossing  whether they may cross at t = 0
  /// @param counts  triangle_pairs, adjacent_pairs and feature_pairs are counted
  /// @throws NonFiniteVertex
  void add(int i, int j, bool with_crossing, StageCounts& counts);

  void clear();

  /// @brief Leaves the pairs of features whose moving boxes overlap, with their windows,
  /// and the edges and faces whose boxes overlap at t = 0.
  /// @param counts  box_culled is counted
  void cull(StageCounts& counts);

  /// @brief What is left, pairs of one kind: codes for points() and candidate().
  const std::vector<std::uint32_t>& codes(FeatureKind kind) const {
    return lists_[kind == FeatureKind::kEdgeEdge].codes;
  }
  const std::vector<TimeWindow>& windows(FeatureKind kind) const {
    return lists_[kind == FeatureKind::kEdgeEdge].windows;
  }

  /// @brief The four vertices of a pair, features in the order of its triangle pair.
  void points(std::uint32_t code, const TreeVertex* (&x)[4]) const;

  /// @brief The pair's one name, whatever triangles it is met in.
  FeatureCandidate candidate(std::uint32_t code, const TimeWindow& window) const;

  /// @brief An edge of one triangle and the face of the other.
  struct EdgeAndFace {
    const TrianglePair* pair;
    /// The edge joins vertices edge and (edge + 1) % 3 of a (or b).
    unsigned edge;
    bool edge_on_a;
  };
  std::size_t numCrossings() const { return crossings_.size(); }
  EdgeAndFace crossing(std::size_t i) const;

 private:
  struct List {
    std::vector<std::uint32_t> codes;
    std::vector<TimeWindow> windows;
  };

  void addCrossings(std::uint32_t pair, unsigned shared);
  void cull(FeatureKind kind, List& list, StageCounts& counts);

  TriangleReader reader_a_, reader_b_;
  bool self_;
  const KdopShift* shift_;
  KdopShift turned_shift_;
  const Kernels& kernels_;
  std::vector<TrianglePair> pairs_;
  std::size_t num_pairs_{0};
  List lists_[2];
  std::vector<std::uint32_t> crossings_;
};

/// @brief Windows are widened by this much, far more than their rounding: a contact at
/// the very start of a window would leave the solver no room to see the sign before it.
constexpr double kFeatureMargin = 0x1p-18;

inline double windowLo(const TimeWindow& w) {
  return w.lo > kFeatureMargin ? w.lo - kFeatureMargin : 0;
}
inline double windowHi(const TimeWindow& w) {
  return w.hi < 1 - kFeatureMargin ? w.hi + kFeatureMargin : 1;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

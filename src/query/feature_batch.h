// SPDX-License-Identifier: BSD-3-Clause
//
// From triangle pairs to pairs of features: lists the pairs that two triangles own, and
// culls those whose moving boxes do not overlap.
#ifndef FCL_CCD_QUERY_FEATURE_BATCH_H
#define FCL_CCD_QUERY_FEATURE_BATCH_H

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "fcl/narrowphase/stage_counts.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "mesh/moving_kdop.h"
#include "query/feature_candidate.h"
#include "query/leading_contact.h"
#include "query/pair_filter.h"
#include "query/triangle_reader.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two triangles, by their numbers in the trees, whose boxes overlap from
/// `earliest` on.
struct LeafPair {
  std::int32_t a, b;
  float earliest;
};

/// @brief A window begins after `latest` if its beginning is above this float. It is
/// rounded up because beginnings are floats, which may be rounded to either side below
/// FLT_MIN.
inline float lastBeginning(double latest) { return roundUp(latest, 0.f); }

/// @brief A block of triangle pairs, and the pairs of features that they own.
class FeatureBatch {
 public:
  static constexpr std::size_t kMaxPairs = TriangleReader::kStored;

  /// @param a, b  kept by reference; the same object for a self-collision
  /// @param shift  added to boxes of a: between their trees, and the distance; null: none
  /// @param cull_distance  features that come within it are wanted; 0: those that touch
  FeatureBatch(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
               const Kernels& kernels, double cull_distance = 0);

  /// @brief From here on the shift and the distance are these.
  void setCullDistance(const KdopShift* shift, double cull_distance);
  double cullDistance() const { return cull_distance_; }

  bool isSelf() const { return self_; }

  /// @brief Begins a task: what is culled depends on nothing that came before.
  void beginTask();

  /// @brief What a query still looks for.
  struct Wanted {
    /// Later contacts do not matter.
    double latest;
    /// Whether it looks for edges that cross faces at t = 0.
    bool crossings;
    /// Features of triangles whose vertices all have larger numbers do not matter.
    std::uint32_t last_vertex{~std::uint32_t{0}};
  };

  /// @brief Adds those triangle pairs that matter and whose boxes begin to overlap in
  /// time. The limit until clear() is kMaxPairs.
  /// @param next  the first pair. Becomes `last`, or the pair with the vertex that is not
  /// finite
  /// @param counts  triangle_pairs and adjacent_pairs are counted
  /// @throws NonFiniteVertex
  void add(const LeafPair*& next, const LeafPair* last, const Wanted& wanted,
           StageCounts& counts);

  void clear();

  /// @brief Keeps the triangle pairs for which keeps(a, b) is true.
  template <typename Keeps>
  void keepTriangles(const Keeps& keeps) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < num_pairs_; ++i)
      if (keeps(*pairs_[i].a, *pairs_[i].b)) keepPair(i, kept);
    num_pairs_ = kept;
  }

  /// @brief Culls triangle pairs that are apart until `latest`; if the whole step
  /// matters, where this pays, those that stay apart, or further apart than the distance;
  /// and lists the edges and faces whose boxes overlap at t = 0.
  /// @param latest  later contacts do not matter to the query
  /// @param counts  plane_culled is counted
  void cullTriangles(double latest, StageCounts& counts);

  /// @brief Lists the pairs of features of one kind, and culls those whose moving boxes
  /// do not overlap. The others get their windows.
  /// @pre cullTriangles() has been called
  /// @param counts  feature_pairs, box_culled and mask_culled are counted
  /// @param filter  leaves out more pairs; null: none
  void cull(ContinuousContactKind kind, double latest, StageCounts& counts,
            const PairFilter* filter = nullptr);

  /// @brief The same without windows, if only t = 0 matters: lists the pairs whose boxes
  /// overlap then.
  /// @pre isAtStart(latest)
  void cullAtStart(ContinuousContactKind kind, StageCounts& counts);

  /// @brief Whether nothing but t = 0 matters to a query to which this time is the
  /// latest, as far as boxes know it.
  bool isAtStart(double latest) const {
    return latest <= latestLeading(0) && isBeginning(latest);
  }

  /// @brief The number of pairs of features of one kind that are left.
  std::size_t size(ContinuousContactKind kind) const { return list(kind).size; }
  /// @brief These pairs, as codes (featureCode()) that refer to pairs(), and their
  /// windows.
  const std::uint32_t* codes(ContinuousContactKind kind) const {
    return list(kind).codes.get();
  }
  const TimeWindow* windows(ContinuousContactKind kind) const {
    return list(kind).windows.get();
  }
  const TrianglePair* pairs() const { return pairs_.get(); }
  const PairBends& bends() const { return bends_; }

  /// @brief Sets the candidate of one of these pairs: deformable::setCandidate().
  void setCandidate(std::uint32_t code, const TimeWindow& window,
                    FeatureCandidate& out) const {
    assert(codePair(code) < num_pairs_);
    deformable::setCandidate(pairs_[codePair(code)], codeBit(code), window, self_, out);
  }

  /// @brief An edge of one triangle and the face of the other one.
  struct EdgeAndFace {
    const TrianglePair* pair;
    /// The edge joins vertices edge and (edge + 1) % 3 of a (or b).
    unsigned edge;
    bool edge_on_a;
  };
  std::size_t numCrossings() const { return num_crossings_; }
  /// @brief The edges and faces whose boxes overlap at t = 0, as codes for
  /// Kernels::mayCross().
  const std::uint32_t* crossings() const { return crossings_.get(); }
  EdgeAndFace crossing(std::size_t i) const;

 private:
  /// A list of pairs of features, with room for all that kMaxPairs triangle pairs can
  /// own. Its memory is not initialized.
  struct List {
    std::unique_ptr<std::uint32_t[]> codes;
    std::unique_ptr<TimeWindow[]> windows;
    std::size_t size{0};

    explicit List(std::size_t pairs_each);
  };

  const List& list(ContinuousContactKind kind) const {
    return lists_[kind == ContinuousContactKind::kEdgeEdge];
  }
  List& list(ContinuousContactKind kind) {
    return lists_[kind == ContinuousContactKind::kEdgeEdge];
  }
  template <typename ReaderA, typename ReaderB>
  void addFrom(ReaderA& reader_a, ReaderB& reader_b, const LeafPair*& next,
               const LeafPair* last, const Wanted& wanted, StageCounts& counts);
  /// Whether only the beginning of the step matters. Paths that are bent are compared
  /// during the whole step.
  bool isBeginning(double latest) const { return isEarly(latest) && !bends_.isAny(); }
  void keepPair(std::size_t i, std::size_t& kept);
  void leaveOutApart(double latest, StageCounts& counts);
  void leaveOutFar(StageCounts& counts);
  void leaveOutEdges();
  std::size_t listPairs(ContinuousContactKind kind, StageCounts& counts);
  unsigned edgePairsToTest();
  std::size_t keep(List& list, const PairFilter& filter);

  TriangleReader reader_a_, reader_b_;
  bool self_;
  double cull_distance_;
  PairBends bends_;
  /// Whether free points come near free edges or each other.
  bool tests_points_;
  const KdopShift* shift_;
  KdopShift exchanged_shift_;
  const Kernels& kernels_;
  std::unique_ptr<TrianglePair[]> pairs_;
  /// For each triangle pair, the pairs of features to test, one bit each.
  std::unique_ptr<std::uint16_t[]> owned_;
  /// For each triangle pair, the edges that may pass through the other triangle at t = 0:
  /// bits 0-2 for those of a, 3-5 for those of b.
  std::unique_ptr<std::uint16_t[]> edges_;
  bool has_edges_{false};
  /// For each triangle pair, a distance. If its features are further apart than this at t
  /// = 0, they do not touch until `latest`.
  std::unique_ptr<float[]> gaps_;
  std::size_t num_pairs_{0};
  /// For how many more blocks leaveOutFar() does nothing, and for how many it did last.
  int wait_{0}, pause_{0};
  List lists_[2];
  std::unique_ptr<std::uint32_t[]> crossings_;
  std::size_t num_crossings_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

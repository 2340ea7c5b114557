// SPDX-License-Identifier: BSD-3-Clause
//
// From triangle pairs to pairs of features: lists the pairs that two triangles own, and
// culls those whose moving boxes do not overlap.
#ifndef FCL_CCD_QUERY_FEATURE_BATCH_H
#define FCL_CCD_QUERY_FEATURE_BATCH_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "mesh/moving_kdop.h"
#include "query/leading_contact.h"
#include "query/pair_filter.h"
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

/// @brief The triangles and vertices of a moving tree, read without a copy.
struct TrianglesInPlace {
  const TreeTriangle* triangles;
  const TreeVertex* vertices;

  /// @param[out] x  the vertices, which are prefetched
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

/// @brief Reads the triangles of a mesh. A moving tree in place is read without a copy.
/// For other meshes the reader computes vertices and their boxes into a store of its own,
/// where it finds most of them again: pairs of triangles that are near in a block have
/// triangles in common.
class TriangleReader {
 public:
  /// @brief A result is valid until this number of later reads.
  static constexpr std::size_t kStored = 256;

  /// @param mesh  kept by reference
  explicit TriangleReader(const MeshInstance& mesh);

  /// @param i  number of the triangle in the tree of the mesh
  /// @param[out] x  its vertices
  /// @throws NonFiniteVertex
  const TreeTriangle* read(int i, const TreeVertex** x) {
    if (in_place_.triangles) return in_place_.read(i, x);
    if (i != index_) find(i);
    for (std::size_t k = 0; k < 3; ++k) x[k] = &vertices_[3 * slot_ + k];
    return &triangles_[slot_];
  }

  void prefetch(int i) const {
    if (in_place_.triangles) in_place_.prefetch(i);
  }

  /// @brief The triangles that read() reads without a copy; null pointers if it has to
  /// copy.
  const TrianglesInPlace& inPlace() const { return in_place_; }

 private:
  /// Slots of the store, which are taken in a circle. A triangle is used again as long
  /// as its slot will not be taken by the next kStored reads.
  static constexpr std::size_t kSlots = 2 * kStored;

  void find(int i);
  void compute(int i, std::size_t slot);
  bool isStored(std::uint32_t id, std::size_t slot) const;
  void pose(std::uint32_t id, TreeVertex& out) const;

  const MeshInstance& mesh_;
  TrianglesInPlace in_place_{nullptr, nullptr};
  /// The triangle that was read last, and its slot.
  int index_{-1};
  std::size_t slot_{0};
  /// The slot that is taken next.
  std::size_t next_{0};
  /// The triangle in each slot; -1: none. And the slot of a triangle, and of a vertex,
  /// by the last bits of its number, if it is in the store.
  std::vector<int> stored_;
  std::vector<std::uint16_t> slot_of_, slot_of_vertex_;
  std::unique_ptr<TreeTriangle[]> triangles_;
  std::unique_ptr<TreeVertex[]> vertices_;
};

/// @brief Two features and their window: outside of [window_lo, window_hi] they do not
/// touch.
struct FeatureCandidate : FeatureIds {
  double window_lo;
  double window_hi;
  /// The vertices, in the order of the ids; the last one repeated where there are fewer.
  /// Valid until FeatureBatch::clear().
  const TreeVertex* x[4];
};

/// @brief A block of triangle pairs, and the pairs of features that they own.
class FeatureBatch {
 public:
  static constexpr std::size_t kMaxPairs = TriangleReader::kStored;

  /// @param a, b  kept by reference; the same object for a self-collision
  /// @param shift  added to boxes of a: between their trees, and the distance; null: none
  /// @param reach  features that come within it are wanted; 0: those that touch
  FeatureBatch(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
               const Kernels& kernels, double reach = 0);

  /// @brief From here on the shift and the reach are these.
  void setReach(const KdopShift* shift, double reach);

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
  /// @param counts  feature_pairs and box_culled are counted
  void cull(ContinuousContactKind kind, double latest, StageCounts& counts);

  /// @brief The same without windows, if only t = 0 matters: lists the pairs whose boxes
  /// overlap then.
  /// @pre isAtStart(latest)
  void cullAtStart(ContinuousContactKind kind, StageCounts& counts);

  /// @brief Whether nothing but t = 0 matters to a query to which this time is the
  /// latest, as far as boxes know it.
  bool isAtStart(double latest) const {
    return latest <= latestLeading(0) && isBeginning(latest);
  }

  /// @brief Keeps the pairs of features of one kind that the filter accepts.
  /// @return the number of the others
  std::size_t keep(ContinuousContactKind kind, const PairFilter& filter);

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

  /// @brief Sets the candidate of a pair of features. It is the same whichever triangles
  /// the pair is found in.
  void setCandidate(std::uint32_t code, const TimeWindow& window,
                    FeatureCandidate& out) const;

  /// @brief The exchanges (exchangedNumbers()) that put the points of a candidate in the
  /// order in which these put the points of its code.
  std::uint8_t exchangesOf(std::uint32_t code, const FeatureCandidate& candidate,
                           std::uint8_t exchanges) const;

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
  void setFreePair(const TrianglePair& pair, FeatureCandidate& out) const;

  TriangleReader reader_a_, reader_b_;
  bool self_;
  double reach_;
  PairBends bends_;
  /// Whether free points come near free edges or each other.
  bool tests_points_;
  const KdopShift* shift_;
  KdopShift turned_shift_;
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

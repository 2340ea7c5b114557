// SPDX-License-Identifier: BSD-3-Clause
//
// The pairs of features of two meshes that may touch, where many do. The step is divided
// into spans. The chord of a vertex is the straight line from its place at the beginning
// of a span to that at the end. Meshes whose vertices go along their chords are compared
// as meshes that go straight (deformable_query.h), at the distance by which vertices may
// deviate from the chords, or from paths that are bent to one side (bend.h).
#ifndef FCL_CCD_CURVED_CHORD_PAIRS_H
#define FCL_CCD_CURVED_CHORD_PAIRS_H

#include <cstdint>
#include <vector>

#include "bodies/moving_body.h"
#include "mesh/bend.h"
#include "query/query_answer.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief How points deviate from their chords in a turn.
struct ChordBend {
  Bend bend;
  /// Bound on the distance from the path that is bent so.
  double error;
};

/// @brief The bend during a span of the points within `radius` of the origin of the body.
/// @param most  bound on their deviation from their chords
/// @pre the body turns about an axis, by less than pi during the span
ChordBend bendOf(const MotionPath& path, double radius, double t0, double t1,
                 double most);

/// @brief A mesh whose vertices go along their chords during a span.
class ChordMesh {
 public:
  /// @param body  kept by reference
  explicit ChordMesh(const MovingBody& body) : body_(body) {}
  // The instance refers to the other members.
  ChordMesh(const ChordMesh&) = delete;
  ChordMesh& operator=(const ChordMesh&) = delete;

  /// @brief Whether a span takes time for each triangle.
  bool isRefit(double t0, double t1) const;

  /// @brief The mesh of a span; valid until the next call.
  /// @param bend  how the paths of a rigid mesh are bent, kept by reference; null: chords
  /// of later spans may be moved
  const MeshInstance& during(double t0, double t1, int num_threads, const Bend* bend);

 private:
  const MovingBody& body_;
  MeshInstance mesh_;
  MovingKdopTree tree_;
  std::vector<double> coordinates_[2];
};

/// @brief Finds the pairs of features of two meshes that may come within the distance of
/// a query, span by span.
class ChordSearch {
 public:
  /// @brief Whether there may be a search: not if the query is for another thing than all
  /// contacts, or a mesh has free edges or points or is small.
  static bool isFor(const MovingBody& a, const MovingBody& b,
                    const QueryOptions& options);

  /// @param a, b  kept by reference
  /// @pre isFor(a, b, options)
  ChordSearch(const MovingBody& a, const MovingBody& b, const QueryOptions& options);

  /// @brief 0: there would be too many. Then the true paths have to be compared.
  int numSpans() const { return num_spans_; }

  /// @brief Whether the pairs of a span have windows. Not with a distance, and not on
  /// paths that are no turns: there they have been advanced along their chords, since to
  /// advance them on the true paths takes longer.
  bool listsWindows() const;

  /// @brief The number of box tests on the true paths that cost less than the meshes of
  /// all spans: where there are few contacts, these may be enough.
  std::uint64_t boxTestsBefore() const;

  struct Span {
    double t0, t1;
    /// The times are fractions of the span. Before toc_lo the features of a pair are
    /// further apart on the true paths, and with listsWindows() after toc_hi. Pairs that
    /// are not in the list stay further apart.
    QueryAnswer near;
  };

  /// @brief The pairs of a span; of the first one also the crossings at t = 0.
  /// @pre 0 <= i < numSpans(), in ascending order; the floating-point mode is the default
  /// one
  /// @throws NonFiniteVertex; fcl::Exception when a vertex id of a triangle is out of
  /// range
  Span find(int i);

 private:
  /// @param share  the deviation in one span beside the largest one in a span
  int enoughSpans(double share) const;
  bool isBent(int k) const;
  double deviationIn(int k, const Span& span) const;
  bool mayMeet(double t0, double t1, double deviation) const;

  const MovingBody* body_[2];
  const QueryOptions& options_;
  ChordMesh mesh_[2];
  int num_spans_{0};
  /// Whether the paths of meshes that turn rigidly are compared as bent ones. Advancement
  /// along chords knows no bends.
  bool has_bends_{false};
  /// The largest deviation of each mesh from its chords, if there were one span; and the
  /// error of a distance on chords.
  double whole_[2]{0, 0};
  double error_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRIANGLE_PAIR_TEST_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRIANGLE_PAIR_TEST_H

#include <cstddef>
#include <cstdint>

#include "fcl/narrowphase/detail/deformable/contact_sink.h"
#include "fcl/narrowphase/detail/deformable/mesh_instance.h"
#include "fcl/narrowphase/detail/deformable/stage_counts.h"
#include "fcl/narrowphase/detail/deformable/triangle_pair.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What a query has to find.
enum class QueryGoal { kAll, kFirst, kAny };

struct QueryOptions {
  QueryGoal goal{QueryGoal::kAll};
  std::size_t max_contacts{static_cast<std::size_t>(-1)};
  double toc_err{1e-4};
  /// A crossing at t = 0 answers the query; contacts are of no interest then.
  bool stop_at_crossing{false};
};

/// @brief An edge of one mesh that passes through a face of the other at t = 0.
struct Crossing {
  /// The edge belongs to mesh a and the face to mesh b, not the other way round.
  bool first_on_a;
  std::uint32_t edge[2];
  std::uint32_t face[3];
  /// Triangle of mesh a and of mesh b.
  std::int32_t triangles[2];
};

/// @brief Everything that is done to a triangle pair whose boxes meet: crossing at t = 0,
/// feature pairs, elementary tests, contacts into the sink. Holds the state of one query
/// of one thread.
class TrianglePairTest {
 public:
  /// @param a, b  kept by reference; the same object twice for a self-collision.
  TrianglePairTest(const MeshInstance& a, const MeshInstance& b,
                   const QueryOptions& options);

  /// @brief Tests triangle i of a against triangle j of b over the window in which their
  /// boxes overlap.
  /// @throws NonFiniteVertex
  void visit(int i, int j, TimeWindow window);

  /// @brief Whether nothing more can change the answer.
  bool isDone() const;

  /// @brief A pair whose window starts after this time cannot change the answer.
  double latest() const;

  bool hasCrossing() const { return has_crossing_; }
  const Crossing& crossing() const { return crossing_; }
  ContactSink& sink() { return sink_; }
  const ContactSink& sink() const { return sink_; }
  const StageCounts& counts() const { return counts_; }
  StageCounts& counts() { return counts_; }

 private:
  void testFeature(const FeaturePair& pair, double lo, double hi);
  void testCrossing(const TriangleSide& edges, const TriangleSide& face, bool edges_on_a);

  QueryOptions options_;
  TrianglePair pair_;
  bool full_window_;
  ContactSink sink_;
  bool has_crossing_{false};
  Crossing crossing_{};
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

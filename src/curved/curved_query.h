// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CURVED_CURVED_QUERY_H
#define FCL_CCD_CURVED_CURVED_QUERY_H

#include <cstdint>
#include <vector>

#include "advance/triangle_advance.h"
#include "bodies/moving_body.h"
#include "elementary/most_steps.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {
namespace deformable {

struct CurvedOptions {
  static constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

  /// Whether every pair of triangles is wanted, with its first time. If not, the first
  /// contact only.
  bool all{false};
  /// Whether one pair is enough, which need not be the first in contact. Not with `all`.
  bool any{false};
  /// Width of a contact's time bracket.
  double toc_err{1e-4};
  /// Whether a time is looked for at which the triangles provably cross. If not, brackets
  /// have no width.
  bool proves_contacts{true};
  /// The latest time that matters.
  double t_max{1};
  /// Whether only contacts at t = 0 are looked for. They are proved until `t_max`.
  bool only_at_start{false};
  /// Bodies are in contact at this distance of their surfaces.
  double distance{0};
  /// Whether pairs with a shape or a cell that are nearer than the distance at t = 0 have
  /// their own one in its place: ConvexAdvance::ignoreInitiallyCloser().
  bool ignores_initially_closer{false};
  /// The number of steps after which a pair of triangles is given up and counts as
  /// contact. Surfaces that slide at a distance g take about sqrt(M / 2 g) steps.
  int max_steps{kMostSteps};
  /// After this number of tests of boxes the query is given up.
  std::uint64_t most_box_tests{kNoLimit};
  /// The largest number of threads, if `all` is set; 0: as many as the task arena has.
  int num_threads{1};
  /// Selects the triangle pairs that count; null: all of them.
  const PairRules* rules{nullptr};
};

/// @brief What a query of two bodies asks of queryCurved().
CurvedOptions curvedOptionsOf(const MovingBody& a, const MovingBody& b,
                              const QueryOptions& options);

struct CurvedAnswer {
  /// Sorted by (toc_lo, triangles). One for each pair of triangles, shapes or cells.
  std::vector<CurvedContact> contacts;
  AdvanceCounts counts;
  /// Largest distance of a reported pair, less the requested distance.
  double touching{0};
  /// Whether the query was given up. The contacts are then some of those that there are.
  bool is_cut{false};
};

/// @brief The bodies in a frame whose origin is in the middle between them, where
/// coordinates round less. The order of the bodies does not matter.
struct BodiesNearOrigin {
  BodiesNearOrigin(const MovingBody& from_a, const MovingBody& from_b);
  MovingBody a, b;
  /// The place of the new origin in the world.
  double origin[3];
};

/// @brief The number of the triangle of a shape or an octree, which have none.
constexpr std::int32_t kNoTriangle = -1;

/// @brief The contacts of two bodies during t in [0, 1]. (1) It never misses: surfaces
/// that come within the distance have a contact. (With a distance of 0 a free point meets
/// neither free edges nor free points.) (2) It is never late: toc_lo is not
/// after the first time at which they do. (3) A reported pair comes within distance +
/// `touching`, unless it is marked kGivenUp.
/// The answer does not depend on the number of threads.
/// @pre the floating-point mode is the default one
CurvedAnswer queryCurved(const MovingBody& a, const MovingBody& b,
                         const CurvedOptions& options);

/// @brief Two triangles that may touch during [t0, t1], by their places in the trees.
struct NearTriangles {
  std::int32_t place[2];
  double t0, t1;
};

/// @brief The pairs of triangles that no box keeps apart by more than a distance. A pair
/// may come several times, with other spans. Outside of these the triangles are further
/// apart.
/// @pre the floating-point mode is the default one
std::vector<NearTriangles> nearTriangles(const MovingBody& a, const MovingBody& b,
                                         double distance = 0);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

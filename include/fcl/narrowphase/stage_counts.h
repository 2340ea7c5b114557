// SPDX-License-Identifier: BSD-3-Clause
//
// Kinds of queries, and what the stages of a query count: plain data,
// which the stages themselves use too. continuous_contact.h includes this header.
#ifndef FCL_NARROWPHASE_STAGE_COUNTS_H
#define FCL_NARROWPHASE_STAGE_COUNTS_H

#include <cstdint>

#include "fcl/narrowphase/continuous_contact_kind.h"

namespace fcl {

/// @brief What a continuous query looks for.
enum class ContinuousQuery {
  kAll,    ///< all contacts (at most num_max_contacts, the earliest ones)
  kFirst,  ///< the first time of contact; later contacts are skipped
  kAny     ///< whether there is a contact; the query stops at the first proof
};

/// @brief How many candidates each stage of a continuous query saw and removed, in the
/// order of the pipeline. A stage culls a candidate or passes it on:
/// feature_pairs = box_culled + mask_culled + filter_culled + solver_culled +
/// exact_culled + contacts.
/// In a query for any contact the sum is smaller, since the query stops at the first
/// proof.
struct StageCounts {
  /// pairs of moving boxes of nodes and triangles that were compared
  std::uint64_t node_pairs{0};
  /// triangle pairs whose moving boxes overlap at some time
  std::uint64_t triangle_pairs{0};
  /// of those, the pairs that share a vertex
  std::uint64_t adjacent_pairs{0};
  /// of those, the pairs that provably touch only in what they share, since the triangles
  /// around the shared vertex stay a fan; pairs below a node that lies in one fan are not
  /// counted
  std::uint64_t fan_culled{0};
  /// triangle pairs that a plane separates until the latest time that matters. If that is
  /// more than the beginning of the step, only where the first pairs of a block show that
  /// it pays, as for close surfaces that slide along each other
  std::uint64_t plane_culled{0};
  /// VF and EE pairs without a common vertex that the remaining triangle pairs own; with
  /// min_distance also pairs of free points with free edges and with each other. Without
  /// those pairs for which the contacts found so far leave no room
  std::uint64_t feature_pairs{0};
  /// feature pairs whose moving boxes do not overlap, or only too late to matter
  std::uint64_t box_culled{0};
  /// feature pairs that the filters of the request reject; without those of triangles of
  /// deforming meshes that groups and masks left out before
  std::uint64_t mask_culled{0};
  /// feature pairs that provably never become coplanar while their boxes overlap; with
  /// min_distance: those that a direction provably keeps further apart, or that do not
  /// come nearer if they are ignored
  std::uint64_t filter_culled{0};
  /// feature pairs for which the certified solve (with min_distance: directional
  /// advancement) proved that there is no contact, or none before the first one
  std::uint64_t solver_culled{0};
  /// feature pairs that the solve left undecided and that integers proved to be no
  /// contact
  std::uint64_t exact_culled{0};
  /// feature pairs that integers decided, contact or not
  std::uint64_t exact_tests{0};
  /// feature pairs that are contacts
  std::uint64_t contacts{0};
  /// edge-face pairs tested for crossing at t = 0, until one is found
  std::uint64_t crossing_tests{0};

  StageCounts& operator+=(const StageCounts& other) {
    node_pairs += other.node_pairs;
    triangle_pairs += other.triangle_pairs;
    adjacent_pairs += other.adjacent_pairs;
    fan_culled += other.fan_culled;
    plane_culled += other.plane_culled;
    feature_pairs += other.feature_pairs;
    box_culled += other.box_culled;
    mask_culled += other.mask_culled;
    filter_culled += other.filter_culled;
    solver_culled += other.solver_culled;
    exact_culled += other.exact_culled;
    exact_tests += other.exact_tests;
    contacts += other.contacts;
    crossing_tests += other.crossing_tests;
    return *this;
  }
};

/// @brief Wall time of the parts of a query, in seconds. With several threads the wall
/// time is divided in proportion to the time that all threads spent on each part.
struct StageTimes {
  /// making trees, owners and moving boxes, if the query itself had to do it
  double update{0};
  /// comparing moving boxes
  double traverse{0};
  /// testing triangle pairs, and handing over the contacts
  double test{0};
};

}  // namespace fcl

#endif

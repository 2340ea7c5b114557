// SPDX-License-Identifier: BSD-3-Clause
//
// Contacts on straight paths that count only where the features approach each other
// faster than a given speed, in units of length per step.
#ifndef FCL_CCD_ELEMENTARY_APPROACH_SPEED_H
#define FCL_CCD_ELEMENTARY_APPROACH_SPEED_H

#include "elementary/feature_points.h"
#include "elementary/flat_passage.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A contact of features that touch, and what counts.
struct TouchingRequest {
  /// The bracket of the first time of contact.
  double toc_lo, toc_hi;
  /// Only contacts until this time count.
  double t_max;
  /// Above 0.
  double min_approach_speed;
  /// The surroundings of both features; null: they are not known.
  const PairStars* stars{nullptr};
};

/// @brief The time from which on a pair that touches approaches faster than the speed, as
/// far as no proof says otherwise; above t_max if it never does.
///
/// The height of a pair is that of the vertex above the plane of the face (VF), or the
/// distance of the lines along their common normal (EE): volume / |n|. A part of the step
/// is left out with one of these proofs:
/// - the features are not above each other: an inside condition is negative;
/// - the height changes by no more than the speed, in either direction;
/// - the height has the sign all the time that it has at toc_lo, before they touch;
/// - one feature is inside of a flat part of its mesh, and the other one does not pass
///   through that (FlatPassage);
/// - they are apart, and were in contact by the last proof only.
///
/// So a vertex that passes through a face slowly is still in contact with it when it
/// moves faster, as long as it is below the face. Features that touch at t = 0 have no
/// side: to move away from each other counts as to approach. Features in a plane of
/// constant x, y or z have no height. Properties: (1) a time is left out only with a
/// proof; (2) the same inputs give the same bits on every machine.
/// @param kind  kVertexFace or kEdgeEdge
double approachesFrom(ContinuousContactKind kind, const FeaturePoints& x,
                      const TouchingRequest& request);

struct DistanceContact;
struct DistanceRequest;

/// @brief advanceToDistance() (elementary/distance_advance.h) where a pair that comes
/// within the distance is in contact only if the distance shrinks faster than the speed.
/// If not, the pair is left out as long as it provably stays further apart than it is
/// then (less twice the tolerance) minus the speed times the time since then. A pair that
/// would touch within the step at this speed has a lower one.
/// @param min_approach_speed  0: all contacts count
DistanceContact advanceToApproach(ContinuousContactKind kind, const FeaturePoints& x,
                                  const DistanceRequest& request,
                                  double min_approach_speed, const PointIds& ids = {});

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

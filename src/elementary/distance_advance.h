// SPDX-License-Identifier: BSD-3-Clause
//
// The first time at which two features on straight paths come within a distance d > 0.
//
// Directional advancement: a direction n that separates the features by more than d does
// so until a time that is known in closed form, since the corners of the difference of
// the features move linearly. The nearest points at a time propose n and how it turns;
// the corners prove it. For d = 0 there is an exact test (elementary.h).
#ifndef FCL_CCD_ELEMENTARY_DISTANCE_ADVANCE_H
#define FCL_CCD_ELEMENTARY_DISTANCE_ADVANCE_H

#include <cassert>

#include "elementary/feature_points.h"
#include "elementary/nearest_point.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What is asked of a pair.
struct DistanceRequest {
  /// At this distance the features are in contact. Above 0.
  double distance;
  /// Only contacts until this time.
  double t_max{1};
  /// Contacts that begin later may be left out.
  double t_stop{1};
  /// Largest width of the bracket. Above 0.
  double toc_err{1};
  /// Features that are nearer than `distance` at t = 0 are in contact when they come
  /// nearer than they are then, by more than the tolerance.
  bool ignores_initially_closer{false};
};

/// @brief Bounds on rounding for one pair. u = 2^-53. d is the distance, L the largest
/// length of a corner of the DifferencePolygon.
///
/// A corner is a difference, rounded once: u L. A point of the polygon at a time t: a
/// corner there is off by 4 u of both its ends, 8 u L. Two multiples of sides, which are
/// 2 L long and 18 u L off: (18 + 2 + 2) u L each and sums of 2 and 3 L, if the multiples
/// add up to 1; weights round by 2 u more. So the distance of a computed point differs
/// from that of a point of the polygon by at most 64 u L.
struct DistanceTolerance {
  DistanceTolerance(double distance, double size)
      : distance_error(64 * kUnit * size),
        margin(128 * kUnit * (distance + size)),
        touching(kTouching * (distance + size)) {
    assert(distance >= 0 && size >= 0 && !(touching < margin + 2 * distance_error));
  }

  /// Bound on the error of the length of a computed nearest point.
  double distance_error;
  /// What is apart by d + margin along a direction, as computed, is further apart than d:
  /// see AdvancingPair in distance_advance.cpp.
  double margin;
  /// Features that come within d + touching are in contact: more than the margin and
  /// twice the error. So a pair at which advancement comes to rest is recognised.
  double touching;

  /// For a pair; bounds on it for all pairs of a query are made with it too.
  static constexpr double kTouching = 512 * kUnit;
  /// The share of d within which a pair that is not decided soon is a contact.
  static constexpr double kShare = 1e-9;
  /// Pairs that almost touch, by this share of d or of their coordinates, have a distance
  /// that rounding may hide.
  static constexpr double kAlmost = 0x1p-20;
};

/// @brief The answer for a pair.
struct DistanceContact {
  bool is_contact{false};
  /// The features are provably further apart than d before toc_lo, and within the
  /// tolerance of it then. If toc_hi is larger, they provably are within d at toc_hi.
  double toc_lo{1};
  double toc_hi{1};
  /// The features that are nearest at toc_lo: the pair itself, or parts of it.
  ContinuousContactKind kind{ContinuousContactKind::kVertexFace};
  /// Their points, as numbers in FeaturePoints. VE: v, e0, e1. VV: the points of both.
  int points[4]{0, 1, 2, 3};
  /// More than the largest number of steps were needed. The pair may be further apart
  /// than the tolerance.
  bool is_given_up{false};
  int steps{0};
};

/// @brief Numbers of the advancement, which its vector form has too
/// (kernels/advance_kernels.cpp).
struct Advance {
  /// A time is a quotient of two differences, or of a product and a sum with a root, then
  /// a product: 8 units in the last place.
  static constexpr double kDown = 1 - 0x1p-50, kUp = 1 + 0x1p-50;
  /// A bracket is narrow beside its end, so that simulations can step by it.
  static constexpr double kShareOfTime = 0.125;
  /// The upper end is sought at this multiple of the time in which the gap closes, then
  /// this factor later each time.
  static constexpr double kFirstGuess = 1.5, kFactor = 4;
  /// Between these sizes no square and no product overflows or underflows.
  static constexpr double kLeastSize = 0x1p-200, kMostSize = 0x1p200;
};

/// @brief Properties: (1) no contact only with a proof that the features stay further
/// apart than d until t_max or t_stop; (2) a contact only if they come within d (1 +
/// 1e-9) + touching, unless is_given_up; (3) the answer does not depend on the order of
/// the features or of their points; (4) the same inputs give the same bits on every
/// machine.
/// @param kind  kVertexFace, kEdgeEdge, kVertexEdge or kVertexVertex
/// @param ids  name the parts of features whose points coincide
/// @pre all coordinates are finite
DistanceContact advanceToDistance(ContinuousContactKind kind, const FeaturePoints& x,
                                  const DistanceRequest& request,
                                  const PointIds& ids = {});

/// @brief The middle of the nearest points at t, and the unit vector from the first
/// feature to the second; zero if they touch.
void distanceGeometry(ContinuousContactKind kind, const FeaturePoints& x, double t,
                      double (&position)[3], double (&normal)[3]);

// Parts of the advancement, for features on other paths.

/// @brief The number of directions that directionApart() proposes.
constexpr int kDirectionAttempts = 5;

/// @brief A unit direction from the first feature to the second at one time; zero if
/// there is none. The first attempt is the plain one. Pairs of nearly parallel edges,
/// slivers and distances far below the size of the features may need others: rounding
/// hides which corners are at the height of the nearest point.
/// @param corners  of the polygon, at this time
Vec directionApart(const DifferencePolygon& polygon, const Vec* corners,
                   const NearestPoint& near, int attempt);

/// @brief The nearest point itself, if its plain direction shows that no point is nearer
/// by more than the error; otherwise the one that accurateNearest() finds. Where
/// coordinates differ by many powers of ten nearestPoint() may be another point of the
/// polygon, which is further away than the error.
NearestPoint sureNearest(const DifferencePolygon& polygon, const Vec* corners,
                         const NearestPoint& near, double error);

/// @brief How the direction n of the nearest points turns with the features, by time. For
/// a proof any turn would be right.
/// @param velocities  of the corners
Vec turnApart(const DifferencePolygon& polygon, const Vec* corners, const Vec* velocities,
              const NearestPoint& near, const Vec& n);

/// @brief The first time at which gap + rate tau + bend tau^2 is 0, for gap > 0; infinity
/// without one. It is the root of a polynomial whose coefficients differ by less than 8
/// units in the last place.
double firstRoot(double gap, double rate, double bend);

/// @brief Sets the features that the nearest point of a polygon belongs to.
/// @param number  of the points of the pair
void setNearest(ContinuousContactKind kind, const NearestPoint& near,
                const int (&number)[4], DistanceContact& out);

/// @brief The same, with the points of a part in ascending order. If the part is the
/// whole pair, its points keep the numbers 0 to 3.
void setPart(ContinuousContactKind kind, const NearestPoint& near, const int (&number)[4],
             DistanceContact& out);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

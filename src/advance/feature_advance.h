// SPDX-License-Identifier: BSD-3-Clause
//
// The first time at which two features of triangles that move on curved paths come within
// a distance above 0. The decision is on the true paths.
#ifndef FCL_CCD_ADVANCE_FEATURE_ADVANCE_H
#define FCL_CCD_ADVANCE_FEATURE_ADVANCE_H

#include "advance/triangle_advance.h"
#include "elementary/distance_advance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A feature of a triangle as a triangle without area: a vertex, or an edge whose
/// second end is repeated.
/// @param first, second  corners
BodyTriangle featureOf(const BodyTriangle& triangle, unsigned first, unsigned second);

/// @brief A vertex and a face, two edges, or free points and edges, in a span of time.
/// What TriangleAdvance is for two triangles.
///
/// Properties: (1) kApart only with a proof that the features stay further apart than the
/// distance d of the tolerance; (2) kContact only if they come within d (1 + 1e-9) +
/// BodyTolerance::touching + 576 u (d + L). L is the largest distance of two of their
/// points, u = 2^-53.
class FeatureAdvance {
 public:
  using Answer = TriangleAdvance::Answer;

  /// @param pair  the number of the pair of features (feature_pairs.h)
  FeatureAdvance(const MotionPath& path_a, const BodyTriangle& a,
                 const MotionPath& path_b, const BodyTriangle& b, int pair, double t0,
                 double t1, const BodyTolerance& tolerance);
  // The members refer to each other.
  FeatureAdvance(const FeatureAdvance&) = delete;
  FeatureAdvance& operator=(const FeatureAdvance&) = delete;

  /// @brief Takes the distance that the features have at t = 0 as d, less the tolerance,
  /// if they are nearer than d then. Not if they touch then.
  void ignoreInitiallyCloser();

  /// @brief Advances from t to the first time at which the features are in contact.
  /// kGivenUp: they are apart before t.
  /// @param[in,out] t  in: the time at which to start; out: the time that was reached
  Answer advance(double& t, AdvanceCounts& counts) const;

  /// @brief The contact that begins at t. At toc_hi the features provably are within d;
  /// it is t if no such time is found. Points are numbered as in FeatureIds.
  /// @param width  largest width of the bracket
  DistanceContact contactAt(double t, double width) const;

 private:
  /// The features at a time.
  struct Moment;

  double proveWithin(double t, double width) const;
  double longestStep(double t, const Moment& moment) const;
  double longerStep(double t, const Moment& moment, const NearestPoint& near,
                    const Vec& n) const;
  double turningStep(const Moment& moment, const Vec& n, const Vec& turn,
                     double longest) const;
  /// Features whose computed gap along a direction is at least d + this are further apart
  /// than d.
  double margin(double size) const;
  /// Features whose computed distance is at most d + this are in contact.
  double touching(double size) const;

  FeaturePair pair_;
  BodyTolerance tolerance_;
  BodyTriangle a_, b_;
  TriangleAdvance motion_;
  double t1_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

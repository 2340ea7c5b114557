// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary tests of continuous collision detection, one query at a time.
#ifndef FCL_NARROWPHASE_CONTINUOUS_FEATURES_H
#define FCL_NARROWPHASE_CONTINUOUS_FEATURES_H

#include "fcl/ccd_version.h"
#include "fcl/common/types.h"
#include "fcl/export.h"

namespace fcl {

/// @brief What vertexFace() and edgeEdge() find.
template <typename S>
struct ContinuousFeatureTestResult {
  /// @brief Whether the features touch at some t in [0, 1].
  bool is_contact{false};

  /// @brief The first time at which they touch lies in [toc_lo, toc_hi]; [0, 0] when they
  /// touch at t = 0. Without contact both are 1.
  S toc_lo{1};
  S toc_hi{1};
};

using ContinuousFeatureTestResultf = ContinuousFeatureTestResult<float>;
using ContinuousFeatureTestResultd = ContinuousFeatureTestResult<double>;

/// @defgroup continuous_feature_tests Elementary tests
///
/// Whether two features, whose vertices move on straight lines from x_t0 (t = 0) to x_t1
/// (t = 1), touch at some t in the closed interval [0, 1], and when first. Features are
/// closed: a triangle contains its border, an edge its ends. A degenerate feature is the
/// set of its points: a triangle without area is a segment or a point, an edge of equal
/// ends is a point.
///
/// (1) The decision is exact for all finite coordinates, which are taken as they are
/// (floats as the doubles that they convert to). (2) toc_lo is not later and toc_hi not
/// earlier than the first time of contact. (3) The decision does not depend on the order
/// of the features, of the vertices of one, or on the direction of time. (4) The same
/// arguments give the same bits. (5) The caller's floating-point mode does not matter and
/// is left as it is. Calls are independent of each other: any number of threads may make
/// them.
///
/// After Tang, Manocha, Tong 2010, section 3, but with decisions that are proved: see
/// doc/pipeline.md.
///
/// @tparam S  double or float; deduced from vectors, to be given for expressions of them
/// @param toc_err  width of [toc_lo, toc_hi] in units of t; 0: as narrow as doubles
/// allow. Where less than a few units in the last place (of S) is asked for, the bracket
/// is that wide; rounding to float may add a unit. It does not change the decision.
/// @throws fcl::Exception when a coordinate is not finite (it names the point, as the
/// parameters are called), or toc_err is negative or NaN.
/// @{

/// @brief Vertex v against triangle f0 f1 f2.
template <typename S>
FCL_EXPORT ContinuousFeatureTestResult<S> vertexFace(
    const Vector3<S>& v_t0, const Vector3<S>& f0_t0, const Vector3<S>& f1_t0,
    const Vector3<S>& f2_t0, const Vector3<S>& v_t1, const Vector3<S>& f0_t1,
    const Vector3<S>& f1_t1, const Vector3<S>& f2_t1, double toc_err);

/// @brief Edge ea0 ea1 against edge eb0 eb1.
template <typename S>
FCL_EXPORT ContinuousFeatureTestResult<S> edgeEdge(
    const Vector3<S>& ea0_t0, const Vector3<S>& ea1_t0, const Vector3<S>& eb0_t0,
    const Vector3<S>& eb1_t0, const Vector3<S>& ea0_t1, const Vector3<S>& ea1_t1,
    const Vector3<S>& eb0_t1, const Vector3<S>& eb1_t1, double toc_err);

/// @}

}  // namespace fcl

#endif

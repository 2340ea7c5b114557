// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary tests of continuous collision detection, for one pair of features.
#ifndef FCL_NARROWPHASE_CONTINUOUS_FEATURES_H
#define FCL_NARROWPHASE_CONTINUOUS_FEATURES_H

#include "fcl/ccd_version.h"
#include "fcl/common/types.h"
#include "fcl/export.h"

namespace fcl {

/// @brief The answer of vertexFace() and edgeEdge().
template <typename S>
struct ContinuousFeatureTestResult {
  /// @brief Whether the features touch at some t in [0, 1].
  bool is_contact{false};

  /// @brief The first time at which they touch lies in [toc_lo, toc_hi], in fractions of
  /// the step. The bracket is [0, 0] if they touch at t = 0. Without contact both are 1.
  S toc_lo{1};
  S toc_hi{1};
};

using ContinuousFeatureTestResultf = ContinuousFeatureTestResult<float>;
using ContinuousFeatureTestResultd = ContinuousFeatureTestResult<double>;

/// @defgroup continuous_feature_tests Elementary tests
///
/// They decide whether two features touch at some t in the closed interval [0, 1], and
/// bound the first such time. Each vertex moves on a straight line from x_t0 (t = 0) to
/// x_t1 (t = 1). Features are closed: a triangle contains its border, an edge its ends. A
/// degenerate feature is the set of its points: a triangle without area is a segment or a
/// point, an edge with equal ends is a point.
///
/// (1) The decision is exact for all finite coordinates. Floats are converted to doubles,
/// which is exact. (2) toc_lo is not later and toc_hi not earlier than the first time of
/// contact. (3) The decision does not depend on the order of the features, on the order
/// of the vertices of a feature, or on the direction of time. (4) The same arguments give
/// the same bits. (5) The caller's floating-point mode does not matter and is not
/// changed. Thread-safety: any number of threads may call them.
///
/// After Tang, Manocha, Tong 2010, section 3. The difference is that each decision is
/// proved: see doc/pipeline.md.
///
/// @tparam S  double or float. It is deduced from vectors; give it for expressions of
/// vectors, as in vertexFace<double>(a + b, ...).
/// @param toc_err  largest width of [toc_lo, toc_hi], in fractions of the step. 0: as
/// narrow as S allows, a few units in the last place; rounding to float may add a unit.
/// It does not change the decision.
/// @throws fcl::Exception when a coordinate is not finite (the text has the name of the
/// parameter), or when toc_err is negative or NaN.
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

/// @defgroup continuous_distance_tests Elementary tests at a distance
///
/// They decide whether two features come within min_distance of each other at some t in
/// [0, 1], and bound the first such time. Paths and features are those of the @ref
/// continuous_feature_tests. With min_distance = 0 they are these exact tests.
///
/// With min_distance = d > 0, u = 2^-53, and L the largest distance between a vertex of
/// one feature and a vertex of the other at t = 0 or 1:
/// (1) A pair that comes within d is never missed, and toc_lo is never later than the
/// first time at which it does. (2) A pair that stays further apart than d (1 + 1e-9) +
/// 512 u (d + L) is never reported. (A pair that is given up after 10,000 steps may be:
/// none of 1,000,000 generated queries, half of which are degenerate; doc/thickness.md.)
/// Between these two distances either answer is right. (3) If toc_hi > toc_lo, the
/// features are within d at toc_hi. The bracket is no wider than toc_err, and no wider
/// than an eighth of toc_hi. toc_hi = toc_lo means that no such time was found: they
/// graze this distance, or come nearer very slowly. (4) The bracket is [0, 0] if the
/// features are within d at t = 0. (5) The answer does not depend on the order of the
/// features or of their vertices. (6) The same arguments give the same bits, in any
/// floating-point mode, from any number of threads.
///
/// The method is directional advancement: doc/thickness.md describes it.
///
/// @param min_distance  d, in the unit of the coordinates
/// @throws fcl::Exception as the exact tests, and when min_distance is negative, infinite
/// or NaN
/// @{

/// @brief Vertex v against triangle f0 f1 f2.
template <typename S>
FCL_EXPORT ContinuousFeatureTestResult<S> vertexFaceWithin(
    const Vector3<S>& v_t0, const Vector3<S>& f0_t0, const Vector3<S>& f1_t0,
    const Vector3<S>& f2_t0, const Vector3<S>& v_t1, const Vector3<S>& f0_t1,
    const Vector3<S>& f1_t1, const Vector3<S>& f2_t1, double toc_err,
    double min_distance);

/// @brief Edge ea0 ea1 against edge eb0 eb1.
template <typename S>
FCL_EXPORT ContinuousFeatureTestResult<S> edgeEdgeWithin(
    const Vector3<S>& ea0_t0, const Vector3<S>& ea1_t0, const Vector3<S>& eb0_t0,
    const Vector3<S>& eb1_t0, const Vector3<S>& ea0_t1, const Vector3<S>& ea1_t1,
    const Vector3<S>& eb0_t1, const Vector3<S>& eb1_t1, double toc_err,
    double min_distance);

/// @brief Vertex v against edge e0 e1.
template <typename S>
FCL_EXPORT ContinuousFeatureTestResult<S> vertexEdgeWithin(
    const Vector3<S>& v_t0, const Vector3<S>& e0_t0, const Vector3<S>& e1_t0,
    const Vector3<S>& v_t1, const Vector3<S>& e0_t1, const Vector3<S>& e1_t1,
    double toc_err, double min_distance);

/// @brief Vertex v against vertex w.
template <typename S>
FCL_EXPORT ContinuousFeatureTestResult<S> vertexVertexWithin(
    const Vector3<S>& v_t0, const Vector3<S>& w_t0, const Vector3<S>& v_t1,
    const Vector3<S>& w_t1, double toc_err, double min_distance);

/// @}

}  // namespace fcl

#endif

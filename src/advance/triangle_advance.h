// SPDX-License-Identifier: BSD-3-Clause
//
// The first time at which two triangles that move on curved paths touch. The decision is
// on the true paths, not on chords.
#ifndef FCL_CCD_ADVANCE_TRIANGLE_ADVANCE_H
#define FCL_CCD_ADVANCE_TRIANGLE_ADVANCE_H

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "advance/advancement.h"
#include "bodies/body_tolerance.h"
#include "bodies/moving_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What is proved about a contact.
enum class ContactCertainty {
  kCrossing,         ///< toc_hi is a time at which the surfaces provably cross
  kWithinTolerance,  ///< the surfaces come within the tolerance of each other
  kGivenUp           ///< after too many steps neither proved apart nor within touching
};

/// @brief The features of two triangles that are nearest to each other.
struct NearestFeatures {
  enum class Kind { kVertexOfA, kVertexOfB, kEdges };
  double square;  ///< square of the distance
  Vec between;    ///< from a's point to b's
  Vec point;      ///< the point of a
  Kind kind;
  int a, b;                 ///< numbers of the vertex or edge (edge k starts at vertex k)
  bool inside_a, inside_b;  ///< edges: whether the point is not an end
};

/// @brief A contact of two triangles.
struct CurvedContact {
  /// The triangles of both bodies. A shape has kNoTriangle, an octree the place of the
  /// cell.
  std::int32_t triangle[2];
  /// The places of the triangles in the trees.
  std::int32_t place[2];
  double toc_lo, toc_hi;
  ContactCertainty certainty;
  NearestFeatures nearest;
};

/// @brief The number of corners of two triangles, of which one or both may stand for an
/// edge, whose second end is repeated, or for a point.
struct NumCorners {
  NumCorners() = default;
  NumCorners(const BodyTriangle& of_a, const BodyTriangle& of_b)
      : a(cornersOf(of_a)), b(cornersOf(of_b)) {}

  int of(int body) const {
    assert(body == 0 || body == 1);
    return body == 0 ? a : b;
  }
  static int edgesOf(int corners) { return corners == 3 ? 3 : 1; }

  int a{3}, b{3};

 private:
  static int cornersOf(const BodyTriangle& triangle) {
    const std::int32_t(&v)[3] = triangle.vertex;
    return v[1] != v[2] ? 3 : v[0] != v[1] ? 2 : 1;
  }
};

/// @brief Two triangles in a span of time.
class TriangleAdvance {
 public:
  /// Positions and velocities of the corners at a time.
  struct State {
    Vec p[2][3];
    Vec v[2][3];
  };

  TriangleAdvance(const MotionPath& path_a, const BodyTriangle& a,
                  const MotionPath& path_b, const BodyTriangle& b, double t0, double t1,
                  const BodyTolerance& tolerance);

  using Answer = AdvanceAnswer;

  /// @brief Advances from t to the first time at which the triangles are within the
  /// tolerance. Unless t is 0, they are apart or just touch at t. Triangles that cross at
  /// t = 0 are in contact.
  /// @param[in,out] t  in: the time at which to start; out: the time that was reached
  /// @param t_stop  stops after the first step that reaches this time
  /// @param[in,out] steps  the number of steps left
  Answer advance(double& t, double t_stop, int& steps, AdvanceCounts& counts);

  const NearestFeatures& nearest() const { return nearest_; }

  /// @brief The nearest features at a time. Both points are points of the triangles, up
  /// to rounding of the corners.
  NearestFeatures nearestAt(double t) const;

  /// @brief Whether an edge of one triangle passes through the other at a time, where the
  /// corners are computed to be.
  bool isCrossingAt(double t) const;

  /// @brief A unit direction from a to b that parts the triangles at a time; if they have
  /// parallel sides that of the sides. 0: there is none.
  Vec directionAt(double t) const;

  /// @brief A time in (t, t + width] at which an edge provably passes through the other
  /// triangle (with a requested distance: at which they provably are within it). t if no
  /// such time is found.
  double proveContact(double t, double width) const;

  /// @brief Whether a contact is proved at a time.
  bool provesContactAt(double t) const;

  State at(double t) const;

  /// @brief The step during which the direction provably keeps the triangles further
  /// apart than the distance, at most to the end of the span; negative if it does not at
  /// t.
  double step(double t, const State& state, const Vec& direction) const;

  /// @brief Bound on the relative acceleration of two vertices.
  double acceleration() const { return acceleration_; }

  /// @brief How long after the time t of a contact a proof is looked for.
  static double bracketWidth(double t, double toc_err, double t_max) {
    return std::min(toc_err, t_max - t);
  }

 private:
  /// Positions, velocities and accelerations of the corners along a direction.
  struct Projection;
  double greatestApproach(double t, const Vec& direction) const;
  Vec directionOfNearest(const State& state) const;
  void cornersAt(double t, Vec (&p)[2][3]) const;
  bool provesCrossing(const Vec (&p)[2][3]) const;

  const MotionPath* path_[2];
  const BodyTriangle* triangle_[2];
  NumCorners count_;
  double t1_;
  const BodyTolerance& tolerance_;
  /// Bound on the relative acceleration of two vertices.
  double acceleration_;
  /// The same for the third derivative; infinite: unknown.
  double jerk_;
  NearestFeatures nearest_;
};

/// @brief The nearest points of two closed triangles, up to rounding. The distance of
/// triangles that cross is not 0.
NearestFeatures nearestFeatures(const Vec (&a)[3], const Vec (&b)[3],
                                const NumCorners& count = {});

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// When two triangles that move on curved paths first touch, decided on the true paths.
#ifndef FCL_CCD_MOTION_TRIANGLE_ADVANCE_H
#define FCL_CCD_MOTION_TRIANGLE_ADVANCE_H

#include <cstdint>

#include "motion/motion_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What a query of two bodies knows of rounding: S is the size of the coordinates
/// that posed vertices are made of.
struct MotionTolerance {
  /// @brief Of two bodies: derived from their bounds.
  /// @param distance  at which bodies are in contact
  MotionTolerance(const MotionBody& a, const MotionBody& b, double distance);

  /// Bound on the error of a distance between computed points along a unit direction.
  double position;
  /// The same of a relative velocity.
  double rate;
  /// What comes within distance + touching counts as contact.
  double touching;
  double distance;
};

/// @brief How sure a contact is.
enum class MotionCertainty {
  kCrossing,         ///< toc_hi is a time at which the surfaces provably cross
  kWithinTolerance,  ///< the surfaces come within the tolerance of each other
  kGivenUp           ///< neither proved apart nor found as near, after too many steps
};

/// @brief The features of two triangles that are nearest to each other.
struct NearestFeatures {
  enum class Kind { kVertexOfA, kVertexOfB, kEdges };
  double square;  ///< of the distance
  Vec between;    ///< from a's point to b's
  Vec point;      ///< a's
  Kind kind;
  int a, b;                 ///< numbers of the vertex or edge (edge k starts at vertex k)
  bool inside_a, inside_b;  ///< of edges: whether the point is no end
};

/// @brief A contact of two triangles.
struct MotionContact {
  std::int32_t triangle[2];
  /// Where the trees have them.
  std::int32_t place[2];
  double toc_lo, toc_hi;
  MotionCertainty certainty;
  NearestFeatures nearest;
};

struct MotionCounts {
  std::uint64_t box_tests{0};
  std::uint64_t triangle_pairs{0};
  std::uint64_t steps{0};
  /// Steps in which the direction of the nearest features was not good enough.
  std::uint64_t all_directions{0};
};

/// @brief Two triangles in a span of time.
class TrianglePairMotion {
 public:
  TrianglePairMotion(const MotionPath& path_a, const BodyTriangle& a,
                     const MotionPath& path_b, const BodyTriangle& b, double t0,
                     double t1, const MotionTolerance& tolerance);

  enum class Answer {
    kApart,    ///< provably apart in all of [t, t1]
    kContact,  ///< within the tolerance at t, or crossing at t = 0; apart before
    kOpen,     ///< provably apart before t, no more steps wanted
    kGivenUp   ///< provably apart before t, no direction that leads on
  };

  /// @brief Advances from t, at which the triangles are apart or just touch unless it is
  /// 0, to the first time at which they are within the tolerance.
  /// @param[in,out] t  from when on
  /// @param last  stops after the first step that comes here
  /// @param[in,out] steps  left
  Answer advance(double& t, double last, int& steps, MotionCounts& counts);

  const NearestFeatures& nearest() const { return nearest_; }

  /// @brief A time in (t, t + width] at which an edge provably passes through the other
  /// triangle (with a distance asked for: at which they provably are as near); t if there
  /// is none that is found.
  double proveContact(double t, double width) const;

 private:
  struct State {
    Vec p[2][3];
    Vec v[2][3];
  };
  /// Positions, velocities and accelerations of the corners along a direction.
  struct Projection;
  State at(double t) const;
  double step(double t, const State& state, const Vec& direction) const;
  double greatestApproach(double t, const Vec& direction) const;
  static bool isCrossingAt(const State& state);
  bool provesCrossing(const State& state) const;

  const MotionPath* path_[2];
  const BodyTriangle* triangle_[2];
  double t1_;
  const MotionTolerance& tolerance_;
  /// Bound on the relative acceleration of two vertices.
  double acceleration_;
  /// The same of the third derivative; infinite: unknown.
  double jerk_;
  NearestFeatures nearest_;
};

/// @brief The points of two closed triangles that are nearest to each other, as far as
/// rounding allows; of triangles that cross not 0.
NearestFeatures nearestFeatures(const Vec (&a)[3], const Vec (&b)[3]);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

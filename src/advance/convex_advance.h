// SPDX-License-Identifier: BSD-3-Clause
//
// The first time at which a convex shape touches a triangle or another shape. Both move
// on curved paths. The decision is on the true paths.
#ifndef FCL_CCD_ADVANCE_CONVEX_ADVANCE_H
#define FCL_CCD_ADVANCE_CONVEX_ADVANCE_H

#include "advance/triangle_advance.h"
#include "bodies/moving_body.h"
#include "shapes/convex_distance.h"
#include "shapes/convex_shape.h"
#include "shapes/penetration.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A shape, a cell of an octree, or a triangle of a mesh, that moves.
struct MovingConvex {
  const MotionPath* path;
  /// Null: the triangle.
  const ConvexShape* shape;
  BodyTriangle triangle;
  /// Bound on the velocity of a point.
  double speed;
};

/// @brief The shape of a body, a cell of its octree, or a triangle of its mesh.
MovingConvex movingConvexOf(const MovingBody& body, std::int32_t place);

/// @brief Two convex sets of which one is a shape, in a span of time. What
/// TriangleAdvance is for two triangles.
class ConvexAdvance {
 public:
  using Answer = TriangleAdvance::Answer;

  /// @param tolerance  its distance is that of the cores
  ConvexAdvance(const MovingConvex& a, const MovingConvex& b, double t0, double t1,
                const BodyTolerance& tolerance);

  /// @brief The share of its distance by which a pair that begins nearer than the
  /// distance of contact must come nearer. With a smaller one, pairs that move together
  /// on curved paths take too many steps: 1,000 a unit of time with this one.
  static constexpr double kNearerShare = 1e-4;

  /// @brief Takes the distance of the surfaces at t = 0, less kNearerShare of it and
  /// twice the tolerance, in place of the distance of contact, if they are nearer than
  /// that then. Not if they touch then.
  void ignoreInitiallyCloser();

  /// @brief Suggests a direction from a to b that may part the sets, for example that of
  /// a pair beside this one; 0: none. The answer depends on it by rounding only.
  void suggest(const Vec& direction) { suggested_ = direction; }

  /// @brief The pair has taken steps before, in this span or another one.
  void continueAfter(int num_steps) { num_steps_ = num_steps; }

  /// @brief The last direction that parted the sets while they were advanced; 0: none.
  const Vec& lastDirection() const { return guess_; }

  /// @brief As TriangleAdvance::advance(). Also kContact where the sets overlap.
  Answer advance(double& t, double t_stop, int& steps, AdvanceCounts& counts);

  /// @brief As TriangleAdvance::proveContact().
  double proveContact(double t, double width) const;

  /// @brief As TriangleAdvance::provesContactAt().
  bool provesContactAt(double t) const;

  /// @brief As TriangleAdvance::directionAt().
  Vec directionAt(double t) const { return gapAt(t).direction; }

  /// @brief The gap of the cores at a time.
  ConvexGap gapAt(double t) const;

  /// @brief The nearest points of the cores at a time, up to rounding: their distance is
  /// larger than the gap by no more than an error.
  ConvexGap nearestAt(double t, double error) const;

  /// @brief The gap of the cores, without a look at their flat sides.
  ConvexGap coreGapAt(double t) const { return gapOf(momentAt(t), 0); }

  /// @brief The least translation that parts the cores.
  /// @param gap  gapAt() of that time
  /// @pre they overlap, or come within the tolerance
  Penetration penetrationAt(double t, const ConvexGap& gap) const;

  /// @brief Bound on the relative speed of two points.
  double speed() const { return set_[0]->speed + set_[1]->speed; }

 private:
  /// Both sets at a time.
  struct Moment {
    PosedConvex set[2];
    /// A point inside.
    Vec center(int k) const;
  };
  /// value + h rate.
  struct Line {
    double value, rate;
  };
  /// A set at a time, with the velocities of its points.
  struct Side {
    const PosedConvex& now;
    PoseRate rate;
    Vec velocity[3];
    /// The largest coordinate n . x + h (n . x' + n' . x) of a point: along a direction
    /// that changes, `h` later, up to terms of second order.
    double reachAfter(double h, const Vec& n, const Vec& change) const;
    /// The coordinate of the point that is farthest then, as a function of the time.
    Line farthestAfter(double h, const Vec& n, const Vec& change) const;
    /// A corner: of a triangle, or a piece of a core.
    MovingPoint cornerOf(int piece) const;
    /// How far two points may be apart; 0 for a flat, of which only the foot counts.
    double size() const;
  };
  struct State {
    const Moment& now;
    Side side[2];
  };
  PosedConvex setAt(int k, double t) const;
  Moment momentAt(double t) const { return {{setAt(0, t), setAt(1, t)}}; }
  Side sideAt(int k, double t, const Moment& now) const;
  State stateAt(double t, const Moment& now) const {
    return {now, {sideAt(0, t, now), sideAt(1, t, now)}};
  }
  ConvexGap gapOf(const Moment& now, double contact) const;
  ConvexGap flatGap(const Moment& now) const;
  /// A direction that is fixed in the world or in a body, or that turns with the nearest
  /// features.
  struct Separator {
    Vec direction, change;
    /// Bound on the second derivative of the relative coordinate of two points.
    double acceleration;
    double margin;
    /// The longest step, for which the direction stays of about the same length.
    double longest;
  };
  /// The gap that a step keeps, along a direction that may become longer by a factor. Its
  /// end may round by another half of the position error.
  double margin(double growth) const {
    return 2 * tolerance_.position + growth * tolerance_.distance;
  }
  double growthOfNormal(const Moment& now) const;
  Vec firstGuess(const Moment& now) const;
  Separator inWorld(const Vec& direction) const;
  double accelerationAlong(const Vec& direction) const;
  Separator inBody(int k, double t, const State& state, const ConvexGap& gap) const;
  double gapAfter(double h, const State& state, const Separator& separator) const;
  double endOfTangent(double h, const State& state, const Separator& separator) const;
  double step(double t, const State& state, const Separator& separator,
              double shorter) const;
  double longestStep(double t, const State& state, const ConvexGap& gap);
  double fixedStep(double t, const State& state, const ConvexGap& gap) const;
  double turningStep(double t, const State& state, const ConvexGap& gap);
  Separator turning(const Vec& direction, const Vec& change, double longest) const;
  Vec turnOfNearest(const State& state, const ConvexGap& gap) const;

  const MovingConvex* set_[2];
  /// The set that is a plane or a halfspace; -1: none. Then the sets are apart along its
  /// normal or not at all.
  int flat_;
  double t1_;
  /// The tolerance of this pair, with its distance of contact.
  BodyTolerance tolerance_;
  /// Bounds on the acceleration of each path in the span.
  AccelerationBound path_acceleration_[2];
  /// Bounds on the acceleration of the points of each set, and of the part of it along
  /// the axis of a turn.
  double set_acceleration_[2], axis_acceleration_[2];
  /// Bound on the relative acceleration of two points.
  double acceleration_{0};
  /// The steps that were taken.
  int num_steps_{0};
  /// How many steps in turn were no longer with a direction that turns.
  int num_in_vain_{0};
  /// How the direction turned then.
  Vec turn_{0, 0, 0};
  /// How much later the direction was that this was measured by.
  double horizon_{1};
  Vec suggested_{0, 0, 0};
  /// The direction of the last gap; 0: there is none.
  Vec guess_{0, 0, 0};
  /// The corners of that gap.
  NearestCorners nearest_{};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// A body as one traversal reads it. For one thread.
#ifndef FCL_CCD_BODIES_BODY_SIDE_H
#define FCL_CCD_BODIES_BODY_SIDE_H

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <memory>

#include "base/slot_cache.h"
#include "bodies/moving_body.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Stores the poses of a body, since the same times are needed again.
class PoseTable {
 public:
  explicit PoseTable(const MotionPath& path) : path_(path) {}
  const Pose& at(double t) {
    assert(isTimeOfStep(t));
    return poses_.get(slotOf(t, 0, kBits), t, [&](Pose& pose) { pose = path_.pose(t); });
  }

 private:
  static constexpr int kBits = 7;
  const MotionPath& path_;
  SlotCache<double, Pose, std::size_t{1} << kBits> poses_{-1};
};

/// @brief The beginning, the middle and the end of a span of time.
struct SpanTimes {
  double at[3];

  SpanTimes(double t0, double t1) : at{t0, 0.5 * (t0 + t1), t1} {
    assert(isPartOfStep(t0, t1) && t0 <= at[1] && at[1] <= t1);
  }
};

/// @brief The data of a body in a traversal.
struct BodySide {
  explicit BodySide(const MovingBody& b)
      : body(b),
        flat(b.shape() ? b.shape()->flat() : nullptr),
        reader(b),
        poses(b.path()),
        goes_straight(goesStraight(b.path())),
        axis(b.path().axis()),
        axis_acceleration(axis ? b.path().axisAcceleration(b.displacement()) : 0) {}

  SpanPoses spanPoses(const SpanTimes& times) {
    return {poses.at(times.at[0]), poses.at(times.at[1]), poses.at(times.at[2])};
  }

  /// @brief The bound on the acceleration during a span, or during the whole step where
  /// that is as good; valid until the next call.
  const AccelerationBound& acceleration(double t0, double t1) {
    if (is_steady_) {
      t0 = 0;
      t1 = 1;
    }
    if (t0 != span_[0] || t1 != span_[1]) {
      acceleration_ = body.path().acceleration(t0, t1);
      span_[0] = t0;
      span_[1] = t1;
    }
    return acceleration_;
  }

  /// @brief Bound on the acceleration of the points of a box during a span.
  /// @param begin, end  the box at t = 0 and t = 1; a rigid body's at t = 0
  double accelerationOf(const BodyBox& begin, const BodyBox& end, double t0, double t1) {
    const AccelerationBound& bound = acceleration(t0, t1);
    assert(!(begin.displacement < 0));
    if (body.isRigid()) return bound.of(vecOf(begin.center), begin.radius);
    return bound.between(vecOf(begin.center), vecOf(end.center),
                         std::max(begin.radius, end.radius)) +
           bound.per_displacement * begin.displacement;
  }

  /// @brief Bounds on the acceleration of the boxes of a node during a span; valid until
  /// the next call.
  /// @param part  the part that was opened; null: another node
  const double (&accelerations(const BodyPart* part, const BodyNode& node, double t0,
                               double t1))[BodyBoxes::kWidth] {
    assert(0 < node.count && node.count <= BodyBoxes::kWidth);
    const auto set = [&](Accelerations& out) {
      for (int lane = 0; lane < node.count; ++lane)
        out.most[lane] =
            goes_straight
                ? 0
                : accelerationOf(node.box[0].get(lane),
                                 node.box[body.isRigid() ? 0 : 1].get(lane), t0, t1);
    };
    if (part && is_steady_)
      return stored_.get(MovingBodyReader::slotOf(*part), part->child, set).most;
    set(other_);
    return other_.most;
  }

  /// @brief A triangle that is compared with others.
  struct SingleTriangle {
    bool is_readable{false};
    BodyTriangle of;
    /// Bound on the acceleration of its points during the span.
    double acceleration{0};
  };

  /// @brief A triangle in a span. Valid until the next call.
  const SingleTriangle& triangle(std::int32_t place, double t0, double t1) {
    assert(place >= 0);
    if (!singles_) singles_ = std::make_unique<SingleCache>(-1);
    const std::size_t slot = static_cast<std::size_t>(place) % SingleCache::kSlots;
    const bool is_stored = singles_->find(slot, place);
    SingleTriangle& out = singles_->get(slot, place, [&](SingleTriangle& single) {
      single.is_readable = body.isReadable(place);
      single.acceleration = 0;
      if (single.is_readable) single.of = body.triangle(place);
    });
    if (out.is_readable && !goes_straight && !(is_stored && is_steady_))
      out.acceleration = deformable::accelerationOf(acceleration(t0, t1), out.of);
    return out;
  }

  /// @brief The share of a point's deviation from a straight line that it has along a
  /// unit direction: all of its acceleration is at right angles to the axis of a turn.
  double shareAlong(const Vec& direction) const {
    return axis ? std::min(norm(cross(direction, *axis)) + 0x1p-48, 1.) : 1;
  }

  /// @brief The corners of a triangle in the world.
  SpanTriangle spanTriangle(const BodyTriangle& triangle, const SpanTimes& times) {
    SpanTriangle out;
    for (int at = 0; at < 3; ++at) {
      const double t = times.at[at];
      const Pose& pose = poses.at(t);
      for (int i = 0; i < 3; ++i) {
        const Vec &x0 = triangle.corner[0][i], &x1 = triangle.corner[1][i];
        set(out.corner[at][i], body.isRigid() ? posed(pose, x0) : posed(pose, x0, x1, t));
      }
    }
    return out;
  }

  const MovingBody& body;
  /// Null: the body is no plane or halfspace.
  const FlatShape* flat;
  MovingBodyReader reader;
  PoseTable poses;
  /// Whether all points go straight, also those of a mesh that deforms.
  const bool goes_straight;
  /// About which the body turns; null: there is none.
  const Vec* axis;
  /// Bound on the acceleration of a point along it.
  double axis_acceleration;

 private:
  struct Accelerations {
    double most[BodyBoxes::kWidth]{};  // lanes without a child, too
  };

  static bool goesStraight(const MotionPath& path) {
    const AccelerationBound bound = path.acceleration(0, 1);
    return bound.isZero() && bound.per_displacement == 0;
  }

  /// One triangle is compared with many nodes. Null until the first one.
  using SingleCache = SlotCache<std::int32_t, SingleTriangle, 64>;
  std::unique_ptr<SingleCache> singles_;
  /// Those of nodes that were opened, if they are the same for all spans.
  SlotCache<std::int32_t, Accelerations, MovingBodyReader::kSlots> stored_{-1};
  Accelerations other_{};
  const bool is_steady_{body.path().hasSteadyAcceleration()};
  AccelerationBound acceleration_;
  /// The span of that bound.
  double span_[2]{-1, -1};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

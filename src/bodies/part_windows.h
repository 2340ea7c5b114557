// SPDX-License-Identifier: BSD-3-Clause
//
// When parts of two bodies may meet, by their boxes.
#ifndef FCL_CCD_BODIES_PART_WINDOWS_H
#define FCL_CCD_BODIES_PART_WINDOWS_H

#include <algorithm>
#include <cassert>

#include "bodies/body_side.h"
#include "bodies/body_tolerance.h"
#include "bodies/part_work.h"
#include "shapes/body_boxes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Compares parts of two bodies during spans of time. For one thread.
class PartWindows {
 public:
  /// @param distance  at which the bodies are in contact
  /// @param measures_gaps  whether leastDistance() is asked for
  PartWindows(const MovingBody& a, const MovingBody& b, const BodyTolerance& tolerance,
              double distance, bool measures_gaps = false);

  /// @brief Takes another distance at which the bodies are in contact.
  void setDistance(double distance) {
    assert(!(distance < 0));
    distance_ = distance;
    box_margin_ = distance + rounding_;
  }

  bool measuresGaps() const { return measures_gaps_; }
  /// @brief The distance of two parts is at least this during the span of windows.
  double leastDistance(const MeetingWindows& windows, int lane) const {
    assert(measures_gaps_ && (windows.mask >> lane & 1U) != 0);
    return std::max(distance_ + windows.gap[lane] / direction_bound_, 0.);
  }

  BodySide& side(int k) { return side_[k]; }
  const BodySide& side(int k) const { return side_[k]; }

  /// @brief Bound on the rounding of the distance of two boxes.
  double rounding() const { return rounding_; }
  /// @brief Bound on the length of a direction that boxes are compared along.
  double directionBound() const { return direction_bound_; }

  /// @brief A part of a body during a span.
  struct PartSpan {
    /// At t = 0 and t = 1. Of a rigid body only the first one is set.
    BodyBox frame[2];
    /// The largest deviation of its points from straight lines.
    double deviation;
  };

  PartSpan partSpan(int k, const BodyPart& part, double t0, double t1);

  /// @brief The radius of a part, with the margin around the core of a shape.
  double sizeOf(int k, const PartSpan& span) const;

  /// @brief The windows, as shares of the span of the work, in which the children of one
  /// side's part may meet the other side's part.
  /// @param opened  the side whose children they are
  /// @param part  the part of that side; null: the node is the part itself
  /// @param other  the part of the other side
  MeetingWindows windows(const PartWork& work, int opened, const BodyNode& node,
                         const BodyPart* part, const PartSpan& other);

  /// @brief The side whose part testing a pair alone takes for the opened one.
  int openedAlone() const { return side_[1].flat ? 0 : 1; }
  /// @brief A part as the only child of a node.
  BodyNode alone(int k, const BodyPart& part) const;

  /// @brief Whether no direction shows that the boxes of two parts are apart at an end of
  /// a span. Then they may overlap at both ends of the span, and of the parts of it that
  /// begin or end there, however short these are.
  /// @param span  of both parts in the span of the work
  bool overlapAtEnds(const PartWork& work, const PartSpan (&span)[2]);

 private:
  using Accelerations = double[BodyBoxes::kWidth];

  /// What the gaps between the boxes of a node and another part are reduced by.
  struct Margins {
    /// How far the points of both deviate from straight lines during the span.
    double deviation[BodyBoxes::kWidth]{};
    /// The same along the axis about which a side turns, of the other part and the node.
    double along_axis[2][BodyBoxes::kWidth]{};
    /// Pads, requested distance and rounding.
    double fixed[BodyBoxes::kWidth]{};

    double with(double part_of_deviation, int lane) const {
      return fixed[lane] + part_of_deviation * deviation[lane];
    }
    double alongAxis(int k, double part_of_deviation, int lane) const {
      return fixed[lane] + part_of_deviation * along_axis[k][lane];
    }
  };

  double flatDeviation(int k, double t0, double t1);
  Margins marginsOf(const PartWork& work, int opened, const BodyNode& node,
                    const PartSpan& other, const Accelerations& acceleration);
  static double shareAlongFlat(const PartWork& work, BodySide& flat,
                               const BodySide& side);
  void setWindows(int opened, const BodyNode& node, const PartSpan& other,
                  const SpanTimes& times, const Margins& margins,
                  const BodyBoxes* const (&boxes)[3], MeetingWindows& windows);
  MeetingWindows windowsOfBoxes(const PartWork& work, int opened, const BodyNode& node,
                                const PartSpan& other, const Margins& margins,
                                TriangleHalves halves);
  TriangleHalves testTriangles(const PartWork& work, int opened, const BodyNode& node,
                               const BodyPart& part, const Accelerations& acceleration);
  bool narrowByShape(int opened, const PartWork& work, const BodyBoxes* const (&boxes)[3],
                     int lane, const Margins& margins, MeetingWindows& windows);

  BodySide side_[2];
  /// The share of a body's deviation that it has along the axis of the other one.
  double axes_share_;
  double rounding_;
  double distance_;
  double box_margin_;
  bool measures_gaps_;
  double direction_bound_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

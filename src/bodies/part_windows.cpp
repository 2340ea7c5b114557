// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/part_windows.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/bits.h"
#include "bodies/flat_windows.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "shapes/convex_distance.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

void interpolate(const BodyBox& end, double t, BodyBox& box) {
  assert(isTimeOfStep(t));
  for (int k = 0; k < 3; ++k) {
    box.center[k] = (1 - t) * box.center[k] + t * end.center[k];
    box.extent[k] = (1 - t) * box.extent[k] + t * end.extent[k];
  }
  box.radius = (1 - t) * box.radius + t * end.radius;
}

/// The box of a part at a time.
BodyBox boxAt(const MovingBody& body, const BodyPart& part, double t) {
  BodyBox box = body.box(part, 0);
  if (!body.isRigid()) interpolate(body.box(part, 1), t, box);
  return box;
}

/// The node's boxes at a time.
const BodyBoxes* boxesAt(const MovingBody& body, const BodyNode& node, double t,
                         BodyBoxes& scratch) {
  assert(isTimeOfStep(t));
  if (body.isRigid() || t == 0) return &node.box[0];
  if (t == 1) return &node.box[1];
  scratch = node.box[0];
  for (int lane = 0; lane < BodyBoxes::kWidth; ++lane) {
    for (int k = 0; k < 3; ++k) {
      scratch.center[k][lane] =
          (1 - t) * scratch.center[k][lane] + t * node.box[1].center[k][lane];
      scratch.extent[k][lane] =
          (1 - t) * scratch.extent[k][lane] + t * node.box[1].extent[k][lane];
    }
    scratch.radius[lane] = (1 - t) * scratch.radius[lane] + t * node.box[1].radius[lane];
  }
  return &scratch;
}

/// The vector from the center of a shape to that of a box.
Vec towardsBox(const ConvexShape& shape, const Pose& pose_shape, const BodyBox& box,
               const Pose& pose_box) {
  return posed(pose_box, vecOf(box.center)) - posed(pose_shape, shape.center());
}

}  // namespace

PartWindows::PartWindows(const MovingBody& a, const MovingBody& b,
                         const BodyTolerance& tolerance, double distance,
                         bool measures_gaps)
    : side_{BodySide(a), BodySide(b)},
      axes_share_(side_[0].axis ? side_[1].shareAlong(*side_[0].axis) : 1),
      measures_gaps_(measures_gaps) {
  // A kernel adds up no more than a hundred roundings of the sizes, and a time is
  // rounded by a few u.
  rounding_ = tolerance.position + 0x1p-44 * (a.size() + b.size()) +
              16 * kUnit * (a.speed() + b.speed());
  assert(distance >= tolerance.distance);
  setDistance(distance);
  direction_bound_ =
      (1 + 0x1p-10) * std::max({1., a.path().stretch(), b.path().stretch()});
}

PartWindows::PartSpan PartWindows::partSpan(int k, const BodyPart& part, double t0,
                                            double t1) {
  assert(isPartOfStep(t0, t1));
  BodySide& side = side_[k];
  const double dt = t1 - t0;
  PartSpan span;
  span.frame[0] = side.body.box(part, 0);
  if (!side.body.isRigid()) span.frame[1] = side.body.box(part, 1);
  span.deviation = 0;
  if (side.flat)
    span.deviation = flatDeviation(k, t0, t1);
  else if (!side.goes_straight)
    span.deviation =
        0.125 * dt * dt * side.accelerationOf(span.frame[0], span.frame[1], t0, t1);
  assert(!(span.deviation < 0));
  return span;
}

/// How far the height of a point above a flat deviates from a straight line, less what
/// the acceleration of the point adds: see ConvexAdvance::inBody().
double PartWindows::flatDeviation(int k, double t0, double t1) {
  BodySide &side = side_[k], &other = side_[1 - k];
  const double dt = t1 - t0, middle = 0.5 * (t0 + t1);
  const Vec foot = side.flat->foot();
  const BodyBox root = boxAt(other.body, other.body.root(), middle);
  const MotionPath& path = side.body.path();
  const double speed = other.body.speed() + path.speed(norm(foot)),
               apart = norm(posed(other.poses.at(middle), vecOf(root.center)) -
                            posed(side.poses.at(middle), foot)) +
                       direction_bound_ * (root.radius + root.pad) + 0.5 * dt * speed;
  const AccelerationBound& bound = side.acceleration(t0, t1);
  return 0.125 * dt * dt * direction_bound_ *
         (bound.of(foot, 0) + bound.of({0, 0, 0}, apart) + 2 * path.turnSpeed() * speed);
}

double PartWindows::sizeOf(int k, const PartSpan& span) const {
  if (side_[k].flat) return HUGE_VAL;
  const MovingBody& body = side_[k].body;
  const double radius = body.isRigid()
                            ? span.frame[0].radius
                            : std::max(span.frame[0].radius, span.frame[1].radius);
  return radius + body.shapeRadius();
}

/// @param acceleration  of the node's boxes
PartWindows::Margins PartWindows::marginsOf(const PartWork& work, int opened,
                                            const BodyNode& node, const PartSpan& other,
                                            const Accelerations& acceleration) {
  BodySide &one = side_[1 - opened], &many = side_[opened];
  const double dt = work.t1 - work.t0, share = direction_bound_ * 0.125 * dt * dt,
               of_one = direction_bound_ * other.deviation,
               axis_one = share * one.axis_acceleration,
               axis_many = share * many.axis_acceleration,
               flat_share = one.flat ? shareAlongFlat(work, one, many) : 1;
  Margins out;
  for (int lane = 0; lane < node.count; ++lane) {
    const double of_many = share * acceleration[lane];
    out.deviation[lane] = of_one + (flat_share * of_many + axis_many);
    out.along_axis[0][lane] = axis_one + (axes_share_ * of_many + axis_many);
    out.along_axis[1][lane] = axis_many + (axes_share_ * of_one + axis_one);
    out.fixed[lane] =
        direction_bound_ * (other.frame[0].pad + box_margin_ + node.box[0].pad[lane]);
    assert(!(out.fixed[lane] < 0) && !(out.deviation[lane] < 0));
    assert(!(out.along_axis[0][lane] < 0) && !(out.along_axis[1][lane] < 0));
  }
  return out;
}

/// The share of a side's deviation along the normal of a flat, which may turn.
double PartWindows::shareAlongFlat(const PartWork& work, BodySide& flat,
                                   const BodySide& side) {
  const double turn = flat.body.path().turnSpeed() * (work.t1 - work.t0);
  if (turn > 1) return 1;
  assert(!(turn < 0));
  const Vec normal = rotated(flat.poses.at(work.t0).rotation, flat.flat->normal);
  return std::min(side.shareAlong(normal) + turn, 1.);
}

/// The windows in which the boxes of a node may overlap the part of the other side.
void PartWindows::setWindows(int opened, const BodyNode& node, const PartSpan& other,
                             const SpanTimes& times, const Margins& margins,
                             const BodyBoxes* const (&boxes)[3],
                             MeetingWindows& windows) {
  BodySide &one = side_[1 - opened], &many = side_[opened];
  const SpanPoses pose_one = one.spanPoses(times), pose_many = many.spanPoses(times);
  double margin[BodyBoxes::kWidth] = {};
  CalmDirection axes[2] = {{one.axis, {}}, {many.axis, {}}};
  // Boxes are compared in the middle of the span too. In a half of it the deviation is
  // a quarter.
  const double part_of_deviation = one.flat ? 1 : 0.25;
  for (int lane = 0; lane < node.count; ++lane) {
    margin[lane] = margins.with(part_of_deviation, lane);
    for (int k = 0; k < 2; ++k)
      axes[k].margin[lane] = margins.alongAxis(k, part_of_deviation, lane);
  }
  if (one.flat)
    return flatWindows(*one.flat, pose_one, boxes, pose_many, margin, node.count,
                       windows);
  BodyBox moving[3];
  const BodyBox* others[3];
  for (int k = 0; k < 3; ++k) {
    others[k] = &other.frame[0];
    if (one.body.isRigid()) continue;
    moving[k] = other.frame[0];
    interpolate(other.frame[1], times.at[k], moving[k]);
    others[k] = &moving[k];
  }
  const BodyKernels& kernels = bodyKernels();
  const auto find =
      measures_gaps_ ? kernels.meetingWindowsWithGaps : kernels.meetingWindows;
  find(others, pose_one, boxes, pose_many, margin, axes, node.count, windows);
}

/// @param acceleration  of the node's boxes
TriangleHalves PartWindows::testTriangles(const PartWork& work, int opened,
                                          const BodyNode& node, const BodyPart& part,
                                          const Accelerations& acceleration) {
  TriangleHalves out;
  const BodyPart& single = opened == 1 ? work.a : work.b;
  BodySide &one = side_[1 - opened], &many = side_[opened];
  if (!one.body.isMesh() || !many.body.isMesh() || !single.isTriangle()) return out;
  for (int lane = 0; lane < node.count; ++lane)
    if (node.part[lane].isTriangle()) out.tested |= 1U << lane;
  if (out.tested == 0) return out;
  const BodySide::SingleTriangle& triangle =
      one.triangle(~single.child, work.t0, work.t1);
  if (!triangle.is_readable) return {};
  const double dt = work.t1 - work.t0, share = 0.125 * 0.25 * dt * dt,
               of_one = triangle.acceleration;
  double deviation[BodyBoxes::kWidth];
  for (int lane = 0; lane < BodyBoxes::kWidth; ++lane)
    deviation[lane] = direction_bound_ * share * (of_one + acceleration[lane]);
  const SpanTimes times(work.t0, work.t1);
  bodyKernels().meetingHalves(
      one.spanTriangle(triangle.of, times), many.reader.triangles(part),
      many.body.isRigid() ? nullptr : times.at, many.spanPoses(times), deviation,
      direction_bound_ * box_margin_, out.tested, out.meeting);
  return out;
}

/// Shortens the window of a box that may overlap the box of a shape, by the direction
/// that parts the shape itself from the box in the middle of the span.
/// @return whether they may overlap
bool PartWindows::narrowByShape(int opened, const PartWork& work,
                                const BodyBoxes* const (&boxes)[3], int lane,
                                const Margins& margins, MeetingWindows& windows) {
  // In a quarter of the span points deviate by a sixteenth.
  constexpr double kQuarter = 0x1p-4;
  const double margin = margins.with(1, lane),
               slack = margin - margins.with(kQuarter, lane);
  assert(!(slack < 0) && (windows.mask >> lane & 1U) != 0);
  const SpanTimes times(work.t0, work.t1);
  const SpanPoses poses[2] = {side_[1 - opened].spanPoses(times),
                              side_[opened].spanPoses(times)};
  const BodyBox begin = boxes[0]->get(lane), end = boxes[2]->get(lane);
  BodyBox middle = begin;
  interpolate(end, 0.5, middle);
  const ConvexShape* shape = side_[1 - opened].body.shape();
  const auto posedShape = [&](const Pose& pose) -> PosedConvex {
    return {shape, nullptr, pose, {}};
  };
  const auto posedBox = [](const BodyBox& box, const Pose& pose) -> PosedConvex {
    return {nullptr, &box, pose, {}};
  };
  const Vec n = convexGap(posedShape(poses[0].middle), posedBox(middle, poses[1].middle),
                          towardsBox(*shape, poses[0].middle, middle, poses[1].middle),
                          margin, margin)
                    .direction;
  const auto gap = [&](const PosedConvex& of_shape, const PosedConvex& of_box) {
    return -of_box.reach(-1. * n) - of_shape.reach(n) - margin;
  };
  const double first = gap(posedShape(poses[0].beginning),
                           posedBox(begin, poses[1].beginning)),
               last = gap(posedShape(poses[0].end), posedBox(end, poses[1].end));
  if (first > -slack && last > -slack &&
      gap(posedShape(poses[0].middle), posedBox(middle, poses[1].middle)) > -slack)
    windows.soon_apart |= 1U << lane;
  if (measures_gaps_)
    windows.gap[lane] = std::max(windows.gap[lane], std::min(first, last));
  return narrowWindow(first, last, windows.lo[lane], windows.hi[lane]);
}

/// @param halves  what is known of the triangles of the node
MeetingWindows PartWindows::windowsOfBoxes(const PartWork& work, int opened,
                                           const BodyNode& node, const PartSpan& other,
                                           const Margins& margins,
                                           TriangleHalves halves) {
  MeetingWindows windows;
  windows.mask = 0;
  const BodySide &one = side_[1 - opened], &many = side_[opened];
  const SpanTimes times(work.t0, work.t1);
  BodyBoxes moving[3];
  const BodyBoxes* boxes[3];
  for (int k = 0; k < 3; ++k) boxes[k] = boxesAt(many.body, node, times.at[k], moving[k]);
  setWindows(opened, node, other, times, margins, boxes, windows);
  halves.narrow(windows);
  if (!one.body.shape() || one.flat || one.body.shape()->fillsBox()) return windows;
  for (unsigned left = windows.mask; left != 0; left &= left - 1) {
    const int lane = lowestBit(left);
    if (!narrowByShape(opened, work, boxes, lane, margins, windows))
      windows.mask &= ~(1U << lane);
  }
  assert(windows.areInSpan(node.count) && (!measures_gaps_ || windows.haveNoGap()));
  return windows;
}

MeetingWindows PartWindows::windows(const PartWork& work, int opened,
                                    const BodyNode& node, const BodyPart* part,
                                    const PartSpan& other) {
  assert(opened == 0 || opened == 1);
  assert(isPartOfStep(work.t0, work.t1) && isPartOfStep(work.t0, work.start));
  const auto& acceleration = side_[opened].accelerations(part, node, work.t0, work.t1);
  TriangleHalves halves;
  if (part) halves = testTriangles(work, opened, node, *part, acceleration);
  if ((halves.left() & ((1U << node.count) - 1)) == 0) {
    MeetingWindows none;
    none.mask = 0;
    return none;
  }
  return windowsOfBoxes(work, opened, node, other,
                        marginsOf(work, opened, node, other, acceleration), halves);
}

BodyNode PartWindows::alone(int k, const BodyPart& part) const {
  const MovingBody& body = side_[k].body;
  BodyNode node;
  node.count = 1;
  for (int frame = 0; frame < (body.isRigid() ? 1 : 2); ++frame) {
    const BodyBox box = body.box(part, frame);
    for (int lane = 0; lane < BodyBoxes::kWidth; ++lane) node.box[frame].set(lane, box);
  }
  std::fill(node.part, node.part + BodyBoxes::kWidth, part);
  return node;
}

// The windows of boxes whose points deviate by nothing: the gap at the ends counts as it
// is.
bool PartWindows::overlapAtEnds(const PartWork& work, const PartSpan (&span)[2]) {
  const int opened = openedAlone();
  const BodyNode node = alone(opened, opened == 1 ? work.b : work.a);
  const PartSpan& other = span[1 - opened];
  Margins margins;
  margins.fixed[0] =
      direction_bound_ * (other.frame[0].pad + box_margin_ + node.box[0].pad[0]);
  const MeetingWindows windows = windowsOfBoxes(work, opened, node, other, margins, {});
  return windows.mask != 0 && !(windows.lo[0] > 0) && !(windows.hi[0] < 1);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes that turn against each other, eight pairs at once.
#include "motion/motion_boxes.h"

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "motion/motion_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "kernels/lanes.h"
#include "kernels/vectors.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

HWY_INLINE Doubles all(double x) { return broadcast<kEight>(x); }
HWY_INLINE Vectors all(const double (&v)[3]) { return {all(v[0]), all(v[1]), all(v[2])}; }
HWY_INLINE Vectors loadVectors(const double (&v)[3][8]) {
  return {load<kEight>(v[0]), load<kEight>(v[1]), load<kEight>(v[2])};
}
HWY_INLINE Vectors scaled(const Doubles& s, const Vectors& v) {
  return {s * v.x, s * v.y, s * v.z};
}

HWY_INLINE Vectors rotated(const double (&r)[9], const Vectors& v) {
  return {all(r[0]) * v.x + all(r[1]) * v.y + all(r[2]) * v.z,
          all(r[3]) * v.x + all(r[4]) * v.y + all(r[5]) * v.z,
          all(r[6]) * v.x + all(r[7]) * v.y + all(r[8]) * v.z};
}
HWY_INLINE Vectors turnedBack(const double (&r)[9], const Vectors& v) {
  return {all(r[0]) * v.x + all(r[3]) * v.y + all(r[6]) * v.z,
          all(r[1]) * v.x + all(r[4]) * v.y + all(r[7]) * v.z,
          all(r[2]) * v.x + all(r[5]) * v.y + all(r[8]) * v.z};
}

/// The single box at one end of the span, in the world frame.
struct WorldBox {
  double center[3];
  double half_axis[3][3];
};

HWY_INLINE WorldBox inWorld(const MotionBox& box, const Pose& pose) {
  const double(&r)[9] = pose.rotation;
  WorldBox out;
  for (int k = 0; k < 3; ++k) {
    out.center[k] = r[3 * k] * box.center[0] + r[3 * k + 1] * box.center[1] +
                    r[3 * k + 2] * box.center[2] + pose.translation[k];
    for (int i = 0; i < 3; ++i)
      out.half_axis[i][k] =
          box.extent[i] * (r[3 * k] * box.axis[i][0] + r[3 * k + 1] * box.axis[i][1] +
                           r[3 * k + 2] * box.axis[i][2]);
  }
  return out;
}

/// Boxes along a direction: b's center minus a's center, and the sum of both reaches.
struct Projection {
  Doubles between, reach;
};

HWY_INLINE Projection project(const WorldBox& a, const MotionBoxes& b, const Pose& pose_b,
                              const Vectors& d) {
  const Vectors body = turnedBack(pose_b.rotation, d);
  const Vectors from = all(pose_b.translation) - all(a.center);
  Projection out{dot(body, loadVectors(b.center)) + dot(d, from), all(0)};
  for (int i = 0; i < 3; ++i)
    out.reach =
        out.reach + (abs(dot(d, all(a.half_axis[i]))) +
                     abs(dot(body, loadVectors(b.axis[i]))) * load<kEight>(b.extent[i]));
  return out;
}

/// The parts at the beginning and at the end of the span in which the boxes are apart.
struct Losses {
  Doubles before, after;
  DoubleMask apart;
};

/// Uses the side of b's center at the beginning, and the side at the end.
HWY_INLINE void addLosses(const Projection& p0, const Projection& p1,
                          const Doubles& margin, Losses& losses) {
  const Doubles zero = all(0), reach0 = p0.reach + margin, reach1 = p1.reach + margin;
  const Doubles depth0 = abs(p0.between) - reach0, depth1 = abs(p1.between) - reach1;
  // The gap at the other end along the same side.
  const Doubles other1 =
      select(p0.between < zero, zero - p1.between, p1.between) - reach1;
  const Doubles other0 =
      select(p1.between < zero, zero - p0.between, p0.between) - reach0;
  losses.apart = losses.apart | ((depth0 > zero) & (other1 > zero));
  const Doubles before = depth0 / (depth0 - other1), after = depth1 / (depth1 - other0);
  losses.before =
      max(losses.before, select((depth0 > zero) & (other1 <= zero), before, zero));
  losses.after =
      max(losses.after, select((depth1 > zero) & (other0 <= zero), after, zero));
}

void meetingWindows(const MotionBox (&a)[2], const SpanPoses& pose_a,
                    const MotionBoxes* const (&b)[2], const SpanPoses& pose_b,
                    const double (&margin)[8], const CalmDirection (&calm)[2], int count,
                    MeetingWindows& out) {
  const WorldBox a0 = inWorld(a[0], pose_a.beginning), a1 = inWorld(a[1], pose_a.end);
  const Doubles zero = all(0), one = all(1);
  Doubles margins = load<kEight>(margin);
  Losses losses{zero, zero, zero > zero};
  const auto tryDirection = [&](const Vectors& d) HWY_ATTR {
    addLosses(project(a0, *b[0], pose_b.beginning, d), project(a1, *b[1], pose_b.end, d),
              margins, losses);
  };
  const unsigned in_use = (1U << count) - 1;
  const auto left = [&]() HWY_ATTR {
    return in_use & ~bits(losses.apart | (losses.before + losses.after > one));
  };
  const Vectors from =
      scaled(all(0.5), loadVectors(b[0]->center) + loadVectors(b[1]->center));
  double center[3];
  for (int k = 0; k < 3; ++k) center[k] = 0.5 * (a0.center[k] + a1.center[k]);
  const Vectors between = rotated(pose_b.middle.rotation, from) +
                          (all(pose_b.middle.translation) - all(center));
  const Doubles length = squareRoot(dot(between, between));
  tryDirection(scaled(one / max(length, all(0x1p-500)), between));
  out.mask = left();
  for (const CalmDirection& from : calm) {
    if (!from.direction || out.mask == 0) continue;
    margins = load<kEight>(from.margin);
    tryDirection(
        {all(from.direction->x), all(from.direction->y), all(from.direction->z)});
    out.mask = left();
  }
  margins = load<kEight>(margin);
  for (int i = 0; i < 3 && out.mask != 0; ++i) {
    const Vectors axis = all(a[0].axis[i]);
    tryDirection(rotated(pose_a.middle.rotation, axis));
    out.mask = left();
  }
  for (int i = 0; i < 3 && out.mask != 0; ++i) {
    tryDirection(rotated(pose_b.middle.rotation, loadVectors(b[0]->axis[i])));
    out.mask = left();
  }
  store(losses.before, out.lo);
  store(one - losses.after, out.hi);
}

#if defined(FCL_CCD_USE_HIGHWAY)
extern const MotionKernels kMotionKernels = {hwy::TargetName(HWY_TARGET),
                                             &meetingWindows};
#else
extern const MotionKernels kMotionKernels = {"plain", &meetingWindows};
#endif

const MotionKernels* motionTable() { return &kMotionKernels; }

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#if !defined(FCL_CCD_USE_HIGHWAY) || HWY_ONCE
namespace fcl {
namespace detail {
namespace deformable {

#if defined(FCL_CCD_USE_HIGHWAY)
HWY_EXPORT(motionTable);
#endif

const MotionKernels& motionKernels() {
#if defined(FCL_CCD_USE_HIGHWAY)
  static const MotionKernels& best = *HWY_DYNAMIC_DISPATCH(motionTable)();
  return best;
#else
  return HWY_NAMESPACE::kMotionKernels;
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
#endif

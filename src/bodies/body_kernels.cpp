// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes that turn against each other, eight pairs at once.
#include "shapes/body_boxes.h"

#include <cassert>
#include <cmath>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/body_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "kernels/lanes.h"
#include "kernels/vectors.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

FCL_CCD_INLINE Vectors turnedBack(const double (&r)[9], const Vectors& v) {
  return {all(r[0]) * v.x + all(r[3]) * v.y + all(r[6]) * v.z,
          all(r[1]) * v.x + all(r[4]) * v.y + all(r[7]) * v.z,
          all(r[2]) * v.x + all(r[5]) * v.y + all(r[8]) * v.z};
}

/// The single box at one end of the span, in the world frame.
struct WorldBox {
  double center[3];
  double half_axis[3][3];
};

FCL_CCD_INLINE WorldBox inWorld(const BodyBox& box, const Pose& pose) {
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

/// Boxes along a direction: b's center minus a's center, and the sum of half their
/// widths.
struct Projection {
  Doubles between, half_widths;
};

FCL_CCD_INLINE Projection project(const WorldBox& a, const BodyBoxes& b,
                                  const Pose& pose_b, const Vectors& d) {
  const Vectors body = turnedBack(pose_b.rotation, d);
  const Vectors from = allOf(pose_b.translation) - allOf(a.center);
  Projection out{dot(body, loadVectors(b.center)) + dot(d, from), all(0)};
  for (int i = 0; i < 3; ++i)
    out.half_widths = out.half_widths + (abs(dot(d, allOf(a.half_axis[i]))) +
                                         abs(dot(body, loadVectors(b.axis[i]))) *
                                             load<kEight>(b.extent[i]));
  return out;
}

/// The parts at the beginning and at the end of the span in which the boxes are apart.
struct Losses {
  Doubles before, after;
  DoubleMask apart;
  /// See MeetingWindows::gap.
  Doubles gap;
};

/// The gaps along a direction at the beginning, in the middle and at the end of the span,
/// to the side where b's center is at one of these times.
struct Gaps {
  Doubles first, middle, last;

  FCL_CCD_INLINE Doubles least() const { return min(min(first, middle), last); }
};

FCL_CCD_INLINE Gaps gapsTo(const Doubles& side, const Projection (&p)[3],
                           const Doubles (&half_widths)[3]) {
  const Doubles zero = all(0);
  const DoubleMask is_opposite = side < zero;
  const auto gap = [&](int k) HWY_ATTR {
    return select(is_opposite, zero - p[k].between, p[k].between) - half_widths[k];
  };
  return {gap(0), gap(1), gap(2)};
}

/// The part of the span, from where the first gap is, in which the gap is positive. It is
/// not positive everywhere.
FCL_CCD_INLINE Doubles lossOf(const Doubles& first, const Doubles& middle,
                              const Doubles& last) {
  const Doubles zero = all(0), half = all(0.5);
  const DoubleMask past_middle = middle > zero;
  const Doubles from = select(past_middle, middle, first),
                to = select(past_middle, last, middle);
  return select(past_middle, half, zero) + half * (from / (from - to));
}

/// Whether none of the numbers of pairs is negative. For assertions.
[[maybe_unused]] inline bool areNotNegative(const double (&x)[8], int count) {
  for (int i = 0; i < count; ++i)
    if (x[i] < 0) return false;
  return true;
}

/// Uses the side of b's center at the beginning, and the side at the end.
template <bool kMeasuresGaps>
FCL_CCD_INLINE void addLosses(const Projection (&p)[3], const Doubles& margin,
                              Losses& losses) {
  const Doubles zero = all(0);
  const Doubles half_widths[3] = {p[0].half_widths + margin, p[1].half_widths + margin,
                                  p[2].half_widths + margin};
  const Gaps from = gapsTo(p[0].between, p, half_widths),
             to = gapsTo(p[2].between, p, half_widths);
  const DoubleMask starts_apart = from.first > zero, ends_apart = to.last > zero,
                   apart = starts_apart & (from.middle > zero) & (from.last > zero);
  losses.apart = losses.apart | apart;
  losses.before =
      max(losses.before,
          select(starts_apart, lossOf(from.first, from.middle, from.last), zero));
  losses.after =
      max(losses.after, select(ends_apart, lossOf(to.last, to.middle, to.first), zero));
  if (kMeasuresGaps) losses.gap = max(losses.gap, max(from.least(), to.least()));
}

template <bool kMeasuresGaps>
void meetingWindows(const BodyBox* const (&a)[3], const SpanPoses& pose_a,
                    const BodyBoxes* const (&b)[3], const SpanPoses& pose_b,
                    const double (&margin)[8], const CalmDirection (&calm)[2], int count,
                    MeetingWindows& out) {
  assert(0 < count && count <= BodyBoxes::kWidth && areNotNegative(margin, count));
  const WorldBox a0 = inWorld(*a[0], pose_a.beginning),
                 am = inWorld(*a[1], pose_a.middle), a1 = inWorld(*a[2], pose_a.end);
  const Doubles zero = all(0), one = all(1);
  Doubles margins = load<kEight>(margin);
  Losses losses{zero, zero, zero > zero, all(-HUGE_VAL)};
  const auto tryDirection = [&](const Vectors& d) HWY_ATTR {
    addLosses<kMeasuresGaps>(
        {project(a0, *b[0], pose_b.beginning, d), project(am, *b[1], pose_b.middle, d),
         project(a1, *b[2], pose_b.end, d)},
        margins, losses);
  };
  const unsigned in_use = (1U << count) - 1;
  const auto left = [&]() HWY_ATTR {
    return in_use & ~bits(losses.apart | (losses.before + losses.after > one));
  };
  const Vectors between = product(pose_b.middle.rotation, loadVectors(b[1]->center)) +
                          (allOf(pose_b.middle.translation) - allOf(am.center));
  const Doubles length = squareRoot(dot(between, between));
  tryDirection((one / max(length, all(0x1p-500))) * between);
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
    const Vectors axis = allOf(a[0]->axis[i]);
    tryDirection(product(pose_a.middle.rotation, axis));
    out.mask = left();
  }
  for (int i = 0; i < 3 && out.mask != 0; ++i) {
    tryDirection(product(pose_b.middle.rotation, loadVectors(b[0]->axis[i])));
    out.mask = left();
  }
  store(losses.before, out.lo);
  store(one - losses.after, out.hi);
  if (kMeasuresGaps) store(losses.gap, out.gap);
  assert(out.areInSpan(count) && out.areOrdered());
  // A gap at all three times is one in the whole span.
  assert(!kMeasuresGaps || out.haveNoGap());
}

/// Corners at the beginning, in the middle and at the end of a span.
struct SpanCorners {
  Vectors corner[3][3];
};

FCL_CCD_INLINE SpanCorners inWorld(const BodyTriangles& b, const double* times,
                                   const SpanPoses& poses) {
  const Pose* const pose[3] = {&poses.beginning, &poses.middle, &poses.end};
  SpanCorners out;
  for (int at = 0; at < 3; ++at)
    for (int i = 0; i < 3; ++i) {
      Vectors x = loadVectors(b.corner[0][i]);
      if (times)
        x = all(1 - times[at]) * x + all(times[at]) * loadVectors(b.corner[1][i]);
      out.corner[at][i] = product(pose[at]->rotation, x) + allOf(pose[at]->translation);
    }
  return out;
}

/// The pairs of triangles that are provably apart in each half of the span.
struct ApartHalves {
  DoubleMask half[2];
};

/// Whether the gaps of all pairs of corners stay above 0 during a half. With the gaps g0
/// and g1 at its ends, g0 (1 - s) + g1 s - 4 D s (1 - s) > 0 for all s in [0, 1] if
/// sqrt(g0) + sqrt(g1) > 2 sqrt(D). Without roots: 2 sqrt(g0 g1) > 4 D - g0 - g1.
FCL_CCD_INLINE DoubleMask areApart(const Doubles (&a0)[3], const Doubles (&a1)[3],
                                   const Doubles (&b0)[3], const Doubles (&b1)[3],
                                   const Doubles& four_deviations) {
  // More than the rounding of both sides.
  const Doubles zero = all(0), four = all(4 * (1 - 0x1p-40));
  DoubleMask apart = zero >= zero;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Doubles g0 = b0[j] - a0[i], g1 = b1[j] - a1[i],
                    lack = four_deviations - (g0 + g1);
      apart = apart & (g0 > zero) & (g1 > zero) &
              ((lack < zero) | (four * (g0 * g1) > lack * lack));
    }
  return apart;
}

/// Tries a direction, or its opposite, whichever parts the triangles more in the middle.
FCL_CCD_INLINE void addApart(const SpanTriangle& a, const SpanCorners& b, Vectors d,
                             const Doubles& four_deviations, double margin,
                             unsigned tested, ApartHalves& apart) {
  const Doubles zero = all(0);
  Doubles of_a[3][3], of_b[3][3];
  for (int i = 0; i < 3; ++i) {
    of_a[1][i] = dot(d, allOf(a.corner[1][i]));
    of_b[1][i] = dot(d, b.corner[1][i]);
  }
  const auto least = [](const Doubles(&x)[3])
                         HWY_ATTR { return min(min(x[0], x[1]), x[2]); };
  const auto most = [](const Doubles(&x)[3])
                        HWY_ATTR { return max(max(x[0], x[1]), x[2]); };
  // The least gaps in the middle, as areApart() rounds them.
  const Doubles along = least(of_b[1]) - (most(of_a[1]) + all(margin)),
                against =
                    (zero - most(of_b[1])) - ((zero - least(of_a[1])) + all(margin));
  const DoubleMask is_opposite = against > along;
  if ((bits((along > zero) | (against > zero)) & tested) == 0) return;
  const auto turned = [&](const Doubles& x)
                          HWY_ATTR { return select(is_opposite, zero - x, x); };
  d = {turned(d.x), turned(d.y), turned(d.z)};
  // The margin belongs to a.
  for (int i = 0; i < 3; ++i) {
    of_a[1][i] = turned(of_a[1][i]) + all(margin);
    of_b[1][i] = turned(of_b[1][i]);
    for (int at = 0; at < 3; at += 2) {
      of_a[at][i] = dot(d, allOf(a.corner[at][i])) + all(margin);
      of_b[at][i] = dot(d, b.corner[at][i]);
    }
  }
  for (int half = 0; half < 2; ++half)
    apart.half[half] = apart.half[half] | areApart(of_a[half], of_a[half + 1], of_b[half],
                                                   of_b[half + 1], four_deviations);
}

FCL_CCD_INLINE Vectors unit(const Vectors& v) {
  return (all(1) / max(squareRoot(dot(v, v)), all(0x1p-500))) * v;
}

void meetingHalves(const SpanTriangle& a, const BodyTriangles& b, const double* times,
                   const SpanPoses& pose_b, const double (&deviation)[8], double margin,
                   unsigned tested, unsigned (&meeting)[2]) {
  assert(!(margin < 0) && areNotNegative(deviation, BodyBoxes::kWidth));
  const SpanCorners corners = inWorld(b, times, pose_b);
  const Doubles four_deviations = all(4) * load<kEight>(deviation), zero = all(0);
  ApartHalves apart{{zero > zero, zero > zero}};
  const auto isDecided = [&](const Vectors& d) HWY_ATTR {
    addApart(a, corners, unit(d), four_deviations, margin, tested, apart);
    for (int half = 0; half < 2; ++half) meeting[half] = tested & ~bits(apart.half[half]);
    return (meeting[0] | meeting[1]) == 0;
  };
  const Vectors middle[2][3] = {
      {allOf(a.corner[1][0]), allOf(a.corner[1][1]), allOf(a.corner[1][2])},
      {corners.corner[1][0], corners.corner[1][1], corners.corner[1][2]}};
  Vectors normal[2];
  for (int body = 0; body < 2; ++body) {
    const Vectors(&x)[3] = middle[body];
    normal[body] = cross(x[1] - x[0], x[2] - x[0]);
    if (isDecided(normal[body])) return;
  }
  for (int body = 0; body < 2; ++body)
    for (int i = 0; i < 3; ++i)
      if (isDecided(cross(normal[body], middle[body][(i + 1) % 3] - middle[body][i])))
        return;
}

#if defined(FCL_CCD_USE_HIGHWAY)
extern const BodyKernels kBodyKernels = {hwy::TargetName(HWY_TARGET),
                                         &meetingWindows<false>, &meetingWindows<true>,
                                         &meetingHalves};
#else
extern const BodyKernels kBodyKernels = {"plain", &meetingWindows<false>,
                                         &meetingWindows<true>, &meetingHalves};
#endif

const BodyKernels* bodyTable() { return &kBodyKernels; }

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
HWY_EXPORT(bodyTable);
#endif

const BodyKernels& bodyKernels() {
#if defined(FCL_CCD_USE_HIGHWAY)
  static const BodyKernels& best = *HWY_DYNAMIC_DISPATCH(bodyTable)();
  return best;
#else
  return HWY_NAMESPACE::kBodyKernels;
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/moving_bounds.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// More than the rounding of a time, a quotient of sums of doubles.
constexpr double kBoxTimeMargin = 0x1p-48;

/// The box at time i of n + 1 equally spaced times.
HalfAxisBox boxAt(const MovingBounds& bounds, int i, int n) {
  if (bounds.num_spans == n) return bounds.boxes[i];
  const int spans = bounds.num_spans, span = i * spans / n, rest = i * spans % n;
  HalfAxisBox box = bounds.boxes[span];
  if (rest == 0) return box;
  const double part = double(rest) / n;
  for (int j = 0; j < HalfAxisBox::kSides; ++j) {
    const double to = bounds.boxes[span + 1].half[j];
    // Ends that are equal may be infinite, and have no difference then.
    if (box.half[j] != to) box.half[j] += (to - box.half[j]) * part;
  }
  return box;
}

/// The window in a span between two boxes of each object, as fractions of the span.
MeetingWindow spanWindow(const HalfAxisBox& a0, const HalfAxisBox& a1,
                         const HalfAxisBox& b0, const HalfAxisBox& b1, double distance) {
  MeetingWindow window{0, 1};
  for (int j = 0; j < HalfAxisBox::kSides; ++j) {
    const int k = HalfAxisBox::opposite(j);
    const double s0 = a0.half[j] + b0.half[k] + distance,
                 s1 = a1.half[j] + b1.half[k] + distance;
    if (s0 >= 0 && s1 >= 0) continue;
    if (s0 < 0 && s1 < 0) return {1, 0};
    const double change = s0 - s1;
    if (!(std::abs(change) <= DBL_MAX)) continue;  // no quotient
    const double t = s0 / change;
    if (s0 < 0)
      window.lo = std::max(window.lo, t - kBoxTimeMargin);
    else
      window.hi = std::min(window.hi, t + kBoxTimeMargin);
  }
  return window;
}

}  // namespace

MeetingWindow meetingWindow(const MovingBounds& a, const MovingBounds& b,
                            double distance) {
  const int n = std::max(a.num_spans, b.num_spans);
  assert(n % a.num_spans == 0 && n % b.num_spans == 0);
  MeetingWindow whole{1, 0};
  bool is_first = true;
  HalfAxisBox a0 = boxAt(a, 0, n), b0 = boxAt(b, 0, n);
  for (int i = 0; i < n; ++i) {
    const HalfAxisBox a1 = boxAt(a, i + 1, n), b1 = boxAt(b, i + 1, n);
    const MeetingWindow part = spanWindow(a0, a1, b0, b1, distance);
    a0 = a1;
    b0 = b1;
    if (part.isEmpty()) continue;
    // n is a power of two: these quotients and sums round by 2^-53.
    if (is_first) whole.lo = std::max(0., (i + part.lo) / n - kBoxTimeMargin);
    whole.hi = std::min(1., (i + part.hi) / n + kBoxTimeMargin);
    is_first = false;
  }
  return whole;
}

LinearBox linearBox(const MovingBounds& bounds) {
  const int n = bounds.num_spans;
  LinearBox out;
  for (int j = 0; j < HalfAxisBox::kSides; ++j) {
    const double from = bounds.boxes[0].half[j], to = bounds.boxes[n].half[j];
    double above = 0;
    for (int i = 1; i < n; ++i) {
      const double part = double(i) / n;
      above = std::max(above, bounds.boxes[i].half[j] - ((1 - part) * from + part * to));
    }
    // The sums of doubles above round by far less than roundUp() adds, 2^-22 of the
    // result, or of the padding below.
    const auto pad = static_cast<float>((std::abs(from) + std::abs(to)) * 0x1p-48);
    float* const side = out.axis[j % 3] + (j < 3 ? 0 : 2);
    side[0] = roundUp(from + above, std::isfinite(pad) ? pad : 0);
    side[1] = roundUp(to + above, std::isfinite(pad) ? pad : 0);
  }
  return out;
}

LinearQuery::LinearQuery(double reach, double last)
    : distance(reach > 0 ? roundUp(reach * (1 + 0x1p-18), 0) : 0),
      latest(roundUp(last, 0)) {}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

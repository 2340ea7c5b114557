// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/moving_bounds.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>

#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// More than the rounding of a time, a quotient of sums of doubles.
constexpr double kBoxTimeMargin = 0x1p-48;

/// The box at time i of n + 1 equally spaced times.
HalfAxisBox boxAt(const MovingBounds& bounds, int i, int n) {
  assert(0 <= i && i <= n && n % bounds.num_spans == 0);
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

/// Cuts a window, in fractions of a span, to the part in which a depth is not negative.
/// It is linear, with these values at both ends.
void cut(double s0, double s1, MeetingWindow& window) {
  if (!(s0 < 0) && !(s1 < 0)) return;
  if (s0 < 0 && s1 < 0) {
    window = {1, 0};
    return;
  }
  const double change = s0 - s1;
  if (!(std::abs(change) <= DBL_MAX)) return;  // no quotient
  const double t = s0 / change;
  assert(0 <= t && t <= 1);
  if (s0 < 0)
    window.lo = std::max(window.lo, t - kBoxTimeMargin);
  else
    window.hi = std::min(window.hi, t + kBoxTimeMargin);
}

/// The window in a span between two boxes of each object, as fractions of the span.
MeetingWindow spanWindow(const HalfAxisBox& a0, const HalfAxisBox& a1,
                         const HalfAxisBox& b0, const HalfAxisBox& b1, double distance) {
  MeetingWindow window{0, 1};
  for (int j = 0; j < HalfAxisBox::kSides && !window.isEmpty(); ++j) {
    const int k = HalfAxisBox::opposite(j);
    cut(a0.half[j] + b0.half[k] + distance, a1.half[j] + b1.half[k] + distance, window);
  }
  return window;
}

/// The boxes of an object and the knots of a flat at both ends of a span of the length
/// dt.
struct FlatSpan {
  HalfAxisBox box[2];
  MovingFlat::Knot knot[2];
  double dt;
};

/// The heights of the points of a box above a flat.
struct Heights {
  double least, most;
};

Heights heightsOf(const HalfAxisBox& box, const MovingFlat& flat,
                  const MovingFlat::Knot& knot) {
  Heights out{-knot.offset, -knot.offset};
  for (int k = 0; k < 3; ++k) {
    const double n = knot.normal[k], lower = -box.half[k] - flat.pivot[k],
                 upper = box.half[k + 3] - flat.pivot[k];
    if (n == 0) continue;  // the bounds may be infinite
    out.least += n * (n > 0 ? lower : upper);
    out.most += n * (n > 0 ? upper : lower);
  }
  return out;
}

/// Bound on the distance of the points of both boxes from the pivot. Those in between are
/// not further.
double farthestOf(const FlatSpan& span, const MovingFlat& flat) {
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    double most = 0;
    for (const HalfAxisBox& box : span.box)
      most = std::max({most, std::abs(-box.half[k] - flat.pivot[k]),
                       std::abs(box.half[k + 3] - flat.pivot[k])});
    square += most * most;
  }
  return std::sqrt(square) * kUpward;
}

/// Bound on the speed of points at fixed shares of the sides of the box that moves.
double speedOf(const FlatSpan& span) {
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    double most = 0;
    for (const int j : {k, k + 3}) {
      const double from = span.box[0].half[j], to = span.box[1].half[j];
      // Ends that are equal may be infinite, and have no difference then.
      if (from != to) most = std::max(most, std::abs(to - from));
    }
    square += most * most;
  }
  assert(0 < span.dt && span.dt <= 1);
  return std::sqrt(square) / span.dt * kUpward;
}

/// Cuts the window of a span to the part in which a box may be within a distance of a
/// flat. A point at fixed shares of the sides of the box moves straight. So its height is
/// at least the line between the heights at both ends, less M dt^2 / 8, where M bounds
/// the second derivative: and this holds for the least height of all points, and likewise
/// for the greatest. Bounds that are infinite or NaN do not cut.
void cut(const FlatSpan& span, const MovingFlat& flat, double distance,
         MeetingWindow& window) {
  assert(!(flat.stretch < 0) && !(flat.room < 0) && !(flat.room_per_distance < 0));
  assert(!(flat.bend < 0) && !(flat.bend_per_distance < 0) && !(flat.bend_per_speed < 0));
  const double farthest = farthestOf(span, flat);
  // A distance counts by up to 2^-30 more in a query.
  double room = flat.stretch * distance * (1 + 0x1p-28) + flat.room +
                flat.room_per_distance * farthest;
  if (!flat.goesStraight())
    room += 0.125 * span.dt * span.dt * kUpward *
            (flat.bend + flat.bend_per_distance * farthest +
             flat.bend_per_speed * speedOf(span));
  assert(!(room < 0));
  const Heights at_0 = heightsOf(span.box[0], flat, span.knot[0]),
                at_1 = heightsOf(span.box[1], flat, span.knot[1]);
  cut(room - at_0.least, room - at_1.least, window);
  if (!flat.is_solid && !window.isEmpty())
    cut(room + at_0.most, room + at_1.most, window);
}

/// The flat that bounds a pair; null: none. Two flats do not bound each other.
const MovingFlat* flatOf(const MovingBounds& a, const MovingBounds& b) {
  if (a.flat && b.flat) return nullptr;
  return a.flat ? a.flat : b.flat;
}

}  // namespace

MeetingWindow meetingWindow(const MovingBounds& a, const MovingBounds& b,
                            double distance) {
  const MovingFlat* const flat = flatOf(a, b);
  const int n = std::max({a.num_spans, b.num_spans, flat ? flat->numSpans() : 1});
  assert(n % a.num_spans == 0 && n % b.num_spans == 0 && (n & (n - 1)) == 0);
  assert(distance >= 0);
  MeetingWindow whole{1, 0};
  bool is_first = true;
  HalfAxisBox a0 = boxAt(a, 0, n), b0 = boxAt(b, 0, n);
  for (int i = 0; i < n; ++i) {
    const HalfAxisBox a1 = boxAt(a, i + 1, n), b1 = boxAt(b, i + 1, n);
    MeetingWindow part = spanWindow(a0, a1, b0, b1, distance);
    if (flat && !part.isEmpty()) {
      const bool is_a = flat == a.flat;
      cut({{is_a ? b0 : a0, is_a ? b1 : a1},
           {flat->knotAt(i, n), flat->knotAt(i + 1, n)},
           1. / n},
          *flat, distance, part);
    }
    a0 = a1;
    b0 = b1;
    if (part.isEmpty()) continue;
    assert(0 <= part.lo && part.hi <= 1);
    // n is a power of two: these quotients and sums round by 2^-53.
    if (is_first) whole.lo = std::max(0., (i + part.lo) / n - kBoxTimeMargin);
    whole.hi = std::min(1., (i + part.hi) / n + kBoxTimeMargin);
    assert(0 <= whole.lo && whole.lo <= whole.hi && whole.hi <= 1);
    is_first = false;
  }
  assert(is_first == whole.isEmpty());
  return whole;
}

#ifndef NDEBUG

namespace {

/// Whether a side of a linear box is not inside of that of a box at any time.
bool containsSide(const float (&ends)[2], const MovingBounds& bounds, int j) {
  for (int i = 0; i <= bounds.num_spans; ++i) {
    const double part = double(i) / bounds.num_spans,
                 at = (1 - part) * double{ends[0]} + part * double{ends[1]};
    if (at < bounds.boxes[i].half[j]) return false;
  }
  return true;
}

}  // namespace

#endif

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
    assert(containsSide({side[0], side[1]}, bounds, j));
  }
  return out;
}

bool mayMeet(const LinearBox& box, const MovingFlat& flat, const LinearQuery& query) {
  HalfAxisBox ends[2];
  for (int k = 0; k < 3; ++k)
    for (int end = 0; end < 2; ++end) {
      ends[end].half[k] = double{box.axis[k][end]};
      ends[end].half[k + 3] = double{box.axis[k][2 + end]};
    }
  const MovingBounds bounds{ends, 1};
  const int n = flat.numSpans();
  FlatSpan span;
  span.dt = 1. / n;
  span.box[1] = ends[0];
  span.knot[1] = flat.knotAt(0, n);
  for (int i = 0; i < n && double(i) / n <= double{query.latest}; ++i) {
    span.box[0] = span.box[1];
    span.knot[0] = span.knot[1];
    span.box[1] = boxAt(bounds, i + 1, n);
    span.knot[1] = flat.knotAt(i + 1, n);
    MeetingWindow part{0, 1};
    cut(span, flat, double{query.distance}, part);
    if (!part.isEmpty()) return true;
  }
  return false;
}

LinearQuery::LinearQuery(double wanted, double last)
    : distance(wanted > 0 ? roundUp(wanted * (1 + 0x1p-18), 0) : 0),
      latest(roundUp(last, 0)) {
  assert(wanted >= 0 && double{distance} >= wanted && double{latest} >= last);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

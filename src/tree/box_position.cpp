// SPDX-License-Identifier: BSD-3-Clause
#include "tree/box_position.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <limits>

#include "base/short_vector.h"
#include "tree/float4.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// roundUp() of four numbers.
Float4 roundUp(Double2 a, Double2 b, float pad) {
  const Double2 least = {double{kLeastHalf}, double{kLeastHalf}};
  const auto narrowed = [&least](Double2 x) {
    return roundedToFloats(least > x ? least : x);
  };
  const Float4 f = shuffle<0, 1, 2, 3>(narrowed(a), narrowed(b));
  const Float4 up = f + (larger(f, -f) * kOutward + (pad + FLT_MIN));
  return up == up ? up : Float4{} + std::numeric_limits<float>::infinity();
}

}  // namespace

void fitPoint(const double* point, const double (&origin)[3], float pad, Kdop16& out) {
  // The pad is NaN where the point is.
  assert(!(pad < 0));
  double d[8];
  kdopCoordinates({point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]}, d);
  for (int j = 0; j < 8; j += 4) {
    const Double2 a = {d[j], d[j + 1]}, b = {d[j + 2], d[j + 3]};
    store(roundUp(-a, -b, pad), out.half + j);
    store(roundUp(a, b, pad), out.half + j + 8);
  }
  assert(isOrdered(out) && containsPoint(out, {point[0] - origin[0], point[1] - origin[1],
                                               point[2] - origin[2]}));
}

KdopShift relativeShift(const BoxPosition& a, const BoxPosition& b) {
  assert(a.largest_coordinate >= 0 && b.largest_coordinate >= 0);
  KdopShift shift;
  for (int frame = 0; frame < 2; ++frame) {
    const double(&origin_a)[3] = a.origin[frame], (&origin_b)[3] = b.origin[frame];
    const double(&move_a)[3] = a.translation[frame], (&move_b)[3] = b.translation[frame];
    double offset[3], d[8];
    double size = 0;  // bounds all numbers that enter a moved coordinate
    for (int k = 0; k < 3; ++k) {
      offset[k] = (origin_a[k] - origin_b[k]) + (move_a[k] - move_b[k]);
      size = std::max(size, std::abs(origin_a[k]) + std::abs(origin_b[k]) +
                                std::abs(move_a[k]) + std::abs(move_b[k]));
    }
    kdopCoordinates(offset, d);
    // Three roundings of the offset, one of the diagonal, and one for each posed
    // coordinate. Each is 2^-53 of a number below size: less than 2^-49 in all.
    size = 2 * (size + a.largest_coordinate + b.largest_coordinate);
    const float pad = roundUp(size * 0x1p-49, 0.f);
    Kdop16& out = frame == 0 ? shift.t0 : shift.t1;
    for (int j = 0; j < 8; ++j) {
      out.half[j] = roundUp(-d[j], pad);
      out.half[j + 8] = roundUp(d[j], pad);
    }
    assert(isOrdered(out) && containsPoint(out, offset));
  }
  return shift;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

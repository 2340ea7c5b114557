// SPDX-License-Identifier: BSD-3-Clause
#include "random_boxes.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace fcl {
namespace test {

using detail::deformable::Kdop16;
using detail::deformable::KdopShift;
using detail::deformable::kLeastHalf;
using detail::deformable::MovingKdop;

namespace {

float randomHalf(Random& random, Halves halves) {
  static const float kSpecials[] = {0.f,
                                    -0.f,
                                    1.f,
                                    -1.f,
                                    std::numeric_limits<float>::infinity(),
                                    std::numeric_limits<float>::quiet_NaN(),
                                    FLT_MAX,
                                    -FLT_MAX,
                                    FLT_MIN,
                                    -FLT_MIN,
                                    std::numeric_limits<float>::denorm_min(),
                                    -std::numeric_limits<float>::denorm_min(),
                                    -std::numeric_limits<float>::infinity()};
  switch (halves) {
    case Halves::kOnGrid:
      return static_cast<float>(random.index(12)) - 2;
    case Halves::kSmooth:
      return static_cast<float>(random.uniform(-0.15, 1));
    case Halves::kSpecial:
      // Most are positive; otherwise no pair of boxes would overlap.
      return kSpecials[random.index(4) ? 4 + random.index(3) : random.index(13)];
    case Halves::kAnyBits:
      break;
  }
  std::uint32_t bits = static_cast<std::uint32_t>(random.next());
  if (random.index(8)) bits &= 0x7fffffffU;
  float half;
  std::memcpy(&half, &bits, sizeof(half));
  return half;
}

}  // namespace

MovingKdop randomBox(Random& random, Halves halves, float scale) {
  MovingKdop box;
  const bool still = random.index(4) == 0;
  for (int j = 0; j < 16; ++j) {
    box.t0.half[j] = scale * randomHalf(random, halves);
    box.t1.half[j] = still ? box.t0.half[j] : scale * randomHalf(random, halves);
  }
  return box;
}

Halves randomHalves(Random& random) { return static_cast<Halves>(random.index(4)); }

float randomScale(Random& random) {
  return random.index(2) ? 1.f
                         : std::ldexp(1.f, static_cast<int>(random.index(260)) - 140);
}

void makeBounds(MovingKdop& box) {
  for (Kdop16* frame : {&box.t0, &box.t1})
    for (float& half : frame->half) {
      if (std::isnan(half)) half = std::numeric_limits<float>::infinity();
      half = std::max(half, kLeastHalf) + 0.f;
    }
}

MovingKdop randomBounds(Random& random, Halves halves, float scale) {
  MovingKdop box = randomBox(random, halves, scale);
  makeBounds(box);
  return box;
}

float depthAtStart(const MovingKdop& a, const MovingKdop& b) {
  float least = a.t0.half[0] + b.t0.half[8];
  for (int j = 1; j < 16; ++j) least = std::min(least, a.t0.half[j] + b.t0.half[j ^ 8]);
  return least;
}

bool doOverlapAtStart(const MovingKdop& a, const MovingKdop& b) {
  return depthAtStart(a, b) >= 0;
}

float randomGap(Random& random, float depth) {
  switch (random.index(4)) {
    case 0:
      return std::numeric_limits<float>::infinity();
    case 1:
      return 0;
    case 2:
      return -std::min(depth, 0.f);
    default:
      return -std::min(depth, 0.f) * static_cast<float>(random.uniform(0, 2));
  }
}

MovingKdop shifted(const MovingKdop& original, const KdopShift* shift) {
  MovingKdop box = original;
  if (!shift) return box;
  for (int j = 0; j < 16; ++j) {
    box.t0.half[j] = detail::deformable::shifted(box.t0.half[j], shift->t0.half[j]);
    box.t1.half[j] = detail::deformable::shifted(box.t1.half[j], shift->t1.half[j]);
  }
  return box;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The moving box: a shift does not make it smaller, and no overlap is missed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "mesh/moving_kdop.h"
#include "mesh_generators.h"
#include "tree_checks.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::halfAt;
using test::Random;

// A moved half-axis is not below the sum, and at most a few units of float above it.
TEST(FCL_MOVING_KDOP, shiftedHalvesAreNotBelowTheSum) {
  constexpr std::uint64_t kSeed = 65;
  Random random(kSeed);
  int rounded = 0;
  for (int i = 0; i < 100000; ++i) {
    // Sums of these are exact in doubles.
    const int exponent = static_cast<int>(random.index(230)) - 140;
    const auto number = [&] {
      return std::ldexp(static_cast<float>(random.uniform(-1, 1)),
                        exponent + static_cast<int>(random.index(28)));
    };
    const float half = number(), shift = number();
    const double sum = double{half} + double{shift};
    const auto moved = double{shifted(half, shift)};
    ASSERT_GE(moved, sum) << "seed " << kSeed << ", " << i;
    ASSERT_LE(moved, sum + std::abs(sum) * 0x1p-21 + 0x1p-149);
    rounded += double{half + shift} < sum;
  }
  EXPECT_GT(rounded, 10000);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(shifted(kInf, kLeastHalf), kInf);
  EXPECT_EQ(shifted(kLeastHalf, kLeastHalf), kLeastHalf);
}

/// A box whose bounds are multiples of a power of two, so that the test computes the
/// overlap below exactly.
detail::deformable::MovingKdop gridBox(Random& random, int exponent) {
  detail::deformable::MovingKdop box;
  for (detail::deformable::Kdop16* frame : {&box.t0, &box.t1})
    for (float& half : frame->half)
      half = std::ldexp(static_cast<float>(random.index(2000)) - 700, exponent);
  return box;
}

/// Whether the boxes overlap at t = k / 64.
bool doOverlapAt(const detail::deformable::MovingKdop& a,
                 const detail::deformable::MovingKdop& b, int k) {
  for (int j = 0; j < 16; ++j)
    if (halfAt(a, j, k / 64.) + halfAt(b, (j + 8) % 16, k / 64.) < 0) return false;
  return true;
}

void expectNoMiss(const detail::deformable::MovingKdop& a,
                  const detail::deformable::MovingKdop& b) {
  const detail::deformable::TimeWindow w = overlapWindow<false>(a, b, nullptr);
  for (int k = 0; k <= 64; ++k)
    if (doOverlapAt(a, b, k)) {
      ASSERT_FALSE(w.isEmpty()) << "overlap at " << k << "/64";
      ASSERT_LE(w.lo, k / 64.);
      ASSERT_GE(w.hi, k / 64.);
    }
}

TEST(FCL_MOVING_KDOP, windowNeverMisses) {
  constexpr std::uint64_t kSeed = 43;
  Random random(kSeed);
  int windows = 0;
  for (int i = 0; i < 20000; ++i) {
    const int exponent = static_cast<int>(random.index(200)) - 100;
    detail::deformable::MovingKdop a = gridBox(random, exponent),
                                   b = gridBox(random, exponent);
    // Most directions overlap during the whole step; otherwise nearly no boxes would.
    for (int j = 0; j < 16; ++j)
      if (random.index(4)) {
        a.t0.half[j] = std::abs(a.t0.half[j]) + std::abs(b.t0.half[(j + 8) % 16]);
        a.t1.half[j] = std::abs(a.t1.half[j]) + std::abs(b.t1.half[(j + 8) % 16]);
      }
    ASSERT_NO_FATAL_FAILURE(expectNoMiss(a, b)) << "seed " << kSeed << ", " << i;
    // The window is wider than the exact one by rounding only.
    const detail::deformable::TimeWindow w = overlapWindow<false>(a, b, nullptr);
    if (w.isEmpty()) continue;
    ++windows;
    double lo = 0, hi = 1;
    for (int j = 0; j < 16; ++j) {
      const double s0 = double{a.t0.half[j]} + double{b.t0.half[(j + 8) % 16]},
                   s1 = double{a.t1.half[j]} + double{b.t1.half[(j + 8) % 16]};
      if (s0 < 0) lo = std::max(lo, s0 / (s0 - s1));
      if (s1 < 0) hi = std::min(hi, s0 / (s0 - s1));
    }
    ASSERT_NEAR(w.lo, lo, 1e-6) << "seed " << kSeed << ", " << i;
    ASSERT_NEAR(w.hi, hi, 1e-6) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(windows, 2000);
}

detail::deformable::MovingKdop cube(float x0, float x1, float half) {
  detail::deformable::MovingKdop box;
  std::fill(box.t0.half, box.t0.half + 16, half);
  box.t1 = box.t0;
  box.t0.half[0] = half - x0;
  box.t0.half[8] = half + x0;
  box.t1.half[0] = half - x1;
  box.t1.half[8] = half + x1;
  return box;
}

// Boxes that are unbounded at one end of the step and far apart at the other: they may
// meet in between.
TEST(FCL_MOVING_KDOP, unboundedNeverSeparates) {
  const detail::deformable::MovingKdop rest = cube(0, 0, 1);
  for (int j = 0; j < 16; ++j)
    for (const bool at_t0 : {true, false}) {
      SCOPED_TRACE("half-axis " + std::to_string(j) + (at_t0 ? " at 0" : " at 1"));
      detail::deformable::MovingKdop box = cube(0, 0, 1);
      (at_t0 ? box.t0 : box.t1).half[j] = std::numeric_limits<float>::infinity();
      (at_t0 ? box.t1 : box.t0).half[j] = -99;
      expectNoMiss(box, rest);
      expectNoMiss(rest, box);
    }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

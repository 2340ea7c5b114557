// SPDX-License-Identifier: BSD-3-Clause
//
// A 16-DOP (8 directions, as FCL's KDOP<S, 16>) that moves: one box at t = 0, one at t
// = 1. For vertices on straight paths the box interpolated between the two contains the
// subtree at every t. Tang, Manocha, Tong 2010 bound the whole sweep with one box
// instead.
#ifndef FCL_BV_MOVING_KDOP_H
#define FCL_BV_MOVING_KDOP_H

#include <cfloat>
#include <cmath>

namespace fcl {

/// @brief Half-axis bounds: entries 0-7 are minus the lower, 8-15 the upper bound along
/// x, y, z, x+y, x+z, y+z, x-y, x-z; relative to an origin that its owner knows; rounded
/// outward. A NaN reads as "unbounded".
struct alignas(64) Kdop16 {
  float half[16];
};

/// @brief The box at t = 0 and the box at t = 1.
struct MovingKdop {
  Kdop16 t0;
  Kdop16 t1;
};

/// @brief Part of the step, 0 <= lo <= hi <= 1, in which something can happen; empty when
/// lo > hi.
struct TimeWindow {
  float lo;
  float hi;
  bool isEmpty() const { return lo > hi; }
};

namespace detail {
namespace deformable {

/// @brief The 8 directions applied to a point.
inline void kdopCoordinates(const double (&p)[3], double (&d)[8]) {
  d[0] = p[0];
  d[1] = p[1];
  d[2] = p[2];
  d[3] = p[0] + p[1];
  d[4] = p[0] + p[2];
  d[5] = p[1] + p[2];
  d[6] = p[0] - p[1];
  d[7] = p[0] - p[2];
}

/// Relative outward step for a float made from a double: the conversion loses 2^-24
/// relative, the two operations of roundUp() 2^-24 each; 2^-22 covers them.
constexpr float kOutward = 0x1p-22f;

/// @brief A float not less than value + pad, pad >= 0; FLT_MIN keeps it right where a
/// float would be subnormal.
inline float roundUp(double value, float pad) {
  const auto f = static_cast<float>(value);
  return f + (std::fabs(f) * kOutward + (pad + FLT_MIN));
}

/// @brief What is added to the sum of two boxes whose origins differ.
struct KdopShift {
  Kdop16 t0;
  Kdop16 t1;
};

/// Four floats: compilers turn elementwise operations on it into vector instructions of
/// whatever the target has, without a change in any result.
typedef float Float4 __attribute__((vector_size(16)));

inline Float4 quad(const Kdop16& box, int q) {
  Float4 v;
  __builtin_memcpy(&v, box.half + 4 * q, sizeof(v));
  return v;
}

/// A comparison of two Float4: all bits of a lane, or none.
typedef int Mask4 __attribute__((vector_size(16)));

inline bool isAny(const Mask4& mask) {
#if defined(__SSE__)
  return __builtin_ia32_movmskps(reinterpret_cast<const Float4&>(mask)) != 0;
#else
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
#endif
}

/// @brief When boxes a and b, which move linearly, overlap in all 8 directions. Never
/// misses a time of overlap: the window is rounded outward.
///
/// Along half-axis j, a's bound plus b's opposite bound (halves swapped) is the overlap
/// depth s(t), linear in t; the boxes overlap while all 16 are >= 0. A NaN never
/// separates.
template <bool kShifted>
inline TimeWindow overlapWindow(const MovingKdop& a, const MovingKdop& b,
                                const KdopShift* shift) {
  const Float4 zero = {0.f, 0.f, 0.f, 0.f}, one = {1.f, 1.f, 1.f, 1.f};
  Float4 s0[4], s1[4];
  Mask4 cut = {0, 0, 0, 0};
  for (int q = 0; q < 4; ++q) {
    s0[q] = quad(a.t0, q) + quad(b.t0, q ^ 2);
    s1[q] = quad(a.t1, q) + quad(b.t1, q ^ 2);
    if (kShifted) {
      s0[q] += quad(shift->t0, q);
      s1[q] += quad(shift->t1, q);
    }
    // Negative at both ends: apart for the whole step. Most pairs end here.
    const Mask4 apart_at_0 = s0[q] < zero, apart_at_1 = s1[q] < zero;
    if (isAny(apart_at_0 & apart_at_1)) return {1.f, 0.f};
    cut |= apart_at_0 | apart_at_1;
  }
  // Negative nowhere: the divisions below would find the whole step too.
  if (!isAny(cut)) return {0.f, 1.f};
  // s0 and s1 are correctly rounded, so their signs are right; the quotient, between
  // numbers of opposite sign, is within 3 * 2^-24 relative of the true root.
  constexpr float kDown = 1.f - 0x1p-21f;
  constexpr float kUp = 1.f + 0x1p-21f;
  Float4 lo = zero, hi = one;
  for (int q = 0; q < 4; ++q) {
    const Float4 change = s0[q] - s1[q];
    // Where the difference overflows (or is NaN) the quotient would mean nothing.
    const Mask4 valid = (change <= FLT_MAX) & (change >= -FLT_MAX);
    const Float4 t = s0[q] / change;
    const Float4 enter = ((s0[q] < zero) & valid) ? t * kDown : zero;
    const Float4 leave = ((s1[q] < zero) & valid) ? t * kUp : one;
    lo = enter > lo ? enter : lo;
    hi = leave < hi ? leave : hi;
  }
  const float lo01 = lo[0] > lo[1] ? lo[0] : lo[1], lo23 = lo[2] > lo[3] ? lo[2] : lo[3];
  const float hi01 = hi[0] < hi[1] ? hi[0] : hi[1], hi23 = hi[2] < hi[3] ? hi[2] : hi[3];
  return {lo01 > lo23 ? lo01 : lo23, hi01 < hi23 ? hi01 : hi23};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// The two loops that all pairs on curved paths have in common: steps up to a contact, and
// the search for a time after it at which the contact is proved.
#ifndef FCL_CCD_ADVANCE_ADVANCEMENT_H
#define FCL_CCD_ADVANCE_ADVANCEMENT_H

#include <algorithm>
#include <cassert>
#include <cstdint>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What a query of two bodies counts.
struct AdvanceCounts {
  std::uint64_t box_tests{0};
  std::uint64_t triangle_pairs{0};
  std::uint64_t steps{0};

  AdvanceCounts& operator+=(const AdvanceCounts& other) {
    box_tests += other.box_tests;
    triangle_pairs += other.triangle_pairs;
    steps += other.steps;
    return *this;
  }
};

/// @brief What the advancement of a pair in a span [t, t1] has shown.
enum class AdvanceAnswer {
  kApart,    ///< provably apart in all of [t, t1]
  kContact,  ///< within the tolerance at t; apart before
  kOpen,     ///< provably apart before t, no more steps wanted
  kGivenUp   ///< provably apart before t, no direction that leads on
};

/// @brief Advances a pair from t, step by step, until it is in contact.
/// @param[in,out] t  in: the time at which to start; out: the time that was reached
/// @param t1  the end of the span
/// @param t_stop  stops after the first step that reaches this time
/// @param[in,out] steps  the number of steps left
/// @param look  look(t) is the pair at a time
/// @param isContact  isContact(moment) is whether it is in contact then
/// @param step  step(t, moment) is how long it provably stays apart; negative: unknown
template <typename Look, typename IsContact, typename Step>
AdvanceAnswer advance(double& t, double t1, double t_stop, int& steps,
                      AdvanceCounts& counts, Look&& look, IsContact&& isContact,
                      Step&& step) {
  assert(0 <= t && t <= 1 && t1 <= 1);
  while (true) {
    const auto moment = look(t);
    ++counts.steps;
    if (isContact(moment)) return AdvanceAnswer::kContact;
    if (steps-- <= 0) return AdvanceAnswer::kOpen;
    const double h = step(t, moment);
    if (h >= t1 - t) return AdvanceAnswer::kApart;
    // Rounded down by more than the rounding of the step. The tolerance includes the
    // rounding of the time.
    const double next = t + h * (1 - 0x1p-48);
    if (!(next > t)) return AdvanceAnswer::kGivenUp;
    assert(next <= t1);
    t = next;
    if (t > t_stop) return AdvanceAnswer::kOpen;
  }
}

/// @brief A time in (t, t + width] at which a contact is proved; t if none is found. Each
/// time that is tried is four times as long after t as the one before.
/// @param position_error  the first time is that in which points move by this way
/// @param speed  of the points
/// @param likely  times that are not this long after t are tried last
/// @param isProved  isProved(time)
template <typename IsProved>
double provedTimeAfter(double t, double width, double position_error, double speed,
                       double likely, IsProved&& isProved) {
  constexpr double kFactor = 4;
  assert(0 <= t && t <= 1 && !(position_error < 0) && !(speed < 0));
  const double longest = std::min(width, 1 - t);
  // The loop ends: doubles have fewer than 1100 powers of two.
  for (double h = std::max(position_error / std::max(speed, 0x1p-500), 0x1p-52);;
       h *= kFactor) {
    const double time = std::min(t + std::min(h, longest), 1.);
    if (!(time > t)) return t;
    assert(time <= 1 && time <= t + width);
    if (!(h < std::min(likely, longest)) && isProved(time)) return time;
    if (h < longest) continue;
    return likely > 0 ? provedTimeAfter(t, width, position_error, speed, 0, isProved) : t;
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

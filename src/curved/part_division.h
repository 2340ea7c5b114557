// SPDX-License-Identifier: BSD-3-Clause
//
// How a query of two bodies gets from the whole bodies and the whole step to pairs of
// triangles, shapes and cells in short spans.
#ifndef FCL_CCD_CURVED_PART_DIVISION_H
#define FCL_CCD_CURVED_PART_DIVISION_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include "advance/advancement.h"
#include "base/bits.h"
#include "bodies/part_windows.h"
#include "bodies/part_work.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Divides pairs of parts: their span is halved, or one of them is opened. Boxes
/// tell which of the pairs that come of it may be in contact, and when. Each one is
/// given to `push(work, least)`; with windows that measure gaps the parts are further
/// apart than `least` in the span of the work. For one thread.
class PartDivision {
 public:
  /// @param prefers_long_spans  whether all contacts of shapes are wanted
  PartDivision(PartWindows& windows, bool prefers_long_spans, AdvanceCounts& counts)
      : windows_(windows), prefers_long_spans_(prefers_long_spans), counts_(counts) {}

  /// @brief The distance at which meshes are in contact: smaller parts need no shorter
  /// spans.
  void setApart(double apart) { apart_ = apart; }

  /// @brief Pushes the first half of a span after the second one. Where the last work is
  /// taken first, the first contact that is found is then the first one of its pair.
  void pushFirstHalfLast() { pushes_first_half_last_ = true; }

  static bool isPair(const PartWork& work) {
    return work.a.isTriangle() && work.b.isTriangle();
  }

  /// @brief Tests the pair in its span.
  template <typename Push>
  void testAlone(const PartWork& work, Push&& push) {
    assert(isOrdered(work));
    const int many = windows_.openedAlone();
    const BodyPart &part = many == 1 ? work.b : work.a,
                   &other = many == 1 ? work.a : work.b;
    test(work, many, windows_.alone(many, part), nullptr,
         windows_.partSpan(1 - many, other, work.t0, work.t1), push);
  }

  /// @brief Divides a pair that is no isPair().
  /// @param latest  the latest time that matters
  template <typename Push>
  void divide(PartWork work, double latest, Push&& push) {
    // In the shortest span the deviation is 2^-43 of the acceleration.
    constexpr double kShortest = 0x1p-20, kLeastShare = 0x1p-6, kMuch = 0x1p6;
    assert(!isPair(work));
    const double most_deviation = mostDeviation(work);
    work.t1 = std::min(work.t1, std::max(latest, work.t0));
    assert(isOrdered(work));
    const PartWindows::PartSpan span[2] = {
        windows_.partSpan(0, work.a, work.t0, work.t1),
        windows_.partSpan(1, work.b, work.t0, work.t1)};
    const double radius[2] = {windows_.sizeOf(0, span[0]), windows_.sizeOf(1, span[1])};
    const int opened =
        work.a.isTriangle() || (!work.b.isTriangle() && radius[1] > radius[0]) ? 1 : 0;
    // Small meshes that are within the distance still are in half of the span. Nothing is
    // gained where rounding is larger than both parts.
    const double least = std::max(std::min(radius[0], radius[1]),
                                  kLeastShare * std::max(radius[opened], apart_)),
                 deviation = span[0].deviation + span[1].deviation;
    if (work.t1 - work.t0 > kShortest && least > windows_.rounding() &&
        (work.is_soon_apart || deviation > most_deviation * least)) {
      if (work.is_soon_apart || !(deviation > kMuch * least)) return halve(work, push);
      if (mayPart(work, span)) return halveTiny(work, push);
    }
    const BodyPart& part = opened == 1 ? work.b : work.a;
    assert(!part.isTriangle());
    test(work, opened, windows_.side(opened).reader.open(part), &part, span[1 - opened],
         push);
  }

 private:
  /// Tests the children of one side's part against the other side's part.
  /// @param opened  the side whose children they are
  /// @param part  the part of that side; null: the node is the part itself
  /// @param other  the part of the other side
  template <typename Push>
  void test(const PartWork& work, int opened, const BodyNode& node, const BodyPart* part,
            const PartWindows::PartSpan& other, Push&& push) {
    // A node of an octree may be occupied while none of its children is.
    if (node.count == 0) return;
    assert(0 < node.count && node.count <= BodyBoxes::kWidth);
    counts_.box_tests += static_cast<std::uint64_t>(node.count);
    const double dt = work.t1 - work.t0;
    const MeetingWindows windows = windows_.windows(work, opened, node, part, other);
    assert(windows.mask >> node.count == 0);
    for (unsigned left = windows.mask; left != 0; left &= left - 1) {
      const int lane = lowestBit(left);
      PartWork child = work;
      (opened == 1 ? child.b : child.a) = node.part[lane];
      child.is_soon_apart = (windows.soon_apart >> lane & 1U) != 0;
      child.start = std::max(work.start, work.t0 + windows.lo[lane] * dt);
      const double end = std::min(work.t1, work.t0 + windows.hi[lane] * dt);
      if (child.start > end) continue;
      setSpan(end, child);
      // The span contains the window, and is a part of that of the work.
      assert(isOrdered(child) && end <= child.t1);
      assert(work.t0 <= child.t0 && child.t1 <= work.t1);
      push(child, windows_.measuresGaps() ? windows_.leastDistance(windows, lane) : 0.);
    }
  }

  static bool isOrdered([[maybe_unused]] const PartWork& work) {
    return 0 <= work.t0 && work.t0 <= work.start && work.start <= work.t1 && work.t1 <= 1;
  }

  /// The largest power of two that is at most a quarter of x.
  static double quarterUnit(double x) {
    int exponent;
    std::frexp(x, &exponent);
    return std::ldexp(1., std::max(exponent - 3, -60));
  }

  /// The span of a piece of work: that of its parent, cut to [start, end], with ends that
  /// are dyadic so that poses are used again.
  static void setSpan(double end, PartWork& work) {
    if (isPair(work)) {
      work.t0 = work.start;
      work.t1 = end;
      return;
    }
    const double unit = quarterUnit(end - work.start);
    work.t0 = std::max(work.t0, std::floor(work.start / unit) * unit);
    work.t1 = std::min(work.t1, std::ceil(end / unit) * unit);
  }

  /// How far points may deviate from straight lines, as a share of the radius of a part.
  /// The shares were chosen by the times of queries. A small share means short spans:
  /// boxes are tight, but there are more spans. If the first contact is wanted, tight
  /// boxes pay with shapes, whose directions are compared at both ends of a span only:
  /// fewer pairs may touch before that contact. If all contacts are wanted, each span has
  /// its cost, and a large share is faster.
  ///
  /// Two nodes of meshes have many pairs below them, so a tight box pays more there than
  /// for a triangle and a node.
  double mostDeviation(const PartWork& work) const {
    if (!windows_.side(0).body.shape() && !windows_.side(1).body.shape())
      return work.a.isTriangle() || work.b.isTriangle() ? 0.5 : 0.25;
    return prefers_long_spans_ ? 1 : 0x1p-5;
  }

  /// Whether short spans may show that parts are apart which are tiny beside their
  /// deviations. As many spans would be needed as the square root of that ratio, for each
  /// part again, and a triangle that touches in all of them has a contact in each. Where
  /// the boxes overlap at both ends of the span they do so in shorter spans too: most
  /// likely the parts touch from the beginning, and advancing them shows it at once. Else
  /// spans are halved towards the times at which the parts come near each other. Parts
  /// that stay near each other without a touch get 4,096 spans at most. More would take
  /// longer than to advance a pair, which gives up after 10,000 steps.
  bool mayPart(const PartWork& work, const PartWindows::PartSpan (&span)[2]) {
    constexpr double kShortestOfTiny = 0x1p-12;
    return work.t1 - work.t0 > kShortestOfTiny && !windows_.overlapAtEnds(work, span);
  }

  template <typename Push>
  void halve(const PartWork& work, Push&& push) {
    const auto [first, second] = halvesOf(work);
    if (pushes_first_half_last_) testAlone(second, push);
    if (first.start < first.t1) testAlone(first, push);
    if (!pushes_first_half_last_) testAlone(second, push);
  }

  /// Halves the span of parts that may have very many. Where the order does not matter
  /// the work that was added last comes first: then that is the first half, and what is
  /// found in it may end the second one.
  template <typename Push>
  void halveTiny(const PartWork& work, Push&& push) {
    auto [first, second] = halvesOf(work);
    first.is_one_of_many = second.is_one_of_many = true;
    testAlone(second, push);
    if (first.start < first.t1) testAlone(first, push);
  }

  static std::pair<PartWork, PartWork> halvesOf(const PartWork& work) {
    const double middle = 0.5 * (work.t0 + work.t1);
    assert(work.t0 < middle && middle < work.t1);
    std::pair<PartWork, PartWork> halves(work, work);
    halves.first.t1 = halves.second.t0 = middle;
    halves.second.start = std::max(work.start, middle);
    return halves;
  }

  PartWindows& windows_;
  const bool prefers_long_spans_;
  double apart_{0};
  bool pushes_first_half_last_{false};
  AdvanceCounts& counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Random moving boxes for tests of the kernels, and properties of two of them.
#ifndef FCL_TEST_SUPPORT_RANDOM_BOXES_H
#define FCL_TEST_SUPPORT_RANDOM_BOXES_H

#include "mesh/moving_kdop.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

/// @brief Kinds of half-axes of a box.
enum class Halves { kOnGrid, kSmooth, kSpecial, kAnyBits };

Halves randomHalves(Random& random);
float randomScale(Random& random);

/// @brief A box of one kind, or of several. Many boxes move by little. Half-axes may have
/// any value.
detail::deformable::MovingKdop randomBox(Random& random, Halves halves, float scale);

/// @brief Changes half-axes to values that roundUp() can return: not NaN, minus infinity
/// or minus zero.
void makeBounds(detail::deformable::MovingKdop& box);

/// @brief randomBox() with makeBounds().
detail::deformable::MovingKdop randomBounds(Random& random, Halves halves, float scale);

/// @brief The box moved by a shift; null: not moved.
detail::deformable::MovingKdop shifted(const detail::deformable::MovingKdop& original,
                                       const detail::deformable::KdopShift* shift);

/// @brief The least overlap depth at t = 0.
float depthAtStart(const detail::deformable::MovingKdop& a,
                   const detail::deformable::MovingKdop& b);

/// @brief Whether no half-axis separates the boxes at t = 0.
bool doOverlapAtStart(const detail::deformable::MovingKdop& a,
                      const detail::deformable::MovingKdop& b);

/// @brief A gap that leaves out no boxes, or some or none of the boxes of that depth.
float randomGap(Random& random, float depth);

/// @brief Counts the pairs of boxes that overlap, during the whole step or in a part of
/// it.
struct OverlapTally {
  int overlaps{0}, apart{0}, cut{0};

  void add(bool overlaps_now, const detail::deformable::TimeWindow& window) {
    ++(overlaps_now ? overlaps : apart);
    cut += overlaps_now && (window.lo > 0 || window.hi < 1);
  }
};

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Random moving boxes for tests of the kernels, and what is true of two of them.
#ifndef FCL_TEST_SUPPORT_RANDOM_BOXES_H
#define FCL_TEST_SUPPORT_RANDOM_BOXES_H

#include "mesh/moving_kdop.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {

/// @brief What the half-axes of a box are like.
enum class Halves { kOnGrid, kSmooth, kSpecial, kAnyBits };

Halves randomHalves(Random& random);
float randomScale(Random& random);

/// @brief Boxes of one kind, or of several; many move by little. Half-axes may be
/// anything.
MovingKdop randomBox(Random& random, Halves halves, float scale);

/// @brief Makes half-axes what roundUp() gives: never a NaN, minus infinity or minus
/// zero.
void makeBounds(MovingKdop& box);

/// @brief randomBox() with makeBounds().
MovingKdop randomBounds(Random& random, Halves halves, float scale);

/// @brief The box, moved by a shift that is not null.
MovingKdop shifted(const MovingKdop& original,
                   const detail::deformable::KdopShift* shift);

/// @brief The least overlap depth at t = 0.
float depthAtStart(const MovingKdop& a, const MovingKdop& b);

/// @brief Whether no half-axis separates the boxes at t = 0.
bool doOverlapAtStart(const MovingKdop& a, const MovingKdop& b);

/// @brief A gap that leaves out nothing or, of boxes of that depth, some or none.
float randomGap(Random& random, float depth);

/// @brief How many pairs of boxes overlap, in all of the step or in a part of it.
struct OverlapTally {
  int overlaps{0}, apart{0}, cut{0};

  void add(bool overlaps_now, const TimeWindow& window) {
    ++(overlaps_now ? overlaps : apart);
    cut += overlaps_now && (window.lo > 0 || window.hi < 1);
  }
};

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/moving_flat.h"

#include <cassert>
#include <cstddef>

namespace fcl {
namespace detail {
namespace deformable {

bool MovingFlat::rests() const {
  return goesStraight() && knots.front().offset == knots.back().offset;
}

MovingFlat::Knot MovingFlat::knotAt(int i, int n) const {
  assert(0 <= i && i <= n && numSpans() > 0 && (numSpans() & (numSpans() - 1)) == 0);
  if (numSpans() == n) return knots[static_cast<std::size_t>(i)];
  assert(numSpans() == 1 && goesStraight());
  Knot knot = knots[0];
  knot.offset += (knots[1].offset - knot.offset) * (double(i) / n);
  return knot;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "paths/turning_bounds.h"

#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

double largestValue(const Coefficients& p) {
  if (p.size() < 2) return sizeOf(p);
  const Coefficients slope = derivativeOf(p);
  if (slope.size() == 1)
    return std::max(std::abs(p[0]), std::abs(p[0] + p[1])) * kUpward +
           0x1p-10 * sizeOf(p);
  constexpr int kParts = 32;
  double most = 0;
  for (int i = 0; i < kParts; ++i)
    most = std::max(most, std::abs(valueAt(p, (i + 0.5) / kParts)));
  const double bound =
      most * kUpward + largestValue(slope) * (0.5 / kParts) + 0x1p-10 * sizeOf(p);
  // The ends are not among the places that were looked at.
  assert(!(std::abs(p[0]) > bound) && !(std::abs(valueAt(p, 1)) > bound));
  return bound;
}

DerivativeBounds derivativeBounds(const Coefficients& p) {
  const Coefficients first = derivativeOf(p), second = derivativeOf(first),
                     third = derivativeOf(second);
  return {largestValue(first), largestValue(second), largestValue(third)};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

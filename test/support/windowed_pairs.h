// SPDX-License-Identifier: BSD-3-Clause
//
// VF and EE pairs with a window of time, for tests of kernels that take eight.
#ifndef FCL_TEST_SUPPORT_WINDOWED_PAIRS_H
#define FCL_TEST_SUPPORT_WINDOWED_PAIRS_H

#include <cmath>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

/// @brief A pair and the window in which it is tested.
struct WindowedPair {
  MovingPair pair;
  double lo, hi;
};

/// @brief The whole step, a part of it, or one time.
inline void randomWindow(Random& random, double& lo, double& hi) {
  switch (random.index(6)) {
    case 0:
      lo = 0;
      hi = 1;
      return;
    case 1:
      lo = hi = static_cast<double>(random.index(2));
      return;
    case 2:
      lo = hi = random.uniform(0, 1);
      return;
    case 3:
      lo = 0;
      hi = random.uniform(0, 1);
      return;
    case 4:
      lo = random.uniform(0, 1);
      hi = 1;
      return;
    default:
      lo = random.uniform(0, 1);
      hi = random.uniform(lo, 1);
  }
}

/// @brief A pair with random points. Many of the pairs stay on one side of each other.
inline MovingPair scatteredPair(Random& random, ContinuousContactKind kind) {
  MovingPair pair{kind, {}};
  const double step = random.index(2) ? 0.2 : 1;
  const bool on_grid = random.index(4) == 0;
  for (detail::deformable::VertexPath& x : pair.x)
    for (int k = 0; k < 3; ++k) {
      x.t0[k] = random.uniform(-1, 1);
      x.t1[k] = x.t0[k] + random.uniform(-step, step);
      if (on_grid) {
        x.t0[k] = std::round(2 * x.t0[k]);
        x.t1[k] = std::round(2 * x.t1[k]);
      }
    }
  return pair;
}

/// @brief Multiplies all coordinates.
inline void scale(MovingPair& pair, double factor) {
  for (detail::deformable::VertexPath& x : pair.x)
    for (int k = 0; k < 3; ++k) {
      x.t0[k] *= factor;
      x.t1[k] *= factor;
    }
}

}  // namespace test
}  // namespace fcl

#endif

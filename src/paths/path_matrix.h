// SPDX-License-Identifier: BSD-3-Clause
//
// Rotations of paths and their derivatives, as nine numbers row by row.
#ifndef FCL_CCD_PATHS_PATH_MATRIX_H
#define FCL_CCD_PATHS_PATH_MATRIX_H

#include <cmath>

#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

inline double frobenius(const double (&m)[9]) {
  double sum = 0;
  for (const double x : m) sum += x * x;
  return std::sqrt(sum);
}

/// Columns of [a] m.
inline void crossColumns(const Vec& a, const double (&m)[9], double (&out)[9]) {
  for (int j = 0; j < 3; ++j) {
    const Vec c = cross(a, {m[j], m[3 + j], m[6 + j]});
    out[j] = c.x;
    out[3 + j] = c.y;
    out[6 + j] = c.z;
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Rotations of paths and their derivatives, as nine numbers row by row.
#ifndef FCL_CCD_PATHS_PATH_MATRIX_H
#define FCL_CCD_PATHS_PATH_MATRIX_H

#include <algorithm>
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

/// The largest length of a column: the matrix makes some vector longer by this factor.
/// For assertions.
inline double longestColumn(const double (&m)[9]) {
  double most = 0;
  for (int j = 0; j < 3; ++j)
    most = std::max(most, m[j] * m[j] + m[3 + j] * m[3 + j] + m[6 + j] * m[6 + j]);
  return std::sqrt(most);
}

/// Whether the columns are unit vectors at right angles, up to an error of their
/// products; also of NaN. For assertions.
inline bool isRotation(const double (&m)[9], double error) {
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      const double product = m[i] * m[j] + m[3 + i] * m[3 + j] + m[6 + i] * m[6 + j];
      if (std::abs(product - (i == j)) > error) return false;
    }
  return true;
}

/// out = x y. For rotations each entry rounds by 3 u, the product by 9 u (Frobenius).
inline void multiply(const double (&x)[9], const double (&y)[9], double (&out)[9]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out[3 * i + j] =
          x[3 * i] * y[j] + x[3 * i + 1] * y[3 + j] + x[3 * i + 2] * y[6 + j];
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

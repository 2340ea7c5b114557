// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/nearest_rotation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// X X' of the rows of X.
void multiplyByTransposed(const double (&x)[9], double (&product)[9]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k)
      product[3 * i + k] = product[3 * k + i] =
          x[3 * i] * x[3 * k] + x[3 * i + 1] * x[3 * k + 1] + x[3 * i + 2] * x[3 * k + 2];
}

}  // namespace

double deviationFromRotation(const double (&matrix)[9]) {
  double product[9], deviation = 0;
  multiplyByTransposed(matrix, product);
  for (int i = 0; i < 9; ++i) {
    const double entry = std::abs(product[i] - (i % 4 == 0 ? 1 : 0));
    if (!(entry <= deviation)) deviation = entry;
    if (std::isnan(deviation)) return deviation;
  }
  return deviation;
}

double determinantOf(const double (&r)[9]) {
  return r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
         r[2] * (r[3] * r[7] - r[4] * r[6]);
}

// The iteration of Newton and Schulz, X <- (3 I - X X') X / 2, keeps the factor, since
// each step is a polynomial of R R' times R. Let E = I - X X'. A step turns E into
// (3 E^2 + E^3) / 4, so its norm e becomes at most (3 + e) / 4 e^2. It begins with at
// most 3 * 2^-6 < .047: .0017, 2.2e-6, 3.7e-12, 1.1e-23. The fifth step is for the
// rounding of the others. A step rounds each entry by at most 8 u of 1, so an entry of
// X X' differs from that of I by less than 2 * 3 * 8 u < 2^-47; 2^-49 was the largest of
// a million matrices.
bool toNearestRotation(double (&matrix)[9]) {
  if (!(deviationFromRotation(matrix) <= kMostDeviation) || determinantOf(matrix) <= 0)
    return false;
  constexpr int kSteps = 5;
  for (int step = 0; step < kSteps; ++step) {
    double factor[9], next[9];
    multiplyByTransposed(matrix, factor);
    for (int i = 0; i < 9; ++i) factor[i] = ((i % 4 == 0 ? 3 : 0) - factor[i]) / 2;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        next[3 * i + k] = factor[3 * i] * matrix[k] + factor[3 * i + 1] * matrix[3 + k] +
                          factor[3 * i + 2] * matrix[6 + k];
    std::copy(next, next + 9, matrix);
  }
  assert(deviationFromRotation(matrix) < 0x1p-47);
  return true;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

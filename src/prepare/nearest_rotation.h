// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_NEAREST_ROTATION_H
#define FCL_CCD_PREPARE_NEAREST_ROTATION_H

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Matrices that are no rotations up to this are taken, in the entries of R R' -
/// I.
constexpr double kMostDeviation = 0x1p-6;

/// @brief The largest entry of |R R' - I|: how far the rows are from length 1 and from
/// right angles. NaN if an entry of R is.
double deviationFromRotation(const double (&matrix)[9]);

double determinantOf(const double (&matrix)[9]);

/// @brief Replaces a matrix by the nearest rotation: the orthogonal factor of its polar
/// decomposition, which has the least sum of squared differences. The result is a
/// rotation up to 2^-49, and depends on the matrix only.
/// @return false, with nothing changed: the matrix is further from a rotation than
/// kMostDeviation, mirrors, or is not finite
bool toNearestRotation(double (&matrix)[9]);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

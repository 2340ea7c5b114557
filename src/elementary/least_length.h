// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_LEAST_LENGTH_H
#define FCL_CCD_ELEMENTARY_LEAST_LENGTH_H

namespace fcl {
namespace detail {
namespace deformable {

/// A vector with a smaller square has a length without all of its digits, so that the
/// quotient of both is no unit vector: squares below 2^-1022 are multiples of 2^-1074.
constexpr double kLeastSquare = 0x1p-1000, kLeastLength = 0x1p-500;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

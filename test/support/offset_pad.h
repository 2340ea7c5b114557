// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TEST_OFFSET_PAD_H
#define FCL_CCD_TEST_OFFSET_PAD_H

#include <cfloat>
#include <limits>

#include "mesh/moving_kdop.h"

namespace fcl {
namespace test {

/// @brief The pad with which kernels fit a point that is `size` away from the origin
/// along an axis.
inline float offsetPad(double size) {
  const auto pad = static_cast<float>(size * detail::deformable::kOffsetPad);
  return pad >= FLT_MAX ? std::numeric_limits<float>::infinity() : pad;
}

}  // namespace test
}  // namespace fcl

#endif

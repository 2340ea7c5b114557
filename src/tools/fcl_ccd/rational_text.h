// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RATIONAL_TEXT_H
#define FCL_CCD_RATIONAL_TEXT_H

#include <string_view>

namespace fcl_ccd {

struct NearestDouble {
  double value{0};
  bool exact{false};
};

/// @brief The double nearest to a fraction of two decimal integers (ties to even).
/// @throws std::runtime_error if a text is not an integer, the denominator is 0, or the
/// fraction is beyond double's range.
NearestDouble nearestDouble(std::string_view numerator, std::string_view denominator);

/// @brief The double nearest to a decimal number such as -2.5E+4 (ties to even). The
/// number is the exact value of the text: 0.1 is a tenth, and no double.
/// @throws std::runtime_error if the text is not a number, or not finite, or beyond
/// double's range.
NearestDouble nearestDouble(std::string_view decimal);

}  // namespace fcl_ccd

#endif

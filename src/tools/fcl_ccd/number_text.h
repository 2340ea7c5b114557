// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_NUMBER_TEXT_H
#define FCL_CCD_NUMBER_TEXT_H

#include <cstdio>
#include <string>

namespace fcl_ccd {

/// @brief A double in so many significant digits; 17 of them identify it.
inline std::string numberText(double value, int digits = 17) {
  char text[64];  // sign, 17 digits, point, exponent: at most 24 characters
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_NUMBER_TEXT_H
#define FCL_CCD_NUMBER_TEXT_H

#include <charconv>
#include <string>

namespace fcl_ccd {

/// @brief A double in so many significant digits; 17 of them identify it.
inline std::string numberText(double value, int digits = 17) {
  char text[64];  // sign, 17 digits, point, exponent: at most 24 characters
  // As printf's %.*g, and several times as fast.
  const auto end =
      std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits);
  return {text, end.ptr};
}

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_NUMBER_TEXT_H
#define FCL_CCD_NUMBER_TEXT_H

#include <cassert>
#include <charconv>
#include <string>

namespace fcl_ccd {

/// @brief A double with a given number of significant digits; 17 digits identify it.
inline std::string numberText(double value, int digits = 17) {
  char text[64];  // sign, 17 digits, point, exponent: at most 24 characters
  // The same text as printf's %.*g, but several times as fast.
  const auto end =
      std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits);
  assert(end.ec == std::errc());
  return {text, end.ptr};
}

}  // namespace fcl_ccd

#endif

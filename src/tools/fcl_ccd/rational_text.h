// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RATIONAL_TEXT_H
#define FCL_CCD_RATIONAL_TEXT_H

#include <boost/multiprecision/cpp_int.hpp>
#include <string_view>

namespace fcl_ccd {

/// @brief numerator / denominator, denominator > 0.
struct Rational {
  boost::multiprecision::cpp_int numerator{0};
  boost::multiprecision::cpp_int denominator{1};
};

/// @brief A fraction of two decimal integers of any size.
/// @throws std::runtime_error if a text is not an integer, or the denominator is 0.
Rational parseFraction(std::string_view numerator, std::string_view denominator);

/// @brief The exact value of a decimal number such as -2.5E+4: 0.1 is a tenth, and no
/// double.
/// @throws std::runtime_error if the text is not a number, or not finite, or beyond
/// double's range, or not 0 but below 1e-5000, whose digits would fill memory.
Rational parseDecimal(std::string_view text);

struct NearestDouble {
  double value{0};
  bool exact{false};
};

/// @brief The double nearest to a rational number (ties to even).
/// @throws std::runtime_error if the number is beyond double's range.
NearestDouble nearestDouble(const Rational& number);

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "rational_text.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

#include "text_scan.h"

namespace fcl_ccd {
namespace {

using boost::multiprecision::cpp_int;

/// @brief A decimal integer of any size. (cpp_int's own parser also takes hexadecimal and
/// octal, so that 010 would be 8.)
cpp_int parseBigInteger(std::string_view text) {
  const bool negative = !text.empty() && text[0] == '-';
  std::string_view digits = text.substr(negative || text.substr(0, 1) == "+" ? 1 : 0);
  const bool decimal =
      !digits.empty() && std::all_of(digits.begin(), digits.end(),
                                     [](char c) { return c >= '0' && c <= '9'; });
  if (!decimal) throw std::runtime_error(quoted(text) + " is not an integer");
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size() - 1));
  const cpp_int magnitude{std::string(digits)};
  return negative ? cpp_int(-magnitude) : magnitude;
}

/// @brief Quotient of positive integers, with 55 bits or more. The last bit is set if the
/// division leaves a rest ("sticky"). So to round it once to 53 bits or fewer is to round
/// the exact quotient.
struct ScaledQuotient {
  cpp_int mantissa;
  int exponent;  ///< quotient = mantissa * 2^exponent
  bool exact;
};

ScaledQuotient divide(const cpp_int& numerator, const cpp_int& denominator) {
  assert(numerator > 0 && denominator > 0);
  const int bits = static_cast<int>(msb(numerator)) - static_cast<int>(msb(denominator));
  const int exponent = bits - 56;  // the quotient has 56 or 57 bits before the sticky one
  cpp_int dividend = numerator, divisor = denominator, rest;
  if (exponent < 0)
    dividend <<= -exponent;
  else
    divisor <<= exponent;
  ScaledQuotient quotient{0, exponent - 1, true};
  divide_qr(dividend, divisor, quotient.mantissa, rest);
  quotient.mantissa <<= 1;
  assert(msb(quotient.mantissa) + 1 >= 55);
  quotient.exact = rest == 0;
  if (!quotient.exact) quotient.mantissa |= 1;
  return quotient;
}

/// @brief mantissa * 2^exponent, rounded once, also where the result is subnormal.
NearestDouble round(const ScaledQuotient& quotient) {
  constexpr int kLowestExponent = -1074;  // that of double's smallest subnormal
  constexpr int kDigits = std::numeric_limits<double>::digits;
  const int size = static_cast<int>(msb(quotient.mantissa)) + 1;
  const int drop = std::max(size - kDigits, kLowestExponent - quotient.exponent);
  cpp_int kept = quotient.mantissa;
  bool exact = quotient.exact;
  if (drop > 0) {
    const cpp_int half = cpp_int(1) << (drop - 1);
    const cpp_int rest = quotient.mantissa & ((half << 1) - 1);
    kept = quotient.mantissa >> drop;
    if (rest > half || (rest == half && (kept & 1) != 0)) ++kept;
    exact = exact && rest == 0;
  }
  // kept has at most 53 bits, or is 2^53: the conversion and the scaling are exact.
  assert(kept <= cpp_int(1) << kDigits);
  const double value =
      std::ldexp(kept.convert_to<double>(), quotient.exponent + std::max(drop, 0));
  return {value, exact};
}

/// @brief digits * 10^exponent.
struct Decimal {
  std::string digits;  ///< with a sign, without leading zeros; empty: 0
  long long exponent{0};
};

/// @param text  a decimal number
Decimal split(std::string_view text) {
  Decimal decimal;
  std::string sign;
  bool is_fraction = false;
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '+' || c == '-') {
      sign = c == '-' ? "-" : "";
    } else if (c == '.') {
      is_fraction = true;
    } else if (c >= '0' && c <= '9') {
      if (c != '0' || !decimal.digits.empty()) decimal.digits += c;
      if (is_fraction) --decimal.exponent;
    } else {
      break;
    }
  }
  if (decimal.digits.empty()) return {};
  decimal.digits = sign + decimal.digits;
  if (i == text.size()) return decimal;
  // An exponent that does not fit into a long long is as good as this one: no text is so
  // long that its digits make up for it.
  long long exponent = std::numeric_limits<long long>::max() / 2;
  const std::string_view written = text.substr(i + 1);
  if (!parseInteger(written, exponent) && written[0] == '-') exponent = -exponent;
  decimal.exponent += exponent;
  return decimal;
}

}  // namespace

Rational parseFraction(std::string_view numerator, std::string_view denominator) {
  const cpp_int num = parseBigInteger(numerator), den = parseBigInteger(denominator);
  if (den == 0) throw std::runtime_error("the denominator is 0");
  return den < 0 ? Rational{-num, -den} : Rational{num, den};
}

Rational parseDecimal(std::string_view text) {
  switch (classifyNumber(text)) {
    case NumberToken::kFinite:
      break;
    case NumberToken::kNotFinite:
      throw std::runtime_error(quoted(text) + " is not finite, or beyond double's range");
    case NumberToken::kNotANumber:
      throw std::runtime_error(quoted(text) + " is not a number");
  }
  const Decimal decimal = split(text);
  if (decimal.digits.empty()) return {};
  constexpr long long kLowestExponent = -5000;
  if (decimal.exponent + static_cast<long long>(decimal.digits.size()) < kLowestExponent)
    throw std::runtime_error(quoted(text) +
                             " is closer to 0 than 1e-5000. Write 0, or scale all "
                             "coordinates of the query");
  const cpp_int digits = parseBigInteger(decimal.digits),
                scale = boost::multiprecision::pow(
                    cpp_int(10), static_cast<unsigned>(std::abs(decimal.exponent)));
  return decimal.exponent < 0 ? Rational{digits, scale} : Rational{digits * scale, 1};
}

NearestDouble nearestDouble(const Rational& number) {
  if (number.numerator == 0) return {0, true};
  NearestDouble nearest = round(divide(abs(number.numerator), number.denominator));
  if (!std::isfinite(nearest.value))
    throw std::runtime_error("the coordinate is beyond double's range");
  if (number.numerator < 0) nearest.value = -nearest.value;
  return nearest;
}

}  // namespace fcl_ccd

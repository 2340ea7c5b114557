// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TEXT_SCAN_H
#define FCL_CCD_TEXT_SCAN_H

#include <charconv>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace fcl_ccd {

/// @brief Removes the next line from the front of the text and returns it without its
/// end.
/// @return false at the end of the text.
bool takeLine(std::string_view& text, std::string_view& line);

/// @brief Removes the next token, a run of non-blank characters, from the front of the
/// text.
/// @return false if only blanks are left.
bool takeToken(std::string_view& text, std::string_view& token);

/// @brief All tokens of a line.
void splitTokens(std::string_view line, std::vector<std::string_view>& tokens);

/// @brief A word of a text that has no meaning where it stands. Only the last word of a
/// text that another program is writing may become another one.
class BadWord : public std::runtime_error {
 public:
  BadWord(const std::string& what, std::string_view word)
      : std::runtime_error(what), word_(word) {}
  const std::string& word() const { return word_; }

 private:
  std::string word_;
};

/// @brief The result of reading a token as a decimal number.
enum class NumberToken {
  kFinite,
  kNotFinite,  ///< nan, inf, or beyond double's range
  kNotANumber
};

NumberToken classifyNumber(std::string_view token);

/// @brief Whether the token is a decimal integer, with its value.
bool parseInteger(std::string_view token, long long& value);

/// @brief The value of a token, rounded once to the nearest Value (float or double). An
/// exponent may have the letter D of Fortran.
/// @throws BadWord if the token is not a finite number, or too large.
template <typename Value>
Value requireNumber(std::string_view token);
extern template float requireNumber<float>(std::string_view);
extern template double requireNumber<double>(std::string_view);

/// @brief std::from_chars() of a float or double. Where the standard library has none
/// (libc++ before 20), it fails, and requireNumber() has to read the token.
template <typename Value>
std::from_chars_result parseDecimal(const char* begin, const char* end, Value& value) {
#ifdef __cpp_lib_to_chars
  return std::from_chars(begin, end, value);
#else
  static_cast<void>(end);
  static_cast<void>(value);
  return {begin, std::errc::invalid_argument};
#endif
}

/// @brief Runs `read`. If it throws a std::runtime_error, puts "PLACE: " before its
/// message; `place` makes this text.
template <typename Read, typename Place>
auto namingPlace(Place place, Read read) {
  try {
    return read();
  } catch (const BadWord& error) {
    throw BadWord(place() + ": " + error.what(), error.word());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(place() + ": " + error.what());
  }
}

/// @brief A token for a message: quoted, cut, without control characters.
std::string quoted(std::string_view token);

}  // namespace fcl_ccd

#endif

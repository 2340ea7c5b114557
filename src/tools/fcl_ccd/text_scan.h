// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TEXT_SCAN_H
#define FCL_CCD_TEXT_SCAN_H

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
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

/// @brief The result of reading a token as a decimal number.
enum class NumberToken {
  kFinite,
  kNotFinite,  ///< nan, inf, or beyond double's range
  kNotANumber
};

NumberToken classifyNumber(std::string_view token);

/// @brief Whether the token is a decimal integer, with its value.
bool parseInteger(std::string_view token, long long& value);

/// @brief Throws std::runtime_error if the token is not a finite number.
void requireFinite(std::string_view token);

/// @brief Runs `read`. If it throws a std::runtime_error, puts "PLACE: " before its
/// message; `place` makes this text.
template <typename Read, typename Place>
auto namingPlace(Place place, Read read) {
  try {
    return read();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(place() + ": " + error.what());
  }
}

/// @brief A token for a message: quoted, cut, without control characters.
std::string quoted(std::string_view token);

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TEXT_SCAN_H
#define FCL_CCD_TEXT_SCAN_H

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_ccd {

/// @brief Takes the next line, without its end, off the front of the text.
/// @return false at the end of the text.
bool takeLine(std::string_view& text, std::string_view& line);

/// @brief Takes the next run of non-blank characters off the front of the text.
/// @return false when only blanks are left.
bool takeToken(std::string_view& text, std::string_view& token);

/// @brief All tokens of a line.
void splitTokens(std::string_view line, std::vector<std::string_view>& tokens);

/// @brief What a token says when it is read as a decimal number.
enum class NumberToken {
  kFinite,
  kNotFinite,  ///< nan, inf, or beyond double's range
  kNotANumber
};

NumberToken classifyNumber(std::string_view token);

/// @brief Whether the token is a decimal integer, with its value.
bool parseInteger(std::string_view token, long long& value);

/// @brief Throws std::runtime_error unless the token is a finite number.
void requireFinite(std::string_view token);

/// @brief Runs `read` and puts "PLACE: " before the message of a std::runtime_error that
/// it throws; `place` makes that text.
template <typename Read, typename Place>
auto namingPlace(Place place, Read read) {
  try {
    return read();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(place() + ": " + error.what());
  }
}

/// @brief A token as it can be shown in a message: quoted, cut, without control
/// characters.
std::string quoted(std::string_view token);

}  // namespace fcl_ccd

#endif

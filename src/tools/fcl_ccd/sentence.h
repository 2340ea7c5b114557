// SPDX-License-Identifier: BSD-3-Clause
//
// Sentences for the terminal.
#ifndef FCL_CCD_SENTENCE_H
#define FCL_CCD_SENTENCE_H

#include <array>
#include <string>

namespace fcl_ccd {

/// @brief A text whose blanks wrapped() does not take for line breaks.
std::string unbroken(std::string text);

/// @brief "(0, 0.5, 1)", which is not broken.
std::string pointText(const std::array<double, 3>& point);

/// @brief "normal (0, 0, 1)", or "no normal" for zero.
std::string normalText(const std::array<double, 3>& normal);

/// @brief Breaks a text at blanks into lines of at most 80 characters, all but the first
/// of which are indented. A word that is longer has a line of its own.
std::string wrapped(const std::string& text);

}  // namespace fcl_ccd

#endif

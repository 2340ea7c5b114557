// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SUGGESTION_H
#define FCL_CCD_SUGGESTION_H

#include <string>
#include <vector>

namespace fcl_ccd {

/// @brief The name that a mistyped word is most like: with the fewest characters that are
/// changed, left out, added, or exchanged with the next one, at most one for each three
/// of the word. Empty if there is none.
std::string nearestName(const std::string& word, const std::vector<std::string>& names);

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_FRAME_LIST_H
#define FCL_CCD_FRAME_LIST_H

#include <optional>
#include <string>
#include <vector>

namespace fcl_ccd {

/// @brief The selection of frames of a folder or of a pattern.
struct FrameRange {
  // Numbers from 0 on.
  std::optional<long long> start;  ///< default: the first frame
  std::optional<long long> end;    ///< inclusive; default: the last frame
  long long stride{1};             ///< at least 1

  bool isWhole() const { return !start && !end && stride == 1; }
};

/// @brief The files that the words name, in their order. A word is
/// (1) a file;
/// (2) a folder: its meshes, which must have one format, in natural order (f9 before
/// f10);
/// (3) a shell pattern with *, ? or [...] in its last part, and not before: the files
/// that match, in natural order; (4) a name with a number, frame_%04d.ply: the numbers
/// from start to end. In (2) and (3) start and end count the files from 0. (1) has no
/// range.
/// @throws std::runtime_error that names the word and the cause: nothing matches, a
/// number of (4) is missing, start or end is below 0, or start, end or stride is given
/// but no word is (2), (3) or (4).
std::vector<std::string> listFrames(const std::vector<std::string>& words,
                                    const FrameRange& range);

/// @brief One line about frames that seem to be missing: the names differ only in a
/// number that rises, more than half of the times by the same, least amount, and now and
/// then by more. Empty if this is not so.
std::string noteOnGaps(const std::vector<std::string>& frames);

/// @brief Whether a comes before b when runs of digits are compared as numbers.
bool isBeforeNaturally(const std::string& a, const std::string& b);

}  // namespace fcl_ccd

#endif

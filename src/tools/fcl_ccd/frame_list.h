// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_FRAME_LIST_H
#define FCL_CCD_FRAME_LIST_H

#include <cstddef>
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
  /// Whether frames may still come: then none is required to be there.
  bool is_growing{false};

  bool isWhole() const { return !start && !end && stride == 1; }
};

/// @brief The numbers of frames: first, first + stride, and so on.
struct FrameNumbers {
  long long first{0};
  long long stride{1};

  std::size_t operator[](std::size_t frame) const {
    return static_cast<std::size_t>(first) + frame * static_cast<std::size_t>(stride);
  }
  /// @brief The frame with a number, if there is one.
  std::optional<std::size_t> frameOf(std::size_t number) const;
};

/// @brief The files that the words name, in their order. A word is
/// (1) a file;
/// (2) a folder: its meshes, which must have one format, in natural order (f9 before
/// f10);
/// (3) a shell pattern with *, ? or [...] in its last part, and not before: the files
/// that match, in natural order; (4) a name with a number, frame_%04d.ply: the numbers
/// from start to end. In (2) and (3) start and end count the files from 0. (1) has no
/// range.
/// @param[out] numbers  may be null. Of the frames of a single word (2), (3) or (4): its
/// file numbers, or those in the names of (4). Other frames are counted from 0.
/// @throws std::runtime_error that names the word and the cause: nothing matches, a
/// number of (4) is missing, start or end is below 0, or start, end or stride is given
/// but no word is (2), (3) or (4). With range.is_growing files of (2) and (3) may be
/// missing, and the frames of (4) end before a number that is missing.
std::vector<std::string> listFrames(const std::vector<std::string>& words,
                                    const FrameRange& range,
                                    FrameNumbers* numbers = nullptr);

/// @brief Whether files that come later may be among those that the words name: there is
/// one word, (2), (3) or (4).
bool mayGrow(const std::vector<std::string>& words);

/// @brief Whether a file that comes later is among those that a word (2), (3) or (4)
/// names.
bool isNamedBy(const std::string& word, const std::string& file);

/// @brief Whether a name is one with a number, as in (4).
/// @throws std::runtime_error if the number is not written as there.
bool hasNumber(const std::string& name);

/// @brief The name of a file with this number. A name without number stays as it is.
std::string withNumber(const std::string& name, std::size_t number);

/// @brief One line about frames that seem to be missing: the names differ only in a
/// number that rises, more than half of the times by the same, least amount, and now and
/// then by more. Empty if this is not so.
std::string noteOnGaps(const std::vector<std::string>& frames);

/// @brief Whether a comes before b when runs of digits are compared as numbers.
bool isBeforeNaturally(const std::string& a, const std::string& b);

}  // namespace fcl_ccd

#endif

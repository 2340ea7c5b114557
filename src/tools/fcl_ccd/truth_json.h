// SPDX-License-Identifier: BSD-3-Clause
//
// The truth of Sample-Scalable-CCD-Data: pairs of boxes and answers, as JSON.
#ifndef FCL_CCD_TRUTH_JSON_H
#define FCL_CCD_TRUTH_JSON_H

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_ccd {

/// @brief The numbers of two boxes.
using BoxPair = std::array<long long, 2>;

/// @brief How the name of a file with answers ends.
constexpr std::string_view kAnswersEnd = "_mma_bool";

/// @brief Whether the name of a file says that it has answers.
bool isNamedAnswers(const std::string& path);

/// @brief The file of answers that belongs to a file of queries or of pairs: for
/// 92vf.csv or 92vf.json it is 92vf_mma_bool.json in the same folder, or in the folder
/// mma_bool beside it. Empty if there is none.
std::string answersBeside(const std::string& path);

/// @brief An array of true and false.
/// @throws std::runtime_error that names the file and the entry
std::vector<bool> readAnswers(const std::string& path);

/// @brief An array of pairs of whole numbers.
/// @throws std::runtime_error that names the file and the entry
std::vector<BoxPair> readBoxPairs(const std::string& path);

}  // namespace fcl_ccd

#endif

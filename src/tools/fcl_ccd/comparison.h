// SPDX-License-Identifier: BSD-3-Clause
//
// The two comparisons of `fcl-ccd compare`.
#ifndef FCL_CCD_COMPARISON_H
#define FCL_CCD_COMPARISON_H

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compare_command.h"
#include "json.h"

namespace fcl_ccd {

/// @brief The figures of a comparison, in one row.
struct ComparisonRow {
  std::vector<std::pair<std::string, std::string>> columns;  ///< name and figure
  Json json;
};

/// @brief A comparison of the library's answers with the truth of some files.
class Comparison {
 public:
  virtual ~Comparison() = default;

  /// @brief The files that it reads.
  virtual std::vector<std::string> files() const = 0;

  /// @throws std::runtime_error that names the file and the cause
  virtual ComparisonRow run() = 0;
};

/// @brief Of elementary queries, whose truth is in their rows or in a file of answers.
/// @param options  must outlive the comparison
/// @throws std::runtime_error if a file is missing
std::unique_ptr<Comparison> queryComparison(const CompareOptions& options);

/// @brief Of the candidates and contacts of a step, with lists of pairs.
std::unique_ptr<Comparison> frameComparison(const CompareOptions& options);

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_REPORT_PAGE_H
#define FCL_CCD_REPORT_PAGE_H

#include <string>

#include "output_file.h"
#include "run_report.h"

namespace fcl_ccd {

/// @brief The page of a run, which loads nothing: the data of pageMesh() and pageStep(),
/// the picture of the first contact, and what shows them. It grows on the disk with each
/// step, and appears when it is published. All functions throw WriteError.
class ReportPage {
 public:
  explicit ReportPage(const std::string& path);

  /// @brief Adds elements of the page.
  void add(const std::string& elements) { file_.write(elements); }

  /// @param sentence     the summary, as it is printed
  /// @param picture      a PNG, or nothing
  /// @param is_complete  whether all steps were done
  void finish(const std::string& sentence, const std::string& picture, bool is_complete);

  OutputFile& file() { return file_; }

 private:
  OutputFile file_;
};

}  // namespace fcl_ccd

#endif

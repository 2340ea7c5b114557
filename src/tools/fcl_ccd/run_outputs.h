// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RUN_OUTPUTS_H
#define FCL_CCD_RUN_OUTPUTS_H

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "growing_file.h"
#include "moment_file.h"
#include "output_set.h"
#include "report_page.h"
#include "resume.h"
#include "run_command.h"
#include "step_record.h"

namespace fcl_ccd {

/// @brief The outputs of a run: table, growing files, JSON, pictures and page. If one of
/// them is standard output, the table goes to stderr. All functions but rollBack() throw
/// WriteError.
class RunOutputs {
 public:
  /// @brief Prints the head of the table; changes no file.
  /// @param reserved  has the locks of all outputs; must outlive this object.
  RunOutputs(const RunOptions& options, const OutputSet& reserved,
             const RunSummary& summary);

  /// @brief Opens the growing files.
  void open(const GrowingOutputs& growing, const ResumePoint& resume_point);

  /// @brief Writes a step to all files and commits it.
  void add(const StepRecord& record);
  /// @brief Prints the row of a step. It comes after add(): what is printed is kept.
  void printRow(const StepRecord& record) const { print(record.row); }

  /// @brief Ends all files. The list of steps and the report say whether they are
  /// complete.
  void finish(bool is_complete);

  /// @brief Prints the summary.
  void printSummary() const;

  /// @brief Removes an incomplete step from the growing files.
  void rollBack() noexcept;

  /// @brief "c.csv and s.jsonl": the files with which --resume can go on; or nothing,
  /// also if another program has taken away one of them.
  std::string whereStepsAre() const;

  const RunSummary& summary() const { return summary_; }

 private:
  void open(const std::string& path, std::uint64_t kept_size, const std::string& head,
            std::optional<GrowingFile>& file);
  void commit();
  std::vector<OutputFile*> finishWholeFiles(bool is_complete);
  void print(std::string_view text) const;

  const RunOptions& options_;
  const OutputSet& reserved_;
  std::optional<GrowingFile> contacts_, steps_;
  std::optional<OutputFile> json_;
  bool has_json_step_{false};
  std::optional<MomentFile> picture_, paint_;
  std::optional<ReportPage> page_;
  std::string page_picture_;
  RunSummary summary_;
};

}  // namespace fcl_ccd

#endif

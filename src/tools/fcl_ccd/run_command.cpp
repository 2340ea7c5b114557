// SPDX-License-Identifier: BSD-3-Clause
#include "run_command.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fcl/ccd_version.h"
#include "growing_file.h"
#include "in_order.h"
#include "output_set.h"
#include "own_steps.h"
#include "progress_line.h"
#include "rank_steps.h"
#include "resume.h"
#include "run_inputs.h"
#include "step_maker.h"
#include "stop_signal.h"
#include "write_error.h"

namespace fcl_ccd {
namespace {

using Json = nlohmann::ordered_json;

/// @brief The number of jobs and of threads.
Parallelism parallelismOf(const RunOptions& options, bool is_alone,
                          std::size_t num_steps) {
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  Parallelism parallelism;
  parallelism.threads = options.threads.value_or(1);
  // Steps at the same time do not wait for each other, as threads of one step do. But
  // their times are not those of a step that has the machine to itself.
  const bool times_count = options.settings.repeat > 1 || options.threads;
  // mpirun starts a rank for each core.
  parallelism.jobs = options.jobs ? static_cast<std::size_t>(*options.jobs)
                                  : std::size_t{times_count || !is_alone ? 1u : 0u};
  if (parallelism.jobs == 0) parallelism.jobs = cores;
  parallelism.jobs = std::min(parallelism.jobs, num_steps);
  return parallelism;
}

/// @brief The first line of the list of steps: the options on which answers depend.
std::string stepsHead(const RunOptions& options, std::size_t num_frames) {
  constexpr const char* kQueries[] = {"all", "first", "any"};
  Json head = {{"fcl_ccd", FCL_CCD_VERSION},
               {"query", kQueries[static_cast<int>(options.settings.query)]},
               {"toc_err", options.settings.toc_err},
               {"self", options.settings.self},
               {"weld", options.weld ? Json(*options.weld) : Json(nullptr)}};
  if (options.settings.min_distance > 0) {
    head["thickness"] = options.settings.min_distance;
    head["ignore_initially_closer"] = options.settings.ignore_initially_closer;
  }
  // A later frame can separate vertices that were joined in the steps before it.
  if (options.weld) head["frames"] = num_frames;
  return head.dump() + '\n';
}

/// @brief The outputs of a run: table, growing files, report and picture.
class RunOutputs {
 public:
  /// @brief Prints the head of the table; changes no file.
  RunOutputs(const RunOptions& options, const RunSummary& summary) : summary_(summary) {
    print(tableHead(options.settings.min_distance > 0));
    if (!options.json_path.empty()) json_.emplace(options.json_path);
    if (!options.paint_path.empty()) paint_.emplace(options.paint_path);
  }

  /// @brief Opens the growing files.
  void open(const GrowingOutputs& growing, const ResumePoint& resume_point) {
    open(growing.contacts_path, resume_point.contacts_size, growing.contacts_head,
         contacts_);
    open(growing.steps_path, resume_point.steps_size, growing.steps_head, steps_);
    if (json_) json_->write("{\"steps\": [");
  }

  void add(const StepRecord& record) {
    if (contacts_) contacts_->append(record.contact_lines);
    if (steps_) steps_->append(record.step_line);
    if (json_) json_->write((has_json_step_ ? ",\n" : "\n") + record.json);
    has_json_step_ = true;
    if (paint_ && !record.painted.empty()) paint_->write(record.painted);
    is_painted_ = !record.painted.empty();
    print(record.row);
    summary_.add(record.summary);
    commit();
  }

  /// @brief Ends all files. The list of steps and the report say whether they are
  /// complete.
  void finish(bool is_complete) {
    Json summary = toJson(summary_);
    if (steps_ && is_complete) steps_->append(Json{{"summary", summary}}.dump() + '\n');
    commit();
    for (auto* file : {&contacts_, &steps_})
      if (*file) (*file)->finish();
    summary["complete"] = is_complete;
    if (json_) json_->write("\n],\n\"summary\": " + summary.dump() + "}\n");
    for (OutputFile* file : wholeFiles()) file->finish();
    for (OutputFile* file : wholeFiles()) file->publish();
  }

  /// @brief Removes an incomplete step from the growing files.
  void rollBack() noexcept {
    for (auto* file : {&contacts_, &steps_})
      if (*file) (*file)->rollBack();
  }

  const RunSummary& summary() const { return summary_; }

 private:
  static void open(const std::string& path, std::uint64_t kept_size,
                   const std::string& head, std::optional<GrowingFile>& file) {
    if (path.empty()) return;
    file.emplace(path, kept_size);
    if (kept_size == 0) file->append(head);
    file->commit();
  }

  void commit() {
    for (auto* file : {&contacts_, &steps_})
      if (*file) (*file)->commit();
  }

  std::vector<OutputFile*> wholeFiles() {
    std::vector<OutputFile*> files;
    if (json_) files.push_back(&*json_);
    if (paint_ && is_painted_) files.push_back(&*paint_);
    return files;
  }

  std::optional<GrowingFile> contacts_, steps_;
  std::optional<OutputFile> json_, paint_;
  bool has_json_step_{false};
  bool is_painted_{false};
  RunSummary summary_;
};

/// @brief Gives the steps in order to a function. Returns an end: without a cause if all
/// steps were done.
using StepTaker = std::function<void(std::size_t, const StepRecord&)>;
using StepSource = std::function<StepOutcome(const StepTaker&)>;

/// @brief A run that has begun: its steps, and how it ends.
class Run {
 public:
  Run(const RunOptions& options, const GrowingOutputs& growing,
      const ResumePoint& resume_point)
      : options_(options),
        growing_(growing),
        resume_point_(resume_point),
        num_steps_(growing.num_steps),
        num_done_(resume_point.step),
        outputs_(options, resume_point.summary) {}

  /// @return the exit code.
  int run(const StepSource& source) {
    StepOutcome last;
    try {
      outputs_.open(growing_, resume_point_);
      last = doSteps(source);
    } catch (const WriteError& error) {
      return endAfter(error);
    } catch (const std::bad_alloc&) {
      return end(kBadFrame, "out of memory. Fewer --jobs need less");
    } catch (const RankLost& error) {
      return end(kRankLost, error.what());
    } catch (const std::exception& error) {
      return end(kBadFrame, error.what());
    }
    return end(last.end_code, last.cause);
  }

 private:
  StepOutcome doSteps(const StepSource& source) {
    progress_.begin(num_steps_, num_done_);
    return source([&](std::size_t step, const StepRecord& record) {
      progress_.clear();
      outputs_.add(record);
      num_done_ = step + 1;
      progress_.step(num_done_, outputs_.summary().contacts());
    });
  }

  int end(int code, const std::string& cause) {
    progress_.clear();
    try {
      outputs_.rollBack();
      outputs_.finish(code == 0);
      print(summaryLines(outputs_.summary()));
    } catch (const WriteError& error) {
      return endAfter(error);
    }
    if (code != 0) report(cause);
    return code;
  }

  int endAfter(const WriteError& error) {
    progress_.clear();
    outputs_.rollBack();
    report(error.what());
    return kNotWritten;
  }

  void report(const std::string& cause) const {
    std::string where;
    for (const std::string* path : {&options_.contacts_path, &options_.steps_path})
      if (!path->empty()) where += (where.empty() ? "" : " and ") + *path;
    std::fprintf(
        stderr, "fcl-ccd: %s\nfcl-ccd: stopped after %zu of %zu steps%s\n", cause.c_str(),
        num_done_, num_steps_,
        where.empty()
            ? ""
            : ("; they are in " + where + ". --resume continues from there").c_str());
  }

  const RunOptions& options_;
  const GrowingOutputs& growing_;
  const ResumePoint& resume_point_;
  std::size_t num_steps_;
  std::size_t num_done_;
  RunOutputs outputs_;
  ProgressLine progress_;
};

/// Refuses outputs that cannot be written or that are inputs, before any file is read.
void reserveOutputs(const FramePaths& paths, const RunOptions& options) {
  std::vector<std::string> inputs = paths.a;
  inputs.insert(inputs.end(), paths.b.begin(), paths.b.end());
  OutputSet outputs(std::move(inputs));
  for (const std::string* path : {&options.contacts_path, &options.steps_path,
                                  &options.json_path, &options.paint_path})
    outputs.reserve(*path);
}

/// @brief What a run needs before its first step.
struct Preparation {
  Preparation() = default;
  Preparation(const Preparation&) = delete;  // `growing` refers to `paths`
  Preparation& operator=(const Preparation&) = delete;

  FramePaths paths;
  Parallelism parallelism;
  std::optional<RunInputs> inputs;
  std::vector<std::string> notes;
  // Of the process that writes the outputs.
  GrowingOutputs growing;
  ResumePoint resume_point;
};

void prepareInputs(const RunOptions& options, bool is_alone, Preparation& run) {
  run.parallelism = parallelismOf(options, is_alone, run.paths.numSteps());
  ProgressLine progress;
  progress.show("reading the frames");
  run.inputs.emplace(openInputs(run.paths, options, run.parallelism.jobs, run.notes));
}

void prepare(const RunOptions& options, bool is_alone, Preparation& run) {
  run.paths = listFrames(options);
  reserveOutputs(run.paths, options);
  const FramePaths& paths = run.paths;
  run.growing = {options.contacts_path, contactsHead(options.columns),
                 options.steps_path,    stepsHead(options, paths.a.size()),
                 paths.numSteps(),      [&](std::size_t i) { return paths.filesOf(i); }};
  const std::size_t latest = paths.numSteps() - (options.paint_path.empty() ? 0 : 1);
  if (options.resume) run.resume_point = findResumePoint(run.growing, latest);
  prepareInputs(options, is_alone, run);
}

void report(const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    std::fprintf(stderr, "fcl-ccd: %s\n", note.c_str());
}

int runAlone(const RunOptions& options) {
  Preparation run;
  prepare(options, true, run);
  report(run.notes);
  const StepShare all{run.resume_point.step, run.paths.numSteps()};
  StepMaker maker(options, run.paths, *run.inputs, run.parallelism, all);
  const auto source = [&](const StepTaker& take) {
    std::size_t num_done = all.first;
    inOrder<StepRecord>(
        0, all.size(), maker.numJobs(),
        [&](std::size_t i, std::size_t worker) { return maker.make(i, worker); },
        [&](std::size_t i, const StepRecord& record) {
          take(all[i], record);
          num_done = all[i] + 1;
        },
        [] { return stopSignal() == 0; });
    return num_done < all.end ? endBySignal() : StepOutcome();
  };
  return Run(options, run.growing, run.resume_point).run(source);
}

/// The first rank: makes steps like the others, and has the outputs.
int runFirstRank(const RunOptions& options, Ranks& ranks, const std::string& command) {
  RankGatherer gatherer(ranks);
  Preparation run;
  try {
    prepare(options, false, run);
  } catch (...) {
    gatherer.refuse();
    throw;
  }
  const StepShare share{run.resume_point.step, run.paths.numSteps(), 0,
                        static_cast<std::size_t>(ranks.size())};
  gatherer.begin({command, share.end, ""}, share.first);
  report(run.notes);
  StepMaker maker(options, run.paths, *run.inputs, run.parallelism, share);
  OwnSteps own(maker);
  const int code =
      Run(options, run.growing, run.resume_point).run([&](const StepTaker& take) {
        return gatherer.take(own, share, take);
      });
  try {
    gatherer.end(own);
  } catch (const RankLost& error) {
    if (code != kRankLost) report({error.what()});
  }
  return code;
}

int runOtherRank(const RunOptions& options, Ranks& ranks, const std::string& command) {
  Preparation run;
  Readiness readiness{command, 0, ""};
  try {
    run.paths = listFrames(options);
    readiness.num_steps = run.paths.numSteps();
    prepareInputs(options, false, run);
  } catch (const std::exception& error) {
    readiness.cause = error.what();
  }
  const std::optional<std::size_t> first = awaitBegin(ranks, readiness);
  if (!first) return 0;
  StepMaker maker(options, run.paths, *run.inputs, run.parallelism,
                  {*first, run.paths.numSteps(), static_cast<std::size_t>(ranks.rank()),
                   static_cast<std::size_t>(ranks.size())});
  OwnSteps own(maker);
  sendSteps(ranks, own);
  return 0;
}

}  // namespace

int runCommand(const RunOptions& options, Ranks& ranks, const std::string& command) {
  if (ranks.size() == 1) return runAlone(options);
  return ranks.rank() == 0 ? runFirstRank(options, ranks, command)
                           : runOtherRank(options, ranks, command);
}

}  // namespace fcl_ccd

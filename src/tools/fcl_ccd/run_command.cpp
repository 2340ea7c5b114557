// SPDX-License-Identifier: BSD-3-Clause
#include "run_command.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "counted.h"
#include "fcl/ccd_version.h"
#include "frame_watch.h"
#include "in_order.h"
#include "json.h"
#include "output_set.h"
#include "own_steps.h"
#include "progress_line.h"
#include "rank_steps.h"
#include "resume.h"
#include "run_inputs.h"
#include "run_outputs.h"
#include "step_maker.h"
#include "stop_signal.h"
#include "write_error.h"

namespace fcl_ccd {
namespace {

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
  // The number of steps of --follow is not known. More jobs than cores read frames while
  // others wait for a disk; four a core are plenty. 64: also on a small machine a number
  // that is meant is taken as it is.
  constexpr std::size_t kJobsOfCore = 4, kLeastLimit = 64;
  if (options.follow)
    parallelism.jobs =
        std::min(parallelism.jobs, std::max(kJobsOfCore * cores, kLeastLimit));
  return parallelism;
}

/// @brief The first line of the list of steps: the options on which answers depend.
std::string stepsHead(const RunOptions& options, std::size_t num_frames) {
  constexpr const char* kQueries[] = {"all", "first", "any"};
  // The form of the lines. A higher one for each change: lines of another form cannot be
  // continued. (1, without crossings in "contacts", was not written.)
  constexpr int kFormat = 4;
  Json head = {{"fcl_ccd", FCL_CCD_VERSION},
               {"format", kFormat},
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

/// @brief Gives the steps in order to a function. Returns an end: without a cause if all
/// steps were done.
using StepTaker = std::function<void(std::size_t, const StepRecord&)>;
using StepSource = std::function<StepOutcome(const StepTaker&)>;

/// @brief A folder of outputs. If it was made and nothing came into it, it does not stay.
class OutputFolder {
 public:
  OutputFolder() = default;
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder() {
    std::error_code error;
    // Folders that are not empty are not removed.
    for (const std::filesystem::path& folder : made_)
      std::filesystem::remove(folder, error);
  }

  /// @brief Makes it and those above it; does nothing for an empty path.
  void make(const std::filesystem::path& path) {
    std::error_code error;
    for (std::filesystem::path folder = path;
         !folder.empty() && !std::filesystem::exists(folder, error);
         folder = folder.parent_path())
      made_.push_back(folder);
    if (!path.empty()) std::filesystem::create_directories(path, error);
  }

 private:
  std::vector<std::filesystem::path> made_;  ///< the innermost first
};

/// @brief What a run needs before its first step.
struct Preparation {
  Preparation() = default;
  Preparation(const Preparation&) = delete;  // `growing` refers to `paths`
  Preparation& operator=(const Preparation&) = delete;

  FramePaths paths;
  Parallelism parallelism;
  std::optional<RunInputs> inputs;
  std::vector<std::string> notes;
  std::size_t num_listed_steps{0};  ///< also those of frames that are being written
  // Of the process that writes the outputs. The folder goes after them.
  OutputFolder report_folder;
  std::optional<OutputSet> outputs;
  GrowingOutputs growing;
  ResumePoint resume_point;

  std::size_t numSteps() const { return paths.numSteps(); }

  /// @brief Leaves out the frames that another rank cannot use.
  void shorten(const Readiness& all) {
    const std::size_t num_frames = all.num_whole_steps + 1;
    if (num_frames >= paths.a.size()) return;
    inputs->unfinished = FrameFault{num_frames, all.unfinished};
    inputs->shorten(num_frames);
    paths.shorten(num_frames);
  }

  /// @brief The end of a run that has done all steps: frames may be left.
  StepOutcome end() const {
    if (!inputs->unfinished) return {};
    return {
        std::nullopt, kUnfinished,
        inputs->unfinished->cause + ". Another program may still be writing this frame"};
  }
};

Readiness readinessOf(const Preparation& run, const std::string& command) {
  return {command, run.num_listed_steps, "", run.numSteps(),
          run.inputs->unfinished ? run.inputs->unfinished->cause : ""};
}

/// @brief A run that has begun: its steps, and how it ends.
class Run {
 public:
  Run(const RunOptions& options, const Preparation& prepared)
      : options_(options),
        prepared_(prepared),
        num_steps_(prepared.num_listed_steps),
        num_done_(prepared.resume_point.step),
        outputs_(options, *prepared.outputs, prepared.resume_point.summary) {}

  /// @return the exit code.
  int run(const StepSource& source) {
    StepOutcome last;
    try {
      outputs_.open(prepared_.growing, prepared_.resume_point);
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

  /// @brief Tells that more frames came, or that the run waits for them.
  void expect(std::size_t num_steps) {
    num_steps_ = num_steps;
    progress_.expect(num_steps);
  }
  void showWaiting() {
    progress_.show(counted(num_done_, "step") + " done, waiting for frames");
  }
  void tell(const std::string& line) {
    progress_.clear();
    std::fprintf(stderr, "fcl-ccd: %s\n", line.c_str());
  }

 private:
  StepOutcome doSteps(const StepSource& source) {
    progress_.begin(prepared_.numSteps(), num_done_);
    return source([&](std::size_t step, const StepRecord& record) {
      progress_.clear();
      if (options_.follow) requireNoFrameIsShown(record);
      outputs_.add(record);
      assert(step == num_done_);
      num_done_ = step + 1;
      outputs_.printRow(record);
      progress_.step(num_done_, outputs_.summary().contacts());
    });
  }

  int end(int code, const std::string& cause) {
    progress_.clear();
    try {
      outputs_.rollBack();
      if (options_.follow) requireNoFrameIsOutput();
      outputs_.finish(code == 0);
      outputs_.printSummary();
    } catch (const WriteError& error) {
      return endAfter(error);
    }
    if (code != 0) report(cause);
    return code;
  }

  /// Frames that came since the outputs were reserved may be links to one. Also
  /// those count that were not used.
  void requireNoFrameIsOutput() const {
    FramePaths listed;
    try {
      listed = listFrames(options_);
    } catch (const std::runtime_error&) {
      return;  // a folder that is gone has no frames
    }
    const FramePaths* const lists[] = {&prepared_.paths, &listed};
    for (const FramePaths* list : lists)
      for (const std::string* path : {&options_.json_path, &options_.paint_path,
                                      &options_.picture_path, &options_.report_path}) {
        requireNotAmong(list->a, *path);
        requireNotAmong(list->b, *path);
      }
  }

  /// The same for the files of a step, which are written before the end.
  void requireNoFrameIsShown(const StepRecord& record) const {
    for (const auto& [path, bytes] :
         {std::make_pair(&options_.picture_path, &record.picture),
          std::make_pair(&options_.paint_path, &record.painted)}) {
      if (bytes->empty() || !hasNumber(*path)) continue;
      for (const auto* frames : {&prepared_.paths.a, &prepared_.paths.b})
        requireNotAmong(*frames, withNumber(*path, record.number));
    }
  }

  int endAfter(const WriteError& error) {
    progress_.clear();
    outputs_.rollBack();
    report(error.what());
    return kNotWritten;
  }

  void report(const std::string& cause) const {
    const std::string where = num_done_ == 0 ? "" : outputs_.whereStepsAre();
    std::fprintf(
        stderr, "fcl-ccd: %s\nfcl-ccd: stopped after %zu of %s%s\n", cause.c_str(),
        num_done_, counted(num_steps_, "step").c_str(),
        where.empty()
            ? ""
            : ("; they are in " + where + ". --resume continues from there").c_str());
  }

  const RunOptions& options_;
  const Preparation& prepared_;
  std::size_t num_steps_;
  std::size_t num_done_;
  RunOutputs outputs_;
  ProgressLine progress_;
};

/// The number of the first step that --picture and --paint may show.
std::size_t firstShown(const RunOptions& options, const FramePaths& paths) {
  const std::vector<std::size_t>& steps = options.shown.steps;
  return steps.empty() ? paths.numbers[0] : *std::min_element(steps.begin(), steps.end());
}

/// The files of a name with a number, for all steps that it shows.
std::vector<std::string> shownFiles(const RunOptions& options, const FramePaths& paths,
                                    const std::string& path) {
  std::vector<std::string> files;
  if (!hasNumber(path)) return files;
  for (const std::size_t number : options.shown.steps)
    files.push_back(withNumber(path, number));
  if (!files.empty()) return files;
  for (std::size_t step = 0; step < paths.numSteps(); ++step)
    files.push_back(withNumber(path, paths.numbers[step]));
  return files;
}

/// Refuses steps that the run does not have.
void requireShown(const RunOptions& options, const FramePaths& paths) {
  if (options.follow || paths.numSteps() == 0) return;
  for (const std::size_t number : options.shown.steps) {
    const std::optional<std::size_t> step = paths.numbers.frameOf(number);
    if (!step || *step >= paths.numSteps())
      throw std::runtime_error("--at-step " + std::to_string(number) +
                               ": the run has no such step. The first is " +
                               std::to_string(paths.numbers[0]) + ", the last " +
                               std::to_string(paths.numbers[paths.numSteps() - 1]));
  }
}

/// Refuses outputs that cannot be written, that are inputs, or that another run writes,
/// before any file is read.
void reserveOutputs(const RunOptions& options, Preparation& run) {
  requireShown(options, run.paths);
  std::vector<std::string> inputs = run.paths.a;
  inputs.insert(inputs.end(), run.paths.b.begin(), run.paths.b.end());
  run.outputs.emplace(std::move(inputs));
  run.report_folder.make(options.report_folder);
  for (const std::string* path : {&options.contacts_path, &options.steps_path,
                                  &options.json_path, &options.report_path})
    run.outputs->reserve(*path);
  for (const std::string* path : {&options.picture_path, &options.paint_path}) {
    // Only the first file of many is locked, but none may be a frame.
    run.outputs->requireNotTaken(shownFiles(options, run.paths, *path));
    run.outputs->reserve(withNumber(*path, firstShown(options, run.paths)));
  }
}

void prepareInputs(const RunOptions& options, bool is_alone, Preparation& run) {
  // More frames may come than there are now.
  const std::size_t num_steps =
      options.follow ? std::numeric_limits<std::size_t>::max() : run.numSteps();
  run.parallelism = parallelismOf(options, is_alone, num_steps);
  run.num_listed_steps = run.numSteps();
  ProgressLine progress;
  progress.show("reading the frames");
  run.inputs.emplace(openInputs(run.paths, options, run.parallelism.jobs, run.notes));
  if (options.jobs && options.threads)
    run.notes.push_back(
        counted(run.parallelism.jobs, "step") + " at the same time, with " +
        (run.parallelism.threads == 0
             ? "as many threads as cores"
             : counted(static_cast<std::size_t>(run.parallelism.threads), "thread")) +
        " each");
}

/// The first step whose file of many is not there. The others were written with their
/// steps.
std::optional<std::size_t> firstWithoutFile(const RunOptions& options,
                                            const FramePaths& paths,
                                            const std::string& path) {
  std::error_code error;
  for (std::size_t step = 0; step < paths.numSteps(); ++step) {
    const std::size_t number = paths.numbers[step];
    if (options.shown.has(number, path) &&
        !std::filesystem::exists(withNumber(path, number), error))
      return step;
  }
  return std::nullopt;
}

/// The first step whose picture is wanted, which the last run may have done.
std::optional<std::size_t> firstToShow(const RunOptions& options,
                                       const Preparation& run) {
  std::optional<std::size_t> first;
  const FramePaths& paths = run.paths;
  for (const std::string* path : {&options.picture_path, &options.paint_path}) {
    if (path->empty() || run.numSteps() == 0) continue;
    std::optional<std::size_t> step = run.numSteps() - 1;
    if (hasNumber(*path))
      step = firstWithoutFile(options, paths, *path);
    else if (!options.shown.isOfFirstContact(*path))
      step = paths.numbers.frameOf(firstShown(options, paths)).value_or(0);
    else if (run.resume_point.first_contact)
      step = *run.resume_point.first_contact;
    if (step) first = std::min(first.value_or(*step), *step);
  }
  return first;
}

/// Finds the first step. The frames are those that all ranks can use.
void prepareResume(const RunOptions& options, Preparation& run) {
  const FramePaths& paths = run.paths;
  run.growing = {options.contacts_path,
                 contactsHead(options.columns),
                 options.columns.placeOfStep().value_or(0),
                 options.steps_path,
                 stepsHead(options, paths.a.size()),
                 run.numSteps(),
                 paths.numbers,
                 [&](std::size_t i) { return paths.filesOf(i); }};
  if (!options.resume) return;
  for (const std::string* path : {&options.contacts_path, &options.steps_path})
    if (isStandardOutput(*path))
      throw std::runtime_error("--resume cannot continue standard output. Name a file");
  if (!options.contacts_path.empty() && !options.columns.placeOfStep())
    throw std::runtime_error(
        "--resume needs the column step of the contacts. Add step to --columns");
  run.resume_point = findResumePoint(run.growing, run.numSteps());
  const std::optional<std::size_t> again = firstToShow(options, run);
  if (again && *again < run.resume_point.step)
    run.resume_point = findResumePoint(run.growing, *again);
  // Else the first contact of the summary would be taken for that of all steps.
  if (run.resume_point.step > 0 && options.steps_path.empty())
    run.notes.push_back("the summary has the steps from " +
                        std::to_string(paths.numbers[run.resume_point.step]) +
                        " on. With --steps it has those of before too");
}

void report(const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    std::fprintf(stderr, "fcl-ccd: %s\n", note.c_str());
}

/// Makes the steps of maker.share().
void makeSteps(StepMaker& maker, const StepTaker& take) {
  const StepShare& share = maker.share();
  inOrder<StepRecord>(
      0, share.size(), std::min(maker.numJobs(), std::max<std::size_t>(1, share.size())),
      [&](std::size_t i, std::size_t worker) { return maker.make(i, worker); },
      [&](std::size_t i, const StepRecord& record) { take(share[i], record); },
      [] { return stopSignal() == 0; });
}

int runAlone(const RunOptions& options) {
  Preparation prepared;
  Run* begun = nullptr;
  std::optional<FrameWatch> watch;
  if (options.follow)
    watch.emplace(options, [&](const std::string& line) {
      if (begun == nullptr) return report({line});
      begun->tell(line);
    });
  prepared.paths = watch ? watch->waitForFirst() : listFrames(options);
  reserveOutputs(options, prepared);
  prepareInputs(options, true, prepared);
  prepareResume(options, prepared);
  report(prepared.notes);
  FramePaths& paths = prepared.paths;
  RunInputs& inputs = *prepared.inputs;
  StepMaker maker(options, paths, inputs, prepared.parallelism,
                  {prepared.resume_point.step, paths.numSteps()});
  Run run(options, prepared);
  begun = &run;
  return run.run([&](const StepTaker& take) {
    std::size_t num_done = prepared.resume_point.step;
    const auto takeNext = [&](std::size_t step, const StepRecord& record) {
      take(step, record);
      num_done = step + 1;
    };
    makeSteps(maker, takeNext);
    while (watch && num_done == paths.numSteps()) {
      run.showWaiting();
      if (!watch->waitForMore(paths, inputs, prepared.parallelism.jobs)) break;
      run.expect(paths.numSteps());
      maker.setShare({num_done, paths.numSteps()});
      makeSteps(maker, takeNext);
    }
    if (stopSignal() != 0 && (watch || num_done < paths.numSteps())) return endBySignal();
    return prepared.end();
  });
}

/// @throws std::runtime_error if --follow cannot work with the other options.
void requireFollowable(const RunOptions& options, const Ranks& ranks) {
  if (ranks.size() > 1)
    throw std::runtime_error("--follow runs in one process: start it without mpirun");
  if (options.weld)
    throw std::runtime_error(
        "--follow cannot be combined with --weld, which needs all frames: a later one "
        "may "
        "part vertices. Weld the mesh before, or run without --follow");
  if (!mayGrow(options.frames))
    throw std::runtime_error(
        "--follow needs frames whose number can grow: one folder, one pattern in quotes, "
        "or one name with a number such as frame_%04d.ply");
  for (const std::string* output :
       {&options.contacts_path, &options.steps_path, &options.json_path,
        &options.report_path, &options.picture_path, &options.paint_path})
    for (const auto* words : {&options.frames, &options.against}) {
      // Of a file a step any number does.
      const std::string file = withNumber(*output, 0);
      if (output->empty() || isStandardOutput(*output) || !mayGrow(*words) ||
          !isNamedBy((*words)[0], file))
        continue;
      throw std::runtime_error(file + ": cannot write: --follow would take it for a " +
                               "frame. Name a file in another folder");
    }
}

/// The first rank: makes steps like the others, and has the outputs.
int runFirstRank(const RunOptions& options, Ranks& ranks, const std::string& command) {
  RankGatherer gatherer(ranks);
  Preparation run;
  try {
    run.paths = listFrames(options);
    reserveOutputs(options, run);
    prepareInputs(options, false, run);
  } catch (...) {
    gatherer.refuse();
    throw;
  }
  const StepRange range =
      gatherer.begin(readinessOf(run, command), [&](const Readiness& all) {
        run.shorten(all);
        prepareResume(options, run);
        return run.resume_point.step;
      });
  report(run.notes);
  StepMaker maker(options, run.paths, *run.inputs, run.parallelism,
                  {range.first, range.end, 0, static_cast<std::size_t>(ranks.size())});
  OwnSteps own(maker);
  const int code = Run(options, run).run([&](const StepTaker& take) {
    StepOutcome end = gatherer.take(own, maker.share(), take);
    return end.end_code == 0 ? run.end() : end;
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
  Readiness readiness{command, 0, "", 0, ""};
  try {
    run.paths = listFrames(options);
    prepareInputs(options, false, run);
    readiness = readinessOf(run, command);
  } catch (const std::exception& error) {
    readiness.num_steps = run.numSteps();
    readiness.cause = error.what();
  }
  const std::optional<StepRange> range = awaitBegin(ranks, readiness);
  if (!range) return 0;
  StepMaker maker(options, run.paths, *run.inputs, run.parallelism,
                  {range->first, range->end, static_cast<std::size_t>(ranks.rank()),
                   static_cast<std::size_t>(ranks.size())});
  OwnSteps own(maker);
  sendSteps(ranks, own);
  return 0;
}

}  // namespace

int runCommand(const RunOptions& options, Ranks& ranks, const std::string& command) {
  if (options.follow) {
    // mpirun ends all ranks when one ends with another code: rank 0 is to say why.
    if (ranks.rank() != 0) return 0;
    requireFollowable(options, ranks);
  }
  if (ranks.size() == 1) return runAlone(options);
  return ranks.rank() == 0 ? runFirstRank(options, ranks, command)
                           : runOtherRank(options, ranks, command);
}

}  // namespace fcl_ccd

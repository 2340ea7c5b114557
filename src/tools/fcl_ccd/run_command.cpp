// SPDX-License-Identifier: BSD-3-Clause
#include "run_command.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include "fcl/ccd_version.h"
#include "frame_store.h"
#include "growing_file.h"
#include "in_order.h"
#include "output_set.h"
#include "progress_line.h"
#include "resume.h"
#include "run_inputs.h"
#include "stop_signal.h"
#include "write_error.h"

namespace fcl_ccd {
namespace {

using Json = nlohmann::ordered_json;

struct Parallelism {
  std::size_t jobs{1};
  int threads{1};
};

/// @brief The number of jobs and of threads.
Parallelism parallelismOf(const RunOptions& options, std::size_t num_steps) {
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  Parallelism parallelism;
  parallelism.threads = options.threads.value_or(1);
  // Steps at the same time do not wait for each other, as threads of one step do. But
  // their times are not those of a step that has the machine to itself.
  const bool times_count = options.settings.repeat > 1 || options.threads;
  parallelism.jobs = options.jobs ? static_cast<std::size_t>(*options.jobs)
                                  : std::size_t{times_count ? 1u : 0u};
  if (parallelism.jobs == 0) parallelism.jobs = cores;
  parallelism.jobs = std::min(parallelism.jobs, num_steps);
  return parallelism;
}

/// @brief The results of a step, ready for the outputs.
struct StepRecord {
  RunSummary summary;
  std::string row;
  std::string contact_lines;
  std::string step_line;
  std::string json;
  std::optional<PaintedMesh> painted;
};

/// @brief Makes the records of steps. Several threads may make different records at the
/// same time.
class StepMaker {
 public:
  StepMaker(const RunOptions& options, const FramePaths& paths, const RunInputs& inputs,
            const Parallelism& parallelism, std::size_t begin)
      : options_(options),
        paths_(paths),
        inputs_(inputs),
        settings_(options.settings),
        look_ahead_(2 * parallelism.jobs),
        frames_a_(inputs.a, begin, paths.numSteps()),
        scenes_(parallelism.jobs) {
    settings_.num_threads = parallelism.threads;
    settings_.points = options.columns.position || options.columns.normal;
    if (inputs.b) frames_b_.emplace(*inputs.b, begin, paths.numSteps());
  }

  StepRecord make(std::size_t step, std::size_t worker) {
    announce(step);
    const FrameStore::Pair a = frames_a_.take(step);
    FrameStore::Pair b;
    if (frames_b_) b = frames_b_->take(step);
    const SceneFrame from{a.from.get(), b.from.get()}, to{a.to.get(), b.to.get()};
    StepReport report;
    report.index = step;
    report.files = paths_.filesOf(step);
    report.vertices = a.to->size() + (b.to ? b.to->size() : 0);
    report.triangles =
        inputs_.a.triangles().size() + (inputs_.b ? inputs_.b->triangles().size() : 0);
    report.result = query(from, to, scenes_[worker], step);
    return record(report, to);
  }

 private:
  void announce(std::size_t step) const {
    const std::size_t frame = step + 1 + look_ahead_;
    if (frame >= paths_.a.size()) return;
    inputs_.a.announce(frame);
    if (paths_.b.size() > 1) inputs_.b->announce(frame);
  }

  StepResult query(const SceneFrame& from, const SceneFrame& to,
                   std::unique_ptr<Scene>& scene, std::size_t step) const {
    const auto namingFiles = [&](const char* what) {
      std::string name;
      for (const std::string& file : paths_.filesOf(step)) name += file + ' ';
      name.back() = ':';
      return std::runtime_error(name + ' ' + what);
    };
    try {
      // A query for any contact may find another one in another tree. So each step has
      // its own tree, and the answer does not depend on the step with which a run began.
      const bool is_new =
          scene == nullptr || settings_.query == fcl::ContinuousQuery::kAny;
      if (is_new) scene = std::make_unique<Scene>(inputs_.triangles(), from, settings_);
      StepResult result = scene->step(from, to);
      if (is_new) result.times.build = scene->buildTime();
      return result;
    } catch (const std::bad_alloc&) {
      throw namingFiles("out of memory. Fewer --jobs need less");
    } catch (const std::exception& error) {
      throw namingFiles(error.what());
    }
  }

  StepRecord record(const StepReport& report, const SceneFrame& to) const {
    StepRecord record;
    record.summary = summaryOf(report);
    record.row = tableRow(report);
    if (!options_.contacts_path.empty())
      record.contact_lines = contactLines(report, options_.columns);
    if (!options_.steps_path.empty()) record.step_line = stepLine(report);
    if (!options_.json_path.empty()) record.json = toJson(report).dump();
    if (!options_.paint_path.empty() && report.index + 1 == paths_.numSteps())
      record.painted = paint(inputs_.triangles(), to, report.result);
    return record;
  }

  const RunOptions& options_;
  const FramePaths& paths_;
  const RunInputs& inputs_;
  QuerySettings settings_;
  std::size_t look_ahead_;
  FrameStore frames_a_;
  std::optional<FrameStore> frames_b_;
  std::vector<std::unique_ptr<Scene>> scenes_;  ///< one for each worker
};

/// @brief The first line of the list of steps: the options on which answers depend.
std::string stepsHead(const RunOptions& options) {
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
    if (record.painted)
      paint_->write(encodePaintedPly(record.painted->mesh, record.painted->colours));
    is_painted_ = record.painted.has_value();
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
  int run(StepMaker& maker, std::size_t jobs) {
    try {
      outputs_.open(growing_, resume_point_);
      doSteps(maker, jobs);
    } catch (const WriteError& error) {
      return endAfter(error);
    } catch (const std::bad_alloc&) {
      return end(kBadFrame, "out of memory. Fewer --jobs need less");
    } catch (const std::runtime_error& error) {
      return end(kBadFrame, error.what());
    }
    const int signal_number = stopSignal();
    if (num_done_ < num_steps_)
      return end(kSignalled + signal_number, strsignal(signal_number));
    return end(0, "");
  }

 private:
  void doSteps(StepMaker& maker, std::size_t jobs) {
    progress_.begin(num_steps_, num_done_);
    inOrder<StepRecord>(
        num_done_, num_steps_, jobs,
        [&](std::size_t step, std::size_t worker) { return maker.make(step, worker); },
        [&](std::size_t step, const StepRecord& record) {
          progress_.clear();
          outputs_.add(record);
          num_done_ = step + 1;
          progress_.step(num_done_, outputs_.summary().vf + outputs_.summary().ee);
        },
        [] { return stopSignal() == 0; });
    progress_.clear();
  }

  int end(int code, const std::string& cause) {
    progress_.clear();
    try {
      outputs_.rollBack();
      outputs_.finish(code == 0);
      if (num_steps_ > 1) print(summaryLines(outputs_.summary()));
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

}  // namespace

int runCommand(const RunOptions& options) {
  const FramePaths paths = listFrames(options);
  reserveOutputs(paths, options);
  const GrowingOutputs growing{
      options.contacts_path, contactsHead(options.columns),
      options.steps_path,    stepsHead(options),
      paths.numSteps(),      [&](std::size_t step) { return paths.filesOf(step); }};
  const std::size_t latest = paths.numSteps() - (options.paint_path.empty() ? 0 : 1);
  const ResumePoint resume_point =
      options.resume ? findResumePoint(growing, latest) : ResumePoint();

  const Parallelism parallelism = parallelismOf(options, paths.numSteps());
  std::vector<std::string> notes;
  const RunInputs inputs = [&] {
    ProgressLine progress;
    progress.show("reading the frames");
    return openInputs(paths, options, parallelism.jobs, notes);
  }();
  for (const std::string& note : notes)
    std::fprintf(stderr, "fcl-ccd: %s\n", note.c_str());

  StepMaker maker(options, paths, inputs, parallelism, resume_point.step);
  return Run(options, growing, resume_point).run(maker, parallelism.jobs);
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "scene_command.h"

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "counted.h"
#include "output_set.h"
#include "progress_line.h"
#include "run_command.h"
#include "run_report.h"
#include "scene_file.h"
#include "scene_objects.h"
#include "scene_report.h"
#include "step_record.h"
#include "stop_signal.h"
#include "write_error.h"

namespace fcl_ccd {
namespace {

/// The steps of --start and --end, which name poses and frames.
struct StepsOfScene {
  std::size_t first, end;
  std::size_t size() const { return end - first; }
};

StepsOfScene stepsOf(const FrameRange& range, const SceneFile& file) {
  const auto last = static_cast<long long>(file.numSteps());
  const long long first = range.start.value_or(0), end = range.end.value_or(last);
  const std::string has = file.json().path() + ": has the poses and frames 0 to " +
                          std::to_string(last) + ", so that ";
  if (first < 0 || first >= last)
    throw std::runtime_error(has + "--start is from 0 to " + std::to_string(last - 1));
  if (end <= first || end > last)
    throw std::runtime_error(has + "--end is from " + std::to_string(first + 1) + " to " +
                             std::to_string(last));
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(end)};
}

/// The outputs of a scene. Files appear when all steps are done.
class SceneOutputs {
 public:
  SceneOutputs(const SceneOptions& options, const SceneFile& file)
      : query_(options.query), files_(file.inputs()) {
    contacts_ = files_.open(options.contacts_path);
    json_ = files_.open(options.json_path);
  }

  void begin(const SceneFile& file, const SceneObjects& objects) {
    print(objectsTableHead(query_));
    write(contacts_, objectsContactsHead());
    if (json_ == nullptr) return;
    write(json_, "{\"file\": " + namesInJson({file.json().path()})[0].dump() +
                     ",\n\"objects\": " + objectsJson(objects).dump() +
                     ",\n\"steps\": [");
  }

  void add(const ObjectsStep& step, const SceneObjects& objects) {
    if (contacts_ != nullptr) write(contacts_, contactLines(step, objects));
    if (json_ != nullptr)
      write(json_, (summary_.steps > 0 ? ",\n" : "\n") + toJson(step, objects).dump());
    summary_.add(step, objects, query_);
    print(objectsTableRow(step));
  }

  void finish() {
    write(json_, "\n],\n\"summary\": " + toJson(summary_).dump() + "}\n");
    files_.publish();
    print(summaryLines(summary_, query_));
  }

  const ObjectsSummary& summary() const { return summary_; }

 private:
  static void write(OutputFile* file, const std::string& text) {
    if (file != nullptr) file->write(text);
  }
  void print(const std::string& text) const {
    fcl_ccd::print(text, files_.hasStandardOutput());
  }

  fcl::ContinuousQuery query_;
  OutputSet files_;
  OutputFile *contacts_{nullptr}, *json_{nullptr};
  ObjectsSummary summary_;
};

fcl::ContinuousContactRequestd requestOf(const SceneOptions& options) {
  fcl::ContinuousContactRequestd request;
  request.query = options.query;
  request.toc_err = options.toc_err;
  request.num_threads = options.threads;
  request.enable_crossings = options.query != fcl::ContinuousQuery::kAny;
  return request;
}

ObjectsStep answer(std::size_t number, const fcl::ContinuousContactRequestd& request,
                   SceneObjects& objects) {
  objects.read(number);
  const auto begin = std::chrono::steady_clock::now();
  fcl::ContinuousManagerResultd result;
  objects.move(number);
  objects.manager().collide(request, result);
  const std::chrono::duration<double, std::milli> taken =
      std::chrono::steady_clock::now() - begin;
  ObjectsStep step = toStep(number, std::move(result), objects);
  step.ms = taken.count();
  return step;
}

}  // namespace

int sceneCommand(const SceneOptions& options) {
  const SceneFile file(options.path);
  const StepsOfScene steps = stepsOf(options.range, file);
  SceneOutputs outputs(options, file);
  std::vector<std::string> notes;
  SceneObjects objects(file, options.threads, notes);
  for (const std::string& note : notes)
    std::fprintf(stderr, "fcl-ccd: %s\n", note.c_str());

  ProgressLine progress;
  const auto stop = [&](int code, const std::string& cause) {
    progress.clear();
    std::fprintf(
        stderr, "fcl-ccd: %s\nfcl-ccd: stopped after %zu of %s. No file was written\n",
        cause.c_str(), outputs.summary().steps, counted(steps.size(), "step").c_str());
    return code;
  };
  try {
    const fcl::ContinuousContactRequestd request = requestOf(options);
    outputs.begin(file, objects);
    progress.begin(steps.size(), 0);
    for (std::size_t number = steps.first; number < steps.end; ++number) {
      if (stopSignal() != 0) return stop(endBySignal().end_code, endBySignal().cause);
      const ObjectsStep step = answer(number, request, objects);
      progress.clear();
      outputs.add(step, objects);
      progress.step(outputs.summary().steps, outputs.summary().contacts);
    }
    progress.clear();
    outputs.finish();
  } catch (const WriteError& error) {
    return stop(kNotWritten, error.what());
  } catch (const std::bad_alloc&) {
    return stop(kBadFrame, "out of memory");
  } catch (const std::exception& error) {
    return stop(kBadFrame, file.json().path() + ": step " +
                               std::to_string(steps.first + outputs.summary().steps) +
                               ": " + objects.withNames(error.what()));
  }
  return 0;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "run_command.h"

#include <cstddef>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "output_set.h"
#include "progress_line.h"
#include "run_report.h"

namespace fcl_ccd {
namespace {

/// @brief The frames of one mesh, read one after the other; two are held at a time.
class FrameSequence {
 public:
  explicit FrameSequence(const std::vector<std::string>& paths)
      : paths_(paths), current_(readMesh(paths.front())) {}

  const Mesh& previous() const { return previous_; }
  const Mesh& current() const { return current_; }

  void advance() {
    const std::string& path = paths_[++index_];
    Mesh next = readMesh(path);
    if (next.vertices.size() != current_.vertices.size())
      throw std::runtime_error(path + ": has " + std::to_string(next.vertices.size()) +
                               " vertices, but " + paths_.front() + " has " +
                               std::to_string(current_.vertices.size()));
    if (next.triangles != current_.triangles)
      throw std::runtime_error(path + ": its faces differ from those of " +
                               paths_.front());
    previous_ = std::exchange(current_, std::move(next));
  }

 private:
  const std::vector<std::string>& paths_;
  std::size_t index_{0};
  Mesh previous_;
  Mesh current_;
};

/// @brief The frames of the scene: mesh A, and B if there is one.
class SceneFrames {
 public:
  explicit SceneFrames(const RunOptions& options)
      : options_(options), a_(options.frames) {
    if (!options.against.empty()) b_.emplace(options.against);
  }

  SceneFrame previous() const { return {&a_.previous(), b_ ? &b_->previous() : nullptr}; }
  SceneFrame current() const { return {&a_.current(), b_ ? &b_->current() : nullptr}; }

  void advance() {
    a_.advance();
    if (b_) b_->advance();
    ++step_;
  }

  /// @brief The files of the step, for messages: "a0.ply a1.ply b0.ply b1.ply".
  std::string stepName() const {
    const std::size_t from = step_ - 1, to = step_;
    std::string name = options_.frames[from] + ' ' + options_.frames[to];
    if (b_) name += ' ' + options_.against[from] + ' ' + options_.against[to];
    return name;
  }

  std::string firstName() const {
    return b_ ? options_.frames[0] + ' ' + options_.against[0] : options_.frames[0];
  }

 private:
  const RunOptions& options_;
  FrameSequence a_;
  std::optional<FrameSequence> b_;
  std::size_t step_{0};
};

/// Puts the names of the files before what the library says about their contents.
template <typename Call>
auto namingFiles(const std::string& files, Call call) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(files + ": out of memory");
  } catch (const std::exception& error) {
    throw std::runtime_error(files + ": " + error.what());
  }
}

std::vector<std::string> inputsOf(const RunOptions& options) {
  std::vector<std::string> inputs = options.frames;
  inputs.insert(inputs.end(), options.against.begin(), options.against.end());
  return inputs;
}

StepReport runStep(const SceneFrames& frames, std::size_t index, Scene& scene) {
  StepReport report;
  report.index = index;
  for (const Mesh* mesh : {frames.current().a, frames.current().b}) {
    if (mesh == nullptr) continue;
    report.vertices += mesh->vertices.size();
    report.triangles += mesh->triangles.size();
  }
  report.result = namingFiles(
      frames.stepName(), [&] { return scene.step(frames.previous(), frames.current()); });
  if (index == 0) report.result.times.build = scene.buildTime();
  return report;
}

void writePaint(const SceneFrame& frame, const StepResult& result, OutputFile& file) {
  const PaintedMesh painted = paint(frame, result);
  file.write(encodePaintedPly(painted.mesh, painted.colours));
}

}  // namespace

void runCommand(const RunOptions& options) {
  OutputSet outputs(inputsOf(options));
  OutputFile* const contacts_file = outputs.open(options.contacts_path);
  OutputFile* const json_file = outputs.open(options.json_path);
  OutputFile* const paint_file = outputs.open(options.paint_path);

  const std::size_t num_steps = options.frames.size() - 1;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  ProgressLine progress;
  progress.show("building the hierarchy");
  SceneFrames frames(options);
  Scene scene = namingFiles(frames.firstName(),
                            [&] { return Scene(frames.current(), options.settings); });
  progress.clear();
  print(tableHead());
  if (contacts_file != nullptr) contacts_file->write(contactsHead());
  for (std::size_t i = 0; i < num_steps; ++i) {
    progress.show("step " + std::to_string(i + 1) + " of " + std::to_string(num_steps));
    frames.advance();
    const StepReport report = runStep(frames, i, scene);
    progress.clear();
    print(tableRow(report));
    if (contacts_file != nullptr) contacts_file->write(contactLines(report));
    if (json_file != nullptr) steps.push_back(toJson(report));
    if (paint_file != nullptr && i + 1 == num_steps)
      writePaint(frames.current(), report.result, *paint_file);
  }
  if (json_file != nullptr)
    json_file->write(nlohmann::ordered_json{{"steps", std::move(steps)}}.dump(2) + '\n');
  outputs.publish();
}

}  // namespace fcl_ccd

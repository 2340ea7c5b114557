// SPDX-License-Identifier: BSD-3-Clause
#include "step_maker.h"

#include <algorithm>
#include <cassert>
#include <new>
#include <stdexcept>
#include <string>

#include "contact_picture.h"
#include "page_step.h"

namespace fcl_ccd {

namespace {

/// Whether an output has places of contacts, beside that of the run's first one. They
/// take a tenth of a step that has very many contacts.
bool needsPoints(const RunOptions& options) {
  bool needs = !options.contacts_path.empty() && options.columns.needPoints();
  for (const std::string* path : {&options.steps_path, &options.json_path,
                                  &options.report_path, &options.picture_path})
    needs |= !path->empty();
  return needs;
}

}  // namespace

StepMaker::StepMaker(const RunOptions& options, const FramePaths& paths,
                     const RunInputs& inputs, const Parallelism& parallelism,
                     const StepShare& share)
    : options_(options),
      paths_(paths),
      inputs_(inputs),
      settings_(options.settings),
      share_(share),
      first_step_(share.first),
      frames_a_(inputs.a, share),
      scenes_(parallelism.jobs) {
  settings_.num_threads = parallelism.threads;
  settings_.points = needsPoints(options);
  // Also for any contact, of which files have one at most: which crossing is found first
  // depends on the tree, and the tree on the steps before.
  settings_.all_crossings = options.writesFiles();
  if (inputs.b) frames_b_.emplace(*inputs.b, share);
  if (options.report_path.empty()) return;
  const SceneFrame first{&inputs.a.firstVertices(),
                         inputs.b ? &inputs.b->firstVertices() : nullptr};
  grid_ = viewGrid(first, paths.numSteps());
}

void StepMaker::setShare(const StepShare& share) {
  share_ = share;
  frames_a_.setShare(share);
  if (frames_b_) frames_b_->setShare(share);
}

StepRecord StepMaker::make(std::size_t i, std::size_t worker) {
  announce(i);
  const std::size_t step = share_[i];
  assert(worker < scenes_.size() && share_.has(step));
  const FrameStore::Pair a = frames_a_.take(step);
  FrameStore::Pair b;
  if (frames_b_) b = frames_b_->take(step);
  const SceneFrame from{a.from.get(), b.from.get()}, to{a.to.get(), b.to.get()};
  StepReport report;
  report.number = paths_.numbers[step];
  report.files = paths_.filesOf(step);
  report.vertices = a.to->size() + (b.to ? b.to->size() : 0);
  report.triangles =
      inputs_.a.triangles().size() + (inputs_.b ? inputs_.b->triangles().size() : 0);
  report.result = query(from, to, scenes_[worker], step);
  const bool may_be_first = first_contact_.mayBeFirst(
      step, report.result.earliest() != nullptr, step + 1 == share_.end);
  if (may_be_first && !(settings_.points && settings_.all_crossings)) {
    // The summary tells the place of the first contact.
    const StepTimes times = report.result.times;
    report.result = scenes_[worker]->stepInDetail(from, to);
    report.result.times = times;
  }
  StepRecord made = record(report);
  show(report, step, may_be_first, from, to, made);
  return made;
}

void StepMaker::announce(std::size_t i) const {
  const std::size_t later = share_[i + 2 * numJobs()];
  const auto announceFrame = [this](std::size_t frame) {
    if (frame >= paths_.a.size()) return;
    inputs_.a.announce(frame);
    if (paths_.b.size() > 1) inputs_.b->announce(frame);
  };
  // Else the step before has announced this frame.
  if (later > 0 && !share_.has(later - 1)) announceFrame(later);
  announceFrame(later + 1);
}

StepResult StepMaker::query(const SceneFrame& from, const SceneFrame& to,
                            std::unique_ptr<Scene>& scene, std::size_t step) const {
  const auto namingFiles = [&](const char* what) {
    std::string name;
    for (const std::string& file : paths_.filesOf(step)) name += file + ' ';
    name.back() = ':';
    return std::runtime_error(name + ' ' + what);
  };
  try {
    const bool is_new = scene == nullptr;
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

StepRecord StepMaker::record(const StepReport& report) const {
  StepRecord record;
  record.number = report.number;
  record.summary = summaryOf(report);
  record.row = tableRow(report);
  if (!options_.contacts_path.empty())
    record.contact_lines = contactLines(report, options_.columns);
  if (!options_.steps_path.empty()) record.step_line = stepLine(report);
  if (!options_.json_path.empty()) record.json = toJson(report).dump();
  return record;
}

void StepMaker::show(const StepReport& report, std::size_t step, bool may_be_first,
                     const SceneFrame& from, const SceneFrame& to,
                     StepRecord& record) const {
  const SceneContact* earliest = report.result.earliest();
  const SceneTriangles triangles = inputs_.triangles();
  const ShownMoments& shown = options_.shown;
  const StepMoment first{report.number, earliest != nullptr ? earliest->toc_lo : 1},
      moment{report.number, shown.time.value_or(first.time)};
  const auto has = [&](const std::string& path) {
    return !path.empty() &&
           (shown.isOfFirstContact(path) ? may_be_first : shown.has(report.number, path));
  };
  if (has(options_.paint_path)) {
    const PaintedMesh painted = paint(triangles, from, to, moment.time, report.result);
    record.painted = encodePaintedPly(painted.mesh, painted.colours);
  }
  if (has(options_.picture_path))
    record.picture = drawContact(triangles, from, to, moment, report.result);
  if (options_.report_path.empty()) return;
  if (step == first_step_) record.page = pageMesh(triangles, from, grid_);
  // Such a frame takes the bytes of five others; to add up 16 takes a tenth of a second.
  constexpr std::size_t kKeySteps = 16;
  const std::size_t done = step - first_step_;
  record.page +=
      pageStep(report, triangles, from, to, grid_, done > 0 && done % kKeySteps == 0);
  if (!may_be_first) return;
  const bool is_drawn = !record.picture.empty() && moment.time == first.time;
  record.page_picture =
      is_drawn ? record.picture : drawContact(triangles, from, to, first, report.result);
}

}  // namespace fcl_ccd

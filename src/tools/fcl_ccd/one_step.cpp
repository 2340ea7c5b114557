// SPDX-License-Identifier: BSD-3-Clause
#include "one_step.h"

#include <cstdio>
#include <stdexcept>

#include "counted.h"
#include "text_scan.h"

namespace fcl_ccd {

template <typename Work>
auto OneStep::namingFrames(Work work) {
  const auto place = [&] {
    std::string names;
    for (const std::string& file : files())
      names.append(names.empty() ? "" : " ").append(file);
    return names;
  };
  return namingPlace(place, work);
}

OneStep::OneStep(const RunOptions& options)
    : options_(options), paths_(listFrames(options)) {
  if (paths_.a.size() != 2)
    throw std::runtime_error("A has " + counted(paths_.a.size(), "frame") +
                             ", but this command has one step. Name two frames");
}

void OneStep::read() {
  std::vector<std::string> notes;
  inputs_.emplace(openInputs(paths_, options_, 1, notes));
  for (const std::string& note : notes)
    std::fprintf(stderr, "fcl-ccd: %s\n", note.c_str());
  to_a_ = inputs_->a.read(1);
  if (inputs_->bMoves()) to_b_ = inputs_->b->read(1);
  namingFrames([&] {
    scene_ = std::make_unique<Scene>(inputs_->triangles(), from(), options_.settings);
  });
}

std::vector<SceneCandidate> OneStep::candidates() {
  return namingFrames([&] { return scene_->candidates(from(), to()); });
}

StepResult OneStep::query() {
  return namingFrames([&] { return scene_->step(from(), to()); });
}

}  // namespace fcl_ccd

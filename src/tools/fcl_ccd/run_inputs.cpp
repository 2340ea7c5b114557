// SPDX-License-Identifier: BSD-3-Clause
#include "run_inputs.h"

#include <algorithm>

#include "in_order.h"
#include "mesh/vertex_weld.h"
#include "stop_signal.h"
#include "weld.h"

namespace fcl_ccd {
namespace {

bool goOn() { return stopSignal() == 0; }

void requireNoSignal() {
  if (!goOn())
    throw StoppedBySignal(
        "stopped by a signal before the first step. No file was written");
}

/// A number in the form 86,400.
std::string withCommas(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

void checkFrames(const MeshSequence& meshes, std::size_t num_workers) {
  // Many frames are checked in one task, since a check takes less time than the change to
  // another thread.
  constexpr std::size_t kBlock = 32;
  inOrder<bool>(
      0, (meshes.size() + kBlock - 1) / kBlock, num_workers,
      [&](std::size_t block, std::size_t) {
        const std::size_t end = std::min(meshes.size(), (block + 1) * kBlock);
        for (std::size_t frame = block * kBlock; frame < end && goOn(); ++frame)
          if (frame > 0) meshes.check(frame);
        return true;
      },
      [](std::size_t, bool) {}, goOn);
  requireNoSignal();
}

/// Reads every frame, which also checks it. With a distance a frame may be read several
/// times.
void weldFrames(MeshSequence& meshes, double eps, std::vector<std::string>& notes) {
  fcl::detail::deformable::VertexWeld weld(meshes.firstVertices().size(), eps);
  weld.refineByAll(meshes.size(), [&](std::size_t frame) {
    requireNoSignal();
    if (frame == 0) return weld.refine(meshes.firstVertices().data()->data());
    return weld.refine(meshes.read(frame).data()->data());
  });
  meshes.join(weld.map());
  notes.push_back(meshes.path(0) + ": " + withCommas(weld.numJoined()) + " of " +
                  withCommas(weld.map().size()) + " vertices joined");
}

MeshSequence openSequence(const std::vector<std::string>& paths,
                          const RunOptions& options, std::size_t num_workers,
                          std::vector<std::string>& notes) {
  const std::string gaps = noteOnGaps(paths);
  if (!gaps.empty()) notes.push_back(gaps);
  MeshSequence meshes(paths);
  if (options.weld) {
    weldFrames(meshes, *options.weld, notes);
    return meshes;
  }
  checkFrames(meshes, num_workers);
  if (isSoup(meshes.firstVertices(), meshes.triangles()))
    notes.push_back(meshes.path(0) + ": " + withCommas(meshes.firstVertices().size()) +
                    " vertices, none shared: neighbours will be reported as contacts; " +
                    "pass --weld to join them");
  return meshes;
}

}  // namespace

std::vector<std::string> FramePaths::filesOf(std::size_t step) const {
  std::vector<std::string> files{a[step], a[step + 1]};
  if (b.size() == 1) files.push_back(b[0]);
  if (b.size() > 1) files.insert(files.end(), {b[step], b[step + 1]});
  return files;
}

FramePaths listFrames(const RunOptions& options) {
  const auto isFile = [](const std::vector<std::string>& words) {
    return words.size() == 1 && listFrames(words, {}) == words;
  };
  FramePaths paths;
  paths.a = listFrames(options.frames, options.range);
  if (paths.a.size() < 2)
    throw std::runtime_error("A needs two frames or more; there is only " + paths.a[0] +
                             ". Name two files, or a folder of frames");
  if (options.against.empty()) return paths;
  paths.b =
      listFrames(options.against, isFile(options.against) ? FrameRange() : options.range);
  if (paths.b.size() != 1 && paths.b.size() != paths.a.size())
    throw std::runtime_error("A has " + std::to_string(paths.a.size()) +
                             " frames and B " + std::to_string(paths.b.size()) +
                             "; B needs as many, or one if it does not move");
  return paths;
}

RunInputs openInputs(const FramePaths& paths, const RunOptions& options,
                     std::size_t num_workers, std::vector<std::string>& notes) {
  RunInputs inputs{openSequence(paths.a, options, num_workers, notes), std::nullopt};
  if (!paths.b.empty())
    inputs.b.emplace(openSequence(paths.b, options, num_workers, notes));
  return inputs;
}

}  // namespace fcl_ccd

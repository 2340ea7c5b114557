// SPDX-License-Identifier: BSD-3-Clause
#include "run_inputs.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

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

/// The first of the frames from `begin` on that does not fit.
std::optional<FrameFault> findFault(const MeshSequence& meshes, std::size_t begin,
                                    std::size_t num_workers) {
  // Many frames are checked in one task, since a check takes less time than the change to
  // another thread.
  constexpr std::size_t kBlock = 32;
  if (meshes.size() <= begin) return std::nullopt;
  const std::size_t num_blocks = (meshes.size() - begin + kBlock - 1) / kBlock;
  std::optional<FrameFault> first;
  inOrder<std::optional<FrameFault>>(
      0, num_blocks, std::min(num_workers, num_blocks),
      [&](std::size_t block, std::size_t) -> std::optional<FrameFault> {
        std::size_t frame = begin + block * kBlock;
        const std::size_t end = std::min(meshes.size(), frame + kBlock);
        try {
          for (; frame < end && goOn(); ++frame) meshes.check(frame);
        } catch (const std::runtime_error& error) {
          return FrameFault{frame, error.what()};
        }
        return std::nullopt;
      },
      [&](std::size_t, const std::optional<FrameFault>& fault) {
        if (!first) first = fault;
      },
      [&] { return !first && goOn(); });
  requireNoSignal();
  // Two frames are those that the user has named.
  const std::size_t last = meshes.size() - 1;
  if (!first && last >= std::max(begin, std::size_t{2}) &&
      meshes.mayEndInACutNumber(last))
    first = FrameFault{last, meshes.path(last) + ": ends in the middle of a line"};
  return first;
}

/// The frames at the end that are still being written, or nothing.
/// @throws std::runtime_error if a frame does not fit and is none of these.
std::optional<FrameFault> findUnfinished(const MeshSequence& meshes, std::size_t begin,
                                         std::size_t num_workers) {
  std::optional<FrameFault> fault = findFault(meshes, begin, num_workers);
  if (!fault) return fault;
  const auto fits = [&](std::size_t frame) {
    try {
      meshes.check(frame);
    } catch (const std::runtime_error&) {
      return false;
    }
    return true;
  };
  for (std::size_t frame = fault->frame; frame < meshes.size(); ++frame)
    if (!meshes.mayBeginAFrame(frame) || (frame > fault->frame && fits(frame)))
      throw std::runtime_error(fault->cause);
  return fault;
}

/// The one that comes first.
std::optional<FrameFault> earlier(const std::optional<FrameFault>& a,
                                  const std::optional<FrameFault>& b) {
  if (!a || !b) return a ? a : b;
  return b->frame < a->frame ? b : a;
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
                          std::vector<std::string>& notes,
                          std::optional<FrameFault>& unfinished) {
  const std::string gaps = noteOnGaps(paths);
  if (!gaps.empty()) notes.push_back(gaps);
  MeshSequence meshes(paths);
  if (options.weld) {
    weldFrames(meshes, *options.weld, notes);
    return meshes;
  }
  unfinished = earlier(unfinished, findUnfinished(meshes, 1, num_workers));
  if (isSoup(meshes.firstVertices(), meshes.triangles()))
    notes.push_back(meshes.path(0) + ": " + withCommas(meshes.firstVertices().size()) +
                    " vertices, none shared: neighbours will be reported as contacts; " +
                    "pass --weld to join them");
  return meshes;
}

/// Whether the frames begin with those that were there before.
/// @throws std::runtime_error if they do not, and a file of theirs is the cause. A list
/// of A may also be shorter because a file of B is missing, or the other way round.
bool haveSameBeginning(const std::vector<std::string>& before,
                       const std::vector<std::string>& now) {
  const auto [old, other] =
      std::mismatch(before.begin(), before.end(), now.begin(), now.end());
  if (old == before.end()) return true;
  std::error_code error;
  if (!std::filesystem::exists(*old, error))
    throw std::runtime_error(*old + ": was taken away while the run used it");
  if (std::find(now.begin(), now.end(), *old) == now.end()) return false;
  throw std::runtime_error(*other +
                           ": came when later frames had been used. With a name " +
                           "such as frame_%04d.ply the run waits for a missing number");
}

}  // namespace

void FramePaths::shorten(std::size_t num_frames) {
  a.resize(std::min(a.size(), num_frames));
  if (!b_is_still) b.resize(std::min(b.size(), num_frames));
}

std::vector<std::string> FramePaths::filesOf(std::size_t step) const {
  std::vector<std::string> files{a[step], a[step + 1]};
  if (b_is_still) files.push_back(b[0]);
  if (!b_is_still && !b.empty()) files.insert(files.end(), {b[step], b[step + 1]});
  return files;
}

FramePaths listFrames(const RunOptions& options) {
  const auto isFile = [](const std::vector<std::string>& words) {
    if (words.size() != 1) return false;
    FrameRange whole;
    whole.is_growing = true;
    return listFrames(words, whole) == words;
  };
  const bool is_growing = options.range.is_growing;
  FramePaths paths;
  paths.a = listFrames(options.frames, options.range, &paths.numbers);
  if (paths.a.size() < 2 && !is_growing)
    throw std::runtime_error("A needs two frames or more; there is only " + paths.a[0] +
                             ". Name two files, or a folder of frames");
  if (options.against.empty()) return paths;
  const bool b_is_file = isFile(options.against);
  paths.b = listFrames(options.against, b_is_file ? FrameRange() : options.range);
  paths.b_is_still = is_growing ? b_is_file : paths.b.size() == 1;
  if (paths.b_is_still) return paths;
  if (is_growing)
    paths.shorten(std::min(paths.a.size(), paths.b.size()));
  else if (paths.b.size() != paths.a.size())
    throw std::runtime_error("A has " + std::to_string(paths.a.size()) +
                             " frames and B " + std::to_string(paths.b.size()) +
                             "; B needs as many, or one if it does not move");
  return paths;
}

void RunInputs::shorten(std::size_t num_frames) {
  const bool b_moves = bMoves();
  a.shorten(num_frames);
  if (b_moves) b->shorten(num_frames);
}

RunInputs openInputs(FramePaths& paths, const RunOptions& options,
                     std::size_t num_workers, std::vector<std::string>& notes) {
  std::optional<FrameFault> unfinished;
  RunInputs inputs{openSequence(paths.a, options, num_workers, notes, unfinished),
                   std::nullopt, std::nullopt};
  if (!paths.b.empty())
    inputs.b.emplace(openSequence(paths.b, options, num_workers, notes, unfinished));
  if (!unfinished) return inputs;
  const std::size_t least = options.range.is_growing ? 1 : 2;
  if (unfinished->frame < least) throw std::runtime_error(unfinished->cause);
  inputs.unfinished = unfinished;
  inputs.shorten(unfinished->frame);
  paths.shorten(unfinished->frame);
  return inputs;
}

void addFrames(FramePaths& paths, RunInputs& inputs, const FramePaths& listed,
               std::size_t num_workers) {
  // If it is not known why frames are missing, the next list tells it.
  const bool has_a = haveSameBeginning(paths.a, listed.a);
  const bool has_b = paths.b_is_still || haveSameBeginning(paths.b, listed.b);
  if (!has_a || !has_b) return;
  const std::size_t begin = paths.a.size();
  const bool b_moves = !paths.b_is_still && inputs.b;
  const auto shorten = [&](std::size_t num_frames) {
    inputs.a.shorten(num_frames);
    if (b_moves) inputs.b->shorten(num_frames);
  };
  std::optional<FrameFault> fault;
  const auto addTo = [&](MeshSequence& meshes, const std::vector<std::string>& all) {
    meshes.add({all.begin() + static_cast<std::ptrdiff_t>(begin), all.end()});
    const std::optional<FrameFault> found = findFault(meshes, begin, num_workers);
    // Steps before a bad frame are done first. Then it is the next one.
    if (found && found->frame == begin && !meshes.mayBeginAFrame(begin))
      throw std::runtime_error(found->cause);
    fault = earlier(fault, found);
  };
  try {
    addTo(inputs.a, listed.a);
    if (b_moves) addTo(*inputs.b, listed.b);
  } catch (const StoppedBySignal&) {
    shorten(begin);
    return;
  }
  const FrameNumbers numbers = paths.numbers;
  paths = listed;
  paths.numbers = numbers;
  inputs.unfinished = fault;
  if (!fault) return;
  shorten(fault->frame);
  paths.shorten(fault->frame);
}

}  // namespace fcl_ccd

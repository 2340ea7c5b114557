// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_FRAME_STORE_H
#define FCL_CCD_FRAME_STORE_H

#include <cstddef>
#include <future>
#include <map>
#include <memory>
#include <mutex>

#include "mesh_sequence.h"
#include "step_share.h"

namespace fcl_ccd {

/// @brief The frames of a mesh for the steps of a share. Step i goes from frame i to
/// frame i + 1. Each frame is read once, by the thread that asks for it first, and is
/// dropped when those of its two steps that are in the share have it. A mesh with one
/// frame stands still.
class FrameStore {
 public:
  using Frame = std::shared_ptr<const Vertices>;

  FrameStore(const MeshSequence& meshes, const StepShare& share)
      : meshes_(meshes), share_(share) {}

  /// @brief Between two shares: the next one.
  void setShare(const StepShare& share) { share_ = share; }

  struct Pair {
    Frame from, to;
  };

  /// @brief Both frames of a step of the share. Call it once for each, on any thread.
  /// @throws std::runtime_error as MeshSequence::read().
  Pair take(std::size_t step);

 private:
  struct Entry {
    std::shared_future<Frame> frame;
    int uses_left{0};
  };

  Frame get(std::size_t frame);

  const MeshSequence& meshes_;
  StepShare share_;
  std::mutex mutex_;
  std::map<std::size_t, Entry> entries_;
};

}  // namespace fcl_ccd

#endif

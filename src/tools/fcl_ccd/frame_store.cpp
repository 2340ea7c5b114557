// SPDX-License-Identifier: BSD-3-Clause
#include "frame_store.h"

#include <cassert>
#include <exception>
#include <utility>

namespace fcl_ccd {

FrameStore::Pair FrameStore::take(std::size_t step) {
  if (meshes_.size() == 1) {
    // Not owned: the sequence has it.
    const Frame still(Frame(), &meshes_.firstVertices());
    return {still, still};
  }
  // Takes the later frame first: the thread that has the step before this one reads the
  // earlier frame already.
  Frame to = get(step + 1);
  return {get(step), std::move(to)};
}

FrameStore::Frame FrameStore::get(std::size_t frame) {
  std::promise<Frame> promise;
  std::shared_future<Frame> future;
  bool is_ours = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto [at, is_new] = entries_.try_emplace(frame);
    if (is_new) {
      at->second.frame = promise.get_future().share();
      at->second.uses_left =
          (frame > 0 && share_.has(frame - 1) ? 1 : 0) + (share_.has(frame) ? 1 : 0);
      is_ours = true;
    }
    future = at->second.frame;
    assert(at->second.uses_left > 0);
    if (--at->second.uses_left == 0) entries_.erase(at);
  }
  if (is_ours) {
    try {
      promise.set_value(std::make_shared<const Vertices>(meshes_.read(frame)));
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
  }
  return future.get();
}

}  // namespace fcl_ccd

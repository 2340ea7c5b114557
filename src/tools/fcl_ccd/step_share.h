// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STEP_SHARE_H
#define FCL_CCD_STEP_SHARE_H

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace fcl_ccd {

/// @brief The steps of one rank. The ranks take the steps of a run in turn, a block of
/// them at a time. Within a block a frame serves two steps and is read once.
struct StepShare {
  /// Steps of a block. Larger blocks read fewer frames twice; but the ranks keep more
  /// results until it is the turn of their block, and the last blocks are less even.
  static constexpr std::size_t kBlock = 4;

  std::size_t first{0};  ///< of the run
  std::size_t end{0};    ///< of the run
  std::size_t rank{0};
  std::size_t num_ranks{1};

  std::size_t rankOf(std::size_t step) const {
    assert(step >= first && rank < num_ranks);
    return (step - first) / kBlock % num_ranks;
  }
  bool has(std::size_t step) const {
    return step >= first && step < end && rankOf(step) == rank;
  }
  /// @brief The number of steps of the share.
  std::size_t size() const {
    if (first >= end) return 0;
    const std::size_t round = kBlock * num_ranks;
    const std::size_t rest = (end - first) % round, before = kBlock * rank;
    return (end - first) / round * kBlock +
           (rest > before ? std::min(rest - before, kBlock) : 0);
  }
  /// @brief The i-th step of the share. From size() on it is not below `end`.
  std::size_t operator[](std::size_t i) const {
    return first + (i / kBlock * num_ranks + rank) * kBlock + i % kBlock;
  }
};

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_PARALLEL_H
#define FCL_CCD_BASE_PARALLEL_H

#include <algorithm>
#include <cstddef>
#include <functional>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Calls visit(0) ... visit(count - 1), each once, in the default floating-point
/// mode; on one thread in this order and without a task. An exception of the lowest index
/// is passed on once no call runs.
/// @param num_threads  at most so many; 0: as many as the task arena around has. Without
/// oneTBB always one.
void parallelFor(std::size_t count, int num_threads,
                 const std::function<void(std::size_t)>& visit);

/// @brief Calls work() once, on this thread. What it does with parallelFor() and the same
/// number shares one task arena, which each call would make for itself otherwise. Without
/// such calls, or for one thread, nothing is made.
void inArena(int num_threads, const std::function<void()>& work);

/// @brief How many threads parallelFor() uses.
int numThreads(int num_threads);

/// @brief parallelFor() over the blocks of 0 ... count - 1, all of one length but for the
/// last: calls visit(first, last) for each. The blocks are the same for any number of
/// threads.
template <typename Visit>
void parallelForBlocks(std::size_t count, std::size_t length, int num_threads,
                       Visit&& visit) {
  parallelFor((count + length - 1) / length, num_threads, [&](std::size_t block) {
    visit(block * length, std::min(count, (block + 1) * length));
  });
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_PARALLEL_H
#define FCL_CCD_BASE_PARALLEL_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <functional>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Calls visit(0) ... visit(count - 1), each once, in the default floating-point
/// mode. One thread does it in this order and without a task. If calls throw, the
/// exception of the lowest index is thrown after all running calls have ended.
/// @param num_threads  the largest number of threads; 0: as many as the task arena around
/// the call has. Without oneTBB it is always one.
void parallelFor(std::size_t count, int num_threads,
                 const std::function<void(std::size_t)>& visit);

/// @brief Calls work() once, on this thread. All its calls of parallelFor() with the same
/// number share one task arena. Otherwise each call would make its own. Without such
/// calls, or for one thread, no arena is made.
void inArena(int num_threads, const std::function<void()>& work);

/// @brief The number of threads that parallelFor() uses.
int numThreads(int num_threads);

/// @brief Divides 0 ... count - 1 into blocks of one length (the last may be shorter),
/// and calls visit(first, last) for each by parallelFor(). The blocks are the same for
/// any number of threads.
template <typename Visit>
void parallelForBlocks(std::size_t count, std::size_t length, int num_threads,
                       Visit&& visit) {
  assert(length > 0);
  parallelFor((count + length - 1) / length, num_threads, [&](std::size_t block) {
    visit(block * length, std::min(count, (block + 1) * length));
  });
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

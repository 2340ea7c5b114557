// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"

#include <cassert>

#if defined(FCL_CCD_USE_TBB)
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <vector>
#endif

#include "base/default_floating_point.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

void forEach(std::size_t count, const std::function<void(std::size_t)>& visit) {
  const DefaultFloatingPoint mode;
  for (std::size_t i = 0; i < count; ++i) {
    visit(i);
    assert(isDefaultFloatingPointMode());
  }
}

}  // namespace

#if defined(FCL_CCD_USE_TBB)

int numThreads(int num_threads) {
  assert(num_threads >= 0);
  if (num_threads == 1) return 1;
  const int available = tbb::this_task_arena::max_concurrency();
  assert(available >= 1);
  return num_threads > 0 ? std::min(num_threads, available) : available;
}

void parallelFor(std::size_t count, int num_threads,
                 const std::function<void(std::size_t)>& visit) {
  const int threads = numThreads(num_threads);
  if (threads <= 1 || count <= 1) return forEach(count, visit);

  std::vector<std::exception_ptr> errors(count);
  const auto run = [&] {
    tbb::parallel_for(
        std::size_t{0}, count,
        [&](std::size_t i) {
          const DefaultFloatingPoint mode;
          try {
            visit(i);
            assert(isDefaultFloatingPointMode());
          } catch (...) {
            errors[i] = std::current_exception();
          }
        },
        tbb::simple_partitioner());
  };
  // Isolated: while the caller waits, its thread does not begin other tasks of the
  // caller. They may need a lock that it holds.
  if (threads == tbb::this_task_arena::max_concurrency())
    tbb::this_task_arena::isolate(run);
  else
    tbb::task_arena(threads).execute(run);
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

void inArena(int num_threads, const std::function<void()>& work) {
  const int threads = numThreads(num_threads);
  if (threads <= 1 || threads == tbb::this_task_arena::max_concurrency()) return work();
  tbb::task_arena(threads).execute(work);
}

#else

int numThreads([[maybe_unused]] int num_threads) {
  assert(num_threads >= 0);
  return 1;
}

void inArena(int, const std::function<void()>& work) { work(); }

void parallelFor(std::size_t count, int, const std::function<void(std::size_t)>& visit) {
  forEach(count, visit);
}

#endif

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_QUERY_PROGRESS_H
#define FCL_CCD_QUERY_QUERY_PROGRESS_H

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What the tasks of a query tell each other, so that none does work that cannot
/// change the answer. Tasks have numbers. So the answer does not depend on which thread
/// is faster.
struct QueryProgress {
  /// The earliest upper end of a bracket so far. An error counts as a contact at the time
  /// from which on its triangles may touch.
  std::atomic<double> first_hi{1};
  /// The earliest lower end of a bracket so far.
  std::atomic<double> first_lo{1};
  /// The lowest number of a task that has found an answer of the whole query, or an error
  /// instead.
  std::atomic<std::size_t> answered_by{static_cast<std::size_t>(-1)};
  /// The lowest number of a task that has found a crossing. Those of later tasks do not
  /// matter, unless all are wanted.
  std::atomic<std::size_t> crossed_by{static_cast<std::size_t>(-1)};
  /// The lowest ContactSink::lastVertexAtStart(), with a distance. A task that has this
  /// bound has as many contacts before it as are wanted, so it holds for all tasks.
  std::atomic<std::uint32_t> last_vertex{~std::uint32_t{0}};
  /// The lowest ContactSink::latestKept() in a query for all contacts. It holds for all
  /// tasks for the same reason.
  std::atomic<double> latest_kept{1};

  template <typename T>
  static void lower(std::atomic<T>& value, T to) {
    T now = value.load(std::memory_order_relaxed);
    while (to < now && !value.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
    }
  }
};

/// @brief A vertex that is not finite. It belongs to two triangles whose boxes overlap
/// from `earliest` on.
struct QueryError {
  float earliest;
  const char* mesh;
  std::size_t vertex;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

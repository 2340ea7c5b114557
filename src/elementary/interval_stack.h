// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_ELEMENTARY_INTERVAL_STACK_H
#define FCL_CCD_ELEMENTARY_INTERVAL_STACK_H

#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Intervals that are still to be examined, the earliest on top. Each look
/// replaces one interval by at most three, and the number of looks is limited, so the
/// stack is never full.
/// @tparam Interval  from `lo` to `hi`
/// @tparam kLooks  the largest number of looks
template <typename Interval, int kLooks>
class IntervalStack {
 public:
  static constexpr int kMaxLooks = kLooks;

  void push(const Interval& interval) {
    assert(size_ < kCapacity);
    assert(!(interval.hi < interval.lo));
    items_[size_++] = interval;
  }
  Interval pop() {
    assert(!isEmpty());
    return items_[--size_];
  }
  bool isEmpty() const { return size_ == 0; }
  /// @brief The interval that comes last in time.
  const Interval& latest() const {
    assert(!isEmpty());
    return items_[0];
  }

 private:
  static constexpr int kCapacity = 2 * kMaxLooks + 3;

  Interval items_[kCapacity];
  int size_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion_work.h"

#include <algorithm>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The parts of a dive come first, and the deepest ones among them. Other work is sorted
/// by start time. If the times are equal, for example t = 0, pieces deeper in the trees
/// come first. The other comparisons make the order depend on the pieces alone.
bool isLater(const MotionWork& x, const MotionWork& y) {
  if (x.dive != y.dive) return x.dive < y.dive;
  if (x.start != y.start) return x.start > y.start;
  const std::int64_t x_depth = std::int64_t{x.a.box} + x.b.box,
                     y_depth = std::int64_t{y.a.box} + y.b.box;
  if (x_depth != y_depth) return x_depth < y_depth;
  if (x.a.box != y.a.box) return x.a.box < y.a.box;
  return x.t0 > y.t0;
}

}  // namespace

void MotionWorkQueue::push(const MotionWork& work) {
  works_.push_back(work);
  if (work.dive > 0) ++works_.back().dive;
  std::push_heap(works_.begin(), works_.end(), isLater);
}

// Each dive begins at twice the number of pieces of the last one, and takes a fourth of
// these and a few more, so that it reaches the triangles.
MotionWork MotionWorkQueue::pop() {
  constexpr int kDepth = 8;
  if (++num_popped_ == end_of_dive_) endDive();
  std::pop_heap(works_.begin(), works_.end(), isLater);
  MotionWork work = works_.back();
  works_.pop_back();
  if (dives_ && num_popped_ == next_dive_) {
    work.dive = 1;
    end_of_dive_ = next_dive_ + next_dive_ / 8 + kDepth;
    next_dive_ *= 2;
  }
  return work;
}

void MotionWorkQueue::endDive() {
  for (MotionWork& work : works_) work.dive = 0;
  std::make_heap(works_.begin(), works_.end(), isLater);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

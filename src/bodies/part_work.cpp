// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/part_work.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The parts of a dive come first, and the deepest ones among them. Other work is sorted
/// by start time. If the times are equal, for example t = 0, pieces deeper in the trees
/// come first. The other comparisons make the order depend on the pieces alone.
bool isLater(const PartWork& x, const PartWork& y) {
  if (x.dive != y.dive) return x.dive < y.dive;
  if (x.start != y.start) return x.start > y.start;
  const std::int64_t x_depth = std::int64_t{x.a.box} + x.b.box,
                     y_depth = std::int64_t{y.a.box} + y.b.box;
  if (x_depth != y_depth) return x_depth < y_depth;
  if (x.a.box != y.a.box) return x.a.box < y.a.box;
  return x.t0 > y.t0;
}

}  // namespace

void PartWorkQueue::push(const PartWork& work) {
  assert(!(work.start < work.t0) && work.steps >= 0 && work.dive >= 0);
  if (order_ == Order::kAny || (work.dive == 0 && work.start < horizon_))
    return ready_.push_back(work);
  heap_.push_back(work);
  if (work.dive > 0) ++heap_.back().dive;
  std::push_heap(heap_.begin(), heap_.end(), isLater);
}

// Each dive begins at twice the number of pieces of the last one, and takes an eighth of
// its number and a few more, so that it reaches the triangles.
PartWork PartWorkQueue::pop() {
  constexpr int kDepth = 8;
  assert(!isEmpty());
  if (++num_popped_ == end_of_dive_) endDive();
  const bool dives = !heap_.empty() && heap_.front().dive > 0;
  PartWork work;
  if (ready_.empty() || dives) {
    work = popHeap();
  } else {
    work = ready_.back();
    ready_.pop_back();
  }
  if (num_popped_ == next_dive_) {
    end_of_dive_ = next_dive_ + next_dive_ / 8 + kDepth;
    next_dive_ *= 2;
  }
  // Where the parts of one piece had no contact it goes on with another one.
  if (order_ == Order::kEarliestFirst && num_popped_ < end_of_dive_)
    work.dive = std::max(work.dive, 1);
  return work;
}

// The period is a compromise. What starts in one period is taken in any order. A longer
// one makes queries without a contact faster. But more work is done that starts after the
// first contact, so queries with a contact become slower. An eighth of the step makes
// both faster than the strict order does, a half only those without a contact.
PartWork PartWorkQueue::popHeap() {
  constexpr std::size_t kMany = 4096;
  constexpr double kPeriod = 0x1p-3;
  std::pop_heap(heap_.begin(), heap_.end(), isLater);
  const PartWork work = heap_.back();
  heap_.pop_back();
  if (ready_.empty())
    horizon_ =
        heap_.size() > kMany ? (std::floor(work.start / kPeriod) + 1) * kPeriod : 0;
  assert(heap_.empty() || !isLater(work, heap_.front()));
  return work;
}

double PartWorkQueue::nextTurn(const PartWork& work) const {
  if (order_ == Order::kAny || work.dive > 0) return HUGE_VAL;
  if (!ready_.empty()) return horizon_;
  return heap_.empty() ? HUGE_VAL : heap_.front().start;
}

void PartWorkQueue::endDive() {
  end_of_dive_ = 0;
  for (PartWork& work : heap_) work.dive = 0;
  std::make_heap(heap_.begin(), heap_.end(), isLater);
}

void PartWorkQueue::keepEarlier(double end) {
  for (auto* works : {&ready_, &heap_})
    works->erase(std::remove_if(works->begin(), works->end(),
                                [end](const PartWork& x) { return x.start >= end; }),
                 works->end());
  endDive();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

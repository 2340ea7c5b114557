// SPDX-License-Identifier: BSD-3-Clause
//
// The order in which a query looks at the parts of two bodies.
#ifndef FCL_CCD_BODIES_PART_WORK_H
#define FCL_CCD_BODIES_PART_WORK_H

#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "bodies/moving_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two parts in a span of time.
struct PartWork {
  /// From t0 to this time the parts are provably apart.
  double start;
  double t0, t1;
  BodyPart a, b;
  std::int32_t steps;
  /// How often it was divided since the dive began that it belongs to; 0: to none.
  std::int32_t dive;
  /// Whether its span is one of many for parts that are tiny beside their deviations.
  bool is_one_of_many{false};
  /// Whether the parts are apart in shorter spans: MeetingWindows::soon_apart.
  bool is_soon_apart{false};
  /// The number by which the traversal counts the steps of a pair in the halves of one
  /// span; -1: the span was not halved while the pair was advanced.
  std::int32_t halves{-1};
};

/// @brief Hands out work. Where one contact is enough, the earliest comes first, but for
/// two cases.
///
/// Now and then it dives: it looks in the depth for a contact, which need not be the
/// first one. Where thousands of pairs touch at nearly the same time, the order by start
/// alone would look at all of them until just before that time, and find no contact whose
/// direction may part the others. A dive ends with a contact, or when it took as many
/// pieces as it may: dives take a quarter of the work at most. What a query pushes as a
/// part of a dive comes next, too.
///
/// If much work waits, pieces that come of one follow it as long as they start in the
/// same eighth of the step, the last one first: what was found together needs the same
/// nodes and poses, and a long heap is slow.
class PartWorkQueue {
 public:
  enum class Order {
    kEarliestFirst,
    /// The last one first.
    kAny
  };
  explicit PartWorkQueue(Order order) : order_(order) {}

  bool isEmpty() const { return heap_.empty() && ready_.empty(); }

  void push(const PartWork& work);

  /// @brief Moves all work out, in the order in which it came.
  /// @pre the order is kAny
  std::vector<PartWork> takeAll() {
    assert(order_ == Order::kAny && heap_.empty());
    return std::exchange(ready_, {});
  }

  /// @brief The work that comes next. Its parts belong to its dive.
  PartWork pop();

  /// @brief The time at which other work has its turn, if it waits; else infinite.
  /// @param work  the last that was handed out
  double nextTurn(const PartWork& work) const;

  /// @brief Whether so much work was handed out that many pairs may touch at one time.
  bool isLong() const { return num_popped_ >= kFirstDive; }

  /// @brief Drops work that starts at a time or later, when a contact was found then. A
  /// dive ends with it.
  void keepEarlier(double end);

 private:
  void endDive();
  PartWork popHeap();

  static constexpr std::int64_t kFirstDive = 192;
  Order order_;
  /// Work that starts before the horizon, or all where the order does not matter. The
  /// last one is taken first.
  std::vector<PartWork> ready_;
  double horizon_{0};
  /// The other work, and the parts of a dive.
  std::vector<PartWork> heap_;
  std::int64_t num_popped_{0};
  /// The numbers of the pieces of work at which a dive begins and ends.
  std::int64_t next_dive_{kFirstDive}, end_of_dive_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

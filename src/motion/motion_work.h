// SPDX-License-Identifier: BSD-3-Clause
//
// The order in which a query looks at the parts of two bodies.
#ifndef FCL_CCD_MOTION_MOTION_WORK_H
#define FCL_CCD_MOTION_MOTION_WORK_H

#include <cstdint>
#include <vector>

#include "motion/motion_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two parts in a span of time.
struct MotionWork {
  /// From t0 to this time the parts are provably apart.
  double start;
  double t0, t1;
  BodyPart a, b;
  std::int32_t steps;
  /// How often it was divided since the dive began that it belongs to; 0: to none.
  std::int32_t dive;
};

/// @brief Hands out work in the order of its start. Now and then it dives: it looks in
/// the depth for a contact, which need not be the first one. Where thousands of pairs
/// touch at nearly the same time, the order by start alone would look at all of them
/// until just before that time, and find no contact whose direction may part the others.
/// Dives take a quarter of the work at most.
class MotionWorkQueue {
 public:
  /// @param dives  whether one contact is enough
  explicit MotionWorkQueue(bool dives) : dives_(dives) {}

  bool isEmpty() const { return works_.empty(); }

  /// @brief The start of the work that comes next.
  double nextStart() const { return works_.front().start; }

  void push(const MotionWork& work);

  /// @brief The work that comes next. Its parts belong to the same dive.
  MotionWork pop();

  /// @brief Whether so much work was handed out that many pairs may touch at one time.
  bool isLong() const { return num_popped_ >= kFirstDive; }

  /// @brief Ends a dive that has found a contact.
  void endDive();

 private:
  static constexpr std::int64_t kFirstDive = 192;
  std::vector<MotionWork> works_;
  bool dives_;
  std::int64_t num_popped_{0};
  /// The numbers of the pieces of work at which a dive begins and ends.
  std::int64_t next_dive_{kFirstDive}, end_of_dive_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

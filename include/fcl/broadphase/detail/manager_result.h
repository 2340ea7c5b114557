// SPDX-License-Identifier: BSD-3-Clause
//
// The answer of a ContinuousCollisionManager: pairs of objects in contact.
#ifndef FCL_BROADPHASE_DETAIL_MANAGER_RESULT_H
#define FCL_BROADPHASE_DETAIL_MANAGER_RESULT_H

#include <cstddef>
#include <vector>

#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {

/// @brief Two objects in contact. A mesh in contact with itself is both of them.
template <typename S>
struct ContinuousPairResult {
  ContinuousCollisionObject<S>* o1{nullptr};
  ContinuousCollisionObject<S>* o2{nullptr};

  /// @brief The answer of continuousCollide() for the two, o1 first.
  ContinuousContactResult<S> result;
};

/// @brief The answer for many objects.
template <typename S>
struct ContinuousManagerResult {
  bool is_collide{false};

  /// @brief The time of the first contact among `pairs`, in fractions of the step; never
  /// later than the true one. With ContinuousQuery::kAny that of the contact that was
  /// found. 1 without collision.
  S time_of_contact{1};

  /// @brief ContinuousQuery::kFirst: the pair that is first in contact. kAny: one pair
  /// that is in contact. kAll: all pairs in contact, sorted by their time of contact. If
  /// times are equal, the order of the box pairs decides.
  std::vector<ContinuousPairResult<S>> pairs;

  /// @brief The number of pairs whose boxes meet.
  std::size_t num_box_pairs{0};

  /// @brief The number of pairs that were tested.
  std::size_t num_tested{0};
};

using ContinuousManagerResultf = ContinuousManagerResult<float>;
using ContinuousManagerResultd = ContinuousManagerResult<double>;

}  // namespace fcl

#endif

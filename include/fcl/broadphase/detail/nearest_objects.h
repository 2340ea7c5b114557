// SPDX-License-Identifier: BSD-3-Clause
//
// How near many objects come to each other: the answer of a ContinuousCollisionManager,
// and a callback in the way of FCL's.
#ifndef FCL_BROADPHASE_DETAIL_NEAREST_OBJECTS_H
#define FCL_BROADPHASE_DETAIL_NEAREST_OBJECTS_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>

#include "fcl/narrowphase/collision_object.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/continuous_distance.h"

namespace fcl {

/// @brief The least distance of many objects during the step.
template <typename S>
struct ContinuousManagerDistance {
  /// @brief The two objects that come nearest; null if no distance was computed: no pair
  /// counts, or all stay further apart than max_distance.
  ContinuousCollisionObject<S>* o1{nullptr};
  ContinuousCollisionObject<S>* o2{nullptr};

  /// @brief The distance, of o1 and o2, and the bound for all pairs: no two objects are
  /// nearer than distance_lo during the step. Both distances are infinite if no pair
  /// counts; with a finite max_distance that is the same as if all were cut off. If any
  /// two objects touch, the answer is about the two that touch first.
  ContinuousDistanceResult<S> result;

  /// @brief The number of pairs whose distance was looked for.
  std::size_t num_tested{0};
};

using ContinuousManagerDistancef = ContinuousManagerDistance<float>;
using ContinuousManagerDistanced = ContinuousManagerDistance<double>;

namespace detail {

/// The answer without a pair.
template <typename S>
ContinuousManagerDistance<S> noPair() {
  ContinuousManagerDistance<S> none;
  none.result.distance_lo = none.result.distance_hi = std::numeric_limits<S>::infinity();
  return none;
}

/// @brief Takes the distance of two objects into the least of all.
template <typename S>
void takeDistance(ContinuousCollisionObject<S>* o1, ContinuousCollisionObject<S>* o2,
                  const ContinuousDistanceResult<S>& tested,
                  ContinuousManagerDistance<S>& nearest) {
  ++nearest.num_tested;
  const S lower = std::min(nearest.result.distance_lo, tested.distance_lo);
  if (tested.distance_hi < nearest.result.distance_hi) {
    nearest.o1 = o1;
    nearest.o2 = o2;
    nearest.result = tested;
  }
  nearest.result.distance_lo = lower;
  assert(!(nearest.result.distance_lo > nearest.result.distance_hi));
}

/// Whether both are planes or halfspaces. The node type of a mesh may not be asked for:
/// it is that of FCL's tree, which may be missing.
template <typename S>
bool areFlats(const ContinuousCollisionObject<S>& o1,
              const ContinuousCollisionObject<S>& o2) {
  const auto isFlat = [](const ContinuousCollisionObject<S>& o) {
    return o.getObjectType() == OT_GEOM &&
           (o.getNodeType() == GEOM_PLANE || o.getNodeType() == GEOM_HALFSPACE);
  };
  return isFlat(o1) && isFlat(o2);
}

}  // namespace detail

/// @brief For DefaultContinuousDistanceFunction(), in the way of FCL's
/// DefaultDistanceData.
template <typename S>
struct DefaultContinuousDistanceData {
  ContinuousDistanceRequest<S> request;

  /// @brief The nearest pair so far. Before the first one its distances are infinite.
  ContinuousManagerDistance<S> nearest{detail::noPair<S>()};

  /// @brief Whether no other pair can be nearer: two objects touch.
  bool done{false};
};

/// @brief A callback for ContinuousCollisionManager::distance(), in the way of FCL's
/// DefaultDistanceFunction: it keeps the nearest pair. If objects touch it stops at two
/// that do; which touch first, it does not say.
/// @param o1, o2  objects of the manager: their getUserData() are the ones that move
/// @param cdata  a DefaultContinuousDistanceData of the same number type
/// @param dist  is lowered to the least distance so far
/// @return whether the search may end
/// @throws fcl::Exception  as continuousDistance()
template <typename S>
bool DefaultContinuousDistanceFunction(CollisionObject<S>* o1, CollisionObject<S>* o2,
                                       void* cdata, S& dist) {
  auto& data = *static_cast<DefaultContinuousDistanceData<S>*>(cdata);
  if (data.done) return true;
  ContinuousDistanceRequest<S> request = data.request;
  request.max_distance = std::min(request.max_distance, dist);
  auto *moving1 = static_cast<ContinuousCollisionObject<S>*>(o1->getUserData()),
       *moving2 = static_cast<ContinuousCollisionObject<S>*>(o2->getUserData());
  ContinuousDistanceResult<S> tested;
  continuousDistance(moving1->collisionGeometry().get(), moving1->getMotion(),
                     moving2->collisionGeometry().get(), moving2->getMotion(), request,
                     tested);
  detail::takeDistance(moving1, moving2, tested, data.nearest);
  // Others stay further apart than is asked for.
  S& lower = data.nearest.result.distance_lo;
  lower = std::min(lower, data.request.max_distance);
  dist = std::min(request.max_distance, tested.distance_hi);
  data.done = tested.is_collide;
  return data.done;
}

}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// How a ContinuousCollisionManager finds the least distance of its objects. It is a part
// of the manager's header, which includes it at its end.
#ifndef FCL_BROADPHASE_DETAIL_MANAGER_DISTANCES_H
#define FCL_BROADPHASE_DETAIL_MANAGER_DISTANCES_H

#include <algorithm>
#include <cmath>
#include <limits>

namespace fcl {

template <typename S>
typename ContinuousCollisionManager<S>::Pairs ContinuousCollisionManager<S>::pairsOf(
    const Sides& sides, const detail::BroadPhaseSettings& settings) const {
  Pairs pairs = sides.object
                    ? boxes_.pairsOf(sides.object, &detail::readObject<S>, settings)
                : sides.other ? boxes_.pairsWith(sides.other->boxes_, settings)
                              : boxes_.pairs(settings);
  const auto areFlats = [](const detail::BroadPhasePair& pair) {
    return detail::areFlats(*objectOf(pair.o1), *objectOf(pair.o2));
  };
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), areFlats), pairs.end());
  return pairs;
}

template <typename S>
template <typename Visit>
void ContinuousCollisionManager<S>::visitNearest(const Sides& sides, S t_max, S limit,
                                                 const Visit& visit) const {
  const detail::NearestSettings settings{
      static_cast<double>(t_max), static_cast<double>(limit),
      [&visit, &limit](const detail::NearPair& pair) {
        Object *const o1 = objectOf(pair.o1), *const o2 = objectOf(pair.o2);
        if (!detail::areFlats(*o1, *o2)) limit = visit(o1, o2);
        return static_cast<double>(limit);
      }};
  if (sides.object)
    boxes_.visitNearestOf(sides.object, &detail::readObject<S>, settings);
  else if (sides.other)
    boxes_.visitNearestWith(sides.other->boxes_, settings);
  else
    boxes_.visitNearest(settings);
}

template <typename S>
void ContinuousCollisionManager<S>::answerDistance(
    const Sides& sides, const ContinuousDistanceRequest<S>& request,
    ContinuousManagerDistance<S>& out) const {
  detail::requireValid(request);
  const ContinuousCollisionManager& other = sides.other ? *sides.other : *this;
  ContinuousManagerDistance<S> nearest = detail::noPair<S>();
  ContinuousDistanceRequest<S> asked = request;
  const auto test = [&](Object* o1, Object* o2) {
    asked.filter1 = filterOf(o1);
    asked.filter2 = other.filterOf(o2);
    ContinuousDistanceResult<S> tested;
    try {
      continuousDistance(o1->collisionGeometry().get(), o1->getMotion(),
                         o2->collisionGeometry().get(), o2->getMotion(), asked, tested);
    } catch (const Exception& error) {
      throw Exception("o1 is " + nameOf(o1) + ", o2 is " + other.nameOf(o2) + ": " +
                      error.what());
    }
    detail::takeDistance(o1, o2, tested, nearest);
  };

  const Request contact = detail::contactRequestOf(request);
  Result first;
  answer(pairsOf(sides, settingsOf(contact)), other, contact, first, false);
  if (first.is_collide) {
    test(first.pairs.front().o1, first.pairs.front().o2);
    out = nearest;
    return;
  }
  visitNearest(sides, request.t_max, request.max_distance, [&](Object* o1, Object* o2) {
    test(o1, o2);
    asked.max_distance = std::min(request.max_distance, nearest.result.distance_hi);
    return asked.max_distance > 0 ? asked.max_distance : S(-1);
  });
  // Pairs that were not looked at are further apart than the nearest one, or than is of
  // interest.
  ContinuousDistanceResult<S>& result = nearest.result;
  result.distance_lo =
      std::min({result.distance_lo, result.distance_hi, request.max_distance});
  result.is_cut_off =
      std::isfinite(request.max_distance) && result.distance_lo == request.max_distance;
  out = nearest;
}

template <typename S>
void ContinuousCollisionManager<S>::distance(const ContinuousDistanceRequest<S>& request,
                                             ContinuousManagerDistance<S>& result) const {
  answerDistance({nullptr, nullptr}, request, result);
}

template <typename S>
void ContinuousCollisionManager<S>::distance(Object* object,
                                             const ContinuousDistanceRequest<S>& request,
                                             ContinuousManagerDistance<S>& result) const {
  detail::requireUsable(object);
  answerDistance({nullptr, object}, request, result);
}

template <typename S>
void ContinuousCollisionManager<S>::distance(const ContinuousCollisionManager& other,
                                             const ContinuousDistanceRequest<S>& request,
                                             ContinuousManagerDistance<S>& result) const {
  answerDistance({&other == this ? nullptr : &other, nullptr}, request, result);
}

template <typename S>
void ContinuousCollisionManager<S>::callBack(const Sides& sides, void* cdata,
                                             DistanceCallBack<S> callback) const {
  const ContinuousCollisionManager& other = sides.other ? *sides.other : *this;
  S dist = std::numeric_limits<S>::max();
  visitNearest(sides, S(1), dist, [&](Object* o1, Object* o2) {
    const bool ends = callback(sweptObject(o1), other.sweptObject(o2), cdata, dist);
    return ends ? S(-1) : dist;
  });
}

template <typename S>
void ContinuousCollisionManager<S>::distance(void* cdata,
                                             DistanceCallBack<S> callback) const {
  callBack(Sides{nullptr, nullptr}, cdata, callback);
}

template <typename S>
void ContinuousCollisionManager<S>::distance(Object* object, void* cdata,
                                             DistanceCallBack<S> callback) const {
  detail::requireUsable(object);
  callBack(Sides{nullptr, object}, cdata, callback);
}

template <typename S>
void ContinuousCollisionManager<S>::distance(
    BroadPhaseContinuousCollisionManager<S>* other, void* cdata,
    DistanceCallBack<S> callback) const {
  if (other == this) return distance(cdata, callback);
  callBack(Sides{&requireManager(other, "distance"), nullptr}, cdata, callback);
}

}  // namespace fcl

#endif

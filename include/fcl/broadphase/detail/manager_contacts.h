// SPDX-License-Identifier: BSD-3-Clause
//
// How a ContinuousCollisionManager finds the contacts of its objects. It is a
// part of the manager's header, which includes it at its end.
#ifndef FCL_BROADPHASE_DETAIL_MANAGER_CONTACTS_H
#define FCL_BROADPHASE_DETAIL_MANAGER_CONTACTS_H

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace fcl {

template <typename S>
detail::BroadPhaseSettings ContinuousCollisionManager<S>::settingsOf(
    const Request& request) {
  return {static_cast<double>(request.min_distance), static_cast<double>(request.t_max),
          false};
}

template <typename S>
void ContinuousCollisionManager<S>::collide(const Request& request,
                                            Result& result) const {
  detail::BroadPhaseSettings settings = settingsOf(request);
  settings.with_self = true;
  answer(boxes_.pairs(settings), *this, request, result);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(Object* object, const Request& request,
                                            Result& result) const {
  detail::requireUsable(object);
  answer(boxes_.pairsOf(object, &detail::readObject<S>, settingsOf(request)), *this,
         request, result);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(const ContinuousCollisionManager& other,
                                            const Request& request,
                                            Result& result) const {
  if (&other == this) return collide(request, result);
  answer(boxes_.pairsWith(other.boxes_, settingsOf(request)), other, request, result);
}

template <typename S>
const ContinuousFilter& ContinuousCollisionManager<S>::filterOf(
    const Object* object) const {
  static const ContinuousFilter none;
  const auto entry = filters_.find(object);
  return entry == filters_.end() ? none : entry->second;
}

template <typename S>
std::string ContinuousCollisionManager<S>::nameOf(const Object* object) const {
  const std::vector<void*> objects = boxes_.objects();
  const auto place = std::find(objects.begin(), objects.end(), object);
  if (place == objects.end()) return "the object";
  return "object " + std::to_string(place - objects.begin());
}

/// The min_approach_speed of a query for an object of this manager and one of another
/// one.
template <typename S>
S ContinuousCollisionManager<S>::approachSpeedOf(const Object* o1,
                                                 const ContinuousCollisionManager& other,
                                                 const Object* o2, S of_request) const {
  const auto first = approach_speeds_.find(o1);
  const auto second = other.approach_speeds_.find(o2);
  S speed = of_request;
  if (first != approach_speeds_.end()) speed = std::max(speed, first->second);
  if (second != other.approach_speeds_.end()) speed = std::max(speed, second->second);
  if (!(speed > of_request)) return of_request;
  // A mesh meets itself in its own frame.
  const bool are_straight =
      o1 == o2 ||
      detail::areStraightMeshes(detail::readObject<S>(o1), detail::readObject<S>(o2));
  return are_straight ? speed : of_request;
}

/// What is added to the distance of a query for an object of this manager and one of
/// another one.
template <typename S>
S ContinuousCollisionManager<S>::distanceOf(const Object* o1,
                                            const ContinuousCollisionManager& other,
                                            const Object* o2) const {
  return &other == this ? distances_.of(o1, o2)
                        : distances_.thicknessOf(o1) + other.distances_.thicknessOf(o2);
}

/// Tests a pair. The filters of the objects were tested with their boxes; what is left
/// are groups of triangles. Returns whether the two are in contact.
template <typename S>
bool ContinuousCollisionManager<S>::test(const detail::BroadPhasePair& pair,
                                         const ContinuousCollisionManager& other,
                                         Request& request, PairResult& tested) const {
  tested.o1 = objectOf(pair.o1);
  tested.o2 = objectOf(pair.o2);
  const ContinuousFilter &filter1 = filterOf(tested.o1),
                         &filter2 = other.filterOf(tested.o2);
  const bool is_filtered = hasTriangles(filter1) || hasTriangles(filter2);
  if (is_filtered) {
    request.filter1 = filter1;
    request.filter2 = filter2;
  }
  try {
    if (pair.o1 == pair.o2)
      fcl::continuousSelfCollide(tested.o1->collisionGeometry().get(), request,
                                 tested.result);
    else
      fcl::collide(tested.o1, tested.o2, request, tested.result);
  } catch (const Exception& error) {
    throw Exception("o1 is " + nameOf(tested.o1) + ", o2 is " + other.nameOf(tested.o2) +
                    ": " + error.what());
  }
  if (is_filtered) request.filter1 = request.filter2 = ContinuousFilter();
  return tested.result.is_collide;
}

/// Tests pairs of the objects of two managers, with what is set for them.
template <typename S>
class ContinuousCollisionManager<S>::PairTest {
 public:
  PairTest(const ContinuousCollisionManager& one, const ContinuousCollisionManager& other,
           const Request& request, bool as_set)
      : one_(one),
        other_(other),
        request_(request),
        has_distances_(as_set && (!one.distances_.empty() || !other.distances_.empty())),
        has_speeds_(as_set &&
                    (!one.approach_speeds_.empty() || !other.approach_speeds_.empty())) {}

  /// The request before anything is added for a pair.
  Request request() const {
    Request common = request_;
    if (has_distances_) detail::addDistance(request_, S(0), common);
    return common;
  }

  bool operator()(const detail::BroadPhasePair& pair, Request& asked,
                  PairResult& tested) const {
    const Object *o1 = objectOf(pair.o1), *o2 = objectOf(pair.o2);
    if (has_distances_)
      detail::addDistance(request_, one_.distanceOf(o1, other_, o2), asked);
    if (has_speeds_)
      asked.min_approach_speed =
          one_.approachSpeedOf(o1, other_, o2, request_.min_approach_speed);
    return one_.test(pair, other_, asked, tested);
  }

 private:
  const ContinuousCollisionManager &one_, &other_;
  const Request& request_;
  bool has_distances_, has_speeds_;
};

template <typename S>
void ContinuousCollisionManager<S>::answer(const Pairs& pairs,
                                           const ContinuousCollisionManager& other,
                                           const Request& request, Result& out,
                                           bool as_set) const {
  const PairTest test(*this, other, request, as_set);
  auto answers = detail::answersOf<PairResult>(pairs, test.request(), test);
  Result result;
  result.num_box_pairs = pairs.size();
  result.num_tested = answers.num_tested;
  result.pairs = std::move(answers.pairs);
  result.is_collide = !result.pairs.empty();
  if (result.is_collide)
    result.time_of_contact = result.pairs.front().result.time_of_contact;
  out = std::move(result);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(
    const Request& request,
    const std::function<bool(ContinuousPairResult<S>&)>& visit) const {
  if (!visit) throw Exception("collide: the function for pairs is empty. Give one");
  detail::BroadPhaseSettings settings = settingsOf(request);
  settings.with_self = true;
  const PairTest test(*this, *this, request, true);
  detail::giveAnswers<PairResult>(boxes_.pairs(settings), test.request(), test,
                                  [&visit](PairResult&& pair) { return visit(pair); });
}

template <typename S>
void ContinuousCollisionManager<S>::callBack(const Pairs& pairs, void* cdata,
                                             ContinuousCollisionCallBack<S> callback) {
  for (const detail::BroadPhasePair& pair : pairs)
    if (callback(objectOf(pair.o1), objectOf(pair.o2), cdata)) return;
}

template <typename S>
void ContinuousCollisionManager<S>::collide(
    void* cdata, ContinuousCollisionCallBack<S> callback) const {
  callBack(boxes_.pairs(allBoxPairs()), cdata, callback);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(
    Object* object, void* cdata, ContinuousCollisionCallBack<S> callback) const {
  detail::requireUsable(object);
  callBack(boxes_.pairsOf(object, &detail::readObject<S>, allBoxPairs()), cdata,
           callback);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(
    const ContinuousCollisionManager& other, void* cdata,
    ContinuousCollisionCallBack<S> callback) const {
  if (&other == this) return collide(cdata, callback);
  callBack(boxes_.pairsWith(other.boxes_, allBoxPairs()), cdata, callback);
}

template <typename S>
CollisionObject<S>* ContinuousCollisionManager<S>::sweptObject(Object* object) const {
  std::unique_ptr<SweptCollisionObject<S>>& swept = swept_objects_[object];
  if (swept)
    swept->update();
  else
    swept.reset(new SweptCollisionObject<S>(object));
  return swept.get();
}

template <typename S>
void ContinuousCollisionManager<S>::callBack(const Pairs& pairs,
                                             const ContinuousCollisionManager& other,
                                             void* cdata,
                                             CollisionCallBack<S> callback) const {
  for (const detail::BroadPhasePair& pair : pairs)
    if (callback(sweptObject(objectOf(pair.o1)), other.sweptObject(objectOf(pair.o2)),
                 cdata))
      return;
}

template <typename S>
void ContinuousCollisionManager<S>::collide(void* cdata,
                                            CollisionCallBack<S> callback) const {
  callBack(boxes_.pairs(allBoxPairs()), *this, cdata, callback);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(Object* object, void* cdata,
                                            CollisionCallBack<S> callback) const {
  detail::requireUsable(object);
  callBack(boxes_.pairsOf(object, &detail::readObject<S>, allBoxPairs()), *this, cdata,
           callback);
}

template <typename S>
void ContinuousCollisionManager<S>::collide(
    BroadPhaseContinuousCollisionManager<S>* other, void* cdata,
    CollisionCallBack<S> callback) const {
  if (other == this) return collide(cdata, callback);
  const ContinuousCollisionManager& manager = requireManager(other, "collide");
  callBack(boxes_.pairsWith(manager.boxes_, allBoxPairs()), manager, cdata, callback);
}

template <typename S>
const ContinuousCollisionManager<S>* ContinuousCollisionManager<S>::managerOf(
    const BroadPhaseContinuousCollisionManager<S>* other) const {
  using Base = BroadPhaseContinuousCollisionManager<S>;
  static const ContinuousCollisionManager plain;
  if (!other) return nullptr;
  if (detail::haveSameClass<Base>(*this, *other) ||
      detail::haveSameClass<Base>(plain, *other))
    return static_cast<const ContinuousCollisionManager*>(other);
#if defined(__GXX_RTTI) || defined(__cpp_rtti)
  if (detail::typeInfoOf(other))
    return dynamic_cast<const ContinuousCollisionManager*>(other);
#endif
  return nullptr;
}

template <typename S>
const ContinuousCollisionManager<S>& ContinuousCollisionManager<S>::requireManager(
    const BroadPhaseContinuousCollisionManager<S>* other, const char* query) const {
  if (const ContinuousCollisionManager* manager = managerOf(other)) return *manager;
  throw Exception(std::string(query) +
                  ": the other manager is not a ContinuousCollisionManager, so its "
                  "objects have no boxes that move. Register its objects in one");
}

}  // namespace fcl

#endif

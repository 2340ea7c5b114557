// SPDX-License-Identifier: BSD-3-Clause
//
// The objects of a ContinuousCollisionManager, and what is set for each of them. It is a
// part of the manager's header, which includes it at its end.
#ifndef FCL_BROADPHASE_DETAIL_MANAGER_OBJECTS_H
#define FCL_BROADPHASE_DETAIL_MANAGER_OBJECTS_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace fcl {

template <typename S>
std::vector<void*> ContinuousCollisionManager<S>::addressesOf(
    const std::vector<Object*>& objects) {
  for (const Object* object : objects) detail::requireUsable(object);
  return {objects.begin(), objects.end()};
}

template <typename S>
void ContinuousCollisionManager<S>::registerObjects(const std::vector<Object*>& objects) {
  const std::vector<void*> addresses = addressesOf(objects);
  boxes_.insert(addresses.data(), addresses.size(), &detail::readObject<S>,
                &detail::prefetchObject<S>);
}

template <typename S>
void ContinuousCollisionManager<S>::registerObject(Object* object) {
  registerObjects({object});
}

template <typename S>
void ContinuousCollisionManager<S>::unregisterObject(Object* object) {
  boxes_.remove(object);
  filters_.erase(object);
  approach_speeds_.erase(object);
  for (const void* other : distances_.forget(object)) setMargin(other);
  swept_objects_.erase(object);
}

template <typename S>
void ContinuousCollisionManager<S>::clear() {
  boxes_.clear();
  filters_.clear();
  approach_speeds_.clear();
  distances_.clear();
  swept_objects_.clear();
}

template <typename S>
void ContinuousCollisionManager<S>::setup() {
  boxes_.rebuild();
}

template <typename S>
void ContinuousCollisionManager<S>::update() {
  const std::vector<void*> objects = boxes_.objects();
  boxes_.update(objects.data(), objects.size(), &detail::readObject<S>,
                &detail::prefetchObject<S>);
}

template <typename S>
void ContinuousCollisionManager<S>::update(Object* object) {
  update(std::vector<Object*>{object});
}

template <typename S>
void ContinuousCollisionManager<S>::update(const std::vector<Object*>& objects) {
  const std::vector<void*> addresses = addressesOf(objects);
  boxes_.update(addresses.data(), addresses.size(), &detail::readObject<S>,
                &detail::prefetchObject<S>);
}

template <typename S>
void ContinuousCollisionManager<S>::setMotion(
    const std::vector<Object*>& objects,
    const std::vector<std::shared_ptr<MotionBase<S>>>& motions) {
  detail::requireOneEach(objects.size(), motions.size(), "motion");
  for (const auto& motion : motions) detail::requireNotNull(motion.get(), "motion");
  const std::vector<void*> addresses = addressesOf(objects);
  // Each object has its motion while it is read, and its old one if reading throws.
  detail::MotionExchange<S> exchange(objects, motions);
  boxes_.update(addresses.data(), addresses.size(), &detail::readObject<S>,
                &detail::prefetchObject<S>);
  exchange.keep();
}

template <typename S>
void ContinuousCollisionManager<S>::setMotion(
    Object* object, const std::shared_ptr<MotionBase<S>>& motion) {
  setMotion(std::vector<Object*>{object},
            std::vector<std::shared_ptr<MotionBase<S>>>{motion});
}

template <typename S>
void ContinuousCollisionManager<S>::setMotion(Object* object, const Transform3<S>& tf_beg,
                                              const Transform3<S>& tf_end) {
  setMotion(object, detail::makeMotionBetween<S>(tf_beg, tf_end));
}

template <typename S>
void ContinuousCollisionManager<S>::step(const std::vector<Object*>& objects,
                                         const std::vector<Transform3<S>>& tf_end) {
  detail::requireOneEach(objects.size(), tf_end.size(), "pose");
  for (const Object* object : objects) {
    detail::requireUsable(object);
    requireRegistered(object);
  }
  std::vector<std::shared_ptr<MotionBase<S>>> motions;
  motions.reserve(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
    motions.push_back(
        detail::makeMotionBetween<S>(detail::lastPoseOf(*objects[i]), tf_end[i]));
  setMotion(objects, motions);
}

template <typename S>
void ContinuousCollisionManager<S>::step(Object* object, const Transform3<S>& tf_end) {
  step(std::vector<Object*>{object}, std::vector<Transform3<S>>{tf_end});
}

template <typename S>
void ContinuousCollisionManager<S>::requireRegistered(const Object* object) const {
  detail::requireNotNull(object, "object");
  if (!boxes_.contains(object))
    throw Exception(
        "the object is not registered in this manager. Call registerObject() first");
}

/// The box of an object, and with it the pairs that queries find, have its margin.
template <typename S>
void ContinuousCollisionManager<S>::setMargin(const void* object) {
  boxes_.setMargin(object, static_cast<double>(distances_.marginOf(object)));
}

template <typename S>
void ContinuousCollisionManager<S>::setThickness(Object* object, S thickness) {
  requireRegistered(object);
  detail::requireNotNegative(thickness, "the thickness", "the unit of the coordinates");
  distances_.setThickness(object, thickness);
  setMargin(object);
}

template <typename S>
void ContinuousCollisionManager<S>::setPairDistance(Object* o1, Object* o2, S distance) {
  requireRegistered(o1);
  requireRegistered(o2);
  detail::requireNotNegative(distance, "the distance", "the unit of the coordinates");
  distances_.setPair(o1, o2, distance);
  setMargin(o1);
  setMargin(o2);
}

template <typename S>
void ContinuousCollisionManager<S>::resetPairDistance(Object* o1, Object* o2) {
  requireRegistered(o1);
  requireRegistered(o2);
  distances_.forgetPair(o1, o2);
  setMargin(o1);
  setMargin(o2);
}

template <typename S>
void ContinuousCollisionManager<S>::setMinApproachSpeed(Object* object, S speed) {
  requireRegistered(object);
  detail::requireNotNegative(speed, "the speed", "units of length per step");
  if (speed > 0)
    approach_speeds_[object] = speed;
  else
    approach_speeds_.erase(object);
}

template <typename S>
void ContinuousCollisionManager<S>::setFilter(Object* object,
                                              const ContinuousFilter& filter) {
  const auto all = [](std::uint32_t whole, const std::vector<std::uint32_t>& parts) {
    if (!parts.empty()) whole = 0;
    for (const std::uint32_t part : parts) whole |= part;
    return whole;
  };
  boxes_.setFilter(object, all(filter.group, filter.triangle_groups),
                   all(filter.mask, filter.triangle_masks));
  filters_[object] = filter;
}

template <typename S>
void ContinuousCollisionManager<S>::setSelfCollision(Object* object, bool enabled) {
  if (enabled && object && object->getObjectType() != OT_BVH)
    throw Exception("setSelfCollision: " + nameOf(object) +
                    " is not a triangle mesh but " +
                    detail::kindOf(object->getNodeType()) +
                    ". Only a triangle mesh can be tested with itself");
  boxes_.setSelf(object, enabled);
}

template <typename S>
void ContinuousCollisionManager<S>::getObjects(std::vector<Object*>& objects) const {
  objects.clear();
  for (void* object : boxes_.objects()) objects.push_back(objectOf(object));
}

}  // namespace fcl

#endif

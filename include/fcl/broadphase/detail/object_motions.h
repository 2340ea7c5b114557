// SPDX-License-Identifier: BSD-3-Clause
//
// New motions of FCL's continuous objects, which have no call for it.
#ifndef FCL_BROADPHASE_DETAIL_OBJECT_MOTIONS_H
#define FCL_BROADPHASE_DETAIL_OBJECT_MOTIONS_H

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/swept_collision_object.h"
#include "fcl/math/motion/twist_motion.h"
#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {
namespace detail {

inline void requireOneEach(std::size_t num_objects, std::size_t count, const char* what) {
  if (count != num_objects)
    throw Exception(std::to_string(num_objects) + " objects and " +
                    std::to_string(count) + " of the argument " + what +
                    ". Give one for each object");
}

/// @brief The motion of an object, which is protected.
template <typename S>
class MotionOf : public ContinuousCollisionObject<S> {
 public:
  static std::shared_ptr<MotionBase<S>>& of(ContinuousCollisionObject<S>& object) {
    return object.*(&MotionOf::motion);
  }
};

/// @brief Gives motions to objects, and takes them back unless keep() is called.
template <typename S>
class MotionExchange {
 public:
  using Motions = std::vector<std::shared_ptr<MotionBase<S>>>;

  /// @pre one motion for each object, none of them null
  MotionExchange(const std::vector<ContinuousCollisionObject<S>*>& objects,
                 Motions motions)
      : objects_(objects), others_(std::move(motions)) {
    swap();
  }
  ~MotionExchange() {
    if (!is_kept_) swap();
  }
  MotionExchange(const MotionExchange&) = delete;
  MotionExchange& operator=(const MotionExchange&) = delete;

  void keep() { is_kept_ = true; }

 private:
  /// In reverse the second time: an object may be in the list twice.
  void swap() {
    const std::size_t count = objects_.size();
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = is_swapped_ ? count - 1 - k : k;
      MotionOf<S>::of(*objects_[i]).swap(others_[i]);
    }
    is_swapped_ = !is_swapped_;
  }

  const std::vector<ContinuousCollisionObject<S>*>& objects_;
  Motions others_;
  bool is_swapped_{false}, is_kept_{false};
};

/// In float FCL's motions that turn are abstract. A template, so that only a program that
/// calls it needs TwistMotion, which -fno-rtti does not allow.
template <typename S>
std::shared_ptr<MotionBase<S>> makeTurn(const Transform3<S>& beg,
                                        const Transform3<S>& end) {
  const Matrix3<S> turn = end.linear() * beg.linear().transpose();
  const AngleAxis<S> about(turn);
  const Vector3<S> way = end.translation() - beg.translation(),
                   angular = about.angle() * about.axis();
  return std::make_shared<TwistMotion<S>>(beg, way, angular, ReferencePath::kStraight);
}

/// FCL's motion turns about one axis at a constant rate, and its origin goes straight.
inline std::shared_ptr<MotionBase<double>> makeTurn(const Transform3<double>& beg,
                                                    const Transform3<double>& end) {
  return detail::makeFclMotion<double>(beg, end, CCDM_LINEAR);
}

/// @brief The motion from one pose to another.
template <typename S>
std::shared_ptr<MotionBase<S>> makeMotionBetween(const Transform3<S>& beg,
                                                 const Transform3<S>& end) {
  if (beg.linear() == end.linear())
    return fcl::make_aligned_shared<TranslationMotion<S>>(beg, end);
  return detail::makeTurn(beg, end);
}

/// @brief The pose of an object at t = 1. A motion class of the program is at its
/// beginning afterwards.
template <typename S>
Transform3<S> lastPoseOf(const ContinuousCollisionObject<S>& object) {
  const MovingGeometry<S> moving = detail::readObject<S>(&object);
  if (moving.path != PathKind::kUnknown)
    return detail::toTransform(detail::endPose(moving));
  Transform3<S> tf = Transform3<S>::Identity();
  object.getMotion()->integrate(S(1));
  object.getMotion()->getCurrentTransform(tf);
  object.getMotion()->integrate(S(0));
  return tf;
}

}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// The boxes of objects that move: in FCL's managers of discrete objects, and in
// ContinuousCollisionManager.
#ifndef FCL_BROADPHASE_SWEPT_COLLISION_OBJECT_H
#define FCL_BROADPHASE_SWEPT_COLLISION_OBJECT_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "fcl/narrowphase/collision_object.h"
#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {

namespace detail {

namespace deformable {
class BroadPhase;
}  // namespace deformable

/// @brief Two objects whose boxes meet during [t_lo, t_hi].
struct BroadPhasePair {
  double t_lo, t_hi;
  void* o1;
  void* o2;
};

struct BroadPhaseSettings {
  /// Pairs that come within this distance.
  double distance;
  /// Pairs that meet no later than this time.
  double t_max;
  bool with_self;
};

/// @brief Two objects, and a distance that their boxes keep.
struct NearPair {
  double distance;
  void* o1;
  void* o2;
};

/// @brief Which pairs are visited in the order of the distance of their boxes.
struct NearestSettings {
  /// The latest time that counts.
  double t_max;
  /// The largest distance that is of interest.
  double limit;
  /// Visits a pair; returns the new limit. Negative or NaN: the search ends.
  std::function<double(const NearPair&)> visit;
};

/// @brief The box of an object during the whole step.
struct StepBox {
  double lower[3];
  double upper[3];
};

/// @brief The moving boxes of objects, and the pairs that meet. The border between the
/// manager, which is compiled with the program, and the library: see query_numbers.h.
template <typename S>
class FCL_EXPORT ContinuousBroadPhase {
 public:
  /// Reads the geometry and the motion of an object.
  using Read = MovingGeometry<S> (*)(const void* object);
  /// Asks for the memory that a Read will need soon.
  using Prefetch = void (*)(const void* object);

  ContinuousBroadPhase();
  ~ContinuousBroadPhase();
  ContinuousBroadPhase(const ContinuousBroadPhase&) = delete;
  ContinuousBroadPhase& operator=(const ContinuousBroadPhase&) = delete;

  void insert(void* const* objects, std::size_t count, Read read, Prefetch prefetch);
  void update(void* const* objects, std::size_t count, Read read, Prefetch prefetch);
  void remove(const void* object);
  void rebuild();
  void clear();
  void setFilter(const void* object, std::uint32_t group, std::uint32_t mask);
  void setSelf(const void* object, bool self);
  /// A pair counts from the distance of a query plus the margins of both objects.
  void setMargin(const void* object, double margin);

  std::size_t size() const;
  bool contains(const void* object) const;
  /// In the order of their registration.
  std::vector<void*> objects() const;
  /// Reads an object, which need not be registered, and returns its box.
  static StepBox stepBox(const void* object, Read read);

  /// Sorted by t_lo, then by the order of registration.
  std::vector<BroadPhasePair> pairs(const BroadPhaseSettings& settings) const;
  std::vector<BroadPhasePair> pairsOf(void* object, Read read,
                                      const BroadPhaseSettings& settings) const;
  std::vector<BroadPhasePair> pairsWith(const ContinuousBroadPhase& other,
                                        const BroadPhaseSettings& settings) const;

  /// Visits pairs in the order of the distance of their boxes, until it is above the
  /// limit.
  void visitNearest(const NearestSettings& settings) const;
  void visitNearestOf(void* object, Read read, const NearestSettings& settings) const;
  void visitNearestWith(const ContinuousBroadPhase& other,
                        const NearestSettings& settings) const;

  /// Throws if a mesh was changed after its object was read.
  /// @param except  an object that does not count
  void requireUpToDate(const void* except = nullptr) const;

  /// For the library.
  const deformable::BroadPhase& boxes() const;

 private:
  class Boxes;
  std::unique_ptr<Boxes> boxes_;
};

/// @brief Reads the geometry and the motion of a ContinuousCollisionObject. It reads
/// nothing of a motion that the library does not know.
template <typename S>
MovingGeometry<S> readObject(const void* object);

/// @brief Whether both are meshes whose vertices go straight.
template <typename S>
FCL_EXPORT bool areStraightMeshes(const MovingGeometry<S>& o1,
                                  const MovingGeometry<S>& o2);

/// @brief Asks for the memory of the object's motion.
template <typename S>
void prefetchObject(const void* object);

}  // namespace detail

/// @brief An object for FCL's managers of discrete objects that stands for one that
/// moves. Its AABB covers the step, so that these managers find the pairs that can meet.
/// Its pose is that at t = 0. A callback finds the object that moves as getUserData().
template <typename S>
class SweptCollisionObject : public CollisionObject<S> {
 public:
  /// @param object  must live as long as this
  /// @throws fcl::Exception  as ContinuousCollisionManager
  explicit SweptCollisionObject(ContinuousCollisionObject<S>* object);

  /// @brief Reads the object again. Do not call FCL's computeAABB(), which covers one
  /// pose. @throws fcl::Exception  as ContinuousCollisionManager
  void update();

 private:
  ContinuousCollisionObject<S>* object_;
};

using SweptCollisionObjectf = SweptCollisionObject<float>;
using SweptCollisionObjectd = SweptCollisionObject<double>;

namespace detail {

template <typename S>
void requireUsable(const ContinuousCollisionObject<S>* object) {
  detail::requireNotNull(object, "object");
  detail::requireNotNull(object->collisionGeometry().get(), "object: the geometry");
  detail::requireNotNull(object->getMotion(), "object: the motion");
}

template <typename S>
void prefetchObject(const void* object) {
  // Those of FCL's motions that are read, without their polynomials.
  constexpr int kLine = 64, kLines = 6;
  const auto* motion = reinterpret_cast<const char*>(
      static_cast<const ContinuousCollisionObject<S>*>(object)->getMotion());
  for (int i = 0; i < kLines; ++i) __builtin_prefetch(motion + i * kLine);
}

template <typename S>
MovingGeometry<S> readObject(const void* object) {
  const auto& o = *static_cast<const ContinuousCollisionObject<S>*>(object);
  const MotionBase<S>& motion = *o.getMotion();
  MovingGeometry<S> moving{
      o.collisionGeometry().get(), {}, PathKind::kUnknown, {}, {}, nullptr, {}, {}};
  if (detail::readMotion(motion, moving)) return moving;
  if (const BoundedMotion* bounded = detail::asBoundedMotion(motion))
    detail::readBoundedMotion(*bounded, moving);
  else
    moving.path = PathKind::kUnknown;
  return moving;
}

}  // namespace detail

// Without a geometry FCL's constructor leaves the geometry's own AABB as it is.
template <typename S>
SweptCollisionObject<S>::SweptCollisionObject(ContinuousCollisionObject<S>* object)
    : CollisionObject<S>(std::shared_ptr<CollisionGeometry<S>>()), object_(object) {
  detail::requireUsable(object);
  this->setUserData(object);
  update();
}

template <typename S>
void SweptCollisionObject<S>::update() {
  const detail::MovingGeometry<S> moving = detail::readObject<S>(object_);
  Transform3<S> tf = detail::toTransform(moving.pose[0]);
  if (moving.path == detail::PathKind::kUnknown)
    object_->getMotion()->getCurrentTransform(tf);
  const detail::StepBox box =
      detail::ContinuousBroadPhase<S>::stepBox(object_, &detail::readObject<S>);
  // Nothing throws from here on.
  this->cgeom_const = object_->collisionGeometry();
  this->cgeom = std::const_pointer_cast<CollisionGeometry<S>>(this->cgeom_const);
  const Matrix3<S> rotation = tf.linear();
  const Vector3<S> translation = tf.translation();
  this->setTransform(rotation, translation);
  for (int k = 0; k < 3; ++k) {
    this->aabb.min_[k] = static_cast<S>(box.lower[k]);
    this->aabb.max_[k] = static_cast<S>(box.upper[k]);
  }
}

}  // namespace fcl

#endif

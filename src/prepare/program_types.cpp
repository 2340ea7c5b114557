// SPDX-License-Identifier: BSD-3-Clause
//
// Reads what the program compiles with flags of its own: transforms that may lack the
// alignment of their type, objects of libfcl's layout, classes without RTTI.
#include <algorithm>

#include "fcl/math/motion/detail/followed_motion.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "prepare/class_cast.h"

namespace fcl {
namespace detail {

template <typename S>
void copyEntries(const S* from, S* to) {
  std::copy(from, from + 16, to);
}

template void copyEntries(const double*, double*);
template void copyEntries(const float*, float*);

template <typename S>
const BoundedMotion* asBoundedMotion(const MotionBase<S>& motion) {
  const auto* const bounded = classCast<BoundedMotion>(motion);
  const auto* const followed =
      bounded ? dynamic_cast<const FollowedMotion<S>*>(bounded) : nullptr;
  return followed ? &followed->path() : bounded;
}

template const BoundedMotion* asBoundedMotion(const MotionBase<double>&);
template const BoundedMotion* asBoundedMotion(const MotionBase<float>&);

PoseNumbers<double> transformOf(const CollisionObject<double>& o) {
  using Object = CollisionObject<double>;
  // The compiler does not see through a volatile pointer. So the functions are those of
  // libfcl, and what they return needs no alignment.
  const Matrix3<double> (Object::*volatile rotation)() const = &Object::getRotation;
  const Vector3<double> (Object::*volatile translation)() const = &Object::getTranslation;
  const Matrix3<double> r = (o.*rotation)();
  const Vector3<double> t = (o.*translation)();
  PoseNumbers<double> pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.rotation[3 * i + k] = r(i, k);
    pose.translation[i] = t[i];
  }
  return pose;
}

}  // namespace detail
}  // namespace fcl

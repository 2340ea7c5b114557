// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors of three coordinates, eight side by side.
//
// Included once for each of Highway's targets, hence no ordinary include guard.
#include "kernels/lanes.h"

#if defined(FCL_CCD_VECTORS_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_VECTORS_INCLUDED
#undef FCL_CCD_VECTORS_INCLUDED
#else
#define FCL_CCD_VECTORS_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// Three coordinates of eight vectors.
struct Vectors {
  Doubles x, y, z;
};

HWY_INLINE Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Doubles dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

HWY_INLINE Doubles maxNorm(const Vectors& a) {
  return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif

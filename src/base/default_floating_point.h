// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_DEFAULT_FLOATING_POINT_H
#define FCL_CCD_BASE_DEFAULT_FLOATING_POINT_H

#if defined(__x86_64__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace fcl {
namespace detail {
namespace deformable {

#if defined(__x86_64__)

/// @brief How the thread rounds, with the flags of what happened. Doubles are computed in
/// SSE, so that its register is enough: to change that of the x87 too takes 300 ns.
using FloatingPointMode = unsigned;

inline FloatingPointMode floatingPointMode() { return _mm_getcsr(); }
inline void setFloatingPointMode(FloatingPointMode mode) {
  _mm_setcsr(mode);
  // The compiler does not know that arithmetic depends on it, and must not move it.
  asm volatile("" ::: "memory");
}
inline void setDefaultFloatingPointMode() { setFloatingPointMode(0x1f80); }
/// @brief Whether a mode is the default one, whatever its flags. To set a mode takes
/// longer than to look at it.
inline bool isDefaultFloatingPointMode(FloatingPointMode mode) {
  return (mode & ~0x3fU) == 0x1f80;
}
inline void restoreFloatingPointMode(FloatingPointMode mode) {
  if (floatingPointMode() != mode) setFloatingPointMode(mode);
}

/// @brief Whether the thread rounds to nearest and keeps subnormals.
inline bool isDefaultFloatingPointMode() { return (_mm_getcsr() & 0xe040U) == 0; }

#else

using FloatingPointMode = std::fenv_t;

inline FloatingPointMode floatingPointMode() {
  std::fenv_t mode;
  std::fegetenv(&mode);
  return mode;
}
inline void setFloatingPointMode(const FloatingPointMode& mode) { std::fesetenv(&mode); }
inline void setDefaultFloatingPointMode() { std::fesetenv(FE_DFL_ENV); }
/// @brief Whether a mode is the default one. What its members mean is not known.
inline bool isDefaultFloatingPointMode(const FloatingPointMode& /*mode*/) {
  return false;
}
inline void restoreFloatingPointMode(const FloatingPointMode& mode) {
  setFloatingPointMode(mode);
}

/// @brief Whether the thread rounds to nearest.
inline bool isDefaultFloatingPointMode() { return std::fegetround() == FE_TONEAREST; }

#endif

/// @brief While this object exists, the thread computes in the default floating-point
/// mode (round to nearest, subnormals kept), which all error bounds assume. Its
/// destructor restores the caller's mode and flags.
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() {
    if (!isDefaultFloatingPointMode(saved_)) setDefaultFloatingPointMode();
  }
  ~DefaultFloatingPoint() { restoreFloatingPointMode(saved_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

 private:
  const FloatingPointMode saved_{floatingPointMode()};
};

/// @brief While this object exists, the thread has the caller's saved mode, for a
/// callback of the caller. Its destructor restores the default mode.
class CallersFloatingPoint {
 public:
  explicit CallersFloatingPoint(const FloatingPointMode& mode) {
    setFloatingPointMode(mode);
  }
  ~CallersFloatingPoint() { setDefaultFloatingPointMode(); }
  CallersFloatingPoint(const CallersFloatingPoint&) = delete;
  CallersFloatingPoint& operator=(const CallersFloatingPoint&) = delete;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_DEFAULT_FLOATING_POINT_H
#define FCL_CCD_BASE_DEFAULT_FLOATING_POINT_H

#include <cfenv>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief While this object exists, the thread computes in the default floating-point
/// mode (round to nearest, subnormals kept), which all error bounds assume. Its
/// destructor restores the caller's mode and flags.
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() {
    std::fegetenv(&saved_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~DefaultFloatingPoint() { std::fesetenv(&saved_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

 private:
  std::fenv_t saved_;
};

/// @brief While this object exists, the thread has the caller's saved mode, for a
/// callback of the caller. Its destructor restores the default mode.
class CallersFloatingPoint {
 public:
  explicit CallersFloatingPoint(const std::fenv_t& mode) { std::fesetenv(&mode); }
  ~CallersFloatingPoint() { std::fesetenv(FE_DFL_ENV); }
  CallersFloatingPoint(const CallersFloatingPoint&) = delete;
  CallersFloatingPoint& operator=(const CallersFloatingPoint&) = delete;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

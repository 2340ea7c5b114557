// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_PREFETCH_H
#define FCL_CCD_BASE_PREFETCH_H

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Asks for the memory at an address, which will be read soon. The address need
/// not be valid.
inline void prefetchMemory(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

/// @brief The same for memory that will be written.
inline void prefetchToWrite(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address, 1);
#else
  static_cast<void>(address);
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_UNINITIALIZED_VECTOR_H
#define FCL_CCD_BASE_UNINITIALIZED_VECTOR_H

#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief An allocator that does not initialize elements without a given value.
template <typename T>
struct DefaultInitAllocator : std::allocator<T> {
  static_assert(std::is_trivial<T>::value, "what is left without a value");

  DefaultInitAllocator() = default;
  // Allocators convert between types: a vector may allocate helper types with this.
  template <typename U>
  DefaultInitAllocator(const DefaultInitAllocator<U>&) noexcept {}

  template <typename U>
  struct rebind {
    using other = DefaultInitAllocator<U>;
  };

  template <typename U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <typename U, typename... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
};

/// @brief A vector whose resize() does not write elements, for arrays that are filled
/// later.
template <typename T>
using UninitializedVector = std::vector<T, DefaultInitAllocator<T>>;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

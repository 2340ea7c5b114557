// SPDX-License-Identifier: BSD-3-Clause
#include "allocation_failures.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace fcl {
namespace test {

thread_local int allocations_left = -1;

namespace {

void* allocate(std::size_t size, std::size_t alignment) {
  if (allocations_left == 0) throw std::bad_alloc();
  if (allocations_left > 0) --allocations_left;
  size = (std::max(size, std::size_t{1}) + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, size);
  if (!memory) throw std::bad_alloc();
  return memory;
}

}  // namespace
}  // namespace test
}  // namespace fcl

void* operator new(std::size_t size) {
  return fcl::test::allocate(size, alignof(std::max_align_t));
}
// As the standard library has it. A sanitizer has its own, whose memory cannot be freed
// below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return fcl::test::allocate(size, static_cast<std::size_t>(alignment));
}
// The array forms are those of the sanitizer otherwise, which call none of these.
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return operator new(size, alignment);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

// The leak sanitizer asks this function, by its name. FCL's copy constructor does not
// free its arrays when memory runs out, and a second beginModel() those of the first.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:fcl::BVHModel<*>::BVHModel\nleak:fcl::BVHModel<*>::beginModel\n";
}

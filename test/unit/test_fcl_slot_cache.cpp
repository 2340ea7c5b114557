// SPDX-License-Identifier: BSD-3-Clause
#include "base/slot_cache.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <stdexcept>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using Squares = SlotCache<int, int, 8>;

int squareOf(int x, Squares& cache, int& num_made) {
  return cache.get(static_cast<std::size_t>(x) % Squares::kSlots, x, [&](int& out) {
    ++num_made;
    out = x * x;
  });
}

TEST(FCL_SLOT_CACHE, keepsAValueUntilItsSlotIsTaken) {
  Squares cache(-1);
  int num_made = 0;
  for (int repeat = 0; repeat < 2; ++repeat)
    for (int x = 0; x < 8; ++x) EXPECT_EQ(squareOf(x, cache, num_made), x * x);
  EXPECT_EQ(num_made, 8);
  EXPECT_EQ(squareOf(11, cache, num_made), 121);
  EXPECT_EQ(cache.find(3, 3), nullptr);
  ASSERT_NE(cache.find(3, 11), nullptr);
  EXPECT_EQ(*cache.find(3, 11), 121);
  EXPECT_EQ(squareOf(3, cache, num_made), 9);
  EXPECT_EQ(num_made, 10);
}

TEST(FCL_SLOT_CACHE, isEmptyAtFirstAndForgets) {
  Squares cache(-1, 7);
  for (int x = 0; x < 8; ++x)
    EXPECT_EQ(cache.find(static_cast<std::size_t>(x), x), nullptr);
  EXPECT_EQ(cache.put(2, 2), 7);
  cache.put(2, 10) = 5;
  EXPECT_EQ(cache.find(2, 2), nullptr);
  EXPECT_EQ(*cache.find(2, 10), 5);
  cache.forget(2);
  EXPECT_EQ(cache.find(2, 10), nullptr);
}

// What was there is not taken for the value that was not made.
TEST(FCL_SLOT_CACHE, hasNothingAfterAnException) {
  Squares cache(-1);
  int num_made = 0;
  squareOf(1, cache, num_made);
  EXPECT_THROW(cache.get(1, 9,
                         [](int& out) {
                           out = 0;
                           throw std::runtime_error("not made");
                         }),
               std::runtime_error);
  EXPECT_EQ(cache.find(1, 1), nullptr);
  EXPECT_EQ(cache.find(1, 9), nullptr);
  EXPECT_EQ(squareOf(1, cache, num_made), 1);
  EXPECT_EQ(num_made, 2);
}

// The times of a query are few binary digits long, and must not share a few slots.
TEST(FCL_SLOT_CACHE, spreadsTimesOverItsSlots) {
  constexpr int kBits = 7;
  std::set<std::size_t> slots;
  for (int i = 0; i <= 64; ++i) {
    const std::size_t slot = slotOf(i / 64., 0, kBits);
    EXPECT_LT(slot, std::size_t{1} << kBits);
    slots.insert(slot);
  }
  EXPECT_GE(slots.size(), 40u);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// What makes a case of the fuzzer small.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "fuzz/minimise.h"

namespace fcl {
namespace test {
namespace {

std::vector<int> numbers(int count) {
  std::vector<int> out;
  for (int i = 0; i < count; ++i) out.push_back(i);
  return out;
}

bool has(const std::vector<int>& items, int x) {
  return std::find(items.begin(), items.end(), x) != items.end();
}

TEST(FuzzMinimise, LeavesWhatTheFaultNeeds) {
  for (const int count : {2, 3, 7, 100, 201})
    for (const int other : {0, 1, count / 2, count - 1}) {
      std::vector<int> items = numbers(count);
      // A fault of two items, wherever they are.
      minimise(items, [&] { return has(items, 1) && has(items, other); });
      EXPECT_EQ(items.size(), other == 1 ? 1U : 2U) << count << ", " << other;
      EXPECT_TRUE(has(items, 1) && has(items, other));
    }
}

TEST(FuzzMinimise, NoFurtherItemCanBeRemoved) {
  // A fault of any three items.
  std::vector<int> items = numbers(50);
  minimise(items, [&] { return items.size() >= 3; });
  EXPECT_EQ(items.size(), 3U);
  // One that is always there.
  minimise(items, [] { return true; });
  EXPECT_TRUE(items.empty());
}

TEST(FuzzMinimise, EndsWithTheCaseThatFailed) {
  std::vector<int> items = numbers(20);
  int calls = 0;
  minimise(items, [&] {
    ++calls;
    return std::count_if(items.begin(), items.end(), [](int i) { return i % 5 == 0; }) ==
           4;
  });
  EXPECT_EQ(items, (std::vector<int>{0, 5, 10, 15}));
  EXPECT_LT(calls, 200);
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_FUZZ_MINIMISE_H
#define FCL_FUZZ_MINIMISE_H

#include <algorithm>
#include <cstddef>
#include <exception>
#include <vector>

namespace fcl {
namespace test {

/// @brief Removes items, halves of the list first, then ever shorter parts, until no
/// single item can be removed.
/// @param fails  whether the case still fails with the items as they are now. An
/// exception says that what is left is no case.
template <typename Item, typename Fails>
void minimise(std::vector<Item>& items, Fails&& fails) {
  const auto at = [&items](std::size_t i) {
    return items.begin() + static_cast<std::ptrdiff_t>(i);
  };
  const auto stillFails = [&fails] {
    try {
      return fails();
    } catch (const std::exception&) {
      return false;
    }
  };
  std::size_t length = std::max<std::size_t>(items.size() / 2, 1);
  while (!items.empty()) {
    bool is_shorter = false;
    for (std::size_t first = 0; first < items.size();) {
      const std::vector<Item> before = items;
      items.erase(at(first), at(std::min(first + length, items.size())));
      if (stillFails()) {
        is_shorter = true;
      } else {
        items = before;
        first += length;
      }
    }
    if (length == 1 && !is_shorter) return;
    length = std::max<std::size_t>(length / 2, 1);
  }
}

}  // namespace test
}  // namespace fcl

#endif

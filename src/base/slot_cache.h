// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_SLOT_CACHE_H
#define FCL_CCD_BASE_SLOT_CACHE_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Keeps values that are expensive to make, one in each slot. A value is forgotten
/// when another key takes its slot. The caller chooses the slot of a key. For one thread.
template <typename Key, typename Value, std::size_t kNumSlots>
class SlotCache {
 public:
  static constexpr std::size_t kSlots = kNumSlots;

  /// @brief An empty cache. Values of plain types are not initialized before they are
  /// set.
  /// @param none  a key that is never asked for
  explicit SlotCache(const Key& none) : none_(none) { forgetAll(); }
  /// @param initial  of all values
  SlotCache(const Key& none, const Value& initial) : SlotCache(none) {
    std::fill(values_, values_ + kSlots, initial);
  }

  /// @brief The value of a key; null if it is not kept. Valid until its slot is taken.
  Value* find(std::size_t slot, const Key& key) {
    assert(slot < kSlots && !(key == none_));
    return keys_[slot] == key ? &values_[slot] : nullptr;
  }

  /// @brief Gives the slot to a key.
  /// @return its value, to be set
  Value& put(std::size_t slot, const Key& key) {
    assert(slot < kSlots && !(key == none_));
    keys_[slot] = key;
    return values_[slot];
  }

  /// @brief The value of a key, which make(value) sets if it is not kept. If it throws,
  /// the slot is empty.
  template <typename Make>
  Value& get(std::size_t slot, const Key& key, Make&& make) {
    if (Value* kept = find(slot, key)) return *kept;
    forget(slot);
    make(values_[slot]);
    return put(slot, key);
  }

  void forget(std::size_t slot) {
    assert(slot < kSlots);
    keys_[slot] = none_;
  }
  void forgetAll() { std::fill(keys_, keys_ + kSlots, none_); }

 private:
  Key none_;
  Key keys_[kSlots];
  Value values_[kSlots];
};

/// @brief A slot of 2^bits for a time and a number.
inline std::size_t slotOf(double t, std::int32_t number, int bits) {
  assert(0 < bits && bits < 64);
  std::uint64_t key;
  std::memcpy(&key, &t, sizeof(key));
  key += static_cast<std::uint64_t>(number);
  return (key * 0x9e3779b97f4a7c15u) >> (64 - bits);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

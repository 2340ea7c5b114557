// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CONTACT_TABLE_H
#define FCL_CCD_QUERY_CONTACT_TABLE_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/feature_pairs.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Contacts by the pairs of features that they are of, a contact for each pair.
/// The contacts belong to the caller; their features must not change while they are in
/// it.
///
/// The slots of a table of twice as many as there are contacts, or more. A contact is at
/// the slot that its hash tells, or behind it without a free slot in between.
/// @tparam Contact  derived from FeatureIds
template <typename Contact>
class ContactTable {
 public:
  /// @brief The contact with the same features; null: none.
  Contact* find(const FeatureIds& pair) const {
    if (size_ == 0) return nullptr;
    const FeatureKey key(pair);
    const std::uint64_t hash = key.hash();
    for (std::size_t i = hash & mask();; i = next(i)) {
      const Slot& slot = slots_[i];
      if (!slot.contact) return nullptr;
      if (slot.hash == hash && FeatureKey(*slot.contact) == key) return slot.contact;
    }
  }

  /// @brief Makes room for this number of contacts.
  void reserve(std::size_t count) {
    if (2 * count > slots_.size()) grow(2 * count);
  }

  /// @brief Adds a contact, unless one with the same features is there.
  /// @return the contact that is there; null if this one has been added
  Contact* findOrAdd(Contact& contact) {
    reserve(size_ + 1);
    const FeatureKey key(contact);
    const std::uint64_t hash = key.hash();
    std::size_t i = hash & mask();
    for (; slots_[i].contact; i = next(i))
      if (slots_[i].hash == hash && FeatureKey(*slots_[i].contact) == key)
        return slots_[i].contact;
    slots_[i] = {hash, &contact};
    ++size_;
    // A search ends at a free slot.
    assert(2 * size_ <= slots_.size());
    return nullptr;
  }

  /// @pre none with the same features is in the table
  void add(Contact& contact) {
    [[maybe_unused]] const Contact* known = findOrAdd(contact);
    assert(!known);
  }

  /// @pre the contact is in the table
  void remove(const Contact& contact) {
    assert(find(contact) == &contact);
    std::size_t i = FeatureKey(contact).hash() & mask();
    while (slots_[i].contact != &contact) i = next(i);
    // Moves contacts forward that would not be found behind the free slot.
    for (std::size_t j = next(i); slots_[j].contact; j = next(j)) {
      const std::size_t home = slots_[j].hash & mask();
      if (((j - home) & mask()) < ((j - i) & mask())) continue;
      slots_[i] = slots_[j];
      i = j;
    }
    slots_[i] = {};
    --size_;
    assert(!find(contact));
  }

  void clear() {
    if (size_ > 0) std::fill(slots_.begin(), slots_.end(), Slot());
    size_ = 0;
  }

 private:
  struct Slot {
    std::uint64_t hash{0};
    Contact* contact{nullptr};
  };

  std::size_t mask() const { return slots_.size() - 1; }
  std::size_t next(std::size_t i) const { return (i + 1) & mask(); }

  void insert(const Slot& slot) {
    std::size_t i = slot.hash & mask();
    while (slots_[i].contact) i = next(i);
    slots_[i] = slot;
  }

  /// @param count  of slots, at least
  void grow(std::size_t count) {
    std::size_t size = 64;
    while (size < count) size *= 2;
    assert(size >= count && (size & (size - 1)) == 0);
    std::vector<Slot> before(size);
    before.swap(slots_);
    for (const Slot& slot : before)
      if (slot.contact) insert(slot);
  }

  /// Their number is a power of two.
  std::vector<Slot> slots_;
  std::size_t size_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

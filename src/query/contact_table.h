// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CONTACT_TABLE_H
#define FCL_CCD_QUERY_CONTACT_TABLE_H

#include <algorithm>
#include <array>
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
/// The places of a table of twice as many as there are contacts, or more. A contact is at
/// the place that its hash tells, or behind it without a free place in between.
/// @tparam Contact  derived from FeatureIds
template <typename Contact>
class ContactTable {
 public:
  /// @brief The contact with the same features; null: none.
  Contact* find(const FeatureIds& pair) const {
    if (size_ == 0) return nullptr;
    const Key key(pair);
    const std::uint64_t hash = key.hash();
    for (std::size_t i = hash & mask();; i = next(i)) {
      const Place& place = places_[i];
      if (!place.contact) return nullptr;
      if (place.hash == hash && Key(*place.contact) == key) return place.contact;
    }
  }

  /// @brief Makes room for this number of contacts.
  void reserve(std::size_t count) {
    if (2 * count > places_.size()) grow(2 * count);
  }

  /// @pre none with the same features is in the table
  void add(Contact& contact) {
    reserve(size_ + 1);
    insert({Key(contact).hash(), &contact});
    ++size_;
  }

  /// @pre the contact is in the table
  void remove(const Contact& contact) {
    std::size_t i = Key(contact).hash() & mask();
    while (places_[i].contact != &contact) i = next(i);
    // Moves contacts forward that would not be found behind the free place.
    for (std::size_t j = next(i); places_[j].contact; j = next(j)) {
      const std::size_t home = places_[j].hash & mask();
      if (((j - home) & mask()) < ((j - i) & mask())) continue;
      places_[i] = places_[j];
      i = j;
    }
    places_[i] = {};
    --size_;
  }

  void clear() {
    if (size_ > 0) std::fill(places_.begin(), places_.end(), Place());
    size_ = 0;
  }

 private:
  /// Faces with the same vertices are one face, in whatever order the vertices are.
  struct Key {
    std::array<std::uint32_t, 5> words;

    explicit Key(const FeatureIds& c)
        : words{2 * static_cast<std::uint32_t>(c.kind) + (c.first_on_a ? 1U : 0U),
                c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]} {
      if (c.kind == ContinuousContactKind::kVertexFace)
        std::sort(words.begin() + 2, words.end());
    }
    bool operator==(const Key& other) const { return words == other.words; }
    /// Two products that do not wait for each other and one of their sum, by odd numbers
    /// with bits all over (the golden ratio, and a prime of xxHash). The upper bits of a
    /// product depend on all bits of its factors, so the lower 20 are left out.
    std::uint64_t hash() const {
      const std::uint64_t first = std::uint64_t{words[1]} << 32 | words[2],
                          second = std::uint64_t{words[3]} << 32 | words[4];
      const std::uint64_t sum = (first + words[0]) * 0x9e3779b97f4a7c15 +
                                (second ^ second >> 29) * 0xc2b2ae3d27d4eb4f;
      return (sum ^ sum >> 32) * 0x9e3779b97f4a7c15 >> 20;
    }
  };
  struct Place {
    std::uint64_t hash{0};
    Contact* contact{nullptr};
  };

  std::size_t mask() const { return places_.size() - 1; }
  std::size_t next(std::size_t i) const { return (i + 1) & mask(); }

  void insert(const Place& place) {
    std::size_t i = place.hash & mask();
    while (places_[i].contact) i = next(i);
    places_[i] = place;
  }

  /// @param count  of places, at least
  void grow(std::size_t count) {
    std::size_t size = 64;
    while (size < count) size *= 2;
    std::vector<Place> before(size);
    before.swap(places_);
    for (const Place& place : before)
      if (place.contact) insert(place);
  }

  /// Their number is a power of two.
  std::vector<Place> places_;
  std::size_t size_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

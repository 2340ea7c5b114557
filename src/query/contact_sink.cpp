// SPDX-License-Identifier: BSD-3-Clause
#include "query/contact_sink.h"

#include <algorithm>
#include <cassert>
#include <tuple>

namespace fcl {
namespace detail {
namespace deformable {

namespace {

/// Of two contacts of the same parts, whether x is the one to keep.
bool isPreferred(const FeatureContact& x, const FeatureContact& y) {
  const auto key = [](const FeatureContact& c) {
    return std::make_tuple(c.toc_lo, c.toc_hi, c.triangles[0], c.triangles[1]);
  };
  return key(x) < key(y);
}

/// After FNV-1a, by words.
std::size_t hashOf(const std::array<std::uint32_t, 5>& key) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint32_t word : key) hash = (hash ^ word) * 0x100000001b3;
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

}  // namespace

bool isEarlier(const FeatureContact& x, const FeatureContact& y) {
  if (x.toc_lo != y.toc_lo) return x.toc_lo < y.toc_lo;
  const auto key = [](const FeatureContact& c) {
    return std::make_tuple(c.kind, !c.first_on_a, c.vertices[0], c.vertices[1],
                           c.vertices[2], c.vertices[3]);
  };
  return key(x) < key(y);
}

ContactSink::PairKey ContactSink::keyOf(const FeatureContact& c) {
  const std::uint32_t tag =
      2 * static_cast<std::uint32_t>(c.kind) + (c.first_on_a ? 1U : 0U);
  PairKey key{tag, c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]};
  // Faces with the same vertices are one face, in whatever order the vertices are.
  if (c.kind == ContinuousContactKind::kVertexFace) std::sort(key.begin() + 2, key.end());
  return key;
}

/// With a distance, other features may have the same nearest parts.
bool ContactSink::mayRepeat(const FeatureContact& contact) const {
  return may_repeat_ || isPart(contact.kind);
}

/// A pair that is kept already; null if it is not.
FeatureContact* ContactSink::findKept(const FeatureContact& contact) {
  const PairKey key = keyOf(contact);
  const auto isIt = [&key](const FeatureContact& c) { return keyOf(c) == key; };
  if (cut_) {
    if (seen_.count(key) == 0) return nullptr;
    return &*std::find_if(contacts_.begin(), contacts_.end(), isIt);
  }
  if (places_.empty()) return nullptr;
  const std::size_t mask = places_.size() - 1;
  for (std::size_t i = hashOf(key) & mask; places_[i] != 0; i = (i + 1) & mask)
    if (isIt(contacts_[places_[i] - 1])) return &contacts_[places_[i] - 1];
  return nullptr;
}

/// Puts a kept pair into the table, which is never more than half full.
void ContactSink::note(std::size_t index) {
  if (2 * (num_places_ + 1) > places_.size()) {
    const std::vector<std::uint32_t> before = std::move(places_);
    places_.assign(std::max<std::size_t>(64, 2 * before.size()), 0);
    num_places_ = 0;
    for (const std::uint32_t place : before)
      if (place != 0) note(place - 1);
  }
  const std::size_t mask = places_.size() - 1;
  std::size_t i = hashOf(keyOf(contacts_[index])) & mask;
  while (places_[i] != 0) i = (i + 1) & mask;
  places_[i] = static_cast<std::uint32_t>(index + 1);
  ++num_places_;
}

/// From here on contacts_ is a heap.
void ContactSink::cut() {
  if (cut_) return;
  cut_ = true;
  std::make_heap(contacts_.begin(), contacts_.end(), isEarlier);
  for (const FeatureContact& contact : contacts_)
    if (mayRepeat(contact)) seen_.insert(keyOf(contact));
  places_.clear();
  num_places_ = 0;
}

bool ContactSink::add(const FeatureContact& contact) {
  assert(0 <= contact.toc_lo && contact.toc_lo <= contact.toc_hi && contact.toc_hi <= 1);
  first_hi_ = std::min(first_hi_, contact.toc_hi);
  const bool may_repeat = mayRepeat(contact);
  if (FeatureContact* kept = may_repeat ? findKept(contact) : nullptr) {
    if (isPart(contact.kind) ? !isPreferred(contact, *kept) : !isEarlier(contact, *kept))
      return false;
    *kept = contact;
    if (cut_) std::make_heap(contacts_.begin(), contacts_.end(), isEarlier);
    return true;
  }
  if (contacts_.size() < capacity_) {
    contacts_.push_back(contact);
    if (may_repeat) note(contacts_.size() - 1);
    return true;
  }
  cut();
  if (!isEarlier(contact, contacts_.front())) return false;
  std::pop_heap(contacts_.begin(), contacts_.end(), isEarlier);
  if (mayRepeat(contacts_.back())) seen_.erase(keyOf(contacts_.back()));
  contacts_.back() = contact;
  std::push_heap(contacts_.begin(), contacts_.end(), isEarlier);
  if (may_repeat) seen_.insert(keyOf(contact));
  return true;
}

bool ContactSink::mayKeepAtStart(const FeatureIds& pair) const {
  if (!cut_ || contacts_.front().toc_lo > 0) return true;
  FeatureContact contact{pair, 0, 0};
  return isEarlier(contact, contacts_.front());
}

void ContactSink::clear() {
  cut_ = false;
  first_hi_ = 1;
  contacts_.clear();
  places_.clear();
  num_places_ = 0;
  seen_.clear();
}

SortedContacts::SortedContacts(std::vector<std::deque<FeatureContact>> lists)
    : lists_(std::move(lists)) {
  std::size_t count = 0;
  for (const auto& list : lists_) count += list.size();
  // Bucket sort: as many buckets, of equal length in time, as contacts. Most buckets get
  // one or two.
  const auto bucketOf = [count](const FeatureContact& c) {
    return std::min(static_cast<std::size_t>(c.toc_lo * static_cast<double>(count)),
                    count - 1);
  };
  std::vector<std::size_t> ends(count + 1, 0);
  for (const auto& list : lists_)
    for (const FeatureContact& c : list) ++ends[bucketOf(c) + 1];
  for (std::size_t i = 1; i <= count; ++i) ends[i] += ends[i - 1];
  sorted_.resize(count);
  // After this loop ends[i] is the end of bucket i; before, it is its beginning.
  for (const auto& list : lists_)
    for (const FeatureContact& c : list) sorted_[ends[bucketOf(c)]++] = &c;
  const auto at = [this](std::size_t i) {
    return sorted_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  for (std::size_t i = 0, first = 0; i < count; first = ends[i], ++i)
    if (ends[i] - first > 1)
      std::sort(at(first), at(ends[i]),
                [](const FeatureContact* x, const FeatureContact* y) {
                  return isEarlier(*x, *y);
                });
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "query/contact_sink.h"

#include <algorithm>
#include <cassert>
#include <tuple>

namespace fcl {
namespace detail {
namespace deformable {

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
      (c.kind == ContinuousContactKind::kEdgeEdge ? 2U : 0U) + (c.first_on_a ? 1U : 0U);
  PairKey key{tag, c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]};
  // Faces with the same vertices are one face, in whatever order the vertices are.
  if (c.kind == ContinuousContactKind::kVertexFace) std::sort(key.begin() + 2, key.end());
  return key;
}

/// Takes a contact of a pair that has been added before.
bool ContactSink::addAgain(const FeatureContact& contact, Seen& seen) {
  if (!isEarlier(contact, seen.contact)) return false;
  auto kept = contacts_.begin() + static_cast<std::ptrdiff_t>(seen.index);
  if (cut_) {
    const PairKey key = keyOf(contact);
    kept = std::find_if(contacts_.begin(), contacts_.end(),
                        [&key](const FeatureContact& c) { return keyOf(c) == key; });
  }
  *kept = seen.contact = contact;
  if (cut_) std::make_heap(contacts_.begin(), contacts_.end(), isEarlier);
  return true;
}

bool ContactSink::add(const FeatureContact& contact) {
  assert(0 <= contact.toc_lo && contact.toc_lo <= contact.toc_hi && contact.toc_hi <= 1);
  first_hi_ = std::min(first_hi_, contact.toc_hi);
  if (may_repeat_) {
    const auto seen = seen_.find(keyOf(contact));
    if (seen != seen_.end()) return addAgain(contact, seen->second);
  }
  if (contacts_.size() < capacity_) {
    contacts_.push_back(contact);
  } else {
    if (!cut_) std::make_heap(contacts_.begin(), contacts_.end(), isEarlier);
    cut_ = true;
    if (!isEarlier(contact, contacts_.front())) return false;
    std::pop_heap(contacts_.begin(), contacts_.end(), isEarlier);
    if (may_repeat_) seen_.erase(keyOf(contacts_.back()));
    contacts_.back() = contact;
    std::push_heap(contacts_.begin(), contacts_.end(), isEarlier);
  }
  if (may_repeat_) seen_[keyOf(contact)] = {contact, contacts_.size() - 1};
  return true;
}

void ContactSink::clear() {
  cut_ = false;
  first_hi_ = 1;
  contacts_.clear();
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

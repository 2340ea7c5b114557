// SPDX-License-Identifier: BSD-3-Clause
#include "query/contact_sink.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <tuple>

namespace fcl {
namespace detail {
namespace deformable {

namespace {

/// Of two contacts of the same features, or with a distance of the same parts, whether x
/// is the one to keep: the earlier one. Faces with the same vertices are one face, whose
/// vertices may be in another order. The order in which two contacts are found decides
/// nothing.
bool isPreferred(const FeatureContact& x, const FeatureContact& y) {
  const auto key = [](const FeatureContact& c) {
    return std::make_tuple(c.toc_lo, c.vertices[0], c.vertices[1], c.vertices[2],
                           c.vertices[3], c.toc_hi, c.triangles[0], c.triangles[1]);
  };
  return key(x) < key(y);
}

/// The contact to keep of the same features. Where no triangle owns them, several may
/// have them, and the first triangles are named: a pair of triangles that turn may find
/// them a little later than another one, and may be left out then.
FeatureContact better(const FeatureContact& x, const FeatureContact& y) {
  assert(FeatureKey(x) == FeatureKey(y));
  FeatureContact out = isPreferred(y, x) ? y : x;
  if (isPart(out.kind) || !std::equal(x.vertices, x.vertices + 4, y.vertices)) return out;
  const auto triangles = [](const FeatureContact& c) {
    return std::make_pair(c.triangles[0], c.triangles[1]);
  };
  const FeatureContact& named = triangles(y) < triangles(x) ? y : x;
  std::copy(named.triangles, named.triangles + 2, out.triangles);
  return out;
}

}  // namespace

void dropRepeats(bool may_repeat, std::vector<std::deque<FeatureContact>>& lists) {
  ContactTable<FeatureContact> seen;
  const auto isOnce = [may_repeat](const FeatureContact& contact) {
    return !may_repeat && !isPart(contact.kind);
  };
  std::size_t count = 0;
  for (const auto& list : lists)
    for (const FeatureContact& contact : list) count += isOnce(contact) ? 0 : 1;
  seen.reserve(count);
  for (auto& list : lists) {
    auto end = list.begin();
    for (const FeatureContact& contact : list) {
      if (&*end != &contact) *end = contact;
      FeatureContact* kept = isOnce(*end) ? nullptr : seen.findOrAdd(*end);
      if (!kept)
        ++end;
      else
        *kept = better(*kept, *end);
    }
    list.erase(end, list.end());
  }
}

/// With a distance, other features may have the same nearest parts.
bool ContactSink::mayRepeat(const FeatureContact& contact) const {
  return may_repeat_ || isPart(contact.kind);
}

/// From here on the kept contacts are in order.
void ContactSink::cut() {
  if (cut_) return;
  cut_ = true;
  for (FeatureContact& contact : contacts_) order_.insert(&contact);
  assert(order_.size() == contacts_.size());
}

void ContactSink::replace(FeatureContact& kept, const FeatureContact& contact) {
  if (cut_) order_.erase(&kept);
  kept = contact;
  if (cut_) order_.insert(&kept);
  // No two contacts are equal in the order, so that none is lost.
  assert(!cut_ || order_.size() == contacts_.size());
}

/// Takes another contact of the same features, if it is the one to keep.
bool ContactSink::improve(FeatureContact& kept, const FeatureContact& contact) {
  const bool is_preferred = isPreferred(contact, kept);
  replace(kept, better(kept, contact));
  return is_preferred;
}

bool ContactSink::add(const FeatureContact& contact) {
  assert(0 <= contact.toc_lo && contact.toc_lo <= contact.toc_hi && contact.toc_hi <= 1);
  first_hi_ = std::min(first_hi_, contact.toc_hi);
  const bool may_repeat = mayRepeat(contact);
  if (contacts_.size() < capacity_) {
    contacts_.push_back(contact);
    FeatureContact* kept = may_repeat ? seen_.findOrAdd(contacts_.back()) : nullptr;
    if (!kept) return true;
    contacts_.pop_back();
    return improve(*kept, contact);
  }
  if (may_repeat)
    if (FeatureContact* kept = seen_.find(contact)) return improve(*kept, contact);
  cut();
  assert(contacts_.size() == capacity_);
  FeatureContact& latest = **order_.rbegin();
  if (!isEarlier(contact, latest)) return false;
  if (mayRepeat(latest)) seen_.remove(latest);
  replace(latest, contact);
  if (may_repeat) seen_.add(latest);
  return true;
}

bool ContactSink::mayKeep(const FeatureIds& pair, double earliest) const {
  return !cut_ || !isEarlier(**order_.rbegin(), FeatureContact{pair, earliest, earliest});
}

/// A contact of another kind, or of a face of a, comes behind all of a vertex of a with a
/// face.
std::uint32_t ContactSink::lastVertexAtStart() const {
  constexpr std::uint32_t kNoBound = ~std::uint32_t{0};
  if (latestKept() > 0) return kNoBound;
  assert(cut_);
  const FeatureContact& latest = **order_.rbegin();
  const bool is_bound =
      latest.kind == ContinuousContactKind::kVertexFace && latest.first_on_a;
  return is_bound ? latest.vertices[0] : kNoBound;
}

void ContactSink::clear() {
  cut_ = false;
  first_hi_ = 1;
  contacts_.clear();
  order_.clear();
  seen_.clear();
}

namespace {

/// Numbers of buckets that ascend in the order of contacts, for as many buckets as there
/// are contacts. Most buckets get one or two. Contacts at t = 0 have buckets by their
/// kind and side, each with as many as it has contacts, and then by their first vertex.
/// The others have them by time.
class Buckets {
 public:
  explicit Buckets(const std::vector<std::deque<FeatureContact>>& lists) {
    for (const auto& list : lists) {
      count_ += list.size();
      for (const FeatureContact& c : list) {
        if (c.toc_lo > 0) continue;
        ++ends_[groupOf(c)];
        num_vertices_ = std::max(num_vertices_, c.vertices[0] + 1.);
      }
    }
    for (std::size_t i = 1; i < kGroups; ++i) ends_[i] += ends_[i - 1];
  }

  std::size_t count() const { return count_; }

  /// A number that ascends in the order of the contacts of one bucket. Contacts with the
  /// same number may differ.
  static std::uint64_t keyOf(const FeatureContact& c) {
    if (!(c.toc_lo > 0)) return std::uint64_t{c.vertices[0]} << 32 | c.vertices[1];
    // Positive numbers are in the order of their bits.
    std::uint64_t bits;
    std::memcpy(&bits, &c.toc_lo, sizeof bits);
    return bits;
  }

  std::size_t operator()(const FeatureContact& c) const {
    const std::size_t at_start = ends_[kGroups - 1];
    if (c.toc_lo > 0) return at_start + partOf(c.toc_lo, count_ - at_start);
    const std::size_t group = groupOf(c), first = group == 0 ? 0 : ends_[group - 1];
    return first + partOf(c.vertices[0] / num_vertices_, ends_[group] - first);
  }

 private:
  /// Five kinds (kCrossing is none of a contact) of two sides.
  static constexpr std::size_t kGroups = 10;

  static std::size_t groupOf(const FeatureContact& c) {
    const std::size_t group =
        2 * static_cast<std::size_t>(c.kind) + (c.first_on_a ? 0 : 1);
    assert(group < kGroups);
    return group;
  }
  static std::size_t partOf(double share, std::size_t count) {
    assert(0 <= share && share <= 1 && count > 0);
    return std::min(static_cast<std::size_t>(share * static_cast<double>(count)),
                    count - 1);
  }

  std::size_t count_{0};
  /// The end of each group's buckets.
  std::size_t ends_[kGroups] = {};
  double num_vertices_{0};
};

}  // namespace

SortedContacts::SortedContacts(std::vector<std::deque<FeatureContact>> lists)
    : lists_(std::move(lists)) {
  const Buckets bucketOf(lists_);
  const std::size_t count = bucketOf.count();
  assert(count <= std::numeric_limits<std::uint32_t>::max());
  std::vector<std::size_t> ends(count + 1, 0);
  UninitializedVector<std::uint32_t> buckets(count);
  auto bucket = buckets.begin();
  for (const auto& list : lists_)
    for (const FeatureContact& c : list) {
      *bucket = static_cast<std::uint32_t>(bucketOf(c));
      assert(*bucket < count);
      ++ends[*bucket++ + 1];
    }
  for (std::size_t i = 1; i <= count; ++i) ends[i] += ends[i - 1];
  sorted_.resize(count);
  bucket = buckets.begin();
  // After this loop ends[i] is the end of bucket i; before, it is its beginning.
  for (const auto& list : lists_)
    for (const FeatureContact& c : list)
      sorted_[ends[*bucket++]++] = {Buckets::keyOf(c), &c};
  const auto at = [this](std::size_t i) {
    return sorted_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  for (std::size_t i = 0, first = 0; i < count; first = ends[i], ++i)
    if (ends[i] - first > 1)
      std::sort(at(first), at(ends[i]), [](const Entry& x, const Entry& y) {
        return x.key != y.key ? x.key < y.key : isEarlier(*x.contact, *y.contact);
      });
  assert(std::is_sorted(begin(), end(), isEarlier));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

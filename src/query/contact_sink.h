// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_CONTACT_SINK_H
#define FCL_CCD_QUERY_CONTACT_SINK_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "base/uninitialized_vector.h"
#include "mesh/feature_pairs.h"
#include "query/contact_table.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A contact between two features, by ids.
struct FeatureContact : FeatureIds {
  double toc_lo;
  double toc_hi;
};

/// @brief The order of contacts: by toc_lo, then by kind, side and vertex ids. No two
/// contacts of a query are equal in it.
inline bool isEarlier(const FeatureContact& x, const FeatureContact& y) {
  if (x.toc_lo != y.toc_lo) return x.toc_lo < y.toc_lo;
  if (x.kind != y.kind) return x.kind < y.kind;
  if (x.first_on_a != y.first_on_a) return x.first_on_a;
  return std::lexicographical_compare(x.vertices, x.vertices + 4, y.vertices,
                                      y.vertices + 4);
}

/// @brief Whether the features are the nearest parts of those that were tested, with a
/// distance: then others may have the same part.
inline bool isPart(ContinuousContactKind kind) {
  return kind == ContinuousContactKind::kVertexEdge ||
         kind == ContinuousContactKind::kVertexVertex;
}

/// @brief Keeps the earliest contacts, up to a capacity.
class ContactSink {
 public:
  /// @param capacity  at least 1
  /// @param may_repeat  whether add() may get the same pair of features more than once.
  /// The sink then keeps the earliest of its contacts, in whatever order they come.
  ContactSink(std::size_t capacity, bool may_repeat)
      : capacity_(capacity), may_repeat_(may_repeat) {
    assert(capacity > 0);
  }
  // The addresses of contacts are kept.
  ContactSink(const ContactSink&) = delete;
  ContactSink& operator=(const ContactSink&) = delete;

  /// @return whether the sink keeps the contact
  bool add(const FeatureContact& contact);

  /// @brief The contacts that are kept. They are in the order of add() as long as isCut()
  /// is false, then in no order.
  const std::deque<FeatureContact>& contacts() const { return contacts_; }

  /// @brief Whether the capacity was too small, so that contacts were dropped.
  bool isCut() const { return cut_; }

  /// @brief The earliest upper end of a bracket so far; 1 without contacts.
  double firstHi() const { return first_hi_; }

  /// @brief A contact that begins after this time changes nothing: the sink would drop
  /// it, and it has dropped others before.
  double latestKept() const {
    assert(!cut_ || !order_.empty());
    return cut_ ? (*order_.rbegin())->toc_lo : 1;
  }

  /// @brief Whether a contact of the pair, or of parts of it, could be kept if its
  /// bracket begins at this time or later, or could name other triangles of one that is.
  /// It could not if the sink has dropped contacts, and all that it keeps come before
  /// this one.
  bool mayKeep(const FeatureIds& pair, double earliest) const;

  /// @brief The same at t = 0 for any pair of a kind.
  bool mayKeepAtStart(ContinuousContactKind kind) const {
    return mayKeep(FeatureIds{kind, true, {0, 0, 0, 0}, {0, 0}}, 0);
  }

  /// @brief Contacts at t = 0 whose vertices all have larger numbers could not be kept.
  /// The largest number if there is no such bound.
  std::uint32_t lastVertexAtStart() const;

  /// @brief Moves the contacts out, in no order. Call clear() before the next add().
  std::deque<FeatureContact> takeContacts() { return std::move(contacts_); }

  /// @brief Forgets all contacts.
  void clear();

 private:
  struct Earlier {
    bool operator()(const FeatureContact* x, const FeatureContact* y) const {
      return isEarlier(*x, *y);
    }
  };
  void cut();
  void replace(FeatureContact& kept, const FeatureContact& contact);
  bool improve(FeatureContact& kept, const FeatureContact& contact);
  bool mayRepeat(const FeatureContact& contact) const;

  std::size_t capacity_;
  bool may_repeat_;
  bool cut_{false};
  double first_hi_{1};
  /// Their addresses stay.
  std::deque<FeatureContact> contacts_;
  /// If cut_: the contacts, earliest first.
  std::set<FeatureContact*, Earlier> order_;
  /// The contacts whose pairs may come again.
  ContactTable<FeatureContact> seen_;
};

/// @brief Keeps, of the contacts of the same features in several lists, the one that a
/// ContactSink would keep.
/// @param may_repeat  false: only those of parts may repeat
void dropRepeats(bool may_repeat, std::vector<std::deque<FeatureContact>>& lists);

/// @brief The contacts of several lists, earliest first. Only pointers are sorted, since
/// there may be many contacts. With a distance a large part of them may be at t = 0.
class SortedContacts {
  /// A contact, and a number of it that ascends in the order of contacts, as long as they
  /// are in one bucket (Buckets in contact_sink.cpp). Most are told apart by this number,
  /// so that the contacts, which are scattered in memory, are not read.
  struct Entry {
    std::uint64_t key;
    const FeatureContact* contact;
  };

 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = FeatureContact;
    using difference_type = std::ptrdiff_t;
    using pointer = const FeatureContact*;
    using reference = const FeatureContact&;

    Iterator() = default;
    explicit Iterator(const Entry* at) : at_(at) {}
    reference operator*() const { return *at_->contact; }
    pointer operator->() const { return at_->contact; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(at_++); }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const Entry* at_{nullptr};
  };

  SortedContacts() = default;
  explicit SortedContacts(std::vector<std::deque<FeatureContact>> lists);
  SortedContacts(SortedContacts&&) = default;
  SortedContacts& operator=(SortedContacts&&) = default;

  std::size_t size() const { return sorted_.size(); }
  bool empty() const { return sorted_.empty(); }
  const FeatureContact& operator[](std::size_t i) const {
    assert(i < size());
    return *sorted_[i].contact;
  }
  const FeatureContact& front() const { return (*this)[0]; }
  const FeatureContact& back() const { return (*this)[size() - 1]; }
  Iterator begin() const { return Iterator(sorted_.data()); }
  Iterator end() const { return Iterator(sorted_.data() + sorted_.size()); }

 private:
  std::vector<std::deque<FeatureContact>> lists_;
  UninitializedVector<Entry> sorted_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

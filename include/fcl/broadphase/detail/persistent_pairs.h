// SPDX-License-Identifier: BSD-3-Clause
//
// Which pairs and contacts of a manager's answer are those of the answer before.
#ifndef FCL_BROADPHASE_DETAIL_PERSISTENT_PAIRS_H
#define FCL_BROADPHASE_DETAIL_PERSISTENT_PAIRS_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "fcl/broadphase/detail/manager_result.h"
#include "fcl/common/exception.h"

namespace fcl {
namespace detail {

/// @brief The features of a contact, as numbers that compare equal in all steps.
using ContactKey = std::array<int, 9>;

/// Two meshes: which kind of features, on which side, and their vertices. A shape or a
/// cell has no vertices, and the nearest feature of a triangle changes from step to step:
/// there the triangle and the cell count.
/// @param is_self  of a mesh with itself, which has no side
template <typename S>
ContactKey contactKey(const ContinuousContact<S>& contact, bool is_self) {
  ContactKey key{{static_cast<int>(contact.kind), contact.part1, contact.part2,
                  contact.first_on_o1 && !is_self}};
  int* const first = key.data() + 4;
  switch (contact.kind) {
    case ContinuousContactKind::kVertexShape:
    case ContinuousContactKind::kEdgeShape:
    case ContinuousContactKind::kFaceShape:
    case ContinuousContactKind::kShapes: {
      key[0] = static_cast<int>(ContinuousContactKind::kShapes);
      const auto b1 = static_cast<std::uint64_t>(contact.b1),
                 b2 = static_cast<std::uint64_t>(contact.b2);
      first[0] = static_cast<int>(static_cast<std::uint32_t>(b1));
      first[1] = static_cast<int>(static_cast<std::uint32_t>(b1 >> 32));
      first[2] = static_cast<int>(static_cast<std::uint32_t>(b2));
      first[3] = static_cast<int>(static_cast<std::uint32_t>(b2 >> 32));
      return key;
    }
    default:
      break;
  }
  std::copy(contact.vertices.begin(), contact.vertices.end(), first);
  switch (contact.kind) {
    case ContinuousContactKind::kVertexFace:
      std::sort(first + 1, first + 4);
      break;
    case ContinuousContactKind::kVertexEdge:
      std::sort(first + 1, first + 3);
      break;
    case ContinuousContactKind::kCrossing:
      std::sort(first, first + 2);
      std::sort(first + 2, first + 5);
      break;
    case ContinuousContactKind::kEdgeEdge:
      std::sort(first, first + 2);
      std::sort(first + 2, first + 4);
      // In a self-collision no edge is the first one.
      if (is_self && std::lexicographical_compare(first + 2, first + 4, first, first + 2))
        std::swap_ranges(first, first + 2, first + 2);
      break;
    default:
      break;
  }
  return key;
}

}  // namespace detail

/// @brief What has changed from one answer of a ContinuousCollisionManager to the next:
/// pairs that have come into contact, that have stayed, and that have parted; and which
/// contacts of a pair were there before. A program that wants this keeps one object, and
/// gives it the answer of each step:
///
///     manager.collide(request, result);   // ContinuousQuery::kAll
///     pairs.update(result);
///     for (auto& pair : pairs.pairs()) if (pair.isNew()) ...
///     for (auto& pair : pairs.removed()) ...
///
/// The answers should be of one question: with kFirst or kAny, pairs that are not
/// reported count as parted.
///
/// Two contacts of a pair are the same if they have the same features: kind, side and
/// vertices of two meshes; triangle and cell beside a shape or an octree; and parts of
/// compounds. After DeformableBVHModel::updateTopology() vertex ids may mean other
/// vertices. The two objects of a pair keep their order as long as they stay registered.
///
/// Time and memory: O(n log n) and O(n) for n pairs and contacts. Copies are independent.
///
/// @tparam Data  what the program keeps with a pair while it lasts, for example impulses
/// to begin with (warm starts). It is made by Data() for a new pair, and moved.
template <typename S, typename Data = void*>
class PersistentPairs {
 public:
  using Object = ContinuousCollisionObject<S>;

  struct Pair {
    Object* o1;
    Object* o2;
    /// @brief The number of the pair, which it keeps while it lasts. No other pair of
    /// this PersistentPairs has or had it.
    std::uint64_t id;
    /// @brief In how many answers in a row the pair is. The last one is included.
    std::size_t num_steps;
    /// @brief For each contact of the pair: the number of the same contact in the answer
    /// before, or -1.
    std::vector<std::ptrdiff_t> previous;
    Data data;

    bool isNew() const { return num_steps == 1; }
  };

  /// @brief Compares an answer with the one before. If it throws, nothing has changed.
  /// @throws fcl::Exception  a pair is twice in the answer
  void update(const ContinuousManagerResult<S>& result);

  /// @brief The pairs of the last answer, in its order: pairs()[i] is result.pairs[i].
  std::vector<Pair>& pairs() { return state_.pairs; }
  const std::vector<Pair>& pairs() const { return state_.pairs; }

  /// @brief The pairs of the answer before that are not in the last one, in their order,
  /// as they were. They are kept until the next update().
  std::vector<Pair>& removed() { return removed_; }
  const std::vector<Pair>& removed() const { return removed_; }

  /// @brief Drops the pairs of an object. Call it before the object is deleted: another
  /// one may get its address. pairs() no longer has the order of the answer then.
  void forget(const Object* object);
  /// @brief Drops all pairs.
  void clear();

 private:
  /// A contact of a pair by its features, and its number.
  using Contact = std::pair<detail::ContactKey, std::ptrdiff_t>;

  struct State {
    std::vector<Pair> pairs;
    /// Of each pair, sorted.
    std::vector<std::vector<Contact>> contacts;
    /// The numbers of the pairs, sorted by their objects.
    std::vector<std::size_t> order;

    /// The number of a pair, or -1.
    std::ptrdiff_t find(const Object* o1, const Object* o2) const;
    void reserve(std::size_t count);
    void add(Pair&& pair, std::vector<Contact>&& contacts_of_pair);
    void sortOrder();
  };

  static bool isBefore(const Object* x1, const Object* x2, const Object* y1,
                       const Object* y2) {
    const std::less<const Object*> less{};
    return less(x1, y1) || (x1 == y1 && less(x2, y2));
  }
  static std::vector<Contact> sortedContacts(const ContinuousPairResult<S>& pair);
  static std::vector<std::ptrdiff_t> match(const std::vector<Contact>& before,
                                           const std::vector<Contact>& now);

  State state_;
  std::vector<Pair> removed_;
  std::uint64_t next_id_{0};
};

template <typename S, typename Data>
std::ptrdiff_t PersistentPairs<S, Data>::State::find(const Object* o1,
                                                     const Object* o2) const {
  const auto place = std::lower_bound(
      order.begin(), order.end(), 0,
      [&](std::size_t i, int) { return isBefore(pairs[i].o1, pairs[i].o2, o1, o2); });
  if (place == order.end() || pairs[*place].o1 != o1 || pairs[*place].o2 != o2) return -1;
  return static_cast<std::ptrdiff_t>(*place);
}

template <typename S, typename Data>
void PersistentPairs<S, Data>::State::reserve(std::size_t count) {
  pairs.reserve(count);
  contacts.reserve(count);
  order.reserve(count);
}

template <typename S, typename Data>
void PersistentPairs<S, Data>::State::add(Pair&& pair,
                                          std::vector<Contact>&& contacts_of_pair) {
  contacts.push_back(std::move(contacts_of_pair));
  pairs.push_back(std::move(pair));
}

template <typename S, typename Data>
void PersistentPairs<S, Data>::State::sortOrder() {
  order.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) order.push_back(i);
  std::sort(order.begin(), order.end(), [this](std::size_t i, std::size_t j) {
    return isBefore(pairs[i].o1, pairs[i].o2, pairs[j].o1, pairs[j].o2);
  });
}

template <typename S, typename Data>
std::vector<typename PersistentPairs<S, Data>::Contact>
PersistentPairs<S, Data>::sortedContacts(const ContinuousPairResult<S>& pair) {
  std::vector<Contact> contacts;
  contacts.reserve(pair.result.contacts.size());
  for (const ContinuousContact<S>& contact : pair.result.contacts)
    contacts.emplace_back(detail::contactKey(contact, pair.o1 == pair.o2),
                          static_cast<std::ptrdiff_t>(contacts.size()));
  std::sort(contacts.begin(), contacts.end());
  return contacts;
}

/// Contacts with the same features follow each other in both lists.
template <typename S, typename Data>
std::vector<std::ptrdiff_t> PersistentPairs<S, Data>::match(
    const std::vector<Contact>& before, const std::vector<Contact>& now) {
  std::vector<std::ptrdiff_t> previous(now.size(), -1);
  auto old = before.begin();
  for (const Contact& contact : now) {
    while (old != before.end() && old->first < contact.first) ++old;
    if (old == before.end()) break;
    if (old->first == contact.first)
      previous[static_cast<std::size_t>(contact.second)] = (old++)->second;
  }
  return previous;
}

template <typename S, typename Data>
void PersistentPairs<S, Data>::update(const ContinuousManagerResult<S>& result) {
  State next;
  next.reserve(result.pairs.size());
  std::uint64_t next_id = next_id_;
  std::vector<std::ptrdiff_t> before;
  std::vector<bool> stays(state_.pairs.size(), false);
  for (const ContinuousPairResult<S>& pair : result.pairs) {
    std::vector<Contact> contacts = sortedContacts(pair);
    before.push_back(state_.find(pair.o1, pair.o2));
    if (before.back() < 0) {
      next.add({pair.o1, pair.o2, next_id++, 1, match({}, contacts), Data()},
               std::move(contacts));
      continue;
    }
    const auto i = static_cast<std::size_t>(before.back());
    const Pair& old = state_.pairs[i];
    stays[i] = true;
    next.add({pair.o1, pair.o2, old.id, old.num_steps + 1,
              match(state_.contacts[i], contacts), Data()},
             std::move(contacts));
  }
  next.sortOrder();
  for (std::size_t i = 1; i < next.order.size(); ++i) {
    const Pair &x = next.pairs[next.order[i - 1]], &y = next.pairs[next.order[i]];
    if (x.o1 == y.o1 && x.o2 == y.o2)
      throw Exception(
          "PersistentPairs: a pair of objects is twice in the answer. Give that of one "
          "query");
  }
  std::vector<Pair> removed;
  removed.reserve(state_.pairs.size());
  // From here on Data is moved, and nothing is allocated.
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] >= 0)
      next.pairs[i].data =
          std::move(state_.pairs[static_cast<std::size_t>(before[i])].data);
  for (std::size_t i = 0; i < stays.size(); ++i)
    if (!stays[i]) removed.push_back(std::move(state_.pairs[i]));
  state_ = std::move(next);
  removed_ = std::move(removed);
  next_id_ = next_id;
}

template <typename S, typename Data>
void PersistentPairs<S, Data>::forget(const Object* object) {
  const auto isOf = [object](const Pair& pair) {
    return pair.o1 == object || pair.o2 == object;
  };
  State left;
  left.reserve(state_.pairs.size());
  for (std::size_t i = 0; i < state_.pairs.size(); ++i)
    if (!isOf(state_.pairs[i]))
      left.add(std::move(state_.pairs[i]), std::move(state_.contacts[i]));
  left.sortOrder();
  state_ = std::move(left);
  removed_.erase(std::remove_if(removed_.begin(), removed_.end(), isOf), removed_.end());
}

template <typename S, typename Data>
void PersistentPairs<S, Data>::clear() {
  state_ = State();
  removed_.clear();
}

}  // namespace fcl

#endif

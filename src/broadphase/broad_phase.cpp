// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/broad_phase.h"
#include "base/prefetch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Boxes with larger coordinates have no place in a tree: sums of their widths, and
/// differences of these, stay finite in float.
constexpr float kMostTreeHalf = 0x1p100f;

/// A tree is built again when more than one of this number of its objects change. To
/// remove and insert an object takes about as long as to build for four.
constexpr std::size_t kRebuildShare = 4;

bool isBounded(const LinearBox& box) {
  for (const auto& axis : box.axis)
    for (const float bound : axis)
      if (!(std::abs(bound) < kMostTreeHalf)) return false;
  return true;
}

bool isSameAtAllTimes(const MovingBounds& bounds) {
  for (int i = 1; i <= bounds.num_spans; ++i)
    if (!std::equal(bounds.boxes[i].half, bounds.boxes[i].half + HalfAxisBox::kSides,
                    bounds.boxes[0].half))
      return false;
  return true;
}

}  // namespace

/// The distance from which a pair counts, with the sum of its margins. The caller adds
/// the same numbers in another order, or rounds them to float.
double BroadPhase::distanceOf(const MeetingQuery& query, double margin) {
  assert(margin >= 0);
  return margin > 0 ? (query.distance + margin) * (1 + 0x1p-20) : query.distance;
}

LinearQuery BroadPhase::linearQuery(const MeetingQuery& query, double margin) {
  return LinearQuery(distanceOf(query, margin), query.latest);
}

std::vector<void*> BroadPhase::objects() const {
  std::vector<std::pair<std::uint64_t, void*>> in_order;
  in_order.reserve(slot_of_.size());
  for (const auto& entry : slot_of_) {
    const Slot& slot = at(entry.second);
    in_order.emplace_back(slot.serial, slot.object);
  }
  std::sort(in_order.begin(), in_order.end());
  std::vector<void*> out;
  out.reserve(in_order.size());
  for (const auto& entry : in_order) out.push_back(entry.second);
  return out;
}

BroadPhase::SlotNumber BroadPhase::newSlot(void* object) {
  SlotNumber i;
  if (free_.empty()) {
    i = static_cast<SlotNumber>(slots_.size());
    slots_.emplace_back();
    is_stale_.push_back(0);
  } else {
    i = free_.back();
    free_.pop_back();
  }
  [[maybe_unused]] const bool is_new = slot_of_.emplace(object, i).second;
  assert(is_new);
  at(i).object = object;
  at(i).serial = next_serial_++;
  at(i).filter = ObjectFilter();
  at(i).self = false;
  at(i).margin = 0;
  at(i).source = kNoSource;
  return i;
}

/// Whether each object is a member of one set, and is in the tree of this set.
bool BroadPhase::isConsistent() const {
  std::size_t num_members = 0;
  for (const std::vector<SlotNumber>& members : members_) num_members += members.size();
  return num_members == slot_of_.size() && is_stale_.size() == slots_.size() &&
         slots_.size() - free_.size() == slot_of_.size() &&
         tree_[kMoving].size() == members_[kMoving].size() &&
         tree_[kResting].size() == members_[kResting].size();
}

void BroadPhase::setBounds(const MovingBounds& bounds, Slot& slot) {
  assert(bounds.num_spans > 0 && (bounds.num_spans & (bounds.num_spans - 1)) == 0);
  slot.boxes.assign(bounds.boxes, bounds.boxes + bounds.num_spans + 1);
  slot.flat = bounds.flat ? std::make_unique<MovingFlat>(*bounds.flat) : nullptr;
  slot.rests = isSameAtAllTimes(bounds) && (!bounds.flat || bounds.flat->rests());
  setBox(slot);
}

/// The box for a tree, and whether there is one.
void BroadPhase::setBox(Slot& slot) {
  slot.box = linearBox(slot.bounds());
  if (slot.margin > 0)
    for (auto& axis : slot.box.axis)
      for (float& side : axis)
        side = roundUp(static_cast<double>(side) + slot.margin * (1 + 0x1p-20), 0);
  slot.mobility = !isBounded(slot.box) ? kUnbounded : slot.rests ? kResting : kMoving;
}

void BroadPhase::join(SlotNumber i) {
  std::vector<SlotNumber>& members = members_[at(i).mobility];
  at(i).member = members.size();
  members.push_back(i);
}

void BroadPhase::leave(SlotNumber i, Mobility mobility) {
  std::vector<SlotNumber>& members = members_[mobility];
  assert(at(i).member < members.size() && members[at(i).member] == i);
  members[at(i).member] = members.back();
  at(members.back()).member = at(i).member;
  members.pop_back();
}

void BroadPhase::addSource(SlotNumber i, const Revision& revision) {
  sources_.push_back({revision, revision->load(), i, at(i).source});
  at(i).source = sources_.size() - 1;
}

void BroadPhase::removeSources(SlotNumber i) {
  while (at(i).source != kNoSource) {
    const std::size_t gone = at(i).source, last = sources_.size() - 1;
    assert(sources_[gone].slot == i);
    at(i).source = sources_[gone].next;
    if (gone != last) {
      // The last source moves into the hole. Its list is told the new number.
      std::size_t* reference = &at(sources_[last].slot).source;
      while (*reference != last) reference = &sources_[*reference].next;
      *reference = gone;
      sources_[gone] = std::move(sources_[last]);
    }
    sources_.pop_back();
  }
}

void BroadPhase::setSources(SlotNumber i, const BoundsList& bounds,
                            const BoundsList::Item& item) {
  const std::size_t source = at(i).source;
  const auto revision = [&](std::size_t k) -> const Revision& {
    return *bounds.revisions[item.first_revision + k];
  };
  if (item.num_revisions == 1 && source != kNoSource &&
      sources_[source].next == kNoSource) {
    sources_[source].revision = revision(0);
    sources_[source].read = revision(0)->load();
    return;
  }
  removeSources(i);
  for (std::size_t k = 0; k < item.num_revisions; ++k) addSource(i, revision(k));
}

const void* BroadPhase::findChanged(const void* except) const {
  for (const Source& source : sources_)
    if (source.revision->load(std::memory_order_relaxed) != source.read &&
        at(source.slot).object != except)
      return at(source.slot).object;
  return nullptr;
}

void BroadPhase::markStale(SlotNumber i) {
  char& is_stale = is_stale_[static_cast<std::size_t>(i)];
  if (is_stale) return;
  is_stale = 1;
  stale_.push_back(i);
}

void BroadPhase::insert(void* const* objects, const BoundsList& bounds) {
  std::vector<SlotNumber> slots;
  slots.reserve(bounds.items.size());
  for (std::size_t i = 0; i < bounds.items.size(); ++i)
    slots.push_back(newSlot(objects[i]));
  change(slots, bounds, true);
}

void BroadPhase::update(const std::vector<SlotNumber>& slots, const BoundsList& bounds) {
  change(slots, bounds, false);
}

std::vector<BroadPhase::SlotNumber> BroadPhase::find(void* const* objects,
                                                     std::size_t count) const {
  std::vector<SlotNumber> slots;
  slots.reserve(count);
  // As a rule the order is that of the insertion.
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!objects[i] || next >= slots_.size() || slots_[next].object != objects[i]) {
      const auto entry = slot_of_.find(objects[i]);
      if (entry == slot_of_.end()) {
        slots.push_back(-1);
        continue;
      }
      next = static_cast<std::size_t>(entry->second);
    }
    slots.push_back(static_cast<SlotNumber>(next++));
  }
  return slots;
}

/// Gives new bounds to objects. A tree in which many objects change is built again.
void BroadPhase::change(const std::vector<SlotNumber>& slots, const BoundsList& bounds,
                        bool are_new) {
  const bool is_rebuilt[2] = {slots.size() * kRebuildShare > members_[kMoving].size(),
                              slots.size() * kRebuildShare > members_[kResting].size()};
  bool is_touched[2] = {false, false};
  assert(slots.size() == bounds.items.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const SlotNumber number = slots[i];
    Slot& slot = at(number);
    assert(slot.object);
    if (!are_new) {
      if (slot.rests) markStale(number);
      if (slot.mobility != kUnbounded) {
        is_touched[slot.mobility] = true;
        if (!is_rebuilt[slot.mobility]) tree_[slot.mobility].remove(number);
      }
    }
    const Mobility before = slot.mobility;
    setBounds(bounds.at(i), slot);
    setSources(number, bounds, bounds.items[i]);
    if (slot.rests) markStale(number);
    if (are_new || slot.mobility != before) {
      if (!are_new) leave(number, before);
      join(number);
    }
    if (slot.mobility == kUnbounded) continue;
    is_touched[slot.mobility] = true;
    if (!is_rebuilt[slot.mobility]) tree_[slot.mobility].insert({&slot.box, number});
  }
  for (const Mobility mobility : {kMoving, kResting})
    if (is_touched[mobility] && is_rebuilt[mobility]) buildTree(mobility);
  assert(isConsistent());
}

void BroadPhase::buildTree(Mobility mobility) {
  std::vector<MovingBoxTree::Leaf> leaves;
  leaves.reserve(members_[mobility].size());
  for (const SlotNumber i : members_[mobility]) leaves.push_back({&at(i).box, i});
  tree_[mobility].build(leaves);
}

void BroadPhase::rebuild() {
  buildTree(kMoving);
  buildTree(kResting);
}

void BroadPhase::remove(const void* object) {
  const auto entry = slot_of_.find(object);
  assert(entry != slot_of_.end());
  const SlotNumber i = entry->second;
  slot_of_.erase(entry);
  if (at(i).rests) markStale(i);
  leave(i, at(i).mobility);
  if (at(i).mobility != kUnbounded) tree_[at(i).mobility].remove(i);
  removeSources(i);
  at(i).object = nullptr;
  at(i).flat.reset();
  free_.push_back(i);
  assert(isConsistent());
}

void BroadPhase::clear() {
  slot_of_.clear();
  slots_.clear();
  free_.clear();
  for (auto& members : members_) members.clear();
  sources_.clear();
  for (auto& tree : tree_) tree.clear();
  resting_.clear();
  stale_.clear();
  is_stale_.clear();
}

void BroadPhase::setFilter(const void* object, const ObjectFilter& filter) {
  const SlotNumber i = numberOf(object);
  at(i).filter = filter;
  if (at(i).rests) markStale(i);
}

void BroadPhase::setMargin(const void* object, double margin) {
  assert(margin >= 0 && std::isfinite(margin));
  const SlotNumber number = numberOf(object);
  Slot& slot = at(number);
  if (slot.margin == margin) return;
  const Mobility before = slot.mobility;
  if (before != kUnbounded) tree_[before].remove(number);
  slot.margin = margin;
  setBox(slot);
  if (slot.rests) markStale(number);
  if (slot.mobility != before) {
    leave(number, before);
    join(number);
  }
  if (slot.mobility != kUnbounded) tree_[slot.mobility].insert({&slot.box, number});
  assert(isConsistent());
}

void BroadPhase::setSelf(const void* object, bool self) {
  at(numberOf(object)).self = self;
}

ObjectFilter BroadPhase::filterOf(const void* object) const {
  const auto entry = slot_of_.find(object);
  return entry == slot_of_.end() ? ObjectFilter() : at(entry->second).filter;
}

double BroadPhase::marginOf(const void* object) const {
  const auto entry = slot_of_.find(object);
  return entry == slot_of_.end() ? 0 : at(entry->second).margin;
}

/// Adds those pairs whose boxes meet and whose filters accept each other.
void BroadPhase::addMeeting(const BroadPhase& one, const BroadPhase& two,
                            const std::vector<SlotPair>& near, const MeetingQuery& query,
                            std::vector<Found>& found) {
  // Neighbours in space are scattered in memory.
  constexpr std::size_t kAheadOfSlots = 16, kAheadOfBoxes = 8;
  const std::size_t last = near.size() - 1;
  found.reserve(found.size() + near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    const SlotPair &slots = near[std::min(i + kAheadOfSlots, last)],
                   &boxes = near[std::min(i + kAheadOfBoxes, last)];
    prefetchMemory(&one.at(slots.first));
    prefetchMemory(&two.at(slots.second));
    prefetchMemory(one.at(boxes.first).boxes.data());
    prefetchMemory(two.at(boxes.second).boxes.data());
    const Slot &a = one.at(near[i].first), &b = two.at(near[i].second);
    if (a.object == b.object || !a.filter.accepts(b.filter)) continue;
    const MeetingWindow window =
        meetingWindow(a.bounds(), b.bounds(), distanceOf(query, a.margin + b.margin));
    if (window.isEmpty() || window.lo > query.latest) continue;
    assert(&one != &two || a.serial != b.serial);
    if (&one == &two && b.serial < a.serial)
      found.push_back({window, b.serial, a.serial, near[i].second, near[i].first});
    else
      found.push_back({window, a.serial, b.serial, near[i].first, near[i].second});
  }
}

/// The objects of a tree that an object may meet. The boxes have their margins.
template <typename Visit>
void BroadPhase::visitMeeting(const MovingBoxTree& tree, const Slot& slot,
                              const MeetingQuery& query, Visit&& visit) {
  if (slot.flat)
    tree.visitMeeting(*slot.flat, linearQuery(query, slot.margin), visit);
  else
    tree.visitMeeting(slot.box, linearQuery(query), visit);
}

/// The pairs of which at least one object moves.
void BroadPhase::findMoving(const MeetingQuery& query,
                            std::vector<SlotPair>& near) const {
  const auto add = [&](SlotNumber a, SlotNumber b) { near.emplace_back(a, b); };
  tree_[kMoving].visitPairs(linearQuery(query), add);
  tree_[kMoving].visitPairs(tree_[kResting], linearQuery(query), add);
  const std::vector<SlotNumber>& unbounded = members_[kUnbounded];
  for (std::size_t i = 0; i < unbounded.size(); ++i) {
    const SlotNumber a = unbounded[i];
    const auto add_to = [&](SlotNumber b) { add(a, b); };
    visitMeeting(tree_[kMoving], at(a), query, add_to);
    if (!at(a).rests) visitMeeting(tree_[kResting], at(a), query, add_to);
    for (std::size_t k = 0; k < i; ++k)
      if (!at(a).rests || !at(unbounded[k]).rests) add(a, unbounded[k]);
  }
}

/// The pairs of two objects that rest.
void BroadPhase::findResting(const MeetingQuery& query,
                             std::vector<SlotPair>& near) const {
  const auto add = [&](SlotNumber a, SlotNumber b) { near.emplace_back(a, b); };
  tree_[kResting].visitPairs(linearQuery(query), add);
  const std::vector<SlotNumber>& unbounded = members_[kUnbounded];
  for (std::size_t i = 0; i < unbounded.size(); ++i) {
    const SlotNumber a = unbounded[i];
    if (!at(a).rests) continue;
    visitMeeting(tree_[kResting], at(a), query, [&](SlotNumber b) { add(a, b); });
    for (std::size_t k = 0; k < i; ++k)
      if (at(unbounded[k]).rests) add(a, unbounded[k]);
  }
}

/// The pairs of a stale object that rests with all others that rest.
void BroadPhase::findRestingOf(SlotNumber i, std::vector<SlotPair>& near) const {
  const auto add_to = [&](SlotNumber k) {
    // Of two stale objects, each finds the other. The one with the lower number adds the
    // pair.
    if (k != i && !(is_stale_[static_cast<std::size_t>(k)] && k < i))
      near.emplace_back(i, k);
  };
  visitMeeting(tree_[kResting], at(i), MeetingQuery(), add_to);
  for (const SlotNumber k : members_[kUnbounded])
    if (at(k).rests) add_to(k);
}

void BroadPhase::refreshResting() const {
  if (stale_.empty()) return;
  const auto is_stale = [this](SlotNumber i) {
    return is_stale_[static_cast<std::size_t>(i)] != 0;
  };
  resting_.erase(std::remove_if(resting_.begin(), resting_.end(),
                                [&](const Found& pair) {
                                  return is_stale(pair.a) || is_stale(pair.b);
                                }),
                 resting_.end());
  std::vector<SlotPair> near;
  for (const SlotNumber i : stale_)
    if (at(i).object && at(i).rests) findRestingOf(i, near);
  addMeeting(*this, *this, near, MeetingQuery(), resting_);
  assert(std::all_of(resting_.begin(), resting_.end(), [this](const Found& pair) {
    return at(pair.a).object && at(pair.a).rests && at(pair.b).object && at(pair.b).rests;
  }));
  for (const SlotNumber i : stale_) is_stale_[static_cast<std::size_t>(i)] = 0;
  stale_.clear();
}

/// Sorts by the start of the window, then by the order of insertion. Pairs are spread
/// over buckets in this order: those that meet at t = 0 by the order of insertion, the
/// others by their time. If the times are spread evenly this takes O(n).
void BroadPhase::sort(std::vector<Found>& found) const {
  const auto is_before = [](const Found& x, const Found& y) {
    if (x.window.lo != y.window.lo) return x.window.lo < y.window.lo;
    if (x.serial_a != y.serial_a) return x.serial_a < y.serial_a;
    return x.serial_b < y.serial_b;
  };
  const auto meets_at_0 = [](const Found& pair) { return pair.window.lo <= 0; };
  const double count = static_cast<double>(found.size()),
               at_0 = static_cast<double>(
                   std::count_if(found.begin(), found.end(), meets_at_0)),
               per_serial = at_0 / static_cast<double>(next_serial_);
  const auto bucket_of = [&](const Found& pair) {
    return static_cast<std::size_t>(meets_at_0(pair)
                                        ? per_serial * static_cast<double>(pair.serial_a)
                                        : at_0 + (count - at_0) * pair.window.lo);
  };
  // A product may round up to the beginning of the next part, and a window begin at 1.
  std::vector<std::size_t> end(found.size() + 2, 0);
  for (const Found& pair : found) {
    assert(bucket_of(pair) + 1 < end.size());
    ++end[bucket_of(pair) + 1];
  }
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Found> spread(found.size());
  for (const Found& pair : found) spread[end[bucket_of(pair)]++] = pair;
  std::size_t first = 0;
  for (const std::size_t last : end) {
    if (last - first > 1)
      std::sort(spread.begin() + static_cast<std::ptrdiff_t>(first),
                spread.begin() + static_cast<std::ptrdiff_t>(last), is_before);
    first = last;
  }
  found.swap(spread);
  assert(std::is_sorted(found.begin(), found.end(), is_before));
}

std::vector<MeetingObjects> BroadPhase::sorted(std::vector<Found>& found,
                                               const BroadPhase& other) const {
  sort(found);
  std::vector<MeetingObjects> out;
  out.reserve(found.size());
  constexpr std::size_t kAhead = 16;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Found &pair = found[i], &ahead = found[std::min(i + kAhead, found.size() - 1)];
    prefetchMemory(&at(ahead.a));
    prefetchMemory(&other.at(ahead.b));
    out.push_back({pair.window, at(pair.a).object, other.at(pair.b).object});
  }
  return out;
}

std::vector<MeetingObjects> BroadPhase::pairs(const MeetingQuery& query) const {
  std::vector<SlotPair> near;
  std::vector<Found> found;
  findMoving(query, near);
  if (query.distance == 0) {
    // What is remembered is for the distance 0.
    const std::lock_guard<std::mutex> lock(resting_mutex_);
    refreshResting();
    found = resting_;
  } else {
    findResting(query, near);
  }
  addMeeting(*this, *this, near, query, found);
  if (query.with_self)
    for (const auto& entry : slot_of_) {
      const Slot& slot = at(entry.second);
      if (slot.self)
        found.push_back({{0, 1}, slot.serial, slot.serial, entry.second, entry.second});
    }
  return sorted(found, *this);
}

/// Calls visit(slot number, slot, window) for the objects that meet another one.
template <typename Visit>
void BroadPhase::visitMet(const MovingBounds& bounds, const ObjectFilter& filter,
                          const MeetingQuery& query, Visit&& visit) const {
  const LinearQuery linear = linearQuery(query);
  const LinearBox box = linearBox(bounds);
  const auto test = [&](SlotNumber i) {
    const Slot& slot = at(i);
    if (!filter.accepts(slot.filter)) return;
    const MeetingWindow window =
        meetingWindow(bounds, slot.bounds(), distanceOf(query, slot.margin));
    if (!window.isEmpty() && window.lo <= query.latest) visit(i, slot, window);
  };
  for (const MovingBoxTree& tree : tree_)
    if (bounds.flat)
      tree.visitMeeting(*bounds.flat, linear, test);
    else
      tree.visitMeeting(box, linear, test);
  for (const SlotNumber i : members_[kUnbounded]) test(i);
}

std::vector<MeetingObjects> BroadPhase::pairsOf(void* object, const MovingBounds& bounds,
                                                const MeetingQuery& query) const {
  std::vector<Found> found;
  MeetingQuery with_margin = query;
  with_margin.distance = distanceOf(query, marginOf(object));
  visitMet(bounds, filterOf(object), with_margin,
           [&](SlotNumber i, const Slot& slot, const MeetingWindow& window) {
             if (slot.object != object)
               found.push_back({window, slot.serial, slot.serial, i, i});
           });
  std::vector<MeetingObjects> out = sorted(found, *this);
  for (MeetingObjects& pair : out) pair.o1 = object;
  return out;
}

void BroadPhase::addMet(const MovingBounds& bounds, const ObjectFilter& filter,
                        const MeetingQuery& query, std::vector<MetObject>& met) const {
  visitMet(bounds, filter, query,
           [&](SlotNumber, const Slot& slot, const MeetingWindow& window) {
             met.push_back({window, slot.object, slot.serial});
           });
}

std::vector<MeetingObjects> BroadPhase::pairsWith(const BroadPhase& other,
                                                  const MeetingQuery& query) const {
  const LinearQuery linear = linearQuery(query);
  std::vector<SlotPair> near;
  const auto add = [&](SlotNumber a, SlotNumber b) { near.emplace_back(a, b); };
  for (const MovingBoxTree& one : tree_)
    for (const MovingBoxTree& two : other.tree_) one.visitPairs(two, linear, add);
  for (const SlotNumber a : members_[kUnbounded]) {
    const auto add_to = [&](SlotNumber b) { add(a, b); };
    for (const MovingBoxTree& two : other.tree_) visitMeeting(two, at(a), query, add_to);
    for (const SlotNumber b : other.members_[kUnbounded]) add(a, b);
  }
  for (const SlotNumber b : other.members_[kUnbounded])
    for (const MovingBoxTree& one : tree_)
      visitMeeting(one, other.at(b), query, [&](SlotNumber a) { add(a, b); });
  std::vector<Found> found;
  addMeeting(*this, other, near, query, found);
  return sorted(found, other);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

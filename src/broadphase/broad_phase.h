// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BROADPHASE_BROAD_PHASE_H
#define FCL_CCD_BROADPHASE_BROAD_PHASE_H

#include <atomic>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "broadphase/moving_box_tree.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Groups and masks: two objects can be in contact if the group of each one has a
/// bit in common with the mask of the other one.
struct ObjectFilter {
  std::uint32_t group{1};
  std::uint32_t mask{~std::uint32_t{0}};

  bool accepts(const ObjectFilter& other) const {
    return (group & other.mask) != 0 && (other.group & mask) != 0;
  }
};

/// @brief A number that is another one after each change of what bounds were read from.
using Revision = std::shared_ptr<std::atomic<std::uint64_t>>;

/// @brief The moving bounds of many objects in one array.
struct BoundsList {
  struct Item {
    static constexpr std::size_t kNoFlat = ~std::size_t{0};

    std::size_t first;
    int num_spans;
    std::size_t flat{kNoFlat};
    /// In `revisions`: those of what was read. None: it does not tell when it changes.
    std::size_t first_revision{0};
    std::size_t num_revisions{0};
  };
  std::vector<HalfAxisBox> boxes;
  std::vector<MovingFlat> flats;
  std::vector<Item> items;
  std::vector<const Revision*> revisions;

  /// @brief Adds a revision to the last item.
  void addRevision(const Revision& revision) {
    Item& item = items.back();
    if (item.num_revisions++ == 0) item.first_revision = revisions.size();
    revisions.push_back(&revision);
  }
  MovingBounds at(std::size_t i) const {
    assert(i < items.size());
    const Item& item = items[i];
    assert(item.num_spans > 0 &&
           item.first + static_cast<std::size_t>(item.num_spans) < boxes.size());
    return {boxes.data() + item.first, item.num_spans,
            item.flat == Item::kNoFlat ? nullptr : &flats[item.flat]};
  }
  void clear() {
    boxes.clear();
    flats.clear();
    items.clear();
    revisions.clear();
  }
};

/// @brief Two objects whose boxes meet, and when.
struct MeetingObjects {
  MeetingWindow window;
  void* o1;
  void* o2;
};

/// @brief An object whose box meets that of another one.
struct MetObject {
  MeetingWindow window;
  void* object;
  /// Grows from object to object in the order of insertion.
  std::uint64_t serial;
};

/// @brief Two objects, and a distance that their boxes keep.
struct NearObjects {
  double distance;
  void* o1;
  void* o2;
};

/// @brief Which pairs are visited in the order of the distance of their boxes.
struct NearestQuery {
  /// The latest time that counts.
  double latest{1};
  /// The largest distance that is of interest.
  double limit{HUGE_VAL};
  /// Visits a pair; returns the new limit. Negative or NaN: the search ends.
  std::function<double(const NearObjects&)> visit;
};

struct MeetingQuery {
  double distance{0};
  double latest{1};
  /// Whether objects with setSelf() are paired with themselves.
  bool with_self{false};
};

/// @brief Finds the pairs of objects whose moving boxes meet. Objects that move, and
/// those that rest, have a tree each; objects without bounds are in a list and are tested
/// against all others. Planes and halfspaces are in this list too: they go down the
/// trees. The pairs of two objects that rest are remembered: they cost nothing until such
/// an object is added, changed or removed.
///
/// Thread-safety: const functions may run at the same time.
class BroadPhase {
 public:
  BroadPhase() = default;
  BroadPhase(const BroadPhase&) = delete;
  BroadPhase& operator=(const BroadPhase&) = delete;

  std::size_t size() const { return slot_of_.size(); }
  bool contains(const void* object) const { return slot_of_.count(object) != 0; }
  /// @brief In the order in which they were inserted.
  std::vector<void*> objects() const;
  /// @brief An object whose revision is not the one that was read; null: there is none.
  /// @param except  an object that does not count
  const void* findChanged(const void* except) const;

  /// @pre no object is there, and none twice
  void insert(void* const* objects, const BoundsList& bounds);
  /// @param slots  of the objects, by find()
  void update(const std::vector<std::int32_t>& slots, const BoundsList& bounds);
  /// @brief The slots of objects, or -1 for those that are not there.
  std::vector<std::int32_t> find(void* const* objects, std::size_t count) const;
  /// @pre the object is there
  void remove(const void* object);
  void setFilter(const void* object, const ObjectFilter& filter);
  void setSelf(const void* object, bool self);
  /// @brief A pair counts from the distance of a query plus the margins of both objects.
  /// 0 at first.
  /// @pre the margin is finite and not negative
  void setMargin(const void* object, double margin);
  void clear();
  /// @brief New trees.
  void rebuild();

  /// @brief The filter of an object; of one that is not there, the default.
  ObjectFilter filterOf(const void* object) const;
  /// @brief The margin of an object; of one that is not there, 0.
  double marginOf(const void* object) const;

  /// @brief Sorted by the start of the window, then by the order of insertion. Of a pair,
  /// o1 was inserted first.
  std::vector<MeetingObjects> pairs(const MeetingQuery& query) const;
  /// @brief The pairs of one object, which is o1, with all others.
  std::vector<MeetingObjects> pairsOf(void* object, const MovingBounds& bounds,
                                      const MeetingQuery& query) const;
  /// @brief Adds the objects that meet one which is not in this set, in no order.
  void addMet(const MovingBounds& bounds, const ObjectFilter& filter,
              const MeetingQuery& query, std::vector<MetObject>& met) const;
  /// @brief o1 is in this set, o2 in the other one.
  std::vector<MeetingObjects> pairsWith(const BroadPhase& other,
                                        const MeetingQuery& query) const;

  /// @brief Visits pairs in the order of the distance of their boxes, until it is above
  /// the limit. The order is the same however the objects came here. Of a pair, o1 was
  /// inserted first.
  void visitNearest(const NearestQuery& query) const;
  /// @brief The pairs of one object, which is o1, with all others.
  void visitNearestOf(void* object, const MovingBounds& bounds,
                      const NearestQuery& query) const;
  /// @brief o1 is in this set, o2 in the other one.
  void visitNearestWith(const BroadPhase& other, const NearestQuery& query) const;

 private:
  class NearestSearch;

  using SlotNumber = std::int32_t;
  static constexpr std::size_t kNoSource = ~std::size_t{0};
  enum Mobility { kMoving, kResting, kUnbounded, kNumMobilities };

  struct Slot {
    void* object{nullptr};
    std::uint64_t serial{0};
    ObjectFilter filter;
    bool self{false};
    /// Whether its box is the same at all times.
    bool rests{false};
    Mobility mobility{kUnbounded};
    /// In members_[mobility].
    std::size_t member{0};
    /// The last one in sources_, or kNoSource.
    std::size_t source{kNoSource};
    double margin{0};
    /// Of the bounds, with the margin around it.
    LinearBox box;
    std::vector<HalfAxisBox> boxes;
    /// Null as a rule.
    std::unique_ptr<MovingFlat> flat;

    MovingBounds bounds() const {
      return {boxes.data(), static_cast<int>(boxes.size()) - 1, flat.get()};
    }
  };
  using SlotPair = std::pair<SlotNumber, SlotNumber>;
  /// What an object was read from, if that says when it changes. A compound has one for
  /// each mesh.
  struct Source {
    Revision revision;
    std::uint64_t read;
    SlotNumber slot;
    /// Another one of the slot, or kNoSource.
    std::size_t next;
  };
  /// Two objects that meet, with all that sorting needs.
  struct Found {
    MeetingWindow window;
    std::uint64_t serial_a, serial_b;
    SlotNumber a, b;
  };
  template <typename Visit>
  void visitMet(const MovingBounds& bounds, const ObjectFilter& filter,
                const MeetingQuery& query, Visit&& visit) const;
  static double distanceOf(const MeetingQuery& query, double margin);
  static LinearQuery linearQuery(const MeetingQuery& query, double margin = 0);
  Slot& at(SlotNumber i) {
    assert(i >= 0 && static_cast<std::size_t>(i) < slots_.size());
    return slots_[static_cast<std::size_t>(i)];
  }
  const Slot& at(SlotNumber i) const {
    assert(i >= 0 && static_cast<std::size_t>(i) < slots_.size());
    return slots_[static_cast<std::size_t>(i)];
  }
  bool isConsistent() const;
  SlotNumber numberOf(const void* object) const { return slot_of_.at(object); }
  SlotNumber newSlot(void* object);
  void setBounds(const MovingBounds& bounds, Slot& slot);
  static void setBox(Slot& slot);
  void join(SlotNumber i);
  void leave(SlotNumber i, Mobility mobility);
  void addSource(SlotNumber i, const Revision& revision);
  void removeSources(SlotNumber i);
  void setSources(SlotNumber i, const BoundsList& bounds, const BoundsList::Item& item);
  void change(const std::vector<SlotNumber>& slots, const BoundsList& bounds,
              bool are_new);
  void buildTree(Mobility mobility);
  void markStale(SlotNumber i);

  static void addMeeting(const BroadPhase& one, const BroadPhase& two,
                         const std::vector<SlotPair>& near, const MeetingQuery& query,
                         std::vector<Found>& found);
  template <typename Visit>
  static void visitMeeting(const MovingBoxTree& tree, const Slot& slot,
                           const MeetingQuery& query, Visit&& visit);
  void findMoving(const MeetingQuery& query, std::vector<SlotPair>& near) const;
  void findResting(const MeetingQuery& query, std::vector<SlotPair>& near) const;
  void findRestingOf(SlotNumber i, std::vector<SlotPair>& near) const;
  void refreshResting() const;
  void sort(std::vector<Found>& found) const;
  std::vector<MeetingObjects> sorted(std::vector<Found>& found,
                                     const BroadPhase& other) const;

  std::unordered_map<const void*, SlotNumber> slot_of_;
  std::vector<Slot> slots_;
  std::vector<SlotNumber> free_;
  std::vector<SlotNumber> members_[kNumMobilities];
  std::vector<Source> sources_;
  MovingBoxTree tree_[2];
  std::uint64_t next_serial_{0};

  /// The pairs of objects that rest, within their margins, except those of stale slots.
  mutable std::mutex resting_mutex_;
  mutable std::vector<Found> resting_;
  mutable std::vector<SlotNumber> stale_;
  mutable std::vector<char> is_stale_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of objects in the order of the distance of their boxes: the pair of nodes that
// may be nearest is opened first.
#include <cassert>
#include <cmath>
#include <deque>
#include <queue>
#include <tuple>

#include "broadphase/broad_phase.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A distance at which two things do not meet, or 0. The answer is the same for all that
/// meet at the same distances.
/// @param meets  whether they meet at a distance; if so, also at a larger one
/// @param exponent  of the distances that are tried, at most
/// @param steps  more steps, a better distance: it is less than the least one at which
/// they meet by 2^-steps of it
template <typename Meets>
double keptDistance(int exponent, int steps, const Meets& meets) {
  int low = -exponent, high = exponent;
  if (meets(0.) || meets(std::ldexp(1., low))) return 0;
  if (!meets(std::ldexp(1., high))) return std::ldexp(1., high);
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (meets(std::ldexp(1., middle)) ? high : low) = middle;
  }
  double apart = std::ldexp(1., low), near = std::ldexp(1., high);
  for (int i = 0; i < steps; ++i) {
    const double middle = (apart + near) / 2;
    (meets(middle) ? near : apart) = middle;
  }
  assert(0 < apart && apart < near);
  return apart;
}

}  // namespace

class BroadPhase::NearestSearch {
 public:
  NearestSearch(const BroadPhase& first, const BroadPhase& second, double latest)
      : set_{&first, &second}, latest_(latest) {
    for (int set = 0; set < 2; ++set)
      for (const Mobility mobility : {kMoving, kResting})
        tree_[set][mobility] =
            set == 1 && &first == &second ? tree_[0][mobility] : makeTree(set, mobility);
    for (int set = 0; set < 2; ++set)
      for (const SlotNumber i : set_[set]->members_[kUnbounded])
        unbounded_[set].push_back(partOf(set_[set]->at(i)));
  }

  /// The pairs of the first set.
  void addOwnPairs() {
    for (const Tree* tree : tree_[0]) addWithin(*tree, tree->of->root());
    addPair(rootOf(tree_[0][kMoving]), rootOf(tree_[0][kResting]));
    for (std::size_t i = 0; i < unbounded_[0].size(); ++i) {
      const Part& part = unbounded_[0][i];
      for (const Tree* tree : tree_[0]) addPair(part, rootOf(tree));
      for (std::size_t k = 0; k < i; ++k) addPair(part, unbounded_[0][k]);
    }
  }

  /// The pairs of an object with those of the second set.
  void addPairsOf(void* object, const MovingBounds& bounds, const ObjectFilter& filter) {
    single_.push_back({object, 0, bounds, linearBox(bounds), filter});
    addWithSecond(Part{nullptr, 0, &single_.back()});
  }

  /// The pairs across.
  void addPairsAcross() {
    for (const Tree* tree : tree_[0]) addWithSecond(rootOf(tree));
    for (const Part& part : unbounded_[0]) addWithSecond(part);
  }

  void run(const NearestQuery& query) {
    double limit = query.limit;
    while (!queue_.empty() && queue_.top().distance <= limit) {
      const Work work = queue_.top();
      queue_.pop();
      if (work.is_pair)
        limit = query.visit({work.distance, objectOf(work.a), objectOf(work.b)});
      else
        open(work);
    }
  }

 private:
  /// A tree, and for each node the groups and masks of all that is below it.
  struct Tree {
    const BroadPhase* set;
    const MovingBoxTree* of;
    std::vector<ObjectFilter> filters;
  };
  struct Object {
    void* object;
    std::uint64_t serial;
    MovingBounds bounds;
    LinearBox box;
    ObjectFilter filter;
  };
  /// A node of a tree, or an object that is in none.
  struct Part {
    const Tree* tree;
    std::int32_t node;
    const Object* object;
  };
  struct Work {
    double distance;
    /// Whether both parts are one object.
    bool is_pair;
    /// Of a pair.
    std::uint64_t serial_a, serial_b;
    Part a, b;

    /// Nodes come first: so pairs at the same distance come by their numbers.
    bool operator<(const Work& other) const { return key() > other.key(); }
    std::tuple<double, bool, std::uint64_t, std::uint64_t> key() const {
      return {distance, is_pair, serial_a, serial_b};
    }
  };

  const Tree* makeTree(int set, Mobility mobility) {
    const MovingBoxTree& of = set_[set]->tree_[mobility];
    trees_.push_back({set_[set], &of, std::vector<ObjectFilter>(of.numNodes())});
    Tree& tree = trees_.back();
    if (of.size() > 0) setFilter(tree, of.root());
    return &tree;
  }

  static ObjectFilter setFilter(Tree& tree, std::int32_t node) {
    ObjectFilter& filter = tree.filters[static_cast<std::size_t>(node)];
    if (tree.of->isLeaf(node)) {
      filter = tree.set->at(tree.of->objectOf(node)).filter;
    } else {
      const ObjectFilter first = setFilter(tree, tree.of->childOf(node, 0)),
                         second = setFilter(tree, tree.of->childOf(node, 1));
      filter = {first.group | second.group, first.mask | second.mask};
    }
    return filter;
  }

  static Part rootOf(const Tree* tree) { return {tree, tree->of->root(), nullptr}; }

  Part partOf(const Slot& slot) {
    single_.push_back({slot.object, slot.serial, slot.bounds(), slot.box, slot.filter});
    return {nullptr, 0, &single_.back()};
  }

  static bool isEmpty(const Part& part) { return part.tree && part.node < 0; }
  static bool isObject(const Part& part) {
    return !part.tree || part.tree->of->isLeaf(part.node);
  }
  static const Slot& slotOf(const Part& leaf) {
    return leaf.tree->set->at(leaf.tree->of->objectOf(leaf.node));
  }
  static const LinearBox& boxOf(const Part& part) {
    return part.tree ? part.tree->of->boxOf(part.node) : part.object->box;
  }
  static const MovingFlat* flatOf(const Part& part) {
    return part.tree ? nullptr : part.object->bounds.flat;
  }
  static const ObjectFilter& filterOf(const Part& part) {
    return part.tree ? part.tree->filters[static_cast<std::size_t>(part.node)]
                     : part.object->filter;
  }
  static void* objectOf(const Part& part) {
    return part.tree ? slotOf(part).object : part.object->object;
  }
  static std::uint64_t serialOf(const Part& part) {
    return part.tree ? slotOf(part).serial : part.object->serial;
  }
  static MovingBounds boundsOf(const Part& part) {
    return part.tree ? slotOf(part).bounds() : part.object->bounds;
  }

  /// The pairs below a node.
  void addWithin(const Tree& tree, std::int32_t node) {
    if (node < 0 || tree.of->isLeaf(node)) return;
    const Part part{&tree, node, nullptr};
    queue_.push({0, false, 0, 0, part, part});
  }

  void addWithSecond(const Part& part) {
    for (const Tree* tree : tree_[1]) addPair(part, rootOf(tree));
    for (const Part& other : unbounded_[1]) addPair(part, other);
  }

  void addPair(const Part& a, const Part& b) {
    if (isEmpty(a) || isEmpty(b) || !filterOf(a).accepts(filterOf(b))) return;
    if (isObject(a) && isObject(b)) return addObjects(a, b);
    constexpr int kExponent = 120, kSteps = 4;
    const double distance = keptDistance(kExponent, kSteps, [&](double d) {
      const LinearQuery query(d, latest_);
      if (const MovingFlat* flat = flatOf(a)) return mayMeet(boxOf(b), *flat, query);
      if (const MovingFlat* flat = flatOf(b)) return mayMeet(boxOf(a), *flat, query);
      return mayMeet(boxOf(a), boxOf(b), query);
    });
    queue_.push({distance, false, 0, 0, a, b});
  }

  void addObjects(const Part& a, const Part& b) {
    if (objectOf(a) == objectOf(b)) return;
    constexpr int kExponent = 1000, kSteps = 8;
    const MovingBounds bounds_a = boundsOf(a), bounds_b = boundsOf(b);
    const double distance = keptDistance(kExponent, kSteps, [&](double d) {
      const MeetingWindow window = meetingWindow(bounds_a, bounds_b, d);
      return !window.isEmpty() && window.lo <= latest_;
    });
    const std::uint64_t serial_a = serialOf(a), serial_b = serialOf(b);
    if (set_[0] == set_[1] && serial_b < serial_a)
      queue_.push({distance, true, serial_b, serial_a, b, a});
    else
      queue_.push({distance, true, serial_a, serial_b, a, b});
  }

  void open(const Work& work) {
    const Part &a = work.a, &b = work.b;
    assert(!work.is_pair && !(isObject(a) && isObject(b)));
    if (a.tree == b.tree && a.node == b.node) {
      const MovingBoxTree& of = *a.tree->of;
      for (int k = 0; k < 2; ++k) addWithin(*a.tree, of.childOf(a.node, k));
      return addPair(childOf(a, 0), childOf(a, 1));
    }
    const bool opens_a =
        isObject(b) || (!isObject(a) && widthOf(boxOf(a)) >= widthOf(boxOf(b)));
    for (int k = 0; k < 2; ++k) {
      if (opens_a)
        addPair(childOf(a, k), b);
      else
        addPair(a, childOf(b, k));
    }
  }
  static Part childOf(const Part& part, int k) {
    return {part.tree, part.tree->of->childOf(part.node, k), nullptr};
  }

  const BroadPhase* set_[2];
  double latest_;
  std::deque<Tree> trees_;
  /// Of each set, by mobility.
  const Tree* tree_[2][2];
  std::vector<Part> unbounded_[2];
  std::deque<Object> single_;
  std::priority_queue<Work> queue_;
};

void BroadPhase::visitNearest(const NearestQuery& query) const {
  NearestSearch search(*this, *this, query.latest);
  search.addOwnPairs();
  search.run(query);
}

void BroadPhase::visitNearestOf(void* object, const MovingBounds& bounds,
                                const NearestQuery& query) const {
  NearestSearch search(*this, *this, query.latest);
  search.addPairsOf(object, bounds, filterOf(object));
  search.run(query);
}

void BroadPhase::visitNearestWith(const BroadPhase& other,
                                  const NearestQuery& query) const {
  NearestSearch search(*this, other, query.latest);
  search.addPairsAcross();
  search.run(query);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

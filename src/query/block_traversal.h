// SPDX-License-Identifier: BSD-3-Clause
//
// The middle of a query, between the trees and the tests: how the triangle pairs of a
// traversal come to the narrow phase, or to another taker.
#ifndef FCL_CCD_QUERY_BLOCK_TRAVERSAL_H
#define FCL_CCD_QUERY_BLOCK_TRAVERSAL_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "base/attributes.h"
#include "base/stopwatch.h"
#include "mesh/non_finite_vertex.h"
#include "query/narrow_phase.h"
#include "query/self_proofs.h"
#include "tree/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The order of the work of a query. Triangle pairs go into the narrow phase in
/// blocks: otherwise the tree and the vertices would push each other out of the cache at
/// every pair. A first-contact query takes the earliest work first. It begins with small
/// blocks, since a contact that is found prunes all later work.
struct Schedule {
  /// Sizes of blocks: the first as long as a large part of the step matters, the second
  /// when only its beginning does, see isEarly().
  std::size_t first_block, block;
  /// Whether the earliest work comes first.
  bool in_order;
  /// The traversal is divided into about this number of tasks. It does not depend on the
  /// number of threads.
  std::size_t tasks;
};
inline constexpr Schedule kAllSchedule{FeatureBatch::kMaxPairs, FeatureBatch::kMaxPairs,
                                       false, 256};
inline constexpr Schedule kFirstSchedule{32, 128, true, 64};

inline bool isEarlierWork(const NodePair& x, const NodePair& y) {
  return x.earliest < y.earliest;
}

/// @brief Sorts pieces of work. The sort is stable. Most pieces of work overlap from t =
/// 0 on, and these keep their order, whatever else is in the list. So what touches at t =
/// 0 is found in the same order, whether or not other pieces are left out.
inline void sortLatestFirst(NodePair* first, NodePair* last) {
  const auto isLater = [](const NodePair& x, const NodePair& y) {
    return isEarlierWork(y, x);
  };
  if (!std::is_sorted(first, last, isLater)) std::stable_sort(first, last, isLater);
}

/// @brief Two meshes, or a mesh with itself, and what a traversal needs to know of them.
struct MeshPair {
  const MeshInstance& a;
  const MeshInstance& b;
  const BoxShifts& shifts;
  SelfProofs proofs;
  double min_distance;
  PairMarks marks{};

  bool isSelf() const { return &a == &b; }

  double poseDisplacement() const { return a.poseDisplacement() + b.poseDisplacement(); }
};

/// @brief A traversal, or a part of it, done by one thread: compares boxes, collects the
/// triangle pairs that overlap, and passes them on in blocks.
/// @tparam Taker  what takes the blocks: NarrowPhase or CandidateCollector
template <bool kSelf, typename TreeA, typename TreeB, typename Taker>
class BlockTraversal {
 public:
  BlockTraversal(const MeshPair& meshes, TreeA& tree_a, TreeB& tree_b,
                 const SeparatingAxes* axes, const Schedule& schedule, Taker& taker)
      : shifts_(meshes.shifts),
        cull_distance_(shifts_.cullDistance(1)),
        shift_(shifts_.shift(cull_distance_)),
        traversal_(tree_a, tree_b, shifts_.isEmpty() ? nullptr : &shift_,
                   meshes.proofs.culling(), axes, kernels(),
                   schedule.in_order || taker.isTimed(), meshes.marks),
        pose_displacement_(meshes.poseDisplacement()),
        schedule_(schedule),
        taker_(taker),
        block_(schedule.block + Traversal<kSelf, TreeA, TreeB>::maxPairs()) {
    assert(schedule.tasks > 0 && 0 < schedule.first_block);
    assert(schedule.first_block <= schedule.block);
    // Taker::collect() takes no more at a time.
    assert(schedule.block <= FeatureBatch::kMaxPairs);
    assert(pose_displacement_ >= 0);
  }

  /// @brief Seconds that the taker has taken.
  double testTime() const { return test_time_; }

  /// @brief Begins the whole traversal, level by level, until there is a piece of work
  /// for each task.
  /// @param[out] pieces  the pieces of work that are left, one for each task
  void divide(std::vector<NodePair>& pieces) {
    assert(pieces.empty());
    std::size_t next = 0;
    beginPart();
    traversal_.start(open_);
    for (;
         next < open_.size() && open_.size() - next < schedule_.tasks && !taker_.isDone();
         ++next) {
      const NodePair work = open_[next];
      setLatest(taker_.latest());
      if (work.earliest <= last_beginning_) step(work);
    }
    finish();
    if (!taker_.isDone()) pieces.assign(open_.data() + next, open_.data() + open_.size());
    if (schedule_.in_order) std::stable_sort(pieces.begin(), pieces.end(), isEarlierWork);
  }

  /// @brief Does a piece of work to its end, or until it has taken this number of steps.
  void run(const NodePair& work, std::size_t steps = static_cast<std::size_t>(-1)) {
    assert(work.earliest >= 0);
    beginPart();
    open_.add(work.parent, work.lane, work.node, work.swapped, work.earliest);
    while (open_.size() > 0 && !taker_.isDone() && steps-- > 0) {
      const std::size_t first = open_.size() - 1;
      const NodePair& last = open_[first];
      open_.cut(first);
      setLatest(taker_.latest());
      if (last.earliest > last_beginning_) continue;
      step(last);
      if (schedule_.in_order)
        sortLatestFirst(open_.data() + first, open_.data() + open_.size());
    }
    finish();
  }

 private:
  /// What is tested from here on depends on nothing that came before.
  void beginPart() {
    assert(count_ == 0);
    open_.cut(0);
    traversal_.beginTask();
    taker_.beginPart();
  }

  void setLatest(double latest) {
    if (latest != latest_) changeLatest(latest);
  }

  // Not inlined: it is rare, and would keep what is not rare from being inlined.
  FCL_CCD_NOINLINE void changeLatest(double latest) {
    assert(0 <= latest && latest <= 1);
    traversal_.leaveOutAfter(latest, pose_displacement_);
    const double cull_distance = shifts_.cullDistance(latest);
    if (cull_distance != cull_distance_)
      traversal_.setShift(shifts_.shift(cull_distance));
    cull_distance_ = cull_distance;
    last_beginning_ = lastBeginning(latest);
    // What begins at the latest time itself is not left out.
    assert(latest <= last_beginning_);
    latest_ = latest;
  }

  void step(const NodePair& work) {
    traversal_.step(work, open_, [this](int a, int b, float earliest) {
      assert(count_ < block_.size());
      LeafPair& pair = block_[count_++];
      pair.a = a;
      pair.b = b;
      pair.earliest = earliest;
      assert(a >= 0 && b >= 0 && (!kSelf || a != b));
      assert(earliest >= 0);
    });
    if (count_ >= blockFor(latest_)) passOnBlocks(false);
  }

  std::size_t blockFor(double latest) const {
    return isEarly(latest) ? schedule_.block : schedule_.first_block;
  }

  /// Passes on the triangle pairs that were found, block by block.
  /// @param with_rest  whether to pass on the last pairs if they do not fill a block; if
  /// not, they wait for more
  void passOnBlocks(bool with_rest) {
    const Stopwatch start;
    const LeafPair* next = block_.data();
    const LeafPair* end = next + count_;
    while (next != end && !taker_.isDone()) {
      const auto left = static_cast<std::size_t>(end - next);
      const std::size_t size = blockFor(taker_.latest());
      if (left < size && !with_rest) break;
      try {
        taker_.collect(next, next + std::min(size, left));
      } catch (const NonFiniteVertex& error) {
        taker_.refuse(error, (next++)->earliest);
      }
      taker_.decide();
    }
    if (next != block_.data()) std::copy(next, end, block_.data());
    count_ = static_cast<std::size_t>(end - next);
    test_time_ += start.seconds();
  }

  void finish() {
    if (count_ > 0) passOnBlocks(true);
    count_ = 0;
    taker_.addTraversal(traversal_.compared(), traversal_.fanCulled());
    traversal_.clearCounts();
  }

  const BoxShifts& shifts_;
  /// Features further apart at t = 0 do not matter.
  double cull_distance_;
  KdopShift shift_;
  Traversal<kSelf, TreeA, TreeB> traversal_;
  double pose_displacement_;
  /// Taker::latest() in the last step, and its lastBeginning().
  double latest_{1};
  float last_beginning_{lastBeginning(1)};
  const Schedule& schedule_;
  Taker& taker_;
  double test_time_{0};
  WorkList open_;
  std::vector<LeafPair> block_;
  std::size_t count_{0};
};

/// @brief Calls visit(traversal) with a BlockTraversal of the trees of both meshes.
/// @param[in,out] times  the traversal's time is added
template <typename Taker, typename Visit>
void traverse(const MeshPair& meshes, const Schedule& schedule, Taker& taker,
              StageTimes& times, const Visit& visit) {
  const Stopwatch start;
  const auto of = [&](auto is_self, auto& tree_a, auto& tree_b,
                      const SeparatingAxes* axes) {
    using A = std::remove_reference_t<decltype(tree_a)>;
    using B = std::remove_reference_t<decltype(tree_b)>;
    BlockTraversal<is_self.value, A, B, Taker> traversal(meshes, tree_a, tree_b, axes,
                                                         schedule, taker);
    visit(traversal);
    times.test += traversal.testTime();
    times.traverse += start.seconds() - traversal.testTime();
  };
  const MovingKdopTree *moving_a = meshes.a.tree, *moving_b = meshes.b.tree;
  // A reader is for one thread and for one side only: its node is valid until it reads
  // another one.
  RigidTreeReader rigid_a(meshes.a.rigid), rigid_b(meshes.b.rigid);
  constexpr std::true_type kSelf;
  constexpr std::false_type kTwo;
  if (meshes.isSelf())
    return moving_a ? of(kSelf, *moving_a, *moving_a, nullptr)
                    : of(kSelf, rigid_a, rigid_b, nullptr);
  if (moving_a && moving_b) return of(kTwo, *moving_a, *moving_b, nullptr);
  if (moving_a) return of(kTwo, *moving_a, rigid_b, nullptr);
  if (moving_b) return of(kTwo, rigid_a, *moving_b, nullptr);
  if (meshes.a.rigid.turns() || meshes.b.rigid.turns() || meshes.a.bend || meshes.b.bend)
    return of(kTwo, rigid_a, rigid_b, nullptr);
  const SeparatingAxes axes(meshes.a, meshes.b, meshes.shifts.cullDistance(1));
  of(kTwo, rigid_a, rigid_b, &axes);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

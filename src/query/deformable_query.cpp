// SPDX-License-Identifier: BSD-3-Clause
#include "query/deformable_query.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <deque>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "self_culling/embedded_fans.h"
#include "self_culling/embedded_regions.h"
#include "tree/box_position.h"
#include "tree/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Triangle pairs are visited in blocks, so that the tree and the vertices do not push
/// each other out of the cache at every pair. A first-contact query begins with small
/// blocks, since a contact that is found prunes what follows, and takes the earliest work
/// first.
struct Schedule {
  /// Until only the beginning of the step matters, see isEarly(), and from then on.
  std::size_t first_block, block;
  bool in_order;
  /// The traversal is cut into about so many tasks, whatever the number of threads.
  std::size_t tasks;
};
constexpr Schedule kAllSchedule{FeatureBatch::kMaxPairs, FeatureBatch::kMaxPairs, false,
                                256};
constexpr Schedule kFirstSchedule{32, 128, true, 64};

/// What is proved of a mesh, so that a query of it with itself can leave it out; empty if
/// nothing is.
struct SelfProofs {
  std::vector<std::uint8_t> fans, regions;
  std::vector<std::uint32_t> nodes_in_fans;

  SelfCulling culling() const {
    return {dataOf(fans), dataOf(nodes_in_fans), dataOf(regions)};
  }

 private:
  template <typename T>
  static const T* dataOf(const std::vector<T>& x) {
    return x.empty() ? nullptr : x.data();
  }
};

bool isEarlierWork(const NodePair& x, const NodePair& y) {
  return x.earliest < y.earliest;
}

/// Works that overlap from the start on, as most do, are in order already, and stay so
/// whatever else is in the list: tasks leave out different works, but meet what touches
/// at t = 0 in the same order.
void sortLatestFirst(NodePair* first, NodePair* last) {
  const auto isLater = [](const NodePair& x, const NodePair& y) {
    return isEarlierWork(y, x);
  };
  if (!std::is_sorted(first, last, isLater)) std::stable_sort(first, last, isLater);
}

/// Part of a traversal: its work, and what is done to the triangle pairs that it finds.
/// @tparam Leaves  NarrowPhase or CandidateCollector
template <bool kSelf, typename TreeA, typename TreeB, typename Leaves>
class Part {
 public:
  Part(TreeA& tree_a, TreeB& tree_b, const KdopShift* shift, const SelfCulling& culling,
       const SeparatingAxes* axes, double pose_displacement, const Schedule& schedule,
       Leaves& leaves)
      : traversal_(tree_a, tree_b, shift, culling, axes, kernels(), schedule.in_order),
        pose_displacement_(pose_displacement),
        schedule_(schedule),
        leaves_(leaves),
        block_(schedule.block + Traversal<kSelf, TreeA, TreeB>::maxPairs()) {}

  /// Seconds in the leaves.
  double testTime() const { return test_time_; }

  /// Opens the whole traversal, level by level, until there is enough work for all tasks.
  void divide(std::vector<NodePair>& works) {
    std::size_t next = 0;
    open_.cut(0);
    traversal_.start(open_);
    for (; next < open_.size() && open_.size() - next < schedule_.tasks &&
           !leaves_.isDone();
         ++next) {
      const NodePair work = open_[next];
      const double latest = leaves_.latest();
      if (work.earliest <= latest) step(work, latest);
    }
    finish();
    if (!leaves_.isDone()) works.assign(open_.data() + next, open_.data() + open_.size());
    if (schedule_.in_order) std::stable_sort(works.begin(), works.end(), isEarlierWork);
  }

  /// Does a work to its end, or no more than so many steps of it.
  void run(const NodePair& work, std::size_t steps = static_cast<std::size_t>(-1)) {
    open_.cut(0);
    open_.add(work.parent, work.lane, work.node, work.swapped, work.earliest);
    while (open_.size() > 0 && !leaves_.isDone() && steps-- > 0) {
      const std::size_t first = open_.size() - 1;
      const NodePair& last = open_[first];
      open_.cut(first);
      const double latest = leaves_.latest();
      if (last.earliest > latest) continue;
      step(last, latest);
      if (schedule_.in_order)
        sortLatestFirst(open_.data() + first, open_.data() + open_.size());
    }
    finish();
  }

 private:
  void step(const NodePair& work, double latest) {
    if (latest != latest_) traversal_.leaveOutAfter(latest, pose_displacement_);
    latest_ = latest;
    traversal_.step(work, open_, [this](int a, int b, float earliest) {
      assert(count_ < block_.size());
      LeafPair& pair = block_[count_++];
      pair.a = a;
      pair.b = b;
      pair.earliest = earliest;
    });
    if (count_ >= blockFor(latest)) visitBlocks(false);
  }

  std::size_t blockFor(double latest) const {
    return isEarly(latest) ? schedule_.block : schedule_.first_block;
  }

  /// Tests what was found, block by block.
  /// @param with_rest  what does not fill a block as well; else it is kept for later
  void visitBlocks(bool with_rest) {
    const auto start = Clock::now();
    const LeafPair* next = block_.data();
    const LeafPair* end = next + count_;
    while (next != end && !leaves_.isDone()) {
      const auto left = static_cast<std::size_t>(end - next);
      const std::size_t size = blockFor(leaves_.latest());
      if (left < size && !with_rest) break;
      try {
        leaves_.visit(next, next + std::min(size, left));
      } catch (const NonFiniteVertex& error) {
        leaves_.refuse(error, (next++)->earliest);
      }
      leaves_.flush();
    }
    if (next != block_.data()) std::copy(next, end, block_.data());
    count_ = static_cast<std::size_t>(end - next);
    test_time_ += secondsSince(start);
  }

  void finish() {
    if (count_ > 0) visitBlocks(true);
    count_ = 0;
    leaves_.addTraversal(traversal_.compared(), traversal_.fanCulled());
    traversal_.clearCounts();
  }

  Traversal<kSelf, TreeA, TreeB> traversal_;
  /// Of both meshes.
  double pose_displacement_;
  /// As it was in the last step.
  double latest_{1};
  const Schedule& schedule_;
  Leaves& leaves_;
  double test_time_{0};
  WorkList open_;
  std::vector<LeafPair> block_;
  std::size_t count_{0};
};

/// Calls visit with the tree to traverse; for one thread.
template <typename Visit>
void visitTree(const MeshInstance& mesh, Visit&& visit) {
  if (mesh.tree) {
    visit(*mesh.tree);
  } else {
    RigidTreeReader reader(mesh.rigid);
    visit(reader);
  }
}

/// Two meshes, or one with itself, as a query traverses them.
struct MeshPair {
  const MeshInstance& a;
  const MeshInstance& b;
  const KdopShift* shift;
  SelfProofs proofs;

  bool isSelf() const { return &a == &b; }

  /// Calls visit(part) with a part of the traversal, and adds the time that it takes.
  template <typename Leaves, typename Visit>
  void visitPart(const Schedule& schedule, Leaves& leaves, StageTimes& times,
                 Visit&& visit) const {
    const auto start = Clock::now();
    makePart(schedule, leaves, [&](auto& part) {
      visit(part);
      times.test += part.testTime();
      times.traverse += secondsSince(start) - part.testTime();
    });
  }

 private:
  template <typename Leaves, typename Visit>
  void makePart(const Schedule& schedule, Leaves& leaves, Visit&& visit) const {
    const double pose_displacement = a.poseDisplacement() + b.poseDisplacement();
    const SelfCulling culling = proofs.culling();
    if (isSelf() && a.tree) {
      Part<true, const MovingKdopTree, const MovingKdopTree, Leaves> part(
          *a.tree, *a.tree, shift, culling, nullptr, pose_displacement, schedule, leaves);
      return visit(part);
    }
    visitTree(a, [&](auto& tree_a) {
      visitTree(b, [&](auto& tree_b) {
        using A = std::remove_reference_t<decltype(tree_a)>;
        using B = std::remove_reference_t<decltype(tree_b)>;
        if constexpr (std::is_same_v<A, B> && std::is_same_v<A, RigidTreeReader>)
          if (isSelf()) {
            Part<true, A, B, Leaves> part(tree_a, tree_b, shift, culling, nullptr,
                                          pose_displacement, schedule, leaves);
            return visit(part);
          }
        const SeparatingAxes axes(a, b);
        Part<false, A, B, Leaves> part(tree_a, tree_b, shift, culling,
                                       a.tree || b.tree ? nullptr : &axes,
                                       pose_displacement, schedule, leaves);
        visit(part);
      });
    });
  }
};

/// What a query of the mesh with itself leaves out.
SelfProofs proveSelf(const MeshInstance& mesh, bool with_regions, int num_threads,
                     StageTimes& times) {
  SelfProofs proofs;
  if (!mesh.tree || !mesh.isInPlace()) return proofs;
  const auto start = Clock::now();
  const MovingKdopTree& tree = *mesh.tree;
  std::vector<std::uint8_t> interior(tree.vertices().size(), 0);
  if (with_regions) {
    EmbeddedRegions regions = findEmbeddedRegions(tree, kernels(), num_threads);
    proofs.regions = std::move(regions.nodes);
    interior = std::move(regions.interior);
  }
  // No pair of triangles around a vertex inside of a region is met.
  proofs.fans = findEmbeddedFans(tree, interior, kernels(), num_threads);
  proofs.nodes_in_fans = findNodesInFans(tree, proofs.fans);
  times.traverse += secondsSince(start);
  return proofs;
}

/// The answer of one task.
struct TaskAnswer {
  /// Without a list where there is none, which most tasks of a first contact are.
  std::optional<std::deque<FeatureContact>> contacts;
  bool cut{false};
  bool has_crossing{false};
  Crossing crossing{};
  std::optional<QueryError> error;
  StageCounts counts;
  StageTimes times;

  void take(NarrowPhase& leaves) {
    cut = leaves.sink().isCut();
    has_crossing = leaves.hasCrossing();
    crossing = leaves.crossing();
    if (!leaves.sink().contacts().empty()) contacts = leaves.sink().takeContacts();
    error = leaves.error();
    counts = leaves.counts();
  }
};

/// Throws what the query has to end with, whatever the tasks did in what order: the error
/// of the first task that has an answer or an error; of a first-contact query the
/// earliest error, unless the first contact is earlier than its triangles meet.
void throwError(const std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                const QueryProgress& progress) {
  const double latest = options.query == ContinuousQuery::kFirst
                            ? progress.first_hi.load()
                            : std::numeric_limits<double>::infinity();
  const std::size_t last = progress.answered_by.load();
  const QueryError* earliest = nullptr;
  for (std::size_t i = 0; i < tasks.size() && i <= last; ++i) {
    const std::optional<QueryError>& error = tasks[i].error;
    if (error && error->earliest <= latest &&
        (!earliest || error->earliest < earliest->earliest))
      earliest = &*error;
  }
  if (earliest) throw NonFiniteVertex(earliest->vertex);
}

/// The answers of all tasks as one, which does not depend on how the tasks went: the
/// first task that has a crossing tells it, a first-contact query keeps only what may be
/// the first contact, a yes-or-no query only what the first task found.
/// @param first_hi  upper end of the earliest bracket
QueryAnswer merge(std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                  double first_hi, bool may_repeat) {
  QueryAnswer answer;
  const bool first = options.query == ContinuousQuery::kFirst;
  const bool any = options.query == ContinuousQuery::kAny;
  std::size_t count = 0;
  for (const TaskAnswer& task : tasks)
    if (task.contacts) count += task.contacts->size();
  // A sink only where something may have to be left out.
  const bool keeps_all = !first && !any && !may_repeat && count <= options.max_contacts;
  std::vector<std::deque<FeatureContact>> lists;
  ContactSink sink(any ? 1 : options.max_contacts, may_repeat);
  for (TaskAnswer& task : tasks) {
    answer.counts += task.counts;
    answer.times.traverse += task.times.traverse;
    answer.times.test += task.times.test;
    if (any && (answer.has_crossing || !sink.contacts().empty())) continue;
    if (task.has_crossing && !answer.has_crossing) {
      answer.has_crossing = true;
      answer.crossing = task.crossing;
    }
    answer.cut |= task.cut && !first && !any;
    if (!task.contacts) continue;
    if (keeps_all) {
      lists.push_back(std::move(*task.contacts));
      continue;
    }
    for (const FeatureContact& c : *task.contacts)
      if (!first || c.toc_lo <= first_hi) sink.add(c);
  }
  answer.cut |= sink.isCut() && !any;
  if (!keeps_all) lists.push_back(sink.takeContacts());
  answer.contacts = SortedContacts(std::move(lists));
  return answer;
}

/// How many steps of each work a first contact of a mesh with itself does before all
/// others, so that an early contact prunes the whole traversal, wherever it is. A work
/// has about as many steps as triangles; where it has few, one contact is as good as
/// another.
std::size_t sampleOf(const MeshInstance& a, const MeshInstance& b,
                     ContinuousQuery query) {
  constexpr std::size_t kTrianglesPerStep = 32, kLeast = 32;
  if (&a != &b || !a.tree || query != ContinuousQuery::kFirst) return 0;
  const std::size_t steps =
      a.tree->triangles().size() / kFirstSchedule.tasks / kTrianglesPerStep;
  return steps < kLeast ? 0 : steps;
}

QueryAnswer query(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
                  const QueryOptions& options) {
  const auto start = Clock::now();
  const bool all = options.query == ContinuousQuery::kAll;
  const Schedule& schedule = all ? kAllSchedule : kFirstSchedule;
  QueryOptions task_options = options;
  // One more, so that it is known whether there were more.
  if (options.query == ContinuousQuery::kFirst && options.max_contacts + 1 != 0)
    ++task_options.max_contacts;

  StageTimes times;
  SelfProofs proofs;
  if (&a == &b)
    proofs = proveSelf(a, options.leaves_out_regions, options.num_threads, times);
  const MeshPair pair{a, b, shift, std::move(proofs)};
  QueryProgress progress;
  std::vector<NodePair> works;
  std::vector<TaskAnswer> answers(1);
  const bool parallel = numThreads(options.num_threads) > 1;
  StageTimes opening_times;
  const std::size_t sample = sampleOf(a, b, options.query);
  NarrowPhase leaves(a, b, shift, task_options, &progress, 0);
  pair.visitPart(schedule, leaves, opening_times, [&](auto& part) {
    part.divide(works);
    answers.resize(1 + works.size());
    answers[0].take(leaves);
    if (sample > 0) {
      // Not one of the tasks, which meet all of it again and count it. Earlier than that,
      // little is left to prune.
      constexpr double kEarlyEnough = 0x1p-10;
      leaves.begin(1 + works.size());
      for (const NodePair& work : works)
        if (progress.first_hi.load() > kEarlyEnough) part.run(work, sample);
    }
    if (parallel) return;
    // One part for all tasks: what it has read of a rigid tree stays.
    for (std::size_t i = 0; i < works.size(); ++i) {
      leaves.begin(i + 1);
      part.run(works[i]);
      answers[i + 1].take(leaves);
    }
  });
  answers[0].times = opening_times;
  if (parallel)
    parallelFor(works.size(), options.num_threads, [&](std::size_t i) {
      NarrowPhase task(a, b, shift, task_options, &progress, i + 1);
      pair.visitPart(schedule, task, answers[i + 1].times,
                     [&](auto& part) { part.run(works[i]); });
      answers[i + 1].take(task);
    });

  throwError(answers, options, progress);
  QueryAnswer answer =
      merge(answers, options, progress.first_hi.load(), !a.hasOwners() || !b.hasOwners());
  // Wall time, divided as the tasks' own; what is left is the tests'.
  const double wall = secondsSince(start);
  const double sum = answer.times.traverse + answer.times.test;
  const double share = sum > 0 ? answer.times.traverse / sum : 0;
  const double in_tasks = std::min(sum, wall - times.traverse);
  answer.times.traverse = times.traverse + in_tasks * share;
  answer.times.test = wall - answer.times.traverse;
  return answer;
}

bool candidates(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
                const CandidateSink& sink) {
  CandidateCollector leaves(a, b, shift, sink);
  StageTimes times;
  SelfProofs proofs;
  if (&a == &b) proofs = proveSelf(a, true, 1, times);
  const MeshPair pair{a, b, shift, std::move(proofs)};
  pair.visitPart(kAllSchedule, leaves, times, [&](auto& part) {
    std::vector<NodePair> works;
    part.divide(works);
    for (const NodePair& work : works) part.run(work);
  });
  return !leaves.isDone();
}

BoxPosition positionOfBoxes(const MeshInstance& mesh) {
  BoxPosition position;
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k) {
      position.origin[frame][k] =
          mesh.tree ? mesh.tree->origin(frame)[k] : mesh.rigid.origin()[k];
      position.translation[frame][k] = mesh.translation[frame][k];
    }
  position.reach = mesh.tree ? 0 : mesh.rigid.reach();
  return position;
}

}  // namespace

QueryAnswer querySelf(const MeshInstance& a, const QueryOptions& options) {
  const DefaultFloatingPoint mode;
  return query(a, a, nullptr, options);
}

QueryAnswer queryPair(const MeshInstance& a, const MeshInstance& b,
                      const QueryOptions& options) {
  const DefaultFloatingPoint mode;
  const KdopShift shift = relativeShift(a, b);
  return query(a, b, &shift, options);
}

bool candidatesSelf(const MeshInstance& a, const CandidateSink& sink) {
  const DefaultFloatingPoint mode;
  return candidates(a, a, nullptr, sink);
}

bool candidatesPair(const MeshInstance& a, const MeshInstance& b,
                    const CandidateSink& sink) {
  const DefaultFloatingPoint mode;
  const KdopShift shift = relativeShift(a, b);
  return candidates(a, b, &shift, sink);
}

KdopShift relativeShift(const MeshInstance& a, const MeshInstance& b) {
  return relativeShift(positionOfBoxes(a), positionOfBoxes(b));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

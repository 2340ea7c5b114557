// SPDX-License-Identifier: BSD-3-Clause
#include "query/deformable_query.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "query/distance_contact.h"
#include "self_culling/embedded_bodies.h"
#include "self_culling/embedded_fans.h"
#include "self_culling/embedded_regions.h"
#include "self_culling/regions_apart.h"
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

/// The order of the work of a query. Triangle pairs go into the narrow phase in blocks:
/// otherwise the tree and the vertices would push each other out of the cache at every
/// pair. A first-contact query takes the earliest work first. It begins with small
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
constexpr Schedule kAllSchedule{FeatureBatch::kMaxPairs, FeatureBatch::kMaxPairs, false,
                                256};
constexpr Schedule kFirstSchedule{32, 128, true, 64};

/// The fans and regions of a mesh that are proved to be embedded, so that a
/// self-collision query leaves them out. Empty lists: none.
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

/// The sort is stable. Most pieces of work overlap from t = 0 on, and these keep their
/// order, whatever else is in the list. So what touches at t = 0 is found in the same
/// order, whether or not other pieces are left out.
void sortLatestFirst(NodePair* first, NodePair* last) {
  const auto isLater = [](const NodePair& x, const NodePair& y) {
    return isEarlierWork(y, x);
  };
  if (!std::is_sorted(first, last, isLater)) std::stable_sort(first, last, isLater);
}

/// A part of a traversal, done by one thread: compares boxes, collects the triangle pairs
/// that overlap, and passes them on in blocks.
/// @tparam Leaves  what takes the blocks: NarrowPhase or CandidateCollector
template <bool kSelf, typename TreeA, typename TreeB, typename Leaves>
class Part {
 public:
  Part(TreeA& tree_a, TreeB& tree_b, const BoxShifts& shifts, const SelfCulling& culling,
       const SeparatingAxes* axes, double pose_displacement, const Schedule& schedule,
       Leaves& leaves)
      : shifts_(shifts),
        reach_(shifts.reach(1)),
        shift_(shifts.shift(reach_)),
        traversal_(tree_a, tree_b, shifts.isEmpty() ? nullptr : &shift_, culling, axes,
                   kernels(), schedule.in_order || leaves.isTimed()),
        pose_displacement_(pose_displacement),
        schedule_(schedule),
        leaves_(leaves),
        block_(schedule.block + Traversal<kSelf, TreeA, TreeB>::maxPairs()) {}

  /// Seconds that the leaves have taken.
  double testTime() const { return test_time_; }

  /// Begins the whole traversal, level by level, until there is a piece of work for each
  /// task.
  /// @param[out] works  the pieces of work that are left, one for each task
  void divide(std::vector<NodePair>& works) {
    std::size_t next = 0;
    open_.cut(0);
    traversal_.start(open_);
    for (; next < open_.size() && open_.size() - next < schedule_.tasks &&
           !leaves_.isDone();
         ++next) {
      const NodePair work = open_[next];
      setLatest(leaves_.latest());
      if (work.earliest <= last_beginning_) step(work);
    }
    finish();
    if (!leaves_.isDone()) works.assign(open_.data() + next, open_.data() + open_.size());
    if (schedule_.in_order) std::stable_sort(works.begin(), works.end(), isEarlierWork);
  }

  /// Does a piece of work to its end, or until it has taken this number of steps.
  void run(const NodePair& work, std::size_t steps = static_cast<std::size_t>(-1)) {
    open_.cut(0);
    open_.add(work.parent, work.lane, work.node, work.swapped, work.earliest);
    while (open_.size() > 0 && !leaves_.isDone() && steps-- > 0) {
      const std::size_t first = open_.size() - 1;
      const NodePair& last = open_[first];
      open_.cut(first);
      setLatest(leaves_.latest());
      if (last.earliest > last_beginning_) continue;
      step(last);
      if (schedule_.in_order)
        sortLatestFirst(open_.data() + first, open_.data() + open_.size());
    }
    finish();
  }

 private:
  void setLatest(double latest) {
    if (latest != latest_) changeLatest(latest);
  }

  // Not inlined: it is rare, and would keep what is not rare from being inlined.
  __attribute__((noinline)) void changeLatest(double latest) {
    traversal_.leaveOutAfter(latest, pose_displacement_);
    const double reach = shifts_.reach(latest);
    if (reach != reach_) traversal_.setShift(shifts_.shift(reach));
    reach_ = reach;
    last_beginning_ = lastBeginning(latest);
    latest_ = latest;
  }

  void step(const NodePair& work) {
    traversal_.step(work, open_, [this](int a, int b, float earliest) {
      assert(count_ < block_.size());
      LeafPair& pair = block_[count_++];
      pair.a = a;
      pair.b = b;
      pair.earliest = earliest;
    });
    if (count_ >= blockFor(latest_)) visitBlocks(false);
  }

  std::size_t blockFor(double latest) const {
    return isEarly(latest) ? schedule_.block : schedule_.first_block;
  }

  /// Passes on the triangle pairs that were found, block by block.
  /// @param with_rest  whether to pass on the last pairs if they do not fill a block; if
  /// not, they wait for more
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

  const BoxShifts& shifts_;
  /// Features further apart at t = 0 do not matter.
  double reach_;
  KdopShift shift_;
  Traversal<kSelf, TreeA, TreeB> traversal_;
  /// The sum of MeshInstance::poseDisplacement() of both meshes.
  double pose_displacement_;
  /// Leaves::latest() in the last step, and its lastBeginning().
  double latest_{1};
  float last_beginning_{lastBeginning(1)};
  const Schedule& schedule_;
  Leaves& leaves_;
  double test_time_{0};
  WorkList open_;
  std::vector<LeafPair> block_;
  std::size_t count_{0};
};

/// Calls visit with the tree of the mesh. A RigidTreeReader is for one thread only.
template <typename Visit>
void visitTree(const MeshInstance& mesh, Visit&& visit) {
  if (mesh.tree) {
    visit(*mesh.tree);
  } else {
    RigidTreeReader reader(mesh.rigid);
    visit(reader);
  }
}

/// Two meshes, or a mesh with itself, and what a traversal needs to know of them.
struct MeshPair {
  const MeshInstance& a;
  const MeshInstance& b;
  const BoxShifts& shifts;
  SelfProofs proofs;
  double min_distance;

  bool isSelf() const { return &a == &b; }

  /// Calls visit(part) with a part of the traversal, and adds its time to `times`.
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
          *a.tree, *a.tree, shifts, culling, nullptr, pose_displacement, schedule,
          leaves);
      return visit(part);
    }
    visitTree(a, [&](auto& tree_a) {
      visitTree(b, [&](auto& tree_b) {
        using A = std::remove_reference_t<decltype(tree_a)>;
        using B = std::remove_reference_t<decltype(tree_b)>;
        if constexpr (std::is_same_v<A, B> && std::is_same_v<A, RigidTreeReader>)
          if (isSelf()) {
            Part<true, A, B, Leaves> part(tree_a, tree_b, shifts, culling, nullptr,
                                          pose_displacement, schedule, leaves);
            return visit(part);
          }
        const SeparatingAxes axes(a, b);
        Part<false, A, B, Leaves> part(
            tree_a, tree_b, shifts, culling,
            a.tree || b.tree || min_distance > 0 ? nullptr : &axes, pose_displacement,
            schedule, leaves);
        visit(part);
      });
    });
  }
};

/// Finds what a query of a mesh with itself leaves out. Finds nothing for two meshes.
SelfProofs proveSelf(const MeshInstance& mesh, const MeshInstance& other,
                     bool with_regions, double min_distance, int num_threads,
                     StageTimes& times) {
  SelfProofs proofs;
  if (&mesh != &other || !mesh.tree || !mesh.isInPlace()) return proofs;
  const auto start = Clock::now();
  const MovingKdopTree& tree = *mesh.tree;
  std::vector<std::uint8_t> interior(tree.vertices().size(), 0);
  if (min_distance > 0) {
    // What is proved not to touch may come near.
    const double reach = reachOf(mesh, mesh, min_distance);
    RegionsApart apart{{}, std::move(interior)};
    if (with_regions) {
      EmbeddedRegions regions = findEmbeddedBodies(tree, kernels(), num_threads, reach);
      addEmbeddedRegions(tree, kernels(), num_threads, regions);
      apart = findRegionsApart(tree, regions, kernels(), reach);
      proofs.nodes_in_fans = std::move(apart.nodes);
    }
    proofs.fans = findEmbeddedFans(tree, apart.fans, kernels(), num_threads, reach);
    for (std::size_t i = 0; i < proofs.fans.size(); ++i) proofs.fans[i] |= apart.fans[i];
    times.traverse += secondsSince(start);
    return proofs;
  }
  if (with_regions) {
    EmbeddedRegions regions = findEmbeddedBodies(tree, kernels(), num_threads);
    addEmbeddedRegions(tree, kernels(), num_threads, regions);
    proofs.regions = std::move(regions.nodes);
    interior = std::move(regions.interior);
  }
  // A fan inside of a region needs no proof: the query leaves out the whole region.
  proofs.fans = findEmbeddedFans(tree, interior, kernels(), num_threads);
  proofs.nodes_in_fans = findNodesInFans(tree, proofs.fans);
  times.traverse += secondsSince(start);
  return proofs;
}

/// The number of steps that a first-contact query of a mesh with itself takes of each
/// piece of work before it does any piece to its end. An early contact in any piece then
/// prunes the whole traversal. A piece has about as many steps as triangles. If it has
/// few, this does not pay: the number is 0.
std::size_t sampleOf(const MeshInstance& a, const MeshInstance& b,
                     ContinuousQuery query) {
  constexpr std::size_t kTrianglesPerStep = 32, kLeast = 32;
  if (&a != &b || !a.tree || query != ContinuousQuery::kFirst) return 0;
  const std::size_t steps =
      a.tree->triangles().size() / kFirstSchedule.tasks / kTrianglesPerStep;
  return steps < kLeast ? 0 : steps;
}

/// A query for contacts. The traversal is divided into tasks. Task 0 is the beginning of
/// the traversal, which divides it; each other task is one of the pieces of work that it
/// leaves.
class ContactQuery {
 public:
  ContactQuery(const MeshInstance& a, const MeshInstance& b, const BoxShifts& shifts,
               const QueryOptions& options)
      : options_(options),
        task_options_(options),
        schedule_(options.query == ContinuousQuery::kAll ? kAllSchedule : kFirstSchedule),
        meshes_{a, b, shifts,
                proveSelf(a, b, options.leaves_out_regions, options.min_distance,
                          options.num_threads, proof_times_),
                options.min_distance} {
    // One contact more than wanted tells whether there are more.
    if (options.query == ContinuousQuery::kFirst && options.isLimited())
      ++task_options_.max_contacts;
  }

  QueryAnswer answer() {
    const bool parallel = numThreads(options_.num_threads) > 1;
    NarrowPhase leaves = narrowPhase(0);
    StageTimes times;
    meshes_.visitPart(schedule_, leaves, times, [&](auto& part) {
      divide(part, leaves);
      lookForEarlyContact(part, leaves);
      // One part does all tasks, so that it reads each node of a rigid tree once.
      if (!parallel) runTasks(part, leaves);
    });
    tasks_[0].times = times;
    if (parallel) runTasksSideBySide();
    QueryAnswer answer = merge(tasks_, options_, progress_, meshes_.a, meshes_.b,
                               [this] { return firstContact(); });
    setWallTimes(answer.times);
    return answer;
  }

 private:
  NarrowPhase narrowPhase(std::size_t task) {
    return NarrowPhase(meshes_.a, meshes_.b, meshes_.shifts, task_options_, &progress_,
                       task);
  }

  template <typename Part>
  void divide(Part& part, NarrowPhase& leaves) {
    part.divide(works_);
    tasks_.resize(1 + works_.size());
    tasks_[0].take(leaves);
  }

  /// Looks into each piece of work for an early contact, see sampleOf(). The result and
  /// the counts are not used, except for the time of the contact: the tasks find
  /// everything again.
  template <typename Part>
  void lookForEarlyContact(Part& part, NarrowPhase& leaves) {
    // After a contact that is earlier than this, little is left to prune.
    constexpr double kEarlyEnough = 0x1p-10;
    const std::size_t steps = sampleOf(meshes_.a, meshes_.b, options_.query);
    if (steps == 0) return;
    leaves.begin(1 + works_.size());
    for (const NodePair& work : works_)
      if (progress_.first_hi.load() > kEarlyEnough) part.run(work, steps);
    // A contact that begins with the one found here must be found again.
    progress_.first_lo = 1;
  }

  template <typename Part>
  void runTasks(Part& part, NarrowPhase& leaves) {
    for (std::size_t i = 0; i < works_.size(); ++i) {
      leaves.begin(i + 1);
      part.run(works_[i]);
      tasks_[i + 1].take(leaves);
    }
  }

  void runTasksSideBySide() {
    parallelFor(works_.size(), options_.num_threads, [&](std::size_t i) {
      NarrowPhase leaves = narrowPhase(i + 1);
      meshes_.visitPart(schedule_, leaves, tasks_[i + 1].times,
                        [&](auto& part) { part.run(works_[i]); });
      tasks_[i + 1].take(leaves);
    });
  }

  /// The first contact, found by a query of its own.
  FeatureContact firstContact() const {
    QueryOptions first = options_;
    first.query = ContinuousQuery::kFirst;
    first.max_contacts = 1;
    return ContactQuery(meshes_.a, meshes_.b, meshes_.shifts, first)
        .answer()
        .contacts.front();
  }

  /// Divides the wall time in proportion to the times of the tasks. The time of
  /// proveSelf() counts as traversal, all other time outside of tasks as tests.
  void setWallTimes(StageTimes& times) const {
    const double wall = secondsSince(start_);
    const double sum = times.traverse + times.test;
    const double share = sum > 0 ? times.traverse / sum : 0;
    const double in_tasks = std::min(sum, wall - proof_times_.traverse);
    times.traverse = proof_times_.traverse + in_tasks * share;
    times.test = wall - times.traverse;
  }

  const Clock::time_point start_{Clock::now()};
  const QueryOptions options_;
  QueryOptions task_options_;
  const Schedule& schedule_;
  StageTimes proof_times_;
  const MeshPair meshes_;
  QueryProgress progress_;
  std::vector<NodePair> works_;
  std::vector<TaskAnswer> tasks_;
};

bool candidates(const MeshInstance& a, const MeshInstance& b, const BoxShifts& shifts,
                const CandidateSink& sink, double min_distance) {
  const double reach = shifts.reach(1);
  const KdopShift shift = shifts.shift(reach);
  CandidateCollector leaves(a, b, shifts.isEmpty() ? nullptr : &shift, sink, reach);
  StageTimes times;
  const MeshPair meshes{a, b, shifts, proveSelf(a, b, true, min_distance, 1, times),
                        min_distance};
  meshes.visitPart(kAllSchedule, leaves, times, [&](auto& part) {
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
          mesh.tree ? mesh.tree->origin(frame)[k] : mesh.rigid.origin(frame)[k];
      position.translation[frame][k] = mesh.translation[frame][k];
    }
  position.reach = mesh.tree ? 0 : mesh.rigid.reach();
  return position;
}

BoxShifts shiftsOf(const MeshInstance& a, const MeshInstance& b, double min_distance,
                   bool ignores_initially_closer) {
  const bool is_self = &a == &b;
  const KdopShift between = is_self ? KdopShift{} : relativeShift(a, b);
  return {a, b, is_self ? nullptr : &between, min_distance, ignores_initially_closer};
}

QueryAnswer query(const MeshInstance& a, const MeshInstance& b,
                  const QueryOptions& options) {
  const DefaultFloatingPoint mode;
  const BoxShifts shifts =
      shiftsOf(a, b, options.min_distance,
               options.ignores_initially_closer && !options.lists_near_pairs);
  return ContactQuery(a, b, shifts, options).answer();
}

}  // namespace

QueryAnswer querySelf(const MeshInstance& a, const QueryOptions& options) {
  return query(a, a, options);
}

QueryAnswer queryPair(const MeshInstance& a, const MeshInstance& b,
                      const QueryOptions& options) {
  return query(a, b, options);
}

bool candidatesSelf(const MeshInstance& a, const CandidateSink& sink,
                    double min_distance) {
  return candidatesPair(a, a, sink, min_distance);
}

bool candidatesPair(const MeshInstance& a, const MeshInstance& b,
                    const CandidateSink& sink, double min_distance) {
  const DefaultFloatingPoint mode;
  return candidates(a, b, shiftsOf(a, b, min_distance, false), sink, min_distance);
}

KdopShift relativeShift(const MeshInstance& a, const MeshInstance& b) {
  return relativeShift(positionOfBoxes(a), positionOfBoxes(b));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "query/deformable_query.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "query/block_traversal.h"
#include "query/self_proofs.h"
#include "query/surroundings.h"
#include "query/tree_marks.h"
#include "tree/box_position.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

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
        meshes_{a,
                b,
                shifts,
                &a == &b ? proveSelf(a, options.leaves_out_regions, options.min_distance,
                                     options.num_threads)
                         : SelfProofs{},
                options.min_distance,
                marksOf(a, b)},
        surroundings_(a, b),
        proof_time_(start_.seconds()) {
    if (options.min_approach_speed > 0) task_options_.surroundings = &surroundings_;
    // One contact more than wanted tells whether there are more.
    if (options.query == ContinuousQuery::kFirst && options.isLimited())
      ++task_options_.max_contacts;
  }

  QueryAnswer answer() {
    const bool parallel = numThreads(options_.num_threads) > 1;
    NarrowPhase narrow_phase = narrowPhase(0);
    StageTimes times;
    traverse(meshes_, schedule_, narrow_phase, times, [&](auto& traversal) {
      divide(traversal, narrow_phase);
      lookForEarlyContact(traversal, narrow_phase);
      // One traversal does all tasks, so that it reads each node of a rigid tree once.
      if (!parallel) runTasks(traversal, narrow_phase);
    });
    tasks_[0].times = times;
    assert(tasks_.size() == 1 + pieces_.size());
    if (parallel) runTasksSideBySide();
    QueryAnswer answer = merge(tasks_, options_, progress_, meshes_.a, meshes_.b,
                               [this] { return firstContact(); });
    setWallTimes(answer.times);
    return answer;
  }

 private:
  /// A tree that does not change is read as it is used, and has no marks.
  PairMarks marksOf(const MeshInstance& a, const MeshInstance& b) {
    if (!options_.filter || !a.tree || !b.tree) return {};
    const auto& marks = options_.filter->rules().marks;
    if (marks[0].areAllEqual() && marks[1].areAllEqual()) return {};
    marks_[0] = treeMarksOf(*a.tree, marks[0]);
    if (&a == &b) return {&marks_[0], &marks_[0]};
    marks_[1] = treeMarksOf(*b.tree, marks[1]);
    return {&marks_[0], &marks_[1]};
  }

  NarrowPhase narrowPhase(std::size_t task) {
    return NarrowPhase(meshes_.a, meshes_.b, meshes_.shifts, task_options_, progress_,
                       task);
  }

  template <typename Traversal>
  void divide(Traversal& traversal, NarrowPhase& narrow_phase) {
    traversal.divide(pieces_);
    tasks_.resize(1 + pieces_.size());
    tasks_[0].take(narrow_phase.findings());
  }

  /// Looks into each piece of work for an early contact, see sampleOf(). The result and
  /// the counts are not used, except for the time of the contact: the tasks find
  /// everything again.
  template <typename Traversal>
  void lookForEarlyContact(Traversal& traversal, NarrowPhase& narrow_phase) {
    // After a contact that is earlier than this, little is left to prune.
    constexpr double kEarlyEnough = 0x1p-10;
    const std::size_t steps = sampleOf(meshes_.a, meshes_.b, options_.query);
    if (steps == 0) return;
    narrow_phase.findings().begin(1 + pieces_.size());
    for (const NodePair& piece : pieces_)
      if (progress_.first_hi.load() > kEarlyEnough) traversal.run(piece, steps);
    // A contact that begins with the one found here must be found again.
    progress_.first_lo = 1;
  }

  template <typename Traversal>
  void runTasks(Traversal& traversal, NarrowPhase& narrow_phase) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      narrow_phase.findings().begin(i + 1);
      traversal.run(pieces_[i]);
      tasks_[i + 1].take(narrow_phase.findings());
    }
  }

  void runTasksSideBySide() {
    parallelFor(pieces_.size(), options_.num_threads, [&](std::size_t i) {
      NarrowPhase narrow_phase = narrowPhase(i + 1);
      traverse(meshes_, schedule_, narrow_phase, tasks_[i + 1].times,
               [&](auto& traversal) { traversal.run(pieces_[i]); });
      tasks_[i + 1].take(narrow_phase.findings());
    });
  }

  /// The first contact, found by a query of its own.
  FeatureContact firstContact() const {
    QueryOptions first = options_;
    first.query = ContinuousQuery::kFirst;
    first.max_contacts = 1;
    const QueryAnswer answer =
        ContactQuery(meshes_.a, meshes_.b, meshes_.shifts, first).answer();
    assert(!answer.contacts.empty());
    return answer.contacts.front();
  }

  /// Divides the wall time in proportion to the times of the tasks. The time of
  /// proveSelf() counts as traversal, all other time outside of tasks as tests.
  void setWallTimes(StageTimes& times) const {
    const double wall = start_.seconds();
    const double sum = times.traverse + times.test;
    const double share = sum > 0 ? times.traverse / sum : 0;
    const double in_tasks = std::min(sum, wall - proof_time_);
    times.traverse = proof_time_ + in_tasks * share;
    times.test = wall - times.traverse;
  }

  const Stopwatch start_;
  const QueryOptions options_;
  QueryOptions task_options_;
  const Schedule& schedule_;
  TreeMarks marks_[2];
  const MeshPair meshes_;
  const Surroundings surroundings_;
  const double proof_time_;
  QueryProgress progress_;
  std::vector<NodePair> pieces_;
  std::vector<TaskAnswer> tasks_;
};

bool candidates(const MeshInstance& a, const MeshInstance& b, const BoxShifts& shifts,
                const FeatureCandidateSink& sink, double min_distance,
                const TrianglePairTest& is_wanted = {}) {
  const double cull_distance = shifts.cullDistance(1);
  const KdopShift shift = shifts.shift(cull_distance);
  CandidateCollector collector(a, b, shifts.isEmpty() ? nullptr : &shift, sink,
                               cull_distance, is_wanted);
  const MeshPair meshes{a, b, shifts,
                        &a == &b ? proveSelf(a, true, min_distance, 1) : SelfProofs{},
                        min_distance};
  StageTimes times;
  traverse(meshes, kAllSchedule, collector, times, [](auto& traversal) {
    std::vector<NodePair> pieces;
    traversal.divide(pieces);
    for (const NodePair& piece : pieces) traversal.run(piece);
  });
  return !collector.isDone();
}

BoxPosition positionOfBoxes(const MeshInstance& mesh) {
  BoxPosition position;
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k) {
      position.origin[frame][k] =
          mesh.tree ? mesh.tree->origin(frame)[k] : mesh.rigid.origin(frame)[k];
      position.translation[frame][k] = mesh.translation[frame][k];
    }
  position.largest_coordinate = mesh.tree ? 0 : mesh.rigid.largestCoordinate();
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

bool candidatesSelf(const MeshInstance& a, const FeatureCandidateSink& sink,
                    double min_distance) {
  return candidatesPair(a, a, sink, min_distance);
}

bool candidatesPair(const MeshInstance& a, const MeshInstance& b,
                    const FeatureCandidateSink& sink, double min_distance) {
  const DefaultFloatingPoint mode;
  return candidates(a, b, shiftsOf(a, b, min_distance, false), sink, min_distance);
}

void candidatesAtEnd(const MeshInstance& a, const MeshInstance& b,
                     const FeatureCandidateSink& sink, double distance,
                     const TrianglePairTest& is_wanted) {
  assert(distance > 0);
  const DefaultFloatingPoint mode;
  BoxShifts shifts = shiftsOf(a, b, distance, false);
  shifts.leaveOutStart();
  candidates(a, b, shifts, sink, distance, is_wanted);
}

KdopShift relativeShift(const MeshInstance& a, const MeshInstance& b) {
  return relativeShift(positionOfBoxes(a), positionOfBoxes(b));
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

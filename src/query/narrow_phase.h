// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_NARROW_PHASE_H
#define FCL_CCD_QUERY_NARROW_PHASE_H

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fcl/narrowphase/stage_counts.h"
#include "query/contact_sink.h"
#include "query/crossing.h"
#include "query/feature_batch.h"
#include "query/leading_contact.h"
#include "query/pair_filter.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

struct QueryOptions {
  ContinuousQuery query{ContinuousQuery::kAll};
  std::size_t max_contacts{static_cast<std::size_t>(-1)};
  double toc_err{1e-4};
  /// A crossing at t = 0 answers the query; contacts are of no interest then.
  bool stop_at_crossing{false};
  /// See parallelFor().
  int num_threads{1};
  /// Whether a self query leaves out embedded regions; only which contact kAny names may
  /// depend on it.
  bool leaves_out_regions{true};
  /// Contacts that begin later are none.
  double t_max{1};
  /// Whether all crossings at t = 0 are wanted, not one.
  bool all_crossings{false};
  /// Null: all pairs count.
  const PairFilter* filter{nullptr};
};

/// @brief What the tasks of one query tell each other, so that none does what cannot
/// change the answer; which task comes first is known whatever the threads do.
struct QueryProgress {
  /// Upper end of the earliest bracket so far; an error stands for a contact from when on
  /// its triangles may touch.
  std::atomic<double> first_hi{1};
  /// The lowest task that has the answer on its own, or an error in place of it.
  std::atomic<std::size_t> answered_by{static_cast<std::size_t>(-1)};

  template <typename T>
  static void lower(std::atomic<T>& value, T to) {
    T now = value.load(std::memory_order_relaxed);
    while (to < now && !value.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
    }
  }
};

/// @brief A vertex that is not finite, of two triangles whose boxes overlap from
/// `earliest` on.
struct QueryError {
  float earliest;
  std::size_t vertex;
};

/// @brief Everything that is done to the triangle pairs whose boxes meet: crossing at t =
/// 0, feature pairs, elementary tests, contacts into the sink. Each stage works on the
/// pairs of a block, eight at a time; what a stage leaves goes on to the next. Holds the
/// state of one query of one thread.
class NarrowPhase {
 public:
  /// @param a, b  kept by reference; the same object twice for a self-collision.
  /// @param shift  between their trees; null for a self-collision
  /// @param progress  of the query; null: this is all of it
  /// @param task  number of this part of the query, until begin()
  NarrowPhase(const MeshInstance& a, const MeshInstance& b, const KdopShift* shift,
              const QueryOptions& options, QueryProgress* progress = nullptr,
              std::size_t task = 0);

  /// @brief Forgets what was found, for another task of the same query.
  /// @param task  its number
  void begin(std::size_t task);

  /// @brief Takes pairs of triangles; between two calls of flush() at most
  /// FeatureBatch::kMaxPairs.
  /// @param next  the first of them; after an error the one that it is about, and in the
  /// end `last`
  /// @throws NonFiniteVertex
  void visit(const LeafPair*& next, const LeafPair* last) {
    batch_.add(next, last, latest(), wantsCrossings(), counts_);
  }

  /// @brief Notes what visit() threw for a pair; the pair is left out. Whether the query
  /// fails is known when all tasks have ended: another may have the answer before.
  void refuse(const NonFiniteVertex& error, float earliest);

  /// @brief The earliest of the errors that were noted, the first one of these.
  const std::optional<QueryError>& error() const { return error_; }

  /// @brief Tests what visit() has taken.
  void flush();

  /// @brief Whether nothing more can change the answer.
  bool isDone() const {
    return hasAnswer() ||
           (progress_ && progress_->answered_by.load(std::memory_order_relaxed) < task_);
  }

  /// @brief A pair whose window starts after this time cannot change the answer.
  double latest() const {
    if (options_.query == ContinuousQuery::kAny) return options_.t_max;
    // A contact that is later than this has a bracket that begins later.
    const double width = options_.toc_err + kTimeRounding;
    double latest = sink_.latestKept() + width;
    if (options_.query == ContinuousQuery::kFirst) {
      const double first_hi = firstHi();
      latest = std::min(latest, std::min(first_hi + width, latestLeading(first_hi)));
    }
    return std::min(latest, options_.t_max);
  }

  bool hasCrossing() const { return !crossings_.empty(); }
  /// @brief The first one that was found, or, where all are wanted, all of them; those of
  /// a mesh without owners repeatedly.
  const std::vector<Crossing>& crossings() const { return crossings_; }
  /// @brief The tight bracket of the first contact that was found, if this is all of the
  /// query.
  /// @pre there is one
  TimeBracket firstBracket() const { return first_.get(); }
  ContactSink& sink() { return sink_; }
  const ContactSink& sink() const { return sink_; }
  const StageCounts& counts() const { return counts_; }
  StageCounts& counts() { return counts_; }

  /// @brief Adds what a traversal counted.
  void addTraversal(std::uint64_t compared, std::uint64_t fan_culled) {
    counts_.node_pairs += compared;
    counts_.triangle_pairs += fan_culled;
    counts_.adjacent_pairs += fan_culled;
    counts_.fan_culled += fan_culled;
  }

 private:
  /// More than a bracket is wider than toc_err: a few units in the last place of 1.
  static constexpr double kTimeRounding = 0x1p-40;

  bool hasAnswer() const {
    if (hasCrossing() && options_.stop_at_crossing) return true;
    // No contact is earlier than the start.
    if (error_ && (options_.query != ContinuousQuery::kFirst || error_->earliest <= 0.f))
      return true;
    return options_.query == ContinuousQuery::kAny &&
           (!sink_.contacts().empty() || hasCrossing());
  }
  bool wantsCrossings() const { return options_.all_crossings || !hasCrossing(); }
  /// Upper end of the earliest bracket, of all tasks.
  double firstHi() const {
    const double mine = sink_.firstHi();
    return progress_ ? std::min(mine, progress_->first_hi.load(std::memory_order_relaxed))
                     : mine;
  }
  /// A candidate in a part of its window.
  struct Piece {
    std::size_t candidate;
    double lo, hi;
  };

  void testCrossings();
  void testCrossing(std::size_t i);
  Crossing crossingAt(std::size_t i) const;
  bool accept(Crossing& crossing) const;
  struct BlockPairs;
  void filter(ContinuousContactKind kind);
  void solvePlainCases();
  void solveRest();
  template <typename OnNo, typename OnOpen>
  void divide(OnNo&& on_no, OnOpen&& on_open);
  template <typename OnNo, typename OnOpen>
  void solve(const std::vector<Piece>& pieces, OnNo&& on_no, OnOpen&& on_open);
  EightPairs eightOf(const std::vector<Piece>& pieces, std::size_t first) const;
  void solve(const FeatureCandidate& candidate);
  void add(const FeatureCandidate& candidate, TimeBracket bracket);
  bool isLeading(const TimeBracket& bracket) const;

  QueryOptions options_;
  const Kernels& kernels_;
  FeatureBatch batch_;
  /// Pairs of one kind that may become coplanar.
  std::vector<FeatureCandidate> candidates_;
  /// What the kernels get, what they leave, and the second parts of divided windows.
  std::vector<Piece> pieces_, open_, second_parts_;
  ContactSink sink_;
  FirstBracket first_;
  QueryProgress* progress_;
  std::size_t task_;
  std::vector<Crossing> crossings_;
  std::optional<QueryError> error_;
  StageCounts counts_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "query/narrow_phase.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "elementary/coplanarity_filter.h"
#include "elementary/elementary.h"
#include "elementary/magnified_solve.h"
#include "elementary/predicates.h"
#include "mesh/non_finite_vertex.h"
#include "query/distance_contact.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The points of a candidate in the form that tests of single pairs need.
class CandidatePoints {
 public:
  explicit CandidatePoints(const FeatureCandidate& candidate) {
    for (int i = 0; i < 4; ++i) {
      std::copy(candidate.x[i]->t0, candidate.x[i]->t0 + 3, path_[i].t0);
      std::copy(candidate.x[i]->t1, candidate.x[i]->t1 + 3, path_[i].t1);
    }
  }
  FeaturePoints get() const { return {{&path_[0], &path_[1], &path_[2], &path_[3]}}; }

 private:
  VertexPath path_[4];
};

/// Brackets that times which differ by little have in common. In a query for the first
/// contact, pairs whose points nearly meet have such a bracket, which begins no earlier
/// than apartUntil() tells. Where all nearly meets at one place, a few pairs then decide
/// the answer, and the others are left out. No bracket depends on what else was found, so
/// the answer does not depend on which pairs were left out.
class CoarseTime {
 public:
  /// Smaller tolerances have no coarse times, and smaller times could be rounded up.
  static constexpr double kLeastTocErr = 0x1p-45, kLeastTime = 0x1p-1000;

  /// @param toc_err  the width of a bracket, at most; at least kLeastTocErr
  explicit CoarseTime(double toc_err) : toc_err_(toc_err) {
    while (std::ldexp(1, -bits_) > 0.125 * toc_err) ++bits_;
  }

  /// The beginning of the bracket of a time t >= kLeastTime. It is earlier by at most a
  /// quarter of toc_err and by at most 2^-12 of t. It grows with t.
  double beginning(double t) const {
    int exponent;
    const double digits = std::frexp(t * kScale, &exponent);
    const double down = std::ldexp(std::floor(std::ldexp(digits, bits_)), -bits_);
    // Three roundings of 2^-53.
    return std::ldexp(down, exponent) / kScale * (1 - 0x1p-51);
  }

  /// The width that the bracket of a contact at t or later may have before it becomes
  /// coarse: half of toc_err, and 2^-12 of t.
  double widthFor(double t) const { return std::min(0.5 * toc_err_, 0x1p-12 * t); }

  /// The end of the bracket that begins here. It is as late as the end of any bracket of
  /// that width whose beginning becomes this one: 1 / (1 - 2^-12)^2 < 1 + 2^-11 + 2^-20.
  /// It is tight.
  double end(double beginning) const {
    return std::min(
        {1., beginning + 0.875 * toc_err_, beginning * (1 + 0x1p-11 + 0x1p-20)});
  }

 private:
  /// Halves and thirds of the step are in the middle of what becomes equal.
  static constexpr double kScale = 1.4142;

  double toc_err_;
  /// 13 digits after the point lose at most 2^-12 of a time.
  int bits_{13};
};

bool mayBecomeCoplanarAccurately(const FeatureCandidate& candidate, double latest) {
  return mayBecomeCoplanarAccurately(candidate.kind, CandidatePoints(candidate).get(),
                                     candidate.window_lo,
                                     std::min(candidate.window_hi, latest));
}

}  // namespace

NarrowPhase::NarrowPhase(const MeshInstance& a, const MeshInstance& b,
                         const BoxShifts& shifts, const QueryOptions& options,
                         QueryProgress* progress, std::size_t task)
    : options_(options),
      kernels_(kernels()),
      shifts_(shifts),
      reach_(shifts.reach(1)),
      shift_(shifts.shift(reach_)),
      batch_(a, b, shifts.isEmpty() ? nullptr : &shift_, kernels_, reach_),
      may_repeat_(!a.hasOwners() || !b.hasOwners()),
      sink_(options.query == ContinuousQuery::kAny ? 1 : options.max_contacts,
            may_repeat_),
      progress_(progress),
      task_(task) {
  assert(options.toc_err > 0 && options.max_contacts > 0);
  assert(&a == &b || !shifts.isEmpty());
}

void NarrowPhase::begin(std::size_t task) {
  sink_.clear();
  task_ = task;
  crossings_.clear();
  error_.reset();
  counts_ = {};
}

FeatureBatch::Wanted NarrowPhase::wanted() const {
  FeatureBatch::Wanted wanted{latest(), wantsCrossings()};
  if (!(options_.min_distance > 0)) return wanted;
  wanted.last_vertex = sink_.lastVertexAtStart();
  if (progress_)
    wanted.last_vertex = std::min(wanted.last_vertex,
                                  progress_->last_vertex.load(std::memory_order_relaxed));
  return wanted;
}

void NarrowPhase::refuse(const NonFiniteVertex& error, float earliest) {
  if (error_ && error_->earliest <= earliest) return;
  error_ = QueryError{earliest, error.mesh(), error.vertex()};
  if (!progress_) return;
  QueryProgress::lower(progress_->first_hi, double{earliest});
  if (hasAnswer()) QueryProgress::lower(progress_->answered_by, task_);
}

/// The pairs of one kind in a block, for runStages().
struct NarrowPhase::BlockPairs {
  NarrowPhase& phase;
  ContinuousContactKind kind;
  /// NarrowPhase::latest() when the block began.
  double latest;

  void cullByBoxes() {
    phase.batch_.cull(kind, latest, phase.counts_);
    if (const PairFilter* filter = phase.options_.filter)
      phase.counts_.mask_culled += phase.batch_.keep(kind, *filter);
  }
  void filterCoplanarity() { phase.filterCoplanarity(kind); }
  void solvePlainCases() { phase.solvePlainCases(); }
  void solveRest() { phase.solveRest(); }
};

void NarrowPhase::setReach(double reach) {
  if (reach == reach_) return;
  reach_ = reach;
  shift_ = shifts_.shift(reach);
  batch_.setReach(&shift_, reach);
}

void NarrowPhase::flush() {
  const double latest = this->latest();
  setReach(shifts_.reach(latest));
  batch_.cullTriangles(latest, counts_);
  testCrossings();
  const bool is_at_start = onlyStartMatters(latest);
  for (const ContinuousContactKind kind :
       {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
    BlockPairs pairs{*this, kind, latest};
    if (!(options_.min_distance > 0)) {
      runStages(pairs);
    } else if (sink_.mayKeepAtStart(kind)) {
      if (is_at_start) {
        batch_.cullAtStart(kind, counts_);
        testDistancesAtStart(kind);
      } else {
        pairs.cullByBoxes();
        testDistances(kind);
      }
    }
  }
  batch_.clear();
}

/// Makes candidates of the pairs that may become coplanar before latest(). A candidate
/// has its whole window, so that the bracket of a contact does not depend on what was
/// found before.
void NarrowPhase::filterCoplanarity(ContinuousContactKind kind) {
  const std::uint32_t* codes = batch_.codes(kind);
  const TimeWindow* windows = batch_.windows(kind);
  const std::size_t size = batch_.size(kind);
  const double latest = this->latest();
  candidates_.clear();
  for (std::size_t first = 0; first < size; first += 8) {
    const EightCoplanarities found =
        kernels_.coplanarity(kind, batch_.pairs(), codes + first, windows + first,
                             std::min<std::size_t>(8, size - first), latest);
    unsigned left = found.possible | found.unclear;
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(left));
      const std::size_t i = first + lane;
      // It is written in place: a copy right after it was stored in parts would wait for
      // these stores.
      candidates_.emplace_back();
      batch_.setCandidate(codes[i], windows[i], candidates_.back());
      candidates_.back().window_hi =
          std::min(candidates_.back().window_hi, options_.t_max);
      if (found.unclear >> lane & 1U &&
          !mayBecomeCoplanarAccurately(candidates_.back(), latest))
        candidates_.pop_back();
    }
  }
  counts_.filter_culled += size - candidates_.size();
}

/// Solves pieces, eight at a time. Adds the contacts. Calls on_no(piece) for each without
/// contact, and on_open(piece) for each that is no plain case.
template <typename OnNo, typename OnOpen>
void NarrowPhase::solve(const std::vector<Piece>& pieces, OnNo&& on_no,
                        OnOpen&& on_open) {
  for (std::size_t first = 0; first < pieces.size() && !isDone(); first += 8) {
    const EightAnswers answers = kernels_.solve(eightOf(pieces, first), options_.toc_err);
    const std::size_t last = std::min(pieces.size(), first + 8);
    for (std::size_t i = first; i < last && !isDone(); ++i) {
      const std::size_t lane = i - first;
      if (answers.no >> lane & 1U)
        on_no(pieces[i]);
      else if (answers.yes >> lane & 1U)
        add(candidates_[pieces[i].candidate],
            {answers.toc_lo[lane], answers.toc_hi[lane]});
      else
        on_open(pieces[i]);
    }
  }
}

/// Eight pieces from number `first` on. If there are fewer, the last one is repeated.
EightPairs NarrowPhase::eightOf(const std::vector<Piece>& pieces,
                                std::size_t first) const {
  assert(first < pieces.size());
  EightPairs eight;
  eight.kind = candidates_.front().kind;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    const Piece& piece = pieces[std::min(first + lane, pieces.size() - 1)];
    eight.set(lane, candidates_[piece.candidate].x, piece.lo, piece.hi);
  }
  return eight;
}

/// Solves all candidates over their whole windows. Leaves in open_ those that are no
/// plain cases.
void NarrowPhase::solvePlainCases() {
  pieces_.clear();
  open_.clear();
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    pieces_.push_back({i, candidates_[i].window_lo, candidates_[i].window_hi});
  solve(
      pieces_, [this](const Piece&) { ++counts_.solver_culled; },
      [this](const Piece& p) { open_.push_back(p); });
}

/// Decides what solvePlainCases() has left. Divides windows in two; the second part is
/// solved only if there is no contact in the first one.
void NarrowPhase::solveRest() {
  const auto isNo = [this](const Piece&) { ++counts_.solver_culled; };
  const auto solveAlone = [this](const Piece& p) { solve(candidates_[p.candidate]); };
  divide(isNo, solveAlone);
  second_parts_.clear();
  solve(
      pieces_,
      [this](const Piece& p) {
        const double window_hi = candidates_[p.candidate].window_hi;
        second_parts_.push_back({p.candidate, p.hi, window_hi});
      },
      solveAlone);
  solve(second_parts_, isNo, solveAlone);
}

/// Finds in open_ the windows that can be divided, and makes pieces of their first parts.
/// Calls on_no(piece) for each that has no contact, and on_open(piece) for all others.
template <typename OnNo, typename OnOpen>
void NarrowPhase::divide(OnNo&& on_no, OnOpen&& on_open) {
  pieces_.clear();
  for (std::size_t first = 0; first < open_.size() && !isDone(); first += 8) {
    const EightDivisions found = kernels_.divide(eightOf(open_, first));
    const std::size_t last = std::min(open_.size(), first + 8);
    for (std::size_t i = first; i < last && !isDone(); ++i) {
      const std::size_t lane = i - first;
      if (found.never_inside >> lane & 1U)
        on_no(open_[i]);
      else if (found.divisible >> lane & 1U)
        pieces_.push_back({open_[i].candidate, open_[i].lo, found.at[lane]});
      else
        on_open(open_[i]);
    }
  }
}

/// Whether this contact may be the answer of the query and its bracket is not tight yet.
bool NarrowPhase::isLeading(const TimeBracket& bracket) const {
  if (bracket.isTight()) return false;
  // Any contact of this task may be the answer of a kAny query.
  if (options_.query == ContinuousQuery::kAny) return true;
  return options_.query == ContinuousQuery::kFirst && bracket.lo <= firstHi();
}

void NarrowPhase::add(const FeatureCandidate& candidate, TimeBracket bracket) {
  assert(bracket.lo <= bracket.hi);
  ++counts_.contacts;
  if (isLeading(bracket))
    bracket = tightened(candidate.kind, CandidatePoints(candidate).get(), bracket);
  // If the query has more tasks, merge() looks for the first contact.
  if (!progress_ && first_.wants(bracket))
    first_.add(tightened(candidate.kind, CandidatePoints(candidate).get(), bracket));
  FeatureContact contact{candidate, bracket.lo, bracket.hi};
  if (options_.filter) options_.filter->find(candidate, contact.triangles);
  add(contact);
}

void NarrowPhase::add(const FeatureContact& contact) {
  sink_.add(contact);
  if (!progress_) return;
  QueryProgress::lower(progress_->first_hi, contact.toc_hi);
  QueryProgress::lower(progress_->first_lo, contact.toc_lo);
  if (options_.query == ContinuousQuery::kAll)
    QueryProgress::lower(progress_->latest_kept, sink_.latestKept());
  if (options_.min_distance > 0 && sink_.isCut())
    QueryProgress::lower(progress_->last_vertex, sink_.lastVertexAtStart());
  if (hasAnswer()) QueryProgress::lower(progress_->answered_by, task_);
}

/// In place of filterCoplanarity() and solve(), with a distance.
void NarrowPhase::testDistances(ContinuousContactKind kind) {
  const std::uint32_t* codes = batch_.codes(kind);
  const TimeWindow* windows = batch_.windows(kind);
  const std::size_t size = batch_.size(kind);
  const DistanceRequest request = distanceRequest();
  candidates_.clear();
  for (std::size_t first = 0; first < size && !isDone(); first += 8) {
    const std::size_t count = std::min<std::size_t>(8, size - first);
    unsigned left =
        kernels_.mayComeWithin(kind, batch_.pairs(), codes + first, windows + first,
                               count, request, batch_.bends());
    counts_.filter_culled += count - static_cast<unsigned>(__builtin_popcount(left));
    for (; left != 0 && !isDone(); left &= left - 1) {
      const std::size_t i = first + static_cast<std::size_t>(__builtin_ctz(left));
      FeatureCandidate& candidate = candidates_.emplace_back();
      batch_.setCandidate(codes[i], windows[i], candidate);
      // Many pairs may be near at t = 0, of which a few are wanted.
      if (!sink_.mayKeep(candidate, 0)) {
        ++counts_.box_culled;
        candidates_.pop_back();
      } else if (options_.lists_near_pairs) {
        add(FeatureContact{candidate, candidate.window_lo, candidate.window_hi});
        candidates_.pop_back();
      } else if (isPart(candidate.kind)) {
        testDistance(candidate);
        candidates_.pop_back();
      } else if (candidates_.size() == kMostApproaching) {
        testManyDistances();
      }
    }
  }
  if (!candidates_.empty()) testManyDistances();
}

/// Whether an answer at t = 0 is known (a contact, a crossing or an error), so that only
/// contacts at t = 0 matter. Kernels::approachAtStart() takes numbers that are not
/// extreme.
bool NarrowPhase::onlyStartMatters(double latest) const {
  return options_.query == ContinuousQuery::kFirst && options_.min_distance > 0x1p-150 &&
         reach_ < 0x1p150 && firstHi() == 0 && batch_.isAtStart(latest) &&
         !options_.filter && !options_.ignores_initially_closer &&
         !options_.lists_near_pairs;
}

/// As testDistances(), where only t = 0 matters: without windows and without the filter.
void NarrowPhase::testDistancesAtStart(ContinuousContactKind kind) {
  assert(options_.min_distance > 0x1p-150 && reach_ < 0x1p150);
  const std::uint32_t* codes = batch_.codes(kind);
  const std::size_t size = batch_.size(kind);
  candidates_.clear();
  for (std::size_t first = 0; first < size && !isDone(); first += 8) {
    const std::size_t count = std::min<std::size_t>(8, size - first);
    Approach found[8];
    unsigned left = kernels_.approachAtStart(kind, batch_.pairs(), codes + first, count,
                                             options_.min_distance, reach_, found);
    counts_.filter_culled += count - static_cast<unsigned>(__builtin_popcount(left));
    for (; left != 0 && !isDone(); left &= left - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(left));
      const std::uint32_t code = codes[first + lane];
      FeatureCandidate& candidate = candidates_.emplace_back();
      batch_.setCandidate(code, {0, 1}, candidate);
      if (!sink_.mayKeep(candidate, 0)) {
        ++counts_.box_culled;
      } else if (isPart(candidate.kind)) {
        testDistance(candidate);
      } else if (found[lane].answer == Approach::Answer::kYes) {
        found[lane].exchanges =
            batch_.exchangesOf(code, candidate, found[lane].exchanges);
        addNear(candidate, contactOf(kind, found[lane]));
      } else {
        if (candidates_.size() == kMostApproaching) testManyDistances();
        continue;
      }
      candidates_.pop_back();
    }
  }
  if (!candidates_.empty()) testManyDistances();
}

DistanceRequest NarrowPhase::distanceRequest() const {
  DistanceRequest request;
  request.distance = options_.min_distance;
  request.toc_err = options_.toc_err;
  request.t_max = options_.t_max;
  request.t_stop = latest();
  request.ignores_initially_closer = options_.ignores_initially_closer;
  return request;
}

/// Tests up to kMostApproaching candidates of one kind, and removes them.
void NarrowPhase::testManyDistances() {
  const ContinuousContactKind kind = candidates_.front().kind;
  FourPoints points[kMostApproaching];
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    std::copy(candidates_[i].x, candidates_[i].x + 4, points[i].x);
  Approach found[kMostApproaching];
  kernels_.approach(kind, points, candidates_.size(), distanceRequest(), found);
  for (std::size_t i = 0; i < candidates_.size() && !isDone(); ++i) {
    if (found[i].answer == Approach::Answer::kOpen)
      testDistance(candidates_[i]);
    else if (found[i].answer == Approach::Answer::kYes)
      addNear(candidates_[i], contactOf(kind, found[i]));
    else
      ++counts_.solver_culled;
  }
  candidates_.clear();
}

void NarrowPhase::testDistance(const FeatureCandidate& candidate) {
  const DistanceContact found =
      advanceToDistance(candidate.kind, CandidatePoints(candidate).get(),
                        distanceRequest(), idsOf(candidate));
  if (found.is_contact)
    addNear(candidate, found);
  else
    ++counts_.solver_culled;
}

void NarrowPhase::addNear(const FeatureCandidate& candidate,
                          const DistanceContact& found) {
  ++counts_.contacts;
  FeatureIds pair = candidate;
  if (options_.filter) options_.filter->find(pair, pair.triangles);
  if (options_.names_parts)
    add(contactOf(pair, found, batch_.isSelf()));
  else
    add(FeatureContact{pair, found.toc_lo, found.toc_hi});
}

ElementaryResult NarrowPhase::decide(const FeatureCandidate& candidate,
                                     double t_stop) const {
  const CandidatePoints paths(candidate);
  const bool is_coarse = options_.query == ContinuousQuery::kFirst && progress_ &&
                         options_.toc_err >= CoarseTime::kLeastTocErr &&
                         isWorthMagnifying(candidate.kind, paths.get());
  if (is_coarse) {
    const double apart =
        apartUntil(candidate.kind, paths.get(), candidate.window_lo, candidate.window_hi);
    if (apart >= CoarseTime::kLeastTime) return decideCoarsely(candidate, t_stop, apart);
  }
  return deformable::decide(candidate.kind, paths.get(), candidate.window_lo,
                            candidate.window_hi, options_.toc_err, t_stop,
                            options_.t_max);
}

/// Whether a contact of the pair may change the answer, if its bracket is this one or a
/// later one. The end matters if there are errors, see refuse().
bool NarrowPhase::mayMatter(const FeatureIds& pair, const TimeBracket& bracket) const {
  if (bracket.hi < firstHi()) return true;
  if (options_.only_time)
    return bracket.lo < progress_->first_lo.load(std::memory_order_relaxed);
  return sink_.mayKeep(pair, bracket.lo);
}

/// With a coarse bracket, for a pair that is apart until a known time.
ElementaryResult NarrowPhase::decideCoarsely(const FeatureCandidate& candidate,
                                             double t_stop, double apart) const {
  const CoarseTime coarse(options_.toc_err);
  const double earliest = coarse.beginning(apart);
  if (!mayMatter(candidate, {earliest, coarse.end(earliest)}))
    return {Answer::kNo, 0, 0, DecidedBy::kSolver};
  const CandidatePoints paths(candidate);
  ElementaryResult result = deformable::decide(
      candidate.kind, paths.get(), candidate.window_lo, candidate.window_hi,
      coarse.widthFor(apart), t_stop, options_.t_max);
  if (result.answer == Answer::kYes) {
    result.toc_lo = coarse.beginning(std::max(apart, result.toc_lo));
    assert(result.toc_hi <= coarse.end(result.toc_lo));
    result.toc_hi = coarse.end(result.toc_lo);
  }
  return result;
}

/// A pair that is met again is decided once.
ElementaryResult NarrowPhase::decideOnce(const FeatureCandidate& candidate) {
  const double t_stop = latest();
  if (may_repeat_)
    if (const ElementaryResult* known = decided_.find(candidate, t_stop)) return *known;
  const ElementaryResult result = decide(candidate, t_stop);
  if (may_repeat_ && result.decided_by == DecidedBy::kExact)
    decided_.add(candidate, t_stop, result);
  return result;
}

void NarrowPhase::solve(const FeatureCandidate& candidate) {
  const ElementaryResult result = decideOnce(candidate);
  if (result.decided_by == DecidedBy::kExact) ++counts_.exact_tests;
  if (result.answer == Answer::kNo) {
    ++(result.decided_by == DecidedBy::kExact ? counts_.exact_culled
                                              : counts_.solver_culled);
    return;
  }
  add(candidate, {result.toc_lo, result.toc_hi});
}

void NarrowPhase::testCrossings() {
  const std::size_t size = batch_.numCrossings();
  for (std::size_t first = 0; first < size && wantsCrossings(); first += 8) {
    const std::size_t count = std::min<std::size_t>(size - first, 8);
    counts_.crossing_tests += count;
    for (unsigned left =
             kernels_.mayCross(batch_.pairs(), batch_.crossings() + first, count);
         left != 0 && wantsCrossings(); left &= left - 1)
      testCrossing(first + static_cast<std::size_t>(__builtin_ctz(left)));
  }
}

void NarrowPhase::testCrossing(std::size_t i) {
  const TreeVertex* x[5];
  crossingPoints(batch_.pairs(), batch_.crossings()[i], x);
  const auto start = [&x](int k) -> const double(&)[3] {
    return reinterpret_cast<const double(&)[3]>(x[k]->t0);
  };
  if (!isCrossing(start(0), start(1), start(2), start(3), start(4))) return;
  Crossing crossing = crossingAt(i);
  if (options_.filter && !accept(crossing)) return;
  crossings_.push_back(crossing);
  if (!progress_) return;
  QueryProgress::lower(progress_->crossed_by, task_);
  if (!hasAnswer()) return;
  QueryProgress::lower(progress_->answered_by, task_);
  if (options_.only_time) QueryProgress::lower(progress_->first_hi, 0.);
}

Crossing NarrowPhase::crossingAt(std::size_t i) const {
  const FeatureBatch::EdgeAndFace c = batch_.crossing(i);
  const bool self = batch_.isSelf();
  const TreeTriangle &edge = c.edge_on_a ? *c.pair->a : *c.pair->b,
                     &face = c.edge_on_a ? *c.pair->b : *c.pair->a;
  Crossing crossing;
  crossing.first_on_a = c.edge_on_a || self;
  crossing.edge[0] = edge.id[c.edge];
  crossing.edge[1] = edge.id[(c.edge + 1) % 3];
  std::copy(face.id, face.id + 3, crossing.face);
  crossing.triangles[0] = static_cast<std::int32_t>((self ? edge : *c.pair->a).index);
  crossing.triangles[1] = static_cast<std::int32_t>((self ? face : *c.pair->b).index);
  return crossing;
}

/// Sets the triangles of the crossing to two that the filter accepts; false if there are
/// none.
bool NarrowPhase::accept(Crossing& crossing) const {
  const HeldFeature edge{crossing.edge, 2,
                         crossing.triangles[crossing.first_on_a ? 0 : 1]},
      face{crossing.face, 3, crossing.triangles[crossing.first_on_a ? 1 : 0]};
  return crossing.first_on_a ? options_.filter->find(edge, face, crossing.triangles)
                             : options_.filter->find(face, edge, crossing.triangles);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "query/touching_stages.h"

#include <algorithm>
#include <cassert>

#include "base/bits.h"
#include "elementary/approach_speed.h"
#include "elementary/coplanarity_filter.h"
#include "elementary/elementary.h"
#include "elementary/magnified_solve.h"
#include "query/coarse_time.h"
#include "query/surroundings.h"

namespace fcl {
namespace detail {
namespace deformable {

void TouchingStages::cullByBoxes() {
  batch_.cull(kind_, latest_, counts_, findings_.options().filter);
}

void TouchingStages::filterCoplanarity() {
  const std::uint32_t* codes = batch_.codes(kind_);
  const TimeWindow* windows = batch_.windows(kind_);
  const std::size_t size = batch_.size(kind_);
  const double latest = findings_.latest();
  candidates_.clear();
  for (std::size_t first = 0; first < size; first += 8) {
    const EightCoplanarities found =
        kernels_.coplanarity(kind_, batch_.pairs(), codes + first, windows + first,
                             std::min<std::size_t>(8, size - first), latest);
    unsigned left = found.possible | found.unclear;
    assert(left >> std::min<std::size_t>(8, size - first) == 0);
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<unsigned>(lowestBit(left));
      const std::size_t i = first + lane;
      // It is written in place: a copy right after it was stored in parts would wait for
      // these stores.
      FeatureCandidate& candidate = candidates_.emplace_back();
      batch_.setCandidate(codes[i], windows[i], candidate);
      // The window does not end at `latest`, so that the bracket of a contact does not
      // depend on what was found before.
      candidate.window_hi = std::min(candidate.window_hi, findings_.options().t_max);
      assert(candidate.window_lo <= candidate.window_hi);
      if (found.unclear >> lane & 1U &&
          !mayBecomeCoplanarAccurately(kind_, CandidatePoints(candidate).get(),
                                       candidate.window_lo,
                                       std::min(candidate.window_hi, latest)))
        candidates_.pop_back();
    }
  }
  counts_.filter_culled += size - candidates_.size();
}

/// Solves pieces, eight at a time. Adds the contacts. Calls on_no(piece) for each without
/// contact, and on_open(piece) for each that is no plain case.
template <typename OnNo, typename OnOpen>
void TouchingStages::solve(const std::vector<Piece>& pieces, OnNo&& on_no,
                           OnOpen&& on_open) {
  for (std::size_t first = 0; first < pieces.size() && !findings_.isDone(); first += 8) {
    const EightAnswers answers =
        kernels_.solve(eightOf(pieces, first), findings_.options().toc_err);
    assert((answers.no & answers.yes) == 0);
    const std::size_t last = std::min(pieces.size(), first + 8);
    for (std::size_t i = first; i < last && !findings_.isDone(); ++i) {
      const std::size_t lane = i - first;
      if (answers.no >> lane & 1U) {
        on_no(pieces[i]);
      } else if (answers.yes >> lane & 1U) {
        const TimeBracket found{answers.toc_lo[lane], answers.toc_hi[lane]};
        assert(pieces[i].lo <= found.lo && found.hi <= pieces[i].hi);
        add(candidates_[pieces[i].candidate], found);
      } else {
        on_open(pieces[i]);
      }
    }
  }
}

/// Eight pieces from number `first` on. If there are fewer, the last one is repeated.
EightPairs TouchingStages::eightOf(const std::vector<Piece>& pieces,
                                   std::size_t first) const {
  assert(first < pieces.size());
  EightPairs eight;
  eight.kind = kind_;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    const Piece& piece = pieces[std::min(first + lane, pieces.size() - 1)];
    eight.set(lane, candidates_[piece.candidate].x, piece.lo, piece.hi);
  }
  return eight;
}

void TouchingStages::solvePlainCases() {
  pieces_.clear();
  open_.clear();
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    pieces_.push_back({i, candidates_[i].window_lo, candidates_[i].window_hi});
  solve(
      pieces_, [this](const Piece&) { ++counts_.solver_culled; },
      [this](const Piece& p) { open_.push_back(p); });
}

void TouchingStages::solveRest() {
  const auto isNo = [this](const Piece&) { ++counts_.solver_culled; };
  const auto isOpen = [this](const Piece& p) { solveAlone(candidates_[p.candidate]); };
  divide();
  second_parts_.clear();
  solve(
      pieces_,
      [this](const Piece& p) {
        const double window_hi = candidates_[p.candidate].window_hi;
        assert(p.lo <= p.hi && p.hi <= window_hi);
        second_parts_.push_back({p.candidate, p.hi, window_hi});
      },
      isOpen);
  solve(second_parts_, isNo, isOpen);
}

/// Finds in open_ the windows that can be divided, and makes pieces of their first parts.
/// Decides all others.
void TouchingStages::divide() {
  pieces_.clear();
  for (std::size_t first = 0; first < open_.size() && !findings_.isDone(); first += 8) {
    const EightDivisions found = kernels_.divide(eightOf(open_, first));
    const std::size_t last = std::min(open_.size(), first + 8);
    for (std::size_t i = first; i < last && !findings_.isDone(); ++i) {
      const std::size_t lane = i - first;
      if (found.never_inside >> lane & 1U) {
        ++counts_.solver_culled;
      } else if (found.divisible >> lane & 1U) {
        assert(open_[i].lo <= found.at[lane] && found.at[lane] <= open_[i].hi);
        pieces_.push_back({open_[i].candidate, open_[i].lo, found.at[lane]});
      } else {
        solveAlone(candidates_[open_[i].candidate]);
      }
    }
  }
}

/// A pair that is met again is decided once.
ElementaryResult TouchingStages::decideOnce(const FeatureCandidate& candidate) {
  const double t_stop = findings_.latest();
  if (may_repeat_)
    if (const ElementaryResult* known = decided_.find(candidate, t_stop)) return *known;
  const ElementaryResult result = decide(candidate, t_stop);
  if (may_repeat_ && result.decided_by == DecidedBy::kExact)
    decided_.add(candidate, t_stop, result);
  return result;
}

/// In a query for the first contact, with a coarse bracket where that pays.
ElementaryResult TouchingStages::decide(const FeatureCandidate& candidate,
                                        double t_stop) const {
  const QueryOptions& options = findings_.options();
  const CandidatePoints points(candidate);
  const FeaturePoints x = points.get();
  const auto decideWithin = [&](double toc_err) {
    return deformable::decide(candidate.kind, x, candidate.window_lo, candidate.window_hi,
                              toc_err, t_stop, options.t_max);
  };
  const bool may_be_coarse = options.query == ContinuousQuery::kFirst &&
                             options.toc_err >= CoarseTime::kLeastTocErr &&
                             isWorthMagnifying(candidate.kind, x);
  const double apart = may_be_coarse ? apartUntil(candidate.kind, x, candidate.window_lo,
                                                  candidate.window_hi)
                                     : 0;
  if (!(apart >= CoarseTime::kLeastTime)) return decideWithin(options.toc_err);
  assert(candidate.window_lo <= apart && apart <= candidate.window_hi);
  const CoarseTime coarse(options.toc_err);
  const double earliest = coarse.beginning(apart);
  if (!findings_.mayMatter(candidate, {earliest, coarse.end(earliest)}))
    return {Answer::kNo, 0, 0, DecidedBy::kSolver};
  ElementaryResult result = decideWithin(coarse.widthFor(apart));
  if (result.answer == Answer::kYes) {
    result.toc_lo = coarse.beginning(std::max(apart, result.toc_lo));
    // What was left out above with the earliest bracket is left out with this one too.
    assert(earliest <= result.toc_lo);
    assert(result.toc_hi <= coarse.end(result.toc_lo));
    result.toc_hi = coarse.end(result.toc_lo);
    assert((TimeBracket{result.toc_lo, result.toc_hi}.isTight()));
  }
  return result;
}

void TouchingStages::solveAlone(const FeatureCandidate& candidate) {
  const ElementaryResult result = decideOnce(candidate);
  const bool is_exact = result.decided_by == DecidedBy::kExact;
  assert(result.answer != Answer::kUnsure);
  if (is_exact) ++counts_.exact_tests;
  if (result.answer == Answer::kNo)
    ++(is_exact ? counts_.exact_culled : counts_.solver_culled);
  else
    add(candidate, {result.toc_lo, result.toc_hi});
}

/// Adds a contact, from the time on from which it counts.
void TouchingStages::add(const FeatureCandidate& candidate, const TimeBracket& bracket) {
  const QueryOptions& options = findings_.options();
  if (!(options.min_approach_speed > 0)) return findings_.addTouching(candidate, bracket);
  const CandidatePoints points(candidate);
  TouchingRequest request{bracket.lo, bracket.hi, options.t_max,
                          options.min_approach_speed};
  double from = approachesFrom(candidate.kind, points.get(), request);
  if (from <= options.t_max) {
    // Few pairs are left, for which the triangles around them are read.
    const PairStars stars = options.surroundings->of(candidate);
    request.stars = &stars;
    from = approachesFrom(candidate.kind, points.get(), request);
  }
  if (from > options.t_max)
    ++counts_.solver_culled;
  else
    findings_.addTouching(candidate,
                          from > bracket.hi ? TimeBracket{from, from} : bracket);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

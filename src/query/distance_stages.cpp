// SPDX-License-Identifier: BSD-3-Clause
#include "query/distance_stages.h"
#include "base/bits.h"
#include "elementary/approach_speed.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {

/// Kernels::approachAtStart() takes numbers that are not extreme.
bool DistanceStages::onlyStartMatters(double latest) const {
  return options_.query == ContinuousQuery::kFirst && options_.min_distance > 0x1p-150 &&
         batch_.cullDistance() < 0x1p150 && findings_.firstHi() == 0 &&
         batch_.isAtStart(latest) && !options_.filter &&
         !(options_.min_approach_speed > 0) && !options_.ignores_initially_closer &&
         !options_.lists_near_pairs;
}

/// At the start there are no windows.
void DistanceStages::cullByBoxes() {
  if (is_at_start_)
    batch_.cullAtStart(kind_, counts_);
  else
    batch_.cull(kind_, latest_, counts_, options_.filter);
  request_ = request();
}

DistanceRequest DistanceStages::request() const {
  DistanceRequest request;
  request.distance = options_.min_distance;
  request.toc_err = options_.toc_err;
  request.t_max = options_.t_max;
  request.t_stop = findings_.latest();
  request.ignores_initially_closer = options_.ignores_initially_closer;
  assert(request.distance > 0 && request.toc_err > 0);
  assert(0 <= request.t_stop && request.t_stop <= request.t_max && request.t_max <= 1);
  return request;
}

bool DistanceStages::filterDistances() {
  candidates_.clear();
  while (candidates_.size() < kMostApproaching && !findings_.isDone()) {
    if (left_ == 0) {
      if (next_ >= batch_.size(kind_)) break;
      filterEight();
      continue;
    }
    const auto lane = static_cast<std::size_t>(lowestBit(left_));
    left_ &= left_ - 1;
    FeatureCandidate& candidate = candidates_.emplace_back();
    if (isSettled(lane, candidate)) candidates_.pop_back();
  }
  return !candidates_.empty();
}

/// Leaves out those of the next eight pairs that stay further apart.
void DistanceStages::filterEight() {
  assert(left_ == 0 && next_ < batch_.size(kind_));
  const std::uint32_t* codes = batch_.codes(kind_) + next_;
  const std::size_t count = std::min<std::size_t>(8, batch_.size(kind_) - next_);
  left_ = is_at_start_ ? kernels_.approachAtStart(kind_, batch_.pairs(), codes, count,
                                                  options_.min_distance,
                                                  batch_.cullDistance(), found_)
                       : kernels_.mayComeWithin(kind_, batch_.pairs(), codes,
                                                batch_.windows(kind_) + next_, count,
                                                request_, batch_.bends());
  assert(left_ >> count == 0);
  counts_.filter_culled += count - static_cast<unsigned>(countBits(left_));
  next_ += 8;
}

/// Sets the candidate of a lane of the last eight pairs. Returns whether it needs no
/// advance().
bool DistanceStages::isSettled(std::size_t lane, FeatureCandidate& candidate) {
  const std::size_t i = next_ - 8 + lane;
  assert(next_ >= 8 && i < batch_.size(kind_));
  assert(!is_at_start_ || found_[lane].answer != Approach::Answer::kNo);
  const std::uint32_t code = batch_.codes(kind_)[i];
  batch_.setCandidate(code, is_at_start_ ? TimeWindow{0, 1} : batch_.windows(kind_)[i],
                      candidate);
  // Many pairs may be near at t = 0, of which a few are wanted.
  if (!findings_.sink().mayKeep(candidate, 0)) {
    ++counts_.box_culled;
  } else if (options_.lists_near_pairs) {
    findings_.add(FeatureContact{candidate, candidate.window_lo, candidate.window_hi});
  } else if (isPart(candidate.kind)) {
    advanceAlone(candidate);
  } else if (is_at_start_ && found_[lane].answer == Approach::Answer::kYes) {
    found_[lane].exchanges = exchangesOf(batch_.pairs()[codePair(code)], codeBit(code),
                                         candidate, found_[lane].exchanges);
    add(candidate, contactOf(kind_, found_[lane]));
  } else {
    return false;
  }
  return true;
}

void DistanceStages::advance() {
  assert(!candidates_.empty() && candidates_.size() <= kMostApproaching);
  FourPoints points[kMostApproaching];
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    std::copy(candidates_[i].x, candidates_[i].x + 4, points[i].x);
  Approach found[kMostApproaching];
  kernels_.approach(kind_, points, candidates_.size(), request(), found);
  for (std::size_t i = 0; i < candidates_.size() && !findings_.isDone(); ++i) {
    // Whether a contact approaches is not decided by vectors.
    const bool is_open =
        found[i].answer == Approach::Answer::kOpen ||
        (found[i].answer == Approach::Answer::kYes && options_.min_approach_speed > 0);
    if (is_open)
      advanceAlone(candidates_[i]);
    else if (found[i].answer == Approach::Answer::kYes)
      add(candidates_[i], contactOf(kind_, found[i]));
    else
      ++counts_.solver_culled;
  }
}

void DistanceStages::advanceAlone(const FeatureCandidate& candidate) {
  const DistanceContact found =
      advanceToApproach(candidate.kind, CandidatePoints(candidate).get(), request(),
                        options_.min_approach_speed, idsOf(candidate));
  if (found.is_contact)
    add(candidate, found);
  else
    ++counts_.solver_culled;
}

void DistanceStages::add(const FeatureCandidate& candidate,
                         const DistanceContact& found) {
  ++counts_.contacts;
  FeatureIds pair = candidate;
  if (options_.filter) options_.filter->find(pair, pair.triangles);
  if (options_.names_parts)
    findings_.add(contactOf(pair, found, batch_.isSelf()));
  else
    findings_.add(FeatureContact{pair, found.toc_lo, found.toc_hi});
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

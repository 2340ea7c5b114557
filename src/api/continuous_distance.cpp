// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_distance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "api/compound_query.h"
#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "curved/body_approach.h"
#include "fcl/common/exception.h"
#include "prepare/checked_request.h"
#include "prepare/posed_flat.h"
#include "prepare/prepared_motion.h"
#include "prepare/prepared_shapes.h"
#include "prepare/query_arguments.h"
#include "prepare/query_range.h"

namespace fcl {
namespace detail {
namespace {

using deformable::ApproachAnswer;
using deformable::ApproachOptions;
using deformable::BodyApproach;
using deformable::DefaultFloatingPoint;
using deformable::PreparedMotion;

void requireError(double error, const char* name) {
  if (!(error >= 0) || !std::isfinite(error))
    throw Exception(std::string(name) + " is negative or not finite. Give 0 or more");
}

template <typename S>
ApproachOptions optionsOf(const ContinuousDistanceRequest<S>& request) {
  ApproachOptions options;
  options.abs_err = static_cast<double>(request.abs_err);
  options.rel_err = static_cast<double>(request.rel_err);
  options.t_max = static_cast<double>(request.t_max);
  options.max_distance = static_cast<double>(request.max_distance);
  options.float_times = std::is_same<S, float>::value;
  requireError(options.abs_err, "request.abs_err");
  requireError(options.rel_err, "request.rel_err");
  if (!(options.max_distance > 0))
    throw Exception(
        "request.max_distance is not above 0. Give the largest distance that is of "
        "interest, or infinity");
  return options;
}

/// The largest number of S that is not above x, or the least one that is not below it.
template <typename S>
S roundedDown(double x) {
  const S near = static_cast<S>(x);
  const S out = static_cast<double>(near) > x
                    ? std::nextafter(near, -std::numeric_limits<S>::infinity())
                    : near;
  assert(static_cast<double>(out) <= x);
  return out;
}
template <typename S>
S roundedUp(double x) {
  return -roundedDown<S>(-x);
}

template <typename S>
Vector3<S> toVector(const deformable::Vec& x) {
  return Vector3<S>(static_cast<S>(x.x), static_cast<S>(x.y), static_cast<S>(x.z));
}

template <typename S>
ContinuousDistanceResult<S> resultOf(const ApproachAnswer& answer) {
  ContinuousDistanceResult<S> out;
  out.distance_lo = roundedDown<S>(answer.lo);
  out.distance_hi = roundedUp<S>(answer.hi);
  assert(0 <= out.distance_lo && out.distance_lo <= out.distance_hi);
  out.time = static_cast<S>(answer.time);
  for (int k = 0; k < 2; ++k) out.nearest_points[k] = toVector<S>(answer.point[k]);
  out.b1 = static_cast<std::intptr_t>(answer.triangle[0]);
  out.b2 = static_cast<std::intptr_t>(answer.triangle[1]);
  out.is_cut_off = answer.is_cut_off;
  return out;
}

/// The distance of objects of which no pair counts.
template <typename S>
ContinuousDistanceResult<S> noDistance() {
  ContinuousDistanceResult<S> out;
  out.distance_lo = out.distance_hi = std::numeric_limits<S>::infinity();
  return out;
}

template <typename S>
ContinuousDistanceResult<S> touchingAt(const ContinuousContactResult<S>& found) {
  ContinuousDistanceResult<S> out;
  assert(found.initially_crossing || !found.contacts.empty());
  out.is_collide = true;
  out.time = found.time_of_contact;
  const ContinuousContact<S>& first =
      found.initially_crossing ? found.crossing : found.contacts.front();
  out.nearest_points[0] = out.nearest_points[1] = first.pos;
  out.b1 = first.b1;
  out.b2 = first.b2;
  out.part1 = first.part1;
  out.part2 = first.part2;
  return out;
}

/// Two objects of which the distance is asked.
template <typename S>
class DistanceQuery {
 public:
  DistanceQuery(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                const ContinuousDistanceRequest<S>& request)
      : moving_{&o1, &o2},
        placed_{PlacedGeometry<S>(o1), PlacedGeometry<S>(o2)},
        contact_request_(contactRequestOf(request)),
        checked_(contact_request_),
        options_(optionsOf(request)) {
    requireAnswer();
  }

  int numThreads() const { return checked_.options.num_threads; }

  ContinuousDistanceResult<S> run() {
    RequestFilter filter(checked_, placed_[0].geometry(), placed_[1].geometry(), false);
    if (filter.rejectsAll() || isNoObstacle(0) || isNoObstacle(1)) return noDistance<S>();
    if (const auto* pairs = filter.prepare()) options_.rules = &pairs->rules();
    const int first = firstOf(placed_[0]), second = 1 - first;
    const PreparedMotion bounded = prepared(first, 0),
                         other = prepared(second,
                                          bounded.isEmpty() ? 0 : bounded.body().size());
    if (bounded.isEmpty() || other.isEmpty()) return noDistance<S>();
    const PreparedMotion &motion1 = first == 0 ? bounded : other,
                         &motion2 = first == 0 ? other : bounded;
    requireProvenRange(motion1, motion2);
    if (!motion1.body().shape() || !motion2.body().shape())
      requireLeastSize(motion1, motion2);
    return answerOf([&] { return search(motion1.body(), motion2.body()); });
  }

 private:
  void requireAnswer() const {
    if (answererOf(placed_[0], placed_[1]) == Answerer::kFcl)
      throw Exception("continuousDistance: " + whyFclAnswers(placed_[0], placed_[1]) +
                      ", and FCL has no such query. Give a mesh, a shape or an octree "
                      "that follows one of FCL's motions, or derive the motion class "
                      "from BoundedMotion too");
    if (deformable::isUnbounded(placed_[0].geometry()) &&
        deformable::isUnbounded(placed_[1].geometry()))
      throw Exception(
          "continuousDistance: o1 and o2 are both a plane or a halfspace, which have no "
          "end. Give a bounded shape in the place of one, or ask continuousCollide() "
          "whether they touch");
    placed_[0].requireFinitePoses("o1");
    placed_[1].requireFinitePoses("o2");
  }

  /// As in FCL, the cells of an octree meet only what the program calls occupied.
  bool isNoObstacle(int k) const {
    return placed_[k].isOctree() && !placed_[1 - k].isOctree() &&
           !placed_[1 - k].geometry().isOccupied();
  }

  PreparedMotion prepared(int k, double other_radius) const {
    return PreparedMotion(placed_[k], k == 0 ? "o1" : "o2", checked_.options.toc_err,
                          checked_.options.num_threads, other_radius);
  }

  ContinuousDistanceResult<S> search(const deformable::MovingBody& a,
                                     const deformable::MovingBody& b) {
    BodyApproach approach(a, b, options_);
    // Triangles were found that are so near that they may cross at another time.
    if (!approach.search()) {
      ContinuousContactResult<S> found;
      if (doTouch(found)) return touchingAt(found);
      approach.search();
      return resultOf<S>(approach.answer());
    }
    const ApproachAnswer answer = approach.answer();
    ContinuousContactResult<S> found;
    if (!(answer.lo > 0) && doTouch(found)) return touchingAt(found);
    return resultOf<S>(answer);
  }

  bool doTouch(ContinuousContactResult<S>& found) const {
    QueryOutcome<S> outcome;
    answerPair(*moving_[0], *moving_[1], contact_request_, outcome,
               static_cast<ContinuousContacts<S>*>(&found));
    found.time_of_contact = outcome.toc_lo;
    return outcome.is_collide;
  }

  const MovingGeometry<S>* moving_[2];
  const PlacedGeometry<S> placed_[2];
  const ContinuousContactRequest<S> contact_request_;
  const CheckedRequest checked_;
  ApproachOptions options_;
};

/// The least distance of two objects of which one or both are compounds: that of two
/// parts. Pairs that stay further apart than the least distance so far cost little.
template <typename S>
class CompoundDistance {
 public:
  /// @param o1, o2  live as long as this
  CompoundDistance(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                   const ContinuousDistanceRequest<S>& request)
      : o1_(o1),
        o2_(o2),
        request_(request),
        contact_request_(contactRequestOf(request)),
        checked_(contact_request_),
        compounds_(o1, o2),
        best_(noDistance<S>()) {
    optionsOf(request);
    compounds_.requireNoTriangleGroups(checked_);
  }

  int numThreads() const { return checked_.options.num_threads; }

  ContinuousDistanceResult<S> run() {
    const RequestFilter filter(checked_, o1_.geometry(), o2_.geometry(), false);
    if (filter.rejectsAll()) return noDistance<S>();
    const auto limit = static_cast<double>(request_.max_distance);
    const bool are_some_far =
        compounds_.visitNearest(limit, [this](const PartPair& pair) {
          if (!best_.is_collide) take(pair);
          return static_cast<double>(request_.max_distance);
        });
    if (best_.is_collide) return firstTouch();
    best_.is_cut_off = !is_measured_ && (is_cut_off_ || are_some_far);
    if (best_.is_cut_off)
      best_.distance_lo = std::min(best_.distance_lo, static_cast<S>(limit));
    return best_;
  }

 private:
  void take(const PartPair& pair) {
    ContinuousDistanceResult<S> one;
    compounds_.ask(pair, [&](const PlacedGeometry<S>& x, const PlacedGeometry<S>& y) {
      one = DistanceQuery<S>(x.moving(), y.moving(), request_).run();
    });
    one.part1 = compounds_.number1(pair);
    one.part2 = compounds_.number2(pair);
    is_cut_off_ |= one.is_cut_off;
    is_measured_ |= !one.is_cut_off && std::isfinite(one.distance_lo);
    const S least = std::min(best_.distance_lo, one.distance_lo);
    if (one.is_collide || one.distance_hi < best_.distance_hi) best_ = one;
    best_.distance_lo = least;
    assert(best_.distance_lo <= best_.distance_hi);
    // A pair that is not nearer need not be measured. 0 is no limit that a query takes.
    if (one.distance_hi > 0)
      request_.max_distance = std::min(request_.max_distance, one.distance_hi);
  }

  ContinuousDistanceResult<S> firstTouch() const {
    QueryOutcome<S> outcome;
    ContinuousContactResult<S> found;
    answerPair(o1_.moving(), o2_.moving(), contact_request_, outcome,
               static_cast<ContinuousContacts<S>*>(&found));
    // Parts that only graze may be none for the boxes of both objects.
    if (!outcome.is_collide) return best_;
    found.time_of_contact = outcome.toc_lo;
    return touchingAt(found);
  }

  const PlacedGeometry<S>&o1_, &o2_;
  /// With the least distance so far as max_distance.
  ContinuousDistanceRequest<S> request_;
  const ContinuousContactRequest<S> contact_request_;
  const CheckedRequest checked_;
  const CompoundPair<S> compounds_;
  /// Of the nearest parts so far, or of some that touch.
  ContinuousDistanceResult<S> best_;
  bool is_cut_off_{false}, is_measured_{false};
};

/// Runs a query in its threads.
template <typename S, typename Query>
void run(Query& query, ContinuousDistanceResult<S>& result) {
  if (query.numThreads() == 1) {
    result = query.run();
    return;
  }
  deformable::inArena(query.numThreads(), [&] {
    const DefaultFloatingPoint mode_of_its_thread;
    result = query.run();
  });
}

}  // namespace

template <typename S>
void requireValid(const ContinuousDistanceRequest<S>& request) {
  optionsOf(request);
}

template <typename S>
void answerDistance(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                    const ContinuousDistanceRequest<S>& request,
                    ContinuousDistanceResult<S>& result) {
  const DefaultFloatingPoint mode;
  const PlacedGeometry<S> placed1(o1), placed2(o2);
  if (placed1.compound() || placed2.compound()) {
    answererOf(placed1, placed2);  // refuses what no query answers
    CompoundDistance<S> query(placed1, placed2, request);
    return run(query, result);
  }
  DistanceQuery<S> query(o1, o2, request);
  run(query, result);
}

#define FCL_CCD_INSTANTIATE(S)                                                     \
  template void requireValid(const ContinuousDistanceRequest<S>&);                 \
  template void answerDistance(const MovingGeometry<S>&, const MovingGeometry<S>&, \
                               const ContinuousDistanceRequest<S>&,                \
                               ContinuousDistanceResult<S>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

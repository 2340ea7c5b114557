// SPDX-License-Identifier: BSD-3-Clause
#include "curved/body_approach.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include "advance/convex_advance.h"
#include "advance/triangle_advance.h"
#include "bodies/calm_bodies.h"
#include "bodies/common_motion.h"
#include "bodies/part_windows.h"
#include "curved/curved_query.h"
#include "curved/part_division.h"
#include "elementary/most_steps.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The bracket is never narrower than this many times BodyTolerance::touching.
constexpr double kTouchings = 8;

/// The square of a length underflows by a few units of 2^-1074, and its root by less than
/// this.
constexpr double kUnderflow = 0x1p-530;

/// Two parts in a span, and what their boxes show.
struct NearWork {
  PartWork work;
  /// The parts are further apart than this during the span.
  double least;
};

/// What may come nearest is first. The other comparisons make the order depend on the
/// work alone.
bool isFurther(const NearWork& x, const NearWork& y) {
  const auto key = [](const NearWork& near) {
    const PartWork& work = near.work;
    return std::make_tuple(near.least, work.a.box, work.b.box, work.start);
  };
  return key(x) > key(y);
}

/// The largest distance that is to be proved. No point of a body is further from the
/// origin than its size. A distance below what a search rounds by would be lost beside
/// the radii of the shapes.
double mostOf(const BodiesNearOrigin& near, double max_distance) {
  const double radii = coreDistance(near.a.shape(), near.b.shape(), 0),
               sizes = 2 * (near.a.size() + near.b.size()) + kUnderflow,
               rounding = BodyTolerance(near.a, near.b, radii).touching;
  assert(rounding >= 0);
  return std::max(std::min(sizes, max_distance), kTouchings * rounding);
}

double longestEdge(const BodyTriangle& triangle) {
  double square = 0;
  for (const auto& corner : triangle.corner)
    for (int i = 0; i < 3; ++i) {
      const Vec edge = corner[(i + 1) % 3] - corner[i];
      square = std::max(square, dot(edge, edge));
    }
  return std::sqrt(square);
}

/// The nearest points of two surfaces at a time.
struct NearestPoints {
  double distance;
  Vec point[2];
};

/// Two triangles, one of each mesh.
class TwoTriangles {
 public:
  TwoTriangles(const MovingBody& a, const MovingBody& b, const PartWork& work)
      : body_{&a, &b}, triangle_{a.triangle(~work.a.child), b.triangle(~work.b.child)} {}

  std::int32_t index(int k) const { return triangle_[k].index; }

  TriangleAdvance between(double t0, double t1, const BodyTolerance& tolerance) const {
    return {body_[0]->path(), triangle_[0], body_[1]->path(), triangle_[1], t0, t1,
            tolerance};
  }

  /// The distance is 0 if they cross.
  NearestPoints nearestAt(const TriangleAdvance& pair, double t, double /*error*/) const {
    const NearestFeatures near = pair.nearestAt(t);
    NearestPoints out{std::sqrt(near.square), {near.point, near.point + near.between}};
    if (out.distance < size() && pair.isCrossingAt(t)) out.distance = 0;
    return out;
  }

  /// More than the distance of triangles that cross.
  double size() const {
    const double stretch =
        std::max(body_[0]->path().stretch(), body_[1]->path().stretch());
    return stretch * std::max(longestEdge(triangle_[0]), longestEdge(triangle_[1])) *
           kUpward;
  }

 private:
  const MovingBody* body_[2];
  BodyTriangle triangle_[2];
};

/// A shape or a cell, and another one of these or a triangle.
class ConvexPair {
 public:
  ConvexPair(const MovingBody& a, const MovingBody& b, const PartWork& work)
      : is_mesh_{a.isMesh(), b.isMesh()},
        radius_{a.shapeRadius(), b.shapeRadius()},
        set_{movingConvexOf(a, ~work.a.child), movingConvexOf(b, ~work.b.child)} {}

  std::int32_t index(int k) const {
    return is_mesh_[k] ? set_[k].triangle.index : kNoTriangle;
  }

  ConvexAdvance between(double t0, double t1, const BodyTolerance& tolerance) const {
    return {set_[0], set_[1], t0, t1, tolerance};
  }

  /// @param error  of the distance: how much more it may be
  NearestPoints nearestAt(const ConvexAdvance& pair, double t, double error) const {
    const ConvexGap gap = pair.nearestAt(t, error);
    NearestPoints out{gap.distance - (radius_[0] + radius_[1]),
                      {gap.point[0], gap.point[1]}};
    if (gap.depth > 0 || !(out.distance > 0)) out.distance = 0;
    if (!(gap.distance > 0)) return out;
    const Vec way = (1 / gap.distance) * (gap.point[1] - gap.point[0]);
    out.point[0] = out.point[0] + radius_[0] * way;
    out.point[1] = out.point[1] - radius_[1] * way;
    return out;
  }

  /// What overlaps is found to do so, if the differences of the points have an interior.
  /// Otherwise sets that are nearer than their size, or than a part of the way that they
  /// go, may touch.
  double size() const {
    constexpr double kPart = 0x1p-10;
    if (radius_[0] + radius_[1] > 0 || hasInterior(set_[0]) || hasInterior(set_[1]))
      return 0;
    return std::max(sizeOf(set_[0]) + sizeOf(set_[1]),
                    kPart * (set_[0].speed + set_[1].speed));
  }

 private:
  static bool hasInterior(const MovingConvex& set) {
    if (!set.shape) return false;
    if (set.shape->flat()) return set.shape->flat()->is_solid;
    const auto& extent = set.shape->box().extent;
    return std::all_of(std::begin(extent), std::end(extent),
                       [](double x) { return x > 0; });
  }

  static double sizeOf(const MovingConvex& set) {
    if (!set.shape) return longestEdge(set.triangle);
    return set.shape->flat() ? 0 : 2 * set.shape->box().radius;
  }

  bool is_mesh_[2];
  double radius_[2];
  MovingConvex set_[2];
};

}  // namespace

class BodyApproach::Search {
 public:
  Search(const MovingBody& a, const MovingBody& b, const ApproachOptions& options)
      : options_(options),
        near_(a, b),
        calm_(near_.a, near_.b),
        most_(mostOf(near_, options.max_distance)),
        tolerance_(near_.a, near_.b, coreDistance(a.shape(), b.shape(), most_)),
        calm_tolerance_(tolerance_),
        windows_(calm_.body(0), calm_.body(1), tolerance_,
                 tolerance_.distance + calm_.deviation(), true),
        division_(windows_, false, counts_) {
    assert(options.abs_err >= 0 && options.rel_err >= 0 && options.max_distance > 0);
    assert(0 <= options.t_max && options.t_max <= 1 && most_ > 0);
    assert(!options.float_times || static_cast<float>(options.t_max) == options.t_max);
    if (moveAsOne(near_.a, near_.b, tolerance_.distance)) {
      t_max_ = 0;
      // What they change: see moveAsOne().
      may_change_ = 2 * tolerance_.position;
    } else {
      t_max_ = options.t_max;
    }
    setProved();
  }

  bool run() {
    if (!has_begun_) begin();
    while (!isDone()) {
      if (may_touch_ && !has_stopped_) {
        has_stopped_ = true;
        return false;
      }
      step(next());
    }
    return true;
  }

  ApproachAnswer answer() const;

 private:
  bool areMeshes() const { return near_.a.isMesh() && near_.b.isMesh(); }

  /// Whether parts that are at least this apart may be nearer than what is to be proved.
  bool isNearer(double least) const {
    return least - calm_.deviation() < tolerance_.distance;
  }
  bool isDone() const {
    if (!(proved_ > 0)) return true;
    return next_.empty() && (works_.empty() || !isNearer(works_.front().least));
  }

  void begin();
  void probe(double t);
  NearWork next();
  void step(const NearWork& near);
  void decide(const PartWork& work);
  /// Calls visit(pair) with the pair of triangles, shapes or cells, if it counts.
  template <typename Visit>
  void visitPair(const PartWork& work, Visit&& visit);
  template <typename Pair>
  void decidePair(const PartWork& work, const Pair& pair);
  template <typename Pair>
  bool improve(const PartWork& work, const Pair& pair, double t0, double t1);
  template <typename Pair>
  double endOfDescent(const Pair& pair, double t, double end) const;
  bool areCalmlyApart(const PartWork& work);
  void setProved();
  double tolerance() const {
    return std::max({options_.abs_err, options_.rel_err * std::min(hi_, most_),
                     kTouchings * tolerance_.touching});
  }

  const ApproachOptions options_;
  BodiesNearOrigin near_;
  CalmBodies calm_;
  double most_;
  /// Their distance is the one that is to be proved, of the cores.
  BodyTolerance tolerance_, calm_tolerance_;
  AdvanceCounts counts_;
  PartWindows windows_;
  PartDivision division_;
  double t_max_, may_change_{0};
  /// The work that waits, the nearest first, and what the last work was divided into.
  std::vector<NearWork> works_, next_;
  bool has_begun_{false}, has_stopped_{false};
  /// Whether triangles were found that are nearer than their size.
  bool may_touch_{false};
  /// The least distance that was found, with what it rounds by, and where.
  double hi_{HUGE_VAL}, time_{0};
  NearestPoints nearest_{HUGE_VAL, {}};
  PartWork nearest_work_{};
  std::int32_t nearest_index_[2]{kNoTriangle, kNoTriangle};
  /// The distance that is to be proved, and the least one that was proved of a pair in
  /// its place.
  double proved_{HUGE_VAL}, given_up_{HUGE_VAL};
};

/// Takes the distance that is to be proved: a tolerance less than what was found. It
/// never grows, so that what was proved before stays proved, however the difference
/// rounds.
void BodyApproach::Search::setProved() {
  proved_ = std::min({proved_, most_, hi_ - tolerance()});
  // A lower bound of what was not proved yet is below what was found.
  assert(proved_ <= hi_);
  if (!(proved_ > 0)) return;
  tolerance_.distance = proved_ + may_change_ + tolerance_.radii;
  calm_tolerance_.distance = tolerance_.distance + calm_.deviation();
  windows_.setDistance(calm_tolerance_.distance);
  if (areMeshes()) division_.setApart(proved_);
}

/// The times at which a pair is looked for at first.
void BodyApproach::Search::begin() {
  has_begun_ = true;
  for (const double share : {0.5, 0., 1.}) {
    probe(share * t_max_);
    if (!(proved_ > 0)) return;
  }
  // The pair that is nearest at that time may be another one.
  constexpr int kMostProbes = 8;
  double before = HUGE_VAL;
  for (int i = 0; i < kMostProbes && hi_ < before - tolerance(); ++i) {
    before = hi_;
    probe(time_);
    if (!(proved_ > 0)) return;
  }
  division_.testAlone({0, 0, t_max_, near_.a.root(), near_.b.root(), 0, 0},
                      [this](const PartWork& work, double least) {
                        next_.push_back({work, least});
                      });
}

/// Follows the nearest boxes at a time.
void BodyApproach::Search::probe(double t) {
  std::vector<NearWork> parts;
  const auto push = [&parts](const PartWork& work, double least) {
    parts.push_back({work, least});
  };
  division_.testAlone({t, t, t, near_.a.root(), near_.b.root(), 0, 0}, push);
  while (!parts.empty()) {
    const PartWork work = std::max_element(parts.begin(), parts.end(), isFurther)->work;
    parts.clear();
    if (PartDivision::isPair(work))
      return visitPair(work, [&](const auto& pair) { improve(work, pair, 0, t_max_); });
    division_.divide(work, t, push);
  }
}

/// The nearest one of those that the last work was divided into; if there are none, the
/// nearest one of all. So pairs are reached soon, and their distances leave out others.
NearWork BodyApproach::Search::next() {
  assert(!next_.empty() || !works_.empty());
  if (next_.empty()) {
    std::pop_heap(works_.begin(), works_.end(), isFurther);
    const NearWork near = works_.back();
    works_.pop_back();
    return near;
  }
  const auto best = std::max_element(next_.begin(), next_.end(), isFurther);
  const NearWork near = *best;
  std::swap(*best, next_.back());
  next_.pop_back();
  for (const NearWork& other : next_) {
    if (!isNearer(other.least)) continue;
    works_.push_back(other);
    std::push_heap(works_.begin(), works_.end(), isFurther);
  }
  next_.clear();
  return near;
}

void BodyApproach::Search::step(const NearWork& near) {
  if (!isNearer(near.least)) return;
  if (PartDivision::isPair(near.work)) return decide(near.work);
  division_.divide(near.work, t_max_, [&](const PartWork& work, double least) {
    // A part is no nearer than what it belongs to.
    next_.push_back({work, std::max(least, near.least)});
  });
}

template <typename Visit>
void BodyApproach::Search::visitPair(const PartWork& work, Visit&& visit) {
  const auto visitIfAccepted = [&](const auto& pair) {
    if (!options_.rules || options_.rules->accept(pair.index(0), pair.index(1)))
      visit(pair);
  };
  if (areMeshes())
    visitIfAccepted(TwoTriangles(near_.a, near_.b, work));
  else
    visitIfAccepted(ConvexPair(near_.a, near_.b, work));
}

void BodyApproach::Search::decide(const PartWork& work) {
  if (!areMeshes() && areCalmlyApart(work)) return;
  visitPair(work, [&](const auto& pair) { decidePair(work, pair); });
}

/// As for a first contact: most pairs need one step without the turns that change no
/// distance.
bool BodyApproach::Search::areCalmlyApart(const PartWork& work) {
  constexpr int kMostSteps = 8;
  if (!calm_.areCalmer()) return false;
  const ConvexPair pair(calm_.body(0), calm_.body(1), work);
  const double end = std::min(work.t1, t_max_);
  assert(work.start <= end);
  ConvexAdvance between = pair.between(work.start, end, calm_tolerance_);
  double t = work.start;
  int left = kMostSteps;
  return between.advance(t, end, left, counts_) == AdvanceAnswer::kApart;
}

/// Proves the distance, and takes a lesser one whenever the pair is nearer. A pair of
/// which it is not proved after all steps, or that has no direction that proves it, is
/// proved to keep a lesser distance.
template <typename Pair>
void BodyApproach::Search::decidePair(const PartWork& work, const Pair& pair) {
  ++counts_.triangle_pairs;
  const double end = std::min(work.t1, t_max_);
  double t = work.start, lowered = 0;
  assert(t <= end);
  while (proved_ > 0) {
    BodyTolerance wanted = tolerance_;
    wanted.distance -= lowered;
    if (!(wanted.distance > wanted.radii)) {
      given_up_ = 0;
      return;
    }
    auto between = pair.between(t, end, wanted);
    int left = kMostSteps;
    const double before = t;
    const bool are_apart =
        between.advance(t, end, left, counts_) == AdvanceAnswer::kApart;
    assert(before <= t && t <= end);
    // Up to t the proof holds for the lowered distance only.
    if (lowered > 0 && (are_apart || t > before))
      given_up_ = std::min(given_up_, proved_ - lowered);
    if (are_apart) return;
    if (improve(work, pair, t, endOfDescent(pair, t, end)))
      lowered = 0;
    else
      // The tolerance of a subnormal distance may be 0.
      lowered = std::max({4 * lowered, tolerance(), DBL_MIN});
  }
}

/// The distance of a pair falls from t on, and may have several minima. This is a time
/// after the first one; the times that are tried are twice as long after t each.
template <typename Pair>
double BodyApproach::Search::endOfDescent(const Pair& pair, double t, double end) const {
  constexpr double kFirst = 0x1p-12;
  const double error = 0x1p-3 * tolerance();
  const auto between = pair.between(t, end, tolerance_);
  double before = pair.nearestAt(between, t, error).distance;
  for (double h = kFirst * (end - t); t + h < end; h *= 2) {
    const double distance = pair.nearestAt(between, t + h, error).distance;
    if (!(distance < before)) return t + h;
    before = distance;
  }
  return end;
}

/// Looks for the least distance of a pair in a span.
/// @return whether it is less than before by half of the tolerance
template <typename Pair>
bool BodyApproach::Search::improve(const PartWork& work, const Pair& pair, double t0,
                                   double t1) {
  constexpr int kBits = 24;
  constexpr std::uintmax_t kMostRounds = 24;
  const double before = hi_, wanted = before - 0.5 * tolerance(),
               error = 0x1p-3 * tolerance();
  assert(0 <= t0 && t0 <= t1 && t1 <= t_max_);
  const auto between = pair.between(t0, t1, tolerance_);
  const auto distanceAt = [&](double time) {
    const double t = options_.float_times ? static_cast<float>(time) : time;
    const NearestPoints near = pair.nearestAt(between, t, error);
    const double most = near.distance + tolerance_.position + kUnderflow;
    if (most < hi_) {
      hi_ = most;
      time_ = t;
      nearest_ = near;
      nearest_work_ = work;
      for (int k = 0; k < 2; ++k) nearest_index_[k] = pair.index(k);
    }
    return near.distance;
  };
  distanceAt(t0);
  if (t1 > t0) {
    distanceAt(t1);
    std::uintmax_t rounds = kMostRounds;
    boost::math::tools::brent_find_minima(distanceAt, t0, t1, kBits, rounds);
  }
  if (!(hi_ < before)) return false;
  may_touch_ |= hi_ < pair.size();
  setProved();
  return !(before < HUGE_VAL) || hi_ <= wanted;
}

ApproachAnswer BodyApproach::Search::answer() const {
  ApproachAnswer out{};
  out.counts = counts_;
  out.hi = hi_;
  out.lo = std::max(std::min(proved_, given_up_), 0.);
  // Below rounding, max_distance is less than most_.
  out.is_cut_off = proved_ == most_ && out.lo >= options_.max_distance;
  if (out.is_cut_off) out.lo = options_.max_distance;
  out.time = time_;
  const MovingBody* const body[2] = {&near_.a, &near_.b};
  const std::int32_t place[2] = {~nearest_work_.a.child, ~nearest_work_.b.child};
  for (int k = 0; k < 2; ++k) {
    out.point[k] = nearest_.point[k] + vecOf(near_.origin);
    const bool is_cell = body[k]->octree() && hi_ < HUGE_VAL;
    out.triangle[k] = is_cell ? body[k]->octree()->number(place[k]) : nearest_index_[k];
  }
  // No pair counts: there is no distance.
  if (!(hi_ < HUGE_VAL) && !out.is_cut_off) out.lo = HUGE_VAL;
  assert(0 <= out.lo && out.lo <= out.hi);
  assert(0 <= out.time && out.time <= options_.t_max);
  return out;
}

BodyApproach::BodyApproach(const MovingBody& a, const MovingBody& b,
                           const ApproachOptions& options)
    : search_(std::make_unique<Search>(a, b, options)) {}

BodyApproach::~BodyApproach() = default;

bool BodyApproach::search() { return search_->run(); }

ApproachAnswer BodyApproach::answer() const { return search_->answer(); }

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

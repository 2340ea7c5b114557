// SPDX-License-Identifier: BSD-3-Clause
#include "curved/curved_query.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <iterator>
#include <memory>
#include <unordered_map>
#include <utility>

#include "advance/convex_advance.h"
#include "base/parallel.h"
#include "bodies/calm_bodies.h"
#include "bodies/part_windows.h"
#include "bodies/part_work.h"
#include "bodies/parting_direction.h"
#include "curved/part_division.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

bool isEarlierContact(const CurvedContact& x, const CurvedContact& y) {
  if (x.toc_lo != y.toc_lo) return x.toc_lo < y.toc_lo;
  if (x.triangle[0] != y.triangle[0]) return x.triangle[0] < y.triangle[0];
  return x.triangle[1] < y.triangle[1];
}

class CurvedTraversal {
 public:
  CurvedTraversal(const MovingBody& a, const MovingBody& b, const CurvedOptions& options)
      : options_(options),
        body_{&a, &b},
        calm_(a, b),
        tolerance_(a, b, coreDistance(a.shape(), b.shape(), options.distance)),
        calm_tolerance_(tolerance_),
        windows_(calm_.body(0), calm_.body(1), tolerance_,
                 tolerance_.distance + calm_.deviation()),
        division_(windows_, options.all, counts_),
        parting_(calm_.body(0), calm_.body(1), withDeviation(calm_tolerance_)),
        latest_(options.only_at_start ? 0 : options.t_max),
        works_(options.all ? PartWorkQueue::Order::kAny
                           : PartWorkQueue::Order::kEarliestFirst) {
    assert(!options.any || !options.all);
    if (options.any) division_.pushFirstHalfLast();
    if (a.isMesh() && b.isMesh()) division_.setApart(options.distance);
  }

  CurvedAnswer run() {
    const auto advance = [this](const PartWork& work) { this->advance(work); };
    begin();
    const bool is_for_tasks = isForTasks();
    int num_steps = 0;
    while (!works_.isEmpty() && !isDone() && !(is_for_tasks && isLong())) {
      step(works_.pop(), advance);
      if (options_.any && contacts_.empty() && latest_ > 0) lookAhead(++num_steps);
    }
    if (is_for_tasks && !works_.isEmpty()) runTasks(pieces());
    return finish();
  }

  std::vector<NearTriangles> nearTriangles() {
    std::vector<NearTriangles> near;
    begin();
    traverse([&near](const PartWork& work) {
      near.push_back({{~work.a.child, ~work.b.child}, work.t0, work.t1});
    });
    return near;
  }

 private:
  static constexpr std::size_t kTasks = 32, kPieces = 8 * kTasks;

  /// Whether the traversal has taken about a millisecond: then it is divided into tasks.
  /// Neither this nor the tasks depend on the number of threads.
  bool isLong() const {
    constexpr std::uint64_t kMost = 8192, kPerStep = 8, kPerStepOfShape = 24;
    const bool has_shape = body(0).shape() || body(1).shape();
    return counts_.box_tests + (has_shape ? kPerStepOfShape : kPerStep) * counts_.steps >
           kMost;
  }

  auto pushing() {
    return [this](const PartWork& work, double /*least*/) { push(work); };
  }

  void begin() {
    division_.testAlone({0, 0, 1, body(0).root(), body(1).root(), 0, 0}, pushing());
  }

  void divide(const PartWork& work) { division_.divide(work, latest_, pushing()); }

  /// Calls visit(work) for pairs of triangles.
  template <typename Visit>
  void traverse(Visit&& visit) {
    while (!works_.isEmpty()) step(works_.pop(), visit);
  }

  template <typename Visit>
  void step(PartWork work, Visit&& visit) {
    if (areKeptApart(work)) return;
    if (isPair(work))
      visit(work);
    else
      divide(work);
  }

  static bool isPair(const PartWork& work) { return PartDivision::isPair(work); }

  const MovingBody& body(int k) const { return *body_[k]; }

  const BodyTolerance& withDeviation(BodyTolerance& tolerance) const {
    tolerance.distance += calm_.deviation();
    return tolerance;
  }

  bool isDone() const { return isCut() || (options_.any && !contacts_.empty()); }

  bool isCut() const { return counts_.box_tests > options_.most_box_tests; }

  /// Where one contact is enough: looks for one at a time, now and then. Most pairs that
  /// do not touch are through before.
  void lookAhead(int num_steps) {
    constexpr int kFirst = 8;
    constexpr double kShares[] = {1, 0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875};
    if (num_looks_ == std::size(kShares) || num_steps != kFirst << num_looks_) return;
    lookAt(kShares[num_looks_++] * options_.t_max);
  }

  /// Looks for a pair that is provably in contact at a time. It comes next, from the
  /// beginning of the step on: its first contact is the answer.
  void lookAt(double t) {
    constexpr int kMostSteps = 64;
    if (body(0).root().isTriangle() && body(1).root().isTriangle()) return;
    std::vector<PartWork> works;
    const auto push = [&works](const PartWork& work, double /*least*/) {
      works.push_back(work);
    };
    division_.testAlone({t, t, t, body(0).root(), body(1).root(), 0, 0}, push);
    for (int i = 0; i < kMostSteps && !works.empty(); ++i) {
      PartWork work = works.back();
      works.pop_back();
      if (!isPair(work)) {
        division_.divide(work, t, push);
      } else if (isInContactAt(work, t)) {
        work.t0 = work.start = 0;
        work.dive = 1;
        works_.push(work);
        return;
      }
    }
  }

  bool isInContactAt(const PartWork& work, double t) const {
    const MovingBody &a = body(0), &b = body(1);
    const std::int32_t place[2] = {~work.a.child, ~work.b.child};
    if (!a.isMesh() || !b.isMesh()) {
      const MovingConvex x = movingConvexOf(a, place[0]), y = movingConvexOf(b, place[1]);
      return accepts(indexOf(x), indexOf(y)) &&
             ConvexAdvance(x, y, t, t, tolerance_).provesContactAt(t);
    }
    const BodyTriangle x = a.triangle(place[0]), y = b.triangle(place[1]);
    return accepts(x.index, y.index) && mayTouch(x, y) &&
           TriangleAdvance(a.path(), x, b.path(), y, t, t, tolerance_).provesContactAt(t);
  }

  /// Whether the work may be done in any order and by several threads. The cells of an
  /// octree are numbered as they are met.
  bool isForTasks() const {
    return options_.all && options_.most_box_tests == CurvedOptions::kNoLimit &&
           !body(0).octree() && !body(1).octree();
  }

  /// Divides the work that is left, the first first: the largest parts as a rule.
  std::vector<PartWork> pieces() {
    std::vector<PartWork> pairs;
    std::deque<PartWork> waiting;
    const auto take = [&] {
      for (const PartWork& work : works_.takeAll()) waiting.push_back(work);
    };
    for (take(); !waiting.empty() && pairs.size() + waiting.size() < kPieces; take()) {
      PartWork work = waiting.front();
      waiting.pop_front();
      if (isPair(work))
        pairs.push_back(work);
      else
        divide(work);
    }
    pairs.insert(pairs.end(), waiting.begin(), waiting.end());
    return pairs;
  }

  /// Does the pieces of work in tasks, each with a traversal of its own. Large pieces are
  /// side by side and go to different tasks.
  void runTasks(const std::vector<PartWork>& pieces) {
    struct Found {
      std::vector<CurvedContact> contacts;
      AdvanceCounts counts;
    };
    std::vector<Found> found(std::min(kTasks, pieces.size()));
    parallelFor(found.size(), options_.num_threads, [&](std::size_t number) {
      // It is too large for the stack of a small thread.
      const auto task = std::make_unique<CurvedTraversal>(body(0), body(1), options_);
      for (std::size_t i = number; i < pieces.size(); i += found.size()) {
        PartWork piece = pieces[i];
        piece.halves = -1;
        task->push(piece);
        task->traverse([&](const PartWork& work) { task->advance(work); });
      }
      found[number] = {std::move(task->contacts_), task->counts_};
    });
    for (const Found& part : found) {
      contacts_.insert(contacts_.end(), part.contacts.begin(), part.contacts.end());
      counts_ += part.counts;
    }
  }

  /// Nothing that starts at the time of a contact can be earlier than it.
  void push(const PartWork& work) {
    const bool is_late =
        options_.all || contacts_.empty() ? work.start > latest_ : work.start >= latest_;
    assert(0 <= work.t0 && work.t0 <= work.start);
    assert(work.start <= work.t1 && work.t1 <= 1);
    if (!is_late) works_.push(work);
  }

  /// Whether two triangles may be in contact. Where bodies have to touch, a free point
  /// meets neither free edges nor free points.
  bool mayTouch(const BodyTriangle& a, const BodyTriangle& b) const {
    return tolerance_.distance > 0 || !a.isFree() || !b.isFree() ||
           (!a.isFreePoint() && !b.isFreePoint());
  }

  bool accepts(std::int32_t triangle1, std::int32_t triangle2) const {
    return !options_.rules || options_.rules->accept(triangle1, triangle2);
  }

  /// The number of a set's triangle.
  static std::int32_t indexOf(const MovingConvex& set) {
    return set.shape ? kNoTriangle : set.triangle.index;
  }

  /// Whether the direction of the contact that was found keeps the parts apart until
  /// then. The points and cells of a part may be apart where its box, which is padded by
  /// more than the tolerance, is not.
  bool areKeptApart(const PartWork& work) {
    if (options_.all || contacts_.empty() || !works_.isLong()) return false;
    const double end = std::min(work.t1, latest_);
    double gap[2];
    if (!parting_.areApart(work.a, work.b, {work.start, end}, gap)) return false;
    const double deviation = windows_.partSpan(0, work.a, work.start, end).deviation +
                             windows_.partSpan(1, work.b, work.start, end).deviation;
    return staysPositive(gap, windows_.directionBound() * deviation);
  }

  /// Takes the direction of a contact. Other pairs may touch at the same time in another
  /// direction, so now and then that of a pair that does not touch earlier.
  template <typename Pair>
  void setPartingDirection(const Pair& pair, TriangleAdvance::Answer answer, double t) {
    constexpr int kOften = 4;
    if (options_.all) return;
    if (answer != TriangleAdvance::Answer::kContact &&
        (contacts_.empty() || !works_.isLong() || ++num_apart_ % kOften != 0))
      return;
    parting_.set(pair.directionAt(t));
  }

  /// A pair that is advanced in more than one span.
  struct PairOfManySpans {
    /// The earliest contact that was found. HUGE_VAL: none.
    double toc{HUGE_VAL};
    /// All steps that it took.
    int steps{0};
  };

  static std::uint64_t keyOf(const PartWork& work) {
    const auto half = [](std::int32_t x) {
      return std::uint64_t{static_cast<std::uint32_t>(x)};
    };
    return half(work.a.child) << 32 | half(work.b.child);
  }

  /// In a span with one bound on the acceleration. A body may rest near another one in a
  /// part of the span, and be fast in the rest: then steps by this bound are short.
  static constexpr int kMostStepsInSpan = 64;

  /// Whether a bound on the acceleration is as good in a long span as in a short one.
  bool isBentAlike() const {
    return body(0).path().hasConstantAcceleration() &&
           body(1).path().hasConstantAcceleration();
  }

  /// Both halves of what is left of a pair's span. They share its steps. The first half
  /// comes last, as in halveTiny().
  void pushHalves(PartWork work) {
    if (!work.is_one_of_many && work.halves < 0) {
      work.halves = static_cast<std::int32_t>(steps_of_halves_.size());
      steps_of_halves_.push_back(work.steps);
    }
    work.t1 = std::max(std::min(work.t1, latest_), work.start);
    PartWork first = work, second = work;
    first.t1 = second.t0 = second.start = work.start + 0.5 * (work.t1 - work.start);
    push(second);
    push(first);
  }

  /// What a pair has if its spans are counted together; null: it has one span.
  PairOfManySpans* manySpansOf(const PartWork& work) {
    return work.is_one_of_many || work.halves >= 0 ? &seen_[keyOf(work)] : nullptr;
  }

  /// All steps that the pair took in this span, before it was halved too; or in all of
  /// its spans, if they are very many.
  int& stepsOf(PartWork& work, PairOfManySpans* known) {
    if (work.halves >= 0) {
      assert(static_cast<std::size_t>(work.halves) < steps_of_halves_.size());
      return steps_of_halves_[static_cast<std::size_t>(work.halves)];
    }
    return known ? known->steps : work.steps;
  }

  /// The steps that the pair took before, in this span and those that it was halved from.
  int stepsBefore(const PartWork& work) const {
    return work.halves < 0 ? work.steps
                           : steps_of_halves_[static_cast<std::size_t>(work.halves)];
  }

  /// Whether a pair had a contact in an earlier span: only the first one counts.
  bool touchedBefore(const PartWork& work) const {
    if (!work.is_one_of_many && work.halves < 0) return false;
    const auto it = seen_.find(keyOf(work));
    return it != seen_.end() && it->second.toc <= work.start;
  }

  /// Whether a pair with a shape or a cell is proved apart without the turns that change
  /// no distance. Most pairs need one step then.
  bool areCalmlyApart(const PartWork& work, double end) {
    constexpr int kMostSteps = 8;
    const MovingConvex x = movingConvexOf(calm_.body(0), ~work.a.child),
                       y = movingConvexOf(calm_.body(1), ~work.b.child);
    ConvexAdvance pair(x, y, work.start, end, calm_tolerance_);
    pair.suggest(last_direction_);
    double t = work.start;
    int left = kMostSteps;
    const auto answer = pair.advance(t, end, left, counts_);
    if (maxNorm(pair.lastDirection()) > 0) last_direction_ = pair.lastDirection();
    if (answer != TriangleAdvance::Answer::kApart) return false;
    ++counts_.triangle_pairs;
    return true;
  }

  /// Advances a pair of triangles, shapes or cells of an octree.
  void advance(const PartWork& work) {
    if (touchedBefore(work)) return;
    const MovingBody &a = body(0), &b = body(1);
    const std::int32_t place[2] = {~work.a.child, ~work.b.child};
    const double end = std::min(work.t1, latest_);
    assert(work.start <= end);
    if (!a.isMesh() || !b.isMesh()) {
      const MovingConvex x = movingConvexOf(a, place[0]), y = movingConvexOf(b, place[1]);
      const std::int32_t index[2] = {indexOf(x), indexOf(y)};
      if (calm_.areCalmer() && work.steps == 0 && areCalmlyApart(work, end)) return;
      ConvexAdvance pair(x, y, work.start, end, tolerance_);
      pair.suggest(last_direction_);
      pair.continueAfter(stepsBefore(work));
      if (options_.ignores_initially_closer) pair.ignoreInitiallyCloser();
      advance(work, index, end, pair);
      if (maxNorm(pair.lastDirection()) > 0) last_direction_ = pair.lastDirection();
      return;
    }
    const BodyTriangle x = a.triangle(place[0]), y = b.triangle(place[1]);
    if (!mayTouch(x, y)) return;
    TriangleAdvance pair(a.path(), x, b.path(), y, work.start, end, tolerance_);
    CurvedContact* contact = advance(work, {x.index, y.index}, end, pair);
    if (contact) contact->nearest = pair.nearest();
  }

  /// @return the contact, if there is one; valid until the next call
  template <typename Pair>
  CurvedContact* advance(PartWork work, const std::int32_t (&index)[2], double end,
                         Pair& pair) {
    if (!accepts(index[0], index[1])) return nullptr;
    if (work.steps == 0) ++counts_.triangle_pairs;
    const double t_stop = std::min(end, works_.nextTurn(work));
    PairOfManySpans* const known = manySpansOf(work);
    int& steps = stepsOf(work, known);
    const int all = std::max(options_.max_steps - steps, 0),
              most = isBentAlike() ? all : std::min(all, kMostStepsInSpan);
    int left = most;
    [[maybe_unused]] const double before = work.start;
    const auto answer = pair.advance(work.start, t_stop, left, counts_);
    assert(before <= work.start && work.start <= end);
    steps += most - left;
    setPartingDirection(pair, answer, work.start);
    if (answer == TriangleAdvance::Answer::kApart) return nullptr;
    if (answer == TriangleAdvance::Answer::kOpen && (left > 0 || most < all)) {
      work.steps = steps;
      if (left > 0)
        push(work);
      else
        pushHalves(work);
      return nullptr;
    }
    if (known) known->toc = std::min(known->toc, work.start);
    CurvedContact contact{};
    contact.place[0] = ~work.a.child;
    contact.place[1] = ~work.b.child;
    for (int k = 0; k < 2; ++k)
      contact.triangle[k] = body(k).octree() ? contact.place[k] : index[k];
    contact.toc_lo = contact.toc_hi = work.start;
    contact.certainty = ContactCertainty::kGivenUp;
    if (answer == TriangleAdvance::Answer::kContact) {
      if (options_.proves_contacts)
        contact.toc_hi = pair.proveContact(
            work.start,
            TriangleAdvance::bracketWidth(work.start, options_.toc_err, options_.t_max));
      contact.certainty = contact.toc_hi > contact.toc_lo
                              ? ContactCertainty::kCrossing
                              : ContactCertainty::kWithinTolerance;
    }
    assert(0 <= contact.toc_lo && contact.toc_lo <= contact.toc_hi);
    assert(contact.toc_hi <= 1);
    contacts_.push_back(contact);
    if (!options_.all) {
      latest_ = std::min(latest_, contact.toc_lo);
      works_.keepEarlier(latest_);
    }
    return &contacts_.back();
  }

  /// Sorts the contacts. A pair of triangles may have been found in several spans; its
  /// first contact is kept. A first-contact query keeps the first of all.
  CurvedAnswer finish() {
    CurvedAnswer answer;
    answer.counts = counts_;
    answer.touching = tolerance_.touching;
    answer.is_cut = isCut();
    const auto isLess = [](const CurvedContact& x, const CurvedContact& y) {
      if (x.triangle[0] != y.triangle[0]) return x.triangle[0] < y.triangle[0];
      if (x.triangle[1] != y.triangle[1]) return x.triangle[1] < y.triangle[1];
      return x.toc_lo < y.toc_lo;
    };
    const auto isSame = [](const CurvedContact& x, const CurvedContact& y) {
      return x.triangle[0] == y.triangle[0] && x.triangle[1] == y.triangle[1];
    };
    std::sort(contacts_.begin(), contacts_.end(), isLess);
    contacts_.erase(std::unique(contacts_.begin(), contacts_.end(), isSame),
                    contacts_.end());
    std::sort(contacts_.begin(), contacts_.end(), isEarlierContact);
    if (!options_.all && contacts_.size() > 1) contacts_.resize(1);
    answer.contacts = std::move(contacts_);
    return answer;
  }

  const CurvedOptions& options_;
  const MovingBody* body_[2];
  /// What boxes are compared of, and pairs with shapes first. Contacts are those of the
  /// bodies themselves.
  CalmBodies calm_;
  BodyTolerance tolerance_, calm_tolerance_;
  PartWindows windows_;
  PartDivision division_;
  PartingDirection parting_;
  /// The latest time that matters.
  double latest_;
  PartWorkQueue works_;
  /// That parted the last pair with a shape or a cell. Others beside it have about the
  /// same.
  Vec last_direction_{0, 0, 0};
  /// The number of times at which a contact was looked for.
  std::size_t num_looks_{0};
  /// The number of pairs that did not touch earlier than the contact that was found.
  int num_apart_{0};
  /// The pairs that are advanced in many spans.
  std::unordered_map<std::uint64_t, PairOfManySpans> seen_;
  /// PartWork::halves.
  std::vector<int> steps_of_halves_;
  std::vector<CurvedContact> contacts_;
  AdvanceCounts counts_;
};

}  // namespace

BodiesNearOrigin::BodiesNearOrigin(const MovingBody& from_a, const MovingBody& from_b)
    : a(from_a), b(from_b) {
  const Pose pose_a = a.path().pose(0), pose_b = b.path().pose(0);
  for (int k = 0; k < 3; ++k)
    origin[k] = 0.5 * pose_a.translation[k] + 0.5 * pose_b.translation[k];
  a.path().shift(origin);
  b.path().shift(origin);
}

CurvedOptions curvedOptionsOf(const MovingBody& a, const MovingBody& b,
                              const QueryOptions& options) {
  const bool are_meshes = a.isMesh() && b.isMesh(),
             all = options.query == ContinuousQuery::kAll;
  CurvedOptions wanted;
  wanted.toc_err = options.toc_err;
  // The first contact of triangles may be one to ignore.
  wanted.all = all || (are_meshes && options.ignores_initially_closer);
  wanted.any = options.query == ContinuousQuery::kAny && !options.only_time &&
               !options.ignores_initially_closer;
  // The contacts of features are proved.
  wanted.proves_contacts = !are_meshes || !wanted.all;
  wanted.t_max = options.t_max;
  wanted.distance = options.min_distance;
  wanted.ignores_initially_closer = !are_meshes && options.ignores_initially_closer;
  assert(0 <= wanted.t_max && wanted.t_max <= 1 && wanted.distance >= 0);
  if (all) wanted.num_threads = options.num_threads;
  wanted.rules = options.filter ? &options.filter->rules() : nullptr;
  // Features are advanced by directions that turn, which takes fewer steps.
  if (are_meshes && options.min_distance > 0) wanted.max_steps = 256;
  return wanted;
}

CurvedAnswer queryCurved(const MovingBody& a, const MovingBody& b,
                         const CurvedOptions& options) {
  const BodiesNearOrigin near(a, b);
  return CurvedTraversal(near.a, near.b, options).run();
}

std::vector<NearTriangles> nearTriangles(const MovingBody& a, const MovingBody& b,
                                         double distance) {
  CurvedOptions options;
  options.all = true;
  options.distance = distance;
  return CurvedTraversal(a, b, options).nearTriangles();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

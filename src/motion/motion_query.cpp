// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion_query.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "motion/convex_advance.h"
#include "motion/flat_windows.h"
#include "motion/motion_work.h"
#include "motion/parting_direction.h"
#include "motion/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kUnitRounding = 0x1p-53;

/// Stores the poses of a body, since the same times are needed again.
class PoseTable {
 public:
  explicit PoseTable(const MotionPath& path) : path_(path) {
    std::fill(time_, time_ + kSlots, -1.);
  }
  const Pose& at(double t) {
    std::uint64_t bits;
    std::memcpy(&bits, &t, sizeof(bits));
    const std::size_t slot = (bits * 0x9e3779b97f4a7c15u) >> (64 - kBits);
    if (time_[slot] != t) {
      pose_[slot] = path_.pose(t);
      time_[slot] = t;
    }
    return pose_[slot];
  }

 private:
  static constexpr int kBits = 7;
  static constexpr std::size_t kSlots = std::size_t{1} << kBits;
  const MotionPath& path_;
  double time_[kSlots];
  Pose pose_[kSlots];
};

/// The data of a body in a traversal.
struct Side {
  explicit Side(const MotionBody& b)
      : body(b),
        flat(b.shape() ? b.shape()->flat() : nullptr),
        reader(b),
        poses(b.path()),
        goes_straight(goesStraight(b.path())),
        axis(b.path().axis()),
        axis_acceleration(axis ? b.path().axisAcceleration(b.displacement()) : 0) {}

  /// Whether all points go straight, also those of a mesh that deforms.
  static bool goesStraight(const MotionPath& path) {
    const AccelerationBound bound = path.acceleration(0, 1);
    return bound.isZero() && bound.per_displacement == 0;
  }

  SpanPoses spanPoses(double t0, double t1) {
    return {poses.at(t0), poses.at(0.5 * (t0 + t1)), poses.at(t1)};
  }

  const MotionBody& body;
  /// Null: the body is no plane or halfspace.
  const FlatShape* flat;
  MotionBodyReader reader;
  PoseTable poses;
  bool goes_straight;
  /// About which the body turns; null: there is none.
  const Vec* axis;
  /// Bound on the acceleration of a point along it.
  double axis_acceleration;
};

bool isEarlierContact(const MotionContact& x, const MotionContact& y) {
  if (x.toc_lo != y.toc_lo) return x.toc_lo < y.toc_lo;
  if (x.triangle[0] != y.triangle[0]) return x.triangle[0] < y.triangle[0];
  return x.triangle[1] < y.triangle[1];
}

/// The largest power of two that is at most a quarter of x.
double quarterUnit(double x) {
  int exponent;
  std::frexp(x, &exponent);
  return std::ldexp(1., std::max(exponent - 3, -60));
}

class MotionTraversal {
 public:
  MotionTraversal(const MotionBody& a, const MotionBody& b,
                  const MotionQueryOptions& options)
      : side_{Side(a), Side(b)},
        options_(options),
        tolerance_(a, b, options.distance),
        parting_(a, b, tolerance_),
        axes_share_(shareAlong(side_[0].axis, side_[1])),
        apart_(a.isMesh() && b.isMesh() ? options.distance : 0),
        latest_(options.last),
        works_(!options.all) {
    // A kernel adds up no more than a hundred roundings of the sizes, and a time is
    // rounded by a few u.
    rounding_ = tolerance_.position + 0x1p-44 * (a.size() + b.size()) +
                16 * kUnitRounding * (a.speed() + b.speed());
    box_margin_ = options.distance + rounding_;
    direction_bound_ = (1 + 0x1p-10) * std::max(a.path().stretch(), b.path().stretch());
  }

  MotionAnswer run() {
    traverse([this](const MotionWork& work) { advance(work); });
    return finish();
  }

  std::vector<NearTriangles> nearTriangles() {
    std::vector<NearTriangles> near;
    traverse([&near](const MotionWork& work) {
      near.push_back({{~work.a.child, ~work.b.child}, work.t0, work.t1});
    });
    return near;
  }

 private:
  /// Calls visit(work) for pairs of triangles, in the order of their starts.
  template <typename Visit>
  void traverse(Visit&& visit) {
    testAlone({0, 0, 1, side_[0].body.root(), side_[1].body.root(), 0, 0});
    while (!works_.isEmpty()) {
      MotionWork work = works_.pop();
      if (isTooLate(work)) break;
      if (areKeptApart(work)) continue;
      if (work.a.isTriangle() && work.b.isTriangle())
        visit(work);
      else
        divide(work);
    }
  }

  /// Whether nothing in it can be earlier than a contact that was found.
  bool isTooLate(const MotionWork& work) const {
    if (options_.all || contacts_.empty()) return work.start > latest_;
    return work.start >= latest_;
  }

  void push(const MotionWork& work) {
    if (!isTooLate(work)) works_.push(work);
  }

  /// The box of a part at a time.
  MotionBox boxAt(const MotionBody& body, const BodyPart& part, double t) const {
    MotionBox box = body.box(part, 0);
    if (!body.isRigid()) interpolate(body.box(part, 1), t, box);
    return box;
  }

  static void interpolate(const MotionBox& end, double t, MotionBox& box) {
    for (int k = 0; k < 3; ++k) {
      box.center[k] = (1 - t) * box.center[k] + t * end.center[k];
      box.extent[k] = (1 - t) * box.extent[k] + t * end.extent[k];
    }
    box.radius = (1 - t) * box.radius + t * end.radius;
  }

  /// A part of a body during a span.
  struct PartSpan {
    /// At both ends.
    MotionBox box[2];
    /// The largest deviation of its points from straight lines.
    double deviation;
  };

  static double accelerationOf(const AccelerationBound& bound, const MotionBox& begin,
                               const MotionBox& end) {
    return bound.between(vecOf(begin.center), vecOf(end.center),
                         std::max(begin.radius, end.radius)) +
           bound.per_displacement * begin.displacement;
  }

  PartSpan partSpan(int k, const BodyPart& part, double t0, double t1) {
    const MotionBody& body = side_[k].body;
    const double dt = t1 - t0;
    PartSpan span;
    span.box[0] = boxAt(body, part, t0);
    span.box[1] = body.isRigid() ? span.box[0] : boxAt(body, part, t1);
    span.deviation = 0;
    if (side_[k].flat)
      span.deviation = flatDeviation(k, t0, t1);
    else if (!side_[k].goes_straight)
      span.deviation =
          0.125 * dt * dt *
          accelerationOf(body.path().acceleration(t0, t1), span.box[0], span.box[1]);
    return span;
  }

  /// How far the height of a point above a flat deviates from a straight line, less what
  /// the acceleration of the point adds: see ConvexPairMotion::inBody().
  double flatDeviation(int k, double t0, double t1) {
    Side &side = side_[k], &other = side_[1 - k];
    const double dt = t1 - t0, middle = 0.5 * (t0 + t1);
    const Vec foot = side.flat->foot();
    const MotionBox root = boxAt(other.body, other.body.root(), middle);
    const MotionPath& path = side.body.path();
    const double speed = other.body.speed() + path.speed(norm(foot)),
                 apart = norm(posed(other.poses.at(middle), vecOf(root.center)) -
                              posed(side.poses.at(middle), foot)) +
                         direction_bound_ * (root.radius + root.pad) + 0.5 * dt * speed;
    const AccelerationBound bound = path.acceleration(t0, t1);
    return 0.125 * dt * dt * direction_bound_ *
           (bound.of(foot, 0) + bound.of({0, 0, 0}, apart) +
            2 * path.turnSpeed() * speed);
  }

  /// The radius of a part, with the margin around the core of a shape.
  double sizeOf(int k, const PartSpan& span) const {
    if (side_[k].flat) return HUGE_VAL;
    const MotionBody& body = side_[k].body;
    return std::max(span.box[0].radius, span.box[1].radius) +
           (body.shape() ? body.shape()->radius() : 0);
  }

  /// Tests the pair in its span, and adds the parts that may overlap.
  void testAlone(const MotionWork& work) {
    const int many = side_[1].flat ? 0 : 1;
    const MotionBody& body = side_[many].body;
    const BodyPart &part = many == 1 ? work.b : work.a,
                   &other = many == 1 ? work.a : work.b;
    MotionNode node;
    node.count = 1;
    for (int frame = 0; frame < (body.isRigid() ? 1 : 2); ++frame) {
      const MotionBox box = body.box(part, frame);
      for (int lane = 0; lane < MotionBoxes::kWidth; ++lane)
        node.box[frame].set(lane, box);
    }
    std::fill(node.part, node.part + MotionBoxes::kWidth, part);
    test(work, many, node, partSpan(1 - many, other, work.t0, work.t1));
  }

  /// The node's boxes at a time.
  const MotionBoxes* boxesAt(const MotionBody& body, const MotionNode& node, double t,
                             MotionBoxes& scratch) const {
    if (body.isRigid() || t == 0) return &node.box[0];
    if (t == 1) return &node.box[1];
    scratch = node.box[0];
    for (int lane = 0; lane < MotionBoxes::kWidth; ++lane) {
      for (int k = 0; k < 3; ++k) {
        scratch.center[k][lane] =
            (1 - t) * scratch.center[k][lane] + t * node.box[1].center[k][lane];
        scratch.extent[k][lane] =
            (1 - t) * scratch.extent[k][lane] + t * node.box[1].extent[k][lane];
      }
      scratch.radius[lane] =
          (1 - t) * scratch.radius[lane] + t * node.box[1].radius[lane];
    }
    return &scratch;
  }

  /// The acceleration of a box of a node. Both ends are the same if the body is rigid.
  static double laneAcceleration(const AccelerationBound& bound, const MotionBoxes& begin,
                                 const MotionBoxes& end, int lane) {
    if (&begin != &end || bound.motion)
      return accelerationOf(bound, begin.get(lane), end.get(lane));
    return bound.of({begin.center[0][lane], begin.center[1][lane], begin.center[2][lane]},
                    begin.radius[lane]);
  }

  /// How far the points of both bodies may be from straight lines, with padding and
  /// rounding: along all directions, and along the axes about which the bodies turn.
  struct Margins {
    double all[MotionBoxes::kWidth];
    CalmDirection axis[2];
  };

  /// The share of a body's deviation that it has along a unit direction: all of its
  /// acceleration is at right angles to the axis about which it turns.
  static double shareAlong(const Vec* direction, const Side& side) {
    if (!direction || !side.axis) return 1;
    return std::min(norm(cross(*direction, *side.axis)) + 0x1p-48, 1.);
  }

  /// The same along the normal of a flat, which may turn.
  static double shareAlongFlat(const MotionWork& work, Side& flat, const Side& side) {
    const double turn = flat.body.path().turnSpeed() * (work.t1 - work.t0);
    if (!side.axis || turn > 1) return 1;
    const Vec normal = rotated(flat.poses.at(work.t0).rotation, flat.flat->normal);
    return std::min(shareAlong(&normal, side) + turn, 1.);
  }

  /// Sets the margins of a node's boxes.
  /// @param other  the part of the other side
  void setMargins(const MotionWork& work, Side& one, const PartSpan& other, Side& many,
                  const MotionBoxes* const (&boxes)[2], int count, Margins& out) {
    out = {};
    out.axis[0].direction = one.axis;
    out.axis[1].direction = many.axis;
    const double dt = work.t1 - work.t0, share = direction_bound_ * 0.125 * dt * dt,
                 of_other = direction_bound_ * other.deviation;
    const double axis_one = share * one.axis_acceleration,
                 axis_many = share * many.axis_acceleration,
                 flat_share = one.flat ? shareAlongFlat(work, one, many) : 1;
    AccelerationBound bound{};
    if (!many.goes_straight) bound = many.body.path().acceleration(work.t0, work.t1);
    for (int lane = 0; lane < count; ++lane) {
      const double still =
          direction_bound_ * (other.box[0].pad + box_margin_ + boxes[0]->pad[lane]);
      double deviation = 0;
      if (!many.goes_straight)
        deviation = share * laneAcceleration(bound, *boxes[0], *boxes[1], lane);
      out.axis[0].margin[lane] = still + axis_one + (axes_share_ * deviation + axis_many);
      out.axis[1].margin[lane] = still + axis_many + (axes_share_ * of_other + axis_one);
      out.all[lane] = still + (of_other + (flat_share * deviation + axis_many));
    }
  }

  /// Tests the children of one side's part against the other side's part.
  /// @param opened  the side whose children they are
  /// @param other  the part of the other side
  void test(const MotionWork& work, int opened, const MotionNode& node,
            const PartSpan& other) {
    // A node of an octree may be occupied while none of its children is.
    if (node.count == 0) return;
    Side& one = side_[1 - opened];
    Side& many = side_[opened];
    const double dt = work.t1 - work.t0;
    MotionBoxes scratch[2];
    const MotionBoxes* boxes[2] = {boxesAt(many.body, node, work.t0, scratch[0]),
                                   boxesAt(many.body, node, work.t1, scratch[1])};
    Margins margin;
    setMargins(work, one, other, many, boxes, node.count, margin);
    MeetingWindows windows;
    const SpanPoses pose_one = one.spanPoses(work.t0, work.t1),
                    pose_many = many.spanPoses(work.t0, work.t1);
    if (one.flat)
      flatWindows(*one.flat, pose_one, boxes, pose_many, margin.all, node.count, windows);
    else
      motionKernels().meetingWindows(other.box, pose_one, boxes, pose_many, margin.all,
                                     margin.axis, node.count, windows);
    counts_.box_tests += static_cast<std::uint64_t>(node.count);
    for (unsigned left = windows.mask; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      if (one.body.shape() && !one.flat && !one.body.shape()->fillsBox() &&
          !narrowByShape(opened, work, boxes, lane, margin.all[lane], windows))
        continue;
      MotionWork child = work;
      (opened == 1 ? child.b : child.a) = node.part[lane];
      child.start = std::max(work.start, work.t0 + windows.lo[lane] * dt);
      const double end = std::min(work.t1, work.t0 + windows.hi[lane] * dt);
      if (child.start > end) continue;
      setSpan(end, child);
      push(child);
    }
  }

  /// From the center of a shape to that of a box.
  static Vec towardsBox(const ConvexShape& shape, const Pose& pose_shape,
                        const MotionBox& box, const Pose& pose_box) {
    return posed(pose_box, vecOf(box.center)) - posed(pose_shape, shape.center());
  }

  /// Shortens the window of a box that may overlap the box of a shape, by the direction
  /// that parts the shape itself from the box in the middle of the span.
  /// @return whether they may overlap
  bool narrowByShape(int opened, const MotionWork& work,
                     const MotionBoxes* const (&boxes)[2], int lane, double margin,
                     MeetingWindows& windows) {
    const SpanPoses poses[2] = {side_[1 - opened].spanPoses(work.t0, work.t1),
                                side_[opened].spanPoses(work.t0, work.t1)};
    const MotionBox begin = boxes[0]->get(lane), end = boxes[1]->get(lane);
    MotionBox middle = begin;
    interpolate(end, 0.5, middle);
    const ConvexShape* shape = side_[1 - opened].body.shape();
    const auto posedShape = [&](const Pose& pose) -> PosedConvex {
      return {shape, nullptr, pose, {}};
    };
    const auto posedBox = [](const MotionBox& box, const Pose& pose) -> PosedConvex {
      return {nullptr, &box, pose, {}};
    };
    const Vec n =
        convexGap(posedShape(poses[0].middle), posedBox(middle, poses[1].middle),
                  towardsBox(*shape, poses[0].middle, middle, poses[1].middle), margin,
                  margin)
            .direction;
    const auto gap = [&](const PosedConvex& of_shape, const PosedConvex& of_box) {
      return -of_box.reach(-1. * n) - of_shape.reach(n) - margin;
    };
    const double first = gap(posedShape(poses[0].beginning),
                             posedBox(begin, poses[1].beginning)),
                 last = gap(posedShape(poses[0].end), posedBox(end, poses[1].end));
    return narrowWindow(first, last, windows.lo[lane], windows.hi[lane]);
  }

  /// The span of a piece of work: that of its parent, cut to [start, end], with ends that
  /// are dyadic so that poses are used again.
  static void setSpan(double end, MotionWork& work) {
    if (work.a.isTriangle() && work.b.isTriangle()) {
      work.t0 = work.start;
      work.t1 = end;
      return;
    }
    const double unit = quarterUnit(end - work.start);
    work.t0 = std::max(work.t0, std::floor(work.start / unit) * unit);
    work.t1 = std::min(work.t1, std::ceil(end / unit) * unit);
  }

  void divide(MotionWork& work) {
    // In the shortest span the deviation is 2^-43 of the acceleration.
    constexpr double kShortest = 0x1p-20, kMostDeviation = 0.25, kLeastShare = 0x1p-6;
    work.t1 = std::min(work.t1, std::max(latest_, work.t0));
    const PartSpan span[2] = {partSpan(0, work.a, work.t0, work.t1),
                              partSpan(1, work.b, work.t0, work.t1)};
    const double radius[2] = {sizeOf(0, span[0]), sizeOf(1, span[1])};
    const int opened =
        work.a.isTriangle() || (!work.b.isTriangle() && radius[1] > radius[0]) ? 1 : 0;
    // Small meshes that are within the distance still are in half of the span. Nothing is
    // gained where rounding is larger than both parts.
    const double least = std::max(std::min(radius[0], radius[1]),
                                  kLeastShare * std::max(radius[opened], apart_));
    if (work.t1 - work.t0 > kShortest && least > rounding_ &&
        span[0].deviation + span[1].deviation > kMostDeviation * least)
      return halve(work);
    test(work, opened, side_[opened].reader.open(opened == 1 ? work.b : work.a),
         span[1 - opened]);
  }

  void halve(const MotionWork& work) {
    const double middle = 0.5 * (work.t0 + work.t1);
    MotionWork half = work;
    half.t1 = middle;
    if (half.start < middle) testAlone(half);
    half = work;
    half.t0 = middle;
    half.start = std::max(half.start, middle);
    testAlone(half);
  }

  /// Whether a free point meets a free edge or another one: they do at a distance only.
  static bool areFreeOfTouch(const BodyTriangle& a, const BodyTriangle& b) {
    return a.isFree() && b.isFree() && (a.isFreePoint() || b.isFreePoint());
  }

  /// Whether the direction of the contact that was found keeps the parts apart until
  /// then. The points and cells of a part may be apart where its box, which is padded by
  /// more than the tolerance, is not.
  bool areKeptApart(const MotionWork& work) {
    if (options_.all || contacts_.empty() || !works_.isLong()) return false;
    const double end = std::min(work.t1, latest_);
    double gap[2];
    if (!parting_.areApart(work.a, work.b, {work.start, end}, gap)) return false;
    const double deviation = partSpan(0, work.a, work.start, end).deviation +
                             partSpan(1, work.b, work.start, end).deviation;
    return staysPositive(gap, direction_bound_ * deviation);
  }

  /// Takes the direction of a contact. Other pairs may touch at the same time in another
  /// direction, so now and then that of a pair that does not touch earlier.
  template <typename Pair>
  void setPartingDirection(const Pair& pair, TrianglePairMotion::Answer answer,
                           double t) {
    constexpr int kOften = 4;
    if (options_.all) return;
    if (answer != TrianglePairMotion::Answer::kContact &&
        (contacts_.empty() || !works_.isLong() || ++num_apart_ % kOften != 0))
      return;
    parting_.set(pair.directionAt(t));
  }

  /// Advances a pair of triangles, shapes or cells of an octree.
  void advance(const MotionWork& work) {
    const MotionBody &a = side_[0].body, &b = side_[1].body;
    const std::int32_t place[2] = {~work.a.child, ~work.b.child};
    const double end = std::min(work.t1, latest_);
    if (!a.isMesh() || !b.isMesh()) {
      const MovingConvex x = movingConvexOf(a, place[0]), y = movingConvexOf(b, place[1]);
      const std::int32_t index[2] = {a.isMesh() ? x.triangle.index : kNoTriangle,
                                     b.isMesh() ? y.triangle.index : kNoTriangle};
      ConvexPairMotion pair(x, y, work.start, end, tolerance_);
      if (options_.ignores_initially_closer) pair.ignoreInitiallyCloser();
      advance(work, index, end, pair);
      return;
    }
    const BodyTriangle x = a.triangle(place[0]), y = b.triangle(place[1]);
    if (!(options_.distance > 0) && areFreeOfTouch(x, y)) return;
    TrianglePairMotion pair(a.path(), x, b.path(), y, work.start, end, tolerance_);
    MotionContact* contact = advance(work, {x.index, y.index}, end, pair);
    if (contact) contact->nearest = pair.nearest();
  }

  /// @return the contact, if there is one; valid until the next call
  template <typename Pair>
  MotionContact* advance(MotionWork work, const std::int32_t (&index)[2], double end,
                         Pair& pair) {
    if (options_.rules && !options_.rules->accept(index[0], index[1])) return nullptr;
    if (work.steps == 0) ++counts_.triangle_pairs;
    const double last =
        options_.all || work.dive > 0 || works_.isEmpty() ? end : works_.nextStart();
    int left = options_.max_steps - work.steps;
    const auto answer = pair.advance(work.start, last, left, counts_);
    setPartingDirection(pair, answer, work.start);
    if (answer == TrianglePairMotion::Answer::kApart) return nullptr;
    if (answer == TrianglePairMotion::Answer::kOpen && left > 0) {
      work.steps = options_.max_steps - left;
      push(work);
      return nullptr;
    }
    MotionContact contact{};
    contact.place[0] = ~work.a.child;
    contact.place[1] = ~work.b.child;
    for (int k = 0; k < 2; ++k)
      contact.triangle[k] = side_[k].body.octree() ? contact.place[k] : index[k];
    contact.toc_lo = contact.toc_hi = work.start;
    contact.certainty = MotionCertainty::kGivenUp;
    if (answer == TrianglePairMotion::Answer::kContact) {
      if (options_.proves_contacts)
        contact.toc_hi = pair.proveContact(
            work.start, TrianglePairMotion::bracketWidth(work.start, options_.toc_err,
                                                         options_.last));
      contact.certainty = contact.toc_hi > contact.toc_lo
                              ? MotionCertainty::kCrossing
                              : MotionCertainty::kWithinTolerance;
    }
    contacts_.push_back(contact);
    if (work.dive > 0) works_.endDive();
    if (!options_.all) latest_ = std::min(latest_, contact.toc_lo);
    return &contacts_.back();
  }

  /// Sorts the contacts. A pair of triangles may have been found in several spans; its
  /// first contact is kept. A first-contact query keeps the first of all.
  MotionAnswer finish() {
    MotionAnswer answer;
    answer.counts = counts_;
    answer.touching = tolerance_.touching;
    const auto isLess = [](const MotionContact& x, const MotionContact& y) {
      if (x.triangle[0] != y.triangle[0]) return x.triangle[0] < y.triangle[0];
      if (x.triangle[1] != y.triangle[1]) return x.triangle[1] < y.triangle[1];
      return x.toc_lo < y.toc_lo;
    };
    const auto isSame = [](const MotionContact& x, const MotionContact& y) {
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

  Side side_[2];
  const MotionQueryOptions& options_;
  MotionTolerance tolerance_;
  PartingDirection parting_;
  /// The share of a body's deviation that it has along the axis of the other one.
  double axes_share_;
  /// The distance at which meshes are in contact.
  double apart_;
  /// Bound on the rounding of the distance of two boxes.
  double rounding_;
  double box_margin_;
  double direction_bound_;
  /// The latest time that matters.
  double latest_;
  MotionWorkQueue works_;
  /// The number of pairs that did not touch earlier than the contact that was found.
  int num_apart_{0};
  std::vector<MotionContact> contacts_;
  MotionCounts counts_;
};

}  // namespace

BodiesNearOrigin::BodiesNearOrigin(const MotionBody& from_a, const MotionBody& from_b)
    : a(from_a), b(from_b) {
  const Pose pose_a = a.path().pose(0), pose_b = b.path().pose(0);
  for (int k = 0; k < 3; ++k)
    origin[k] = 0.5 * pose_a.translation[k] + 0.5 * pose_b.translation[k];
  a.path().shift(origin);
  b.path().shift(origin);
}

MotionAnswer queryMotions(const MotionBody& a, const MotionBody& b,
                          const MotionQueryOptions& options) {
  const BodiesNearOrigin near(a, b);
  return MotionTraversal(near.a, near.b, options).run();
}

std::vector<NearTriangles> nearTriangles(const MotionBody& a, const MotionBody& b,
                                         double distance) {
  MotionQueryOptions options;
  options.all = true;
  options.distance = distance;
  return MotionTraversal(a, b, options).nearTriangles();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion_query.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "base/parallel.h"
#include "motion/convex_advance.h"
#include "motion/flat_windows.h"
#include "motion/motion_side.h"
#include "motion/motion_work.h"
#include "motion/parting_direction.h"
#include "motion/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kUnitRounding = 0x1p-53;

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
      : side_{MotionSide(a), MotionSide(b)},
        options_(options),
        tolerance_(a, b, options.distance),
        parting_(a, b, tolerance_),
        axes_share_(side_[0].axis ? side_[1].shareAlong(*side_[0].axis) : 1),
        apart_(a.isMesh() && b.isMesh() ? options.distance : 0),
        latest_(options.last),
        works_(options.all ? MotionWorkQueue::Order::kAny
                           : MotionWorkQueue::Order::kEarliestFirst) {
    // A kernel adds up no more than a hundred roundings of the sizes, and a time is
    // rounded by a few u.
    rounding_ = tolerance_.position + 0x1p-44 * (a.size() + b.size()) +
                16 * kUnitRounding * (a.speed() + b.speed());
    box_margin_ = options.distance + rounding_;
    direction_bound_ =
        (1 + 0x1p-10) * std::max({1., a.path().stretch(), b.path().stretch()});
  }

  MotionAnswer run() {
    const auto advance = [this](const MotionWork& work) { this->advance(work); };
    begin();
    const bool is_for_tasks = isForTasks();
    while (!works_.isEmpty() && !isCut() && !(is_for_tasks && isLong()))
      step(works_.pop(), advance);
    if (is_for_tasks && !works_.isEmpty()) runTasks(pieces());
    return finish();
  }

  std::vector<NearTriangles> nearTriangles() {
    std::vector<NearTriangles> near;
    begin();
    traverse([&near](const MotionWork& work) {
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
    const bool has_shape = side_[0].body.shape() || side_[1].body.shape();
    return counts_.box_tests + (has_shape ? kPerStepOfShape : kPerStep) * counts_.steps >
           kMost;
  }

  void begin() { testAlone({0, 0, 1, side_[0].body.root(), side_[1].body.root(), 0, 0}); }

  /// Calls visit(work) for pairs of triangles.
  template <typename Visit>
  void traverse(Visit&& visit) {
    while (!works_.isEmpty()) step(works_.pop(), visit);
  }

  template <typename Visit>
  void step(MotionWork work, Visit&& visit) {
    if (areKeptApart(work)) return;
    if (isPair(work))
      visit(work);
    else
      divide(work);
  }

  static bool isPair(const MotionWork& work) {
    return work.a.isTriangle() && work.b.isTriangle();
  }

  bool isCut() const { return counts_.box_tests > options_.most_box_tests; }

  /// Whether the work may be done in any order and by several threads. The cells of an
  /// octree are numbered as they are met.
  bool isForTasks() const {
    return options_.all && options_.most_box_tests == MotionQueryOptions::kNoLimit &&
           !side_[0].body.octree() && !side_[1].body.octree();
  }

  /// Divides the work that is left, the first first: the largest parts as a rule.
  std::vector<MotionWork> pieces() {
    std::vector<MotionWork> pairs;
    std::deque<MotionWork> waiting;
    const auto take = [&] {
      for (const MotionWork& work : works_.takeAll()) waiting.push_back(work);
    };
    for (take(); !waiting.empty() && pairs.size() + waiting.size() < kPieces; take()) {
      MotionWork work = waiting.front();
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
  void runTasks(const std::vector<MotionWork>& pieces) {
    struct Found {
      std::vector<MotionContact> contacts;
      MotionCounts counts;
    };
    std::vector<Found> found(std::min(kTasks, pieces.size()));
    parallelFor(found.size(), options_.num_threads, [&](std::size_t number) {
      // It is too large for the stack of a small thread.
      const auto task =
          std::make_unique<MotionTraversal>(side_[0].body, side_[1].body, options_);
      for (std::size_t i = number; i < pieces.size(); i += found.size()) {
        task->push(pieces[i]);
        task->traverse([&](const MotionWork& work) { task->advance(work); });
      }
      found[number] = {std::move(task->contacts_), task->counts_};
    });
    for (const Found& part : found) {
      contacts_.insert(contacts_.end(), part.contacts.begin(), part.contacts.end());
      counts_ += part.counts;
    }
  }

  /// Nothing that starts at the time of a contact can be earlier than it.
  void push(const MotionWork& work) {
    const bool is_late =
        options_.all || contacts_.empty() ? work.start > latest_ : work.start >= latest_;
    if (!is_late) works_.push(work);
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
    /// At t = 0 and t = 1. Of a rigid body only the first one is set.
    MotionBox frame[2];
    /// The largest deviation of its points from straight lines.
    double deviation;
  };

  PartSpan partSpan(int k, const BodyPart& part, double t0, double t1) {
    MotionSide& side = side_[k];
    const double dt = t1 - t0;
    PartSpan span;
    span.frame[0] = side.body.box(part, 0);
    if (!side.body.isRigid()) span.frame[1] = side.body.box(part, 1);
    span.deviation = 0;
    if (side.flat)
      span.deviation = flatDeviation(k, t0, t1);
    else if (!side.goes_straight)
      span.deviation =
          0.125 * dt * dt * side.accelerationOf(span.frame[0], span.frame[1], t0, t1);
    return span;
  }

  /// How far the height of a point above a flat deviates from a straight line, less what
  /// the acceleration of the point adds: see ConvexPairMotion::inBody().
  double flatDeviation(int k, double t0, double t1) {
    MotionSide &side = side_[k], &other = side_[1 - k];
    const double dt = t1 - t0, middle = 0.5 * (t0 + t1);
    const Vec foot = side.flat->foot();
    const MotionBox root = boxAt(other.body, other.body.root(), middle);
    const MotionPath& path = side.body.path();
    const double speed = other.body.speed() + path.speed(norm(foot)),
                 apart = norm(posed(other.poses.at(middle), vecOf(root.center)) -
                              posed(side.poses.at(middle), foot)) +
                         direction_bound_ * (root.radius + root.pad) + 0.5 * dt * speed;
    const AccelerationBound& bound = side.acceleration(t0, t1);
    return 0.125 * dt * dt * direction_bound_ *
           (bound.of(foot, 0) + bound.of({0, 0, 0}, apart) +
            2 * path.turnSpeed() * speed);
  }

  /// The radius of a part, with the margin around the core of a shape.
  double sizeOf(int k, const PartSpan& span) const {
    if (side_[k].flat) return HUGE_VAL;
    const MotionBody& body = side_[k].body;
    const double radius = body.isRigid()
                              ? span.frame[0].radius
                              : std::max(span.frame[0].radius, span.frame[1].radius);
    return radius + (body.shape() ? body.shape()->radius() : 0);
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
    test(work, many, node, nullptr, partSpan(1 - many, other, work.t0, work.t1));
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

  /// What the gaps between the boxes of a node and another part are reduced by.
  struct Margins {
    /// How far the points of both deviate from straight lines during the span.
    double deviation[MotionBoxes::kWidth]{};
    /// The same along the axis about which a side turns, of the other part and the node.
    double along_axis[2][MotionBoxes::kWidth]{};
    /// Pads, requested distance and rounding.
    double fixed[MotionBoxes::kWidth]{};

    double with(double part_of_deviation, int lane) const {
      return fixed[lane] + part_of_deviation * deviation[lane];
    }
    double alongAxis(int k, double part_of_deviation, int lane) const {
      return fixed[lane] + part_of_deviation * along_axis[k][lane];
    }
  };

  /// @param acceleration  of the node's boxes
  Margins marginsOf(const MotionWork& work, int opened, const MotionNode& node,
                    const PartSpan& other,
                    const double (&acceleration)[MotionBoxes::kWidth]) {
    MotionSide &one = side_[1 - opened], &many = side_[opened];
    const double dt = work.t1 - work.t0, share = direction_bound_ * 0.125 * dt * dt,
                 of_one = direction_bound_ * other.deviation,
                 axis_one = share * one.axis_acceleration,
                 axis_many = share * many.axis_acceleration,
                 flat_share = one.flat ? shareAlongFlat(work, one, many) : 1;
    Margins out;
    for (int lane = 0; lane < node.count; ++lane) {
      const double of_many = share * acceleration[lane];
      out.deviation[lane] = of_one + (flat_share * of_many + axis_many);
      out.along_axis[0][lane] = axis_one + (axes_share_ * of_many + axis_many);
      out.along_axis[1][lane] = axis_many + (axes_share_ * of_one + axis_one);
      out.fixed[lane] =
          direction_bound_ * (other.frame[0].pad + box_margin_ + node.box[0].pad[lane]);
    }
    return out;
  }

  /// The share of a side's deviation along the normal of a flat, which may turn.
  static double shareAlongFlat(const MotionWork& work, MotionSide& flat,
                               const MotionSide& side) {
    const double turn = flat.body.path().turnSpeed() * (work.t1 - work.t0);
    if (turn > 1) return 1;
    const Vec normal = rotated(flat.poses.at(work.t0).rotation, flat.flat->normal);
    return std::min(side.shareAlong(normal) + turn, 1.);
  }

  /// The windows in which the boxes of a node may overlap the part of the other side.
  void setWindows(int opened, const MotionNode& node, const PartSpan& other,
                  const SpanTimes& times, const Margins& margins,
                  const MotionBoxes* const (&boxes)[3], MeetingWindows& windows) {
    MotionSide &one = side_[1 - opened], &many = side_[opened];
    const SpanPoses pose_one = one.spanPoses(times), pose_many = many.spanPoses(times);
    double margin[MotionBoxes::kWidth] = {};
    CalmDirection axes[2] = {{one.axis, {}}, {many.axis, {}}};
    // Boxes are compared in the middle of the span too. In a half of it the deviation is
    // a quarter.
    const double part_of_deviation = one.flat ? 1 : 0.25;
    for (int lane = 0; lane < node.count; ++lane) {
      margin[lane] = margins.with(part_of_deviation, lane);
      for (int k = 0; k < 2; ++k)
        axes[k].margin[lane] = margins.alongAxis(k, part_of_deviation, lane);
    }
    if (one.flat)
      return flatWindows(*one.flat, pose_one, boxes, pose_many, margin, node.count,
                         windows);
    MotionBox moving[3];
    const MotionBox* others[3];
    for (int k = 0; k < 3; ++k) {
      others[k] = &other.frame[0];
      if (one.body.isRigid()) continue;
      moving[k] = other.frame[0];
      interpolate(other.frame[1], times.at[k], moving[k]);
      others[k] = &moving[k];
    }
    motionKernels().meetingWindows(others, pose_one, boxes, pose_many, margin, axes,
                                   node.count, windows);
  }

  /// @param acceleration  of the node's boxes
  TriangleHalves testTriangles(const MotionWork& work, int opened, const MotionNode& node,
                               const BodyPart& part,
                               const double (&acceleration)[MotionBoxes::kWidth]) {
    TriangleHalves out;
    const BodyPart& single = opened == 1 ? work.a : work.b;
    MotionSide &one = side_[1 - opened], &many = side_[opened];
    if (!one.body.isMesh() || !many.body.isMesh() || !single.isTriangle()) return out;
    for (int lane = 0; lane < node.count; ++lane)
      if (node.part[lane].isTriangle()) out.tested |= 1U << lane;
    if (out.tested == 0) return out;
    if (!one.body.isReadable(~single.child)) return {};
    const BodyTriangle triangle = one.body.triangle(~single.child);
    const double dt = work.t1 - work.t0, share = 0.125 * 0.25 * dt * dt,
                 of_one =
                     one.goes_straight
                         ? 0
                         : accelerationOf(one.acceleration(work.t0, work.t1), triangle);
    double deviation[MotionBoxes::kWidth];
    for (int lane = 0; lane < MotionBoxes::kWidth; ++lane)
      deviation[lane] = direction_bound_ * share * (of_one + acceleration[lane]);
    const SpanTimes times(work.t0, work.t1);
    motionKernels().meetingHalves(
        one.spanTriangle(triangle, times), many.reader.triangles(part),
        many.body.isRigid() ? nullptr : times.at, many.spanPoses(times), deviation,
        direction_bound_ * box_margin_, out.tested, out.meeting);
    return out;
  }

  /// Tests the children of one side's part against the other side's part.
  /// @param opened  the side whose children they are
  /// @param part  the part of that side; null: the node is the part itself
  /// @param other  the part of the other side
  void test(const MotionWork& work, int opened, const MotionNode& node,
            const BodyPart* part, const PartSpan& other) {
    // A node of an octree may be occupied while none of its children is.
    if (node.count == 0) return;
    const MotionSide& one = side_[1 - opened];
    MotionSide& many = side_[opened];
    const double dt = work.t1 - work.t0;
    const SpanTimes times(work.t0, work.t1);
    counts_.box_tests += static_cast<std::uint64_t>(node.count);
    const auto& acceleration = many.accelerations(part, node, work.t0, work.t1);
    TriangleHalves halves;
    if (part) halves = testTriangles(work, opened, node, *part, acceleration);
    if ((halves.left() & ((1U << node.count) - 1)) == 0) return;
    MotionBoxes moving[3];
    const MotionBoxes* boxes[3];
    for (int k = 0; k < 3; ++k)
      boxes[k] = boxesAt(many.body, node, times.at[k], moving[k]);
    const Margins margins = marginsOf(work, opened, node, other, acceleration);
    MeetingWindows windows;
    setWindows(opened, node, other, times, margins, boxes, windows);
    halves.narrow(windows);
    for (unsigned left = windows.mask; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      if (one.body.shape() && !one.flat && !one.body.shape()->fillsBox() &&
          !narrowByShape(opened, work, boxes, lane, margins.with(1, lane), windows))
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
                     const MotionBoxes* const (&boxes)[3], int lane, double margin,
                     MeetingWindows& windows) {
    const SpanTimes times(work.t0, work.t1);
    const SpanPoses poses[2] = {side_[1 - opened].spanPoses(times),
                                side_[opened].spanPoses(times)};
    const MotionBox begin = boxes[0]->get(lane), end = boxes[2]->get(lane);
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
    if (isPair(work)) {
      work.t0 = work.start;
      work.t1 = end;
      return;
    }
    const double unit = quarterUnit(end - work.start);
    work.t0 = std::max(work.t0, std::floor(work.start / unit) * unit);
    work.t1 = std::min(work.t1, std::ceil(end / unit) * unit);
  }

  /// How far points may deviate from straight lines, as a share of the radius of a part.
  /// Directions of shapes are compared at both ends of a span only. In short spans fewer
  /// pairs may touch before the first contact does: that of a mesh and a cylinder takes
  /// 0.44 ms, with a share of a quarter 0.65 ms. Where all contacts are wanted each span
  /// costs: they take 7% to 45% less time than with a quarter, most beside a halfspace.
  double mostDeviation() const {
    if (!side_[0].body.shape() && !side_[1].body.shape()) return 0.5;
    return options_.all ? 1 : 0x1p-5;
  }

  void divide(MotionWork& work) {
    // In the shortest span the deviation is 2^-43 of the acceleration.
    constexpr double kShortest = 0x1p-20, kLeastShare = 0x1p-6;
    const double most_deviation = mostDeviation();
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
        span[0].deviation + span[1].deviation > most_deviation * least)
      return halve(work);
    const BodyPart& part = opened == 1 ? work.b : work.a;
    test(work, opened, side_[opened].reader.open(part), &part, span[1 - opened]);
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
      pair.suggest(last_direction_);
      if (options_.ignores_initially_closer) pair.ignoreInitiallyCloser();
      advance(work, index, end, pair);
      if (maxNorm(pair.lastDirection()) > 0) last_direction_ = pair.lastDirection();
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
    const double last = std::min(end, works_.nextTurn(work));
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
    if (!options_.all) {
      latest_ = std::min(latest_, contact.toc_lo);
      works_.keepEarlier(latest_);
    }
    return &contacts_.back();
  }

  /// Sorts the contacts. A pair of triangles may have been found in several spans; its
  /// first contact is kept. A first-contact query keeps the first of all.
  MotionAnswer finish() {
    MotionAnswer answer;
    answer.counts = counts_;
    answer.touching = tolerance_.touching;
    answer.is_cut = isCut();
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

  MotionSide side_[2];
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
  /// That parted the last pair with a shape or a cell. Others beside it have about the
  /// same.
  Vec last_direction_{0, 0, 0};
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

// SPDX-License-Identifier: BSD-3-Clause
#include "api/compound_query.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include "prepare/prepared_motion.h"

namespace fcl {
namespace detail {

using deformable::BoundsList;
using deformable::MeetingWindow;
using deformable::MotionPath;
using deformable::Pose;

namespace {

/// Wider bounds cost less, and let some more parts be asked. With these a query of boxes
/// that turn costs the least.
constexpr int kWholeSpans = 4, kPartSpans = 8;

template <typename S>
void copyPose(const Pose& pose, PoseNumbers<S>& out) {
  const auto round = [](double x) { return static_cast<S>(x); };
  std::transform(pose.rotation, pose.rotation + 9, out.rotation, round);
  std::transform(pose.translation, pose.translation + 3, out.translation, round);
}

PartOffset toOffset(const Pose& pose) {
  PartOffset out{true, {}, {}};
  std::copy(pose.rotation, pose.rotation + 9, out.rotation);
  std::copy(pose.translation, pose.translation + 3, out.translation);
  return out;
}

/// The gap of two moving boxes at the beginning or at the end, the lesser one.
double gapAtEnds(const deformable::MovingBounds& a, const deformable::MovingBounds& b) {
  const auto gap = [](const deformable::HalfAxisBox& x,
                      const deformable::HalfAxisBox& y) {
    double square = 0;
    for (int k = 0; k < 3; ++k) {
      const double apart =
          std::max({0., -(x.half[k] + y.half[k + 3]), -(x.half[k + 3] + y.half[k])});
      square += apart * apart;
    }
    return square;
  };
  return std::min(gap(a.boxes[0], b.boxes[0]),
                  gap(a.boxes[a.num_spans], b.boxes[b.num_spans]));
}

void removeLast(BoundsList& list) {
  list.boxes.resize(list.items.back().first);
  list.items.pop_back();
}

}  // namespace

template <typename S>
CompoundSide<S>::CompoundSide(const PlacedGeometry<S>& placed, const char* name)
    : name_(name), parts_(placed.compound()), body_(placed.moving()) {
  if (!parts_) return;
  requireParts(*parts_, name);
  deformable::requireDefinedPath(placed, name);
  path_.emplace(deformable::motionPathOf(placed, name));
}

template <typename S>
void CompoundSide<S>::appendPart(int i, PathPoses& poses, int most_spans,
                                 BoundsList& list) const {
  const Part& one = part(i);
  if (one.has_box)
    appendBox({one.box, one.box}, poses, most_spans, list);
  else
    detail::appendBounds(MovingPart(*this, i).moving(), list);
}

template <typename S>
void CompoundSide<S>::appendBounds(BoundsList& list) const {
  if (!parts_) return appendWhole(nullptr, list);
  PathPoses poses(*path_);
  for (int i = 0; i < count(); ++i) appendPart(i, poses, kPartSpans, list);
}

template <typename S>
std::vector<int> CompoundSide<S>::appendNear(const deformable::MovingBounds& other,
                                             double distance, PathPoses& poses,
                                             BoundsList& list) const {
  assert(isCompound());
  const bool is_straight = poses.acceleration().isZero();
  const auto meets = [&] {
    return !deformable::meetingWindow(list.at(list.items.size() - 1), other, distance)
                .isEmpty();
  };
  std::vector<int> near;
  for (int i = 0; i < count(); ++i) {
    // Most far parts need the bounds of one span only.
    if (part(i).has_box && !is_straight) {
      appendPart(i, poses, 1, list);
      const bool is_near = meets();
      removeLast(list);
      if (!is_near) continue;
    }
    appendPart(i, poses, kPartSpans, list);
    if (meets())
      near.push_back(i);
    else
      removeLast(list);
  }
  return near;
}

template <typename S>
void CompoundSide<S>::appendWhole(PathPoses* poses, BoundsList& list) const {
  if (parts_ && parts_->has_box)
    return appendBox({parts_->box, parts_->box}, *poses, kWholeSpans, list);
  const PlacedGeometry<S> placed(body_);
  if (isBounded(placed)) return appendBody(boundedBodyOf(placed, name_), list);
  detail::appendBounds(body_, list);
}

template <typename S>
CompoundSide<S>::MovingPart::MovingPart(const CompoundSide& side, int i)
    : moving_(side.body_) {
  if (!side.parts_) return;
  const Part& part = side.part(i);
  moving_.geometry = part.geometry.get();
  if (moving_.path != PathKind::kBounded && moving_.path != PathKind::kSpline) {
    moving_.offset = toOffset(part.offset);
    return;
  }
  path_.emplace(*side.path_, part.offset);
  moving_.path = PathKind::kBounded;
  moving_.motion = &*path_;
  for (int end = 0; end < 2; ++end) {
    const BoundedMotion::Placement at = path_->placementAt(end);
    Pose pose;
    std::copy(at.rotation, at.rotation + 9, pose.rotation);
    std::copy(at.translation, at.translation + 3, pose.translation);
    copyPose(pose, moving_.pose[end]);
  }
}

template <typename S>
CompoundPair<S>::CompoundPair(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2)
    : side1_(o1, "o1"), side2_(o2, "o2") {}

template <typename S>
void CompoundPair<S>::requireNoTriangleGroups(const CheckedRequest& request) const {
  for (int k = 0; k < 2; ++k) {
    const ContinuousFilter* filter = request.filter[k];
    if (!(k == 0 ? side1_ : side2_).isCompound() || !filter) continue;
    if (!filter->triangle_groups.empty() || !filter->triangle_masks.empty())
      throw Exception("request.filter" + std::to_string(k + 1) +
                      " has groups of triangles, and o" + std::to_string(k + 1) +
                      " is a compound, which has none. Set the group and the mask of "
                      "the whole object");
  }
}

template <typename S>
std::vector<PartPair> CompoundPair<S>::near(
    const deformable::QueryOptions& options) const {
  const double distance = options.min_distance;
  std::optional<PathPoses> poses1, poses2;
  if (side1_.path()) poses1.emplace(*side1_.path());
  if (side2_.path()) poses2.emplace(*side2_.path());
  BoundsList whole1, whole2, bounds1, bounds2;
  side1_.appendWhole(poses1 ? &*poses1 : nullptr, whole1);
  side2_.appendWhole(poses2 ? &*poses2 : nullptr, whole2);
  const deformable::MovingBounds all1 = whole1.at(0), all2 = whole2.at(0);
  if (deformable::meetingWindow(all1, all2, distance).isEmpty()) return {};
  std::vector<int> near1{0}, near2{0};
  if (poses1) near1 = side1_.appendNear(all2, distance, *poses1, bounds1);
  if (poses2) near2 = side2_.appendNear(all1, distance, *poses2, bounds2);
  const BoundsList &list1 = side1_.isCompound() ? bounds1 : whole1,
                   &list2 = side2_.isCompound() ? bounds2 : whole2;
  assert(near1.size() == list1.items.size() && near2.size() == list2.items.size());
  std::vector<PartPair> pairs;
  for (std::size_t i = 0; i < near1.size(); ++i)
    for (std::size_t k = 0; k < near2.size(); ++k) {
      const MeetingWindow window =
          deformable::meetingWindow(list1.at(i), list2.at(k), distance);
      // A contact may be reported earlier than boxes meet, by up to toc_err.
      const double earliest = window.lo - options.toc_err;
      if (!window.isEmpty() && earliest <= options.t_max)
        pairs.push_back({earliest, near1[i], near2[k]});
    }
  std::sort(pairs.begin(), pairs.end(), [](const PartPair& x, const PartPair& y) {
    return std::tie(x.t_lo, x.part1, x.part2) < std::tie(y.t_lo, y.part1, y.part2);
  });
  return pairs;
}

template <typename S>
bool CompoundPair<S>::visitNearest(
    double limit, const std::function<double(const PartPair&)>& visit) const {
  BoundsList bounds1, bounds2;
  side1_.appendBounds(bounds1);
  side2_.appendBounds(bounds2);
  assert(bounds1.items.size() == static_cast<std::size_t>(side1_.count()));
  assert(bounds2.items.size() == static_cast<std::size_t>(side2_.count()));
  struct Candidate {
    double gap;
    int part1, part2;
  };
  std::vector<Candidate> order;
  for (int i = 0; i < side1_.count(); ++i)
    for (int k = 0; k < side2_.count(); ++k)
      order.push_back(
          {gapAtEnds(bounds1.at(std::size_t(i)), bounds2.at(std::size_t(k))), i, k});
  std::sort(order.begin(), order.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.gap, x.part1, x.part2) < std::tie(y.gap, y.part1, y.part2);
  });
  bool is_complete = true;
  for (const Candidate& pair : order) {
    const bool is_far =
        std::isfinite(limit) &&
        deformable::meetingWindow(bounds1.at(std::size_t(pair.part1)),
                                  bounds2.at(std::size_t(pair.part2)), limit)
            .isEmpty();
    if (is_far)
      is_complete = false;
    else
      limit = visit({0, pair.part1, pair.part2});
  }
  return !is_complete;
}

template <typename S>
std::string CompoundPair<S>::nameOf(const PartPair& pair) const {
  const auto name = [](const CompoundSide<S>& side, int i, const char* object) {
    return side.isCompound()
               ? object + (" is part " + std::to_string(i)) + " of a compound"
               : std::string();
  };
  const std::string first = name(side1_, pair.part1, "o1"),
                    second = name(side2_, pair.part2, "o2");
  return first + (first.empty() || second.empty() ? "" : ", ") + second;
}

template <typename S>
QueryOutcome<S> earliestOf(const std::vector<PartAnswer<S>>& answers) {
  QueryOutcome<S> earliest{false, 1, 1, 1};
  for (const PartAnswer<S>& answer : answers) {
    const QueryOutcome<S>& one = answer.result.outcome;
    assert(one.is_collide && one.toc_lo <= one.toc_hi);
    if (!earliest.is_collide ||
        std::tie(one.toc_lo, one.toc_hi) < std::tie(earliest.toc_lo, earliest.toc_hi))
      earliest = one;
  }
  return earliest;
}

namespace {

template <typename S>
void setParts(const PartAnswer<S>& answer, std::vector<ContinuousContact<S>>& contacts) {
  for (ContinuousContact<S>& contact : contacts) {
    contact.part1 = answer.part1;
    contact.part2 = answer.part2;
  }
}

template <typename T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Keeps those that may be the first, whose bracket begins no later than the earliest
/// bracket ends.
template <typename S>
void keepFirst(std::vector<ContinuousContact<S>>& contacts) {
  double earliest = std::numeric_limits<double>::infinity();
  for (const auto& contact : contacts) earliest = std::min(earliest, contact.toc_hi);
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(),
                     [earliest](const auto& c) { return c.toc_lo > earliest; }),
      contacts.end());
}

}  // namespace

template <typename S>
ContinuousContacts<S> joinedContacts(std::vector<PartAnswer<S>> answers,
                                     const deformable::QueryOptions& options) {
  std::sort(answers.begin(), answers.end(),
            [](const PartAnswer<S>& x, const PartAnswer<S>& y) {
              return std::tie(x.part1, x.part2) < std::tie(y.part1, y.part2);
            });
  ContinuousContacts<S> out;
  for (PartAnswer<S>& answer : answers) {
    ContinuousContacts<S>& one = answer.result;
    setParts(answer, one.contacts);
    setParts(answer, one.crossings);
    append(one.contacts, out.contacts);
    append(one.crossings, out.crossings);
    if (one.initially_crossing && !out.initially_crossing) {
      out.initially_crossing = true;
      out.crossing = one.crossing;
      out.crossing.part1 = answer.part1;
      out.crossing.part2 = answer.part2;
    }
    out.contacts_cut |= one.contacts_cut;
  }
  if (options.query == ContinuousQuery::kFirst) keepFirst(out.contacts);
  std::stable_sort(out.contacts.begin(), out.contacts.end(),
                   [](const auto& x, const auto& y) { return x.toc_lo < y.toc_lo; });
  if (out.contacts.size() > options.max_contacts) {
    out.contacts.resize(options.max_contacts);
    out.contacts_cut = true;
  }
  return out;
}

#define FCL_CCD_INSTANTIATE(S)                                              \
  template class CompoundSide<S>;                                           \
  template class CompoundPair<S>;                                           \
  template QueryOutcome<S> earliestOf(const std::vector<PartAnswer<S>>&);   \
  template ContinuousContacts<S> joinedContacts(std::vector<PartAnswer<S>>, \
                                                const deformable::QueryOptions&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

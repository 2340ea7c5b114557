// SPDX-License-Identifier: BSD-3-Clause
#include "curved/shape_contacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "advance/convex_advance.h"
#include "bodies/common_motion.h"
#include "curved/curved_query.h"
#include "curved/overlap_at_start.h"
#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Bound on the distance of its points from a center; a flat has none.
double sizeOf(const MovingBody& body) {
  if (!body.shape()) return body.radius();
  return body.shape()->flat() ? HUGE_VAL : body.shape()->outerRadius();
}

/// What a contact calls the part of a body.
std::int64_t nameOf(const MovingBody& body, const CurvedContact& contact, int side) {
  return body.octree() ? body.octree()->number(contact.place[side])
                       : contact.triangle[side];
}

/// The places of cells depend on the query; their names do not.
void sortByNames(const MovingBody& a, const MovingBody& b,
                 std::vector<CurvedContact>& contacts) {
  if (!a.octree() && !b.octree()) return;
  std::sort(contacts.begin(), contacts.end(),
            [&](const CurvedContact& x, const CurvedContact& y) {
              return std::make_tuple(x.toc_lo, nameOf(a, x, 0), nameOf(b, x, 1)) <
                     std::make_tuple(y.toc_lo, nameOf(a, y, 0), nameOf(b, y, 1));
            });
}

/// The feature of a triangle whose corners hold the nearest point.
void setFeature(const BodyTriangle& triangle, unsigned corners,
                DescribedContact& contact) {
  int count = 0;
  for (int k = 0; k < 3; ++k)
    if ((corners >> k & 1U) != 0) contact.vertices[count++] = triangle.vertex[k];
  contact.kind = count == 1   ? ContinuousContactKind::kVertexShape
                 : count == 2 ? ContinuousContactKind::kEdgeShape
                              : ContinuousContactKind::kFaceShape;
}

class ShapeContacts {
 public:
  ShapeContacts(const MovingBody& a, const MovingBody& b, double distance)
      : near_(a, b),
        body_{&near_.a, &near_.b},
        tolerance_(near_.a, near_.b, coreDistance(a.shape(), b.shape(), distance)) {}

  static DescribedContact timesOf(const CurvedContact& found) {
    DescribedContact contact;
    contact.toc_lo = found.toc_lo;
    // A contact at the beginning has exactly the time 0.
    contact.toc_hi = found.toc_lo == 0 ? 0 : found.toc_hi;
    contact.within_tolerance = found.certainty != ContactCertainty::kCrossing;
    return contact;
  }

  DescribedContact contactOf(const CurvedContact& found, bool with_geometry) const {
    const MovingConvex set[2] = {movingConvexOf(*body_[0], found.place[0]),
                                 movingConvexOf(*body_[1], found.place[1])};
    const ConvexAdvance pair(set[0], set[1], found.toc_lo, found.toc_lo, tolerance_);
    const ConvexGap gap = pair.gapAt(found.toc_lo);
    DescribedContact contact = timesOf(found);
    for (int side = 0; side < 2; ++side) {
      contact.triangles[side] = nameOf(*body_[side], found, side);
      if (body_[side]->isMesh()) {
        contact.first_on_a = side == 0;
        setFeature(set[side].triangle, gap.corners[side], contact);
      }
    }
    if (!with_geometry) return contact;
    setPosition(gap, contact);
    if (gap.gap + tolerance_.touching > tolerance_.radii) {
      contact.normal = gap.direction;
    } else if (found.toc_lo > 0) {
      contact.normal = normalBefore(pair, found.toc_lo);
    } else {
      const Penetration penetration = pair.penetrationAt(0, gap);
      contact.normal = penetration.direction;
      contact.depth = penetration.depth + tolerance_.radii;
    }
    return contact;
  }

  /// The time at which the pair overlaps well, in [toc_hi, toc_lo + toc_err] and up to
  /// `t_max`. That is the end as a rule. Bodies may pass each other before, or one
  /// through the other: then the deepest of some times is taken. Bodies that overlap
  /// deeply at t = 0 stay there.
  double poseTimeOf(const CurvedContact& found, double toc_err, double t_max) const {
    // Points come nearer by at most the bound on their speed, times the time. Half of all
    // pairs come nearer by a tenth of that.
    constexpr double kWell = 0x1p-5;
    constexpr int kTimes = 8;
    const double first = found.toc_lo == 0 ? 0 : found.toc_hi,
                 end = std::min(t_max, found.toc_lo + toc_err);
    if (!(end > first)) return first;
    const MovingConvex set[2] = {movingConvexOf(*body_[0], found.place[0]),
                                 movingConvexOf(*body_[1], found.place[1])};
    const ConvexAdvance pair(set[0], set[1], found.toc_lo, end, tolerance_);
    const double radii = tolerance_.radii,
                 well = kWell * pair.speed() * (end - found.toc_lo);
    if (first == 0 && isDeepOverlap(radii + overlapOf(pair.coreGapAt(first)),
                                    std::min(sizeOf(*body_[0]), sizeOf(*body_[1]))))
      return first;
    // An upper bound: the search for a direction may end before this is the depth. What
    // is proved of shallow overlaps says less: it may be 0, or rounding.
    const auto overlapAt = [&](double time) { return radii - pair.coreGapAt(time).gap; };
    double best = end, deepest = overlapAt(end);
    for (int i = kTimes - 1; i >= 0 && !(deepest >= well); --i) {
      const double time = first + (end - first) * (double(i) / kTimes),
                   overlap = overlapAt(time);
      if (!(overlap > deepest) && !(i == 0 && overlap == deepest)) continue;
      best = time;
      deepest = overlap;
    }
    assert(first <= best && best <= end);
    return best;
  }

 private:
  /// The direction that parts the bodies just before a time. Round surfaces that nearly
  /// touch may have none within rounding at the time itself.
  Vec normalBefore(const ConvexAdvance& pair, double time) const {
    constexpr double kFirstShare = 0x1p-40, kLastShare = 0x1p-10, kGrowth = 0x1p5;
    const double radii = tolerance_.radii;
    for (double share = kFirstShare; share <= kLastShare; share *= kGrowth) {
      const ConvexGap before = pair.gapAt((1 - share) * time);
      if (before.gap > radii) return before.direction;
    }
    return {0, 0, 0};
  }

  /// The position is half-way between the surfaces, or inside of both.
  void setPosition(const ConvexGap& gap, DescribedContact& contact) const {
    const double radius[2] = {body_[0]->shapeRadius(), body_[1]->shapeRadius()};
    Vec way = gap.point[1] - gap.point[0];
    if (gap.distance > 0) way = (1 / gap.distance) * way;
    double along = 0.5 * (gap.distance + radius[0] - radius[1]);
    if (gap.distance <= tolerance_.radii)
      along = std::min(std::max({along, -radius[0], gap.distance - radius[1]}),
                       std::min(radius[0], gap.distance + radius[1]));
    contact.position = gap.point[0] + along * way + vecOf(near_.origin);
  }

  BodiesNearOrigin near_;
  const MovingBody* body_[2];
  BodyTolerance tolerance_;
};

/// Keeps those that may be the first.
void keepFirst(std::vector<CurvedContact>& contacts) {
  assert(
      std::is_sorted(contacts.begin(), contacts.end(),
                     [](const auto& x, const auto& y) { return x.toc_lo < y.toc_lo; }));
  double first_hi = 1;
  for (const CurvedContact& contact : contacts)
    first_hi = std::min(first_hi, contact.toc_hi);
  while (contacts.size() > 1 && contacts.back().toc_lo > first_hi) contacts.pop_back();
  assert(contacts.empty() || contacts.front().toc_lo <= first_hi);
}

}  // namespace

QueryAnswer queryShapeContacts(const MovingBody& a, const MovingBody& b,
                               const QueryOptions& options) {
  QueryAnswer answer;
  if (options.only_time && overlapDeeplyAtStart(a, b)) {
    answer.shape_contacts.emplace_back();
    answer.first = {0, 0};
    return answer;
  }
  const auto ask = [&](const CurvedOptions& wanted) {
    CurvedAnswer found = queryCurved(a, b, wanted);
    answer.counts.node_pairs += found.counts.box_tests;
    answer.counts.triangle_pairs += found.counts.triangle_pairs;
    return std::move(found.contacts);
  };
  CurvedOptions wanted = curvedOptionsOf(a, b, options);
  const BodiesNearOrigin near(a, b);
  wanted.only_at_start = moveAsOne(near.a, near.b, options.min_distance);
  std::vector<CurvedContact> touching = ask(wanted);
  if (options.query == ContinuousQuery::kFirst && !touching.empty()) {
    // All that begin before the first bracket ends.
    wanted.all = true;
    wanted.t_max = touching.front().toc_hi;
    std::vector<CurvedContact> first = ask(wanted);
    // A graze has a bracket without width, at whose end another division of the step may
    // see nothing.
    if (!first.empty()) touching = std::move(first);
    keepFirst(touching);
  }
  sortByNames(a, b, touching);
  const std::size_t most =
      options.query == ContinuousQuery::kAny ? 1 : options.max_contacts;
  if (touching.size() > most) {
    touching.resize(most);
    answer.cut = options.query != ContinuousQuery::kAny;
  }
  const ShapeContacts contacts(a, b, options.min_distance);
  answer.shape_contacts.reserve(touching.size());
  for (const CurvedContact& contact : touching)
    answer.shape_contacts.push_back(
        options.only_time ? ShapeContacts::timesOf(contact)
                          : contacts.contactOf(contact, options.with_geometry));
  answer.counts.contacts = touching.size();
  if (touching.empty()) return answer;
  const DescribedContact& first = answer.shape_contacts.front();
  answer.first = {first.toc_lo, first.toc_hi};
  if (!(options.min_distance > 0))
    answer.pose_time =
        contacts.poseTimeOf(touching.front(), options.toc_err, options.t_max);
  assert(0 <= answer.first.lo && answer.first.lo <= answer.first.hi &&
         answer.first.hi <= 1);
  assert(options.min_distance > 0 || answer.first.hi <= answer.pose_time);
  return answer;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

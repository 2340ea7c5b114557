// SPDX-License-Identifier: BSD-3-Clause
#include "api/contact_conversion.h"
#include "base/large_pages.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "base/stopwatch.h"
#include "elementary/distance_advance.h"
#include "elementary/elementary.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

Vec toVec(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

template <typename S>
Vector3<S> toVector(const Vec& v) {
  return {static_cast<S>(v.x), static_cast<S>(v.y), static_cast<S>(v.z)};
}

/// Converts a list of contacts to the public type.
template <typename S, typename Contacts, typename Convert>
void convertAll(const Contacts& contacts, const Convert& convert, int num_threads,
                std::vector<ContinuousContact<S>>& out) {
  const std::size_t count = contacts.size();
  const auto contactAt = [&](std::size_t i) {
    // Contacts that are neighbours in time are scattered in memory.
    constexpr std::size_t kAhead = 16;
    prefetchMemory(&contacts[std::min(i + kAhead, count - 1)]);
    return convert(contacts[i]);
  };
  if (numThreads(num_threads) == 1) {
    out.clear();
    for (std::size_t i = 0; i < count; ++i) out.push_back(contactAt(i));
    return;
  }
  // resize() writes each contact once, contactAt() a second time.
  constexpr std::size_t kBlock = 1024;
  out.resize(count);
  parallelForBlocks(count, kBlock, num_threads, [&](std::size_t i, std::size_t last) {
    for (; i < last; ++i) out[i] = contactAt(i);
  });
}

}  // namespace

ContactDescriber::ContactDescriber(const QueryOptions& options)
    : with_geometry_(options.with_geometry), at_distance_(options.min_distance > 0) {}

ContactDescriber::ContactDescriber(const MeshInstance& a, const MeshInstance& b,
                                   const QueryOptions& options)
    : ContactDescriber(options) {
  mesh_[0] = a;
  mesh_[1] = b;
}

ContactDescriber::ContactDescriber(const PreparedMotion& a, const PreparedMotion& b,
                                   const QueryOptions& options)
    : ContactDescriber(a.beginning(), b.beginning(), options) {
  motion_[0] = &a;
  motion_[1] = &b;
}

DescribedContact ContactDescriber::operator()(const FeatureContact& contact) const {
  DescribedContact out;
  out.kind = contact.kind;
  out.first_on_a = contact.first_on_a;
  std::copy(contact.triangles, contact.triangles + 2, out.triangles);
  for (std::size_t i = 0; i < 4; ++i)
    out.vertices[i] = static_cast<std::int32_t>(contact.vertices[i]);
  out.toc_lo = contact.toc_lo;
  out.toc_hi = contact.toc_hi;
  const bool has_width = contact.toc_hi != contact.toc_lo;
  out.within_tolerance =
      !has_width && (motion_[0] ? !(at_distance_ && contact.toc_lo == 0)
                                : at_distance_ && contact.toc_lo > 0);
  if (with_geometry_) addGeometry(contact, out);
  return out;
}

void ContactDescriber::addGeometry(const FeatureContact& contact,
                                   DescribedContact& out) const {
  VertexPath x[4]{};
  for (unsigned i = 0; i < numVertices(contact.kind); ++i) {
    const int side = isPointOfA(contact.kind, contact.first_on_a, i) ? 0 : 1;
    x[i] = motion_[side] ? motion_[side]->tangentAt(contact.vertices[i], contact.toc_lo)
                         : mesh_[side].frames[contact.vertices[i]];
  }
  // The time on these paths.
  const double t = motion_[0] ? 0 : contact.toc_lo;
  double position[3], normal[3];
  (at_distance_ ? distanceGeometry : contactGeometry)(
      contact.kind, FeaturePoints{{&x[0], &x[1], &x[2], &x[3]}}, t, position, normal);
  out.position = vecOf(position);
  out.normal = (contact.first_on_a ? 1. : -1.) * vecOf(normal);
}

DescribedContact ContactDescriber::operator()(const Crossing& crossing) const {
  DescribedContact out;
  out.kind = ContinuousContactKind::kCrossing;
  out.first_on_a = crossing.first_on_a;
  std::copy(crossing.triangles, crossing.triangles + 2, out.triangles);
  const auto toId = [](std::uint32_t vertex) {
    return static_cast<std::int32_t>(vertex);
  };
  std::transform(crossing.edge, crossing.edge + 2, std::begin(out.vertices), toId);
  std::transform(crossing.face, crossing.face + 3, std::begin(out.vertices) + 2, toId);
  if (!with_geometry_) return out;

  const MeshInstance &first = mesh_[crossing.first_on_a ? 0 : 1],
                     &second = mesh_[crossing.first_on_a ? 1 : 0];
  double point[5][3];
  for (std::size_t i = 0; i < 5; ++i)
    (i < 2 ? first : second)
        .frames.at(0, i < 2 ? crossing.edge[i] : crossing.face[i - 2], point[i]);
  const auto vec = [&point](int i) {
    return Vector3<double>(point[i][0], point[i][1], point[i][2]);
  };
  // Scaled so that no product of tiny or huge meshes leaves the range of numbers.
  const auto scaled = [](const Vector3<double>& v) -> Vector3<double> {
    const double size = v.cwiseAbs().maxCoeff();
    if (!(size > 0) || !std::isfinite(size)) return v;
    return v * std::ldexp(1, std::min(-std::ilogb(size), 1000));
  };
  const Vector3<double> edge = vec(1) - vec(0);
  const Vector3<double> normal =
      scaled(scaled(vec(3) - vec(2)).cross(scaled(vec(4) - vec(2))));
  const double below = (vec(0) - vec(2)).dot(normal),
               above = (vec(1) - vec(2)).dot(normal);
  // The ends are on different sides. For an edge in the plane it is the middle.
  const double s = above != below ? below / (below - above) : 0.5;
  const Vector3<double> position = vec(0) + std::min(std::max(s, 0.), 1.) * edge;
  out.position = toVec(position);
  const double length = normal.norm();
  if (length > 0 && std::isfinite(length)) {
    out.normal = toVec(normal / length);
    assert(std::abs(norm(out.normal) - 1) < 0x1p-48);
  }
  return out;
}

template <typename S>
ContinuousContact<S> toContinuousContact(const DescribedContact& contact,
                                         const CollisionGeometry<S>& o1,
                                         const CollisionGeometry<S>& o2) {
  ContinuousContact<S> out;
  out.kind = contact.kind;
  out.o1 = &o1;
  out.o2 = &o2;
  out.b1 = contact.triangles[0];
  out.b2 = contact.triangles[1];
  std::copy(contact.vertices, contact.vertices + 5, out.vertices.begin());
  out.first_on_o1 = contact.first_on_a;
  out.within_tolerance = contact.within_tolerance;
  out.toc_lo = contact.toc_lo;
  out.toc_hi = contact.toc_hi;
  out.pos = toVector<S>(contact.position);
  out.normal = toVector<S>(contact.normal);
  out.penetration_depth = static_cast<S>(contact.depth);
  return out;
}

template <typename S>
Contact<S> toContact(const ContinuousContact<S>& contact) {
  Contact<S> out(contact.o1, contact.o2, static_cast<int>(contact.b1),
                 static_cast<int>(contact.b2));
  out.pos = contact.pos;
  out.normal = contact.normal;
  out.penetration_depth = contact.penetration_depth;
  return out;
}

template <typename S>
S roundTimeDown(double t) {
  const auto rounded = static_cast<S>(t);
  const S out =
      static_cast<double>(rounded) > t ? std::nextafter(rounded, S(0)) : rounded;
  assert(!(out < 0) && !(static_cast<double>(out) > t));
  return out;
}

template <typename S>
S roundTimeUp(double t) {
  const auto rounded = static_cast<S>(t);
  const S out =
      static_cast<double>(rounded) < t ? std::nextafter(rounded, S(1)) : rounded;
  assert(!(out > 1) && !(static_cast<double>(out) < t));
  return out;
}

template <typename S>
QueryOutcome<S> outcomeOf(const QueryAnswer& answer) {
  if (answer.hasCrossing()) return {true, 0, 0, 0};
  if (!answer.hasContact()) return {false, 1, 1, 1};
  assert(!(answer.first.lo > answer.first.hi) && !(answer.pose_time > 1));
  const S hi = roundTimeUp<S>(answer.first.hi);
  return {true, roundTimeDown<S>(answer.first.lo), hi,
          std::max(hi, static_cast<S>(answer.pose_time))};
}

template <typename S>
void fillContacts(const QueryAnswer& answer, const ContactDescriber& describe,
                  const CollisionGeometry<S>& o1, const CollisionGeometry<S>& o2,
                  const QueryOptions& options, ContinuousContacts<S>& result) {
  const Stopwatch start;
  const auto convert = [&](const auto& contact) {
    return toContinuousContact<S>(describe(contact), o1, o2);
  };
  assert(answer.contacts.empty() || answer.shape_contacts.empty());
  const bool has_shape = !answer.shape_contacts.empty();
  const std::size_t count =
      has_shape ? answer.shape_contacts.size() : answer.contacts.size();
  // Allocate first: an exception must leave the result unchanged.
  result.crossings.reserve(options.all_crossings ? answer.crossings.size() : 0);
  if (result.contacts.capacity() < count) {
    std::vector<ContinuousContact<S>> room;
    room.reserve(count);
    preferLargePages(room.data(), count * sizeof(ContinuousContact<S>));
    result.contacts.swap(room);
  }
  if (has_shape)
    convertAll(answer.shape_contacts, convert, 1, result.contacts);
  else
    convertAll(answer.contacts, convert, options.num_threads, result.contacts);
  assert(result.contacts.size() == count);
  result.contacts_cut = answer.cut;
  result.is_triangle_soup = false;
  result.initially_crossing = answer.hasCrossing();
  result.crossing =
      answer.hasCrossing() ? convert(answer.crossings.front()) : ContinuousContact<S>();
  result.crossings.clear();
  if (options.all_crossings)
    for (const Crossing& crossing : answer.crossings)
      result.crossings.push_back(convert(crossing));
  result.counts = answer.counts;
  result.times = answer.times;
  result.times.test += start.seconds();
}

#define FCL_CCD_INSTANTIATE(S)                                                         \
  template ContinuousContact<S> toContinuousContact(const DescribedContact&,           \
                                                    const CollisionGeometry<S>&,       \
                                                    const CollisionGeometry<S>&);      \
  template Contact<S> toContact(const ContinuousContact<S>&);                          \
  template QueryOutcome<S> outcomeOf(const QueryAnswer&);                              \
  template void fillContacts(const QueryAnswer&, const ContactDescriber&,              \
                             const CollisionGeometry<S>&, const CollisionGeometry<S>&, \
                             const QueryOptions&, ContinuousContacts<S>&);             \
  template S roundTimeDown<S>(double);                                                 \
  template S roundTimeUp<S>(double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/triangle_pair_test.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "fcl/narrowphase/detail/deformable/instant_test.h"

namespace fcl {
namespace detail {
namespace deformable {

TrianglePairTest::TrianglePairTest(const MeshInstance& a, const MeshInstance& b,
                                   const QueryOptions& options)
    : a_(a),
      b_(b),
      options_(options),
      self_(&a == &b),
      // A pair that is met in several triangle pairs must get one answer: every window
      // then gives way to the whole step.
      full_window_(!a.prepared || !b.prepared),
      sink_(options.goal == QueryGoal::kAny ? 1 : options.max_contacts, full_window_) {}

bool TrianglePairTest::isDone() const {
  if (has_crossing_ && options_.stop_at_crossing) return true;
  return options_.goal == QueryGoal::kAny && (!sink_.contacts().empty() || has_crossing_);
}

double TrianglePairTest::latest() const {
  if (options_.goal == QueryGoal::kFirst)
    return std::min(sink_.firstHi(), sink_.latestKept());
  return options_.goal == QueryGoal::kAll ? sink_.latestKept() : 1;
}

void TrianglePairTest::Side::load(const MeshInstance& mesh, int i) {
  if (index == i) return;
  index = i;
  triangle = mesh.triangle(static_cast<std::size_t>(i));
  for (int k = 0; k < 3; ++k) {
    x[k] = mesh.frames[triangle.v[k]];
    vertex[k] = AxisRanges(x[k]);
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(x[k].t0[c]) || !std::isfinite(x[k].t1[c]))
        throw std::domain_error("vertex " + std::to_string(triangle.v[k]) +
                                " is not finite");
  }
  for (int k = 0; k < 3; ++k) edge[k] = AxisRanges(vertex[k], vertex[(k + 1) % 3]);
  face = AxisRanges(edge[0], vertex[2]);
}

void TrianglePairTest::test(int i, int j, TimeWindow window) {
  side_a_.load(a_, i);
  side_b_.load(b_, j);
  ++counts_.triangle_pairs;
  if (window.lo <= 0.f && !has_crossing_) {
    testCrossing(side_a_, side_b_, true);
    if (!has_crossing_) testCrossing(side_b_, side_a_, false);
  }
  if (full_window_) window = {0.f, 1.f};
  if (self_)
    testFeatures<true>(window);
  else
    testFeatures<false>(window);
}

template <bool kSelf>
void TrianglePairTest::testFeatures(TimeWindow window) {
  const double lo = std::max(0., window.lo - kWindowMargin),
               hi = std::min(1., window.hi + kWindowMargin);
  const MeshTriangle &a = side_a_.triangle, &b = side_b_.triangle;
  if (kSelf && (hasVertex(b, a.v[0]) || hasVertex(b, a.v[1]) || hasVertex(b, a.v[2])))
    ++counts_.adjacent_pairs;
  forEachFeaturePair<kSelf>(a, b, [&](const FeaturePair& pair) {
    ++counts_.feature_pairs;
    const bool ee = pair.kind == FeatureKind::kEdgeEdge;
    const AxisRanges& ranges_a = ee                ? side_a_.edge[pair.first]
                                 : pair.first_on_a ? side_a_.vertex[pair.first]
                                                   : side_a_.face;
    const AxisRanges& ranges_b = ee                ? side_b_.edge[pair.second]
                                 : pair.first_on_a ? side_b_.face
                                                   : side_b_.vertex[pair.first];
    double pair_lo = lo, pair_hi = hi;
    if (!narrowWindow(ranges_a, ranges_b, pair_lo, pair_hi))
      ++counts_.box_culled;
    else
      testFeature(pair, pair_lo, pair_hi);
  });
}

FeatureContact TrianglePairTest::describe(const FeaturePair& pair) const {
  const MeshTriangle &a = side_a_.triangle, &b = side_b_.triangle;
  FeatureContact contact{};
  contact.kind = pair.kind;
  contact.first_on_a = pair.first_on_a;
  contact.triangles[0] = side_a_.index;
  contact.triangles[1] = side_b_.index;
  if (pair.kind == FeatureKind::kVertexFace) {
    const MeshTriangle& face = pair.first_on_a ? b : a;
    contact.vertices[0] = pair.first_on_a ? a.v[pair.first] : b.v[pair.first];
    std::copy(face.v, face.v + 3, contact.vertices + 1);
    // In a self-collision the vertex is always "o1".
    if (self_ && !pair.first_on_a) {
      contact.first_on_a = true;
      std::swap(contact.triangles[0], contact.triangles[1]);
    }
    return contact;
  }
  contact.vertices[0] = a.v[pair.first];
  contact.vertices[1] = a.v[(pair.first + 1) % 3];
  contact.vertices[2] = b.v[pair.second];
  contact.vertices[3] = b.v[(pair.second + 1) % 3];
  return contact;
}

void TrianglePairTest::sortByIds(FeatureContact& contact, FeaturePoints& points) const {
  std::uint32_t(&v)[4] = contact.vertices;
  const auto swap = [&](int i, int j) {
    std::swap(v[i], v[j]);
    std::swap(points.point[i], points.point[j]);
  };
  if (v[1] < v[0]) swap(0, 1);
  if (v[3] < v[2]) swap(2, 3);
  if (self_ && (v[2] < v[0] || (v[2] == v[0] && v[3] < v[1]))) {
    swap(0, 2);
    swap(1, 3);
    std::swap(contact.triangles[0], contact.triangles[1]);
  }
}

FeaturePoints TrianglePairTest::pointsOf(const FeaturePair& pair) const {
  if (pair.kind == FeatureKind::kVertexFace) {
    const Side &vertex = pair.first_on_a ? side_a_ : side_b_,
               &face = pair.first_on_a ? side_b_ : side_a_;
    return {{&vertex.x[pair.first], &face.x[0], &face.x[1], &face.x[2]}};
  }
  return {{&side_a_.x[pair.first], &side_a_.x[(pair.first + 1) % 3],
           &side_b_.x[pair.second], &side_b_.x[(pair.second + 1) % 3]}};
}

void TrianglePairTest::testFeature(const FeaturePair& pair, double lo, double hi) {
  FeaturePoints points = pointsOf(pair);
  if (!mayBecomeCoplanar(pair.kind, points, lo, hi)) {
    ++counts_.filter_culled;
    return;
  }
  FeatureContact contact = describe(pair);
  if (pair.kind == FeatureKind::kEdgeEdge) sortByIds(contact, points);
  ElementaryResult result =
      solveCoplanarity(pair.kind, points, lo, hi, options_.toc_err, latest());
  if (result.answer == Answer::kUnsure) {
    ++counts_.exact_tests;
    result = decideExactly(pair.kind, points, options_.toc_err);
  }
  if (result.answer == Answer::kNo) {
    ++(result.decided_by == DecidedBy::kExact ? counts_.exact_culled
                                              : counts_.solver_culled);
    return;
  }
  contact.toc_lo = result.toc_lo;
  contact.toc_hi = result.toc_hi;
  ++counts_.contacts;
  sink_.add(contact);
}

void TrianglePairTest::testCrossing(const Side& edges, const Side& face,
                                    bool edges_on_a) {
  const MeshTriangle &e = edges.triangle, &f = face.triangle;
  for (unsigned k = 0; k < 3; ++k) {
    const unsigned l = (k + 1) % 3;
    if (!e.ownsEdge(k)) continue;
    if (self_ && (hasVertex(f, e.v[k]) || hasVertex(f, e.v[l]))) continue;
    bool apart = false;
    for (int axis = 0; axis < 3; ++axis)
      apart |= edges.edge[k].hi[axis][0] < face.face.lo[axis][0] ||
               face.face.hi[axis][0] < edges.edge[k].lo[axis][0];
    if (apart) continue;
    ++counts_.crossing_tests;
    if (!isCrossing(edges.x[k].t0, edges.x[l].t0, face.x[0].t0, face.x[1].t0,
                    face.x[2].t0))
      continue;
    has_crossing_ = true;
    crossing_.first_on_a = edges_on_a || self_;
    crossing_.edge[0] = e.v[k];
    crossing_.edge[1] = e.v[l];
    std::copy(f.v, f.v + 3, crossing_.face);
    const bool keep_order = edges_on_a || !self_;
    crossing_.triangles[0] = keep_order ? side_a_.index : side_b_.index;
    crossing_.triangles[1] = keep_order ? side_b_.index : side_a_.index;
    return;
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

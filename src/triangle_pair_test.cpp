// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/triangle_pair_test.h"

#include <algorithm>

#include "fcl/narrowphase/detail/deformable/instant_test.h"

namespace fcl {
namespace detail {
namespace deformable {

TrianglePairTest::TrianglePairTest(const MeshInstance& a, const MeshInstance& b,
                                   const QueryOptions& options)
    : options_(options),
      pair_(a, b),
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

void TrianglePairTest::visit(int i, int j, TimeWindow window) {
  pair_.load(i, j);
  ++counts_.triangle_pairs;
  if (window.lo <= 0.f && !has_crossing_) {
    testCrossing(pair_.sideA(), pair_.sideB(), true);
    if (!has_crossing_) testCrossing(pair_.sideB(), pair_.sideA(), false);
  }
  if (full_window_) window = {0.f, 1.f};
  pair_.forEachCandidate(window, counts_,
                         [this](const FeaturePair& features, double lo, double hi) {
                           testFeature(features, lo, hi);
                         });
}

void TrianglePairTest::testFeature(const FeaturePair& pair, double lo, double hi) {
  FeaturePoints points = pair_.pointsOf(pair);
  if (!mayBecomeCoplanar(pair.kind, points, lo, hi)) {
    ++counts_.filter_culled;
    return;
  }
  const FeatureIds ids = pair_.describe(pair, points);
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
  ++counts_.contacts;
  sink_.add({ids, result.toc_lo, result.toc_hi});
}

void TrianglePairTest::testCrossing(const TriangleSide& edges, const TriangleSide& face,
                                    bool edges_on_a) {
  const MeshTriangle &e = edges.triangle, &f = face.triangle;
  const bool self = pair_.isSelf();
  for (unsigned k = 0; k < 3; ++k) {
    const unsigned l = (k + 1) % 3;
    if (!e.ownsEdge(k)) continue;
    if (self && (hasVertex(f, e.v[k]) || hasVertex(f, e.v[l]))) continue;
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
    crossing_.first_on_a = edges_on_a || self;
    crossing_.edge[0] = e.v[k];
    crossing_.edge[1] = e.v[l];
    std::copy(f.v, f.v + 3, crossing_.face);
    const bool keep_order = edges_on_a || !self;
    crossing_.triangles[0] = keep_order ? pair_.sideA().index : pair_.sideB().index;
    crossing_.triangles[1] = keep_order ? pair_.sideB().index : pair_.sideA().index;
    return;
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

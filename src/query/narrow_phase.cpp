// SPDX-License-Identifier: BSD-3-Clause
#include "query/narrow_phase.h"

#include <cassert>

#include "elementary/elementary.h"
#include "query/crossing_stage.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Whether a pair of features may be met more than once.
bool mayRepeat(const MeshInstance& a, const MeshInstance& b) {
  return !a.hasOwners() || !b.hasOwners();
}

}  // namespace

NarrowPhase::NarrowPhase(const MeshInstance& a, const MeshInstance& b,
                         const BoxShifts& shifts, const QueryOptions& options,
                         QueryProgress& progress, std::size_t task, FirstBracket* first)
    : shifts_(shifts),
      shift_(shifts.shift(shifts.cullDistance(1))),
      batch_(a, b, shifts.isEmpty() ? nullptr : &shift_, kernels(),
             shifts.cullDistance(1)),
      findings_(options, mayRepeat(a, b), progress, task, first),
      touching_(batch_, findings_, mayRepeat(a, b)),
      distance_(batch_, findings_) {
  assert(&a == &b || !shifts.isEmpty());
  assert(options.ignores_initially_closer ||
         shifts.cullDistance(1) >= options.min_distance);
}

void NarrowPhase::setCullDistance(double cull_distance) {
  if (cull_distance == batch_.cullDistance()) return;
  shift_ = shifts_.shift(cull_distance);
  batch_.setCullDistance(&shift_, cull_distance);
}

void NarrowPhase::decide() {
  const double latest = findings_.latest();
  setCullDistance(shifts_.cullDistance(latest));
  batch_.cullTriangles(latest, findings_.counts());
  findCrossings(batch_, findings_);
  const bool is_at_start = distance_.onlyStartMatters(latest);
  for (const ContinuousContactKind kind :
       {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
    if (!(findings_.options().min_distance > 0))
      runStages(touching_.of(kind, latest));
    else if (findings_.sink().mayKeepAtStart(kind))
      runDistanceStages(distance_.of(kind, latest, is_at_start));
  }
  batch_.clear();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

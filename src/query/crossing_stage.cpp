// SPDX-License-Identifier: BSD-3-Clause
#include "query/crossing_stage.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "base/bits.h"
#include "elementary/predicates.h"
#include "kernels/kernels.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

bool isCrossingAt(const FeatureBatch& batch, std::size_t i) {
  const TreeVertex* x[5];
  crossingPoints(batch.pairs(), batch.crossings()[i], x);
  const auto start = [&x](int k) -> const double(&)[3] {
    return reinterpret_cast<const double(&)[3]>(x[k]->t0);
  };
  return isCrossing(start(0), start(1), start(2), start(3), start(4));
}

Crossing crossingAt(const FeatureBatch& batch, std::size_t i) {
  const FeatureBatch::EdgeAndFace c = batch.crossing(i);
  const bool self = batch.isSelf();
  const TreeTriangle &edge = c.edge_on_a ? *c.pair->a : *c.pair->b,
                     &face = c.edge_on_a ? *c.pair->b : *c.pair->a;
  Crossing crossing;
  crossing.first_on_a = c.edge_on_a || self;
  crossing.edge[0] = edge.id[c.edge];
  crossing.edge[1] = edge.id[(c.edge + 1) % 3];
  std::copy(face.id, face.id + 3, crossing.face);
  crossing.triangles[0] = static_cast<std::int32_t>((self ? edge : *c.pair->a).index);
  crossing.triangles[1] = static_cast<std::int32_t>((self ? face : *c.pair->b).index);
  return crossing;
}

/// Sets the triangles of the crossing to two that the filter accepts; false if there are
/// none.
bool accept(const PairFilter& filter, Crossing& crossing) {
  const HeldFeature edge{crossing.edge, 2,
                         crossing.triangles[crossing.first_on_a ? 0 : 1]},
      face{crossing.face, 3, crossing.triangles[crossing.first_on_a ? 1 : 0]};
  return crossing.first_on_a ? filter.find(edge, face, crossing.triangles)
                             : filter.find(face, edge, crossing.triangles);
}

}  // namespace

void findCrossings(const FeatureBatch& batch, TaskFindings& findings) {
  const PairFilter* filter = findings.options().filter;
  const std::size_t size = batch.numCrossings();
  for (std::size_t first = 0; first < size && findings.wantsCrossings(); first += 8) {
    const std::size_t count = std::min<std::size_t>(size - first, 8);
    findings.counts().crossing_tests += count;
    for (unsigned left =
             kernels().mayCross(batch.pairs(), batch.crossings() + first, count);
         left != 0 && findings.wantsCrossings(); left &= left - 1) {
      assert(left >> count == 0);
      const std::size_t i = first + static_cast<std::size_t>(lowestBit(left));
      if (!isCrossingAt(batch, i)) continue;
      Crossing crossing = crossingAt(batch, i);
      if (!filter || accept(*filter, crossing)) findings.add(crossing);
    }
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

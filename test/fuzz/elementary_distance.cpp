// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of features at a distance. Textbook formulas in Real, at samples of the step,
// look for a fault in each pair. They round, so that a suspicion goes to the oracle, and
// so does every 16th pair.
#include <algorithm>
#include <cmath>
#include <vector>

#include "elementary/distance_advance.h"
#include "family.h"
#include "oracle/distance_check.h"
#include "oracle/exact_oracle.h"
#include "pair_as_test.h"
#include "real_distance.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;
using fcl::ContinuousContactKind;

/// The distance of the features at t.
Real distanceAt(const MovingPair& pair, Real t) {
  RealVector p[4];
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      p[i][k] = (1 - t) * pair.x[i].t0[k] + t * Real{pair.x[i].t1[k]};
  switch (pair.kind) {
    case ContinuousContactKind::kVertexFace:
      return pointToTriangle(p[0], p[1], p[2], p[3]);
    case ContinuousContactKind::kEdgeEdge:
      return segmentToSegment(p[0], p[1], p[2], p[3]);
    case ContinuousContactKind::kVertexEdge:
      return pointToSegment(p[0], p[1], p[2]);
    default:
      return (p[0] - p[1]).norm();
  }
}

/// What is certain of a contact at a distance: doc/thickness.md.
struct Promise {
  Promise(const MovingPair& pair, double distance)
      : size(DifferencePolygon(pair.kind, pair.points()).size()),
        reach((distance * (1 + 1e-9) + 0x1p-44 * (distance + size)) * (1 + 0x1p-50)) {}
  double size, reach;
};

/// Whether samples contradict the answer, or nearly so.
bool isSuspect(const MovingPair& pair, double distance, const Promise& promise,
               const std::vector<DistanceContact>& found) {
  constexpr int kSamples = 16;
  const Real slack = 0x1p-50L * (promise.size + distance);
  const Real until = found.empty() ? 1 : found[0].toc_lo;
  for (int i = 0; i < kSamples; ++i)
    if (distanceAt(pair, until * i / kSamples) < distance - slack) return true;
  const Real at_end = distanceAt(pair, until);
  if (found.empty()) return at_end < distance - slack;
  return at_end > promise.reach - slack ||
         (found[0].toc_hi > found[0].toc_lo &&
          distanceAt(pair, found[0].toc_hi) > distance - slack);
}

void expectOracle(const MovingPair& pair, double d, const Promise& promise,
                  const std::vector<DistanceContact>& found, Outcome& outcome) {
  const FeaturePoints x = pair.points();
  const OracleAnswer truth = askDistanceOracle(pair.kind, x, d);
  if (found.empty()) {
    if (truth.touch()) outcome.blame(&Outcome::missed, "missed\n");
    return;
  }
  const DistanceContact& c = found[0];
  if (truth.touch() && truth.compareTime(c.toc_lo) < 0)
    outcome.blame(&Outcome::late, "late\n");
  if (std::isfinite(promise.size) && !c.is_given_up &&
      !isWithinAt(pair.kind, x, promise.reach, c.toc_lo))
    outcome.blame(truth.touch() ? &Outcome::early : &Outcome::invented,
                  "reported too far apart\n");
  if (c.toc_hi > c.toc_lo && !isWithinAt(pair.kind, x, d, c.toc_hi))
    outcome.blame(&Outcome::invented, "the upper end is not within the distance\n");
}

Outcome atADistance(std::uint64_t seed) {
  Outcome outcome;
  const auto [pair, distance] = distanceQuery(seed);
  DistanceRequest request;
  request.distance = distance;
  request.toc_err = 1e-6;
  std::vector<DistanceContact> found{outcome.timed(
      [&, p = &pair] { return advanceToDistance(p->kind, p->points(), request); })};
  if (!found[0].is_contact) found.clear();
  outcome.contacts = found.size();
  applyPlantedFault(found);
  outcome.addToDigest(found.empty() ? 2 : found[0].toc_lo);
  const Promise promise(pair, distance);
  if (seed % 16 == 0 || isSuspect(pair, distance, promise, found))
    expectOracle(pair, distance, promise, found, outcome);
  if (outcome.isRight()) return outcome;
  std::ostringstream text;
  text << "distance " << std::hexfloat << distance << "\n";
  outcome.complaint += text.str() + asTest(pair, request.toc_err, "");
  return outcome;
}

const RegisteredFamily kDistance("elementary-distance", atADistance, 50);

}  // namespace
}  // namespace test
}  // namespace fcl

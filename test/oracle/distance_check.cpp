// SPDX-License-Identifier: BSD-3-Clause
#include "distance_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "elementary/distance_advance.h"
#include "exact_oracle.h"
#include "query_check.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;
using fcl::ContinuousContactKind;

double distanceAt(const DifferencePolygon& polygon, double t) {
  Vec corners[DifferencePolygon::kMaxCorners];
  for (int k = 0; k < polygon.count(); ++k) corners[k] = polygon.at(k, t);
  return std::sqrt(nearestPoint(polygon, corners).square);
}

/// The time of about the least distance: the best of many times, and then ever closer.
double timeOfLeastDistance(const DifferencePolygon& polygon) {
  constexpr int kTimes = 32;
  double best = 0, width = 1;
  for (int round = 0; round < 8; ++round) {
    const double lo = std::max(0., best - width), hi = std::min(1., best + width);
    for (int i = 0; i <= kTimes; ++i) {
      const double t = std::min(1., lo + (hi - lo) * i / kTimes);
      if (distanceAt(polygon, t) < distanceAt(polygon, best)) best = t;
    }
    width *= 2. / kTimes;
  }
  return best;
}

}  // namespace

DistanceQuery distanceQuery(std::uint64_t number) {
  Random random(number ^ 0x5bd1e995);
  DistanceQuery query{generatedQuery(number), 0};
  MovingPair& pair = query.pair;
  const std::size_t kind = random.index(6);
  if (kind == 0) pair.kind = ContinuousContactKind::kVertexEdge;
  if (kind == 1) pair.kind = ContinuousContactKind::kVertexVertex;
  const DifferencePolygon polygon(pair.kind, pair.points());
  double t = random.uniform(0, 1), d = 0;
  const std::size_t how = random.index(4);
  if (how == 0) t = timeOfLeastDistance(polygon);
  if (how < 2) {
    constexpr double kFactors[] = {1,           1 + 1e-9,    1 - 1e-9,
                                   1 + 0x1p-52, 1 - 0x1p-53, 1 + 2e-9};
    d = distanceAt(polygon, t) * kFactors[random.index(6)];
  }
  // What touches, or is apart by rounding only, gets a thickness too.
  if (!(d > 0x1p-40 * polygon.size()) || !std::isfinite(d)) {
    const double size =
        polygon.size() > 0 && std::isfinite(polygon.size()) ? polygon.size() : 1;
    d = size * std::pow(10, random.uniform(-9, 0));
  }
  query.distance = std::max(d, std::numeric_limits<double>::denorm_min());
  return query;
}

std::string distanceDisagreement(const DistanceQuery& query, DistanceTally& tally) {
  const auto& [pair, d] = query;
  const FeaturePoints x = pair.points();
  DistanceRequest request;
  request.distance = d;
  request.toc_err = 1e-6;
  const DistanceContact found = advanceToDistance(pair.kind, x, request);
  std::string wrong;
  const auto expect = [&wrong](bool is_right, const char* what) {
    if (!is_right) wrong += std::string(what) + "\n";
  };
  const OracleAnswer truth = askDistanceOracle(pair.kind, x, d);
  if (!found.is_contact) {
    expect(!truth.touch(), "a contact is missed");
  } else {
    const double size = DifferencePolygon(pair.kind, x).size();
    const double reach =
        (d * (1 + DistanceTolerance::kShare) + DistanceTolerance(d, size).touching) *
        (1 + 0x1p-50);
    if (std::isfinite(size) && !found.is_given_up)
      expect(isWithinAt(pair.kind, x, reach, found.toc_lo), "reported too far apart");
    if (truth.touch()) expect(truth.compareTime(found.toc_lo) >= 0, "too late");
    expect(found.toc_hi - found.toc_lo <= std::min(request.toc_err, 0.125 * found.toc_hi),
           "bracket too wide");
    if (found.toc_hi > found.toc_lo)
      expect(isWithinAt(pair.kind, x, d, found.toc_hi), "upper end not within d");
  }
  ++tally.queries;
  tally.contacts += found.is_contact;
  tally.contacts_at_start += found.is_contact && found.toc_lo == 0;
  tally.grazes += found.is_contact && found.toc_lo > 0 && found.toc_hi == found.toc_lo;
  tally.given_up += found.is_given_up;
  tally.steps += static_cast<std::size_t>(found.steps);
  tally.most_steps = std::max(tally.most_steps, static_cast<std::size_t>(found.steps));
  if (wrong.empty()) return wrong;
  std::ostringstream text;
  text << wrong << "kind " << static_cast<int>(pair.kind) << ", distance "
       << std::hexfloat << d << ", found [" << found.toc_lo << ", " << found.toc_hi
       << "] after " << found.steps << " steps\n"
       << pair;
  return text.str();
}

}  // namespace test
}  // namespace fcl

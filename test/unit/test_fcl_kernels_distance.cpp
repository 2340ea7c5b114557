// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel of the distance filter, against the scalar test that follows it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "elementary/distance_advance.h"
#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "windowed_pairs.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::allSets;
using test::MovingPair;
using test::Random;
using test::scatteredPair;

/// Pairs of one kind as features of triangle pairs.
struct DistanceBlock {
  std::vector<TreeVertex> vertices{33};
  TrianglePair pairs[8];
  std::uint32_t codes[8];
  TimeWindow windows[8];

  explicit DistanceBlock(const MovingPair (&queries)[8]) {
    // Not of any feature.
    for (double* x : {vertices[32].t0, vertices[32].t1})
      std::fill(x, x + 4, std::numeric_limits<double>::quiet_NaN());
    for (std::uint32_t lane = 0; lane < 8; ++lane) {
      const bool vf = queries[lane].kind == ContinuousContactKind::kVertexFace;
      const int bit = vf ? static_cast<int>(lane) % 6 : 6 + static_cast<int>(lane);
      std::fill(pairs[lane].x, pairs[lane].x + 6, &vertices[32]);
      for (std::size_t i = 0; i < 4; ++i) {
        const VertexPath& path = queries[lane].x[i];
        TreeVertex& x = vertices[4 * lane + i];
        x.setPath(path.t0, path.t1);
        pairs[lane].x[kFeaturePoints[bit][i]] = &x;
      }
      codes[lane] = featureCode(lane, bit);
      windows[lane] = {0, 1};
    }
  }
};

struct Found {
  int culled{0}, contacts{0}, apart{0};
};

/// No instruction set culls what the scalar test reports until `latest`, and all find the
/// same.
Found expectRightFilter(const MovingPair (&queries)[8], double distance, double latest) {
  const DistanceBlock block(queries);
  const ContinuousContactKind kind = queries[0].kind;
  unsigned contacts = 0;
  for (unsigned lane = 0; lane < 8; ++lane) {
    DistanceRequest request;
    request.distance = distance;
    request.t_max = latest;
    contacts |=
        unsigned{advanceToDistance(kind, queries[lane].points(), request).is_contact}
        << lane;
  }
  const unsigned found = allSets().front()->mayComeWithin(
      kind, block.pairs, block.codes, block.windows, 8, latest, distance);
  EXPECT_EQ(contacts & ~found, 0U) << distance;
  for (const Kernels* k : allSets())
    for (const std::size_t count : {8, 3, 1})
      EXPECT_EQ(k->mayComeWithin(kind, block.pairs, block.codes, block.windows, count,
                                 latest, distance),
                found & ((1U << count) - 1))
          << k->name;
  return {8 - __builtin_popcount(found), __builtin_popcount(contacts),
          8 - __builtin_popcount(contacts)};
}

TEST(FCL_KERNELS, distanceFilterNeverCullsAContact) {
  Random random(71);
  Found sum;
  for (int i = 0; i < 6000 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    MovingPair queries[8];
    // Half of them move little, as the pairs of a scene do.
    const double motion = i % 2 ? 1 : 0.05;
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      for (auto& p : pair.x)
        for (int k = 0; k < 3; ++k) p.t1[k] = p.t0[k] + motion * (p.t1[k] - p.t0[k]);
    }
    const double latest = random.index(2) ? 1 : random.uniform(0.2, 1);
    const Found n =
        expectRightFilter(queries, std::pow(10, random.uniform(-6, 0)), latest);
    sum.culled += n.culled;
    sum.contacts += n.contacts;
    sum.apart += n.apart;
  }
  EXPECT_GT(sum.contacts, 2000);
  // Most of what stays apart.
  EXPECT_GT(sum.culled, sum.apart * 3 / 4);
}

/// At the distance at which pairs at rest are, but for 1e-9 or a rounding of it.
TEST(FCL_KERNELS, distanceFilterOfGrazes) {
  Random random(72);
  int contacts = 0, culled = 0;
  for (int i = 0; i < 3000 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    MovingPair queries[8];
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      for (auto& p : pair.x) std::copy(p.t0, p.t0 + 3, p.t1);
    }
    const DifferencePolygon polygon(kind, queries[random.index(8)].points());
    Vec corners[4];
    for (int k = 0; k < polygon.count(); ++k) corners[k] = polygon.t0(k);
    constexpr double kFactors[] = {1,        1 - 0x1p-50, 1 + 0x1p-50,
                                   1 - 1e-9, 1 + 1e-9,    1 - 3e-9};
    const double distance =
        std::sqrt(nearestPoint(polygon, corners).square) * kFactors[random.index(6)];
    const Found n = expectRightFilter(queries, distance, 1);
    contacts += n.contacts;
    culled += n.culled;
  }
  EXPECT_GT(contacts, 3000);
  EXPECT_GT(culled, 3000);
}

/// Sizes over all of double's range, and coordinates that are not finite.
TEST(FCL_KERNELS, distanceFilterOfAllSizes) {
  Random random(73);
  int culled = 0;
  for (int exponent = -1074; exponent <= 1023; exponent += 3) {
    const ContinuousContactKind kind = test::randomKind(random);
    MovingPair queries[8];
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      scale(pair, std::ldexp(1, exponent));
    }
    culled +=
        expectRightFilter(queries, std::ldexp(random.uniform(0.01, 0.1), exponent), 1)
            .culled;
  }
  EXPECT_GT(culled, 300);
  MovingPair queries[8];
  for (MovingPair& pair : queries) {
    pair = scatteredPair(random, ContinuousContactKind::kEdgeEdge);
    pair.x[random.index(4)].t1[random.index(3)] =
        random.index(2) ? std::numeric_limits<double>::quiet_NaN()
                        : std::numeric_limits<double>::infinity();
  }
  const DistanceBlock block(queries);
  for (const Kernels* k : allSets())
    EXPECT_EQ(k->mayComeWithin(ContinuousContactKind::kEdgeEdge, block.pairs, block.codes,
                               block.windows, 8, 1, 1e-3),
              0xffU)
        << k->name;
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

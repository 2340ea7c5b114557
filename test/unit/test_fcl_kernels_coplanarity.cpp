// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel of the coplanarity filter, against the scalar one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "elementary/coplanarity_filter.h"
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
using test::randomWindow;
using test::scatteredPair;
using test::WindowedPair;

/// The numbers of pairs, out of eight, with each answer of the filter.
struct FilterCounts {
  int may{0};      // may become coplanar, final answer
  int unclear{0};  // unclear in doubles
};

/// Pairs as features of triangle pairs that also have other vertices, with windows.
struct FilterBlock {
  std::vector<TreeVertex> vertices;
  TrianglePair pairs[8];
  std::uint32_t codes[8];
  detail::deformable::TimeWindow windows[8];

  explicit FilterBlock(const WindowedPair (&queries)[8]) : vertices(33) {
    // A vertex that belongs to no feature.
    for (double* x : {vertices[32].t0, vertices[32].t1})
      std::fill(x, x + 4, std::numeric_limits<double>::quiet_NaN());
    for (std::uint32_t lane = 0; lane < 8; ++lane) {
      const WindowedPair& q = queries[lane];
      const bool vf = q.pair.kind == ContinuousContactKind::kVertexFace;
      const int bit = vf ? static_cast<int>(lane) % 6 : 6 + static_cast<int>(lane);
      const std::uint32_t place = (3 * lane + 5) % 8;
      std::fill(pairs[place].x, pairs[place].x + 6, &vertices[32]);
      for (std::size_t i = 0; i < 4; ++i) {
        const VertexPath& path = q.pair.x[i];
        TreeVertex& x = vertices[4 * lane + i];
        x.setPath(path.t0, path.t1);
        pairs[place].x[kFeaturePoints[bit][i]] = &x;
      }
      codes[lane] = featureCode(place, bit);
      windows[lane] = {static_cast<float>(q.lo), static_cast<float>(q.hi)};
    }
  }
};

/// Expects that every instruction set gives the answers of the scalar filter, lane by
/// lane, and the same decision where both continue in double-double.
FilterCounts expectRightFilter(const WindowedPair (&queries)[8], double latest = 1) {
  const FilterBlock block(queries);
  const ContinuousContactKind kind = queries[0].pair.kind;
  unsigned possible = 0, unclear = 0, may = 0, may_accurately = 0;
  for (unsigned lane = 0; lane < 8; ++lane) {
    const FeaturePoints x = queries[lane].pair.points();
    const double lo = windowLo(block.windows[lane]),
                 hi = std::min(windowHi(block.windows[lane]), latest);
    const Coplanarity found = coplanarityInDoubles(kind, x, lo, hi);
    possible |= unsigned{found == Coplanarity::kPossible} << lane;
    unclear |= unsigned{found == Coplanarity::kUnclear} << lane;
    may |= unsigned{mayBecomeCoplanar(kind, x, lo, hi)} << lane;
    may_accurately |= unsigned{mayBecomeCoplanarAccurately(kind, x, lo, hi)} << lane;
  }
  for (const Kernels* k : allSets())
    for (const std::size_t count : {8, 1}) {
      const EightCoplanarities found =
          k->coplanarity(kind, block.pairs, block.codes, block.windows, count, latest);
      const unsigned used = (1U << count) - 1;
      EXPECT_EQ(found.possible | (found.unclear & may_accurately), may & used) << k->name;
      EXPECT_EQ(found.possible, possible & used) << k->name;
      EXPECT_EQ(found.unclear, unclear & used) << k->name;
      for (unsigned lane = 0; lane < count; ++lane)
        if (((found.possible ^ possible) | (found.unclear ^ unclear)) >> lane & 1U)
          ADD_FAILURE() << queries[lane].pair << std::hexfloat << " in ["
                        << queries[lane].lo << ", " << queries[lane].hi << "] until "
                        << latest;
    }
  return {__builtin_popcount(may), __builtin_popcount(unclear)};
}

/// The same for blocks of random pairs and windows.
/// @param make_pair  from the random numbers and a kind
template <typename MakePair>
FilterCounts expectRightFilter(std::uint64_t seed, int num_blocks, MakePair&& make_pair) {
  Random random(seed);
  FilterCounts sum;
  for (int i = 0; i < num_blocks && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(i));
    const ContinuousContactKind kind = randomKind(random);
    WindowedPair queries[8];
    for (WindowedPair& q : queries) {
      q.pair = make_pair(random, kind);
      randomWindow(random, q.lo, q.hi);
    }
    const double latest = random.index(2) ? 1 : random.uniform(0.5, 1);
    const FilterCounts n = expectRightFilter(queries, latest);
    sum.may += n.may;
    sum.unclear += n.unclear;
  }
  return sum;
}

TEST(FCL_KERNELS, filterAsTheScalarOne) {
  constexpr int kBlocks = 20000;
  const FilterCounts n = expectRightFilter(74, kBlocks, scatteredPair);
  EXPECT_GT(n.may, kBlocks / 2);
  EXPECT_LT(n.may, 7 * kBlocks);
  EXPECT_LT(n.unclear, kBlocks / 1000);  // doubles are enough for most
}

// Sizes over all of double's range: products that underflow or overflow, and the edges of
// the range in which the bounds hold.
TEST(FCL_KERNELS, filterOfAllSizes) {
  constexpr std::uint64_t kSeed = 75;
  Random random(kSeed);
  int may = 0, never = 0;
  for (int exponent = -1074; exponent <= 1023; ++exponent)
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      WindowedPair queries[8];
      for (WindowedPair& q : queries) {
        q.pair = scatteredPair(random, kind);
        scale(q.pair, std::ldexp(1, exponent));
        // Only one point has another size.
        if (random.index(3) == 0)
          for (int k = 0; k < 3; ++k)
            q.pair.x[random.index(4)].t1[k] *= std::ldexp(1, exponent / 2);
        randomWindow(random, q.lo, q.hi);
      }
      const int n = expectRightFilter(queries).may;
      may += n;
      never += 8 - n;
      ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", 2^" << exponent;
    }
  EXPECT_GT(may, 5000);
  EXPECT_GT(never, 1000);
}

// Signs that agree, with values far below the bound on rounding or near it. Around the
// bound every instruction set is on the same side of it.
TEST(FCL_KERNELS, filterOfNarrowSigns) {
  constexpr int kBlocks = 5000;
  const auto makePair = [](Random& random, ContinuousContactKind kind) {
    // A slope z = a x + b y, and the first feature a little above it.
    const double a = random.uniform(-2, 2), b = random.uniform(-2, 2);
    const double gap =
        random.uniform(0x1p-54, 0x1p-53) * static_cast<double>(1U << random.index(16));
    MovingPair pair = scatteredPair(random, kind);
    for (int n = 0; n < 4; ++n) {
      VertexPath& p = pair.x[n];
      const bool above = n < (kind == ContinuousContactKind::kVertexFace ? 1 : 2);
      p.t0[2] = a * p.t0[0] + b * p.t0[1] + (above ? gap : 0);
      p.t1[2] = a * p.t1[0] + b * p.t1[1] + (above ? gap : 0);
    }
    return pair;
  };
  const FilterCounts n = expectRightFilter(78, kBlocks, makePair);
  EXPECT_GT(n.may, kBlocks);
  EXPECT_LT(n.may, 7 * kBlocks);
  EXPECT_GT(n.unclear, kBlocks);
}

// Pairs that are flat, at rest, or touch all the time. What is nearly or exactly coplanar
// "may" become coplanar.
TEST(FCL_KERNELS, filterOfDegeneratePairs) {
  expectRightFilter(76, 5000, [](Random& random, ContinuousContactKind kind) {
    MovingPair pair = scatteredPair(random, kind);
    auto& x = pair.x;
    switch (random.index(6)) {
      case 0:  // all in one plane
        for (VertexPath& p : x) p.t0[2] = p.t1[2] = 0.25;
        break;
      case 1:  // at rest
        for (VertexPath& p : x) std::copy(p.t0, p.t0 + 3, p.t1);
        break;
      case 2:  // no normal
        x[1] = x[random.index(4)];
        break;
      case 3:  // a unit in the last place off a plane
        for (VertexPath& p : x) p.t0[2] = p.t1[2] = 1;
        x[random.index(4)].t1[2] = std::nextafter(1, 2);
        break;
      case 4:  // far away
        for (VertexPath& p : x)
          for (int k = 0; k < 3; ++k) {
            p.t0[k] += 1e9;
            p.t1[k] += 1e9;
          }
        break;
      default:  // one point for all
        for (VertexPath& p : x) p = x[0];
    }
    return pair;
  });
}

// Coordinates that are not finite prove nothing, even if the window ends before they
// matter, and do not change the other lanes.
TEST(FCL_KERNELS, filterKeepsWhatIsNotFinite) {
  constexpr std::uint64_t kSeed = 77;
  Random random(kSeed);
  const double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity()};
  int never = 0;
  for (int i = 0; i < 20000; ++i) {
    const ContinuousContactKind kind = randomKind(random);
    WindowedPair queries[8];
    unsigned bad = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      WindowedPair& q = queries[lane];
      q.pair = scatteredPair(random, kind);
      randomWindow(random, q.lo, q.hi);
      if (random.index(2)) continue;
      bad |= 1U << lane;
      if (random.index(8) == 0) {
        (random.index(2) ? q.lo : q.hi) = kBad[0];
        continue;
      }
      for (std::size_t n = 1 + random.index(3); n-- > 0;) {
        VertexPath& x = q.pair.x[random.index(4)];
        (random.index(2) ? x.t0 : x.t1)[random.index(3)] = kBad[random.index(3)];
      }
    }
    never += 8 - expectRightFilter(queries).may;
    const FilterBlock block(queries);
    for (const Kernels* k : allSets())
      ASSERT_EQ(
          k->coplanarity(kind, block.pairs, block.codes, block.windows, 8, 1).possible &
              bad,
          bad)
          << k->name;
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(never, 1000);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of contact at a distance, against the scalar test: the filters before it,
// the advancement of eight pairs, and the least distance of pairs at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "elementary/distance_advance.h"
#include "elementary/least_distance.h"
#include "feature_distance.h"
#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "query/distance_contact.h"
#include "sanitizer.h"
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
  detail::deformable::TimeWindow windows[8];

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

DistanceRequest requestUntil(double latest, double distance) {
  DistanceRequest request;
  request.distance = distance;
  request.t_max = request.t_stop = latest;
  return request;
}

/// No instruction set culls what the scalar test reports, and all find the same.
Found expectRightFilter(const MovingPair (&queries)[8], const DistanceRequest& request) {
  const DistanceBlock block(queries);
  const ContinuousContactKind kind = queries[0].kind;
  unsigned contacts = 0;
  for (unsigned lane = 0; lane < 8; ++lane) {
    contacts |=
        unsigned{advanceToDistance(kind, queries[lane].points(), request).is_contact}
        << lane;
  }
  const unsigned found = allSets().front()->mayComeWithin(
      kind, block.pairs, block.codes, block.windows, 8, request, PairBends());
  EXPECT_EQ(contacts & ~found, 0U) << request.distance;
  for (const Kernels* k : allSets())
    for (const std::size_t count : {8, 3, 1})
      EXPECT_EQ(k->mayComeWithin(kind, block.pairs, block.codes, block.windows, count,
                                 request, PairBends()),
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
    const Found n = expectRightFilter(
        queries, requestUntil(latest, std::pow(10, random.uniform(-6, 0))));
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
    const Found n = expectRightFilter(queries, requestUntil(1, distance));
    contacts += n.contacts;
    culled += n.culled;
  }
  EXPECT_GT(contacts, 3000);
  EXPECT_GT(culled, 3000);
}

/// Pairs that are nearer than the distance at t = 0, and ignored then: the filter leaves
/// out those that do not come nearer until an early time. Some rest, some move together,
/// and some almost touch.
TEST(FCL_KERNELS, distanceFilterOfIgnoredPairs) {
  Random random(77);
  Found sum;
  for (int i = 0; i < 8000 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    const double latest = std::pow(10, random.uniform(-14, -1.3));
    MovingPair queries[8];
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      const Vector3<double> way = random.point(1);
      const double apart = random.index(4) ? 1 : std::pow(10, random.uniform(-13, 0));
      const int moves = static_cast<int>(random.index(3));
      for (auto& p : pair.x)
        for (int k = 0; k < 3; ++k) {
          // Nearer to each other in one direction.
          if (k == i % 3) p.t0[k] *= apart;
          if (moves < 2) p.t1[k] = p.t0[k] + (moves == 1 ? way[k] : 0);
        }
    }
    DistanceRequest request = requestUntil(latest, std::pow(10, random.uniform(-2, 0)));
    request.ignores_initially_closer = true;
    const Found n = expectRightFilter(queries, request);
    sum.culled += n.culled;
    sum.contacts += n.contacts;
    sum.apart += n.apart;
  }
  EXPECT_GT(sum.contacts, 1000);
  EXPECT_GT(sum.culled, sum.apart / 2);
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
        expectRightFilter(
            queries, requestUntil(1, std::ldexp(random.uniform(0.01, 0.1), exponent)))
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
                               block.windows, 8, requestUntil(1, 1e-3), PairBends()),
              0xffU)
        << k->name;
}

/// What the advancement of eight pairs has found, and how many pairs it left open.
struct Advanced {
  int contacts{0}, moving_contacts{0}, brackets{0}, apart{0}, open{0};

  void operator+=(const Advanced& other) {
    contacts += other.contacts;
    moving_contacts += other.moving_contacts;
    brackets += other.brackets;
    apart += other.apart;
    open += other.open;
  }
};

void expectSameContact(const DistanceContact& found, const DistanceContact& expected) {
  EXPECT_EQ(std::memcmp(&found.toc_lo, &expected.toc_lo, sizeof(double)), 0)
      << found.toc_lo << " " << expected.toc_lo;
  EXPECT_EQ(std::memcmp(&found.toc_hi, &expected.toc_hi, sizeof(double)), 0)
      << found.toc_hi << " " << expected.toc_hi;
  EXPECT_EQ(found.kind, expected.kind);
  EXPECT_EQ(std::vector<int>(found.points, found.points + 4),
            std::vector<int>(expected.points, expected.points + 4));
}

/// Each instruction set gives the answers of the scalar test, to the bit, or leaves the
/// same pairs open.
Advanced expectSameAdvance(const std::vector<MovingPair>& queries,
                           const DistanceRequest& request) {
  std::vector<TreeVertex> vertices(4 * queries.size());
  std::vector<FourPoints> pairs(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n)
    for (std::size_t i = 0; i < 4; ++i) {
      TreeVertex& x = vertices[4 * n + i];
      x.setPath(queries[n].x[i].t0, queries[n].x[i].t1);
      pairs[n].x[i] = &x;
    }
  const ContinuousContactKind kind = queries[0].kind;
  const auto isOpen = [](const Approach& found) {
    return found.answer == Approach::Answer::kOpen;
  };
  std::vector<Approach> first(queries.size());
  allSets().front()->approach(kind, pairs.data(), pairs.size(), request, first.data());
  Advanced sum;
  for (const Kernels* k : allSets()) {
    std::vector<Approach> found(queries.size());
    k->approach(kind, pairs.data(), pairs.size(), request, found.data());
    sum = {};
    for (std::size_t n = 0; n < queries.size(); ++n) {
      SCOPED_TRACE(std::string(k->name) + " pair " + std::to_string(n));
      EXPECT_EQ(isOpen(found[n]), isOpen(first[n]));
      if (isOpen(found[n])) {
        ++sum.open;
        continue;
      }
      const DistanceContact expected =
          advanceToDistance(queries[n].kind, queries[n].points(), request);
      EXPECT_FALSE(expected.is_given_up);
      const bool is_contact = found[n].answer == Approach::Answer::kYes;
      EXPECT_EQ(is_contact, expected.is_contact);
      if (!expected.is_contact || !is_contact) {
        ++sum.apart;
        continue;
      }
      ++sum.contacts;
      sum.moving_contacts += expected.toc_lo > 0;
      sum.brackets += expected.toc_hi > expected.toc_lo;
      expectSameContact(contactOf(kind, found[n]), expected);
    }
  }
  return sum;
}

DistanceRequest randomRequest(Random& random, double distance) {
  DistanceRequest request;
  request.distance = distance;
  request.toc_err = random.index(2) ? 1e-4 : std::pow(10, random.uniform(-12, 0));
  request.t_max = random.index(3) ? 1 : random.uniform(0, 1);
  request.t_stop = random.index(3) ? 1 : random.uniform(0, 1);
  request.ignores_initially_closer = random.index(3) == 0;
  return request;
}

/// The plain steps are enough for nearly all pairs. Pairs of several eights are put
/// together again while they advance.
TEST(FCL_KERNELS, advancesAsTheScalarTest) {
  Random random(74);
  Advanced sum;
  for (int i = 0; i < 1500 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    std::vector<MovingPair> queries(1 + random.index(kMostApproaching));
    for (MovingPair& pair : queries) pair = scatteredPair(random, kind);
    sum += expectSameAdvance(queries,
                             randomRequest(random, std::pow(10, random.uniform(-6, 0))));
  }
  EXPECT_GT(sum.moving_contacts, 2000);
  EXPECT_GT(sum.brackets, 1000);
  EXPECT_GT(sum.apart, 3000);
  EXPECT_LT(sum.open, 1500 * 32 / 20);
}

/// Of points of one feature that coincide all the time the ids tell the order, which the
/// kernel does not know. Points of two features, or at one time only, may coincide.
TEST(FCL_KERNELS, leavesCoincidingPointsToTheScalarTest) {
  Random random(76);
  for (const auto kind :
       {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge})
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) {
        const int second = kind == ContinuousContactKind::kVertexFace ? 1 : 2;
        const bool is_one_feature = (i < second) == (j < second);
        for (const bool at_both : {false, true}) {
          const MovingPair pair = scatteredPair(random, kind);
          TreeVertex x[4];
          FourPoints points;
          for (int k = 0; k < 4; ++k) {
            const int l = k == i ? j : k;
            x[k].setPath(pair.x[l].t0, pair.x[at_both ? l : k].t1);
            points.x[k] = &x[k];
          }
          DistanceRequest request;
          request.distance = 100;
          for (const Kernels* k : allSets()) {
            Approach found[8];
            k->approach(kind, &points, 1, request, found);
            EXPECT_EQ(found[0].answer, is_one_feature && at_both ? Approach::Answer::kOpen
                                                                 : Approach::Answer::kYes)
                << k->name << " " << i << " " << j;
          }
        }
      }
}

/// Features without length or area, flat pairs and pairs at rest.
TEST(FCL_KERNELS, advancesDegeneratePairsAsTheScalarTest) {
  Random random(75);
  Advanced sum;
  for (int i = 0; i < 6000 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    std::vector<MovingPair> queries(8);
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      // A part of the pair is flat, has no length, or does not move.
      auto& p = pair.x[random.index(4)];
      const auto& q = pair.x[random.index(4)];
      if (random.index(2)) std::copy(q.t0, q.t0 + 3, p.t0);
      if (random.index(2)) std::copy(q.t1, q.t1 + 3, p.t1);
      const int axis = static_cast<int>(random.index(3));
      if (random.index(3) == 0)
        for (auto& x : pair.x) x.t0[axis] = x.t1[axis] = 0.25;
      if (random.index(4) == 0)
        for (auto& x : pair.x) std::copy(x.t0, x.t0 + 3, x.t1);
    }
    sum += expectSameAdvance(queries,
                             randomRequest(random, std::pow(10, random.uniform(-9, 0))));
  }
  EXPECT_GT(sum.contacts, 5000);
  EXPECT_GT(sum.apart, 2000);
}

/// What the test of eight pairs at t = 0 has found.
struct AtStart {
  int contacts{0}, far{0}, open{0};
};

/// Each instruction set gives the answers of the scalar test where only t = 0 matters, or
/// leaves the same pairs open.
/// @param size  no coordinate is larger
AtStart expectSameAtStart(const MovingPair (&queries)[8], double distance, double size) {
  const DistanceBlock block(queries);
  const ContinuousContactKind kind = queries[0].kind;
  // As cullDistanceOf(), for coordinates of this size.
  const double reach = distance * (1 + 2 * DistanceTolerance::kShare) +
                       2 * DistanceTolerance::kTouching * (distance + 2 * size);
  const auto test = [&](const Kernels& k, std::size_t count, Approach(&found)[8]) {
    return k.approachAtStart(kind, block.pairs, block.codes, count, distance, reach,
                             found);
  };
  Approach first[8];
  const unsigned left = test(*allSets().front(), 8, first);
  AtStart sum;
  for (const Kernels* k : allSets())
    for (const std::size_t count : {1, 3, 8}) {
      Approach found[8];
      EXPECT_EQ(test(*k, count, found), left & ((1U << count) - 1)) << k->name;
      sum = {};
      for (std::size_t n = 0; n < count; ++n) {
        SCOPED_TRACE(std::string(k->name) + " pair " + std::to_string(n));
        const DistanceContact expected =
            advanceToDistance(kind, queries[n].points(), requestUntil(0, distance));
        if ((left >> n & 1U) == 0) {
          EXPECT_FALSE(expected.is_contact);
          ++sum.far;
        } else if (found[n].answer == Approach::Answer::kYes) {
          EXPECT_TRUE(expected.is_contact);
          EXPECT_EQ(first[n].answer, Approach::Answer::kYes);
          expectSameContact(contactOf(kind, found[n]), expected);
          ++sum.contacts;
        } else {
          EXPECT_EQ(first[n].answer, Approach::Answer::kOpen);
          EXPECT_EQ(found[n].answer, Approach::Answer::kOpen);
          ++sum.open;
        }
      }
    }
  return sum;
}

/// Nearly all pairs are decided, but for those whose points coincide at t = 0 or whose
/// distance is the wanted one up to rounding.
TEST(FCL_KERNELS, findsContactsAtStartAsTheScalarTest) {
  Random random(77);
  AtStart sum[2];
  for (int i = 0; i < 6000 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    const bool is_degenerate = i % 2;
    MovingPair queries[8];
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      if (!is_degenerate) continue;
      auto& p = pair.x[random.index(4)];
      const auto& q = pair.x[random.index(4)];
      if (random.index(2)) std::copy(q.t0, q.t0 + 3, p.t0);
      const int axis = static_cast<int>(random.index(3));
      if (random.index(2))
        for (auto& x : pair.x) x.t0[axis] = 0.25;
    }
    const AtStart n =
        expectSameAtStart(queries, std::pow(10, random.uniform(-3, 0)), 100);
    sum[is_degenerate].contacts += n.contacts;
    sum[is_degenerate].far += n.far;
    sum[is_degenerate].open += n.open;
  }
  for (const AtStart& n : sum) {
    EXPECT_GT(n.contacts, 2000);
    EXPECT_GT(n.far, 2000);
  }
  EXPECT_LT(sum[0].open, 240);
  EXPECT_GT(sum[1].open, 300);
}

/// All sizes that the kernel takes, and points that are nearer to each other than the
/// squares of doubles reach.
TEST(FCL_KERNELS, findsContactsAtStartOfAllSizes) {
  Random random(79);
  AtStart sum;
  for (int exponent = -140; exponent <= 140; ++exponent)
    for (int i = 0; i < 8 && !testing::Test::HasFailure(); ++i) {
      const ContinuousContactKind kind = test::randomKind(random);
      const double size = std::ldexp(1, exponent);
      MovingPair queries[8];
      for (MovingPair& pair : queries) {
        pair = scatteredPair(random, kind);
        scale(pair, size);
        if (random.index(4)) continue;
        // Near the origin, and near the point.
        auto &p = pair.x[0], &q = pair.x[3];
        for (int k = 0; k < 3; ++k) {
          p.t0[k] = 0;
          q.t0[k] = random.uniform(-1, 1) * std::pow(10, random.uniform(-170, -150));
        }
      }
      const AtStart n =
          expectSameAtStart(queries, size * random.uniform(0.01, 0.5), 100 * size);
      sum.contacts += n.contacts;
      sum.far += n.far;
      sum.open += n.open;
    }
  EXPECT_GT(sum.contacts, 2000);
  EXPECT_GT(sum.far, 2000);
  EXPECT_LT(sum.open, 2000);
}

/// Sizes over all of double's range: the scalar test scales those that are extreme.
TEST(FCL_KERNELS, advancesAllSizesAsTheScalarTest) {
  Random random(76);
  Advanced sum;
  for (int exponent = -1074; exponent <= 1023; exponent += 3) {
    const ContinuousContactKind kind = test::randomKind(random);
    std::vector<MovingPair> queries(8);
    for (MovingPair& pair : queries) {
      pair = scatteredPair(random, kind);
      scale(pair, std::ldexp(1, exponent));
    }
    sum += expectSameAdvance(
        queries, randomRequest(random, std::ldexp(random.uniform(0.01, 0.5), exponent)));
  }
  EXPECT_GT(sum.contacts, 100);
  EXPECT_GT(sum.open, 2000);
}

/// Pairs at rest at t = 1: the bound of the scalar function, to the bit.
TEST(FCL_KERNELS, leastDistancesAsTheScalarFunction) {
  Random random(78);
  int known = 0, unknown = 0;
  for (int i = 0; i < 4000 && !testing::Test::HasFailure(); ++i) {
    const ContinuousContactKind kind = test::randomKind(random);
    std::vector<TreeVertex> vertices(32);
    EightPoints points;
    points.kind = kind;
    double expected[8];
    for (std::size_t lane = 0; lane < 8; ++lane) {
      MovingPair pair = scatteredPair(random, kind);
      // Some are flat.
      if (random.index(4) == 0)
        for (auto& x : pair.x) x.t1[i % 3] = 0.25;
      for (std::size_t k = 0; k < 4; ++k) {
        vertices[4 * lane + k].setPath(pair.x[k].t0, pair.x[k].t1);
        points.x[k][lane] = &vertices[4 * lane + k];
        std::copy(pair.x[k].t1, pair.x[k].t1 + 3, pair.x[k].t0);
      }
      expected[lane] = leastDistance(kind, pair.points());
    }
    double first[8];
    const unsigned found = allSets().front()->leastDistances(points, first);
    test::expectSameBits(found, first, expected);
    for (const Kernels* k : allSets()) {
      double least[8];
      EXPECT_EQ(k->leastDistances(points, least), found) << k->name;
      test::expectSameBits(found, least, expected);
    }
    known += __builtin_popcount(found);
    unknown += 8 - __builtin_popcount(found);
  }
  EXPECT_GT(known, 20000);
  EXPECT_GT(unknown, 100);
}

/// Two triangles that move.
struct TwoTriangles {
  std::vector<TreeVertex> vertices{6};
  VertexPath paths[6];
  TrianglePair pair{};

  TwoTriangles(Random& random, double motion) {
    const Vector3<double> away = random.point(1);
    for (std::size_t k = 0; k < 6; ++k) {
      const Vector3<double> p = random.point(1) + (k < 3 ? 0. : 1.) * away,
                            q = p + random.point(motion);
      std::copy(p.data(), p.data() + 3, paths[k].t0);
      std::copy(q.data(), q.data() + 3, paths[k].t1);
      vertices[k].setPath(paths[k].t0, paths[k].t1);
      pair.x[k] = &vertices[k];
    }
  }

  /// The distance of two triangles is that of their VF and EE pairs, unless they cross.
  bool comeWithin(double distance, double until) const {
    const auto test = [&](ContinuousContactKind kind, std::array<std::size_t, 4> id) {
      return advanceToDistance(
                 kind, {{&paths[id[0]], &paths[id[1]], &paths[id[2]], &paths[id[3]]}},
                 requestUntil(until, std::max(distance, 1e-9)))
          .is_contact;
    };
    bool comes_near = false;
    for (std::size_t k = 0; k < 3; ++k) {
      comes_near |= test(ContinuousContactKind::kVertexFace, {k, 3, 4, 5}) ||
                    test(ContinuousContactKind::kVertexFace, {3 + k, 0, 1, 2});
      for (std::size_t l = 0; l < 3; ++l)
        comes_near |= test(ContinuousContactKind::kEdgeEdge,
                           {k, (k + 1) % 3, 3 + l, 3 + (l + 1) % 3});
    }
    return comes_near;
  }
};

/// Triangles that a plane keeps further apart than a distance, until an early time.
TEST(FCL_KERNELS, trianglesThatStayApartByADistance) {
  Random random(79);
  int apart = 0, near = 0;
  for (int i = 0; i < 6000 && !testing::Test::HasFailure(); ++i) {
    const double distance = i % 3 ? std::pow(10, random.uniform(-4, -0.3)) : 0,
                 share = std::pow(10, random.uniform(-4, -1.3));
    const TwoTriangles x(random, 0.5);
    float gaps[8];
    const bool is_apart =
        allSets().front()->areApart(&x.pair, 1, share * (1 + 0x1p-50), distance, gaps) &
        1U;
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->areApart(&x.pair, 1, share * (1 + 0x1p-50), distance, gaps) & 1U,
                unsigned{is_apart})
          << k->name;
    const bool comes_near = x.comeWithin(distance, share);
    EXPECT_FALSE(is_apart && comes_near) << distance << " until " << share;
    apart += is_apart && distance > 0;
    near += comes_near && distance > 0;
  }
  EXPECT_GT(apart, 200);
  EXPECT_GT(near, 200);
}

/// Triangles that a plane keeps further apart than a distance during the whole step.
TEST(FCL_KERNELS, trianglesThatStayApartThroughout) {
  Random random(80);
  int apart = 0, near = 0;
  for (int i = 0; i < 1000 && !testing::Test::HasFailure(); ++i) {
    const double distance = std::pow(10, random.uniform(-4, -0.3)),
                 motion = std::pow(10, random.uniform(-2, 0));
    const std::vector<TwoTriangles> x = [&] {
      std::vector<TwoTriangles> made;
      made.reserve(8);
      for (int k = 0; k < 8; ++k) made.emplace_back(random, motion);
      return made;
    }();
    TrianglePair pairs[8];
    for (std::size_t k = 0; k < 8; ++k) pairs[k] = x[k].pair;
    const unsigned found = allSets().front()->stayApart(pairs, 8, distance, PairBends());
    for (const Kernels* k : allSets())
      for (const std::size_t count : {8, 5, 1})
        EXPECT_EQ(k->stayApart(pairs, count, distance, PairBends()),
                  found & ((1U << count) - 1))
            << k->name;
    for (std::size_t k = 0; k < 8; ++k) {
      const bool is_apart = found >> k & 1U, comes_near = x[k].comeWithin(distance, 1);
      EXPECT_FALSE(is_apart && comes_near) << distance;
      apart += is_apart;
      near += comes_near;
    }
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(near, 1000);
}

/// Two triangles on bent paths.
struct BentTriangles : TwoTriangles {
  Bend bend[2];

  BentTriangles(Random& random, double motion) : TwoTriangles(random, motion) {
    const double size = std::pow(10, random.uniform(-3, 0));
    for (Bend& of : bend) {
      const Vector3<double> offset = random.point(size);
      std::copy(offset.data(), offset.data() + 3, of.offset);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
          of.matrix[3 * i + j] = of.matrix[3 * j + i] = random.uniform(-size, size);
    }
  }

  Vector3<double> pointAt(std::size_t vertex, double t, const PairBends& bends) const {
    const Eigen::Map<const Vector3<double>> from(paths[vertex].t0), to(paths[vertex].t1);
    const Vector3<double> chord = (1 - t) * from + t * to;
    const Bend* of = bends.of[vertex / 3];
    if (!of) return chord;
    const Eigen::Map<const Matrix3<double>> matrix(of->matrix);
    const Eigen::Map<const Vector3<double>> offset(of->offset);
    return chord + 4 * t * (1 - t) * (matrix * (from + to) / 2 + offset);
  }

  /// The least distance of a pair of features at some times.
  double leastDistance(int bit, double lo, double hi, const PairBends& bends) const {
    constexpr int kSamples = 40;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSamples; ++i) {
      const auto at = [&](std::size_t k) {
        return pointAt(k, lo + (hi - lo) * i / kSamples, bends);
      };
      const auto first = static_cast<std::size_t>(bit < 6 ? bit : (bit - 6) / 3),
                 second = static_cast<std::size_t>(bit < 6 ? 0 : (bit - 6) % 3);
      const std::size_t face = bit < 3 ? 3 : 0;
      least = std::min(
          least,
          bit < 6 ? test::distanceToFace(at(first), at(face), at(face + 1), at(face + 2))
                  : test::distanceOfEdges(at(first), at((first + 1) % 3), at(3 + second),
                                          at(3 + (second + 1) % 3)));
    }
    return least;
  }
};

struct BentFound {
  int apart{0}, culled{0}, near{0};
};

/// No pair of triangles and no pair of features that comes near at a sampled time on its
/// bent paths is culled, and all instruction sets find the same.
void expectRightOnBentPaths(const BentTriangles& x, const PairBends& bends,
                            double distance, double lo, double hi, BentFound& sum) {
  const unsigned is_apart = allSets().front()->stayApart(&x.pair, 1, distance, bends);
  const DistanceRequest request = requestUntil(1, distance);
  detail::deformable::TimeWindow windows[8];
  std::fill(
      windows, windows + 8,
      detail::deformable::TimeWindow{static_cast<float>(lo), static_cast<float>(hi)});
  for (const auto kind :
       {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
    const bool vf = kind == ContinuousContactKind::kVertexFace;
    const int count = vf ? 6 : 8;
    std::uint32_t codes[8];
    for (int k = 0; k < count; ++k) codes[k] = featureCode(0, vf ? k : 6 + k);
    const auto size = static_cast<std::size_t>(count);
    const unsigned found = allSets().front()->mayComeWithin(kind, &x.pair, codes, windows,
                                                            size, request, bends);
    for (const Kernels* k : allSets()) {
      EXPECT_EQ(k->stayApart(&x.pair, 1, distance, bends), is_apart) << k->name;
      EXPECT_EQ(k->mayComeWithin(kind, &x.pair, codes, windows, size, request, bends),
                found)
          << k->name;
    }
    for (int k = 0; k < count; ++k) {
      const int bit = static_cast<int>(codes[k] % 16);
      const bool is_near = x.leastDistance(bit, windows[0].lo, windows[0].hi, bends) <=
                           distance,
                 is_kept = found >> k & 1U;
      EXPECT_TRUE(is_kept || !is_near) << bit << " in " << lo << " " << hi;
      EXPECT_FALSE(is_apart && is_near) << bit;
      sum.culled += !is_kept;
      sum.near += is_near;
    }
  }
  sum.apart += is_apart != 0;
}

TEST(FCL_KERNELS, bentPathsThatComeNearAreNotCulled) {
  Random random(81);
  BentFound sum;
  for (int i = 0; i < test::rounds(1500) && !HasFailure(); ++i) {
    const BentTriangles x(random, std::pow(10, random.uniform(-2, 0)));
    PairBends bends;
    for (int k = 0; k < 2; ++k)
      if (i % 3 != k) bends.of[k] = &x.bend[k];
    const double lo = random.index(2) ? 0 : random.uniform(0, 0.8),
                 hi = random.index(2) ? 1 : random.uniform(lo, 1);
    expectRightOnBentPaths(x, bends, std::pow(10, random.uniform(-3, -0.5)), lo, hi, sum);
  }
  EXPECT_GT(sum.apart, test::rounds(100));
  EXPECT_GT(sum.culled, test::rounds(5000));
  EXPECT_GT(sum.near, test::rounds(400));
}

/// Two triangles face each other, and one moves. The plane between them is parallel to
/// both at all times; the least distance is that at the end.
TEST(FCL_KERNELS, trianglesThatStayApartUpToTheirGap) {
  constexpr double kCorners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  for (const double gap : {1e-6, 1e-3, 0.25}) {
    std::vector<TreeVertex> vertices(6);
    TrianglePair pair{};
    for (std::size_t k = 0; k < 6; ++k) {
      const double(&at)[2] = kCorners[k % 3];
      const double from[3] = {at[0], at[1], k < 3 ? 0. : 1.},
                   to[3] = {at[0] + (k < 3 ? 0. : 0.3), at[1], k < 3 ? 0 : gap};
      vertices[k].setPath(from, to);
      pair.x[k] = &vertices[k];
    }
    for (const Kernels* k : allSets()) {
      EXPECT_EQ(k->stayApart(&pair, 1, gap * (1 - 1e-6), PairBends()), 1U)
          << k->name << " " << gap;
      EXPECT_EQ(k->stayApart(&pair, 1, gap * (1 + 1e-6), PairBends()), 0U)
          << k->name << " " << gap;
    }
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

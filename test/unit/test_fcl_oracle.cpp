// SPDX-License-Identifier: BSD-3-Clause
//
// The oracle against cases that were worked out by hand, and the library against the
// oracle. This is the short version of fcl_ccd_oracle_check.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "oracle/distance_check.h"
#include "oracle/exact_oracle.h"
#include "oracle/query_check.h"
#include "oracle/scene_check.h"
#include "query_csv.h"
#include "rational_geometry.h"
#include "sanitizer.h"
#include "shared_data.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::VertexPath;
using fcl::ContinuousContactKind;

constexpr ContinuousContactKind kVf = ContinuousContactKind::kVertexFace,
                                kEe = ContinuousContactKind::kEdgeEdge;
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();

MovingPair onUnitEdge(const VertexPath& c, const VertexPath& d) {
  return {kEe, {at(-1, 0, 0), at(1, 0, 0), c, d}};
}

struct HandCase {
  const char* name;
  MovingPair pair;
  /// Time of the first contact; denominator 0: none.
  int numerator, denominator;
};

const HandCase kHandCases[] = {
    {"through the inside", onTriangle(falling(1, 1, 2, -1)), 2, 3},
    {"starts inside, parts", onTriangle(falling(1, 1, 0, 1)), 0, 1},
    {"ends inside", onTriangle(falling(1, 1, 1, 0)), 1, 1},
    {"ends just above", onTriangle(falling(1, 1, 1, kSmallest)), 0, 0},
    {"through a corner", onTriangle(falling(0, 4, 1, -6)), 1, 7},
    {"through a border", onTriangle(falling(2, 2, 1, -6)), 1, 7},
    {"a hair outside", onTriangle(falling(2, 2 + 0x1p-51, 1, -6)), 0, 0},
    {"slides in, in the plane", onTriangle(path({-1, 1, 0}, {2, 1, 0})), 1, 3},
    {"slides past a corner", onTriangle(path({5, -1, 0}, {3, 1, 0})), 1, 2},
    {"slides past, outside", onTriangle(path({5, 0, 0}, {4, 1, 0})), 0, 0},
    {"rests in the plane, outside", onTriangle(at(3, 3, 0)), 0, 0},
    {"rests inside", onTriangle(at(1, 1, 0)), 0, 1},
    {"triangle turns over",
     {kVf,
      {at(1, 1, 0), at(0, 0, 0), path({4, 0, 3}, {4, 0, -1}),
       path({0, 4, 3}, {0, 4, -1})}},
     3,
     4},
    // The moving edge crosses y = 0 at the height (1 - 2t)^2.
    {"double root",
     {kEe,
      {at(-1, 0, 0), at(1, 0, 0), path({0, 0, 1}, {0, -2, -1}),
       path({0, 2, -1}, {0, 0, 1})}},
     1,
     2},
    {"double root, missed by a hair",
     {kEe,
      {at(-1, 0, 0), at(1, 0, 0), path({0, 0, 1 + 0x1p-52}, {0, -2, -1 + 0x1p-52}),
       path({0, 2, -1 + 0x1p-52}, {0, 0, 1 + 0x1p-52})}},
     0,
     0},
    // The volume is (1 - 2t)^3.
    {"triple root",
     {kVf,
      {path({0, 0, 1}, {0, 0, -1}), at(0, 0, 0), path({1, 0, 0}, {-1, 0, 0}),
       path({0, 1, 0}, {0, -1, 0})}},
     1,
     2},
    {"no area, hit at an inner point",
     {kVf, {falling(3, 0, 1, -2), at(0, 0, 0), at(2, 0, 0), at(4, 0, 0)}},
     1,
     3},
    {"no area, missed in line",
     {kVf, {falling(5, 0, 1, -2), at(0, 0, 0), at(2, 0, 0), at(4, 0, 0)}},
     0,
     0},
    {"no area, missed beside",
     {kVf, {falling(1, 1, 1, -2), at(0, 0, 0), at(2, 0, 0), at(4, 0, 0)}},
     0,
     0},
    {"area lost when it matters",
     {kVf, {falling(1, 0, 1, -1), at(0, 0, 0), at(4, 0, 0), path({0, 4, 0}, {4, -4, 0})}},
     1,
     2},
    {"triangle is a point",
     {kVf, {falling(1, 1, 1, -1), at(1, 1, 0), at(1, 1, 0), at(1, 1, 0)}},
     1,
     2},
    {"all points the same",
     {kVf, {at(1, 2, 3), at(1, 2, 3), at(1, 2, 3), at(1, 2, 3)}},
     0,
     1},
    {"edges cross", onUnitEdge(falling(0, -1, 1, -4), falling(0, 1, 1, -4)), 1, 5},
    {"end on edge", onUnitEdge(falling(0, 0, 1, -4), falling(0, 1, 1, -4)), 1, 5},
    {"edges pass", onUnitEdge(falling(2, -1, 1, -4), falling(0.5, 1, 1, -4)), 0, 0},
    {"parallel edges meet", onUnitEdge(falling(0, 0, 1, -2), falling(5, 0, 1, -2)), 1, 3},
    {"parallel edges pass", onUnitEdge(falling(0, 1, 1, -2), falling(5, 1, 1, -2)), 0, 0},
    {"collinear edges meet",
     onUnitEdge(path({3, 0, 0}, {0, 0, 0}), path({4, 0, 0}, {1, 0, 0})), 2, 3},
    {"collinear edges, one in passing",
     onUnitEdge(path({-9, 0, 0}, {7, 0, 0}), path({-8, 0, 0}, {8, 0, 0})), 7, 16},
    {"edge without length on edge",
     onUnitEdge(falling(0, 0, 2, -1), falling(0, 0, 2, -1)), 2, 3},
    {"edge without length beside", onUnitEdge(falling(0, 1, 2, -1), falling(0, 1, 2, -1)),
     0, 0},
    {"two edges without length",
     {kEe, {at(1, 1, 0), at(1, 1, 0), falling(1, 1, 1, -1), falling(1, 1, 1, -1)}},
     1,
     2},
    {"the same edge", onUnitEdge(at(-1, 0, 0), at(1, 0, 0)), 0, 1},
    {"largest doubles", onTriangle(falling(1, 1, kLargest, -kLargest)), 1, 2},
    {"smallest doubles", onTriangle(falling(1, 1, kSmallest, -3 * kSmallest)), 1, 4},
    {"both",
     {kVf,
      {falling(0, 0, kSmallest, -kSmallest), at(-kLargest, -kLargest, 0),
       at(kLargest, -kLargest, 0), at(0, kLargest, 0)}},
     1,
     2},
};

TEST(FCL_ORACLE, casesByHand) {
  for (const HandCase& c : kHandCases) {
    SCOPED_TRACE(c.name);
    const OracleAnswer answer = askOracle(c.pair.kind, c.pair.points());
    ASSERT_EQ(answer.touch(), c.denominator != 0);
    if (!answer.touch()) continue;
    const Rational time(c.numerator, c.denominator);
    EXPECT_LE(answer.lower(), time);
    EXPECT_GE(answer.upper(), time);
    OracleAnswer narrow = answer;
    narrow.refine(Rational(1) / (Rational(1ULL << 62) * Rational(1ULL << 62)));
    EXPECT_LE(narrow.lower(), time);
    EXPECT_GE(narrow.upper(), time);
    EXPECT_LE((narrow.upper() - narrow.lower()) * Rational(1ULL << 62), 1);
    if (narrow.isExact()) {
      EXPECT_EQ(narrow.lower(), time);
    }
    const double before = static_cast<double>(c.numerator) / c.denominator - 1e-9;
    EXPECT_EQ(answer.compareTime(before), 1);
    EXPECT_EQ(answer.compareTime(before + 2e-9), -1);
    if ((c.denominator & (c.denominator - 1)) == 0) {
      EXPECT_EQ(answer.compareTime(static_cast<double>(c.numerator) / c.denominator), 0);
    }
  }
}

// Seen along x, the vertex (1 - t, t) lies on the line to (2 - t, 1 - t) when 2 (1 - t)^2
// = 1.
TEST(FCL_ORACLE, irrationalTime) {
  const MovingPair pair{kVf,
                        {path({0, 1, 0}, {0, 0, 1}), at(-9, 0, 0),
                         path({9, 0, 0}, {9, 0, 0}), path({0, 2, 1}, {0, 1, 0})}};
  OracleAnswer answer = askOracle(pair.kind, pair.points());
  ASSERT_TRUE(answer.touch());
  answer.refine(Rational(1, 1ULL << 60));
  EXPECT_FALSE(answer.isExact());
  const Rational early = 1 - answer.lower(), late = 1 - answer.upper();
  EXPECT_GT(2 * early * early, 1);
  EXPECT_LT(2 * late * late, 1);
}

// The oracle's decision at single times, by rational arithmetic: if features touch at one
// of the tested times, the first contact is not later.
TEST(FCL_ORACLE, noContactIsBeforeTheFirst) {
  constexpr std::uint64_t kSteps = 840;  // divided by 2 ... 8
  std::size_t contacts = 0;
  for (std::uint64_t number = 0; number < rounds(2000U); number += 2) {
    const MovingPair pair = generatedQuery(number);
    const OracleAnswer answer = askOracle(pair.kind, pair.points());
    for (std::uint64_t k = 0; k <= kSteps; k += 35) {
      const Rational t(k, kSteps);
      if (!doTouch(pair.kind, pointsAt<Rational>(pair.x.data(), t, 1))) continue;
      ASSERT_TRUE(answer.touch()) << pair << "\nat " << t;
      ASSERT_LE(answer.lower(), t) << pair;
      ++contacts;
      break;
    }
  }
  EXPECT_GT(contacts, rounds(300U));
}

TEST(FCL_ORACLE, generatedQueries) {
  constexpr std::uint64_t kCount = rounds(24000U);
  CheckTally tally;
  for (std::uint64_t number = 0; number < kCount; ++number)
    ASSERT_EQ(disagreement(generatedQuery(number), number, tally), "")
        << "query " << number;
  EXPECT_GT(tally.contacts, kCount / 4);
  EXPECT_GT(tally.contacts_at_start, kCount / 20);
  for (const std::size_t decided : tally.decided_by) EXPECT_GT(decided, kCount / 50);
}

// Distances by hand: a vertex that falls on the inside, beside an edge and beside a
// corner of a face, and two edges.
TEST(FCL_ORACLE, distancesByHand) {
  struct DistanceCase {
    MovingPair pair;
    double distance;
    /// Denominator 0: none.
    int numerator, denominator;
  };
  const DistanceCase cases[] = {
      {onTriangle(falling(1, 1, 4, 0)), 1, 3, 4},
      {onTriangle(falling(1, 1, 4, 1)), 1, 1, 1},
      {onTriangle(falling(1, 1, 4, 1 + 0x1p-52)), 1, 0, 0},
      {onTriangle(falling(1, -3, 8, 0)), 5, 1, 2},
      {onTriangle(falling(-2, -1, 8, 0)), 3, 3, 4},
      {onTriangle(falling(1, 1, 0.5, 4)), 1, 0, 1},
      {onTriangle(path({-4, 1, 1}, {4, 1, 1})), 1, 1, 2},
      {onTriangle(path({-4, 1, 1}, {4, 1, 1})), 1 - 0x1p-53, 0, 0},
      {onUnitEdge(path({0, -1, 5}, {0, -1, 1}), path({0, 1, 5}, {0, 1, 1})), 3, 1, 2},
      {onUnitEdge(path({4, -1, 8}, {4, -1, 0}), path({4, 1, 8}, {4, 1, 0})), 5, 1, 2},
      {onUnitEdge(at(0, 3, 4), at(5, 3, 4)), 5, 0, 1},
      {onUnitEdge(at(0, 3, 4), at(5, 3, 4)), 5 - 0x1p-50, 0, 0}};
  for (const DistanceCase& c : cases) {
    const OracleAnswer answer =
        askDistanceOracle(c.pair.kind, c.pair.points(), c.distance);
    ASSERT_EQ(answer.touch(), c.denominator != 0) << c.pair << c.distance;
    if (!answer.touch()) continue;
    EXPECT_EQ(answer.compareTime(static_cast<double>(c.numerator) / c.denominator), 0)
        << c.pair << c.distance;
  }
}

TEST(FCL_ORACLE, generatedDistances) {
  constexpr std::uint64_t kCount = 4000;
  DistanceTally tally;
  for (std::uint64_t number = 0; number < kCount; ++number)
    ASSERT_EQ(distanceDisagreement(distanceQuery(number), tally), "")
        << "query " << number;
  EXPECT_GT(tally.contacts, kCount / 4);
  EXPECT_LT(tally.contacts, kCount * 9 / 10);
  EXPECT_GT(tally.contacts - tally.contacts_at_start, kCount / 5);
  EXPECT_GT(tally.grazes, kCount / 100);
  EXPECT_EQ(tally.given_up, 0U);
}

// Differences near the smallest double times differences near the largest. Products are
// in range, but their factors have lost digits. The solver must not miss these two
// contacts.
TEST(FCL_ORACLE, differencesThatUnderflow) {
  const MovingPair pairs[] = {
      {kEe,
       {path(
            {-0x0.000000000002p-1022, -0x0.000000000003p-1022, -0x0.000000000003p-1022},
            {-0x0.000000000005p-1022, -0x0.0000000000068p-1022, -0x0.000000000001p-1022}),
        path({-0x1.8p+62, -0x1.4p+62, -0x1p+60}, {-0x1.2p+63, -0x1.ep+62, -0x1p+60}),
        path({0, -0x0.000000000007p-1022, 0x0.000000000002p-1022},
             {-0x0.000000000005p-1022, -0x0.000000000008p-1022, 0x0.000000000003p-1022}),
        path({-0x1p+602, -0x1p+602, -0x1p+601}, {-0x1p+603, -0x1p+602, 0})}},
      {kEe,
       {path(
            {0x0.0000000000004p-1022, 0x0.0000000000004p-1022, -0x0.000000000000ep-1022},
            {0x0.0000000000004p-1022, 0x0.0000000000006p-1022, -0x0.0000000000008p-1022}),
        path({-0x1.2p+302, 0x1.4p+301, -0x1.ap+302},
             {-0x1.cp+301, 0x1.cp+301, -0x1.cp+301}),
        path({-0x0.000000000007cp-1022, 0x0.000000000001bp-1022, 0x0.0000000000012p-1022},
             {0x0.0000000000076p-1022, -0x0.000000000000fp-1022,
              -0x0.0000000000024p-1022}),
        path({-0x1.d6p-54, 0x1.7p-56, 0x1.48p-56},
             {0x1.eep-54, -0x1.3p-56, -0x1.14p-55})}}};
  CheckTally tally;
  for (const MovingPair& pair : pairs) EXPECT_EQ(disagreement(pair, 0, tally), "");
  EXPECT_EQ(tally.contacts, 2U);
}

TEST(FCL_ORACLE, hardQueries) {
  const auto root = sharedData("queries");
  if (!root) GTEST_SKIP() << kNoSharedData;
  CheckTally tally;
  for (const auto& folder : std::filesystem::directory_iterator(*root))
    for (const ContinuousContactKind kind : {kVf, kEe}) {
      const std::string path =
          folder.path().string() + (kind == kVf ? "/vertex-face.csv" : "/edge-edge.csv");
      if (!std::filesystem::exists(path)) continue;
      for (const auto& query : fcl_ccd::readQueries(path).queries) {
        const MovingPair pair{kind, query.x};
        EXPECT_EQ(askOracle(kind, pair.points()).touch(), query.truth) << path << pair;
        EXPECT_EQ(disagreement(pair, tally.queries, tally), "") << path;
      }
    }
  EXPECT_EQ(tally.queries, 4120U);
  EXPECT_EQ(tally.contacts, 160U);
}

void expectNoContactCulled(const char* name, const char* previous, const char* current) {
  const auto folder = sharedData(std::string("scenes/") + name);
  if (!folder) GTEST_SKIP() << kNoSharedData;
  const CullReport report = checkCulledPairs(
      readFramePair(*folder + "/" + previous, *folder + "/" + current), {});
  for (const CulledByStage& stage : report.stages) {
    EXPECT_EQ(stage.contacts, 0U) << stage.name << "\n" << report.example;
    // The exact stage is for hard cases, which a scene may not have.
    if (&stage != &report.stages.back()) {
      EXPECT_GT(stage.asked, 0U) << stage.name;
    }
  }
}

TEST(FCL_ORACLE, culledPairsOfClothBall) {
  expectNoContactCulled("cloth-ball", "92.ply", "93.ply");
}

TEST(FCL_ORACLE, culledPairsOfNBody) {
  expectNoContactCulled("n-body", "18.ply", "19.ply");
}

}  // namespace
}  // namespace test
}  // namespace fcl

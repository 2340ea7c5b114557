// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary test on pairs made by hand, and its stages against the exact test.
#include "elementary/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "elementary/axis_window.h"
#include "elementary/coplanarity_filter.h"
#include "elementary/exact.h"
#include "feature_pair_generators.h"
#include "query_generators.h"
#include "rational_geometry.h"
#include "real.h"
#include "sanitizer.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::at;
using test::falling;
using test::MovingPair;
using test::onTriangle;
using test::path;
using test::Random;
using test::Real;

constexpr ContinuousContactKind kVf = ContinuousContactKind::kVertexFace,
                                kEe = ContinuousContactKind::kEdgeEdge;

ElementaryResult test(const MovingPair& pair, double toc_err = 1e-6) {
  return elementaryTest(pair.kind, pair.points(), 0, 1, toc_err);
}

ElementaryResult exact(const MovingPair& pair, double toc_err = 1e-12) {
  return decideExactly(pair.kind, pair.points(), toc_err);
}

bool doOverlap(const ElementaryResult& x, const ElementaryResult& y) {
  return x.toc_lo <= y.toc_hi && y.toc_lo <= x.toc_hi;
}

/// The answer is right, and the bracket contains the exact time.
void expectAgreement(const MovingPair& pair, const ElementaryResult& result,
                     const ElementaryResult& truth) {
  ASSERT_EQ(result.answer, truth.answer) << pair;
  if (truth.answer == Answer::kYes) {
    ASSERT_TRUE(doOverlap(result, truth))
        << pair << "\n[" << result.toc_lo << ", " << result.toc_hi << "] and ["
        << truth.toc_lo << ", " << truth.toc_hi << "]";
  }
}

struct Case {
  const char* name;
  MovingPair pair;
  /// Time of contact as a fraction; denominator 0: none.
  int numerator, denominator;
  std::optional<DecidedBy> decided_by;
};

MovingPair edges(const VertexPath& a, const VertexPath& b, const VertexPath& c,
                 const VertexPath& d) {
  return {kEe, {a, b, c, d}};
}
/// Edges whose volume is that of s^2 + gap as s runs from -1 to s1: they graze at s = 0.
MovingPair grazing(double s1, double gap) {
  return edges(at(-1, 0, 0), at(1, 0, 0), path({0, 0, 1 + gap}, {0, -s1 - 1, gap - s1}),
               path({0, 2, gap - 1}, {0, 1 - s1, gap + s1}));
}

const std::vector<Case>& cases() {
  constexpr auto kBox = DecidedBy::kBox, kFilter = DecidedBy::kFilter,
                 kSolver = DecidedBy::kSolver, kExact = DecidedBy::kExact;
  constexpr double kTinyBit = 0x1p-40;
  static const std::vector<Case> list = {
      {"through the inside", onTriangle(falling(1, 1, 2, -2)), 1, 2, kSolver},
      {"through at a third", onTriangle(falling(1, 1, 1, -2)), 1, 3, kSolver},
      {"far beside", onTriangle(falling(9, 1, 1, -1)), 0, 0, kBox},
      {"stays above",
       {kVf,
        {path({1, 1, 1}, {2, 1, 1}), at(0, 0, 0), at(4, 0, 0),
         path({0, 4, 0}, {0, 4, 2})}},
       0,
       0,
       kFilter},
      {"beside the hypotenuse", onTriangle(falling(3, 3, 1, -1)), 0, 0, kSolver},
      {"just beside the edge", onTriangle(falling(2 + kTinyBit, 2, 1, -1)), 0, 0,
       kSolver},
      {"just inside the edge", onTriangle(falling(2 - kTinyBit, 2, 1, -1)), 1, 2,
       kSolver},
      {"on the edge", onTriangle(falling(2, 2, 1, -1)), 1, 2, kExact},
      {"on a corner", onTriangle(falling(4, 0, 1, -1)), 1, 2, kExact},
      {"starts on it, parts", onTriangle(falling(1, 1, 0, 1)), 0, 1, kSolver},
      {"starts on a corner", onTriangle(falling(0, 0, 0, 1)), 0, 1, kSolver},
      {"ends on it", onTriangle(falling(1, 1, 1, 0)), 1, 1, kExact},
      {"ends just above", onTriangle(falling(1, 1, 1, kTinyBit)), 0, 0, {}},
      {"rests on it", onTriangle(at(1, 1, 0)), 0, 1, kSolver},
      {"rests above", onTriangle(at(1, 1, 1)), 0, 0, kBox},
      {"rests in the plane, outside", onTriangle(at(3, 3, 0)), 0, 0, kSolver},
      {"slides in the plane, in", onTriangle(path({-1, 1, 0}, {1, 1, 0})), 1, 2, {}},
      {"slides in the plane, past", onTriangle(path({5, 1, 0}, {1, 5, 0})), 0, 0, {}},
      {"slides in the plane, to a corner",
       onTriangle(path({8, 0, 0}, {2, 0, 0})),
       2,
       3,
       {}},
      {"no area, onto it",
       {kVf, {falling(1, 0, 1, -2), at(0, 0, 0), at(2, 0, 0), at(4, 0, 0)}},
       1,
       3,
       kSolver},
      {"no area, beside",
       {kVf, {falling(1, 1, 1, -2), at(0, 0, 0), at(2, 2, 0), at(4, 4, 0)}},
       1,
       3,
       kExact},
      {"no area, missed",
       {kVf, {falling(1, 2, 1, -2), at(0, 0, 0), at(2, 2, 0), at(4, 4, 0)}},
       0,
       0,
       {}},
      {"triangle is a point",
       {kVf, {falling(1, 1, 1, -1), at(1, 1, 0), at(1, 1, 0), at(1, 1, 0)}},
       1,
       2,
       kExact},
      {"triangle closes on it",
       {kVf,
        {at(1, 1, 0), path({0, 0, 1}, {0, 0, -1}), path({4, 0, 1}, {4, 0, -1}),
         path({0, 4, 1}, {0, 4, -1})}},
       1,
       2,
       kSolver},
      {"all four the same",
       {kVf, {at(1, 2, 3), at(1, 2, 3), at(1, 2, 3), at(1, 2, 3)}},
       0,
       1,
       kSolver},
      {"crossing edges",
       edges(at(-1, 0, 0), at(1, 0, 0), falling(0, -1, 1, -1), falling(0, 1, 1, -1)), 1,
       2, kSolver},
      {"edges pass beside",
       edges(at(-1, 0, 0), at(1, 0, 0), falling(2, -1, 1, -1), falling(0.5, 1, 1, -1)), 0,
       0, kSolver},
      {"end on edge",
       edges(at(-1, 0, 0), at(1, 0, 0), falling(0, 0, 1, -1), falling(0, 1, 1, -1)), 1, 2,
       kExact},
      {"end on end",
       edges(at(-1, 0, 0), at(1, 0, 0), falling(1, 0, 1, -1), falling(2, 1, 1, -1)), 1, 2,
       kExact},
      {"edges touch at 0 and part",
       edges(at(-1, 0, 0), at(1, 0, 0), falling(0, -1, 0, 1), falling(0, 1, 0, 1)), 0, 1,
       kSolver},
      {"edges touch at 1",
       edges(at(-1, 0, 0), at(1, 0, 0), falling(0, -1, 1, 0), falling(0, 1, 1, 0)), 1, 1,
       kExact},
      {"rest crossed", edges(at(-1, 0, 0), at(1, 0, 0), at(0, -1, 0), at(0, 1, 0)), 0, 1,
       kSolver},
      {"edges in the plane, touch",
       edges(at(0, 0, 0), at(2, 0, 0), path({1, 1, 0}, {1, -1, 0}),
             path({1, 3, 0}, {1, 1, 0})),
       1,
       2,
       {}},
      {"edges in the plane, apart",
       edges(at(0, 0, 0), at(2, 2, 0), path({2, 1, 0}, {3, 2, 0}),
             path({3, 1, 0}, {4, 2, 0})),
       0,
       0,
       {}},
      {"parallel edges meet",
       edges(at(0, 0, 0), at(2, 0, 0), path({1, 1, 0}, {1, -2, 0}),
             path({3, 1, 0}, {3, -2, 0})),
       1, 3, kSolver},
      {"parallel edges pass",
       edges(at(0, 0, 0), at(2, 2, 0), path({2, 0, 1}, {2, 0, -1}),
             path({3, 1, 1}, {3, 1, -1})),
       0, 0, kSolver},
      {"collinear edges meet",
       edges(at(0, 0, 0), at(1, 1, 0), path({3, 3, 0}, {0, 0, 0}),
             path({4, 4, 0}, {1, 1, 0})),
       2, 3, kExact},
      {"collinear edges apart",
       edges(at(0, 0, 0), at(1, 1, 0), path({4, 4, 0}, {2, 2, 0}),
             path({5, 5, 0}, {3, 3, 0})),
       0, 0, kBox},
      {"same edge", edges(at(0, 1, 2), at(3, 1, 0), at(0, 1, 2), at(3, 1, 0)), 0, 1,
       kSolver},
      {"an edge is a point",
       edges(at(0, 0, 0), at(0, 0, 0), falling(-1, 0, 1, -2), falling(1, 0, 1, -2)), 1, 3,
       kExact},
      {"an edge is a point, missed",
       edges(at(0, 0, 0), at(0, 0, 0), falling(-1, 0, 1, -2), falling(1, 1, 1, -2)),
       0,
       0,
       {}},
      {"both edges are points",
       edges(at(1, 1, 0), at(1, 1, 0), falling(1, 1, 1, -1), falling(1, 1, 1, -1)), 1, 2,
       kExact},
      {"graze", grazing(1, 0), 1, 2, kExact},
      {"graze at a third", grazing(2, 0), 1, 3, kExact},
      {"nearly graze", grazing(1, 0x1p-30), 0, 0, {}},
  };
  return list;
}

/// The bracket contains the time and is as narrow as promised. Real is exact for
/// these fractions.
void expectTime(const Case& c, const ElementaryResult& r, double toc_err) {
  ASSERT_EQ(r.answer, c.denominator ? Answer::kYes : Answer::kNo);
  if (!c.denominator) return;
  const Real n = c.numerator, d = c.denominator;
  EXPECT_LE(r.toc_lo * d, n);
  EXPECT_GE(r.toc_hi * d, n);
  EXPECT_LE(r.toc_hi - r.toc_lo, std::max(toc_err, 4 * DBL_EPSILON));
  EXPECT_GE(r.toc_lo, 0);
  EXPECT_LE(r.toc_hi, 1);
  if (c.numerator == 0) {
    EXPECT_EQ(r.toc_hi, 0);
  }
}

TEST(FCL_ELEMENTARY_TEST, constructedCases) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const ElementaryResult r = test(c.pair);
    expectTime(c, r, 1e-6);
    expectTime(c, exact(c.pair, 1e-6), 1e-6);
    if (c.decided_by) {
      EXPECT_EQ(static_cast<int>(r.decided_by), static_cast<int>(*c.decided_by));
    }
    for (int digits = 2; digits <= 15; ++digits) {
      const double toc_err = std::pow(10, -digits);
      expectTime(c, test(c.pair, toc_err), toc_err);
    }
  }
}

/// For the whole step the answer is the exact one. For parts of the step, no contact is
/// denied.
/// @return whether the exact stage was not needed
bool expectExactAnswer(const MovingPair& pair, Random& random) {
  const ElementaryResult truth = exact(pair, 1e-12), r = test(pair);
  EXPECT_EQ(r.answer, truth.answer) << pair;
  const bool touch = truth.answer == Answer::kYes;
  if (touch) {
    EXPECT_LE(r.toc_lo, truth.toc_hi) << pair;
    EXPECT_GE(r.toc_hi, truth.toc_lo) << pair;
    EXPECT_LE(r.toc_hi - r.toc_lo, 1e-6) << pair;
  }
  double lo = random.uniform(0, 1), hi = random.uniform(0, 1);
  if (hi < lo) std::swap(lo, hi);
  const ElementaryResult part = solveCoplanarity(pair.kind, pair.points(), lo, hi, 1e-6);
  if (touch && truth.toc_lo > lo && truth.toc_hi < hi) {
    EXPECT_NE(part.answer, Answer::kNo) << pair;
    EXPECT_LE(part.toc_lo, truth.toc_hi) << pair;
  }
  if (part.answer == Answer::kYes) {
    EXPECT_TRUE(touch) << pair;
    EXPECT_LE(truth.toc_lo, part.toc_hi) << pair;
  }
  return r.decided_by != DecidedBy::kExact;
}

// Sheets that slide over each other: every volume is zero.
TEST(FCL_ELEMENTARY_TEST, pairsInOnePlane) {
  constexpr std::uint64_t kSeed = 34;
  Random random(kSeed);
  int cheap[2] = {0, 0};
  constexpr int kCount = 20000;
  for (int i = 0; i < 2 * kCount; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const bool on_grid = i % 2;
    MovingPair pair = test::gridPair(random, 2);
    const std::size_t axis = random.index(3);
    const double height[2] = {random.uniform(-1, 1), random.uniform(-1, 1)};
    const bool shift_only = random.index(2);
    double shift[2][3];
    for (int k = 0; k < 3; ++k)
      for (auto& s : shift) s[k] = random.uniform(-2, 2);
    const int firsts = pair.kind == kVf ? 1 : 2;
    for (int j = 0; j < 4; ++j) {
      VertexPath& p = pair.x[static_cast<std::size_t>(j)];
      for (int k = 0; k < 3; ++k) {
        if (!on_grid) p.t0[k] = random.uniform(-1, 1), p.t1[k] = random.uniform(-1, 1);
        // Features that keep their shape: edges may stay parallel.
        if (shift_only) p.t1[k] = p.t0[k] + shift[j < firsts][k];
      }
      p.t0[axis] = height[0];
      p.t1[axis] = height[1];
    }
    cheap[on_grid] += expectExactAnswer(pair, random);
    if (HasFailure()) return;
  }
  EXPECT_GT(cheap[0], kCount * 99 / 100);
  EXPECT_GT(cheap[1], kCount * 80 / 100);
}

// The same in a plane that rounding bends: every volume is rounding.
TEST(FCL_ELEMENTARY_TEST, pairsNearlyInOnePlane) {
  constexpr std::uint64_t kSeed = 35;
  Random random(kSeed);
  int cheap = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingPair pair{i % 2 ? kVf : kEe, {}};
    const double slope[2] = {random.uniform(-2, 2), random.uniform(-2, 2)};
    for (auto& p : pair.x)
      for (double(*frame)[3] : {&p.t0, &p.t1}) {
        (*frame)[0] = random.uniform(-1, 1);
        (*frame)[1] = random.uniform(-1, 1);
        (*frame)[2] = slope[0] * (*frame)[0] + slope[1] * (*frame)[1];
      }
    cheap += expectExactAnswer(pair, random);
    if (HasFailure()) return;
  }
  EXPECT_GT(cheap, kCount * 99 / 100);
}

/// A feature pair of two sheets in the plane z = 0, the second of which slides: sides and
/// halves of the cells of a grid. Edges are often parallel, or slide in one line.
MovingPair slidingFeatures(Random& random, double spacing) {
  MovingPair pair{random.index(4) ? kEe : kVf, {}};
  const bool in_line = pair.kind == kEe && random.index(3) == 0;
  static constexpr double kSides[3][2] = {{1, 0}, {1, 1}, {0, 1}};
  const auto slide = [&] { return spacing * random.uniform(-2, 2); };
  const double from[2] = {slide(), in_line ? 0 : slide()},
               to[2] = {slide(), in_line ? 0 : slide()};
  const std::size_t half = random.index(2), firsts = pair.kind == kVf ? 1 : 2;
  for (std::size_t i = 0; i < 4; ++i) {
    VertexPath& p = pair.x[i];
    const bool is_corner = i == 0 || i == firsts;
    const std::size_t which = in_line || is_corner ? 0
                              : pair.kind == kVf   ? i - 2 + half
                                                   : random.index(3);
    for (int k = 0; k < 2; ++k) {
      const double place = is_corner ? 0 : spacing * kSides[which][k];
      p.t0[k] = place + (i < firsts ? 0 : from[k]);
      p.t1[k] = place + (i < firsts ? 0 : to[k]);
    }
    p.t0[2] = p.t1[2] = 0;
  }
  return pair;
}

// In a tilted plane, edges are parallel except for rounding, and touch while they are in
// one line, for a shorter time than doubles can resolve.
TEST(FCL_ELEMENTARY_TEST, sheetsSlidingInATiltedPlane) {
  constexpr std::uint64_t kSeed = 36;
  Random random(kSeed);
  int cheap = 0;
  constexpr int kCount = 30000;
  for (int i = 0; i < kCount; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    MovingPair pair = slidingFeatures(random, 0.01);
    const Matrix3<double> turn =
        AngleAxis<double>(random.uniform(0.2, 1.2),
                          (random.point(0.5) + Vector3<double>(1, 1, 1)).normalized())
            .toRotationMatrix();
    const Vector3<double> place = random.point(1);
    for (auto& p : pair.x)
      for (double(*frame)[3] : {&p.t0, &p.t1}) {
        const Vector3<double> turned =
            turn * (Vector3<double>((*frame)[0], (*frame)[1], (*frame)[2]) + place);
        for (int k = 0; k < 3; ++k) (*frame)[k] = turned[k];
      }
    cheap += expectExactAnswer(pair, random);
    if (HasFailure()) return;
  }
  EXPECT_GT(cheap, kCount * 90 / 100);
}

// What the stages before the exact stage prove is true.
TEST(FCL_ELEMENTARY_TEST, everyFamilyAgreesWithTheExactTest) {
  constexpr std::uint64_t kSeed = 37;
  for (const test::QueryFamily& family : test::queryFamilies()) {
    Random random(kSeed);
    for (int i = 0; i < 1500; ++i) {
      SCOPED_TRACE(std::string(family.name) + ", seed " + std::to_string(kSeed) + ", " +
                   std::to_string(i));
      expectExactAnswer(family.generate(random), random);
      if (HasFailure()) return;
    }
  }
}

TEST(FCL_ELEMENTARY_TEST, constructedCasesMovedTurnedAndScaled) {
  const int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                          {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    for (int turn = 0; turn < 48; ++turn)
      for (const double scale : {0x1p-20, 1., 0x1p20}) {
        MovingPair pair = c.pair;
        for (auto& p : pair.x)
          for (double(*frame)[3] : {&p.t0, &p.t1}) {
            const double old[3] = {(*frame)[0], (*frame)[1], (*frame)[2]};
            for (int k = 0; k < 3; ++k)
              (*frame)[k] =
                  scale * ((turn >> k & 1 ? -1 : 1) * old[axes[turn / 8][k]] + 7 * k - 3);
          }
        expectTime(c, test(pair), 1e-6);
      }
  }
}

TEST(FCL_ELEMENTARY_TEST, agreesWithTheExactTest) {
  constexpr std::uint64_t kSeed = 11;
  Random random(kSeed);
  int by[4] = {};
  for (int i = 0; i < 20000; ++i) {
    const MovingPair pair = test::randomPair(random);
    const ElementaryResult r = test(pair);
    ASSERT_NO_FATAL_FAILURE(expectAgreement(pair, r, exact(pair))) << "seed " << kSeed;
    ++by[static_cast<int>(r.decided_by)];
  }
  // Each stage has its share.
  for (const int count : by) EXPECT_GT(count, 100);
}

/// Whether the volume's Bernstein coefficients over a window have one sign, exactly.
bool haveOneSign(const MovingPair& pair, double lo, double hi) {
  using Number = test::Rational;
  using Point = test::ExactPoint<Number>;
  const auto difference = [&](std::size_t i, std::size_t j, bool end) {
    const Number t = end ? hi : lo;
    Point d;
    for (std::size_t k = 0; k < 3; ++k) {
      const Number d0 = Number(pair.x[i].t0[k]) - Number(pair.x[j].t0[k]),
                   d1 = Number(pair.x[i].t1[k]) - Number(pair.x[j].t1[k]);
      d[k] = d0 + t * (d1 - d0);
    }
    return d;
  };
  const bool vf = pair.kind == kVf;
  const auto volume = [&](bool u_end, bool v_end, bool w_end) -> Number {
    const Point u = vf ? difference(0, 1, u_end) : difference(2, 0, u_end),
                v = vf ? difference(2, 1, v_end) : difference(1, 0, v_end),
                w = vf ? difference(3, 1, w_end) : difference(3, 2, w_end);
    return test::dot(u, test::cross(v, w));
  };
  const Number b[4] = {
      volume(0, 0, 0), volume(1, 0, 0) + volume(0, 1, 0) + volume(0, 0, 1),
      volume(0, 1, 1) + volume(1, 0, 1) + volume(1, 1, 0), volume(1, 1, 1)};
  return std::all_of(b, b + 4, [](const Number& c) { return c > 0; }) ||
         std::all_of(b, b + 4, [](const Number& c) { return c < 0; });
}

// Signs below the bound on rounding are decided in double-double; none is used without
// proof.
TEST(FCL_ELEMENTARY_TEST, filterSeesTheSignsThatThereAre) {
  constexpr std::uint64_t kSeed = 38;
  int all = 0, seen = 0;
  for (const test::QueryFamily& family : test::queryFamilies()) {
    if (std::string(family.name) == "extreme-exponents") continue;
    Random random(kSeed);
    for (int i = 0; i < test::rounds(500); ++i) {
      const MovingPair pair = family.generate(random);
      const bool is_culled = !mayBecomeCoplanar(pair.kind, pair.points(), 0, 1),
                 have_one_sign = haveOneSign(pair, 0, 1);
      ASSERT_LE(is_culled, have_one_sign) << family.name << pair << "\nseed " << kSeed;
      const double a = random.uniform(0, 1), b = random.uniform(0, 1),
                   lo = std::min(a, b), hi = std::max(a, b);
      if (!mayBecomeCoplanar(pair.kind, pair.points(), lo, hi)) {
        ASSERT_TRUE(haveOneSign(pair, lo, hi))
            << family.name << pair << " in [" << lo << ", " << hi << "]\nseed " << kSeed;
      }
      all += have_one_sign;
      seen += is_culled;
    }
  }
  EXPECT_GT(all, test::rounds(1000));
  EXPECT_GT(seen, all * 95 / 100);  // the rest have different signs once rounded
}

TEST(FCL_ELEMENTARY_TEST, filterDecidesJustAboveASlope) {
  // The volume, 2^-46, is a twentieth of the bound on its rounding in doubles.
  constexpr double kGap = 0x1p-50;
  const MovingPair pair{kVf,
                        {path({1, 1, 2 + kGap}, {1, 1, 2 + 2 * kGap}), at(0, 0, 0),
                         at(4, 0, 4), at(0, 4, 4)}};
  const ElementaryResult r = test(pair);
  EXPECT_EQ(r.answer, Answer::kNo);
  EXPECT_EQ(r.decided_by, DecidedBy::kFilter);
  MovingPair touching = pair;
  touching.x[0].t0[2] = 2;
  EXPECT_EQ(test(touching).answer, Answer::kYes);
}

TEST(FCL_ELEMENTARY_TEST, everyStageIsProved) {
  constexpr std::uint64_t kSeed = 12;
  Random random(kSeed);
  int culled[2] = {}, solved[2] = {};
  for (int i = 0; i < 20000; ++i) {
    const MovingPair pair = test::randomPair(random);
    const FeaturePoints x = pair.points();
    const ElementaryResult truth = exact(pair);
    const bool touch = truth.answer == Answer::kYes;
    double lo = 0, hi = 1;
    if (!narrowWindow(pair.kind, x, lo, hi)) {
      ASSERT_FALSE(touch) << pair << "\nseed " << kSeed;
      ++culled[0];
    } else if (touch) {
      ASSERT_TRUE(lo <= truth.toc_hi && truth.toc_lo <= hi) << pair;
    }
    if (!mayBecomeCoplanar(pair.kind, x, 0, 1)) {
      ASSERT_FALSE(touch) << pair << "\nseed " << kSeed;
      ++culled[1];
    }
    const double a = random.uniform(0, 1), b = random.uniform(0, 1);
    const double begin = std::min(a, b), end = random.index(3) ? std::max(a, b) : begin;
    const bool in_window = touch && truth.toc_lo >= begin && truth.toc_hi <= end;
    if (!mayBecomeCoplanar(pair.kind, x, begin, end)) {
      ASSERT_FALSE(in_window) << pair;
    }

    const double toc_err = std::pow(10, random.uniform(-12, -1));
    const ElementaryResult r = solveCoplanarity(pair.kind, x, 0, 1, toc_err);
    if (r.answer == Answer::kUnsure) {
      if (touch) {
        ASSERT_LE(r.toc_lo, truth.toc_hi) << pair;
        ASSERT_GE(r.toc_hi, truth.toc_lo) << pair;
      }
    } else {
      ASSERT_NO_FATAL_FAILURE(expectAgreement(pair, r, truth)) << "seed " << kSeed;
      ++solved[touch];
    }
    // Over a window, and up to a time to stop at.
    const ElementaryResult part = solveCoplanarity(pair.kind, x, begin, end, toc_err);
    if (in_window) {
      ASSERT_NE(part.answer, Answer::kNo) << pair;
      ASSERT_LE(part.toc_lo, truth.toc_hi) << pair;
    }
    if (part.answer == Answer::kYes) {
      ASSERT_TRUE(touch) << pair;
    }
    if (touch && truth.toc_hi <= begin) {
      ASSERT_NE(solveCoplanarity(pair.kind, x, 0, 1, toc_err, begin).answer, Answer::kNo)
          << pair;
    }
  }
  for (const int count : {culled[0], culled[1], solved[0], solved[1]})
    EXPECT_GT(count, 500);
}

/// A pair that is scaled about a point by a factor below 0, so that all meets there.
MovingPair scaledPair(Random& random, double& meeting) {
  MovingPair pair = test::randomPair(random);
  const Vector3<double> center = random.point(1);
  const double factor = -random.uniform(0, 4);
  meeting = 1 / (1 - factor);
  for (auto& p : pair.x)
    for (int k = 0; k < 3; ++k) {
      p.t0[k] = random.uniform(-1, 1);
      p.t1[k] = center[k] + factor * (p.t0[k] - center[k]);
    }
  return pair;
}

TEST(FCL_ELEMENTARY_TEST, noPairTouchesWhileApart) {
  constexpr std::uint64_t kSeed = 14;
  Random random(kSeed);
  int later = 0;
  const auto expectApart = [&](const MovingPair& pair, double lo, double hi) {
    const FeaturePoints x = pair.points();
    const double until = apartUntil(pair.kind, x, lo, hi);
    ASSERT_GE(until, lo);
    ASSERT_LE(until, hi);
    if (until == lo) return;
    ++later;
    const ElementaryResult r = decideExactly(pair.kind, x, 1e-12, 1, until);
    ASSERT_TRUE(r.answer == Answer::kNo || r.toc_hi <= lo) << pair << "\nseed " << kSeed;
  };
  for (int i = 0; i < 20000; ++i) {
    const double a = random.uniform(0, 1), b = random.uniform(0, 1);
    ASSERT_NO_FATAL_FAILURE(expectApart(test::randomPair(random), 0, 1));
    ASSERT_NO_FATAL_FAILURE(
        expectApart(test::randomPair(random), std::min(a, b), std::max(a, b)));
  }
  for (const test::QueryFamily& family : test::queryFamilies())
    for (int i = 0; i < 500; ++i)
      ASSERT_NO_FATAL_FAILURE(expectApart(family.generate(random), 0, 1)) << family.name;
  EXPECT_GT(later, 5000);
}

// There a plane tells the time up to rounding. What it cannot separate is nearly flat.
TEST(FCL_ELEMENTARY_TEST, pairsAreApartUntilAllMeets) {
  Random random(15);
  int sharp = 0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    double meeting;
    const MovingPair pair = scaledPair(random, meeting);
    const double until = apartUntil(pair.kind, pair.points(), 0, 1);
    ASSERT_NE(decideExactly(pair.kind, pair.points(), 1e-12, 1, until).answer,
              Answer::kYes)
        << pair;
    sharp += until > meeting - 1e-13;
  }
  EXPECT_GT(sharp, kCount * 9 / 10);
}

TEST(FCL_ELEMENTARY_TEST, bracketsNarrowWithTheTolerance) {
  constexpr std::uint64_t kSeed = 13;
  Random random(kSeed);
  for (int i = 0; i < 300; ++i) {
    const MovingPair pair = test::nearContactPair(random, i % 2 ? 0 : 1e-13);
    const ElementaryResult truth = exact(pair, 1e-15);
    for (int digits = 2; digits <= 15; ++digits) {
      const double toc_err = std::pow(10, -digits);
      for (const ElementaryResult& r : {test(pair, toc_err), exact(pair, toc_err)}) {
        ASSERT_NO_FATAL_FAILURE(expectAgreement(pair, r, truth)) << "seed " << kSeed;
        if (r.answer == Answer::kYes) {
          ASSERT_LE(r.toc_hi - r.toc_lo, std::max(toc_err, 4 * DBL_EPSILON)) << pair;
        }
      }
    }
  }
}

TEST(FCL_ELEMENTARY_TEST, doesNotDependOnTheView) {
  constexpr std::uint64_t kSeed = 14;
  Random random(kSeed);
  for (int i = 0; i < 6000; ++i) {
    const MovingPair pair = i % 4 ? test::randomPair(random) : test::gridPair(random, 3);
    const ElementaryResult r = test(pair);
    const bool vf = pair.kind == kVf;
    for (const auto& order :
         vf ? std::vector<std::array<std::size_t, 4>>{{0, 2, 3, 1}, {0, 2, 1, 3}}
            : std::vector<std::array<std::size_t, 4>>{{2, 3, 0, 1}, {1, 0, 2, 3}})
      ASSERT_NO_FATAL_FAILURE(
          expectAgreement(pair, test(test::reordered(pair, order)), r))
          << "seed " << kSeed;

    MovingPair reversed = pair;
    for (auto& p : reversed.x) std::swap(p.t0, p.t1);
    ASSERT_EQ(test(reversed).answer, r.answer) << pair;

    const double scale = std::ldexp(1, static_cast<int>(random.index(160)) - 80);
    const auto times = [&pair](double factor) {
      return test(test::mapped(pair, [factor](double c) { return factor * c; }));
    };
    ASSERT_NO_FATAL_FAILURE(expectAgreement(pair, times(-1), r)) << "seed " << kSeed;
    const ElementaryResult scaled = times(scale);
    ASSERT_EQ(scaled.answer, r.answer) << pair << "\ntimes " << scale;
    ASSERT_EQ(scaled.decided_by, r.decided_by) << pair << "\ntimes " << scale;
    ASSERT_EQ(scaled.toc_lo, r.toc_lo) << pair << "\ntimes " << scale;
    ASSERT_EQ(scaled.toc_hi, r.toc_hi) << pair << "\ntimes " << scale;
  }
}

// 2^1015 makes coordinates of 3e305 and volumes that overflow; 2^-1000 volumes that
// underflow; 2^-1070 puts the grid's coordinates among the subnormals.
TEST(FCL_ELEMENTARY_TEST, extremeScales) {
  constexpr std::uint64_t kSeed = 15;
  Random random(kSeed);
  for (int i = 0; i < 3000; ++i) {
    const MovingPair pair = test::gridPair(random, 3);
    const ElementaryResult truth = exact(pair);
    for (const int exponent :
         {-1074, -1070, -1000, -340, -310, 290, 320, 1000, 1015, 1021}) {
      const MovingPair scaled =
          test::mapped(pair, [exponent](double c) { return std::ldexp(c, exponent); });
      ASSERT_NO_FATAL_FAILURE(expectAgreement(scaled, test(scaled), truth))
          << "seed " << kSeed;
    }
  }
}

TEST(FCL_ELEMENTARY_TEST, mixedScales) {
  constexpr std::uint64_t kSeed = 16;
  Random random(kSeed);
  constexpr int kExponents[] = {-1074, -1030, -600, -60, 0, 60, 600, 1000, 1018};
  int contacts = 0;
  for (int i = 0; i < 120; ++i) {
    MovingPair pair = test::gridPair(random, 2);
    const int all = kExponents[random.index(9)];
    for (auto& p : pair.x) {
      const int from = random.index(3) ? all : kExponents[random.index(9)];
      const int to = random.index(3) ? all : kExponents[random.index(9)];
      for (int k = 0; k < 3; ++k) {
        p.t0[k] = std::ldexp(p.t0[k], from);
        p.t1[k] = std::ldexp(p.t1[k], to);
      }
    }
    const ElementaryResult truth = exact(pair);
    ASSERT_NO_FATAL_FAILURE(expectAgreement(pair, test(pair), truth)) << "seed " << kSeed;
    contacts += truth.answer == Answer::kYes;
  }
  EXPECT_GT(contacts, 10);
}

/// The answer of all stages is that of the last one.
void expectAsExact(const MovingPair& pair, Answer answer) {
  EXPECT_EQ(exact(pair).answer, answer) << pair;
  EXPECT_EQ(test(pair).answer, answer) << pair;
}

// A tiny vertex that passes the edge of a large face or goes through it. Underflows in
// its coordinates are multiplied by the size of the face.
TEST(FCL_ELEMENTARY_TEST, tinyPathsAtLargeFaces) {
  for (int exponent = 20; exponent <= 480; exponent += 10) {
    const double size = std::ldexp(1, exponent);
    MovingPair pair{ContinuousContactKind::kVertexFace, {}};
    auto& x = pair.x;
    const auto still = [&x](std::size_t i, double px, double py) {
      x[i].t0[0] = x[i].t1[0] = px;
      x[i].t0[1] = x[i].t1[1] = py;
      x[i].t0[2] = x[i].t1[2] = 0;
    };
    still(1, 0, 0);
    still(2, size, 0);
    still(3, 0, 0x1p50);
    const auto path = [&x](double x0, double z0, double x1, double z1) {
      const double from[3] = {x0, 0x1p-1002, z0}, to[3] = {x1, 0x1p-1002, z1};
      std::copy(from, from + 3, x[0].t0);
      std::copy(to, to + 3, x[0].t1);
    };
    path(0x1.988614adc749cp-1002, 0x1.366dca38bd6bep-1001, -0x1.d55ae2274e568p-1002,
         -0x1.64a73eb83cff6p-1001);
    expectAsExact(pair, Answer::kNo);
    path(0x1.039bee163ef9ap-1001, 0x1.37b0ce96c6636p-1001, -0x1.85f901815cd78p-1001,
         -0x1.d435081323ccap-1001);
    expectAsExact(pair, Answer::kYes);
  }
}

/// The place and the normal of two features that touch at t.
struct Geometry {
  double position[3], normal[3];

  Geometry(const MovingPair& pair, double t) {
    contactGeometry(pair.kind, pair.points(), t, position, normal);
  }
};

/// An edge along x from 0 to `length` that rests, and another from p to q that comes from
/// above and touches it at t = 1.
MovingPair fallingEdge(double length, const double (&p)[2], const double (&q)[2],
                       double height) {
  MovingPair pair{ContinuousContactKind::kEdgeEdge, {}};
  pair.x[1].t0[0] = pair.x[1].t1[0] = length;
  for (int k = 0; k < 2; ++k) {
    pair.x[2].t0[k] = pair.x[2].t1[k] = p[k];
    pair.x[3].t0[k] = pair.x[3].t1[k] = q[k];
  }
  pair.x[2].t0[2] = pair.x[3].t0[2] = height;
  return pair;
}

TEST(FCL_ELEMENTARY_TEST, geometryOfAllSizes) {
  for (int exponent = -1000; exponent <= 1000; exponent += 20) {
    const double size = std::ldexp(1, exponent);
    // They cross at a quarter of the first.
    const Geometry found(
        fallingEdge(size, {0.25 * size, -size}, {0.25 * size, size}, size), 1);
    EXPECT_EQ(found.position[0] / size, 0.25) << exponent;
    EXPECT_EQ(found.position[1], 0) << exponent;
    EXPECT_EQ(found.position[2], 0) << exponent;
    // The second comes from above.
    EXPECT_EQ(found.normal[2], 1) << exponent;
  }
}

// Two nearly parallel edges: the square of their product is a subnormal number.
TEST(FCL_ELEMENTARY_TEST, normalOfAShortProduct) {
  for (int exponent = -500; exponent >= -560; exponent -= 5) {
    const double turn = std::ldexp(1, exponent);
    MovingPair pair = fallingEdge(1, {0, 0}, {1, turn}, 1);
    const Geometry found(pair, 1);
    EXPECT_NEAR(Vector3<double>(found.normal).norm(), 1, 1e-15) << exponent;
  }
}

// Edges that lie along each other touch where both are.
TEST(FCL_ELEMENTARY_TEST, geometryOfParallelEdges) {
  constexpr double kRounding = 1e-14;  // of weights, times the longer edge
  const double ranges[][4] = {         // second edge from, to; common part from, to
                              {1, 2, 1, 1},
                              {2, 1, 1, 1},
                              {-1, 0, 0, 0},
                              {0, -1, 0, 0},
                              {0.25, 0.75, 0.25, 0.75},
                              {-3, 0.5, 0, 0.5},
                              {0.5, 9, 0.5, 1},
                              {-2, 4, 0, 1},
                              {5, -1, 0, 1},
                              {0.5, 0.5, 0.5, 0.5}};
  for (const auto& r : ranges)
    for (const double size : {1., 0x1p-300, 0x1p300}) {
      MovingPair pair = fallingEdge(size, {r[0] * size, 0}, {r[1] * size, 0}, size);
      const double x = Geometry(pair, 1).position[0] / size;
      EXPECT_GE(x, r[2] - kRounding) << r[0] << " to " << r[1];
      EXPECT_LE(x, r[3] + kRounding) << r[0] << " to " << r[1];
      // The same seen from the other edge.
      std::swap(pair.x[0], pair.x[2]);
      std::swap(pair.x[1], pair.x[3]);
      const double y = Geometry(pair, 1).position[0] / size;
      EXPECT_GE(y, r[2] - kRounding) << r[0] << " to " << r[1];
      EXPECT_LE(y, r[3] + kRounding) << r[0] << " to " << r[1];
    }
}

// The boxes' depth goes from 1.5e308 to -1.5e308: the difference of the two overflows.
TEST(FCL_ELEMENTARY_TEST, windowOfCoordinatesNearTheLargestDouble) {
  const double big = 0.75e308;
  const MovingPair pair{
      kVf,
      {VertexPath{{0, 0, big}, {0, 0, -big}}, VertexPath{{-1, -1, -big}, {-1, -1, big}},
       VertexPath{{2, -1, -big}, {2, -1, big}}, VertexPath{{-1, 2, -big}, {-1, 2, big}}}};
  ASSERT_EQ(exact(pair).answer, Answer::kYes);
  double lo = 0, hi = 1;
  EXPECT_TRUE(narrowWindow(kVf, pair.points(), lo, hi));
  EXPECT_LE(lo, 0.5);
  EXPECT_GE(hi, 0.5);
  expectAgreement(pair, test(pair), exact(pair));
}

// The vertex comes to the face's side of an edge at t = 2.5e-601, and to its plane at
// 1e-600. The difference of the two is far below the smallest double.
TEST(FCL_ELEMENTARY_TEST, bracketOfATimeBelowTheSmallestDouble) {
  const MovingPair pair{kVf,
                        {VertexPath{{-0.25e-300, 0, 1e-300}, {1e300, 0, -1e300}},
                         at(0, -1, 0), at(0, 1, 0), at(1, 0, 0)}};
  const ElementaryResult r = exact(pair);
  ASSERT_EQ(r.answer, Answer::kYes);
  EXPECT_EQ(r.toc_lo, 0);
  EXPECT_GT(r.toc_hi, 0);
}

// As above at t = 3e-160 / (3e-160 + 7e160), a subnormal double's neighbourhood: the
// lower end must not be rounded up.
TEST(FCL_ELEMENTARY_TEST, bracketOfASubnormalTimeIsRoundedOutward) {
  Random random(17);
  for (int i = 0; i < 200; ++i) {
    const double z0 = random.uniform(1, 9) * 0x1p-530,
                 z1 = -random.uniform(1, 9) * 0x1p530;
    const MovingPair pair{kVf,
                          {VertexPath{{z0 * (-1 + 0x1p-50), 0, z0}, {-z1, 0, z1}},
                           at(0, -1, 0), at(0, 1, 0), at(1, 0, 0)}};
    const ElementaryResult r = exact(pair);
    ASSERT_EQ(r.answer, Answer::kYes);
    // z(t) from its values at the ends, up to factors: z0 + t (z1 - z0), with z0
    // negligible in comparison with z1.
    const Real root = Real{z0} / -Real{z1};
    ASSERT_LE(r.toc_lo, root) << pair;
    ASSERT_GE(r.toc_hi, root) << pair;
  }
}

// t = 2^-1022 / (1 + 2^-1022), just below the smallest normal number: to 53 bits it is
// smaller, to those of a subnormal it would round up.
TEST(FCL_ELEMENTARY_TEST, bracketOfATimeBelowTheSmallestNormal) {
  for (const double toc_err : {1e-3, 1e-12}) {
    const ElementaryResult r = exact({kVf,
                                      {VertexPath{{0.25, 0, 0x1p-1022}, {0.25, 0, -1}},
                                       at(0, -1, 0), at(0, 1, 0), at(1, 0, 0)}},
                                     toc_err);
    EXPECT_EQ(r.answer, Answer::kYes);
    EXPECT_LT(r.toc_lo, DBL_MIN);
    EXPECT_GE(r.toc_hi, DBL_MIN);
    EXPECT_LE(r.toc_hi - r.toc_lo, toc_err);
  }
}

TEST(FCL_ELEMENTARY_TEST, unreadableCoordinatesAreNotCulled) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInf, -kInf})
    for (std::size_t i = 0; i < 4; ++i)
      for (int k = 0; k < 6; ++k) {
        MovingPair pair = edges(at(-1, 0, 0), at(1, 0, 5), at(0, -1, 9), at(0, 1, 8));
        for (const ContinuousContactKind kind : {kVf, kEe}) {
          pair.kind = kind;
          ASSERT_FALSE(mayBecomeCoplanar(kind, pair.points(), 0, 1));
          MovingPair broken = pair;
          (k < 3 ? broken.x[i].t0 : broken.x[i].t1)[k % 3] = bad;
          EXPECT_TRUE(mayBecomeCoplanar(kind, broken.points(), 0, 1)) << broken;
          EXPECT_TRUE(mayBecomeCoplanar(kind, broken.points(), 0.25, 0.75)) << broken;
          EXPECT_NE(solveCoplanarity(kind, broken.points(), 0, 1, 1e-6).answer,
                    Answer::kYes);
        }
      }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

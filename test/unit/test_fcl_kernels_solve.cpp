// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels that find the time of contact, against the exact test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "elementary/exact.h"
#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "real.h"
#include "sanitizer.h"
#include "windowed_pairs.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::abs;
using test::allSets;
using test::expectSameBits;
using test::MovingPair;
using test::Random;
using test::randomWindow;
using test::Real;
using test::scatteredPair;
using test::WindowedPair;

/// Eight pairs in the form of the kernels; owns the vertices.
class EightPoints {
 public:
  explicit EightPoints(const WindowedPair (&queries)[8]) {
    for (std::size_t lane = 0; lane < 8; ++lane)
      for (std::size_t i = 0; i < 4; ++i) {
        const VertexPath& path = queries[lane].pair.x[i];
        TreeVertex& x = x_[lane][i];
        std::copy(path.t0, path.t0 + 3, x.t0);
        std::copy(path.t1, path.t1 + 3, x.t1);
        // The fourth number has no meaning.
        x.t0[3] = x.t1[3] = std::numeric_limits<double>::quiet_NaN();
      }
  }

  /// @param queries  the same pairs, in any windows
  EightPairs pairs(const WindowedPair (&queries)[8]) const {
    EightPairs out;
    out.kind = queries[0].pair.kind;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const TreeVertex* const x[4] = {&x_[lane][0], &x_[lane][1], &x_[lane][2],
                                      &x_[lane][3]};
      out.set(lane, x, queries[lane].lo, queries[lane].hi);
    }
    return out;
  }

 private:
  TreeVertex x_[8][4];
};

struct SolveTally {
  int yes{0}, no{0}, open{0}, divided{0};
};

/// solve(), the same on every instruction set.
EightAnswers solveAll(const EightPairs& eight, double toc_err) {
  const EightAnswers first = allSets().front()->solve(eight, toc_err);
  EXPECT_EQ(first.yes & first.no, 0U);
  EXPECT_EQ((first.yes | first.no) & ~0xffU, 0U);
  for (const Kernels* k : allSets()) {
    const EightAnswers answers = k->solve(eight, toc_err);
    EXPECT_EQ(answers.yes, first.yes) << k->name;
    EXPECT_EQ(answers.no, first.no) << k->name;
    expectSameBits(first.yes, answers.toc_lo, first.toc_lo);
    expectSameBits(first.yes, answers.toc_hi, first.toc_hi);
  }
  return first;
}

/// divide(), the same on every instruction set.
EightDivisions divideAll(const EightPairs& eight) {
  const EightDivisions first = allSets().front()->divide(eight);
  EXPECT_EQ((first.never_inside | first.divisible) & ~0xffU, 0U);
  for (const Kernels* k : allSets()) {
    const EightDivisions found = k->divide(eight);
    EXPECT_EQ(found.never_inside, first.never_inside) << k->name;
    EXPECT_EQ(found.divisible, first.divisible) << k->name;
    expectSameBits(0xffU, found.at, first.at);
  }
  return first;
}

/// What the kernel proves about a pair is true, by the exact test.
void expectRightAnswer(const WindowedPair& q, const ElementaryResult& exact, bool yes,
                       bool no, double lo, double hi, double toc_err) {
  // The first contact of the window is the first of all, or a later one.
  const bool in_window =
      exact.answer == Answer::kYes && exact.toc_lo >= q.lo && exact.toc_hi <= q.hi;
  bool right = true;
  if (no) right = !in_window;
  if (yes) {
    right = exact.answer == Answer::kYes && lo >= q.lo && hi <= q.hi && lo <= hi &&
            hi - lo <= toc_err && exact.toc_lo <= hi;
    if (in_window) right &= lo <= exact.toc_hi;
  }
  ASSERT_TRUE(right) << (yes ? "yes " : "no ") << q.pair << std::hexfloat << " in ["
                     << q.lo << ", " << q.hi << "], [" << lo << ", " << hi
                     << "], exactly [" << exact.toc_lo << ", " << exact.toc_hi << "]";
}

/// Eight pairs in their windows, and the pairs that are left in both parts of the
/// windows.
void expectRightAnswers(const WindowedPair (&queries)[8], double toc_err,
                        SolveTally& tally) {
  const EightPoints points(queries);
  const EightAnswers whole = solveAll(points.pairs(queries), toc_err);
  const EightDivisions divided = divideAll(points.pairs(queries));
  WindowedPair early[8], late[8];
  for (int lane = 0; lane < 8; ++lane) {
    early[lane] = late[lane] = queries[lane];
    early[lane].hi = late[lane].lo = divided.at[lane];
    ASSERT_GE(divided.at[lane], queries[lane].lo);
    ASSERT_LE(divided.at[lane], queries[lane].hi);
  }
  const EightAnswers first = solveAll(points.pairs(early), toc_err),
                     second = solveAll(points.pairs(late), toc_err);
  for (int lane = 0; lane < 8; ++lane) {
    const WindowedPair& q = queries[lane];
    const ElementaryResult exact = decideExactly(q.pair.kind, q.pair.points(), 1e-13);
    const auto expectRight = [&](const WindowedPair& part, const EightAnswers& answers) {
      const bool yes = answers.yes >> lane & 1U, no = answers.no >> lane & 1U;
      expectRightAnswer(part, exact, yes, no, answers.toc_lo[lane], answers.toc_hi[lane],
                        toc_err);
    };
    expectRight(q, whole);
    expectRight(early[lane], first);
    expectRight(late[lane], second);
    const bool never_inside = divided.never_inside >> lane & 1U;
    expectRightAnswer(q, exact, false, never_inside, 0, 0, toc_err);
    const bool yes = whole.yes >> lane & 1U, no = whole.no >> lane & 1U;
    ++(yes ? tally.yes : no ? tally.no : tally.open);
    const unsigned in_parts = first.yes | (first.no & (second.yes | second.no));
    const unsigned decided = divided.never_inside | (divided.divisible & in_parts);
    tally.divided += !yes && !no && (decided >> lane & 1U);
  }
}

TEST(FCL_KERNELS, solvedPairsAreSo) {
  constexpr std::uint64_t kSeed = 81;
  Random random(kSeed);
  SolveTally tally;
  for (int i = 0; i < 12000; ++i) {
    const ContinuousContactKind kind = randomKind(random);
    WindowedPair queries[8];
    for (WindowedPair& q : queries) {
      q.pair = scatteredPair(random, kind);
      if (random.index(8) == 0)
        scale(q.pair, std::ldexp(1, static_cast<int>(random.index(700)) - 350));
      randomWindow(random, q.lo, q.hi);
    }
    const double kErrors[] = {1, 1e-2, 1e-4, 1e-8, 1e-12, 1e-16};
    expectRightAnswers(queries, kErrors[random.index(6)], tally);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(tally.yes, 300);
  EXPECT_GT(tally.no, 10000);
  EXPECT_GT(tally.open, 300);
  EXPECT_GT(tally.divided, 300);
}

/// The volume of the four points at t, from the vectors that the kernels take.
Real volumeAt(const MovingPair& pair, double t) {
  Real p[4][3];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      p[i][k] = (1 - Real{t}) * pair.x[i].t0[k] + Real{t} * pair.x[i].t1[k];
  const bool vf = pair.kind == ContinuousContactKind::kVertexFace;
  const int from[3] = {vf ? 0 : 2, vf ? 2 : 1, 3},
            to[3] = {vf ? 1 : 0, vf ? 1 : 0, vf ? 1 : 2};
  Real e[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) e[i][k] = p[from[i]][k] - p[to[i]][k];
  Real volume = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    volume += e[0][k] * (e[1][l] * e[2][m] - e[1][m] * e[2][l]);
  }
  return volume;
}

/// Pairs of one kind, in most or all of the step.
void randomLongWindows(Random& random, WindowedPair (&queries)[8]) {
  const ContinuousContactKind kind = randomKind(random);
  for (WindowedPair& q : queries) {
    q.pair = scatteredPair(random, kind);
    q.lo = random.index(2) ? 0 : random.uniform(0, 0.4);
    q.hi = random.index(2) ? 1 : random.uniform(0.6, 1);
  }
}

// If a volume certainly goes through zero once, the root is found and the pair decided,
// except for a few whose features meet at their borders.
TEST(FCL_KERNELS, pairsWithOneRootAreDecided) {
  constexpr std::uint64_t kSeed = 84;
  Random random(kSeed);
  int decided = 0, open = 0;
  for (int i = 0; i < test::rounds(20000); ++i) {
    WindowedPair queries[8];
    randomLongWindows(random, queries);
    const double kErrors[] = {1e-2, 1e-4, 1e-8};
    const EightAnswers found =
        solveAll(EightPoints(queries).pairs(queries), kErrors[random.index(3)]);
    for (int lane = 0; lane < 8; ++lane) {
      const WindowedPair& q = queries[lane];
      constexpr int kParts = 64;
      Real volumes[kParts + 1], size = 0;
      int changes = 0;
      for (int k = 0; k <= kParts; ++k) {
        volumes[k] = volumeAt(q.pair, q.lo + (q.hi - q.lo) * k / kParts);
        size = std::max(size, abs(volumes[k]));
        changes += k > 0 && volumes[k] * volumes[k - 1] <= 0;
      }
      const Real clear = 1e-3L * size;
      if (changes != 1 || abs(volumes[0]) < clear || abs(volumes[kParts]) < clear)
        continue;
      ++((found.yes | found.no) >> lane & 1U ? decided : open);
    }
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(decided, test::rounds(10000));
  EXPECT_LT(open, decided / 50);
}

// If a volume goes through zero and back, the window is divided at the farthest point
// beyond zero, so that each part has one root. It is not divided if the volume is zero at
// an end.
TEST(FCL_KERNELS, dividedBetweenTwoRoots) {
  constexpr std::uint64_t kSeed = 83;
  Random random(kSeed);
  int returning = 0, touching = 0;
  for (int i = 0; i < test::rounds(20000); ++i) {
    WindowedPair queries[8];
    randomLongWindows(random, queries);
    const EightPoints points(queries);
    const EightDivisions divided = divideAll(points.pairs(queries));
    for (int lane = 0; lane < 8; ++lane) {
      const WindowedPair& q = queries[lane];
      const Real first = volumeAt(q.pair, q.lo), last = volumeAt(q.pair, q.hi);
      if (first == 0 || last == 0) {
        ++touching;
        EXPECT_FALSE(divided.divisible >> lane & 1U) << q.pair;
        continue;
      }
      // Far from zero on both sides.
      Real farthest = 0, size = 0;
      for (int k = 0; k <= 64; ++k) {
        const Real volume = volumeAt(q.pair, q.lo + (q.hi - q.lo) * k / 64);
        farthest = std::max(farthest, first > 0 ? -volume : volume);
        size = std::max(size, abs(volume));
      }
      const Real clear = 1e-6L * size;
      if (first * last < 0 || size < 1e-3L || farthest < clear || abs(first) < clear ||
          abs(last) < clear)
        continue;
      ++returning;
      const Real there = volumeAt(q.pair, divided.at[lane]);
      EXPECT_TRUE(divided.divisible >> lane & 1U) << q.pair;
      EXPECT_GE(first > 0 ? -there : there, farthest - 1e-12L * size) << q.pair;
    }
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(returning, test::rounds(1000));
  EXPECT_GT(touching, test::rounds(100));
}

// Touches at the end of a window, at rest, during all of the step, of flat pairs and of
// points.
TEST(FCL_KERNELS, solvedDegeneratePairsAreSo) {
  constexpr std::uint64_t kSeed = 82;
  Random random(kSeed);
  SolveTally tally;
  for (int i = 0; i < 3000; ++i) {
    const ContinuousContactKind kind = randomKind(random);
    WindowedPair queries[8];
    for (WindowedPair& q : queries) {
      q.pair.kind = kind;
      for (VertexPath& x : q.pair.x)
        for (int k = 0; k < 3; ++k) {
          x.t0[k] = static_cast<double>(random.index(5)) - 2;
          x.t1[k] = random.index(3) ? x.t0[k] : static_cast<double>(random.index(5)) - 2;
        }
      q.lo = 0.125 * static_cast<double>(random.index(9));
      q.hi = std::min(1., q.lo + 0.125 * static_cast<double>(random.index(9)));
      if (random.index(2)) {
        q.lo = 0;
        q.hi = 1;
      }
    }
    expectRightAnswers(queries, random.index(2) ? 1e-4 : 1e-9, tally);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(tally.yes, 50);
  EXPECT_GT(tally.no, 500);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

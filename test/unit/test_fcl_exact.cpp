// SPDX-License-Identifier: BSD-3-Clause
//
// The exact stages against the definition of a contact, evaluated a second time with
// other formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "elementary/exact.h"
#include "elementary/exact_pair.h"
#include "elementary/magnified_solve.h"
#include "elementary/predicates.h"
#include "feature_pair_generators.h"
#include "query_generators.h"
#include "rational_geometry.h"
#include "sanitizer.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::ExactPoint;
using test::MovingPair;
using test::Random;
using test::Rational;

constexpr double kTocErr = 1e-9;

ElementaryResult exact(const MovingPair& pair) {
  return decideExactly(pair.kind, pair.points(), kTocErr);
}

/// decideExactly() by roots of polynomials alone.
ElementaryResult exactByRoots(const MovingPair& pair, double toc_err, double t_max = 1) {
  ExactQuery query(pair.kind, pair.points());
  if (query.touchInFrame(0)) return {Answer::kYes, 0, 0, DecidedBy::kExact};
  if (t_max == 0) return {Answer::kNo, 0, 0, DecidedBy::kExact};
  return decideByRoots(query.pair(), query.digits().clock_exponent, toc_err, 1, t_max);
}

/// Touching at time k / n, by integers of few digits.
bool doTouchAt(const MovingPair& pair, std::int64_t k, std::int64_t n) {
  return test::doTouch(pair.kind, test::pointsAt<std::int64_t>(pair.x.data(), k, n));
}

/// At the time of the answer the features touch, and at no earlier tested time.
void expectDefinition(const MovingPair& pair, const ElementaryResult& r) {
  constexpr std::int64_t kSteps = 24;  // halves, thirds, eighths
  for (std::int64_t k = 0; k <= kSteps; ++k) {
    if (!doTouchAt(pair, k, kSteps)) continue;
    ASSERT_EQ(r.answer, Answer::kYes) << pair << "\ntouch at " << k << "/" << kSteps;
    ASSERT_LE(Rational(r.toc_lo) * kSteps, k) << pair;
    break;
  }
  if (r.answer == Answer::kYes && r.toc_lo == r.toc_hi) {
    const Rational t(r.toc_lo);
    ASSERT_TRUE(test::doTouch(pair.kind, test::pointsAt<Rational>(pair.x.data(), t, 1)))
        << pair << "\nat " << r.toc_lo;
  }
}

TEST(FCL_EXACT_TEST, gridPairs) {
  constexpr std::uint64_t kSeed = 21;
  Random random(kSeed);
  int contacts = 0, instants = 0;
  for (int i = 0; i < test::rounds(40000); ++i) {
    const MovingPair pair = test::gridPair(random, 1 + i % 3);
    const ElementaryResult truth = exact(pair);
    ASSERT_NO_FATAL_FAILURE(expectDefinition(pair, truth)) << "seed " << kSeed;
    const ElementaryResult r = elementaryTest(pair.kind, pair.points(), 0, 1, 1e-6);
    ASSERT_EQ(r.answer, truth.answer) << pair << "\nseed " << kSeed;
    if (r.answer != Answer::kYes) continue;
    ASSERT_LE(r.toc_lo, truth.toc_hi) << pair;
    ASSERT_GE(r.toc_hi, truth.toc_lo) << pair;
    ++contacts;
    instants += truth.toc_lo == truth.toc_hi;
  }
  EXPECT_GT(contacts, test::rounds(4000));
  EXPECT_GT(instants, test::rounds(1000));
}

// Features that touch by construction at a time that is not a double: k / 7.
TEST(FCL_EXACT_TEST, contactsAtRationalTimes) {
  constexpr std::uint64_t kSeed = 22;
  Random random(kSeed);
  int tested = 0;
  for (int i = 0; i < 60000; ++i) {
    MovingPair pair = test::gridPair(random, 2);
    const std::int64_t k = 1 + static_cast<std::int64_t>(random.index(6));
    for (auto& p : pair.x)
      for (int c = 0; c < 3; ++c) {
        const double position = p.t0[c], velocity = p.t1[c];
        p.t0[c] = position - static_cast<double>(k) * velocity;
        p.t1[c] = position + static_cast<double>(7 - k) * velocity;
      }
    if (!doTouchAt(pair, k, 7)) continue;
    ++tested;
    const ElementaryResult truth = exact(pair);
    ASSERT_EQ(truth.answer, Answer::kYes) << pair << "\nseed " << kSeed;
    ASSERT_LE(Rational(truth.toc_lo) * 7, k) << pair;
    ASSERT_NO_FATAL_FAILURE(expectDefinition(pair, truth));
    const ElementaryResult r = elementaryTest(pair.kind, pair.points(), 0, 1, 1e-6);
    ASSERT_EQ(r.answer, Answer::kYes) << pair << "\nseed " << kSeed;
    ASSERT_LE(Rational(r.toc_lo) * 7, k) << pair;
  }
  EXPECT_GT(tested, 3000);
}

// A vertex that falls through a static triangle: the time is a fraction, known exactly.
TEST(FCL_EXACT_TEST, bracketsContainKnownTimes) {
  constexpr std::uint64_t kSeed = 23;
  Random random(kSeed);
  for (int i = 0; i < 2000; ++i) {
    const double top = random.uniform(1e-6, 1), bottom = -random.uniform(1e-6, 1);
    const double x = random.uniform(-0.2, 0.2), y = random.uniform(-0.2, 0.2);
    MovingPair pair{
        ContinuousContactKind::kVertexFace,
        {VertexPath{{x, y, top}, {x, y, bottom}}, VertexPath{{-1, -1, 0}, {-1, -1, 0}},
         VertexPath{{1, -1, 0}, {1, -1, 0}}, VertexPath{{0, 1, 0}, {0, 1, 0}}}};
    const Rational time = Rational(top) / (Rational(top) - Rational(bottom));
    for (const double toc_err : {1e-3, 1e-9, 1e-15})
      for (const ElementaryResult& r :
           {decideExactly(pair.kind, pair.points(), toc_err),
            elementaryTest(pair.kind, pair.points(), 0, 1, toc_err)}) {
        ASSERT_EQ(r.answer, Answer::kYes) << pair;
        ASSERT_LE(Rational(r.toc_lo), time) << pair;
        ASSERT_GE(Rational(r.toc_hi), time) << pair;
      }
  }
}

bool isFinite(const MovingPair& pair) {
  for (const VertexPath& p : pair.x)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(p.t0[k]) || !std::isfinite(p.t1[k])) return false;
  return true;
}

/// Pairs that doubles do not decide: all families of degenerate pairs, points that nearly
/// meet in one point, and coordinates of very different size.
MovingPair hardPair(Random& random, int i) {
  const auto& families = test::queryFamilies();
  MovingPair pair =
      families[static_cast<std::size_t>(i) % families.size()].generate(random);
  if (i % 3 == 1) {  // to the other side of a point, rounded
    const Vector3<double> center = random.point(0.5);
    const double factor = -random.uniform(0.1, 2);
    for (auto& p : pair.x)
      for (int k = 0; k < 3; ++k) p.t1[k] = center[k] + factor * (p.t0[k] - center[k]);
  }
  const int power = static_cast<int>(random.index(1200)) - 600;
  MovingPair scaled = pair;
  if (i % 7 == 2)
    for (auto& p : scaled.x)
      for (double& c : p.t1) c = std::ldexp(c, power);
  if (i % 11 == 3)
    scaled = test::mapped(scaled, [power](double c) { return std::ldexp(c, power); });
  return isFinite(scaled) ? scaled : pair;
}

bool isNarrow(const ElementaryResult& r, double toc_err) {
  return r.toc_hi - r.toc_lo <= std::max(toc_err, 0x1p-50 * r.toc_hi);
}

/// solveMagnified() of any pair, also if it is not worth magnifying.
ElementaryResult solve(const MovingPair& pair, double toc_err, double t_stop,
                       double t_max) {
  ExactQuery query(pair.kind, pair.points());
  if (query.touchInFrame(0)) return {Answer::kYes, 0, 0, DecidedBy::kExact};
  if (t_max == 0) return {Answer::kNo, 0, 0, DecidedBy::kExact};
  return solveMagnified(query, toc_err, t_stop, t_max);
}

TEST(FCL_EXACT_TEST, magnifiedSolveAgreesWithRoots) {
  constexpr std::uint64_t kSeed = 27;
  constexpr int kQueries = 8000;
  Random random(kSeed);
  int contacts = 0, with_limit = 0, decided = 0;
  for (int i = 0; i < kQueries; ++i) {
    const MovingPair pair = hardPair(random, i);
    const double toc_err = i % 2 ? 1e-4 : 1e-12;
    const ElementaryResult truth = exactByRoots(pair, 1e-300),
                           r = decideExactly(pair.kind, pair.points(), toc_err);
    ASSERT_EQ(r.answer, truth.answer) << pair << "\nseed " << kSeed << ", " << i;
    const double any = random.uniform(0, 1),
                 limits[] = {any, truth.toc_lo, std::nextafter(truth.toc_lo, 0),
                             truth.toc_hi, std::ldexp(std::floor(8 * any), -3)};
    const double limit = truth.answer == Answer::kYes ? limits[random.index(5)] : any;
    const ElementaryResult magnified = solve(pair, toc_err, 1, 1);
    decided += magnified.answer != Answer::kUnsure;
    if (magnified.answer != Answer::kUnsure) {
      ASSERT_EQ(magnified.answer, truth.answer)
          << pair << "\nseed " << kSeed << ", " << i;
      if (truth.answer == Answer::kYes) {
        ASSERT_TRUE(isNarrow(magnified, toc_err)) << pair;
        ASSERT_LE(magnified.toc_lo, truth.toc_hi) << pair << "\nseed " << kSeed;
        ASSERT_GE(magnified.toc_hi, truth.toc_lo) << pair << "\nseed " << kSeed;
      }
    }
    ElementaryResult until = solve(pair, toc_err, 1, limit);
    if (until.answer == Answer::kUnsure)
      until = decideExactly(pair.kind, pair.points(), toc_err, 1, limit);
    ASSERT_EQ(until.answer, exactByRoots(pair, toc_err, limit).answer)
        << pair << "\nseed " << kSeed << ", " << i << ", until " << limit;
    ElementaryResult early = solve(pair, toc_err, limit, 1);
    if (early.answer == Answer::kUnsure)
      early = decideExactly(pair.kind, pair.points(), toc_err, limit);
    if (truth.answer == Answer::kNo) {
      ASSERT_EQ(until.answer, Answer::kNo) << pair;
      ASSERT_EQ(early.answer, Answer::kNo) << pair;
      continue;
    }
    ++contacts;
    ASSERT_TRUE(isNarrow(r, toc_err)) << pair << "\nseed " << kSeed << ", " << i;
    ASSERT_LE(r.toc_lo, truth.toc_hi) << pair << "\nseed " << kSeed << ", " << i;
    ASSERT_GE(r.toc_hi, truth.toc_lo) << pair << "\nseed " << kSeed << ", " << i;
    if (truth.toc_hi <= limit) {
      ASSERT_EQ(until.answer, Answer::kYes) << pair << "\nuntil " << limit;
      ASSERT_LE(until.toc_lo, truth.toc_hi) << pair << "\nuntil " << limit;
      ASSERT_GE(until.toc_hi, truth.toc_lo) << pair << "\nuntil " << limit;
      ASSERT_LE(until.toc_hi, limit) << pair;
      ASSERT_EQ(early.answer, Answer::kYes) << pair << "\nafter " << limit;
      ++with_limit;
    } else if (truth.toc_lo > limit) {
      ASSERT_EQ(until.answer, Answer::kNo) << pair << "\nuntil " << limit;
    }
    const ElementaryResult stopped =
        decideExactly(pair.kind, pair.points(), toc_err, limit);
    if (stopped.answer == Answer::kYes) {
      ASSERT_EQ(stopped.toc_lo, r.toc_lo) << pair << "\nafter " << limit;
      ASSERT_EQ(stopped.toc_hi, r.toc_hi) << pair << "\nafter " << limit;
    }
    if (early.answer == Answer::kNo) {
      ASSERT_GT(truth.toc_hi, limit) << pair << "\nafter " << limit;
    }
  }
  EXPECT_GT(contacts, kQueries / 4);
  EXPECT_GT(with_limit, kQueries / 10);
  EXPECT_GT(decided, kQueries / 2);
}

// Features that touch by construction at k / 8, a double: a limit there counts, the
// double before does not.
TEST(FCL_EXACT_TEST, touchExactlyAtTheLatestTime) {
  constexpr std::uint64_t kSeed = 28;
  constexpr int kParts = 8;
  Random random(kSeed);
  int tested = 0;
  for (int i = 0; i < 60000; ++i) {
    MovingPair pair = test::gridPair(random, 2);
    const auto k = static_cast<int>(random.index(kParts + 1));
    for (auto& p : pair.x)
      for (int c = 0; c < 3; ++c) {
        const double position = p.t0[c], velocity = p.t1[c];
        p.t0[c] = position - k * velocity;
        p.t1[c] = position + (kParts - k) * velocity;
      }
    if (!doTouchAt(pair, k, kParts)) continue;
    const double t = static_cast<double>(k) / kParts;
    const ElementaryResult until = decideExactly(pair.kind, pair.points(), 1e-9, 1, t);
    ASSERT_EQ(until.answer, Answer::kYes) << pair << "\nat " << t;
    ASSERT_LE(until.toc_hi, t) << pair;
    const ElementaryResult first = exactByRoots(pair, 1e-300);
    if (first.toc_lo != t) continue;
    ASSERT_EQ(first.toc_hi, t) << pair;
    if (t > 0) {
      const double before = std::nextafter(t, 0);
      ASSERT_EQ(decideExactly(pair.kind, pair.points(), 1e-9, 1, before).answer,
                Answer::kNo)
          << pair << "\nbefore " << t;
    }
    ++tested;
  }
  EXPECT_GT(tested, 2000);
}

struct Tetrahedron {
  double p[4][3];

  ExactPoint<Rational> exactPoint(int i) const {
    return {Rational(p[i][0]), Rational(p[i][1]), Rational(p[i][2])};
  }
  int truth() const {
    return test::volumeSign(exactPoint(0), exactPoint(1), exactPoint(2), exactPoint(3));
  }
  int sign() const { return orientation(p[0], p[1], p[2], p[3]); }
};

TEST(FCL_CROSSING_TEST, orientationIsExact) {
  constexpr std::uint64_t kSeed = 24;
  Random random(kSeed);
  int flat = 0;
  for (int i = 0; i < test::rounds(30000); ++i) {
    Tetrahedron t;
    for (auto& point : t.p)
      for (double& c : point) switch (i % 5) {
          case 0:  // integers, often coplanar
            c = static_cast<double>(random.index(5)) - 2;
            break;
          case 1:
            c = random.uniform(-1, 1);
            break;
          case 2:  // exponents that only fit integers of any size
            c = std::ldexp(random.uniform(-1, 1),
                           static_cast<int>(random.index(120)) - 60);
            break;
          case 3:  // down to subnormals, up to where products overflow
            c = std::ldexp(static_cast<double>(random.index(9)) - 4,
                           static_cast<int>(random.index(5)) * 500 - 1070);
            break;
          default:  // a large offset: differences lose digits
            c = 1e8 + random.uniform(-1e-7, 1e-7);
        }
    if (i % 2)  // in or nearly in the plane of the others
      for (int k = 0; k < 3; ++k)
        t.p[0][k] = 0.5 * t.p[1][k] + 0.25 * t.p[2][k] + 0.25 * t.p[3][k];
    const int truth = t.truth();
    ASSERT_EQ(t.sign(), truth) << "seed " << kSeed << ", " << i;
    flat += truth == 0;
    std::swap(t.p[2], t.p[3]);
    ASSERT_EQ(t.sign(), -truth) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(flat, test::rounds(1000));
}

// The length of the integers depends on the digits of the coordinates. Around each length
// at which longer ones are needed, the differences of opposite corners are the largest.
TEST(FCL_CROSSING_TEST, orientationOfIntegersOfAnyLength) {
  constexpr std::uint64_t kSeed = 25;
  Random random(kSeed);
  int flat = 0;
  for (const int digits : {24, 39, 40, 41, 42, 53, 100, 167, 168, 169, 170, 240, 400})
    for (int i = 0; i < 500; ++i) {
      const auto sign = [&random] { return random.index(2) ? 1. : -1.; };
      const int cut = std::min(digits, 53);
      const double largest = std::ldexp(std::ldexp(1., cut) - 1, digits - cut);
      // Two opposite corners, another one, and a point in the middle or at a corner; or
      // one unit away from it.
      Tetrahedron t;
      const bool at_corner = random.index(2);
      for (int k = 0; k < 3; ++k) {
        t.p[1][k] = sign() * largest;
        t.p[2][k] = sign() * largest;
        t.p[3][k] = at_corner ? sign() * largest : -t.p[2][k];
        t.p[0][k] = at_corner ? t.p[2][k] : 0;
        if (i % 3 && random.index(2))
          t.p[0][k] = at_corner ? std::nextafter(t.p[0][k], 0) : 1;
      }
      if (at_corner) t.p[1][random.index(3)] = 1;
      std::swap(t.p[random.index(4)], t.p[random.index(4)]);
      const double scale = std::ldexp(1., static_cast<int>(random.index(800)) - 400);
      for (auto& point : t.p)
        for (double& c : point) c *= scale;
      const int truth = t.truth();
      flat += truth == 0;
      ASSERT_EQ(t.sign(), truth) << "seed " << kSeed << ", " << digits << ", " << i;
    }
  EXPECT_GT(flat, 2000);
  EXPECT_LT(flat, 5000);
}

/// Four points, often in degenerate places.
Tetrahedron degeneratePoints(Random& random, int i) {
  Tetrahedron t;
  const double scales[] = {1, 0.1, 0x1p-1070, 0x1p500, 1e-3};
  const double scale = scales[random.index(5)],
               offset = random.index(3) ? 0 : 1e8 * scale;
  for (auto& point : t.p)
    for (double& c : point)
      c = i % 2 ? scale * (static_cast<double>(random.index(4)) - 1) + offset
                : scale * random.uniform(-1, 1);
  const std::size_t axis = random.index(3);
  if (i % 3 == 0)
    for (auto& point : t.p) point[axis] = t.p[0][axis];
  // A point between two others, up to rounding, or one step away.
  if (i % 4 == 0) {
    const std::size_t a = random.index(4), b = random.index(4), c = random.index(4);
    const double s = random.index(2) ? 0.5 : random.uniform(0, 1);
    for (int k = 0; k < 3; ++k) t.p[a][k] = (1 - s) * t.p[b][k] + s * t.p[c][k];
    if (random.index(2)) t.p[a][axis] = std::nextafter(t.p[a][axis], 1e300);
  }
  return t;
}

TEST(FCL_INSTANT_TEST, touchingIsExact) {
  constexpr std::uint64_t kSeed = 26;
  Random random(kSeed);
  int touch = 0;
  for (int i = 0; i < test::rounds(12000); ++i) {
    const Tetrahedron t = degeneratePoints(random, i);
    const auto& p = t.p;
    const std::array<ExactPoint<Rational>, 4> e{t.exactPoint(0), t.exactPoint(1),
                                                t.exactPoint(2), t.exactPoint(3)};
    const bool on_triangle = test::doTouch(ContinuousContactKind::kVertexFace, e),
               segments = test::doTouch(ContinuousContactKind::kEdgeEdge, e);
    ASSERT_EQ(isOnTriangle(p[0], p[1], p[2], p[3]), on_triangle)
        << "seed " << kSeed << ", " << i;
    ASSERT_EQ(doSegmentsTouch(p[0], p[1], p[2], p[3]), segments)
        << "seed " << kSeed << ", " << i;
    touch += on_triangle + segments;
    for (int axis = 0; axis < 3; ++axis) {
      const auto exact_cross =
          test::cross(test::minus(e[1], e[0]), test::minus(e[3], e[2]));
      ASSERT_EQ(crossSign(p[0], p[1], p[2], p[3], axis),
                test::signOf(exact_cross[static_cast<std::size_t>(axis)]))
          << "seed " << kSeed << ", " << i;
    }
  }
  EXPECT_GT(touch, test::rounds(900));
}

// The normal overflows, but the volume is an ordinary number.
TEST(FCL_INSTANT_TEST, hugeTriangleTinyDistance) {
  constexpr double kSide = 0x1.ap511, kWeight = 0x1p-712;
  const double a[3] = {0, 0, 0}, b[3] = {kSide / 2, kSide, -kSide},
               c[3] = {kSide / 2, kSide, kSide},
               p[3] = {kWeight * kSide, 2 * kWeight * kSide, 0};  // weight (b + c)
  EXPECT_EQ(orientation(p, a, b, c), 0);
  EXPECT_TRUE(isOnTriangle(p, a, b, c));
}

TEST(FCL_CROSSING_TEST, onlyTheInsideCounts) {
  const double a[3] = {0, 0, 0}, b[3] = {4, 0, 0}, c[3] = {0, 4, 0};
  const auto isCrossed = [&](double x, double y, double z0, double z1) {
    const double p[3] = {x, y, z0}, q[3] = {x, y, z1};
    const bool crossed = isCrossing(p, q, a, b, c);
    EXPECT_EQ(isCrossing(q, p, a, b, c), crossed);
    EXPECT_EQ(isCrossing(p, q, b, c, a), crossed);
    EXPECT_EQ(isCrossing(p, q, b, a, c), crossed);
    return crossed;
  };
  EXPECT_TRUE(isCrossed(1, 1, 1, -1));
  EXPECT_TRUE(isCrossed(2 - 0x1p-51, 2, 1, -1));
  EXPECT_TRUE(isCrossed(1, 1, 1e300, -1e-300));
  EXPECT_FALSE(isCrossed(1, 1, 1, 0x1p-1074));
  EXPECT_FALSE(isCrossed(1, 1, 1, 0)) << "an end on the face";
  EXPECT_FALSE(isCrossed(2, 2, 1, -1)) << "through an edge";
  EXPECT_FALSE(isCrossed(4, 0, 1, -1)) << "through a corner";
  EXPECT_FALSE(isCrossed(3, 3, 1, -1)) << "outside";
  EXPECT_FALSE(isCrossed(1, 1, 0, 0)) << "a point in the face";
  const double p[3] = {-1, 1, 0}, q[3] = {9, 1, 0};
  EXPECT_FALSE(isCrossing(p, q, a, b, c)) << "in the plane";
  const double up[3] = {1, 0, 1}, down[3] = {1, 0, -1};
  EXPECT_FALSE(isCrossing(up, down, a, b, b)) << "no area";
}

// A proper crossing: the closed segment and triangle meet, and no end or border is
// involved.
TEST(FCL_CROSSING_TEST, gridTriangles) {
  constexpr std::uint64_t kSeed = 25;
  Random random(kSeed);
  int crossings = 0;
  for (int i = 0; i < 40000; ++i) {
    double x[5][3];
    ExactPoint<std::int64_t> e[5];
    for (std::size_t j = 0; j < 5; ++j)
      for (std::size_t k = 0; k < 3; ++k) {
        e[j][k] = static_cast<std::int64_t>(random.index(5)) - 2;
        x[j][k] = static_cast<double>(e[j][k]);
      }
    const std::int64_t side_p = test::volumeSign(e[0], e[2], e[3], e[4]),
                       side_q = test::volumeSign(e[1], e[2], e[3], e[4]);
    bool truth = side_p * side_q < 0;
    if (truth) {
      // The point where pq meets the plane, times the sum of the distances of p and q
      // from it.
      const auto n = test::cross(test::minus(e[3], e[2]), test::minus(e[4], e[2]));
      const std::int64_t dp = std::abs(test::dot(test::minus(e[0], e[2]), n)),
                         dq = std::abs(test::dot(test::minus(e[1], e[2]), n));
      ExactPoint<std::int64_t> meet, corner[3];
      for (std::size_t k = 0; k < 3; ++k) {
        meet[k] = dq * e[0][k] + dp * e[1][k];
        for (std::size_t j = 0; j < 3; ++j) corner[j][k] = (dp + dq) * e[2 + j][k];
      }
      truth = test::isOnTriangle(meet, corner[0], corner[1], corner[2]);
      for (std::size_t j = 0; j < 3; ++j)
        truth = truth && !test::isOnSegment(meet, corner[j], corner[(j + 1) % 3]);
    }
    ASSERT_EQ(isCrossing(x[0], x[1], x[2], x[3], x[4]), truth)
        << "seed " << kSeed << ", " << i;
    crossings += truth;
  }
  EXPECT_GT(crossings, 500);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The public elementary tests. The stages behind them have tests of their own.
#include "fcl/narrowphase/continuous_features.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "elementary/exact.h"
#include "feature_test_calls.h"
#include "real.h"
#include "test_models.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace fcl {
namespace test {
namespace {

using detail::deformable::Answer;
using detail::deformable::decideExactly;
using detail::deformable::ElementaryResult;

template <typename S>
class ContinuousFeatureTest : public testing::Test {};
using Scalars = testing::Types<double, float>;
TYPED_TEST_SUITE(ContinuousFeatureTest, Scalars, );

TYPED_TEST(ContinuousFeatureTest, ReadsAsInTheLiterature) {
  using S = TypeParam;
  using V = Vector3<S>;
  const V f0(0, 0, 0), f1(4, 0, 0), f2(0, 4, 0);
  // A vertex falls through the triangle at a third of the step.
  auto result = vertexFace(V(1, 1, 1), f0, f1, f2, V(1, 1, -2), f0, f1, f2, 1e-6);
  EXPECT_TRUE(result.is_contact);
  EXPECT_LE(3 * Real{result.toc_lo}, 1);
  EXPECT_GE(3 * Real{result.toc_hi}, 1);
  EXPECT_LE(result.toc_hi - result.toc_lo, 2e-6);
  // The triangle rises against the vertex, which rests: points at t = 0 come first.
  const V up(0, 0, 2), v(1, 1, 1);
  result = vertexFace<S>(v, f0, f1, f2, v, f0 + up, f1 + up, f2 + up, 1e-6);
  EXPECT_TRUE(result.is_contact);
  EXPECT_LE(result.toc_lo, S(0.5));
  EXPECT_GE(result.toc_hi, S(0.5));
  // Beside the triangle.
  result = vertexFace(V(3, 3, 1), f0, f1, f2, V(3, 3, -1), f0, f1, f2, 1e-6);
  EXPECT_FALSE(result.is_contact);
  EXPECT_EQ(result.toc_lo, 1);
  EXPECT_EQ(result.toc_hi, 1);
  // Closed features, closed interval: ends meet at t = 1.
  result = edgeEdge(V(-1, 0, 0), V(1, 0, 0), V(1, 0, 1), V(2, 1, 1), V(-1, 0, 0),
                    V(1, 0, 0), V(1, 0, 0), V(2, 1, 0), 1e-6);
  EXPECT_TRUE(result.is_contact);
  EXPECT_EQ(result.toc_hi, 1);
  // Degenerate features are the sets of their points.
  const V p(1, 2, 3);
  result = edgeEdge(p, p, p, p, p, p, p, p, 1e-6);
  EXPECT_TRUE(result.is_contact);
  EXPECT_EQ(result.toc_lo, 0);
  EXPECT_EQ(result.toc_hi, 0);
}

TYPED_TEST(ContinuousFeatureTest, AgreesWithTheDefinition) {
  using S = TypeParam;
  constexpr std::uint64_t kSeed = 41;
  Random random(kSeed);
  int contacts = 0;
  for (int i = 0; i < 6000; ++i) {
    MovingPair pair = i % 3 ? randomPair(random) : gridPair(random, 3);
    if (std::is_same_v<S, float>) pair = floatPair(pair);
    const ElementaryResult truth = decideExactly(pair.kind, pair.points(), 1e-15);
    const double toc_err = std::pow(10, random.uniform(-18, -1));
    const auto result = featureTest<S>(pair, toc_err);
    ASSERT_EQ(result.is_contact, truth.answer == Answer::kYes) << pair << kSeed;
    if (!result.is_contact) continue;
    ++contacts;
    const double lo{result.toc_lo}, hi{result.toc_hi};
    ASSERT_LE(lo, truth.toc_hi) << pair;
    ASSERT_GE(hi, truth.toc_lo) << pair;
    ASSERT_GE(lo, 0) << pair;
    ASSERT_LE(hi, 1) << pair;
    // Rounding to S adds at most a unit in the last place at each end.
    const double unit = std::numeric_limits<S>::epsilon();
    ASSERT_LE(hi - lo, std::max(toc_err + unit, 4 * unit)) << pair << "\n" << toc_err;
  }
  EXPECT_GT(contacts, 1000);
}

TYPED_TEST(ContinuousFeatureTest, UnusableInputIsRefusedByName) {
  using S = TypeParam;
  const char* const names[2][8] = {
      {"v_t0", "f0_t0", "f1_t0", "f2_t0", "v_t1", "f0_t1", "f1_t1", "f2_t1"},
      {"ea0_t0", "ea1_t0", "eb0_t0", "eb1_t0", "ea0_t1", "ea1_t1", "eb0_t1", "eb1_t1"}};
  const auto call = [](int kind, const std::vector<Vector3<S>>& p, double toc_err) {
    const auto test = kind ? edgeEdge<S> : vertexFace<S>;
    return test(p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], toc_err);
  };
  const std::vector<Vector3<S>> good(8, Vector3<S>(1, 2, 3));
  for (int kind = 0; kind < 2; ++kind) {
    for (std::size_t i = 0; i < 8; ++i)
      for (const S value :
           {std::numeric_limits<S>::quiet_NaN(), -std::numeric_limits<S>::infinity()}) {
        auto bad = good;
        bad[i][static_cast<int>(i) % 3] = value;
        expectRefused([&] { call(kind, bad, 1e-6); },
                      std::string(names[kind][i]) + " is not finite");
      }
    for (const double toc_err : {-1., std::numeric_limits<double>::quiet_NaN()})
      expectRefused([&] { call(kind, good, toc_err); }, "toc_err is negative or NaN");
    EXPECT_TRUE(call(kind, good, 0).is_contact);
    EXPECT_TRUE(call(kind, good, std::numeric_limits<double>::denorm_min()).is_contact);
    EXPECT_TRUE(call(kind, good, std::numeric_limits<double>::infinity()).is_contact);
  }
}

// A time that no double is: as close as doubles get, whatever is asked for.
TEST(FCL_CONTINUOUS_FEATURE_TEST, tinyTolerances) {
  using V = Vector3<double>;
  const V a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  for (const double toc_err : {1e-16, 1e-300, 1e-310, 5e-324, 0.}) {
    const auto third =
        vertexFace<double>(V(0.2, 0.2, 1), a, b, c, V(0.2, 0.2, -2), a, b, c, toc_err);
    EXPECT_TRUE(third.is_contact);
    EXPECT_LE(3 * third.toc_lo, 1);  // the product is exact enough: no double is a third
    EXPECT_GE(3 * third.toc_hi, 1);
    EXPECT_LE(third.toc_hi - third.toc_lo, 4 * std::numeric_limits<double>::epsilon());
  }
}

/// Rounding upward and, where there are such bits, subnormals read and written as zero.
class RoughFloatingPoint {
 public:
  RoughFloatingPoint() {
    std::fegetenv(&saved_);
    std::fesetround(FE_UPWARD);
#if defined(__SSE2__)
    _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
  }
  ~RoughFloatingPoint() { std::fesetenv(&saved_); }
  RoughFloatingPoint(const RoughFloatingPoint&) = delete;
  RoughFloatingPoint& operator=(const RoughFloatingPoint&) = delete;

 private:
  std::fenv_t saved_;
};

TYPED_TEST(ContinuousFeatureTest, TheCallersModeDoesNotMatter) {
  using S = TypeParam;
  constexpr std::uint64_t kSeed = 42;
  Random random(kSeed);
  // Every second pair consists of subnormal numbers.
  constexpr int kExponent = std::numeric_limits<S>::min_exponent - 12;
  for (int i = 0; i < 2000; ++i) {
    MovingPair pair = i % 2 ? floatPair(randomPair(random)) : gridPair(random, 3);
    if (i % 2 == 0)
      pair = mapped(pair, [](double c) { return std::ldexp(c, kExponent); });
    const auto expected = featureTest<S>(pair, 1e-6);
    std::vector<Vector3<S>> p;
    for (const bool end : {false, true})
      for (const auto& x : pair.x) {
        const double* c = end ? x.t1 : x.t0;
        p.emplace_back(static_cast<S>(c[0]), static_cast<S>(c[1]), static_cast<S>(c[2]));
      }
    const auto test = pair.kind == fcl::ContinuousContactKind::kVertexFace ? vertexFace<S>
                                                                           : edgeEdge<S>;
    ContinuousFeatureTestResult<S> result;
    int mode_after = 0;
    {
      const RoughFloatingPoint mode;
      result = test(p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], 1e-6);
      mode_after = std::fegetround();
    }
    ASSERT_EQ(mode_after, FE_UPWARD);
    ASSERT_EQ(result.is_contact, expected.is_contact) << pair;
    ASSERT_EQ(result.toc_lo, expected.toc_lo) << pair;
    ASSERT_EQ(result.toc_hi, expected.toc_hi) << pair;
  }
}

TEST(ContinuousFeatureTests, FloatIsDoubleOfTheFloats) {
  constexpr std::uint64_t kSeed = 43;
  Random random(kSeed);
  int contacts = 0;
  for (int i = 0; i < 5000; ++i) {
    const MovingPair pair =
        floatPair(i % 3 ? randomPair(random) : gridPair(random, 1 + i % 4));
    const auto f = featureTest<float>(pair, 1e-9);
    const auto d = featureTest<double>(pair, 1e-9);
    ASSERT_EQ(f.is_contact, d.is_contact) << pair << kSeed;
    if (!f.is_contact) continue;
    ++contacts;
    // Outward, by the nearest float.
    ASSERT_LE(double{f.toc_lo}, d.toc_lo) << pair;
    ASSERT_GE(double{f.toc_hi}, d.toc_hi) << pair;
    ASSERT_TRUE(double{f.toc_lo} == d.toc_lo ||
                double{std::nextafter(f.toc_lo, 2.f)} > d.toc_lo)
        << pair;
    ASSERT_TRUE(double{f.toc_hi} == d.toc_hi ||
                double{std::nextafter(f.toc_hi, -1.f)} < d.toc_hi)
        << pair;
  }
  EXPECT_GT(contacts, 1000);
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The public elementary tests at a distance. The comparison with exact numbers is in
// test_fcl_oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "elementary/distance_advance.h"
#include "fcl/narrowphase/continuous_features.h"
#include "feature_test_calls.h"
#include "query_generators.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::advanceToDistance;
using detail::deformable::DistanceContact;
using detail::deformable::DistanceRequest;
using Kind = ContinuousContactKind;
using V = Vector3<double>;
using Result = ContinuousFeatureTestResultd;

constexpr double kErr = 1e-6;

/// The time is not late, and early by rounding only.
void expectTime(const Result& result, double time) {
  EXPECT_TRUE(result.is_contact);
  EXPECT_LE(result.toc_lo, time * (1 + 1e-15));
  EXPECT_GE(result.toc_lo, time * (1 - 1e-11));
  EXPECT_GE(result.toc_hi, time * (1 - 1e-15));
  EXPECT_LE(result.toc_hi - result.toc_lo, kErr);
}

// The direction that turns is a quotient by the area of a sliver, and not perpendicular.
TEST(FCL_DISTANCE_FEATURES, sliverThatOpensInItsPlane) {
  const V v(0, 0, 0);
  const V t0[3] = {{-0.6666666666666666, 0.17694924931527778, 0.1769494082609972},
                   {0.33333333333333337, 0.17694924931527778, 0.1769494082609972},
                   {0.33333333333333337, 0.17694948773385688, 0.1769491698424181}};
  const V t1[3] = {{-0.6666666666666666, 0.010109949108694699, 0.3434434413877474},
                   {0.33333333333333337, 0.010109949108694699, 0.3434434413877474},
                   {0.33333333333333337, 0.5101101875272738, -0.1565567970308317}};
  // At t = 1 the distance is 0.25 (1 - 2.7e-10), by rational arithmetic.
  EXPECT_TRUE(
      vertexFaceWithin<double>(v, t0[0], t0[1], t0[2], v, t1[0], t1[1], t1[2], kErr, 0.25)
          .is_contact);
}

// A pair that begins just above the distance, moves away and comes back, as after a step
// of a simulation.
TEST(FCL_DISTANCE_FEATURES, comesBackToTheDistance) {
  const V v(0, 0, 0);
  const double d = 0x1.df86c571174b9p-5;
  const V t0[3] = {{-0x1.cce81940ee351p+1, -0x1.346970ff5b7fcp+1, 0x1.df86c57121355p-5},
                   {0x1.b42dc32b8c4d3p+1, -0x1.1c4b0181ae792p+1, 0x1.df86c57121355p-5},
                   {-0x1.af5dec6805470p-4, 0x1.95a4bf7f03f40p+1, 0x1.df86c57121355p-5}};
  const V t1[3] = {{-0x1.944441941b5d4p+1, -0x1.346970ff5b7fcp+1, -0x1.308404095b53cp-6},
                   {0x1.ecd19ad85f250p+1, -0x1.1c4b0181ae792p+1, 0x1.376f922a89468p-3},
                   {0x1.5947424c956cfp-2, 0x1.95a4bf7f03f40p+1, 0x1.108066eb5c579p-4}};
  // The exact first time is 0.97822769 and some more digits.
  const Result result =
      vertexFaceWithin<double>(v, t0[0], t0[1], t0[2], v, t1[0], t1[1], t1[2], kErr, d);
  EXPECT_TRUE(result.is_contact);
  EXPECT_LE(result.toc_lo, 0.9782277);
}

TEST(FCL_DISTANCE_FEATURES, closedForms) {
  const V f0(0, 0, 0), f1(4, 0, 0), f2(0, 4, 0), down(0, 0, -2);
  // A vertex falls on a face from the height 1 and is a quarter above it at 3/8.
  const V v(1, 1, 1);
  expectTime(vertexFaceWithin<double>(v, f0, f1, f2, v + down, f0, f1, f2, kErr, 0.25),
             0.375);
  // Beside an edge of the face: the distance is sqrt(1 + z^2).
  const V w(1, -1, 2);
  expectTime(
      vertexFaceWithin<double>(w, f0, f1, f2, w + down, f0, f1, f2, kErr, std::sqrt(2)),
      0.5);
  expectTime(vertexEdgeWithin<double>(w, f0, f1, w + down, f0, f1, kErr, std::sqrt(2)),
             0.5);
  // A graze at exactly the distance, and just above it.
  const V a(-3, -1, 0), b(3, -1, 0);
  const Result graze = vertexVertexWithin<double>(a, f0, b, f0, kErr, 1);
  EXPECT_TRUE(graze.is_contact);
  EXPECT_LE(graze.toc_lo, 0.5);
  EXPECT_GE(graze.toc_lo, 0.5 - 1e-7);
  EXPECT_FALSE(vertexVertexWithin<double>(a, f0, b, f0, kErr, 1 - 1e-8).is_contact);
  EXPECT_FALSE(vertexEdgeWithin<double>(a, f0, f1, b, f0, f1, kErr, 1 - 1e-8).is_contact);
  // Crossed edges at the heights 0 and 3, which fall by 2.
  const V e(1, -1, 3), f(1, 1, 3);
  expectTime(edgeEdgeWithin<double>(f0, f1, e, f, f0, f1, e + down, f + down, kErr, 1.5),
             0.75);
  // Parallel edges.
  const V g(1, 0, 3), h(9, 0, 3);
  expectTime(edgeEdgeWithin<double>(f0, f1, g, h, f0, f1, g + down, h + down, kErr, 1.5),
             0.75);
  // Already nearer, and at rest.
  const Result near = vertexFaceWithin<double>(v, f0, f1, f2, v, f0, f1, f2, kErr, 1);
  EXPECT_TRUE(near.is_contact);
  EXPECT_EQ(near.toc_lo, 0);
  EXPECT_EQ(near.toc_hi, 0);
  EXPECT_FALSE(
      vertexFaceWithin<double>(v, f0, f1, f2, v, f0, f1, f2, kErr, 0.999).is_contact);
}

/// Edges that turn against each other about the axis between them stay at one distance:
/// the direction between them turns with them, and no fixed one proves it for long.
TEST(FCL_DISTANCE_FEATURES, edgesThatTurnAtOneDistance) {
  const V a0(-1, 0, 0), a1(1, 0, 0), b0(-1, -1, 1), b1(1, 1, 1), c0(1, -1, 1),
      c1(-1, 1, 1);
  EXPECT_FALSE(
      edgeEdgeWithin<double>(a0, a1, b0, b1, a0, a1, c0, c1, kErr, 1 - 1e-8).is_contact);
  const Result at_one = edgeEdgeWithin<double>(a0, a1, b0, b1, a0, a1, c0, c1, kErr, 1);
  EXPECT_TRUE(at_one.is_contact);
  EXPECT_EQ(at_one.toc_lo, 0);
}

Result testAt(const MovingPair& pair, double distance, double toc_err = kErr) {
  V t0[4], t1[4];
  for (std::size_t i = 0; i < 4; ++i) {
    t0[i] = V(pair.x[i].t0);
    t1[i] = V(pair.x[i].t1);
  }
  switch (pair.kind) {
    case Kind::kVertexFace:
      return vertexFaceWithin<double>(t0[0], t0[1], t0[2], t0[3], t1[0], t1[1], t1[2],
                                      t1[3], toc_err, distance);
    case Kind::kEdgeEdge:
      return edgeEdgeWithin<double>(t0[0], t0[1], t0[2], t0[3], t1[0], t1[1], t1[2],
                                    t1[3], toc_err, distance);
    case Kind::kVertexEdge:
      return vertexEdgeWithin<double>(t0[0], t0[1], t0[2], t1[0], t1[1], t1[2], toc_err,
                                      distance);
    default:
      return vertexVertexWithin<double>(t0[0], t0[1], t1[0], t1[1], toc_err, distance);
  }
}

constexpr Kind kKinds[] = {Kind::kVertexFace, Kind::kEdgeEdge, Kind::kVertexEdge,
                           Kind::kVertexVertex};

MovingPair anyPair(Random& random) {
  const auto& families = queryFamilies();
  MovingPair pair = families[random.index(families.size())].generate(random);
  if (random.index(2)) pair.kind = kKinds[2 + random.index(2)];
  return pair;
}

double sizeOf(const MovingPair& pair) {
  double size = 0;
  for (const auto& p : pair.x)
    for (int k = 0; k < 3; ++k)
      size = std::max(size, std::max(std::abs(p.t0[k]), std::abs(p.t1[k])));
  return size;
}

void expectSame(const Result& x, const Result& y, const MovingPair& pair) {
  ASSERT_EQ(x.is_contact, y.is_contact) << pair;
  ASSERT_EQ(x.toc_lo, y.toc_lo) << pair;
  ASSERT_EQ(x.toc_hi, y.toc_hi) << pair;
}

/// Any order of the features and of their vertices gives the same bits.
TEST(FCL_DISTANCE_FEATURES, orderDoesNotMatter) {
  Random random(51);
  for (int i = 0; i < 20000 && !testing::Test::HasFatalFailure(); ++i) {
    const MovingPair pair = anyPair(random);
    const double distance = sizeOf(pair) * std::pow(10, random.uniform(-6, 0));
    if (!(distance > 0) || !std::isfinite(distance)) continue;
    const Result result = testAt(pair, distance);
    MovingPair other = pair;
    const auto swap = [&other](std::size_t p, std::size_t q) {
      std::swap(other.x[p], other.x[q]);
    };
    if (pair.kind == Kind::kVertexFace) {
      swap(1 + random.index(3), 1 + random.index(3));
      swap(1, 2);
    } else if (pair.kind == Kind::kEdgeEdge) {
      if (random.index(2)) swap(0, 1);
      if (random.index(2)) swap(2, 3);
      swap(0, 2);
      swap(1, 3);
    } else {
      pair.kind == Kind::kVertexEdge ? swap(1, 2) : swap(0, 1);
    }
    expectSame(testAt(other, distance), result, pair);
  }
}

/// A power of two for all lengths changes nothing, however large.
TEST(FCL_DISTANCE_FEATURES, scaleDoesNotMatter) {
  Random random(52);
  for (int i = 0; i < 4000 && !testing::Test::HasFatalFailure(); ++i) {
    const MovingPair pair = i % 2 ? nearContactPair(random, 0.1) : gridPair(random, 5);
    const double distance = random.uniform(0.01, 1);
    const Result result = testAt(pair, distance);
    for (const int exponent : {-900, -300, 300, 900}) {
      const double scale = std::ldexp(1, exponent);
      const MovingPair other = mapped(pair, [scale](double c) { return scale * c; });
      expectSame(testAt(other, scale * distance), result, pair);
    }
  }
}

/// A distance of 0 is the exact test, to the bit; vertices and edges are faces without
/// area.
TEST(FCL_DISTANCE_FEATURES, withoutDistanceItIsTheExactTest) {
  Random random(53);
  for (int i = 0; i < 6000 && !testing::Test::HasFatalFailure(); ++i) {
    const MovingPair pair = anyPair(random);
    MovingPair exact = pair;
    if (pair.kind == Kind::kVertexVertex) exact.x[2] = exact.x[1];
    if (pair.kind != Kind::kVertexFace && pair.kind != Kind::kEdgeEdge) {
      exact.x[3] = exact.x[2];
      exact.kind = Kind::kVertexFace;
    }
    expectSame(testAt(pair, 0), featureTest<double>(exact, kErr), pair);
  }
}

/// The parts of a pair are never in contact before the pair, and the pair is not before
/// the part that is told to be nearest.
TEST(FCL_DISTANCE_FEATURES, nearestPartsAreInContactToo) {
  Random random(54);
  int parts = 0;
  for (int i = 0; i < 20000; ++i) {
    const MovingPair pair = i % 2 ? randomPair(random) : nearContactPair(random, 0.2);
    DistanceRequest request;
    request.distance = random.uniform(0.01, 0.5);
    request.toc_err = kErr;
    const DistanceContact whole = advanceToDistance(pair.kind, pair.points(), request);
    if (!whole.is_contact || whole.kind == pair.kind) continue;
    ++parts;
    MovingPair part = pair;
    part.kind = whole.kind;
    for (std::size_t k = 0; k < 4; ++k)
      if (whole.points[k] >= 0)
        part.x[k] = pair.x[static_cast<std::size_t>(whole.points[k])];
    const DistanceContact own = advanceToDistance(part.kind, part.points(), request);
    ASSERT_TRUE(own.is_contact) << pair;
    ASSERT_NEAR(own.toc_lo, whole.toc_lo, 1e-9) << pair;
    ASSERT_GE(own.toc_hi + 1e-9, whole.toc_lo) << pair;
  }
  EXPECT_GT(parts, 2000);
}

/// Pairs that are nearer at the start are contacts when they come nearer than they were.
TEST(FCL_DISTANCE_FEATURES, initiallyCloser) {
  const auto fall = [](double from, double to) {
    MovingPair pair = onTriangle(falling(1, 1, from, to));
    DistanceRequest request;
    request.distance = 1;
    request.ignores_initially_closer = true;
    return advanceToDistance(pair.kind, pair.points(), request);
  };
  EXPECT_FALSE(fall(0.5, 0.5).is_contact);
  EXPECT_FALSE(fall(0.5, 2).is_contact);
  // What touches may pass through without coming nearer.
  for (const double to : {0., 2., -2.}) {
    const DistanceContact touching = fall(0, to);
    EXPECT_TRUE(touching.is_contact);
    EXPECT_EQ(touching.toc_hi, 0);
  }
  const DistanceContact nearer = fall(0.5, 0.25);
  EXPECT_TRUE(nearer.is_contact);
  EXPECT_LE(nearer.toc_lo, 1e-8);
  // From above the distance it acts as ever.
  EXPECT_NEAR(fall(2, 0).toc_lo, 0.5, 1e-12);
}

TEST(FCL_DISTANCE_FEATURES, middleAndDirection) {
  const MovingPair pair = onTriangle(falling(1, 1, 1, -1));
  double position[3], normal[3];
  detail::deformable::distanceGeometry(pair.kind, pair.points(), 0.25, position, normal);
  EXPECT_EQ(V(position), V(1, 1, 0.25));
  EXPECT_EQ(V(normal), V(0, 0, -1));
  // Edges given in either order: from the first to the second.
  MovingPair edges{Kind::kEdgeEdge,
                   {at(-1, 0, 0), at(1, 0, 0), at(0, -1, 2), at(0, 1, 2)}};
  for (int turn = 0; turn < 2; ++turn) {
    detail::deformable::distanceGeometry(edges.kind, edges.points(), 0.5, position,
                                         normal);
    EXPECT_LE((V(position) - V(0, 0, 1)).norm(), 1e-15);
    EXPECT_EQ(V(normal), V(0, 0, turn ? -1 : 1));
    std::swap(edges.x[0], edges.x[2]);
    std::swap(edges.x[1], edges.x[3]);
  }
}

TEST(FCL_DISTANCE_FEATURES, middleAndDirectionOfAllSizes) {
  for (int exponent = -1000; exponent <= 1000; exponent += 20) {
    const double size = std::ldexp(1, exponent);
    MovingPair pair = onTriangle(falling(1, 1, 1, -1));
    for (auto& vertex : pair.x)
      for (int k = 0; k < 3; ++k) {
        vertex.t0[k] *= size;
        vertex.t1[k] *= size;
      }
    double position[3], normal[3];
    detail::deformable::distanceGeometry(pair.kind, pair.points(), 0.25, position,
                                         normal);
    EXPECT_EQ(V(position), V(size, size, 0.25 * size)) << exponent;
    EXPECT_EQ(V(normal), V(0, 0, -1)) << exponent;
  }
}

TEST(FCL_DISTANCE_FEATURES, unusableDistanceIsRefused) {
  const V p(1, 2, 3), q(4, 5, 6);
  for (const double d : {-1., std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()}) {
    expectRefused([&] { vertexVertexWithin<double>(p, q, p, q, kErr, d); },
                  "min_distance is negative or not finite");
    expectRefused([&] { vertexFaceWithin<double>(p, p, p, p, q, q, q, q, kErr, d); },
                  "min_distance is negative or not finite");
  }
  const V bad(1, std::numeric_limits<double>::quiet_NaN(), 0);
  expectRefused([&] { vertexVertexWithin<double>(p, bad, p, q, kErr, 1); },
                "w_t0 is not finite");
  expectRefused([&] { vertexEdgeWithin<double>(p, p, p, p, q, bad, kErr, 1); },
                "e1_t1 is not finite");
}

TEST(FCL_DISTANCE_FEATURES, floatsAreRoundedOutward) {
  using F = Vector3<float>;
  const auto result = vertexVertexWithin<float>(F(0, 0, 3), F(0, 0, 0), F(0, 0, 0),
                                                F(0, 0, 0), kErr, 0.1);
  EXPECT_TRUE(result.is_contact);
  EXPECT_LE(double{result.toc_lo}, 2.9 / 3);
  EXPECT_GE(double{result.toc_hi}, 2.9 / 3);
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The moving tree: its boxes contain what they should at every time, and no pair that
// meets is lost on the way down.
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "fcl/narrowphase/detail/deformable/deformable_query.h"
#include "fcl/narrowphase/detail/deformable/traversal.h"
#include "moving_mesh.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingMesh;
using test::PreparedMovingMesh;
using test::Random;

constexpr double kTimes[] = {0, 1e-9, 0.125, 1. / 3, 0.5, 0.7, 0.9375, 1};

/// The 8 coordinates of a vertex at t, relative to origin, with 11 bits more than double.
void coordinatesAt(const VertexPath& p, double t, const double (&origin)[3],
                   long double (&d)[8]) {
  long double x[3];
  for (int k = 0; k < 3; ++k)
    x[k] = (1 - static_cast<long double>(t)) *
               (static_cast<long double>(p.t0[k]) - origin[k]) +
           static_cast<long double>(t) * (static_cast<long double>(p.t1[k]) - origin[k]);
  const long double all[8] = {x[0],        x[1],        x[2],        x[0] + x[1],
                              x[0] + x[2], x[1] + x[2], x[0] - x[1], x[0] - x[2]};
  std::copy(all, all + 8, d);
}

/// Bound of half-axis j at t; a NaN is no bound.
long double halfAt(const MovingKdop& box, int j, double t) {
  const long double half = (1 - static_cast<long double>(t)) * box.t0.half[j] +
                           static_cast<long double>(t) * box.t1.half[j];
  return std::isnan(half) ? std::numeric_limits<long double>::infinity() : half;
}

/// Every box of the tree contains the triangles below it.
void expectContainment(const MovingKdopTree& tree,
                       const std::vector<MeshTriangle>& triangles,
                       const VertexFrames& frames) {
  const std::size_t count = tree.links().size();
  ASSERT_EQ(count, 2 * triangles.size() - 1);
  std::vector<int> parent(count, -1);
  std::vector<int> seen(triangles.size(), 0);
  for (int node = 0; node < static_cast<int>(count); ++node) {
    if (tree.isLeaf(node)) continue;
    ASSERT_GT(tree.leftChild(node), node);
    for (int child : {tree.leftChild(node), tree.leftChild(node) + 1})
      parent[static_cast<std::size_t>(child)] = node;
  }
  for (int leaf = 0; leaf < static_cast<int>(count); ++leaf) {
    if (!tree.isLeaf(leaf)) continue;
    const auto triangle = static_cast<std::size_t>(tree.triangle(leaf));
    ++seen[triangle];
    for (const std::uint32_t v : triangles[triangle].v)
      for (const double t : kTimes) {
        long double d[8];
        coordinatesAt(frames[v], t, tree.origin(), d);
        for (int node = leaf; node >= 0; node = parent[static_cast<std::size_t>(node)])
          for (int j = 0; j < 8; ++j) {
            ASSERT_LE(-d[j], halfAt(tree.box(node), j, t)) << "node " << node;
            ASSERT_LE(d[j], halfAt(tree.box(node), j + 8, t)) << "node " << node;
          }
      }
  }
  for (const int times : seen) ASSERT_EQ(times, 1);
}

template <typename S>
std::vector<S> coordinates(const std::vector<Vector3<double>>& points, double scale,
                           double offset) {
  std::vector<S> out;
  for (const auto& p : points)
    for (int k = 0; k < 3; ++k)
      out.push_back(static_cast<S>(scale * p[k] + offset * (k - 1.3)));
  return out;
}

template <typename S>
void testContainment(std::uint64_t seed) {
  Random random(seed);
  for (const double offset : {0., 1e6, 1e12, 1e30})
    for (const double scale : {1e-6, 1., 1e6}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", offset " + std::to_string(offset) +
                   ", scale " + std::to_string(scale));
      const MovingMesh mesh = test::randomSoup(random, 50, 60, 1, 0.3);
      const auto t0 = coordinates<S>(mesh.t0, scale, offset);
      const auto t1 = coordinates<S>(mesh.t1, scale, offset);
      const VertexFrames frames(t0.data(), t1.data(), mesh.t0.size());
      const auto triangles =
          assignFeatures(mesh.triangles.data(), mesh.triangles.size(), mesh.t0.size());
      MovingKdopTree tree;
      tree.build(triangles, frames);
      tree.refit(triangles, frames);
      expectContainment(tree, triangles, frames);

      Pose turn, move;
      const double rotation[9] = {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1};
      std::copy(rotation, rotation + 9, turn.rotation);
      move.translation[0] = 3 * scale;
      VertexFrames posed = frames;
      posed.setPoses(turn, move);
      MovingKdopTree same_links;
      same_links.setLinks(tree.links());
      same_links.refit(triangles, posed);
      expectContainment(same_links, triangles, posed);
    }
}

TEST(FCL_MOVING_KDOP_TREE, boxesContainDoubleFrames) { testContainment<double>(41); }
TEST(FCL_MOVING_KDOP_TREE, boxesContainFloatFrames) { testContainment<float>(42); }

/// A box whose bounds are multiples of a power of two, so that the exact overlap below
/// is exact.
MovingKdop gridBox(Random& random, int exponent) {
  MovingKdop box;
  for (Kdop16* frame : {&box.t0, &box.t1})
    for (float& half : frame->half)
      half = std::ldexp(static_cast<float>(random.index(2000)) - 700, exponent);
  return box;
}

/// Whether the boxes overlap at t = k / 64.
bool doOverlapAt(const MovingKdop& a, const MovingKdop& b, int k) {
  for (int j = 0; j < 16; ++j)
    if (halfAt(a, j, k / 64.) + halfAt(b, (j + 8) % 16, k / 64.) < 0) return false;
  return true;
}

void expectNoMiss(const MovingKdop& a, const MovingKdop& b) {
  const TimeWindow w = overlapWindow<false>(a, b, nullptr);
  for (int k = 0; k <= 64; ++k)
    if (doOverlapAt(a, b, k)) {
      ASSERT_FALSE(w.isEmpty()) << "overlap at " << k << "/64";
      ASSERT_LE(w.lo, k / 64.);
      ASSERT_GE(w.hi, k / 64.);
    }
}

TEST(FCL_MOVING_KDOP, windowNeverMisses) {
  constexpr std::uint64_t kSeed = 43;
  Random random(kSeed);
  int windows = 0;
  for (int i = 0; i < 20000; ++i) {
    const int exponent = static_cast<int>(random.index(200)) - 100;
    MovingKdop a = gridBox(random, exponent), b = gridBox(random, exponent);
    // Most directions overlap all the time, else nearly no box would.
    for (int j = 0; j < 16; ++j)
      if (random.index(4)) {
        a.t0.half[j] = std::abs(a.t0.half[j]) + std::abs(b.t0.half[(j + 8) % 16]);
        a.t1.half[j] = std::abs(a.t1.half[j]) + std::abs(b.t1.half[(j + 8) % 16]);
      }
    ASSERT_NO_FATAL_FAILURE(expectNoMiss(a, b)) << "seed " << kSeed << ", " << i;
    // The window is no wider than rounding makes it.
    const TimeWindow w = overlapWindow<false>(a, b, nullptr);
    if (w.isEmpty()) continue;
    ++windows;
    double lo = 0, hi = 1;
    for (int j = 0; j < 16; ++j) {
      const double s0 = double{a.t0.half[j]} + double{b.t0.half[(j + 8) % 16]},
                   s1 = double{a.t1.half[j]} + double{b.t1.half[(j + 8) % 16]};
      if (s0 < 0) lo = std::max(lo, s0 / (s0 - s1));
      if (s1 < 0) hi = std::min(hi, s0 / (s0 - s1));
    }
    ASSERT_NEAR(w.lo, lo, 1e-6) << "seed " << kSeed << ", " << i;
    ASSERT_NEAR(w.hi, hi, 1e-6) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(windows, 2000);
}

MovingKdop cube(float x0, float x1, float half) {
  MovingKdop box;
  std::fill(box.t0.half, box.t0.half + 16, half);
  box.t1 = box.t0;
  box.t0.half[0] = half - x0;
  box.t0.half[8] = half + x0;
  box.t1.half[0] = half - x1;
  box.t1.half[8] = half + x1;
  return box;
}

// Unbounded at one end of the step, far apart at the other: they may meet in between.
TEST(FCL_MOVING_KDOP, unboundedNeverSeparates) {
  const MovingKdop rest = cube(0, 0, 1);
  for (int j = 0; j < 16; ++j)
    for (const bool at_t0 : {true, false}) {
      SCOPED_TRACE("half-axis " + std::to_string(j) + (at_t0 ? " at 0" : " at 1"));
      MovingKdop box = cube(0, 0, 1);
      (at_t0 ? box.t0 : box.t1).half[j] = std::numeric_limits<float>::quiet_NaN();
      (at_t0 ? box.t1 : box.t0).half[j] = -99;
      expectNoMiss(box, rest);
      expectNoMiss(rest, box);
    }
}

using Visits = std::map<std::pair<int, int>, int>;

/// Whether the exact ranges of two triangles along the 8 directions meet at t.
bool doTrianglesOverlapAt(const MeshInstance& a, std::size_t i, const MeshInstance& b,
                          std::size_t j, double t) {
  long double lo[2][8], hi[2][8];
  const double origin[3] = {a.frames[a.triangle(i).v[0]].t0[0],
                            a.frames[a.triangle(i).v[0]].t0[1],
                            a.frames[a.triangle(i).v[0]].t0[2]};
  for (int side = 0; side < 2; ++side) {
    const MeshInstance& mesh = side ? b : a;
    const MeshTriangle triangle = mesh.triangle(side ? j : i);
    for (int c = 0; c < 3; ++c) {
      long double d[8];
      coordinatesAt(mesh.frames[triangle.v[c]], t, origin, d);
      for (int k = 0; k < 8; ++k) {
        lo[side][k] = c ? std::min(lo[side][k], d[k]) : d[k];
        hi[side][k] = c ? std::max(hi[side][k], d[k]) : d[k];
      }
    }
  }
  for (int k = 0; k < 8; ++k)
    if (lo[0][k] > hi[1][k] || lo[1][k] > hi[0][k]) return false;
  return true;
}

Visits visitsOf(const MeshInstance& a, const MeshInstance& b, double latest) {
  Visits visits;
  std::vector<NodePair> open;
  const bool self = &a == &b;
  const auto visit = [&](int i, int j, TimeWindow window) {
    EXPECT_FALSE(window.isEmpty());
    EXPECT_LE(window.lo, latest);
    ++visits[self && j < i ? std::make_pair(j, i) : std::make_pair(i, j)];
    return true;
  };
  if (self) {
    traverse<true>(
        *a.tree, *a.tree, nullptr, open, [=] { return latest; }, visit);
  } else {
    const KdopShift shift = relativeShift(a, b);
    traverse<false>(
        *a.tree, *b.tree, &shift, open, [=] { return latest; }, visit);
  }
  return visits;
}

/// Every pair that overlaps at a time up to latest is visited, none twice.
/// @return number of pairs that had to be visited
int expectVisits(const MeshInstance& a, const MeshInstance& b, double latest = 1) {
  const Visits visits = visitsOf(a, b, latest);
  for (const auto& [pair, times] : visits) {
    EXPECT_EQ(times, 1);
    EXPECT_TRUE(&a != &b || pair.first != pair.second);
  }
  int needed = 0;
  for (std::size_t i = 0; i < a.num_triangles; ++i)
    for (std::size_t j = &a == &b ? i + 1 : 0; j < b.num_triangles; ++j)
      for (const double t : kTimes)
        if (t <= latest && doTrianglesOverlapAt(a, i, b, j, t)) {
          ++needed;
          EXPECT_TRUE(visits.count({static_cast<int>(i), static_cast<int>(j)}))
              << i << " and " << j << " overlap at " << t;
          break;
        }
  return needed;
}

TEST(FCL_MOVING_KDOP_TREE, traversalVisitsEveryOverlap) {
  constexpr std::uint64_t kSeed = 44;
  Random random(kSeed);
  int needed = 0;
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const MovingMesh a = i % 2 ? test::crumpledSheet(random, 5, 0.3)
                               : test::randomSoup(random, 40, 120, 3, 0.5);
    const MovingMesh b = test::crumpledSheet(random, 4, 0.5);
    const PreparedMovingMesh pa(a), pb(b);
    for (const double latest : {1., 0.5, 0.}) {
      needed += expectVisits(pa.instance(), pa.instance(), latest);
      needed += expectVisits(pa.instance(), pb.instance(), latest);
    }
    const std::size_t all = visitsOf(pa.instance(), pa.instance(), 1).size();
    EXPECT_LT(all, a.triangles.size() * (a.triangles.size() - 1) / 2);
    EXPECT_LE(visitsOf(pa.instance(), pa.instance(), 0).size(), all);
  }
  EXPECT_GT(needed, 10000);
}

TEST(FCL_MOVING_KDOP_TREE, oneTriangleAndNothingToVisit) {
  MovingMesh mesh;
  mesh.t0 = mesh.t1 = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const PreparedMovingMesh one(mesh), other(mesh);
  EXPECT_TRUE(visitsOf(one.instance(), one.instance(), 1).empty());
  EXPECT_EQ(visitsOf(one.instance(), other.instance(), 1).size(), 1U);
}

TEST(FCL_MOVING_KDOP_TREE, treesFarFromEachOthersOrigin) {
  constexpr std::uint64_t kSeed = 45;
  Random random(kSeed);
  for (const double far : {0., 1e3, 1e6, 1e9, 1e15})
    for (const double size : {1e-3, 1., 1e5}) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(far) + ", " +
                   std::to_string(size));
      MovingMesh a = test::crumpledSheet(random, 4, 0.4);
      MovingMesh b = test::crumpledSheet(random, 5, 0.4);
      Pose pose_a[2], pose_b[2];
      for (int k = 0; k < 3; ++k) {
        // a is there by its pose, b by half its pose and half its coordinates.
        for (int frame = 0; frame < 2; ++frame) {
          pose_a[frame].translation[k] = far * (k + 1);
          pose_b[frame].translation[k] = 0.5 * far * (k + 1) + (frame ? 0.1 * size : 0);
        }
        for (auto* points : {&a.t0, &a.t1})
          for (auto& p : *points) p[k] *= size;
        for (auto* points : {&b.t0, &b.t1})
          for (auto& p : *points) p[k] = size * p[k] + 0.5 * far * (k + 1);
      }
      const PreparedMovingMesh pa(a, pose_a[0], pose_a[1]), pb(b, pose_b[0], pose_b[1]);
      EXPECT_GT(expectVisits(pa.instance(), pb.instance()), 100);
      EXPECT_GT(expectVisits(pb.instance(), pa.instance()), 100);
      // Not by giving up: most pairs are still culled where floats can tell them apart.
      if (far <= 1e6 * size) {
        EXPECT_LT(visitsOf(pa.instance(), pb.instance(), 1).size(),
                  a.triangles.size() * b.triangles.size() * 3 / 4);
      }
    }
}

int depthOf(const MovingKdopTree& tree, int node = 0) {
  if (tree.isLeaf(node)) return 0;
  const int left = tree.leftChild(node);
  return 1 + std::max(depthOf(tree, left), depthOf(tree, left + 1));
}

TEST(FCL_MOVING_KDOP_TREE, depthIsBounded) {
  Random random(46);
  constexpr std::size_t kCount = 3000;
  for (int shape = 0; shape < 4; ++shape) {
    SCOPED_TRACE(shape);
    MovingMesh mesh;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double x = shape == 0   ? 0  // all centroids the same
                       : shape == 1 ? std::ldexp(1, static_cast<int>(i % 250) - 125)
                       : shape == 2 ? std::pow(1.05, static_cast<double>(i)) * 1e-30
                                    : 1e300 * random.uniform(-1, 1);
      for (int k = 0; k < 3; ++k) {
        mesh.t0.emplace_back(x, shape == 3 ? x : 0, 0);
        mesh.t1.emplace_back(x, 0, 1);
      }
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    const PreparedMovingMesh prepared(mesh);
    ASSERT_EQ(prepared.tree().links().size(), 2 * kCount - 1);
    EXPECT_LE(depthOf(prepared.tree()), kMaxSahDepth + 32);
    EXPECT_GE(depthOf(prepared.tree()), 11);
  }
}

// Beyond float's range a box is unbounded, and everything has to be visited.
TEST(FCL_MOVING_KDOP_TREE, coordinatesBeyondFloat) {
  constexpr std::uint64_t kSeed = 47;
  Random random(kSeed);
  for (const double size : {1e36, 1e37, 1e38, 2e38, 1e39, 1e45, 1e53, 1e60, 1e300}) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(size));
    const MovingMesh a = test::randomSoup(random, 25, 60, size, size);
    const MovingMesh b = test::randomSoup(random, 15, 40, size, 0.1 * size);
    const PreparedMovingMesh pa(a), pb(b);
    const std::size_t n = a.triangles.size(), m = b.triangles.size();
    EXPECT_GT(expectVisits(pa.instance(), pa.instance()), 10);
    EXPECT_GT(expectVisits(pa.instance(), pb.instance()), 10);
    if (size > 1e60) {
      EXPECT_EQ(visitsOf(pa.instance(), pa.instance(), 1).size(), n * (n - 1) / 2);
      EXPECT_EQ(visitsOf(pa.instance(), pb.instance(), 1).size(), n * m);
    }
  }
}

// Two triangles that touch at t = 0, where no float bounds them, and are apart at t = 1,
// where floats do.
TEST(FCL_MOVING_KDOP_TREE, unboundedInOneFrame) {
  MovingMesh mesh;
  for (const double side : {-1., 1.}) {
    for (int k = 0; k < 3; ++k) {
      mesh.t0.emplace_back(-1e45, k == 1 ? 1e36 : 0, k == 2 ? 1e36 : 0);
      mesh.t1.emplace_back(side * 1e36, k == 1 ? 1e36 : 0, k == 2 ? 1e36 : 0);
    }
  }
  mesh.t0.emplace_back(1e45, 0, 0);  // keeps the origin at 0
  mesh.t1.emplace_back(1e45, 0, 0);
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const PreparedMovingMesh prepared(mesh);
  EXPECT_EQ(expectVisits(prepared.instance(), prepared.instance()), 1);
}

/// Runs a self-query in the mode set by the caller, whose control word must survive.
QueryAnswer answerOf(const MeshInstance& mesh) {
  QueryOptions options;
  options.toc_err = 1e-7;
#ifdef __SSE__
  const unsigned before = _mm_getcsr();
#endif
  const int rounding = std::fegetround();
  QueryAnswer answer = querySelf(mesh, options);
#ifdef __SSE__
  EXPECT_EQ(_mm_getcsr(), before);
#endif
  EXPECT_EQ(std::fegetround(), rounding);
  return answer;
}

void expectSameAnswer(const QueryAnswer& x, const QueryAnswer& y) {
  EXPECT_EQ(x.has_crossing, y.has_crossing);
  EXPECT_EQ(x.counts.feature_pairs, y.counts.feature_pairs);
  EXPECT_EQ(x.counts.exact_tests, y.counts.exact_tests);
  ASSERT_EQ(x.contacts.size(), y.contacts.size());
  for (std::size_t i = 0; i < x.contacts.size(); ++i) {
    EXPECT_EQ(x.contacts[i].toc_lo, y.contacts[i].toc_lo);
    EXPECT_EQ(x.contacts[i].toc_hi, y.contacts[i].toc_hi);
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(x.contacts[i].vertices[k], y.contacts[i].vertices[k]);
  }
}

TEST(FCL_MOVING_KDOP_TREE, callersFloatingPointModeDoesNotMatter) {
  constexpr std::uint64_t kSeed = 48;
  Random random(kSeed);
  for (const double scale : {1., 1e-160, 1e-307}) {
    MovingMesh mesh = test::crumpledSheet(random, 6, 0.5);
    for (auto* points : {&mesh.t0, &mesh.t1})
      for (auto& p : *points) p *= scale;
    const PreparedMovingMesh prepared(mesh);
    const QueryAnswer normal = answerOf(prepared.instance());
    EXPECT_GT(normal.contacts.size(), 20U) << "seed " << kSeed;
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      std::fesetround(mode);
      const QueryAnswer answer = answerOf(prepared.instance());
      std::fesetround(FE_TONEAREST);
      expectSameAnswer(answer, normal);
    }
#ifdef __SSE__
    const unsigned csr = _mm_getcsr();
    _mm_setcsr(csr | 0x8040);  // flush to zero, denormals are zero
    const QueryAnswer answer = answerOf(prepared.instance());
    _mm_setcsr(csr);
    expectSameAnswer(answer, normal);
#endif
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

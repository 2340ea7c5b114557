// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of triangles at t = 0: which edges may cross faces, which pairs are apart.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "elementary/predicates.h"
#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh_generators.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::allSets;
using test::Random;

/// The ends of an edge and the corners of a face. Their coordinates have few different
/// values, so that many points are in a plane or equal, or they have any values. Returns
/// whether they are not special.
bool setCrossing(Random& random, double scale, TreeVertex (&x)[5]) {
  const bool few = random.index(2) == 0;
  for (TreeVertex& vertex : x)
    for (double& c : vertex.t0)
      c = scale * (few ? static_cast<double>(random.index(4)) : random.uniform(-1, 1));
  if (random.index(4) > 0) return !few;
  // The edge ends near the plane of the face, or passes near an edge of it.
  const double s = random.uniform(0, 1), tilt = random.uniform(-1, 1) * 0x1p-50 * scale;
  for (int k = 0; k < 3; ++k)
    x[1].t0[k] = s * x[2].t0[k] + (1 - s) * x[3].t0[k] + (k == 2 ? tilt : 0);
  return false;
}

/// An edge, any of a's or b's, and the face of the other triangle.
class CrossingPair {
 public:
  TreeVertex x[5];

  /// @param bit  the bit of the edge, as in Kernels::cullCrossings()
  TrianglePair pair(std::uint32_t bit) const {
    TrianglePair pair{};
    const std::uint32_t edge = bit / 3 * 3, face = 3 - edge, k = bit % 3;
    pair.x[edge + k] = &x[0];
    pair.x[edge + (k + 1) % 3] = &x[1];
    pair.x[edge + (k + 2) % 3] = &far_;
    for (std::uint32_t i = 0; i < 3; ++i) pair.x[face + i] = &x[2 + i];
    return pair;
  }

 private:
  /// The third corner, which is not used.
  TreeVertex far_{};
};

// Pairs that are left out do not cross, on every instruction set. Nearly all pairs that
// do not cross are left out, unless they are special.
TEST(FCL_KERNELS, whatMayCross) {
  constexpr std::uint64_t kSeed = 74;
  Random random(kSeed);
  int crossing = 0, apart = 0, left = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const double scale =
        std::ldexp(1, i % 3 > 0 ? 0 : 60 * static_cast<int>(random.index(34)) - 1020);
    CrossingPair crossings[8];
    TrianglePair pairs[8];
    std::uint32_t codes[8];
    bool is_plain[8];
    const std::size_t count = 1 + random.index(8);
    for (std::uint32_t n = 0; n < count; ++n) {
      const auto bit = static_cast<std::uint32_t>(random.index(6));
      is_plain[n] = setCrossing(random, scale, crossings[n].x) && i % 3 > 0;
      pairs[n] = crossings[n].pair(bit);
      codes[n] = featureCode(n, static_cast<int>(bit));
    }
    const unsigned found = allSets().front()->mayCross(pairs, codes, count);
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->mayCross(pairs, codes, count), found) << k->name;
    EXPECT_EQ(found >> count, 0U);
    for (unsigned lane = 0; lane < count; ++lane) {
      const auto at = [&](std::size_t k) -> const double(&)[3] {
        return reinterpret_cast<const double(&)[3]>(crossings[lane].x[k].t0);
      };
      const bool crosses = isCrossing(at(0), at(1), at(2), at(3), at(4));
      const bool kept = found >> lane & 1U;
      EXPECT_TRUE(kept || !crosses);
      crossing += crosses;
      apart += !crosses && is_plain[lane];
      left += !crosses && is_plain[lane] && kept;
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(crossing, 5000);
  EXPECT_GT(apart, 20000);
  EXPECT_LT(1000 * left, apart);
}

/// Two triangles whose coordinates are whole numbers. So sums of them are exact, but
/// products are not always. The second one touches the first one: a vertex, or the middle
/// of an edge, is at the same point in both.
struct TouchingTriangles {
  TreeVertex a[3], b[3];

  explicit TouchingTriangles(Random& random) {
    constexpr std::size_t kSizes[] = {4, 2000, std::size_t{1} << 48};
    const std::size_t size = kSizes[random.index(3)];
    const auto whole = [&random, size] {
      return 2 * static_cast<double>(random.index(size));
    };
    double shift[3];
    for (TreeVertex* x : {a, b})
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) x[i].t0[k] = whole();
    // Two layers that lie on each other, as in cloth.
    const bool parallel = random.index(2) == 0;
    if (parallel)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
          b[i].t0[k] = a[i].t0[k] + 2 * static_cast<double>(random.index(2));
    const std::size_t mine = random.index(6), theirs = random.index(6);
    for (int k = 0; k < 3; ++k) shift[k] = place(a, mine, k) - place(b, theirs, k);
    move(shift);
  }

  TouchingTriangles(const TouchingTriangles&) = default;

  /// Coordinate k of vertex i, or of the middle of edge i - 3.
  static double place(const TreeVertex (&x)[3], std::size_t i, int k) {
    return i < 3 ? x[i].t0[k] : 0.5 * (x[i - 3].t0[k] + x[(i - 2) % 3].t0[k]);
  }

  /// Moves the second triangle.
  void move(const double (&by)[3]) {
    for (TreeVertex& x : b)
      for (int k = 0; k < 3; ++k) x.t0[k] += by[k];
  }

  void scale(double by, double offset) {
    for (TreeVertex* x : {a, b})
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) x[i].t0[k] = by * (x[i].t0[k] + offset);
  }

  /// Allows the two to approach each other by this amount in the step, along an axis: a
  /// vertex of one moves by a part of it, a vertex of the other by the rest.
  void setApproach(Random& random, double approach) {
    for (TreeVertex* x : {a, b})
      for (int i = 0; i < 3; ++i) x[i].t0[3] = 0;
    const double part = 0.25 * static_cast<double>(random.index(5));
    a[random.index(3)].t0[3] = part * approach;
    b[random.index(3)].t0[3] = (1 - part) * approach;
  }

  TrianglePair pair() const {
    return {{&a[0], &a[1], &a[2], &b[0], &b[1], &b[2]}, nullptr, nullptr};
  }
};

// Triangles that touch when one is moved by as much as they can approach each other are
// never apart.
TEST(FCL_KERNELS, trianglesThatComeTogetherAreNotApart) {
  constexpr std::uint64_t kSeed = 75;
  Random random(kSeed);
  int apart = 0, total = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    double approach[8];
    for (double& x : approach)
      x = random.index(4) ? static_cast<double>(random.index(40)) : 0;
    // The part of the step.
    const double share = std::ldexp(1, -static_cast<int>(random.index(20)));
    const double scale =
        std::ldexp(1, i % 3 > 0 ? 0 : 60 * static_cast<int>(random.index(32)) - 960);
    const double offset = random.index(2) ? std::ldexp(1, 30) : 0;
    std::vector<TouchingTriangles> triangles;
    std::vector<TrianglePair> touching, separated;
    const std::size_t count = 1 + random.index(8);
    for (std::size_t n = 0; n < 2 * count; ++n) {
      triangles.emplace_back(random);
      // The first ones are moved so far that they can still come together, the others
      // farther.
      const double size = n < count ? approach[n] : 40 * (approach[n - count] + 1);
      double away[3];
      for (double& w : away) w = size * (static_cast<double>(random.index(3)) - 1);
      triangles.back().move(away);
      triangles.back().scale(scale, offset);
      triangles.back().setApproach(random, scale * approach[n % count] / share);
    }
    for (std::size_t n = 0; n < 2 * count; ++n)
      (n < count ? touching : separated).push_back(triangles[n].pair());
    float gaps[8];
    for (const Kernels* k : allSets()) {
      EXPECT_EQ(k->areApart(touching.data(), count, share, 0, gaps), 0U) << k->name;
      for (std::size_t n = 0; n < count; ++n)
        EXPECT_EQ(gaps[n], roundUp(2 * scale * approach[n], 0.f)) << k->name;
    }
    const unsigned found =
        allSets().front()->areApart(separated.data(), count, share, 0, gaps);
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->areApart(separated.data(), count, share, 0, gaps), found) << k->name;
    apart += __builtin_popcount(found);
    total += static_cast<int>(count);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(3 * apart, total);
}

// Layers are apart if three times the approach is less than their distance, wherever they
// are and whichever is on top. The plane of either one may prove it.
TEST(FCL_KERNELS, layersAreApart) {
  for (const double offset : {0., 0x1p30})
    for (const double height : {1., -1.})
      // The layer that stands upright, so that its plane cuts the other one.
      for (const int upright : {-1, 0, 1}) {
        TreeVertex x[2][3] = {};
        for (int t = 0; t < 2; ++t) {
          const double corners[3][3] = {{0, -4, 0}, {8, -4, 0}, {4, 4, 0}};
          for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) x[t][i].t0[k] = offset + corners[i][k];
          if (t == upright) {
            for (TreeVertex& v : x[t]) v.t0[1] = offset;
            x[t][2].t0[2] += (t == 0 ? -8 : 8) * height;
          }
          for (TreeVertex& v : x[t]) v.t0[2] += t * height;
        }
        const TrianglePair pair{
            {&x[0][0], &x[0][1], &x[0][2], &x[1][0], &x[1][1], &x[1][2]},
            nullptr,
            nullptr};
        x[0][1].t0[3] = x[1][2].t0[3] = 0.5;
        for (const Kernels* k : allSets()) {
          float gaps[8];
          EXPECT_EQ(k->areApart(&pair, 1, 0.33, 0, gaps), 1U)
              << k->name << " " << upright;
          EXPECT_EQ(k->areApart(&pair, 1, 0, 0, gaps), 1U) << k->name << " " << upright;
          EXPECT_EQ(k->areApart(&pair, 1, 0.34, 0, gaps), 0U)
              << k->name << " " << upright;
        }
      }
}

TEST(FCL_KERNELS, whatIsNotFiniteMayCross) {
  CrossingPair crossing{};
  TreeVertex(&vertices)[5] = crossing.x;
  // An edge far above a face.
  vertices[0].t0[2] = vertices[1].t0[2] = vertices[1].t0[0] = 1;
  vertices[3].t0[0] = vertices[4].t0[1] = 1;
  const TrianglePair pair = crossing.pair(0);
  const std::uint32_t code = featureCode(0, 0);
  for (const Kernels* k : allSets()) EXPECT_EQ(k->mayCross(&pair, &code, 1), 0u);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (TreeVertex& vertex : vertices) {
      const double before = vertex.t0[0];
      vertex.t0[0] = bad;
      for (const Kernels* k : allSets())
        EXPECT_EQ(k->mayCross(&pair, &code, 1), 1u) << k->name;
      vertex.t0[0] = before;
    }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

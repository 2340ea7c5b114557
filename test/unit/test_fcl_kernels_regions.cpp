// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of regions and bodies: the directions that triangles face during the whole
// step, the sides that a point sees of them, and how high they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh_generators.h"
#include "real.h"
#include "sanitizer.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::abs;
using test::allSets;
using test::Random;
using test::Real;
using test::RealVector;

const Real kInfinity = std::numeric_limits<Real>::infinity();

/// facedDirections() computed with plain numbers.
std::uint32_t facedDirectionsOf(const std::vector<TreeVertex>& vertices,
                                const std::vector<TreeTriangle>& triangles) {
  using Vector = std::array<double, 3>;
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                  a[0] * b[1] - a[1] * b[0]};
  };
  std::uint32_t faced = (1U << (2 * kNumAxes)) - 1;
  for (const TreeTriangle& t : triangles) {
    Vector v[2], w[2];
    double v_norm = 0, w_norm = 0;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t frame = 0; frame < 2; ++frame) {
        const auto at = [&](std::size_t i) {
          const TreeVertex& x = vertices[t.place[i]];
          return frame == 0 ? x.t0[k] : x.t1[k];
        };
        v[frame][k] = at(1) - at(0);
        w[frame][k] = at(2) - at(0);
        v_norm = std::max(v_norm, std::abs(v[frame][k]));
        w_norm = std::max(w_norm, std::abs(w[frame][k]));
      }
    const Vector first = cross(v[0], w[0]), last = cross(v[1], w[1]),
                 b = cross(v[0], w[1]), c = cross(v[1], w[0]),
                 middle = {b[0] + c[0], b[1] + c[1], b[2] + c[2]};
    const double size = v_norm * w_norm, bound = 192 * 0x1p-53 * size;
    if (!(size >= 0x1p-900 && size <= 0x1p900)) return 0;
    for (std::size_t axis = 0; axis < kNumAxes; ++axis) {
      bool up = true, down = true;
      for (const Vector* n : {&first, &middle, &last}) {
        const double along = kAxes[axis][0] * (*n)[0] + kAxes[axis][1] * (*n)[1] +
                             kAxes[axis][2] * (*n)[2];
        up = up && along >= bound;
        down = down && along <= -bound;
      }
      if (!up) faced &= ~(1U << axis);
      if (!down) faced &= ~(1U << (axis + kNumAxes));
    }
  }
  return faced;
}

TEST(FCL_KERNELS, directionsThatTrianglesFace) {
  constexpr std::uint64_t kSeed = 85;
  Random random(kSeed);
  int met[2 * kNumAxes] = {}, none = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = 1 + random.index(8);
    const Vector3<double> normal = random.point(1).normalized();
    const double noise = random.uniform(0, 0.6);
    const int exponent =
        random.index(8) ? 0 : static_cast<int>(random.index(2000)) - 1000;
    std::vector<TreeVertex> vertices(3 * count);
    std::vector<TreeTriangle> triangles(count);
    const auto side = normal.cross(random.point(1)).normalized();
    const Vector3<double> corners[3] = {{0, 0, 0}, side, normal.cross(side)};
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      Vector3<double> p = corners[k % 3] + random.point(noise),
                      q = corners[k % 3] + random.point(noise);
      for (int c = 0; c < 3; ++c) {
        // The planes of triangles on a grid contain some of the directions.
        if (i % 8 == 0) p[c] = std::round(p[c]), q[c] = std::round(q[c]);
        vertices[k].t0[c] = std::ldexp(p[c], exponent);
        vertices[k].t1[c] = std::ldexp(q[c], exponent);
      }
      triangles[k / 3].place[k % 3] = static_cast<std::uint32_t>(k);
    }
    if (random.index(20) == 0) triangles[0].place[1] = triangles[0].place[0];
    const std::uint32_t expected = facedDirectionsOf(vertices, triangles);
    for (std::size_t k = 0; k < 2 * kNumAxes; ++k) met[k] += expected >> k & 1U;
    none += expected == 0;
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->facedDirections(vertices.data(), triangles.data(), count), expected)
          << k->name;
    // Triangles that are not finite face no direction.
    const double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
    TreeVertex& x = vertices[random.index(vertices.size())];
    (random.index(2) ? x.t0 : x.t1)[random.index(3)] = kBad[random.index(3)];
    if (&x == &vertices[1]) continue;  // it may belong to no triangle
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->facedDirections(vertices.data(), triangles.data(), count), 0U)
          << k->name;
    ASSERT_FALSE(HasFailure());
  }
  for (const int n : met) EXPECT_GT(n, 500);
  EXPECT_GT(none, 1000);
}

/// Numbers that are all positive (negative), by more than a margin or at all.
struct Signs {
  bool positive{true}, negative{true}, clearly_positive{true}, clearly_negative{true};

  void add(Real x, Real margin) {
    positive = positive && x > 0;
    negative = negative && x < 0;
    clearly_positive = clearly_positive && x > margin;
    clearly_negative = clearly_negative && x < -margin;
  }
};

Real volume(const RealVector& a, const RealVector& b, const RealVector& c) {
  return a.dot(b.cross(c));
}

// Whatever is claimed is true, and what is clearly true is claimed.
TEST(FCL_KERNELS, trianglesSeenFromAPoint) {
  constexpr std::uint64_t kSeed = 86;
  Random random(kSeed);
  int left = 0, right = 0, missed = 0, hit = 0, open = 0;
  for (int i = 0; i < 5000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = 1 + random.index(8);
    const double step = random.uniform(0, 1);
    const int exponent = static_cast<int>(random.index(200)) - 100;
    std::vector<TreeVertex> vertices(3 * count + 1);
    std::vector<TreeTriangle> triangles(count);
    for (TreeVertex& x : vertices) {
      const Vector3<double> p = random.point(1), q = p + random.point(step);
      for (int c = 0; c < 3; ++c) {
        // On a grid some volumes are zero.
        x.t0[c] = std::ldexp(i % 4 ? p[c] : std::round(p[c]), exponent);
        x.t1[c] = std::ldexp(i % 4 ? q[c] : std::round(q[c]), exponent);
      }
    }
    for (std::size_t k = 0; k < 3 * count; ++k)
      triangles[k / 3].place[k % 3] = static_cast<std::uint32_t>(k);
    const TreeVertex& point = vertices.back();
    const Vector3<double> direction = random.point(1);
    const double ray[3] = {direction[0], direction[1], direction[2]};
    const EightViews views =
        kernels().viewFrom(point, ray, vertices.data(), triangles.data(), count, nullptr);
    for (const Kernels* k : allSets()) {
      const EightViews other =
          k->viewFrom(point, ray, vertices.data(), triangles.data(), count, nullptr);
      EXPECT_EQ(other.left, views.left) << k->name;
      EXPECT_EQ(other.right, views.right) << k->name;
      EXPECT_EQ(other.missed, views.missed) << k->name;
    }
    EXPECT_EQ((views.left | views.right | views.missed) >> count, 0U);
    for (std::size_t k = 0; k < count; ++k) {
      RealVector a[2][3];
      for (int frame = 0; frame < 2; ++frame)
        for (std::size_t corner = 0; corner < 3; ++corner)
          for (int c = 0; c < 3; ++c) {
            const TreeVertex& x = vertices[3 * k + corner];
            a[frame][corner][c] = Real{frame == 0 ? x.t0[c] : x.t1[c]} -
                                  (frame == 0 ? point.t0[c] : point.t1[c]);
          }
      const auto &p = a[0], &q = a[1];
      const Real margin = std::ldexp(1e-12L, 3 * exponent);
      Signs volumes;
      volumes.add(volume(p[0], p[1], p[2]), margin);
      volumes.add(
          volume(q[0], p[1], p[2]) + volume(p[0], q[1], p[2]) + volume(p[0], p[1], q[2]),
          margin);
      volumes.add(
          volume(p[0], q[1], q[2]) + volume(q[0], p[1], q[2]) + volume(q[0], q[1], p[2]),
          margin);
      volumes.add(volume(q[0], q[1], q[2]), margin);
      const bool is_left = views.left >> k & 1U, is_right = views.right >> k & 1U,
                 is_missed = views.missed >> k & 1U;
      EXPECT_TRUE(volumes.positive || !is_left);
      EXPECT_TRUE(volumes.negative || !is_right);
      EXPECT_TRUE(is_left || !volumes.clearly_positive);
      EXPECT_TRUE(is_right || !volumes.clearly_negative);
      if (is_left || is_right) {
        // It is hit if all weights have the sign of the volume, or are zero.
        const RealVector r(ray[0], ray[1], ray[2]);
        const Real sign = is_left ? 1 : -1, weights[3] = {sign * volume(r, p[1], p[2]),
                                                          sign * volume(p[0], r, p[2]),
                                                          sign * volume(p[0], p[1], r)};
        const Real least = *std::min_element(weights, weights + 3);
        EXPECT_TRUE(least < 0 || !is_missed);
        EXPECT_TRUE(is_missed || least > -std::ldexp(1e-12L, 2 * exponent));
      }
      EXPECT_TRUE(is_left || is_right || !is_missed);
      left += is_left;
      right += is_right;
      open += !is_left && !is_right;
      missed += is_missed;
      hit += (is_left || is_right) && !is_missed;
    }
    vertices[random.index(3 * count)].t1[1] = std::numeric_limits<double>::quiet_NaN();
    for (const Kernels* k : allSets()) {
      const EightViews bad =
          k->viewFrom(point, ray, vertices.data(), triangles.data(), count, nullptr);
      EXPECT_NE(bad.left | bad.right, (1U << count) - 1) << k->name;
    }
    ASSERT_FALSE(HasFailure());
  }
  for (const int n : {left, right, missed, hit, open}) EXPECT_GT(n, 300);
}

/// A few triangles that move as a whole and are bent while they do, and a point.
struct MovingTriangles {
  std::vector<TreeVertex> vertices;
  std::vector<TreeTriangle> triangles;

  MovingTriangles(Random& random, std::size_t count, double step, int exponent)
      : vertices(3 * count + 1), triangles(count) {
    const Vector3<double> away = random.point(1);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      Vector3<double> p = random.point(1);
      // The point is below the triangles.
      p[2] += k < 3 * count ? 2 : -2;
      const Vector3<double> q = p + away + random.point(step);
      for (int c = 0; c < 3; ++c) {
        vertices[k].t0[c] = std::ldexp(p[c], exponent);
        vertices[k].t1[c] = std::ldexp(q[c], exponent);
      }
      if (k < 3 * count) triangles[k / 3].place[k % 3] = static_cast<std::uint32_t>(k);
    }
  }

  RealVector at(std::size_t vertex, Real t) const {
    RealVector x;
    for (int c = 0; c < 3; ++c)
      x[c] = (1 - t) * vertices[vertex].t0[c] + t * vertices[vertex].t1[c];
    return x;
  }
  /// Calls visit(corners) for triangle i at several times.
  template <typename Visit>
  void visitCorners(std::size_t i, Visit&& visit) const {
    for (int k = 0; k <= 16; ++k) {
      const Real t = k / 16.L;
      const RealVector corners[4] = {at(3 * i, t), at(3 * i + 1, t), at(3 * i + 2, t),
                                     at(vertices.size() - 1, t)};
      visit(corners);
    }
  }
};

/// The least of all lanes of LeastSight.
struct LeastOfAll {
  double distance_square, sine_square;
};

/// Of triangles seen one after the other in two blocks, where there are several.
LeastOfAll leastSightOf(const Kernels& k, const MovingTriangles& x, std::size_t count) {
  constexpr double kRay[3] = {0, 0, 1};
  LeastSight least;
  const std::size_t first = count / 2;
  if (first > 0)
    k.viewFrom(x.vertices.back(), kRay, x.vertices.data(), x.triangles.data(), first,
               &least);
  k.viewFrom(x.vertices.back(), kRay, x.vertices.data(), x.triangles.data() + first,
             count - first, &least);
  return {*std::min_element(least.distance_square, least.distance_square + 8),
          *std::min_element(least.sine_square, least.sine_square + 8)};
}

// The bounds are below what is there at any time, and not far below for triangles at
// rest.
TEST(FCL_KERNELS, leastSightFromAPoint) {
  constexpr std::uint64_t kSeed = 89;
  Random random(kSeed);
  int bounded = 0, none = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = 1 + random.index(8);
    const double step = i % 3 ? random.uniform(0, 0.3) : 0;
    const int exponent = static_cast<int>(random.index(200)) - 100;
    MovingTriangles x(random, count, step, exponent);
    const auto least_by = [&](const Kernels& k) { return leastSightOf(k, x, count); };
    const LeastOfAll sight = least_by(kernels());
    for (const Kernels* k : allSets()) {
      const LeastOfAll other = least_by(*k);
      EXPECT_EQ(other.distance_square, sight.distance_square) << k->name;
      EXPECT_EQ(other.sine_square, sight.sine_square) << k->name;
    }
    Real distance = kInfinity, sine = kInfinity;
    for (std::size_t t = 0; t < count; ++t)
      x.visitCorners(t, [&](const RealVector(&p)[4]) {
        const RealVector a = p[0] - p[3], b = p[1] - p[3], c = p[2] - p[3];
        const Real six = abs(volume(a, b, c));
        distance = std::min(distance, six / (b - a).cross(c - a).norm());
        sine = std::min(sine, six / (a.norm() * b.cross(c).norm()));
        sine = std::min(sine, six / (b.norm() * c.cross(a).norm()));
        sine = std::min(sine, six / (c.norm() * a.cross(b).norm()));
      });
    const Real almost = 1 + 1e-12L;
    EXPECT_LE(sight.distance_square, distance * distance * almost);
    EXPECT_LE(sight.sine_square, sine * sine * almost);
    if (step == 0 && sine > 1e-3L) {
      EXPECT_GE(sight.distance_square, distance * distance * (1 - 1e-9L));
      EXPECT_GE(sight.sine_square, sine * sine * (1 - 1e-9L));
    }
    bounded += sight.sine_square > 0;
    none += sight.sine_square == 0;
    x.vertices[random.index(3 * count)].t1[1] = std::numeric_limits<double>::quiet_NaN();
    for (const Kernels* k : allSets()) EXPECT_EQ(least_by(*k).sine_square, 0) << k->name;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(bounded, 1000);
  EXPECT_GT(none, 300);
}

// A corner that is not low is higher than the distance at all times.
TEST(FCL_KERNELS, lowCorners) {
  constexpr std::uint64_t kSeed = 90;
  Random random(kSeed);
  int low = 0, high = 0;
  for (int i = 0; i < test::rounds(8000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const double step = i % 3 ? random.uniform(0, 0.3) : 0;
    const int exponent = static_cast<int>(random.index(200)) - 100;
    MovingTriangles x(random, 8, step, exponent);
    MovingKdopNode node{};
    node.count = 8;
    for (int lane = 0; lane < 8; ++lane) {
      node.child[lane] = random.index(4) ? ~lane : lane;
      for (std::uint32_t k = 0; k < 3; ++k)
        node.places[k][lane] = node.child[lane] < 0
                                   ? 3 * static_cast<std::uint32_t>(lane) + k
                                   : MovingKdopNode::kNoPlace;
    }
    node.markTriangles();
    if (node.triangles == 0) continue;
    const std::size_t axis = random.index(kNumAxes);
    const int sign = random.index(2) ? 1 : -1,
              direction[3] = {sign * kAxes[axis][0], sign * kAxes[axis][1],
                              sign * kAxes[axis][2]};
    const double distance = std::ldexp(random.uniform(0, 0.6), exponent);
    const std::uint32_t found =
        kernels().lowCorners(x.vertices.data(), node, direction, distance);
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->lowCorners(x.vertices.data(), node, direction, distance), found)
          << k->name;
    const RealVector d =
        RealVector(direction[0], direction[1], direction[2]).normalized();
    for (std::size_t t = 0; t < 8; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const bool is_low = found >> (8 * k + t) & 1U;
        if (!(node.triangles >> t & 1U)) {
          EXPECT_FALSE(is_low);
          continue;
        }
        Real height = kInfinity, bound = kInfinity;
        x.visitCorners(t, [&](const RealVector(&p)[4]) {
          const RealVector side = p[(k + 2) % 3] - p[(k + 1) % 3];
          const Real area = (p[1] - p[0]).cross(p[2] - p[0]).dot(d);
          height = std::min(height, area / (side - side.dot(d) * d).norm());
          bound = std::min(bound, area / side.norm());
        });
        EXPECT_TRUE(is_low || height > distance);
        EXPECT_TRUE(step > 0 || !is_low || bound < distance * (1 + 1e-9L));
        ++(is_low ? low : high);
      }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(low, test::rounds(3000));
  EXPECT_GT(high, test::rounds(3000));
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

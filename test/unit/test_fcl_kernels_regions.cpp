// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel of regions: the directions that triangles face during the whole step.
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

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::allSets;
using test::Random;

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

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

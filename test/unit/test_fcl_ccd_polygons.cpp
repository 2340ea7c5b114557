// SPDX-License-Identifier: BSD-3-Clause
//
// Faces of many corners, divided by the sweep: random polygons with all their corners on
// a small grid, so that corners are in line and edges upright; faces with holes that are
// cut open, with corners that touch, with spikes; and large ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "mesh_io.h"
#include "sweep_triangulation.h"
#include "triangulate.h"

namespace {

using fcl_ccd::Triangles;
using fcl_ccd::Vertices;
using Point = std::array<double, 3>;

constexpr double kPi = 3.14159265358979323846;

std::vector<int> numbers(std::size_t size) {
  std::vector<int> ids;
  for (std::size_t i = 0; i < size; ++i) ids.push_back(static_cast<int>(i));
  return ids;
}

fcl_ccd::Faces face(const std::vector<int>& ids) {
  fcl_ccd::Faces faces;
  faces.corners = ids;
  EXPECT_TRUE(faces.endFace());
  return faces;
}

const Point& at(const Vertices& vertices, int id) {
  return vertices[static_cast<std::size_t>(id)];
}

double turn(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double areaOf(const Vertices& vertices, const std::vector<int>& ids) {
  double area = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Point &p = at(vertices, ids[i]), &q = at(vertices, ids[(i + 1) % ids.size()]);
    area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
  }
  return area;
}

/// @brief Whether c is on the closed segment ab; exact on a grid.
bool isOn(const Point& a, const Point& b, const Point& c) {
  return turn(a, b, c) == 0 && std::min(a[0], b[0]) <= c[0] &&
         c[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= c[1] &&
         c[1] <= std::max(a[1], b[1]);
}

bool doMeet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto sign = [](double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  return (sign(turn(a, b, c)) * sign(turn(a, b, d)) < 0 &&
          sign(turn(c, d, a)) * sign(turn(c, d, b)) < 0) ||
         isOn(a, b, c) || isOn(a, b, d) || isOn(c, d, a) || isOn(c, d, b);
}

/// @brief Makes a polygon simple by turning the part between two edges that meet, again
/// and again. Returns whether it succeeded.
bool untangle(Vertices& p) {
  const std::size_t n = p.size();
  for (int tries = 0; tries < 200; ++tries) {
    bool is_simple = true;
    for (std::size_t i = 0; i < n && is_simple; ++i)
      for (std::size_t j = i + 1; j < n && is_simple; ++j) {
        const Point &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
        const bool follows = j == i + 1, precedes = (j + 1) % n == i;
        if (follows || precedes) {
          // Neighbours share a corner. They must not go back along each other.
          if (follows ? isOn(a, b, d) || isOn(c, d, a) : isOn(a, b, c) || isOn(c, d, b))
            return false;
        } else if (doMeet(a, b, c, d)) {
          std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                       p.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          is_simple = false;
        }
      }
    if (is_simple) return true;
  }
  return false;
}

/// @brief A simple polygon that turns to the left; empty if none was found.
Vertices randomPolygon(std::mt19937& random) {
  Vertices p;
  const std::size_t most = 4 + random() % 14, grid = 2 + random() % 7;
  for (std::size_t i = 0; i < most; ++i) {
    const Point q{double(random() % grid), double(random() % grid), 0};
    if (std::find(p.begin(), p.end(), q) == p.end()) p.push_back(q);
  }
  if (p.size() < 4 || !untangle(p)) return {};
  if (areaOf(p, numbers(p.size())) < 0) std::reverse(p.begin(), p.end());
  return p;
}

/// @brief Expects that triangles cover a polygon of this area once.
/// @param with_flat  whether triangles without area are right, too
void expectCovered(const Vertices& vertices, const std::vector<int>& ids,
                   const Triangles& triangles, bool with_flat = false) {
  EXPECT_EQ(triangles.size(), ids.size() - 2);
  double covered = 0;
  for (const auto& t : triangles) {
    const double area =
        0.5 * turn(at(vertices, t[0]), at(vertices, t[1]), at(vertices, t[2]));
    ASSERT_TRUE(area > 0 || (with_flat && area == 0)) << area;
    covered += area;
  }
  const double area = areaOf(vertices, ids);
  EXPECT_NEAR(covered, area, 1e-9 * std::max(1.0, area));
}

Triangles sweep(const Vertices& vertices, const std::vector<int>& ids) {
  Triangles triangles;
  EXPECT_TRUE(fcl_ccd::addSweptTriangles(vertices, ids, 2, true, triangles));
  return triangles;
}

// Positive areas that add up to the polygon's, and no corner on an edge of a triangle of
// which it is no corner.
TEST(CcdPolygons, RandomOnesOnAGridAreCoveredOnce) {
  std::mt19937 random(1);
  int num_polygons = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vertices p = randomPolygon(random);
    if (p.empty()) continue;
    ++num_polygons;
    const std::vector<int> ids = numbers(p.size());
    const Triangles triangles = sweep(p, ids);
    expectCovered(p, ids, triangles);
    for (const auto& t : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        for (const int id : ids)
          if (id != t[k] && id != t[(k + 1) % 3]) {
            ASSERT_FALSE(isOn(at(p, t[k]), at(p, t[(k + 1) % 3]), at(p, id))) << i;
          }
  }
  EXPECT_GT(num_polygons, 2000);
}

// The same polygon seen along any axis, from either side.
TEST(CcdPolygons, TheViewDoesNotMatter) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const Vertices p = randomPolygon(random);
    if (p.empty()) continue;
    const std::vector<int> ids = numbers(p.size());
    const double area = areaOf(p, ids);
    for (int axis = 0; axis < 3; ++axis)
      for (const bool turns_left : {true, false}) {
        Vertices q = p;
        for (std::size_t k = 0; k < p.size(); ++k) {
          const auto u = static_cast<std::size_t>((axis + 1) % 3),
                     v = static_cast<std::size_t>((axis + 2) % 3);
          q[k] = {};
          q[k][turns_left ? u : v] = p[k][0];
          q[k][turns_left ? v : u] = p[k][1];
        }
        Triangles triangles;
        ASSERT_TRUE(fcl_ccd::addSweptTriangles(q, ids, axis, turns_left, triangles));
        double covered = 0;
        for (const auto& t : triangles)
          covered += 0.5 * turn(at(p, t[0]), at(p, t[1]), at(p, t[2]));
        EXPECT_EQ(triangles.size(), ids.size() - 2);
        EXPECT_NEAR(covered, area, 1e-12);
      }
  }
}

std::vector<int> addRing(const Point& centre, double radius, int size, double phase,
                         Vertices& vertices) {
  std::vector<int> ids;
  for (int i = 0; i < std::abs(size); ++i) {
    const double angle = phase + 2 * kPi * i / size;
    ids.push_back(static_cast<int>(vertices.size()));
    vertices.push_back(
        {centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle), 0});
  }
  return ids;
}

/// @brief Appends the ring from its first corner to its first corner.
void appendClosed(const std::vector<int>& ring, std::vector<int>& ids) {
  ids.insert(ids.end(), ring.begin(), ring.end());
  ids.push_back(ring[0]);
}

// A ring for the outside, a cut to the hole, the hole, and the cut back. The corners of
// the cut have one id or two.
TEST(CcdPolygons, FacesWithHolesThatAreCutOpen) {
  for (double phase = 0; phase < 6; phase += kPi / 8) {
    Vertices vertices;
    std::vector<int> ids;
    appendClosed(addRing({0, 0, 0}, 2, 70, phase, vertices), ids);
    appendClosed(addRing({0, 0, 0}, 1, -30, phase, vertices), ids);
    expectCovered(vertices, ids, sweep(vertices, ids));
    EXPECT_EQ(fcl_ccd::triangulate(vertices, face(ids)), sweep(vertices, ids));
    Vertices copies;
    for (const int id : ids) copies.push_back(at(vertices, id));
    expectCovered(copies, numbers(ids.size()), sweep(copies, numbers(ids.size())));
  }
}

TEST(CcdPolygons, CornersMayTouch) {
  const Vertices v{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 2, 0},
                   {2, 1, 0}, {6, 0, 0}, {4, 0, 0}, {2, 0, 0}, {0, 0, 0}};
  const std::vector<std::vector<int>> polygons{
      {0, 1, 2, 3, 0, 4, 5},  // a hole that touches the outside in a corner
      {0, 1, 2, 3, 9, 4, 5},  // the same with two ids
      {0, 1, 6, 1, 2, 3},     // a spike to the outside
      {0, 1, 6, 7, 2, 3},     // the same with two ids
      {0, 5, 0, 1, 2, 3},     // a spike to the inside
      {0, 1, 1, 2, 3},        // a corner that is given twice
      {0, 1, 7, 2, 3},        // the same with two ids
      {0, 1, 2, 8, 3}};       // a corner that touches a side
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    SCOPED_TRACE(i);
    expectCovered(v, polygons[i], sweep(v, polygons[i]), true);
  }
  const std::vector<int> eighty = numbers(80);
  EXPECT_EQ(sweep(Vertices(80, {1, 1, 1}), eighty).size(), 78u);
  // Two triangles that meet in a corner, beside and above each other.
  for (const bool beside : {true, false}) {
    Vertices two{{0, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 0}, {1, -1, 0}, {1, 1, 0}};
    if (!beside)
      for (auto& p : two) p = {p[1], -p[0], 0};
    expectCovered(two, numbers(6), sweep(two, numbers(6)), true);
    expectCovered(two, {0, 1, 2, 0, 4, 5}, sweep(two, {0, 1, 2, 0, 4, 5}), true);
  }
}

Vertices comb(int teeth) {
  Vertices p;
  for (int i = 0; i < teeth; ++i) {
    p.push_back({double(i), 0, 0});
    p.push_back({i + 0.5, 5, 0});
  }
  p.push_back({double(teeth), 0, 0});
  p.push_back({double(teeth), -1, 0});
  p.push_back({0, -1, 0});
  std::reverse(p.begin(), p.end());
  return p;
}

Vertices star(int size, double inner) {
  Vertices p;
  for (int i = 0; i < size; ++i) {
    const double angle = 2 * kPi * i / size, radius = i % 2 == 0 ? 1 : inner;
    p.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return p;
}

Vertices spiral(int half) {
  Vertices p;
  for (int i = 0; i < 2 * half; ++i) {
    const double angle = 0.01 * (i < half ? i : 2 * half - 1 - i);
    const double radius = angle + (i < half ? 1 : 0.5);
    p.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return p;
}

// These took 0.3 s together; to cut off ears took over a minute for each. The test does
// not measure time.
TEST(CcdPolygons, LargeOnesAreCovered) {
  for (const Vertices& p : {comb(50000), star(100000, 0.3), spiral(50000)}) {
    const std::vector<int> ids = numbers(p.size());
    expectCovered(p, ids, fcl_ccd::triangulate(p, face(ids)));
  }
  // A circle turns too little at each corner for a fan.
  const Vertices circle = star(100000, 1);
  expectCovered(circle, numbers(circle.size()),
                fcl_ccd::triangulate(circle, face(numbers(circle.size()))));
}

// Random corners: the polygon crosses itself everywhere. There are triangles all the
// same.
TEST(CcdPolygons, ThoseThatCrossThemselvesEnd) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(0, 1);
  for (const std::size_t size : {4u, 65u, 1000u, 20000u}) {
    Vertices p;
    for (std::size_t i = 0; i < size; ++i)
      p.push_back({number(random), number(random), 0});
    EXPECT_EQ(fcl_ccd::triangulate(p, face(numbers(size))).size(), size - 2);
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "triangulate.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "sweep_triangulation.h"

namespace fcl_ccd {
namespace {

struct Point2 {
  double x, y;
};

/// Twice the area of the triangle, positive if it turns to the left.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The sine of an angle below which three points count as points of a line: 0.06 degrees.
/// Rounded to six digits, the fewest that programs write, a point moves by up to 5e-6 of
/// its coordinate. This is the angle at an edge of 1/200 of the coordinate. A polygon of
/// fewer than 6,000 corners on a circle turns by more at each.
constexpr double kStraight = 1e-3;

/// The angles with which ears are searched, each when there is no ear left with the one
/// before. A thin face has only thin ears.
constexpr double kStraightOfEars[] = {kStraight, 1e-6, 1e-9, 0};

/// @brief The least turn() of three points that are not on a line, for this sine of an
/// angle between b - a and c - b.
double leastTurn(double sine, const Point2& a, const Point2& b, const Point2& c) {
  const auto squared = [](const Point2& p, const Point2& q) {
    return (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
  };
  return sine * std::sqrt(squared(a, b)) * std::sqrt(squared(b, c));
}

/// @brief Twice the sum of the areas that the polygon covers in the planes yz, zx and xy.
std::array<double, 3> newellNormal(const Vertices& vertices,
                                   const std::vector<int>& corners) {
  std::array<double, 3> normal{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& p = vertices[static_cast<std::size_t>(corners[i])];
    const auto& q = vertices[static_cast<std::size_t>(corners[(i + 1) % corners.size()])];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
      normal[k] += (p[u] - q[u]) * (p[v] + q[v]);
    }
  }
  return normal;
}

/// @brief The coordinate plane in which a polygon is largest.
struct View {
  std::size_t axis{0};  ///< across the plane
  bool turns_left{true};
};

View viewOf(const Vertices& vertices, const std::vector<int>& corners) {
  const std::array<double, 3> normal = newellNormal(vertices, corners);
  View view;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[view.axis])) view.axis = k;
  view.turns_left = !(normal[view.axis] < 0);
  return view;
}

/// @brief The polygon in this plane, turning to the left.
std::vector<Point2> project(const Vertices& vertices, const std::vector<int>& corners,
                            const View& view) {
  std::size_t u = (view.axis + 1) % 3, v = (view.axis + 2) % 3;
  if (!view.turns_left) std::swap(u, v);
  std::vector<Point2> points;
  for (const int id : corners) {
    const auto& p = vertices[static_cast<std::size_t>(id)];
    points.push_back({p[u], p[v]});
  }
  return points;
}

/// @brief Whether the polygon turns to the left at each corner.
bool isStrictlyConvex(const std::vector<Point2>& points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (!(turn(a, b, c) > leastTurn(kStraight, a, b, c))) return false;
  }
  return true;
}

/// Faces of up to so many corners lose their ears without a limit: this takes less than
/// 64^3 tests of a point and a triangle, 4,096 a corner.
constexpr std::size_t kFewCorners = 64;
/// The tests for each corner of a larger face, of which only those come here that cross
/// themselves. One pass over 1,000 corners needs as many. When none is left, the rest
/// becomes a fan.
constexpr std::size_t kTestsACorner = 1024;

/// @brief A ring of corners from which ears are cut, one at a time.
class Ring {
 public:
  Ring(std::vector<int> corners, std::vector<Point2> points)
      : most_tests_(corners.size() <= kFewCorners
                        ? std::numeric_limits<std::size_t>::max()
                        : kTestsACorner * corners.size()),
        corners_(std::move(corners)),
        points_(std::move(points)) {}

  std::size_t size() const { return corners_.size(); }

  /// Whether the triangle at corner i turns to the left and contains no other corner, not
  /// on its edges either.
  /// @param straight  the sine of an angle below which three corners are on a line.
  bool isEar(std::size_t i, double straight) {
    const std::size_t before = (i + size() - 1) % size(), after = (i + 1) % size();
    const Point2 &a = points_[before], &b = points_[i], &c = points_[after];
    ++num_tests_;
    if (!(turn(a, b, c) > leastTurn(straight, a, b, c))) return false;
    for (std::size_t k = 0; k < size(); ++k) {
      ++num_tests_;
      const int id = corners_[k];
      if (id == corners_[before] || id == corners_[i] || id == corners_[after]) continue;
      const Point2& p = points_[k];
      const auto isBeside = [&](const Point2& from, const Point2& to) {
        const double side = turn(from, to, p);
        return side >= 0 || side >= -leastTurn(straight, from, to, p);
      };
      if (isBeside(a, b) && isBeside(b, c) && isBeside(c, a)) return false;
    }
    return true;
  }

  /// The first ear at corner i or behind it; size() if there is none, or no test left.
  std::size_t findEar(std::size_t i, double straight) {
    for (std::size_t k = 0; k < size() && hasTestsLeft(); ++k)
      if (isEar((i + k) % size(), straight)) return (i + k) % size();
    return size();
  }

  void cut(std::size_t i, Triangles& out) {
    assert(i < size() && size() > 3);
    out.push_back(
        {corners_[(i + size() - 1) % size()], corners_[i], corners_[(i + 1) % size()]});
    num_tests_ += size() / 64;  // moving 64 corners takes the time of a test or less
    corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(i));
    points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  const std::vector<int>& corners() const { return corners_; }

 private:
  bool hasTestsLeft() const { return num_tests_ < most_tests_; }

  std::size_t most_tests_;
  std::size_t num_tests_{0};
  std::vector<int> corners_;
  std::vector<Point2> points_;
};

void addFan(const std::vector<int>& corners, Triangles& out) {
  for (std::size_t k = 2; k < corners.size(); ++k)
    out.push_back({corners[0], corners[k - 1], corners[k]});
}

void addPolygon(const Vertices& vertices, const std::vector<int>& corners,
                Triangles& out) {
  const View view = viewOf(vertices, corners);
  std::vector<Point2> points = project(vertices, corners, view);
  if (isStrictlyConvex(points)) return addFan(corners, out);
  if (corners.size() > kFewCorners &&
      addSweptTriangles(vertices, corners, static_cast<int>(view.axis), view.turns_left,
                        out))
    return;
  [[maybe_unused]] const std::size_t before = out.size();
  Ring ring(corners, std::move(points));
  std::size_t i = 0;
  for (const double straight : kStraightOfEars) {
    while (ring.size() > 3) {
      const std::size_t ear = ring.findEar(i, straight);
      if (ear == ring.size()) break;
      ring.cut(ear, out);
      i = ear % ring.size();
    }
  }
  addFan(ring.corners(), out);
  assert(out.size() == before + corners.size() - 2);
}

}  // namespace

Triangles triangulate(const Vertices& vertices, const Faces& faces) {
  Triangles triangles;
  triangles.reserve(faces.corners.size() / 3);
  if (faces.ends.empty()) {
    assert(faces.corners.size() % 3 == 0);
    for (std::size_t i = 0; i < faces.corners.size(); i += 3)
      triangles.push_back({faces.corners[i], faces.corners[i + 1], faces.corners[i + 2]});
    return triangles;
  }
  std::vector<int> corners;
  std::size_t begin = 0;
  for (const std::size_t end : faces.ends) {
    assert(begin + 3 <= end && end <= faces.corners.size());
    corners.assign(faces.corners.begin() + static_cast<std::ptrdiff_t>(begin),
                   faces.corners.begin() + static_cast<std::ptrdiff_t>(end));
    if (corners.size() == 3)
      addFan(corners, triangles);
    else
      addPolygon(vertices, corners, triangles);
    begin = end;
  }
  return triangles;
}

}  // namespace fcl_ccd

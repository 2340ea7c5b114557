// SPDX-License-Identifier: BSD-3-Clause
//
// Random shapes with support functions and distances of their own, for references that
// share no code with the library.
#ifndef FCL_TEST_SUPPORT_POSED_SHAPE_H
#define FCL_TEST_SUPPORT_POSED_SHAPE_H

#include <ccd/ccd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/geometry/shape/triangle_p.h"
#include "mesh_generators.h"
#include "random_direction.h"

namespace fcl {
namespace test {

/// @brief A shape in a pose.
struct PosedShape {
  using Point = Vector3<double>;

  std::string kind;
  std::shared_ptr<CollisionGeometry<double>> geometry;
  /// Depends on the kind: the points whose hull it is; or radius and half height around
  /// the z axis; or half axes.
  std::vector<Point> points;
  Point size{Point::Zero()};
  /// Of spheres and capsules: how far it stands out from the hull.
  double radius{0};
  /// Of planes and halfspaces.
  Point normal{Point::Zero()};
  double offset{0};
  Transform3<double> pose{Transform3<double>::Identity()};

  bool isFlat() const { return kind == "plane" || kind == "halfspace"; }

  /// @brief A farthest point along a direction, in the world.
  Point support(const Point& direction) const {
    const Point d = (pose.linear().transpose() * direction).normalized();
    Point p = Point::Zero();
    if (!points.empty()) {
      p = *std::max_element(
          points.begin(), points.end(),
          [&d](const Point& x, const Point& y) { return x.dot(d) < y.dot(d); });
      p += radius * d;
    } else if (kind == "ellipsoid") {
      p = size.cwiseProduct(size.cwiseProduct(d).normalized());
    } else {
      Point rim = Point::Zero();
      if (d.head<2>().norm() > 0) rim.head<2>() = size[0] * d.head<2>().normalized();
      rim[2] = kind == "cylinder" && d[2] > 0 ? size[1] : -size[1];
      const Point tip(0, 0, size[1]);
      p = kind == "cone" && tip.dot(d) > rim.dot(d) ? tip : rim;
    }
    return pose * p;
  }

  /// @brief How far outside a point of the world is, at least about; 0 inside. Only its
  /// zero matters: it is found without any support function where the shape is round.
  double outside(const Point& world) const {
    const Point p = pose.inverse() * world;
    const double r = p.head<2>().norm(), z = p[2];
    if (kind == "plane") return std::abs(normal.dot(p) - offset);
    if (kind == "halfspace") return std::max(normal.dot(p) - offset, 0.);
    if (kind == "sphere") return std::max(p.norm() - radius, 0.);
    if (kind == "capsule")
      return std::max(std::hypot(r, std::max(std::abs(z) - size[1], 0.)) - radius, 0.);
    if (kind == "cylinder") return std::max({r - size[0], std::abs(z) - size[1], 0.});
    if (kind == "cone")
      return std::max({r - size[0] * (size[1] - z) / (2 * size[1]), -size[1] - z, 0.});
    if (kind == "ellipsoid")
      return std::max(p.cwiseQuotient(size).norm() - 1, 0.) * size.minCoeff();
    if (kind == "box") return std::max((p.cwiseAbs() - size).maxCoeff(), 0.);
    if (kind == "convex")
      return std::max(p.cwiseQuotient(Point(p[0] > 0 ? points[1][0] : points[0][0],
                                            p[1] > 0 ? points[3][1] : points[2][1],
                                            p[2] > 0 ? points[5][2] : points[4][2]))
                              .sum() -
                          1,
                      0.);
    return outsideTriangle(p);
  }

 private:
  double outsideTriangle(const Point& p) const {
    const Point n = (points[1] - points[0]).cross(points[2] - points[0]).normalized();
    double most = std::abs(n.dot(p - points[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      const Point edge = points[(k + 1) % 3] - points[k];
      most = std::max(most, edge.cross(n).normalized().dot(p - points[k]));
    }
    return most;
  }
};

inline PosedShape posedTriangle(const Vector3<double>& a, const Vector3<double>& b,
                                const Vector3<double>& c) {
  PosedShape shape;
  shape.kind = "triangle";
  shape.points = {a, b, c};
  shape.geometry = std::make_shared<TriangleP<double>>(a, b, c);
  return shape;
}

/// @brief An octahedron whose corners are at random places on the axes.
inline PosedShape randomConvex(Random& random) {
  PosedShape shape;
  for (int i = 0; i < 6; ++i) {
    Vector3<double> p = Vector3<double>::Zero();
    p[i / 2] = (i % 2 == 1 ? 1 : -1) * random.uniform(0.2, 0.7);
    shape.points.push_back(p);
  }
  auto faces = std::make_shared<std::vector<int>>();
  for (int face = 0; face < 8; ++face) {
    const int corners[3] = {face & 1, 2 + (face >> 1 & 1), 4 + (face >> 2 & 1)};
    const bool turned = __builtin_popcount(static_cast<unsigned>(face)) % 2 == 0;
    faces->insert(faces->end(),
                  {3, corners[0], corners[turned ? 2 : 1], corners[turned ? 1 : 2]});
  }
  shape.geometry = std::make_shared<Convex<double>>(
      std::make_shared<std::vector<Vector3<double>>>(shape.points), 8, faces);
  return shape;
}

/// @brief A shape of a kind, with sizes from 0.1 to 0.6.
inline PosedShape randomShape(const std::string& kind, Random& random) {
  using Point = Vector3<double>;
  PosedShape shape;
  double s[3];
  for (double& size : s) size = random.uniform(0.1, 0.6);
  if (kind == "sphere") {
    shape.points = {Point::Zero()};
    shape.radius = s[0];
    shape.geometry = std::make_shared<Sphere<double>>(s[0]);
  } else if (kind == "capsule") {
    shape.points = {Point(0, 0, -s[1]), Point(0, 0, s[1])};
    shape.radius = s[0];
    shape.size = {0, s[1], 0};
    shape.geometry = std::make_shared<Capsule<double>>(s[0], 2 * s[1]);
  } else if (kind == "box") {
    for (int i = 0; i < 8; ++i)
      shape.points.emplace_back((i & 1) != 0 ? s[0] : -s[0], (i & 2) != 0 ? s[1] : -s[1],
                                (i & 4) != 0 ? s[2] : -s[2]);
    shape.size = {s[0], s[1], s[2]};
    shape.geometry = std::make_shared<Box<double>>(2 * s[0], 2 * s[1], 2 * s[2]);
  } else if (kind == "ellipsoid") {
    shape.size = {s[0], s[1], s[2]};
    shape.geometry = std::make_shared<Ellipsoid<double>>(s[0], s[1], s[2]);
  } else if (kind == "cone" || kind == "cylinder") {
    shape.size = {s[0], s[1], 0};
    if (kind == "cone")
      shape.geometry = std::make_shared<Cone<double>>(s[0], 2 * s[1]);
    else
      shape.geometry = std::make_shared<Cylinder<double>>(s[0], 2 * s[1]);
  } else if (kind == "convex") {
    shape = randomConvex(random);
  } else if (kind == "triangle") {
    shape = posedTriangle(s[0] * randomDirection(random), s[1] * randomDirection(random),
                          s[2] * randomDirection(random));
  } else {
    shape.normal = randomDirection(random);
    shape.offset = random.uniform(-0.5, 0.5);
    if (kind == "plane")
      shape.geometry = std::make_shared<Plane<double>>(shape.normal, shape.offset);
    else
      shape.geometry = std::make_shared<Halfspace<double>>(shape.normal, shape.offset);
  }
  shape.kind = kind;
  return shape;
}

/// @brief Whether balls around two shapes are apart, so that they do not overlap.
inline bool areFar(const PosedShape& a, const PosedShape& b) {
  if (a.isFlat() || b.isFlat()) return false;
  Vector3<double> center[2];
  double radius[2];
  for (int side = 0; side < 2; ++side) {
    const PosedShape& shape = side == 0 ? a : b;
    center[side] = shape.pose.translation();
    // The largest is a capsule, of the radius 0.6 and a half length of 0.6.
    radius[side] = 1.2;
    if (shape.kind != "triangle") continue;
    center[side] = shape.pose * shape.points[0];
    radius[side] = std::max((shape.points[1] - shape.points[0]).norm(),
                            (shape.points[2] - shape.points[0]).norm());
  }
  return (center[1] - center[0]).norm() > radius[0] + radius[1];
}

/// @brief Whether a bounded shape and another one overlap, by libccd or in closed form;
/// wrong by about 1e-6.
inline bool overlap(const PosedShape& a, const PosedShape& b) {
  if (a.isFlat()) return overlap(b, a);
  if (b.isFlat()) {
    const Vector3<double> n = b.pose.linear() * b.normal;
    const double offset = b.offset + n.dot(b.pose.translation());
    return n.dot(a.support(-n)) <= offset &&
           (b.kind == "halfspace" || n.dot(a.support(n)) >= offset);
  }
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 =
      ccd.support2 = [](const void* shape, const ccd_vec3_t* d, ccd_vec3_t* out) {
        const Vector3<double> p = static_cast<const PosedShape*>(shape)->support(
            Vector3<double>(d->v[0], d->v[1], d->v[2]));
        ccdVec3Set(out, p[0], p[1], p[2]);
      };
  ccd.center1 = ccd.center2 = [](const void* shape, ccd_vec3_t* out) {
    const auto* posed = static_cast<const PosedShape*>(shape);
    Vector3<double> p = Vector3<double>::Zero();
    for (const Vector3<double>& x : posed->points) p += x;
    if (!posed->points.empty()) p /= static_cast<double>(posed->points.size());
    p = posed->pose * p;
    ccdVec3Set(out, p[0], p[1], p[2]);
  };
  ccd.max_iterations = 500;
  return ccdGJKIntersect(&a, &b, &ccd) != 0;
}

}  // namespace test
}  // namespace fcl

#endif

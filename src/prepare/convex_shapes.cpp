// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/convex_shapes.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "elementary/least_length.h"
#include "fcl/common/exception.h"
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
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

template <typename S>
double requireSize(S size, const std::string& name, const char* what) {
  if (size >= 0 && std::isfinite(size)) return static_cast<double>(size);
  throw Exception(name + ": the " + what + " is negative or not finite. Give 0 or more");
}

template <typename S>
Vec requirePoint(const Vector3<S>& p, const std::string& name, const char* what) {
  if (!p.allFinite())
    throw Exception(name + ": a coordinate of the " + what +
                    " is not finite. Correct it");
  return {static_cast<double>(p[0]), static_cast<double>(p[1]),
          static_cast<double>(p[2])};
}

template <typename S>
ConvexShape shapeOf(const Sphere<S>& sphere, const std::string& name, double) {
  return ConvexShape::capsule(requireSize(sphere.radius, name, "radius of the sphere"),
                              0);
}

template <typename S>
ConvexShape shapeOf(const Capsule<S>& capsule, const std::string& name, double) {
  const double half = 0.5 * requireSize(capsule.lz, name, "length of the capsule");
  return ConvexShape::capsule(requireSize(capsule.radius, name, "radius of the capsule"),
                              half);
}

template <typename S>
ConvexShape shapeOf(const Box<S>& box, const std::string& name, double) {
  double half[3];
  for (int k = 0; k < 3; ++k)
    half[k] = 0.5 * requireSize(box.side[k], name, "side of the box");
  return ConvexShape::cuboid({half[0], half[1], half[2]});
}

template <typename S>
ConvexShape shapeOf(const Ellipsoid<S>& ellipsoid, const std::string& name, double) {
  double half[3];
  for (int k = 0; k < 3; ++k)
    half[k] = requireSize(ellipsoid.radii[k], name, "radius of the ellipsoid");
  return ConvexShape::ellipsoid({half[0], half[1], half[2]});
}

template <typename S>
ConvexShape shapeOf(const Cone<S>& cone, const std::string& name, double) {
  return ConvexShape::cone(requireSize(cone.radius, name, "radius of the cone"),
                           requireSize(cone.lz, name, "height of the cone"));
}

template <typename S>
ConvexShape shapeOf(const Cylinder<S>& cylinder, const std::string& name, double) {
  return ConvexShape::cylinder(
      requireSize(cylinder.radius, name, "radius of the cylinder"),
      requireSize(cylinder.lz, name, "height of the cylinder"));
}

template <typename S>
ConvexShape shapeOf(const Convex<S>& convex, const std::string& name, double) {
  std::vector<Vec> points;
  for (const Vector3<S>& p : convex.getVertices())
    points.push_back(requirePoint(p, name, "convex"));
  if (points.empty()) throw Exception(name + ": the convex has no vertices. Give some");
  return ConvexShape::hull(std::move(points));
}

template <typename S>
ConvexShape shapeOf(const TriangleP<S>& triangle, const std::string& name, double) {
  return ConvexShape::hull({requirePoint(triangle.a, name, "triangle"),
                            requirePoint(triangle.b, name, "triangle"),
                            requirePoint(triangle.c, name, "triangle")});
}

/// @param flat  FCL's plane or halfspace
template <typename Flat>
ConvexShape flatShape(const Flat& flat, bool is_solid, const std::string& name,
                      double other_radius) {
  Vec normal = {static_cast<double>(flat.n[0]), static_cast<double>(flat.n[1]),
                static_cast<double>(flat.n[2])};
  auto offset = static_cast<double>(flat.d);
  // Where the square of the normal would leave the range of numbers.
  const double size = maxNorm(normal);
  if ((size > 0 && size < kLeastLength) || (size > 1 / kLeastLength && size <= DBL_MAX)) {
    const double scale = std::ldexp(1, std::min(1000, -std::ilogb(size)));
    normal = scale * normal;
    offset *= scale;
  }
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(offset))
    throw Exception(name + ": the normal of the " + (is_solid ? "halfspace" : "plane") +
                    " is zero, or one of its numbers is not finite. Give a unit normal "
                    "and a finite offset");
  return ConvexShape::flat({(1 / length) * normal, offset / length, is_solid},
                           other_radius);
}

template <typename S>
ConvexShape shapeOf(const Plane<S>& plane, const std::string& name, double other_radius) {
  return flatShape(plane, false, name, other_radius);
}

template <typename S>
ConvexShape shapeOf(const Halfspace<S>& halfspace, const std::string& name,
                    double other_radius) {
  return flatShape(halfspace, true, name, other_radius);
}

/// Calls use(shape) with a geometry as its own class, or otherwise() if it is none of
/// these. A new class of shapes is a line here, and shapeOf().
/// @return what that returns
template <typename S, typename Use, typename Otherwise>
auto asItsClass(const CollisionGeometry<S>& o, Use&& use, Otherwise&& otherwise) {
  // A model that deforms has no node type while FCL's tree is out of date.
  if (o.getObjectType() != OT_GEOM) return otherwise();
  switch (o.getNodeType()) {
    case GEOM_SPHERE:
      return use(static_cast<const Sphere<S>&>(o));
    case GEOM_CAPSULE:
      return use(static_cast<const Capsule<S>&>(o));
    case GEOM_BOX:
      return use(static_cast<const Box<S>&>(o));
    case GEOM_ELLIPSOID:
      return use(static_cast<const Ellipsoid<S>&>(o));
    case GEOM_CONE:
      return use(static_cast<const Cone<S>&>(o));
    case GEOM_CYLINDER:
      return use(static_cast<const Cylinder<S>&>(o));
    case GEOM_CONVEX:
      return use(static_cast<const Convex<S>&>(o));
    case GEOM_TRIANGLE:
      return use(static_cast<const TriangleP<S>&>(o));
    case GEOM_PLANE:
      return use(static_cast<const Plane<S>&>(o));
    case GEOM_HALFSPACE:
      return use(static_cast<const Halfspace<S>&>(o));
    default:
      return otherwise();
  }
}

}  // namespace

template <typename S>
bool isConvexShape(const CollisionGeometry<S>& geometry) {
  return asItsClass(
      geometry, [](const auto&) { return true; }, [] { return false; });
}

template <typename S>
bool isUnbounded(const CollisionGeometry<S>& shape) {
  return isConvexShape(shape) &&
         (shape.getNodeType() == GEOM_PLANE || shape.getNodeType() == GEOM_HALFSPACE);
}

template <typename S>
ConvexShape convexShapeOf(const CollisionGeometry<S>& shape, const std::string& name,
                          double other_radius) {
  return asItsClass(
      shape, [&](const auto& of) { return shapeOf(of, name, other_radius); },
      [&]() -> ConvexShape {
        throw Exception(name + " is a geometry of node type " +
                        std::to_string(shape.getNodeType()) +
                        ", which is none of FCL's shapes. Give one of them, or a mesh of "
                        "its surface");
      });
}

#define FCL_CCD_INSTANTIATE(S)                                                        \
  template bool isConvexShape(const CollisionGeometry<S>&);                           \
  template bool isUnbounded(const CollisionGeometry<S>&);                             \
  template ConvexShape convexShapeOf(const CollisionGeometry<S>&, const std::string&, \
                                     double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

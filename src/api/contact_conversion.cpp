// SPDX-License-Identifier: BSD-3-Clause
#include "api/contact_conversion.h"
#include "elementary/distance_advance.h"
#include "elementary/elementary.h"

#include <algorithm>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

template <typename S>
Vector3<S> toVector(const double (&v)[3]) {
  return {static_cast<S>(v[0]), static_cast<S>(v[1]), static_cast<S>(v[2])};
}

/// The contact without geometry.
template <typename S>
ContinuousContact<S> toNumbers(const FeatureContact& contact) {
  ContinuousContact<S> out;
  out.kind = contact.kind;
  out.b1 = contact.triangles[0];
  out.b2 = contact.triangles[1];
  for (std::size_t i = 0; i < 4; ++i)
    out.vertices[i] = static_cast<int>(contact.vertices[i]);
  out.first_on_o1 = contact.first_on_a;
  out.toc_lo = contact.toc_lo;
  out.toc_hi = contact.toc_hi;
  return out;
}

/// @param path_of  path_of(on_a, id) returns the path of a vertex of mesh a, or of b
/// @param t  the time of contact on these paths
template <typename S, typename PathOf>
void addGeometry(const FeatureContact& contact, const PathOf& path_of, double t,
                 bool at_distance, ContinuousContact<S>& out) {
  const std::size_t num_first = contact.kind == ContinuousContactKind::kEdgeEdge ? 2 : 1;
  VertexPath x[4]{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(out.numVertices()); ++i)
    x[i] = path_of((i < num_first) == contact.first_on_a, contact.vertices[i]);
  double position[3], normal[3];
  (at_distance ? distanceGeometry : contactGeometry)(
      contact.kind, FeaturePoints{{&x[0], &x[1], &x[2], &x[3]}}, t, position, normal);
  out.pos = toVector<S>(position);
  out.normal = toVector<S>(normal);
  if (!contact.first_on_a) out.normal = -out.normal;
}

}  // namespace

template <typename S>
ContinuousContact<S> toContinuousContact(const FeatureContact& contact,
                                         const MeshInstance& a, const MeshInstance& b,
                                         bool with_geometry, bool at_distance) {
  ContinuousContact<S> out = toNumbers<S>(contact);
  const auto path_of = [&](bool on_a, std::uint32_t id) {
    return (on_a ? a : b).frames[id];
  };
  out.within_tolerance =
      at_distance && contact.toc_lo > 0 && contact.toc_hi == contact.toc_lo;
  if (with_geometry) addGeometry(contact, path_of, contact.toc_lo, at_distance, out);
  return out;
}

template <typename S>
ContinuousContact<S> toContinuousContact(const FeatureContact& contact,
                                         const PreparedMotion& a, const PreparedMotion& b,
                                         bool with_geometry, bool at_distance) {
  ContinuousContact<S> out = toNumbers<S>(contact);
  const auto path_of = [&](bool on_a, std::uint32_t id) {
    return (on_a ? a : b).tangentAt(id, contact.toc_lo);
  };
  out.within_tolerance =
      contact.toc_hi == contact.toc_lo && !(at_distance && contact.toc_lo == 0);
  if (with_geometry) addGeometry(contact, path_of, 0, at_distance, out);
  return out;
}

template <typename S>
ContinuousContact<S> toContinuousContact(const Crossing& crossing, const MeshInstance& a,
                                         const MeshInstance& b, bool with_geometry) {
  ContinuousContact<S> out;
  out.kind = ContinuousContactKind::kCrossing;
  out.b1 = crossing.triangles[0];
  out.b2 = crossing.triangles[1];
  for (std::size_t i = 0; i < 2; ++i)
    out.vertices[i] = static_cast<int>(crossing.edge[i]);
  for (std::size_t i = 0; i < 3; ++i)
    out.vertices[i + 2] = static_cast<int>(crossing.face[i]);
  out.first_on_o1 = crossing.first_on_a;
  if (!with_geometry) return out;

  const MeshInstance &first = crossing.first_on_a ? a : b,
                     &second = crossing.first_on_a ? b : a;
  double point[5][3];
  for (std::size_t i = 0; i < 5; ++i)
    (i < 2 ? first : second)
        .frames.at(0, i < 2 ? crossing.edge[i] : crossing.face[i - 2], point[i]);
  const auto vec = [&point](int i) { return toVector<double>(point[i]); };
  // Scaled so that no product of tiny or huge meshes leaves the range of numbers.
  const auto scaled = [](const Vector3<double>& v) -> Vector3<double> {
    const double size = v.cwiseAbs().maxCoeff();
    if (!(size > 0) || !std::isfinite(size)) return v;
    return v * std::ldexp(1, std::min(-std::ilogb(size), 1000));
  };
  const Vector3<double> edge = vec(1) - vec(0);
  const Vector3<double> normal =
      scaled(scaled(vec(3) - vec(2)).cross(scaled(vec(4) - vec(2))));
  const double below = (vec(0) - vec(2)).dot(normal),
               above = (vec(1) - vec(2)).dot(normal);
  // The ends are on different sides. For an edge in the plane it is the middle.
  const double s = above != below ? below / (below - above) : 0.5;
  out.pos = (vec(0) + std::min(std::max(s, 0.), 1.) * edge).template cast<S>();
  const double length = normal.norm();
  if (length > 0 && std::isfinite(length))
    out.normal = (normal / length).template cast<S>();
  return out;
}

template <typename S>
ContinuousContact<S> toContinuousContact(const ShapeContact& contact,
                                         bool with_geometry) {
  ContinuousContact<S> out;
  out.kind = contact.kind;
  out.first_on_o1 = contact.mesh_is_first;
  out.b1 = contact.triangles[0];
  out.b2 = contact.triangles[1];
  std::copy(contact.vertices, contact.vertices + 3, out.vertices.begin());
  out.toc_lo = contact.toc_lo;
  out.toc_hi = contact.toc_hi;
  out.within_tolerance = contact.within_tolerance;
  if (!with_geometry) return out;
  const auto vector = [](const Vec& v) -> Vector3<S> {
    return {static_cast<S>(v.x), static_cast<S>(v.y), static_cast<S>(v.z)};
  };
  out.pos = vector(contact.position);
  out.normal = vector(contact.normal);
  return out;
}

template <typename S>
Contact<S> toContact(const ContinuousContact<S>& contact) {
  Contact<S> out(contact.o1, contact.o2, static_cast<int>(contact.b1),
                 static_cast<int>(contact.b2));
  out.pos = contact.pos;
  out.normal = contact.normal;
  out.penetration_depth = 0;
  return out;
}

template <typename S>
S roundTimeDown(double t) {
  const auto rounded = static_cast<S>(t);
  return static_cast<double>(rounded) > t ? std::nextafter(rounded, S(0)) : rounded;
}

template <typename S>
S roundTimeUp(double t) {
  const auto rounded = static_cast<S>(t);
  return static_cast<double>(rounded) < t ? std::nextafter(rounded, S(1)) : rounded;
}

#define FCL_CCD_INSTANTIATE(S)                                                          \
  template ContinuousContact<S> toContinuousContact(                                    \
      const FeatureContact&, const MeshInstance&, const MeshInstance&, bool, bool);     \
  template ContinuousContact<S> toContinuousContact(                                    \
      const FeatureContact&, const PreparedMotion&, const PreparedMotion&, bool, bool); \
  template ContinuousContact<S> toContinuousContact(                                    \
      const Crossing&, const MeshInstance&, const MeshInstance&, bool);                 \
  template ContinuousContact<S> toContinuousContact(const ShapeContact&, bool);         \
  template Contact<S> toContact(const ContinuousContact<S>&);                           \
  template S roundTimeDown<S>(double);                                                  \
  template S roundTimeUp<S>(double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

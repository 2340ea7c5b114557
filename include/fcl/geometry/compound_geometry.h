// SPDX-License-Identifier: BSD-3-Clause
//
// A body that is made of several geometries.
#ifndef FCL_GEOMETRY_COMPOUND_GEOMETRY_H
#define FCL_GEOMETRY_COMPOUND_GEOMETRY_H

#include <memory>

#include "fcl/ccd_version.h"
#include "fcl/geometry/collision_geometry.h"
#include "fcl/math/motion/detail/followed_motion.h"

namespace fcl {

namespace detail {
template <typename S>
struct CompoundParts;
}  // namespace detail

/// @brief One body of several geometries, each in its own place: a link of a robot, a
/// vehicle of boxes. The @ref continuous_queries take it as any other geometry, with one
/// motion for all parts, and so do ContinuousCollisionManager, CollisionRobot and
/// continuousDistance(). Contacts name the parts (ContinuousContact::part1, part2).
///
/// A part is a mesh whose frames are equal, a shape or an octree. It moves as the pose of
/// the body times its offset. On straight paths both products, at t = 0 and at t = 1, are
/// rounded to doubles: the answer is that for the part between these poses. Parts may
/// overlap each other, and are not tested with each other.
///
/// FCL's own functions do not know this class. Its type is OT_GEOM and BV_UNKNOWN:
/// collide() and distance() print that they do not support it, and find nothing. It has a
/// box, so that FCL's managers of objects find it.
///
/// The compound reads a geometry when it is added. After a change of one call update().
/// Copies are independent and share the geometries.
///
/// Thread-safety: queries may share it while it does not change.
///
/// @tparam S  double or float, as of the geometries. Offsets are doubles.
template <typename S>
class FCL_EXPORT CompoundGeometry final : public CollisionGeometry<S> {
 public:
  using Geometry = std::shared_ptr<const CollisionGeometry<S>>;

  /// @brief Without parts. A query refuses it.
  CompoundGeometry();
  CompoundGeometry(const CompoundGeometry& other);
  CompoundGeometry& operator=(const CompoundGeometry& other);
  ~CompoundGeometry() override;

  /// @brief Adds a geometry.
  /// @param offset  the frame of the geometry in that of the body. A rotation up to 2^-6
  /// is replaced by the nearest one.
  /// @return the number of the part: 0, 1, ...
  /// @throws fcl::Exception  the geometry is null, a compound, a mesh that deforms, a
  /// point cloud or of a class of the program; a mesh is not built; a number is not
  /// finite; the offset is no rotation and translation. Then nothing has changed.
  // A template, so that it is compiled with the program: see query_numbers.h.
  template <typename T = double>
  int addPart(const Geometry& geometry,
              const Transform3<T>& offset = Transform3<T>::Identity()) {
    return addPlaced(geometry, detail::placementOf(offset));
  }

  /// @brief Reads all geometries again. @throws fcl::Exception  as addPart()
  void update();

  int numParts() const;
  /// @brief The geometry of a part. @throws fcl::Exception  there is no such part
  const Geometry& part(int number) const;
  /// @brief Where a part is in the frame of the body.
  /// @throws fcl::Exception  there is no such part
  BoundedMotion::Placement offset(int number) const;

  OBJECT_TYPE getObjectType() const override;
  NODE_TYPE getNodeType() const override;
  /// @brief Sets the box to that of all parts. FCL's objects call it.
  void computeLocalAABB() override;

  /// @brief For the library.
  const detail::CompoundParts<S>& parts() const { return *parts_; }

 private:
  int addPlaced(const Geometry& geometry, const BoundedMotion::Placement& offset);

  std::shared_ptr<const detail::CompoundParts<S>> parts_;
};

using CompoundGeometryf = CompoundGeometry<float>;
using CompoundGeometryd = CompoundGeometry<double>;

extern template class CompoundGeometry<double>;
extern template class CompoundGeometry<float>;

}  // namespace fcl

#endif

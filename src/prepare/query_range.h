// SPDX-License-Identifier: BSD-3-Clause
//
// The sizes of a pair on curved paths, or with a shape or an octree, for which products
// of lengths neither overflow nor underflow.
#ifndef FCL_CCD_PREPARE_QUERY_RANGE_H
#define FCL_CCD_PREPARE_QUERY_RANGE_H

#include "fcl/narrowphase/detail/query_numbers.h"
#include "prepare/prepared_motion.h"

namespace fcl {
namespace detail {

/// @brief The power of two by which the lengths of two shapes, and of their paths, are to
/// be multiplied, so that products of lengths are in the range of doubles; 1 as a rule.
/// @param motion1, motion2  prepared without a scale
/// (Other bodies, and paths of motions of the program, are not scaled.)
/// @throws fcl::Exception  as the two functions below, where they are not scaled
template <typename S>
double scaleOf(const MovingGeometry<S>& o1, const deformable::PreparedMotion& motion1,
               const MovingGeometry<S>& o2, const deformable::PreparedMotion& motion2,
               double distance);

/// @brief Whether the path of a shape is so far inside the range that PreparedMotion
/// refuses none, and scaleOf() is 1 without a distance.
/// @pre its poses are rotations; it has no reference point and no control points
template <typename S>
bool isWellInRange(const PlacedGeometry<S>& o, const deformable::ConvexShape& shape);

/// @brief The same path with all its lengths multiplied.
template <typename S>
MovingGeometry<S> scaledPath(const MovingGeometry<S>& o, double factor);

/// @brief Refuses two bodies for which products of lengths overflow. (Where they
/// underflow, contacts can be reported early, never late.)
/// @throws fcl::Exception
void requireProvenRange(const deformable::PreparedMotion& motion1,
                        const deformable::PreparedMotion& motion2);

/// @brief Refuses two bodies that are so small that squares of lengths underflow. Boxes
/// leave out triangles then, also those that FCL's tree has.
/// @throws fcl::Exception
void requireLeastSize(const deformable::PreparedMotion& motion1,
                      const deformable::PreparedMotion& motion2);

}  // namespace detail
}  // namespace fcl

#endif

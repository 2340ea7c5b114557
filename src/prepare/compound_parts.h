// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_COMPOUND_PARTS_H
#define FCL_CCD_PREPARE_COMPOUND_PARTS_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/collision_geometry.h"
#include "mesh/vertex_frames.h"
#include "shapes/body_boxes.h"

namespace fcl {
namespace detail {

class DeformableMesh;

/// @brief The parts of a compound, as they were read.
template <typename S>
struct CompoundParts {
  struct Part {
    std::shared_ptr<const CollisionGeometry<S>> geometry;
    /// Its frame in that of the compound.
    deformable::Pose offset;
    /// In the frame of the compound. Planes and halfspaces have none.
    bool has_box;
    deformable::BodyBox box;
    /// A DeformableBVHModel, and its revision when it was read; null for others.
    const DeformableMesh* model;
    std::uint64_t revision;
  };
  std::vector<Part> parts;
  /// Of all parts.
  bool has_box{true};
  deformable::BodyBox box{};
};

/// @brief Null: the geometry is no compound.
template <typename S>
const CompoundParts<S>* compoundPartsOf(const CollisionGeometry<S>& o);

/// @brief Refuses a compound without parts, or with a part that it has to read again.
/// @param name  of the compound in errors
template <typename S>
void requireParts(const CompoundParts<S>& compound, const std::string& name);

/// @brief Refuses a mesh that deforms.
/// @param name  of the part in errors
template <typename S>
void requireRigidPart(const CollisionGeometry<S>& part, const std::string& name);

}  // namespace detail
}  // namespace fcl

#endif

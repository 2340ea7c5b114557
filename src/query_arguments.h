// SPDX-License-Identifier: BSD-3-Clause
//
// What the public queries of scenes share: their arguments and their errors.
#ifndef FCL_CCD_SRC_QUERY_ARGUMENTS_H
#define FCL_CCD_SRC_QUERY_ARGUMENTS_H

#include <limits>
#include <string>

#include "fcl/common/exception.h"
#include "fcl/common/types.h"
#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/detail/deformable/feature_batch.h"
#include "fcl/narrowphase/detail/deformable/prepared_mesh.h"

namespace fcl {
namespace detail {

/// Poses at t = 0 and t = 1.
template <typename S>
struct Placement {
  Transform3<S> beginning;
  Transform3<S> end;

  bool isRotating() const { return beginning.linear() != end.linear(); }
};

/// Rotations are made of quaternions and products: one that stays the same may differ at
/// the end, by a few roundings (one as a rule).
template <typename S>
bool isConstantRotation(const Placement<S>& placement) {
  constexpr S kRounding = 8 * std::numeric_limits<S>::epsilon();
  return ((placement.end.linear() - placement.beginning.linear()).array().abs() <=
          kRounding)
      .all();
}

/// The placement of a rigid mesh with one rotation, if it is constant.
template <typename S>
Placement<S> withoutRounding(const CollisionGeometry<S>& o, Placement<S> placement) {
  if (isConstantRotation(placement) &&
      deformable::meshKindOf(o) == deformable::MeshKind::kRigid)
    placement.end.linear() = placement.beginning.linear();
  return placement;
}

inline void require(const void* argument, const char* name) {
  if (!argument) throw Exception(std::string(name) + " is null");
}

template <typename S>
void requireFinite(const Placement<S>& placement, const char* name) {
  for (const Transform3<S>* tf : {&placement.beginning, &placement.end})
    if (!tf->linear().allFinite() || !tf->translation().allFinite())
      throw Exception(std::string(name) + ": the transform is not finite");
}

template <typename S>
void requireMesh(const CollisionGeometry<S>& o, const char* function) {
  if (deformable::meshKindOf(o) == deformable::MeshKind::kNotAMesh)
    throw Exception(std::string(function) + ": the geometry is not a triangle mesh");
}

/// What errors say of a pair for which isAnsweredHere() is false.
constexpr const char* kNotAnsweredHere =
    " of continuous collision need two triangle meshes that deform or translate";

template <typename S>
bool areMeshes(const CollisionGeometry<S>& o1, const CollisionGeometry<S>& o2) {
  return deformable::meshKindOf(o1) != deformable::MeshKind::kNotAMesh &&
         deformable::meshKindOf(o2) != deformable::MeshKind::kNotAMesh;
}

/// Of a pair for which isAnsweredHere() is false (a rotation that is not finite counts as
/// one); the others are PreparedMesh's, and what is no mesh is FCL's.
template <typename S>
void requireFinite(const CollisionGeometry<S>& o1, const Placement<S>& placement1,
                   const CollisionGeometry<S>& o2, const Placement<S>& placement2) {
  if (!areMeshes(o1, o2)) return;
  requireFinite(placement1, "o1");
  requireFinite(placement2, "o2");
}

/// Whether the pair is answered by this library and not left to FCL.
template <typename S>
bool isAnsweredHere(const CollisionGeometry<S>& o1, bool rotates1,
                    const CollisionGeometry<S>& o2, bool rotates2) {
  const auto accepts = [](const CollisionGeometry<S>& o, bool rotates) {
    const deformable::MeshKind kind = deformable::meshKindOf(o);
    return kind == deformable::MeshKind::kDeforming ||
           (kind == deformable::MeshKind::kRigid && !rotates);
  };
  return accepts(o1, rotates1) && accepts(o2, rotates2);
}

/// Runs a query; what it finds wrong with a vertex becomes FCL's exception.
template <typename Query>
auto answerOf(Query&& query) {
  try {
    return query();
  } catch (const deformable::NonFiniteVertex& error) {
    throw Exception(error.what());
  }
}

}  // namespace detail
}  // namespace fcl

#endif

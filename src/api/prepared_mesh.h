// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_API_PREPARED_MESH_H
#define FCL_CCD_API_PREPARED_MESH_H

#include <string>
#include <vector>

#include "fcl/geometry/collision_geometry.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief How a geometry moves, as far as the choice of the method needs it.
enum class MeshKind {
  kNotAMesh,   ///< a shape, an octree, a point cloud
  kRigid,      ///< a triangle mesh with one frame
  kDeforming,  ///< a triangle mesh whose two frames differ
};

/// @brief Whether every mesh must have feature owners.
enum class FeatureOwners {
  kIfKept,  ///< not a rigid mesh that brings none
  kAlways   ///< of such a mesh they are computed, in time and memory linear in its
            ///< triangles
};

template <typename S>
MeshKind meshKindOf(const CollisionGeometry<S>& geometry);

/// @throws fcl::Exception that calls the geometry `name`, when a number is not finite
void requireFinite(const Pose& beginning, const Pose& end, const std::string& name);

/// @brief A geometry made ready for one query, with what had to be computed for it:
/// nothing for a DeformableBVHModel that is only translated and for a rigid mesh (but see
/// FeatureOwners); owners and boxes for a plain BVHModel in FCL's updated state, and for
/// a rigid mesh whose tree is not sound (RigidTree::isSound()); boxes for a rotated
/// DeformableBVHModel.
class PreparedMesh {
 public:
  /// @param name  how errors call the geometry, for example "o1"
  /// @param num_threads  for boxes, as in parallelFor(); the mesh does not depend on it
  /// @pre the floating-point mode is the default one; meshKindOf(geometry) != kNotAMesh;
  /// a rigid mesh is not rotated between the poses
  /// @throws fcl::Exception  model not built or being updated, or too large, pose or
  /// frame not finite, vertex index out of range, a vertex that leaves the range of
  /// double in its pose (not of a rigid mesh, whose vertices are not looked at)
  template <typename S>
  PreparedMesh(const CollisionGeometry<S>& geometry, const Pose& beginning,
               const Pose& end, const std::string& name, int num_threads = 1,
               FeatureOwners owners = FeatureOwners::kIfKept);

  PreparedMesh(const PreparedMesh&) = delete;
  PreparedMesh& operator=(const PreparedMesh&) = delete;

  const MeshInstance& instance() const { return instance_; }

  /// @brief Seconds that boxes, owners and a tree took, if they had to be made.
  double updateTime() const { return update_time_; }

 private:
  template <typename BV>
  void prepareModel(const BVHModel<BV>& model, const Pose& beginning, const Pose& end,
                    const std::string& name, int num_threads, FeatureOwners owners);
  template <typename BV>
  static void requireIndices(const BVHModel<BV>& model, const std::string& name);
  template <typename BV>
  void prepareDeforming(const BVHModel<BV>& model, const std::string& name,
                        int num_threads);
  void refit(const std::string& name, int num_threads);
  template <typename Work>
  void measure(Work&& work);

  MeshInstance instance_;
  std::vector<MeshTriangle> owners_;
  MovingKdopTree tree_;
  double update_time_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

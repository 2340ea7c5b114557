// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_PREPARED_MESH_H
#define FCL_CCD_PREPARE_PREPARED_MESH_H

#include <string>
#include <vector>

#include "fcl/geometry/collision_geometry.h"
#include "tree/mesh_instance.h"

namespace fcl {

template <typename BV>
class BVHModel;

namespace detail {

class DeformableMesh;

namespace deformable {

/// @brief How a geometry moves. The choice of the method depends on it.
enum class MeshKind {
  kNotAMesh,   ///< a shape, an octree, a point cloud
  kRigid,      ///< a triangle mesh with one frame
  kDeforming,  ///< a triangle mesh whose two frames differ
};

/// @brief Which meshes get feature owners.
enum class FeatureOwners {
  kIfKept,  ///< only meshes that have them already
  kAlways   ///< all; for a rigid BVHModel they are computed, in time and memory linear
            ///< in its triangles
};

/// @brief What a query asks of the class of a geometry.
struct MeshClass {
  MeshKind kind;
  /// A DeformableBVHModel whose moving tree is up to date; null otherwise.
  const DeformableMesh* model;
};

template <typename S>
MeshClass meshClassOf(const CollisionGeometry<S>& geometry);

template <typename S>
MeshKind meshKindOf(const CollisionGeometry<S>& geometry) {
  return meshClassOf(geometry).kind;
}

/// @brief The number of triangles of a geometry; 0 if it is no mesh.
template <typename S>
std::size_t numTrianglesOf(const CollisionGeometry<S>& geometry);

/// @throws fcl::Exception when a number is not finite; the text names the geometry `name`
void requireFinite(const Pose& beginning, const Pose& end, const std::string& name);

/// @brief A geometry made ready for one query. It owns what had to be computed:
/// - nothing for a DeformableBVHModel that is only translated;
/// - nothing for a rigid mesh, but see FeatureOwners;
/// - boxes for a DeformableBVHModel that is rotated;
/// - owners and boxes for a plain BVHModel in FCL's updated state, and for a rigid mesh
///   whose tree is not known to be sound (isTreeSound()).
class PreparedMesh {
 public:
  /// @param name  the name of the geometry in errors, for example "o1"
  /// @param num_threads  for boxes, as in parallelFor(); the mesh does not depend on it
  /// @pre the floating-point mode is the default one; meshKindOf(geometry) != kNotAMesh;
  /// a rigid mesh has the same rotation in both poses
  /// @throws fcl::Exception  when the model is not built, is being updated or is too
  /// large; when a pose or a frame is not finite; when a vertex index is out of range;
  /// when the pose moves a vertex out of the range of double (vertices of a rigid mesh
  /// are not checked here)
  template <typename S>
  PreparedMesh(const CollisionGeometry<S>& geometry, const Pose& beginning,
               const Pose& end, const std::string& name, int num_threads = 1,
               FeatureOwners owners = FeatureOwners::kIfKept);

  PreparedMesh(const PreparedMesh&) = delete;
  PreparedMesh& operator=(const PreparedMesh&) = delete;

  const MeshInstance& instance() const { return instance_; }

  /// @brief Seconds that the boxes, owners and tree of this query took; 0 if none were
  /// made.
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

  const std::string name_;
  MeshInstance instance_;
  std::vector<MeshTriangle> owners_;
  MovingKdopTree tree_;
  double update_time_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

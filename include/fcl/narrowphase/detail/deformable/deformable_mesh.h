// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_DEFORMABLE_MESH_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_DEFORMABLE_MESH_H

#include <cstddef>
#include <vector>

#include "fcl/narrowphase/detail/deformable/mesh_topology.h"
#include "fcl/narrowphase/detail/deformable/moving_kdop_tree.h"
#include "fcl/narrowphase/detail/deformable/vertex_frames.h"

namespace fcl {
namespace detail {

/// @brief The part of a DeformableBVHModel that does not depend on its BV: feature
/// owners, moving tree, and what a query must know of the model's state.
class DeformableMesh {
 public:
  virtual ~DeformableMesh() = default;

  const deformable::MovingKdopTree& movingTree() const { return tree_; }

  /// @brief Whether a vertex differs between the two frames.
  bool isDeforming() const { return is_deforming_; }

  /// @brief As given to setNumThreads().
  int numThreads() const { return num_threads_; }

  /// @brief How many updates since the build have made parts of the tree anew.
  std::size_t numRestructurings() const { return num_restructurings_; }

  /// @brief Whether an update or replacement has begun and not ended.
  bool isUpdateOpen() const { return open_ != Open::kNone; }

  /// @brief Whether the moving tree describes the base model's arrays as they are now;
  /// false when they were changed through a reference to the base class.
  virtual bool isInStep() const = 0;

  /// @brief The two frames, model coordinates; only while in step.
  virtual deformable::VertexFrames frames() const = 0;

 protected:
  enum class Open { kNone, kUpdate, kReplace };

  DeformableMesh() = default;
  DeformableMesh(const DeformableMesh&) = default;
  DeformableMesh(DeformableMesh&&) = default;
  DeformableMesh& operator=(const DeformableMesh&) = default;
  DeformableMesh& operator=(DeformableMesh&&) = default;

  /// @brief Owners and tree structure anew, for triangles that have been checked.
  void buildTree(const Triangle* triangles, std::size_t num_triangles,
                 const deformable::VertexFrames& frames);

  /// @brief Boxes for a pair of frames, in a tree whose aged parts are made anew.
  void refitTree(const deformable::VertexFrames& frames);

  /// @brief Tree and owners for triangles that have been checked, as
  /// MovingKdopTree::changeTopology(); without boxes.
  void changeTopology(const Triangle* triangles, std::size_t num_triangles,
                      const std::vector<int>& origins,
                      const deformable::VertexFrames& frames);

  /// @brief Boxes for a pair of frames after a change of topology.
  void refitChangedTree(const deformable::VertexFrames& frames);

  std::size_t treeMemUsage() const;

  Open open_{Open::kNone};
  int num_threads_{1};

 private:
  deformable::MovingKdopTree tree_;
  std::size_t num_restructurings_{0};
  bool is_deforming_{false};
};

}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <memory>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "mesh/vertex_frames.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {

DeformableMesh::DeformableMesh()
    : tree_(std::make_unique<deformable::MovingKdopTree>()) {}

DeformableMesh::~DeformableMesh() = default;

DeformableMesh::DeformableMesh(const DeformableMesh& other)
    : open_(other.open_),
      num_threads_(other.num_threads_),
      tree_(std::make_unique<deformable::MovingKdopTree>(*other.tree_)),
      num_restructurings_(other.num_restructurings_),
      is_deforming_(other.is_deforming_) {}

DeformableMesh& DeformableMesh::operator=(DeformableMesh&& other) noexcept = default;

void DeformableMesh::buildTree(const Triangle* triangles, std::size_t num_triangles,
                               const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  deformable::inArena(num_threads_, [&] {
    tree_->build(triangles, num_triangles, frames, num_threads_);
  });
  num_restructurings_ = 0;
}

void DeformableMesh::changeTopology(const Triangle* triangles, std::size_t num_triangles,
                                    const std::vector<int>& origins,
                                    const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  deformable::inArena(num_threads_, [&] {
    tree_->changeTopology(triangles, num_triangles, origins, frames, num_threads_);
  });
}

void DeformableMesh::refitTree(const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  num_restructurings_ += tree_->restructure();
  refitChangedTree(frames);
}

void DeformableMesh::refitChangedTree(const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  deformable::inArena(num_threads_, [&] { tree_->refit(frames, num_threads_); });
  is_deforming_ = false;
  if (frames.isStill()) return;
  for (std::size_t i = 0; i < frames.size() && !is_deforming_; ++i) {
    const deformable::VertexPath path = frames[i];
    for (int k = 0; k < 3; ++k) is_deforming_ |= path.t0[k] != path.t1[k];
  }
}

std::size_t DeformableMesh::treeMemUsage() const { return tree_->memUsage(); }

}  // namespace detail
}  // namespace fcl

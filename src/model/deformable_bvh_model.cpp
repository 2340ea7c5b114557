// SPDX-License-Identifier: BSD-3-Clause
//
// Copies of a model, and its answers about itself. Builds and updates are in
// deformable_bvh_model_update.cpp, the state in model_state.cpp, and the checks of the
// input in deformable_mesh.cpp.
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "mesh/vertex_frames.h"
#include "model/coordinate_arrays.h"
#include "model/model_instances.h"
#include "model/per_thread_fitting.h"

namespace fcl {

template <typename BV>
DeformableBVHModel<BV>::DeformableBVHModel() {
  fitPerThread();
}

template <typename BV>
DeformableBVHModel<BV>::~DeformableBVHModel() = default;

template <typename BV>
DeformableBVHModel<BV>::DeformableBVHModel(const DeformableBVHModel& other)
    : Base(copyable(other)), detail::DeformableMesh(other), staged_(other.staged_) {
  fitPerThread();
  if (this->build_state == BVH_BUILD_STATE_BEGUN && this->num_vertices == 0) makeRoom();
  state_ = other.state_.ofCopy(other.arrays(), arrays());
  assert(isInStep() == other.isInStep());
}

template <typename BV>
const BVHModel<BV>& DeformableBVHModel<BV>::copyable(const DeformableBVHModel& model) {
  model.checkCopy();
  return model;
}

/// FCL's copy of a model that has begun has room for exactly the vertices that are there,
/// and doubles this room when more come. A copy without vertices would never have room:
/// it gets memory here.
template <typename BV>
void DeformableBVHModel<BV>::makeRoom() {
  assert(this->num_vertices == 0);
  delete[] std::exchange(this->vertices, nullptr);
  const std::unique_ptr<Triangle[]> triangles(std::exchange(this->tri_indices, nullptr));
  this->build_state = BVH_BUILD_STATE_EMPTY;
  if (Base::beginModel(this->num_tris) != BVH_OK) throw std::bad_alloc();
  std::copy_n(triangles.get(), this->num_tris, this->tri_indices);
}

template <typename BV>
DeformableBVHModel<BV>& DeformableBVHModel<BV>::operator=(
    const DeformableBVHModel& other) {
  if (this == &other) return *this;
  // Nothing throws after the swap.
  DeformableBVHModel copy(other);
  swapBase(copy);
  detail::DeformableMesh::operator=(std::move(static_cast<DeformableMesh&>(copy)));
  staged_ = std::move(copy.staged_);
  return *this;
}

// FCL's own assignment copies pointers, also the private ones. That is wrong for users,
// and right for a swap: after its three steps no array is shared.
template <typename BV>
void DeformableBVHModel<BV>::swapBase(Base& other) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-copy"
  const Base empty;
  Base held;
  held = *this;
  Base::operator=(other);
  other = held;
  held = empty;
#pragma GCC diagnostic pop
}

template <typename BV>
detail::ModelArrays DeformableBVHModel<BV>::arrays() const {
  return {this->vertices,     this->prev_vertices, this->tri_indices,
          this->num_vertices, this->num_tris,      this->build_state};
}

template <typename BV>
bool DeformableBVHModel<BV>::isInStep() const {
  return phase() == Phase::kInStep;
}

/// Brings the base class into the state of a model that is built.
template <typename BV>
void DeformableBVHModel<BV>::seal() {
  this->build_state = state_.builtState();
  state_.seal(arrays());
}

template <typename BV>
detail::deformable::VertexFrames DeformableBVHModel<BV>::frames() const {
  assert(this->prev_vertices && this->vertices && this->num_vertices > 0);
  return {this->prev_vertices->data(), this->vertices->data(),
          static_cast<std::size_t>(this->num_vertices)};
}

template <typename BV>
int DeformableBVHModel<BV>::checkFrames(const S* previous, const S* current,
                                        std::size_t num_vertices) {
  if (const int code = checkFinite(previous, num_vertices, "previous")) return code;
  return checkFinite(current, num_vertices, "current");
}

template <typename BV>
int DeformableBVHModel<BV>::setNumThreads(int num_threads) {
  return allowThreads(num_threads);
}

template <typename BV>
bool DeformableBVHModel<BV>::isFclTreeUpToDate() const {
  return this->getNumBVs() > 0 && !hasFree() && !isFclTreeBehind();
}

template <typename BV>
Primitive DeformableBVHModel<BV>::primitive(std::intptr_t b) const {
  auto index = static_cast<std::size_t>(b);
  const auto num_triangles = static_cast<std::size_t>(this->num_tris);
  if (index < num_triangles) return {PrimitiveKind::kTriangle, index};
  index -= num_triangles;
  assert(b >= 0 && index < numFreeEdges() + numFreePoints());
  if (index < numFreeEdges()) return {PrimitiveKind::kFreeEdge, index};
  return {PrimitiveKind::kFreePoint, index - numFreeEdges()};
}

template <typename BV>
const std::string& DeformableBVHModel<BV>::lastError() const {
  return last_error_;
}

template <typename BV>
std::size_t DeformableBVHModel<BV>::deformableMemUsage() const {
  return treeMemUsage() + staged_.capacity() * sizeof(staged_[0]);
}

template <typename BV>
NODE_TYPE DeformableBVHModel<BV>::getNodeType() const {
  checkDiscreteQuery(this->getNumBVs());
  return Base::getNodeType();
}

template <typename BV>
void DeformableBVHModel<BV>::computeLocalAABB() {
  // A model without beginModel() has no array.
  const S* current = this->vertices ? this->vertices->data() : nullptr;
  const bool has_previous = this->prev_vertices && !state_.isPreviousShort(arrays());
  const auto bounds = detail::deformable::boundFrames(
      has_previous ? this->prev_vertices->data() : current, current,
      static_cast<std::size_t>(this->num_vertices), numThreads());
  this->aabb_local.min_ = Vector3<S>(bounds.lo);
  this->aabb_local.max_ = Vector3<S>(bounds.hi);
  this->aabb_center = Vector3<S>(bounds.center);
  this->aabb_radius = bounds.radius;
}

template <typename BV>
void DeformableBVHModel<BV>::fitPerThread() {
  this->bv_splitter = std::make_shared<detail::PerThreadSplitter<BV>>();
  this->bv_fitter = std::make_shared<detail::PerThreadFitter<BV>>();
}

FCL_CCD_FOR_VOLUMES(FCL_CCD_INSTANTIATE_MODEL)

}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// Copies of a model, its states, and the checks of its input. Builds and updates are in
// deformable_bvh_model_update.cpp.
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include <algorithm>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "api/coordinate_arrays.h"
#include "api/model_instances.h"
#include "api/per_thread_fitting.h"
#include "fcl/common/exception.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_frames.h"

namespace fcl {

template <typename BV>
DeformableBVHModel<BV>::DeformableBVHModel() {
  fitPerThread();
}

template <typename BV>
DeformableBVHModel<BV>::~DeformableBVHModel() = default;

template <typename BV>
DeformableBVHModel<BV>::DeformableBVHModel(const DeformableBVHModel& other)
    : Base(copyable(other)),
      detail::DeformableMesh(other),
      staged_(other.staged_),
      fcl_tree_built_(other.fcl_tree_built_),
      fcl_tree_up_to_date_(other.fcl_tree_up_to_date_),
      is_changing_(other.is_changing_),
      last_error_(other.last_error_) {
  // FCL copies the nodes of the tree. A tree that is half made has fewer nodes than FCL
  // expects.
  if (isHalfUpdated())
    throw Exception(
        "DeformableBVHModel: a copy of a model whose last update failed. Give both "
        "frames "
        "to the model first, by updateFrames()");
  fitPerThread();
  if (this->build_state == BVH_BUILD_STATE_BEGUN && this->num_vertices == 0) makeRoom();
  if (other.isInStep()) seal_ = currentSeal();
  if (other.opened_ == other.currentSeal()) opened_ = currentSeal();
}

/// FCL's copy of a model that has begun has room for exactly the vertices that are there.
/// It doubles this room when more come, and twice nothing is nothing.
template <typename BV>
void DeformableBVHModel<BV>::makeRoom() {
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
  seal_ = copy.seal_;
  opened_ = copy.opened_;
  fcl_tree_built_ = copy.fcl_tree_built_;
  fcl_tree_up_to_date_ = copy.fcl_tree_up_to_date_;
  is_changing_ = copy.is_changing_;
  last_error_ = std::move(copy.last_error_);
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
int DeformableBVHModel<BV>::refuse(int code, std::string why) {
  last_error_ = std::move(why);
  return code;
}

template <typename BV>
int DeformableBVHModel<BV>::accept() {
  last_error_.clear();
  return BVH_OK;
}

template <typename BV>
bool DeformableBVHModel<BV>::Seal::operator==(const Seal& other) const {
  return vertices == other.vertices && prev_vertices == other.prev_vertices &&
         tri_indices == other.tri_indices && num_vertices == other.num_vertices &&
         num_tris == other.num_tris && build_state == other.build_state;
}

template <typename BV>
typename DeformableBVHModel<BV>::Seal DeformableBVHModel<BV>::currentSeal() const {
  return {this->vertices,     this->prev_vertices, this->tri_indices,
          this->num_vertices, this->num_tris,      this->build_state};
}

// Every change through the base class breaks the seal. An update ends in the UPDATED
// state, a replacement deletes prev_vertices, and a rebuild does both or changes the
// sizes.
template <typename BV>
bool DeformableBVHModel<BV>::isInStep() const {
  return seal_.vertices && seal_.prev_vertices && seal_ == currentSeal();
}

/// Brings the base class into the state of a model that is built.
template <typename BV>
void DeformableBVHModel<BV>::seal() {
  this->build_state = fcl_tree_built_ ? BVH_BUILD_STATE_PROCESSED : BVH_BUILD_STATE_BEGUN;
  seal_ = currentSeal();
  is_changing_ = false;
}

// A later change through the base class leaves another state.
template <typename BV>
bool DeformableBVHModel<BV>::isHalfUpdated() const {
  return is_changing_ && this->build_state == BVH_BUILD_STATE_UPDATE_BEGUN;
}

/// Whether vertices were added through the base class to a model that ended without FCL's
/// tree. The array of its previous frame has no room for them.
template <typename BV>
bool DeformableBVHModel<BV>::isPreviousShort() const {
  return this->prev_vertices && seal_.prev_vertices == this->prev_vertices &&
         seal_.num_vertices < this->num_vertices;
}

// FCL copies the same number of vertices of both frames.
template <typename BV>
const BVHModel<BV>& DeformableBVHModel<BV>::copyable(const DeformableBVHModel& model) {
  if (model.isPreviousShort())
    throw Exception(
        "DeformableBVHModel: a copy of a model to which vertices were added through its "
        "base class. Call endModel() of the model first");
  return model;
}

template <typename BV>
bool DeformableBVHModel<BV>::isBuilt() const {
  return isInStep() || isHalfUpdated() ||
         (this->vertices && this->num_tris > 0 &&
          (this->build_state == BVH_BUILD_STATE_PROCESSED ||
           this->build_state == BVH_BUILD_STATE_UPDATED));
}

template <typename BV>
detail::deformable::VertexFrames DeformableBVHModel<BV>::frames() const {
  return {this->prev_vertices->data(), this->vertices->data(),
          static_cast<std::size_t>(this->num_vertices)};
}

template <typename BV>
int DeformableBVHModel<BV>::checkFinite(const S* coordinates, std::size_t count,
                                        const char* frame) {
  const std::size_t bad =
      detail::deformable::findNotFinite(coordinates, count, num_threads_);
  if (bad == count) return BVH_OK;
  return refuse(BVH_ERR_INCORRECT_DATA, "vertex " + std::to_string(bad) + " of the " +
                                            frame + " frame is not finite");
}

template <typename BV>
int DeformableBVHModel<BV>::checkFrames(const S* previous, const S* current,
                                        std::size_t num_vertices) {
  if (const int code = checkFinite(previous, num_vertices, "previous")) return code;
  return checkFinite(current, num_vertices, "current");
}

/// Whether both frames can be given at once.
template <typename BV>
int DeformableBVHModel<BV>::checkSteppable(const char* caller) {
  const std::string name(caller);
  if (!isBuilt())
    return refuse(BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
                  name + "() on a model that is not built. Call endModel() first");
  if (isUpdateOpen())
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  name +
                      "() between begin...Model() and end...Model(). Call end...Model() "
                      "first");
  return BVH_OK;
}

template <typename BV>
int DeformableBVHModel<BV>::checkTriangles(const Triangle* triangles,
                                           std::size_t num_triangles,
                                           std::size_t num_vertices) {
  if (num_triangles == 0 || num_vertices == 0)
    return refuse(
        BVH_ERR_BUILD_EMPTY_MODEL,
        "the model has no triangles. Add some by addTriangle() or addSubModel()");
  std::string too_many = detail::deformable::findTooMany(num_triangles, num_vertices);
  if (!too_many.empty()) return refuse(BVH_ERR_INCORRECT_DATA, std::move(too_many));
  const std::size_t bad =
      detail::deformable::findOutOfRange(triangles, num_triangles, num_vertices);
  if (bad == 3 * num_triangles) return BVH_OK;
  return refuse(BVH_ERR_INCORRECT_DATA,
                "triangle " + std::to_string(bad / 3) + " refers to vertex " +
                    std::to_string(triangles[bad / 3][static_cast<int>(bad % 3)]) +
                    " of " + std::to_string(num_vertices) +
                    " vertices, which are numbered from 0");
}

template <typename BV>
int DeformableBVHModel<BV>::checkOrigins(const std::vector<int>& origins,
                                         std::size_t num_triangles) {
  if (origins.empty()) return BVH_OK;
  if (origins.size() != num_triangles)
    return refuse(BVH_ERR_INCORRECT_DATA, std::to_string(origins.size()) +
                                              " origins given for " +
                                              std::to_string(num_triangles) +
                                              " triangles. Give one a triangle, or none");
  for (std::size_t i = 0; i < num_triangles; ++i)
    if (origins[i] < -1 || origins[i] >= this->num_tris)
      return refuse(BVH_ERR_INCORRECT_DATA,
                    "triangle " + std::to_string(i) + " comes from triangle " +
                        std::to_string(origins[i]) + " of " +
                        std::to_string(this->num_tris) + ". -1 is for a new triangle");
  return BVH_OK;
}

template <typename BV>
int DeformableBVHModel<BV>::setNumThreads(int num_threads) {
  if (num_threads < 0)
    return refuse(
        BVH_ERR_INCORRECT_DATA,
        std::to_string(num_threads) + " is not a number of threads. Give 0 or more");
  num_threads_ = num_threads;
  return accept();
}

template <typename BV>
bool DeformableBVHModel<BV>::isFclTreeUpToDate() const {
  return this->getNumBVs() > 0 && !isFclTreeBehind();
}

/// Whether FCL's tree is missing, or belongs to other frames or triangles.
template <typename BV>
bool DeformableBVHModel<BV>::isFclTreeBehind() const {
  if (isInStep()) return !fcl_tree_up_to_date_;
  if (isHalfUpdated()) return true;
  // The model was changed through the base class, which keeps its tree up to date. It has
  // none if vertices were added after endModel(FclTree::kSkip).
  return seal_.vertices && this->build_state == BVH_BUILD_STATE_BEGUN;
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
  if (isHalfUpdated())
    throw Exception(
        "DeformableBVHModel: the last update failed, because an exception ended it (out "
        "of memory, for example). Give both frames again, by updateFrames()");
  if (isFclTreeBehind() && !isInStep())
    throw Exception(
        "DeformableBVHModel: the model has grown since endModel(). Call endModel() "
        "again");
  if (isFclTreeBehind())
    throw Exception(
        "DeformableBVHModel: this query needs FCL's own tree, which is out of date "
        "(FclTree::kSkip). Call updateFclTree() first");
  if (this->getNumBVs() == 0)
    throw Exception("DeformableBVHModel: the model is not built. Call endModel() first");
  return Base::getNodeType();
}

template <typename BV>
void DeformableBVHModel<BV>::computeLocalAABB() {
  // A model without beginModel() has no array.
  const S* current = this->vertices ? this->vertices->data() : nullptr;
  const bool has_previous = this->prev_vertices && !isPreviousShort();
  const auto bounds = detail::deformable::boundFrames(
      has_previous ? this->prev_vertices->data() : current, current,
      static_cast<std::size_t>(this->num_vertices), num_threads_);
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

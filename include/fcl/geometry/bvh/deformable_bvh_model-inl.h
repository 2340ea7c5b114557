// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BVH_DEFORMABLE_BVH_MODEL_INL_H
#define FCL_BVH_DEFORMABLE_BVH_MODEL_INL_H

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/narrowphase/detail/deformable/coordinate_arrays.h"

namespace fcl {

#define FCL_CCD_EXTERN_MODELS(S)                         \
  extern template class DeformableBVHModel<AABB<S>>;     \
  extern template class DeformableBVHModel<OBB<S>>;      \
  extern template class DeformableBVHModel<RSS<S>>;      \
  extern template class DeformableBVHModel<kIOS<S>>;     \
  extern template class DeformableBVHModel<OBBRSS<S>>;   \
  extern template class DeformableBVHModel<KDOP<S, 16>>; \
  extern template class DeformableBVHModel<KDOP<S, 18>>; \
  extern template class DeformableBVHModel<KDOP<S, 24>>;
FCL_CCD_EXTERN_MODELS(double)
FCL_CCD_EXTERN_MODELS(float)
#undef FCL_CCD_EXTERN_MODELS

namespace detail {

/// FCL 0.7 merges two RSSs into one that can leave points out, and the oriented boxes of
/// single triangles that are thin or have no area are not around them, so that a
/// bottom-up refit of a tree that holds them makes distances too large and misses
/// contacts; from the top down each volume is fitted to the vertices.
template <typename BV>
struct RefitsBottomUp : std::false_type {};
template <typename S>
struct RefitsBottomUp<AABB<S>> : std::true_type {};
template <typename S, std::size_t N>
struct RefitsBottomUp<KDOP<S, N>> : std::true_type {};

}  // namespace detail

template <typename BV>
DeformableBVHModel<BV>::DeformableBVHModel() = default;

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
  // FCL copies the nodes that a tree has; one that is half made has less than it needs.
  if (isHalfUpdated())
    throw Exception("DeformableBVHModel: copied after an update that failed");
  // FCL shares these between copies, although building writes to them.
  this->bv_splitter = std::make_shared<detail::BVSplitter<BV>>(detail::SPLIT_METHOD_MEAN);
  this->bv_fitter = std::make_shared<detail::BVFitter<BV>>();
  if (other.isInStep()) seal_ = currentSeal();
  if (other.opened_ == other.currentSeal()) opened_ = currentSeal();
}

template <typename BV>
DeformableBVHModel<BV>& DeformableBVHModel<BV>::operator=(
    const DeformableBVHModel& other) {
  if (this == &other) return *this;
  // From the swap on nothing throws.
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

// FCL's own assignment copies pointers, private ones included: what makes it wrong for
// users is what a swap needs. No array is shared once the three steps are done.
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

// Every change through the base class breaks the seal: an update leaves the UPDATED
// state, a replacement deletes prev_vertices, a rebuild does both or changes the sizes.
template <typename BV>
bool DeformableBVHModel<BV>::isInStep() const {
  return seal_.vertices && seal_.prev_vertices && seal_ == currentSeal();
}

/// Brings the base into the state of a model that is built, with all that belongs to it.
template <typename BV>
void DeformableBVHModel<BV>::seal() {
  this->build_state = fcl_tree_built_ ? BVH_BUILD_STATE_PROCESSED : BVH_BUILD_STATE_BEGUN;
  seal_ = currentSeal();
  is_changing_ = false;
}

// A change through the base class that follows leaves another state.
template <typename BV>
bool DeformableBVHModel<BV>::isHalfUpdated() const {
  return is_changing_ && this->build_state == BVH_BUILD_STATE_UPDATE_BEGUN;
}

/// Whether vertices were added, through the base class, to a model that ended without
/// FCL's tree: its array of the previous frame has no room for them.
template <typename BV>
bool DeformableBVHModel<BV>::isPreviousShort() const {
  return this->prev_vertices && seal_.prev_vertices == this->prev_vertices &&
         seal_.num_vertices < this->num_vertices;
}

// FCL copies as many vertices of both frames.
template <typename BV>
const BVHModel<BV>& DeformableBVHModel<BV>::copyable(const DeformableBVHModel& model) {
  if (model.isPreviousShort())
    throw Exception("DeformableBVHModel: copied after vertices were added to its base");
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
                  name + "() on a model that is not built");
  if (isUpdateOpen())
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  name + "() between begin...Model() and end...Model()");
  return BVH_OK;
}

template <typename BV>
int DeformableBVHModel<BV>::checkTriangles(const Triangle* triangles,
                                           std::size_t num_triangles,
                                           std::size_t num_vertices) {
  if (num_triangles == 0 || num_vertices == 0)
    return refuse(BVH_ERR_BUILD_EMPTY_MODEL, "the model has no triangles");
  std::string too_many = detail::deformable::findTooMany(num_triangles, num_vertices);
  if (!too_many.empty()) return refuse(BVH_ERR_INCORRECT_DATA, std::move(too_many));
  const std::size_t bad =
      detail::deformable::findOutOfRange(triangles, num_triangles, num_vertices);
  if (bad == 3 * num_triangles) return BVH_OK;
  return refuse(BVH_ERR_INCORRECT_DATA,
                "triangle " + std::to_string(bad / 3) + " refers to vertex " +
                    std::to_string(triangles[bad / 3][static_cast<int>(bad % 3)]) +
                    " of " + std::to_string(num_vertices));
}

template <typename BV>
int DeformableBVHModel<BV>::checkOrigins(const std::vector<int>& origins,
                                         std::size_t num_triangles) {
  if (origins.empty()) return BVH_OK;
  if (origins.size() != num_triangles)
    return refuse(BVH_ERR_INCORRECT_DATA,
                  std::to_string(origins.size()) + " origins given for " +
                      std::to_string(num_triangles) + " triangles");
  for (std::size_t i = 0; i < num_triangles; ++i)
    if (origins[i] < -1 || origins[i] >= this->num_tris)
      return refuse(BVH_ERR_INCORRECT_DATA, "triangle " + std::to_string(i) +
                                                " comes from triangle " +
                                                std::to_string(origins[i]) + " of " +
                                                std::to_string(this->num_tris));
  return BVH_OK;
}

template <typename BV>
int DeformableBVHModel<BV>::setNumThreads(int num_threads) {
  if (num_threads < 0)
    return refuse(BVH_ERR_INCORRECT_DATA,
                  std::to_string(num_threads) + " is not a number of threads");
  num_threads_ = num_threads;
  return accept();
}

template <typename BV>
template <typename Add>
int DeformableBVHModel<BV>::grow(Add&& add) {
  if (isHalfUpdated())
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  "the model grows after an update that failed");
  if (this->build_state == BVH_BUILD_STATE_BEGUN) {
    delete[] this->prev_vertices;
    this->prev_vertices = nullptr;
  }
  const int code = add();
  return code == BVH_OK ? accept() : refuse(code, "FCL refused what was added");
}

template <typename BV>
int DeformableBVHModel<BV>::addVertex(const Vector3<S>& p) {
  return grow([&] { return Base::addVertex(p); });
}

template <typename BV>
int DeformableBVHModel<BV>::addTriangle(const Vector3<S>& p1, const Vector3<S>& p2,
                                        const Vector3<S>& p3) {
  return grow([&] { return Base::addTriangle(p1, p2, p3); });
}

template <typename BV>
int DeformableBVHModel<BV>::addSubModel(const std::vector<Vector3<S>>& ps) {
  return grow([&] { return Base::addSubModel(ps); });
}

template <typename BV>
int DeformableBVHModel<BV>::addSubModel(const std::vector<Vector3<S>>& ps,
                                        const std::vector<Triangle>& ts) {
  return grow([&] { return Base::addSubModel(ps, ts); });
}

template <typename BV>
int DeformableBVHModel<BV>::endModel(FclTree fcl_tree) {
  if (this->build_state != BVH_BUILD_STATE_BEGUN)
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE, "endModel() without beginModel()");
  const auto count = static_cast<std::size_t>(this->num_vertices),
             num_triangles = static_cast<std::size_t>(this->num_tris);
  if (const int code = checkTriangles(this->tri_indices, num_triangles, count))
    return code;
  if (const int code = checkFinite(this->vertices->data(), count, "first")) return code;

  // What fails leaves an open model, which no seal fits.
  open_ = Open::kNone;
  seal_.build_state = BVH_BUILD_STATE_EMPTY;
  std::unique_ptr<Vector3<S>[]> previous(new Vector3<S>[count]);
  std::copy(this->vertices, this->vertices + count, previous.get());
  delete[] this->prev_vertices;
  this->prev_vertices = previous.release();
  seal_.prev_vertices = this->prev_vertices;
  seal_.num_vertices = this->num_vertices;
  const detail::deformable::VertexFrames still(this->vertices->data(),
                                               this->vertices->data(), count);
  buildTree(this->tri_indices, num_triangles, still);
  refitTree(still);
  computeLocalAABB();
  if (fcl_tree == FclTree::kUpdate) {
    if (const int code = Base::endModel())
      return refuse(code, "FCL refused to build its tree");
  }
  fcl_tree_built_ = fcl_tree_up_to_date_ = fcl_tree == FclTree::kUpdate;
  seal();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::open(Open what, const char* caller) {
  if (!isBuilt())
    return refuse(BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
                  std::string(caller) + "() on a model that is not built");
  staged_.clear();
  staged_.reserve(static_cast<std::size_t>(this->num_vertices));
  open_ = what;
  opened_ = currentSeal();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::stage(const Vector3<S>* points, std::size_t count,
                                  Open expected) {
  if (open_ != expected)
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE, "a vertex without a begin...Model()");
  staged_.insert(staged_.end(), points, points + count);
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::close(Open expected, const char* caller) {
  if (open_ != expected)
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  std::string(caller) + "() without its begin...Model()");
  open_ = Open::kNone;
  if (!(opened_ == currentSeal()))
    return refuse(
        BVH_ERR_BUILD_OUT_OF_SEQUENCE,
        std::string(caller) + "() of a model that was changed since its begin...Model()");
  const auto count = static_cast<std::size_t>(this->num_vertices);
  if (staged_.size() != count)
    return refuse(BVH_ERR_INCORRECT_DATA, std::to_string(staged_.size()) +
                                              " vertices given for a model of " +
                                              std::to_string(count));
  return checkFinite(staged_.data()->data(), count, "current");
}

template <typename BV>
int DeformableBVHModel<BV>::beginUpdateModel() {
  if (isHalfUpdated())
    return refuse(
        BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
        "beginUpdateModel() after an update that failed: both frames are needed");
  return open(Open::kUpdate, "beginUpdateModel");
}

template <typename BV>
int DeformableBVHModel<BV>::updateVertex(const Vector3<S>& p) {
  return stage(&p, 1, Open::kUpdate);
}

template <typename BV>
int DeformableBVHModel<BV>::updateTriangle(const Vector3<S>& p1, const Vector3<S>& p2,
                                           const Vector3<S>& p3) {
  const Vector3<S> points[3] = {p1, p2, p3};
  return stage(points, 3, Open::kUpdate);
}

template <typename BV>
int DeformableBVHModel<BV>::updateSubModel(const std::vector<Vector3<S>>& ps) {
  return stage(ps.data(), ps.size(), Open::kUpdate);
}

template <typename BV>
int DeformableBVHModel<BV>::endUpdateModel(bool refit, bool bottomup) {
  if (const int code = close(Open::kUpdate, "endUpdateModel")) return code;
  advance(nullptr, FclTree::kUpdate, refit, bottomup);
  finish();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::beginReplaceModel() {
  return open(Open::kReplace, "beginReplaceModel");
}

template <typename BV>
int DeformableBVHModel<BV>::replaceVertex(const Vector3<S>& p) {
  return stage(&p, 1, Open::kReplace);
}

template <typename BV>
int DeformableBVHModel<BV>::replaceTriangle(const Vector3<S>& p1, const Vector3<S>& p2,
                                            const Vector3<S>& p3) {
  const Vector3<S> points[3] = {p1, p2, p3};
  return stage(points, 3, Open::kReplace);
}

template <typename BV>
int DeformableBVHModel<BV>::replaceSubModel(const std::vector<Vector3<S>>& ps) {
  return stage(ps.data(), ps.size(), Open::kReplace);
}

template <typename BV>
int DeformableBVHModel<BV>::endReplaceModel(bool refit, bool bottomup) {
  if (const int code = close(Open::kReplace, "endReplaceModel")) return code;
  advance(staged_.data()->data(), FclTree::kUpdate, refit, bottomup);
  finish();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::updateFrames(const S* previous, const S* current,
                                         std::size_t num_vertices, FclTree fcl_tree) {
  if (const int code = checkSteppable("updateFrames")) return code;
  if (!previous || !current)
    return refuse(BVH_ERR_INCORRECT_DATA, "updateFrames() with a null frame");
  if (num_vertices != static_cast<std::size_t>(this->num_vertices))
    return refuse(BVH_ERR_INCORRECT_DATA, std::to_string(num_vertices) +
                                              " vertices given for a model of " +
                                              std::to_string(this->num_vertices));
  if (const int code = checkFrames(previous, current, num_vertices)) return code;

  // Both copies are made before an array changes: the frames may be the model's own.
  staged_.resize(num_vertices);
  std::memcpy(staged_.data()->data(), current, 3 * num_vertices * sizeof(S));
  const bool build = fcl_tree == FclTree::kUpdate && !fcl_tree_built_;
  advance(previous, fcl_tree, true, true);
  finish();
  if (build) return updateFclTree();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::updateTopology(const std::vector<Triangle>& triangles,
                                           const std::vector<int>& origins,
                                           const S* previous, const S* current,
                                           std::size_t num_vertices, FclTree fcl_tree) {
  if (const int code = checkSteppable("updateTopology")) return code;
  if (!previous || !current)
    return refuse(BVH_ERR_INCORRECT_DATA, "updateTopology() with a null frame");
  if (const int code = checkTriangles(triangles.data(), triangles.size(), num_vertices))
    return code;
  if (const int code = checkOrigins(origins, triangles.size())) return code;
  if (const int code = checkFrames(previous, current, num_vertices)) return code;

  // All is made beside the model. What of it is no mesh stays.
  Base next;
  static_cast<CollisionGeometry<S>&>(next) = *this;
  next.bv_splitter = this->bv_splitter;
  next.bv_fitter = this->bv_fitter;
  int code =
      next.beginModel(static_cast<int>(triangles.size()), static_cast<int>(num_vertices));
  if (code != BVH_OK) return refuse(code, "FCL has no memory for the mesh");
  std::copy(triangles.begin(), triangles.end(), next.tri_indices);
  next.num_tris = static_cast<int>(triangles.size());
  std::memcpy(next.vertices->data(), current, 3 * num_vertices * sizeof(S));
  next.num_vertices = static_cast<int>(num_vertices);
  next.prev_vertices = new Vector3<S>[num_vertices];
  std::memcpy(next.prev_vertices->data(), previous, 3 * num_vertices * sizeof(S));
  if (fcl_tree == FclTree::kUpdate) code = next.endModel();
  if (code != BVH_OK) return refuse(code, "FCL refused to build its tree");
  const detail::deformable::VertexFrames new_frames(next.prev_vertices->data(),
                                                    next.vertices->data(), num_vertices);
  if (isInStep())
    changeTopology(next.tri_indices, triangles.size(), origins, new_frames);
  else
    buildTree(next.tri_indices, triangles.size(), new_frames);

  // What fails from here on leaves an update half done.
  seal_ = {};
  is_changing_ = true;
  this->build_state = next.build_state = BVH_BUILD_STATE_UPDATE_BEGUN;
  swapBase(next);
  seal_.prev_vertices = this->prev_vertices;
  seal_.num_vertices = this->num_vertices;
  fcl_tree_built_ = fcl_tree_up_to_date_ = fcl_tree == FclTree::kUpdate;
  refitChangedTree(frames());
  computeLocalAABB();
  seal();
  return accept();
}

/// `previous`, or else the current frame, becomes the previous one, staged_ the current
/// one. Until seal() the model is in the state of an update that has begun and not ended:
/// if an exception comes between them it stays there, and no query takes it.
template <typename BV>
void DeformableBVHModel<BV>::advance(const S* previous, FclTree fcl_tree, bool refit,
                                     bool bottomup) {
  const auto count = static_cast<std::size_t>(this->num_vertices);
  const bool rebuild = !isInStep(), repair = isHalfUpdated();
  if (!this->prev_vertices || isPreviousShort()) {
    std::unique_ptr<Vector3<S>[]> room(new Vector3<S>[count]);
    delete[] this->prev_vertices;
    this->prev_vertices = room.release();
    seal_.prev_vertices = this->prev_vertices;
    seal_.num_vertices = this->num_vertices;
  }
  is_changing_ = true;
  this->build_state = BVH_BUILD_STATE_UPDATE_BEGUN;
  // After a change through the base class the base alone knows what the model is.
  if (rebuild && !repair) fcl_tree_built_ = true;
  // FCL's tree may have been left half made: a repair makes it anew.
  fcl_tree_up_to_date_ = fcl_tree_built_ && (repair || fcl_tree == FclTree::kUpdate);
  const std::size_t size = 3 * count * sizeof(S);
  if (fcl_tree_up_to_date_) {
    if (previous) std::memmove(this->vertices->data(), previous, size);
    this->build_state = BVH_BUILD_STATE_PROCESSED;
    Base::beginUpdateModel();
    Base::updateSubModel(staged_);
    Base::endUpdateModel(refit && !repair, bottomup && detail::RefitsBottomUp<BV>::value);
    this->build_state = BVH_BUILD_STATE_UPDATE_BEGUN;
  } else {
    // Each array stays in its place: FCL may have room for more vertices in `vertices`.
    std::memmove(this->prev_vertices->data(),
                 previous ? previous : this->vertices->data(), size);
    std::copy(staged_.begin(), staged_.end(), this->vertices);
  }
  if (rebuild)
    buildTree(this->tri_indices, static_cast<std::size_t>(this->num_tris), frames());
}

template <typename BV>
void DeformableBVHModel<BV>::finish() {
  refitTree(frames());
  computeLocalAABB();
  seal();
}

template <typename BV>
int DeformableBVHModel<BV>::updateFclTree() {
  if (isHalfUpdated())
    return refuse(BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
                  "updateFclTree() after an update that failed: both frames are needed");
  if (!isBuilt())
    return refuse(BVH_ERR_BUILD_EMPTY_MODEL,
                  "updateFclTree() on a model that is not built");
  if (isUpdateOpen())
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  "updateFclTree() between begin...Model() and end...Model()");
  // A change through the base class has refit FCL's tree.
  if (!isInStep()) return accept();
  if (!fcl_tree_built_) {
    // FCL may have moved the vertices before it fails.
    int code;
    try {
      code = Base::endModel();
    } catch (...) {
      seal();
      throw;
    }
    fcl_tree_built_ = fcl_tree_up_to_date_ = code == BVH_OK;
    seal();
    if (code) return refuse(code, "FCL refused to build its tree");
  } else if (!fcl_tree_up_to_date_) {
    staged_.assign(this->vertices, this->vertices + this->num_vertices);
    advance(this->prev_vertices->data(), FclTree::kUpdate, true, true);
    seal();
  }
  return accept();
}

template <typename BV>
bool DeformableBVHModel<BV>::isFclTreeUpToDate() const {
  return this->getNumBVs() > 0 && !isFclTreeBehind();
}

/// Whether FCL's tree, if there is any, is one of other frames or triangles.
template <typename BV>
bool DeformableBVHModel<BV>::isFclTreeBehind() const {
  if (isInStep()) return !fcl_tree_up_to_date_;
  if (isHalfUpdated()) return true;
  // Changed through the base class, which keeps its tree up to date, unless it never had
  // one: vertices were added after endModel(FclTree::kSkip).
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
        "DeformableBVHModel: the last update failed, for want of memory or in an "
        "exception; give both frames first, through updateFrames() or a replacement");
  if (isFclTreeBehind() && !isInStep())
    throw Exception(
        "DeformableBVHModel: the model has grown since endModel(); call that again");
  if (isFclTreeBehind())
    throw Exception(
        "DeformableBVHModel: FCL's tree was skipped (FclTree::kSkip) and discrete "
        "queries need it; call updateFclTree() first");
  return Base::getNodeType();
}

template <typename BV>
void DeformableBVHModel<BV>::computeLocalAABB() {
  // A model that was never begun has no array.
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

}  // namespace fcl

#endif

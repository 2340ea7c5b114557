// SPDX-License-Identifier: BSD-3-Clause
//
// Builds and updates of a model. Its state is in model_state.cpp, and the checks of its
// input are in deformable_mesh.cpp.
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "model/model_instances.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mesh/mesh_topology.h"
#include "mesh/vertex_frames.h"

namespace fcl {

namespace {

/// Whether FCL may refit a tree of this BV from the bottom up. FCL 0.7 merges two RSSs
/// into one that can leave points out, and its oriented boxes of thin triangles do not
/// contain them. A bottom-up refit of such trees makes distances too large and misses
/// contacts. A refit from the top down fits each volume to the vertices.
template <typename BV>
struct RefitsBottomUp : std::false_type {};
template <typename S>
struct RefitsBottomUp<AABB<S>> : std::true_type {};
template <typename S, std::size_t N>
struct RefitsBottomUp<KDOP<S, N>> : std::true_type {};

}  // namespace

// Without beginModel() FCL itself writes beyond its arrays. It also loses the previous
// frame of a model that was updated.
template <typename BV>
template <typename Add>
int DeformableBVHModel<BV>::grow(Add&& add) {
  if (this->build_state != BVH_BUILD_STATE_BEGUN)
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  "add...() on a model that is not open. Call beginModel() first");
  // If FCL finds no memory for triangles, it may have moved the vertices and added new
  // ones already.
  const int num_vertices = this->num_vertices;
  const bool was_in_step = isInStep();
  const auto restore = [&] {
    this->num_vertices = num_vertices;
    if (was_in_step) state_.setCurrent(arrays());
  };
  try {
    if (const int code = add()) {
      restore();
      return refuse(code, "FCL has no memory for the vertices or triangles to be added");
    }
  } catch (...) {
    restore();
    throw;
  }
  if (!isInStep()) {
    delete[] this->prev_vertices;
    this->prev_vertices = nullptr;
  }
  return accept();
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
int DeformableBVHModel<BV>::beginModel(int num_tris, int num_vertices) {
  dropFree();
  return Base::beginModel(num_tris, num_vertices);
}

template <typename BV>
int DeformableBVHModel<BV>::addEdge(const Vector3<S>& p1, const Vector3<S>& p2) {
  return addSubModel({p1, p2}, {}, {FreeEdge{{0, 1}}});
}

template <typename BV>
int DeformableBVHModel<BV>::addPoint(const Vector3<S>& p) {
  return addSubModel({p}, {}, {}, {0});
}

template <typename BV>
int DeformableBVHModel<BV>::addSubModel(const std::vector<Vector3<S>>& ps,
                                        const std::vector<Triangle>& ts,
                                        const std::vector<FreeEdge>& edges,
                                        const std::vector<std::size_t>& points) {
  if (const int code = checkFree(edges, points, ps.size())) return code;
  reserveFree(edges.size(), points.size());
  const auto first = static_cast<std::size_t>(this->num_vertices);
  const auto add = [&] {
    return ts.empty() ? Base::addSubModel(ps) : Base::addSubModel(ps, ts);
  };
  if (const int code = grow(add)) return code;
  assert(static_cast<std::size_t>(this->num_vertices) == first + ps.size());
  addFree(edges, points, first);
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::endModel(FclTree fcl_tree) {
  if (const int code = checkInConstruction()) return code;
  const auto count = static_cast<std::size_t>(this->num_vertices),
             num_triangles = static_cast<std::size_t>(this->num_tris);
  if (const int code = checkTriangles(this->tri_indices, num_triangles, count))
    return code;
  if (const int code = checkFree(count)) return code;
  if (const int code = checkFinite(this->vertices->data(), count, "first")) return code;

  if (hasFree()) fcl_tree = FclTree::kSkip;
  state_.beginBuild();
  std::unique_ptr<Vector3<S>[]> previous(new Vector3<S>[count]);
  std::copy(this->vertices, this->vertices + count, previous.get());
  delete[] this->prev_vertices;
  this->prev_vertices = previous.release();
  state_.setPrevious(arrays());
  const detail::deformable::VertexFrames still(this->vertices->data(),
                                               this->vertices->data(), count);
  buildTree(this->tri_indices, num_triangles, still);
  refitTree(still);
  computeLocalAABB();
  if (fcl_tree == FclTree::kUpdate) {
    if (const int code = Base::endModel())
      return refuse(code, "FCL refused to build its tree");
  }
  state_.setFclTree(fcl_tree == FclTree::kUpdate ? FclTreeIs::kUpToDate
                                                 : FclTreeIs::kMissing);
  seal();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::open(OpenUpdate what, const char* caller) {
  if (isBuilt()) {
    staged_.clear();
    staged_.reserve(static_cast<std::size_t>(this->num_vertices));
  }
  return openUpdate(what, caller);
}

template <typename BV>
int DeformableBVHModel<BV>::stage(const Vector3<S>* points, std::size_t count,
                                  OpenUpdate expected) {
  if (const int code = checkOpen(expected)) return code;
  staged_.insert(staged_.end(), points, points + count);
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::close(OpenUpdate expected, const char* caller) {
  if (const int code = closeUpdate(expected, caller)) return code;
  if (const int code = checkCount(staged_.size())) return code;
  return checkFinite(staged_.data()->data(), staged_.size(), "current");
}

template <typename BV>
int DeformableBVHModel<BV>::beginUpdateModel() {
  if (phase() == Phase::kHalfUpdated)
    return refuse(
        BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
        "beginUpdateModel() on a model whose last update failed. Give both frames, by "
        "updateFrames()");
  return open(OpenUpdate::kUpdate, "beginUpdateModel");
}

template <typename BV>
int DeformableBVHModel<BV>::updateVertex(const Vector3<S>& p) {
  return stage(&p, 1, OpenUpdate::kUpdate);
}

template <typename BV>
int DeformableBVHModel<BV>::updateTriangle(const Vector3<S>& p1, const Vector3<S>& p2,
                                           const Vector3<S>& p3) {
  const Vector3<S> points[3] = {p1, p2, p3};
  return stage(points, 3, OpenUpdate::kUpdate);
}

template <typename BV>
int DeformableBVHModel<BV>::updateSubModel(const std::vector<Vector3<S>>& ps) {
  return stage(ps.data(), ps.size(), OpenUpdate::kUpdate);
}

template <typename BV>
int DeformableBVHModel<BV>::endUpdateModel(bool refit, bool bottomup) {
  if (const int code = close(OpenUpdate::kUpdate, "endUpdateModel")) return code;
  shiftFrames(nullptr, FclTree::kUpdate, refit, bottomup);
  finish();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::beginReplaceModel() {
  return open(OpenUpdate::kReplace, "beginReplaceModel");
}

template <typename BV>
int DeformableBVHModel<BV>::replaceVertex(const Vector3<S>& p) {
  return stage(&p, 1, OpenUpdate::kReplace);
}

template <typename BV>
int DeformableBVHModel<BV>::replaceTriangle(const Vector3<S>& p1, const Vector3<S>& p2,
                                            const Vector3<S>& p3) {
  const Vector3<S> points[3] = {p1, p2, p3};
  return stage(points, 3, OpenUpdate::kReplace);
}

template <typename BV>
int DeformableBVHModel<BV>::replaceSubModel(const std::vector<Vector3<S>>& ps) {
  return stage(ps.data(), ps.size(), OpenUpdate::kReplace);
}

template <typename BV>
int DeformableBVHModel<BV>::endReplaceModel(bool refit, bool bottomup) {
  if (const int code = close(OpenUpdate::kReplace, "endReplaceModel")) return code;
  shiftFrames(staged_.data()->data(), FclTree::kUpdate, refit, bottomup);
  finish();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::updateFrames(const S* previous, const S* current,
                                         std::size_t num_vertices, FclTree fcl_tree) {
  if (const int code = checkSteppable("updateFrames")) return code;
  if (!previous || !current)
    return refuse(BVH_ERR_INCORRECT_DATA,
                  "updateFrames() with a null frame. Give the previous and the current "
                  "frame");
  if (const int code = checkCount(num_vertices)) return code;
  if (const int code = checkFrames(previous, current, num_vertices)) return code;

  // Both copies are made before an array changes, since the frames may be the model's
  // own.
  staged_.resize(num_vertices);
  std::memcpy(staged_.data()->data(), current, 3 * num_vertices * sizeof(S));
  shiftFrames(previous, fcl_tree, true, true);
  finish();
  if (fcl_tree == FclTree::kUpdate && state_.fclTree() == FclTreeIs::kMissing &&
      !hasFree())
    return updateFclTree();
  return accept();
}

template <typename BV>
int DeformableBVHModel<BV>::updateTopology(const std::vector<Triangle>& triangles,
                                           const std::vector<int>& origins,
                                           const S* previous, const S* current,
                                           std::size_t num_vertices, FclTree fcl_tree) {
  if (const int code = checkSteppable("updateTopology")) return code;
  if (hasFree())
    return refuse(BVH_ERR_UNSUPPORTED_FUNCTION,
                  "updateTopology() of a model with free edges or points. Give them too");
  if (!previous || !current)
    return refuse(BVH_ERR_INCORRECT_DATA,
                  "updateTopology() with a null frame. Give the previous and the current "
                  "frame");
  if (const int code = checkTriangles(triangles.data(), triangles.size(), num_vertices))
    return code;
  if (const int code = checkOrigins(origins, triangles.size())) return code;
  if (const int code = checkFrames(previous, current, num_vertices)) return code;

  // Everything is made beside the model. What does not belong to the mesh stays.
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

  state_.beginChange();
  this->build_state = next.build_state = BVH_BUILD_STATE_UPDATE_BEGUN;
  swapBase(next);
  state_.setPrevious(arrays());
  state_.setFclTree(fcl_tree == FclTree::kUpdate ? FclTreeIs::kUpToDate
                                                 : FclTreeIs::kMissing);
  assert(phase() == Phase::kHalfUpdated);
  refitChangedTree(frames());
  computeLocalAABB();
  seal();
  return accept();
}

/// Everything is made in another model, whose parts then take the place of this one's.
template <typename BV>
int DeformableBVHModel<BV>::updateTopology(const std::vector<Triangle>& triangles,
                                           const std::vector<FreeEdge>& edges,
                                           const std::vector<std::size_t>& points,
                                           const S* previous, const S* current,
                                           std::size_t num_vertices) {
  if (const int code = checkSteppable("updateTopology")) return code;
  if (!previous || !current)
    return refuse(BVH_ERR_INCORRECT_DATA,
                  "updateTopology() with a null frame. Give the previous and the current "
                  "frame");
  std::string too_many = detail::deformable::findTooMany(
      triangles.size() + edges.size() + points.size(), num_vertices);
  if (!too_many.empty()) return refuse(BVH_ERR_INCORRECT_DATA, std::move(too_many));
  if (const int code = checkFrames(previous, current, num_vertices)) return code;

  std::vector<Vector3<S>> vertices(num_vertices);
  std::memcpy(static_cast<void*>(vertices.data()), previous,
              3 * num_vertices * sizeof(S));
  DeformableBVHModel next;
  static_cast<CollisionGeometry<S>&>(next) = *this;
  next.bv_splitter = this->bv_splitter;
  next.bv_fitter = this->bv_fitter;
  next.setNumThreads(numThreads());
  int code =
      next.beginModel(static_cast<int>(triangles.size()), static_cast<int>(num_vertices));
  if (code != BVH_OK) return refuse(code, "FCL has no memory for the mesh");
  code = next.addSubModel(vertices, triangles, edges, points);
  if (code == BVH_OK) code = next.endModel(FclTree::kSkip);
  if (code == BVH_OK) code = next.updateFrames(previous, current, num_vertices);
  if (code != BVH_OK) return refuse(code, next.lastError());
  swapBase(next);
  detail::DeformableMesh::operator=(std::move(static_cast<DeformableMesh&>(next)));
  return accept();
}

/// `previous` becomes the previous frame; if it is null, the current frame does. staged_
/// becomes the current frame. Until seal() the model is in the state of an update that
/// has not ended. If an exception comes before seal(), the model stays in that state, and
/// no query accepts it.
template <typename BV>
void DeformableBVHModel<BV>::shiftFrames(const S* previous, FclTree fcl_tree, bool refit,
                                         bool bottomup) {
  const auto count = static_cast<std::size_t>(this->num_vertices);
  assert(isBuilt() && staged_.size() == count);
  const Phase before = phase();
  const bool repair = before == Phase::kHalfUpdated;
  std::unique_ptr<Vector3<S>[]> room;
  if (!this->prev_vertices || state_.isPreviousShort(arrays()))
    room.reset(new Vector3<S>[count]);
  state_.beginChange();
  this->build_state = BVH_BUILD_STATE_UPDATE_BEGUN;
  if (room) {
    delete[] this->prev_vertices;
    this->prev_vertices = room.release();
    state_.setPrevious(arrays());
  }
  // A model that was changed through the base class has FCL's tree. A tree that may be
  // half made is built again.
  if (before == Phase::kChangedThroughBase || state_.fclTree() != FclTreeIs::kMissing)
    state_.setFclTree(repair || fcl_tree == FclTree::kUpdate ? FclTreeIs::kUpToDate
                                                             : FclTreeIs::kBehind);
  const std::size_t size = 3 * count * sizeof(S);
  if (state_.fclTree() == FclTreeIs::kUpToDate) {
    if (previous) std::memmove(this->vertices->data(), previous, size);
    this->build_state = BVH_BUILD_STATE_PROCESSED;
    Base::beginUpdateModel();
    Base::updateSubModel(staged_);
    Base::endUpdateModel(refit && !repair, bottomup && RefitsBottomUp<BV>::value);
    this->build_state = BVH_BUILD_STATE_UPDATE_BEGUN;
  } else {
    // Each array stays in its place, since FCL may have room for more vertices in
    // `vertices`.
    std::memmove(this->prev_vertices->data(),
                 previous ? previous : this->vertices->data(), size);
    std::copy(staged_.begin(), staged_.end(), this->vertices);
  }
  if (before != Phase::kInStep)
    buildTree(this->tri_indices, static_cast<std::size_t>(this->num_tris), frames());
}

template <typename BV>
void DeformableBVHModel<BV>::finish() {
  assert(phase() == Phase::kHalfUpdated);  // no query accepts it until it is sealed
  refitTree(frames());
  computeLocalAABB();
  seal();
}

template <typename BV>
int DeformableBVHModel<BV>::updateFclTree() {
  if (const int code = checkFclTreeUpdate()) return code;
  // A change through the base class has refit FCL's tree.
  if (!isInStep()) return accept();
  if (state_.fclTree() == FclTreeIs::kMissing) {
    // FCL may have moved the vertices before it fails.
    int code;
    try {
      code = Base::endModel();
    } catch (...) {
      seal();
      throw;
    }
    if (code == BVH_OK) state_.setFclTree(FclTreeIs::kUpToDate);
    seal();
    if (code) return refuse(code, "FCL refused to build its tree");
  } else if (state_.fclTree() == FclTreeIs::kBehind) {
    staged_.assign(this->vertices, this->vertices + this->num_vertices);
    shiftFrames(this->prev_vertices->data(), FclTree::kUpdate, true, true);
    seal();
  }
  return accept();
}

FCL_CCD_FOR_VOLUMES(FCL_CCD_INSTANTIATE_MODEL)

}  // namespace fcl

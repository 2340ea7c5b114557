// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_frames.h"
#include "model/coordinate_arrays.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace detail {
namespace {

std::atomic<std::uint64_t> last_revision{0};

/// Returns what is wrong, or an empty string.
template <typename S>
std::string notFinite(const S* coordinates, std::size_t count, const char* frame,
                      int num_threads) {
  const std::size_t bad = deformable::findNotFinite(coordinates, count, num_threads);
  if (bad == count) return {};
  return "vertex " + std::to_string(bad) + " of the " + frame + " frame is not finite";
}

/// Twice the room each time, so that adding one by one takes linear time.
template <typename T>
void reserveMore(std::size_t count, std::vector<T>& list) {
  if (list.capacity() - list.size() < count)
    list.reserve(std::max(2 * list.size(), list.size() + count));
}

}  // namespace

DeformableMesh::DeformableMesh()
    : tree_(std::make_unique<deformable::MovingKdopTree>()) {}

DeformableMesh::~DeformableMesh() = default;

DeformableMesh::DeformableMesh(const DeformableMesh& other)
    : state_(other.state_),
      last_error_(other.last_error_),
      tree_(std::make_unique<deformable::MovingKdopTree>(*other.tree_)),
      num_threads_(other.num_threads_),
      num_restructurings_(other.num_restructurings_),
      is_deforming_(other.is_deforming_),
      free_edges_(other.free_edges_),
      free_points_(other.free_points_) {}

DeformableMesh& DeformableMesh::operator=(DeformableMesh&& other) noexcept {
  state_ = other.state_;
  last_error_ = std::move(other.last_error_);
  tree_ = std::move(other.tree_);
  num_threads_ = other.num_threads_;
  num_restructurings_ = other.num_restructurings_;
  is_deforming_ = other.is_deforming_;
  free_edges_ = std::move(other.free_edges_);
  free_points_ = std::move(other.free_points_);
  takeRevision();
  return *this;
}

std::uint64_t DeformableMesh::lastRevision() { return last_revision.load(); }

void DeformableMesh::takeRevision() { *revision_ = ++last_revision; }

bool DeformableMesh::isBuilt() const {
  const Phase now = phase();
  return now == Phase::kInStep || now == Phase::kHalfUpdated ||
         now == Phase::kChangedThroughBase;
}

bool DeformableMesh::isFclTreeBehind() const {
  switch (phase()) {
    case Phase::kInStep:
      return state_.fclTree() != FclTreeIs::kUpToDate;
    case Phase::kHalfUpdated:
    case Phase::kGrown:
      return true;
    default:
      // The base class keeps its tree up to date.
      return false;
  }
}

void DeformableMesh::reserveFree(std::size_t num_edges, std::size_t num_points) {
  reserveMore(num_edges, free_edges_);
  reserveMore(num_points, free_points_);
}

void DeformableMesh::addFree(const std::vector<FreeEdge>& edges,
                             const std::vector<std::size_t>& points, std::size_t first) {
  for (const FreeEdge& edge : edges) {
    assert(edge[0] != edge[1]);
    free_edges_.push_back({edge[0] + first, edge[1] + first});
  }
  for (const std::size_t point : points) free_points_.push_back(point + first);
}

void DeformableMesh::dropFree() {
  free_edges_.clear();
  free_points_.clear();
}

/// The triangles, and triangles that stand for free edges and points (MeshTriangle).
std::vector<Triangle> DeformableMesh::leavesOf(const Triangle* triangles,
                                               std::size_t num_triangles) const {
  std::vector<Triangle> leaves;
  leaves.reserve(num_triangles + free_edges_.size() + free_points_.size());
  leaves.assign(triangles, triangles + num_triangles);
  for (const FreeEdge& edge : free_edges_) leaves.emplace_back(edge[0], edge[1], edge[1]);
  for (const std::size_t point : free_points_) leaves.emplace_back(point, point, point);
  assert(leaves.size() == num_triangles + free_edges_.size() + free_points_.size());
  return leaves;
}

int DeformableMesh::refuse(int code, std::string why) {
  last_error_ = std::move(why);
  return code;
}

int DeformableMesh::accept() {
  last_error_.clear();
  return BVH_OK;
}

int DeformableMesh::allowThreads(int num_threads) {
  if (num_threads < 0)
    return refuse(
        BVH_ERR_INCORRECT_DATA,
        std::to_string(num_threads) + " is not a number of threads. Give 0 or more");
  num_threads_ = num_threads;
  return accept();
}

int DeformableMesh::checkCount(std::size_t num_vertices) {
  const int expected = arrays().num_vertices;
  if (num_vertices == static_cast<std::size_t>(expected)) return BVH_OK;
  return refuse(BVH_ERR_INCORRECT_DATA, std::to_string(num_vertices) +
                                            " vertices given for a model of " +
                                            std::to_string(expected));
}

int DeformableMesh::checkFinite(const float* coordinates, std::size_t count,
                                const char* frame) {
  std::string wrong = notFinite(coordinates, count, frame, num_threads_);
  return wrong.empty() ? BVH_OK : refuse(BVH_ERR_INCORRECT_DATA, std::move(wrong));
}

int DeformableMesh::checkFinite(const double* coordinates, std::size_t count,
                                const char* frame) {
  std::string wrong = notFinite(coordinates, count, frame, num_threads_);
  return wrong.empty() ? BVH_OK : refuse(BVH_ERR_INCORRECT_DATA, std::move(wrong));
}

int DeformableMesh::checkTriangles(const Triangle* triangles, std::size_t num_triangles,
                                   std::size_t num_vertices) {
  const std::size_t num_leaves = num_triangles + free_edges_.size() + free_points_.size();
  if (num_leaves == 0 || num_vertices == 0)
    return refuse(
        BVH_ERR_BUILD_EMPTY_MODEL,
        "the model has no triangles. Add some by addTriangle() or addSubModel()");
  std::string too_many = deformable::findTooMany(num_leaves, num_vertices);
  if (!too_many.empty()) return refuse(BVH_ERR_INCORRECT_DATA, std::move(too_many));
  const std::size_t bad =
      deformable::findOutOfRange(triangles, num_triangles, num_vertices);
  if (bad == 3 * num_triangles) return BVH_OK;
  return refuse(BVH_ERR_INCORRECT_DATA,
                "triangle " + std::to_string(bad / 3) + " refers to vertex " +
                    std::to_string(triangles[bad / 3][static_cast<int>(bad % 3)]) +
                    " of " + std::to_string(num_vertices) +
                    " vertices, which are numbered from 0");
}

int DeformableMesh::checkOrigins(const std::vector<int>& origins,
                                 std::size_t num_triangles) {
  if (origins.empty()) return BVH_OK;
  if (origins.size() != num_triangles)
    return refuse(BVH_ERR_INCORRECT_DATA, std::to_string(origins.size()) +
                                              " origins given for " +
                                              std::to_string(num_triangles) +
                                              " triangles. Give one a triangle, or none");
  const int num_tris = arrays().num_tris;
  for (std::size_t i = 0; i < num_triangles; ++i)
    if (origins[i] < -1 || origins[i] >= num_tris)
      return refuse(BVH_ERR_INCORRECT_DATA,
                    "triangle " + std::to_string(i) + " comes from triangle " +
                        std::to_string(origins[i]) + " of " + std::to_string(num_tris) +
                        ". -1 is for a new triangle");
  return BVH_OK;
}

int DeformableMesh::checkFree(const std::vector<FreeEdge>& edges,
                              const std::vector<std::size_t>& points,
                              std::size_t num_vertices) {
  const auto refuseVertex = [&](const char* what, std::size_t i, std::size_t vertex) {
    return refuse(BVH_ERR_INCORRECT_DATA,
                  what + std::to_string(i) + " refers to vertex " +
                      std::to_string(vertex) + " of " + std::to_string(num_vertices) +
                      " vertices, which are numbered from 0");
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (const std::size_t vertex : edges[i])
      if (vertex >= num_vertices) return refuseVertex("free edge ", i, vertex);
    if (edges[i][0] == edges[i][1])
      return refuse(BVH_ERR_INCORRECT_DATA,
                    "free edge " + std::to_string(i) + " joins vertex " +
                        std::to_string(edges[i][0]) + " to itself. Add a free point");
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i] >= num_vertices) return refuseVertex("free point ", i, points[i]);
  return BVH_OK;
}

int DeformableMesh::checkInConstruction() {
  if (arrays().build_state != BVH_BUILD_STATE_BEGUN)
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  "endModel() on a model that is not open. Call beginModel() first");
  if (phase() == Phase::kInStep)
    return refuse(
        BVH_ERR_BUILD_OUT_OF_SEQUENCE,
        "endModel() on a model that is built and has not grown. Call updateFclTree() "
        "to build FCL's tree");
  return BVH_OK;
}

int DeformableMesh::checkSteppable(const char* caller) {
  const std::string name(caller);
  if (!isBuilt())
    return refuse(BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
                  name + "() on a model that is not built. Call endModel() first");
  if (isUpdateOpen())
    return refuse(
        BVH_ERR_BUILD_OUT_OF_SEQUENCE,
        name + "() between begin...Model() and end...Model(). Call end...Model() first");
  return BVH_OK;
}

int DeformableMesh::checkFclTreeUpdate() {
  if (hasFree())
    return refuse(BVH_ERR_UNSUPPORTED_FUNCTION,
                  "updateFclTree() on a model with free edges or points, which FCL's own "
                  "tree cannot hold");
  if (phase() == Phase::kHalfUpdated)
    return refuse(BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
                  "updateFclTree() on a model whose last update failed. Give both frames "
                  "first, by updateFrames()");
  if (!isBuilt())
    return refuse(BVH_ERR_BUILD_EMPTY_MODEL,
                  "updateFclTree() on a model that is not built. Call endModel() first");
  if (isUpdateOpen())
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  "updateFclTree() between begin...Model() and end...Model(). Call "
                  "end...Model() first");
  return BVH_OK;
}

int DeformableMesh::openUpdate(OpenUpdate what, const char* caller) {
  if (!isBuilt())
    return refuse(
        BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME,
        std::string(caller) + "() on a model that is not built. Call endModel() first");
  state_.beginUpdate(what, arrays());
  return accept();
}

int DeformableMesh::checkOpen(OpenUpdate expected) {
  if (state_.openUpdate() == expected) return BVH_OK;
  return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                "a vertex is given outside of begin...Model() and end...Model(). Call "
                "beginUpdateModel() or beginReplaceModel() first");
}

int DeformableMesh::closeUpdate(OpenUpdate expected, const char* caller) {
  if (state_.openUpdate() != expected)
    return refuse(BVH_ERR_BUILD_OUT_OF_SEQUENCE,
                  std::string(caller) +
                      "() without its begin...Model(). Call begin...Model() first");
  if (state_.endUpdate(arrays())) return BVH_OK;
  return refuse(
      BVH_ERR_BUILD_OUT_OF_SEQUENCE,
      std::string(caller) +
          "() on a model that was changed since its begin...Model(). Begin again");
}

void DeformableMesh::checkDiscreteQuery(int num_bvs) const {
  const Phase now = phase();
  if (now == Phase::kHalfUpdated)
    throw Exception(
        "DeformableBVHModel: the last update failed, because an exception ended it (out "
        "of memory, for example). Give both frames again, by updateFrames()");
  if (now == Phase::kGrown)
    throw Exception(
        "DeformableBVHModel: the model has grown since endModel(). Call endModel() "
        "again");
  if (hasFree() && (isBuilt() || num_bvs > 0))
    throw Exception(
        "DeformableBVHModel: the model has free edges or points. FCL's own queries do "
        "not know them, nor do functions of its base class. Use continuous queries of "
        "straight paths, and the update functions of DeformableBVHModel itself");
  if (isFclTreeBehind())
    throw Exception(
        "DeformableBVHModel: this query needs FCL's own tree, which is out of date "
        "(FclTree::kSkip). Call updateFclTree() first");
  if (num_bvs == 0)
    throw Exception("DeformableBVHModel: the model is not built. Call endModel() first");
}

// FCL copies the same number of vertices of both frames, and the nodes of the tree. A
// tree that is half made has fewer nodes than FCL expects.
void DeformableMesh::checkCopy() const {
  if (state_.isPreviousShort(arrays()))
    throw Exception(
        "DeformableBVHModel: a copy of a model to which vertices were added through its "
        "base class. Call endModel() of the model first");
  if (phase() == Phase::kHalfUpdated)
    throw Exception(
        "DeformableBVHModel: a copy of a model whose last update failed. Give both "
        "frames to the model first, by updateFrames()");
}

void DeformableMesh::buildTree(const Triangle* triangles, std::size_t num_triangles,
                               const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  std::vector<Triangle> leaves;
  if (hasFree()) {
    leaves = leavesOf(triangles, num_triangles);
    triangles = leaves.data();
    num_triangles = leaves.size();
  }
  deformable::inArena(num_threads_, [&] {
    tree_->build(triangles, num_triangles, frames, num_threads_,
                 {free_edges_.size(), free_points_.size()});
  });
  assert(tree_->triangles().size() == num_triangles &&
         tree_->vertices().size() <= frames.size());
  num_restructurings_ = 0;
}

void DeformableMesh::changeTopology(const Triangle* triangles, std::size_t num_triangles,
                                    const std::vector<int>& origins,
                                    const deformable::VertexFrames& frames) {
  assert(!hasFree());
  const deformable::DefaultFloatingPoint mode;
  deformable::inArena(num_threads_, [&] {
    tree_->changeTopology(triangles, num_triangles, origins, frames, num_threads_);
  });
  assert(tree_->triangles().size() == num_triangles &&
         tree_->vertices().size() <= frames.size());
}

void DeformableMesh::refitTree(const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  num_restructurings_ += tree_->restructure();
  refitChangedTree(frames);
}

void DeformableMesh::refitChangedTree(const deformable::VertexFrames& frames) {
  const deformable::DefaultFloatingPoint mode;
  takeRevision();
  deformable::inArena(num_threads_, [&] { tree_->refit(frames, num_threads_); });
  is_deforming_ = false;
  if (frames.isStill()) return;
  for (std::size_t i = 0; i < frames.size() && !is_deforming_; ++i) {
    const deformable::VertexPath path = frames[i];
    for (int k = 0; k < 3; ++k) is_deforming_ |= path.t0[k] != path.t1[k];
  }
}

std::size_t DeformableMesh::treeMemUsage() const {
  return tree_->memUsage() + free_edges_.capacity() * sizeof(FreeEdge) +
         free_points_.capacity() * sizeof(std::size_t);
}

}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/prepared_mesh.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/default_floating_point.h"
#include "base/stopwatch.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "model/fcl_tree.h"
#include "model/sound_tree.h"
#include "prepare/class_cast.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Calls visit with the geometry as a BVHModel of its type. Returns false if it is none.
template <typename S, typename Visit>
bool visitModel(const CollisionGeometry<S>& geometry, Visit&& visit) {
  if (geometry.getObjectType() != OT_BVH) return false;
  const auto as = [&](auto* model) {
    visit(*model);
    return true;
  };
  switch (geometry.getNodeType()) {
    case BV_AABB:
      return as(static_cast<const BVHModel<AABB<S>>*>(&geometry));
    case BV_OBB:
      return as(static_cast<const BVHModel<OBB<S>>*>(&geometry));
    case BV_RSS:
      return as(static_cast<const BVHModel<RSS<S>>*>(&geometry));
    case BV_kIOS:
      return as(static_cast<const BVHModel<kIOS<S>>*>(&geometry));
    case BV_OBBRSS:
      return as(static_cast<const BVHModel<OBBRSS<S>>*>(&geometry));
    case BV_KDOP16:
      return as(static_cast<const BVHModel<KDOP<S, 16>>*>(&geometry));
    case BV_KDOP18:
      return as(static_cast<const BVHModel<KDOP<S, 18>>*>(&geometry));
    case BV_KDOP24:
      return as(static_cast<const BVHModel<KDOP<S, 24>>*>(&geometry));
    default:
      return false;
  }
}

/// Whether a model is in FCL's updated state and has a previous frame.
template <typename BV>
bool isDeforming(const BVHModel<BV>& model) {
  return model.build_state == BVH_BUILD_STATE_UPDATED && model.prev_vertices;
}

/// The geometry as a DeformableBVHModel whose moving tree is up to date; null otherwise.
template <typename S>
const DeformableMesh* deformableMeshOf(const CollisionGeometry<S>& geometry) {
  const auto* mesh = classCast<DeformableMesh>(geometry);
  return mesh && mesh->isInStep() ? mesh : nullptr;
}

template <typename S>
void requireFinite(const Vector3<S>* vertices, int count, const std::string& what) {
  for (int i = 0; i < count; ++i)
    if (!vertices[i].allFinite())
      throw Exception(what + ": vertex " + std::to_string(i) +
                      " is not finite. Correct it");
}

/// A finite vertex can leave the range of numbers when it is posed. Then its box is
/// unbounded, and so is the root's. If the root's box has bounds, no vertex need be
/// checked.
bool areBoxesBounded(const MovingKdopTree& tree) {
  const MovingKdopNode& root = tree.node(0);
  float most = 0;
  for (int r = 0; r < 16; ++r)
    for (int lane = 0; lane < root.count; ++lane)
      most = std::max(most, std::max(root.t0[r][lane], root.t1[r][lane]));
  return std::isfinite(most);
}

/// Whether no translation moves a vertex of the tree out of range. The factor of one half
/// is far more than the rounding here and in largestCoordinate().
bool stayInRange(const MovingKdopTree& tree, const double (&translation)[2][3]) {
  double most = 0;
  for (int frame = 0; frame < 2; ++frame)
    for (int k = 0; k < 3; ++k)
      most = std::max(most,
                      std::abs(tree.origin(frame)[k]) + std::abs(translation[frame][k]));
  return most + tree.largestCoordinate() <= 0.5 * DBL_MAX;
}

/// @param frames  posed
void requireFinite(const MovingKdopTree& tree, const VertexFrames& frames,
                   const std::string& name) {
  for (const TreeTriangle& triangle : tree.triangles())
    for (const std::uint32_t id : triangle.id) {
      const VertexPath path = frames[id];
      for (int k = 0; k < 3; ++k)
        if (!std::isfinite(path.t0[k]) || !std::isfinite(path.t1[k]))
          throw Exception(name + ": vertex " + std::to_string(id) +
                          ", posed, is not finite: the transform moves it out of the "
                          "range of double");
    }
}

}  // namespace

void requireFinite(const Pose& beginning, const Pose& end, const std::string& name) {
  for (const Pose* pose : {&beginning, &end}) {
    double sum = 0;  // NaN if a number is not finite
    for (const double x : pose->rotation) sum += 0 * x;
    for (const double x : pose->translation) sum += 0 * x;
    if (sum != 0) throw Exception(name + ": the transform is not finite. Correct it");
  }
}

template <typename S>
MeshClass meshClassOf(const CollisionGeometry<S>& geometry) {
  if (const DeformableMesh* mesh = deformableMeshOf(geometry))
    return {mesh->isDeforming() ? MeshKind::kDeforming : MeshKind::kRigid, mesh};
  MeshKind kind = MeshKind::kNotAMesh;
  visitModel(geometry, [&kind](const auto& model) {
    if (model.num_vertices > 0 && model.num_tris == 0) return;  // a point cloud
    kind = isDeforming(model) ? MeshKind::kDeforming : MeshKind::kRigid;
  });
  return {kind, nullptr};
}

template <typename S>
std::size_t numTrianglesOf(const CollisionGeometry<S>& geometry) {
  // It says what kind of node it has only while FCL's tree is up to date.
  if (const DeformableMesh* mesh = deformableMeshOf(geometry))
    return mesh->movingTree().triangles().size();
  std::size_t count = 0;
  visitModel(geometry, [&count](const auto& model) {
    count = static_cast<std::size_t>(model.num_tris);
  });
  return count;
}

template <typename S>
PreparedMesh::PreparedMesh(const CollisionGeometry<S>& geometry, const Pose& beginning,
                           const Pose& end, const std::string& name, int num_threads,
                           FeatureOwners owners)
    : name_(name) {
  requireFinite(beginning, end, name);
  instance_.name = name_.c_str();
  for (int k = 0; k < 3; ++k) {
    instance_.translation[0][k] = beginning.translation[k];
    instance_.translation[1][k] = end.translation[k];
  }
  const auto* any = classCast<DeformableMesh>(geometry);
  if (any && any->isUpdateOpen())
    throw Exception(name +
                    ": an update of the model has begun and not ended. Call "
                    "endUpdateModel() or endReplaceModel() first");
  assert(meshKindOf(geometry) != MeshKind::kNotAMesh);
  if (const DeformableMesh* mesh = deformableMeshOf(geometry)) {
    instance_.frames = mesh->frames();
    instance_.frames.setPoses(beginning, end);
    instance_.tree = &mesh->movingTree();
    if (beginning.isTranslation() && end.isTranslation()) {
      if (instance_.frames.isPosed() &&
          !stayInRange(mesh->movingTree(), instance_.translation))
        requireFinite(mesh->movingTree(), instance_.frames, name);
      return;
    }
    measure([&] {
      tree_ = mesh->movingTree();
      refit(name, num_threads);
    });
    return;
  }
  visitModel(geometry, [&](const auto& model) {
    prepareModel(model, beginning, end, name, num_threads, owners);
  });
}

template <typename BV>
void PreparedMesh::prepareModel(const BVHModel<BV>& model, const Pose& beginning,
                                const Pose& end, const std::string& name, int num_threads,
                                FeatureOwners owners) {
  const bool deforming = isDeforming(model);
  if (!deforming && model.build_state != BVH_BUILD_STATE_PROCESSED)
    throw Exception(name +
                    ": the model is not built, or an update has begun and not ended. "
                    "Call endModel(), endUpdateModel() or endReplaceModel() first");
  const auto count = static_cast<std::size_t>(model.num_vertices);
  const std::string too_many =
      findTooMany(static_cast<std::size_t>(model.num_tris), count);
  if (!too_many.empty()) throw Exception(name + ": " + too_many);
  const auto* current = model.vertices->data();
  instance_.frames =
      VertexFrames(deforming ? model.prev_vertices->data() : current, current, count);
  instance_.frames.setPoses(beginning, end);
  instance_.triangles = model.tri_indices;
  instance_.num_triangles = static_cast<std::size_t>(model.num_tris);
  if (!deforming && isTreeSound(model)) {
    assert(std::equal(beginning.rotation, beginning.rotation + 9, end.rotation));
    instance_.rigid = RigidTree(fclTree(model), beginning);
    if (owners == FeatureOwners::kAlways) {
      requireIndices(model, name);
      measure([&] {
        owners_ = assignFeatures(model.tri_indices,
                                 static_cast<std::size_t>(model.num_tris), count);
      });
      assert(owners_.size() == instance_.num_triangles);
      instance_.owners = owners_.data();
    }
    return;
  }
  measure([&] { prepareDeforming(model, name, num_threads); });
}

template <typename BV>
void PreparedMesh::requireIndices(const BVHModel<BV>& model, const std::string& name) {
  const auto num_vertices = static_cast<std::size_t>(model.num_vertices);
  const auto num_triangles = static_cast<std::size_t>(model.num_tris);
  const std::size_t bad = findOutOfRange(model.tri_indices, num_triangles, num_vertices);
  if (bad < 3 * num_triangles)
    throw Exception(name + ": triangle " + std::to_string(bad / 3) +
                    " refers to a vertex that is not there. The model has " +
                    std::to_string(num_vertices) + ", numbered from 0");
}

template <typename BV>
void PreparedMesh::prepareDeforming(const BVHModel<BV>& model, const std::string& name,
                                    int num_threads) {
  if (isDeforming(model))
    requireFinite(model.prev_vertices, model.num_vertices, name + ", previous frame");
  requireFinite(model.vertices, model.num_vertices, name + ", current frame");
  std::vector<std::int32_t> links(static_cast<std::size_t>(model.getNumBVs()));
  for (int i = 0; i < model.getNumBVs(); ++i)
    links[static_cast<std::size_t>(i)] = model.getBV(i).first_child;
  requireIndices(model, name);
  tree_.build(model.tri_indices, static_cast<std::size_t>(model.num_tris),
              static_cast<std::size_t>(model.num_vertices), links, num_threads);
  refit(name, num_threads);
}

template <typename Work>
void PreparedMesh::measure(Work&& work) {
  const Stopwatch start;
  work();
  update_time_ = start.seconds();
}

void PreparedMesh::refit(const std::string& name, int num_threads) {
  const DefaultFloatingPoint mode;
  tree_.refit(instance_.frames, num_threads);
  if (!areBoxesBounded(tree_)) requireFinite(tree_, instance_.frames, name);
  instance_.tree = &tree_;
  // The boxes have the poses already.
  for (auto& translation : instance_.translation)
    std::fill(translation, translation + 3, 0.);
}

#define FCL_CCD_INSTANTIATE(S)                                                  \
  template MeshClass meshClassOf(const CollisionGeometry<S>&);                  \
  template std::size_t numTrianglesOf(const CollisionGeometry<S>&);             \
  template PreparedMesh::PreparedMesh(const CollisionGeometry<S>&, const Pose&, \
                                      const Pose&, const std::string&, int,     \
                                      FeatureOwners);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

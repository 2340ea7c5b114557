// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TRAVERSAL_DEFORMABLECONTINUOUSCOLLISIONTRAVERSALNODE_H
#define FCL_TRAVERSAL_DEFORMABLECONTINUOUSCOLLISIONTRAVERSALNODE_H

#include <cstddef>
#include <memory>
#include <vector>

#include "fcl/narrowphase/collision_result.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/deformable/prepared_mesh.h"
#include "fcl/narrowphase/detail/deformable/triangle_pair_test.h"
#include "fcl/narrowphase/detail/traversal/collision/collision_traversal_node_base.h"

namespace fcl {
namespace detail {

namespace deformable {
class BinaryView;
}

/// @brief Traversal node for continuous collision between two meshes that deform or
/// translate, or of one with itself; made by initialize(), driven by FCL's collide(&node)
/// or selfCollide(&node). The trees are the models' moving 16-DOP trees (a rigid model's
/// own FCL tree, where that bounds it), whatever BV the models have.
///
/// The result receives one Contact for each VF or EE contact (b1, b2 triangles, pos and
/// normal if request.enable_contact, see ContinuousContact::normal; penetration depth 0),
/// the request.num_max_contacts earliest ones, in no order. Surfaces that cross at t = 0
/// without a VF or EE contact are one Contact too.
template <typename S>
class FCL_EXPORT DeformableContinuousCollisionTraversalNode
    : public CollisionTraversalNodeBase<S> {
 public:
  DeformableContinuousCollisionTraversalNode();
  ~DeformableContinuousCollisionTraversalNode() override;

  bool isFirstNodeLeaf(int b) const override;
  bool isSecondNodeLeaf(int b) const override;
  bool firstOverSecond(int b1, int b2) const override;
  int getFirstLeftChild(int b) const override;
  int getFirstRightChild(int b) const override;
  int getSecondLeftChild(int b) const override;
  int getSecondRightChild(int b) const override;

  /// @brief Whether the two nodes' moving boxes never overlap, or only after the earliest
  /// time that still matters.
  bool BVTesting(int b1, int b2) const override;
  void leafTesting(int b1, int b2) const override;
  bool canStop() const override;

  /// @brief First time of contact found so far, never later than the true one once the
  /// traversal is over; 0 when the surfaces cross at t = 0; 1 without contact.
  mutable S time_of_contact{1};

  /// @brief Whether an edge passes through a face at t = 0.
  bool isInitiallyCrossing() const;

  const StageCounts& counts() const;

  /// @brief Width of the contacts' time brackets; set before initialize().
  S toc_err{S(1e-4)};

  /// @brief What initialize() does.
  void start(const CollisionGeometry<S>& model1, const Transform3<S>& tf1_beg,
             const Transform3<S>& tf1_end, const CollisionGeometry<S>& model2,
             const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
             const CollisionRequest<S>& request, CollisionResult<S>& result);

  /// @brief What initialize() does for a model with itself.
  void startSelf(const CollisionGeometry<S>& model, const CollisionRequest<S>& request,
                 CollisionResult<S>& result);

 private:
  const deformable::MeshInstance& mesh1() const;
  const deformable::MeshInstance& mesh2() const;
  const deformable::BinaryView& view2() const;
  TimeWindow window(int b1, int b2) const;
  void requireValid(const CollisionRequest<S>& request) const;
  void begin(std::unique_ptr<deformable::PreparedMesh> prepared1,
             std::unique_ptr<deformable::PreparedMesh> prepared2,
             const CollisionRequest<S>& request, CollisionResult<S>& result);
  void report() const;
  Contact<S> toFcl(ContinuousContact<S> contact) const;

  const CollisionGeometry<S>* model1_{nullptr};
  const CollisionGeometry<S>* model2_{nullptr};
  std::unique_ptr<deformable::PreparedMesh> prepared1_;
  std::unique_ptr<deformable::PreparedMesh> prepared2_;  // null: with itself
  std::unique_ptr<deformable::TrianglePairTest> test_;
  std::unique_ptr<deformable::BinaryView> view1_;
  std::unique_ptr<deformable::BinaryView> view2_;  // null: with itself
  std::unique_ptr<deformable::KdopShift> shift_;   // null: with itself
  /// What the result held before.
  CollisionResult<S> earlier_;
  mutable std::size_t reported_{0};
  mutable bool crossing_reported_{false};
};

using DeformableContinuousCollisionTraversalNoded =
    DeformableContinuousCollisionTraversalNode<double>;
using DeformableContinuousCollisionTraversalNodef =
    DeformableContinuousCollisionTraversalNode<float>;

/// @brief Makes the node ready for FCL's collide(&node).
/// @return false, with nothing changed, if a geometry is not a triangle mesh, or is a
/// rigid one that rotates between its transforms.
/// @throws fcl::Exception as continuousCollide()
template <typename S>
FCL_EXPORT bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                           const CollisionGeometry<S>& model1,
                           const Transform3<S>& tf1_beg, const Transform3<S>& tf1_end,
                           const CollisionGeometry<S>& model2,
                           const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                           const CollisionRequest<S>& request,
                           CollisionResult<S>& result);

/// @brief The same for models whose transforms do not change during the step.
template <typename S>
bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                const CollisionGeometry<S>& model1, const Transform3<S>& tf1,
                const CollisionGeometry<S>& model2, const Transform3<S>& tf2,
                const CollisionRequest<S>& request, CollisionResult<S>& result) {
  return initialize(node, model1, tf1, tf1, model2, tf2, tf2, request, result);
}

/// @brief Makes the node ready for FCL's selfCollide(&node).
template <typename S>
FCL_EXPORT bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                           const CollisionGeometry<S>& model,
                           const CollisionRequest<S>& request,
                           CollisionResult<S>& result);

}  // namespace detail
}  // namespace fcl

#endif

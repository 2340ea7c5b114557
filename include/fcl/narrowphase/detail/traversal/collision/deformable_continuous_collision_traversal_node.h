// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TRAVERSAL_DEFORMABLECONTINUOUSCOLLISIONTRAVERSALNODE_H
#define FCL_TRAVERSAL_DEFORMABLECONTINUOUSCOLLISIONTRAVERSALNODE_H

#include <memory>

#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/collision_request.h"
#include "fcl/narrowphase/collision_result.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "fcl/narrowphase/detail/traversal/collision/collision_traversal_node_base.h"
#include "fcl/narrowphase/stage_counts.h"

namespace fcl {
namespace detail {

/// @brief The implementation of DeformableContinuousCollisionTraversalNode, in the
/// library. The node itself has FCL's transforms and is compiled with the program.
template <typename S>
class FCL_EXPORT DeformableTraversal {
 public:
  DeformableTraversal();
  ~DeformableTraversal();

  /// @return false, with nothing changed, if a geometry is not a triangle mesh or is a
  /// rigid mesh that turns. An exception also leaves the traversal unchanged.
  bool start(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2, S toc_err,
             const CollisionRequest<S>& request, CollisionResult<S>& result);
  bool startSelf(const CollisionGeometry<S>& model, S toc_err,
                 const CollisionRequest<S>& request, CollisionResult<S>& result);

  bool isFirstLeaf(int b) const;
  bool isSecondLeaf(int b) const;
  bool firstOverSecond(int b1, int b2) const;
  /// The right child has the next number.
  int firstLeftChild(int b) const;
  int secondLeftChild(int b) const;

  bool areApart(int b1, int b2);
  void testLeaves(int b1, int b2);
  bool isDone() const;

  S timeOfContact() const;
  bool isInitiallyCrossing() const;
  const StageCounts& counts() const;

 private:
  struct State;

  void report();

  /// Null until start().
  std::unique_ptr<State> state_;
};

extern template class DeformableTraversal<double>;
extern template class DeformableTraversal<float>;

/// @brief Traversal node for continuous collision between two meshes that deform or
/// translate, or of one mesh with itself. initialize() prepares it; FCL's collide(&node)
/// or selfCollide(&node) drives it. It walks the moving 16-DOP trees of the models,
/// whatever their BV, and the FCL tree of a rigid model if that bounds its triangles.
///
/// The result gets one Contact for each VF or EE contact: the request.num_max_contacts
/// earliest ones, in no order. b1 and b2 are triangles; pos and normal are set if
/// request.enable_contact (see ContinuousContact::normal); the penetration depth is 0.
/// Surfaces that cross at t = 0 without a VF or EE contact give one Contact too.
template <typename S>
class DeformableContinuousCollisionTraversalNode : public CollisionTraversalNodeBase<S> {
 public:
  bool isFirstNodeLeaf(int b) const override { return traversal_.isFirstLeaf(b); }
  bool isSecondNodeLeaf(int b) const override { return traversal_.isSecondLeaf(b); }
  bool firstOverSecond(int b1, int b2) const override {
    return traversal_.firstOverSecond(b1, b2);
  }
  int getFirstLeftChild(int b) const override { return traversal_.firstLeftChild(b); }
  int getFirstRightChild(int b) const override {
    return traversal_.firstLeftChild(b) + 1;
  }
  int getSecondLeftChild(int b) const override { return traversal_.secondLeftChild(b); }
  int getSecondRightChild(int b) const override {
    return traversal_.secondLeftChild(b) + 1;
  }

  /// @brief Whether the two nodes' moving boxes never overlap, or only after the earliest
  /// time that still matters.
  bool BVTesting(int b1, int b2) const override { return traversal_.areApart(b1, b2); }
  void leafTesting(int b1, int b2) const override {
    traversal_.testLeaves(b1, b2);
    time_of_contact = traversal_.timeOfContact();
  }
  bool canStop() const override { return traversal_.isDone(); }

  /// @brief The first time of contact found so far. After the traversal it is never later
  /// than the true one. 0 when the surfaces cross at t = 0; 1 without contact.
  mutable S time_of_contact{1};

  /// @brief Whether an edge passes through a face at t = 0.
  bool isInitiallyCrossing() const { return traversal_.isInitiallyCrossing(); }

  const StageCounts& counts() const { return traversal_.counts(); }

  /// @brief Largest width of the contacts' time brackets, in fractions of the step. Set
  /// it before initialize().
  S toc_err{S(1e-4)};

  /// @brief The implementation of initialize().
  bool start(const CollisionGeometry<S>& model1, const Transform3<S>& tf1_beg,
             const Transform3<S>& tf1_end, const CollisionGeometry<S>& model2,
             const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
             const CollisionRequest<S>& request, CollisionResult<S>& result) {
    if (!traversal_.start(detail::movingGeometry(&model1, tf1_beg, tf1_end),
                          detail::movingGeometry(&model2, tf2_beg, tf2_end), toc_err,
                          request, result))
      return false;
    begin(tf1_beg, tf2_beg, request, result);
    return true;
  }

  /// @brief The implementation of initialize() for a model with itself.
  bool startSelf(const CollisionGeometry<S>& model, const CollisionRequest<S>& request,
                 CollisionResult<S>& result) {
    if (!traversal_.startSelf(model, toc_err, request, result)) return false;
    begin(Transform3<S>::Identity(), Transform3<S>::Identity(), request, result);
    return true;
  }

 private:
  void begin(const Transform3<S>& tf1, const Transform3<S>& tf2,
             const CollisionRequest<S>& request, CollisionResult<S>& result) {
    // The arguments may lack the alignment of their type: see copyEntries().
    detail::setTransform(detail::toNumbers(tf1), this->tf1);
    detail::setTransform(detail::toNumbers(tf2), this->tf2);
    this->request = request;
    this->result = &result;
    time_of_contact = 1;
  }

  mutable DeformableTraversal<S> traversal_;
};

using DeformableContinuousCollisionTraversalNoded =
    DeformableContinuousCollisionTraversalNode<double>;
using DeformableContinuousCollisionTraversalNodef =
    DeformableContinuousCollisionTraversalNode<float>;

/// @brief Makes the node ready for FCL's collide(&node).
/// @return false, with nothing changed, if a geometry is not a triangle mesh or is a
/// rigid mesh that turns between its transforms
/// @throws fcl::Exception as continuousCollide()
template <typename S>
bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                const CollisionGeometry<S>& model1, const Transform3<S>& tf1_beg,
                const Transform3<S>& tf1_end, const CollisionGeometry<S>& model2,
                const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                const CollisionRequest<S>& request, CollisionResult<S>& result) {
  return node.start(model1, tf1_beg, tf1_end, model2, tf2_beg, tf2_end, request, result);
}

/// @brief The same for models whose transforms do not change during the step.
template <typename S>
bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                const CollisionGeometry<S>& model1, const Transform3<S>& tf1,
                const CollisionGeometry<S>& model2, const Transform3<S>& tf2,
                const CollisionRequest<S>& request, CollisionResult<S>& result) {
  return detail::initialize(node, model1, tf1, tf1, model2, tf2, tf2, request, result);
}

/// @brief Makes the node ready for FCL's selfCollide(&node).
template <typename S>
bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                const CollisionGeometry<S>& model, const CollisionRequest<S>& request,
                CollisionResult<S>& result) {
  return node.startSelf(model, request, result);
}

}  // namespace detail
}  // namespace fcl

#endif

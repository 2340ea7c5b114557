// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRAVERSAL_H
#define FCL_NARROWPHASE_DETAIL_DEFORMABLE_TRAVERSAL_H

#include <memory>

#include "fcl/geometry/collision_geometry.h"
#include "fcl/narrowphase/collision_request.h"
#include "fcl/narrowphase/collision_result.h"
#include "fcl/narrowphase/detail/deformable/stage_counts.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {
namespace detail {

/// @brief What DeformableContinuousCollisionTraversalNode does, in the library. The node
/// itself has FCL's transforms and is compiled with the program.
template <typename S>
class FCL_EXPORT DeformableTraversal {
 public:
  DeformableTraversal();
  ~DeformableTraversal();

  /// @return false, with nothing changed, if a geometry is not a triangle mesh, or is a
  /// rigid one that rotates. What throws leaves a traversal that was ready as it was.
  bool start(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2, S toc_err,
             const CollisionRequest<S>& request, CollisionResult<S>& result);
  bool startSelf(const CollisionGeometry<S>& model, S toc_err,
                 const CollisionRequest<S>& request, CollisionResult<S>& result);

  bool isFirstLeaf(int b) const;
  bool isSecondLeaf(int b) const;
  bool firstOverSecond(int b1, int b2) const;
  /// The right child is the next node.
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

}  // namespace detail
}  // namespace fcl

#endif

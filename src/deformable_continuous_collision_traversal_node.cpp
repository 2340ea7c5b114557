// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h"

#include "fcl/common/exception.h"
#include "fcl/narrowphase/detail/deformable/contact_conversion.h"
#include "fcl/narrowphase/detail/deformable/default_floating_point.h"
#include "fcl/narrowphase/detail/deformable/deformable_query.h"
#include "fcl/narrowphase/detail/deformable/traversal.h"

namespace fcl {
namespace detail {
namespace {

/// Calls visit with the tree that a query uses for the mesh.
template <typename Visit>
auto withTree(const deformable::MeshInstance& mesh, Visit&& visit) {
  return mesh.tree ? visit(*mesh.tree) : visit(mesh.rigid);
}

bool isLeaf(const deformable::MeshInstance& mesh, int b) {
  return withTree(mesh, [b](const auto& tree) { return tree.isLeaf(b); });
}

int leftChild(const deformable::MeshInstance& mesh, int b) {
  return withTree(mesh, [b](const auto& tree) { return tree.leftChild(b); });
}

int triangleOf(const deformable::MeshInstance& mesh, int b) {
  return withTree(mesh, [b](const auto& tree) { return tree.triangle(b); });
}

MovingKdop boxOf(const deformable::MeshInstance& mesh, int b) {
  return withTree(mesh, [b](const auto& tree) -> MovingKdop { return tree.box(b); });
}

}  // namespace

template <typename S>
DeformableContinuousCollisionTraversalNode<
    S>::DeformableContinuousCollisionTraversalNode() = default;

template <typename S>
const deformable::MeshInstance& DeformableContinuousCollisionTraversalNode<S>::mesh1()
    const {
  return prepared1_->instance();
}

template <typename S>
const deformable::MeshInstance& DeformableContinuousCollisionTraversalNode<S>::mesh2()
    const {
  return (prepared2_ ? prepared2_ : prepared1_)->instance();
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::start(
    const CollisionGeometry<S>& model1, const Transform3<S>& tf1_beg,
    const Transform3<S>& tf1_end, const CollisionGeometry<S>& model2,
    const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
    const CollisionRequest<S>& request, CollisionResult<S>& result) {
  auto prepared1 =
      std::make_unique<deformable::PreparedMesh>(model1, tf1_beg, tf1_end, "model1");
  prepared2_ =
      std::make_unique<deformable::PreparedMesh>(model2, tf2_beg, tf2_end, "model2");
  prepared1_ = std::move(prepared1);
  model1_ = &model1;
  model2_ = &model2;
  this->tf1 = tf1_beg;
  this->tf2 = tf2_beg;
  const deformable::DefaultFloatingPoint mode;
  shift_ = deformable::relativeShift(mesh1(), mesh2());
  begin(request, result);
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::startSelf(
    const CollisionGeometry<S>& model, const CollisionRequest<S>& request,
    CollisionResult<S>& result) {
  const Transform3<S> identity = Transform3<S>::Identity();
  prepared1_ =
      std::make_unique<deformable::PreparedMesh>(model, identity, identity, "model");
  prepared2_.reset();
  model1_ = model2_ = &model;
  this->tf1 = this->tf2 = identity;
  begin(request, result);
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::begin(
    const CollisionRequest<S>& request, CollisionResult<S>& result) {
  if (request.num_max_contacts == 0) throw Exception("request.num_max_contacts is 0");
  if (!(toc_err > 0)) throw Exception("toc_err is not positive");
  this->request = request;
  this->result = &result;
  deformable::QueryOptions options;
  options.max_contacts = request.num_max_contacts;
  options.toc_err = static_cast<double>(toc_err);
  test_ = std::make_unique<deformable::TrianglePairTest>(mesh1(), mesh2(), options);
  earlier_.clear();
  result.getContacts(earlier_);
  reported_ = 0;
  crossing_reported_ = false;
  time_of_contact = 1;
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::isFirstNodeLeaf(int b) const {
  return isLeaf(mesh1(), b);
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::isSecondNodeLeaf(int b) const {
  return isLeaf(mesh2(), b);
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::firstOverSecond(int b1,
                                                                    int b2) const {
  if (isSecondNodeLeaf(b2)) return true;
  return !isFirstNodeLeaf(b1) &&
         deformable::extent(boxOf(mesh1(), b1)) > deformable::extent(boxOf(mesh2(), b2));
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getFirstLeftChild(int b) const {
  return leftChild(mesh1(), b);
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getFirstRightChild(int b) const {
  return leftChild(mesh1(), b) + 1;
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getSecondLeftChild(int b) const {
  return leftChild(mesh2(), b);
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getSecondRightChild(int b) const {
  return leftChild(mesh2(), b) + 1;
}

template <typename S>
TimeWindow DeformableContinuousCollisionTraversalNode<S>::window(int b1, int b2) const {
  const MovingKdop box1 = boxOf(mesh1(), b1), box2 = boxOf(mesh2(), b2);
  return prepared2_ ? deformable::overlapWindow<true>(box1, box2, &shift_)
                    : deformable::overlapWindow<false>(box1, box2, nullptr);
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::BVTesting(int b1, int b2) const {
  ++test_->counts().node_pairs;
  const TimeWindow w = window(b1, b2);
  return w.isEmpty() || w.lo > test_->latest();
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::leafTesting(int b1, int b2) const {
  const deformable::DefaultFloatingPoint mode;
  try {
    test_->visit(triangleOf(mesh1(), b1), triangleOf(mesh2(), b2), window(b1, b2));
  } catch (const deformable::NonFiniteVertex& error) {
    throw Exception(error.what());
  }
  report();
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::canStop() const {
  return test_->isDone();
}

template <typename S>
Contact<S> DeformableContinuousCollisionTraversalNode<S>::toFcl(
    ContinuousContact<S> contact) const {
  contact.o1 = model1_;
  contact.o2 = model2_;
  return deformable::toContact(contact);
}

/// Brings the result up to date: contacts that are new, or, once some had to be dropped,
/// all that are kept.
template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::report() const {
  const auto convert = [this](const auto& contact) {
    return toFcl(deformable::toContinuousContact<S>(contact, mesh1(), mesh2(),
                                                    this->request.enable_contact));
  };
  const auto& contacts = test_->sink().contacts();
  const bool crosses = test_->hasCrossing();
  // A crossing stands in the result only while there is no contact.
  const bool drop_crossing = crossing_reported_ && !contacts.empty();
  if (test_->sink().isCut() || drop_crossing) {
    this->result->clear();
    for (const Contact<S>& contact : earlier_) this->result->addContact(contact);
    reported_ = 0;
    crossing_reported_ = false;
  }
  for (; reported_ < contacts.size(); ++reported_) {
    const auto& contact = contacts[reported_];
    const S toc = deformable::roundTimeDown<S>(contact.toc_lo);
    if (toc < time_of_contact) time_of_contact = toc;
    this->result->addContact(convert(contact));
  }
  if (!crosses) return;
  time_of_contact = 0;
  if (contacts.empty() && !crossing_reported_) {
    this->result->addContact(convert(test_->crossing()));
    crossing_reported_ = true;
  }
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::isInitiallyCrossing() const {
  return test_->hasCrossing();
}

template <typename S>
const StageCounts& DeformableContinuousCollisionTraversalNode<S>::counts() const {
  return test_->counts();
}

template <typename S>
bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                const CollisionGeometry<S>& model1, const Transform3<S>& tf1_beg,
                const Transform3<S>& tf1_end, const CollisionGeometry<S>& model2,
                const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,
                const CollisionRequest<S>& request, CollisionResult<S>& result) {
  using deformable::MeshKind;
  const auto accepts = [](const CollisionGeometry<S>& model, const Transform3<S>& beg,
                          const Transform3<S>& end) {
    const MeshKind kind = deformable::meshKindOf(model);
    return kind == MeshKind::kDeforming ||
           (kind == MeshKind::kRigid && beg.linear() == end.linear());
  };
  if (!accepts(model1, tf1_beg, tf1_end) || !accepts(model2, tf2_beg, tf2_end))
    return false;
  node.start(model1, tf1_beg, tf1_end, model2, tf2_beg, tf2_end, request, result);
  return true;
}

template <typename S>
bool initialize(DeformableContinuousCollisionTraversalNode<S>& node,
                const CollisionGeometry<S>& model, const CollisionRequest<S>& request,
                CollisionResult<S>& result) {
  if (deformable::meshKindOf(model) == deformable::MeshKind::kNotAMesh) return false;
  node.startSelf(model, request, result);
  return true;
}

#define FCL_CCD_INSTANTIATE(S)                                                      \
  template class DeformableContinuousCollisionTraversalNode<S>;                     \
  template bool initialize(DeformableContinuousCollisionTraversalNode<S>&,          \
                           const CollisionGeometry<S>&, const Transform3<S>&,       \
                           const Transform3<S>&, const CollisionGeometry<S>&,       \
                           const Transform3<S>&, const Transform3<S>&,              \
                           const CollisionRequest<S>&, CollisionResult<S>&);        \
  template bool initialize(DeformableContinuousCollisionTraversalNode<S>&,          \
                           const CollisionGeometry<S>&, const CollisionRequest<S>&, \
                           CollisionResult<S>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

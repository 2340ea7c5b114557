// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "fcl/common/exception.h"
#include "fcl/narrowphase/detail/deformable/contact_conversion.h"
#include "fcl/narrowphase/detail/deformable/default_floating_point.h"
#include "fcl/narrowphase/detail/deformable/deformable_query.h"
#include "fcl/narrowphase/detail/deformable/traversal.h"
#include "query_arguments.h"

namespace fcl {
namespace detail {
namespace deformable {

/// A tree of eight children a node, seen as the binary tree that FCL's traversal walks.
/// Node i stands for 15 binary nodes 16 i + k, k = 1 for all its children, 2 k and 2 k +
/// 1 for the two halves of k, 8 + lane for one child; such a child, if it is a node, is
/// the same as its own k = 1. The root is 0.
class BinaryView {
 public:
  explicit BinaryView(const MeshInstance& mesh) : tree_(mesh.tree) {
    if (!tree_) reader_ = std::make_unique<RigidTreeReader>(mesh.rigid);
  }

  bool isEmpty(int b) const { return firstLane(b) >= node(b).count; }

  bool isLeaf(int b) const {
    return placeOf(b) >= 8 && (isEmpty(b) || node(b).isTriangle(firstLane(b)));
  }
  int triangle(int b) const { return node(b).triangle(firstLane(b)); }

  int leftChild(int b) const {
    constexpr int kMostNodes = std::numeric_limits<int>::max() / 16;
    const int k = placeOf(b);
    if (k < 8) return 16 * (b / 16) + 2 * k;
    const int child = node(b).child[firstLane(b)];
    if (child >= kMostNodes) throw Exception("the tree has too many nodes for FCL's int");
    return 16 * child + 2;
  }

  /// The smallest box around the children, of which there is at least one.
  MovingKdop box(int b) const {
    const MovingKdopNode& n = node(b);
    MovingKdop out = n.box(firstLane(b));
    for (int lane = firstLane(b) + 1; lane < std::min(endLane(b), int{n.count}); ++lane) {
      const MovingKdop other = n.box(lane);
      for (int j = 0; j < 16; ++j) {
        out.t0.half[j] = std::max(out.t0.half[j], other.t0.half[j]);
        out.t1.half[j] = std::max(out.t1.half[j], other.t1.half[j]);
      }
    }
    return out;
  }

 private:
  static int placeOf(int b) { return std::max(b % 16, 1); }
  static int width(int b) {
    return placeOf(b) >= 8 ? 1 : placeOf(b) >= 4 ? 2 : placeOf(b) >= 2 ? 4 : 8;
  }
  static int firstLane(int b) { return placeOf(b) * width(b) - 8; }
  static int endLane(int b) { return firstLane(b) + width(b); }

  const MovingKdopNode& node(int b) const {
    if (tree_) return tree_->node(b / 16);
    // It may have to be made.
    const DefaultFloatingPoint mode;
    return reader_->node(b / 16);
  }

  const MovingKdopTree* tree_;
  std::unique_ptr<RigidTreeReader> reader_;
};

}  // namespace deformable

template <typename S>
DeformableContinuousCollisionTraversalNode<
    S>::DeformableContinuousCollisionTraversalNode() = default;

template <typename S>
DeformableContinuousCollisionTraversalNode<
    S>::~DeformableContinuousCollisionTraversalNode() = default;

template <typename S>
const deformable::BinaryView& DeformableContinuousCollisionTraversalNode<S>::view2()
    const {
  return view2_ ? *view2_ : *view1_;
}

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
  requireValid(request);
  const deformable::DefaultFloatingPoint mode;
  begin(std::make_unique<deformable::PreparedMesh>(model1, tf1_beg, tf1_end, "model1"),
        std::make_unique<deformable::PreparedMesh>(model2, tf2_beg, tf2_end, "model2"),
        request, result);
  model1_ = &model1;
  model2_ = &model2;
  this->tf1 = tf1_beg;
  this->tf2 = tf2_beg;
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::startSelf(
    const CollisionGeometry<S>& model, const CollisionRequest<S>& request,
    CollisionResult<S>& result) {
  requireValid(request);
  const deformable::DefaultFloatingPoint mode;
  const Transform3<S> identity = Transform3<S>::Identity();
  begin(std::make_unique<deformable::PreparedMesh>(model, identity, identity, "model"),
        nullptr, request, result);
  model1_ = model2_ = &model;
  this->tf1 = this->tf2 = identity;
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::requireValid(
    const CollisionRequest<S>& request) const {
  if (request.num_max_contacts == 0) throw Exception("request.num_max_contacts is 0");
  if (!(toc_err > 0)) throw Exception("toc_err is not positive");
}

/// All is made before anything changes: a node that was ready stays so if it fails.
/// @param prepared2  null: the first with itself
template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::begin(
    std::unique_ptr<deformable::PreparedMesh> prepared1,
    std::unique_ptr<deformable::PreparedMesh> prepared2,
    const CollisionRequest<S>& request, CollisionResult<S>& result) {
  const deformable::MeshInstance &mesh1 = prepared1->instance(),
                                 &mesh2 = (prepared2 ? prepared2 : prepared1)->instance();
  std::unique_ptr<deformable::KdopShift> shift;
  std::unique_ptr<deformable::BinaryView> view2;
  if (prepared2) {
    shift =
        std::make_unique<deformable::KdopShift>(deformable::relativeShift(mesh1, mesh2));
    view2 = std::make_unique<deformable::BinaryView>(mesh2);
  }
  deformable::QueryOptions options;
  options.max_contacts = request.num_max_contacts;
  options.toc_err = static_cast<double>(toc_err);
  auto test =
      std::make_unique<deformable::TrianglePairTest>(mesh1, mesh2, shift.get(), options);
  auto view1 = std::make_unique<deformable::BinaryView>(mesh1);
  CollisionResult<S> earlier = result;

  this->request = request;
  this->result = &result;
  test_ = std::move(test);
  view1_ = std::move(view1);
  view2_ = std::move(view2);
  shift_ = std::move(shift);
  prepared1_ = std::move(prepared1);
  prepared2_ = std::move(prepared2);
  std::swap(earlier_, earlier);
  reported_ = 0;
  crossing_reported_ = false;
  time_of_contact = 1;
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::isFirstNodeLeaf(int b) const {
  return view1_->isLeaf(b);
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::isSecondNodeLeaf(int b) const {
  return view2().isLeaf(b);
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::firstOverSecond(int b1,
                                                                    int b2) const {
  if (isSecondNodeLeaf(b2)) return true;
  if (isFirstNodeLeaf(b1)) return false;
  const auto extent = [](const MovingKdop& box) {
    float sum = 0;
    for (int k = 0; k < 3; ++k) sum += box.t0.half[k] + box.t0.half[k + 8];
    return sum;
  };
  return extent(view1_->box(b1)) > extent(view2().box(b2));
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getFirstLeftChild(int b) const {
  return view1_->leftChild(b);
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getFirstRightChild(int b) const {
  return view1_->leftChild(b) + 1;
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getSecondLeftChild(int b) const {
  return view2().leftChild(b);
}

template <typename S>
int DeformableContinuousCollisionTraversalNode<S>::getSecondRightChild(int b) const {
  return view2().leftChild(b) + 1;
}

template <typename S>
TimeWindow DeformableContinuousCollisionTraversalNode<S>::window(int b1, int b2) const {
  const MovingKdop box1 = view1_->box(b1), box2 = view2().box(b2);
  return prepared2_ ? deformable::overlapWindow<true>(box1, box2, shift_.get())
                    : deformable::overlapWindow<false>(box1, box2, nullptr);
}

template <typename S>
bool DeformableContinuousCollisionTraversalNode<S>::BVTesting(int b1, int b2) const {
  const deformable::DefaultFloatingPoint mode;
  if (view1_->isEmpty(b1) || view2().isEmpty(b2)) return true;
  ++test_->counts().node_pairs;
  const TimeWindow w = window(b1, b2);
  return w.isEmpty() || w.lo > test_->latest();
}

template <typename S>
void DeformableContinuousCollisionTraversalNode<S>::leafTesting(int b1, int b2) const {
  const deformable::DefaultFloatingPoint mode;
  try {
    const deformable::LeafPair pair{view1_->triangle(b1), view2().triangle(b2),
                                    window(b1, b2).lo};
    const deformable::LeafPair* next = &pair;
    test_->visit(next, next + 1);
    test_->flush();
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
    *this->result = earlier_;
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
  const auto placed1 = withoutRounding(model1, Placement<S>{tf1_beg, tf1_end}),
             placed2 = withoutRounding(model2, Placement<S>{tf2_beg, tf2_end});
  if (!isAnsweredHere(model1, placed1.isRotating(), model2, placed2.isRotating()))
    return false;
  node.start(model1, placed1.beginning, placed1.end, model2, placed2.beginning,
             placed2.end, request, result);
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

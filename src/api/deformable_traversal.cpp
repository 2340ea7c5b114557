// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>
#include <utility>

#include "api/contact_conversion.h"
#include "base/default_floating_point.h"
#include "fcl/common/exception.h"
#include "mesh/non_finite_vertex.h"
#include "prepare/query_arguments.h"
#include "query/deformable_query.h"
#include "query/narrow_phase.h"
#include "tree/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {

/// A tree with eight children a node, seen as the binary tree that FCL's traversal walks.
/// Node i stands for 15 binary nodes 16 i + k: k = 1 for all its children, 2 k and 2 k +
/// 1 for the two halves of k, and 8 + lane for one child. If such a child is a node, it
/// is the same as its own k = 1. The root is 0.
class BinaryView {
 public:
  explicit BinaryView(const MeshInstance& mesh) : tree_(mesh.tree) {
    if (!tree_) reader_ = std::make_unique<RigidTreeReader>(mesh.rigid);
  }

  bool isEmpty(int b) const { return firstLane(b) >= node(b).count; }

  bool isLeaf(int b) const {
    return heapIndex(b) >= 8 && (isEmpty(b) || node(b).isTriangle(firstLane(b)));
  }
  int triangle(int b) const {
    assert(isLeaf(b) && !isEmpty(b));
    return node(b).triangle(firstLane(b));
  }

  int leftChild(int b) const {
    constexpr int kMostNodes = std::numeric_limits<int>::max() / 16;
    const int k = heapIndex(b);
    assert(!isLeaf(b));
    if (k < 8) return 16 * (b / 16) + 2 * k;
    const int child = node(b).child[firstLane(b)];
    if (child >= kMostNodes)
      throw Exception(
          "a model's tree has more nodes than FCL's traversal can number. Use "
          "continuousCollide() or continuousSelfCollide(), which have no such limit");
    return 16 * child + 2;
  }

  /// The smallest box around the children, of which there is at least one.
  MovingKdop box(int b) const {
    const MovingKdopNode& n = node(b);
    assert(firstLane(b) < n.count);
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
  static int heapIndex(int b) { return std::max(b % 16, 1); }
  static int width(int b) {
    return heapIndex(b) >= 8 ? 1 : heapIndex(b) >= 4 ? 2 : heapIndex(b) >= 2 ? 4 : 8;
  }
  static int firstLane(int b) { return heapIndex(b) * width(b) - 8; }
  static int endLane(int b) { return firstLane(b) + width(b); }

  const MovingKdopNode& node(int b) const {
    if (tree_) return tree_->node(b / 16);
    // The reader may have to make the node.
    const DefaultFloatingPoint mode;
    return reader_->node(b / 16);
  }

  const MovingKdopTree* tree_;
  std::unique_ptr<RigidTreeReader> reader_;
};

}  // namespace deformable

/// A traversal that is ready. It is complete before it replaces another one.
template <typename S>
struct DeformableTraversal<S>::State {
  /// @param prepared2  null: the first mesh with itself
  State(const CollisionGeometry<S>& o1, const CollisionGeometry<S>& o2,
        std::unique_ptr<deformable::PreparedMesh> prepared1,
        std::unique_ptr<deformable::PreparedMesh> prepared2,
        const deformable::QueryOptions& options, CollisionResult<S>& result)
      : o1(o1),
        o2(o2),
        prepared1(std::move(prepared1)),
        prepared2(std::move(prepared2)),
        view1(mesh1()),
        describe(mesh1(), mesh2(), options),
        result(result),
        earlier(result) {
    if (this->prepared2) {
      shift = std::make_unique<deformable::KdopShift>(
          deformable::relativeShift(mesh1(), mesh2()));
      second_view = std::make_unique<deformable::BinaryView>(mesh2());
    }
    shifts = deformable::BoxShifts(shift.get());
    test = std::make_unique<deformable::NarrowPhase>(mesh1(), mesh2(), shifts, options,
                                                     progress, 0, &first);
  }

  const deformable::MeshInstance& mesh1() const { return prepared1->instance(); }
  const deformable::MeshInstance& mesh2() const {
    return (prepared2 ? prepared2 : prepared1)->instance();
  }
  const deformable::BinaryView& view2() const {
    return second_view ? *second_view : view1;
  }

  deformable::TimeWindow window(int b1, int b2) const {
    const deformable::MovingKdop box1 = view1.box(b1), box2 = view2().box(b2);
    return prepared2 ? deformable::overlapWindow<true>(box1, box2, shift.get())
                     : deformable::overlapWindow<false>(box1, box2, nullptr);
  }

  const CollisionGeometry<S>& o1;
  const CollisionGeometry<S>& o2;
  const std::unique_ptr<deformable::PreparedMesh> prepared1;
  const std::unique_ptr<deformable::PreparedMesh> prepared2;  // null: with itself
  const deformable::BinaryView view1;
  std::unique_ptr<deformable::BinaryView> second_view;  // null: with itself
  std::unique_ptr<deformable::KdopShift> shift;         // null: with itself
  deformable::BoxShifts shifts;
  deformable::QueryProgress progress;
  deformable::FirstBracket first;
  std::unique_ptr<deformable::NarrowPhase> test;
  const deformable::ContactDescriber describe;
  CollisionResult<S>& result;
  /// The contacts that the result had before.
  const CollisionResult<S> earlier;
  std::size_t reported{0};
  bool crossing_reported{false};
  S time_of_contact{1};
};

namespace {

template <typename S>
deformable::QueryOptions makeOptions(S toc_err, const CollisionRequest<S>& request) {
  if (request.num_max_contacts == 0)
    throw Exception("request.num_max_contacts is 0. Give 1 or more");
  deformable::QueryOptions options;
  options.max_contacts = request.num_max_contacts;
  options.toc_err = requireTocErr(static_cast<double>(toc_err), "toc_err");
  options.with_geometry = request.enable_contact;
  return options;
}

}  // namespace

template <typename S>
DeformableTraversal<S>::DeformableTraversal() = default;

template <typename S>
DeformableTraversal<S>::~DeformableTraversal() = default;

template <typename S>
bool DeformableTraversal<S>::start(const MovingGeometry<S>& o1,
                                   const MovingGeometry<S>& o2, S toc_err,
                                   const CollisionRequest<S>& request,
                                   CollisionResult<S>& result) {
  const deformable::DefaultFloatingPoint mode;
  const PlacedGeometry<S> placed1(o1), placed2(o2);
  for (const PlacedGeometry<S>* placed : {&placed1, &placed2})
    if (!placed->isMesh() || !placed->goesStraight()) return false;
  const deformable::QueryOptions options = makeOptions(toc_err, request);
  const auto prepared = [](const PlacedGeometry<S>& o, const char* name) {
    return std::make_unique<deformable::PreparedMesh>(o.geometry(), o.beginning(),
                                                      o.end(), name);
  };
  auto mesh1 = prepared(placed1, "model1"), mesh2 = prepared(placed2, "model2");
  state_ = std::make_unique<State>(*o1.geometry, *o2.geometry, std::move(mesh1),
                                   std::move(mesh2), options, result);
  return true;
}

template <typename S>
bool DeformableTraversal<S>::startSelf(const CollisionGeometry<S>& model, S toc_err,
                                       const CollisionRequest<S>& request,
                                       CollisionResult<S>& result) {
  if (deformable::meshKindOf(model) == deformable::MeshKind::kNotAMesh) return false;
  const deformable::QueryOptions options = makeOptions(toc_err, request);
  const deformable::DefaultFloatingPoint mode;
  const deformable::Pose still;
  state_ = std::make_unique<State>(
      model, model,
      std::make_unique<deformable::PreparedMesh>(model, still, still, "model"), nullptr,
      options, result);
  return true;
}

template <typename S>
bool DeformableTraversal<S>::isFirstLeaf(int b) const {
  return state_->view1.isLeaf(b);
}

template <typename S>
bool DeformableTraversal<S>::isSecondLeaf(int b) const {
  return state_->view2().isLeaf(b);
}

template <typename S>
bool DeformableTraversal<S>::firstOverSecond(int b1, int b2) const {
  if (isSecondLeaf(b2)) return true;
  if (isFirstLeaf(b1)) return false;
  const auto extent = [](const deformable::MovingKdop& box) {
    float sum = 0;
    for (int k = 0; k < 3; ++k) sum += box.t0.half[k] + box.t0.half[k + 8];
    return sum;
  };
  return extent(state_->view1.box(b1)) > extent(state_->view2().box(b2));
}

template <typename S>
int DeformableTraversal<S>::firstLeftChild(int b) const {
  return state_->view1.leftChild(b);
}

template <typename S>
int DeformableTraversal<S>::secondLeftChild(int b) const {
  return state_->view2().leftChild(b);
}

template <typename S>
bool DeformableTraversal<S>::areApart(int b1, int b2) {
  const deformable::DefaultFloatingPoint mode;
  if (state_->view1.isEmpty(b1) || state_->view2().isEmpty(b2)) return true;
  ++state_->test->findings().counts().node_pairs;
  const deformable::TimeWindow w = state_->window(b1, b2);
  return w.isEmpty() || w.lo > deformable::lastBeginning(state_->test->latest());
}

template <typename S>
void DeformableTraversal<S>::testLeaves(int b1, int b2) {
  const deformable::DefaultFloatingPoint mode;
  try {
    const deformable::LeafPair pair{state_->view1.triangle(b1),
                                    state_->view2().triangle(b2),
                                    state_->window(b1, b2).lo};
    const deformable::LeafPair* next = &pair;
    state_->test->collect(next, next + 1);
    state_->test->decide();
  } catch (const deformable::NonFiniteVertex& error) {
    throw Exception(error.what());
  }
  report();
}

template <typename S>
bool DeformableTraversal<S>::isDone() const {
  return state_->test->isDone();
}

/// Brings the result up to date: adds the new contacts or, once some were dropped, writes
/// all that are kept.
template <typename S>
void DeformableTraversal<S>::report() {
  State& state = *state_;
  const auto convert = [&state](const auto& contact) {
    return deformable::toContact(
        deformable::toContinuousContact<S>(state.describe(contact), state.o1, state.o2));
  };
  const auto& contacts = state.test->findings().sink().contacts();
  // A crossing is in the result only while there is no contact.
  const bool drop_crossing = state.crossing_reported && !contacts.empty();
  if (state.test->findings().sink().isCut() || drop_crossing) {
    state.result = state.earlier;
    state.reported = 0;
    state.crossing_reported = false;
  }
  for (; state.reported < contacts.size(); ++state.reported) {
    state.result.addContact(convert(contacts[state.reported]));
  }
  if (!contacts.empty())
    state.time_of_contact = deformable::roundTimeDown<S>(state.first.get().lo);
  if (!state.test->findings().hasCrossing()) return;
  state.time_of_contact = 0;
  if (contacts.empty() && !state.crossing_reported) {
    state.result.addContact(convert(state.test->findings().crossings().front()));
    state.crossing_reported = true;
  }
}

template <typename S>
S DeformableTraversal<S>::timeOfContact() const {
  return state_->time_of_contact;
}

template <typename S>
bool DeformableTraversal<S>::isInitiallyCrossing() const {
  return state_->test->findings().hasCrossing();
}

template <typename S>
const StageCounts& DeformableTraversal<S>::counts() const {
  return state_->test->findings().counts();
}

template class DeformableTraversal<double>;
template class DeformableTraversal<float>;

}  // namespace detail
}  // namespace fcl

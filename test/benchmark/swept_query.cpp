// SPDX-License-Identifier: BSD-3-Clause
#include "swept_query.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "swept_tree.h"
#include "timing.h"
#include "traverse.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;

PairName nameOf(const deformable::FeatureContact& contact) {
  const auto id = [&contact](int k) { return static_cast<int>(contact.vertices[k]); };
  return pairName(contact.kind == fcl::ContinuousContactKind::kVertexFace
                      ? ContinuousContactKind::kVertexFace
                      : ContinuousContactKind::kEdgeEdge,
                  {id(0), id(1), id(2), id(3)});
}

}  // namespace

SweptContacts sweptSelfContacts(const detail::DeformableMesh& model, bool with_fans) {
  const SweptTree tree(model.movingTree());
  deformable::MeshInstance instance;
  instance.frames = model.frames();
  instance.tree = &model.movingTree();
  const deformable::BoxShifts shifts;
  deformable::QueryProgress progress;
  deformable::NarrowPhase narrow_phase(instance, instance, shifts,
                                       deformable::QueryOptions(), progress);
  SweptContacts found;
  std::vector<deformable::LeafPair> pairs;
  found.ms_traverse = millisecondsOf([&] {
    std::vector<std::uint8_t> embedded;
    if (with_fans) embedded = embeddedFans(model.movingTree());
    narrow_phase.findings().counts().node_pairs =
        traverse<true>(tree, tree, nullptr,
                       [&](int a, int b, float) {
                         pairs.push_back({a, b, 0.f});
                       },
                       1, {with_fans ? embedded.data() : nullptr});
  });
  found.ms_test = millisecondsOf([&] {
    const deformable::LeafPair* next = pairs.data();
    for (std::size_t left = pairs.size(); left > 0; narrow_phase.decide()) {
      const std::size_t size = std::min(deformable::FeatureBatch::kMaxPairs, left);
      narrow_phase.collect(next, next + size);
      left -= size;
    }
  });
  found.counts = narrow_phase.findings().counts();
  for (const auto& contact : narrow_phase.findings().sink().contacts())
    found.pairs.push_back(nameOf(contact));
  return found;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/deformable_query.h"

#include <chrono>

#include "fcl/narrowphase/detail/deformable/default_floating_point.h"
#include "fcl/narrowphase/detail/deformable/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct LeafPair {
  std::int32_t a, b;
  TimeWindow window;
};

/// Triangle pairs are visited in blocks: the tree and the vertices do not push each other
/// out of the cache at every pair, and the clock is read once a block. A first-contact
/// query uses small blocks, since each contact found prunes what follows.
constexpr std::size_t kBlock = 1024;
constexpr std::size_t kFirstBlock = 32;

/// @tparam Leaves  TrianglePairTest or CandidateCollector
template <bool kSelf, typename TreeA, typename TreeB, typename Leaves>
void run(TreeA& tree_a, TreeB& tree_b, const KdopShift* shift, Leaves& leaves,
         std::size_t block_size, StageTimes& times) {
  std::vector<NodePair> open;
  std::vector<LeafPair> block;
  block.reserve(block_size);
  const auto start = Clock::now();

  const auto visitBlock = [&] {
    const auto visit_start = Clock::now();
    for (const LeafPair& p : block) {
      if (p.window.lo > leaves.latest()) continue;
      leaves.visit(p.a, p.b, p.window);
      if (leaves.isDone()) break;
    }
    block.clear();
    times.test += secondsSince(visit_start);
    return !leaves.isDone();
  };
  leaves.counts().node_pairs += traverse<kSelf>(
      tree_a, tree_b, shift, open, [&] { return leaves.latest(); },
      [&](int a, int b, TimeWindow window) {
        block.push_back({a, b, window});
        return block.size() < block_size || visitBlock();
      });
  if (!leaves.isDone()) visitBlock();
  times.traverse += secondsSince(start) - times.test;
}

/// Calls visit with the tree to traverse.
template <typename Visit>
void visitTree(const MeshInstance& mesh, Visit&& visit) {
  if (mesh.tree)
    visit(*mesh.tree);
  else
    visit(RigidTreeReader(mesh.rigid));
}

template <typename Leaves>
StageTimes runSelf(const MeshInstance& a, Leaves& leaves, std::size_t block) {
  StageTimes times;
  visitTree(a,
            [&](auto&& tree) { run<true>(tree, tree, nullptr, leaves, block, times); });
  return times;
}

template <typename Leaves>
StageTimes runPair(const MeshInstance& a, const MeshInstance& b, Leaves& leaves,
                   std::size_t block) {
  StageTimes times;
  const KdopShift shift = relativeShift(a, b);
  visitTree(a, [&](auto&& tree_a) {
    visitTree(b, [&](auto&& tree_b) {
      run<false>(tree_a, tree_b, &shift, leaves, block, times);
    });
  });
  return times;
}

std::size_t blockFor(const QueryOptions& options) {
  return options.goal == QueryGoal::kAll ? kBlock : kFirstBlock;
}

QueryAnswer collect(TrianglePairTest& leaves, const StageTimes& times) {
  QueryAnswer answer;
  answer.cut = leaves.sink().isCut();
  answer.has_crossing = leaves.hasCrossing();
  answer.crossing = leaves.crossing();
  answer.contacts = leaves.sink().takeSorted();
  answer.counts = leaves.counts();
  answer.times = times;
  return answer;
}

}  // namespace

QueryAnswer querySelf(const MeshInstance& a, const QueryOptions& options) {
  const DefaultFloatingPoint mode;
  TrianglePairTest leaves(a, a, options);
  const StageTimes times = runSelf(a, leaves, blockFor(options));
  return collect(leaves, times);
}

QueryAnswer queryPair(const MeshInstance& a, const MeshInstance& b,
                      const QueryOptions& options) {
  const DefaultFloatingPoint mode;
  TrianglePairTest leaves(a, b, options);
  const StageTimes times = runPair(a, b, leaves, blockFor(options));
  return collect(leaves, times);
}

bool candidatesSelf(const MeshInstance& a, const CandidateSink& sink) {
  const DefaultFloatingPoint mode;
  CandidateCollector leaves(a, a, sink);
  runSelf(a, leaves, kBlock);
  leaves.finish();
  return !leaves.isDone();
}

bool candidatesPair(const MeshInstance& a, const MeshInstance& b,
                    const CandidateSink& sink) {
  const DefaultFloatingPoint mode;
  CandidateCollector leaves(a, b, sink);
  runPair(a, b, leaves, kBlock);
  leaves.finish();
  return !leaves.isDone();
}

KdopShift relativeShift(const MeshInstance& a, const MeshInstance& b) {
  return relativeShift(a.tree ? a.tree->origin() : a.rigid.origin(), a.translation,
                       a.tree ? a.tree->reach() : a.rigid.reach(),
                       b.tree ? b.tree->origin() : b.rigid.origin(), b.translation,
                       b.tree ? b.tree->reach() : b.rigid.reach());
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

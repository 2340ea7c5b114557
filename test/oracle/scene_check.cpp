// SPDX-License-Identifier: BSD-3-Clause
#include "scene_check.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <sstream>
#include <utility>
#include <vector>

#include "elementary/coplanarity_filter.h"
#include "elementary/exact.h"
#include "exact_oracle.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "feature_pair_generators.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "owned_features.h"
#include "query/feature_batch.h"
#include "swept_tree.h"
#include "traverse.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;
using deformable::Answer;
using deformable::FeaturePair;
using deformable::MeshTriangle;
using fcl::ContinuousContactKind;

using Model = DeformableBVHModel<KDOP<double, 16>>;
using Indices = std::pair<int, int>;

enum StageIndex { kFar, kNear, kFans, kBoxes, kFilter, kSolver, kIntegers };

/// The tolerance of a query that asks for none.
constexpr double kTocErr = 1e-4;

Indices inOrder(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// A pair of features whatever the order of its ids.
using PairKey = std::pair<ContinuousContactKind, std::array<std::uint32_t, 4>>;

PairKey keyOf(ContinuousContactKind kind, std::array<std::uint32_t, 4> v) {
  if (kind == ContinuousContactKind::kVertexFace) {
    std::sort(v.begin() + 1, v.end());
    return {kind, v};
  }
  std::sort(v.begin(), v.begin() + 2);
  std::sort(v.begin() + 2, v.end());
  if (v[2] < v[0] || (v[2] == v[0] && v[3] < v[1])) std::rotate(&v[0], &v[2], &v[0] + 4);
  return {kind, v};
}

deformable::MeshInstance instanceOf(const Model& model) {
  deformable::MeshInstance instance;
  instance.frames = model.frames();
  instance.tree = &model.movingTree();
  return instance;
}

class CullCheck {
 public:
  CullCheck(const Model& model, const CullCheckOptions& options)
      : model_(model),
        options_(options),
        random_(options.seed),
        instance_(instanceOf(model)),
        batch_(instance_, instance_, nullptr, deformable::kernels()) {}

  /// What a query does to a visited triangle pair, stage by stage.
  void addVisited(int a, int b) {
    std::vector<PairKey> left;
    StageCounts counts;
    const deformable::LeafPair leaves{a, b, 0.f};
    const deformable::LeafPair* next = &leaves;
    batch_.add(next, next + 1, {1, false}, counts);
    batch_.cullTriangles(1, counts);
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      batch_.cull(kind, 1, counts);
      for (std::size_t i = 0; i < batch_.size(kind); ++i) {
        deformable::FeatureCandidate c;
        batch_.setCandidate(batch_.codes(kind)[i], batch_.windows(kind)[i], c);
        left.push_back(
            keyOf(c.kind, {c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]}));
        addCandidate(c, deformable::kernels().coplanarity(
                            kind, batch_.pairs(), batch_.codes(kind) + i,
                            batch_.windows(kind) + i, 1, 1.));
      }
    }
    batch_.clear();
    forEachPair(a, b, [&](const MovingPair& pair, const PairKey& key) {
      if (std::find(left.begin(), left.end(), key) == left.end()) addCulled(kBoxes, pair);
    });
  }

  /// A triangle pair that is not looked at.
  void addUnvisited(StageIndex stage, int a, int b) {
    forEachPair(a, b,
                [&](const MovingPair& pair, const PairKey&) { addCulled(stage, pair); });
  }

  CullReport finish() {
    for (std::size_t i = 0; i < samples_.size(); ++i)
      for (const MovingPair& pair : samples_[i]) {
        CulledByStage& stage = report_.stages[i];
        if (!options_.decide_all) decide(stage, pair);
        ++stage.asked;
        if (askOracle(pair.kind, pair.points()).touch()) complain(stage, pair, "oracle");
      }
    return report_;
  }

 private:
  /// @param found  by the filter
  void addCandidate(const deformable::FeatureCandidate& c,
                    const deformable::EightCoplanarities& found) {
    MovingPair pair{c.kind, {}};
    deformable::EightPairs eight;
    eight.kind = c.kind;
    for (std::size_t i = 0; i < 8; ++i) eight.set(i, c.x, c.window_lo, c.window_hi);
    for (std::size_t i = 0; i < 4; ++i) pair.x[i] = model_.frames()[c.vertices[i]];
    if (found.possible == 0 &&
        (found.unclear == 0 || !mayBecomeCoplanarAccurately(pair.kind, pair.points(),
                                                            c.window_lo, c.window_hi))) {
      addCulled(kFilter, pair);
      return;
    }
    if (deformable::kernels().solve(eight, kTocErr).no != 0) {
      addCulled(kSolver, pair);
      return;
    }
    const Answer solved =
        solveCoplanarity(pair.kind, pair.points(), c.window_lo, c.window_hi, kTocErr)
            .answer;
    if (solved == Answer::kNo)
      addCulled(kSolver, pair);
    else if (solved == Answer::kUnsure &&
             decideExactly(pair.kind, pair.points(), kTocErr).answer == Answer::kNo)
      addCulled(kIntegers, pair);
  }

  template <typename Visit>
  void forEachPair(int a, int b, Visit&& visit) const {
    const MeshTriangle ta = triangleOf(model_.movingTree(), a),
                       tb = triangleOf(model_.movingTree(), b);
    forEachFeaturePair<true>(ta, tb, [&](const FeaturePair& f) {
      const MeshTriangle &first = f.first_on_a ? ta : tb, &other = f.first_on_a ? tb : ta;
      const std::uint32_t vertex = first.v[f.first];
      const std::array<std::uint32_t, 4> ids =
          f.kind == ContinuousContactKind::kVertexFace
              ? std::array<std::uint32_t, 4>{vertex, other.v[0], other.v[1], other.v[2]}
              : std::array<std::uint32_t, 4>{vertex, ta.v[(f.first + 1) % 3],
                                             tb.v[f.second], tb.v[(f.second + 1) % 3]};
      MovingPair pair{f.kind, {}};
      for (std::size_t i = 0; i < 4; ++i) pair.x[i] = model_.frames()[ids[i]];
      visit(pair, keyOf(f.kind, ids));
    });
  }

  void addCulled(StageIndex index, const MovingPair& pair) {
    CulledByStage& stage = report_.stages[index];
    std::vector<MovingPair>& sample = samples_[index];
    ++stage.culled;
    if (options_.decide_all) decide(stage, pair);
    // Reservoir: every pair of the stage has the same chance.
    if (sample.size() < options_.oracle_samples) {
      sample.push_back(pair);
    } else {
      const std::size_t place = random_.index(stage.culled);
      if (place < sample.size()) sample[place] = pair;
    }
  }

  void decide(CulledByStage& stage, const MovingPair& pair) {
    ++stage.decided;
    if (decideExactly(pair.kind, pair.points(), kTocErr).answer != Answer::kNo)
      complain(stage, pair, "decideExactly()");
  }

  void complain(CulledByStage& stage, const MovingPair& pair, const char* who) {
    ++stage.contacts;
    if (!report_.example.empty()) return;
    std::ostringstream text;
    text << "culled by " << stage.name << ", a contact by " << who << ": " << pair;
    report_.example = text.str();
  }

  const Model& model_;
  const CullCheckOptions& options_;
  Random random_;
  deformable::MeshInstance instance_;
  deformable::FeatureBatch batch_;
  CullReport report_;
  std::array<std::vector<MovingPair>, 7> samples_;
};

}  // namespace

std::size_t CullReport::contacts() const {
  std::size_t sum = 0;
  for (const CulledByStage& stage : stages) sum += stage.contacts;
  return sum;
}

CullReport checkCulledPairs(const FramePairMesh& mesh, const CullCheckOptions& options) {
  Model model;
  model.beginModel(static_cast<int>(mesh.triangles.size()),
                   static_cast<int>(mesh.previous.size()));
  model.addSubModel(mesh.previous, mesh.triangles);
  model.endModel(FclTree::kSkip);
  model.updateFrames(mesh.previous.front().data(), mesh.current.front().data(),
                     mesh.previous.size(), FclTree::kSkip);

  CullCheck check(model, options);
  std::vector<Indices> visited;
  const deformable::MovingKdopTree& tree = model.movingTree();
  const std::vector<std::uint8_t> embedded = embeddedFans(tree);
  const auto visit = [&](int a, int b, float) {
    visited.push_back(inOrder(a, b));
    check.addVisited(a, b);
  };
  traverse<true>(tree, tree, nullptr, visit, 1, {embedded.data()});
  std::sort(visited.begin(), visited.end());
  const auto isVisited = [&visited](int a, int b) {
    return std::binary_search(visited.begin(), visited.end(), inOrder(a, b));
  };
  // Triangle pairs whose boxes meet and that lie in one embedded fan.
  std::vector<Indices> in_fans;
  traverse<true>(tree, tree, nullptr, [&](int a, int b, float) {
    if (!isVisited(a, b)) in_fans.push_back(inOrder(a, b));
  });
  for (const Indices& pair : in_fans) check.addUnvisited(kFans, pair.first, pair.second);
  visited.insert(visited.end(), in_fans.begin(), in_fans.end());
  std::sort(visited.begin(), visited.end());

  // Triangle pairs that only their motion keeps apart.
  const SweptTree swept(tree);
  traverse<true>(swept, swept, nullptr, [&](int a, int b, float) {
    if (!isVisited(a, b)) check.addUnvisited(kNear, a, b);
  });
  Random random(options.seed + 1);
  for (std::size_t i = 0; i < options.oracle_samples; ++i) {
    const int a = static_cast<int>(random.index(mesh.triangles.size())),
              b = static_cast<int>(random.index(mesh.triangles.size()));
    if (a != b && !isVisited(a, b)) check.addUnvisited(kFar, a, b);
  }
  return check.finish();
}

}  // namespace test
}  // namespace fcl

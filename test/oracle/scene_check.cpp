// SPDX-License-Identifier: BSD-3-Clause
#include "scene_check.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "exact_oracle.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/detail/deformable/feature_pairs.h"
#include "fcl/narrowphase/detail/deformable/traversal.h"
#include "feature_pair_generators.h"
#include "swept_tree.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;
using deformable::Answer;
using deformable::FeatureKind;
using deformable::FeaturePair;
using deformable::MeshTriangle;

using Model = DeformableBVHModel<KDOP<double, 16>>;
using TrianglePair = std::pair<int, int>;

enum StageIndex { kFar, kNear, kAxis, kFilter, kSolver, kIntegers };

/// The tolerance of a query that asks for none.
constexpr double kTocErr = 1e-4;

TrianglePair inOrder(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

class CullCheck {
 public:
  CullCheck(const Model& model, const CullCheckOptions& options)
      : model_(model), options_(options), random_(options.seed) {}

  /// What the elementary test does to a visited triangle pair, stage by stage.
  void addVisited(int a, int b, TimeWindow window) {
    const double lo = std::max(0., window.lo - deformable::kWindowMargin),
                 hi = std::min(1., window.hi + deformable::kWindowMargin);
    forEachPair(a, b, [&](const MovingPair& pair) {
      double pair_lo = lo, pair_hi = hi;
      if (!narrowWindow(pair.kind, pair.points(), pair_lo, pair_hi)) {
        addCulled(kAxis, pair);
      } else if (!mayBecomeCoplanar(pair.kind, pair.points(), pair_lo, pair_hi)) {
        addCulled(kFilter, pair);
      } else {
        const Answer solved =
            solveCoplanarity(pair.kind, pair.points(), pair_lo, pair_hi, kTocErr).answer;
        if (solved == Answer::kNo)
          addCulled(kSolver, pair);
        else if (solved == Answer::kUnsure &&
                 decideExactly(pair.kind, pair.points(), kTocErr).answer == Answer::kNo)
          addCulled(kIntegers, pair);
      }
    });
  }

  /// A triangle pair that the traversal did not visit.
  void addUnvisited(StageIndex stage, int a, int b) {
    forEachPair(a, b, [&](const MovingPair& pair) { addCulled(stage, pair); });
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
  template <typename Visit>
  void forEachPair(int a, int b, Visit&& visit) const {
    const MeshTriangle& ta = model_.features()[static_cast<std::size_t>(a)];
    const MeshTriangle& tb = model_.features()[static_cast<std::size_t>(b)];
    deformable::forEachFeaturePair<true>(ta, tb, [&](const FeaturePair& f) {
      const MeshTriangle &first = f.first_on_a ? ta : tb, &other = f.first_on_a ? tb : ta;
      MovingPair pair{f.kind, {}};
      const auto set = [&](std::size_t i, std::uint32_t id) {
        pair.x[i] = model_.frames()[id];
      };
      set(0, first.v[f.first]);
      if (f.kind == FeatureKind::kVertexFace) {
        for (std::size_t k = 0; k < 3; ++k) set(k + 1, other.v[k]);
      } else {
        set(1, ta.v[(f.first + 1) % 3]);
        set(2, tb.v[f.second]);
        set(3, tb.v[(f.second + 1) % 3]);
      }
      visit(pair);
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
  CullReport report_;
  std::array<std::vector<MovingPair>, 6> samples_;
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
  std::vector<deformable::NodePair> open;
  std::vector<TrianglePair> visited;
  const auto whole_step = [] { return 1.; };
  deformable::traverse<true>(model.movingTree(), model.movingTree(), nullptr, open,
                             whole_step, [&](int a, int b, TimeWindow window) {
                               visited.push_back(inOrder(a, b));
                               check.addVisited(a, b, window);
                               return true;
                             });
  std::sort(visited.begin(), visited.end());
  const auto isVisited = [&visited](int a, int b) {
    return std::binary_search(visited.begin(), visited.end(), inOrder(a, b));
  };

  // Triangle pairs that only their motion keeps apart.
  const SweptTree swept(model.movingTree());
  deformable::traverse<true>(swept, swept, nullptr, open, whole_step,
                             [&](int a, int b, TimeWindow) {
                               if (!isVisited(a, b)) check.addUnvisited(kNear, a, b);
                               return true;
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

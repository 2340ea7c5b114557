// SPDX-License-Identifier: BSD-3-Clause
//
// All self-contacts of a mesh, on one thread, by any of the methods to compare with. One
// driver: a tree hands out pairs of triangles, the technique says which of their features
// are meant, the tree compares the features' boxes, the filter drops pairs that are never
// coplanar, the solver decides.
#ifndef FCL_BENCHMARK_BASELINES_SELF_QUERY_H
#define FCL_BENCHMARK_BASELINES_SELF_QUERY_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "baselines/baseline.h"
#include "baselines/candidates.h"
#include "baselines/connectivity.h"
#include "baselines/method.h"
#include "baselines/normal_cones.h"
#include "baselines/wide_tree.h"
#include "elementary/coplanarity_filter.h"
#include "elementary/elementary.h"
#include "kernels/kernels.h"
#include "scene_data.h"
#include "speed_error/coplanarity_cubic.h"
#include "timing.h"

namespace fcl {
namespace test {

/// @tparam Tree  FeatureTree or WideTree
template <typename Tree>
class SelfQuery final : public Baseline {
 public:
  SelfQuery(const FramePairMesh& mesh, Technique technique, Filter filter,
            TouchTest touches)
      : technique_(technique),
        filter_(filter),
        touches_(touches),
        tree_(mesh),
        mesh_(tree_.connectivity()) {
    if (technique_ != Technique::kConnectivity) return;
    regions_ = tree_.regions();
    cones_ = std::make_unique<NormalCones>(regions_, mesh_);
    orphans_ = mesh_.findOrphans();
  }

  BaselineStep step(const FramePairMesh& mesh) override {
    step_ = {};
    step_.ms_update = millisecondsOf([&] {
      tree_.refit(mesh);
      if (cones_) cones_->update(tree_.paths());
    });
    const double ms = millisecondsOf([&] {
      for (const TrianglePairMask& o : orphans_) add(o.a, o.b, o.pairs);
      tree_.traverse([&](int region) { return isLeftOut(region); },
                     [&](int i, int j) {
                       ++step_.triangle_pairs;
                       add(i, j, 0);
                     });
      testBlock();
      if (technique_ == Technique::kFeatureBoxes) forgetRepeated();
    });
    step_.ms_traverse = ms - step_.ms_test;
    return std::move(step_);
  }

 private:
  using Kind = fcl::ContinuousContactKind;

  /// Pairs are tested in blocks: the clock is read once a block, and nodes and vertices
  /// do not push each other out of the cache at every pair.
  static constexpr std::size_t kBlock = 1024;

  bool isLeftOut(int region) {
    if (!cones_) return false;
    const bool is_free = cones_->isFreeOfSelfContact(static_cast<std::size_t>(region));
    step_.regions_left_out += is_free;
    return is_free;
  }

  /// @param pairs  of features; 0: as the technique says
  void add(int i, int j, std::uint16_t pairs) {
    block_.push_back({i, j, pairs});
    if (block_.size() == kBlock) testBlock();
  }

  void testBlock() {
    step_.ms_test += millisecondsOf([&] {
      for (TrianglePairMask& pair : block_)
        if (pair.pairs == 0)
          pair.pairs = static_cast<std::uint16_t>(pairsOf(pair.a, pair.b));
      candidates_.clear();
      tree_.findOverlaps(block_, candidates_);
      step_.feature_pairs += candidates_.size();
      test(tree_);
      block_.clear();
    });
  }

  unsigned pairsOf(int i, int j) const {
    if (technique_ == Technique::kFeatureBoxes) return mesh_.allPairs(i, j);
    if (technique_ == Technique::kRepresentatives) return mesh_.ownedPairs(i, j);
    return mesh_.areAdjacent(i, j) ? 0 : mesh_.representedPairs(i, j);
  }

  struct PointIds {
    Kind kind;
    std::array<std::uint32_t, 4> v;
  };
  PointIds pointsOf(const Candidate& c) const {
    const TrianglePairMask& pair = block_[c.pair];
    const auto &a = mesh_.triangle(pair.a).v, &b = mesh_.triangle(pair.b).v;
    const unsigned char(&places)[4] = detail::deformable::kFeaturePoints[c.bit];
    PointIds points;
    points.kind = c.bit < detail::deformable::kNumVertexFacePairs ? Kind::kVertexFace
                                                                  : Kind::kEdgeEdge;
    for (std::size_t i = 0; i < 4; ++i)
      points.v[i] = places[i] < 3 ? a[places[i]] : b[places[i] - 3];
    return points;
  }

  /// One pair at a time.
  template <typename AnyTree>
  void test(const AnyTree&) {
    for (const Candidate& c : candidates_) {
      const PointIds points = pointsOf(c);
      if (filter_ == Filter::kCertified &&
          !detail::deformable::mayBecomeCoplanar(
              points.kind, pathsOf(points), double{c.window.lo}, double{c.window.hi}))
        continue;
      solve(points, filter_ == Filter::kPlain);
    }
  }

  /// Eight pairs of one kind at a time through the filter.
  template <Boxes kBoxes>
  void test(const WideTree<kBoxes>& tree) {
    if (filter_ == Filter::kNone) {
      for (const Candidate& c : candidates_) solve(pointsOf(c));
      return;
    }
    // A tree of kernels lists the pairs of a vertex and a face first.
    for (std::size_t i = 0; i < candidates_.size();) {
      const bool is_plain = filter_ == Filter::kPlain;
      const Kind kind = pointsOf(candidates_[i]).kind;
      PointIds points[8];
      detail::deformable::TrianglePair pairs[8];
      std::uint32_t codes[8];
      detail::deformable::TimeWindow windows[8];
      std::uint32_t count = 0;
      for (; count < 8 && i < candidates_.size(); ++i, ++count) {
        const Candidate& c = candidates_[i];
        points[count] = pointsOf(c);
        if (points[count].kind != kind) break;
        const auto& places = detail::deformable::kFeaturePoints[c.bit];
        for (std::size_t n = 0; n < 4; ++n)
          pairs[count].x[places[n]] = &tree.vertices()[points[count].v[n]];
        codes[count] = detail::deformable::featureCode(count, c.bit);
        windows[count] = is_plain ? detail::deformable::TimeWindow{0, 1} : c.window;
      }
      // Where signs agree but stand below the bound is unclear; the plain filter has no
      // bound.
      const auto found = detail::deformable::kernels().coplanarity(kind, pairs, codes,
                                                                   windows, count, 1.);
      const unsigned left = is_plain ? found.possible : found.possible | found.unclear;
      for (std::size_t lane = 0; lane < count; ++lane)
        if (left >> lane & 1U) solve(points[lane]);
    }
  }

  detail::deformable::FeaturePoints pathsOf(const PointIds& points) const {
    const auto& paths = tree_.paths();
    return {{&paths[points.v[0]], &paths[points.v[1]], &paths[points.v[2]],
             &paths[points.v[3]]}};
  }

  /// @param filtered  whether the plain filter looks at the cubic first
  void solve(const PointIds& points, bool filtered = false) {
    const detail::deformable::FeaturePoints x = pathsOf(points);
    const RelativePair<double> pair(points.kind, x);
    const CoplanarityCubic<double> cubic(pair);
    if (filtered && cubic.hasOneSign()) return;
    ++step_.elementary_tests;
    if (!touches_(points.kind, x, pair, cubic)) return;
    std::array<int, 4> ids{};
    for (std::size_t i = 0; i < 4; ++i) ids[i] = tree_.originalVertex(points.v[i]);
    step_.contacts.push_back(pairName(points.kind == Kind::kVertexFace
                                          ? ContinuousContactKind::kVertexFace
                                          : ContinuousContactKind::kEdgeEdge,
                                      ids));
  }

  void forgetRepeated() {
    auto& contacts = step_.contacts;
    std::sort(contacts.begin(), contacts.end());
    contacts.erase(std::unique(contacts.begin(), contacts.end()), contacts.end());
  }

  Technique technique_;
  Filter filter_;
  TouchTest touches_;
  Tree tree_;
  const MeshConnectivity& mesh_;
  Regions regions_;
  std::unique_ptr<NormalCones> cones_;
  std::vector<TrianglePairMask> orphans_;
  std::vector<TrianglePairMask> block_;
  std::vector<Candidate> candidates_;
  BaselineStep step_;
};

}  // namespace test
}  // namespace fcl

#endif

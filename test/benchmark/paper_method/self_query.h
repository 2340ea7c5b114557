// SPDX-License-Identifier: BSD-3-Clause
//
// All self-contacts of a mesh as Tang, Manocha, Tong 2010 find them, on one thread: boxes
// of nodes, boxes of features, the coplanarity filter, Interval-Newton. Boxes, filter and
// solver are parameters, so that each difference to the paper can be measured alone.
#ifndef FCL_BENCHMARK_SELF_QUERY_H
#define FCL_BENCHMARK_SELF_QUERY_H

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "fcl/narrowphase/detail/deformable/elementary_test.h"
#include "feature_tree.h"
#include "scene_data.h"
#include "speed_error/coplanarity_cubic.h"
#include "speed_error/interval_newton.h"
#include "timing.h"

namespace fcl {
namespace test {

enum class Filter {
  kNone,
  kPlain,     ///< the paper's: signs of four numbers over the whole step
  kCertified  ///< the library's: signs with a bound, while the boxes overlap
};

/// @brief The solver of the paper. A solver is called with a pair, its cubic included,
/// and says whether the features touch.
struct IntervalNewton {
  double resolution;

  bool operator()(detail::deformable::FeatureKind,
                  const detail::deformable::FeaturePoints&,
                  const RelativePair<double>& pair,
                  const CoplanarityCubic<double>& cubic) const {
    return firstTimeByIntervalNewton(pair, cubic, resolution, resolution) >= 0;
  }
};

/// @brief Features that touch and the time it took to find them.
struct SelfContacts {
  std::vector<PairName> pairs;
  double ms_traverse{0};
  double ms_test{0};
};

template <Filter kFilter, typename Box, typename Solver>
class SelfQuery {
 public:
  using Tree = FeatureTree<Box>;

  SelfQuery(const Tree& tree, const Solver& solver) : tree_(tree), solver_(solver) {}

  SelfContacts run() {
    block_.reserve(kBlock);
    const double ms = millisecondsOf([&] {
      traverse();
      visitBlock();
    });
    contacts_.ms_traverse = ms - contacts_.ms_test;
    return std::move(contacts_);
  }

 private:
  using Kind = detail::deformable::FeatureKind;
  using Points = detail::deformable::FeaturePoints;

  /// Leaf pairs are tested in blocks: the clock is read once a block, and nodes and
  /// vertices do not push each other out of the cache at every pair.
  static constexpr std::size_t kBlock = 4096;

  struct LeafPair {
    int a, b;
    TimeWindow window;
  };

  void traverse() {
    std::vector<LeafPair> open{{0, 0, {0.f, 1.f}}};
    const auto pushIfOverlapping = [&](int a, int b) {
      const TimeWindow window = overlap(tree_.box(a), tree_.box(b));
      if (!window.isEmpty()) open.push_back({a, b, window});
    };
    while (!open.empty()) {
      const LeafPair pair = open.back();
      open.pop_back();
      const int link_a = tree_.link(pair.a), link_b = tree_.link(pair.b);
      if (pair.a == pair.b) {
        if (link_a < 0) continue;
        open.push_back({link_a + 1, link_a + 1, {0.f, 1.f}});
        open.push_back({link_a, link_a, {0.f, 1.f}});
        pushIfOverlapping(link_a, link_a + 1);
      } else if (link_a < 0 && link_b < 0) {
        block_.push_back({~link_a, ~link_b, pair.window});
        if (block_.size() == kBlock) visitBlock();
      } else if (link_a < 0) {
        pushIfOverlapping(pair.a, link_b);
        pushIfOverlapping(pair.a, link_b + 1);
      } else if (link_b < 0) {
        pushIfOverlapping(link_a, pair.b);
        pushIfOverlapping(link_a + 1, pair.b);
      } else {
        // Both: the four boxes are fetched once.
        for (const int a : {link_a, link_a + 1})
          for (const int b : {link_b, link_b + 1}) pushIfOverlapping(a, b);
      }
    }
  }

  void visitBlock() {
    contacts_.ms_test += millisecondsOf([&] {
      for (const LeafPair& pair : block_) visit(pair);
    });
    block_.clear();
  }

  /// Every VF and EE pair that the two triangles own.
  void visit(const LeafPair& pair) {
    const auto *a = tree_.leaf(pair.a), *b = tree_.leaf(pair.b);
    testVertices(a, b, pair.window);
    testVertices(b, a, pair.window);
    for (auto i = a->first_edge; i < a[1].first_edge; ++i)
      for (auto j = b->first_edge; j < b[1].first_edge; ++j) {
        const TimeWindow window = overlap(tree_.edgeBox(i), tree_.edgeBox(j));
        const auto &e = tree_.edge(i), &f = tree_.edge(j);
        if (!window.isEmpty() && !shareVertex(e, f))
          test(Kind::kEdgeEdge, {e[0], e[1], f[0], f[1]}, window, pair.window);
      }
  }

  static bool shareVertex(const typename Tree::Edge& e, const typename Tree::Edge& f) {
    return e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1];
  }

  /// The vertices that triangle a owns against the face of b.
  void testVertices(const typename Tree::Leaf* a, const typename Tree::Leaf* b,
                    const TimeWindow& both) {
    if (!b->owns_face) return;
    for (auto v = a->first_vertex; v < a[1].first_vertex; ++v) {
      const TimeWindow window = overlap(tree_.vertexBox(v), tree_.faceBox(b));
      if (!window.isEmpty() && !b->has(v))
        test(Kind::kVertexFace, {v, b->v[0], b->v[1], b->v[2]}, window, both);
    }
  }

  void test(Kind kind, const std::array<std::uint32_t, 4>& v, TimeWindow window,
            const TimeWindow& leaf_window) {
    const Points x{
        {&tree_.path(v[0]), &tree_.path(v[1]), &tree_.path(v[2]), &tree_.path(v[3])}};
    if (kFilter == Filter::kCertified) {
      window.lo = std::max(window.lo, leaf_window.lo);
      window.hi = std::min(window.hi, leaf_window.hi);
      if (window.isEmpty() || !detail::deformable::mayBecomeCoplanar(
                                  kind, x, double{window.lo}, double{window.hi}))
        return;
    }
    const RelativePair<double> pair(kind, x);
    const CoplanarityCubic<double> cubic(pair);
    if (kFilter == Filter::kPlain && cubic.hasOneSign()) return;
    if (solver_(kind, x, pair, cubic))
      contacts_.pairs.push_back(
          pairName(kind == Kind::kVertexFace ? ContinuousContactKind::kVertexFace
                                             : ContinuousContactKind::kEdgeEdge,
                   {tree_.originalVertex(v[0]), tree_.originalVertex(v[1]),
                    tree_.originalVertex(v[2]), tree_.originalVertex(v[3])}));
  }

  const Tree& tree_;
  Solver solver_;
  std::vector<LeafPair> block_;
  SelfContacts contacts_;
};

}  // namespace test
}  // namespace fcl

#endif

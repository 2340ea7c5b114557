// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of nodes: boxes of points and of everything below a node, and children that
// overlap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh_generators.h"
#include "offset_pad.h"
#include "query/leading_contact.h"
#include "random_boxes.h"
#include "real.h"
#include "tree/box_position.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::allSets;
using test::depthAtStart;
using test::doOverlapAtStart;
using test::expectSameBits;
using test::Halves;
using test::OverlapTally;
using test::Random;
using test::randomBounds;
using test::randomGap;
using test::randomHalves;
using test::randomScale;
using test::Real;
using test::shifted;

constexpr int kWidth = MovingKdopNode::kWidth;

/// A box's half-axes in the order of a node's rows.
struct Rows {
  float t0[16], t1[16];

  explicit Rows(const detail::deformable::MovingKdop& box) {
    for (int r = 0; r < 16; ++r) {
      t0[r] = box.t0.half[MovingKdopNode::halfAxis(r)];
      t1[r] = box.t1.half[MovingKdopNode::halfAxis(r)];
    }
  }
  BoxView view(float displacement = 0) const { return {t0, t1, 1, displacement}; }
};

/// The same as a request, for boxes whose displacements add up to `moved`.
OverlapRequest randomRequest(Random& random, float depth, float moved) {
  OverlapRequest request{random.index(2) == 0};
  const float gap = randomGap(random, depth);
  if (!(gap <= FLT_MAX)) return request;
  const auto part = static_cast<float>(random.uniform(0, 1));
  switch (random.index(3)) {
    case 0:
      request.share = 0;
      request.slack = gap;
      break;
    case 1:
      request.share = moved > 0 ? gap / moved : 1.f;
      request.slack = 0;
      break;
    default:
      request.share = moved > 0 ? part * gap / moved : part;
      request.slack = gap - part * gap;
  }
  return request;
}

/// Whether the request leaves out boxes of that depth at t = 0.
bool isTooFar(const OverlapRequest& request, float depth, float moved) {
  return request.leavesOut() && depth + (moved * request.share + request.slack) < 0;
}

float randomDisplacement(Random& random, float scale) {
  return random.index(3) ? scale * static_cast<float>(random.uniform(0, 2)) : 0.f;
}

/// The answer about boxes that overlap from `lo` on, if times are not asked for.
void expectUntimed(float earliest, const detail::deformable::MovingKdop& a,
                   const detail::deformable::MovingKdop& b, float lo) {
  if (doOverlapAtStart(a, b))
    EXPECT_EQ(earliest, 0);
  else
    EXPECT_TRUE(earliest == FLT_MIN || earliest == lo) << earliest << " " << lo;
}

void expectRightChildren(const BoxView& view, const detail::deformable::MovingKdop& box,
                         const MovingKdopNode& node, OverlapTally& tally) {
  float first[kWidth];
  const unsigned mask = allSets().front()->overlapChildren(view, node, {true}, first);
  EXPECT_EQ(mask & ~node.lanes(), 0U) << "a lane that is not in use";
  for (int lane = 0; lane < node.count; ++lane) {
    const detail::deformable::TimeWindow expected =
        overlapWindow<false>(box, node.box(lane), nullptr);
    ASSERT_EQ(mask >> lane & 1U, unsigned{!expected.isEmpty()}) << lane;
    if (!expected.isEmpty()) {
      EXPECT_EQ(first[lane], expected.lo);
    }
    tally.add(!expected.isEmpty(), expected);
  }
  float first_untimed[kWidth];
  allSets().front()->overlapChildren(view, node, {false}, first_untimed);
  for (int lane = 0; lane < node.count; ++lane)
    if (mask >> lane & 1U)
      expectUntimed(first_untimed[lane], box, node.box(lane), first[lane]);
  for (const Kernels* k : allSets()) {
    float earliest[kWidth];
    ASSERT_EQ(k->overlapChildren(view, node, {true}, earliest), mask) << k->name;
    expectSameBits(mask, earliest, first);
    ASSERT_EQ(k->overlapChildren(view, node, {false}, earliest), mask) << k->name;
    expectSameBits(mask, earliest, first_untimed);
    ASSERT_FALSE(testing::Test::HasFailure()) << k->name;
  }
}

/// A request leaves out the children that are too far away at t = 0, and does not change
/// the others. Counts those that it leaves out.
void expectRightRequest(const BoxView& view, const detail::deformable::MovingKdop& box,
                        const MovingKdopNode& node, const OverlapRequest& request,
                        int& left_out) {
  unsigned near = 0;
  for (int lane = 0; lane < node.count; ++lane)
    near |= unsigned{!isTooFar(request, depthAtStart(box, node.box(lane)),
                               view.displacement + node.displacement[lane])}
            << lane;
  for (const Kernels* k : allSets()) {
    float expected[kWidth], earliest[kWidth];
    const unsigned all = k->overlapChildren(view, node, {request.timed}, expected);
    ASSERT_EQ(k->overlapChildren(view, node, request, earliest), all & near) << k->name;
    for (int lane = 0; lane < node.count; ++lane)
      if (all & near & 1U << lane) {
        if (request.timed)
          EXPECT_EQ(earliest[lane], expected[lane]) << k->name;
        else
          expectUntimed(earliest[lane], box, node.box(lane),
                        overlapWindow<false>(box, node.box(lane), nullptr).lo);
      }
    left_out += __builtin_popcount(all & ~near);
  }
}

// Boxes of points are those of fitPoint(): near and far, on the axes, beyond the range of
// a float, and not finite. For a given number of vertices in one frame, and for no
// others.
TEST(FCL_KERNELS, pointsAsFitPoint) {
  constexpr std::uint64_t kSeed = 76;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const double specials[] = {0.,      -0.,     kInf,        -kInf,  std::nan(""),
                             FLT_MAX, DBL_MAX, -DBL_MAX,    1e-310, FLT_MIN,
                             0x1p175, 0x1p177, 2 * FLT_MAX, -1e39};
  Random random(kSeed);
  int unbounded = 0, bounded = 0;
  for (int i = 0; i < 20000; ++i) {
    double offsets[3][8];
    const bool special = random.index(3) == 0;
    const double scale = std::ldexp(1, static_cast<int>(random.index(80)) - 40);
    for (auto& axis : offsets)
      for (double& x : axis)
        x = special && random.index(2) ? specials[random.index(std::size(specials))]
                                       : scale * random.uniform(-1, 1);
    const int frame = static_cast<int>(random.index(2));
    const std::size_t count = 1 + random.index(8);
    const auto boxOf = [](const TreeVertex& x,
                          int k) -> const detail::deformable::Kdop16& {
      return k == 0 ? x.box.t0 : x.box.t1;
    };
    std::vector<TreeVertex> before(8), first;
    for (TreeVertex& x : before) x.box = randomBounds(random, randomHalves(random), 1);
    for (const Kernels* k : allSets()) {
      std::vector<TreeVertex> vertices = before;
      k->fitPoints(offsets, frame, count, vertices.data());
      if (first.empty()) first = vertices;
      ASSERT_EQ(std::memcmp(vertices.data(), first.data(), 8 * sizeof(TreeVertex)), 0)
          << k->name << ", seed " << kSeed << ", " << i;
    }
    for (std::size_t n = 0; n < 8; ++n) {
      const double point[3] = {offsets[0][n], offsets[1][n], offsets[2][n]},
                   origin[3] = {};
      double size = std::abs(point[0]);
      for (int k = 1; k < 3; ++k)
        size = size < std::abs(point[k]) ? std::abs(point[k]) : size;
      detail::deformable::Kdop16 box;
      fitPoint(point, origin, test::offsetPad(size), box);
      const detail::deformable::Kdop16& same = boxOf(before[n], 1 - frame);
      for (std::size_t j = 0; j < 16; ++j) {
        const float expected = n < count ? box.half[j] : boxOf(before[n], frame).half[j];
        ASSERT_EQ(boxOf(first[n], frame).half[j], expected)
            << j << ", seed " << kSeed << ", " << i << ", " << n;
        ASSERT_EQ(boxOf(first[n], 1 - frame).half[j], same.half[j]);
        ++(box.half[j] <= FLT_MAX ? bounded : unbounded);
      }
    }
  }
  EXPECT_GT(bounded, 1000000);
  EXPECT_GT(unbounded, 100000);
}

/// A node with triangles of few vertices, and sometimes a node among them.
MovingKdopNode randomLeaf(Random& random, Halves halves, float scale) {
  MovingKdopNode node;
  node.count = 1 + static_cast<int>(random.index(kWidth));
  // Few vertices, or places that differ only in a high bit.
  const unsigned high = random.index(2) ? 0 : 31;
  const auto place = [&] {
    return static_cast<std::uint32_t>(random.index(high ? 2 : 20)) << high |
           static_cast<std::uint32_t>(random.index(high ? 4 : 1));
  };
  for (int lane = 0; lane < kWidth; ++lane) {
    const bool is_triangle = lane < node.count && random.index(8) != 0;
    node.child[lane] = is_triangle ? -1 - lane : lane;
    for (auto& row : node.places)
      row[lane] = is_triangle ? place() : MovingKdopNode::kNoPlace;
    node.setBox(lane, randomBounds(random, halves, scale));
    node.displacement[lane] = randomDisplacement(random, scale);
  }
  node.markTriangles();
  return node;
}

// The boxes of a node's children contain what is below them, and no more: those of
// triangles their vertices, those of nodes their children, those of unused lanes nothing.
// In one frame, too, if nothing moves.
TEST(FCL_KERNELS, childrenHoldWhatIsBelow) {
  constexpr std::uint64_t kSeed = 80;
  Random random(kSeed);
  constexpr std::size_t kVertices = 20, kNodes = 4;
  int summed = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const Halves halves = randomHalves(random);
    const float scale = randomScale(random);
    const bool is_still = i % 4 == 0;
    std::vector<TreeVertex> vertices(kVertices);
    for (TreeVertex& x : vertices) {
      x.box = randomBounds(random, halves, scale);
      if (is_still) x.box.t1 = x.box.t0;
      x.t0[3] = double{randomDisplacement(random, scale)};
    }
    std::vector<MovingKdopNode> nodes;
    for (std::size_t n = 0; n < kNodes; ++n) {
      nodes.push_back(randomLeaf(random, halves, scale));
      nodes.back().clearRest();
      if (is_still) std::memcpy(nodes.back().t1, nodes.back().t0, sizeof(nodes[0].t0));
    }
    MovingKdopNode before = randomLeaf(random, halves, scale);
    for (int lane = 0; lane < kWidth; ++lane) {
      for (auto& row : before.places)
        if (row[lane] != MovingKdopNode::kNoPlace) row[lane] %= kVertices;
      if (!before.isTriangle(lane)) before.child[lane] %= kNodes;
    }

    MovingKdopNode expected = before;
    double sums[kWidth] = {}, sizes[kWidth] = {};
    for (int lane = 0; lane < kWidth; ++lane) {
      detail::deformable::MovingKdop all;
      std::fill(all.t0.half, all.t0.half + 16, kLeastHalf);
      std::fill(all.t1.half, all.t1.half + 16, kLeastHalf);
      float moved = 0;
      const auto add = [&](const detail::deformable::MovingKdop& box,
                           float displacement) {
        for (int j = 0; j < 16; ++j) {
          all.t0.half[j] = std::max(all.t0.half[j], box.t0.half[j]);
          all.t1.half[j] = std::max(all.t1.half[j], box.t1.half[j]);
        }
        moved = std::max(moved, displacement);
      };
      if (lane < before.count && before.isTriangle(lane)) {
        for (const auto& row : before.places)
          add(vertices[row[lane]].box,
              static_cast<float>(vertices[row[lane]].displacement()));
      } else if (lane < before.count) {
        const MovingKdopNode& child = nodes[static_cast<std::size_t>(before.child[lane])];
        for (int k = 0; k < child.count; ++k) add(child.box(k), child.displacement[k]);
      }
      expected.setBox(lane, all);
      expected.displacement[lane] = moved;
      for (int j = 0; j < 16; ++j)
        for (const float half : {all.t0.half[j], all.t1.half[j]}) {
          sums[lane] += double{half};
          sizes[lane] += std::abs(double{half});
        }
    }

    float first[kWidth];
    for (const Kernels* k : allSets()) {
      MovingKdopNode node = before;
      float extents[kWidth];
      k->fitNode(vertices.data(), nodes.data(), is_still, node, extents);
      ASSERT_EQ(std::memcmp(&node, &expected, sizeof(node)), 0) << k->name;
      if (k == allSets().front()) std::copy(extents, extents + kWidth, first);
      for (int lane = 0; lane < kWidth; ++lane) {
        ASSERT_TRUE(extents[lane] == first[lane] ||
                    (std::isnan(extents[lane]) && std::isnan(first[lane])))
            << k->name;
        if (sizes[lane] > FLT_MAX) continue;
        ASSERT_NEAR(double{extents[lane]}, sums[lane], 1e-5 * sizes[lane]) << k->name;
        ++summed;
      }
    }
  }
  EXPECT_GT(summed, 10000);
}

TEST(FCL_KERNELS, childrenAsOverlapWindow) {
  constexpr std::uint64_t kSeed = 71;
  Random random(kSeed);
  OverlapTally tally;
  int left_out = 0;
  for (int i = 0; i < 20000; ++i) {
    const float scale = randomScale(random);
    MovingKdopNode parent, node;
    parent.count = kWidth;
    node.count = 1 + static_cast<int>(random.index(kWidth));
    for (int lane = 0; lane < kWidth; ++lane) {
      parent.child[lane] = node.child[lane] = 0;
      parent.setBox(lane, randomBounds(random, randomHalves(random), scale));
      node.setBox(lane, randomBounds(random, randomHalves(random), scale));
      parent.displacement[lane] = randomDisplacement(random, scale);
      node.displacement[lane] = randomDisplacement(random, scale);
    }
    // Unused lanes have any content.
    if (random.index(2)) node.clearRest();
    const auto lane = static_cast<int>(random.index(kWidth));
    const detail::deformable::MovingKdop box = parent.box(lane);
    // A single box, and one of eight.
    const Rows rows(box);
    const float moved = parent.displacement[lane];
    const OverlapRequest request = randomRequest(random, depthAtStart(box, node.box(0)),
                                                 moved + node.displacement[0]);
    for (const BoxView& view :
         {rows.view(moved),
          BoxView{&parent.t0[0][lane], &parent.t1[0][lane], kWidth, moved}}) {
      expectRightChildren(view, box, node, tally);
      expectRightRequest(view, box, node, request, left_out);
    }
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(tally.overlaps, 5000);
  EXPECT_GT(tally.apart, 5000);
  EXPECT_GT(tally.cut, 2000);
  EXPECT_GT(left_out, 5000);
}

/// Whether boxes are apart along a half-axis at t = 0, or at both ends of the step, in
/// numbers that do not round. The kernels may see that where shifted() has rounded.
bool areApartExactly(const detail::deformable::MovingKdop& a,
                     const detail::deformable::MovingKdop& b, const KdopShift& shift,
                     bool at_start) {
  const auto depth = [](const detail::deformable::Kdop16& x,
                        const detail::deformable::Kdop16& y,
                        const detail::deformable::Kdop16& added, int j) {
    return Real{x.half[j]} + y.half[j ^ 8] + added.half[j];
  };
  for (int j = 0; j < 16; ++j)
    if (depth(a.t0, b.t0, shift.t0, j) < 0 &&
        (at_start || depth(a.t1, b.t1, shift.t1, j) < 0))
      return true;
  return false;
}

// What is added to a box, such as a distance, is added to each of its half-axes.
TEST(FCL_KERNELS, shiftedChildrenAsOverlapWindow) {
  constexpr std::uint64_t kSeed = 72;
  Random random(kSeed);
  int overlaps = 0, apart = 0, late = 0, left_out = 0, rounded = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const float scale = randomScale(random);
    MovingKdopNode node;
    node.count = 1 + static_cast<int>(random.index(kWidth));
    for (int lane = 0; lane < node.count; ++lane) {
      node.child[lane] = 0;
      node.setBox(lane, randomBounds(random, randomHalves(random), scale));
      node.displacement[lane] = randomDisplacement(random, scale);
    }
    node.clearRest();
    const detail::deformable::MovingKdop box = randomBounds(random, randomHalves(random),
                                                            scale),
                                         added = randomBounds(
                                             random, randomHalves(random), scale);
    const KdopShift shift = {added.t0, added.t1};
    float rows[2][16];
    for (int r = 0; r < 16; ++r) {
      rows[0][r] = shift.t0.half[MovingKdopNode::halfAxis(r)];
      rows[1][r] = shift.t1.half[MovingKdopNode::halfAxis(r)];
    }
    const detail::deformable::MovingKdop moved = shifted(box, &shift);
    const Rows single(box);
    BoxView view = single.view(randomDisplacement(random, scale));
    view.shift = rows;
    OverlapRequest request = randomRequest(random, depthAtStart(moved, node.box(0)),
                                           view.displacement + node.displacement[0]);
    request.timed = true;
    float first[kWidth];
    const unsigned found = allSets().front()->overlapChildren(view, node, {true}, first);
    unsigned near = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      const detail::deformable::TimeWindow window =
          overlapWindow<false>(moved, node.box(lane), nullptr);
      if (found >> lane & 1U) {
        // A sum may round to an overlap, or to an earlier one.
        if (!window.isEmpty()) {
          EXPECT_LE(first[lane], window.lo);
        }
        rounded += window.isEmpty() || first[lane] < window.lo;
        ++overlaps;
        late += window.lo > 0;
      } else {
        EXPECT_TRUE(window.isEmpty() ||
                    areApartExactly(box, node.box(lane), shift, false))
            << lane;
        ++apart;
      }
      near |= unsigned{!isTooFar(request, depthAtStart(moved, node.box(lane)),
                                 view.displacement + node.displacement[lane])}
              << lane;
    }
    left_out += __builtin_popcount(found & ~near);
    // Of boxes that only rounding brings together, all may be kept.
    float first_kept[kWidth];
    const unsigned kept =
        allSets().front()->overlapChildren(view, node, request, first_kept);
    ASSERT_EQ(kept & found, found & near);
    for (int lane = 0; lane < node.count; ++lane) {
      if (!(kept >> lane & 1U)) continue;
      EXPECT_TRUE((found >> lane & 1U) ||
                  areApartExactly(box, node.box(lane), shift, false));
      if (found >> lane & 1U) {
        EXPECT_LE(first_kept[lane], first[lane]);
        rounded += first_kept[lane] < first[lane];
      }
    }
    for (const Kernels* k : allSets()) {
      float earliest[kWidth];
      ASSERT_EQ(k->overlapChildren(view, node, {true}, earliest), found) << k->name;
      expectSameBits(found, earliest, first);
      ASSERT_EQ(k->overlapChildren(view, node, request, earliest), kept) << k->name;
      expectSameBits(kept, earliest, first_kept);
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(overlaps, 5000);
  EXPECT_GT(apart, 5000);
  EXPECT_GT(late, 1000);
  EXPECT_GT(left_out, 1000);
  EXPECT_LT(rounded, 20);
}

// Where nothing after t = 0 matters, what motion bridges is as good as nothing. But it is
// a normal number: kernels take several times as long with subnormal ones.
TEST(FCL_KERNELS, bridgesNormalNumbersAtTheStart) {
  const double latest = latestLeading(0);
  EXPECT_GT(latest, 0);
  EXPECT_LT(latest, 1e-50);
  EXPECT_GE(latest * 1e-30, DBL_MIN);
  OverlapRequest request{true};
  request.leaveOutAfter(latest, 0);
  EXPECT_TRUE(request.leavesOut());
  EXPECT_LT(request.share, 1e-19f);
  EXPECT_GE(request.share * 1e-15f, FLT_MIN);
}

// Unbounded boxes overlap all boxes that are in use, and nothing else.
TEST(FCL_KERNELS, unboundedOverlapsWhatIsInUse) {
  for (const float half : {std::numeric_limits<float>::infinity(), FLT_MAX}) {
    detail::deformable::MovingKdop box;
    std::fill(box.t0.half, box.t0.half + 16, half);
    box.t1 = box.t0;
    for (int count = 1; count <= kWidth; ++count) {
      MovingKdopNode node;
      node.count = count;
      for (int lane = 0; lane < count; ++lane) {
        node.setBox(lane, box);
        node.displacement[lane] = half;
      }
      node.clearRest();
      for (const Kernels* k : allSets()) {
        float earliest[kWidth];
        for (const bool timed : {true, false})
          for (const float share : {0.1f, std::numeric_limits<float>::infinity()}) {
            EXPECT_EQ(k->overlapChildren(Rows(box).view(half), node, {timed, share, 0.f},
                                         earliest),
                      (1U << count) - 1)
                << k->name;
            for (int lane = 0; lane < count; ++lane)
              EXPECT_EQ(earliest[lane], 0) << k->name;
          }
      }
    }
  }
}

bool doShareEmbedded(const MovingKdopNode& a, int i, const MovingKdopNode& b, int j,
                     const std::set<std::uint32_t>& embedded) {
  for (const auto& mine : a.places)
    for (const auto& theirs : b.places)
      if (mine[i] == theirs[j] && embedded.count(mine[i])) return true;
  return false;
}

struct ExpectedPair {
  int a, b;
  float lo;
};

// Two lowest nodes, or one with itself, with or without a shift, with and without fans.
// One with itself and a shift is of two poses, or of one pose at a distance.
TEST(FCL_KERNELS, trianglesAsOverlapWindow) {
  constexpr std::uint64_t kSeed = 83;
  Random random(kSeed);
  int overlaps = 0, apart = 0, fans = 0, late = 0, far = 0;
  for (int i = 0; i < 6000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const Halves halves = randomHalves(random);
    const float scale = randomScale(random);
    MovingKdopNode a = randomLeaf(random, halves, scale),
                   other = randomLeaf(random, halves, scale);
    const bool same = random.index(3) == 0;
    const MovingKdopNode& b = same ? a : other;
    const bool has_shift = random.index(2), is_self = same && random.index(2),
               is_once = same && (!has_shift || is_self);
    const detail::deformable::MovingKdop box =
        randomBounds(random, randomHalves(random), scale);
    const KdopShift shift = {box.t0, box.t1};
    float rows[2][16];
    for (int r = 0; r < 16; ++r) {
      rows[0][r] = shift.t0.half[MovingKdopNode::halfAxis(r)];
      rows[1][r] = shift.t1.half[MovingKdopNode::halfAxis(r)];
    }
    // The table of embedded fans has an entry for each place.
    const bool has_fans = random.index(2);
    std::set<std::uint32_t> embedded;
    std::vector<std::uint8_t> table(20);
    if (has_fans) {
      for (MovingKdopNode* node : {&a, &other})
        for (auto& row : node->places)
          for (std::uint32_t& p : row)
            if (p != MovingKdopNode::kNoPlace) p %= 20;
      for (std::uint32_t p = 0; p < 20; ++p)
        if (random.index(3) == 0) {
          table[p] = 1;
          embedded.insert(p);
        }
    }
    const auto lanes = static_cast<unsigned>(random.next()) & a.triangles;
    const OverlapRequest request =
        randomRequest(random, depthAtStart(a.box(0), b.box(b.count - 1)),
                      a.displacement[0] + b.displacement[b.count - 1]);

    std::vector<ExpectedPair> expected;
    std::size_t expected_fans = 0;
    for (int x = 0; x < a.count; ++x)
      for (int y = is_once ? x + 1 : 0; y < b.count; ++y) {
        if (!(lanes >> x & 1U) || !b.isTriangle(y)) continue;
        const detail::deformable::MovingKdop moved =
            shifted(a.box(x), has_shift ? &shift : nullptr);
        const detail::deformable::TimeWindow window =
            overlapWindow<false>(moved, b.box(y), nullptr);
        const bool is_far = isTooFar(request, depthAtStart(moved, b.box(y)),
                                     a.displacement[x] + b.displacement[y]);
        far += is_far && !window.isEmpty();
        if (window.isEmpty() || is_far)
          ++apart;
        else if (doShareEmbedded(a, x, b, y, embedded))
          ++expected_fans;
        else
          expected.push_back({x, y, window.lo});
      }
    LanePairs first;
    for (const Kernels* k : allSets()) {
      LanePairs pairs;
      const LeafPairing leaves{a,
                               b,
                               lanes,
                               has_shift ? rows : nullptr,
                               has_fans ? table.data() : nullptr,
                               request,
                               is_self};
      k->overlapTriangles(leaves, pairs);
      if (has_shift && k == allSets().front())
        expected.erase(
            std::remove_if(expected.begin(), expected.end(),
                           [&](const ExpectedPair& pair) {
                             return !(pairs.pairs >> (kWidth * pair.a + pair.b) & 1U) &&
                                    areApartExactly(a.box(pair.a), b.box(pair.b), shift,
                                                    false);
                           }),
            expected.end());
      std::uint64_t expected_bits = 0;
      for (const ExpectedPair& pair : expected)
        expected_bits |= std::uint64_t{1} << (kWidth * pair.a + pair.b);
      ASSERT_EQ(pairs.pairs, expected_bits) << k->name;
      EXPECT_EQ(pairs.fan_culled, expected_fans) << k->name;
      EXPECT_EQ(pairs.compared, static_cast<std::uint64_t>(b.count) *
                                    static_cast<std::size_t>(__builtin_popcount(lanes)))
          << k->name;
      // Another call replaces the pairs and adds to the counts.
      LanePairs twice = pairs;
      k->overlapTriangles(leaves, twice);
      EXPECT_EQ(twice.pairs, pairs.pairs) << k->name;
      EXPECT_EQ(twice.compared, 2 * pairs.compared) << k->name;
      EXPECT_EQ(twice.fan_culled, 2 * pairs.fan_culled) << k->name;
      if (k == allSets().front()) first = pairs;
      for (const ExpectedPair& pair : expected) {
        const float earliest = pairs.earliest[pair.a][pair.b];
        if (request.timed)
          EXPECT_EQ(earliest, pair.lo) << k->name;
        else if (has_shift && earliest == 0)
          // They overlap at t = 0, but for rounding.
          EXPECT_LT(pair.lo, 1e-3f) << k->name;
        else if (!has_shift ||
                 !areApartExactly(a.box(pair.a), b.box(pair.b), shift, true))
          expectUntimed(earliest, shifted(a.box(pair.a), has_shift ? &shift : nullptr),
                        b.box(pair.b), pair.lo);
        EXPECT_EQ(std::memcmp(&earliest, &first.earliest[pair.a][pair.b], sizeof(float)),
                  0)
            << k->name;
      }
      ASSERT_FALSE(HasFailure()) << k->name;
    }
    fans += static_cast<int>(expected_fans);
    overlaps += static_cast<int>(expected.size());
    for (const ExpectedPair& p : expected) late += p.lo > 0;
  }
  EXPECT_GT(overlaps, 5000);
  EXPECT_GT(apart, 5000);
  EXPECT_GT(fans, 1000);
  EXPECT_GT(late, 1000);
  EXPECT_GT(far, 1000);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

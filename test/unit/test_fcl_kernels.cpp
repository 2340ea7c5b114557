// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels decide as the scalar functions do, on every instruction set of the machine
// and with the same bits.
#include "kernels/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "elementary/coplanarity_filter.h"
#include "elementary/elementary.h"
#include "elementary/exact.h"
#include "elementary/predicates.h"
#include "feature_pair_generators.h"
#include "mesh/feature_pairs.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_fans.h"
#include "mesh_generators.h"
#include "tree/box_position.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::MovingPair;
using test::Random;

constexpr int kWidth = MovingKdopNode::kWidth;

TEST(FCL_KERNELS, everyInstructionSetOnceTheBestFirst) {
  const auto all = allKernels();
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.front(), &kernels());
  std::set<std::string> names;
  for (const Kernels* k : all) EXPECT_TRUE(names.insert(k->name).second) << k->name;
    // The last one needs nothing of the machine, where the compiler may not take anything
    // for granted.
#if defined(__x86_64__) && !defined(__SSSE3__)
  const std::string last = all.back()->name;
  EXPECT_TRUE(last == "EMU128" || last == "SCALAR" || last == "plain") << last;
  EXPECT_EQ(all.size() == 1, last == "plain");
#endif
}

TEST(FCL_KERNELS, listingChoosesNothing) {
  const Kernels& before = kernels();
  allKernels();
  EXPECT_EQ(&kernels(), &before);
}

const std::vector<const Kernels*>& allSets() {
  static const std::vector<const Kernels*> all = allKernels();
  return all;
}

/// What the half-axes of a box are like.
enum class Halves { kOnGrid, kSmooth, kSpecial, kAnyBits };

float randomHalf(Random& random, Halves halves) {
  static const float kSpecials[] = {0.f,
                                    -0.f,
                                    1.f,
                                    -1.f,
                                    std::numeric_limits<float>::infinity(),
                                    std::numeric_limits<float>::quiet_NaN(),
                                    FLT_MAX,
                                    -FLT_MAX,
                                    FLT_MIN,
                                    -FLT_MIN,
                                    std::numeric_limits<float>::denorm_min(),
                                    -std::numeric_limits<float>::denorm_min(),
                                    -std::numeric_limits<float>::infinity()};
  switch (halves) {
    case Halves::kOnGrid:
      return static_cast<float>(random.index(12)) - 2;
    case Halves::kSmooth:
      return static_cast<float>(random.uniform(-0.15, 1));
    case Halves::kSpecial:
      // Mostly positive ones, else no pair of boxes would ever overlap.
      return kSpecials[random.index(4) ? 4 + random.index(3) : random.index(13)];
    case Halves::kAnyBits:
      break;
  }
  std::uint32_t bits = static_cast<std::uint32_t>(random.next());
  if (random.index(8)) bits &= 0x7fffffffU;
  float half;
  std::memcpy(&half, &bits, sizeof(half));
  return half;
}

/// Boxes of one kind, or of several; many move by little.
MovingKdop randomBox(Random& random, Halves halves, float scale) {
  MovingKdop box;
  const bool still = random.index(4) == 0;
  for (int j = 0; j < 16; ++j) {
    box.t0.half[j] = scale * randomHalf(random, halves);
    box.t1.half[j] = still ? box.t0.half[j] : scale * randomHalf(random, halves);
  }
  return box;
}

Halves randomHalves(Random& random) { return static_cast<Halves>(random.index(4)); }

float randomScale(Random& random) {
  return random.index(2) ? 1.f
                         : std::ldexp(1.f, static_cast<int>(random.index(260)) - 140);
}

void expectSameWindow(const TimeWindow& window, const TimeWindow& expected) {
  EXPECT_EQ(window.lo, expected.lo);
  EXPECT_EQ(window.hi, expected.hi);
}

/// As roundUp() makes them: never a NaN, minus infinity or minus zero.
void makeBounds(MovingKdop& box) {
  for (Kdop16* frame : {&box.t0, &box.t1})
    for (float& half : frame->half) {
      if (std::isnan(half)) half = std::numeric_limits<float>::infinity();
      half = std::max(half, kLeastHalf) + 0.f;
    }
}

MovingKdop randomBounds(Random& random, Halves halves, float scale) {
  MovingKdop box = randomBox(random, halves, scale);
  makeBounds(box);
  return box;
}

/// The same to the bit, where bits of the mask are set.
template <typename T, std::size_t kCount>
void expectSameBits(unsigned mask, const T (&x)[kCount], const T (&y)[kCount]) {
  for (std::size_t i = 0; i < kCount; ++i)
    if (mask >> i & 1U) {
      EXPECT_EQ(std::memcmp(&x[i], &y[i], sizeof(T)), 0) << i;
    }
}

struct Tally {
  int overlaps{0}, apart{0}, cut{0};

  void add(bool overlaps_now, const TimeWindow& window) {
    ++(overlaps_now ? overlaps : apart);
    cut += overlaps_now && (window.lo > 0 || window.hi < 1);
  }
};

/// A box's half-axes in the order of a node's rows.
struct Rows {
  float t0[16], t1[16];

  explicit Rows(const MovingKdop& box) {
    for (int r = 0; r < 16; ++r) {
      t0[r] = box.t0.half[MovingKdopNode::halfAxis(r)];
      t1[r] = box.t1.half[MovingKdopNode::halfAxis(r)];
    }
  }
  BoxView view(float displacement = 0) const { return {t0, t1, 1, displacement}; }
};

/// The least overlap depth at t = 0.
float depthAtStart(const MovingKdop& a, const MovingKdop& b) {
  float least = a.t0.half[0] + b.t0.half[8];
  for (int j = 1; j < 16; ++j) least = std::min(least, a.t0.half[j] + b.t0.half[j ^ 8]);
  return least;
}

/// Whether no half-axis separates the boxes at t = 0.
bool doOverlapAtStart(const MovingKdop& a, const MovingKdop& b) {
  return depthAtStart(a, b) >= 0;
}

/// A gap that leaves out nothing or, of boxes of that depth, some or none.
float randomGap(Random& random, float depth) {
  switch (random.index(4)) {
    case 0:
      return std::numeric_limits<float>::infinity();
    case 1:
      return 0;
    case 2:
      return -std::min(depth, 0.f);
    default:
      return -std::min(depth, 0.f) * static_cast<float>(random.uniform(0, 2));
  }
}

/// The same as a request, of boxes whose displacements are `moved` together.
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

/// What is said without times of boxes that overlap from `lo` on.
void expectUntimed(float earliest, const MovingKdop& a, const MovingKdop& b, float lo) {
  if (doOverlapAtStart(a, b))
    EXPECT_EQ(earliest, 0);
  else
    EXPECT_TRUE(earliest == FLT_MIN || earliest == lo) << earliest << " " << lo;
}

void expectRightChildren(const BoxView& view, const MovingKdop& box,
                         const MovingKdopNode& node, Tally& tally) {
  float first[kWidth];
  const unsigned mask = allSets().front()->overlapChildren(view, node, {true}, first);
  EXPECT_EQ(mask & ~node.lanes(), 0U) << "a lane that is not in use";
  for (int lane = 0; lane < node.count; ++lane) {
    const TimeWindow expected = overlapWindow<false>(box, node.box(lane), nullptr);
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

/// A request leaves out the children that are too far away at t = 0, and changes nothing
/// of the others. Counts those that it leaves out.
void expectRightRequest(const BoxView& view, const MovingKdop& box,
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

// Boxes of points, as fitPoint() makes them: near and far, on the axes, beyond the range
// of a float, and not finite; of so many vertices in one frame, and of no others.
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
    const auto boxOf = [](const TreeVertex& x, int k) -> const Kdop16& {
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
      Kdop16 box;
      fitPoint(point, origin, offsetPad(size), box);
      const Kdop16& same = boxOf(before[n], 1 - frame);
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

/// A node with triangles of few vertices and, here and there, a node among them.
MovingKdopNode randomLeaf(Random& random, Halves halves, float scale) {
  MovingKdopNode node;
  node.count = 1 + static_cast<int>(random.index(kWidth));
  // Few vertices, or places that differ in a high bit alone.
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

// A node's children hold what is below them, no more: triangles their vertices, nodes
// their children, and lanes that are not in use nothing; in one frame, too, if nothing
// moves.
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
      MovingKdop all;
      std::fill(all.t0.half, all.t0.half + 16, kLeastHalf);
      std::fill(all.t1.half, all.t1.half + 16, kLeastHalf);
      float moved = 0;
      const auto add = [&](const MovingKdop& box, float displacement) {
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
  Tally tally;
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
    // Whatever lies in lanes that are not in use.
    if (random.index(2)) node.clearRest();
    const auto lane = static_cast<int>(random.index(kWidth));
    const MovingKdop box = parent.box(lane);
    // A box by itself, and one of eight.
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

// Boxes that nothing bounds overlap all that is there, and nothing else.
TEST(FCL_KERNELS, unboundedOverlapsWhatIsInUse) {
  for (const float half : {std::numeric_limits<float>::infinity(), FLT_MAX}) {
    MovingKdop box;
    std::fill(box.t0.half, box.t0.half + 16, half);
    box.t1 = box.t0;
    for (int count = 0; count <= kWidth; ++count) {
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

MovingKdop merged(const MovingKdop& a, const MovingKdop& b) {
  MovingKdop out;
  for (int j = 0; j < 16; ++j) {
    out.t0.half[j] = std::max(a.t0.half[j], b.t0.half[j]);
    out.t1.half[j] = std::max(a.t1.half[j], b.t1.half[j]);
  }
  return out;
}

MovingKdop shifted(const MovingKdop& original, const KdopShift* shift) {
  MovingKdop box = original;
  if (!shift) return box;
  for (int j = 0; j < 16; ++j) {
    box.t0.half[j] = detail::deformable::shifted(box.t0.half[j], shift->t0.half[j]);
    box.t1.half[j] = detail::deformable::shifted(box.t1.half[j], shift->t1.half[j]);
  }
  return box;
}

/// Boxes of a triangle's vertices, edges and face.
struct ScalarBoxes {
  MovingKdop vertex[3], edge[3], face;

  ScalarBoxes(const TreeVertex (&x)[3], const KdopShift* shift) {
    for (int k = 0; k < 3; ++k) vertex[k] = x[k].box;
    for (int k = 0; k < 3; ++k) edge[k] = merged(vertex[k], vertex[(k + 1) % 3]);
    face = merged(edge[0], vertex[2]);
    for (int k = 0; k < 3; ++k) {
      vertex[k] = shifted(vertex[k], shift);
      edge[k] = shifted(edge[k], shift);
    }
    face = shifted(face, shift);
  }
};

/// The boxes of the pair of features that a bit stands for, a's first.
std::pair<MovingKdop, MovingKdop> boxesOf(int bit, const ScalarBoxes& a,
                                          const ScalarBoxes& b) {
  const FeaturePair pair = featurePair(bit);
  if (pair.kind == ContinuousContactKind::kEdgeEdge)
    return {a.edge[pair.first], b.edge[pair.second]};
  return pair.first_on_a ? std::make_pair(a.vertex[pair.first], b.face)
                         : std::make_pair(a.face, b.vertex[pair.first]);
}

struct TrianglePairBoxes {
  TreeVertex a[3], b[3];
  KdopShift shift;
  bool has_shift;

  explicit TrianglePairBoxes(Random& random) : has_shift(random.index(2)) {
    const float scale = randomScale(random);
    const bool one_kind = random.index(4);
    const Halves halves = randomHalves(random);
    for (int k = 0; k < 3; ++k) {
      a[k].box = randomBox(random, one_kind ? halves : randomHalves(random), scale);
      b[k].box = randomBox(random, one_kind ? halves : randomHalves(random), scale);
    }
    // Many come apart along an axis, at the start, at the end or all the time.
    if (random.index(3)) {
      const std::size_t j = random.index(16);
      const double start = random.uniform(-2, 6), end = random.uniform(-2, 6);
      for (TreeVertex& x : a) {
        x.box.t0.half[j] -= scale * static_cast<float>(start);
        x.box.t1.half[j] -= scale * static_cast<float>(end);
      }
    }
    for (int k = 0; k < 3; ++k) {
      makeBounds(a[k].box);
      makeBounds(b[k].box);
    }
    MovingKdop box = randomBox(
        random, random.index(3) ? Halves::kSmooth : randomHalves(random), scale);
    makeBounds(box);
    shift = {box.t0, box.t1};
  }
  const KdopShift* shiftOrNull() const { return has_shift ? &shift : nullptr; }

  /// The same, for boxes of b's features.
  KdopShift turnedShift() const {
    KdopShift turned;
    for (int j = 0; j < 16; ++j) {
      turned.t0.half[j] = shift.t0.half[j ^ 8];
      turned.t1.half[j] = shift.t1.half[j ^ 8];
    }
    return turned;
  }

  TrianglePair pair() const {
    return {{&a[0], &a[1], &a[2], &b[0], &b[1], &b[2]}, nullptr, nullptr};
  }
};

TEST(FCL_KERNELS, featuresOfMasks) {
  constexpr std::uint64_t kSeed = 84;
  Random random(kSeed);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint16_t> masks(random.index(20));
    for (std::uint16_t& mask : masks) {
      mask = static_cast<std::uint16_t>(random.next() & 0xffffU);
      if (random.index(2)) mask &= static_cast<std::uint16_t>(random.next() & 0xffffU);
      if (random.index(8) == 0) mask = random.index(2) ? 0 : 0xffff;
    }
    const auto kept = static_cast<unsigned>(random.index(2) ? random.next() : ~0U);
    std::vector<std::uint32_t> expected;
    for (std::size_t k = 0; k < masks.size(); ++k)
      for (int bit = 0; bit < 16; ++bit)
        if (masks[k] & kept & 1U << bit)
          expected.push_back(featureCode(static_cast<std::uint32_t>(k), bit));
    for (const Kernels* k : allSets()) {
      // The room that it asks for, and no more.
      std::vector<std::uint32_t> codes(expected.size() + 16);
      codes.resize(k->listFeatures(masks.data(), masks.size(), kept, codes.data()));
      ASSERT_EQ(codes, expected) << k->name << ", seed " << kSeed << ", " << i;
    }
  }
}

std::vector<TrianglePairBoxes> boxesWithOneShift(Random& random, std::size_t count) {
  std::vector<TrianglePairBoxes> boxes;
  for (std::size_t k = 0; k < count; ++k) {
    boxes.emplace_back(random);
    boxes[k].has_shift = boxes[0].has_shift;
    boxes[k].shift = boxes[0].shift;
  }
  return boxes;
}

// Several triangle pairs at a time; codes and windows of what is left, in order.
TEST(FCL_KERNELS, featuresAsOverlapWindow) {
  constexpr std::uint64_t kSeed = 72;
  constexpr std::uint32_t kPairs = 9;
  Random random(kSeed);
  Tally tally[kNumFeaturePairs];
  int late = 0, far = 0;
  for (int i = 0; i < 12000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::vector<TrianglePairBoxes> boxes = boxesWithOneShift(random, kPairs);
    std::vector<TrianglePair> pairs;
    for (const TrianglePairBoxes& b : boxes) pairs.push_back(b.pair());
    const KdopShift turned_shift = boxes[0].turnedShift();
    const KdopShift* shift = boxes[0].shiftOrNull();
    const float latest =
        random.index(2) ? 1.f : static_cast<float>(random.uniform(-0.1, 1));
    std::vector<float> gaps;
    for (const TrianglePairBoxes& b : boxes)
      gaps.push_back(
          randomGap(random, depthAtStart(b.a[random.index(3)].box, b.b[0].box)));
    const bool has_gaps = random.index(3) > 0;
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      std::vector<std::uint32_t> codes, left;
      std::vector<TimeWindow> left_windows;
      for (std::uint32_t k = 0; k < kPairs; ++k)
        for (int bit = kind == ContinuousContactKind::kEdgeEdge ? 6 : 0;
             bit < (kind == ContinuousContactKind::kEdgeEdge ? kNumFeaturePairs : 6);
             ++bit) {
          if (random.index(3) == 0) continue;
          codes.push_back(featureCode(k, bit));
          // The shift is added to the vertex, or to edge a.
          const bool vertex_on_b = bit >= 3 && bit < 6;
          const ScalarBoxes a(boxes[k].a, vertex_on_b ? nullptr : shift),
              b(boxes[k].b, vertex_on_b && shift ? &turned_shift : nullptr);
          const auto [box_a, box_b] = boxesOf(bit, a, b);
          const TimeWindow expected = overlapWindow<false>(box_a, box_b, nullptr);
          const bool is_far = has_gaps && depthAtStart(box_a, box_b) < -gaps[k];
          far += is_far && !expected.isEmpty();
          if (!expected.isEmpty() && expected.lo <= latest && !is_far) {
            left.push_back(codes.back());
            left_windows.push_back(expected);
          }
          late += !expected.isEmpty() && expected.lo > latest;
          tally[bit].add(!expected.isEmpty(), expected);
        }
      std::vector<TimeWindow> first;
      for (const Kernels* kernels : allSets()) {
        std::vector<std::uint32_t> mine = codes;
        mine.resize(codes.size() + 15);
        std::vector<TimeWindow> windows(codes.size());
        const std::size_t count = kernels->cullFeatures(
            kind, pairs.data(), shift, &turned_shift, latest,
            has_gaps ? gaps.data() : nullptr, mine.data(), codes.size(), windows.data());
        mine.resize(count);
        windows.resize(count);
        ASSERT_EQ(mine, left) << kernels->name;
        for (std::size_t k = 0; k < count; ++k)
          expectSameWindow(windows[k], left_windows[k]);
        if (first.empty()) first = windows;
        for (std::size_t k = 0; k < count; ++k)
          ASSERT_EQ(std::memcmp(&windows[k], &first[k], sizeof(TimeWindow)), 0)
              << kernels->name;
      }
    }
    ASSERT_FALSE(HasFailure());
  }
  for (int bit = 0; bit < kNumFeaturePairs; ++bit) {
    EXPECT_GT(tally[bit].overlaps, 1000) << bit;
    EXPECT_GT(tally[bit].apart, 1000) << bit;
    EXPECT_GT(tally[bit].cut, 300) << bit;
  }
  EXPECT_GT(late, 1000);
  EXPECT_GT(far, 1000);
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

// Two leaves or one with itself, moved against each other or not, with and without fans.
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
    const bool has_shift = !same && random.index(2);
    const MovingKdop box = randomBounds(random, randomHalves(random), scale);
    const KdopShift shift = {box.t0, box.t1};
    float rows[2][16];
    for (int r = 0; r < 16; ++r) {
      rows[0][r] = shift.t0.half[MovingKdopNode::halfAxis(r)];
      rows[1][r] = shift.t1.half[MovingKdopNode::halfAxis(r)];
    }
    // A table of what is embedded reaches as far as the places.
    const bool has_fans = !has_shift && random.index(2);
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
      for (int y = same ? x + 1 : 0; y < b.count; ++y) {
        if (!(lanes >> x & 1U) || !b.isTriangle(y)) continue;
        const MovingKdop moved = shifted(a.box(x), has_shift ? &shift : nullptr);
        const TimeWindow window = overlapWindow<false>(moved, b.box(y), nullptr);
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
      const LeafPairing leaves{
          a,      b, lanes, has_shift ? rows : nullptr, has_fans ? table.data() : nullptr,
          request};
      k->overlapTriangles(leaves, pairs);
      std::uint64_t expected_bits = 0;
      for (const ExpectedPair& pair : expected)
        expected_bits |= std::uint64_t{1} << (kWidth * pair.a + pair.b);
      ASSERT_EQ(pairs.pairs, expected_bits) << k->name;
      EXPECT_EQ(pairs.fan_culled, expected_fans) << k->name;
      EXPECT_EQ(pairs.compared, static_cast<std::uint64_t>(b.count) *
                                    static_cast<std::size_t>(__builtin_popcount(lanes)))
          << k->name;
      // Another call leaves nothing of the pairs and adds to the counts.
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
        else
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

TEST(FCL_KERNELS, edgesAndFacesAtStart) {
  constexpr std::uint64_t kSeed = 73;
  constexpr std::uint32_t kPairs = 12;
  Random random(kSeed);
  int overlaps[6] = {}, apart[6] = {};
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::vector<TrianglePairBoxes> boxes = boxesWithOneShift(random, kPairs);
    std::vector<TrianglePair> pairs;
    for (const TrianglePairBoxes& b : boxes) pairs.push_back(b.pair());
    const KdopShift turned_shift = boxes[0].turnedShift();
    const KdopShift* shift = boxes[0].shiftOrNull();
    std::vector<std::uint32_t> codes, left;
    for (std::uint32_t k = 0; k < kPairs; ++k) {
      const ScalarBoxes a(boxes[k].a, nullptr), b(boxes[k].b, nullptr);
      const ScalarBoxes moved_a(boxes[k].a, shift),
          moved_b(boxes[k].b, shift ? &turned_shift : nullptr);
      for (int bit = 0; bit < 6; ++bit) {
        if (random.index(2)) continue;
        codes.push_back(featureCode(k, bit));
        const bool overlap = bit < 3 ? doOverlapAtStart(moved_a.edge[bit], b.face)
                                     : doOverlapAtStart(a.face, moved_b.edge[bit - 3]);
        if (overlap) left.push_back(codes.back());
        ++(overlap ? overlaps : apart)[bit];
      }
    }
    for (const Kernels* k : allSets()) {
      std::vector<std::uint32_t> mine = codes;
      mine.resize(codes.size() + 15);
      mine.resize(k->cullCrossings(pairs.data(), shift, &turned_shift, mine.data(),
                                   codes.size()));
      ASSERT_EQ(mine, left) << k->name;
    }
  }
  for (int bit = 0; bit < 6; ++bit) {
    EXPECT_GT(overlaps[bit], 500) << bit;
    EXPECT_GT(apart[bit], 500) << bit;
  }
}

/// Five points of few values, so that many lie in a plane or are the same, or of any: the
/// ends of an edge and the corners of a face. Returns whether they are nothing special.
bool setCrossing(Random& random, double scale, TreeVertex (&x)[5]) {
  const bool few = random.index(2) == 0;
  for (TreeVertex& vertex : x)
    for (double& c : vertex.t0)
      c = scale * (few ? static_cast<double>(random.index(4)) : random.uniform(-1, 1));
  if (random.index(4) > 0) return !few;
  // The edge ends next to the plane of the face, or passes next to an edge of it.
  const double s = random.uniform(0, 1), tilt = random.uniform(-1, 1) * 0x1p-50 * scale;
  for (int k = 0; k < 3; ++k)
    x[1].t0[k] = s * x[2].t0[k] + (1 - s) * x[3].t0[k] + (k == 2 ? tilt : 0);
  return false;
}

/// An edge, any of a's or b's, and the face of the other triangle.
class CrossingPair {
 public:
  TreeVertex x[5];

  /// @param bit  of the edge, as in Kernels::cullCrossings()
  TrianglePair pair(std::uint32_t bit) const {
    TrianglePair pair{};
    const std::uint32_t edge = bit / 3 * 3, face = 3 - edge, k = bit % 3;
    pair.x[edge + k] = &x[0];
    pair.x[edge + (k + 1) % 3] = &x[1];
    pair.x[edge + (k + 2) % 3] = &far_;
    for (std::uint32_t i = 0; i < 3; ++i) pair.x[face + i] = &x[2 + i];
    return pair;
  }

 private:
  /// The third corner, which does not count.
  TreeVertex far_{};
};

// What is left out does not cross, on every instruction set; nearly all of what does not
// is, unless it is special.
TEST(FCL_KERNELS, whatMayCross) {
  constexpr std::uint64_t kSeed = 74;
  Random random(kSeed);
  int crossing = 0, apart = 0, left = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const double scale =
        std::ldexp(1, i % 3 > 0 ? 0 : 60 * static_cast<int>(random.index(34)) - 1020);
    CrossingPair crossings[8];
    TrianglePair pairs[8];
    std::uint32_t codes[8];
    bool is_plain[8];
    const std::size_t count = 1 + random.index(8);
    for (std::uint32_t n = 0; n < count; ++n) {
      const auto bit = static_cast<std::uint32_t>(random.index(6));
      is_plain[n] = setCrossing(random, scale, crossings[n].x) && i % 3 > 0;
      pairs[n] = crossings[n].pair(bit);
      codes[n] = featureCode(n, static_cast<int>(bit));
    }
    const unsigned found = allSets().front()->mayCross(pairs, codes, count);
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->mayCross(pairs, codes, count), found) << k->name;
    EXPECT_EQ(found >> count, 0U);
    for (unsigned lane = 0; lane < count; ++lane) {
      const auto at = [&](std::size_t k) -> const double(&)[3] {
        return reinterpret_cast<const double(&)[3]>(crossings[lane].x[k].t0);
      };
      const bool crosses = isCrossing(at(0), at(1), at(2), at(3), at(4));
      const bool kept = found >> lane & 1U;
      EXPECT_TRUE(kept || !crosses);
      crossing += crosses;
      apart += !crosses && is_plain[lane];
      left += !crosses && is_plain[lane] && kept;
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(crossing, 5000);
  EXPECT_GT(apart, 20000);
  EXPECT_LT(1000 * left, apart);
}

/// Two triangles whose coordinates are whole numbers, so that sums of them are exact, but
/// not always products; the second one has a vertex, or the middle of an edge, where the
/// first one has.
struct TouchingTriangles {
  TreeVertex a[3], b[3];

  explicit TouchingTriangles(Random& random) {
    constexpr std::size_t kSizes[] = {4, 2000, std::size_t{1} << 48};
    const std::size_t size = kSizes[random.index(3)];
    const auto whole = [&random, size] {
      return 2 * static_cast<double>(random.index(size));
    };
    double shift[3];
    for (TreeVertex* x : {a, b})
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) x[i].t0[k] = whole();
    // A layer beside a layer, as cloth has it.
    const bool parallel = random.index(2) == 0;
    if (parallel)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
          b[i].t0[k] = a[i].t0[k] + 2 * static_cast<double>(random.index(2));
    const std::size_t mine = random.index(6), theirs = random.index(6);
    for (int k = 0; k < 3; ++k) shift[k] = place(a, mine, k) - place(b, theirs, k);
    move(shift);
  }

  TouchingTriangles(const TouchingTriangles&) = default;

  /// Of vertex i, or of the middle of edge i - 3.
  static double place(const TreeVertex (&x)[3], std::size_t i, int k) {
    return i < 3 ? x[i].t0[k] : 0.5 * (x[i - 3].t0[k] + x[(i - 2) % 3].t0[k]);
  }

  /// Moves the second one.
  void move(const double (&by)[3]) {
    for (TreeVertex& x : b)
      for (int k = 0; k < 3; ++k) x.t0[k] += by[k];
  }

  void scale(double by, double offset) {
    for (TreeVertex* x : {a, b})
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) x[i].t0[k] = by * (x[i].t0[k] + offset);
  }

  /// Lets the two come closer by as much in the step, along an axis: some of it by a
  /// vertex of the one, the rest by one of the other.
  void setApproach(Random& random, double approach) {
    for (TreeVertex* x : {a, b})
      for (int i = 0; i < 3; ++i) x[i].t0[3] = 0;
    const double part = 0.25 * static_cast<double>(random.index(5));
    a[random.index(3)].t0[3] = part * approach;
    b[random.index(3)].t0[3] = (1 - part) * approach;
  }

  TrianglePair pair() const {
    return {{&a[0], &a[1], &a[2], &b[0], &b[1], &b[2]}, nullptr, nullptr};
  }
};

// Triangles that touch when one is moved by as much as they can approach each other are
// never called apart.
TEST(FCL_KERNELS, trianglesThatComeTogetherAreNotApart) {
  constexpr std::uint64_t kSeed = 75;
  Random random(kSeed);
  int apart = 0, total = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    double approach[8];
    for (double& x : approach)
      x = random.index(4) ? static_cast<double>(random.index(40)) : 0;
    // Of what they approach in the whole step.
    const double share = std::ldexp(1, -static_cast<int>(random.index(20)));
    const double scale =
        std::ldexp(1, i % 3 > 0 ? 0 : 60 * static_cast<int>(random.index(32)) - 960);
    const double offset = random.index(2) ? std::ldexp(1, 30) : 0;
    std::vector<TouchingTriangles> triangles;
    std::vector<TrianglePair> touching, separated;
    const std::size_t count = 1 + random.index(8);
    for (std::size_t n = 0; n < 2 * count; ++n) {
      triangles.emplace_back(random);
      // The first ones so far that they can come together, the others, further.
      const double size = n < count ? approach[n] : 40 * (approach[n - count] + 1);
      double away[3];
      for (double& w : away) w = size * (static_cast<double>(random.index(3)) - 1);
      triangles.back().move(away);
      triangles.back().scale(scale, offset);
      triangles.back().setApproach(random, scale * approach[n % count] / share);
    }
    for (std::size_t n = 0; n < 2 * count; ++n)
      (n < count ? touching : separated).push_back(triangles[n].pair());
    float gaps[8];
    for (const Kernels* k : allSets()) {
      EXPECT_EQ(k->areApart(touching.data(), count, share, gaps), 0U) << k->name;
      for (std::size_t n = 0; n < count; ++n)
        EXPECT_EQ(gaps[n], roundUp(2 * scale * approach[n], 0.f)) << k->name;
    }
    const unsigned found =
        allSets().front()->areApart(separated.data(), count, share, gaps);
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->areApart(separated.data(), count, share, gaps), found) << k->name;
    apart += __builtin_popcount(found);
    total += static_cast<int>(count);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(3 * apart, total);
}

// Layers are called apart where three times the approach does not bridge what is between
// them, wherever they are and whichever is on top; by the plane of either.
TEST(FCL_KERNELS, layersAreApart) {
  for (const double offset : {0., 0x1p30})
    for (const double height : {1., -1.})
      // Which of them stands upright, so that its plane cuts the other one.
      for (const int upright : {-1, 0, 1}) {
        TreeVertex x[2][3] = {};
        for (int t = 0; t < 2; ++t) {
          const double corners[3][3] = {{0, -4, 0}, {8, -4, 0}, {4, 4, 0}};
          for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) x[t][i].t0[k] = offset + corners[i][k];
          if (t == upright) {
            for (TreeVertex& v : x[t]) v.t0[1] = offset;
            x[t][2].t0[2] += (t == 0 ? -8 : 8) * height;
          }
          for (TreeVertex& v : x[t]) v.t0[2] += t * height;
        }
        const TrianglePair pair{
            {&x[0][0], &x[0][1], &x[0][2], &x[1][0], &x[1][1], &x[1][2]},
            nullptr,
            nullptr};
        x[0][1].t0[3] = x[1][2].t0[3] = 0.5;
        for (const Kernels* k : allSets()) {
          float gaps[8];
          EXPECT_EQ(k->areApart(&pair, 1, 0.33, gaps), 1U) << k->name << " " << upright;
          EXPECT_EQ(k->areApart(&pair, 1, 0, gaps), 1U) << k->name << " " << upright;
          EXPECT_EQ(k->areApart(&pair, 1, 0.34, gaps), 0U) << k->name << " " << upright;
        }
      }
}

TEST(FCL_KERNELS, whatIsNotFiniteMayCross) {
  CrossingPair crossing{};
  TreeVertex(&vertices)[5] = crossing.x;
  // An edge far above a face.
  vertices[0].t0[2] = vertices[1].t0[2] = vertices[1].t0[0] = 1;
  vertices[3].t0[0] = vertices[4].t0[1] = 1;
  const TrianglePair pair = crossing.pair(0);
  const std::uint32_t code = featureCode(0, 0);
  for (const Kernels* k : allSets()) EXPECT_EQ(k->mayCross(&pair, &code, 1), 0u);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (TreeVertex& vertex : vertices) {
      const double before = vertex.t0[0];
      vertex.t0[0] = bad;
      for (const Kernels* k : allSets())
        EXPECT_EQ(k->mayCross(&pair, &code, 1), 1u) << k->name;
      vertex.t0[0] = before;
    }
}

/// A pair and the window in which it is looked at.
struct FilterQuery {
  MovingPair pair;
  double lo, hi;
};

/// Eight pairs as the kernels take them; keeps the vertices.
class EightPoints {
 public:
  explicit EightPoints(const FilterQuery (&queries)[8]) {
    for (std::size_t lane = 0; lane < 8; ++lane)
      for (std::size_t i = 0; i < 4; ++i) {
        const VertexPath& path = queries[lane].pair.x[i];
        TreeVertex& x = x_[lane][i];
        std::copy(path.t0, path.t0 + 3, x.t0);
        std::copy(path.t1, path.t1 + 3, x.t1);
        // The fourth number is nobody's.
        x.t0[3] = x.t1[3] = std::numeric_limits<double>::quiet_NaN();
      }
  }

  /// @param queries  the same pairs, in any windows
  EightPairs pairs(const FilterQuery (&queries)[8]) const {
    EightPairs out;
    out.kind = queries[0].pair.kind;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const TreeVertex* const x[4] = {&x_[lane][0], &x_[lane][1], &x_[lane][2],
                                      &x_[lane][3]};
      out.set(lane, x, queries[lane].lo, queries[lane].hi);
    }
    return out;
  }

 private:
  TreeVertex x_[8][4];
};

void randomWindow(Random& random, double& lo, double& hi) {
  switch (random.index(6)) {
    case 0:
      lo = 0;
      hi = 1;
      return;
    case 1:
      lo = hi = static_cast<double>(random.index(2));
      return;
    case 2:
      lo = hi = random.uniform(0, 1);
      return;
    case 3:
      lo = 0;
      hi = random.uniform(0, 1);
      return;
    case 4:
      lo = random.uniform(0, 1);
      hi = 1;
      return;
    default:
      lo = random.uniform(0, 1);
      hi = random.uniform(lo, 1);
  }
}

/// Points here and there; many of the pairs stay on one side of each other.
MovingPair randomPair(Random& random, ContinuousContactKind kind) {
  MovingPair pair{kind, {}};
  const double step = random.index(2) ? 0.2 : 1;
  const bool on_grid = random.index(4) == 0;
  for (VertexPath& x : pair.x)
    for (int k = 0; k < 3; ++k) {
      x.t0[k] = random.uniform(-1, 1);
      x.t1[k] = x.t0[k] + random.uniform(-step, step);
      if (on_grid) {
        x.t0[k] = std::round(2 * x.t0[k]);
        x.t1[k] = std::round(2 * x.t1[k]);
      }
    }
  return pair;
}

void scale(MovingPair& pair, double factor) {
  for (VertexPath& x : pair.x)
    for (int k = 0; k < 3; ++k) {
      x.t0[k] *= factor;
      x.t1[k] *= factor;
    }
}

ContinuousContactKind oneOfTwo(Random& random) {
  return random.index(2) ? ContinuousContactKind::kVertexFace
                         : ContinuousContactKind::kEdgeEdge;
}

/// How many of eight pairs the filter finds what about.
struct FilterCounts {
  int may{0};      // become coplanar, in the end
  int unclear{0};  // in doubles
};

/// Pairs as features of triangle pairs that have other vertices besides, with windows.
struct FilterBlock {
  std::vector<TreeVertex> vertices;
  TrianglePair pairs[8];
  std::uint32_t codes[8];
  TimeWindow windows[8];

  explicit FilterBlock(const FilterQuery (&queries)[8]) : vertices(33) {
    // Not of any feature.
    for (double* x : {vertices[32].t0, vertices[32].t1})
      std::fill(x, x + 4, std::numeric_limits<double>::quiet_NaN());
    for (std::uint32_t lane = 0; lane < 8; ++lane) {
      const FilterQuery& q = queries[lane];
      const bool vf = q.pair.kind == ContinuousContactKind::kVertexFace;
      const int bit = vf ? static_cast<int>(lane) % 6 : 6 + static_cast<int>(lane);
      const std::uint32_t place = (3 * lane + 5) % 8;
      std::fill(pairs[place].x, pairs[place].x + 6, &vertices[32]);
      for (std::size_t i = 0; i < 4; ++i) {
        const VertexPath& path = q.pair.x[i];
        TreeVertex& x = vertices[4 * lane + i];
        x.setPath(path.t0, path.t1);
        pairs[place].x[kFeaturePoints[bit][i]] = &x;
      }
      codes[lane] = featureCode(place, bit);
      windows[lane] = {static_cast<float>(q.lo), static_cast<float>(q.hi)};
    }
  }
};

/// Every instruction set finds what the scalar filter finds, lane by lane, and comes to
/// the same decision where both go on in twice the digits.
FilterCounts expectRightFilter(const FilterQuery (&queries)[8], double latest = 1) {
  const FilterBlock block(queries);
  const ContinuousContactKind kind = queries[0].pair.kind;
  unsigned possible = 0, unclear = 0, may = 0, may_accurately = 0;
  for (unsigned lane = 0; lane < 8; ++lane) {
    const FeaturePoints x = queries[lane].pair.points();
    const double lo = windowLo(block.windows[lane]),
                 hi = std::min(windowHi(block.windows[lane]), latest);
    const Coplanarity found = coplanarityInDoubles(kind, x, lo, hi);
    possible |= unsigned{found == Coplanarity::kPossible} << lane;
    unclear |= unsigned{found == Coplanarity::kUnclear} << lane;
    may |= unsigned{mayBecomeCoplanar(kind, x, lo, hi)} << lane;
    may_accurately |= unsigned{mayBecomeCoplanarAccurately(kind, x, lo, hi)} << lane;
  }
  for (const Kernels* k : allSets())
    for (const std::size_t count : {8, 1}) {
      const EightCoplanarities found =
          k->coplanarity(kind, block.pairs, block.codes, block.windows, count, latest);
      const unsigned used = (1U << count) - 1;
      EXPECT_EQ(found.possible | (found.unclear & may_accurately), may & used) << k->name;
      EXPECT_EQ(found.possible, possible & used) << k->name;
      EXPECT_EQ(found.unclear, unclear & used) << k->name;
      for (unsigned lane = 0; lane < count; ++lane)
        if (((found.possible ^ possible) | (found.unclear ^ unclear)) >> lane & 1U)
          ADD_FAILURE() << queries[lane].pair << std::hexfloat << " in ["
                        << queries[lane].lo << ", " << queries[lane].hi << "] until "
                        << latest;
    }
  return {__builtin_popcount(may), __builtin_popcount(unclear)};
}

/// The same for blocks of random pairs and windows.
/// @param make_pair  from the random numbers and a kind
template <typename MakePair>
FilterCounts expectRightFilter(std::uint64_t seed, int num_blocks, MakePair&& make_pair) {
  Random random(seed);
  FilterCounts sum;
  for (int i = 0; i < num_blocks && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(i));
    const ContinuousContactKind kind = oneOfTwo(random);
    FilterQuery queries[8];
    for (FilterQuery& q : queries) {
      q.pair = make_pair(random, kind);
      randomWindow(random, q.lo, q.hi);
    }
    const double latest = random.index(2) ? 1 : random.uniform(0.5, 1);
    const FilterCounts n = expectRightFilter(queries, latest);
    sum.may += n.may;
    sum.unclear += n.unclear;
  }
  return sum;
}

TEST(FCL_KERNELS, filterAsTheScalarOne) {
  constexpr int kBlocks = 20000;
  const FilterCounts n = expectRightFilter(74, kBlocks, randomPair);
  EXPECT_GT(n.may, kBlocks / 2);
  EXPECT_LT(n.may, 7 * kBlocks);
  EXPECT_LT(n.unclear, kBlocks / 1000);  // doubles are enough for most
}

// Sizes over all of double's range: products that underflow or overflow, and the edges of
// the range in which the bounds hold.
TEST(FCL_KERNELS, filterOfAllSizes) {
  constexpr std::uint64_t kSeed = 75;
  Random random(kSeed);
  int may = 0, never = 0;
  for (int exponent = -1074; exponent <= 1023; ++exponent)
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      FilterQuery queries[8];
      for (FilterQuery& q : queries) {
        q.pair = randomPair(random, kind);
        scale(q.pair, std::ldexp(1, exponent));
        // One point alone of another size.
        if (random.index(3) == 0)
          for (int k = 0; k < 3; ++k)
            q.pair.x[random.index(4)].t1[k] *= std::ldexp(1, exponent / 2);
        randomWindow(random, q.lo, q.hi);
      }
      const int n = expectRightFilter(queries).may;
      may += n;
      never += 8 - n;
      ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", 2^" << exponent;
    }
  EXPECT_GT(may, 5000);
  EXPECT_GT(never, 1000);
}

// Signs that agree, by much less than what doubles may lose or by nearly that: around the
// bound every instruction set is on the same side of it.
TEST(FCL_KERNELS, filterOfNarrowSigns) {
  constexpr int kBlocks = 5000;
  const auto makePair = [](Random& random, ContinuousContactKind kind) {
    // A slope z = a x + b y, and the first feature a little above it.
    const double a = random.uniform(-2, 2), b = random.uniform(-2, 2);
    const double gap =
        random.uniform(0x1p-54, 0x1p-53) * static_cast<double>(1U << random.index(16));
    MovingPair pair = randomPair(random, kind);
    for (int n = 0; n < 4; ++n) {
      VertexPath& p = pair.x[n];
      const bool above = n < (kind == ContinuousContactKind::kVertexFace ? 1 : 2);
      p.t0[2] = a * p.t0[0] + b * p.t0[1] + (above ? gap : 0);
      p.t1[2] = a * p.t1[0] + b * p.t1[1] + (above ? gap : 0);
    }
    return pair;
  };
  const FilterCounts n = expectRightFilter(78, kBlocks, makePair);
  EXPECT_GT(n.may, kBlocks);
  EXPECT_LT(n.may, 7 * kBlocks);
  EXPECT_GT(n.unclear, kBlocks);
}

// Pairs that are flat, still, or touch all the time: what is nearly or exactly coplanar
// "may" be so.
TEST(FCL_KERNELS, filterOfDegeneratePairs) {
  expectRightFilter(76, 5000, [](Random& random, ContinuousContactKind kind) {
    MovingPair pair = randomPair(random, kind);
    auto& x = pair.x;
    switch (random.index(6)) {
      case 0:  // all in one plane
        for (VertexPath& p : x) p.t0[2] = p.t1[2] = 0.25;
        break;
      case 1:  // at rest
        for (VertexPath& p : x) std::copy(p.t0, p.t0 + 3, p.t1);
        break;
      case 2:  // no normal
        x[1] = x[random.index(4)];
        break;
      case 3:  // a unit in the last place off a plane
        for (VertexPath& p : x) p.t0[2] = p.t1[2] = 1;
        x[random.index(4)].t1[2] = std::nextafter(1, 2);
        break;
      case 4:  // far away
        for (VertexPath& p : x)
          for (int k = 0; k < 3; ++k) {
            p.t0[k] += 1e9;
            p.t1[k] += 1e9;
          }
        break;
      default:  // one point for all
        for (VertexPath& p : x) p = x[0];
    }
    return pair;
  });
}

// What is not finite proves nothing, even where the window ends before it counts, and
// leaves the other lanes alone.
TEST(FCL_KERNELS, filterKeepsWhatIsNotFinite) {
  constexpr std::uint64_t kSeed = 77;
  Random random(kSeed);
  const double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity()};
  int never = 0;
  for (int i = 0; i < 20000; ++i) {
    const ContinuousContactKind kind = oneOfTwo(random);
    FilterQuery queries[8];
    unsigned bad = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      FilterQuery& q = queries[lane];
      q.pair = randomPair(random, kind);
      randomWindow(random, q.lo, q.hi);
      if (random.index(2)) continue;
      bad |= 1U << lane;
      if (random.index(8) == 0) {
        (random.index(2) ? q.lo : q.hi) = kBad[0];
        continue;
      }
      for (std::size_t n = 1 + random.index(3); n-- > 0;) {
        VertexPath& x = q.pair.x[random.index(4)];
        (random.index(2) ? x.t0 : x.t1)[random.index(3)] = kBad[random.index(3)];
      }
    }
    never += 8 - expectRightFilter(queries).may;
    const FilterBlock block(queries);
    for (const Kernels* k : allSets())
      ASSERT_EQ(
          k->coplanarity(kind, block.pairs, block.codes, block.windows, 8, 1).possible &
              bad,
          bad)
          << k->name;
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(never, 1000);
}

/// A vertex and its spokes.
struct RandomFan {
  std::vector<TreeVertex> vertices;  // the spokes, then the center
  std::vector<std::uint32_t> spokes;
  bool is_closed;

  /// Spokes around a center, `turns` times round, more or less in a plane.
  RandomFan(Random& random, std::size_t count, bool closed, double turns, double noise)
      : is_closed(closed) {
    const Vector3<double> tilt = random.point(1), at = random.point(5);
    const double motion = random.uniform(0, 1);
    const auto add = [&](const Vector3<double>& p) {
      const Vector3<double> a = p + random.point(noise),
                            b = a + motion * random.point(noise);
      TreeVertex x{};
      for (int k = 0; k < 3; ++k) {
        // A shear, so that the plane is not one of the axes'.
        x.t0[k] = a[k] + tilt[k] * a[(k + 1) % 3] + at[k];
        x.t1[k] = b[k] + tilt[k] * b[(k + 1) % 3] + at[k];
      }
      vertices.push_back(x);
    };
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2 * 3.14159265358979 * turns * static_cast<double>(i) /
                           static_cast<double>(closed ? count : count - 1);
      const double length = random.uniform(0.5, 1.5);
      add({length * std::cos(angle), length * std::sin(angle), 0});
      spokes.push_back(static_cast<std::uint32_t>(i));
    }
    add({0, 0, 0});
  }

  /// Whether features of the triangles that share no vertex touch at some time.
  bool doTouch() const {
    std::vector<Triangle> triangles;
    const std::size_t n = spokes.size();
    for (std::size_t i = 0; i + (is_closed ? 0 : 1) < n; ++i)
      triangles.emplace_back(n, i, (i + 1) % n);
    const auto mesh = assignFeatures(triangles.data(), triangles.size(), n + 1);
    bool touch = false;
    for (std::size_t i = 0; i < mesh.size(); ++i)
      for (std::size_t j = i + 1; j < mesh.size(); ++j)
        forEachFeaturePair<true>(mesh[i], mesh[j], [&](const FeaturePair& f) {
          const MeshTriangle &a = f.first_on_a ? mesh[i] : mesh[j],
                             &b = f.first_on_a ? mesh[j] : mesh[i];
          if (touch) return;
          const bool vf = f.kind == ContinuousContactKind::kVertexFace;
          const VertexPath x[4] = {path(a.v[f.first]),
                                   path(vf ? b.v[0] : a.v[(f.first + 1) % 3]),
                                   path(vf ? b.v[1] : b.v[f.second]),
                                   path(vf ? b.v[2] : b.v[(f.second + 1) % 3])};
          touch = elementaryTest(f.kind, x, 0, 1, 1e-6).answer != Answer::kNo;
        });
    return touch;
  }

 private:
  VertexPath path(std::uint32_t i) const {
    const TreeVertex& x = vertices[i];
    return {{x.t0[0], x.t0[1], x.t0[2]}, {x.t1[0], x.t1[1], x.t1[2]}};
  }
};

/// The answers of every instruction set for up to eight fans that are alike, a bit each.
unsigned areEmbedded(const std::vector<RandomFan>& fans) {
  // Their vertices one behind the other, the first fan's last.
  std::vector<TreeVertex> vertices;
  std::vector<std::uint32_t> spokes[8];
  std::size_t centers[8];
  for (std::size_t i = 8; i-- > 0;) {
    const RandomFan& fan = fans[std::min(i, fans.size() - 1)];
    for (const std::uint32_t spoke : fan.spokes)
      spokes[i].push_back(spoke + static_cast<std::uint32_t>(vertices.size()));
    vertices.insert(vertices.end(), fan.vertices.begin(), fan.vertices.end());
    centers[i] = vertices.size() - 1;
  }
  EightFans eight;
  eight.count = static_cast<std::uint32_t>(fans.front().spokes.size());
  eight.is_closed = fans.front().is_closed;
  for (std::size_t i = 0; i < 8; ++i) {
    eight.center[i] = &vertices[centers[i]];
    eight.spokes[i] = spokes[i].data();
  }
  const unsigned found = allSets().front()->areFansEmbedded(vertices.data(), eight);
  for (const Kernels* k : allSets())
    EXPECT_EQ(k->areFansEmbedded(vertices.data(), eight), found) << k->name;
  const bool last = found >> (fans.size() - 1) & 1U;
  for (std::size_t i = fans.size(); i < 8; ++i) EXPECT_EQ(found >> i & 1U, last) << i;
  return found;
}

bool isEmbedded(const RandomFan& fan) { return areEmbedded({fan}) & 1U; }

TEST(FCL_KERNELS, embeddedFansDoNotTouch) {
  constexpr std::uint64_t kSeed = 78;
  Random random(kSeed);
  int embedded[2] = {}, not_proved[2] = {}, touching = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const bool closed = random.index(2);
    const std::size_t count = i % 8 ? 3 + random.index(6) : 9 + random.index(16);
    std::vector<RandomFan> fans;
    for (int n = 0; n < 8; ++n) {
      const double turns = closed ? (random.index(4) ? 1 : 2) : random.uniform(0.2, 1.4);
      fans.emplace_back(random, count, closed, turns, std::pow(random.uniform(0, 1), 2));
    }
    const unsigned found = areEmbedded(fans);
    for (std::size_t n = 0; n < 8; ++n) {
      const bool proved = found >> n & 1U;
      ++(proved ? embedded : not_proved)[closed];
      const bool touch = fans[n].doTouch();
      touching += touch;
      EXPECT_FALSE(proved && touch) << n << ", " << count << (closed ? ", closed" : "");
      // Nor does an answer depend on what lies beside it.
      EXPECT_EQ(isEmbedded(fans[n]), proved) << n;
    }
  }
  for (const int c : {0, 1}) {
    EXPECT_GT(embedded[c], 100) << c;
    EXPECT_GT(not_proved[c], 100) << c;
  }
  EXPECT_GT(touching, 200);
}

// A flat fan is embedded, one that goes round twice is not; every number of spokes.
TEST(FCL_KERNELS, flatFans) {
  Random random(79);
  for (std::size_t count = 2; count <= 3 * VertexFans::kShort; ++count) {
    EXPECT_TRUE(isEmbedded(RandomFan(random, count, false, 0.4, 0))) << count;
    if (count < 3) continue;
    EXPECT_TRUE(isEmbedded(RandomFan(random, count, true, 1, 0)) || count == 3) << count;
    if (count >= 5) {
      EXPECT_FALSE(isEmbedded(RandomFan(random, count, true, 2, 0))) << count;
      EXPECT_FALSE(isEmbedded(RandomFan(random, count, false, 1.2, 0))) << count;
    }
  }
}

/// A fan in the plane z = 0 that does not move.
RandomFan flatFan(const std::vector<std::array<double, 2>>& spokes, bool closed) {
  Random random(81);
  RandomFan fan(random, spokes.size(), closed, 1, 0);
  for (std::size_t i = 0; i <= spokes.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      fan.vertices[i].t0[k] = fan.vertices[i].t1[k] =
          i < spokes.size() && k < 2 ? spokes[i][k] : 0;
  return fan;
}

// The ray goes through the middle of the first sector. A spoke that lies on it hides that
// the fan goes round twice.
TEST(FCL_KERNELS, spokeOnTheRay) {
  const RandomFan twice = flatFan(
      {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}, true);
  EXPECT_TRUE(twice.doTouch());
  EXPECT_FALSE(isEmbedded(twice));
  EXPECT_TRUE(isEmbedded(flatFan({{1, 0}, {0, 1}, {-1, 0}, {0, -1}}, true)));
}

// All triangles face the same way at both ends of the step, and all vertices meet in
// between.
TEST(FCL_KERNELS, fansThatTurnInsideOut) {
  for (const bool closed : {false, true}) {
    std::vector<std::array<double, 2>> spokes{{1, 0}, {0, 1}, {-1, 0}};
    if (closed) spokes.push_back({0, -1});
    RandomFan fan = flatFan(spokes, closed);
    EXPECT_TRUE(isEmbedded(fan)) << closed;
    for (TreeVertex& x : fan.vertices)
      for (int k = 0; k < 3; ++k) x.t1[k] = -x.t0[k];
    EXPECT_TRUE(fan.doTouch()) << closed;
    EXPECT_FALSE(isEmbedded(fan)) << closed;
  }
}

// What is not finite, or has no size, proves nothing.
TEST(FCL_KERNELS, fansOfAllSizes) {
  constexpr std::uint64_t kSeed = 80;
  Random random(kSeed);
  const double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity(), 1e300};
  for (int i = 0; i < 2000; ++i) {
    const std::size_t count = 3 + random.index(14);
    RandomFan fan(random, count, random.index(2), 1, 0.05);
    const int exponent = static_cast<int>(random.index(2098)) - 1074;
    for (TreeVertex& x : fan.vertices)
      for (int k = 0; k < 3; ++k) {
        x.t0[k] = std::ldexp(x.t0[k], exponent);
        x.t1[k] = std::ldexp(x.t1[k], exponent);
      }
    const bool proved = isEmbedded(fan);
    if (count < 7 && proved) {
      EXPECT_FALSE(fan.doTouch()) << "seed " << kSeed << ", " << i;
    }
    TreeVertex& x = fan.vertices[random.index(count + 1)];
    (random.index(2) ? x.t0 : x.t1)[random.index(3)] = kBad[random.index(2)];
    EXPECT_FALSE(isEmbedded(fan)) << "seed " << kSeed << ", " << i;
  }
}

/// facedDirections() by plain numbers.
std::uint32_t facedDirectionsOf(const std::vector<TreeVertex>& vertices,
                                const std::vector<TreeTriangle>& triangles) {
  using Vector = std::array<double, 3>;
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                  a[0] * b[1] - a[1] * b[0]};
  };
  std::uint32_t faced = (1U << (2 * kNumAxes)) - 1;
  for (const TreeTriangle& t : triangles) {
    Vector v[2], w[2];
    double v_norm = 0, w_norm = 0;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t frame = 0; frame < 2; ++frame) {
        const auto at = [&](std::size_t i) {
          const TreeVertex& x = vertices[t.place[i]];
          return frame == 0 ? x.t0[k] : x.t1[k];
        };
        v[frame][k] = at(1) - at(0);
        w[frame][k] = at(2) - at(0);
        v_norm = std::max(v_norm, std::abs(v[frame][k]));
        w_norm = std::max(w_norm, std::abs(w[frame][k]));
      }
    const Vector first = cross(v[0], w[0]), last = cross(v[1], w[1]),
                 b = cross(v[0], w[1]), c = cross(v[1], w[0]),
                 middle = {b[0] + c[0], b[1] + c[1], b[2] + c[2]};
    const double size = v_norm * w_norm, bound = 192 * 0x1p-53 * size;
    if (!(size >= 0x1p-900 && size <= 0x1p900)) return 0;
    for (std::size_t axis = 0; axis < kNumAxes; ++axis) {
      bool up = true, down = true;
      for (const Vector* n : {&first, &middle, &last}) {
        const double along = kAxes[axis][0] * (*n)[0] + kAxes[axis][1] * (*n)[1] +
                             kAxes[axis][2] * (*n)[2];
        up = up && along >= bound;
        down = down && along <= -bound;
      }
      if (!up) faced &= ~(1U << axis);
      if (!down) faced &= ~(1U << (axis + kNumAxes));
    }
  }
  return faced;
}

TEST(FCL_KERNELS, directionsThatTrianglesFace) {
  constexpr std::uint64_t kSeed = 85;
  Random random(kSeed);
  int met[2 * kNumAxes] = {}, none = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = 1 + random.index(8);
    const Vector3<double> normal = random.point(1).normalized();
    const double noise = random.uniform(0, 0.6);
    const int exponent =
        random.index(8) ? 0 : static_cast<int>(random.index(2000)) - 1000;
    std::vector<TreeVertex> vertices(3 * count);
    std::vector<TreeTriangle> triangles(count);
    const auto side = normal.cross(random.point(1)).normalized();
    const Vector3<double> corners[3] = {{0, 0, 0}, side, normal.cross(side)};
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      Vector3<double> p = corners[k % 3] + random.point(noise),
                      q = corners[k % 3] + random.point(noise);
      for (int c = 0; c < 3; ++c) {
        // Triangles on a grid face some directions from the side.
        if (i % 8 == 0) p[c] = std::round(p[c]), q[c] = std::round(q[c]);
        vertices[k].t0[c] = std::ldexp(p[c], exponent);
        vertices[k].t1[c] = std::ldexp(q[c], exponent);
      }
      triangles[k / 3].place[k % 3] = static_cast<std::uint32_t>(k);
    }
    if (random.index(20) == 0) triangles[0].place[1] = triangles[0].place[0];
    const std::uint32_t expected = facedDirectionsOf(vertices, triangles);
    for (std::size_t k = 0; k < 2 * kNumAxes; ++k) met[k] += expected >> k & 1U;
    none += expected == 0;
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->facedDirections(vertices.data(), triangles.data(), count), expected)
          << k->name;
    // What is not finite faces nothing.
    const double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
    TreeVertex& x = vertices[random.index(vertices.size())];
    (random.index(2) ? x.t0 : x.t1)[random.index(3)] = kBad[random.index(3)];
    if (&x == &vertices[1]) continue;  // perhaps of no triangle
    for (const Kernels* k : allSets())
      EXPECT_EQ(k->facedDirections(vertices.data(), triangles.data(), count), 0U)
          << k->name;
    ASSERT_FALSE(HasFailure());
  }
  for (const int n : met) EXPECT_GT(n, 500);
  EXPECT_GT(none, 1000);
}

struct SolveTally {
  int yes{0}, no{0}, open{0}, divided{0};
};

/// solve(), the same on every instruction set.
EightAnswers solveAll(const EightPairs& eight, double toc_err) {
  const EightAnswers first = allSets().front()->solve(eight, toc_err);
  EXPECT_EQ(first.yes & first.no, 0U);
  EXPECT_EQ((first.yes | first.no) & ~0xffU, 0U);
  for (const Kernels* k : allSets()) {
    const EightAnswers answers = k->solve(eight, toc_err);
    EXPECT_EQ(answers.yes, first.yes) << k->name;
    EXPECT_EQ(answers.no, first.no) << k->name;
    expectSameBits(first.yes, answers.toc_lo, first.toc_lo);
    expectSameBits(first.yes, answers.toc_hi, first.toc_hi);
  }
  return first;
}

/// divide(), the same on every instruction set.
EightDivisions divideAll(const EightPairs& eight) {
  const EightDivisions first = allSets().front()->divide(eight);
  EXPECT_EQ((first.never_inside | first.divisible) & ~0xffU, 0U);
  for (const Kernels* k : allSets()) {
    const EightDivisions found = k->divide(eight);
    EXPECT_EQ(found.never_inside, first.never_inside) << k->name;
    EXPECT_EQ(found.divisible, first.divisible) << k->name;
    expectSameBits(0xffU, found.at, first.at);
  }
  return first;
}

/// What the kernel proves of a pair is so, by the exact test.
void expectRightAnswer(const FilterQuery& q, const ElementaryResult& exact, bool yes,
                       bool no, double lo, double hi, double toc_err) {
  // The first contact of the window is the first of all, or one that came later.
  const bool in_window =
      exact.answer == Answer::kYes && exact.toc_lo >= q.lo && exact.toc_hi <= q.hi;
  bool right = true;
  if (no) right = !in_window;
  if (yes) {
    right = exact.answer == Answer::kYes && lo >= q.lo && hi <= q.hi && lo <= hi &&
            hi - lo <= toc_err && exact.toc_lo <= hi;
    if (in_window) right &= lo <= exact.toc_hi;
  }
  ASSERT_TRUE(right) << (yes ? "yes " : "no ") << q.pair << std::hexfloat << " in ["
                     << q.lo << ", " << q.hi << "], [" << lo << ", " << hi
                     << "], exactly [" << exact.toc_lo << ", " << exact.toc_hi << "]";
}

/// Eight pairs in their windows, and those that are left in both parts of them.
void expectRightAnswers(const FilterQuery (&queries)[8], double toc_err,
                        SolveTally& tally) {
  const EightPoints points(queries);
  const EightAnswers whole = solveAll(points.pairs(queries), toc_err);
  const EightDivisions divided = divideAll(points.pairs(queries));
  FilterQuery early[8], late[8];
  for (int lane = 0; lane < 8; ++lane) {
    early[lane] = late[lane] = queries[lane];
    early[lane].hi = late[lane].lo = divided.at[lane];
    ASSERT_GE(divided.at[lane], queries[lane].lo);
    ASSERT_LE(divided.at[lane], queries[lane].hi);
  }
  const EightAnswers first = solveAll(points.pairs(early), toc_err),
                     second = solveAll(points.pairs(late), toc_err);
  for (int lane = 0; lane < 8; ++lane) {
    const FilterQuery& q = queries[lane];
    const ElementaryResult exact = decideExactly(q.pair.kind, q.pair.points(), 1e-13);
    const auto expectRight = [&](const FilterQuery& part, const EightAnswers& answers) {
      const bool yes = answers.yes >> lane & 1U, no = answers.no >> lane & 1U;
      expectRightAnswer(part, exact, yes, no, answers.toc_lo[lane], answers.toc_hi[lane],
                        toc_err);
    };
    expectRight(q, whole);
    expectRight(early[lane], first);
    expectRight(late[lane], second);
    const bool never_inside = divided.never_inside >> lane & 1U;
    expectRightAnswer(q, exact, false, never_inside, 0, 0, toc_err);
    const bool yes = whole.yes >> lane & 1U, no = whole.no >> lane & 1U;
    ++(yes ? tally.yes : no ? tally.no : tally.open);
    const unsigned in_parts = first.yes | (first.no & (second.yes | second.no));
    const unsigned decided = divided.never_inside | (divided.divisible & in_parts);
    tally.divided += !yes && !no && (decided >> lane & 1U);
  }
}

TEST(FCL_KERNELS, solvedPairsAreSo) {
  constexpr std::uint64_t kSeed = 81;
  Random random(kSeed);
  SolveTally tally;
  for (int i = 0; i < 12000; ++i) {
    const ContinuousContactKind kind = oneOfTwo(random);
    FilterQuery queries[8];
    for (FilterQuery& q : queries) {
      q.pair = randomPair(random, kind);
      if (random.index(8) == 0)
        scale(q.pair, std::ldexp(1, static_cast<int>(random.index(700)) - 350));
      randomWindow(random, q.lo, q.hi);
    }
    const double kErrors[] = {1, 1e-2, 1e-4, 1e-8, 1e-12, 1e-16};
    expectRightAnswers(queries, kErrors[random.index(6)], tally);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(tally.yes, 300);
  EXPECT_GT(tally.no, 10000);
  EXPECT_GT(tally.open, 300);
  EXPECT_GT(tally.divided, 300);
}

/// Volume of the four points at t, by the vectors that the kernels take.
long double volumeAt(const MovingPair& pair, double t) {
  long double p[4][3];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      p[i][k] = (1 - static_cast<long double>(t)) * pair.x[i].t0[k] +
                static_cast<long double>(t) * pair.x[i].t1[k];
  const bool vf = pair.kind == ContinuousContactKind::kVertexFace;
  const int from[3] = {vf ? 0 : 2, vf ? 2 : 1, 3},
            to[3] = {vf ? 1 : 0, vf ? 1 : 0, vf ? 1 : 2};
  long double e[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) e[i][k] = p[from[i]][k] - p[to[i]][k];
  long double volume = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    volume += e[0][k] * (e[1][l] * e[2][m] - e[1][m] * e[2][l]);
  }
  return volume;
}

/// Pairs of one kind, in most or all of the step.
void randomLongWindows(Random& random, FilterQuery (&queries)[8]) {
  const ContinuousContactKind kind = oneOfTwo(random);
  for (FilterQuery& q : queries) {
    q.pair = randomPair(random, kind);
    q.lo = random.index(2) ? 0 : random.uniform(0, 0.4);
    q.hi = random.index(2) ? 1 : random.uniform(0.6, 1);
  }
}

// Where a volume goes through zero once, beyond doubt, the root is found and the pair
// decided; but for few whose features meet at their borders.
TEST(FCL_KERNELS, pairsWithOneRootAreDecided) {
  constexpr std::uint64_t kSeed = 84;
  Random random(kSeed);
  int decided = 0, open = 0;
  for (int i = 0; i < 20000; ++i) {
    FilterQuery queries[8];
    randomLongWindows(random, queries);
    const double kErrors[] = {1e-2, 1e-4, 1e-8};
    const EightAnswers found =
        solveAll(EightPoints(queries).pairs(queries), kErrors[random.index(3)]);
    for (int lane = 0; lane < 8; ++lane) {
      const FilterQuery& q = queries[lane];
      constexpr int kParts = 64;
      long double volumes[kParts + 1], size = 0;
      int changes = 0;
      for (int k = 0; k <= kParts; ++k) {
        volumes[k] = volumeAt(q.pair, q.lo + (q.hi - q.lo) * k / kParts);
        size = std::max(size, std::abs(volumes[k]));
        changes += k > 0 && volumes[k] * volumes[k - 1] <= 0;
      }
      const long double clear = 1e-3L * size;
      if (changes != 1 || std::abs(volumes[0]) < clear ||
          std::abs(volumes[kParts]) < clear)
        continue;
      ++((found.yes | found.no) >> lane & 1U ? decided : open);
    }
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(decided, 10000);
  EXPECT_LT(open, decided / 50);
}

// Where a volume goes through zero and back, the window is divided at the farthest point
// beyond, so that each part has one root; and not where it begins or ends at zero.
TEST(FCL_KERNELS, dividedBetweenTwoRoots) {
  constexpr std::uint64_t kSeed = 83;
  Random random(kSeed);
  int returning = 0, touching = 0;
  for (int i = 0; i < 20000; ++i) {
    FilterQuery queries[8];
    randomLongWindows(random, queries);
    const EightPoints points(queries);
    const EightDivisions divided = divideAll(points.pairs(queries));
    for (int lane = 0; lane < 8; ++lane) {
      const FilterQuery& q = queries[lane];
      const long double first = volumeAt(q.pair, q.lo), last = volumeAt(q.pair, q.hi);
      if (first == 0 || last == 0) {
        ++touching;
        EXPECT_FALSE(divided.divisible >> lane & 1U) << q.pair;
        continue;
      }
      // Clear of zero on both sides.
      long double farthest = 0, size = 0;
      for (int k = 0; k <= 64; ++k) {
        const long double volume = volumeAt(q.pair, q.lo + (q.hi - q.lo) * k / 64);
        farthest = std::max(farthest, first > 0 ? -volume : volume);
        size = std::max(size, std::abs(volume));
      }
      const long double clear = 1e-6L * size;
      if (first * last < 0 || size < 1e-3L || farthest < clear ||
          std::abs(first) < clear || std::abs(last) < clear)
        continue;
      ++returning;
      const long double there = volumeAt(q.pair, divided.at[lane]);
      EXPECT_TRUE(divided.divisible >> lane & 1U) << q.pair;
      EXPECT_GE(first > 0 ? -there : there, farthest - 1e-12L * size) << q.pair;
    }
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(returning, 1000);
  EXPECT_GT(touching, 100);
}

// Touches at the end of a window, at rest, all the time, of flat pairs and of points.
TEST(FCL_KERNELS, solvedDegeneratePairsAreSo) {
  constexpr std::uint64_t kSeed = 82;
  Random random(kSeed);
  SolveTally tally;
  for (int i = 0; i < 3000; ++i) {
    const ContinuousContactKind kind = oneOfTwo(random);
    FilterQuery queries[8];
    for (FilterQuery& q : queries) {
      q.pair.kind = kind;
      for (VertexPath& x : q.pair.x)
        for (int k = 0; k < 3; ++k) {
          x.t0[k] = static_cast<double>(random.index(5)) - 2;
          x.t1[k] = random.index(3) ? x.t0[k] : static_cast<double>(random.index(5)) - 2;
        }
      q.lo = 0.125 * static_cast<double>(random.index(9));
      q.hi = std::min(1., q.lo + 0.125 * static_cast<double>(random.index(9)));
      if (random.index(2)) {
        q.lo = 0;
        q.hi = 1;
      }
    }
    expectRightAnswers(queries, random.index(2) ? 1e-4 : 1e-9, tally);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", " << i;
  }
  EXPECT_GT(tally.yes, 50);
  EXPECT_GT(tally.no, 500);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The tree of moving boxes and their windows, against sums and pairs by brute force.
#include "broadphase/moving_box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "broadphase/broad_phase.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

using namespace fcl::detail::deformable;
using Pairs = std::set<std::pair<int, int>>;

/// Boxes at equally spaced times, of random size, on a random way.
std::vector<HalfAxisBox> randomBoxes(Random& random, int num_spans, double way) {
  const Vector3<double> half(random.uniform(.01, .4), random.uniform(.01, .4), .2);
  const Vector3<double> from = random.point(1), to = from + random.point(way);
  std::vector<HalfAxisBox> boxes;
  for (int i = 0; i <= num_spans; ++i) {
    const double t = double(i) / num_spans;
    const Vector3<double> at = from + t * (to - from) + random.point(.1);
    HalfAxisBox box;
    for (int k = 0; k < 3; ++k) {
      box.half[k] = half[k] - at[k];
      box.half[k + 3] = half[k] + at[k];
    }
    boxes.push_back(box);
  }
  return boxes;
}

MovingBounds boundsOf(const std::vector<HalfAxisBox>& boxes) {
  return {boxes.data(), static_cast<int>(boxes.size()) - 1};
}

double sideAt(const std::vector<HalfAxisBox>& boxes, int side, double t) {
  const double place = t * double(boxes.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), boxes.size() - 2);
  const double part = place - double(i);
  return (1 - part) * boxes[i].half[side] + part * boxes[i + 1].half[side];
}

/// The least overlap along the six sides at t; >= 0: the boxes overlap.
double depthAt(const std::vector<HalfAxisBox>& a, const std::vector<HalfAxisBox>& b,
               double t) {
  double least = HUGE_VAL;
  for (int j = 0; j < HalfAxisBox::kSides; ++j)
    least = std::min(least, sideAt(a, j, t) + sideAt(b, HalfAxisBox::opposite(j), t));
  return least;
}

TEST(MovingBounds, WindowsAreThoseOfDenseSamples) {
  Random random(1);
  int meeting = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto a = randomBoxes(random, 1 << random.index(5), 2),
               b = randomBoxes(random, 1 << random.index(5), 2);
    const MeetingWindow window = meetingWindow(boundsOf(a), boundsOf(b), 0);
    constexpr int kSamples = 256;
    double first = 2, last = -1;
    for (int k = 0; k <= kSamples; ++k) {
      const double t = double(k) / kSamples;
      if (depthAt(a, b, t) < 0) continue;
      first = std::min(first, t);
      last = t;
    }
    if (last >= 0) {
      ++meeting;
      EXPECT_LE(window.lo, first);
      EXPECT_GE(window.hi, last);
    }
    // Where the window ends inside of the step the boxes just touch.
    if (window.isEmpty()) continue;
    if (window.lo > 0) {
      EXPECT_NEAR(depthAt(a, b, window.lo), 0, 1e-9);
    }
    if (window.hi < 1) {
      EXPECT_NEAR(depthAt(a, b, window.hi), 0, 1e-9);
    }
  }
  EXPECT_GT(meeting, 200);
}

TEST(MovingBounds, FormationFlightDoesNotMeet) {
  // Both go ten times their distance; their sweeps overlap.
  const HalfAxisBox a0{{.1, .1, .1, .1, .1, .1}}, a1{{-9.9, .1, .1, 10.1, .1, .1}},
      b0{{-.2, .1, .1, .4, .1, .1}}, b1{{-10.2, .1, .1, 10.4, .1, .1}};
  const std::vector<HalfAxisBox> a{a0, a1}, b{b0, b1};
  EXPECT_TRUE(meetingWindow(boundsOf(a), boundsOf(b), 0).isEmpty());
  EXPECT_FALSE(mayMeet(linearBox(boundsOf(a)), linearBox(boundsOf(b)), {0, 1}));
  EXPECT_FALSE(meetingWindow(boundsOf(a), boundsOf(b), .11).isEmpty());
  EXPECT_TRUE(mayMeet(linearBox(boundsOf(a)), linearBox(boundsOf(b)), {.11, 1}));
}

TEST(MovingBounds, LinearBoxesContainTheirBounds) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const auto a = randomBoxes(random, 1 << random.index(5), 2);
    const LinearBox box = linearBox(boundsOf(a));
    for (int k = 0; k <= 64; ++k)
      for (int j = 0; j < HalfAxisBox::kSides; ++j) {
        const double t = k / 64.;
        const float* side = box.axis[j % 3] + (j < 3 ? 0 : 2);
        EXPECT_GE((1 - t) * double{side[0]} + t * double{side[1]}, sideAt(a, j, t));
      }
  }
}

TEST(MovingBounds, SidesWithoutBoundsMeetWhatTheBoundedSidesAllow) {
  const double inf = std::numeric_limits<double>::infinity();
  // z <= 0, at rest, and a box that comes down from z = 1.
  const std::vector<HalfAxisBox> ground(2, HalfAxisBox{{inf, inf, inf, inf, inf, 0}});
  const HalfAxisBox above{{.1, .1, -.9, .1, .1, 1.1}}, below{{.1, .1, 1.1, .1, .1, -.9}};
  const std::vector<HalfAxisBox> falls{above, below}, hovers{above, above};
  EXPECT_NEAR(meetingWindow(boundsOf(ground), boundsOf(falls), 0).lo, .45, 1e-12);
  EXPECT_TRUE(meetingWindow(boundsOf(ground), boundsOf(hovers), 0).isEmpty());
  const LinearBox box = linearBox(boundsOf(ground));
  EXPECT_TRUE(mayMeet(box, linearBox(boundsOf(falls)), {0, 1}));
  EXPECT_FALSE(mayMeet(box, linearBox(boundsOf(falls)), {0, .4}));
  EXPECT_FALSE(mayMeet(box, linearBox(boundsOf(hovers)), {0, 1}));
}

/// The tree's pairs against all pairs.
void expectAllPairs(const MovingBoxTree& tree, const std::vector<LinearBox>& boxes,
                    const std::vector<bool>& is_in, const LinearQuery& query) {
  Pairs expected, found;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = i + 1; k < boxes.size(); ++k)
      if (is_in[i] && is_in[k] && mayMeet(boxes[i], boxes[k], query))
        expected.emplace(i, k);
  tree.visitPairs(query, [&](int a, int b) {
    EXPECT_TRUE(found.emplace(std::min(a, b), std::max(a, b)).second);
  });
  EXPECT_EQ(found, expected);
}

TEST(MovingBoxTree, InsertAndRemoveKeepPairsAndBalance) {
  Random random(3);
  std::vector<LinearBox> boxes;
  for (int i = 0; i < 300; ++i)
    boxes.push_back(linearBox(boundsOf(randomBoxes(random, 1, .5))));
  std::vector<bool> is_in(boxes.size(), false);
  MovingBoxTree tree;
  std::size_t count = 0;
  for (int step = 0; step < 3000; ++step) {
    const std::size_t i = random.index(boxes.size());
    if (is_in[i])
      tree.remove(static_cast<int>(i));
    else
      tree.insert({&boxes[i], static_cast<int>(i)});
    is_in[i] = !is_in[i];
    count = is_in[i] ? count + 1 : count - 1;
    ASSERT_EQ(tree.size(), count);
    // The least number of leaves of an AVL tree grows by the golden ratio a level.
    ASSERT_LE(tree.height(), 1.4405 * std::log2(double(count) + 2) + 1);
    if (step % 250 == 0) expectAllPairs(tree, boxes, is_in, {0, 1});
  }
  expectAllPairs(tree, boxes, is_in, {.05, 1});
  expectAllPairs(tree, boxes, is_in, {0, .3});
}

TEST(MovingBoxTree, SortedInsertionStaysBalanced) {
  MovingBoxTree tree;
  for (int i = 0; i < 4096; ++i) {
    const HalfAxisBox at{{.1 - i, .1, .1, .1 + i, .1, .1}};
    const std::vector<HalfAxisBox> boxes{at, at};
    const LinearBox box = linearBox(boundsOf(boxes));
    tree.insert({&box, i});
  }
  EXPECT_LE(tree.height(), 18);
  for (int i = 0; i < 4095; ++i) tree.remove(i);
  EXPECT_EQ(tree.height(), 0);
  tree.remove(4095);
  EXPECT_EQ(tree.size(), 0u);
}

TEST(MovingBoxTree, BuiltTreesAndPairsOfTwoTrees) {
  Random random(4);
  MovingBoxTree tree[2];
  std::vector<LinearBox> boxes[2];
  for (int s = 0; s < 2; ++s) {
    std::vector<MovingBoxTree::Leaf> leaves;
    for (int i = 0; i < 200; ++i)
      boxes[s].push_back(linearBox(boundsOf(randomBoxes(random, 1, .5))));
    for (int i = 0; i < 200; ++i) leaves.push_back({&boxes[s][std::size_t(i)], i});
    tree[s].build(leaves);
    EXPECT_EQ(tree[s].height(), 8);
    expectAllPairs(tree[s], boxes[s], std::vector<bool>(200, true), {0, 1});
  }
  Pairs expected, found;
  std::set<int> near_first, expected_first;
  for (int i = 0; i < 200; ++i)
    for (int k = 0; k < 200; ++k)
      if (mayMeet(boxes[0][std::size_t(i)], boxes[1][std::size_t(k)], {0, 1})) {
        expected.emplace(i, k);
        if (i == 0) expected_first.insert(k);
      }
  tree[0].visitPairs(tree[1], {0, 1},
                     [&](int a, int b) { EXPECT_TRUE(found.emplace(a, b).second); });
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 50u);
  tree[1].visitMeeting(boxes[0][0], {0, 1}, [&](int b) { near_first.insert(b); });
  EXPECT_EQ(near_first, expected_first);
}

/// The pairs of a broad phase in their order, with the beginnings of their windows.
using OrderedPairs = std::vector<std::tuple<double, int, int>>;

TEST(BroadPhase, PairsAreSortedByTheirWindowsAndThenByInsertion) {
  Random random(5);
  std::vector<std::vector<HalfAxisBox>> boxes;
  for (int i = 0; i < 150; ++i) boxes.push_back(randomBoxes(random, 1, 1));
  // Twenty that touch the first one at the end of the step, at the same time.
  for (int i = 0; i < 20; ++i) {
    HalfAxisBox far = boxes[0][1], near = boxes[0][1];
    far.half[0] -= 9, far.half[3] += 9;
    near.half[3] = -boxes[0][1].half[0] + (near.half[0] + near.half[3]);
    near.half[0] = -boxes[0][1].half[3];
    boxes.push_back({far, near});
  }
  std::vector<char> objects(boxes.size());
  std::vector<void*> addresses;
  BoundsList bounds;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    addresses.push_back(&objects[i]);
    bounds.items.push_back({bounds.boxes.size(), 1});
    bounds.boxes.insert(bounds.boxes.end(), boxes[i].begin(), boxes[i].end());
  }
  BroadPhase broad_phase;
  broad_phase.insert(addresses.data(), bounds);
  OrderedPairs expected, found;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = i + 1; k < boxes.size(); ++k) {
      const MeetingWindow window =
          meetingWindow(boundsOf(boxes[i]), boundsOf(boxes[k]), 0);
      if (!window.isEmpty()) expected.emplace_back(window.lo, i, k);
    }
  std::sort(expected.begin(), expected.end());
  const auto numberOf = [&](const void* object) {
    return static_cast<int>(static_cast<const char*>(object) - objects.data());
  };
  for (const MeetingObjects& pair : broad_phase.pairs(MeetingQuery()))
    found.emplace_back(pair.window.lo, numberOf(pair.o1), numberOf(pair.o2));
  EXPECT_EQ(found, expected);
  const auto meets_at_0 = [](const auto& pair) { return std::get<0>(pair) == 0; };
  const auto num_at_0 = std::count_if(expected.begin(), expected.end(), meets_at_0);
  EXPECT_GT(num_at_0, 100);
  EXPECT_GT(static_cast<std::ptrdiff_t>(expected.size()) - num_at_0, 100);
}

}  // namespace
}  // namespace test
}  // namespace fcl

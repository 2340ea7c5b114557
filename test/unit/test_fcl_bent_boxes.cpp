// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of points on bent paths contain the paths, and are little larger.
#include "tree/bent_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mesh_generators.h"
#include "real.h"
#include "tree/box_position.h"

namespace fcl {
namespace test {
namespace {

using namespace fcl::detail::deformable;

/// A point at t = 0 and t = 1, and where it is in between.
struct BentPath {
  double place[2][3];

  void at(double t, const Bend& bend, Real (&out)[3]) const {
    const Real s = t;
    for (int i = 0; i < 3; ++i) {
      Real by = bend.offset[i];
      for (int k = 0; k < 3; ++k)
        by += Real{bend.matrix[3 * i + k]} * (Real{place[0][k]} + place[1][k]) / 2;
      out[i] = (1 - s) * place[0][i] + s * place[1][i] + 4 * s * (1 - s) * by;
    }
  }
};

/// A bend that is small relative to points within `size`; each third one is 0 along z.
Bend randomBend(Random& random, int i, double size) {
  Bend bend{};
  const double share = std::pow(10, random.uniform(-6, 0));
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c <= r; ++c)
      bend.matrix[3 * r + c] = bend.matrix[3 * c + r] = share * random.uniform(-1, 1);
    bend.offset[r] = size * share * random.uniform(-1, 1);
  }
  if (i % 3 == 0)
    for (int k = 0; k < 3; ++k)
      bend.matrix[6 + k] = bend.matrix[3 * k + 2] = bend.offset[2] = 0;
  return bend;
}

/// By how much a path leaves a box that moves linearly, along the direction in which it
/// leaves it most. Negative: it stays inside.
Real mostOutside(const MovingKdop& box, const double (&origin)[2][3],
                 const BentPath& path, const Bend& bend) {
  constexpr int kTimes = 16;
  Real most = -std::numeric_limits<Real>::infinity();
  for (int i = 0; i <= kTimes; ++i) {
    const double t = double(i) / kTimes;
    Real x[3], d[8];
    path.at(t, bend, x);
    for (int k = 0; k < 3; ++k)
      x[k] -= (1 - Real{t}) * origin[0][k] + Real{t} * origin[1][k];
    kdopCoordinates(x, d);
    for (int j = 0; j < 16; ++j) {
      const Real half = (1 - Real{t}) * box.t0.half[j] + Real{t} * box.t1.half[j];
      most = std::max(most, (j < 8 ? -d[j] : d[j - 8]) - half);
    }
  }
  return most;
}

/// The box of points at t = 0 or t = 1, which it barely contains.
Kdop16 boxOf(const std::vector<BentPath>& paths, int frame, const double (&origin)[3]) {
  Kdop16 box;
  std::fill(box.half, box.half + 16, kLeastHalf);
  for (const BentPath& path : paths) {
    Kdop16 of;
    fitPoint(path.place[frame], origin, 0, of);
    for (int j = 0; j < 16; ++j) box.half[j] = std::max(box.half[j], of.half[j]);
  }
  return box;
}

struct Scene {
  double size;
  Bend bend;
  double origin[2][3], translation[2][3];
  std::vector<BentPath> lanes[MovingKdopNode::kWidth];

  /// The points of a lane are near each other; some are one point.
  Scene(Random& random, int i) : size(std::pow(10, random.uniform(-3, 3))) {
    bend = randomBend(random, i, size);
    const double far = i % 2 ? 100 : 0;
    for (int frame = 0; frame < 2; ++frame)
      for (int k = 0; k < 3; ++k) {
        origin[frame][k] = size * random.uniform(-1, 1);
        translation[frame][k] = far * size * random.uniform(-1, 1);
      }
    for (auto& lane : lanes) {
      const double width = size * std::pow(10, random.uniform(-5, 0));
      const Vector3<double> center[2] = {size * random.point(1), size * random.point(1)};
      for (int n = 0; n < 6; ++n) {
        BentPath path;
        for (int frame = 0; frame < 2; ++frame)
          for (int k = 0; k < 3; ++k)
            path.place[frame][k] = center[frame][k] + width * random.uniform(-1, 1);
        lane.push_back(path);
      }
    }
  }

  /// The paths of a lane in the world.
  std::vector<BentPath> inWorld(int lane) const {
    std::vector<BentPath> paths = lanes[lane];
    for (BentPath& path : paths)
      for (int frame = 0; frame < 2; ++frame)
        for (int k = 0; k < 3; ++k) path.place[frame][k] += translation[frame][k];
    return paths;
  }
};

TEST(FCL_BENT_BOXES, nodesContainTheBentPaths) {
  constexpr int kScenes = 2000;
  Random random(31);
  int tight = 0;
  for (int i = 0; i < kScenes; ++i) {
    const Scene scene(random, i);
    MovingKdopNode node{};
    for (int lane = 0; lane < MovingKdopNode::kWidth; ++lane)
      node.setBox(lane, {boxOf(scene.lanes[lane], 0, scene.origin[0]),
                         boxOf(scene.lanes[lane], 1, scene.origin[1])});
    const MovingKdopNode before = node;
    BentBoxes(scene.bend, scene.origin, scene.translation).enlarge(node);
    double at[2][3], bound = 0;
    for (int k = 0; k < 3; ++k)
      for (int frame = 0; frame < 2; ++frame)
        at[frame][k] = scene.origin[frame][k] + scene.translation[frame][k];
    for (int k = 0; k < 3; ++k) bound += std::abs(at[0][k]) + std::abs(at[1][k]);
    const double rounding = 0x1p-50 * (bound + scene.size);
    for (int lane = 0; lane < MovingKdopNode::kWidth; ++lane) {
      Real most = -std::numeric_limits<Real>::infinity();
      for (const BentPath& path : scene.inWorld(lane))
        most = std::max(most, mostOutside(node.box(lane), at, path, scene.bend));
      ASSERT_LE(most, rounding) << "scene " << i << ", lane " << lane;
      // To one side of a direction a box grows by rounding only, where the bend of all
      // points is large to the other side.
      const MovingKdop box = node.box(lane), old = before.box(lane);
      for (int j = 0; j < 8; ++j) {
        const float down = box.t0.half[j] - old.t0.half[j],
                    up = box.t0.half[j + 8] - old.t0.half[j + 8];
        tight += std::min(down, up) < 1e-3F * std::max(down, up);
      }
    }
  }
  EXPECT_GT(tight, kScenes * 8 * 8 / 3);
}

TEST(FCL_BENT_BOXES, verticesContainTheirBentPaths) {
  Random random(32);
  for (int i = 0; i < 2000; ++i) {
    const Scene scene(random, i);
    const BentPath path = scene.lanes[0].front();
    TreeVertex vertex;
    vertex.setPath(path.place[0], path.place[1]);
    fitPoint(path.place[0], scene.origin[0], 0, vertex.box.t0);
    fitPoint(path.place[1], scene.origin[1], 0, vertex.box.t1);
    enlarge(scene.bend, vertex);
    EXPECT_LE(mostOutside(vertex.box, scene.origin, path, scene.bend),
              0x1p-50 * scene.size)
        << i;
    // The box of a point is as large as its bend.
    Real middle[3], straight[3];
    path.at(0.5, scene.bend, middle);
    path.at(0.5, Bend{}, straight);
    Real bend = 0;
    for (int k = 0; k < 3; ++k) bend += abs(middle[k] - straight[k]);
    for (int j = 0; j < 8; ++j)
      EXPECT_LE(Real{vertex.box.t0.half[j]} + vertex.box.t0.half[j + 8],
                bend + 1e-5 * scene.size)
          << i;
  }
}

TEST(FCL_BENT_BOXES, whatHasNoBoundKeepsNone) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  Random random(33);
  const double zero[2][3] = {};
  for (int row = 0; row < 16; ++row) {
    MovingKdopNode node{};
    for (auto* rows : {node.t0, node.t1})
      for (int r = 0; r < 16; ++r)
        std::fill(rows[r], rows[r] + MovingKdopNode::kWidth, 1);
    (row % 2 ? node.t0 : node.t1)[row][3] = kInf;
    BentBoxes(randomBend(random, row, 1), zero, zero).enlarge(node);
    for (int r = 0; r < 16; ++r)
      for (const float half : {node.t0[r][3], node.t1[r][3]}) {
        EXPECT_GE(half, 1) << row << ", " << r;
        EXPECT_TRUE(row >= 6 || half == kInf) << row << ", " << r;
      }
    EXPECT_EQ((row % 2 ? node.t0 : node.t1)[row][3], kInf) << row;
    EXPECT_LT(node.t0[row][2], 100) << row;
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh that tears. A sheet is cut along its middle: the vertices there get a copy, and
// the triangles to the right of the cut use the copies. updateTopology() takes the new
// triangles and keeps what is left of the tree. Then the right half moves through the
// left one.
#include <cstdio>
#include <vector>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/narrowphase/continuous_collision.h>

namespace {

using Frame = std::vector<fcl::Vector3d>;
constexpr std::size_t kSquares = 16, kVertices = kSquares + 1, kCut = kSquares / 2;

std::vector<fcl::Triangle> sheetTriangles() {
  std::vector<fcl::Triangle> triangles;
  for (std::size_t y = 0; y < kSquares; ++y)
    for (std::size_t x = 0; x < kSquares; ++x) {
      const std::size_t v = y * kVertices + x;
      triangles.emplace_back(v, v + 1, v + kVertices + 1);
      triangles.emplace_back(v, v + kVertices + 1, v + kVertices);
    }
  return triangles;
}

std::size_t countContacts(const fcl::DeformableBVHModel<>& model) {
  fcl::ContinuousContactResultd result;
  fcl::continuousSelfCollide(&model, fcl::ContinuousContactRequestd(), result);
  return result.contacts.size();
}

}  // namespace

int main() {
  Frame now;
  for (std::size_t y = 0; y < kVertices; ++y)
    for (std::size_t x = 0; x < kVertices; ++x)
      now.emplace_back(double(x), double(y), .01 * double(x * x + y));
  std::vector<fcl::Triangle> triangles = sheetTriangles();
  fcl::DeformableBVHModel<> sheet;
  sheet.beginModel();
  sheet.addSubModel(now, triangles);
  sheet.endModel(fcl::FclTree::kSkip);
  const std::size_t before = countContacts(sheet);

  // The tear: vertex `first_copy + y` is the copy of the cut's vertex in row y.
  const std::size_t first_copy = now.size();
  for (std::size_t y = 0; y < kVertices; ++y) {
    now.push_back(now[y * kVertices + kCut]);
    now.back().x() += .05;  // the two sides of a tear must not touch
  }
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (i / 2 % kSquares >= kCut)
      for (int k = 0; k < 3; ++k)
        if (triangles[i][k] % kVertices == kCut)
          triangles[i][k] = first_copy + triangles[i][k] / kVertices;
  Frame next = now;  // the right half goes left and down
  for (std::size_t v = 0; v < next.size(); ++v)
    if (v >= first_copy || v % kVertices > kCut) next[v] += fcl::Vector3d(-4, .1, -.6);
  // No origins are given: triangle i was triangle i.
  if (sheet.updateTopology(triangles, {}, now[0].data(), next[0].data(), now.size()) !=
      fcl::BVH_OK) {
    std::printf("%s\n", sheet.lastError().c_str());
    return 1;
  }
  const std::size_t after = countContacts(sheet);

  fcl::DeformableBVHModel<> fresh;  // the same mesh, built anew
  fresh.beginModel();
  fresh.addSubModel(now, triangles);
  fresh.endModel(fcl::FclTree::kSkip);
  fresh.updateFrames(now[0].data(), next[0].data(), now.size());
  std::printf("%zu contacts before the tear, %zu after\n", before, after);
  return before == 0 && after > 0 && after == countContacts(fresh) ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
//
// A solver of your own over the library's candidates. continuousSelfCandidates() hands
// out each vertex-face and edge-edge pair that culling leaves, once, with the window of
// time in which its boxes overlap. Here the pairs are solved in the order of their
// windows, until no window begins before the first contact found.
#include <algorithm>
#include <cstdio>
#include <vector>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/narrowphase/continuous_candidates.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_features.h>

namespace {

using Frame = std::vector<fcl::Vector3d>;

/// Put your own solver here: the time of contact of one pair, 2 without contact.
double solve(const fcl::ContinuousCandidate& pair, const Frame& t0, const Frame& t1) {
  const auto p = [&](const Frame& frame, std::size_t k) -> const fcl::Vector3d& {
    return frame[std::size_t(pair.vertices[k])];
  };
  const bool is_vf = pair.kind == fcl::ContinuousContactKind::kVertexFace;
  const auto test = is_vf ? &fcl::vertexFace<double> : &fcl::edgeEdge<double>;
  const auto found = test(p(t0, 0), p(t0, 1), p(t0, 2), p(t0, 3), p(t1, 0), p(t1, 1),
                          p(t1, 2), p(t1, 3), 1e-6);
  return found.is_contact ? found.toc_lo : 2;
}

}  // namespace

int main() {
  // Layers of small triangles that swap their heights: each meets its neighbours.
  Frame t0, t1;
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i < 200; ++i) {
    const double z = .1 * double(i), rise = i % 2 == 0 ? .15 : -.05,
                 x = .01 * double(i % 7);
    for (const fcl::Vector3d& corner :
         {fcl::Vector3d(x, 0, z), fcl::Vector3d(1 + x, .1, z),
          fcl::Vector3d(x, 1, z + .02)}) {
      t0.push_back(corner);
      t1.push_back(corner + fcl::Vector3d(0, 0, rise));
    }
    triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  fcl::DeformableBVHModel<> layers;
  layers.beginModel();
  layers.addSubModel(t0, triangles);
  layers.endModel(fcl::FclTree::kSkip);
  layers.updateFrames(t0[0].data(), t1[0].data(), t0.size());

  std::vector<fcl::ContinuousCandidate> pairs;
  fcl::continuousSelfCandidates(
      &layers, [&](const fcl::ContinuousCandidate* block, std::size_t count) {
        pairs.insert(pairs.end(), block, block + count);  // valid during this call only
        return true;                                      // false would end the query
      });
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.window_lo < b.window_lo; });
  double first = 2;
  std::size_t solved = 0;
  while (solved < pairs.size() && pairs[solved].window_lo <= first)
    first = std::min(first, solve(pairs[solved++], t0, t1));
  std::printf("%zu candidates, %zu solved, first contact at %.6f\n", pairs.size(), solved,
              first);

  // The library's own query gives the same time.
  fcl::ContinuousCollisionRequestd request;
  request.toc_err = 1e-6;
  fcl::ContinuousCollisionResultd result;
  const double toc = fcl::continuousSelfCollide(&layers, request, result);
  return result.is_collide && std::abs(toc - first) <= 1e-6 ? 0 : 1;
}

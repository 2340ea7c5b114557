// SPDX-License-Identifier: BSD-3-Clause
#include "query/self_proofs.h"

#include <cassert>
#include <cstddef>
#include <utility>

#include "query/distance_contact.h"
#include "self_culling/embedded_bodies.h"
#include "self_culling/embedded_fans.h"
#include "self_culling/embedded_regions.h"
#include "self_culling/regions_apart.h"

namespace fcl {
namespace detail {
namespace deformable {

namespace {

/// What does not touch: embedded regions, and fans outside of them. A region is left out
/// as a whole.
SelfProofs proveEmbedded(const MovingKdopTree& tree, bool with_regions, int num_threads) {
  SelfProofs proofs;
  std::vector<std::uint8_t> in_region(tree.vertices().size(), 0);
  if (with_regions) {
    EmbeddedRegions regions = findEmbeddedBodies(tree, kernels(), num_threads);
    addEmbeddedRegions(tree, kernels(), num_threads, regions);
    proofs.regions = std::move(regions.nodes);
    in_region = std::move(regions.interior);
  }
  proofs.fans = findEmbeddedFans(tree, in_region, kernels(), num_threads);
  proofs.nodes_in_fans = findNodesInFans(tree, proofs.fans);
  assert(proofs.fans.size() == tree.vertices().size());
  assert(proofs.nodes_in_fans.empty() || proofs.nodes_in_fans.size() == tree.numNodes());
  return proofs;
}

/// What does not come near. An embedded region does not touch itself, but it may come
/// near: only its features that stay apart are left out.
SelfProofs proveApart(const MovingKdopTree& tree, bool with_regions, double cull_distance,
                      int num_threads) {
  SelfProofs proofs;
  RegionsApart apart{{}, std::vector<std::uint8_t>(tree.vertices().size(), 0)};
  if (with_regions) {
    EmbeddedRegions regions =
        findEmbeddedBodies(tree, kernels(), num_threads, cull_distance);
    addEmbeddedRegions(tree, kernels(), num_threads, regions);
    apart = findRegionsApart(tree, regions, kernels(), cull_distance);
    proofs.nodes_in_fans = std::move(apart.nodes);
  }
  proofs.fans = findEmbeddedFans(tree, apart.fans, kernels(), num_threads, cull_distance);
  assert(proofs.fans.size() == apart.fans.size());
  for (std::size_t i = 0; i < proofs.fans.size(); ++i) proofs.fans[i] |= apart.fans[i];
  return proofs;
}

}  // namespace

SelfProofs proveSelf(const MeshInstance& mesh, bool with_regions, double min_distance,
                     int num_threads) {
  if (!mesh.tree || !mesh.isInPlace()) return {};
  if (min_distance > 0)
    return proveApart(*mesh.tree, with_regions, cullDistanceOf(mesh, mesh, min_distance),
                      num_threads);
  return proveEmbedded(*mesh.tree, with_regions, num_threads);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

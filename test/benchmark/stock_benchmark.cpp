// SPDX-License-Identifier: BSD-3-Clause
#include "stock_benchmark.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "components.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "scene_data.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using BV = KDOP<double, 16>;

/// The bodies with an even (odd) number; vertices of the others stay, unused.
FramePairMesh halfOf(const FramePairMesh& mesh, const std::vector<std::size_t>& component,
                     std::size_t parity) {
  FramePairMesh half{mesh.previous, mesh.current, {}};
  for (const Triangle& t : mesh.triangles)
    if (component[t[0]] % 2 == parity) half.triangles.push_back(t);
  return half;
}

template <typename Model>
void fill(const FramePairMesh& mesh, Model& model) {
  model.beginModel();
  model.addSubModel(mesh.previous, mesh.triangles);
  model.endModel();
  model.beginUpdateModel();
  model.updateSubModel(mesh.current);
  model.endUpdateModel();
}

}  // namespace

void benchmarkAgainstStock(const SceneFiles& files, int repeats) {
  const FramePairMesh mesh =
      readFramePair(files.folder + files.previous, files.folder + files.current);
  const auto component = componentsOf(mesh.triangles, mesh.previous.size());
  const FramePairMesh halves[2] = {halfOf(mesh, component, 0),
                                   halfOf(mesh, component, 1)};
  DeformableBVHModel<BV> ours[2];
  BVHModel<BV> stock[2];
  for (int i = 0; i < 2; ++i) {
    fill(halves[i], ours[i]);
    fill(halves[i], stock[i]);
  }
  const Transform3<double> identity = Transform3<double>::Identity();

  ContinuousContactRequest<double> request;
  request.query = ContinuousQuery::kFirst;
  request.enable_contact = false;
  ContinuousContactResult<double> result;
  const double our_ms = leastMilliseconds(repeats, [&] {
    continuousCollide(&ours[0], identity, identity, &ours[1], identity, identity, request,
                      result);
  });
  request.query = ContinuousQuery::kAll;
  ContinuousContactResult<double> all;
  const double all_ms = leastMilliseconds(repeats, [&] {
    continuousCollide(&ours[0], identity, identity, &ours[1], identity, identity, request,
                      all);
  });

  double stock_first = 1, stock_earliest = 1;
  std::size_t stock_pairs = 0;
  const auto runStock = [&](std::size_t max_contacts, double& toc) {
    return leastMilliseconds(repeats, [&] {
      detail::MeshContinuousCollisionTraversalNode<BV> node;
      detail::initialize<BV>(node, stock[0], identity, stock[1], identity,
                             CollisionRequest<double>(max_contacts));
      detail::collide(&node);
      toc = node.time_of_contact;
      stock_pairs = node.pairs.size();
    });
  };
  const double stock_first_ms = runStock(1, stock_first);
  const double stock_all_ms = runStock(mesh.triangles.size() * 100, stock_earliest);

  std::printf("two halves of %s,query,time_of_contact,ms,contacts\n", files.name.c_str());
  std::printf("ours,first,%.9g,%.2f,%zu VF or EE (crossing at t = 0: %s)\n",
              result.contacts.empty() ? 1. : result.contacts.front().toc_lo, our_ms,
              result.contacts.size(), result.initially_crossing ? "yes" : "no");
  std::printf("ours,all,%.9g,%.2f,%zu VF or EE\n",
              all.contacts.empty() ? 1. : all.contacts.front().toc_lo, all_ms,
              all.contacts.size());
  std::printf("stock FCL,default request,%.9g,%.2f,stops at the first pair it meets\n",
              stock_first, stock_first_ms);
  std::printf("stock FCL,all,%.9g,%.2f,%zu triangle pairs\n", stock_earliest,
              stock_all_ms, stock_pairs);
}

}  // namespace test
}  // namespace fcl

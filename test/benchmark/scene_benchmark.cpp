// SPDX-License-Identifier: BSD-3-Clause
#include "scene_benchmark.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "scene_data.h"
#include "swept_query.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<KDOP<double, 16>>;

struct Row {
  std::string scene;
  const char* query;
  const char* boxes;
  double build{0}, refit{0}, traverse{0}, test{0};
  StageCounts counts;
  std::size_t contacts{0};
  /// Of the true contacts; a first-contact query does not look for all of them.
  long missed{-1};
  std::size_t extra{0};

  double total() const { return refit + traverse + test; }
};

void print(const Row& r) {
  const auto count = [](std::uint64_t n) { return static_cast<unsigned long>(n); };
  std::printf(
      "%s,%s,%s,%.2f,%.2f,%.2f,%.2f,%.2f,%lu,%lu,%lu,%lu,%lu,%zu,", r.scene.c_str(),
      r.query, r.boxes, r.build, r.refit, r.traverse, r.test, r.total(),
      count(r.counts.node_pairs), count(r.counts.triangle_pairs),
      count(r.counts.feature_pairs),
      count(r.counts.feature_pairs - r.counts.box_culled - r.counts.filter_culled),
      count(r.counts.exact_tests), r.contacts);
  if (r.missed >= 0)
    std::printf("%ld,%zu\n", r.missed, r.extra);
  else
    std::printf("-,%zu\n", r.extra);
}

void buildModel(const FramePairMesh& mesh, FclTree fcl_tree, Model& model) {
  model.beginModel(static_cast<int>(mesh.triangles.size()),
                   static_cast<int>(mesh.previous.size()));
  model.addSubModel(mesh.previous, mesh.triangles);
  model.endModel(fcl_tree);
}

void updateModel(const FramePairMesh& mesh, Model& model) {
  model.updateFrames(mesh.previous.front().data(), mesh.current.front().data(),
                     mesh.previous.size(), FclTree::kSkip);
}

Row runMovingBoxes(const FramePairMesh& mesh, const std::set<PairName>& truth,
                   ContinuousQuery query, int repeats) {
  Row best;
  for (int i = 0; i < repeats; ++i) {
    Row row;
    Model model;
    row.build = millisecondsOf([&] { buildModel(mesh, FclTree::kSkip, model); });
    row.refit = leastMilliseconds(2, [&] { updateModel(mesh, model); });
    ContinuousContactRequest<double> request;
    request.query = query;
    request.enable_contact = false;
    ContinuousContactResult<double> result;
    continuousSelfCollide(&model, request, result);
    row.traverse = 1e3 * result.times.traverse;
    row.test = 1e3 * result.times.test;
    row.counts = result.counts;
    row.contacts = result.contacts.size();
    std::size_t found = 0;
    for (const auto& contact : result.contacts) found += truth.count(pairName(contact));
    row.extra = row.contacts - found;
    if (query == ContinuousQuery::kAll)
      row.missed = static_cast<long>(truth.size() - found);
    if (i == 0 || row.total() < best.total()) best = row;
  }
  best.query = query == ContinuousQuery::kAll ? "all" : "first";
  best.boxes = "moving";
  return best;
}

Row runSweptBoxes(const FramePairMesh& mesh, const std::set<PairName>& truth,
                  int repeats) {
  Model model;
  buildModel(mesh, FclTree::kSkip, model);
  const double refit = leastMilliseconds(repeats, [&] { updateModel(mesh, model); });
  Row best;
  for (int i = 0; i < repeats; ++i) {
    Row row;
    row.refit = refit;
    const SweptContacts contacts = sweptSelfContacts(model, false);
    row.traverse = contacts.ms_traverse;
    row.test = contacts.ms_test;
    row.counts = contacts.counts;
    row.contacts = contacts.pairs.size();
    std::size_t found = 0;
    for (const PairName& pair : contacts.pairs) found += truth.count(pair);
    row.extra = row.contacts - found;
    row.missed = static_cast<long>(truth.size() - found);
    if (i == 0 || row.total() < best.total()) best = row;
  }
  best.query = "all";
  best.boxes = "swept";
  return best;
}

}  // namespace

void printSceneHeader() {
  std::printf(
      "scene,query,boxes,ms_build,ms_refit,ms_traverse,ms_test,ms_total,node_pairs,"
      "triangle_pairs,feature_pairs,solved,exact,contacts,missed,extra\n");
}

void benchmarkScene(const SceneFiles& files, int repeats) {
  const FramePairMesh mesh =
      readFramePair(files.folder + files.previous, files.folder + files.current);
  const std::set<PairName> truth = readTruePairs(files.folder + "true_pairs.csv.gz");
  Row rows[3] = {runMovingBoxes(mesh, truth, ContinuousQuery::kAll, repeats),
                 runMovingBoxes(mesh, truth, ContinuousQuery::kFirst, repeats),
                 runSweptBoxes(mesh, truth, repeats)};
  for (Row& row : rows) {
    row.scene = files.name;
    print(row);
  }

  Model model;
  const double fcl_build =
      millisecondsOf([&] { buildModel(mesh, FclTree::kUpdate, model); });
  const double fcl_refit = millisecondsOf([&] {
    model.updateFrames(mesh.previous.front().data(), mesh.current.front().data(),
                       mesh.previous.size(), FclTree::kUpdate);
  });
  std::printf(
      "# %s: %zu triangles, %zu vertices; %.0f bytes a triangle over FCL's model; with "
      "FCL's own tree build %.1f ms, update %.1f ms\n",
      files.name.c_str(), mesh.triangles.size(), mesh.previous.size(),
      static_cast<double>(model.deformableMemUsage()) /
          static_cast<double>(mesh.triangles.size()),
      fcl_build, fcl_refit);
}

}  // namespace test
}  // namespace fcl

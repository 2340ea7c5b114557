// SPDX-License-Identifier: BSD-3-Clause
#include "scene_measure.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "fcl/common/exception.h"
#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {
namespace test {
namespace {

/// Number of names in `a` that are not in `b`; both are sorted.
std::size_t countMissing(const std::vector<PairName>& a, const std::vector<PairName>& b) {
  return static_cast<std::size_t>(std::count_if(a.begin(), a.end(), [&](const auto& p) {
    return !std::binary_search(b.begin(), b.end(), p);
  }));
}

}  // namespace

FrameFigures SceneMeasure::measure(const SceneFrame& frame) {
  if (frame.index == 0) {
    model_ = {};
    const bool built = model_.beginModel() == BVH_OK &&
                       model_.addSubModel(frame.previous, frame.triangles) == BVH_OK &&
                       model_.endModel(FclTree::kSkip) == BVH_OK;
    if (!built) throw Exception("SceneMeasure: " + model_.lastError());
  }
  const auto begin = std::chrono::steady_clock::now();
  const double *previous = frame.previous[0].data(), *current = frame.current[0].data();
  const int code = frame.change.isEmpty()
                       ? model_.updateFrames(previous, current, frame.previous.size())
                       : model_.updateTopology(frame.triangles, {}, previous, current,
                                               frame.previous.size());
  if (code != BVH_OK) throw Exception("SceneMeasure: " + model_.lastError());
  ContinuousContactRequest<double> request;
  request.num_threads = num_threads_;
  result_ = {};
  continuousSelfCollide(&model_, request, result_);
  FrameFigures figures;
  figures.query_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  figures.crossing = result_.initially_crossing;
  std::vector<PairName> pairs;
  pairs.reserve(result_.contacts.size());
  for (const auto& contact : result_.contacts) {
    pairs.push_back(pairName(contact));
    ++(contact.kind == ContinuousContactKind::kVertexFace ? figures.vertex_face
                                                          : figures.edge_edge);
  }
  std::sort(pairs.begin(), pairs.end());
  figures.started = countMissing(pairs, pairs_);
  figures.ended = countMissing(pairs_, pairs);
  pairs_ = std::move(pairs);
  return figures;
}

}  // namespace test
}  // namespace fcl

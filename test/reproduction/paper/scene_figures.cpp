// SPDX-License-Identifier: BSD-3-Clause
#include "scene_figures.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "timing.h"

namespace fcl {
namespace test {
namespace {

/// Frames until a method may renew its structure. Trees that are only refitted make the
/// earlier methods take up to twice the time on balls that mix; where layers lie on each
/// other one made for the frame can be the slower.
constexpr std::size_t kRenewal = 5;

template <typename Figure>
double mean(const std::vector<FrameRow>& frames, Figure&& figure) {
  const double sum = std::accumulate(frames.begin(), frames.end(), 0.,
                                     [&](double s, const FrameRow& row) {
                                       return s + static_cast<double>(figure(row));
                                     });
  return sum / static_cast<double>(frames.size());
}

}  // namespace

double MethodFigures::meanMs() const {
  return mean(frames, [](const FrameRow& row) { return row.ms; });
}

double MethodFigures::meanFeaturePairs() const {
  return mean(frames, [](const FrameRow& row) { return row.feature_pairs; });
}

double MethodFigures::meanElementaryTests() const {
  return mean(frames, [](const FrameRow& row) { return row.elementary_tests; });
}

Errors MethodFigures::errors() const {
  Errors sum{0, 0};
  for (const FrameRow& row : frames) {
    sum.missed += row.errors.missed;
    sum.extra += row.errors.extra;
  }
  return sum;
}

const MethodFigures& SceneFigures::method(const char* name, const char* filter,
                                          const char* kernels) const {
  for (const MethodFigures& m : methods)
    if (m.name == name && m.filter == filter && m.kernels == kernels) return m;
  throw std::logic_error(scene + ": " + name + ", " + filter + " is not measured");
}

MethodFigures measureMethod(const ListedMethod& listed, const FrameFolder& folder,
                            const Effort& effort, const Score& score) {
  MethodFigures figures{listed.name, listed.filter, listed.kernels, {}, 0, 0};
  const std::unique_ptr<SceneMethod> method = listed.make();
  TopologyWatch watch;
  for (std::size_t i = 0; i < folder.size(); ++i) {
    const FramePairMesh frame = folder.read(i);
    if (watch.isNew(frame)) {
      figures.take_ms += millisecondsOf([&] { method->takeTopology(frame); });
      ++figures.takes;
    } else if (i % kRenewal == 0) {
      method->renew(frame);
    }
    FrameAnswer fastest;
    repeat(effort, [&] {
      FrameAnswer answer = method->query(frame);
      if (answer.ms < fastest.ms) fastest = std::move(answer);
    });
    std::sort(fastest.contacts.begin(), fastest.contacts.end());
    figures.frames.push_back({folder.number(i), fastest.ms, fastest.feature_pairs,
                              fastest.elementary_tests, score(i, fastest)});
  }
  return figures;
}

}  // namespace test
}  // namespace fcl

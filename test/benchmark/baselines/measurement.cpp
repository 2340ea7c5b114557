// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/measurement.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "timing.h"

namespace fcl {
namespace test {

BaselineFigures measureBaseline(const FramePairMesh& mesh, const BaselineMethod& method,
                                const Effort& effort) {
  BaselineFigures figures;
  std::unique_ptr<Baseline> baseline;
  figures.ms_build = std::numeric_limits<double>::infinity();
  repeat(effort, [&] {
    baseline.reset();
    figures.ms_build = std::min(
        figures.ms_build, millisecondsOf([&] { baseline = makeBaseline(mesh, method); }));
  });
  double least = std::numeric_limits<double>::infinity();
  repeat(effort, [&] {
    BaselineStep step = baseline->step(mesh);
    if (step.total() >= least) return;
    least = step.total();
    figures.step = std::move(step);
  });
  std::sort(figures.step.contacts.begin(), figures.step.contacts.end());
  return figures;
}

}  // namespace test
}  // namespace fcl

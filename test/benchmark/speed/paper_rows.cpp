// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>

#include "machine.h"
#include "paper_method/self_query.h"
#include "rows.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

/// At which Interval-Newton leaves no contact of the public scenes out for its own sake,
/// nor invents one; doc/speed_error.md has what coarser and finer ones cost.
constexpr double kResolution = 1e-6;

template <typename Box, Filter kFilter>
void measure(const FramePairMesh& mesh, const Effort& effort, Row& row,
             std::vector<PairName>& found) {
  using Tree = FeatureTree<Box>;
  std::unique_ptr<Tree> tree;
  measureBuild(effort, row, [&] {
    tree.reset();
    return millisecondsOf([&] { tree = std::make_unique<Tree>(mesh); });
  });
  measureStep(effort, row, [&](StepTimes& times) {
    times.update = millisecondsOf([&] { tree->refit(mesh); });
    SelfContacts contacts =
        SelfQuery<kFilter, Box, IntervalNewton>(*tree, IntervalNewton{kResolution}).run();
    times.traverse = contacts.ms_traverse;
    times.test = contacts.ms_test;
    found = std::move(contacts.pairs);
  });
}

template <typename Box>
void measure(const std::string& filter, const FramePairMesh& mesh, const Effort& effort,
             Row& row, std::vector<PairName>& found) {
  if (filter == "none")
    measure<Box, Filter::kNone>(mesh, effort, row, found);
  else if (filter == "plain")
    measure<Box, Filter::kPlain>(mesh, effort, row, found);
  else if (filter == "certified")
    measure<Box, Filter::kCertified>(mesh, effort, row, found);
  else
    throw std::invalid_argument(filter + ": no filter");
}

}  // namespace

Row measurePaper(const Scene& scene, const std::string& boxes, const std::string& filter,
                 const Effort& effort, const std::vector<PairName>& truth) {
  Row row{scene.name, scene.a.triangles.size(), "all", boxes, filter, kPaperKernels, 1};
  std::vector<PairName> found;
  resetPeakMemory();
  if (boxes == "swept")
    measure<SweptBox>(filter, scene.a, effort, row, found);
  else if (boxes == "moving")
    measure<MovingKdop>(filter, scene.a, effort, row, found);
  else
    throw std::invalid_argument(boxes + ": no boxes");
  row.peak_mb = peakMegabytes();
  setContacts(found, truth, row);
  return row;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
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
  bool first = true;
  repeat(effort, [&] {
    tree.reset();
    const double ms = millisecondsOf([&] { tree = std::make_unique<Tree>(mesh); });
    if (first || ms < row.build) row.build = ms;
    first = false;
  });
  first = true;
  repeat(effort, [&] {
    StepTimes times;
    times.update = millisecondsOf([&] { tree->refit(mesh); });
    SelfContacts contacts =
        SelfQuery<kFilter, Box, IntervalNewton>(*tree, IntervalNewton{kResolution}).run();
    times.traverse = contacts.ms_traverse;
    times.test = contacts.ms_test;
    if (first || times.total() < row.times.total()) row.times = times;
    first = false;
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
  Row row{scene.name, scene.a.triangles.size(), "all", boxes, filter, "scalar", 1};
  std::vector<PairName> found;
  resetPeakMemory();
  if (boxes == "swept")
    measure<SweptBox>(filter, scene.a, effort, row, found);
  else if (boxes == "moving")
    measure<MovingKdop>(filter, scene.a, effort, row, found);
  else
    throw std::invalid_argument(boxes + ": no boxes");
  row.peak_mb = peakMegabytes();
  std::sort(found.begin(), found.end());
  row.contacts = found.size();
  const Errors errors = errorsOf(found, truth);
  row.missed = errors.missed;
  row.extra = errors.extra;
  row.hash = hashOf(found).value();
  return row;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "baselines/measurement.h"
#include "machine.h"
#include "rows.h"

namespace fcl {
namespace test {
namespace {

BaselineMethod methodOf(const std::string& boxes, const std::string& filter,
                        KernelSet kernels) {
  BaselineMethod method{Technique::kRepresentatives};
  method.kernels = kernels;
  if (boxes == "moving")
    method.boxes = Boxes::kMoving;
  else if (boxes != "swept")
    throw std::invalid_argument(boxes + ": no boxes");
  if (filter == "plain")
    method.filter = Filter::kPlain;
  else if (filter == "certified")
    method.filter = Filter::kCertified;
  else if (filter != "none")
    throw std::invalid_argument(filter + ": no filter");
  return method;
}

}  // namespace

Row measurePaper(const SpeedScene& scene, const std::string& boxes,
                 const std::string& filter, KernelSet kernels, const Effort& effort,
                 const std::vector<PairName>& truth) {
  const char* name = kernels == KernelSet::kScalar ? kPaperKernels : kPaperVectorKernels;
  Row row{scene.name, scene.a.triangles.size(), "all", boxes, filter, name, 1};
  const BaselineMethod method = methodOf(boxes, filter, kernels);
  resetPeakMemory();
  BaselineFigures figures = measureBaseline(scene.a, method, effort);
  row.build = figures.ms_build;
  row.times = {figures.step.ms_update, figures.step.ms_traverse, figures.step.ms_test};
  row.peak_mb = peakMegabytes();
  setContacts(figures.step.contacts, truth, row);
  return row;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/measurement.h"
#include "rows.h"

namespace fcl {
namespace test {

std::vector<BaselineRow> measureBaselines(const SpeedScene& scene, const Effort& effort,
                                          const std::vector<PairName>& truth) {
  const struct {
    const char* name;
    Technique technique;
  } techniques[] = {{"feature boxes", Technique::kFeatureBoxes},
                    {"r-triangles", Technique::kRepresentatives},
                    {"iccd", Technique::kConnectivity}};
  const struct {
    const char *filter_name, *kernels_name;
    Filter filter;
    KernelSet kernels;
  } variants[] = {{"none", "scalar", Filter::kNone, KernelSet::kScalar},
                  {"plain", "scalar", Filter::kPlain, KernelSet::kScalar},
                  {"none", "vector", Filter::kNone, KernelSet::kVector},
                  {"plain", "vector", Filter::kPlain, KernelSet::kVector},
                  {"certified", "vector", Filter::kCertified, KernelSet::kVector}};
  std::vector<BaselineRow> rows;
  for (const auto& technique : techniques)
    for (const auto& variant : variants) {
      const BaselineFigures figures = measureBaseline(
          scene.a, {technique.technique, variant.filter, variant.kernels}, effort);
      const BaselineStep& step = figures.step;
      BaselineRow row;
      row.scene = scene.name;
      row.triangles = scene.a.triangles.size();
      row.technique = technique.name;
      row.filter = variant.filter_name;
      row.kernels = variant.kernels_name;
      row.build = figures.ms_build;
      row.times = {step.ms_update, step.ms_traverse, step.ms_test};
      row.triangle_pairs = step.triangle_pairs;
      row.feature_pairs = step.feature_pairs;
      row.elementary_tests = step.elementary_tests;
      row.contacts = step.contacts.size();
      row.errors = errorsOf(step.contacts, truth);
      rows.push_back(row);
    }
  return rows;
}

}  // namespace test
}  // namespace fcl

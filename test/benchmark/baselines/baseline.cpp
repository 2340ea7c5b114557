// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/baseline.h"

#include "baselines/feature_tree.h"
#include "baselines/self_query.h"
#include "baselines/wide_tree.h"
#include "speed_error/interval_newton.h"

namespace fcl {
namespace test {
namespace {

template <typename Tree>
std::unique_ptr<Baseline> make(const FramePairMesh& mesh, const BaselineMethod& method,
                               TouchTest touches) {
  return std::make_unique<SelfQuery<Tree>>(mesh, method.technique, method.filter,
                                           touches);
}

}  // namespace

bool touchesByIntervalNewton(fcl::ContinuousContactKind,
                             const detail::deformable::FeaturePoints&,
                             const RelativePair<double>& pair,
                             const CoplanarityCubic<double>& cubic) {
  // At which next to no contact of the public scenes is left out for its own sake, or
  // invented; doc/speed_error.md has what coarser and finer ones cost.
  constexpr double kResolution = 1e-6;
  return firstTimeByIntervalNewton(pair, cubic, kResolution, kResolution) >= 0;
}

std::unique_ptr<Baseline> makeBaseline(const FramePairMesh& mesh,
                                       const BaselineMethod& method, TouchTest touches) {
  const bool is_swept = method.boxes == Boxes::kSwept;
  if (method.kernels == KernelSet::kVector)
    return is_swept ? make<WideTree<Boxes::kSwept>>(mesh, method, touches)
                    : make<WideTree<Boxes::kMoving>>(mesh, method, touches);
  return is_swept
             ? make<FeatureTree<SweptBox>>(mesh, method, touches)
             : make<FeatureTree<detail::deformable::MovingKdop>>(mesh, method, touches);
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "option_query.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/safe_displacements.h"
#include "timing.h"

namespace fcl {
namespace test {

OptionQuery::OptionQuery(const SpeedScene& scene)
    : scene_(scene.name),
      triangles_(scene.a.triangles.size() + scene.b.triangles.size()),
      a_(modelOf(scene.a)) {
  if (!scene.isSelf()) b_ = modelOf(scene.b);
}

OptionQuery::Result OptionQuery::operator()(const Request& request) const {
  Result result;
  const Transform3<double> origin = Transform3<double>::Identity();
  if (b_)
    continuousCollide(a_.get(), origin, origin, b_.get(), origin, origin, request,
                      result);
  else
    continuousSelfCollide(a_.get(), request, result);
  return result;
}

OptionRow OptionQuery::measure(const std::string& option, const Request& off,
                               const std::function<void()>& on,
                               const Effort& effort) const {
  OptionRow row;
  row.scene = scene_;
  row.triangles = triangles_;
  row.option = option;
  row.query = off.query == ContinuousQuery::kAll ? "all" : "first";
  row.off = row.on = std::numeric_limits<double>::infinity();
  repeat(effort, [&] {
    row.off = std::min(row.off, millisecondsOf([&] { (*this)(off); }));
    row.on = std::min(row.on, millisecondsOf(on));
  });
  return row;
}

OptionRow OptionQuery::measure(const std::string& option, const Request& off,
                               const Request& on, const Effort& effort) const {
  return measure(
      option, off, [&] { (*this)(on); }, effort);
}

OptionRow OptionQuery::measureSafeDisplacements(const std::string& option,
                                                const Request& off,
                                                double max_displacement,
                                                double min_distance,
                                                const Effort& effort) const {
  return measure(
      option, off, [&] { safeDisplacements(max_displacement, min_distance); }, effort);
}

std::vector<double> OptionQuery::safeDisplacements(double max_displacement,
                                                   double min_distance) const {
  return safeSelfDisplacements(a_.get(), max_displacement, min_distance);
}

OptionQuery::Request OptionQuery::request(ContinuousQuery query, double toc_err) {
  Request request;
  request.query = query;
  request.enable_contact = false;
  request.toc_err = toc_err;
  return request;
}

std::unique_ptr<OptionQuery::Model> OptionQuery::modelOf(const FramePairMesh& mesh) {
  auto model = std::make_unique<Model>();
  const auto expect = [&](int code) {
    if (code != BVH_OK) throw std::runtime_error(model->lastError());
  };
  expect(model->beginModel());
  expect(model->addSubModel(mesh.previous, mesh.triangles));
  expect(model->endModel(FclTree::kSkip));
  expect(model->updateFrames(mesh.previous[0].data(), mesh.current[0].data(),
                             mesh.previous.size(), FclTree::kSkip));
  return model;
}

}  // namespace test
}  // namespace fcl

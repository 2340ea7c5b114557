// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>

#include "fcl/narrowphase/continuous_collision.h"
#include "stage_list.h"

namespace fcl_ccd {
namespace {

using Contact = fcl::ContinuousContactd;
using Kind = fcl::ContinuousContactKind;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
};

void requireSuccess(int code, const std::string& error, const char* mesh) {
  if (code != fcl::BVH_OK)
    throw std::runtime_error(std::string("mesh ") + mesh + ": " + error);
}

template <typename Model>
std::unique_ptr<Model> buildModel(const std::vector<fcl::Vector3d>& points,
                                  const std::vector<fcl::Triangle>& triangles,
                                  const char* mesh, int num_threads) {
  auto model = std::make_unique<Model>();
  requireSuccess(model->setNumThreads(num_threads), model->lastError(), mesh);
  requireSuccess(model->beginModel(static_cast<int>(triangles.size()),
                                   static_cast<int>(points.size())),
                 model->lastError(), mesh);
  requireSuccess(model->addSubModel(points, triangles), model->lastError(), mesh);
  const int code = model->endModel(fcl::FclTree::kSkip);
  requireSuccess(code, model->lastError(), mesh);
  return model;
}

/// @brief Builds a model from FCL's own types, so that their conversion is not timed.
template <typename Model>
std::unique_ptr<Model> timeBuild(const Vertices& vertices, const Triangles& faces,
                                 const char* name, int num_threads, double& seconds) {
  std::vector<fcl::Vector3d> points;
  points.reserve(vertices.size());
  for (const auto& p : vertices) points.emplace_back(p[0], p[1], p[2]);
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(faces.size());
  for (const auto& t : faces)
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                           static_cast<std::size_t>(t[2]));
  const Stopwatch watch;
  auto model = buildModel<Model>(points, triangles, name, num_threads);
  seconds += watch.seconds();
  return model;
}

template <typename Model>
void updateModel(Model& model, const Vertices& from, const Vertices& to,
                 const char* name) {
  if (&from == &to && !model.isDeforming()) return;
  const int code = model.updateFrames(from.data()->data(), to.data()->data(), to.size(),
                                      fcl::FclTree::kSkip);
  requireSuccess(code, model.lastError(), name);
}

/// The number of vertices of the contact's first feature.
std::size_t firstFeatureSize(Kind kind) {
  return kind == Kind::kEdgeEdge || kind == Kind::kCrossing ? 2 : 1;
}

SceneContact toSceneContact(const Contact& contact, bool o1_is_b, bool o2_is_b) {
  SceneContact out;
  out.kind = contact.kind;
  out.num_vertices = contact.numVertices();
  out.toc_lo = contact.toc_lo;
  out.toc_hi = contact.toc_hi;
  const bool in_order = contact.kind == Kind::kEdgeEdge || contact.first_on_o1;
  out.triangles = {
      {in_order ? contact.b1 : contact.b2, in_order ? contact.b2 : contact.b1}};
  for (int k = 0; k < 3; ++k) {
    out.position[static_cast<std::size_t>(k)] = contact.pos[k];
    out.normal[static_cast<std::size_t>(k)] = contact.normal[k];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(out.num_vertices); ++i) {
    const bool of_first_feature = i < firstFeatureSize(contact.kind);
    const bool of_o1 = of_first_feature == contact.first_on_o1;
    out.vertices[i] = {contact.vertices[i], of_o1 ? o1_is_b : o2_is_b};
  }
  return out;
}

/// Sorts the contacts of two queries by time.
void sortContacts(std::vector<SceneContact>& contacts) {
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const auto& a, const auto& b) { return a.toc_lo < b.toc_lo; });
}

/// Keeps the contacts of two first-contact queries that may be the first one of both.
void keepFirst(std::vector<SceneContact>& contacts) {
  double first_hi = std::numeric_limits<double>::infinity();
  for (const SceneContact& c : contacts) first_hi = std::min(first_hi, c.toc_hi);
  const auto later = std::find_if(contacts.begin(), contacts.end(),
                                  [&](const auto& c) { return c.toc_lo > first_hi; });
  contacts.erase(later, contacts.end());
}

}  // namespace

const SceneContact* StepResult::first() const {
  if (crossing) return &*crossing;
  return contacts.empty() ? nullptr : &contacts.front();
}

Scene::Scene(const SceneTriangles& triangles, const SceneFrame& frame,
             const StepSettings& settings)
    : settings_(settings) {
  build_time_ = std::numeric_limits<double>::infinity();
  for (int i = 0; i < settings_.repeat; ++i) build(triangles, frame);
}

void Scene::build(const SceneTriangles& triangles, const SceneFrame& frame) {
  double seconds = 0;
  a_ = timeBuild<Model>(*frame.a, *triangles.a, "A", settings_.num_threads, seconds);
  if (frame.b != nullptr)
    b_ = timeBuild<Model>(*frame.b, *triangles.b, "B", settings_.num_threads, seconds);
  build_time_ = std::min(build_time_, seconds);
}

void Scene::query(const Model& o1, const Model& o2, StepResult& step) const {
  fcl::ContinuousContactRequestd request;
  request.query = settings_.query;
  request.toc_err = settings_.toc_err;
  request.enable_contact = settings_.points;
  request.num_threads = settings_.num_threads;
  request.min_distance = settings_.min_distance;
  request.ignore_initially_closer = settings_.ignore_initially_closer;
  fcl::ContinuousContactResultd result;
  const fcl::Transform3d identity = fcl::Transform3d::Identity();
  if (&o1 == &o2)
    fcl::continuousSelfCollide(&o1, request, result);
  else
    fcl::continuousCollide(&o1, identity, identity, &o2, identity, identity, request,
                           result);

  const bool o1_is_b = &o1 == b_.get(), o2_is_b = &o2 == b_.get();
  for (const Contact& contact : result.contacts)
    step.contacts.push_back(toSceneContact(contact, o1_is_b, o2_is_b));
  if (result.initially_crossing && !step.initially_crossing) {
    step.initially_crossing = true;
    step.crossing = toSceneContact(result.crossing, o1_is_b, o2_is_b);
  }
  for (const StageField& stage : kStages)
    step.counts.*stage.count += result.counts.*stage.count;
  step.times.update += result.times.update;
  step.times.traverse += result.times.traverse;
  step.times.test += result.times.test;
}

StepResult Scene::runOnce(const SceneFrame& from, const SceneFrame& to) {
  StepResult step;
  step.at_distance = settings_.min_distance > 0;
  const Stopwatch watch;
  updateModel(*a_, *from.a, *to.a, "A");
  if (b_ != nullptr) updateModel(*b_, *from.b, *to.b, "B");
  step.times.update = watch.seconds();

  if (settings_.self) query(*a_, *a_, step);
  const bool answered = settings_.query == fcl::ContinuousQuery::kAny &&
                        (!step.contacts.empty() || step.initially_crossing);
  if (b_ != nullptr && !answered) {
    query(*a_, *b_, step);
    sortContacts(step.contacts);
    if (settings_.query == fcl::ContinuousQuery::kFirst) keepFirst(step.contacts);
  }
  return step;
}

StepResult Scene::step(const SceneFrame& from, const SceneFrame& to) {
  StepResult best = runOnce(from, to);
  for (int i = 1; i < settings_.repeat; ++i) {
    const StepTimes times = runOnce(from, to).times;
    if (times.total() < best.times.total()) best.times = times;
  }
  return best;
}

}  // namespace fcl_ccd

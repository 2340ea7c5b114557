// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>
#include <utility>

#include "contact_text.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_model.h"
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

/// Sets the triangle of a feature from the number b of a contact or candidate.
template <typename Pair>
void setTriangle(std::intptr_t b, std::intptr_t num_triangles,
                 const std::vector<fcl::Primitive>& free, std::size_t feature,
                 Pair& out) {
  out.triangles[feature] = b;
  if (b < num_triangles) return;
  assert(static_cast<std::size_t>(b - num_triangles) < free.size());
  const fcl::Primitive& primitive = free[static_cast<std::size_t>(b - num_triangles)];
  out.triangles[feature] = static_cast<std::intptr_t>(primitive.index);
  out.triangle_kinds[feature] = primitive.kind;
}

/// Sets the triangles of both features of a contact or candidate of the library.
template <typename From, typename Body, typename To>
void setTriangles(const From& pair, const Body& o1, const Body& o2, To& out) {
  const bool in_order = pair.kind == Kind::kEdgeEdge || pair.first_on_o1;
  setTriangle(pair.b1, o1.model->num_tris, o1.free, in_order ? 0 : 1, out);
  setTriangle(pair.b2, o2.model->num_tris, o2.free, in_order ? 1 : 0, out);
}

/// Sets the vertices of a contact or candidate of the library.
template <typename From, typename To>
void setVertices(const From& pair, bool o1_is_b, bool o2_is_b, To& out) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(out.num_vertices); ++i) {
    assert(pair.vertices[i] >= 0);
    const bool of_first_feature = i < firstFeatureSize(pair.kind);
    const bool of_o1 = of_first_feature == pair.first_on_o1;
    out.vertices[i] = {pair.vertices[i], of_o1 ? o1_is_b : o2_is_b};
  }
}

SceneContact toSceneContact(const Contact& contact, bool o1_is_b, bool o2_is_b) {
  SceneContact out;
  out.kind = contact.kind;
  out.num_vertices = contact.numVertices();
  out.toc_lo = contact.toc_lo;
  out.toc_hi = contact.toc_hi;
  for (int k = 0; k < 3; ++k) {
    out.position[static_cast<std::size_t>(k)] = contact.pos[k];
    out.normal[static_cast<std::size_t>(k)] = contact.normal[k];
  }
  setVertices(contact, o1_is_b, o2_is_b, out);
  return out;
}

int numVertices(Kind kind) {
  return kind == Kind::kVertexVertex ? 2 : kind == Kind::kVertexEdge ? 3 : 4;
}

SceneCandidate toSceneCandidate(const fcl::ContinuousCandidate& candidate, bool o1_is_b,
                                bool o2_is_b) {
  SceneCandidate out;
  out.kind = candidate.kind;
  out.num_vertices = numVertices(candidate.kind);
  out.window_lo = candidate.window_lo;
  out.window_hi = candidate.window_hi;
  setVertices(candidate, o1_is_b, o2_is_b, out);
  return out;
}

bool isBefore(const SceneCandidate& a, const SceneCandidate& b) {
  if (a.kind != b.kind) return a.kind < b.kind;
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    const SceneVertex &v = a.vertices[i], &w = b.vertices[i];
    if (v.of_b != w.of_b) return w.of_b;
    if (v.id != w.id) return v.id < w.id;
  }
  return false;
}

/// Sorts the contacts of two queries by time, and crossings before all others.
void sortContacts(std::vector<SceneContact>& contacts) {
  const auto order = [](const SceneContact& contact) {
    return std::make_pair(contact.kind != Kind::kCrossing, contact.toc_lo);
  };
  std::stable_sort(contacts.begin(), contacts.end(),
                   [&](const auto& a, const auto& b) { return order(a) < order(b); });
}

/// Keeps the contacts of first-contact queries that may be the first one of all. Nothing
/// is before a crossing.
void keepFirst(std::vector<SceneContact>& contacts) {
  assert(
      std::is_sorted(contacts.begin(), contacts.end(),
                     [](const auto& a, const auto& b) { return a.toc_lo < b.toc_lo; }));
  double first_hi = std::numeric_limits<double>::infinity();
  for (const SceneContact& c : contacts) first_hi = std::min(first_hi, c.toc_hi);
  const auto later = std::find_if(contacts.begin(), contacts.end(),
                                  [&](const auto& c) { return c.toc_lo > first_hi; });
  contacts.erase(later, contacts.end());
}

}  // namespace

std::optional<bool> StepResult::initiallyCrossing() const {
  if (!contacts.empty() && contacts.front().kind == Kind::kCrossing) return true;
  return is_decided ? std::optional<bool>(false) : std::nullopt;
}

bool StepResult::isFirstDecided() const {
  return is_decided || (!contacts.empty() && contacts.front().toc_hi == 0);
}

Scene::Scene(const SceneTriangles& triangles, const SceneFrame& frame,
             const StepSettings& settings)
    : settings_(settings) {
  build_time_ = std::numeric_limits<double>::infinity();
  for (int i = 0; i < settings_.repeat; ++i) build(triangles, frame);
}

Scene::Body Scene::build(const Triangles& triangles, const FreeElements* free,
                         const Vertices& vertices, const char* name,
                         double& seconds) const {
  const MeshInput input = toInput(vertices, triangles, free);
  // The conversion is not timed.
  const Stopwatch watch;
  Body body = buildModel(input, name, settings_.num_threads);
  seconds += watch.seconds();
  return body;
}

void Scene::build(const SceneTriangles& triangles, const SceneFrame& frame) {
  double seconds = 0;
  a_ = build(*triangles.a, triangles.free_a, *frame.a, "mesh A", seconds);
  if (frame.b != nullptr)
    b_ = build(*triangles.b, triangles.free_b, *frame.b, "mesh B", seconds);
  build_time_ = std::min(build_time_, seconds);
}

void Scene::query(const Body& o1, const Body& o2, StepResult& step) const {
  fcl::ContinuousContactRequestd request;
  // Which contact a query for any finds depends on the tree, and the tree on the steps
  // before. The first contact does not. It also decides whether an edge and a face cross.
  const bool is_any = settings_.query == fcl::ContinuousQuery::kAny;
  request.query = is_any ? fcl::ContinuousQuery::kFirst : settings_.query;
  if (is_any) request.num_max_contacts = 1;
  request.enable_crossings = settings_.all_crossings;
  request.toc_err = settings_.toc_err;
  request.enable_contact = settings_.points;
  request.num_threads = settings_.num_threads;
  request.min_distance = settings_.min_distance;
  request.ignore_initially_closer = settings_.ignore_initially_closer;
  fcl::ContinuousContactResultd result;
  const fcl::Transform3d identity = fcl::Transform3d::Identity();
  const Model &model1 = *o1.model, &model2 = *o2.model;
  if (&o1 == &o2)
    fcl::continuousSelfCollide(&model1, request, result);
  else
    fcl::continuousCollide(&model1, identity, identity, &model2, identity, identity,
                           request, result);

  const auto convert = [&](const Contact& contact) {
    SceneContact out = toSceneContact(contact, &o1 == &b_, &o2 == &b_);
    setTriangles(contact, o1, o2, out);
    return out;
  };
  if (!settings_.all_crossings && result.initially_crossing)
    result.crossings = {result.crossing};
  // One is kept of them: the first by its ids.
  if (is_any && result.crossings.size() > 1) result.crossings.resize(1);
  step.contacts.reserve(step.contacts.size() + result.crossings.size() +
                        result.contacts.size());
  for (const auto* found : {&result.crossings, &result.contacts})
    for (const Contact& contact : *found) step.contacts.push_back(convert(contact));
  for (const StageField& stage : kStages)
    step.counts.*stage.count += result.counts.*stage.count;
  step.times.update += result.times.update;
  step.times.traverse += result.times.traverse;
  step.times.test += result.times.test;
}

void Scene::addCandidates(const Body& o1, const Body& o2,
                          std::vector<SceneCandidate>& candidates) const {
  const Model &model1 = *o1.model, &model2 = *o2.model;
  const auto take = [&](const fcl::ContinuousCandidate* block, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const fcl::ContinuousCandidate& from = block[i];
      SceneCandidate out = toSceneCandidate(from, &o1 == &b_, &o2 == &b_);
      setTriangles(from, o1, o2, out);
      candidates.push_back(out);
    }
    return true;
  };
  const fcl::Transform3d identity = fcl::Transform3d::Identity();
  if (&o1 == &o2)
    fcl::continuousSelfCandidates(&model1, take, settings_.min_distance);
  else
    fcl::continuousCandidates(&model1, identity, identity, &model2, identity, identity,
                              take, settings_.min_distance);
}

std::vector<SceneCandidate> Scene::candidates(const SceneFrame& from,
                                              const SceneFrame& to) {
  move(from, to);
  std::vector<SceneCandidate> candidates;
  if (settings_.self) addCandidates(a_, a_, candidates);
  if (b_.model) addCandidates(a_, b_, candidates);
  std::sort(candidates.begin(), candidates.end(), isBefore);
  return candidates;
}

void Scene::move(const SceneFrame& from, const SceneFrame& to) {
  updateModel(*a_.model, *from.a, *to.a, "mesh A");
  if (b_.model) updateModel(*b_.model, *from.b, *to.b, "mesh B");
}

StepResult Scene::runOnce(const SceneFrame& from, const SceneFrame& to) {
  StepResult step;
  step.at_distance = settings_.min_distance > 0;
  const Stopwatch watch;
  move(from, to);
  step.times.update = watch.seconds();

  step.is_any = settings_.query == fcl::ContinuousQuery::kAny;

  if (settings_.self) query(a_, a_, step);
  if (b_.model) {
    step.is_decided = !step.is_any || step.contacts.empty();
    if (step.is_decided) query(a_, b_, step);
    sortContacts(step.contacts);
  }
  if (settings_.query == fcl::ContinuousQuery::kFirst) keepFirst(step.contacts);
  if (step.is_any && step.contacts.size() > 1) step.contacts.resize(1);
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

StepResult Scene::stepInDetail(const SceneFrame& from, const SceneFrame& to) {
  const StepSettings settings = settings_;
  settings_.points = settings_.all_crossings = true;
  StepResult result = runOnce(from, to);
  settings_ = settings;
  return result;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "cloth_simulator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "fcl/common/exception.h"

namespace fcl {
namespace test {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Opposite corners of each pair of triangles that share an edge.
std::vector<std::array<int, 2>> hinges(const std::vector<Triangle>& triangles) {
  std::map<std::array<int, 2>, int> corner_at;
  std::vector<std::array<int, 2>> pairs;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = static_cast<int>(t[k]);
      const int b = static_cast<int>(t[(k + 1) % 3]);
      const int corner = static_cast<int>(t[(k + 2) % 3]);
      const auto inserted =
          corner_at.insert({{{std::min(a, b), std::max(a, b)}}, corner});
      if (!inserted.second) pairs.push_back({{inserted.first->second, corner}});
    }
  return pairs;
}

template <typename T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[random.index(i)]);
}

/// Mean length of the edges of movable triangles.
double meanEdge(const TestMesh& mesh, const std::vector<char>& is_movable) {
  double sum = 0;
  std::size_t edges = 0;
  for (const Triangle& t : mesh.triangles) {
    if (!is_movable[t[0]]) continue;
    for (int k = 0; k < 3; ++k)
      sum += (mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]).norm();
    edges += 3;
  }
  return edges > 0 ? sum / static_cast<double>(edges) : 0;
}

bool sameFeatures(const FrameContact& a, const FrameContact& b) {
  return a.kind == b.kind && a.where.vertices == b.where.vertices;
}

}  // namespace

int ClothSimulator::addBody(const TestMesh& mesh, Kind kind, ObstacleMotion motion) {
  if (started_) throw Exception("ClothSimulator: bodies come before the first frame");
  const int first = static_cast<int>(mesh_.vertices.size());
  const int count = static_cast<int>(mesh.vertices.size());
  append(mesh_, mesh);
  bodies_.push_back(
      {first, count, kind, mesh, std::move(motion), Transform3<double>::Identity()});
  body_of_.resize(mesh_.vertices.size(), static_cast<int>(bodies_.size()) - 1);
  is_movable_.resize(mesh_.vertices.size(), kind == Kind::kObstacle ? 0 : 1);
  inverse_masses_.resize(mesh_.vertices.size(), 0);
  pinned_to_.resize(mesh_.vertices.size(), -1);
  solid_of_.resize(mesh_.vertices.size(), -1);
  rest_.resize(mesh_.vertices.size(), Vector3<double>::Zero());
  return first;
}

int ClothSimulator::addObstacle(const TestMesh& mesh, ObstacleMotion motion) {
  const Transform3<double> pose = motion ? motion(0) : Transform3<double>::Identity();
  const int first = addBody(transformed(mesh, pose), Kind::kObstacle, std::move(motion));
  bodies_.back().shape = mesh;
  return first;
}

int ClothSimulator::addCloth(const TestMesh& rest,
                             const std::vector<Vector3<double>>& start) {
  const int first = addBody({start, rest.triangles}, Kind::kCloth, {});
  addSprings(rest, first);
  addMasses(rest, first);
  return first;
}

void ClothSimulator::addSprings(const TestMesh& rest, int first_vertex) {
  const auto add = [&](std::vector<Spring>& springs, const std::array<int, 2>& e,
                       double compliance) {
    const double length = (rest.vertices[e[0]] - rest.vertices[e[1]]).norm();
    springs.push_back(
        {{{e[0] + first_vertex, e[1] + first_vertex}}, length, compliance, 0});
  };
  for (const auto& e : uniqueEdges(rest.triangles)) add(edge_springs_, e, 0);
  for (const auto& e : hinges(rest.triangles))
    add(bend_springs_, e, options_.bend_compliance);
}

void ClothSimulator::addMasses(const TestMesh& rest, int first_vertex) {
  std::vector<double> mass(rest.vertices.size(), 0);
  for (const Triangle& t : rest.triangles) {
    const Vector3<double> a = rest.vertices[t[1]] - rest.vertices[t[0]];
    const Vector3<double> b = rest.vertices[t[2]] - rest.vertices[t[0]];
    for (int k = 0; k < 3; ++k)
      mass[t[k]] += options_.cloth_density * a.cross(b).norm() / 6;
  }
  for (std::size_t v = 0; v < mass.size(); ++v)
    inverse_masses_[first_vertex + v] = mass[v] > 0 ? 1 / mass[v] : 0;
}

void ClothSimulator::pin(int vertex, int obstacle) {
  pinned_to_[vertex] = obstacle;
  is_movable_[vertex] = 0;
  inverse_masses_[vertex] = 0;
}

void ClothSimulator::start() {
  started_ = true;
  Random random(options_.seed);
  shuffle(edge_springs_, random);
  shuffle(bend_springs_, random);
  mean_edge_ = 0;
  for (const Spring& s : edge_springs_)
    mean_edge_ += s.rest_length / static_cast<double>(edge_springs_.size());
  for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
    if (is_movable_[v] && solid_of_[v] < 0)
      mesh_.vertices[v] += random.point(1e-4 * mean_edge_);
  if (edge_springs_.empty()) mean_edge_ = meanEdge(mesh_, is_movable_);
  for (Shell& shell : shells_)
    for (FragileShell::Bond& bond : shell.surface.bonds())
      bond.strength = shell.options.strength * random.uniform(0.5, 1.5);
  velocities_.assign(mesh_.vertices.size(), Vector3<double>::Zero());
  held_with_.assign(mesh_.vertices.size(), -1);
  buildModel();
}

void ClothSimulator::buildModel() {
  moved_ = mesh_.vertices;
  model_ = {};
  model_.setNumThreads(options_.num_threads);
  const bool built = model_.beginModel() == BVH_OK &&
                     model_.addSubModel(mesh_.vertices, mesh_.triangles) == BVH_OK &&
                     model_.endModel(FclTree::kSkip) == BVH_OK;
  if (!built) throw Exception("ClothSimulator: " + model_.lastError());
}

FrameReport ClothSimulator::advanceFrame() {
  const auto begin = Clock::now();
  if (!started_) start();
  breakShells();
  frame_begin_ = mesh_.vertices;
  FrameReport report;
  if (options_.find_free_motion) findFreeMotion();
  step_time_ = options_.frame_time / options_.steps_per_frame;
  for (int i = 0; i < options_.steps_per_frame; ++i) advanceStep(i, report);
  finishContacts(report);
  report.total_seconds = secondsSince(begin);
  return report;
}

/// Does one step as long as the frame, without contacts, and restores the state.
void ClothSimulator::findFreeMotion() {
  const std::vector<Vector3<double>> velocities = velocities_;
  const std::vector<Solid> solids = solids_;
  step_time_ = options_.frame_time;
  contacts_.clear();
  predict();
  for (Spring& s : edge_springs_) s.multiplier = 0;
  for (Spring& s : bend_springs_) s.multiplier = 0;
  solve(options_.iterations);
  placeSolids();
  free_motion_ = moved_;
  velocities_ = velocities;
  solids_ = solids;
}

/// Keeps one entry for each feature pair, ordered by kind and vertices, and counts them.
void ClothSimulator::finishContacts(FrameReport& report) const {
  auto& contacts = report.contacts;
  std::stable_sort(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) {
    return std::tie(a.kind, a.where.vertices) < std::tie(b.kind, b.where.vertices);
  });
  contacts.erase(std::unique(contacts.begin(), contacts.end(), sameFeatures),
                 contacts.end());
  for (const FrameContact& c : contacts) {
    const auto& ids = c.where.vertices;
    ++(c.kind == ContinuousContactKind::kVertexFace ? report.vertex_face
                                                    : report.edge_edge);
    if (body_of_[ids[0]] == body_of_[ids[3]]) ++report.self;
  }
}

void ClothSimulator::advanceStep(int step_of_frame, FrameReport& report) {
  contacts_.clear();
  predict();
  pushApart();
  addConstraints(query(step_of_frame, report).contacts);
  for (Spring& s : edge_springs_) s.multiplier = 0;
  for (Spring& s : bend_springs_) s.multiplier = 0;
  solve(options_.iterations);
  placeSolids();
  respond(step_of_frame, report);
  loadBonds();
  finishStep();
}

/// Moves everything to where it would go if nothing were in the way.
void ClothSimulator::predict() {
  const double dt = stepTime();
  const double kept = std::exp(-options_.damping * dt);
  for (Body& body : bodies_) {
    const bool moves = body.kind == Kind::kObstacle && body.motion;
    const Transform3<double> pose =
        moves ? body.motion(obstacleTime() + dt) : Transform3<double>::Identity();
    if (moves) body.step_motion = pose * body.motion(obstacleTime()).inverse();
    if (body.kind == Kind::kSolid) continue;
    for (int i = 0; i < body.num_vertices; ++i) {
      const int v = body.first_vertex + i;
      if (moves) {
        moved_[v] = pose * body.shape.vertices[i];
      } else if (body.kind == Kind::kObstacle) {
        moved_[v] = mesh_.vertices[v];
      } else if (pinned_to_[v] < 0) {
        velocities_[v] = kept * velocities_[v] + dt * options_.gravity;
        moved_[v] = mesh_.vertices[v] + dt * velocities_[v];
      }
    }
  }
  for (std::size_t v = 0; v < moved_.size(); ++v)
    if (pinned_to_[v] >= 0)
      moved_[v] = bodies_[pinned_to_[v]].step_motion * mesh_.vertices[v];
  fastest_ = 0;
  for (std::size_t v = 0; v < moved_.size(); ++v)
    if (!is_movable_[v])
      fastest_ = std::max(fastest_, (moved_[v] - mesh_.vertices[v]).norm() / dt);
  for (const Solid& s : solids_) fastest_ = std::max(fastest_, s.body.speedBound());
  fastest_ += dt * options_.gravity.norm();
  const double deforming_kept = std::exp(-options_.solid_damping * dt);
  for (Solid& s : solids_) s.body.predict(dt, options_.gravity, kept, deforming_kept);
  placeSolids();
}

/// Moves the vertices of solids with their bodies.
void ClothSimulator::placeSolids() {
  for (const Solid& s : solids_)
    for (const int v : s.body.vertices)
      moved_[v] = s.body.end.centre + s.body.end.shape * rest_[v];
}

void ClothSimulator::solve(int iterations) {
  for (int i = 0; i < iterations; ++i) {
    for (Spring& s : edge_springs_) projectSpring(s);
    for (Spring& s : bend_springs_) projectSpring(s);
    projectContacts();
  }
}

void ClothSimulator::projectSpring(Spring& spring) {
  const int a = spring.vertices[0];
  const int b = spring.vertices[1];
  const double mobility = inverse_masses_[a] + inverse_masses_[b];
  const Vector3<double> edge = moved_[b] - moved_[a];
  const double length = edge.norm();
  if (mobility == 0 || length == 0) return;
  const double softness = spring.compliance / (stepTime() * stepTime());
  const double multiplier = (spring.rest_length - length - softness * spring.multiplier) /
                            (mobility + softness);
  spring.multiplier += multiplier;
  const Vector3<double> push = (multiplier / length) * edge;
  moved_[a] -= inverse_masses_[a] * push;
  moved_[b] += inverse_masses_[b] * push;
}

void ClothSimulator::finishStep() {
  for (std::size_t v = 0; v < moved_.size(); ++v)
    velocities_[v] = (moved_[v] - mesh_.vertices[v]) / stepTime();
  dampNeighbours();
  for (Solid& s : solids_) {
    s.body.finish(stepTime());
    s.body.limitSpeed(fastest_);
  }
  mesh_.vertices.swap(moved_);
  ++step_;
}

/// Friction inside the cloth: reduces the relative velocity of neighbours. Momentum is
/// kept.
void ClothSimulator::dampNeighbours() {
  const double lost = 1 - std::exp(-options_.internal_damping * stepTime());
  for (const Spring& s : edge_springs_) {
    const auto [a, b] = s.vertices;
    const double mobility = inverse_masses_[a] + inverse_masses_[b];
    if (mobility == 0) continue;
    const Vector3<double> impulse = (lost / mobility) * (velocities_[b] - velocities_[a]);
    velocities_[a] += inverse_masses_[a] * impulse;
    velocities_[b] -= inverse_masses_[b] * impulse;
  }
}

double ClothSimulator::maxStretch() const {
  double stretch = 0;
  for (const Spring& s : edge_springs_) {
    const double length =
        (mesh_.vertices[s.vertices[0]] - mesh_.vertices[s.vertices[1]]).norm();
    stretch = std::max(stretch, length / s.rest_length);
  }
  return stretch;
}

}  // namespace test
}  // namespace fcl

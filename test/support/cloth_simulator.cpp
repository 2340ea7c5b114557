// SPDX-License-Identifier: BSD-3-Clause
#include "cloth_simulator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "fcl/common/exception.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "proximity.h"

namespace fcl {
namespace test {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Rounds of holding; each holds at least one more vertex, so that the bound is met only
/// in a scene where an obstacle crushes the cloth.
const int kMaxHoldRounds = 100;

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

bool sameFeatures(const FrameContact& a, const FrameContact& b) {
  return a.kind == b.kind && a.where.vertices == b.where.vertices;
}

/// Weights of the points of lines a0 a1 and b0 b1 closest to each other, kept on the
/// segments.
std::array<double, 4> edgeWeights(const Vector3<double>& a0, const Vector3<double>& a1,
                                  const Vector3<double>& b0, const Vector3<double>& b1) {
  const Vector3<double> v = a1 - a0;
  const Vector3<double> w = b1 - b0;
  const Vector3<double> u = b0 - a0;
  const Vector3<double> n = v.cross(w);
  const double n2 = n.squaredNorm();
  const auto onSegment = [](double x) { return std::min(1.0, std::max(0.0, x)); };
  double s = 0.5;
  double t = 0.5;
  if (n2 > 0) {
    s = onSegment(u.cross(w).dot(n) / n2);
    t = onSegment(u.cross(v).dot(n) / n2);
  }
  return {{1 - s, s, t - 1, -t}};
}

Vector3<double> separation(const ContactWeights& where,
                           const std::vector<Vector3<double>>& positions) {
  Vector3<double> sum = Vector3<double>::Zero();
  for (int k = 0; k < 4; ++k) sum += where.weights[k] * positions[where.vertices[k]];
  return sum;
}

}  // namespace

int ClothSimulator::addBody(const TestMesh& mesh, bool is_obstacle,
                            ObstacleMotion motion) {
  if (started_) throw Exception("ClothSimulator: bodies come before the first frame");
  const int first = static_cast<int>(mesh_.vertices.size());
  const int count = static_cast<int>(mesh.vertices.size());
  append(mesh_, mesh);
  bodies_.push_back({first, count, is_obstacle, mesh, std::move(motion)});
  body_of_.resize(mesh_.vertices.size(), static_cast<int>(bodies_.size()) - 1);
  is_movable_.resize(mesh_.vertices.size(), is_obstacle ? 0 : 1);
  inverse_masses_.resize(mesh_.vertices.size(), 0);
  return first;
}

int ClothSimulator::addObstacle(const TestMesh& mesh, ObstacleMotion motion) {
  const Transform3<double> pose = motion ? motion(0) : Transform3<double>::Identity();
  const int first = addBody(transformed(mesh, pose), true, std::move(motion));
  bodies_.back().shape = mesh;
  return first;
}

int ClothSimulator::addCloth(const TestMesh& rest,
                             const std::vector<Vector3<double>>& start) {
  const int first = addBody({start, rest.triangles}, false, {});
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

void ClothSimulator::start() {
  started_ = true;
  Random random(options_.seed);
  shuffle(edge_springs_, random);
  shuffle(bend_springs_, random);
  mean_edge_ = 0;
  for (const Spring& s : edge_springs_)
    mean_edge_ += s.rest_length / static_cast<double>(edge_springs_.size());
  for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
    if (is_movable_[v]) mesh_.vertices[v] += random.point(1e-4 * mean_edge_);
  velocities_.assign(mesh_.vertices.size(), Vector3<double>::Zero());
  held_with_.assign(mesh_.vertices.size(), -1);
  moved_ = mesh_.vertices;
  const bool built = model_.beginModel() == BVH_OK &&
                     model_.addSubModel(mesh_.vertices, mesh_.triangles) == BVH_OK &&
                     model_.endModel(FclTree::kSkip) == BVH_OK;
  if (!built) throw Exception("ClothSimulator: " + model_.lastError());
}

FrameReport ClothSimulator::advanceFrame() {
  const auto begin = Clock::now();
  if (!started_) start();
  FrameReport report;
  for (int i = 0; i < options_.steps_per_frame; ++i) advanceStep(i, report);
  finishContacts(report);
  report.total_seconds = secondsSince(begin);
  return report;
}

/// Keeps one entry a pair of features, ordered by kind and vertices, and counts them.
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
  for (const auto& contact : query(step_of_frame, report).contacts)
    addConstraint(weightsAt(contact), -contact.normal);
  for (Spring& s : edge_springs_) s.multiplier = 0;
  for (Spring& s : bend_springs_) s.multiplier = 0;
  solve(options_.iterations);
  respond(step_of_frame, report);
  finishStep();
}

/// Where everything would go if nothing were in the way.
void ClothSimulator::predict() {
  const double dt = stepTime();
  const double kept = std::exp(-options_.damping * dt);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const bool moves = body.is_obstacle && body.motion;
    const Transform3<double> pose =
        moves ? body.motion(time() + dt) : Transform3<double>::Identity();
    for (int i = 0; i < body.num_vertices; ++i) {
      const int v = body.first_vertex + i;
      if (moves) {
        moved_[v] = pose * body.shape.vertices[i];
      } else if (body.is_obstacle) {
        moved_[v] = mesh_.vertices[v];
      } else {
        velocities_[v] = kept * velocities_[v] + dt * options_.gravity;
        moved_[v] = mesh_.vertices[v] + dt * velocities_[v];
      }
    }
  }
}

/// Surfaces that are close at the start of the step, hence on known sides of each other,
/// keep their distance during the step.
void ClothSimulator::pushApart() {
  for (const NearPair& pair :
       findNearPairs(mesh_.vertices, mesh_.triangles, is_movable_, options_.thickness,
                     std::max(mean_edge_, 2 * options_.thickness))) {
    const Triangle& t = mesh_.triangles[pair.triangle];
    ContactWeights where;
    where.vertices = {{pair.vertex, static_cast<int>(t[0]), static_cast<int>(t[1]),
                       static_cast<int>(t[2])}};
    where.weights = {{1, -pair.weights[0], -pair.weights[1], -pair.weights[2]}};
    addConstraint(where, separation(where, mesh_.vertices));
  }
}

/// One query over the motion from mesh_.vertices to moved_.
ContinuousContactResult<double> ClothSimulator::query(int step_of_frame,
                                                      FrameReport& report) {
  const auto begin = Clock::now();
  if (model_.updateFrames(mesh_.vertices[0].data(), moved_[0].data(), moved_.size()) !=
      BVH_OK)
    throw Exception("ClothSimulator: " + model_.lastError());
  ContinuousContactResult<double> result;
  continuousSelfCollide(&model_, ContinuousContactRequest<double>(), result);
  report.query_seconds += secondsSince(begin);
  ++report.queries;
  report.counts += result.counts;
  report.crossing = report.crossing || result.initially_crossing;
  for (const auto& c : result.contacts) {
    report.contacts.push_back(
        {c.kind, {{static_cast<int>(c.b1), static_cast<int>(c.b2)}}, weightsAt(c)});
    report.first_contact = std::min(
        report.first_contact, (step_of_frame + c.toc_lo) / options_.steps_per_frame);
  }
  return result;
}

ContactWeights ClothSimulator::weightsAt(const ContinuousContact<double>& contact) const {
  ContactWeights where;
  Vector3<double> p[4];
  for (int k = 0; k < 4; ++k) {
    const int v = contact.vertices[k];
    where.vertices[k] = v;
    p[k] = mesh_.vertices[v] + contact.toc_lo * (moved_[v] - mesh_.vertices[v]);
  }
  if (contact.kind == ContinuousContactKind::kVertexFace) {
    const Vector3<double> w = closestWeights(p[0], p[1], p[2], p[3]);
    where.weights = {{1, -w[0], -w[1], -w[2]}};
  } else {
    where.weights = edgeWeights(p[0], p[1], p[2], p[3]);
  }
  return where;
}

/// Keeps the first feature on the side `direction` (of any length) of the second.
void ClothSimulator::addConstraint(const ContactWeights& where,
                                   Vector3<double> direction) {
  const Vector3<double> now = separation(where, mesh_.vertices);
  if (direction.squaredNorm() == 0) direction = now;
  const double length = direction.norm();
  if (!(length > 0)) return;
  direction /= length;
  const double push = options_.push_speed * stepTime();
  const double gap =
      std::min(options_.thickness, std::max(0.0, direction.dot(now)) + push);
  contacts_.push_back({where, direction, gap});
}

void ClothSimulator::solve(int iterations) {
  for (int i = 0; i < iterations; ++i) {
    for (Spring& s : edge_springs_) projectSpring(s);
    for (Spring& s : bend_springs_) projectSpring(s);
    for (const ContactConstraint& c : contacts_) projectContact(c);
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

/// Inelastic: takes away what is missing to the gap, and of the sliding as much as
/// friction allows.
void ClothSimulator::projectContact(const ContactConstraint& contact) {
  const auto& ids = contact.where.vertices;
  const auto& weights = contact.where.weights;
  const double missing =
      contact.gap - contact.direction.dot(separation(contact.where, moved_));
  if (missing <= 0) return;
  double mobility = 0;
  for (int k = 0; k < 4; ++k)
    mobility += weights[k] * weights[k] * inverse_masses_[ids[k]];
  if (mobility == 0) return;
  Vector3<double> slide =
      separation(contact.where, moved_) - separation(contact.where, mesh_.vertices);
  slide -= contact.direction.dot(slide) * contact.direction;
  const double sliding = slide.norm();
  const double stopped = std::min(sliding, options_.friction * missing);
  Vector3<double> change = missing * contact.direction;
  if (sliding > 0) change -= (stopped / sliding) * slide;
  for (int k = 0; k < 4; ++k)
    moved_[ids[k]] += (weights[k] * inverse_masses_[ids[k]] / mobility) * change;
}

/// Queries and corrects until the motion of the step has no contact left.
void ClothSimulator::respond(int step_of_frame, FrameReport& report) {
  for (int round = 0; round < options_.response_rounds; ++round) {
    const auto result = query(step_of_frame, report);
    if (result.contacts.empty()) return;
    for (const auto& contact : result.contacts)
      addConstraint(weightsAt(contact), -contact.normal);
    solve(2);
    for (int i = 0; i < options_.iterations; ++i)
      for (const ContactConstraint& c : contacts_) projectContact(c);
  }
  holdInContact(step_of_frame, report);
}

/// Lets the cloth vertices that are still in contact move with the obstacle that they
/// touch, directly or through held vertices, or not at all.
void ClothSimulator::holdInContact(int step_of_frame, FrameReport& report) {
  std::fill(held_with_.begin(), held_with_.end(), -1);
  for (int round = 0; round < kMaxHoldRounds; ++round) {
    const auto result = query(step_of_frame, report);
    if (result.contacts.empty()) return;
    if (round + 1 == kMaxHoldRounds) report.unresolved += result.contacts.size();
    for (const auto& contact : result.contacts) {
      int carrier = body_of_[contact.vertices[0]];
      for (int k = 0; k < 4; ++k) {
        const int v = contact.vertices[k];
        const int with = is_movable_[v] ? held_with_[v] : body_of_[v];
        if (with >= 0 && bodies_[with].is_obstacle) carrier = with;
      }
      const Transform3<double> motion = bodyMotion(carrier);
      for (int k = 0; k < 4; ++k) {
        const int v = contact.vertices[k];
        if (!is_movable_[v]) continue;
        if (held_with_[v] < 0) ++report.held_vertices;
        held_with_[v] = carrier;
        moved_[v] = motion * mesh_.vertices[v];
      }
    }
  }
}

/// The body's motion in this step; the identity for a cloth.
Transform3<double> ClothSimulator::bodyMotion(int body) const {
  const ObstacleMotion& motion = bodies_[body].motion;
  if (!motion) return Transform3<double>::Identity();
  return motion(time() + stepTime()) * motion(time()).inverse();
}

void ClothSimulator::finishStep() {
  for (std::size_t v = 0; v < moved_.size(); ++v)
    velocities_[v] = (moved_[v] - mesh_.vertices[v]) / stepTime();
  dampNeighbours();
  mesh_.vertices.swap(moved_);
  ++step_;
}

/// Friction inside the cloth: takes away a part of how fast neighbours move against each
/// other; momentum is kept.
void ClothSimulator::dampNeighbours() {
  const double lost = 1 - std::exp(-options_.internal_damping * stepTime());
  for (const Spring& s : edge_springs_) {
    const auto [a, b] = s.vertices;
    const double mobility = inverse_masses_[a] + inverse_masses_[b];
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

// SPDX-License-Identifier: BSD-3-Clause
#include "cloth_over_ball.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;

const double kClothSide = 1.5;
const double kClothDensity = .2;    // kg / m^2
const double kBendCompliance = .5;  // m / N
const double kBallRadius = .25;
const double kSpinBegin = .3;         // s
const double kSpinAcceleration = 12;  // radians / s^2
const double kGravity = 9.81;
const int kPasses = 25;  // over all springs
// Fractions of velocity, and of the relative velocity of neighbours, that are lost in a
// second (exponential).
const double kDamping = .5;
const double kNeighbourDamping = 100;

double secondsNow() {
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Pairs of vertices that face each other across an edge.
std::vector<std::array<std::size_t, 2>> hinges(const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> opposite;
  std::vector<std::array<std::size_t, 2>> pairs;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const std::size_t v = t[k], w = t[(k + 1) % 3], other = t[(k + 2) % 3];
      const auto [it, is_new] = opposite.try_emplace(std::minmax(v, w), other);
      if (!is_new) pairs.push_back({{it->second, other}});
    }
  return pairs;
}

template <typename T>
void write(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <typename T>
void read(const std::string& bytes, std::size_t& at, T* values, std::size_t count) {
  std::memcpy(values, bytes.data() + at, count * sizeof(T));
  at += count * sizeof(T);
}

}  // namespace

ClothOverBall::ClothOverBall(int resolution) {
  Transform3<double> start = Transform3<double>::Identity();
  start.translation() = V(.08, -.05, .56);
  start.rotate(Eigen::AngleAxisd(.4, V::UnitZ()));
  mesh_ =
      transformed(makeSheet(resolution, resolution,
                            [](double u, double v) {
                              return V(kClothSide * (u - .5), kClothSide * (v - .5), 0);
                            }),
                  start);
  addSprings(mesh_);
  first_of_ball_ = mesh_.vertices.size();
  // Vertices that lie on a line or in a plane would meet others all at one time.
  Random random(1);
  for (V& p : mesh_.vertices) p += random.point(1e-4 * kClothSide / resolution);
  mass_ = kClothDensity * kClothSide * kClothSide / static_cast<double>(first_of_ball_);

  ball_ = makeIcosphere(resolution < 64 ? 3 : 4, kBallRadius);
  append(mesh_, ball_);
  first_of_ground_ = mesh_.vertices.size();
  append(mesh_, makeSheet(16, 16, [](double u, double v) {
           return V(3 * (u - .5), 3 * (v - .5), 0);
         }));
  place(mesh_.vertices, 0);

  velocities_.assign(mesh_.vertices.size(), V::Zero());
  inverse_masses_.assign(mesh_.vertices.size(), 0);
  std::fill_n(inverse_masses_.begin(), first_of_ball_, 1 / mass_);
  options_.margin = std::min(.002, .25 * kClothSide / resolution);
  model_.beginModel();
  model_.addSubModel(mesh_.vertices, mesh_.triangles);
  model_.endModel(FclTree::kSkip);
}

ClothOverBall::Body ClothOverBall::bodyOf(std::size_t vertex) const {
  return vertex < first_of_ball_ ? kCloth : vertex < first_of_ground_ ? kBall : kGround;
}

void ClothOverBall::addSprings(const TestMesh& rest) {
  const auto add = [&](std::size_t a, std::size_t b, double compliance) {
    springs_.push_back({{{a, b}},
                        (rest.vertices[a] - rest.vertices[b]).norm(),
                        compliance / (kStepTime * kStepTime),
                        0});
  };
  for (const auto& e : uniqueEdges(rest.triangles))
    add(static_cast<std::size_t>(e[0]), static_cast<std::size_t>(e[1]), 0);
  for (const auto& e : hinges(rest.triangles)) add(e[0], e[1], kBendCompliance);
}

/// The vertices of the ball.
void ClothOverBall::place(Positions& vertices, double ball_time) const {
  const double spinning = std::max(0., ball_time - kSpinBegin);
  Transform3<double> pose(Translation3<double>(0, 0, kBallRadius + .02));
  pose.rotate(
      Eigen::AngleAxisd(.5 * kSpinAcceleration * spinning * spinning, V::UnitZ()));
  for (std::size_t v = 0; v < ball_.vertices.size(); ++v)
    vertices[first_of_ball_ + v] = pose * ball_.vertices[v];
}

/// Where a step would lead if nothing were in the way.
ClothOverBall::Positions ClothOverBall::proposed() {
  Positions next = mesh_.vertices;
  for (std::size_t v = 0; v < first_of_ball_; ++v)
    next[v] += kStepTime * (velocities_[v] - kStepTime * V(0, 0, kGravity));
  for (Spring& spring : springs_) spring.multiplier = 0;
  for (int pass = 0; pass < kPasses; ++pass)
    for (Spring& spring : springs_) {
      V &a = next[spring.vertices[0]], &b = next[spring.vertices[1]];
      const double length = (b - a).norm();
      if (length == 0) continue;
      const double multiplier =
          (spring.rest_length - length - spring.softness * spring.multiplier) /
          (2 / mass_ + spring.softness);
      spring.multiplier += multiplier;
      const V push = (multiplier / (mass_ * length)) * (b - a);
      a -= push;
      b += push;
    }
  place(next, ballTime(step_ + 1));
  return next;
}

ContinuousContactResult<double> ClothOverBall::contactsOnTheWayTo(const Positions& next) {
  model_.updateFrames(mesh_.vertices[0].data(), next[0].data(), next.size());
  ContinuousContactResult<double> result;
  continuousSelfCollide(&model_, ContinuousContactRequest<double>(), result);
  return result;
}

bool ClothOverBall::hasCrossing() {
  return contactsOnTheWayTo(mesh_.vertices).initially_crossing;
}

/// The contacts of the proposed motion, for pictures and table. The response asks by
/// itself.
void ClothOverBall::ask(const Positions& next, int step_of_frame, DemoFrame& frame) {
  const double begin = secondsNow();
  const ContinuousContactResult<double> result = contactsOnTheWayTo(next);
  frame.query_seconds += secondsNow() - begin;
  frame.counts += result.counts;
  if (!result.contacts.empty())
    frame.first_contact =
        std::min(frame.first_contact,
                 (step_of_frame + result.contacts[0].toc_lo) / kStepsPerFrame);
  frame.contacts.insert(frame.contacts.end(), result.contacts.begin(),
                        result.contacts.end());
}

void ClothOverBall::advanceStep(int step_of_frame, DemoFrame& frame) {
  const Positions free = proposed();
  Positions next = free, change(next.size(), V::Zero());
  ask(next, step_of_frame, frame);
  const double begin = secondsNow();
  const contact_response::Report report =
      contact_response::respond(model_, options_, inverse_masses_, mesh_.vertices,
                                kStepTime, next, change, &memory_);
  frame.response_seconds += secondsNow() - begin;
  frame.queries += report.queries;
  frame.in_zones += report.in_zones;
  frame.stopped += report.stopped;
  frame.unresolved += report.unresolved;
  frame.crossing |= report.initially_crossing;
  if (report.has_stopped_obstacle) {
    ++stopped_steps_;
    ++frame.stopped_steps;
  }
  for (std::size_t v = 0; v < first_of_ball_; ++v)
    velocities_[v] =
        std::exp(-kDamping * kStepTime) / kStepTime * (next[v] - mesh_.vertices[v]);
  damp();
  mesh_.vertices = std::move(next);
  ++step_;
}

/// Friction inside the cloth: reduces the relative velocity of neighbours.
void ClothOverBall::damp() {
  const double lost = 1 - std::exp(-kNeighbourDamping * kStepTime);
  for (const Spring& spring : springs_) {
    if (spring.softness > 0) continue;  // of a hinge
    V &a = velocities_[spring.vertices[0]], &b = velocities_[spring.vertices[1]];
    const V half = lost / 2 * (b - a);
    a += half;
    b -= half;
  }
}

DemoFrame ClothOverBall::advanceFrame() {
  const double begin = secondsNow();
  DemoFrame frame;
  // What the memory holds is no part of the state.
  memory_.forget();
  for (int step = 0; step < kStepsPerFrame; ++step) advanceStep(step, frame);
  const auto key = [](const ContinuousContact<double>& c) {
    return std::make_tuple(c.kind, c.vertices);
  };
  std::stable_sort(frame.contacts.begin(), frame.contacts.end(),
                   [&](const auto& x, const auto& y) { return key(x) < key(y); });
  frame.contacts.erase(
      std::unique(frame.contacts.begin(), frame.contacts.end(),
                  [&](const auto& x, const auto& y) { return key(x) == key(y); }),
      frame.contacts.end());
  for (const ContinuousContact<double>& c : frame.contacts) {
    ++(c.kind == ContinuousContactKind::kVertexFace ? frame.vertex_face
                                                    : frame.edge_edge);
    frame.self +=
        std::all_of(c.vertices.begin(), c.vertices.begin() + c.numVertices(),
                    [&](int v) { return bodyOf(static_cast<std::size_t>(v)) == kCloth; });
  }
  frame.number = this->frame();
  frame.total_seconds = secondsNow() - begin;
  return frame;
}

std::string ClothOverBall::state() const {
  std::string bytes;
  const int numbers[] = {static_cast<int>(mesh_.vertices.size()), step_, stopped_steps_};
  write(bytes, numbers, 3);
  write(bytes, mesh_.vertices[0].data(), 3 * mesh_.vertices.size());
  write(bytes, velocities_[0].data(), 3 * velocities_.size());
  return bytes;
}

void ClothOverBall::setState(const std::string& bytes) {
  int numbers[3] = {};
  const std::size_t count = mesh_.vertices.size();
  std::size_t at = 0;
  if (bytes.size() == sizeof(numbers) + 6 * count * sizeof(double))
    read(bytes, at, numbers, 3);
  if (numbers[0] != static_cast<int>(count))
    throw std::runtime_error("This is no state of a cloth of this resolution");
  read(bytes, at, mesh_.vertices[0].data(), 3 * count);
  read(bytes, at, velocities_[0].data(), 3 * count);
  step_ = numbers[1];
  stopped_steps_ = numbers[2];
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The part of the simulator that finds contacts and responds to them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include "cloth_simulator.h"
#include "fcl/common/exception.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "proximity.h"

namespace fcl {
namespace test {
namespace {

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Rounds of holding before obstacles stop for the step, and before everything stops.
/// Held vertices meet new ones, layer by layer. Dense cloth can need more than ten
/// rounds.
const int kRoundsWithMotion = 20;
const int kRoundsWithCloth = 50;

/// Weights of the closest points of the lines a0 a1 and b0 b1, moved into the segments.
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

/// Keeps the distance of surfaces that are close at the start of the step: there the side
/// on which each lies is known.
void ClothSimulator::pushApart() {
  if (!options_.push_apart) return;
  for (const NearPair& pair :
       findNearPairs(mesh_.vertices, mesh_.triangles, is_movable_, options_.thickness,
                     std::max(mean_edge_, 2 * options_.thickness))) {
    const Triangle& t = mesh_.triangles[pair.triangle];
    ContactWeights where;
    where.vertices = {{pair.vertex, static_cast<int>(t[0]), static_cast<int>(t[1]),
                       static_cast<int>(t[2])}};
    where.weights = {{1, -pair.weights[0], -pair.weights[1], -pair.weights[2]}};
    addConstraint(ContinuousContactKind::kVertexFace, where,
                  separation(where, mesh_.vertices));
  }
}

/// One query over the motion from mesh_.vertices to moved_.
ContinuousContactResult<double> ClothSimulator::query(int step_of_frame,
                                                      FrameReport& report) {
  const auto begin = std::chrono::steady_clock::now();
  if (model_.updateFrames(mesh_.vertices[0].data(), moved_[0].data(), moved_.size()) !=
      BVH_OK)
    throw Exception("ClothSimulator: " + model_.lastError());
  ContinuousContactRequest<double> request;
  request.num_threads = options_.num_threads;
  ContinuousContactResult<double> result;
  continuousSelfCollide(&model_, request, result);
  report.query_seconds += secondsSince(begin);
  ++report.queries;
  report.counts += result.counts;
  report.crossing = report.crossing || result.initially_crossing;
  for (const auto& c : result.contacts) {
    if (options_.keep_contacts)
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
void ClothSimulator::addConstraint(ContinuousContactKind kind, ContactWeights where,
                                   Vector3<double> direction) {
  const Vector3<double> now = separation(where, mesh_.vertices);
  if (direction.squaredNorm() == 0) direction = now;
  const double length = direction.norm();
  if (!(length > 0)) return;
  direction /= length;
  const double push = options_.push_speed * stepTime();
  double distance = std::max(0.0, direction.dot(now));
  distance = std::max((1 - options_.approach) * distance,
                      std::min(distance, 0.1 * options_.thickness));
  const double gap = std::min(options_.thickness, distance + push);
  ContactConstraint contact{where, {}, direction, now, gap, 0};
  const int split = kind == ContinuousContactKind::kVertexFace ? 1 : 2;
  for (int k = 0; k < 4; ++k) {
    const int v = where.vertices[k];
    if (solid_of_[v] < 0) continue;
    SolidShare& share = contact.solids[k < split ? 0 : 1];
    share.solid = solid_of_[v];
    share.weight += where.weights[k];
    share.rest += where.weights[k] * rest_[v];
    contact.where.weights[k] = 0;
  }
  const int solid = contact.solids[0].solid;
  if (solid >= 0 && solid == contact.solids[1].solid) return;
  contacts_.push_back(contact);
}

/// @param contacts  those of a query on the step's motion
void ClothSimulator::addConstraints(
    const std::vector<ContinuousContact<double>>& contacts) {
  const auto pairOf = [&](const ContinuousContact<double>& c) {
    const int one = solid_of_[c.vertices[0]];
    const int other = solid_of_[c.vertices[3]];
    return std::make_pair(std::min(one, other), std::max(one, other));
  };
  std::map<std::pair<int, int>, std::size_t> counts;
  for (const auto& c : contacts) ++counts[pairOf(c)];
  const std::size_t most = options_.contacts_per_pair;
  std::map<std::pair<int, int>, std::size_t> seen;
  for (const auto& c : contacts) {
    const auto pair = pairOf(c);
    const bool are_solids = pair.first >= 0 && pair.second >= 0;
    const std::size_t stride = are_solids ? 1 + (counts[pair] - 1) / most : 1;
    if (seen[pair]++ % stride == 0) addConstraint(c.kind, weightsAt(c), -c.normal);
  }
}

Vector3<double> ClothSimulator::separationNow(const ContactConstraint& contact) const {
  Vector3<double> sum = separation(contact.where, moved_);
  for (const SolidShare& share : contact.solids)
    if (share.solid >= 0) {
      const AffineState& end = solids_[share.solid].body.end;
      sum += share.weight * end.centre + end.shape * share.rest;
    }
  return sum;
}

/// Inelastic response: restores the gap, and reduces sliding as far as friction allows.
void ClothSimulator::projectContact(ContactConstraint& contact) {
  const auto& ids = contact.where.vertices;
  const auto& weights = contact.where.weights;
  const Vector3<double> now = separationNow(contact);
  const double missing = contact.gap - contact.direction.dot(now);
  if (missing <= 0) return;
  double mobility = 0;
  for (int k = 0; k < 4; ++k)
    mobility += weights[k] * weights[k] * inverse_masses_[ids[k]];
  for (const SolidShare& share : contact.solids)
    if (share.solid >= 0)
      mobility += solids_[share.solid].body.mobility(share.weight, share.rest);
  if (mobility == 0) return;
  Vector3<double> slide = now - contact.begin;
  slide -= contact.direction.dot(slide) * contact.direction;
  const double sliding = slide.norm();
  const double stopped = std::min(sliding, options_.friction * missing);
  Vector3<double> change = missing * contact.direction;
  if (sliding > 0) change -= (stopped / sliding) * slide;
  for (int k = 0; k < 4; ++k)
    moved_[ids[k]] += (weights[k] * inverse_masses_[ids[k]] / mobility) * change;
  for (const SolidShare& share : contact.solids)
    if (share.solid >= 0)
      solids_[share.solid].body.push(share.weight, share.rest, change / mobility);
  contact.impulse += missing / mobility;
}

void ClothSimulator::projectContacts() {
  for (ContactConstraint& c : contacts_) projectContact(c);
  for (Solid& s : solids_) s.body.restoreShape();
}

/// Repeats query and correction until the motion of the step has no contact.
void ClothSimulator::respond(int step_of_frame, FrameReport& report) {
  for (Solid& s : solids_) s.body.is_slowed = false;
  for (int round = 0; round < options_.response_rounds; ++round) {
    const auto result = query(step_of_frame, report);
    if (result.contacts.empty()) return;
    addConstraints(result.contacts);
    solve(2);
    for (int i = 0; i < options_.iterations; ++i) projectContacts();
    placeSolids();
  }
  holdInContact(step_of_frame, report);
}

/// Halves the motion of features that are still in contact, relative to their carrier. At
/// this point few contacts are left, late in the step.
void ClothSimulator::slowDown(const std::vector<ContinuousContact<double>>& contacts) {
  std::vector<std::array<int, 2>> slowed;  // vertex, carrier
  std::vector<int> solids;
  for (const auto& contact : contacts) {
    const int carrier = carrierOf(contact);
    for (int k = 0; k < 4; ++k) {
      const int v = contact.vertices[k];
      if (solid_of_[v] >= 0)
        solids.push_back(solid_of_[v]);
      else if (is_movable_[v])
        slowed.push_back({{v, carrier}});
    }
  }
  std::sort(solids.begin(), solids.end());
  solids.erase(std::unique(solids.begin(), solids.end()), solids.end());
  for (const int solid : solids) solids_[solid].body.slowDown(stepTime());
  placeSolids();
  std::sort(slowed.begin(), slowed.end());
  for (std::size_t i = 0; i < slowed.size(); ++i) {
    const int v = slowed[i][0];
    if (i + 1 < slowed.size() && slowed[i + 1][0] == v) continue;
    moved_[v] = 0.5 * (moved_[v] + bodies_[slowed[i][1]].step_motion * mesh_.vertices[v]);
  }
}

/// Makes features that are still in contact move with the obstacle that they touch,
/// directly or through other held features, or not at all. The loop ends at the latest
/// when everything stands still, since the step began without contact. But the next step
/// would then be the same again, so the code tries hard to keep something moving.
void ClothSimulator::holdInContact(int step_of_frame, FrameReport& report) {
  std::fill(held_with_.begin(), held_with_.end(), -1);
  for (Solid& s : solids_) s.body.held_with = -1;
  for (int round = 0;; ++round) {
    const auto result = query(step_of_frame, report);
    if (result.contacts.empty()) return;
    if (round < options_.slowing_rounds) {
      slowDown(result.contacts);
      continue;
    }
    if (round > kRoundsWithCloth) {
      report.unresolved += result.contacts.size();
      return;
    }
    if (round == kRoundsWithMotion) {
      stopObstacles();
      ++report.stopped_steps;
    }
    if (round == kRoundsWithCloth) stopAll();
    report.held_vertices +=
        holdContacts(result.contacts, /*with_neighbours=*/round >= kRoundsWithMotion);
  }
}

/// @param with_neighbours  whether the surroundings of a vertex of cloth are held with
/// it. Without it, layer by layer and vertex by vertex, all of a dense cloth can come to
/// rest first
/// @return the number of newly held vertices
std::size_t ClothSimulator::holdContacts(
    const std::vector<ContinuousContact<double>>& contacts, bool with_neighbours) {
  std::size_t held = 0;
  std::vector<int> carriers(with_neighbours ? moved_.size() : 0, -1);
  for (const auto& contact : contacts) {
    const int carrier = carrierOf(contact);
    for (int k = 0; k < 4; ++k) {
      const int v = contact.vertices[k];
      held += hold(v, carrier);
      if (with_neighbours && solid_of_[v] < 0) carriers[v] = carrier;
    }
  }
  if (!with_neighbours) return held;
  for (const Triangle& t : mesh_.triangles) {
    const int carrier = std::max({carriers[t[0]], carriers[t[1]], carriers[t[2]]});
    for (int k = 0; k < 3 && carrier >= 0; ++k)
      if (held_with_[t[k]] < 0) held += hold(static_cast<int>(t[k]), carrier);
  }
  return held;
}

/// The obstacle of a contact, directly or through held features, or the body of its first
/// vertex.
int ClothSimulator::carrierOf(const ContinuousContact<double>& contact) const {
  int carrier = body_of_[contact.vertices[0]];
  for (int k = 0; k < 4; ++k) {
    const int with = carrierOf(contact.vertices[k]);
    if (with >= 0 && isObstacle(with)) carrier = with;
  }
  return carrier;
}

/// The body with which a vertex moves already, or -1.
int ClothSimulator::carrierOf(int vertex) const {
  if (solid_of_[vertex] >= 0) return solids_[solid_of_[vertex]].body.held_with;
  if (pinned_to_[vertex] >= 0) return pinned_to_[vertex];
  return is_movable_[vertex] ? held_with_[vertex] : body_of_[vertex];
}

/// Holds a vertex; a vertex of a solid holds the whole solid. @return whether it was not
/// held before
bool ClothSimulator::hold(int vertex, int carrier) {
  if (!is_movable_[vertex]) return false;
  const Transform3<double>& motion = bodies_[carrier].step_motion;
  if (solid_of_[vertex] < 0) {
    const bool is_new = held_with_[vertex] < 0;
    held_with_[vertex] = carrier;
    moved_[vertex] = motion * mesh_.vertices[vertex];
    return is_new;
  }
  AffineBody& body = solids_[solid_of_[vertex]].body;
  const bool is_new = body.held_with < 0;
  if (!is_new && body.held_with == carrier) return false;
  body.held_with = carrier;
  body.end.centre = motion * body.begin.centre;
  body.end.shape = motion.linear() * body.begin.shape;
  for (const int v : body.vertices) moved_[v] = motion * mesh_.vertices[v];
  return is_new;
}

void ClothSimulator::stopObstacles() {
  ++stopped_steps_;
  for (std::size_t v = 0; v < moved_.size(); ++v)
    if (!is_movable_[v] || held_with_[v] >= 0) moved_[v] = mesh_.vertices[v];
  for (Body& body : bodies_) body.step_motion = Transform3<double>::Identity();
  for (Solid& s : solids_) {
    if (s.body.held_with < 0) continue;
    s.body.end = s.body.begin;
    for (const int v : s.body.vertices) moved_[v] = mesh_.vertices[v];
  }
}

void ClothSimulator::stopAll() {
  moved_ = mesh_.vertices;
  for (Solid& s : solids_) s.body.end = s.body.begin;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// A response to contacts, to copy into an engine. A step of a simulation proposes
// positions; respond() changes them until the exact continuous query finds no contact on
// the way. So a state without crossings leads to another one.
//
// First there are rounds of impulses. Each contact keeps its two features apart, by their
// masses and with friction. The impulses of a contact add up to zero: linear momentum is
// kept.
//
// Where contacts are left after these rounds, the vertices that meet become a rigid zone.
// It keeps the linear momentum of its vertices, and to first order the angular one, or it
// moves with the obstacle that is in it. Zones that meet become one.
//
// A zone that still has contacts stands still for the step. So the rounds end.
//
// The zones are those of Provot 1997, "Collision and self-collision handling in cloth
// model dedicated to design garments", and of Bridson, Fedkiw and Anderson 2002, "Robust
// treatment of collisions, contact and friction for cloth animation".
#ifndef CONTACT_RESPONSE_H
#define CONTACT_RESPONSE_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_contact.h>

namespace contact_response {

using Positions = std::vector<fcl::Vector3d>;

struct Options {
  /// The distance that impulses leave between two features, above min_distance, in the
  /// unit of the coordinates. It must be above 0, because features that touch at the
  /// beginning of a step cannot be parted.
  double margin;
  /// The distance at which features are in contact. 0: where they touch. Above 0, pairs
  /// that are nearer than that at the beginning of the step may not come nearer, and
  /// zones do not turn: on straight ways a turn brings parts nearer to each other for a
  /// while.
  double min_distance{0};
  /// Coulomb's coefficient.
  double friction{.3};
  /// Rounds of a query and impulses before there are zones, and passes over all contacts
  /// in each.
  int impulse_rounds{10};
  int passes{20};
  /// Rounds with zones that move, before zones stand still.
  int zone_rounds{20};
  /// Whether the engine keeps positions in float: the motion that is found free is that
  /// of rounded positions. Those before the step must be floats.
  bool rounds_to_float{false};
  /// Threads of the queries; the answer does not depend on it.
  int num_threads{1};
};

struct Report {
  int queries{0};
  /// Contacts of the motion that was proposed; with a memory, after its pairs were kept
  /// apart.
  std::size_t contacts{0};
  /// Vertices that moved in zones, and those of zones that stand still.
  std::size_t in_zones{0};
  std::size_t stopped{0};
  /// Whether an obstacle is among those: continue its motion from where it stands.
  bool has_stopped_obstacle{false};
  /// The state before the step had an edge that passes through a triangle: nothing was
  /// changed.
  bool initially_crossing{false};
  /// Contacts of the motion that is returned. They are left only of features that touch
  /// at the beginning, and where nothing was changed.
  std::size_t unresolved{0};
};

/// The nearest position whose coordinates are floats.
inline fcl::Vector3d roundedToFloat(const fcl::Vector3d& p) {
  fcl::Vector3d out;
  for (int k = 0; k < 3; ++k) {
    // volatile: gcc 12 leaves out conversions to float and back.
    const volatile float x = static_cast<float>(p[k]);
    out[k] = static_cast<double>(x);
  }
  return out;
}

/// The pairs of features that met in the last step. Those that are still near are kept
/// apart before the first query of the next one, which then finds few contacts: most
/// pairs that rest on each other do so for many steps. A part of the state of a
/// simulation. Forget it where triangles change.
class Memory {
 public:
  void forget() { pairs_.clear(); }

 private:
  template <typename BV>
  friend class Step;
  struct Pair {
    fcl::ContinuousContactKind kind;
    int num_vertices;
    std::array<std::size_t, 4> vertices;
    bool operator<(const Pair& other) const {
      return std::tie(kind, vertices) < std::tie(other.kind, other.vertices);
    }
    bool operator==(const Pair& other) const {
      return kind == other.kind && vertices == other.vertices;
    }
  };
  std::vector<Pair> pairs_;
};

/// One step. `model` has the mesh of all bodies, deforming ones and obstacles.
template <typename BV>
class Step {
 public:
  /// @param inverse_masses  of the vertices; 0: an obstacle, which moves as proposed
  Step(fcl::DeformableBVHModel<BV>& model, const Options& options,
       const std::vector<double>& inverse_masses, const Positions& before,
       Positions& after, Memory* memory = nullptr)
      : model_(model),
        options_(options),
        inverse_masses_(inverse_masses),
        before_(before),
        after_(after),
        memory_(memory) {
    if (!(options.margin > 0) || !(options.min_distance >= 0) ||
        options.impulse_rounds < 0)
      throw std::invalid_argument(
          "The margin must be above 0, other options not below it");
    if (before.empty() || before.size() != after.size() ||
        before.size() != inverse_masses.size())
      throw std::invalid_argument("Positions and inverse masses: one for each vertex");
    for (const double w : inverse_masses)
      if (!(w >= 0) || !std::isfinite(w))
        throw std::invalid_argument("An inverse mass is a number that is not below 0");
    if (options.rounds_to_float)
      for (const fcl::Vector3d& p : before)
        if (p != roundedToFloat(p))
          throw std::invalid_argument(
              "With rounds_to_float the positions before are floats");
  }

  Report run() {
    remember();
    for (int round = 0; round <= options_.impulse_rounds; ++round) {
      query();
      if (round == 0) report_.contacts = found_.contacts.size();
      report_.initially_crossing = found_.initially_crossing;
      report_.unresolved = found_.contacts.size();
      if (found_.contacts.empty() || found_.initially_crossing) break;
      if (round == options_.impulse_rounds) {
        moveZones();
        break;
      }
      for (const auto& contact : found_.contacts) addConstraint(contact);
      projectAll();
    }
    if (memory_) memory_->pairs_ = std::move(pairs_);
    return report_;
  }

 private:
  using Kind = fcl::ContinuousContactKind;
  /// The first feature minus the second one at the place of the contact: the weights of
  /// their vertices, which add up to 0.
  struct Constraint {
    int size;
    std::size_t vertex[4];
    double weight[4];
    fcl::Vector3d direction;  // unit, from the second feature to the first one
    double gap;               // that has to be left along it
  };

  void query() {
    if (options_.rounds_to_float)
      for (fcl::Vector3d& p : after_) p = roundedToFloat(p);
    if (model_.updateFrames(before_[0].data(), after_[0].data(), after_.size()) !=
        fcl::BVH_OK)
      throw std::runtime_error(model_.lastError());
    fcl::ContinuousContactRequestd request;
    request.min_distance = options_.min_distance;
    request.ignore_initially_closer = options_.min_distance > 0;
    request.num_threads = options_.num_threads;
    if (report_.queries > 0) selectMoved(request);
    const std::vector<fcl::ContinuousContactd> old = std::move(found_.contacts);
    found_ = {};
    fcl::continuousSelfCollide(&model_, request, found_);
    if (report_.queries > 0) keepUnmoved(old);
    asked_ = after_;
    ++report_.queries;
  }

  bool hasMoved(std::size_t vertex) const { return after_[vertex] != asked_[vertex]; }

  /// Between two queries few vertices move. Triangles of two groups: those that have not
  /// moved meet those that have, but not each other.
  void selectMoved(fcl::ContinuousContactRequestd& request) const {
    constexpr std::uint32_t kStill = 1, kMoved = 2;
    auto &groups = request.filter1.triangle_groups,
         &masks = request.filter1.triangle_masks;
    const auto add = [&](bool has_moved) {
      groups.push_back(has_moved ? kStill | kMoved : kStill);
      masks.push_back(has_moved ? kStill | kMoved : kMoved);
    };
    for (int i = 0; i < model_.num_tris; ++i) {
      const fcl::Triangle& t = model_.tri_indices[i];
      add(hasMoved(t[0]) || hasMoved(t[1]) || hasMoved(t[2]));
    }
    for (std::size_t i = 0; i < model_.numFreeEdges(); ++i)
      add(hasMoved(model_.freeEdge(i)[0]) || hasMoved(model_.freeEdge(i)[1]));
    for (std::size_t i = 0; i < model_.numFreePoints(); ++i)
      add(hasMoved(model_.freePoint(i)));
  }

  /// Adds the contacts of the query before whose features have not moved, and that the
  /// last one has not found again.
  void keepUnmoved(const std::vector<fcl::ContinuousContactd>& old) {
    std::vector<Memory::Pair> again;
    for (const auto& contact : found_.contacts) again.push_back(pairOf(contact));
    std::sort(again.begin(), again.end());
    for (const auto& contact : old) {
      bool has_moved = false;
      for (int k = 0; k < contact.numVertices(); ++k)
        has_moved |= hasMoved(vertexOf(contact, k));
      if (!has_moved && !std::binary_search(again.begin(), again.end(), pairOf(contact)))
        found_.contacts.push_back(contact);
    }
  }

  static std::size_t vertexOf(const fcl::ContinuousContactd& contact, int k) {
    return static_cast<std::size_t>(contact.vertices[static_cast<std::size_t>(k)]);
  }

  static Memory::Pair pairOf(const fcl::ContinuousContactd& contact) {
    Memory::Pair pair{contact.kind, contact.numVertices(), {}};
    for (int k = 0; k < pair.num_vertices; ++k)
      pair.vertices[static_cast<std::size_t>(k)] = vertexOf(contact, k);
    return pair;
  }

  static double clamped(double x) { return std::min(1., std::max(0., x)); }

  /// Where the foot of a point on an edge lies, from 0 to 1.
  static double along(const fcl::Vector3d& p, const fcl::Vector3d& a,
                      const fcl::Vector3d& b) {
    const double square = (b - a).squaredNorm();
    return square > 0 ? clamped((p - a).dot(b - a) / square) : .5;
  }

  void projectAll() {
    for (int i = 0; i < options_.passes; ++i)
      for (const Constraint& constraint : constraints_) project(constraint);
  }

  /// The constraints of the pairs of the last step that are still near.
  void remember() {
    if (!memory_) return;
    std::sort(memory_->pairs_.begin(), memory_->pairs_.end());
    memory_->pairs_.erase(std::unique(memory_->pairs_.begin(), memory_->pairs_.end()),
                          memory_->pairs_.end());
    const double near = 2 * (options_.min_distance + options_.margin);
    for (const Memory::Pair& pair : memory_->pairs_) {
      // A mesh that has lost vertices.
      if (*std::max_element(pair.vertices.begin(), pair.vertices.end()) >= before_.size())
        continue;
      fcl::Vector3d x[4], place;
      for (int k = 0; k < pair.num_vertices; ++k)
        x[k] = before_[pair.vertices[static_cast<std::size_t>(k)]];
      if (!nearestPlace(pair.kind, x, place)) continue;
      Constraint c = constraintAt(pair, x, place);
      c.direction = between(c, before_);
      if (!(c.direction.norm() < near) || !finish(c)) continue;
      constraints_.push_back(c);
      pairs_.push_back(pair);
    }
    projectAll();
  }

  /// A point on one of two features, near to the other. @return false if their nearest
  /// points are on their borders
  static bool nearestPlace(Kind kind, const fcl::Vector3d (&x)[4], fcl::Vector3d& place) {
    place = x[0];
    if (kind == Kind::kVertexFace) {
      const fcl::Vector3d n = (x[2] - x[1]).cross(x[3] - x[1]);
      for (int k = 0; k < 3; ++k)
        if ((x[1 + (k + 1) % 3] - x[1 + k]).cross(x[0] - x[1 + k]).dot(n) < 0)
          return false;
    } else if (kind == Kind::kEdgeEdge) {
      const fcl::Vector3d u = x[1] - x[0], v = x[3] - x[2], w = x[2] - x[0],
                          n = u.cross(v);
      const double square = n.squaredNorm(), s = w.cross(v).dot(n), t = w.cross(u).dot(n);
      if (!(0 <= s && s <= square && 0 <= t && t <= square && square > 0)) return false;
      place = x[0] + (s / square) * u;
    }
    return true;
  }

  void addConstraint(const fcl::ContinuousContactd& contact) {
    const Memory::Pair pair = pairOf(contact);
    fcl::Vector3d x[4];
    for (int k = 0; k < contact.numVertices(); ++k) {
      const std::size_t v = vertexOf(contact, k);
      x[k] = before_[v] + contact.toc_lo * (after_[v] - before_[v]);
    }
    Constraint c = constraintAt(pair, x, contact.pos);
    c.direction = contact.normal.squaredNorm() > 0 ? fcl::Vector3d(-contact.normal)
                                                   : between(c, before_);
    if (!finish(c)) return;
    constraints_.push_back(c);
    pairs_.push_back(pair);
  }

  /// The weights of the vertices at a place.
  static Constraint constraintAt(const Memory::Pair& pair, const fcl::Vector3d (&x)[4],
                                 const fcl::Vector3d& place) {
    Constraint c{};
    c.size = pair.num_vertices;
    std::copy(pair.vertices.begin(), pair.vertices.end(), c.vertex);
    const auto setEdge = [&](int k, double sign) {
      const double t = along(place, x[k], x[k + 1]);
      c.weight[k] = sign * (1 - t);
      c.weight[k + 1] = sign * t;
    };
    c.weight[0] = 1;
    switch (pair.kind) {
      case Kind::kVertexFace: {
        const fcl::Vector3d n = (x[2] - x[1]).cross(x[3] - x[1]);
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
          const fcl::Vector3d &p = x[1 + (k + 1) % 3], &q = x[1 + (k + 2) % 3];
          c.weight[k + 1] = std::max(0., (q - p).cross(place - p).dot(n));
          sum += c.weight[k + 1];
        }
        for (int k = 1; k < 4; ++k) c.weight[k] = sum > 0 ? -c.weight[k] / sum : -1 / 3.;
        break;
      }
      case Kind::kEdgeEdge:
        setEdge(0, 1);
        setEdge(2, -1);
        break;
      case Kind::kVertexEdge:
        setEdge(1, -1);
        break;
      default:  // two vertices
        c.weight[1] = -1;
    }
    return c;
  }

  /// The gap along the direction. @return false without a direction
  bool finish(Constraint& c) const {
    if (!(c.direction.norm() > 0)) return false;
    c.direction.normalize();
    // A pair that is nearer than it should be is pushed apart a little in each step.
    const double wanted = options_.min_distance + options_.margin,
                 begin = c.direction.dot(between(c, before_));
    c.gap = std::min(wanted, std::max(0., begin) + .01 * wanted);
    return true;
  }

  static fcl::Vector3d between(const Constraint& c, const Positions& positions) {
    fcl::Vector3d sum = fcl::Vector3d::Zero();
    for (int k = 0; k < c.size; ++k) sum += c.weight[k] * positions[c.vertex[k]];
    return sum;
  }

  /// Restores the gap, and takes away sliding as far as friction allows.
  void project(const Constraint& c) {
    const fcl::Vector3d now = between(c, after_);
    const double missing = c.gap - c.direction.dot(now);
    if (!(missing > 0)) return;
    double mobility = 0;
    for (int k = 0; k < c.size; ++k)
      mobility += c.weight[k] * c.weight[k] * inverse_masses_[c.vertex[k]];
    if (mobility == 0) return;
    fcl::Vector3d change = missing * c.direction, slide = now - between(c, before_);
    slide -= c.direction.dot(slide) * c.direction;
    const double sliding = slide.norm();
    if (sliding > 0)
      change -= std::min(1., options_.friction * missing / sliding) * slide;
    for (int k = 0; k < c.size; ++k)
      after_[c.vertex[k]] +=
          (c.weight[k] * inverse_masses_[c.vertex[k]] / mobility) * change;
  }

  std::size_t zoneOf(std::size_t vertex) {
    while (zone_[vertex] != vertex) vertex = zone_[vertex] = zone_[zone_[vertex]];
    return vertex;
  }

  /// @return whether they were two zones
  bool join(std::size_t v, std::size_t w) {
    v = zoneOf(v);
    w = zoneOf(w);
    zone_[std::max(v, w)] = std::min(v, w);
    is_still_[std::min(v, w)] |= is_still_[std::max(v, w)];
    return v != w;
  }

  bool isOneZone(const fcl::ContinuousContactd& contact) {
    for (int k = 1; k < contact.numVertices(); ++k)
      if (zoneOf(vertexOf(contact, k)) != zoneOf(vertexOf(contact, 0))) return false;
    return true;
  }

  void moveZones() {
    const Positions free = after_;
    zone_.resize(before_.size());
    std::iota(zone_.begin(), zone_.end(), std::size_t{0});
    is_still_.assign(before_.size(), 0);
    // Each part of an obstacle that edges join is a zone from the beginning: it keeps its
    // shape.
    for (int i = 0; i < model_.num_tris; ++i) {
      const fcl::Triangle& t = model_.tri_indices[i];
      for (int k = 0; k < 3; ++k) {
        const std::size_t v = t[k], w = t[(k + 1) % 3];
        if (inverse_masses_[v] == 0 && inverse_masses_[w] == 0) join(v, w);
      }
    }
    for (std::size_t i = 0; i < model_.numFreeEdges(); ++i) {
      const fcl::FreeEdge& edge = model_.freeEdge(i);
      if (inverse_masses_[edge[0]] == 0 && inverse_masses_[edge[1]] == 0)
        join(edge[0], edge[1]);
    }
    std::vector<char> has_contact(before_.size(), 0);
    for (int round = 0; !found_.contacts.empty(); ++round) {
      // What moved as one and has a contact nevertheless stands still.
      bool is_new = false;
      for (const auto& contact : found_.contacts)
        if (isOneZone(contact) || round >= options_.zone_rounds) {
          char& is_still = is_still_[zoneOf(vertexOf(contact, 0))];
          is_new |= !is_still;
          is_still = 1;
        }
      for (const auto& contact : found_.contacts) {
        has_contact[vertexOf(contact, 0)] = 1;
        for (int k = 1; k < contact.numVertices(); ++k)
          is_new |= join(vertexOf(contact, 0), vertexOf(contact, k));
      }
      if (!is_new) break;
      place(free, has_contact);
      query();
    }
    report_.unresolved = found_.contacts.size();
  }

  /// Moves all zones of the rounds so far, from where the impulses led their vertices.
  void place(const Positions& free, const std::vector<char>& has_contact) {
    std::vector<std::vector<std::size_t>> members(before_.size());
    for (std::size_t v = 0; v < before_.size(); ++v) members[zoneOf(v)].push_back(v);
    report_.in_zones = report_.stopped = 0;
    report_.has_stopped_obstacle = false;
    for (std::size_t zone = 0; zone < members.size(); ++zone) {
      bool is_zone = false;
      for (const std::size_t v : members[zone]) is_zone |= has_contact[v] != 0;
      if (!is_zone) continue;
      fcl::Transform3d motion;
      const bool moves = !is_still_[zone] && motionOf(members[zone], free, motion);
      for (const std::size_t v : members[zone]) {
        if (!moves)
          after_[v] = before_[v];
        else if (inverse_masses_[v] > 0)
          after_[v] = motion * before_[v];
        report_.has_stopped_obstacle |=
            !moves && inverse_masses_[v] == 0 && free[v] != before_[v];
      }
      (moves ? report_.in_zones : report_.stopped) += members[zone].size();
    }
  }

  /// The motion of a zone. @return false if its obstacles do not move as one rigid body
  bool motionOf(const std::vector<std::size_t>& members, const Positions& free,
                fcl::Transform3d& motion) const {
    std::vector<std::size_t> fixed;
    for (const std::size_t v : members)
      if (inverse_masses_[v] == 0) fixed.push_back(v);
    if (fixed.empty()) {
      motion = motionOfMasses(members, free);
      return true;
    }
    Eigen::Matrix3Xd from(3, fixed.size()), to(3, fixed.size());
    for (std::size_t i = 0; i < fixed.size(); ++i) {
      from.col(static_cast<Eigen::Index>(i)) = before_[fixed[i]];
      to.col(static_cast<Eigen::Index>(i)) = free[fixed[i]];
    }
    motion = fcl::Transform3d::Identity();
    motion.translation() = to.col(0) - from.col(0);
    const double size = from.cwiseAbs().maxCoeff() + to.cwiseAbs().maxCoeff();
    // Half a unit in the last place of a float is 6e-8. The next query checks the motion.
    const double most = (options_.rounds_to_float ? 1e-6 : 1e-12) * size;
    const auto error = [&] { return (motion * from - to).cwiseAbs().maxCoeff(); };
    if (error() <= most) return true;
    // Points on a line do not tell how far it turns about itself.
    const Eigen::Matrix3Xd centered = from.colwise() - from.rowwise().mean();
    const Eigen::Matrix3d spread = centered * centered.transpose();
    const Eigen::Vector3d extents =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
    if (!(extents[1] > 1e-6 * extents[2])) return false;
    motion.matrix() = Eigen::umeyama(from, to, false);
    return error() <= most;
  }

  /// The rigid motion with the linear and angular momentum of the vertices; with
  /// min_distance with the linear one alone.
  fcl::Transform3d motionOfMasses(const std::vector<std::size_t>& members,
                                  const Positions& free) const {
    double mass = 0;
    fcl::Vector3d center = fcl::Vector3d::Zero(), way = center, momentum = center;
    for (const std::size_t v : members) {
      const double m = 1 / inverse_masses_[v];
      mass += m;
      center += m * before_[v];
      way += m * (free[v] - before_[v]);
    }
    center /= mass;
    way /= mass;
    fcl::Matrix3d inertia = fcl::Matrix3d::Zero();
    for (const std::size_t v : members) {
      const double m = 1 / inverse_masses_[v];
      const fcl::Vector3d r = before_[v] - center;
      momentum += m * r.cross(free[v] - before_[v]);
      inertia += m * (r.squaredNorm() * fcl::Matrix3d::Identity() - r * r.transpose());
    }
    // Points on a line have no inertia about it, but for rounding: they do not turn about
    // it.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
    const double least = options_.rounds_to_float ? 1e-6 : 1e-12;
    fcl::Vector3d turn = fcl::Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const fcl::Vector3d axis = axes.eigenvectors().col(i);
      const double about_axis = axes.eigenvalues()[i];
      if (about_axis > least * axes.eigenvalues()[2])
        turn += axis.dot(momentum) / about_axis * axis;
    }
    // Less than half a turn: on straight ways the vertices keep the sides that they are
    // on.
    const double angle = options_.min_distance > 0 ? 0 : std::min(turn.norm(), 1.5);
    fcl::Transform3d motion = fcl::Transform3d::Identity();
    motion.translation() = center + way;
    if (angle > 0) motion.rotate(Eigen::AngleAxisd(angle, turn.normalized()));
    motion.translate(-center);
    return motion;
  }

  fcl::DeformableBVHModel<BV>& model_;
  const Options& options_;
  const std::vector<double>& inverse_masses_;
  const Positions& before_;
  Positions& after_;
  fcl::ContinuousContactResultd found_;
  /// The positions after the step of the last query.
  Positions asked_;
  Memory* memory_;
  std::vector<Constraint> constraints_;
  /// Of the constraints.
  std::vector<Memory::Pair> pairs_;
  std::vector<std::size_t> zone_;
  std::vector<char> is_still_;
  Report report_;
};

/// Changes the positions at the end of a step until there is no contact on the way from
/// `before`, and the velocities by as much.
/// @param model  all bodies as one mesh, built; its motion is set here
/// @param inverse_masses  of the vertices; 0: an obstacle, which moves as proposed
/// @param time  of the step, in the unit of the velocities
/// @param memory  of the last step; null: none
/// @throws std::invalid_argument for numbers that do not fit, std::runtime_error for
/// coordinates that the model refuses; positions and velocities are then as before
template <typename BV>
Report respond(fcl::DeformableBVHModel<BV>& model, const Options& options,
               const std::vector<double>& inverse_masses, const Positions& before,
               double time, Positions& after, Positions& velocities,
               Memory* memory = nullptr) {
  if (!(time > 0)) throw std::invalid_argument("The time of a step must be above 0");
  if (velocities.size() != after.size())
    throw std::invalid_argument("Velocities: one for each vertex");
  Positions accepted = after;
  const Report report =
      Step<BV>(model, options, inverse_masses, before, accepted, memory).run();
  if (report.initially_crossing) return report;
  for (std::size_t v = 0; v < after.size(); ++v)
    if (inverse_masses[v] > 0) velocities[v] += (accepted[v] - after[v]) / time;
  after = std::move(accepted);
  return report;
}

}  // namespace contact_response

#endif

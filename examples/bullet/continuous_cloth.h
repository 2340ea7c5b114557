// SPDX-License-Identifier: BSD-3-Clause
//
// Continuous collision detection around btSoftRigidDynamicsWorld::stepSimulation(), to
// copy into a simulation: a soft body of faces, obstacles of triangles, and a step in
// which the body passes neither through them nor through itself. Bullet has positions in
// float. All doubles that are set here are floats, so nothing is rounded on the way.
#ifndef CONTINUOUS_CLOTH_H
#define CONTINUOUS_CLOTH_H

#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include "contact_response.h"

static_assert(sizeof(btScalar) == sizeof(float), "Bullet in float, as it usually is");

class ContinuousCloth {
 public:
  using Positions = contact_response::Positions;

  /// @param margin  that is left to others, in the unit of the coordinates
  /// @throws std::invalid_argument for a body without faces, such as a rope
  ContinuousCloth(btSoftBody& body, double margin) : body_(body) {
    if (body.m_faces.size() == 0)
      throw std::invalid_argument("ContinuousCloth: the soft body has no faces");
    options_.margin = margin;
    options_.rounds_to_float = true;
    positions_ = nodes();
    for (int i = 0; i < body.m_faces.size(); ++i) {
      std::size_t v[3];
      for (int k = 0; k < 3; ++k)
        v[k] = static_cast<std::size_t>(body.m_faces[i].m_n[k] - &body.m_nodes[0]);
      triangles_.emplace_back(v[0], v[1], v[2]);
    }
    for (int i = 0; i < body.m_nodes.size(); ++i)
      inverse_masses_.push_back(static_cast<double>(body.m_nodes[i].m_im));
  }

  /// Before the first step. The vertices are rounded to float.
  void addObstacle(const Positions& vertices,
                   const std::vector<fcl::Triangle>& triangles) {
    const std::size_t first = positions_.size();
    for (const fcl::Vector3d& p : vertices)
      positions_.push_back(contact_response::roundedToFloat(p));
    for (const fcl::Triangle& t : triangles)
      triangles_.emplace_back(first + t[0], first + t[1], first + t[2]);
    inverse_masses_.resize(positions_.size(), 0);
  }

  /// One step of the world, without steps inside of it. `obstacles`: the positions of all
  /// vertices of obstacles at its end, rounded to float; empty: they stay.
  /// @throws std::invalid_argument if that is another number of vertices
  contact_response::Report step(btSoftRigidDynamicsWorld& world, float time,
                                const Positions& obstacles = {}) {
    if (model_.num_tris == 0) {
      model_.beginModel();
      model_.addSubModel(positions_, triangles_);
      model_.endModel(fcl::FclTree::kSkip);
    }
    const std::size_t num_nodes = static_cast<std::size_t>(body_.m_nodes.size());
    if (!obstacles.empty() && obstacles.size() != positions_.size() - num_nodes)
      throw std::invalid_argument("ContinuousCloth: positions of all obstacles, or none");
    world.stepSimulation(time, 0);
    Positions next = nodes(), velocities(positions_.size(), fcl::Vector3d::Zero());
    const std::size_t count = next.size();
    next.insert(next.end(), positions_.begin() + static_cast<std::ptrdiff_t>(count),
                positions_.end());
    for (std::size_t i = 0; i < obstacles.size(); ++i)
      next[count + i] = contact_response::roundedToFloat(obstacles[i]);
    const auto begin = std::chrono::steady_clock::now();
    const contact_response::Report report =
        contact_response::respond(model_, options_, inverse_masses_, positions_,
                                  static_cast<double>(time), next, velocities, &memory_);
    seconds_ =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (std::size_t i = 0; i < count; ++i) {
      btSoftBody::Node& node = body_.m_nodes[static_cast<int>(i)];
      node.m_x = vectorOf(next[i]);
      node.m_v += vectorOf(velocities[i]);
    }
    positions_ = next;
    return report;
  }

  /// Nodes of the body, then vertices of obstacles, after the last step.
  const Positions& positions() const { return positions_; }
  /// Of these.
  const std::vector<fcl::Triangle>& triangles() const { return triangles_; }
  /// What contacts took of the last step: queries and response.
  double secondsOfContacts() const { return seconds_; }

 private:
  static btVector3 vectorOf(const fcl::Vector3d& p) {
    return {static_cast<float>(p.x()), static_cast<float>(p.y()),
            static_cast<float>(p.z())};
  }

  Positions nodes() const {
    Positions out;
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
      const btVector3& x = body_.m_nodes[i].m_x;
      out.emplace_back(x.x(), x.y(), x.z());
    }
    return out;
  }

  btSoftBody& body_;
  contact_response::Options options_{};
  contact_response::Memory memory_;
  fcl::DeformableBVHModel<> model_;
  Positions positions_;
  std::vector<fcl::Triangle> triangles_;
  std::vector<double> inverse_masses_;
  double seconds_{0};
};

#endif

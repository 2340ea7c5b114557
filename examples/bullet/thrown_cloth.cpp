// SPDX-License-Identifier: BSD-3-Clause
//
// A cloth of Bullet that is thrown at a sheet of triangles without thickness, beside a
// block that turns: by Bullet alone, and with the continuous step around it. Contacts on
// the way that was taken, which nobody answered, are counted by the exact query.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "continuous_cloth.h"

namespace {

using Positions = contact_response::Positions;

struct Mesh {
  Positions vertices;
  std::vector<fcl::Triangle> triangles;
};

/// A sheet at the height 0.
Mesh sheet() {
  Mesh mesh;
  constexpr std::size_t kQuads = 20;
  for (std::size_t i = 0; i <= kQuads; ++i)
    for (std::size_t j = 0; j <= kQuads; ++j)
      mesh.vertices.emplace_back(4 * double(i) / kQuads - 2, 4 * double(j) / kQuads - 2,
                                 0);
  for (std::size_t i = 0; i < kQuads; ++i)
    for (std::size_t j = 0; j < kQuads; ++j) {
      const std::size_t v = i * (kQuads + 1) + j;
      mesh.triangles.emplace_back(v, v + kQuads + 1, v + 1);
      mesh.triangles.emplace_back(v + 1, v + kQuads + 1, v + kQuads + 2);
    }
  return mesh;
}

/// A block that turns about the z axis, at a time.
Mesh block(double time) {
  Mesh mesh;
  const double c = std::cos(2 * time), s = std::sin(2 * time);
  for (int i = 0; i < 8; ++i) {
    const double x = i & 1 ? .3 : -.3, y = i & 2 ? .2 : -.2, z = i & 4 ? .5 : .2;
    mesh.vertices.emplace_back(static_cast<float>(c * x - s * y),
                               static_cast<float>(s * x + c * y), static_cast<float>(z));
  }
  const std::size_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.emplace_back(q[0], q[1], q[2]);
    mesh.triangles.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

struct Outcome {
  std::size_t unanswered{0};
  double queries{0}, milliseconds{0};  // a step
  double lowest{0};
};

Outcome simulate(bool is_continuous, int frequency, int steps, int resolution) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity({0, 0, -10});
  world.getWorldInfo().m_gravity = {0, 0, -10};
  world.getWorldInfo().m_sparsesdf.Initialize();

  const Mesh floor = sheet();
  btTriangleMesh triangles;
  for (const fcl::Triangle& t : floor.triangles) {
    btVector3 p[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const fcl::Vector3d& x = floor.vertices[t[k]];
      p[k] = {float(x.x()), float(x.y()), float(x.z())};
    }
    triangles.addTriangle(p[0], p[1], p[2]);
  }
  btBvhTriangleMeshShape shape(&triangles, true);
  btRigidBody ground(0, nullptr, &shape);
  world.addRigidBody(&ground);

  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-1, -1, 1},
                                                     {1, -1, 1}, {-1, 1, 1}, {1, 1, 1},
                                                     resolution, resolution, 0, true);
  cloth->getCollisionShape()->setMargin(.01f);
  cloth->setTotalMass(1);
  cloth->m_cfg.piterations = 4;
  // A little uneven, or all of it would meet the sheet at one time.
  for (int i = 0; i < cloth->m_nodes.size(); ++i)
    cloth->m_nodes[i].m_x.setZ(1 + .05f * std::sin(3 * cloth->m_nodes[i].m_x.x() +
                                                   2 * cloth->m_nodes[i].m_x.y()));
  cloth->setVelocity({0, 0, -6});
  world.addSoftBody(cloth);

  ContinuousCloth continuous(*cloth, 5e-3);
  continuous.addObstacle(floor.vertices, floor.triangles);
  continuous.addObstacle(block(0).vertices, block(0).triangles);
  fcl::DeformableBVHModel<> all;  // of cloth and obstacles, to count
  Positions before = continuous.positions();
  Outcome outcome;
  const auto secondsNow = [] {
    return std::chrono::duration<double>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
  for (int step = 0; step < steps; ++step) {
    const float time = 1.f / static_cast<float>(frequency);
    Positions obstacles = floor.vertices;
    const Positions turned = block(double(time) * (step + 1)).vertices;
    obstacles.insert(obstacles.end(), turned.begin(), turned.end());
    const double begin = secondsNow();
    if (is_continuous) {
      const contact_response::Report report = continuous.step(world, time, obstacles);
      outcome.queries += double(report.queries) / steps;
    } else {
      world.stepSimulation(time, 0);
    }
    outcome.milliseconds += 1e3 * (secondsNow() - begin) / steps;

    Positions now = before;
    for (int i = 0; i < cloth->m_nodes.size(); ++i) {
      const btVector3& x = cloth->m_nodes[i].m_x;
      now[std::size_t(i)] = {double(x.x()), double(x.y()), double(x.z())};
    }
    const std::size_t nodes = std::size_t(cloth->m_nodes.size());
    for (std::size_t i = 0; i < obstacles.size(); ++i)
      now[nodes + i] = is_continuous ? continuous.positions()[nodes + i] : obstacles[i];
    if (step == 0) {
      std::vector<fcl::Triangle> faces;
      for (int i = 0; i < cloth->m_faces.size(); ++i)
        faces.emplace_back(std::size_t(cloth->m_faces[i].m_n[0] - &cloth->m_nodes[0]),
                           std::size_t(cloth->m_faces[i].m_n[1] - &cloth->m_nodes[0]),
                           std::size_t(cloth->m_faces[i].m_n[2] - &cloth->m_nodes[0]));
      std::size_t first = nodes;
      for (const Mesh& mesh : {floor, block(0)}) {
        for (const fcl::Triangle& t : mesh.triangles)
          faces.emplace_back(first + t[0], first + t[1], first + t[2]);
        first += mesh.vertices.size();
      }
      all.beginModel();
      all.addSubModel(before, faces);
      all.endModel(fcl::FclTree::kSkip);
    }
    all.updateFrames(before[0].data(), now[0].data(), now.size());
    fcl::ContinuousContactResultd found;
    fcl::continuousSelfCollide(&all, fcl::ContinuousContactRequestd(), found);
    outcome.unanswered += found.contacts.size() + (found.initially_crossing ? 1 : 0);
    before = now;
  }
  // Above or below the sheet, which is 4 wide.
  outcome.lowest = 1;
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    const btVector3& x = cloth->m_nodes[i].m_x;
    if (std::abs(x.x()) < 2 && std::abs(x.y()) < 2)
      outcome.lowest = std::min(outcome.lowest, double(x.z()));
  }
  world.removeSoftBody(cloth);
  delete cloth;
  world.removeRigidBody(&ground);
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 60;
  const int resolution = argc > 2 ? std::atoi(argv[2]) : 21;
  bool is_right = true;
  for (const int frequency : {60, 240}) {
    const Outcome without = simulate(false, frequency, steps, resolution),
                  with = simulate(true, frequency, steps, resolution);
    std::printf(
        "%3d Hz, %d steps, contacts that are not answered: Bullet %zu, lowest point at "
        "%.3f; with the continuous step %zu, at %.3f\n",
        frequency, steps, without.unanswered, without.lowest, with.unanswered,
        with.lowest);
    std::printf("  %.1f queries, %.2f ms a step, %.2f without\n", with.queries,
                with.milliseconds, without.milliseconds);
    is_right &= without.unanswered > 0 && with.unanswered == 0 && with.lowest > 0;
  }
  return is_right ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
//
// A cloth of Bullet that is thrown at a sheet of triangles without thickness, where a
// rigid body of triangles turns, and one that falls on its edge and folds onto itself: by
// Bullet alone, and with the continuous step around it. Contacts on the way that was
// taken, which nobody answered, are counted by the exact query.
//   example_thrown_cloth [STEPS] [VERTICES OF A SIDE] [FOLDER FOR THE LAST FRAMES]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "continuous_cloth.h"
#include "obj_file.h"

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

/// A block above the sheet, in its own coordinates.
Mesh block() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? .3 : -.3, i & 2 ? .2 : -.2, i & 4 ? .5 : .2);
  const std::size_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.emplace_back(q[0], q[1], q[2]);
    mesh.triangles.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

/// It turns about the z axis.
btTransform poseOfBlock(double time) {
  return btTransform(btQuaternion({0, 0, 1}, static_cast<float>(2 * time)));
}

btVector3 vectorOf(const fcl::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()),
          static_cast<float>(p.z())};
}

/// A rigid body of triangles.
struct MeshBody {
  MeshBody(btDynamicsWorld& world, const Mesh& mesh) : world(world), mesh(mesh) {
    for (const fcl::Triangle& t : mesh.triangles)
      triangles.addTriangle(vectorOf(mesh.vertices[t[0]]), vectorOf(mesh.vertices[t[1]]),
                            vectorOf(mesh.vertices[t[2]]));
    shape = std::make_unique<btBvhTriangleMeshShape>(&triangles, true);
    body = std::make_unique<btRigidBody>(0.f, nullptr, shape.get());
    body->setCollisionFlags(body->getCollisionFlags() |
                            btCollisionObject::CF_KINEMATIC_OBJECT);
    world.addRigidBody(body.get());
  }
  ~MeshBody() { world.removeRigidBody(body.get()); }

  /// Moves it, and adds its vertices there.
  void moveTo(const btTransform& pose, Positions& positions) {
    body->setWorldTransform(pose);
    for (const fcl::Vector3d& p : mesh.vertices) {
      const btVector3 x = pose * vectorOf(p);
      positions.emplace_back(x.x(), x.y(), x.z());
    }
  }

  btDynamicsWorld& world;
  Mesh mesh;
  btTriangleMesh triangles;
  std::unique_ptr<btBvhTriangleMeshShape> shape;
  std::unique_ptr<btRigidBody> body;
};

enum class Scene { kThrown, kOnEdge };

struct Outcome {
  std::size_t unanswered{0};
  double queries{0}, milliseconds{0}, milliseconds_of_contacts{0};  // a step
  double lowest{0};
};

/// A cloth 2 wide and 1 above the sheet.
btSoftBody* makeCloth(btSoftRigidDynamicsWorld& world, Scene scene, int resolution) {
  const bool is_flat = scene == Scene::kThrown;
  const btVector3 far = is_flat ? btVector3(0, 2, 0) : btVector3(0, 0, 2),
                  corner(-1, is_flat ? -1.f : .9f, is_flat ? 1.f : .2f), wide(2, 0, 0);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(
      world.getWorldInfo(), corner, corner + wide, corner + far, corner + wide + far,
      resolution, resolution, 0, true);
  cloth->getCollisionShape()->setMargin(.01f);
  cloth->setTotalMass(1);
  cloth->m_cfg.piterations = 4;
  // A little uneven, or all of it would meet the sheet at one time, and fold nowhere.
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    btVector3& x = cloth->m_nodes[i].m_x;
    x += .05f * std::sin(3 * x.x() + 2 * (is_flat ? x.y() : x.z())) *
         (is_flat ? btVector3(0, 0, 1) : btVector3(0, 1, 0));
  }
  cloth->setVelocity({0, 0, -6});
  world.addSoftBody(cloth);
  return cloth;
}

Outcome simulate(bool is_continuous, Scene scene, int frequency, int steps,
                 int resolution, const std::string& path) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity({0, 0, -10});
  world.getWorldInfo().m_gravity = {0, 0, -10};
  world.getWorldInfo().m_sparsesdf.Initialize();
  MeshBody floor(world, sheet()), turning(world, block());
  btSoftBody* cloth = makeCloth(world, scene, resolution);

  ContinuousCloth continuous(*cloth, 5e-3);
  for (const MeshBody* body : {&floor, &turning})
    continuous.addObstacle(body->mesh.vertices, body->mesh.triangles);
  fcl::DeformableBVHModel<> all;  // of cloth and obstacles, to count
  all.beginModel();
  all.addSubModel(continuous.positions(), continuous.triangles());
  all.endModel(fcl::FclTree::kSkip);
  Positions before = continuous.positions();
  Outcome outcome;
  const auto secondsNow = [] {
    return std::chrono::duration<double>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
  const float time = 1.f / static_cast<float>(frequency);
  for (int step = 0; step < steps; ++step) {
    Positions obstacles;
    floor.moveTo(btTransform::getIdentity(), obstacles);
    turning.moveTo(poseOfBlock(double(time) * (step + 1)), obstacles);
    const double begin = secondsNow();
    if (is_continuous) {
      const contact_response::Report report = continuous.step(world, time, obstacles);
      outcome.queries += double(report.queries) / steps;
      outcome.milliseconds_of_contacts += 1e3 * continuous.secondsOfContacts() / steps;
    } else {
      world.stepSimulation(time, 0);
    }
    outcome.milliseconds += 1e3 * (secondsNow() - begin) / steps;

    Positions now;
    for (int i = 0; i < cloth->m_nodes.size(); ++i) {
      const btVector3& x = cloth->m_nodes[i].m_x;
      now.emplace_back(x.x(), x.y(), x.z());
    }
    now.insert(now.end(), obstacles.begin(), obstacles.end());
    // An obstacle may have stopped.
    if (is_continuous) now = continuous.positions();
    all.updateFrames(before[0].data(), now[0].data(), now.size());
    fcl::ContinuousContactResultd found;
    fcl::continuousSelfCollide(&all, fcl::ContinuousContactRequestd(), found);
    outcome.unanswered += found.contacts.size() + (found.initially_crossing ? 1 : 0);
    before = now;
  }
  if (!path.empty()) {
    ObjFile file;
    file.addMesh(before, continuous.triangles());
    file.write(path);
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
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 60;
  const int resolution = argc > 2 ? std::atoi(argv[2]) : 21;
  const std::string folder = argc > 3 ? argv[3] : "";
  bool is_right = true;
  for (const Scene scene : {Scene::kThrown, Scene::kOnEdge})
    for (const int frequency : {60, 240}) {
      const std::string name = scene == Scene::kThrown ? "thrown" : "on its edge";
      const auto run = [&](bool is_continuous) {
        const std::string path =
            folder.empty()
                ? ""
                : folder + (scene == Scene::kThrown ? "/thrown_" : "/on_edge_") +
                      std::to_string(frequency) +
                      (is_continuous ? "_with.obj" : "_without.obj");
        return simulate(is_continuous, scene, frequency, steps, resolution, path);
      };
      const Outcome without = run(false), with = run(true);
      std::printf(
          "%s, %d Hz, %d steps, contacts that are not answered: Bullet %zu, lowest point "
          "at %.3f; with the continuous step %zu, at %.3f\n",
          name.c_str(), frequency, steps, without.unanswered, without.lowest,
          with.unanswered, with.lowest);
      std::printf(
          "  %.1f queries, %.2f ms a step, %.2f of them for contacts, %.2f ms without\n",
          with.queries, with.milliseconds, with.milliseconds_of_contacts,
          without.milliseconds);
      is_right &= without.unanswered > 0 && with.unanswered == 0 && with.lowest > 0;
    }
  return is_right ? 0 : 1;
}

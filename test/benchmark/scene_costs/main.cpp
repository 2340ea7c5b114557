// SPDX-License-Identifier: BSD-3-Clause
//
//   fcl_ccd_scene_costs > scene.csv
//
// What each kind of object of a scene costs, and each option of a manager, off and on:
// bytes for each triangle beyond those of FCL's own model, and nanoseconds for each
// triangle of an update and of a query. doc/broad_phase.md explains the columns.
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "machine.h"
#include "mesh_generators.h"
#include "moving_objects.h"
#include "test_models.h"
#include "timing.h"

namespace {

using namespace fcl::test;
using Object = fcl::ContinuousCollisionObject<double>;
using Manager = fcl::ContinuousCollisionManager<double>;
using Request = fcl::ContinuousContactRequest<double>;
using Result = fcl::ContinuousManagerResult<double>;
using Vector = fcl::Vector3<double>;
using FclModel = fcl::BVHModel<fcl::OBBRSS<double>>;
using Model = fcl::DeformableBVHModel<fcl::OBBRSS<double>>;
using Motion = std::shared_ptr<fcl::MotionBase<double>>;

constexpr int kRuns = 15;

double bytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return double(info.uordblks) + double(info.hblkhd);
}

/// Waves over a square about the origin.
TestMesh makeGround(int n, double edge, double height) {
  return makeSheet(n, n, [=](double u, double v) -> Vector {
    const double x = edge * (u - .5), y = edge * (v - .5);
    return {x, y, height + .02 * std::sin(5 * x) * std::cos(4 * y)};
  });
}

template <typename AnyModel>
std::shared_ptr<AnyModel> modelOf(const TestMesh& mesh) {
  auto model = std::make_shared<AnyModel>();
  model->beginModel(int(mesh.triangles.size()), int(mesh.vertices.size()));
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

enum class Kind { kStatic, kRigid, kTurning, kDeforming };

constexpr const char* kNames[] = {"static", "rigid", "turning", "deforming"};

/// A mesh that comes down by a twentieth, unless it is static.
struct Body {
  Kind kind;
  TestMesh mesh;
  std::shared_ptr<fcl::CollisionGeometry<double>> geometry;
  std::unique_ptr<Object> object;

  Body(Kind kind_of_body, TestMesh mesh_of_body)
      : kind(kind_of_body), mesh(std::move(mesh_of_body)) {
    if (kind == Kind::kDeforming)
      geometry = modelOf<Model>(mesh);
    else
      geometry = modelOf<FclModel>(mesh);
    object = makeObject(geometry, motion());
    step();
  }

  std::size_t size() const { return mesh.triangles.size(); }
  /// Beyond those of a BVHModel that has the same frames.
  double modelBytes() const {
    if (kind != Kind::kDeforming) return 0;
    return double(static_cast<const Model&>(*geometry).deformableMemUsage());
  }
  /// The next frame of a mesh that deforms.
  void step() const {
    if (kind != Kind::kDeforming) return;
    std::vector<double> previous, current;
    for (const Vector& p : mesh.vertices) {
      previous.insert(previous.end(), p.data(), p.data() + 3);
      current.insert(current.end(), {p[0], p[1], p[2] - .05 * (1 + .1 * p[0])});
    }
    static_cast<Model&>(*geometry).updateFrames(previous.data(), current.data(),
                                                mesh.vertices.size());
  }

 private:
  Motion motion() const {
    const Vector from(0, 0, 0), to(0, 0, -.05);
    if (kind == Kind::kRigid) return translation(from, to);
    if (kind != Kind::kTurning) return translation(from, from);
    const fcl::AngleAxis<double> turn(.02, Vector::UnitZ());
    return std::make_shared<fcl::InterpMotion<double>>(
        fcl::Matrix3<double>::Identity(), from, turn.toRotationMatrix(), to, from);
  }
};

/// An option of a manager, a request or an answer.
struct Option {
  const char* name;
  std::function<void(Manager&, Object*)> set;
  std::function<void(Request&)> ask;
  bool tracks{false};
};

const std::vector<Option>& options() {
  static const std::vector<Option> all = {
      {"none", {}, {}},
      {"self_collision",
       [](Manager& manager, Object* o) { manager.setSelfCollision(o, true); },
       {}},
      {"thickness",
       [](Manager& manager, Object* o) { manager.setThickness(o, 1e-3); },
       {}},
      {"approach_speed",
       [](Manager& manager, Object* o) { manager.setMinApproachSpeed(o, 1e-3); },
       {}},
      {"groups",
       [](Manager& manager, Object* o) {
         fcl::ContinuousGroups groups;
         groups.set(1, 2, false);
         manager.setFilter(o, groups.filterOf(1));
       },
       {}},
      {"persistence", {}, {}, true},
      {"first_contact", {}, [](Request& r) { r.query = fcl::ContinuousQuery::kFirst; }}};
  return all;
}

struct Cost {
  double bytes{0}, update{0}, query{0};
  std::size_t contacts{0};
};

Cost measure(const Body& body, const Body& other, const Option& option) {
  Cost cost;
  const double before = bytesInUse();
  Manager manager;
  fcl::PersistentPairs<double> tracked;
  manager.registerObjects({body.object.get(), other.object.get()});
  if (option.set) option.set(manager, body.object.get());
  Request request;
  if (option.ask) option.ask(request);
  Result result;
  cost.update = cost.query = std::numeric_limits<double>::infinity();
  for (int run = 0; run < kRuns; ++run) {
    const double update = cpuMillisecondsOf([&] {
      body.step();
      manager.update(body.object.get());
    });
    const double query = cpuMillisecondsOf([&] {
      manager.collide(request, result);
      if (option.tracks) tracked.update(result);
    });
    cost.update = std::min(cost.update, update);
    cost.query = std::min(cost.query, query);
  }
  for (const auto& pair : result.pairs) cost.contacts += pair.result.contacts.size();
  result = Result();
  cost.bytes = bytesInUse() - before;
  return cost;
}

void print(const Body& body, const Body& other, const Option& option) {
  const auto size = double(body.size());
  const Cost cost = measure(body, other, option);
  std::printf("%s,%zu,%zu,%s,%.1f,%.1f,%.2f,%.2f,%zu\n", kNames[int(body.kind)],
              body.size(), other.size(), option.name, body.modelBytes() / size,
              cost.bytes / size, 1e6 * cost.update / size, 1e6 * cost.query / size,
              cost.contacts);
  std::fflush(stdout);
}

/// The triangles that have a vertex in the square of a half edge.
TestMesh partOf(const TestMesh& mesh, double half) {
  TestMesh part;
  std::map<std::size_t, std::size_t> ids;
  const auto isInside = [&](std::size_t id) {
    const Vector& p = mesh.vertices[id];
    return std::abs(p[0]) <= half && std::abs(p[1]) <= half;
  };
  for (const fcl::Triangle& t : mesh.triangles) {
    if (!isInside(t[0]) && !isInside(t[1]) && !isInside(t[2])) continue;
    std::size_t corner[3];
    for (int k = 0; k < 3; ++k) {
      const auto entry = ids.emplace(t[k], part.vertices.size());
      if (entry.second) part.vertices.push_back(mesh.vertices[t[k]]);
      corner[k] = entry.first->second;
    }
    part.triangles.emplace_back(corner[0], corner[1], corner[2]);
  }
  return part;
}

}  // namespace

int main() {
  std::printf(
      "kind,triangles,other_triangles,option,model_bytes_per_triangle,"
      "option_bytes_per_triangle,update_ns_per_triangle,query_ns_per_triangle,"
      "contacts\n");
  // A ball stands in the middle. The bodies come down to it from above.
  TestMesh round = makeIcosphere(3, .1);
  for (Vector& p : round.vertices) p[2] -= .125;
  const Body ball(Kind::kStatic, round), falling(Kind::kRigid, moved(round, 0, 0, .25));
  for (const Kind kind :
       {Kind::kStatic, Kind::kRigid, Kind::kTurning, Kind::kDeforming}) {
    const Body body(kind, makeGround(100, 1, 0));
    for (const Option& option : options())
      print(body, kind == Kind::kStatic ? falling : ball, option);
  }
  // A cloth of 20,000 triangles comes down on a part of a large ground.
  const TestMesh ground = makeGround(707, 20, -.02);
  const Body cloth(Kind::kDeforming, makeGround(100, 1, 0));
  for (const TestMesh& mesh : {partOf(ground, .6), ground}) {
    const Body below(Kind::kStatic, mesh);
    print(cloth, below, options().front());
    print(cloth, below, options().back());
  }
  std::fprintf(stderr, "%s\n", machineName().c_str());
}

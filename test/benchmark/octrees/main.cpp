// SPDX-License-Identifier: BSD-3-Clause
//
// Speed and errors of queries of a mesh and a map of a million occupied cells, beside
// FCL's method. doc/broad_phase.md explains the report.
#include <octomap/octomap.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "machine.h"
#include "mesh_generators.h"
#include "posed_shape.h"
#include "timing.h"

namespace {

using namespace fcl::test;
using Geometry = std::shared_ptr<fcl::CollisionGeometry<double>>;
using Motion = fcl::InterpMotion<double>;
using Pose = fcl::Transform3<double>;
using Vector = fcl::Vector3<double>;

constexpr double kCell = 0.05;
/// Columns of the map along x and along y. Each has one occupied cell.
constexpr int kColumns = 1000;
constexpr double kNever = 2;
constexpr double kTocErr = 1e-4;
/// The reference may be early by its `toc_err` of 1e-9.
constexpr double kTimeError = 1e-8;

enum class Map { kHills, kFlat };
enum class Body { kBall, kSheet, kCloth };

struct Scene {
  const char* name;
  Map map;
  Body body;
  bool touches, turns;
};

constexpr Scene kScenes[] = {
    {"ball_over_hills", Map::kHills, Body::kBall, false, false},
    {"ball_over_hills", Map::kHills, Body::kBall, false, true},
    {"ball_close_over_flat", Map::kFlat, Body::kBall, false, false},
    {"ball_close_over_flat", Map::kFlat, Body::kBall, false, true},
    {"ball_into_hills", Map::kHills, Body::kBall, true, false},
    {"ball_into_hills", Map::kHills, Body::kBall, true, true},
    {"sheet_onto_hills", Map::kHills, Body::kSheet, true, false},
    {"sheet_onto_hills", Map::kHills, Body::kSheet, true, true},
    {"cloth_onto_hills", Map::kHills, Body::kCloth, true, false},
    {"sheet_onto_flat", Map::kFlat, Body::kSheet, true, false},
    {"sheet_onto_flat", Map::kFlat, Body::kSheet, true, true}};

/// The height of the cell of a column, in cells.
int heightOf(Map map, int x, int y) {
  if (map == Map::kFlat) return 0;
  return static_cast<int>(std::lround(12 * std::sin(0.021 * x) * std::cos(0.017 * y) +
                                      4 * std::sin(0.13 * x + 0.1 * y)));
}

Vector centerOf(Map map, int x, int y) {
  return kCell * Vector(x + 0.5, y + 0.5, heightOf(map, x, y) + 0.5);
}

Geometry makeMap(Map map) {
  const auto cells = std::make_shared<octomap::OcTree>(kCell);
  for (int x = 0; x < kColumns; ++x)
    for (int y = 0; y < kColumns; ++y) {
      const Vector c = centerOf(map, x, y);
      cells->updateNode(
          octomap::point3d(static_cast<float>(c[0]), static_cast<float>(c[1]),
                           static_cast<float>(c[2])),
          true, true);
    }
  cells->updateInnerOccupancy();
  return std::make_shared<fcl::OcTree<double>>(cells);
}

Geometry modelOf(const TestMesh& mesh) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

/// 5,000 triangles.
Geometry makeBody(Body body) {
  if (body == Body::kBall) {
    TestMesh ball = makeUvSphere(50, 51, 0.5);
    for (auto& p : ball.vertices) p *= 1 + 0.1 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
    return modelOf(ball);
  }
  const auto sheet = [](double wave) {
    return makeSheet(50, 50, [wave](double u, double v) {
      return Vector(u - 0.5, v - 0.5, wave * std::sin(8 * u) * std::cos(6 * v));
    });
  };
  if (body == Body::kSheet) return modelOf(sheet(0));
  const auto cloth = std::make_shared<fcl::DeformableBVHModel<>>();
  cloth->beginModel();
  cloth->addSubModel(sheet(0).vertices, sheet(0).triangles);
  cloth->endModel();
  cloth->beginUpdateModel();
  cloth->updateSubModel(sheet(0.1).vertices);
  cloth->endUpdateModel();
  return cloth;
}

/// The surfaces of the cells in reach of a path, as a mesh: the reference, a query of two
/// meshes.
Geometry cellsNear(Map map, const Vector& from, const Vector& to) {
  constexpr double kReach = 0.9;
  const auto column = [](double x) {
    return std::clamp(static_cast<int>(std::floor(x / kCell)), 0, kColumns - 1);
  };
  TestMesh mesh;
  const TestMesh box = makeBox(Vector::Constant(kCell / 2));
  const Vector lo = from.cwiseMin(to).array() - kReach,
               hi = from.cwiseMax(to).array() + kReach;
  for (int x = column(lo[0]); x <= column(hi[0]); ++x)
    for (int y = column(lo[1]); y <= column(hi[1]); ++y) {
      const Vector c = centerOf(map, x, y);
      append(mesh, transformed(box, Pose(fcl::Translation3<double>(c))));
    }
  return modelOf(mesh);
}

struct Query {
  Vector from, to;
  fcl::Matrix3<double> turn_from, turn_to;

  Motion motion() const {
    return Motion(turn_from, from, turn_to, to, Vector(Vector::Zero()));
  }
};

Query makeQuery(const Scene& scene, Random& random) {
  Query query;
  const double edge = kCell * kColumns;
  query.from = Vector(random.uniform(2, edge - 4), random.uniform(2, edge - 4), 0);
  const auto ground = [&](const Vector& p) {
    return kCell * heightOf(scene.map, static_cast<int>(p[0] / kCell),
                            static_cast<int>(p[1] / kCell));
  };
  query.to = query.from + Vector(random.uniform(-1, 1), random.uniform(-1, 1), 0);
  const bool is_flat = scene.map == Map::kFlat;
  // Hills rise by at most 0.9 along the path and under the body. The ball is inside a
  // sphere of radius 0.55.
  const auto height = [&] {
    const bool is_close = is_flat && !scene.touches;
    return is_close ? kCell + 0.56 : random.uniform(1.5, 2);
  };
  query.from[2] = ground(query.from) + height();
  query.to[2] = ground(query.to) + (scene.touches ? -0.2 : height());
  const auto rotation = [&](double angle) {
    const Vector axis = is_flat ? Vector(Vector::UnitZ()) : randomDirection(random);
    return fcl::AngleAxis<double>(angle, axis).toRotationMatrix();
  };
  query.turn_from = rotation(random.uniform(0, 3));
  query.turn_to =
      scene.turns ? rotation(random.uniform(0, 1)) * query.turn_from : query.turn_from;
  return query;
}

enum class Method { kTime, kFirst, kAny, kStock };
constexpr const char* kMethods[] = {"fcl-ccd-time", "fcl-ccd-first", "fcl-ccd-any",
                                    "FCL-naive-10"};

double ask(Method method, const Geometry& body, const Motion& path, const Geometry& map,
           double toc_err) {
  const Pose here = Pose::Identity();
  const Motion moving(path), rest(here, here);
  if (method == Method::kTime || method == Method::kStock) {
    fcl::ContinuousCollisionRequest<double> request;
    request.toc_err = toc_err;
    fcl::ContinuousCollisionResult<double> result;
    if (method == Method::kStock)
      fcl::continuousCollide<double>(body.get(), &moving, map.get(), &rest, request,
                                     result);
    else
      continuousCollide(body.get(), &moving, map.get(), &rest, request, result);
    return result.is_collide ? double{result.time_of_contact} : kNever;
  }
  fcl::ContinuousContactRequest<double> request;
  request.toc_err = toc_err;
  request.query = method == Method::kFirst ? fcl::ContinuousQuery::kFirst
                                           : fcl::ContinuousQuery::kAny;
  fcl::ContinuousContactResult<double> result;
  continuousCollide(body.get(), &moving, map.get(), &rest, request, result);
  return result.is_collide ? double{result.time_of_contact} : kNever;
}

struct Row {
  int contacts{0}, missed{0}, late{0}, invented{0};
  double max_early{0};
  std::vector<double> times;

  void add(double truth, double time, bool is_any) {
    contacts += truth != kNever;
    missed += truth != kNever && time == kNever;
    invented += truth == kNever && time != kNever;
    if (truth == kNever || time == kNever || is_any) return;
    late += time > truth + kTimeError;
    max_early = std::max(max_early, truth - time);
  }
};

void measure(const Scene& scene, const Geometry& map, int num_queries, std::FILE* out) {
  const Geometry body = makeBody(scene.body);
  std::array<Row, 4> rows;
  Random random(7);
  for (int i = 0; i < num_queries; ++i) {
    const Query query = makeQuery(scene, random);
    const Motion motion = query.motion();
    const double truth = ask(Method::kTime, body, motion,
                             cellsNear(scene.map, query.from, query.to), 1e-9);
    for (const Method method :
         {Method::kTime, Method::kFirst, Method::kAny, Method::kStock}) {
      double time = kNever;
      Row& row = rows[static_cast<std::size_t>(method)];
      const double ms =
          leastMilliseconds(3, [&] { time = ask(method, body, motion, map, kTocErr); });
      row.times.push_back(ms);
      row.add(truth, time, method == Method::kAny);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row& row = rows[i];
    std::sort(row.times.begin(), row.times.end());
    std::fprintf(out, "%s,%s,%s,%zu,%d,%d,%d,%d,%.2g,%.4f,%.4f,%s\n", scene.name,
                 scene.turns ? "turning" : "straight", kMethods[i], row.times.size(),
                 row.contacts, row.missed, row.late, row.invented, row.max_early,
                 row.times[row.times.size() / 2], row.times.back(),
                 machineName().c_str());
  }
  std::fflush(out);
}

void run(int num_queries, const std::string& folder) {
  std::filesystem::create_directories(folder);
  std::FILE* out = std::fopen((folder + "/octrees.csv").c_str(), "w");
  if (!out) throw std::runtime_error("cannot write " + folder + "/octrees.csv");
  std::fprintf(out,
               "scene,motion,method,queries,contacts,missed,late,false,max_early,"
               "ms_median,ms_max,machine\n");
  const Geometry hills = makeMap(Map::kHills), flat = makeMap(Map::kFlat);
  for (const Scene& scene : kScenes)
    measure(scene, scene.map == Map::kFlat ? flat : hills, num_queries, out);
  std::fclose(out);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Speed and errors of queries of a mesh and an octree");
  std::string folder;
  int queries = 100;
  app.add_option("folder", folder, "where the table goes")->required();
  app.add_option("--queries", queries, "for each scene")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(queries, folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_ccd_octrees: %s\n", error.what());
    return 1;
  }
  return 0;
}

// SPDX-License-Identifier: BSD-3-Clause
//
// Runs `fcl-ccd run` on scene files of many objects. Random scenes are answered a second
// time by calls of the library.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ccd_json.h"
#include "ccd_tool.h"
#include "csv_rows.h"
#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/AABB.h"
#include "mesh_generators.h"
#include "output_lock.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;
using fcl::ContinuousQuery;
using fcl::Transform3d;
using fcl::Vector3d;
using Contact = fcl::ContinuousContactd;
using Object = fcl::ContinuousCollisionObjectd;
using Manager = fcl::ContinuousCollisionManagerd;
using Model = fcl::DeformableBVHModel<fcl::AABBd>;
using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

constexpr const char* kColumns = "step,o1,o2,kind,b1,b2,toc_lo,toc_hi,x,y,z,nx,ny,nz";
const std::map<std::string, ContinuousQuery> kQueries{{"all", ContinuousQuery::kAll},
                                                      {"first", ContinuousQuery::kFirst},
                                                      {"any", ContinuousQuery::kAny}};

Json toJson(const Vector3d& v) { return {v[0], v[1], v[2]}; }

std::string exact(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

Mesh toFile(const TestMesh& mesh) {
  Mesh out;
  for (const Vector3d& p : mesh.vertices) out.vertices.push_back({p[0], p[1], p[2]});
  for (const fcl::Triangle& t : mesh.triangles)
    out.triangles.push_back(
        {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return out;
}

/// An object as a program makes it.
struct DirectObject {
  std::string name;
  Geometry geometry;
  std::shared_ptr<Model> model;  ///< of a mesh
  TestMesh mesh;                 ///< its vertices, or those of its first frame
  std::vector<TestMesh> frames;  ///< of a mesh that deforms
  std::vector<Transform3d> poses;
  int group{0};
  double thickness{0}, speed{0};
  bool self{false};
  std::unique_ptr<Object> object;

  std::shared_ptr<fcl::MotionBased> motion(std::size_t step) const {
    const bool moves = poses.size() > 1;
    return fcl::detail::makeMotionBetween<double>(poses[moves ? step : 0],
                                                  poses[moves ? step + 1 : 0]);
  }
};

/// A row of the contact list, without the names and numbers of the pair.
std::string rowOf(const Contact& c, const DirectObject& o1, const DirectObject& o2) {
  static const std::map<fcl::ContinuousContactKind, std::string> kinds{
      {fcl::ContinuousContactKind::kVertexFace, "vf"},
      {fcl::ContinuousContactKind::kEdgeEdge, "ee"},
      {fcl::ContinuousContactKind::kCrossing, "crossing"},
      {fcl::ContinuousContactKind::kVertexEdge, "ve"},
      {fcl::ContinuousContactKind::kVertexVertex, "vv"},
      {fcl::ContinuousContactKind::kVertexShape, "vs"},
      {fcl::ContinuousContactKind::kEdgeShape, "es"},
      {fcl::ContinuousContactKind::kFaceShape, "fs"},
      {fcl::ContinuousContactKind::kShapes, "ss"}};
  const auto part = [](std::intptr_t b) { return b < 0 ? "" : std::to_string(b); };
  std::string row = o1.name + ',' + o2.name + ',' + kinds.at(c.kind) + ',' + part(c.b1) +
                    ',' + part(c.b2) + ',' + exact(c.toc_lo) + ',' + exact(c.toc_hi);
  for (int k = 0; k < 3; ++k) row += ',' + exact(c.pos[k]);
  for (int k = 0; k < 3; ++k) row += ',' + exact(c.normal[k]);
  return row;
}

/// Random objects of all kinds: their file, and the same objects for the library.
class RandomScene {
 public:
  static constexpr std::size_t kSteps = 3;

  RandomScene(std::uint64_t seed, const fs::path& folder)
      : random_(seed), folder_(folder) {
    const bool is_thick = random_.index(2) == 0;
    for (std::size_t i = 0; i < 12; ++i) add(i, is_thick);
    if (random_.index(2) == 0)
      for (int i = 0; i < 3; ++i) {
        const int a = static_cast<int>(random_.index(3)),
                  b = static_cast<int>(random_.index(3));
        groups_.set(a, b, false);
        file["groups_apart"].push_back({a, b});
      }
    if (is_thick) addPairDistances();
    writeText(folder_ / "scene.json", file.dump(1));
  }

  /// The rows of the contact list for the manager.
  std::vector<std::string> answer(ContinuousQuery query) {
    Manager manager;
    prepare(manager);
    fcl::ContinuousContactRequestd request = requestOf(query);
    std::vector<std::string> rows;
    for (std::size_t step = 0; step < kSteps; ++step) {
      move(manager, step);
      fcl::ContinuousManagerResultd result;
      manager.collide(request, result);
      for (const auto& pair : result.pairs)
        addRows(step, of(pair.o1), of(pair.o2), pair.result, rows);
    }
    return rows;
  }

  /// The same without a manager, for all contacts: each pair of objects by itself.
  std::vector<std::string> answerByPairs() {
    Manager manager;  // for the motions
    prepare(manager);
    std::vector<std::string> rows;
    for (std::size_t step = 0; step < kSteps; ++step) {
      move(manager, step);
      for (std::size_t i = 0; i < objects_.size(); ++i)
        for (std::size_t j = i; j < objects_.size(); ++j) addPair(step, i, j, rows);
    }
    return rows;
  }

  Json file;

 private:
  fcl::ContinuousContactRequestd requestOf(ContinuousQuery query) const {
    fcl::ContinuousContactRequestd request;
    request.query = query;
    request.toc_err = 1e-4;
    request.enable_crossings = query != ContinuousQuery::kAny;
    return request;
  }

  const DirectObject& of(const Object* object) const {
    return *std::find_if(objects_.begin(), objects_.end(),
                         [&](const DirectObject& o) { return o.object.get() == object; });
  }

  void addRows(std::size_t step, const DirectObject& o1, const DirectObject& o2,
               const fcl::ContinuousContactResultd& result,
               std::vector<std::string>& rows) const {
    std::vector<Contact> list = result.crossings;
    if (list.empty() && result.contacts.empty() && result.initially_crossing)
      list.push_back(result.crossing);
    list.insert(list.end(), result.contacts.begin(), result.contacts.end());
    for (const Contact& contact : list)
      rows.push_back(std::to_string(step) + ',' + rowOf(contact, o1, o2));
  }

  void addPair(std::size_t step, std::size_t i, std::size_t j,
               std::vector<std::string>& rows) const {
    const DirectObject &o1 = objects_[i], &o2 = objects_[j];
    if (i == j && !o1.self) return;
    if (i != j && !groups_.canMeet(o1.group, o2.group)) return;
    fcl::ContinuousContactRequestd request = requestOf(ContinuousQuery::kAll);
    const auto distance = distances_.find({i, j});
    request.min_distance =
        distance != distances_.end() ? distance->second : o1.thickness + o2.thickness;
    const auto is_straight_mesh = [](const DirectObject& o) {
      return o.model && dynamic_cast<const fcl::TranslationMotiond*>(
                            o.object->getMotion()) != nullptr;
    };
    if (is_straight_mesh(o1) && is_straight_mesh(o2))
      request.min_approach_speed = std::max(o1.speed, o2.speed);
    fcl::ContinuousContactResultd result;
    if (i == j)
      fcl::continuousSelfCollide(o1.geometry.get(), request, result);
    else
      fcl::collide(o1.object.get(), o2.object.get(), request, result);
    addRows(step, o1, o2, result, rows);
  }

  void prepare(Manager& manager) {
    for (DirectObject& o : objects_) {
      if (o.model) o.geometry = o.model = makeMesh(o.mesh);
      o.object = std::make_unique<Object>(o.geometry, o.motion(0));
      manager.registerObject(o.object.get());
      manager.setFilter(o.object.get(), groups_.filterOf(o.group));
      manager.setThickness(o.object.get(), o.thickness);
      manager.setMinApproachSpeed(o.object.get(), o.speed);
      if (o.self) manager.setSelfCollision(o.object.get(), true);
    }
    for (const auto& [pair, distance] : distances_)
      manager.setPairDistance(objects_[pair.first].object.get(),
                              objects_[pair.second].object.get(), distance);
  }

  void move(Manager& manager, std::size_t step) {
    for (DirectObject& o : objects_) {
      if (!o.frames.empty()) {
        const auto numbers = [](const TestMesh& mesh) { return mesh.vertices[0].data(); };
        ASSERT_EQ(
            o.model->updateFrames(numbers(o.frames[step]), numbers(o.frames[step + 1]),
                                  o.frames[step].vertices.size(), fcl::FclTree::kSkip),
            fcl::BVH_OK);
      }
      if (o.poses.size() > 1 || !o.frames.empty())
        manager.setMotion(o.object.get(), o.motion(step));
    }
  }

  static std::shared_ptr<Model> makeMesh(const TestMesh& mesh) {
    auto model = std::make_shared<Model>();
    EXPECT_EQ(model->beginModel(), fcl::BVH_OK);
    EXPECT_EQ(model->addSubModel(mesh.vertices, mesh.triangles), fcl::BVH_OK);
    EXPECT_EQ(model->endModel(fcl::FclTree::kSkip), fcl::BVH_OK);
    return model;
  }

  /// A sheet that is bent at random, and may cross itself.
  TestMesh sheet() {
    const Vector3d bend = random_.point(1);
    return makeSheet(4, 4, [&bend](double u, double v) {
      u -= .5;
      v -= .5;
      return Vector3d(u * (1 - std::abs(bend[2] * u)), v,
                      bend[0] * u * u + bend[1] * u * v + 3 * bend[2] * v * v * u);
    });
  }

  void addMesh(const std::string& name, Json& entry, DirectObject& o) {
    o.mesh = random_.index(2) == 0 ? makeIcosphere(1, .3) : makeBox({.4, .2, .1}, 2);
    writeText(folder_ / (name + ".obj"), toObj(toFile(o.mesh)));
    entry["mesh"] = name + ".obj";
    o.geometry = o.model = makeMesh(o.mesh);
  }

  void addFrames(const std::string& name, Json& entry, DirectObject& o) {
    fs::create_directory(folder_ / name);
    std::vector<std::string> files;
    for (std::size_t i = 0; i <= kSteps; ++i) {
      o.frames.push_back(sheet());
      files.push_back(name + "/f" + std::to_string(i) + ".ply");
      writeText(folder_ / files.back(), toBinaryPly<double>(toFile(o.frames[i]), false));
    }
    entry["frames"] = random_.index(2) == 0 ? Json(name) : Json(files);
    o.mesh = o.frames[0];
    o.geometry = o.model = makeMesh(o.mesh);
    o.self = random_.index(2) == 0;
    if (o.self) entry["self_collision"] = true;
  }

  void addOctree(const std::string& name, Json& entry, DirectObject& o) {
    octomap::OcTree map(.1);
    for (int i = 0; i < 20; ++i) {
      const auto middle = [&] { return .1f * (float(random_.index(8)) - 3.5f); };
      const float x = middle(), y = middle(), z = middle();
      map.updateNode(octomap::point3d(x, y, z), true);
    }
    const bool is_binary = random_.index(2) == 0;
    const std::string file = name + (is_binary ? ".bt" : ".ot");
    if (is_binary)
      map.writeBinary((folder_ / file).string());
    else
      map.write((folder_ / file).string());
    entry["octree"] = file;
    o.geometry = std::make_shared<fcl::OcTreed>(std::make_shared<octomap::OcTree>(map));
  }

  void addShape(Json& entry, DirectObject& o) {
    Json& shape = entry["shape"];
    const double r = random_.uniform(.1, .3), l = random_.uniform(.2, .6);
    const Vector3d sizes(r, l, random_.uniform(.1, .5));
    switch (random_.index(8)) {
      case 0:
        shape = {{"type", "sphere"}, {"radius", r}};
        o.geometry = std::make_shared<fcl::Sphered>(r);
        break;
      case 1:
        shape = {{"type", "box"}, {"sides", toJson(sizes)}};
        o.geometry = std::make_shared<fcl::Boxd>(sizes);
        break;
      case 2:
        shape = {{"type", "capsule"}, {"radius", r}, {"length", l}};
        o.geometry = std::make_shared<fcl::Capsuled>(r, l);
        break;
      case 3:
        shape = {{"type", "cylinder"}, {"radius", r}, {"length", l}};
        o.geometry = std::make_shared<fcl::Cylinderd>(r, l);
        break;
      case 4:
        shape = {{"type", "cone"}, {"radius", r}, {"length", l}};
        o.geometry = std::make_shared<fcl::Coned>(r, l);
        break;
      case 5:
        shape = {{"type", "ellipsoid"}, {"radii", toJson(sizes)}};
        o.geometry = std::make_shared<fcl::Ellipsoidd>(sizes);
        break;
      case 6: {
        auto corners = std::make_shared<std::vector<Vector3d>>(std::vector<Vector3d>{
            {-.2, -.2, -.1}, {.3, 0, -.1}, {-.1, .3, -.1}, {0, 0, .3}});
        shape = {{"type", "convex"}, {"vertices", Json::array()}};
        for (const Vector3d& p : *corners) shape["vertices"].push_back(toJson(p));
        o.geometry = std::make_shared<fcl::Convexd>(
            corners, 4,
            std::make_shared<std::vector<int>>(
                std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3}));
        break;
      }
      default: {
        const Vector3d normal = random_.point(1);
        const bool is_plane = random_.index(2) == 0;
        shape = {{"type", is_plane ? "plane" : "halfspace"},
                 {"normal", toJson(normal)},
                 {"offset", -2 * normal.norm()}};
        if (is_plane)
          o.geometry = std::make_shared<fcl::Planed>(normal, -2 * normal.norm());
        else
          o.geometry = std::make_shared<fcl::Halfspaced>(normal, -2 * normal.norm());
      }
    }
  }

  void addPoses(Json& entry, DirectObject& o) {
    const bool rests = random_.index(4) == 0, turns = random_.index(3) != 0;
    fcl::Quaterniond q(1, 0, 0, 0);
    for (std::size_t i = 0; i <= (rests ? 0 : kSteps); ++i) {
      const Vector3d place = random_.point(1);
      if (i == 0 || (turns && random_.index(3) != 0)) {
        const Vector3d axis = random_.point(1);
        q = fcl::Quaterniond(1, axis[0], axis[1], axis[2]).normalized();
      }
      Transform3d pose = Transform3d::Identity();
      pose.translation() = place;
      pose.linear() = q.normalized().toRotationMatrix();
      Json json = {{"translation", toJson(place)},
                   {"rotation", {q.w(), q.x(), q.y(), q.z()}}};
      if (random_.index(3) == 0) {
        json = Json::array();
        for (int row = 0; row < 4; ++row)
          json.push_back({pose.matrix()(row, 0), pose.matrix()(row, 1),
                          pose.matrix()(row, 2), pose.matrix()(row, 3)});
      }
      o.poses.push_back(pose);
      entry["poses"].push_back(json);
    }
  }

  void add(std::size_t number, bool is_thick) {
    DirectObject o;
    o.name = "object " + std::to_string(number);
    Json entry = {{"name", o.name}};
    const std::string file = "o" + std::to_string(number);
    const std::size_t kind = number < 2 ? number : random_.index(5);
    if (kind == 0)
      addFrames(file, entry, o);
    else if (kind == 1)
      addMesh(file, entry, o);
    else if (kind == 2)
      addOctree(file, entry, o);
    else
      addShape(entry, o);
    addPoses(entry, o);
    if (random_.index(2) == 0) entry["group"] = o.group = int(random_.index(3));
    if (is_thick && random_.index(2) == 0)
      entry["thickness"] = o.thickness = random_.uniform(0, .1);
    if (random_.index(3) == 0)
      entry["min_approach_speed"] = o.speed = random_.uniform(0, .5);
    this->file["objects"].push_back(entry);
    objects_.push_back(std::move(o));
  }

  void addPairDistances() {
    for (int i = 0; i < 4; ++i) {
      const std::size_t a = random_.index(objects_.size()),
                        b = random_.index(objects_.size());
      const double distance = random_.index(2) == 0 ? 0 : random_.uniform(0, .3);
      if (a == b || !distances_.emplace(std::minmax(a, b), distance).second) continue;
      file["pair_distances"].push_back(
          {{"objects", {objects_[a].name, objects_[b].name}}, {"distance", distance}});
    }
  }

  Random random_;
  fs::path folder_;
  std::vector<DirectObject> objects_;
  std::map<std::pair<std::size_t, std::size_t>, double> distances_;
  fcl::ContinuousGroups groups_;
};

std::vector<std::string> sorted(std::vector<std::string> lines) {
  std::sort(lines.begin(), lines.end());
  return lines;
}

class CcdScenes : public CcdJsonTest {
 protected:
  /// Runs the scene of a text, with outputs that are there already. Expects that it is
  /// refused at this line, and that the outputs stay as they are.
  void expectRefused(const std::string& text, int line, const std::string& cause) {
    SCOPED_TRACE(text);
    writeText(path("scene.json"), text);
    writeText(path("c.csv"), "before");
    writeText(path("j.json"), "before");
    const std::set<std::string> before = files();
    const Outcome outcome = run("run scene.json --contacts c.csv --json j.json");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("fcl-ccd: scene.json: line " + std::to_string(line)),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), before);
    EXPECT_EQ(readText(path("c.csv")), "before");
    EXPECT_EQ(readText(path("j.json")), "before");
  }

  /// A ball that falls on a table, with something in place of a text.
  static std::string fallingBall(const std::string& from = "",
                                 const std::string& to = "") {
    std::string text =
        "{\n"                                                                         // 1
        "  \"objects\": [\n"                                                          // 2
        "    {\"name\": \"table\",\n"                                                 // 3
        "     \"shape\": {\"type\": \"box\", \"sides\": [4, 4, 2]}},\n"               // 4
        "    {\"name\": \"ball\",\n"                                                  // 5
        "     \"shape\": {\"type\": \"sphere\", \"radius\": 1},\n"                    // 6
        "     \"poses\": [{\"translation\": [0, 0, 5]},\n"                            // 7
        "               {\"translation\": [0, 0, 3], \"rotation\": [1, 0, 0, 0]},\n"  // 8
        "               {\"translation\": [0, 0, 1]}]}\n"                             // 9
        "  ]\n"  // 10
        "}\n";   // 11
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
};

TEST_F(CcdScenes, AnswersEqualTheLibrarysToTheBit) {
  std::set<std::string> kinds;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const fs::path folder = path("scene_" + std::to_string(seed));
    fs::create_directory(folder);
    RandomScene scene(seed, folder);
    const std::string name = folder.filename().string() + "/scene.json";
    for (const auto& [word, query] : kQueries) {
      std::vector<std::string> expected{kColumns};
      for (const std::string& row : scene.answer(query)) expected.push_back(row);
      for (const char* threads : {"1", "3"}) {
        const Outcome outcome = run("run " + name + " --contacts c.csv --query " + word +
                                    " --threads " + threads);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        ASSERT_EQ(linesOf(readText(path("c.csv"))), expected) << word << ' ' << threads;
      }
      if (seed == 0 && query != ContinuousQuery::kAny) {
        const Outcome outcome =
            run("run " + name + " --contacts c.csv --start 1 --end 2 --query " + word);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        std::vector<std::string> second{kColumns};
        for (const std::string& row : expected)
          if (row.rfind("1,", 0) == 0) second.push_back(row);
        EXPECT_EQ(linesOf(readText(path("c.csv"))), second) << word;
      }
      if (query == ContinuousQuery::kAll) {
        for (const std::string& row : expected) kinds.insert(csvFields(row)[3]);
        expected.erase(expected.begin());
        EXPECT_EQ(sorted(expected), sorted(scene.answerByPairs()));
      }
    }
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"kind", "vf", "ee", "ve", "vv", "crossing",
                                          "vs", "es", "fs", "ss"}));
}

TEST_F(CcdScenes, PrintsTableAndSummary) {
  writeText(path("scene.json"), fallingBall());
  const Outcome outcome = run("run scene.json");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  const std::vector<std::string> lines = linesOf(outcome.out);
  ASSERT_EQ(lines.size(), 7u) << outcome.out;
  EXPECT_EQ(lines[0],
            "step  box pairs  pairs in contact  contacts  first time        ms");
  EXPECT_EQ(lines[1].substr(0, 57),
            "   0          0                 0         0           -  ");
  EXPECT_EQ(lines[2].substr(0, 57),
            "   1          1                 1         1         0.5  ");
  EXPECT_EQ(lines[3], "2 steps, 1 contact");
  EXPECT_EQ(lines[4].substr(0, 24), "first contact: step 1 at");
  EXPECT_NE(outcome.out.find("between table and ball: shape-shape, box table\n  meets "
                             "sphere ball at (0, 0, 1), normal (0, 0, 1)\n"),
            std::string::npos)
      << outcome.out;
  EXPECT_EQ(lines[6].substr(0, 9), "slowest: ");
  for (const std::string& line : lines) EXPECT_LE(line.size(), 80u) << line;

  const Outcome any = run("run scene.json --query any");
  EXPECT_NE(any.out.find("   a time"), std::string::npos);
  EXPECT_NE(any.out.find("\na contact: step 1"), std::string::npos);
  const Outcome none = run("run scene.json --end 1");
  EXPECT_NE(none.out.find("\nno contact in 1 step\n"), std::string::npos) << none.out;
  const Outcome late = run("run scene.json --start 1");
  EXPECT_NE(late.out.find("1 step, 1 contact\n"), std::string::npos) << late.out;
  EXPECT_NE(late.out.find("first contact: step 1 at"), std::string::npos) << late.out;
}

TEST_F(CcdScenes, NamesFeaturesOfMeshes) {
  writeTip();
  writeText(path("scene.json"), R"({"objects": [
    {"name": "my floor", "frames": ["tip0.obj", "tip1.obj"], "self_collision": true},
    {"name": "other", "mesh": "tip0.obj", "poses": [{"translation": [100, 0, 0]}]}]})");
  const Outcome outcome = run("run scene.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("of my floor with itself: vertex-face,\n  vertex 3 of "
                             "triangle 1 meets face 0 1 2 of triangle 0 at"),
            std::string::npos)
      << outcome.out;
  writeText(path("scene.json"), R"({"objects": [
    {"name": "tip", "mesh": "tip0.obj",
     "poses": [{"translation": [0, 0, 2]}, {"translation": [0, 0, 0.5]}]},
    {"name": "box", "shape": {"type": "box", "sides": [20, 20, 2]}, "thickness": 0.25}]})");
  EXPECT_NE(run("run scene.json").out.find("comes near box box"), std::string::npos);
}

TEST_F(CcdScenes, NamesCablesAndPoints) {
  writeText(path("cable.obj"), "v 0 0 0\nv 4 0 0\nl 1 2\np 1\n");
  writeText(path("scene.json"), R"({"objects": [
    {"name": "cable", "mesh": "cable.obj", "poses": [{}, {"translation": [0, 0, 5]}]},
    {"name": "ball", "shape": {"type": "sphere", "radius": 1},
     "poses": [{"translation": [0, 0, 3]}]}]})");
  const Outcome outcome = run("run scene.json --contacts c.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::set<std::string> parts;
  for (const CsvRow& row : readCsv(path("c.csv").string(), kColumns))
    parts.insert(row.at("kind") + ' ' + row.at("b1") + ' ' + row.at("b2"));
  EXPECT_EQ(parts, (std::set<std::string>{"vs e0 ", "vs p0 "}));
  EXPECT_NE(outcome.out.find("free edge 0 of cable meets"), std::string::npos)
      << outcome.out;
}

TEST_F(CcdScenes, TellsOfSplitVertices) {
  const Mesh split{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                   {{0, 1, 2}, {3, 4, 5}}};
  writeText(path("split.obj"), toObj(split));
  writeText(path("scene.json"), R"({"objects": [{"name": "a", "mesh": "split.obj",
    "self_collision": true, "poses": [{}, {"translation": [1, 0, 0]}]}]})");
  const Outcome outcome = run("run scene.json");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("split.obj: no two triangles share a vertex"),
            std::string::npos)
      << outcome.err;
}

TEST_F(CcdScenes, CsvQuotesNames) {
  writeText(path("scene.json"), fallingBall("\"ball\"", R"("a \"b\", c")"));
  const Outcome outcome = run("run scene.json --contacts -");
  EXPECT_EQ(outcome.exit_code, 0);
  const std::vector<std::string> lines = linesOf(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], kColumns);
  EXPECT_EQ(lines[1].substr(0, 30), "1,table,\"a \"\"b\"\", c\",ss,,,0.49") << lines[1];
  EXPECT_NE(outcome.err.find("first contact: step 1"), std::string::npos);
}

TEST_F(CcdScenes, WritesJson) {
  fs::create_directory(path("sub"));
  writeText(path("sub/tip.obj"), toObj(floorAndTip(0)));
  writeText(path("sub/scene.json"), R"({"version": 1, "objects": [
    {"name": "tip", "mesh": "tip.obj",
     "poses": [{"translation": [0, 0, 2]}, {"translation": [0, 0, 2]}, {}]},
    {"name": "box", "shape": {"type": "box", "sides": [20, 20, 2]}}]})");
  const Outcome outcome = run("run sub/scene.json --json j.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json file = json("j.json");
  EXPECT_EQ(file.at("file"), "sub/scene.json");
  EXPECT_EQ(file.at("objects"),
            Json::parse(R"([{"name": "tip", "geometry": "mesh", "triangles": 2},
                            {"name": "box", "geometry": "box", "triangles": 0}])"));
  ASSERT_EQ(file.at("steps").size(), 2u);
  EXPECT_EQ(file["steps"][0]["pairs"], Json::array());
  const Json& step = file["steps"][1];
  EXPECT_EQ(keysOf(step),
            (std::set<std::string>{"step", "box_pairs", "pairs", "contacts", "ms"}));
  EXPECT_EQ(step["step"], 1);
  ASSERT_EQ(step["pairs"].size(), 1u);
  EXPECT_EQ(step["pairs"][0]["o1"], "tip");
  EXPECT_EQ(step["pairs"][0]["o2"], "box");
  EXPECT_NEAR(step["pairs"][0]["time"].get<double>(), .5, 1e-9);
  EXPECT_EQ(step["pairs"][0]["contacts"], step["contacts"]);
  const Json& first = file.at("summary").at("first");
  EXPECT_EQ(file["summary"]["steps"], 2);
  EXPECT_EQ(first.at("step"), 1);
  EXPECT_EQ(first.at("b2"), nullptr);
  EXPECT_TRUE(first.at("b1").is_number_integer());
  EXPECT_EQ(run("run sub/scene.json --json j.json --end 1").exit_code, 0);
  EXPECT_EQ(json("j.json").at("summary").at("first"), nullptr);
}

TEST_F(CcdScenes, RefusesBrokenJson) {
  writeText(path("empty.json"), "");
  expectFailure("run empty.json", "empty.json: the file is empty");
  expectRefused("{\n \"objects\": [\n  {\"name\": nan}]}", 3, "column 13: nan is not");
  expectRefused("{\n \"objects\": [\n  {\"name\": -Infinity}]}", 3,
                "Write a finite number");
  expectRefused("{\n \"objects\": 1e999}", 2, "too large");
  expectRefused("{\n \"objects\": [],,\n}", 2, "column 16: broken JSON");
  expectRefused("{\n \"objects\": [\n", 3, "broken JSON");
  expectRefused("{\n \"objects\": [\"\xff\"]}", 2, "broken JSON");
  expectRefused("{} {}", 1, "broken JSON");
  expectRefused(std::string(1000, '['), 1, "nested too deeply");
  expectRefused("[\n]", 1, "is a list. Write an object");
  expectRefused("7", 1, "is a number. Write an object");
}

TEST_F(CcdScenes, RefusesWrongFields) {
  expectRefused("{}", 1, "the field 'objects' is missing");
  expectRefused("{\n\"version\": 2,\n\"objects\": []}", 2, "version: is 2. Write 1");
  expectRefused("{\n\"objects\":\n[]}", 3, "objects: the list is empty");
  const auto refuse = [&](const std::string& from, const std::string& to, int line,
                          const std::string& cause) {
    expectRefused(fallingBall(from, to), line, cause);
  };
  refuse("\"objects\"", "\"object\"", 2, "Did you mean 'objects'?");
  refuse("\"shape\"", "\"shap\"", 4,
         "objects[0]: there is no field 'shap' here. Did you "
         "mean 'shape'?");
  refuse("\"radius\": 1", "\"radius\": 1, \"radius\": 1", 6, "is there twice");
  refuse("\"ball\"", "\"table\"", 5,
         "objects[1].name: the object in line 3 has the name");
  refuse("\"ball\"", "\"\"", 5, "the text is empty");
  refuse("\"ball\"", "\"a\\nb\"", 5, "control character");
  refuse("\"ball\"", "null", 5, "objects[1].name: is null. Write a text in quotes");
  refuse("{\"name\": \"ball\",", "{", 5, "objects[1]: the field 'name' is missing");
  refuse("\"shape\": {\"type\": \"box\", \"sides\": [4, 4, 2]}", "\"group\": 0", 3,
         "has no geometry. Give it one of 'mesh', 'frames', 'shape' and 'octree'");
  refuse("\"shape\": {\"type\": \"box\"",
         "\"mesh\": \"x.obj\", \"shape\": {\"type\": \"box\"", 4,
         "the object has 'mesh' too");
  refuse("\"sphere\"", "\"spere\"", 6,
         "objects[1].shape.type: 'spere' is not a type of "
         "shapes. Did you mean 'sphere'?");
  refuse("\"radius\": 1", "\"radius\": 0", 6,
         "shape.radius: is 0. Write a number above 0");
  refuse("\"radius\": 1", "\"radius\": \"1\"", 6, "is a text. Write a number");
  refuse(", \"radius\": 1", "", 6, "the field 'radius' is missing");
  refuse("[4, 4, 2]", "[4, 4]", 4, "shape.sides: the list has 2 entries. Write 3");
  refuse("[4, 4, 2]", "[4, 4,\n -2]", 5, "shape.sides[2]: is -2");
  refuse("[4, 4, 2]", "[]", 4, "the list is empty");
  refuse("{\"type\": \"sphere\", \"radius\": 1}",
         "{\"type\": \"plane\", \"normal\": [0, 0, 0], \"offset\": 1}", 6,
         "no direction");
  refuse("{\"type\": \"sphere\", \"radius\": 1}", "\"sphere\"", 6, "Write an object");
  refuse("{\"type\": \"sphere\", \"radius\": 1}",
         "{\"type\": \"convex\", \"vertices\": []}", 6,
         "shape.vertices: the list is empty");
  for (const char* field : {"thickness", "min_approach_speed"}) {
    const std::string name = '"' + std::string(field) + '"';
    refuse("\"name\": \"ball\"", "\"name\": \"ball\", " + name + ": -1", 5,
           std::string(field) + ": is -1. Write a number from 0 on");
    refuse("\"name\": \"ball\"", "\"name\": \"ball\", " + name + ": true", 5,
           "is true or false. Write a number");
  }
  for (const char* group : {"32", "-1", "1.5"})
    refuse("\"name\": \"ball\"", "\"name\": \"ball\", \"group\": " + std::string(group),
           5, "group: is " + std::string(group) + ". Write a whole number from 0 to 31");
  refuse("\"name\": \"ball\"", "\"name\": \"ball\", \"self_collision\": true", 5,
         "only a mesh can be tested with itself");
  refuse("\"name\": \"ball\"", "\"name\": \"ball\", \"self_collision\": 1", 5,
         "Write true or false");
}

TEST_F(CcdScenes, RefusesWrongPoses) {
  const auto refuse = [&](const std::string& from, const std::string& to, int line,
                          const std::string& cause) {
    expectRefused(fallingBall(from, to), line, cause);
  };
  refuse("[1, 0, 0, 0]", "[1.02, 0, 0, 0]", 8,
         "objects[1].poses[1].rotation: the quaternion [w, x, y, z] has the length 1.02");
  refuse("[1, 0, 0, 0]", "[0, 0, 0, 0]", 8, "length");
  refuse("[1, 0, 0, 0]", "[1, 0, 0]", 8, "the list has 3 entries. Write 4");
  refuse("\"rotation\"", "\"rotatoin\"", 8, "Did you mean 'rotation'?");
  refuse("[0, 0, 5]", "[0, 0, -1e101]", 7,
         "objects[1].poses[0].translation[2]: is -1e+101. Use larger units");
  refuse("{\"translation\": [0, 0, 5]}", "[]", 7, "poses[0]: the list is empty");
  refuse("{\"translation\": [0, 0, 5]}", "[0, 0, 5]", 7, "Write 4");
  refuse("{\"translation\": [0, 0, 5]}", "[[1,0,0,0],\n[0,2,0,0],[0,0,1,0],[0,0,0,1]]", 7,
         "poses[0]: the matrix scales, mirrors or shears");
  refuse("{\"translation\": [0, 0, 5]}", "[[1,0,0,0],\n[0,1,0,0],[0,0,-1,0],[0,0,0,1]]",
         7, "the matrix scales, mirrors or shears");
  refuse("{\"translation\": [0, 0, 5]}",
         "[[1,0,0,0],\n[0,1,0,0],\n[0,0,1,0],\n[0,0,1,1]]", 10,
         "poses[0][3]: the last row of a matrix is [0, 0, 0, 1]");
  refuse("\"sides\": [4, 4, 2]}", "\"sides\": [4, 4, 2]},\n\"poses\": [{}, {}]", 8,
         "objects[1].poses: there are 3 poses, but 2 poses in line 5");
}

TEST_F(CcdScenes, RefusesWrongPairs) {
  const auto refuse = [&](const std::string& fields, int line, const std::string& cause) {
    expectRefused(fallingBall("  ]\n", "  ],\n" + fields), line, cause);
  };
  refuse("\"groups_apart\": []", 11, "groups_apart: the list is empty");
  refuse("\"groups_apart\": [[1]]", 11, "groups_apart[0]: the list has 1 entry. Write 2");
  refuse("\"groups_apart\": [[1,\n32]]", 12, "groups_apart[0][1]: is 32");
  refuse(
      "\"pair_distances\": [\n{\"objects\": [\"ball\", \"tabel\"], \"distance\": 0}]", 12,
      "pair_distances[0].objects[1]: there is no object 'tabel'. Did you mean 'table'?");
  refuse("\"pair_distances\": [{\"objects\": [\"ball\", \"table\"]}]", 11,
         "pair_distances[0]: the field 'distance' is missing");
  refuse("\"pair_distances\": [{\"objects\": [\"ball\", \"table\"], \"distance\": -1}]",
         11, "Write a number from 0 on");
  refuse(
      "\"pair_distances\": [{\"objects\": [\"ball\", \"table\"], \"distance\": 1},\n"
      "{\"objects\": [\"table\", \"ball\"], \"distance\": 1}]",
      12, "these two have a distance already");
}

TEST_F(CcdScenes, RefusesWrongFiles) {
  const auto refuse = [&](const std::string& geometry, const std::string& cause) {
    expectRefused(
        fallingBall("\"shape\": {\"type\": \"sphere\", \"radius\": 1}", geometry), 6,
        cause);
  };
  refuse("\"mesh\": \"gone.obj\"",
         "objects[1].mesh: gone.obj: cannot open: there is no such");
  writeText(path("bad.obj"), "v 0 0 0\nv 1 0\n");
  refuse("\"mesh\": \"bad.obj\"", "bad.obj: line 2");
  writeText(path("mesh.txt"), "x");
  refuse("\"mesh\": \"mesh.txt\"", "unknown mesh format");
  refuse("\"frames\": \"gone\"", "objects[1].frames: gone: cannot open");
  refuse("\"frames\": \"*.off\"", "objects[1].frames");
  refuse("\"octree\": \"gone.bt\"", "cannot open");
  refuse("\"octree\": \"mesh.txt\"", "is not an octree");
  writeText(path("bad.bt"), "no octree");
  refuse("\"octree\": \"bad.bt\"", "bad.bt: octomap cannot read this file");
  writeTip();
  expectRefused(fallingBall("\"shape\": {\"type\": \"sphere\", \"radius\": 1}",
                            "\"frames\": [\"tip0.obj\", \"tip1.obj\"]"),
                7, "objects[1].poses: there are 3 poses, but 2 frames in line 6");
}

TEST_F(CcdScenes, RefusesOptionsOfFrames) {
  writeText(path("scene.json"), fallingBall());
  writeText(path("other.json"), fallingBall());
  for (const char* option :
       {"--report r", "--picture p.png", "--paint p.ply", "--steps s.jsonl", "--jobs 2",
        "--follow=1", "--weld=0", "--thickness 1", "--stride 2", "--repeat 2",
        "--against scene.json", "--contacts c.csv --columns position",
        "--contacts c.csv --resume"}) {
    const std::string words = option;
    const std::size_t at = words.rfind("--");
    expectFailure(
        "run scene.json " + words,
        words.substr(at, words.find_first_of(" =", at) - at) + " is for frames");
  }
  expectFailure("run scene.json other.json", "a scene is named alone");
  expectFailure("run scene.json --end 3", "--end is from 1 to 2");
  expectFailure("run scene.json --start 2", "--start is from 0 to 1");
  expectFailure("run scene.json --contacts scene.json", "it is also given as scene.json");
  expectFailure("run scene.json --contacts x --json x", "it is also given as x");
  expectFailure("run gone.json", "gone.json: cannot open");
}

TEST_F(CcdScenes, OutputsAreLocked) {
  writeText(path("scene.json"), fallingBall());
  writeText(path("c.csv"), "before");
  const fcl_ccd::OutputLock lock(path("c.csv").string());
  expectFailure("run scene.json --contacts c.csv", "c.csv");
  EXPECT_EQ(readText(path("c.csv")), "before");
}

// The positions of binary PLYs are checked in their step.
TEST_F(CcdScenes, WritesNothingIfAStepFails) {
  Mesh mesh = floorAndTip(0);
  writeText(path("f0.ply"), toBinaryPly<double>(mesh, false));
  writeText(path("f1.ply"), toBinaryPly<double>(mesh, false));
  mesh.vertices[0][0] = std::numeric_limits<double>::quiet_NaN();
  writeText(path("f2.ply"), toBinaryPly<double>(mesh, false));
  writeText(path("scene.json"), R"({"objects": [{"name": "a", "frames": "f*.ply"}]})");
  writeText(path("c.csv"), "before");
  expectFailure("run scene.json --contacts c.csv --json j.json", "f2.ply", 3);
  expectFailure("run scene.json --contacts c.csv --json j.json",
                "stopped after 1 of 2 steps. No file was written", 3);
  EXPECT_EQ(readText(path("c.csv")), "before");
}

TEST_F(CcdScenes, TheExampleWorks) {
  const Outcome outcome = run("run '" FCL_CCD_SOURCE_DIR "/examples/scene.json'");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("3 steps, 2 contacts\nfirst contact: step 2 at 0.3, between "
                             "floor and ball: shape-shape,"),
            std::string::npos)
      << outcome.out;
}

// The schema of the format takes the example and scenes of all kinds, and refuses what
// the program refuses.
TEST_F(CcdScenes, TheSchemaKnowsTheFormat) {
  writeText(path("check.py"), R"(import json, sys
try:
    from jsonschema import Draft202012Validator
except ImportError:
    sys.exit(77)
schema = json.load(open(sys.argv[1]))
Draft202012Validator.check_schema(schema)
for name in sys.argv[2:]:
    if list(Draft202012Validator(schema).iter_errors(json.load(open(name)))):
        print(name)
)");
  const std::string check =
      "python3 -W ignore check.py '" FCL_CCD_SOURCE_DIR "/doc/scene.schema.json' ";
  const std::string example = FCL_CCD_SOURCE_DIR "/examples/scene.json";
  std::string good = '\'' + example + "'", bad;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const fs::path folder = path("scene_" + std::to_string(seed));
    fs::create_directory(folder);
    RandomScene scene(seed, folder);
    good += ' ' + folder.filename().string() + "/scene.json";
  }
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"\"shape\"", "\"shap\""},
      {"\"radius\": 1", "\"radius\": 0"},
      {"\"sphere\"", "\"spere\""},
      {"[4, 4, 2]", "[4, 4]"},
      {"\"ball\"", "7"},
      {"[1, 0, 0, 0]", "[1, 0, 0]"},
      {"\"name\": \"ball\",", ""},
      {"\"name\": \"ball\"", "\"name\": \"b\", \"group\": 32"},
      {"\"objects\"", "\"object\""},
      {"{\"translation\": [0, 0, 5]}", "[0, 0, 5]"},
      {"\"shape\"", "\"mesh\": \"x.obj\", \"shape\""}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    const std::string name = "wrong" + std::to_string(i) + ".json";
    writeText(path(name), fallingBall(wrong[i].first, wrong[i].second));
    bad += name + ' ';
  }
  const Outcome refused = runShell(check + bad + good);
  if (refused.exit_code == 77) GTEST_SKIP() << "python3 has no jsonschema";
  EXPECT_EQ(refused.exit_code, 0) << refused.err;
  std::string names;
  for (const std::string& line : linesOf(refused.out)) names += line + ' ';
  EXPECT_EQ(names, bad);
}

}  // namespace

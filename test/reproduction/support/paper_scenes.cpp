// SPDX-License-Identifier: BSD-3-Clause
#include "paper_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "fcl/common/exception.h"
#include "figures.h"
#include "fragile_designs.h"

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;

const double kPi = std::acos(-1.0);

/// A simulator and what its bodies are.
struct Stage {
  explicit Stage(const SimulatorOptions& options) : simulator(options) {}

  void addGround(double half, int divisions) {
    simulator.addObstacle(makeSheet(divisions, divisions, [=](double u, double v) {
      return Vec(half * (2 * u - 1), half * (2 * v - 1), 0);
    }));
    roles.push_back(SceneRole::kGround);
  }
  int addObstacle(SceneRole role, const TestMesh& mesh, const ObstacleMotion& motion) {
    simulator.addObstacle(mesh, motion);
    roles.push_back(role);
    return static_cast<int>(roles.size()) - 1;
  }
  void addFigure(const Figure& figure) {
    for (const FigurePart& part : figure)
      addObstacle(SceneRole::kFigure, part.mesh, part.motion);
  }
  void addSolid(const TestMesh& mesh, const SolidOptions& options) {
    simulator.addSolid(mesh, options);
    roles.push_back(SceneRole::kSolid);
  }
  void addFragile(const ShellDesign& design, const SolidOptions& options,
                  const FragileOptions& fragile) {
    simulator.addFragile(design, options, fragile);
    roles.push_back(SceneRole::kSolid);
  }
  /// A skirt around the z axis: pinned along its upper border, at `height`, to `body`.
  void addSkirt(SceneRole role, const Skirt& skirt, int body, double scale) {
    const TestMesh mesh = makeSkirt(skirt, scale);
    const int first = simulator.addCloth(mesh, mesh.vertices);
    roles.push_back(role);
    for (int i = 0; i < scaled(skirt.columns, scale, 12); ++i)
      simulator.pin(first + i, body);
  }

  ClothSimulator simulator;
  std::vector<SceneRole> roles;
};

using StagePointer = std::unique_ptr<Stage>;

SimulatorOptions simulatorOptions(const SceneOptions& scene) {
  SimulatorOptions options;
  options.seed = scene.seed;
  options.num_threads = scene.num_threads;
  options.keep_contacts = false;
  options.find_free_motion = true;
  options.push_speed = 0.01;
  options.approach = 0.5;
  // Each round leaves a tenth of the contacts of the one before; holding the last few
  // dozens brings new ones.
  options.response_rounds = 14;
  return options;
}

/// A cloth that falls over a ball, which turns and winds it up.
StagePointer makeCloth(const SceneOptions& scene) {
  const double ball_radius = 0.25;
  SimulatorOptions options = simulatorOptions(scene);
  // Long frames: the denser are the contacts of their free motion.
  options.frame_time = 1.0 / 20;
  options.steps_per_frame = 6;
  options.iterations = 20;
  options.thickness = 0.0001;
  options.friction = 0.5;
  options.bend_compliance = 0.5;
  options.internal_damping = 60;
  auto stage = std::make_unique<Stage>(options);
  const int resolution = scaled(209, scene.scale);
  const TestMesh rest = makeSheet(resolution, resolution, [&](double u, double v) {
    return Vec(1.5 * (u - 0.5), 1.5 * (v - 0.5), 0);
  });
  Transform3<double> start = Transform3<double>::Identity();
  start.translation() = Vec(0.06, -0.04, 2 * ball_radius + 0.03);
  start.rotate(Eigen::AngleAxisd(0.4, Vec::UnitZ()));
  stage->simulator.addCloth(rest, transformed(rest, start).vertices);
  stage->roles.push_back(SceneRole::kCloth);
  stage->addObstacle(
      SceneRole::kContainer, makeGeodesicSphere(scaled(13, scene.scale), ball_radius),
      [=](double time) {
        Transform3<double> pose = Transform3<double>::Identity();
        pose.translation() = Vec(0, 0, ball_radius + 0.02);
        // From rest to 5 radians a second in about half a second.
        pose.rotate(Eigen::AngleAxisd(5 * (time - 0.25 * (1 - std::exp(-time / 0.25))),
                                      Vec::UnitZ()));
        return pose;
      });
  stage->addGround(1.5, scaled(16, scene.scale));
  return stage;
}

/// A dancer whose three skirts swing as she turns to and fro.
StagePointer makeFlamenco(const SceneOptions& scene) {
  SimulatorOptions options = simulatorOptions(scene);
  options.steps_per_frame = 4;
  options.iterations = 20;
  options.thickness = 0.0002;
  options.friction = 0.3;
  options.bend_compliance = 0.5;
  options.internal_damping = 30;
  auto stage = std::make_unique<Stage>(options);
  stage->addFigure(makeDancer(scene.scale));
  const int columns = 182, rows = 40;
  const double waist = 1.06;
  stage->addSkirt(SceneRole::kUnderCloth, {waist - 0.06, 0.165, 0.6, 0.92, columns, rows},
                  0, scene.scale);
  stage->addSkirt(SceneRole::kCloth, {waist - 0.03, 0.155, 0.8, 0.93, columns, rows}, 0,
                  scene.scale);
  stage->addSkirt(SceneRole::kCloth, {waist, 0.145, 1.0, 0.94, columns, rows}, 0,
                  scene.scale);
  stage->addGround(2.0, scaled(14, scene.scale));
  return stage;
}

/// A figure that sits down on the ground; her dress and the one below it fold under her.
StagePointer makePrincess(const SceneOptions& scene) {
  SimulatorOptions options = simulatorOptions(scene);
  options.steps_per_frame = 4;
  options.iterations = 20;
  options.thickness = 0.0002;
  options.friction = 0.4;
  options.bend_compliance = 0.5;
  options.internal_damping = 40;
  auto stage = std::make_unique<Stage>(options);
  stage->addFigure(makeSittingFigure(scene.scale));
  stage->addSkirt(SceneRole::kUnderCloth, {1.00, 0.165, 0.42, 1.0, 126, 44}, 0,
                  scene.scale);
  stage->addSkirt(SceneRole::kCloth, {1.06, 0.145, 0.6, 1.05, 200, 59}, 0, scene.scale);
  stage->addGround(2.0, scaled(14, scene.scale));
  return stage;
}

/// The inside of a bowl and its outside, closed.
TestMesh makeBowl(int slices, double inner_radius, double wall, double depth) {
  std::vector<std::array<double, 2>> profile;
  const int rings = std::max(4, slices / 4);
  for (int i = 0; i <= rings; ++i) {
    const double a = 0.5 * kPi * i / rings;
    profile.push_back({{inner_radius * std::sin(a), wall + depth * (1 - std::cos(a))}});
  }
  for (int i = rings; i >= 0; --i) {
    const double a = 0.5 * kPi * i / rings;
    profile.push_back(
        {{(inner_radius + wall) * std::sin(a), (wall + depth) * (1 - std::cos(a))}});
  }
  return makeLathe(slices, profile);
}

/// Soft balls that fall into a rocking bowl and roll about.
StagePointer makeBalls(const SceneOptions& scene) {
  SimulatorOptions options = simulatorOptions(scene);
  options.steps_per_frame = 6;
  options.iterations = 12;
  options.thickness = 0.0002;
  options.friction = 0.2;
  options.damping = 0.1;
  options.solid_damping = 6;
  auto stage = std::make_unique<Stage>(options);
  Random random(scene.seed);
  const double radius = 0.06;
  const int count = std::max(6, static_cast<int>(std::lround(186 * scene.scale)));
  const int side = std::max(2, static_cast<int>(std::lround(std::cbrt(0.75 * count))));
  SolidOptions solid;
  solid.frequency = 40;
  for (int i = 0; i < count; ++i) {
    const double spacing = 2.5 * radius;
    const Vec cell(i % side - 0.5 * (side - 1), i / side % side - 0.5 * (side - 1),
                   i / side / side);
    TestMesh ball = makeGeodesicSphere(3, radius * random.uniform(0.8, 1));
    Transform3<double> pose = Transform3<double>::Identity();
    pose.translation() = spacing * cell + Vec(0, 0, 0.45) + random.point(0.2 * radius);
    pose.rotate(Eigen::AngleAxisd(random.uniform(0, 2 * kPi), Vec::UnitX()));
    pose.rotate(Eigen::AngleAxisd(random.uniform(0, 2 * kPi), Vec::UnitY()));
    solid.velocity = random.point(0.8) - Vec(0, 0, 0.5);
    stage->addSolid(transformed(ball, pose), solid);
  }
  const double bowl = 2.2 * radius * std::cbrt(count) + 0.1;
  stage->addObstacle(
      SceneRole::kContainer, makeBowl(32, bowl, 0.03, 0.7 * bowl), [=](double time) {
        Transform3<double> pose = Transform3<double>::Identity();
        pose.translation() = Vec(0, 0, 0.7 * bowl + 0.05);
        pose.rotate(Eigen::AngleAxisd(0.3 * std::sin(5 * time), Vec::UnitX()));
        pose.rotate(Eigen::AngleAxisd(0.3 * std::sin(4 * time), Vec::UnitY()));
        pose.translate(Vec(0, 0, -0.7 * bowl));
        return pose;
      });
  return stage;
}

/// Letters that fall into a bowl and break.
StagePointer makeAlphabets(const SceneOptions& scene) {
  SimulatorOptions options = simulatorOptions(scene);
  options.steps_per_frame = 8;
  options.iterations = 20;
  options.thickness = 0.0005;
  options.friction = 0.3;
  options.solid_damping = 10;
  auto stage = std::make_unique<Stage>(options);
  Random random(scene.seed);
  const int letters = std::max(3, static_cast<int>(std::lround(34 * scene.scale)));
  SolidOptions solid;
  solid.frequency = 120;
  FragileOptions fragile;
  fragile.strength = 0.25;
  fragile.reach = 0.15;
  for (int i = 0; i < letters; ++i) {
    Transform3<double> pose = Transform3<double>::Identity();
    const double angle = 2.4 * i;
    pose.translation() =
        Vec(0.28 * std::cos(angle), 0.28 * std::sin(angle), 0.6 + 0.16 * i) +
        random.point(0.03);
    pose.rotate(Eigen::AngleAxisd(random.uniform(0, 2 * kPi), Vec::UnitZ()));
    pose.rotate(Eigen::AngleAxisd(random.uniform(-0.5, 0.5), Vec::UnitX()));
    ShellDesign design = makeLetter(i, 0.04, 1, 4, random);
    for (auto* layer : {&design.outer, &design.inner})
      for (Vec& p : *layer) p = pose * p;
    solid.velocity = Vec(0, 0, -2.0);
    stage->addFragile(design, solid, fragile);
  }
  stage->addObstacle(SceneRole::kContainer, makeBowl(19, 0.7, 0.03, 0.5), {});
  return stage;
}

/// A ball falls on a lion of stone.
StagePointer makeLionScene(const SceneOptions& scene) {
  SimulatorOptions options = simulatorOptions(scene);
  options.steps_per_frame = 2;
  options.thickness = 0.0002;
  options.push_apart = false;
  // Hundreds of pieces that are wedged in between each other, 0.3 mm apart: with fewer
  // iterations and rounds contacts are left, what is in contact is held, and the pile
  // jams.
  options.iterations = 300;
  options.response_rounds = 16;
  options.slowing_rounds = 8;
  options.contacts_per_pair = 64;
  options.friction = 0.3;
  options.push_speed = 0.002;
  options.damping = 0.1;
  auto stage = std::make_unique<Stage>(options);
  Random random(scene.seed);
  const int frequency = scaled(197, scene.scale);
  const int pieces =
      std::max(8, static_cast<int>(std::lround(240 * std::pow(scene.scale, 0.25))));
  SolidOptions stone;
  stone.density = 60;
  FragileOptions fragile;
  fragile.strength = 30;
  fragile.reach = 0.12;
  fragile.gap = 0.25;
  fragile.burst = 2;
  ShellDesign design = makeLion(frequency, pieces, random);
  double lowest = 0;
  for (const Vec& p : design.outer) lowest = std::min(lowest, p[2]);
  for (auto* layer : {&design.outer, &design.inner})
    for (Vec& p : *layer) p[2] += 0.002 - lowest;
  stage->addFragile(design, stone, fragile);
  SolidOptions iron;
  iron.density = 300;
  iron.velocity = Vec(0, 0, -6);
  Transform3<double> pose = Transform3<double>::Identity();
  pose.translation() = Vec(0.03, 0.02, 1.35);
  stage->addSolid(transformed(makeGeodesicSphere(scaled(20, scene.scale), 0.22), pose),
                  iron);
  stage->addGround(2.5, scaled(16, scene.scale));
  return stage;
}

StagePointer makeStage(SceneKind kind, const SceneOptions& options) {
  switch (kind) {
    case SceneKind::kCloth:
      return makeCloth(options);
    case SceneKind::kFlamenco:
      return makeFlamenco(options);
    case SceneKind::kPrincess:
      return makePrincess(options);
    case SceneKind::kBalls:
      return makeBalls(options);
    case SceneKind::kAlphabets:
      return makeAlphabets(options);
    default:
      return makeLionScene(options);
  }
}

}  // namespace

const std::vector<SceneInfo>& sceneInfos() {
  static const std::vector<SceneInfo> infos{
      {SceneKind::kCloth, "cloth", 92000, 60},
      {SceneKind::kFlamenco, "flamenco", 49000, 60},
      {SceneKind::kPrincess, "princess", 40000, 60},
      {SceneKind::kBalls, "balls", 34000, 60},
      {SceneKind::kAlphabets, "alphabets", 5000, 60},
      {SceneKind::kLion, "lion", 1600000, 30}};
  return infos;
}

TestMesh sceneMesh(SceneKind kind, const SceneOptions& options) {
  return makeStage(kind, options)->simulator.mesh();
}

void generateScene(SceneKind kind, const SceneOptions& options, const SceneSink& sink) {
  const StagePointer stage = makeStage(kind, options);
  ClothSimulator& simulator = stage->simulator;
  const int frames = options.frames > 0
                         ? options.frames
                         : sceneInfos()[static_cast<std::size_t>(kind)].frames;
  for (int i = 0; i < frames; ++i) {
    const FrameReport report = simulator.advanceFrame();
    // The next frame, if there is one, would begin as this one did.
    if (i + 1 < frames && simulator.frameBegin() == simulator.mesh().vertices)
      throw Exception("generateScene: nothing moves in frame " + std::to_string(i + 1) +
                      ", nor would it in any after that");
    if (!sink({i, simulator.time(), simulator.mesh().triangles, simulator.frameBegin(),
               simulator.freeMotion(), simulator.mesh().vertices, simulator.stepBegin(),
               simulator.topologyChange(), report, simulator.bodies(), stage->roles}))
      return;
  }
}

}  // namespace test
}  // namespace fcl

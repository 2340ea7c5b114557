// SPDX-License-Identifier: BSD-3-Clause
//
// Scenes of the kind and size of those in the paper's evaluation, which are not public.
// Each is simulated, frame by frame; doc/scenes.md shows them.
#ifndef FCL_TEST_SUPPORT_PAPER_SCENES_H
#define FCL_TEST_SUPPORT_PAPER_SCENES_H

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cloth_simulator.h"

namespace fcl {
namespace test {

enum class SceneKind { kCloth, kFlamenco, kPrincess, kBalls, kAlphabets, kLion };

/// @brief What is known of a scene before it runs.
struct SceneInfo {
  SceneKind kind;
  std::string name;
  int paper_triangles;
  int frames;
};

/// @brief All scenes, in the order of SceneKind.
const std::vector<SceneInfo>& sceneInfos();

struct SceneOptions {
  std::uint64_t seed{1};
  /// times the paper's number of triangles, about
  double scale{1};
  /// 0: as many as SceneInfo says
  int frames{0};
  /// of the simulator's queries; the frames do not depend on it
  int num_threads{1};
};

/// @brief What a body is in its scene; pictures tell them apart.
enum class SceneRole { kGround, kContainer, kFigure, kCloth, kUnderCloth, kSolid };

/// @brief One step of a scene: the motion from `previous` to `current`, about which a
/// simulator asks collision detection. Its answer to the contacts leads to `accepted`.
/// References are valid during the callback only.
struct SceneFrame {
  int index;    // from 0
  double time;  // at its end, s
  const std::vector<Triangle>& triangles;
  /// free of crossings
  const std::vector<Vector3<double>>& previous;
  /// where forces and scripted motion lead if nothing is in the way: layers that press on
  /// each other pass through each other
  const std::vector<Vector3<double>>& current;
  /// those that the next frame begins with, unless the topology changes then
  const std::vector<Vector3<double>>& accepted;
  /// where the last of the simulator's own steps began, which led to `accepted`
  const std::vector<Vector3<double>>& step_begin;
  /// how `triangles` and `previous` differ from the frame before's `triangles` and
  /// `accepted`; vertices on a crack have moved a little too, hence all of the bodies
  /// that broke may differ by rounding
  const TopologyChange& change;
  /// of the simulator; without contacts
  const FrameReport& report;
  /// one entry a vertex
  const std::vector<int>& body_of;
  /// one entry a body
  const std::vector<SceneRole>& roles;
};

/// @brief Takes a frame; returns false to end the scene.
using SceneSink = std::function<bool(const SceneFrame& frame)>;

/// @brief Simulates a scene and hands out its frames. Same options, same bits.
/// @throws fcl::Exception if the simulation fails, or comes before its last frame to a
/// stop that it cannot leave.
void generateScene(SceneKind kind, const SceneOptions& options, const SceneSink& sink);

/// @brief The first mesh of a scene, without simulating it.
TestMesh sceneMesh(SceneKind kind, const SceneOptions& options);

}  // namespace test
}  // namespace fcl

#endif

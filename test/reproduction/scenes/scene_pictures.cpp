// SPDX-License-Identifier: BSD-3-Clause
#include "scene_pictures.h"

#include <cstdint>

#include "mesh_io.h"

namespace fcl {
namespace test {
namespace {

struct Look {
  std::uint32_t front, back;
};

/// Neighbouring solids differ.
const std::uint32_t kSolidColours[] = {0x2a9d8f, 0xe9c46a, 0xf4a261, 0xe76f51,
                                       0x8ab17d, 0x287271, 0xd7a9c0};

Look lookOf(SceneRole role, int body) {
  switch (role) {
    case SceneRole::kGround:
      return {0xf4f5f7, 0xf4f5f7};
    case SceneRole::kContainer:
      return {0xb9bec5, 0x9aa1ab};
    case SceneRole::kFigure:
      return {0xd9b99b, 0xd9b99b};
    case SceneRole::kCloth:
      return {0x2a9d8f, 0xe9c46a};
    case SceneRole::kUnderCloth:
      return {0xe76f51, 0xf4a261};
    default: {
      const std::uint32_t colour = kSolidColours[body % 7];
      return {colour, colour};
    }
  }
}

Look lookOfVertex(const SceneFrame& frame, std::size_t v) {
  const int body = frame.body_of[v];
  return lookOf(frame.roles[static_cast<std::size_t>(body)], body);
}

}  // namespace

Camera sceneCamera(SceneKind kind) {
  Camera camera;
  camera.vertical_view_angle = 0.46;
  switch (kind) {
    case SceneKind::kCloth:
      camera.eye = {1.75, -2.1, 1.5};
      camera.target = {0.03, 0, 0.14};
      break;
    case SceneKind::kFlamenco:
      camera.eye = {1.6, -4.2, 1.9};
      camera.target = {0, 0, 0.78};
      break;
    case SceneKind::kPrincess:
      camera.eye = {2.2, -3.2, 1.9};
      camera.target = {0, 0.1, 0.5};
      break;
    case SceneKind::kBalls:
      camera.eye = {1.5, -3.6, 3.4};
      camera.target = {0, 0, 0.4};
      camera.vertical_view_angle = 0.34;
      break;
    case SceneKind::kAlphabets:
      camera.eye = {0.8, -2.2, 2.4};
      camera.target = {0, 0, 0.35};
      break;
    case SceneKind::kLion:
      camera.eye = {1.6, -2.8, 1.5};
      camera.target = {0, 0, 0.5};
      break;
  }
  return camera;
}

Image drawFrame(SceneKind kind, const SceneFrame& frame, int width, int height) {
  PaintedMesh scene;
  scene.mesh = {frame.accepted, frame.triangles};
  for (const Triangle& t : frame.triangles) {
    const Look look = lookOfVertex(frame, t[0]);
    const auto body = static_cast<std::size_t>(frame.body_of[t[0]]);
    scene.paints.push_back({colourFromHex(look.front), colourFromHex(look.back),
                            frame.roles[body] == SceneRole::kGround});
  }
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.fade_end = 2;
  return render(scene, {}, sceneCamera(kind), options);
}

std::string encodeFrame(const SceneFrame& frame,
                        const std::vector<Vector3<double>>& positions) {
  fcl_ccd::Mesh mesh;
  std::vector<fcl_ccd::Colour> colours;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    mesh.vertices.push_back({{positions[v][0], positions[v][1], positions[v][2]}});
    const std::uint32_t rgb = lookOfVertex(frame, v).front;
    colours.push_back(
        {{static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
          static_cast<std::uint8_t>(rgb)}});
  }
  for (const Triangle& t : frame.triangles)
    mesh.triangles.push_back(
        {{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])}});
  return fcl_ccd::encodePaintedPly(mesh, colours);
}

}  // namespace test
}  // namespace fcl

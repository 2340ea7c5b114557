// SPDX-License-Identifier: BSD-3-Clause
#include "edge_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "pictures.h"
#include "scene_pictures.h"

namespace fcl {
namespace test {
namespace {

constexpr int kWidth = 640, kHeight = 600;

/// The ground of every scene lies still in z = 0, where no other triangle does.
bool isGround(const FramePairMesh& frame, const Triangle& t) {
  for (int k = 0; k < 3; ++k)
    if (frame.previous[t[k]][2] != 0 || frame.current[t[k]][2] != 0) return false;
  return true;
}

PaintedMesh paint(const FramePairMesh& frame) {
  const Colour surface = colourFromHex(0xe4e6ea), ground = colourFromHex(0xf4f5f7);
  PaintedMesh scene;
  scene.mesh = {frame.previous, frame.triangles};
  for (const Triangle& t : frame.triangles) {
    const bool is_ground = isGround(frame, t);
    const Colour& colour = is_ground ? ground : surface;
    scene.paints.push_back({colour, colour, is_ground});
  }
  return scene;
}

/// Each edge as a row of dots, half a pixel apart; without the ground's, which are long
/// and would cross the picture.
std::vector<Marker> dotted(const TestedEdges& edges, const Colour& colour,
                           const Camera& camera) {
  std::vector<Marker> dots;
  for (const TestedEdges::Segment& s : edges.edges) {
    const Vector3<double> p(s[0], s[1], s[2]), q(s[3], s[4], s[5]);
    if (p[2] == 0 && q[2] == 0) continue;
    const double pixel = (p - camera.eye).norm() * 2 *
                         std::tan(0.5 * camera.vertical_view_angle) / kHeight;
    const double steps = std::max(1., std::ceil((q - p).norm() / (0.5 * pixel)));
    for (double i = 0; i <= steps; ++i) dots.push_back({p + i / steps * (q - p), colour});
  }
  return dots;
}

Image drawPanel(const PaintedMesh& scene, const Camera& camera, const TestedEdges& edges,
                std::uint32_t colour, const std::string& title) {
  RenderOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.fade_end = 2;
  options.marker_radius = 0.6;
  const Colour ink = colourFromHex(colour);
  Image image = render(scene, dotted(edges, ink, camera), camera, options);
  drawText(image, title, 16, 16, 2, ink);
  drawText(image,
           std::to_string(edges.pairs) + " PAIRS OF " +
               std::to_string(edges.edges.size()) + " EDGES",
           16, 38, 2, ink);
  return image;
}

}  // namespace

Image drawTestedEdges(SceneKind kind, const FramePairMesh& frame,
                      const TestedEdgeSets& sets) {
  const PaintedMesh scene = paint(frame);
  Camera camera = sceneCamera(kind);
  camera.eye = camera.target + 0.75 * (camera.eye - camera.target);
  Image picture(3 * kWidth, kHeight, RenderOptions().background);
  paste(picture, drawPanel(scene, camera, sets.boxes, 0x1d5fa8, "BOXES"), 0, 0);
  paste(picture, drawPanel(scene, camera, sets.plain, 0x1e8449, "AND THE FILTER"), kWidth,
        0);
  paste(picture, drawPanel(scene, camera, sets.moving, 0xc0392b, "OURS"), 2 * kWidth, 0);
  return picture;
}

}  // namespace test
}  // namespace fcl

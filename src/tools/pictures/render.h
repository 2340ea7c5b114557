// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PICTURES_RENDER_H
#define FCL_CCD_PICTURES_RENDER_H

#include <vector>

#include "fcl/common/types.h"
#include "fcl/math/triangle.h"
#include "image.h"

namespace fcl_ccd {
namespace picture {

/// @brief A triangle mesh in metres.
struct Surface {
  std::vector<fcl::Vector3<double>> vertices;
  std::vector<fcl::Triangle> triangles;
};

/// @brief How a triangle looks.
struct Paint {
  /// colours of the side to which the normal points, and of the other side
  Colour front;
  Colour back;
  /// whether it is the ground, which fades into the background
  bool fades{false};
};

/// @brief A mesh with one paint per triangle.
struct PaintedMesh {
  Surface mesh;
  std::vector<Paint> paints;
};

/// @brief A small disc that faces the camera. Objects in front of it hide it, unless it
/// is on top.
struct Marker {
  fcl::Vector3<double> position;  // metres
  Colour colour;
  double size{1};  // of RenderOptions::marker_radius
  bool is_on_top{false};
};

/// @brief A pinhole camera.
struct Camera {
  fcl::Vector3<double> eye{2, -2, 1.5};  // metres
  fcl::Vector3<double> target{0, 0, 0};  // metres
  double vertical_view_angle{0.6};       // radians
};

/// @brief How a picture is made; z is up.
struct RenderOptions {
  int width{800};   // pixels
  int height{600};  // pixels
  /// samples per pixel along each axis
  int supersampling{2};
  /// number of lights in the sky, in addition to the sun; each casts shadows
  int sky_lights{40};
  /// points of the sun's shadow map along each axis
  int shadow_size{2048};
  /// direction to the sun, of any length
  fcl::Vector3<double> sun{0.5, -0.35, 1};
  Colour background{colourFromHex(0xf4f5f7)};
  /// horizontal distances from the camera's target, in metres, between which a ground
  /// fades into the background, so that it has no visible end
  double fade_begin{0.8};
  double fade_end{1.45};
  /// pixels
  double marker_radius{2};
};

/// @brief Draws the scene with a z-buffer: smooth normals, both sides lit, shadows of the
/// sun and of the sky.
Image render(const PaintedMesh& scene, const std::vector<Marker>& markers,
             const Camera& camera, const RenderOptions& options);

}  // namespace picture
}  // namespace fcl_ccd

#endif

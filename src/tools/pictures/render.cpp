// SPDX-License-Identifier: BSD-3-Clause
#include "render.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace fcl_ccd {
namespace picture {
namespace {

using fcl::Triangle;
using Vec = fcl::Vector3<double>;

/// A point on the screen: x to the right, y down (in pixels). z grows away from the
/// viewer.
using ScreenPoint = Vec;

/// Calls visit(x, y, weights) for each pixel centre inside the triangle. The weights are
/// barycentric on the screen.
template <typename Visit>
void rasterise(const std::array<ScreenPoint, 3>& p, int width, int height, Visit visit) {
  const auto cross = [](const Vec& o, const Vec& a, double x, double y) {
    return (a[0] - o[0]) * (y - o[1]) - (a[1] - o[1]) * (x - o[0]);
  };
  const double area = cross(p[0], p[1], p[2][0], p[2][1]);
  if (area == 0) return;
  const auto bounds = [&](int axis, int size) {
    const double lo = std::min({p[0][axis], p[1][axis], p[2][axis]});
    const double hi = std::max({p[0][axis], p[1][axis], p[2][axis]});
    const int first = static_cast<int>(std::max(0.0, std::floor(lo)));
    const int last = static_cast<int>(std::min(size - 1.0, std::ceil(hi)));
    return std::array<int, 2>{{first, last}};
  };
  const auto columns = bounds(0, width);
  const auto rows = bounds(1, height);
  for (int y = rows[0]; y <= rows[1]; ++y)
    for (int x = columns[0]; x <= columns[1]; ++x) {
      const double px = x + 0.5;
      const double py = y + 0.5;
      const Vec weights(cross(p[1], p[2], px, py) / area,
                        cross(p[2], p[0], px, py) / area,
                        cross(p[0], p[1], px, py) / area);
      if (weights.minCoeff() >= 0) visit(x, y, weights);
    }
}

/// A depth map seen from far away in direction `to_light`.
class ShadowMap {
 public:
  ShadowMap(const Surface& mesh, const Vec& to_light, int size)
      : size_(size),
        depths_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size),
                std::numeric_limits<float>::max()) {
    axes_[2] = -to_light.normalized();
    const Vec side = std::abs(axes_[2][2]) < 0.9 ? Vec::UnitZ() : Vec::UnitX();
    axes_[0] = axes_[2].cross(side).normalized();
    axes_[1] = axes_[2].cross(axes_[0]);
    lo_ = Vec::Constant(std::numeric_limits<double>::max());
    Vec hi = -lo_;
    for (const Vec& v : mesh.vertices) {
      lo_ = lo_.cwiseMin(along(v));
      hi = hi.cwiseMax(along(v));
    }
    const double extent = std::max(hi[0] - lo_[0], hi[1] - lo_[1]);
    pixels_per_metre_ = extent > 0 ? size / (1.0001 * extent) : 1;
    for (const Triangle& t : mesh.triangles) draw(mesh, t);
  }

  /// The part of the light that reaches a point, in [0, 1], from samples of the map in a
  /// square of (2 radius + 1)^2. The point is moved by `lift` (metres) towards the light
  /// so that a surface does not shade itself.
  float light(const Vec& point, double lift, int radius) const {
    const ScreenPoint p = toMap(point);
    const int cx = static_cast<int>(p[0]);
    const int cy = static_cast<int>(p[1]);
    int lit = 0;
    for (int y = cy - radius; y <= cy + radius; ++y)
      for (int x = cx - radius; x <= cx + radius; ++x) {
        const bool inside = x >= 0 && x < size_ && y >= 0 && y < size_;
        lit += !inside || p[2] - lift <= depths_[index(x, y)];
      }
    const int width = 2 * radius + 1;
    return static_cast<float>(lit) / static_cast<float>(width * width);
  }

  Vec toLight() const { return -axes_[2]; }

 private:
  Vec along(const Vec& v) const {
    return {axes_[0].dot(v), axes_[1].dot(v), axes_[2].dot(v)};
  }
  ScreenPoint toMap(const Vec& v) const {
    ScreenPoint p = along(v) - lo_;
    p[0] *= pixels_per_metre_;
    p[1] *= pixels_per_metre_;
    return p;
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(x);
  }
  void draw(const Surface& mesh, const Triangle& t) {
    std::array<ScreenPoint, 3> p;
    for (int k = 0; k < 3; ++k)
      p[static_cast<std::size_t>(k)] = toMap(mesh.vertices[t[k]]);
    rasterise(p, size_, size_, [&](int x, int y, const Vec& w) {
      const double depth = w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2];
      float& nearest = depths_[index(x, y)];
      nearest = std::min(nearest, static_cast<float>(depth));
    });
  }

  int size_;
  std::vector<float> depths_;
  std::array<Vec, 3> axes_;
  Vec lo_;
  double pixels_per_metre_{1};
};

/// A sun and a sky, as a set of shadowed lights.
class Lighting {
 public:
  Lighting(const Surface& mesh, const RenderOptions& options)
      : sun_(mesh, options.sun, options.shadow_size) {
    // A spiral with equal steps in height covers the half sphere evenly.
    const double golden_angle = std::acos(-1.0) * (3 - std::sqrt(5.0));
    for (int i = 0; i < options.sky_lights; ++i) {
      const double z = (i + 0.5) / options.sky_lights;
      const double r = std::sqrt(1 - z * z);
      sky_.emplace_back(
          mesh, Vec(r * std::cos(i * golden_angle), r * std::sin(i * golden_angle), z),
          512);
    }
  }

  /// Light that a matt surface with this unit normal sends back, as a colour.
  Colour at(const Vec& point, const Vec& normal) const {
    const Colour sun_colour(1.0f, 0.96f, 0.88f);
    const Colour sky_colour(0.86f, 0.93f, 1.0f);
    const double towards_sun = normal.dot(sun_.toLight());
    const float sun = towards_sun > 0
                          ? static_cast<float>(towards_sun) * sun_.light(point, 0.006, 2)
                          : 0;
    float sky = 0;
    for (const ShadowMap& map : sky_) {
      const double towards = normal.dot(map.toLight());
      if (towards > 0) sky += static_cast<float>(towards) * map.light(point, 0.02, 0);
    }
    if (!sky_.empty()) sky *= 2 / static_cast<float>(sky_.size());
    return 0.75f * sun * sun_colour + 0.5f * sky * sky_colour + Colour::Constant(0.04f);
  }

 private:
  ShadowMap sun_;
  std::vector<ShadowMap> sky_;
};

/// Maps metres to (supersampled) pixels; z of the result is the distance along the view.
class Projection {
 public:
  Projection(const Camera& camera, int width, int height)
      : eye_(camera.eye), centre_(0.5 * width, 0.5 * height) {
    forward_ = (camera.target - camera.eye).normalized();
    right_ = forward_.cross(Vec::UnitZ()).normalized();
    down_ = forward_.cross(right_);
    scale_ = 0.5 * height / std::tan(0.5 * camera.vertical_view_angle);
  }

  double depthOf(const Vec& v) const { return forward_.dot(v - eye_); }

  ScreenPoint operator()(const Vec& v) const {
    const Vec d = v - eye_;
    const double depth = forward_.dot(d);
    return {centre_[0] + scale_ * right_.dot(d) / depth,
            centre_[1] + scale_ * down_.dot(d) / depth, depth};
  }

 private:
  Vec eye_, forward_, right_, down_;
  fcl::Vector2<double> centre_;
  double scale_;
};

/// Area-weighted vertex normals, unit.
std::vector<Vec> smoothNormals(const Surface& mesh) {
  std::vector<Vec> normals(mesh.vertices.size(), Vec::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Vec n = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                      .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (int k = 0; k < 3; ++k) normals[t[k]] += n;
  }
  for (Vec& n : normals)
    if (n.squaredNorm() > 0) n.normalize();
  return normals;
}

class Renderer {
 public:
  Renderer(const PaintedMesh& scene, const Camera& camera, const RenderOptions& options)
      : scene_(scene),
        camera_(camera),
        options_(options),
        width_(options.width * options.supersampling),
        height_(options.height * options.supersampling),
        projection_(camera, width_, height_),
        image_(width_, height_, options.background),
        hits_(image_.pixels.size()) {}

  Image run(const std::vector<Marker>& markers) {
    for (std::size_t f = 0; f < scene_.mesh.triangles.size(); ++f) findVisible(f);
    shade();
    for (const Marker& marker : markers) drawMarker(marker);
    return shrunk(image_, options_.supersampling);
  }

 private:
  /// The content of a pixel: a triangle, a point on it, and its distance.
  struct Hit {
    int triangle{-1};
    float depth{std::numeric_limits<float>::max()};
    fcl::Vector3<float> weights{fcl::Vector3<float>::Zero()};
  };

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  void findVisible(std::size_t f) {
    const std::vector<Vec> polygon = partBeforeCamera(f);
    for (std::size_t k = 2; k < polygon.size(); ++k)
      findVisible(f, {polygon[0], polygon[k - 1], polygon[k]});
  }

  Vec pointOf(std::size_t f, const Vec& weights) const {
    const Triangle& t = scene_.mesh.triangles[f];
    const auto& v = scene_.mesh.vertices;
    return weights[0] * v[t[0]] + weights[1] * v[t[1]] + weights[2] * v[t[2]];
  }

  /// The corners, as barycentric coordinates, of the part of a triangle that is before
  /// the camera.
  std::vector<Vec> partBeforeCamera(std::size_t f) const {
    constexpr double kNear = 1e-2;  // metres
    std::vector<Vec> polygon;
    for (int k = 0; k < 3; ++k) {
      const Vec a = Vec::Unit(k), b = Vec::Unit((k + 1) % 3);
      const double before_a = projection_.depthOf(pointOf(f, a)) - kNear,
                   before_b = projection_.depthOf(pointOf(f, b)) - kNear;
      if (before_a >= 0) polygon.push_back(a);
      if ((before_a >= 0) == (before_b >= 0)) continue;
      const double share = before_a / (before_a - before_b);
      polygon.emplace_back((1 - share) * a + share * b);
    }
    return polygon;
  }

  /// Finds the pixels that show a part of a triangle, given by barycentric coordinates.
  void findVisible(std::size_t f, const std::array<Vec, 3>& part) {
    std::array<ScreenPoint, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = projection_(pointOf(f, part[k]));
    rasterise(p, width_, height_, [&](int x, int y, const Vec& w) {
      // 1 / depth is linear on the screen.
      const Vec inverse(w[0] / p[0][2], w[1] / p[1][2], w[2] / p[2][2]);
      const auto depth = static_cast<float>(1 / inverse.sum());
      Hit& hit = hits_[index(x, y)];
      if (depth >= hit.depth) return;
      hit.triangle = static_cast<int>(f);
      hit.depth = depth;
      const Vec weights =
          inverse[0] * part[0] + inverse[1] * part[1] + inverse[2] * part[2];
      hit.weights = (weights / inverse.sum()).cast<float>();
    });
  }

  void shade() {
    const Lighting lighting(scene_.mesh, options_);
    const std::vector<Vec> normals = smoothNormals(scene_.mesh);
    for (std::size_t i = 0; i < hits_.size(); ++i)
      if (hits_[i].triangle >= 0)
        image_.pixels[i] = colourOf(hits_[i], lighting, normals);
  }

  Colour colourOf(const Hit& hit, const Lighting& lighting,
                  const std::vector<Vec>& normals) const {
    const auto f = static_cast<std::size_t>(hit.triangle);
    const Triangle& t = scene_.mesh.triangles[f];
    const auto& v = scene_.mesh.vertices;
    const Vec w = hit.weights.cast<double>();
    const Vec point = w[0] * v[t[0]] + w[1] * v[t[1]] + w[2] * v[t[2]];
    const Vec flat = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]);
    const bool is_front = flat.dot(camera_.eye - point) >= 0;
    Vec normal = w[0] * normals[t[0]] + w[1] * normals[t[1]] + w[2] * normals[t[2]];
    if (normal.dot(flat) < 0 || normal.squaredNorm() == 0) normal = flat;
    if (normal.squaredNorm() > 0) normal.normalize();
    if (!is_front) normal = -normal;
    const Paint& paint = scene_.paints[f];
    const Colour& pigment = is_front ? paint.front : paint.back;
    const Colour lit = pigment.cwiseProduct(lighting.at(point, normal));
    const float shown = paint.fades ? shownAt(point) : 1.0f;
    return shown * lit + (1 - shown) * options_.background;
  }

  /// The opacity of the ground at a point.
  float shownAt(const Vec& point) const {
    const Vec away = point - camera_.target;
    const double faded = (std::hypot(away[0], away[1]) - options_.fade_begin) /
                         (options_.fade_end - options_.fade_begin);
    return static_cast<float>(1 - std::min(1.0, std::max(0.0, faded)));
  }

  void drawMarker(const Marker& marker) {
    const ScreenPoint p = projection_(marker.position);
    if (!(p[2] > 0)) return;
    const double radius = marker.size * options_.marker_radius * options_.supersampling;
    // Markers lie on surfaces, and have to be drawn in front of them.
    const double depth = p[2] * (1 - 0.004);
    const int reach = static_cast<int>(std::ceil(radius));
    const int cx = static_cast<int>(p[0]);
    const int cy = static_cast<int>(p[1]);
    for (int y = std::max(0, cy - reach); y <= std::min(height_ - 1, cy + reach); ++y)
      for (int x = std::max(0, cx - reach); x <= std::min(width_ - 1, cx + reach); ++x) {
        const double distance = std::hypot(x + 0.5 - p[0], y + 0.5 - p[1]);
        if (distance > radius) continue;
        if (!marker.is_on_top && depth > hits_[index(x, y)].depth) continue;
        image_.at(x, y) = marker.colour;
      }
  }

  const PaintedMesh& scene_;
  const Camera& camera_;
  const RenderOptions& options_;
  int width_;
  int height_;
  Projection projection_;
  Image image_;
  std::vector<Hit> hits_;
};

}  // namespace

Image render(const PaintedMesh& scene, const std::vector<Marker>& markers,
             const Camera& camera, const RenderOptions& options) {
  assert(scene.paints.size() == scene.mesh.triangles.size());
  return Renderer(scene, camera, options).run(markers);
}

}  // namespace picture
}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "generated_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

const double kPi = std::acos(-1.0);

Vector3<double> snapped(Vector3<double> p) {
  for (int k = 0; k < 3; ++k) p[k] = std::nearbyint(p[k] * 0x1p30) * 0x1p-30;
  return p;
}

double bump(double x, double y, double sigma) {
  return std::exp(-(x * x + y * y) / (2 * sigma * sigma));
}

double smoothStep(double x) {
  x = std::max(0., std::min(1., x));
  return x * x * (3 - 2 * x);
}

/// A height over the plane, the same for both layers. So where one layer lies over the
/// other, their distance is that of the flat layers.
class Waves {
 public:
  explicit Waves(Random& random) {
    for (double& phase : phases_) phase = random.uniform(0, 2 * kPi);
  }
  double operator()(double x, double y, double t) const {
    return 0.06 * std::sin(8 * x + phases_[0] + 0.15 * t) * std::cos(7 * y + phases_[1]) +
           0.03 * std::sin(13 * x + 11 * y + phases_[2] - 0.2 * t);
  }

 private:
  double phases_[3];
};

/// A sheet of nx x ny quads over the unit square. Its inner vertices are moved a little
/// at random, so that edges of two layers are not parallel, as on a real mesh.
TestMesh makeIrregularSheet(int nx, int ny, Random& random) {
  TestMesh sheet = makeSheet(nx, ny);
  for (auto& p : sheet.vertices) {
    const double du = random.uniform(-0.2, 0.2) / nx, dv = random.uniform(-0.2, 0.2) / ny;
    if (p[0] > 0 && p[0] < 1) p[0] += du;
    if (p[1] > 0 && p[1] < 1) p[1] += dv;
  }
  return sheet;
}

/// The cloth of makeSmoothCloth().
class SmoothCloth {
 public:
  SmoothCloth(int triangles, std::uint64_t seed) {
    Random random(seed);
    waves_ = Waves(random);
    const int across =
        std::max(4, static_cast<int>(std::lround(std::sqrt(triangles / (2 * kLength)))));
    const int along = std::max(4, triangles / (2 * across));
    sheet_ = makeIrregularSheet(along, across, random);
  }

  const std::vector<Triangle>& triangles() const { return sheet_.triangles; }

  /// @param t  moves the waves and the whole sheet
  /// @param sunk  0: the lip is above the layer below; 1: a little under it
  std::vector<Vector3<double>> frame(double t, double sunk) const {
    constexpr double kRadius = 0.05, kGap = 0.02, kPenetration = 0.01;
    const double depth = 2 * kRadius - kGap + sunk * (kGap + kPenetration);
    const double bend = kPi * kRadius;
    std::vector<Vector3<double>> points;
    points.reserve(sheet_.vertices.size());
    for (const auto& uv : sheet_.vertices) {
      const double s = kLength * uv[0], y = uv[1];
      double x = s, z = 0;
      if (s > 1 + bend) {
        const double on_lip = s - 1 - bend;
        x = 1 - on_lip;
        z = 2 * kRadius -
            depth * smoothStep(on_lip / 0.05) * bump(x - 0.87, y - 0.5, 0.06);
      } else if (s > 1) {
        x = 1 + kRadius * std::sin((s - 1) / kRadius);
        z = kRadius * (1 - std::cos((s - 1) / kRadius));
      }
      z += waves_(x, y, t);
      points.push_back(snapped({x + 0.01 * t, y + 0.004 * t, z - 0.006 * t}));
    }
    return points;
  }

 private:
  static constexpr double kLength = 1.4;
  Random no_random_{0};
  Waves waves_{no_random_};
  TestMesh sheet_;
};

TestMesh bumpy(TestMesh mesh, double phase, const Vector3<double>& center) {
  for (auto& p : mesh.vertices)
    p = snapped(p * (1 + 0.02 * std::sin(9 * p[0] + phase) * std::sin(7 * p[1] - phase)) +
                center);
  return mesh;
}

}  // namespace

FramePairMesh makeSmoothCloth(int triangles, std::uint64_t seed) {
  const SmoothCloth cloth(triangles, seed);
  return {cloth.frame(0, 0), cloth.frame(1, 1), cloth.triangles()};
}

FramePairMesh makeTiles(int triangles, std::uint64_t seed) {
  constexpr int kQuads = 16;  // 2 layers of 2 * 16^2 triangles
  constexpr double kSpacing = 1.6, kGap = 0.1;
  Random random(seed);
  const int tiles = (triangles + kTileTriangles - 1) / kTileTriangles;
  const int side = static_cast<int>(std::ceil(std::cbrt(tiles)));
  FramePairMesh mesh;
  const auto vertices = static_cast<std::size_t>(tiles * 2 * (kQuads + 1) * (kQuads + 1));
  mesh.previous.reserve(vertices);
  mesh.current.reserve(vertices);
  mesh.triangles.reserve(static_cast<std::size_t>(tiles * kTileTriangles));
  for (int tile = 0; tile < tiles; ++tile) {
    const Vector3<double> place(tile % side, tile / side % side, tile / side / side);
    const Waves waves(random);
    const double yaw = random.uniform(0, 2 * kPi);
    const double spot[2] = {random.uniform(0.3, 0.7), random.uniform(0.3, 0.7)};
    const auto position = [&](double u, double v, bool upper, double t) {
      // The upper layer is shifted by half a quad and sinks below the lower one.
      const double x = upper ? u + 0.5 / kQuads : u, y = upper ? v + 0.3 / kQuads : v;
      const double over =
          upper ? kGap * (1 - (0.6 + 0.6 * t) * bump(x - spot[0], y - spot[1], 0.15)) : 0;
      const double z = waves(x, y, t) + over;
      const double c = std::cos(yaw), s = std::sin(yaw);
      return snapped({kSpacing * place[0] + c * (x - 0.5) - s * (y - 0.5) + 0.02 * t,
                      kSpacing * place[1] + s * (x - 0.5) + c * (y - 0.5) - 0.01 * t,
                      kSpacing * place[2] + z});
    };
    for (const bool upper : {false, true}) {
      const TestMesh sheet = makeIrregularSheet(kQuads, kQuads, random);
      const std::size_t first = mesh.previous.size();
      for (const auto& uv : sheet.vertices) {
        mesh.previous.push_back(position(uv[0], uv[1], upper, 0));
        mesh.current.push_back(position(uv[0], uv[1], upper, 1));
      }
      for (const Triangle& t : sheet.triangles)
        mesh.triangles.emplace_back(t[0] + first, t[1] + first, t[2] + first);
    }
  }
  return mesh;
}

std::pair<FramePairMesh, FramePairMesh> makeMeetingBodies(int subdivisions) {
  const TestMesh sphere = makeIcosphere(subdivisions, 1);
  const auto body = [&](double phase, const Vector3<double>& from,
                        const Vector3<double>& to) {
    return FramePairMesh{bumpy(sphere, phase, from).vertices,
                         bumpy(sphere, phase + 0.3, to).vertices, sphere.triangles};
  };
  return {body(0, {0, 0, 0}, {0.02, 0, 0}),
          body(2, {2.11, 0.3, 0.2}, {1.93, 0.28, 0.17})};
}

std::pair<FramePairMesh, FramePairMesh> makeLayers(int triangles, std::uint64_t seed) {
  constexpr double kGap = 1e-6, kRoughness = 1e-8;
  const int quads = static_cast<int>(std::ceil(std::sqrt(triangles / 2.)));
  Random random(seed);
  const auto layer = [&](double height, double way) {
    const TestMesh sheet = makeIrregularSheet(quads, quads, random);
    FramePairMesh mesh{{}, {}, sheet.triangles};
    for (const auto& uv : sheet.vertices) {
      const double z = height + random.uniform(0, kRoughness);
      mesh.previous.push_back(snapped({uv[0], uv[1], z}));
      mesh.current.push_back(snapped({uv[0], uv[1], z - way * random.uniform(1, 1.1)}));
    }
    return mesh;
  };
  return {layer(0, 0), layer(kGap, 1)};
}

std::pair<FramePairMesh, FramePairMesh> makeThrownSpheres(int subdivisions,
                                                          std::uint64_t seed) {
  constexpr double kFar = 1e4;
  const TestMesh sphere = makeIcosphere(subdivisions, 1);
  Random random(seed);
  const auto body = [&](double x) {
    FramePairMesh mesh{{}, {}, sphere.triangles};
    for (const auto& p : sphere.vertices) {
      mesh.previous.push_back(snapped(p + Vector3<double>(x, 0, 0)));
      mesh.current.push_back(snapped(mesh.previous.back() + random.point(kFar)));
    }
    return mesh;
  };
  return {body(0), body(2.1)};
}

void move(FramePairMesh& mesh, const Vector3<double>& by) {
  for (auto* points : {&mesh.previous, &mesh.current})
    for (auto& p : *points) p += by;
}

FrameSequence makeCrumplingSheet(int frames) {
  constexpr int kAlong = 160, kAcross = 64, kPleats = 8, kSubsteps = 8;
  // If the direction of a sine-generated curve swings by 2.2 radians, neighbouring loops
  // touch.
  constexpr double kTightest = 2.12, kVariation = 0.06;
  FrameSequence sequence{makeSheet(kAlong, kAcross).triangles, {}};
  for (int frame = 0; frame < frames; ++frame) {
    const double s = static_cast<double>(frame) / (frames - 1);
    std::vector<Vector3<double>> points;
    std::vector<std::array<double, 2>> curve(kAlong + 1);
    for (int j = 0; j <= kAcross; ++j) {
      const double v = static_cast<double>(j) / kAcross;
      const double swing =
          kTightest * (0.05 + 0.95 * s) * (1 + kVariation * std::sin(9 * v + 3 * s));
      double x = 0, z = 0;
      for (int i = 0; i <= kAlong; ++i) {
        curve[static_cast<std::size_t>(i)] = {x, z};
        for (int k = 0; k < kSubsteps; ++k) {
          const double u = (i + (k + 0.5) / kSubsteps) / kAlong;
          const double direction = swing * std::cos(2 * kPi * kPleats * u);
          x += std::cos(direction) / (kAlong * kSubsteps);
          z += std::sin(direction) / (kAlong * kSubsteps);
        }
      }
      const double middle = curve[kAlong / 2][0];
      for (const auto& c : curve) {
        // Twisted about the x axis. Points that are apart stay apart.
        const double along = c[0] - middle, turn = 2 * s * (along + 0.5);
        const double y = v - 0.5;
        points.push_back(snapped({along, std::cos(turn) * y - std::sin(turn) * c[1],
                                  std::sin(turn) * y + std::cos(turn) * c[1]}));
      }
    }
    sequence.frames.push_back(std::move(points));
  }
  return sequence;
}

FrameSequence makeWavingCloth(int frames, std::uint64_t seed) {
  const SmoothCloth cloth(20000, seed);
  FrameSequence sequence{cloth.triangles(), {}};
  for (int frame = 0; frame < frames; ++frame)
    sequence.frames.push_back(
        cloth.frame(frame, 0.5 - 0.5 * std::cos(2 * kPi * frame / 20)));
  return sequence;
}

FrameSequence makeMixingBalls(int frames, int slices) {
  constexpr int kBalls = 340;
  struct Orbit {
    double radius, height, phase, speed;
  };
  Random random(1);
  std::vector<Orbit> orbits;
  TestMesh mesh;
  const TestMesh ball = makeUvSphere(slices, 6, 0.05);
  for (int i = 0; i < kBalls; ++i) {
    const double radius = random.uniform(0.1, 1), height = random.uniform(-0.5, 0.5);
    orbits.push_back({radius, height, random.uniform(0, 2 * kPi),
                      0.06 / (0.3 + radius) * (random.index(2) ? 1 : -1)});
    append(mesh, ball);
  }
  FrameSequence sequence{mesh.triangles, {}};
  for (int frame = 0; frame < frames; ++frame) {
    std::vector<Vector3<double>> points;
    for (const Orbit& o : orbits) {
      const double angle = o.phase + o.speed * frame;
      const Vector3<double> center(o.radius * std::cos(angle), o.radius * std::sin(angle),
                                   o.height * std::cos(0.05 * frame + o.phase));
      for (const auto& p : ball.vertices) points.push_back(snapped(center + p));
    }
    sequence.frames.push_back(std::move(points));
  }
  return sequence;
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "sliding/scenes.h"

#include <cmath>
#include <limits>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/math/bv/AABB.h"
#include "fcl/math/bv/OBBRSS.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Vector = Vector3<double>;

constexpr int kSlices = 400, kRings = 100;
constexpr double kRadius = 0.998, kQuarter = M_PI / 2, kWay = 0.5;

template <typename BV>
Geometry modelOf(const TestMesh& mesh) {
  auto model = std::make_shared<BVHModel<BV>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

TestMesh hole() {
  return makeRoundTube(kSlices, kRings,
                       [](double, double) { return holeRadius(kSlices); });
}

TestMesh tube() {
  return makeRoundTube(kSlices, kRings, [](double, double) { return kRadius; });
}

template <typename BV>
Scene tubeSlides(const std::string& name) {
  Scene scene;
  scene.name = name;
  scene.moving = modelOf<BV>(tube());
  scene.still = modelOf<BV>(hole());
  scene.way = kWay;
  return scene;
}

Scene tubeAtADistance() {
  Scene scene = tubeSlides<OBBRSS<double>>("tube_slides_distance");
  scene.distance = 1e-6;
  scene.is_for_stock = false;
  return scene;
}

/// A mesh whose vertices go straight from their first to their last place.
struct Deforming {
  std::vector<Vector> first, last;
  std::shared_ptr<DeformableBVHModel<>> model = std::make_shared<DeformableBVHModel<>>();

  Deforming(const TestMesh& mesh, const std::function<Vector(const Vector&)>& lastPlace)
      : first(mesh.vertices) {
    for (const Vector& p : first) last.push_back(lastPlace(p));
    model->beginModel();
    model->addSubModel(first, mesh.triangles);
    model->endModel(FclTree::kSkip);
  }

  std::vector<Vector> at(double t) const {
    std::vector<Vector> out;
    for (std::size_t i = 0; i < first.size(); ++i)
      out.push_back((1 - t) * first[i] + t * last[i]);
    return out;
  }

  void update(double from, double to) const {
    const std::vector<Vector> begin = at(from), end = at(to);
    model->updateFrames(begin[0].data(), end[0].data(), begin.size());
  }
};

Scene tubeDeforms() {
  Scene scene;
  scene.name = "tube_slides_deforming";
  const Deforming inner(tube(), [](const Vector& p) {
    return Vector((1 + 1e-7 * p[2]) * p + Vector(0, 0, kWay));
  });
  const Deforming outer(
      hole(), [](const Vector& p) { return Vector(p[0], p[1], 1.0001 * p[2]); });
  scene.moving = inner.model;
  scene.still = outer.model;
  scene.is_for_stock = false;
  scene.deform = [inner, outer](double from, double to) {
    inner.update(from, to);
    outer.update(from, to);
  };
  return scene;
}

/// The hole becomes narrow: its radius is that of the tube 0.05 of a ring's height after
/// the ring at 0.92. Corners lie at the same angles, so that edges meet.
Scene tubeReachesANarrowPlace() {
  constexpr double kStep = 0.02, kRing = 2. / kRings, kLastWide = 0.92;
  Scene scene;
  scene.name = "tube_slides_into_funnel";
  TestMesh plug = tube();
  for (Vector& p : plug.vertices) p[2] -= 1;
  scene.moving = modelOf<OBBRSS<double>>(plug);
  scene.still =
      modelOf<OBBRSS<double>>(makeRoundTube(kSlices, kRings, [=](double, double z) {
        return holeRadius(kSlices) - (z > kLastWide + kRing / 2 ? kStep : 0);
      }));
  scene.way = 1;
  scene.truth = kLastWide + kRing * (holeRadius(kSlices) - kRadius) / kStep;
  return scene;
}

Scene shapeInHole(const std::string& name, const Geometry& shape, double angle,
                  double way) {
  Scene scene;
  scene.name = name;
  scene.moving = shape;
  scene.still = modelOf<OBBRSS<double>>(hole());
  scene.angle = angle;
  scene.way = way;
  return scene;
}

/// Two threads of 12,000 triangles, 2.5 turns in a unit of length. Their edges leave the
/// round surface by less than 0.002. They are 0.005 apart, and meet if the bolt turns by
/// 30 degrees without its pitch.
Scene boltInNut(const std::string& name, bool has_pitch) {
  constexpr double kTurns = 2.5, kClearance = 0.005, kDepth = 0.02;
  const auto thread = [](double radius) {
    return modelOf<OBBRSS<double>>(
        makeRoundTube(100, 60, [radius](double angle, double z) {
          return radius + kDepth * std::cos(2 * M_PI * kTurns * z - angle);
        }));
  };
  Scene scene;
  scene.name = name;
  scene.moving = thread(1);
  scene.still = thread(1 + kClearance);
  scene.angle = M_PI / 6;
  if (has_pitch)
    scene.way = scene.angle / (2 * M_PI * kTurns);
  else
    scene.truth = std::numeric_limits<double>::quiet_NaN();
  return scene;
}

}  // namespace

std::vector<std::function<Scene()>> slidingScenes() {
  const auto shape = [](const char* name, Geometry geometry, double angle, double way) {
    return [=] { return shapeInHole(name, geometry, angle, way); };
  };
  const auto cylinder = std::make_shared<Cylinder<double>>(kRadius, 2);
  return {
      [] { return tubeSlides<OBBRSS<double>>("tube_slides"); },
      tubeAtADistance,
      [] { return tubeSlides<AABB<double>>("tube_slides_aabb"); },
      tubeDeforms,
      tubeReachesANarrowPlace,
      shape("cylinder_turns", cylinder, kQuarter, 0),
      shape("cylinder_slides", cylinder, 0, kWay),
      shape("capsule_turns", std::make_shared<Capsule<double>>(kRadius, 1), kQuarter, 0),
      shape("ellipsoid_turns", std::make_shared<Ellipsoid<double>>(kRadius, kRadius, 1.2),
            kQuarter, 0),
      [] { return boltInNut("bolt_in_nut_with_pitch", true); },
      [] { return boltInNut("bolt_in_nut_without_pitch", false); }};
}

}  // namespace test
}  // namespace fcl

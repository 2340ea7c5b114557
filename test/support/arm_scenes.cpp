// SPDX-License-Identifier: BSD-3-Clause
#include "arm_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/distance.h"
#include "reference_motion.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Tf = Transform3<double>;

Tf tfOf(const Matrix3<double>& rotation, const Vector& translation) {
  Tf tf = Tf::Identity();
  tf.linear() = rotation;
  tf.translation() = translation;
  return tf;
}

ArmGeometry modelOf(const TestMesh& mesh) {
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

/// Whether the balls around two geometries are apart.
bool areFar(const CollisionGeometry<double>& x, const Tf& tf_x,
            const CollisionGeometry<double>& y, const Tf& tf_y) {
  const double most = x.aabb_radius + y.aabb_radius;
  return (tf_x * x.aabb_center - tf_y * y.aabb_center).squaredNorm() > most * most;
}

bool doTouch(const CollisionGeometry<double>& x, const Tf& tf_x,
             const CollisionGeometry<double>& y, const Tf& tf_y) {
  if (areFar(x, tf_x, y, tf_y)) return false;
  const CollisionRequest<double> request;
  CollisionResult<double> result;
  return fcl::collide(&x, tf_x, &y, tf_y, request, result) > 0;
}

}  // namespace

int ArmScene::addJoint(const Tf& origin, const Vector& axis, bool slides) {
  joints_.push_back({origin, axis.normalized(), slides});
  return slides ? chain_.addPrismatic(origin, axis) : chain_.addRevolute(origin, axis);
}

void ArmScene::addPart(int link, const ArmGeometry& geometry, const Tf& origin) {
  geometry->computeLocalAABB();
  parts_.push_back({link, geometry, origin});
}

void ArmScene::addObstacle(const ArmGeometry& geometry, const Tf& pose) {
  geometry->computeLocalAABB();
  const auto rest = fcl::make_aligned_shared<TranslationMotion<double>>(pose, pose);
  obstacles_.push_back(
      {geometry, pose,
       std::make_unique<ContinuousCollisionObject<double>>(geometry, rest)});
  manager_.registerObject(obstacles_.back().object.get());
}

CollisionRobot<double> ArmScene::robot() const {
  CollisionRobot<double> robot(chain_);
  robot.allowNeighbours();
  for (const Part& part : parts_) robot.attach(part.link, part.geometry, part.origin);
  return robot;
}

int ArmScene::numberOf(const ContinuousCollisionObject<double>* obstacle) const {
  for (std::size_t i = 0; i < obstacles_.size(); ++i)
    if (obstacles_[i].object.get() == obstacle) return static_cast<int>(i);
  return -1;
}

bool ArmScene::areTested(std::size_t part1, std::size_t part2) const {
  return std::abs(parts_[part1].link - parts_[part2].link) > 1;
}

std::vector<Tf> ArmScene::partPoses(const JointValues& values) const {
  std::vector<Tf> links;
  Tf at = Tf::Identity();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    at = at * joint.origin;
    if (joint.slides)
      at = at * Translation3<double>(values[i] * joint.axis);
    else
      at = at * AngleAxis<double>(values[i], joint.axis);
    links.push_back(at);
  }
  std::vector<Tf> poses;
  for (const Part& part : parts_)
    poses.push_back(part.link < 0 ? part.origin
                                  : links[std::size_t(part.link)] * part.origin);
  return poses;
}

ArmBodies ArmScene::touching(const JointValues& values) const {
  const std::vector<Tf> poses = partPoses(values);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const auto& own = *parts_[i].geometry;
    for (std::size_t k = 0; k < obstacles_.size(); ++k)
      if (doTouch(own, poses[i], *obstacles_[k].geometry, obstacles_[k].pose))
        return {static_cast<int>(i), -1, static_cast<int>(k)};
    for (std::size_t k = 0; k < i; ++k)
      if (areTested(i, k) && doTouch(own, poses[i], *parts_[k].geometry, poses[k]))
        return {static_cast<int>(k), static_cast<int>(i), -1};
  }
  return {};
}

double ArmScene::distance(const ArmBodies& bodies, const JointValues& values) const {
  const std::vector<Tf> poses = partPoses(values);
  const std::size_t i = std::size_t(bodies.part1);
  const bool is_own = bodies.obstacle < 0;
  const std::size_t k = std::size_t(is_own ? bodies.part2 : bodies.obstacle);
  const auto& x = *parts_[i].geometry;
  const auto& y = is_own ? *parts_[k].geometry : *obstacles_[k].geometry;
  const Tf &tf_x = poses[i], &tf_y = is_own ? poses[k] : obstacles_[k].pose;
  if (doTouch(x, tf_x, y, tf_y)) return 0;
  const DistanceRequest<double> request;
  DistanceResult<double> result;
  return fcl::distance(&x, tf_x, &y, tf_y, request, result);
}

void makeRandomArm(Random& random, ArmScene& scene) {
  const std::size_t count = 3 + random.index(5);
  const auto geometryOf = [&](double length) -> ArmGeometry {
    const double r = random.uniform(.03, .08);
    switch (random.index(4)) {
      case 0:
        return std::make_shared<Capsule<double>>(r, length);
      case 1:
        return std::make_shared<Box<double>>(r, r, length);
      case 2: {
        TestMesh mesh = makeCapsule(8, 4, r, length);
        for (Vector& p : mesh.vertices) p.z() -= .5 * length;
        return modelOf(mesh);
      }
      default:
        return modelOf(makeBox({r, r, .5 * length}));
    }
  };
  double length = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Tf turned = tfOf(randomRotation(random), Vector(0, 0, length));
    const int link =
        scene.addJoint(turned, randomDirection(random), random.index(6) == 0);
    length = random.uniform(.2, .6);
    scene.addPart(link, geometryOf(.8 * length),
                  Tf(Translation3<double>(0, 0, .5 * length)));
    if (random.index(3) == 0)
      scene.addPart(link, geometryOf(.2), tfOf(randomRotation(random), random.point(.1)));
  }
  for (std::size_t i = 3 + random.index(6); i > 0; --i) {
    ArmGeometry geometry;
    if (random.index(3) == 0)
      geometry = std::make_shared<Sphere<double>>(random.uniform(.03, .1));
    else
      geometry =
          modelOf(makeBox({random.uniform(.01, .5), random.uniform(.01, .03), .02}));
    scene.addObstacle(geometry, tfOf(randomRotation(random), random.point(1.2)));
  }
}

void makeSixAxisArm(ArmScene& scene) {
  const Vector x = Vector::UnitX(), y = Vector::UnitY(), z = Vector::UnitZ();
  const Vector axes[] = {z, y, y, x, y, x};
  // From the frame of a joint to the next one; the last is the tool.
  const Vector bones[] = {{0, 0, .3},  {0, 0, .45}, {0, 0, .15},
                          {.35, 0, 0}, {.12, 0, 0}, {.15, 0, 0}};
  const double radii[] = {.08, .06, .06, .05, .045, .03};
  const Matrix3<double> z_to_x =
      AngleAxis<double>(std::acos(0.), Vector::UnitY()).toRotationMatrix();
  Vector origin(0, 0, .1);
  for (int i = 0; i < 6; ++i) {
    const int link = scene.addJoint(Tf(Translation3<double>(origin)), axes[i]);
    // Capsules of 544 triangles.
    scene.addPart(
        link, modelOf(makeCapsule(16, 6, radii[i], bones[i].norm())),
        tfOf(bones[i].x() > 0 ? z_to_x : Matrix3<double>::Identity(), Vector::Zero()));
    origin = bones[i];
  }
  for (int i = 0; i < 12; ++i) {
    // Bars of 1 cm around the arm, along x, y and z in turn.
    const double angle = std::acos(-1.) / 6 * i, height = .2 + .15 * (i % 5),
                 distance = .45 + .05 * (i % 4);
    Vector half(.005, .005, .005);
    half[i % 3] = .25;
    scene.addObstacle(modelOf(makeBox(half)),
                      Tf(Translation3<double>(distance * std::cos(angle),
                                              distance * std::sin(angle), height)));
  }
}

JointValues randomValues(Random& random, std::size_t count) {
  JointValues values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(random.uniform(-3, 3));
  return values;
}

JointValues nearValues(Random& random, const JointValues& values, double most) {
  JointValues out = values;
  for (double& value : out) value += random.uniform(-most, most);
  return out;
}

JointValues valuesBetween(const JointValues& from, const JointValues& to, double t) {
  JointValues out;
  for (std::size_t i = 0; i < from.size(); ++i)
    out.push_back((1 - t) * from[i] + t * to[i]);
  return out;
}

SampledContact sampledContact(const ArmScene& scene, const JointValues& from,
                              const JointValues& to, double step) {
  double most = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    most = std::max(most, std::abs(to[i] - from[i]));
  const int count = std::max(1, static_cast<int>(std::ceil(most / step)));
  for (int i = 0; i <= count; ++i) {
    const double t = double(i) / count;
    const ArmBodies bodies = scene.touching(valuesBetween(from, to, t));
    if (bodies.exist()) return {bodies, t};
  }
  return {};
}

}  // namespace test
}  // namespace fcl

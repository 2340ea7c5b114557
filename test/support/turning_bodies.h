// SPDX-License-Identifier: BSD-3-Clause
//
// Rigid meshes on the paths of reference motions, as queries take them.
#ifndef FCL_TEST_SUPPORT_TURNING_BODIES_H
#define FCL_TEST_SUPPORT_TURNING_BODIES_H

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

// FCL's templates that are in the library are not compiled again.
#include "curved/curved_query.h"
#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/collision.h"
#include "model/fcl_tree.h"
#include "model/model_instances.h"
#include "reference_motion.h"

namespace fcl {
namespace test {

/// @brief A mesh with FCL's tree.
struct Body {
  using Model = BVHModel<OBBRSS<double>>;

  explicit Body(TestMesh m) : mesh(std::move(m)), model(std::make_shared<Model>()) {
    model->beginModel(static_cast<int>(mesh.triangles.size()),
                      static_cast<int>(mesh.vertices.size()));
    model->addSubModel(mesh.vertices, mesh.triangles);
    model->endModel();
  }
  TestMesh mesh;
  std::shared_ptr<Model> model;
};

/// @brief A body on its path.
struct BodyOnPath {
  BodyOnPath(const Body& from, const detail::deformable::MotionPath& path)
      : tree(detail::deformable::fclTree(*from.model), detail::deformable::Pose()),
        body(tree,
             detail::deformable::VertexFrames(from.model->vertices->data(),
                                              from.model->vertices->data(),
                                              from.mesh.vertices.size()),
             from.model->tri_indices, path) {}
  BodyOnPath(const BodyOnPath&) = delete;
  BodyOnPath& operator=(const BodyOnPath&) = delete;
  detail::deformable::RigidTree tree;
  detail::deformable::MovingBody body;
};

inline detail::deformable::CurvedAnswer ask(
    const Body& a, const detail::deformable::MotionPath& path_a, const Body& b,
    const detail::deformable::MotionPath& path_b,
    const detail::deformable::CurvedOptions& options = {}) {
  return queryCurved(BodyOnPath(a, path_a).body, BodyOnPath(b, path_b).body, options);
}

/// @brief The first time of contact; 2 without a contact.
inline double timeOf(const detail::deformable::CurvedAnswer& answer) {
  return answer.contacts.empty() ? 2 : answer.contacts[0].toc_lo;
}

inline Transform3<double> asTransform(const RealPose& pose) {
  Transform3<double> tf = Transform3<double>::Identity();
  tf.linear() = pose.rotation.cast<double>();
  tf.translation() = pose.translation.cast<double>();
  return tf;
}

/// @brief The first time at which FCL's discrete query finds a collision: a sample, then
/// bisection between it and the previous one; 2 without collision.
inline double sampledTime(const Body& a, const ReferenceMotion& motion_a, const Body& b,
                          const ReferenceMotion& motion_b, int samples) {
  const auto collides = [&](double t) {
    CollisionResult<double> result;
    return collide(a.model.get(), asTransform(motion_a.at(t)), b.model.get(),
                   asTransform(motion_b.at(t)), CollisionRequest<double>(), result) > 0;
  };
  for (int i = 0; i <= samples; ++i) {
    double hi = static_cast<double>(i) / samples;
    if (!collides(hi)) continue;
    double lo = std::max(0., hi - 1. / samples);
    for (int k = 0; k < 30 && i > 0; ++k) {
      const double middle = 0.5 * (lo + hi);
      (collides(middle) ? hi : lo) = middle;
    }
    return hi;
  }
  return 2;
}

/// @brief Four bodies: an ellipsoid, a bumpy ball, a box, a capsule.
inline std::vector<Body> makeBodies() {
  TestMesh ellipsoid = makeUvSphere(20, 15, 0.5), bumpy = makeIcosphere(3, 0.4);
  for (auto& p : ellipsoid.vertices) p = Vector3<double>(p[0], 0.6 * p[1], 0.3 * p[2]);
  for (auto& p : bumpy.vertices) p *= 1 + 0.1 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
  std::vector<Body> bodies;
  bodies.emplace_back(ellipsoid);
  bodies.emplace_back(bumpy);
  bodies.emplace_back(makeBox({0.4, 0.25, 0.15}, 8));
  bodies.emplace_back(makeCapsule(12, 10, 0.15, 0.6));
  return bodies;
}

/// @brief Moves b so that it passes a at a distance, or hits it with a depth, of 1e-2 to
/// 1e-6.
inline void makeGrazing(Random& random, const Body& a, const ReferenceMotion& motion_a,
                        const Body& b, ReferenceMotion& motion_b) {
  constexpr double kDepths[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  const Vector3<double> direction = randomDirection(random);
  const auto isHit = [&](double offset) {
    ReferenceMotion moved = motion_b;
    moved.move(offset * direction);
    return !ask(a, motion_a.path(), b, moved.path()).contacts.empty();
  };
  double lo = 3;
  while (lo > -3 && !isHit(lo)) lo -= 0.1;
  double hi = lo + 0.1;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (isHit(middle) ? lo : hi) = middle;
  }
  const double depth = kDepths[random.index(5)];
  motion_b.move((random.index(2) ? lo - depth : hi + depth) * direction);
}

}  // namespace test
}  // namespace fcl

#endif

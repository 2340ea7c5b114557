// SPDX-License-Identifier: BSD-3-Clause
#include "approach/large_meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/continuous_distance.h"
#include "fcl/narrowphase/distance.h"
#include "mesh_generators.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using Model = BVHModel<OBBRSS<double>>;
using V = Vector3<double>;
using Pose = Transform3<double>;

std::shared_ptr<Model> modelOf(const TestMesh& mesh) {
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

/// 100,800 triangles, about one unit long.
TestMesh ellipsoid() {
  TestMesh mesh = makeUvSphere(240, 211, 0.5);
  for (V& p : mesh.vertices) p = V(p[0], 0.6 * p[1], 0.3 * p[2]);
  return mesh;
}

/// 81,920 triangles.
TestMesh bumpyBall() {
  TestMesh mesh = makeIcosphere(6, 0.4);
  for (V& p : mesh.vertices) p *= 1 + 0.1 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
  return mesh;
}

/// The first mesh turns by 90 degrees while it passes the second one.
struct Motion {
  Pose begin, end, other_begin, other_end;

  Motion(Random& random) {
    const auto anyRotation = [&random] {
      return AngleAxis<double>(3 * random.point(1)[0], random.point(1).normalized())
          .toRotationMatrix();
    };
    begin = end = other_begin = other_end = Pose::Identity();
    begin.linear() = anyRotation();
    end.linear() =
        AngleAxis<double>(M_PI / 2, random.point(1).normalized()) * begin.linear();
    other_begin.linear() = anyRotation();
    other_end.linear() =
        AngleAxis<double>(M_PI / 2, random.point(1).normalized()) * other_begin.linear();
    const V way = random.point(0.5);
    begin.translation() = -way;
    end.translation() = way;
    other_begin.translation() = other_end.translation() =
        1.5 * random.point(1).normalized();
  }

  void shift(const V& by) {
    other_begin.pretranslate(by);
    other_end.pretranslate(by);
  }

  std::shared_ptr<InterpMotion<double>> path(int k) const {
    const Pose &from = k == 0 ? begin : other_begin, &to = k == 0 ? end : other_end;
    return std::make_shared<InterpMotion<double>>(
        from.linear(), from.translation(), to.linear(), to.translation(), V::Zero());
  }
};

class Scene {
 public:
  Scene() : body_{modelOf(ellipsoid()), modelOf(bumpyBall())} {}

  ContinuousDistanceResult<double> distance(const Motion& motion, double rel_err) const {
    ContinuousDistanceRequest<double> request;
    request.rel_err = rel_err;
    ContinuousDistanceResult<double> result;
    continuousDistance(body_[0].get(), motion.path(0).get(), body_[1].get(),
                       motion.path(1).get(), request, result);
    return result;
  }

  bool collides(const Motion& motion) const {
    ContinuousCollisionRequest<double> request;
    ContinuousCollisionResult<double> result;
    continuousCollide(body_[0].get(), motion.path(0).get(), body_[1].get(),
                      motion.path(1).get(), request, result);
    return result.is_collide;
  }

  /// The least distance of samples by FCL, and the one at a time.
  double sampledDistance(const Motion& motion, double t) const {
    Pose pose[2];
    for (int k = 0; k < 2; ++k) {
      const auto path = motion.path(k);
      path->integrate(t);
      path->getCurrentTransform(pose[k]);
    }
    DistanceRequest<double> request;
    DistanceResult<double> result;
    return fcl::distance(body_[0].get(), pose[0], body_[1].get(), pose[1], request,
                         result);
  }

 private:
  std::shared_ptr<Model> body_[2];
};

/// Moves the second mesh until the least distance is about `gap`.
bool setGap(const Scene& scene, double gap, Motion& motion) {
  constexpr int kRounds = 12;
  for (int i = 0; i < kRounds; ++i) {
    const auto found = scene.distance(motion, 1e-3);
    if (found.is_collide || !(found.distance_lo > 0)) {
      motion.shift(0.2 * motion.other_begin.translation().normalized());
      continue;
    }
    if (std::abs(found.distance_hi - gap) < 0.1 * gap) return true;
    const V between = found.nearest_points[1] - found.nearest_points[0];
    motion.shift((gap - found.distance_hi) * between.normalized());
  }
  return false;
}

double medianOf(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

/// The median of three runs.
template <typename Call>
double typicalMilliseconds(Call&& call) {
  return medianOf(
      {cpuMillisecondsOf(call), cpuMillisecondsOf(call), cpuMillisecondsOf(call)});
}

}  // namespace

int measureLargeMeshes(int motions) {
  constexpr int kSamples = 32;
  constexpr double kFclError = 1e-9;
  const Scene scene;
  int wrong = 0;
  std::printf("gap,rel_err,motions,distance_ms,first_contact_ms,wrong,widest\n");
  for (const double gap : {0.3, 0.1, 1e-2, 1e-3, 1e-4})
    for (const double rel_err : {1e-2, 1e-3, 1e-6}) {
      Random random(1);
      std::vector<double> ms, contact_ms;
      int errors = 0;
      double widest = 0;
      for (int i = 0; i < motions; ++i) {
        Motion motion(random);
        if (!setGap(scene, gap, motion)) continue;
        ContinuousDistanceResult<double> found;
        ms.push_back(
            typicalMilliseconds([&] { found = scene.distance(motion, rel_err); }));
        bool collides = false;
        contact_ms.push_back(
            typicalMilliseconds([&] { collides = scene.collides(motion); }));
        double least = scene.sampledDistance(motion, found.time);
        errors += collides || least > found.distance_hi + kFclError;
        for (int k = 0; k <= kSamples && rel_err == 1e-3; ++k)
          least = std::min(least, scene.sampledDistance(motion, double(k) / kSamples));
        errors += least < found.distance_lo - kFclError;
        widest =
            std::max(widest, (found.distance_hi - found.distance_lo) / found.distance_hi);
      }
      wrong += errors;
      std::printf("%g,%g,%zu,%.4f,%.4f,%d,%.3g\n", gap, rel_err, ms.size(), medianOf(ms),
                  medianOf(contact_ms), errors, widest);
      std::fflush(stdout);
    }
  return wrong;
}

}  // namespace test
}  // namespace fcl

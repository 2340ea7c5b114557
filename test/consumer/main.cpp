// SPDX-License-Identifier: BSD-3-Clause
//
// A program that uses FCL's names only. A small plate flies through a large one. Both
// have no thickness, and they touch at none of the 10 times that stock FCL samples. So
// this program succeeds only if fcl_ccd answers the continuous queries.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_collision.h>

double timeThroughFclHeader(const fcl::CollisionGeometryd& a,
                            const fcl::CollisionGeometryd& b,
                            const fcl::Transform3d& b_beg, const fcl::Transform3d& b_end);

namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;
using fcl::Transform3d;
using fcl::Vector3d;

int failures = 0;

void expect(bool holds, const char* what) {
  std::printf("%s  %s\n", holds ? "ok    " : "FAILED", what);
  if (!holds) ++failures;
}

/// A square of two triangles around the origin, spanned by two half sides.
std::shared_ptr<Model> makePlate(const Vector3d& u, const Vector3d& v) {
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addTriangle(-u - v, u - v, u + v);
  model->addTriangle(-u - v, u + v, -u + v);
  model->endModel();
  model->computeLocalAABB();
  return model;
}

Transform3d at(double x, double y, double z) {
  Transform3d tf = Transform3d::Identity();
  tf.translation() = Vector3d(x, y, z);
  return tf;
}

/// The plates meet at 0.35; a time may be early by the request's tolerance, never late.
bool isTimeOfContact(double time) { return time <= 0.35 + 1e-12 && time >= 0.35 - 2e-4; }

struct BroadphaseAnswer {
  int pairs;
  bool collide;
  double time;
  const fcl::CollisionObjectd* falling;
};

/// A program's own broadphase callback: one object falls by 1. The object has no user
/// data that would say so, since FCL's constructors leave the user data unset.
bool fallAndCollide(fcl::CollisionObjectd* o1, fcl::CollisionObjectd* o2, void* data) {
  BroadphaseAnswer& answer = *static_cast<BroadphaseAnswer*>(data);
  ++answer.pairs;
  Transform3d o1_end = o1->getTransform(), o2_end = o2->getTransform();
  if (o1 == answer.falling) o1_end.translation().z() -= 1;
  if (o2 == answer.falling) o2_end.translation().z() -= 1;
  fcl::ContinuousCollisionResultd result;
  fcl::continuousCollide(o1, o1_end, o2, o2_end, fcl::ContinuousCollisionRequestd(),
                         result);
  if (result.is_collide) {
    answer.collide = true;
    answer.time = std::fmin(answer.time, result.time_of_contact);
  }
  return false;
}

}  // namespace

int main() {
  const auto large = makePlate(Vector3d(1, 0, 0), Vector3d(0, 1, 0));
  const auto small = makePlate(Vector3d(0.1, 0, 0), Vector3d(0, 0.1, 0));
  const Transform3d still = Transform3d::Identity();
  const Transform3d beg = at(0.3, 0.2, 0.35), end = at(0.3, 0.2, -0.65);

  {
    const auto upright = makePlate(Vector3d(0.1, 0, 0), Vector3d(0, 0, 0.1));
    fcl::CollisionRequestd request;
    fcl::CollisionResultd hit, miss;
    expect(fcl::collide(large.get(), still, upright.get(), at(0.3, 0.2, 0), request,
                        hit) > 0,
           "collide() of crossing plates");
    expect(fcl::collide(large.get(), still, upright.get(), at(0.3, 0.2, 0.5), request,
                        miss) == 0,
           "collide() of separate plates");
  }

  const fcl::ContinuousCollisionRequestd request;
  {
    fcl::ContinuousCollisionResultd result;
    const double time = fcl::continuousCollide(large.get(), still, still, small.get(),
                                               beg, end, request, result);
    expect(result.is_collide && result.time_of_contact == time && isTimeOfContact(time),
           "continuousCollide(geometry, transforms)");

    fcl::ContinuousCollisionResultd miss;
    fcl::continuousCollide(large.get(), still, still, small.get(), at(0.3, 0.2, 1.35),
                           at(0.3, 0.2, 0.35), request, miss);
    expect(!miss.is_collide, "continuousCollide(geometry, transforms) that stops before");
  }
  {
    const fcl::CollisionObjectd o1(large, still), o2(small, beg);
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&o1, still, &o2, end, request, result);
    expect(result.is_collide && isTimeOfContact(result.time_of_contact),
           "continuousCollide(objects)");
  }
  {
    const fcl::TranslationMotiond rest(still, still), fall(beg, end);
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(large.get(), &rest, small.get(), &fall, request, result);
    expect(result.is_collide && isTimeOfContact(result.time_of_contact),
           "continuousCollide(geometry, motions)");
  }
  {
    fcl::ContinuousCollisionObjectd o1(
        large, std::make_shared<fcl::TranslationMotiond>(still, still));
    fcl::ContinuousCollisionObjectd o2(
        small, std::make_shared<fcl::TranslationMotiond>(beg, end));
    fcl::ContinuousCollisionResultd result;
    fcl::collide(&o1, &o2, request, result);
    expect(result.is_collide && isTimeOfContact(result.time_of_contact),
           "collide(continuous objects)");

    fcl::DefaultContinuousCollisionData<double> data;
    fcl::DefaultContinuousCollisionFunction(&o1, &o2, &data);
    expect(data.result.is_collide && isTimeOfContact(data.result.time_of_contact),
           "DefaultContinuousCollisionFunction()");
  }
  {
    // Broadphase boxes are those of the start, so the large plate is tilted to have one
    // that holds the small plate: x + z = 0 there, met after 0.35 of the way.
    const auto tilted = makePlate(Vector3d(1, 0, -1), Vector3d(0, 1, 0));
    const auto point_like = makePlate(Vector3d(0.1, 0, -0.1), Vector3d(0, 0.1, 0));
    fcl::CollisionObjectd o1(tilted, still), o2(point_like, at(0.1, 0, 0.25));
    fcl::CollisionObjectd far_away(point_like, at(9, 9, 9));

    fcl::DynamicAABBTreeCollisionManagerd manager;
    for (fcl::CollisionObjectd* o : {&o1, &o2, &far_away}) manager.registerObject(o);
    manager.setup();
    BroadphaseAnswer answer = {0, false, 1, &o2};
    manager.collide(&answer, fallAndCollide);
    expect(answer.pairs == 1 && answer.collide && isTimeOfContact(answer.time),
           "continuousCollide() from a broadphase callback");
  }
  expect(isTimeOfContact(timeThroughFclHeader(*large, *small, beg, end)),
         "continuousCollide() through fcl/fcl.h");

  return failures == 0 ? 0 : 1;
}

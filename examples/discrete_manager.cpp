// SPDX-License-Identifier: BSD-3-Clause
//
// A program that has one of FCL's managers of discrete objects keeps it: the objects in
// it stand for objects that move, with AABBs that cover the step. A ball goes through a
// thin wall in one step. At both ends of the step it is beside it.
#include <cstdio>
#include <memory>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/swept_collision_object.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>

namespace {

using fcl::Vector3d;
using Moving = fcl::ContinuousCollisionObjectd;

struct FirstContact {
  const Moving* o1{nullptr};
  const Moving* o2{nullptr};
  double time{1};
};

/// For each pair whose AABBs overlap.
bool testPair(fcl::CollisionObjectd* o1, fcl::CollisionObjectd* o2, void* cdata) {
  auto& first = *static_cast<FirstContact*>(cdata);
  const auto *moving1 = static_cast<const Moving*>(o1->getUserData()),
             *moving2 = static_cast<const Moving*>(o2->getUserData());
  fcl::ContinuousContactRequestd request;
  request.query = fcl::ContinuousQuery::kFirst;
  request.t_max = first.time;  // what is later does not matter
  fcl::ContinuousContactResultd result;
  fcl::collide(moving1, moving2, request, result);
  if (result.is_collide && result.time_of_contact < first.time)
    first = {moving1, moving2, result.time_of_contact};
  return false;  // true ends the query
}

std::shared_ptr<fcl::MotionBased> straight(const Vector3d& from, const Vector3d& to) {
  return std::make_shared<fcl::TranslationMotion<double>>(fcl::Matrix3d::Identity(), from,
                                                          to);
}

}  // namespace

int main() {
  const auto ball = std::make_shared<fcl::Sphered>(.1);
  const Vector3d left(-1, 0, 0), right(1, 0, 0), above(0, 0, 2);
  Moving bullet(ball, straight(left, right)), bird(ball, straight(above, above)),
      wall(std::make_shared<fcl::Boxd>(.02, 1, 1), straight({0, 0, 0}, {0, 0, 0}));

  fcl::SweptCollisionObjectd swept[] = {fcl::SweptCollisionObjectd(&bullet),
                                        fcl::SweptCollisionObjectd(&bird),
                                        fcl::SweptCollisionObjectd(&wall)};
  fcl::DynamicAABBTreeCollisionManagerd manager;
  for (fcl::SweptCollisionObjectd& object : swept) manager.registerObject(&object);
  manager.setup();
  FirstContact first;
  manager.collide(&first, &testPair);
  std::printf("at %.4f of the step\n", first.time);

  // The ball touches the wall at x = -0.11. The time is early by at most toc_err.
  const double truth = .89 / 2, early = truth - first.time;
  if (early < -1e-12 || early > 1e-4) return 1;
  // The next step: new motions in the objects, then update().
  for (fcl::SweptCollisionObjectd& object : swept) object.update();
  manager.update();
  return first.o1 != &bird && first.o2 != &bird ? 0 : 1;
}

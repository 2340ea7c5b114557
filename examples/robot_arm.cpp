// SPDX-License-Identifier: BSD-3-Clause
//
// A robot arm of two meshes and a capsule, a soft pad and a sensor map: first contact of
// all, with the pair named. The joints turn at constant speed, and the links follow their
// exact paths. Links touch in joints: their group does not meet itself.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <fcl/broadphase/continuous_collision_manager.h>
#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/math/motion/joint_chain.h>
#include <fcl/math/motion/translation_motion.h>

using namespace fcl;
using Geometry = std::shared_ptr<CollisionGeometryd>;

/// A square around (2.5, 0.5, 0), at right angles to y. It bulges towards the arm.
Geometry makePad() {
  const auto pad = std::make_shared<DeformableBVHModel<>>();
  std::vector<Vector3d> p{{2.5, .5, 0}};
  for (int i = 0; i < 4; ++i) p.emplace_back(i & 2 ? 2.8 : 2.2, .5, i & 1 ? .3 : -.3);
  pad->beginModel();
  pad->addSubModel(p, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {0, 3, 1}});
  pad->endModel();
  p[0].y() = .4;
  pad->beginUpdateModel();
  pad->updateSubModel(p);
  pad->endUpdateModel();
  return pad;
}

/// A shelf of 20 x 2 x 20 occupied cells of 5 cm, from (2, 0.8, -0.5) on.
Geometry makeMap() {
  const auto map = std::make_shared<octomap::OcTree>(.05);
  for (int i = 0; i < 800; ++i)
    map->updateNode(2.025 + .05 * (i % 20), .825 + .05 * (i / 400),
                    -.475 + .05 * (i / 20 % 20), true);
  return std::make_shared<OcTreed>(map);
}

int main() {
  const Transform3d here(Translation3d(0, 0, 0)), along_x(Translation3d(.5, 0, 0));
  // Three joints, one at the end of each link before it, as in a URDF.
  JointChain chain;
  for (int i = 0; i < 3; ++i)
    chain.addRevolute(Transform3d(Translation3d(i > 0, 0, 0)), Vector3d::UnitZ());
  const AngleAxisd z_to_x(std::acos(0.), Vector3d::UnitY());
  const int along_link = chain.addFixed(along_x * z_to_x);  // the frame of the capsule
  const ChainMotion arm_motion(chain, {0, 0, 0}, {.5, .5, .5});
  const auto link = std::make_shared<BVHModel<OBBRSSd>>();
  generateBVHModel(*link, Boxd(1, .2, .2), along_x);
  const auto rest = std::make_shared<TranslationMotion<double>>(here, here);
  const auto capsule = std::make_shared<Capsuled>(.1, .8);
  ContinuousCollisionObjectd objects[] = {{link, arm_motion.link(0)},
                                          {link, arm_motion.link(1)},
                                          {capsule, arm_motion.link(along_link)},
                                          {makePad(), rest},
                                          {makeMap(), rest}};
  const char* names[] = {"link 1", "link 2", "link 3", "pad", "map"};
  const ContinuousFilter arm{1, 2, {}, {}}, others{2, 1, {}, {}};  // groups 1 and 2
  ContinuousCollisionManagerd manager;
  for (int i = 0; i < 5; ++i) {
    manager.registerObject(&objects[i]);
    manager.setFilter(&objects[i], i < 3 ? arm : others);
  }
  ContinuousContactRequestd request;
  request.query = ContinuousQuery::kFirst;
  ContinuousManagerResultd result;
  manager.collide(request, result);
  const auto& first = result.pairs.at(0);
  std::printf("%s and %s: %.4f\n", names[first.o1 - objects], names[first.o2 - objects],
              result.time_of_contact);
  return first.o1 == &objects[2] && first.o2 == &objects[3] ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
//
// A robot arm of three links among boxes: first contact of all, with the pair named. Each
// link goes from its pose at the beginning of the step to that at the end. Neighbours
// touch in their joint, so links are in a group that does not collide with itself.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fcl/broadphase/continuous_collision_manager.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/interp_motion.h>

namespace {

using fcl::Vector3d;
using Object = fcl::ContinuousCollisionObjectd;
constexpr int kLinks = 3;

/// The surface of a box from `low` to `high`.
std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> makeBox(Vector3d low, Vector3d high) {
  const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  const auto corner = [&](int i) {
    return Vector3d(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                    i & 4 ? high.z() : low.z());
  };
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  mesh->beginModel();
  for (const auto& f : faces)
    for (int k = 1; k < 3; ++k)
      mesh->addTriangle(corner(f[0]), corner(f[k]), corner(f[k + 1]));
  mesh->endModel();
  return mesh;
}

/// The motion of a link when each joint turns from the angle 0 to `angle`.
std::shared_ptr<fcl::MotionBased> linkMotion(int link, double angle) {
  Vector3d from(link, 0, 0), to(0, 0, 0);
  for (int k = 1; k <= link; ++k)
    to += Vector3d(std::cos(k * angle), std::sin(k * angle), 0);
  const fcl::AngleAxisd turn((link + 1) * angle, Vector3d::UnitZ());
  return std::make_shared<fcl::InterpMotion<double>>(
      fcl::Matrix3d::Identity(), from, turn.matrix(), to, Vector3d(0, 0, 0));
}

}  // namespace

int main() {
  const char* names[] = {"link 1", "link 2", "link 3", "shelf", "wall"};
  std::vector<std::shared_ptr<Object>> objects;
  for (int i = 0; i < kLinks; ++i)
    objects.push_back(
        std::make_shared<Object>(makeBox({0, -.1, -.1}, {1, .1, .1}), linkMotion(i, .5)));
  const auto rest = linkMotion(0, 0);
  objects.push_back(std::make_shared<Object>(makeBox({2, .8, -1}, {3, 2, 1}), rest));
  objects.push_back(std::make_shared<Object>(makeBox({-3, -1, -1}, {-2, 1, 1}), rest));

  fcl::ContinuousCollisionManagerd manager;
  fcl::ContinuousFilter links{1, 2, {}, {}}, scene{2, 1, {}, {}};  // groups 1 and 2
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i]->setUserData(const_cast<char*>(names[i]));
    manager.registerObject(objects[i].get());
    manager.setFilter(objects[i].get(), i < kLinks ? links : scene);
  }
  fcl::ContinuousContactRequestd request;
  request.query = fcl::ContinuousQuery::kFirst;
  fcl::ContinuousManagerResultd result;
  manager.collide(request, result);
  if (!result.is_collide) return 1;
  const std::string one = static_cast<const char*>(result.pairs[0].o1->getUserData()),
                    two = static_cast<const char*>(result.pairs[0].o2->getUserData());
  std::printf("%s and %s: %.4f\n", one.c_str(), two.c_str(), result.time_of_contact);
  return one == "link 3" && two == "shelf" ? 0 : 1;
}

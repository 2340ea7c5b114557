// SPDX-License-Identifier: BSD-3-Clause
//
// Objects and results that std::make_shared makes. Before C++17 they are aligned to 16
// bytes, where Eigen wants 32 with AVX. Stock FCL takes them.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <fcl/fcl.h>

using fcl::CollisionObjectd;
using fcl::Transform3d;

int main() {
  Transform3d begin = Transform3d::Identity(), end = begin;
  begin.translation() = fcl::Vector3d(5, 0, 0);
  end.translation() = fcl::Vector3d(-5, 0, 0);
  std::vector<std::shared_ptr<void>> kept;
  int failures = 0, unaligned = 0;
  for (int i = 0; i < 40; ++i) {
    // Memory of other sizes in between moves the objects.
    if (i % 3 == 1) kept.push_back(std::make_shared<std::uint64_t>(0));
    const auto box = std::make_shared<fcl::Boxd>(1., 1., 1.);
    const auto rest = std::make_shared<CollisionObjectd>(box);
    const auto start = std::make_shared<CollisionObjectd>(box, begin);
    const auto goal = std::make_shared<CollisionObjectd>(box, end);
    const auto result = std::make_shared<fcl::ContinuousCollisionResultd>();
    for (const std::shared_ptr<void>& x :
         std::initializer_list<std::shared_ptr<void>>{box, rest, start, goal, result})
      kept.push_back(x);
    unaligned += reinterpret_cast<std::uintptr_t>(&goal->getTransform()) % 32 != 0;
    const fcl::ContinuousCollisionRequestd request;
    const double time =
        fcl::continuousCollide(rest.get(), rest->getTransform(), start.get(),
                               goal->getTransform(), request, *result);
    failures += std::abs(time - .4) > 1e-3;
    const double again = fcl::continuousCollide(
        box.get(), rest->getTransform(), rest->getTransform(), box.get(),
        start->getTransform(), goal->getTransform(), request, *result);
    // FCL compiles the result with other flags and may place its poses elsewhere. They
    // are read here as the program has them.
    const double* pose = result->contact_tf2.data();
    failures += again != time || std::abs(pose[12] - 1) > .01 || pose[15] != 1;
  }
  std::printf("%s  unaligned objects (%d of 40)\n", failures == 0 ? "ok    " : "FAILED",
              unaligned);
  return failures == 0 ? 0 : 1;
}

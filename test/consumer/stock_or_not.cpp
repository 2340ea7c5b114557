// SPDX-License-Identifier: BSD-3-Clause
//
//   stock_or_not [stock | extended]
// A program that uses FCL's names only. It succeeds if its answers are those of this
// package (extended), or of stock FCL. A ball flies through another one in the first
// tenth of the step, where FCL does not sample.
#include <cstdio>
#include <cstring>

#include <fcl/fcl.h>

int main(int argc, char** argv) {
  const bool wants_stock = argc > 1 && std::strcmp(argv[1], "stock") == 0;
  const fcl::Sphered ball(.1);
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  fcl::Transform3d begin = still, end = still;
  begin.translation() = fcl::Vector3d(1, 0, 0);
  end.translation() = fcl::Vector3d(-19, 0, 0);
  fcl::ContinuousCollisionResultd result;
  fcl::continuousCollide(&ball, still, still, &ball, begin, end,
                         fcl::ContinuousCollisionRequestd(), result);
  fcl::CollisionResultd at_rest;
  fcl::collide(&ball, still, &ball, still, fcl::CollisionRequestd(), at_rest);
  const bool ok = result.is_collide != wants_stock && at_rest.isCollision();
  std::printf("%s  %s FCL\n", ok ? "ok    " : "FAILED",
              wants_stock ? "stock" : "extended");
  return ok ? 0 : 1;
}

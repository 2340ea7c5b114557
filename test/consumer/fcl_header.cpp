// SPDX-License-Identifier: BSD-3-Clause
//
// The same query as in main.cpp, with FCL's header <fcl/fcl.h>.
#include <fcl/fcl.h>

double timeThroughFclHeader(const fcl::CollisionGeometryd& a,
                            const fcl::CollisionGeometryd& b,
                            const fcl::Transform3d& b_beg,
                            const fcl::Transform3d& b_end) {
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  fcl::ContinuousCollisionResultd result;
  return fcl::continuousCollide(&a, still, still, &b, b_beg, b_end,
                                fcl::ContinuousCollisionRequestd(), result);
}

// A program in double does not compile Eigen's transforms in float, which took a
// twentieth of the time of the header. After a use of them this is an error of gcc.
namespace Eigen {
template <>
class Transform<float, 3, Isometry>;
}

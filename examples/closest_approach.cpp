// SPDX-License-Identifier: BSD-3-Clause
//
// How near a turning blade comes to a mast during a step, when, and where.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/continuous_distance.h>

#include <cmath>
#include <cstdio>

int main() {
  // A blade of two triangles, 3 units long, from the z axis outwards along x.
  fcl::BVHModel<fcl::OBBRSSd> blade;
  blade.beginModel();
  const fcl::Vector3d root_low(0, 0, -0.1), root_high(0, 0, 0.1), tip_low(3, 0, -0.1),
      tip_high(3, 0, 0.1);
  blade.addTriangle(root_low, tip_low, tip_high);
  blade.addTriangle(root_low, tip_high, root_high);
  blade.endModel();
  // The mast is 4 units from the axis, at an angle of 1 from the blade.
  const fcl::Cylinderd mast(0.25, 10);
  const fcl::Transform3d begin = fcl::Transform3d::Identity(),
                         end(fcl::AngleAxisd(1.5, fcl::Vector3d::UnitZ())),
                         place(fcl::Translation3d(4 * std::cos(1.), 4 * std::sin(1.), 0));

  fcl::ContinuousDistanceRequestd request;
  request.rel_err = 1e-6;    // the bracket: a millionth of the distance
  request.max_distance = 2;  // more is of no interest
  fcl::ContinuousDistanceResultd result;
  fcl::continuousDistance(&blade, begin, end, &mast, place, place, request, result);
  std::printf("from %.7f to %.7f, at %.3f of the step, by triangle %d\n",
              result.distance_lo, result.distance_hi, result.time,
              static_cast<int>(result.b1));

  // The tip passes the mast's surface at 4 - 0.25 - 3.
  const bool is_right = !result.is_collide && !result.is_cut_off &&
                        result.distance_lo <= 0.75 + 1e-12 &&
                        result.distance_hi >= 0.75 - 1e-12;
  return is_right ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
//
// A query that FCL answers, by each of its motions: a bar turns into a box.
#include <cstdio>
#include <memory>

#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/continuous_collision.h>

int main() {
  const fcl::Boxd bar(4, .1, .5), box(.1, .1, 1);
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  fcl::Transform3d turned = still, at = still;
  turned.linear() =
      Eigen::AngleAxisd(1.5707963267948966, fcl::Vector3d::UnitZ()).toRotationMatrix();
  at.translation() = fcl::Vector3d(.919, .919, 0);
  fcl::ContinuousCollisionRequestd request;
  request.num_max_iterations = 1000;
  request.toc_err = 1e-3;
  bool ok = true;
  for (const fcl::CCDMotionType type : {fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
    request.ccd_motion_type = type;
    fcl::ContinuousCollisionResultd result;
    const double time =
        fcl::continuousCollide(&bar, still, turned, &box, at, at, request, result);
    ok = ok && result.is_collide && time > .43 && time < .46;
  }
  for (const fcl::CCDMotionType type : {fcl::CCDM_TRANS, fcl::CCDM_SPLINE}) {
    request.ccd_motion_type = type;
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&bar, still, still, &box, at, at, request, result);
  }
  std::printf("%s  rotations\n", ok ? "ok    " : "FAILED");
  return ok ? 0 : 1;
}

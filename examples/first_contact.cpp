// SPDX-License-Identifier: BSD-3-Clause
//
// First contact of a cloth and a tool. The cloth deforms between two frames; the tool is
// a rigid mesh that translates. README.md shows this program.

// [README begin]
#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/continuous_collision.h>

#include <cstdio>
#include <vector>

int main() {
  // A cloth of four triangles, and a tool that is one triangle on its tip.
  std::vector<fcl::Vector3d> frame{
      {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0}};
  fcl::DeformableBVHModel<> cloth;  // is a fcl::BVHModel<fcl::KDOP<double, 16>>
  cloth.beginModel();
  cloth.addSubModel(frame, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  cloth.endModel();
  fcl::BVHModel<fcl::OBBRSSd> tool;
  tool.beginModel();
  tool.addTriangle({0, 0, 0}, {.2, -.2, 1}, {-.2, .2, 1});
  tool.endModel();

  // Each step: the cloth gets its next frame, the tool goes from one pose to another.
  frame[4].z() = .2;  // the middle of the cloth rises
  cloth.beginUpdateModel();
  cloth.updateSubModel(frame);
  cloth.endUpdateModel();
  const fcl::Transform3d rest = fcl::Transform3d::Identity();
  const fcl::Transform3d from(fcl::Translation3d(0, 0, 1));
  const fcl::Transform3d to(fcl::Translation3d(0, 0, -1));

  fcl::ContinuousCollisionRequestd request;  // toc_err: how early the time may be
  fcl::ContinuousCollisionResultd result;
  fcl::continuousCollide(&cloth, rest, rest, &tool, from, to, request, result);

  // The tip is at 1 - 2 t, the middle of the cloth at .2 t: they meet at 1 / 2.2.
  const double early = 1 / 2.2 - result.time_of_contact;
  std::printf("%d, at %.4f of the step\n", result.is_collide, result.time_of_contact);
  return result.is_collide && early > -1e-12 && early <= request.toc_err ? 0 : 1;
}
// [README end]

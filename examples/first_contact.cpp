// SPDX-License-Identifier: BSD-3-Clause
//
// First contact of a cloth and a tool. The cloth deforms between two frames; the tool is
// a rigid mesh that translates.
#include <cstdio>
#include <vector>

// [README begin]
#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/continuous_collision.h>
// [README end]

namespace {

using fcl::Vector3d;

struct Mesh {
  std::vector<Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
};

/// A square of 2 x 20 x 20 triangles in the plane z = 0.
Mesh makeSheet() {
  const std::size_t n = 21;  // vertices a row
  Mesh mesh;
  for (std::size_t v = 0; v < n * n; ++v) {
    mesh.vertices.emplace_back(.1 * double(v % n) - 1, .1 * double(v / n) - 1, 0);
    if (v % n + 1 == n || v / n + 1 == n) continue;
    mesh.triangles.emplace_back(v, v + 1, v + n + 1);
    mesh.triangles.emplace_back(v, v + n + 1, v + n);
  }
  return mesh;
}

/// A pyramid on its tip, which is the origin: a rigid mesh as in any FCL program.
fcl::BVHModel<fcl::OBBRSSd> makeTool() {
  const Vector3d tip(0, 0, 0);
  const Vector3d top[] = {{-.2, -.2, 1}, {.2, -.2, 1}, {.2, .2, 1}, {-.2, .2, 1}};
  fcl::BVHModel<fcl::OBBRSSd> tool;
  tool.beginModel();
  for (int k = 0; k < 4; ++k) tool.addTriangle(tip, top[(k + 1) % 4], top[k]);
  tool.endModel();
  return tool;
}

}  // namespace

int main() {
  const Mesh sheet = makeSheet();
  const fcl::BVHModel<fcl::OBBRSSd> tool = makeTool();
  std::vector<Vector3d> next = sheet.vertices;  // the middle of the cloth rises
  for (Vector3d& p : next) p.z() += .2 * (1 - p.head<2>().squaredNorm() / 2);

  // [README begin]
  fcl::DeformableBVHModel<> cloth;  // is a fcl::BVHModel<fcl::KDOP<double, 16>>
  cloth.beginModel();
  cloth.addSubModel(sheet.vertices, sheet.triangles);
  cloth.endModel();

  // Each step: the cloth gets its next frame, the tool goes from one pose to another.
  cloth.beginUpdateModel();
  cloth.updateSubModel(next);
  cloth.endUpdateModel();
  const fcl::Transform3d rest = fcl::Transform3d::Identity();
  const fcl::Transform3d from(fcl::Translation3d(0, 0, 1));
  const fcl::Transform3d to(fcl::Translation3d(0, 0, -1));

  fcl::ContinuousCollisionRequestd request;  // toc_err: how early the time may be
  fcl::ContinuousCollisionResultd result;
  fcl::continuousCollide(&cloth, rest, rest, &tool, from, to, request, result);
  std::printf("%d, at %.4f of the step\n", result.is_collide, result.time_of_contact);
  // [README end]

  // The tip is at 1 - 2 t, the middle of the cloth at 0.2 t. The time is early by at most
  // toc_err, 1e-4 by default, and never late.
  const double truth = 1 / 2.2, early = truth - result.time_of_contact;
  return result.is_collide && early > -1e-12 && early <= 1e-4 ? 0 : 1;
}

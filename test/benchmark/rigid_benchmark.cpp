// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_benchmark.h"

#include <cmath>
#include <cstdio>

#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

Transform3<double> at(double x, double y, double z) {
  Transform3<double> tf = Transform3<double>::Identity();
  tf.translation() = Vector3<double>(x, y, z);
  return tf;
}

/// 100,352 triangles; the bumps keep it from being convex.
TestMesh bumpySphere() {
  TestMesh mesh = makeUvSphere(224, 225, 1);
  for (Vector3<double>& p : mesh.vertices)
    p *= 1 + 0.02 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
  return mesh;
}

template <typename BV>
void run(const char* name, const TestMesh& mesh, int repeats) {
  BVHModel<BV> model;
  model.beginModel();
  model.addSubModel(mesh.vertices, mesh.triangles);
  model.endModel();
  const struct {
    const char* name;
    Transform3<double> beginning, end;
  } paths[] = {{"apart", at(2.2, 0.3, 0.2), at(2.1, 0.3, 0.3)},
               {"interlocking boxes", at(1.2, 1.3, 1.2), at(1.2, 1.3, 1.1)},
               {"touching", at(2.2, 0.3, 0.2), at(1.9, 0.2, 0.2)}};
  for (const auto& path : paths) {
    ContinuousCollisionResult<double> result;
    const double ms = leastMilliseconds(4 * repeats, [&] {
      continuousCollide(&model, at(0, 0, 0), at(0, 0, 0), &model, path.beginning,
                        path.end, ContinuousCollisionRequest<double>(), result);
    });
    std::printf("%s,%s,%d,%s,%.6f,%.1f\n", name, path.name, model.num_tris,
                result.is_collide ? "contact" : "no contact", result.time_of_contact,
                1e3 * ms);
  }
}

}  // namespace

void benchmarkRigid(int repeats) {
  std::printf("bv,rigid pair,triangles each,answer,time_of_contact,us\n");
  const TestMesh mesh = bumpySphere();
  run<KDOP<double, 16>>("KDOP16", mesh, repeats);
  run<OBBRSS<double>>("OBBRSS", mesh, repeats);
}

}  // namespace test
}  // namespace fcl

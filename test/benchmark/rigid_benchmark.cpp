// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_benchmark.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <memory>
#include <tuple>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/bvh/refit_top_down.h"
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

/// 2 slices^2 triangles; the bumps keep it from being convex.
TestMesh bumpySphere(int slices) {
  TestMesh mesh = makeUvSphere(slices, slices + 1, 1);
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

using Oriented = BVHModel<OBBRSS<double>>;

template <typename Model>
std::unique_ptr<Model> build(const TestMesh& mesh) {
  auto model = std::make_unique<Model>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

struct Path {
  const char* name;
  Transform3<double> beginning, end;
};

/// Kind, owner of the first feature, vertices.
using ContactName = std::tuple<int, bool, std::array<int, 5>>;

/// Sorted.
std::vector<ContactName> contactsOf(const CollisionGeometry<double>& a,
                                    const CollisionGeometry<double>& b,
                                    const Path& path) {
  ContinuousContactResult<double> result;
  continuousCollide(&a, at(0, 0, 0), at(0, 0, 0), &b, path.beginning, path.end,
                    ContinuousContactRequest<double>(), result);
  std::vector<ContactName> names;
  for (const auto& c : result.contacts)
    names.emplace_back(static_cast<int>(c.kind), c.first_on_o1, c.vertices);
  std::sort(names.begin(), names.end());
  return names;
}

/// How many elements of a sorted list are not in another.
std::size_t lacking(const std::vector<ContactName>& from,
                    const std::vector<ContactName>& in) {
  std::vector<ContactName> out;
  std::set_difference(from.begin(), from.end(), in.begin(), in.end(),
                      std::back_inserter(out));
  return out.size();
}

/// A row for each path of the ball along a model whose tree was made in a certain way.
void runTree(const char* name, const Oriented& model, const Oriented& ball,
             const std::vector<Path>& paths, int repeats) {
  const auto deformable = [](const Oriented& o) {
    TestMesh mesh;
    mesh.vertices.assign(o.vertices, o.vertices + o.num_vertices);
    mesh.triangles.assign(o.tri_indices, o.tri_indices + o.num_tris);
    return build<DeformableBVHModel<AABB<double>>>(mesh);
  };
  const auto true_model = deformable(model), true_ball = deformable(ball);
  for (const Path& path : paths) {
    const auto truth = contactsOf(*true_model, *true_ball, path),
               found = contactsOf(model, ball, path);
    const ContinuousCollisionRequest<double> request;
    ContinuousCollisionResult<double> ours, stock;
    const double our_ms = leastMilliseconds(4 * repeats, [&] {
      continuousCollide(&model, at(0, 0, 0), at(0, 0, 0), &ball, path.beginning, path.end,
                        request, ours);
    });
    const double stock_ms = leastMilliseconds(repeats, [&] {
      continuousCollide<double>(&model, at(0, 0, 0), at(0, 0, 0), &ball, path.beginning,
                                path.end, request, stock);
    });
    std::printf("%s,%s,%d,%zu,%zu,%zu,%.6f,%.1f,%.6f,%.1f\n", name, path.name,
                model.num_tris, truth.size(), lacking(truth, found),
                lacking(found, truth), ours.time_of_contact, 1e3 * our_ms,
                stock.time_of_contact, 1e3 * stock_ms);
  }
}

/// A ball beside, or above, models of `slices`^2 squares in OBBRSSs.
void runTrees(int slices, int repeats) {
  const std::vector<Path> beside = {{"apart", at(2.2, 0.3, 0.2), at(2.1, 0.3, 0.3)},
                                    {"touching", at(2.2, 0.3, 0.2), at(1.9, 0.2, 0.2)}};
  const std::vector<Path> above = {{"apart", at(0.5, 0.4, 1.5), at(0.5, 0.4, 1.4)},
                                   {"touching", at(0.5, 0.4, 1.1), at(0.5, 0.3, 0.9)}};
  const TestMesh sphere = bumpySphere(slices);
  const auto ball = build<Oriented>(sphere), model = build<Oriented>(sphere);
  runTree("as built", *model, *ball, beside, repeats);
  model->beginReplaceModel();
  model->replaceSubModel(sphere.vertices);
  model->endReplaceModel();
  runTree("replaced", *model, *ball, beside, repeats);
  refitTopDown(*model);
  runTree("replaced and refitTopDown()", *model, *ball, beside, repeats);
  runTree("floor of squares", *build<Oriented>(makeSheet(slices, slices)), *ball, above,
          repeats);
  const int divisions = static_cast<int>(slices / std::sqrt(6.));
  runTree("box of squares",
          *build<Oriented>(makeBox(Vector3<double>(1, 1, 1), divisions)), *ball, beside,
          repeats);
}

}  // namespace

void benchmarkRigid(int repeats) {
  std::printf("bv,rigid pair,triangles each,answer,time_of_contact,us\n");
  const TestMesh mesh = bumpySphere(224);
  run<KDOP<double, 16>>("KDOP16", mesh, repeats);
  run<OBBRSS<double>>("OBBRSS", mesh, repeats);
}

void benchmarkRigidTrees(int repeats) {
  std::printf(
      "OBBRSS tree,rigid pair,triangles,contacts,missed,false,time_of_contact,us,stock "
      "time_of_contact,stock us\n");
  for (const int slices : {50, 224}) runTrees(slices, repeats);
}

}  // namespace test
}  // namespace fcl

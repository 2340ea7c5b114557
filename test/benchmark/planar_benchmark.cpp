// SPDX-License-Identifier: BSD-3-Clause
#include "planar_benchmark.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "elementary/elementary.h"
#include "elementary/exact.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<>;
using Place = std::function<Vector3<double>(const Vector3<double>&)>;

/// A scene of one or two meshes in two frames.
struct PlanarScene {
  const char* name;
  TestMesh a;
  std::vector<Vector3<double>> a_end;
  TestMesh b;
  std::vector<Vector3<double>> b_end;
};

std::vector<Vector3<double>> placed(const std::vector<Vector3<double>>& points,
                                    const Place& place) {
  std::vector<Vector3<double>> out;
  for (const auto& p : points) out.push_back(place(p));
  return out;
}

/// Two sheets of 2 x 100 x 100 triangles, the second moved by the map.
PlanarScene twoSheets(const char* name, const SheetPosition& surface,
                      const Place& beginning, const Place& end) {
  PlanarScene scene{
      name, makeSheet(100, 100, surface), {}, makeSheet(100, 100, surface), {}};
  scene.a_end = scene.a.vertices;
  scene.b_end = placed(scene.b.vertices, end);
  scene.b.vertices = placed(scene.b.vertices, beginning);
  return scene;
}

PlanarScene tilted(PlanarScene scene) {
  const Matrix3<double> turn =
      AngleAxis<double>(0.7, Vector3<double>(1, 2, 3).normalized()).toRotationMatrix();
  for (auto* points : {&scene.a.vertices, &scene.a_end, &scene.b.vertices, &scene.b_end})
    for (auto& p : *points) p = turn * p;
  scene.name = "the same in a tilted plane";
  return scene;
}

PlanarScene still(const char* name, TestMesh mesh) {
  PlanarScene scene{name, std::move(mesh), {}, {}, {}};
  scene.a_end = scene.a.vertices;
  return scene;
}

void makeStep(Model& model, const TestMesh& mesh,
              const std::vector<Vector3<double>>& end) {
  model.beginModel();
  model.addSubModel(mesh.vertices, mesh.triangles);
  model.endModel();
  model.updateFrames(mesh.vertices[0].data(), end[0].data(), end.size());
}

using Name = std::tuple<ContinuousContactKind, bool, std::array<int, 4>>;

/// The candidates of the scene that touch, by the exact stage alone.
template <typename HandOut>
std::set<Name> truthOf(const PlanarScene& scene, HandOut&& handOut) {
  namespace deformable = detail::deformable;
  std::set<Name> truth;
  const bool self = scene.b.vertices.empty();
  handOut([&](const ContinuousCandidate* candidates, std::size_t count) {
    for (const auto* c = candidates; c != candidates + count; ++c) {
      const bool vf = c->kind == ContinuousContactKind::kVertexFace;
      deformable::VertexPath x[4];
      for (int i = 0; i < 4; ++i) {
        const bool first = i < (vf ? 1 : 2), on_a = self || first == c->first_on_o1;
        const auto id =
            static_cast<std::size_t>(c->vertices[static_cast<std::size_t>(i)]);
        const auto& from = (on_a ? scene.a : scene.b).vertices[id];
        const auto& to = (on_a ? scene.a_end : scene.b_end)[id];
        for (int k = 0; k < 3; ++k) {
          x[i].t0[k] = from[k];
          x[i].t1[k] = to[k];
        }
      }
      const auto kind = vf ? fcl::ContinuousContactKind::kVertexFace
                           : fcl::ContinuousContactKind::kEdgeEdge;
      if (deformable::decideExactly(kind, {{&x[0], &x[1], &x[2], &x[3]}}, 1).answer ==
          deformable::Answer::kYes)
        truth.emplace(c->kind, c->first_on_o1, c->vertices);
    }
    return true;
  });
  return truth;
}

void run(const PlanarScene& scene, int repeats) {
  Model a, b;
  makeStep(a, scene.a, scene.a_end);
  const bool self = scene.b.vertices.empty();
  if (!self) makeStep(b, scene.b, scene.b_end);
  const ContinuousContactRequest<double> request;
  ContinuousContactResult<double> result;
  const Transform3<double> origin = Transform3<double>::Identity();
  const double ms = leastMilliseconds(repeats, [&] {
    if (self)
      continuousSelfCollide(&a, request, result);
    else
      continuousCollide(&a, origin, origin, &b, origin, origin, request, result);
  });
  const std::set<Name> truth = truthOf(scene, [&](const ContinuousCandidateSink& sink) {
    if (self)
      continuousSelfCandidates(&a, sink);
    else
      continuousCandidates(&a, origin, origin, &b, origin, origin, sink);
  });
  std::size_t right = 0;
  for (const auto& c : result.contacts)
    right += truth.count({c.kind,
                          c.first_on_o1,
                          {c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]}});
  const auto& counts = result.counts;
  // What the boxes leave to the elementary test, and what its filter leaves to the solve.
  const auto tested = counts.feature_pairs - counts.box_culled;
  const auto solved = tested - counts.filter_culled;
  const auto nanosecondsPer = [ms](std::uint64_t pairs) {
    return 1e6 * ms / static_cast<double>(pairs);
  };
  std::printf("%s,%.2f,%llu,%llu,%llu,%llu,%zu,%zu,%zu,%.0f,%.0f,%.0f\n", scene.name, ms,
              static_cast<unsigned long long>(counts.triangle_pairs),
              static_cast<unsigned long long>(tested),
              static_cast<unsigned long long>(solved),
              static_cast<unsigned long long>(counts.exact_tests), result.contacts.size(),
              truth.size() - right, result.contacts.size() - right,
              nanosecondsPer(counts.triangle_pairs), nanosecondsPer(tested),
              nanosecondsPer(solved));
}

}  // namespace

void benchmarkPlanar(int repeats) {
  std::printf(
      "scene,ms_total,triangle_pairs,tested,solved,exact,contacts,missed,extra,"
      "ns_per_triangle_pair,ns_per_tested,ns_per_solved\n");
  const auto flat = [](double u, double v) { return Vector3<double>(u, v, 0); };
  const auto wavy = [](double u, double v) {
    return Vector3<double>(u, v, 0.03 * std::sin(40 * u) * std::cos(37 * v));
  };
  const auto moved = [](double x, double y, double z) -> Place {
    return [=](const Vector3<double>& p) -> Vector3<double> {
      return p + Vector3<double>(x, y, z);
    };
  };
  // The general case: waves that pass through each other.
  run(twoSheets("waves through waves", wavy, moved(0.0123, 0.0071, 0.02),
                moved(0.0411, 0.0313, -0.01)),
      repeats);
  const PlanarScene sliding = twoSheets(
      "flat sheets sliding", flat, moved(0.0123, 0.0071, 0), moved(0.0411, 0.0313, 0));
  run(sliding, repeats);
  run(tilted(sliding), repeats);
  const PlanarScene aligned = twoSheets("flat sheets sliding along their edges", flat,
                                        moved(0, 0, 0), moved(0.0351, 0, 0));
  run(aligned, repeats);
  run(tilted(aligned), repeats);
  const auto folded = [](double u, double v) {
    return Vector3<double>(u < 0.5 ? u : 1 - u, v, 0);
  };
  const PlanarScene fold =
      still("folded flat sheet at rest", makeSheet(200, 100, folded));
  run(fold, repeats);
  run(tilted(fold), repeats);
  run(still("waves at rest", makeSheet(100, 100, wavy)), repeats);
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The methods of earlier papers, which the benchmark of speed compares with, in all their
// variants: the same contacts as every pair of features tested one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "baselines/baseline.h"
#include "baselines/feature_tree.h"
#include "baselines/normal_cones.h"
#include "fcl/narrowphase/continuous_feature_test.h"
#include "generated_scenes.h"
#include "mesh_generators.h"
#include "speed_error/interval_newton.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::FeatureKind;
using detail::deformable::FeaturePoints;
using detail::deformable::VertexPath;

/// The library's exact decision in place of Interval-Newton.
bool touch(FeatureKind kind, const FeaturePoints& x) {
  Vector3<double> p[4], q[4];
  for (int i = 0; i < 4; ++i) {
    p[i] = Vector3<double>(x[i].t0);
    q[i] = Vector3<double>(x[i].t1);
  }
  const auto result =
      kind == FeatureKind::kVertexFace
          ? vertexFace<double>(p[0], p[1], p[2], p[3], q[0], q[1], q[2], q[3], 1)
          : edgeEdge<double>(p[0], p[1], p[2], p[3], q[0], q[1], q[2], q[3], 1);
  return result.is_contact;
}

bool touchExactly(FeatureKind kind, const FeaturePoints& x, const RelativePair<double>&,
                  const CoplanarityCubic<double>&) {
  return touch(kind, x);
}

/// Of a resolution at which it finds exactly what touches in general position.
bool touchFinely(FeatureKind, const FeaturePoints&, const RelativePair<double>& pair,
                 const CoplanarityCubic<double>& cubic) {
  return firstTimeByIntervalNewton(pair, cubic, 1e-9, 1e-9) >= 0;
}

std::vector<PairName> bruteForce(const FramePairMesh& mesh) {
  std::vector<VertexPath> paths;
  for (std::size_t i = 0; i < mesh.previous.size(); ++i) {
    const auto &p = mesh.previous[i], &q = mesh.current[i];
    paths.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2]}});
  }
  std::vector<PairName> found;
  const auto test = [&](FeatureKind kind, std::array<int, 4> v) {
    for (std::size_t i = 0; i < (kind == FeatureKind::kVertexFace ? 1 : 2); ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (v[i] == v[j] && (kind == FeatureKind::kVertexFace || j >= 2)) return;
    const auto path = [&](std::size_t i) {
      return &paths[static_cast<std::size_t>(v[i])];
    };
    if (touch(kind, {{path(0), path(1), path(2), path(3)}}))
      found.push_back(pairName(kind == FeatureKind::kVertexFace
                                   ? ContinuousContactKind::kVertexFace
                                   : ContinuousContactKind::kEdgeEdge,
                               v));
  };
  for (const Triangle& t : mesh.triangles)
    for (int v = 0; v < static_cast<int>(paths.size()); ++v)
      test(FeatureKind::kVertexFace,
           {v, static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  const auto edges = uniqueEdges(mesh.triangles);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size(); ++j)
      test(FeatureKind::kEdgeEdge, {edges[i][0], edges[i][1], edges[j][0], edges[j][1]});
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<PairName> contacts(const FramePairMesh& mesh, const BaselineMethod& method,
                               TouchTest touches = touchExactly) {
  std::vector<PairName> found = makeBaseline(mesh, method, touches)->step(mesh).contacts;
  std::sort(found.begin(), found.end());
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end())
      << "a pair was met twice";
  return found;
}

/// Calls compare(name, contacts) for every method there is.
template <typename Compare>
void forEachMethod(const FramePairMesh& mesh, TouchTest touches, Compare&& compare) {
  const struct {
    const char* name;
    Filter filter;
    KernelSet kernels;
    Boxes boxes;
  } variants[] = {
      {"swept, none", Filter::kNone, KernelSet::kScalar, Boxes::kSwept},
      {"swept, plain", Filter::kPlain, KernelSet::kScalar, Boxes::kSwept},
      {"swept, certified", Filter::kCertified, KernelSet::kScalar, Boxes::kSwept},
      {"moving, none", Filter::kNone, KernelSet::kScalar, Boxes::kMoving},
      {"moving, plain", Filter::kPlain, KernelSet::kScalar, Boxes::kMoving},
      {"moving, certified", Filter::kCertified, KernelSet::kScalar, Boxes::kMoving},
      {"vector, none", Filter::kNone, KernelSet::kVector, Boxes::kSwept},
      {"vector, certified", Filter::kCertified, KernelSet::kVector, Boxes::kSwept}};
  const struct {
    const char* name;
    Technique technique;
  } techniques[] = {{"feature boxes, ", Technique::kFeatureBoxes},
                    {"representatives, ", Technique::kRepresentatives},
                    {"connectivity, ", Technique::kConnectivity}};
  for (const auto& technique : techniques)
    for (const auto& v : variants)
      compare(
          std::string(technique.name) + v.name,
          contacts(mesh, {technique.technique, v.filter, v.kernels, v.boxes}, touches));
}

void expectFromAllMethods(const FramePairMesh& mesh, const std::vector<PairName>& truth,
                          TouchTest touches = touchExactly) {
  forEachMethod(mesh, touches,
                [&](const std::string& method, const std::vector<PairName>& found) {
                  EXPECT_EQ(found, truth) << method;
                });
}

/// A sheet thrown about: general position, many contacts.
FramePairMesh thrownSheet(std::uint64_t seed) {
  Random random(seed);
  const TestMesh sheet = makeSheet(8, 8);
  FramePairMesh mesh{{}, {}, sheet.triangles};
  for (const auto& p : sheet.vertices) {
    mesh.previous.push_back(p + random.point(0.05));
    mesh.current.push_back(mesh.previous.back() + random.point(0.3));
  }
  return mesh;
}

/// A sheet that lies on another, moved aside by a vector of small integers, and leaves
/// it: all contacts are at t = 0, and exact.
FramePairMesh liftedSheet() {
  const TestMesh sheet = makeSheet(
      6, 6, [](double u, double v) { return Vector3<double>(60 * u, 60 * v, 0); });
  FramePairMesh mesh{sheet.vertices, sheet.vertices, sheet.triangles};
  for (const auto& p : sheet.vertices) {
    mesh.previous.push_back(p + Vector3<double>(3, 4, 0));
    mesh.current.push_back(mesh.previous.back() + Vector3<double>(1, 2, 5));
  }
  for (const Triangle& t : sheet.triangles)
    mesh.triangles.emplace_back(t[0] + sheet.vertices.size(),
                                t[1] + sheet.vertices.size(),
                                t[2] + sheet.vertices.size());
  return mesh;
}

TEST(FCL_BASELINES, generalPositionIsAnsweredRightByAllMethods) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FramePairMesh mesh = thrownSheet(seed);
    const auto truth = bruteForce(mesh);
    EXPECT_GT(truth.size(), 100u);
    expectFromAllMethods(mesh, truth);
    expectFromAllMethods(mesh, truth, touchFinely);
  }
}

TEST(FCL_BASELINES, placeDoesNotMatter) {
  FramePairMesh mesh = makeTiles(1);
  const auto truth = contacts(mesh, {Technique::kRepresentatives});
  EXPECT_GT(truth.size(), 10u);
  move(mesh, {1e6, -1e6, 1e6});
  expectFromAllMethods(mesh, truth);
}

TEST(FCL_BASELINES, sharedAndRepeatedFeaturesAreOneFeature) {
  FramePairMesh mesh = thrownSheet(4);
  const auto truth = bruteForce(mesh);
  const std::size_t n = mesh.triangles.size();
  for (std::size_t i = 0; i < n; i += 3)
    mesh.triangles.emplace_back(mesh.triangles[i][1], mesh.triangles[i][2],
                                mesh.triangles[i][0]);
  expectFromAllMethods(mesh, truth);
}

/// Where no number is rounded, zero has no sign, and no filter culls a touch.
TEST(FCL_BASELINES, exactTouchesAtTheStartAreFound) {
  const FramePairMesh mesh = liftedSheet();
  const auto truth = bruteForce(mesh);
  EXPECT_GT(truth.size(), 100u);
  expectFromAllMethods(mesh, truth);
}

/// Turned out of the coordinate planes, which rounds it, the same is not for the plain
/// filter: it takes the sign of a rounding for a proof, and no solver brings back what it
/// culls.
TEST(FCL_BASELINES, thePlainFilterCullsRoundedTouchesAtTheStart) {
  FramePairMesh mesh = liftedSheet();
  const Matrix3<double> turn =
      AngleAxis<double>(0.7, Vector3<double>(1, 2, 3).normalized()).toRotationMatrix();
  for (auto* points : {&mesh.previous, &mesh.current})
    for (auto& p : *points) p = turn * p;
  const auto truth = bruteForce(mesh);
  EXPECT_GT(truth.size(), 10u);
  forEachMethod(
      mesh, touchExactly,
      [&](const std::string& variant, const std::vector<PairName>& found) {
        EXPECT_TRUE(std::includes(truth.begin(), truth.end(), found.begin(), found.end()))
            << variant;
        if (variant.find("plain") == std::string::npos) {
          EXPECT_EQ(found, truth) << variant;
        }
      });
}

}  // namespace
}  // namespace test
}  // namespace fcl

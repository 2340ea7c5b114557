// SPDX-License-Identifier: BSD-3-Clause
//
// The methods of earlier papers, with which the benchmark of speed compares, in all their
// variants. They find the same contacts as a test of every feature pair one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "baselines/baseline.h"
#include "brute_force.h"
#include "generated_scenes.h"
#include "mesh_generators.h"
#include "speed_error/interval_newton.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::FeaturePoints;
using fcl::ContinuousContactKind;

bool touchExactly(ContinuousContactKind kind, const FeaturePoints& x,
                  const RelativePair<double>&, const CoplanarityCubic<double>&) {
  return doTouch(kind, x);
}

/// The resolution at which it finds exactly the contacts in general position.
bool touchFinely(ContinuousContactKind, const FeaturePoints&,
                 const RelativePair<double>& pair,
                 const CoplanarityCubic<double>& cubic) {
  return firstTimeByIntervalNewton(pair, cubic, 1e-9, 1e-9) >= 0;
}

std::vector<PairName> contacts(const FramePairMesh& mesh, const BaselineMethod& method,
                               TouchTest touches = touchExactly) {
  std::vector<PairName> found = makeBaseline(mesh, method, touches)->step(mesh).contacts;
  std::sort(found.begin(), found.end());
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end())
      << "a pair was met twice";
  return found;
}

/// Calls compare(name, contacts) for every method.
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
      {"vector, swept, none", Filter::kNone, KernelSet::kVector, Boxes::kSwept},
      {"vector, swept, plain", Filter::kPlain, KernelSet::kVector, Boxes::kSwept},
      {"vector, swept, certified", Filter::kCertified, KernelSet::kVector, Boxes::kSwept},
      {"vector, moving, none", Filter::kNone, KernelSet::kVector, Boxes::kMoving},
      {"vector, moving, plain", Filter::kPlain, KernelSet::kVector, Boxes::kMoving},
      {"vector, moving, certified", Filter::kCertified, KernelSet::kVector,
       Boxes::kMoving}};
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

/// A sheet that moves at random: general position, many contacts.
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

/// A sheet that lies on another one, shifted by a vector of small integers, and leaves
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

/// A mesh and its motion: each vertex goes to where `to` takes it.
template <typename To>
FramePairMesh moving(const TestMesh& mesh, To&& to) {
  FramePairMesh pair{mesh.vertices, {}, mesh.triangles};
  for (const auto& p : mesh.vertices) pair.current.push_back(to(p));
  return pair;
}

/// A sheet bent over itself whose upper end falls through the lower one.
FramePairMesh foldedCloth() {
  const auto position = [](double u, double v, double gap) {
    const double s = 3 * u - 1.5, turn = std::min(1.5, std::max(-1.5, 3 * s));
    const double x = std::cos(turn) - std::max(0., std::abs(3 * s) - 1.5);
    return Vector3<double>(x, v + 0.03 * std::sin(9 * u), gap * std::sin(turn));
  };
  const auto at = [&](double gap) {
    return makeSheet(24, 6, [&, gap](double u, double v) { return position(u, v, gap); });
  };
  FramePairMesh mesh{at(0.3).vertices, at(0.3).vertices, at(0.3).triangles};
  for (auto& p : mesh.current)
    if (p[0] < 0 && p[2] > 0) p[2] -= 0.9 * std::min(1., -2 * p[0]);
  return mesh;
}

/// Two spheres that meet, and shrink.
FramePairMesh meetingSpheres() {
  TestMesh spheres = makeIcosphere(1, 1);
  append(spheres, transformed(makeIcosphere(1, 1),
                              Transform3<double>(Translation3<double>(2.3, 0.1, 0.2))));
  return moving(spheres, [](const Vector3<double>& p) {
    return Vector3<double>(0.8 * p[0] + (p[0] > 1.2 ? -0.6 : 0.3), 0.9 * p[1], p[2]);
  });
}

/// Three sheets that share an edge, and close like a book.
FramePairMesh closingBook() {
  Random random(8);
  FramePairMesh mesh;
  constexpr int kCells = 5;
  for (const double angle : {0., 0.5, 1.1}) {
    const std::size_t first = mesh.previous.size();
    const TestMesh page = makeSheet(kCells, kCells);
    const auto id = [&](std::size_t v) {
      // The vertices of the back, x = 0, are the first page's.
      return v % (kCells + 1) == 0 ? v : first + v;
    };
    for (const auto& p : page.vertices) {
      const auto at = [&](double a) {
        return Vector3<double>(p[0] * std::cos(a), p[1], p[0] * std::sin(a));
      };
      mesh.previous.push_back(at(angle) + random.point(0.01));
      mesh.current.push_back(at(angle * (0.2 - p[1])) + random.point(0.01));
    }
    for (const Triangle& t : page.triangles)
      mesh.triangles.emplace_back(id(t[0]), id(t[1]), id(t[2]));
  }
  return mesh;
}

/// Shapes with so few triangles that most of them are adjacent. All feature pairs of a
/// tetrahedron are orphans.
FramePairMesh thrownTetrahedra(std::uint64_t seed) {
  Random random(seed);
  return moving(
      makeTetrahedronSoup(12, 0.5, 0.4, seed),
      [&](const Vector3<double>& p) -> Vector3<double> { return p + random.point(0.4); });
}

TEST(FCL_BASELINES, surfacesOfAllKindsAreAnsweredRightByAllMethods) {
  FramePairMesh degenerate = thrownSheet(7);
  for (std::size_t i = 0; i < degenerate.triangles.size(); i += 9) {
    Triangle& t = degenerate.triangles[i];
    t = Triangle(t[0], t[0], t[1]);
  }
  const struct {
    const char* name;
    FramePairMesh mesh;
  } scenes[] = {{"folded cloth", foldedCloth()},
                {"spheres", meetingSpheres()},
                {"book", closingBook()},
                {"tetrahedra", thrownTetrahedra(5)},
                {"triangles that are edges", degenerate}};
  for (const auto& scene : scenes) {
    SCOPED_TRACE(scene.name);
    const auto truth = bruteForceSelfContacts(scene.mesh);
    EXPECT_GT(truth.size(), 20u);
    expectFromAllMethods(scene.mesh, truth);
  }
}

TEST(FCL_BASELINES, normalConesLeaveOutWhatIsSmooth) {
  const FramePairMesh mesh =
      moving(makeSheet(16, 16,
                       [](double u, double v) {
                         return Vector3<double>(u, v, 0.1 * std::sin(5 * u + v));
                       }),
             [](const Vector3<double>& p) {
               return Vector3<double>(p[0] - 0.1 * p[1], p[1], p[2] + 0.2 * p[0] * p[1]);
             });
  for (const KernelSet kernels : {KernelSet::kScalar, KernelSet::kVector}) {
    const BaselineStep step =
        makeBaseline(mesh, {Technique::kConnectivity, Filter::kNone, kernels})
            ->step(mesh);
    EXPECT_TRUE(step.contacts.empty());
    EXPECT_EQ(step.triangle_pairs, 0u);
    EXPECT_GE(step.regions_left_out, 1u);
  }
}

/// The work of each stage: owners and representatives meet the same feature pairs, boxes
/// of features alone meet them repeatedly, the filter leaves fewer.
TEST(FCL_BASELINES, countsAreThoseOfTheStages) {
  for (const KernelSet kernels : {KernelSet::kScalar, KernelSet::kVector}) {
    const FramePairMesh mesh = thrownSheet(6);
    const auto stepOf = [&](Technique technique, Filter filter) {
      return makeBaseline(mesh, {technique, filter, kernels})->step(mesh);
    };
    const BaselineStep boxes = stepOf(Technique::kFeatureBoxes, Filter::kNone),
                       owners = stepOf(Technique::kRepresentatives, Filter::kNone),
                       connected = stepOf(Technique::kConnectivity, Filter::kNone),
                       filtered = stepOf(Technique::kRepresentatives, Filter::kPlain);
    EXPECT_EQ(connected.regions_left_out, 0u);
    EXPECT_EQ(connected.feature_pairs, owners.feature_pairs);
    EXPECT_GT(boxes.feature_pairs, 2 * owners.feature_pairs);
    EXPECT_EQ(owners.elementary_tests, owners.feature_pairs);
    EXPECT_EQ(filtered.feature_pairs, owners.feature_pairs);
    EXPECT_LT(filtered.elementary_tests, filtered.feature_pairs);
    EXPECT_EQ(filtered.contacts.size(), owners.contacts.size());
  }
}

TEST(FCL_BASELINES, aKeptTreeAnswersAsAFreshOne) {
  const FrameSequence sequence = makeMixingBalls(3);
  for (const BaselineMethod method :
       {BaselineMethod{Technique::kConnectivity, Filter::kPlain},
        BaselineMethod{Technique::kConnectivity, Filter::kCertified,
                       KernelSet::kVector}}) {
    const auto kept = makeBaseline(sequence.pair(0), method);
    for (std::size_t i = 0; i < 2; ++i) {
      const FramePairMesh mesh = sequence.pair(i);
      std::vector<PairName> found = kept->step(mesh).contacts;
      std::vector<PairName> fresh = makeBaseline(mesh, method)->step(mesh).contacts;
      std::sort(found.begin(), found.end());
      std::sort(fresh.begin(), fresh.end());
      EXPECT_EQ(found, fresh);
    }
  }
}

TEST(FCL_BASELINES, generalPositionIsAnsweredRightByAllMethods) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FramePairMesh mesh = thrownSheet(seed);
    const auto truth = bruteForceSelfContacts(mesh);
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
  const auto truth = bruteForceSelfContacts(mesh);
  const std::size_t n = mesh.triangles.size();
  for (std::size_t i = 0; i < n; i += 3)
    mesh.triangles.emplace_back(mesh.triangles[i][1], mesh.triangles[i][2],
                                mesh.triangles[i][0]);
  expectFromAllMethods(mesh, truth);
}

/// If no number is rounded, zero has no sign, and no filter culls a touch.
TEST(FCL_BASELINES, exactTouchesAtTheStartAreFound) {
  const FramePairMesh mesh = liftedSheet();
  const auto truth = bruteForceSelfContacts(mesh);
  EXPECT_GT(truth.size(), 100u);
  expectFromAllMethods(mesh, truth);
}

/// The same scene rotated out of the coordinate planes, which rounds it. The plain filter
/// takes the sign of a rounding for a proof, and no solver brings back the pairs that it
/// culls.
TEST(FCL_BASELINES, thePlainFilterCullsRoundedTouchesAtTheStart) {
  FramePairMesh mesh = liftedSheet();
  const Matrix3<double> turn =
      AngleAxis<double>(0.7, Vector3<double>(1, 2, 3).normalized()).toRotationMatrix();
  for (auto* points : {&mesh.previous, &mesh.current})
    for (auto& p : *points) p = turn * p;
  const auto truth = bruteForceSelfContacts(mesh);
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

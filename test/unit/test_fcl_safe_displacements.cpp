// SPDX-License-Identifier: BSD-3-Clause
//
// Safe displacements against the distances of all pairs of features.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/safe_displacements.h"
#include "feature_distance.h"
#include "moving_mesh.h"
#include "prepare/prepared_mesh.h"
#include "query/deformable_query.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Rigid = BVHModel<OBBRSS<double>>;

/// Four points of a pair, as numbers in a list of all vertices.
struct Pair {
  bool is_face;
  std::array<std::size_t, 4> id;

  double distance(const std::vector<V>& x) const {
    const auto &p = x[id[0]], &q = x[id[1]], &r = x[id[2]], &s = x[id[3]];
    return is_face ? distanceToFace(p, q, r, s) : distanceOfEdges(p, q, r, s);
  }
};

/// The pairs of a mesh with itself, or of two meshes in one list of vertices.
/// @param first  the number of triangles of the first mesh
std::vector<Pair> allPairs(const TestMesh& mesh, std::size_t first) {
  std::vector<Pair> pairs;
  const bool is_self = first == mesh.triangles.size();
  const auto add = [&pairs](bool is_face, const std::array<std::size_t, 4>& id) {
    const std::size_t num_first = is_face ? 1 : 2;
    for (std::size_t i = 0; i < num_first; ++i)
      for (std::size_t j = num_first; j < 4; ++j)
        if (id[i] == id[j]) return;
    pairs.push_back({is_face, id});
  };
  const auto of = [&](bool is_second) {
    const auto begin = mesh.triangles.begin(),
               middle = begin + static_cast<std::ptrdiff_t>(first);
    if (is_self) return mesh.triangles;
    return is_second ? std::vector<Triangle>(middle, mesh.triangles.end())
                     : std::vector<Triangle>(begin, middle);
  };
  for (const bool second : {false, true}) {
    if (is_self && second) break;
    std::vector<std::size_t> vertices;
    for (const Triangle& t : of(second))
      for (int k = 0; k < 3; ++k) vertices.push_back(t[k]);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const std::size_t v : vertices)
      for (const Triangle& t : of(!second)) add(true, {v, t[0], t[1], t[2]});
  }
  const auto a = uniqueEdges(of(false)), b = uniqueEdges(of(true));
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = is_self ? i + 1 : 0; j < b.size(); ++j)
      add(false, {static_cast<std::size_t>(a[i][0]), static_cast<std::size_t>(a[i][1]),
                  static_cast<std::size_t>(b[j][0]), static_cast<std::size_t>(b[j][1])});
  return pairs;
}

/// The bounds are half of the least distances, and keep all pairs apart when the vertices
/// move by them, in random directions and towards the other feature.
/// @return the number of bounds below the largest one
int expectBounds(Random& random, const std::vector<V>& x, const std::vector<Pair>& pairs,
                 double most, double d, const std::vector<double>& bounds) {
  std::vector<double> expected(x.size(), most);
  std::vector<V> towards(x.size(), V::Zero());
  for (const Pair& pair : pairs) {
    const double half = std::max(0., 0.5 * (pair.distance(x) - d));
    const std::size_t num_first = pair.is_face ? 1 : 2;
    V center[2] = {V::Zero(), V::Zero()};
    for (std::size_t i = 0; i < 4; ++i)
      center[i < num_first ? 0 : 1] +=
          x[pair.id[i]] / (i < num_first ? num_first : 4 - num_first);
    for (std::size_t i = 0; i < 4; ++i)
      if (half < expected[pair.id[i]]) {
        expected[pair.id[i]] = half;
        towards[pair.id[i]] =
            (i < num_first ? 1 : -1) * (center[1] - center[0]).normalized();
      }
  }
  EXPECT_EQ(bounds.size(), x.size());
  int low = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_LE(bounds[i], expected[i]);
    EXPECT_GE(bounds[i], expected[i] - 1e-13);
    low += bounds[i] < most;
  }
  for (int round = 0; round < rounds(6); ++round) {
    std::vector<V> moved = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      moved[i] += bounds[i] * (round == 0 ? towards[i] : V(random.point(1).normalized()));
    for (const Pair& pair : pairs)
      if (pair.distance(x) > d) {
        EXPECT_GT(pair.distance(moved), d - 1e-15);
      }
  }
  return low;
}

std::shared_ptr<Model> modelOf(const MovingMesh& mesh) {
  auto model = makeModel<Model>(TestMesh{mesh.t0, mesh.triangles});
  EXPECT_EQ(model->updateFrames(mesh.previous(), mesh.current(), mesh.t0.size(),
                                FclTree::kSkip),
            BVH_OK);
  return model;
}

TEST(FCL_SAFE_DISPLACEMENTS, ofAMeshWithItself) {
  int low = 0, zero = 0;
  for (std::uint64_t seed = 0; seed < (kHasAddressSanitizer ? 3 : 12); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    // The previous frame does not count.
    const MovingMesh mesh = crumpledSheet(random, 5, seed % 2 ? 0.3 : 0.05);
    const double most = std::pow(10, random.uniform(-2, 0)),
                 d = seed % 3 ? std::pow(10, random.uniform(-3, -1)) : 0;
    const auto bounds = safeSelfDisplacements(modelOf(mesh).get(), most, d);
    low += expectBounds(random, mesh.t1,
                        allPairs({mesh.t1, mesh.triangles}, mesh.triangles.size()), most,
                        d, bounds);
    // Pairs whose vertices have this bound already are left out.
    zero += static_cast<int>(std::count(bounds.begin(), bounds.end(), 0.));
    MovingMesh still = mesh;
    still.t0 = still.t1;
    EXPECT_EQ(safeSelfDisplacements(modelOf(still).get(), most, d), bounds);
    // Near the largest floats, which boxes have, and beyond.
    for (const int shift : {122, 126, 130}) {
      const double scale = std::ldexp(1, shift);
      MovingMesh huge = mesh;
      std::vector<double> scaled = bounds;
      for (std::size_t i = 0; i < bounds.size(); ++i) {
        huge.t0[i] *= scale;
        huge.t1[i] *= scale;
        scaled[i] *= scale;
      }
      EXPECT_EQ(safeSelfDisplacements(modelOf(huge).get(), scale * most, scale * d),
                scaled);
    }
  }
  EXPECT_GE(low, rounds(200));
  EXPECT_GE(zero, rounds(50));
}

// Two sheets that are far apart at t = 0 and close at t = 1, and the other way round.
TEST(FCL_SAFE_DISPLACEMENTS, onlyTheEndOfTheStepCounts) {
  constexpr double kGap = 0.01, kMost = 0.02, kD = 0.002;
  const TestMesh sheet = makeSheet(8, 8);
  const std::size_t count = sheet.vertices.size();
  for (const bool is_near_at_end : {true, false}) {
    MovingMesh mesh;
    for (const bool is_upper : {false, true}) {
      for (const V& p : sheet.vertices) {
        const V far = p + V(0, 0, is_upper ? 1e6 : 0),
                near = p + V(0, 0, is_upper ? kGap : 0);
        mesh.t0.push_back(is_near_at_end ? far : near);
        mesh.t1.push_back(is_near_at_end ? near : far);
      }
      const std::size_t first = is_upper ? count : 0;
      for (const Triangle& t : sheet.triangles)
        mesh.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
    }
    const double expected = is_near_at_end ? (kGap - kD) / 2 : kMost;
    const auto bounds = safeSelfDisplacements(modelOf(mesh).get(), kMost, kD);
    EXPECT_EQ(bounds.size(), 2 * count);
    for (const double bound : bounds) {
      EXPECT_LE(bound, expected);
      EXPECT_NEAR(bound, expected, 1e-12);
    }

    const auto model = modelOf(mesh);
    const detail::deformable::PreparedMesh prepared(
        *model, {}, {}, "o", 1, detail::deformable::FeatureOwners::kAlways);
    std::size_t met = 0;
    const auto countPairs = [&met](const auto* pairs, std::size_t number) {
      for (std::size_t i = 0; i < number; ++i) EXPECT_EQ(pairs[i].window_hi, 1);
      met += number;
      return true;
    };
    const auto meet = [&](bool is_wanted) {
      met = 0;
      detail::deformable::candidatesAtEnd(
          prepared.instance(), prepared.instance(), countPairs, kD + 2 * kMost,
          [is_wanted](const auto&, const auto&) { return is_wanted; });
      return met;
    };
    EXPECT_EQ(meet(true) > 2 * count, is_near_at_end);
    EXPECT_EQ(meet(false), 0U);
    if (!is_near_at_end) {
      EXPECT_EQ(meet(true), 0U);
    }
  }
}

TEST(FCL_SAFE_DISPLACEMENTS, ofTwoMeshes) {
  int low = 0;
  for (std::uint64_t seed = 0; seed < rounds(8U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh a = crumpledSheet(random, 4, 0.1), b = crumpledSheet(random, 3, 0.1);
    Transform3<double> tf1 = Transform3<double>::Identity(), tf2 = tf1;
    tf1.translation() = V(0.1, 0, random.uniform(-0.5, 0.5));
    tf2.linear() =
        Eigen::AngleAxisd(0.3, random.point(1).normalized()).toRotationMatrix();
    TestMesh both;
    for (const V& p : a.t1) both.vertices.push_back(tf1 * p);
    for (const V& p : b.t1) both.vertices.push_back(tf2 * p);
    both.triangles = a.triangles;
    for (const Triangle& t : b.triangles)
      both.triangles.emplace_back(t[0] + a.t1.size(), t[1] + a.t1.size(),
                                  t[2] + a.t1.size());
    const double most = 0.2, d = 0.01;
    const auto rigid = makeModel<Rigid>(TestMesh{b.t1, b.triangles});
    const SafeDisplacements found =
        safeDisplacements(modelOf(a).get(), tf1, rigid.get(), tf2, most, d);
    std::vector<double> bounds = found.of_o1;
    bounds.insert(bounds.end(), found.of_o2.begin(), found.of_o2.end());
    low += expectBounds(random, both.vertices, allPairs(both, a.triangles.size()), most,
                        d, bounds);
    const SafeDisplacements swapped =
        safeDisplacements(rigid.get(), tf2, modelOf(a).get(), tf1, most, d);
    EXPECT_EQ(swapped.of_o1, found.of_o2);
    EXPECT_EQ(swapped.of_o2, found.of_o1);

    const SafeDisplacements moving =
        safeDisplacements(modelOf(a).get(), tf1, modelOf(b).get(), tf2, most, d);
    bounds = moving.of_o1;
    bounds.insert(bounds.end(), moving.of_o2.begin(), moving.of_o2.end());
    low += expectBounds(random, both.vertices, allPairs(both, a.triangles.size()), most,
                        d, bounds);
  }
  EXPECT_GE(low, rounds(200));
}

// Two parallel triangles of the distance 1, and one far away.
TEST(FCL_SAFE_DISPLACEMENTS, closedForm) {
  TestMesh mesh;
  for (const double z : {0., 1., 9.})
    for (const V& p : {V(0, 0, z), V(1, 0, z), V(0, 1, z)}) mesh.vertices.push_back(p);
  mesh.triangles = {Triangle(0, 1, 2), Triangle(3, 4, 5), Triangle(6, 7, 8)};
  // A vertex without a triangle is no feature.
  mesh.vertices.push_back(V(0.2, 0.2, 0));
  const auto model = makeModel<Model>(mesh);
  const auto bounds = safeSelfDisplacements(model.get(), 2, 0.25);
  ASSERT_EQ(bounds.size(), 10U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT(bounds[i], 0.375);
    EXPECT_GT(bounds[i], 0.375 - 1e-14);
  }
  for (std::size_t i = 6; i < 10; ++i) EXPECT_EQ(bounds[i], 2);
  const auto low = makeModel<DeformableBVHModel<OBBRSS<float>>>(mesh);
  EXPECT_EQ(safeSelfDisplacements(low.get(), 2, 0.25), bounds);
  // As near as the distance, and nearer.
  for (const double d : {1., 1.5})
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_EQ(safeSelfDisplacements(model.get(), 2, d)[i], 0);
}

TEST(FCL_SAFE_DISPLACEMENTS, whatCannotBeAskedIsRefused) {
  const auto model = makeModel<Model>(makeSheet(2, 2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double most : {0., -1., nan, HUGE_VAL})
    expectRefused([&] { safeSelfDisplacements(model.get(), most); },
                  "max_displacement is not above 0 or not finite");
  for (const double d : {-1., nan, HUGE_VAL})
    expectRefused([&] { safeSelfDisplacements(model.get(), 1, d); },
                  "min_distance is negative or not finite");
  const CollisionGeometry<double>* none = nullptr;
  expectRefused([&] { safeSelfDisplacements(none, 1); }, "o is null");
  Transform3<double> here = Transform3<double>::Identity(), broken = here;
  broken.translation()[1] = nan;
  expectRefused([&] { safeDisplacements(model.get(), here, none, here, 1); },
                "o2 is null");
  expectRefused([&] { safeDisplacements(model.get(), here, model.get(), broken, 1); },
                "o2: the transform");
  const Sphere<double> sphere(1);
  expectRefused([&] { safeDisplacements(model.get(), here, &sphere, here, 1); },
                "safeDisplacements: o2 is not a triangle mesh");
}

}  // namespace
}  // namespace test
}  // namespace fcl

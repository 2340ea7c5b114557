// SPDX-License-Identifier: BSD-3-Clause
//
// Rigid models whose trees FCL made badly: they have the same contacts as the others.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <thread>

#include "brute_force.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/bvh/refit_top_down.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

/// Expects that the contacts of two rigid models, one of which moves, are those of models
/// with AABBs.
/// @return their number
template <typename BV>
std::size_t expectContactsAsOfBoxes(const BVHModel<BV>& a, const BVHModel<BV>& b,
                                    const Vector3<double>& way) {
  using S = typename BV::S;
  const Transform3<S> still = Transform3<S>::Identity();
  Transform3<S> end = still;
  end.translation() = way.cast<S>();
  const auto contactsOf = [&](const CollisionGeometry<S>& x,
                              const CollisionGeometry<S>& y) {
    ContinuousContactResult<S> result;
    continuousCollide(&x, still, end, &y, still, still, ContinuousContactRequest<S>(),
                      result);
    return result;
  };
  const auto withBoxes = [](const BVHModel<BV>& model) {
    TestMesh mesh;
    for (int i = 0; i < model.num_vertices; ++i)
      mesh.vertices.push_back(model.vertices[i].template cast<double>());
    mesh.triangles.assign(model.tri_indices, model.tri_indices + model.num_tris);
    return makeModel<BVHModel<AABB<S>>>(mesh);
  };
  const auto expected = contactsOf(*withBoxes(a), *withBoxes(b));
  expectSameContacts(contactsOf(a, b), expected);
  return expected.contacts.size();
}

template <typename BV>
class FCL_RIGID_TREE_QUERY : public testing::Test {};
using Volumes = testing::Types<OBB<double>, OBBRSS<double>, kIOS<double>, RSS<double>,
                               KDOP<double, 24>, OBB<float>, OBBRSS<float>, kIOS<float>,
                               RSS<float>, KDOP<float, 16>>;
TYPED_TEST_SUITE(FCL_RIGID_TREE_QUERY, Volumes, );

// FCL's oriented boxes of thin triangles do not contain them after vertices were
// replaced. Those of triangles without area are at any place.
TYPED_TEST(FCL_RIGID_TREE_QUERY, replacedThinTriangles) {
  using Plain = BVHModel<TypeParam>;
  using S = typename TypeParam::S;
  constexpr std::uint64_t kSeed = 11;
  Random random(kSeed);
  std::size_t contacts = 0;
  for (int exponent = 0; exponent < 60; ++exponent) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", 2^-" + std::to_string(exponent));
    // The last ones have no area, like wires made of triangles.
    const double width = exponent < 56 ? std::ldexp(1, -exponent) : 0;
    TestMesh thin = makeTriangleSoup(3, 0.3, 0.5, kSeed);
    const Vector3<double> far = random.point(8);
    for (std::size_t i = 0; i < thin.vertices.size(); i += 3) {
      Vector3<double>* x = &thin.vertices[i];
      x[0] += far;
      x[1] += far;
      x[2] = 0.5 * (x[0] + x[1]) + width * random.point(0.3);
    }
    const auto model = makeModel<Plain>(makeTriangleSoup(3, 0.3, 0.5, kSeed));
    ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
    ASSERT_EQ(model->replaceSubModel(pointsAs<S>(thin.vertices)), BVH_OK);
    ASSERT_EQ(model->endReplaceModel(), BVH_OK);
    const TestMesh face{
        {far + Vector3<double>(-1, -1, -1), far + Vector3<double>(1, -1, -1),
         far + Vector3<double>(0, 1, -1)},
        {Triangle(0, 1, 2)}};
    contacts += expectContactsAsOfBoxes(*model, *makeModel<Plain>(face), {0, 0, -2});
  }
  EXPECT_GT(contacts, 100U);
}

// Sums of squares that leave the range of float, or of double: the axes of FCL's boxes
// are then not valid.
TYPED_TEST(FCL_RIGID_TREE_QUERY, coordinatesOfAllSizes) {
  using Plain = BVHModel<TypeParam>;
  using S = typename TypeParam::S;
  constexpr int kMost = std::numeric_limits<S>::max_exponent;
  // In double such coordinates need the exact test, which takes a hundred times as long.
  constexpr int kStep = sizeof(S) == 8 ? 5 : 1, kTriangles = sizeof(S) == 8 ? 15 : 50;
  std::size_t contacts = 0;
  for (int exponent = kMost / 2 - 12; exponent < kMost / 2 + 8; exponent += kStep)
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", 2^" + std::to_string(exponent));
      const double scale = std::ldexp(1, exponent);
      TestMesh meshes[2] = {makeTriangleSoup(kTriangles, 0.5, 0.5, 2 * seed),
                            makeTriangleSoup(kTriangles, 0.5, 0.5, 2 * seed + 1)};
      for (TestMesh& mesh : meshes)
        for (Vector3<double>& x : mesh.vertices) x *= scale;
      contacts += expectContactsAsOfBoxes(*makeModel<Plain>(meshes[0]),
                                          *makeModel<Plain>(meshes[1]),
                                          scale * Vector3<double>(0.3, 0.2, 0.1));
    }
  EXPECT_GT(contacts, 200U);
}

/// The second of two meshes moves by `way`: all contacts of the step.
template <typename S>
ContinuousContactResult<S> contactsAlong(const CollisionGeometry<S>& a,
                                         const CollisionGeometry<S>& b,
                                         const Vector3<double>& way,
                                         int num_threads = 1) {
  const Transform3<S> still = Transform3<S>::Identity();
  Transform3<S> end = still;
  end.translation() = way.cast<S>();
  ContinuousContactRequest<S> request;
  request.num_threads = num_threads;
  ContinuousContactResult<S> result;
  continuousCollide(&a, still, still, &b, still, end, request, result);
  return result;
}

/// The number of feature pairs of two meshes that touch, each tested separately; or of
/// one mesh without contacts of its own, whose second part moves.
std::size_t bruteForceCount(const TestMesh& a, const TestMesh& b,
                            const Vector3<double>& way) {
  FramePairMesh both;
  both.previous = a.vertices;
  both.previous.insert(both.previous.end(), b.vertices.begin(), b.vertices.end());
  both.current = both.previous;
  both.triangles = a.triangles;
  const std::size_t n = a.vertices.size();
  for (std::size_t i = n; i < both.current.size(); ++i) both.current[i] += way;
  for (const Triangle& t : b.triangles)
    both.triangles.emplace_back(t[0] + n, t[1] + n, t[2] + n);
  return bruteForceSelfContacts(both).size();
}

// A model that is replaced and refit repeatedly answers like a model that was built from
// its vertices: with each kind of refit, after each replacement. Coordinates are
// multiples of 2^-10, so that all sums here are exact.
TYPED_TEST(FCL_RIGID_TREE_QUERY, replacedAgainAndAgain) {
  using Plain = BVHModel<TypeParam>;
  using Deformable = DeformableBVHModel<TypeParam>;
  using S = typename TypeParam::S;
  const auto onGrid = [](TestMesh mesh) {
    for (Vector3<double>& p : mesh.vertices)
      p = (1024 * p).array().round().matrix() / 1024;
    return mesh;
  };
  const TestMesh floor = onGrid(makeSheet(8, 8));
  const TestMesh ball = onGrid(moved(makeIcosphere(1, 0.25), 0.4, 0.5, 0.5));
  const Vector3<double> way(0.125, 0, -0.5);
  const auto model = makeModel<Plain>(floor), falling = makeModel<Plain>(ball);
  const auto true_falling = makeModel<Deformable>(ball);
  std::size_t contacts = 0;
  for (int round = 0; round < 4; ++round) {
    SCOPED_TRACE(round);
    const TestMesh next = onGrid(makeSheet(8, 8, [round](double u, double v) {
      return Vector3<double>(u, v, 0.05 * round * (u * u + v) - (round == 2 ? 30 : 0));
    }));
    const auto expected =
        contactsAlong<S>(*makeModel<Deformable>(next), *true_falling, way);
    EXPECT_EQ(expected.contacts.size(), bruteForceCount(next, ball, way));
    contacts += expected.contacts.size();
    const auto expectRight = [&] {
      expectSameContacts(contactsAlong<S>(*model, *falling, way), expected);
    };
    for (const bool bottom_up : {true, true, false}) {
      ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
      ASSERT_EQ(model->replaceSubModel(pointsAs<S>(next.vertices)), BVH_OK);
      ASSERT_EQ(model->endReplaceModel(true, bottom_up), BVH_OK);
      expectRight();
    }
    refitTopDown(*model);
    expectRight();
  }
  EXPECT_GT(contacts, 50U);
}

// Queries only read: two threads that share models, and two threads within a query.
TYPED_TEST(FCL_RIGID_TREE_QUERY, twoThreads) {
  using S = typename TypeParam::S;
  const Vector3<double> way(0.1, 0, -0.6);
  const auto model = makeModel<BVHModel<TypeParam>>(makeSheet(12, 12));
  const auto ball =
      makeModel<BVHModel<TypeParam>>(moved(makeIcosphere(2, 0.25), 0.4, 0.5, 0.5));
  for (const bool bottom_up : {false, true}) {
    ASSERT_EQ(model->beginReplaceModel(), BVH_OK);
    ASSERT_EQ(model->replaceSubModel(pointsAs<S>(makeSheet(12, 12).vertices)), BVH_OK);
    ASSERT_EQ(model->endReplaceModel(true, bottom_up), BVH_OK);
    const auto expected = contactsAlong<S>(*model, *ball, way);
    EXPECT_FALSE(expected.contacts.empty());
    ContinuousContactResult<S> results[2];
    std::thread other([&] { results[1] = contactsAlong<S>(*model, *ball, way); });
    results[0] = contactsAlong<S>(*model, *ball, way);
    other.join();
    for (const auto& result : results) expectIdentical(result, expected);
    expectIdentical(contactsAlong<S>(*model, *ball, way, 2), expected);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

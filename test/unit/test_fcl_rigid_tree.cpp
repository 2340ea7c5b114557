// SPDX-License-Identifier: BSD-3-Clause
//
// Rigid models whose trees FCL made badly: their contacts are the others'.
#include "tree/rigid_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

/// Of a model as it is built, and after its vertices were replaced.
template <typename BV>
void expectSound(bool built, bool from_the_bottom) {
  using S = typename BV::S;
  const TestMesh mesh = bentSheet(6), next = shaken(mesh, 0.15, 3);
  const auto model = makeModel<BVHModel<BV>>(mesh);
  EXPECT_EQ(detail::deformable::RigidTree::isSound(*model), built);
  for (const bool bottom_up : {true, false}) {
    model->beginReplaceModel();
    model->replaceSubModel(pointsAs<S>(next.vertices));
    model->endReplaceModel(true, bottom_up);
    EXPECT_EQ(detail::deformable::RigidTree::isSound(*model),
              bottom_up ? from_the_bottom : built);
  }
}

// What a query leaves to FCL's tree, and what it does not.
TEST(FCL_RIGID_TREE, whatIsSound) {
  expectSound<AABB<double>>(true, true);
  expectSound<KDOP<float, 24>>(true, true);
  expectSound<OBB<double>>(true, false);
  expectSound<OBB<float>>(true, false);
  expectSound<OBBRSS<double>>(true, false);
  expectSound<kIOS<float>>(true, false);
  // Triangles with two equal sides tell nothing.
  EXPECT_FALSE(detail::deformable::RigidTree::isSound(
      *makeModel<BVHModel<OBB<double>>>(makeSheet(4, 4))));
}

/// The contacts of two rigid models, one of which moves, are those of models with AABBs.
/// @return how many
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

// FCL's oriented boxes of thin triangles are not around them once vertices were replaced,
// and those of triangles without area are anywhere.
TYPED_TEST(FCL_RIGID_TREE_QUERY, replacedThinTriangles) {
  using Plain = BVHModel<TypeParam>;
  using S = typename TypeParam::S;
  constexpr std::uint64_t kSeed = 11;
  Random random(kSeed);
  std::size_t contacts = 0;
  for (int exponent = 0; exponent < 60; ++exponent) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", 2^-" + std::to_string(exponent));
    // The last ones have no area, as wires made of triangles.
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

// Sums of squares that leave the range of float, or of double: FCL's boxes have axes that
// are none.
TYPED_TEST(FCL_RIGID_TREE_QUERY, coordinatesOfAllSizes) {
  using Plain = BVHModel<TypeParam>;
  using S = typename TypeParam::S;
  constexpr int kMost = std::numeric_limits<S>::max_exponent;
  // In double such coordinates take the exact test, a hundred times as long.
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

}  // namespace
}  // namespace test
}  // namespace fcl

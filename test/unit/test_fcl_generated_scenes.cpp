// SPDX-License-Identifier: BSD-3-Clause
//
// The generated scenes have the properties that their declarations promise. The library's
// own queries check it.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "generated_scenes.h"

namespace fcl {
namespace test {
namespace {

using Result = ContinuousContactResult<double>;

void makeStep(const FramePairMesh& mesh, DeformableBVHModel<>& model) {
  ASSERT_EQ(model.beginModel(), BVH_OK);
  ASSERT_EQ(model.addSubModel(mesh.previous, mesh.triangles), BVH_OK);
  ASSERT_EQ(model.endModel(FclTree::kSkip), BVH_OK);
  ASSERT_EQ(model.updateFrames(mesh.previous[0].data(), mesh.current[0].data(),
                               mesh.previous.size()),
            BVH_OK)
      << model.lastError();
}

Result selfContacts(const FramePairMesh& mesh) {
  DeformableBVHModel<> model;
  makeStep(mesh, model);
  Result result;
  continuousSelfCollide(&model, ContinuousContactRequest<double>(), result);
  return result;
}

std::size_t trianglesIn(const Result& result) {
  std::set<std::intptr_t> triangles;
  for (const auto& contact : result.contacts) {
    triangles.insert(contact.b1);
    triangles.insert(contact.b2);
  }
  return triangles.size();
}

TEST(FCL_GENERATED_SCENES, smoothClothTouchesInAFewPlacesLate) {
  for (const int triangles : {5000, 20000, 60000}) {
    SCOPED_TRACE(triangles);
    const FramePairMesh mesh = makeSmoothCloth(triangles);
    const auto count = static_cast<double>(mesh.triangles.size());
    EXPECT_NEAR(count, triangles, 0.05 * triangles);
    const Result result = selfContacts(mesh);
    EXPECT_FALSE(result.initially_crossing);
    EXPECT_GT(result.time_of_contact, 0.5);
    EXPECT_GT(result.contacts.size(), 20u);
    EXPECT_LT(static_cast<double>(trianglesIn(result)), 0.01 * count);
  }
}

TEST(FCL_GENERATED_SCENES, tilesHaveTheSameDensityOfContactsAtAnySize) {
  double density = 0;
  for (const int tiles : {16, 64}) {
    const FramePairMesh mesh = makeTiles(tiles * kTileTriangles);
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(tiles * kTileTriangles));
    const Result result = selfContacts(mesh);
    EXPECT_FALSE(result.initially_crossing);
    EXPECT_GT(result.time_of_contact, 0.2);
    for (const auto& contact : result.contacts)
      ASSERT_EQ(contact.b1 / kTileTriangles, contact.b2 / kTileTriangles);
    const double now = static_cast<double>(result.contacts.size()) /
                       static_cast<double>(mesh.triangles.size());
    EXPECT_GT(now, 0.02);
    if (density > 0) {
      EXPECT_NEAR(now / density, 1, 0.1);
    }
    density = now;
  }
}

TEST(FCL_GENERATED_SCENES, bodiesMeetLate) {
  const auto bodies = makeMeetingBodies(4);
  DeformableBVHModel<> a, b;
  makeStep(bodies.first, a);
  makeStep(bodies.second, b);
  const auto origin = Transform3<double>::Identity();
  Result result;
  continuousCollide(&a, origin, origin, &b, origin, origin,
                    ContinuousContactRequest<double>(), result);
  EXPECT_FALSE(result.initially_crossing);
  EXPECT_GT(result.time_of_contact, 0.5);
  EXPECT_GT(result.contacts.size(), 20u);
}

TEST(FCL_GENERATED_SCENES, aMoveByAMillionIsExact) {
  const FramePairMesh mesh = makeSmoothCloth(2000);
  FramePairMesh moved = mesh;
  const Vector3<double> by(1e6, -1e6, 1e6);
  move(moved, by);
  for (std::size_t i = 0; i < mesh.previous.size(); ++i) {
    ASSERT_EQ(moved.previous[i] - by, mesh.previous[i]);
    ASSERT_EQ(moved.current[i] - by, mesh.current[i]);
  }
}

TEST(FCL_GENERATED_SCENES, sequencesMoveInSmallStepsAndTouch) {
  for (const auto& sequence :
       {makeCrumplingSheet(51), makeWavingCloth(51), makeMixingBalls(51)}) {
    ASSERT_EQ(sequence.frames.size(), 51u);
    EXPECT_NEAR(static_cast<double>(sequence.triangles.size()), 20000, 500);
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < 50; i += 7)
      contacts += selfContacts(sequence.pair(i)).contacts.size();
    contacts += selfContacts(sequence.pair(49)).contacts.size();
    EXPECT_GT(contacts, 10u);
    double longest = 0;
    for (std::size_t i = 0; i < 50; ++i)
      for (std::size_t v = 0; v < sequence.frames[i].size(); ++v)
        longest =
            std::max(longest, (sequence.frames[i + 1][v] - sequence.frames[i][v]).norm());
    EXPECT_GT(longest, 0.005);
    EXPECT_LT(longest, 0.1);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

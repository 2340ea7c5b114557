// SPDX-License-Identifier: BSD-3-Clause
//
// Real scenes with exact truth (they are outside of the project; see shared_data.h). Each
// kind of query finds every contact and invents none.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h"
#include "fcl/narrowphase/detail/traversal/collision_node.h"
#include "scene_data.h"
#include "shared_data.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<KDOP<double, 16>>;
using Plain = BVHModel<KDOP<double, 16>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

template <typename S>
std::vector<PairName> pairsOf(const ContinuousContactResult<S>& result) {
  std::vector<PairName> pairs;
  for (const auto& c : result.contacts) pairs.push_back(pairName(c));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Expects that both lists are equal. Differences are counted, with one example, not
/// listed.
void expectPairs(const std::vector<PairName>& got,
                 const std::vector<PairName>& expected) {
  const auto report = [](const char* what, const std::vector<PairName>& x,
                         const std::vector<PairName>& y) {
    std::vector<PairName> only;
    std::set_difference(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(only));
    std::ostringstream example;
    if (!only.empty())
      for (const int id : only[0]) example << ' ' << id;
    EXPECT_EQ(only.size(), 0u) << what << ", for example" << example.str();
  };
  report("missed", expected, got);
  report("invented", got, expected);
  EXPECT_EQ(got.size(), expected.size()) << "a pair was listed twice";
}

struct SceneFiles {
  const char* folder;
  const char* t0;
  const char* t1;
  std::size_t vertices;
  std::size_t triangles;
  std::size_t pairs;
};

void PrintTo(const SceneFiles& files, std::ostream* out) { *out << files.folder; }

class Scenes : public ::testing::TestWithParam<SceneFiles> {
 protected:
  /// @return whether the scene exists.
  bool load() {
    const SceneFiles& files = GetParam();
    const auto folder = sharedData(std::string("scenes/") + files.folder);
    if (!folder) return false;
    const FramePairMesh mesh =
        readFramePair(*folder + "/" + files.t0, *folder + "/" + files.t1);
    t0_ = {mesh.previous, mesh.triangles};
    t1_ = {mesh.current, mesh.triangles};
    EXPECT_EQ(t0_.vertices.size(), files.vertices);
    EXPECT_EQ(t0_.triangles.size(), files.triangles);
    const auto truth = readTruePairs(*folder + "/true_pairs.csv.gz");
    truth_.assign(truth.begin(), truth.end());
    EXPECT_EQ(truth_.size(), files.pairs);
    return true;
  }

  TestMesh t0_, t1_;
  std::vector<PairName> truth_;
};

TEST_P(Scenes, ContactsAreTheTruth) {
  if (!load()) GTEST_SKIP() << kNoSharedData;
  const auto model = makeModel<Model>(t0_, t1_);
  const Result all = selfContacts<double>(*model);
  expectPairs(pairsOf(all), truth_);
  EXPECT_TRUE(
      std::is_sorted(all.contacts.begin(), all.contacts.end(),
                     [](const auto& a, const auto& b) { return a.toc_lo < b.toc_lo; }));
  for (const auto& c : all.contacts) ASSERT_LE(c.toc_hi - c.toc_lo, 1e-4);
  expectSameContacts(selfContacts<double>(*makeModel<Plain>(t0_, t1_)), all);

  Request request;
  request.query = ContinuousQuery::kFirst;
  const Result first = selfContacts<double>(*model, request);
  ASSERT_FALSE(first.contacts.empty());
  EXPECT_LE(first.contacts[0].toc_lo, all.contacts[0].toc_hi);
  EXPECT_LE(all.contacts[0].toc_lo, first.contacts[0].toc_hi);
  EXPECT_EQ(first.initially_crossing, all.initially_crossing);

  request = Request();
  request.num_max_contacts = 1000;
  const Result some = selfContacts<double>(*model, request);
  EXPECT_TRUE(some.contacts_cut);
  ASSERT_EQ(some.contacts.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(nameOf(some.contacts[i]), nameOf(all.contacts[i])) << i;
    ASSERT_EQ(some.contacts[i].toc_lo, all.contacts[i].toc_lo) << i;
  }
}

// The files' coordinates are floats.
TEST_P(Scenes, FloatModelsFindTheSame) {
  if (!load()) GTEST_SKIP() << kNoSharedData;
  ContinuousContactRequest<float> request_f;
  Request request_d;
  request_f.toc_err = 0x1p-13f;
  request_d.toc_err = 0x1p-13;
  const auto floats = selfContacts<float>(
      *makeModel<DeformableBVHModel<KDOP<float, 16>>>(t0_, t1_), request_f);
  expectPairs(pairsOf(floats), truth_);
  expectIdentical(floats, selfContacts<double>(*makeModel<Model>(t0_, t1_), request_d),
                  false);
}

TEST_P(Scenes, TraversalNodeFindsTheSame) {
  if (!load()) GTEST_SKIP() << kNoSharedData;
  const auto model = makeModel<Model>(t0_, t1_);
  const Result all = selfContacts<double>(*model);
  detail::DeformableContinuousCollisionTraversalNode<double> node;
  CollisionResult<double> result;
  ASSERT_TRUE(detail::initialize(
      node, *model, CollisionRequest<double>(std::size_t{1} << 30, true), result));
  detail::selfCollide(&node);
  EXPECT_EQ(node.time_of_contact, all.time_of_contact);
  EXPECT_EQ(node.isInitiallyCrossing(), all.initially_crossing);
  using Row = std::array<double, 8>;
  const auto row = [](std::intptr_t b1, std::intptr_t b2, const Vector3<double>& p,
                      const Vector3<double>& n) {
    return Row{static_cast<double>(b1),
               static_cast<double>(b2),
               p[0],
               p[1],
               p[2],
               n[0],
               n[1],
               n[2]};
  };
  std::vector<Row> got, expected;
  for (std::size_t i = 0; i < result.numContacts(); ++i) {
    const auto& c = result.getContact(i);
    got.push_back(row(c.b1, c.b2, c.pos, c.normal));
  }
  for (const auto& c : all.contacts) expected.push_back(row(c.b1, c.b2, c.pos, c.normal));
  std::sort(got.begin(), got.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(got.size(), truth_.size());
  EXPECT_TRUE(got == expected);

  CollisionResult<double> one;
  ASSERT_TRUE(detail::initialize(node, *model, CollisionRequest<double>(1, true), one));
  detail::selfCollide(&node);
  ASSERT_EQ(one.numContacts(), 1u);
  EXPECT_EQ(node.time_of_contact, all.time_of_contact);
}

// After a shift that rounds it, the scene is another one, on which two trees with
// different boxes must agree. On a grid that the shift keeps exactly, the contacts are
// the same as without the shift.
TEST_P(Scenes, FarFromTheOrigin) {
  if (!load()) GTEST_SKIP() << kNoSharedData;
  const TestMesh far0 = moved(t0_, 1e6, -1e6, 1e6), far1 = moved(t1_, 1e6, -1e6, 1e6);
  const Result own = selfContacts<double>(*makeModel<Model>(far0, far1));
  EXPECT_GT(own.contacts.size(), truth_.size() / 2);
  expectSameContacts(selfContacts<double>(*makeModel<Plain>(far0, far1)), own);

  const auto onGrid = [](TestMesh mesh, double shift) {
    const double grid = 0x1p-28;
    for (auto& p : mesh.vertices)
      for (int k = 0; k < 3; ++k) {
        const double here = std::round(p[k] / grid) * grid;
        p[k] = here + shift;
        EXPECT_EQ(p[k] - shift, here);
      }
    return mesh;
  };
  const auto contacts = [&](double shift) {
    return pairsOf(
        selfContacts<double>(*makeModel<Model>(onGrid(t0_, shift), onGrid(t1_, shift))));
  };
  const std::vector<PairName> here = contacts(0);
  EXPECT_GT(here.size(), truth_.size() / 2);
  expectPairs(contacts(1e6), here);
}

INSTANTIATE_TEST_SUITE_P(Real, Scenes,
                         ::testing::Values(SceneFiles{"cloth-ball", "92.ply", "93.ply",
                                                      46598, 92230, 94822 + 19032},
                                           SceneFiles{"n-body", "18.ply", "19.ply", 73960,
                                                      146480, 41031 + 9459}),
                         [](const testing::TestParamInfo<SceneFiles>& info) {
                           std::string name = info.param.folder;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace test
}  // namespace fcl

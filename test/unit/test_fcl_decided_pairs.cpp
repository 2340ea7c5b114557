// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh without owners meets a pair of features several times. It is decided once, with
// the same answers.
#include "query/decided_pairs.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <utility>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "scene_data.h"
#include "test_models.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

FeatureCandidate candidateOf(std::uint32_t v, double window_hi) {
  FeatureCandidate pair{};
  pair.kind = ContinuousContactKind::kEdgeEdge;
  pair.first_on_a = true;
  for (std::uint32_t k = 0; k < 4; ++k) pair.vertices[k] = v + k;
  pair.window_hi = window_hi;
  return pair;
}

TEST(FCL_DEFORMABLE_QUERY, decidedPairsAreTheSameInAll) {
  const FeatureCandidate pair = candidateOf(7, 0.5);
  DecidedPairs decided;
  EXPECT_EQ(decided.find(pair, 0.25), nullptr);
  decided.add(pair, 0.25, {Answer::kYes, 0.125, 0.25, DecidedBy::kExact});
  const ElementaryResult* found = decided.find(pair, 0.25);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->answer, Answer::kYes);
  EXPECT_EQ(found->toc_lo, 0.125);
  EXPECT_EQ(found->toc_hi, 0.25);
  EXPECT_EQ(found->decided_by, DecidedBy::kExact);
  EXPECT_EQ(decided.find(pair, 0.24), nullptr);
  EXPECT_EQ(decided.find(candidateOf(7, 0.6), 0.25), nullptr);
  FeatureCandidate other = pair;
  other.kind = ContinuousContactKind::kVertexFace;
  EXPECT_EQ(decided.find(other, 0.25), nullptr);
  other = pair;
  other.first_on_a = false;
  EXPECT_EQ(decided.find(other, 0.25), nullptr);
  // Others take the place of some, and are not taken for them.
  for (std::uint32_t v = 0; v < 100000; ++v) {
    const double t = v * 0x1p-20;
    const FeatureCandidate next = candidateOf(v, 0.5);
    if (v != 7) {
      EXPECT_EQ(decided.find(next, 0.25), nullptr);
    }
    decided.add(next, 0.25, {Answer::kYes, t, t, DecidedBy::kExact});
    ASSERT_NE(decided.find(next, 0.25), nullptr);
    EXPECT_EQ(decided.find(next, 0.25)->toc_lo, t);
  }
}

/// Names and brackets of the contacts of a box that moves onto an equal one, side to
/// side.
template <typename Model>
std::map<test::PairName, std::pair<double, double>> alignedBoxes(ContinuousQuery query,
                                                                 StageCounts& counts) {
  const auto box = test::makeModel<Model>(test::makeBox({0.5, 0.5, 0.5}, 2));
  ContinuousContactRequest<double> request;
  request.query = query;
  ContinuousContactResult<double> result;
  Transform3<double> still = Transform3<double>::Identity(), from = still, to = still;
  from.translation() = Vector3<double>(3, 0, 0);
  to.translation() = Vector3<double>(0.5, 0, 0);
  continuousCollide(box.get(), still, still, box.get(), from, to, request, result);
  counts = result.counts;
  std::map<test::PairName, std::pair<double, double>> contacts;
  for (const auto& contact : result.contacts) {
    // In a pair the same ids may be a vertex of one mesh or of the other one.
    test::PairName name = test::pairName(contact);
    name[0] += 2 * contact.first_on_o1;
    if (contact.kind == ContinuousContactKind::kEdgeEdge)
      name = {4, contact.vertices[0] * 1000 + contact.vertices[1],
              contact.vertices[2] * 1000 + contact.vertices[3], 0, 0};
    EXPECT_TRUE(contacts.insert({name, {contact.toc_lo, contact.toc_hi}}).second);
  }
  return contacts;
}

// Exact tests decide whether sides that meet at a border touch.
TEST(FCL_DEFORMABLE_QUERY, pairsMetSeveralTimes) {
  for (const ContinuousQuery query : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
    StageCounts repeated, once;
    const auto rigid = alignedBoxes<BVHModel<OBBRSS<double>>>(query, repeated),
               owned = alignedBoxes<DeformableBVHModel<>>(query, once);
    EXPECT_GT(owned.size(), 200U);
    EXPECT_EQ(rigid, owned);
    EXPECT_GT(once.exact_tests, 100U);
    EXPECT_GT(repeated.exact_tests, 2 * once.exact_tests);
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// 4,120 elementary queries from the literature. They were made to break floating-point
// tests, and have the truth by rational arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "elementary/elementary.h"
#include "elementary/exact.h"
#include "query_csv.h"
#include "shared_data.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

TEST(FCL_HARD_QUERIES, allAreAnsweredRight) {
  const auto root = test::sharedData("queries");
  if (!root) GTEST_SKIP() << test::kNoSharedData;
  std::size_t count = 0, contacts = 0, box = 0, filter = 0;
  for (const auto& folder : std::filesystem::directory_iterator(*root)) {
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      const std::string path =
          folder.path().string() + (kind == ContinuousContactKind::kVertexFace
                                        ? "/vertex-face.csv"
                                        : "/edge-edge.csv");
      if (!std::filesystem::exists(path)) continue;
      const fcl_ccd::QueryList list = fcl_ccd::readQueries(path);
      ASSERT_TRUE(list.has_truth) << path;
      for (const auto& query : list.queries) EXPECT_EQ(query.num_not_doubles, 0U) << path;
      for (std::size_t i = 0; i < list.queries.size(); ++i) {
        const auto& x = list.queries[i].x;
        const FeaturePoints points{{&x[0], &x[1], &x[2], &x[3]}};
        const Answer truth = list.queries[i].truth ? Answer::kYes : Answer::kNo;
        const ElementaryResult exact = decideExactly(kind, points, 1e-12);
        const ElementaryResult r = elementaryTest(kind, points, 0, 1, 1e-6);
        ASSERT_EQ(exact.answer, truth) << path << ", query " << i;
        ASSERT_EQ(r.answer, truth) << path << ", query " << i;
        if (truth == Answer::kYes) {
          EXPECT_LE(r.toc_lo, exact.toc_hi) << path << ", query " << i;
          EXPECT_GE(r.toc_hi, exact.toc_lo) << path << ", query " << i;
        }
        ++count;
        contacts += list.queries[i].truth;
        box += r.decided_by == DecidedBy::kBox;
        filter += r.decided_by == DecidedBy::kFilter;
      }
    }
  }
  EXPECT_EQ(count, 4120U);
  EXPECT_EQ(contacts, 160U);
  // The cheap stages take part.
  EXPECT_GT(box, 0U);
  EXPECT_GT(filter, 0U);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

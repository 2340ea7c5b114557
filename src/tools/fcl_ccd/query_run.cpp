// SPDX-License-Identifier: BSD-3-Clause
#include "query_run.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "rational_points.h"

namespace fcl_ccd {

using fcl::detail::deformable::Answer;
using fcl::detail::deformable::ElementaryResult;
using fcl::detail::deformable::VertexPath;

ElementaryResult runQuery(const QuerySet& set, std::size_t query, double toc_err) {
  const auto& [x, truth, toc, num_not_doubles, exact] = set.queries[query];
  const fcl::ContinuousContactKind kind = set.fileOf(query).kind;
  // The width of a bracket is above 0. As in the library, 0 stands for the smallest one.
  const double width = std::max(toc_err, std::numeric_limits<double>::min());
  if (exact) return exact->decide(kind, width);
  const VertexPath paths[4] = {x[0], x[1], x[2], x[3]};
  return fcl::detail::deformable::elementaryTest(kind, paths, 0, 1, width);
}

QueryErrors compareWithTruth(const QuerySet& set,
                             const std::vector<ElementaryResult>& results) {
  QueryErrors errors;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Answer answer = results[k].answer;
    if (answer == Answer::kUnsure) ++errors.uncertain;
    if (!set.has_truth) continue;
    const bool truth = set.queries[k].truth;
    const std::optional<double>& toc = set.queries[k].toc;
    if (truth) ++errors.num_true;
    if (answer == Answer::kNo && truth) ++errors.false_negatives;
    if (answer == Answer::kYes && !truth) ++errors.false_positives;
    if (answer != Answer::kYes || !toc) continue;
    ++errors.num_times;
    // The bounds are doubles. So the nearest double of a time between them is, too.
    if (*toc < results[k].toc_lo || *toc > results[k].toc_hi) ++errors.wrong_times;
  }
  return errors;
}

}  // namespace fcl_ccd

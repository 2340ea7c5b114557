// SPDX-License-Identifier: BSD-3-Clause
#include "queries_command.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "number_text.h"
#include "output_set.h"
#include "query_csv.h"

namespace fcl_ccd {
namespace {

using fcl::detail::deformable::Answer;
using fcl::detail::deformable::ElementaryResult;
using fcl::detail::deformable::elementaryTest;
using fcl::detail::deformable::VertexPath;
using Json = nlohmann::ordered_json;

struct Summary {
  std::size_t num_true{0};
  std::size_t false_negatives{0};
  std::size_t false_positives{0};
  std::size_t uncertain{0};
  double ns_per_query{0};
};

std::vector<ElementaryResult> runQueries(const QueryList& list,
                                         const QueriesOptions& options, double& seconds) {
  using Clock = std::chrono::steady_clock;
  std::vector<ElementaryResult> results(list.queries.size());
  seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < options.repeat; ++i) {
    const auto start = Clock::now();
    for (std::size_t k = 0; k < list.queries.size(); ++k) {
      const auto& x = list.queries[k].x;
      const VertexPath paths[4] = {x[0], x[1], x[2], x[3]};
      results[k] = elementaryTest(options.kind, paths, 0, 1, options.toc_err);
    }
    const std::chrono::duration<double> taken = Clock::now() - start;
    seconds = std::min(seconds, taken.count());
  }
  return results;
}

Summary summarize(const QueryList& list, const std::vector<ElementaryResult>& results) {
  Summary summary;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const bool truth = list.queries[k].truth;
    const Answer answer = results[k].answer;
    if (truth) ++summary.num_true;
    if (answer == Answer::kUnsure) ++summary.uncertain;
    if (answer == Answer::kNo && truth) ++summary.false_negatives;
    if (answer == Answer::kYes && !truth) ++summary.false_positives;
  }
  return summary;
}

std::string answerLines(const std::vector<ElementaryResult>& results) {
  std::string lines;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const ElementaryResult& result = results[k];
    lines.append(std::to_string(k));
    if (result.answer == Answer::kNo) {
      lines.append(",no,,\n");
      continue;
    }
    lines.append(result.answer == Answer::kYes ? ",yes," : ",unsure,");
    lines.append(numberText(result.toc_lo)).append(1, ',');
    lines.append(numberText(result.toc_hi)).append(1, '\n');
  }
  return lines;
}

Json toJson(const QueryList& list, const Summary& summary) {
  const auto ifTruth = [&](std::size_t count) {
    return list.has_truth ? Json(count) : Json(nullptr);
  };
  return {{"queries", list.queries.size()},
          {"true", ifTruth(summary.num_true)},
          {"false_negatives", ifTruth(summary.false_negatives)},
          {"false_positives", ifTruth(summary.false_positives)},
          {"uncertain", summary.uncertain},
          {"ns_per_query", summary.ns_per_query}};
}

std::string table(const QueryList& list, const Summary& summary) {
  const auto ifTruth = [&](std::size_t count) {
    return list.has_truth ? std::to_string(count) : "-";
  };
  char row[256];  // six fields of at most 20 characters
  std::snprintf(
      row, sizeof row, "%7zu  %6s  %15s  %15s  %9zu  %12.1f\n", list.queries.size(),
      ifTruth(summary.num_true).c_str(), ifTruth(summary.false_negatives).c_str(),
      ifTruth(summary.false_positives).c_str(), summary.uncertain, summary.ns_per_query);
  return std::string("queries    true  false negatives  false positives  uncertain  ") +
         "ns per query\n" + row;
}

}  // namespace

void queriesCommand(const QueriesOptions& options) {
  OutputSet outputs(options.files);
  OutputFile* const json_file = outputs.open(options.json_path);
  const QueryList list = readQueries(options.files);
  if (list.num_rounded > 0)
    std::fprintf(stderr,
                 "fcl-ccd: warning: %s not exactly of type double, and rounded to the "
                 "nearest one\n",
                 list.num_rounded == 1
                     ? "1 coordinate is"
                     : (std::to_string(list.num_rounded) + " coordinates are").c_str());

  double seconds = 0;
  const std::vector<ElementaryResult> results = runQueries(list, options, seconds);
  Summary summary = summarize(list, results);
  summary.ns_per_query = 1e9 * seconds / static_cast<double>(results.size());

  print(options.print_answers ? answerLines(results) : table(list, summary),
        outputs.hasStandardOutput());
  if (json_file != nullptr) json_file->write(toJson(list, summary).dump(2) + '\n');
  outputs.publish();
}

}  // namespace fcl_ccd

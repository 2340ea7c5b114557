// SPDX-License-Identifier: BSD-3-Clause
#include "queries_command.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <limits>

#include "contact_text.h"
#include "json.h"
#include "number_text.h"
#include "output_set.h"
#include "query_run.h"

namespace fcl_ccd {
namespace {

using fcl::detail::deformable::Answer;
using fcl::detail::deformable::ElementaryResult;

std::vector<ElementaryResult> runQueries(const QuerySet& set,
                                         const QueriesOptions& options, double& seconds) {
  using Clock = std::chrono::steady_clock;
  std::vector<ElementaryResult> results(set.queries.size());
  seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < options.repeat; ++i) {
    const auto start = Clock::now();
    for (std::size_t k = 0; k < results.size(); ++k)
      results[k] = runQuery(set, k, options.toc_err);
    const std::chrono::duration<double> taken = Clock::now() - start;
    seconds = std::min(seconds, taken.count());
  }
  return results;
}

/// A query and its answer.
struct AnswerRow {
  const QuerySet& set;
  std::size_t index;
  const ElementaryResult& result;

  const ElementaryQuery& query() const { return set.queries[index]; }
  bool hasTimes() const { return result.answer != Answer::kNo; }
};

void appendTime(const std::optional<double>& time, std::string& line) {
  if (time) line.append(numberText(*time));
}

constexpr CsvColumn<AnswerRow> kAnswerColumns[] = {
    {"index", [](const AnswerRow& row,
                 std::string& line) { line.append(std::to_string(row.index)); }},
    {"answer",
     [](const AnswerRow& row, std::string& line) {
       const Answer answer = row.result.answer;
       line.append(answer == Answer::kNo    ? "no"
                   : answer == Answer::kYes ? "yes"
                                            : "unsure");
     }},
    {"toc_lo",
     [](const AnswerRow& row, std::string& line) {
       if (row.hasTimes()) appendTime(row.result.toc_lo, line);
     }},
    {"toc_hi",
     [](const AnswerRow& row, std::string& line) {
       if (row.hasTimes()) appendTime(row.result.toc_hi, line);
     }},
    {"kind",
     [](const AnswerRow& row, std::string& line) {
       line.append(nameOf(row.set.fileOf(row.index).kind));
     }},
    {"truth",
     [](const AnswerRow& row, std::string& line) {
       if (row.set.has_truth) line.append(row.query().truth ? "yes" : "no");
     }},
    {"toc",
     [](const AnswerRow& row, std::string& line) { appendTime(row.query().toc, line); }},
    {"not_doubles",
     [](const AnswerRow& row, std::string& line) {
       line.append(std::to_string(row.query().num_not_doubles));
     }},
    {"file", [](const AnswerRow& row, std::string& line) {
       line.append(csvField(row.set.fileOf(row.index).path));
     }}};

std::string answerLines(const QuerySet& set, const std::vector<ElementaryResult>& results,
                        const std::optional<ColumnNumbers>& columns) {
  const ColumnNumbers plain{0, 1, 2, 3};
  std::string lines = columns ? csvHead(kAnswerColumns, *columns) : "";
  for (std::size_t k = 0; k < results.size(); ++k)
    appendCsvLine(kAnswerColumns, columns ? *columns : plain,
                  AnswerRow{set, k, results[k]}, lines);
  return lines;
}

Json toJson(const QuerySet& set, const QueryErrors& errors, double ns_per_query) {
  const auto ifTruth = [&](std::size_t count) {
    return set.has_truth ? Json(count) : Json(nullptr);
  };
  return {
      {"queries", set.queries.size()},
      {"true", ifTruth(errors.num_true)},
      {"false_negatives", ifTruth(errors.false_negatives)},
      {"false_positives", ifTruth(errors.false_positives)},
      {"wrong_times", errors.num_times > 0 ? Json(errors.wrong_times) : Json(nullptr)},
      {"uncertain", errors.uncertain},
      {"queries_not_doubles", numQueriesNotDoubles(set)},
      {"ns_per_query", ns_per_query}};
}

std::string table(const QuerySet& set, const QueryErrors& errors, double ns_per_query) {
  const auto ifTruth = [&](std::size_t count) {
    return set.has_truth ? std::to_string(count) : "-";
  };
  const std::string wrong_times =
      errors.num_times > 0 ? std::to_string(errors.wrong_times) : "-";
  char row[256];  // seven fields of at most 20 characters
  std::snprintf(row, sizeof row, "%7zu  %6s  %15s  %15s  %11s  %9zu  %12.1f\n",
                set.queries.size(), ifTruth(errors.num_true).c_str(),
                ifTruth(errors.false_negatives).c_str(),
                ifTruth(errors.false_positives).c_str(), wrong_times.c_str(),
                errors.uncertain, ns_per_query);
  return std::string("queries    true  false negatives  false positives  wrong times  ") +
         "uncertain  ns per query\n" + row;
}

}  // namespace

std::vector<std::string> answerColumns() { return namesOf(kAnswerColumns); }

void queriesCommand(const QueriesOptions& options) {
  const std::vector<QueryFile> files = listQueryFiles(options.files, options.kind);
  std::vector<std::string> inputs;
  inputs.reserve(files.size());
  for (const QueryFile& file : files) inputs.push_back(file.path);
  OutputSet outputs(inputs);
  OutputFile* const json_file = outputs.open(options.json_path);
  const QuerySet set = readQuerySet(files);

  double seconds = 0;
  const std::vector<ElementaryResult> results = runQueries(set, options, seconds);
  const QueryErrors errors = compareWithTruth(set, results);
  const double ns_per_query = 1e9 * seconds / static_cast<double>(results.size());

  print(options.print_answers ? answerLines(set, results, options.columns)
                              : table(set, errors, ns_per_query),
        outputs.hasStandardOutput());
  if (json_file != nullptr)
    json_file->write(toJson(set, errors, ns_per_query).dump(2) + '\n');
  outputs.publish();
}

}  // namespace fcl_ccd

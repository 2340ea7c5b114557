// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "comparison.h"
#include "json.h"
#include "number_text.h"
#include "query_run.h"
#include "run_report.h"
#include "truth_json.h"

namespace fcl_ccd {
namespace {

using fcl::detail::deformable::Answer;
using fcl::detail::deformable::ElementaryResult;

/// The results of all queries, and the shortest time of each, in seconds.
struct TimedResults {
  std::vector<ElementaryResult> results;
  std::vector<double> seconds;

  double meanSeconds() const {
    double sum = 0;
    for (const double x : seconds) sum += x;
    return sum / static_cast<double>(seconds.size());
  }
  double maxSeconds() const { return *std::max_element(seconds.begin(), seconds.end()); }
};

TimedResults runTimed(const QuerySet& set, double toc_err, int repeat) {
  using Clock = std::chrono::steady_clock;
  const std::size_t size = set.queries.size();
  TimedResults timed{std::vector<ElementaryResult>(size),
                     std::vector<double>(size, std::numeric_limits<double>::infinity())};
  for (int i = 0; i < repeat; ++i)
    for (std::size_t k = 0; k < size; ++k) {
      const auto start = Clock::now();
      timed.results[k] = runQuery(set, k, toc_err);
      const std::chrono::duration<double> taken = Clock::now() - start;
      timed.seconds[k] = std::min(timed.seconds[k], taken.count());
    }
  return timed;
}

/// The largest distance of toc_lo from the true time; nothing if no contact that was
/// found has one.
std::optional<double> largestTimeError(const QuerySet& set,
                                       const std::vector<ElementaryResult>& results) {
  std::optional<double> largest;
  for (std::size_t k = 0; k < results.size(); ++k)
    if (results[k].answer == Answer::kYes && set.queries[k].toc)
      largest = std::max(largest.value_or(0),
                         std::abs(results[k].toc_lo - *set.queries[k].toc));
  return largest;
}

class QueryComparison : public Comparison {
 public:
  explicit QueryComparison(const CompareOptions& options)
      : options_(options), files_(listQueryFiles(options.inputs, options.kind)) {
    if (!options.truth.empty() && options.truth.size() != files_.size())
      throw std::runtime_error(
          "--truth names " + std::to_string(options.truth.size()) +
          " files and there are " + std::to_string(files_.size()) +
          " files of queries. Give one file of answers for each, in their order");
    for (std::size_t i = 0; i < files_.size(); ++i)
      files_[i].answers =
          options.truth.empty() ? answersBeside(files_[i].path) : options.truth[i];
  }

  std::vector<std::string> files() const override {
    std::vector<std::string> names;
    for (const QueryFile& file : files_) {
      names.push_back(file.path);
      if (!file.answers.empty()) names.push_back(file.answers);
    }
    return names;
  }

  ComparisonRow run() override {
    const QuerySet set = readQuerySet(files_);
    if (!set.has_truth)
      throw std::runtime_error(files_[0].path +
                               ": does not tell the truth, and there is no file of "
                               "answers. Give --truth FILE, "
                               "or 0 or 1 at the end of each row");
    const TimedResults timed = runTimed(set, options_.toc_err, options_.repeat);
    return report(set, timed);
  }

 private:
  ComparisonRow report(const QuerySet& set, const TimedResults& timed) const {
    const QueryErrors errors = compareWithTruth(set, timed.results);
    assert(errors.false_negatives <= errors.num_true);
    const std::size_t contacts =
        errors.num_true - errors.false_negatives + errors.false_positives;
    const std::optional<double> time_error = largestTimeError(set, timed.results);
    const double mean = 1e6 * timed.meanSeconds(), max = 1e6 * timed.maxSeconds();
    constexpr int kDigits = 4;
    return {{{"queries", std::to_string(set.queries.size())},
             {"true", std::to_string(errors.num_true)},
             {"contacts", std::to_string(contacts)},
             {"FN", std::to_string(errors.false_negatives)},
             {"FP", std::to_string(errors.false_positives)},
             {"uncertain", std::to_string(errors.uncertain)},
             {"wrong times", time_error ? std::to_string(errors.wrong_times) : "-"},
             {"time error", time_error ? numberText(*time_error, kDigits) : "-"},
             {"mean us", numberText(mean, kDigits)},
             {"max us", numberText(max, kDigits)}},
            {{"files", namesInJson(files())},
             {"queries", set.queries.size()},
             {"true", errors.num_true},
             {"contacts", contacts},
             {"false_negatives", errors.false_negatives},
             {"false_positives", errors.false_positives},
             {"uncertain", errors.uncertain},
             {"queries_not_doubles", numQueriesNotDoubles(set)},
             {"wrong_times", time_error ? Json(errors.wrong_times) : Json(nullptr)},
             {"time_error", time_error ? Json(*time_error) : Json(nullptr)},
             {"us_per_query", {{"mean", mean}, {"max", max}}}}};
  }

  const CompareOptions& options_;
  std::vector<QueryFile> files_;
};

}  // namespace

std::unique_ptr<Comparison> queryComparison(const CompareOptions& options) {
  return std::make_unique<QueryComparison>(options);
}

}  // namespace fcl_ccd

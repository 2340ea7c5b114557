// SPDX-License-Identifier: BSD-3-Clause
#include "measurement.h"

#include <algorithm>
#include <chrono>
#include <limits>

namespace fcl {
namespace test {
namespace {

using Clock = std::chrono::steady_clock;

double nanosecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// What goes in here has to be computed.
volatile double sink;

double clockCost() {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 100000; ++i)
    least = std::min(least, nanosecondsSince(Clock::now()));
  return least;
}

/// The value below which the share q of them lies; reorders them.
double quantile(std::vector<double>& values, double q) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(
                                          q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

void Errors::add(const Truth& truth, bool contact, double toc) {
  if (truth.contact) ++contacts;
  if (truth.contact && !contact) ++false_negatives;
  if (!truth.contact && contact) ++false_positives;
  if (truth.contact && contact) {
    max_late = std::max(max_late, toc - truth.toc_hi);
    max_early = std::max(max_early, truth.toc_lo - toc);
  }
}

std::vector<MethodAnswer> answersOf(const Method& method, const QuerySet& set) {
  std::vector<MethodAnswer> answers;
  answers.reserve(set.queries.size());
  for (const MovingPair& query : set.queries)
    answers.push_back(method.answer(query, method.number));
  return answers;
}

Errors errorsOf(const std::vector<MethodAnswer>& answers, const QuerySet& set) {
  Errors errors;
  for (std::size_t i = 0; i < answers.size(); ++i)
    errors.add(set.truth[i], answers[i].contact, answers[i].toc);
  return errors;
}

std::array<double, 4> stageShares(const std::vector<MethodAnswer>& answers) {
  std::array<double, 4> shares{};
  const double one = 1 / static_cast<double>(answers.size());
  for (const MethodAnswer& answer : answers)
    shares[static_cast<std::size_t>(answer.stage)] += one;
  return shares;
}

Times timesOf(const Method& method, const QuerySet& set, int repeats) {
  const double cost = clockCost();
  double least_loop = std::numeric_limits<double>::infinity();
  std::vector<double> least(set.queries.size(), least_loop);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    double sum = 0;
    const auto start = Clock::now();
    for (const MovingPair& query : set.queries) {
      const MethodAnswer answer = method.answer(query, method.number);
      sum += answer.contact ? answer.toc : 1;
    }
    least_loop = std::min(least_loop, nanosecondsSince(start));
    sink = sum;
    for (std::size_t i = 0; i < set.queries.size(); ++i) {
      const auto query_start = Clock::now();
      sink = method.answer(set.queries[i], method.number).toc;
      least[i] = std::min(least[i], nanosecondsSince(query_start));
    }
  }
  for (double& ns : least) ns = std::max(0., ns - cost);
  return {least_loop / static_cast<double>(set.queries.size()), quantile(least, 0.5),
          quantile(least, 0.999)};
}

}  // namespace test
}  // namespace fcl

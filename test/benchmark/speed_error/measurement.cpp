// SPDX-License-Identifier: BSD-3-Clause
#include "measurement.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <numeric>
#include <random>

namespace fcl {
namespace test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Queries between two looks at the clock: few enough to take less than a time slice, so
/// many that the clock does not count.
constexpr std::size_t kChunk = 1000;

/// Loops are not repeated once they have taken this time: they are steady then.
constexpr double kLoopBudget = 20e9;

/// Enough for 50 queries beyond the 99.9th percentile.
constexpr std::size_t kLatencySample = 50000;

double nanosecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// Numbers below n, in order, drawn evenly.
std::vector<std::size_t> latencySample(std::size_t n) {
  std::vector<std::size_t> all(n), sample;
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::sample(all.begin(), all.end(), std::back_inserter(sample), kLatencySample,
              std::mt19937_64(1));
  return sample;
}

/// What goes in here has to be computed.
volatile double sink;

double clockCost() {
  double least = kInfinity;
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

void AnswerErrors::add(const Truth& truth, bool contact, double toc) {
  if (truth.contact) ++contacts;
  if (truth.contact && !contact) ++false_negatives;
  if (!truth.contact && contact) ++false_positives;
  if (truth.contact && contact) {
    if (std::isnan(toc)) max_late = max_early = kInfinity;
    max_late = std::max(max_late, toc - truth.toc_hi);
    max_early = std::max(max_early, truth.toc_lo - toc);
  }
}

AnswerErrors errorsOf(const std::vector<MethodAnswer>& answers, const QuerySet& set) {
  AnswerErrors errors;
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

Run run(const Method& method, const QuerySet& set, int repeats) {
  const std::size_t n = set.queries.size();
  Run out{std::vector<MethodAnswer>(n), {}};
  std::vector<double> least_chunk(n / kChunk + 1, kInfinity);
  double spent = 0;
  for (int repeat = 0; repeat < repeats && spent < kLoopBudget; ++repeat)
    for (std::size_t chunk = 0; chunk * kChunk < n; ++chunk) {
      const auto start = Clock::now();
      for (std::size_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i)
        out.answers[i] = method.answer(set.queries[i], method.number);
      const double ns = nanosecondsSince(start);
      least_chunk[chunk] = std::min(least_chunk[chunk], ns);
      spent += ns;
    }
  double sum = 0;
  for (std::size_t chunk = 0; chunk * kChunk < n; ++chunk) sum += least_chunk[chunk];
  out.times.ns_mean = sum / static_cast<double>(n);

  const std::vector<std::size_t> sample = latencySample(n);
  std::vector<double> least(sample.size(), kInfinity);
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t k = 0; k < sample.size(); ++k) {
      const MovingPair query = set.queries[sample[k]];  // a copy: fetched before
      const auto start = Clock::now();
      sink = method.answer(query, method.number).toc;
      least[k] = std::min(least[k], nanosecondsSince(start));
    }
  const double cost = clockCost();
  for (double& ns : least) ns = std::max(0., ns - cost);
  out.times.ns_median = quantile(least, 0.5);
  out.times.ns_p999 = quantile(least, 0.999);
  return out;
}

}  // namespace test
}  // namespace fcl

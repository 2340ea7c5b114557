// SPDX-License-Identifier: BSD-3-Clause
#include "filter_figures.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "speed_error/measurement.h"
#include "speed_error/methods.h"

namespace fcl {
namespace test {
namespace {

/// Of the methods to compare with, see baselines/baseline.cpp.
constexpr double kResolution = 1e-6;

Method methodNamed(const std::vector<Method>& methods, const std::string& name,
                   double number) {
  for (const Method& method : methods)
    if (method.name == name && method.number == number) return method;
  throw std::logic_error(name + ": no such method");
}

QuerySet leftBy(const Run& filter, const QuerySet& pairs) {
  QuerySet left{pairs.name, {}, {}};
  for (std::size_t i = 0; i < pairs.queries.size(); ++i) {
    if (!filter.answers[i].contact) continue;
    left.queries.push_back(pairs.queries[i]);
    left.truth.push_back(pairs.truth[i]);
  }
  return left;
}

}  // namespace

FilterFigures measureFilter(const QuerySet& pairs, int repeats) {
  FilterFigures figures;
  figures.pairs = pairs.queries.size();
  if (figures.pairs == 0) return figures;
  const Run filter = run(methodNamed(filters(), "plain", 0), pairs, repeats);
  const Method newton = methodNamed(allMethods(), "interval-newton", kResolution);
  const Run solver = run(newton, pairs, repeats);
  figures.filter_ns = filter.times.ns_mean;
  figures.newton_ns = solver.times.ns_mean;
  figures.filter_operations = operationsOfFilter(pairs);
  figures.newton_operations = operationsOfIntervalNewton(pairs, kResolution);
  figures.filter_errors.missed = errorsOf(filter.answers, pairs).false_negatives;
  const auto errors = errorsOf(solver.answers, pairs);
  figures.newton_errors = {errors.false_negatives, errors.false_positives};
  const QuerySet left = leftBy(filter, pairs);
  figures.left = left.queries.size();
  if (figures.left > 0) figures.newton_left_ns = run(newton, left, repeats).times.ns_mean;
  return figures;
}

}  // namespace test
}  // namespace fcl

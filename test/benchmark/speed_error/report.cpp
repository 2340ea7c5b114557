// SPDX-License-Identifier: BSD-3-Clause
#include "report.h"

#include <filesystem>
#include <stdexcept>

#include "machine.h"
#include "measurement.h"
#include "methods.h"
#include "number.h"
#include "operation_count.h"

namespace fcl {
namespace test {
namespace {

std::string tenths(double value) { return number(value, "%.1f"); }

std::string errorFields(const QuerySet& set, const AnswerErrors& errors) {
  return std::to_string(set.queries.size()) + ',' + std::to_string(errors.contacts) +
         ',' + std::to_string(errors.false_negatives) + ',' +
         std::to_string(errors.false_positives) + ',' + number(errors.max_late, "%.3g") +
         ',' + number(errors.max_early, "%.3g") + ',';
}

std::string timeFields(const Times& times) {
  return tenths(times.ns_mean) + ',' + tenths(times.ns_median) + ',' +
         tenths(times.ns_p999) + ',';
}

/// A filter as a stage: how much of what cannot touch it culls, and how many contacts.
struct Culling {
  std::size_t rightly{0};
  std::size_t wrongly{0};
  std::size_t rightly_as_plain{0};
};

Culling cullingOf(const std::vector<MethodAnswer>& answers,
                  const std::vector<MethodAnswer>& plain, const QuerySet& set) {
  Culling culling;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i].contact) continue;
    ++(set.truth[i].contact ? culling.wrongly : culling.rightly);
    culling.rightly_as_plain += !set.truth[i].contact && !plain[i].contact;
  }
  return culling;
}

std::string operationFields(const OperationCount& count) {
  return tenths(count.additions) + ',' + tenths(count.multiplications) + ',' +
         tenths(count.divisions);
}

}  // namespace

Report::Report(const std::string& folder, int repeats)
    : machine_(machineName()), repeats_(repeats) {
  std::filesystem::create_directories(folder);
  methods_.open(folder + "/speed_error.csv");
  filters_.open(folder + "/filter_ratio.csv");
  methods_ << "set,method,setting,queries,contacts,false_negatives,false_positives,"
              "max_late,max_early,ns_mean,ns_median,ns_p999,decided_box,decided_filter,"
              "decided_solver,decided_exact,machine\n";
  filters_
      << "set,stage,setting,queries,culled_rightly,culled_wrongly,share_of_plain,ns_mean,"
         "cost_to_plain,additions,multiplications,divisions,machine\n";
  if (!methods_ || !filters_) throw std::runtime_error(folder + ": cannot be written to");
}

void Report::add(const QuerySet& set, const std::vector<OutsideSolver>& solvers) {
  // The outside solvers first: if one fails, it is soon.
  for (const OutsideSolver& solver : solvers) addSolver(set, solver);
  addMethods(set);
  addFilters(set);
}

void Report::finish() {
  if (!methods_.flush() || !filters_.flush())
    throw std::runtime_error("the tables cannot be written");
}

void Report::addMethods(const QuerySet& set) {
  for (const Method& method : allMethods()) {
    std::fprintf(stderr, "%s: %s %s\n", set.name.c_str(), method.name.c_str(),
                 method.setting.c_str());
    const Run done = run(method, set, repeats_);
    methods_ << set.name << ',' << method.name << ',' << method.setting << ','
             << errorFields(set, errorsOf(done.answers, set)) << timeFields(done.times);
    for (const double share : stageShares(done.answers))
      methods_ << (method.has_stages ? number(share, "%.6f") : "") << ',';
    methods_ << machine_ << std::endl;
  }
}

void Report::addSolver(const QuerySet& set, const OutsideSolver& solver) {
  const OutsideAnswers outside = runOutsideSolver(solver, set);
  methods_ << set.name << ',' << solver.name << ','
           << (outside.own_clock ? "own clock" : "wall clock") << ','
           << errorFields(set, errorsOf(outside.answers, set)) << tenths(outside.ns_mean)
           << ",,,,,,," << machine_ << std::endl;
}

void Report::addFilters(const QuerySet& set) {
  std::vector<MethodAnswer> plain;
  double plain_rightly = 0, plain_ns = 0;
  const auto addRow = [&](const Method& method, const std::string& operations) {
    const Run done = run(method, set, repeats_);
    const double ns = done.times.ns_mean;
    if (plain.empty()) {
      plain = done.answers;
      plain_rightly = static_cast<double>(cullingOf(plain, plain, set).rightly);
      plain_ns = ns;
    }
    const Culling culling = cullingOf(done.answers, plain, set);
    filters_ << set.name << ',' << method.name << ',' << method.setting << ','
             << set.queries.size() << ',' << culling.rightly << ',' << culling.wrongly
             << ','
             << number(static_cast<double>(culling.rightly_as_plain) / plain_rightly,
                       "%.6f")
             << ',' << tenths(ns) << ',' << number(ns / plain_ns, "%.3f") << ','
             << operations << ',' << machine_ << std::endl;
  };
  for (const Method& stage : filters())
    addRow(stage,
           stage.name == "plain" ? operationFields(operationsOfFilter(set)) : ",,");
  // The solvers that a filter saves: what they answer no to counts as culled.
  for (const Method& method : allMethods()) {
    if (method.name == "interval-newton")
      addRow(method, operationFields(operationsOfIntervalNewton(set, method.number)));
    if (method.name == "cubic") addRow(method, ",,");
  }
}

}  // namespace test
}  // namespace fcl

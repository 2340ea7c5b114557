// SPDX-License-Identifier: BSD-3-Clause
#include "step_record.h"

#include <cstring>
#include <utility>

#include "run_command.h"
#include "stop_signal.h"

namespace fcl_ccd {
namespace {

using Json = nlohmann::json;

Json encode(const RunSummary& summary) {
  Json first = nullptr;
  if (summary.first) first = Json::array({summary.first->step, summary.first->toc_lo});
  return Json::array({summary.steps, summary.vf, summary.ee, summary.at_distance,
                      summary.ve, summary.vv, summary.crossing_steps, first,
                      summary.slowest_step, summary.slowest_ms});
}

RunSummary decodeSummary(const Json& fields) {
  RunSummary summary;
  std::size_t i = 0;
  fields.at(i++).get_to(summary.steps);
  fields.at(i++).get_to(summary.vf);
  fields.at(i++).get_to(summary.ee);
  fields.at(i++).get_to(summary.at_distance);
  fields.at(i++).get_to(summary.ve);
  fields.at(i++).get_to(summary.vv);
  fields.at(i++).get_to(summary.crossing_steps);
  const Json& first = fields.at(i++);
  if (!first.is_null()) summary.first = RunSummary::First{first.at(0), first.at(1)};
  fields.at(i++).get_to(summary.slowest_step);
  fields.at(i++).get_to(summary.slowest_ms);
  return summary;
}

/// The texts of a record, in the order in which they are sent.
constexpr std::string StepRecord::*kTexts[] = {
    &StepRecord::row, &StepRecord::contact_lines, &StepRecord::step_line,
    &StepRecord::json, &StepRecord::painted};

}  // namespace

StepOutcome endBySignal() {
  const int signal_number = stopSignal();
  return {std::nullopt, kSignalled + signal_number, strsignal(signal_number)};
}

std::string toBytes(const StepOutcome& outcome) {
  Json fields = Json::array({outcome.end_code, outcome.cause});
  if (outcome.record) {
    fields.push_back(encode(outcome.record->summary));
    for (const auto text : kTexts) fields.push_back(*outcome.record.*text);
  }
  std::string bytes;
  Json::to_cbor(fields, bytes);
  return bytes;
}

StepOutcome outcomeOf(const std::string& bytes) {
  Json fields = Json::from_cbor(bytes);
  StepOutcome outcome;
  fields.at(0).get_to(outcome.end_code);
  fields.at(1).get_to(outcome.cause);
  if (fields.size() == 2) return outcome;
  StepRecord& record = outcome.record.emplace();
  record.summary = decodeSummary(fields.at(2));
  std::size_t i = 3;
  for (const auto text : kTexts)
    record.*text = std::move(fields.at(i++).get_ref<std::string&>());
  return outcome;
}

}  // namespace fcl_ccd

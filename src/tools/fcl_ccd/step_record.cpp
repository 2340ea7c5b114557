// SPDX-License-Identifier: BSD-3-Clause
#include "step_record.h"

#include <cassert>
#include <cstring>

#include "json.h"
#include "run_command.h"
#include "stop_signal.h"

namespace fcl_ccd {
namespace {

Json encode(const RunSummary& summary) {
  Json first = nullptr;
  if (summary.first)
    first = Json::array({summary.first->step, summary.first->files,
                         Json(toJson(summary.first->contact)), summary.first->as_early,
                         summary.first->is_decided});
  return Json::array({summary.steps, summary.vf, summary.ee, summary.at_distance,
                      summary.ve, summary.vv, summary.crossings, summary.crossing_steps,
                      summary.is_any, summary.undecided_steps, first,
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
  fields.at(i++).get_to(summary.crossings);
  fields.at(i++).get_to(summary.crossing_steps);
  fields.at(i++).get_to(summary.is_any);
  fields.at(i++).get_to(summary.undecided_steps);
  const Json& first = fields.at(i++);
  if (!first.is_null())
    summary.first = FirstContact{first.at(0), first.at(1), contactOf(first.at(2)),
                                 first.at(3), first.at(4)};
  fields.at(i++).get_to(summary.slowest_step);
  fields.at(i++).get_to(summary.slowest_ms);
  return summary;
}

/// The texts of a record, in the order in which they are sent.
constexpr std::string StepRecord::*kTexts[] = {
    &StepRecord::row,  &StepRecord::contact_lines, &StepRecord::step_line,
    &StepRecord::json, &StepRecord::painted,       &StepRecord::picture,
    &StepRecord::page, &StepRecord::page_picture};

}  // namespace

StepOutcome endBySignal() {
  const int signal_number = stopSignal();
  return {std::nullopt, kSignalled + signal_number, strsignal(signal_number)};
}

// A message begins with the size of its head. The texts behind the head may be large, and
// are copied as they are.
std::string toBytes(const StepOutcome& outcome) {
  Json head = Json::array({outcome.end_code, outcome.cause});
  std::size_t size = 0;
  if (outcome.record) {
    head.push_back(outcome.record->number);
    head.push_back(encode(outcome.record->summary));
    for (const auto text : kTexts) {
      head.push_back((*outcome.record.*text).size());
      size += (*outcome.record.*text).size();
    }
  }
  std::string packed_head;
  Json::to_cbor(head, packed_head);
  const std::size_t head_size = packed_head.size();
  std::string bytes(sizeof head_size, '\0');
  std::memcpy(bytes.data(), &head_size, sizeof head_size);
  bytes.reserve(sizeof head_size + head_size + size);
  bytes += packed_head;
  if (outcome.record)
    for (const auto text : kTexts) bytes += *outcome.record.*text;
  assert(bytes.size() == sizeof head_size + head_size + size);
  return bytes;
}

StepOutcome outcomeOf(const std::string& bytes) {
  std::size_t head_size = 0;
  std::memcpy(&head_size, bytes.data(), sizeof head_size);
  std::size_t at = sizeof head_size + head_size;
  assert(at <= bytes.size());
  const Json head = Json::from_cbor(bytes.data() + sizeof head_size, bytes.data() + at);
  StepOutcome outcome;
  head.at(0).get_to(outcome.end_code);
  head.at(1).get_to(outcome.cause);
  if (head.size() == 2) return outcome;
  StepRecord& record = outcome.record.emplace();
  head.at(2).get_to(record.number);
  record.summary = decodeSummary(head.at(3));
  std::size_t i = 4;
  for (const auto text : kTexts) {
    const std::size_t size = head.at(i++);
    record.*text = bytes.substr(at, size);
    at += size;
  }
  assert(at == bytes.size());
  return outcome;
}

}  // namespace fcl_ccd

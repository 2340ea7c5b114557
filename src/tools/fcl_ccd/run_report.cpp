// SPDX-License-Identifier: BSD-3-Clause
#include "run_report.h"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <utility>

#include "contact_text.h"
#include "counted.h"
#include "moment.h"
#include "number_text.h"
#include "stage_list.h"

namespace fcl_ccd {
namespace {

using Kind = fcl::ContinuousContactKind;
constexpr Colour kGrey{200, 200, 200};
constexpr Colour kOrange{255, 140, 0};
constexpr Colour kRed{220, 20, 20};
constexpr Colour kViolet{150, 0, 200};

/// In JSON, in place of what a query for any contact did not decide. Unlike null it
/// cannot be taken for "no".
constexpr const char* kUndecided = "undecided";

std::size_t countOf(Kind kind, const StepResult& result) {
  return static_cast<std::size_t>(std::count_if(
      result.contacts.begin(), result.contacts.end(),
      [kind](const SceneContact& contact) { return contact.kind == kind; }));
}

/// VE and VV are kinds of contacts at a distance only.
Json countsOf(const RunSummary& summary) {
  Json counts = {{"vf", summary.vf}, {"ee", summary.ee}};
  if (summary.at_distance) {
    counts["ve"] = summary.ve;
    counts["vv"] = summary.vv;
  }
  counts["crossing"] = summary.crossings;
  return counts;
}

/// The number of other contacts that may be as early as the earliest.
std::size_t asEarlyAs(const SceneContact& earliest, const StepResult& result) {
  const auto overlaps = std::count_if(
      result.contacts.begin(), result.contacts.end(),
      [&](const SceneContact& other) { return other.toc_lo <= earliest.toc_hi; });
  // It is one of them.
  assert(overlaps > 0);
  return static_cast<std::size_t>(overlaps) - 1;
}

double milliseconds(double seconds) { return 1e3 * seconds; }

/// What the query of a step found. "any" is there only if it was for any contact.
Json findings(const StepResult& result) {
  const SceneContact* earliest = result.earliest();
  const std::optional<bool> crossing = result.initiallyCrossing();
  Json found = nullptr;
  if (earliest != nullptr) {
    found = toJson(*earliest);
    if (!result.is_any) found["as_early"] = asEarlyAs(*earliest, result);
  }
  Json findings = {{"initially_crossing", crossing ? Json(*crossing) : Json(kUndecided)},
                   {"first", result.isFirstDecided() ? found : Json(kUndecided)}};
  if (result.is_any) findings["any"] = found;
  return findings;
}

Json toJson(const StepTimes& times) {
  return {{"build", milliseconds(times.build)},
          {"update", milliseconds(times.update)},
          {"traverse", milliseconds(times.traverse)},
          {"test", milliseconds(times.test)},
          {"total", milliseconds(times.total())}};
}

}  // namespace

std::string tableHead(bool at_distance, fcl::ContinuousQuery query) {
  return std::string(at_distance ? "step  triangles      vf      ee      ve      vv "
                                 : "step  triangles        vf        ee ") +
         (query == fcl::ContinuousQuery::kAny ? "    a time" : "first time") +
         "       ms  crossing\n";
}

std::string tableRow(const StepReport& report) {
  constexpr std::size_t kTimeWidth = 10;
  const StepResult& result = report.result;
  const RunSummary counts = summaryOf(report);
  std::string time = "-";
  if (const SceneContact* earliest = result.earliest()) {
    time = numberText(earliest->toc_lo, 8);
    if (time.size() > kTimeWidth) time = numberText(earliest->toc_lo, 5);
  }
  char row[256];  // at most eight fields of at most 20 characters
  if (result.at_distance)
    std::snprintf(row, sizeof row, "%4zu  %9zu  %6zu  %6zu  %6zu  %6zu %10s %8.3f  ",
                  report.number, report.triangles, counts.vf, counts.ee, counts.ve,
                  counts.vv, time.c_str(), counts.slowest_ms);
  else
    std::snprintf(row, sizeof row, "%4zu  %9zu  %8zu  %8zu %10s %8.3f  ", report.number,
                  report.triangles, counts.vf, counts.ee, time.c_str(),
                  counts.slowest_ms);
  const std::optional<bool> crossing = result.initiallyCrossing();
  return std::string(row) + (!crossing ? "not decided" : *crossing ? "yes" : "no") + '\n';
}

namespace {

/// "3 vf and 1 ee contact".
std::string contactsText(const RunSummary& summary) {
  std::string text = std::to_string(summary.vf) + " vf";
  if (!summary.at_distance) return text + " and " + counted(summary.ee, "ee contact");
  return text + ", " + std::to_string(summary.ee) + " ee, " + std::to_string(summary.ve) +
         " ve and " + counted(summary.vv, "vv contact");
}

}  // namespace

std::string summaryLines(const RunSummary& summary, fcl::ContinuousQuery query) {
  const bool is_any = query == fcl::ContinuousQuery::kAny;
  std::string lines = counted(summary.steps, "step") + ", " + contactsText(summary);
  if (query == fcl::ContinuousQuery::kFirst) lines += " that may be the first";
  if (is_any) lines += ", at most one a step";
  const std::string crossing =
      counted(summary.crossing_steps, "step") + " began crossing";
  constexpr std::size_t kWidth = 80;
  lines += (lines.size() + 2 + crossing.size() <= kWidth ? "; " : "\n") + crossing + '\n';
  if (summary.undecided_steps > 0)
    lines += "not decided: whether " + counted(summary.undecided_steps, "other step") +
             " began crossing\n";
  if (summary.first)
    lines += sentenceOf(is_any ? "a contact:" : "first contact:", *summary.first,
                        summary.at_distance);
  else if (summary.steps > 0)
    lines += "no contact in " + counted(summary.steps, "step") + '\n';
  if (summary.first && !summary.first->is_decided)
    lines += "not decided: whether it is the first\n";
  if (summary.slowest_ms >= 0)
    lines += "slowest: step " + std::to_string(summary.slowest_step) + " with " +
             numberText(summary.slowest_ms, 4) + " ms\n";
  return lines;
}

std::string stepLine(const StepReport& report) {
  Json line = {{"step", report.number},
               {"files", namesInJson(report.files)},
               {"contacts", countsOf(summaryOf(report))}};
  line.update(findings(report.result));
  return line.dump() + '\n';
}

Json namesInJson(const std::vector<std::string>& files) {
  constexpr int kOneLine = -1;
  return Json::parse(
      Json(files).dump(kOneLine, ' ', false, Json::error_handler_t::replace));
}

RunSummary summaryOf(const StepReport& report) {
  const StepResult& result = report.result;
  RunSummary summary;
  summary.steps = 1;
  summary.vf = countOf(Kind::kVertexFace, result);
  summary.ee = countOf(Kind::kEdgeEdge, result);
  summary.at_distance = result.at_distance;
  summary.ve = countOf(Kind::kVertexEdge, result);
  summary.vv = countOf(Kind::kVertexVertex, result);
  summary.crossings = countOf(Kind::kCrossing, result);
  const std::optional<bool> crossing = result.initiallyCrossing();
  summary.crossing_steps = crossing.value_or(false) ? 1 : 0;
  summary.is_any = result.is_any;
  summary.undecided_steps = crossing ? 0 : 1;
  if (const SceneContact* earliest = result.earliest())
    summary.first = FirstContact{report.number, report.files, *earliest,
                                 asEarlyAs(*earliest, result), result.isFirstDecided()};
  summary.slowest_step = report.number;
  summary.slowest_ms = milliseconds(result.times.total());
  return summary;
}

RunSummary summaryOf(const Json& step_line) {
  RunSummary summary;
  summary.steps = 1;
  const Json& counts = step_line.at("contacts");
  summary.vf = counts.at("vf");
  summary.ee = counts.at("ee");
  summary.at_distance = counts.contains("ve");
  summary.ve = counts.value("ve", std::size_t{0});
  summary.vv = counts.value("vv", std::size_t{0});
  summary.crossings = counts.at("crossing");
  const Json &crossing = step_line.at("initially_crossing"),
             &first = step_line.at("first");
  summary.undecided_steps = crossing == kUndecided ? 1 : 0;
  summary.crossing_steps = crossing == true ? 1 : 0;
  summary.is_any = step_line.contains("any");
  const bool is_decided = first != kUndecided;
  const Json& found = is_decided ? first : step_line.at("any");
  if (!found.is_null())
    summary.first =
        FirstContact{step_line.at("step"), step_line.at("files"), contactOf(found),
                     found.value("as_early", std::size_t{0}), is_decided};
  return summary;
}

void RunSummary::add(const RunSummary& step) {
  assert(!first || !step.first || first->step < step.first->step);
  steps += step.steps;
  vf += step.vf;
  ee += step.ee;
  at_distance |= step.at_distance;
  ve += step.ve;
  vv += step.vv;
  crossings += step.crossings;
  crossing_steps += step.crossing_steps;
  is_any |= step.is_any;
  undecided_steps += step.undecided_steps;
  if (!first) first = step.first;
  if (step.slowest_ms > slowest_ms) {
    slowest_ms = step.slowest_ms;
    slowest_step = step.slowest_step;
  }
}

Json toJson(const RunSummary& summary) {
  Json found = nullptr;
  if (summary.first) {
    found = {{"step", summary.first->step}, {"files", namesInJson(summary.first->files)}};
    found.update(toJson(summary.first->contact));
    if (!summary.is_any) found["as_early"] = summary.first->as_early;
  }
  const bool is_decided = !summary.first || summary.first->is_decided;
  Json json = {{"steps", summary.steps},
               {"contacts", countsOf(summary)},
               {"initially_crossing", summary.crossing_steps},
               {"first", is_decided ? found : Json(kUndecided)}};
  if (summary.is_any) {
    json["undecided"] = summary.undecided_steps;
    json["any"] = found;
  }
  return json;
}

Json toJson(const StepReport& report) {
  const StepResult& result = report.result;
  Json stages = Json::object();
  for (const StageField& stage : kStages) stages[stage.name] = result.counts.*stage.count;
  Json json = {{"step", report.number},
               {"files", namesInJson(report.files)},
               {"vertices", report.vertices},
               {"triangles", report.triangles},
               {"contacts", countsOf(summaryOf(report))}};
  json.update(findings(result));
  json["ms"] = toJson(result.times);
  json["stages"] = std::move(stages);
  return json;
}

PaintedMesh paint(const SceneTriangles& triangles, const SceneFrame& from,
                  const SceneFrame& to, double time, const StepResult& result) {
  PaintedMesh painted;
  painted.mesh = meshAt(triangles, from, to, time);
  painted.colours.assign(painted.mesh.vertices.size(), kGrey);

  const auto colour = [&](const SceneContact& contact, const Colour& value) {
    if (contact.toc_lo > time) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(contact.num_vertices); ++i)
      painted.colours[idInScene(contact.vertices[i], from)] = value;
  };
  // Rare kinds are painted last, so that they stay visible.
  for (const SceneContact& contact : result.contacts)
    if (contact.kind == Kind::kEdgeEdge) colour(contact, kOrange);
  for (const SceneContact& contact : result.contacts)
    if (contact.kind != Kind::kEdgeEdge) colour(contact, kRed);
  for (const SceneContact& contact : result.contacts)
    if (contact.kind == Kind::kCrossing) colour(contact, kViolet);
  return painted;
}

}  // namespace fcl_ccd

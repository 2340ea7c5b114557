// SPDX-License-Identifier: BSD-3-Clause
#include "run_report.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "number_text.h"
#include "stage_list.h"

namespace fcl_ccd {
namespace {

using Kind = fcl::ContinuousContactKind;
using Json = nlohmann::ordered_json;

constexpr Colour kGrey{200, 200, 200};
constexpr Colour kOrange{255, 140, 0};
constexpr Colour kRed{220, 20, 20};
constexpr Colour kViolet{150, 0, 200};

/// The library decides every contact exactly. The table tells this to its reader.
constexpr int kNumUncertain = 0;

/// The program has no shapes.
const char* nameOf(Kind kind) {
  switch (kind) {
    case Kind::kVertexFace:
      return "vf";
    case Kind::kEdgeEdge:
      return "ee";
    case Kind::kVertexEdge:
      return "ve";
    case Kind::kVertexVertex:
      return "vv";
    default:
      return "crossing";
  }
}

/// What is before the number of a triangle, a free edge or a free point.
const char* nameOf(fcl::PrimitiveKind kind) {
  switch (kind) {
    case fcl::PrimitiveKind::kFreeEdge:
      return "e";
    case fcl::PrimitiveKind::kFreePoint:
      return "p";
    default:
      return "";
  }
}

std::string nameOf(const SceneVertex& vertex) {
  return (vertex.of_b ? "b" : "") + std::to_string(vertex.id);
}

std::size_t countOf(Kind kind, const StepResult& result) {
  return static_cast<std::size_t>(std::count_if(
      result.contacts.begin(), result.contacts.end(),
      [kind](const SceneContact& contact) { return contact.kind == kind; }));
}

/// VE and VV are kinds of contacts at a distance only.
Json countsOf(const StepResult& result) {
  Json counts = {{"vf", countOf(Kind::kVertexFace, result)},
                 {"ee", countOf(Kind::kEdgeEdge, result)}};
  if (result.at_distance) {
    counts["ve"] = countOf(Kind::kVertexEdge, result);
    counts["vv"] = countOf(Kind::kVertexVertex, result);
  }
  return counts;
}

double milliseconds(double seconds) { return 1e3 * seconds; }

Json toJson(const SceneContact& contact) {
  Json vertices = Json::array();
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.num_vertices); ++i) {
    const SceneVertex& vertex = contact.vertices[i];
    if (vertex.of_b)
      vertices.push_back(nameOf(vertex));
    else
      vertices.push_back(vertex.id);
  }
  return {{"kind", nameOf(contact.kind)},
          {"vertices", std::move(vertices)},
          {"toc_lo", contact.toc_lo},
          {"toc_hi", contact.toc_hi}};
}

Json toJson(const StepTimes& times) {
  return {{"build", milliseconds(times.build)},
          {"update", milliseconds(times.update)},
          {"traverse", milliseconds(times.traverse)},
          {"test", milliseconds(times.test)},
          {"total", milliseconds(times.total())}};
}

void append(const Vertices& vertices, const Triangles& triangles,
            const FreeElements* free, Mesh& whole) {
  const int offset = static_cast<int>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), vertices.begin(), vertices.end());
  for (const auto& t : triangles)
    whole.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  if (free == nullptr) return;
  for (const auto& edge : free->edges)
    whole.edges.push_back({edge[0] + offset, edge[1] + offset});
}

}  // namespace

std::string tableHead(bool at_distance) {
  return std::string("step  triangles        vf        ee") +
         (at_distance ? "        ve        vv" : "") +
         "    first time          ms  uncertain  initially crossing\n";
}

std::string tableRow(const StepReport& report) {
  const StepResult& result = report.result;
  const SceneContact* first = result.first();
  const std::string first_time = first == nullptr ? "-" : numberText(first->toc_lo, 9);
  char counts[128], rest[128];  // each of at most four fields of at most 20 characters
  std::snprintf(counts, sizeof counts, "%4zu  %9zu  %8zu  %8zu", report.index,
                report.triangles, countOf(Kind::kVertexFace, result),
                countOf(Kind::kEdgeEdge, result));
  std::string row = counts;
  if (result.at_distance) {
    std::snprintf(counts, sizeof counts, "  %8zu  %8zu",
                  countOf(Kind::kVertexEdge, result),
                  countOf(Kind::kVertexVertex, result));
    row += counts;
  }
  std::snprintf(rest, sizeof rest, "  %12s  %10.3f  %9d  %s\n", first_time.c_str(),
                milliseconds(result.times.total()), kNumUncertain,
                result.initially_crossing ? "yes" : "no");
  return row + rest;
}

std::string summaryLines(const RunSummary& summary) {
  std::string lines =
      std::to_string(summary.steps) + (summary.steps == 1 ? " step, " : " steps, ") +
      std::to_string(summary.vf) + (summary.at_distance ? " vf, " : " vf and ") +
      std::to_string(summary.ee) +
      (summary.at_distance ? " ee, " + std::to_string(summary.ve) + " ve and " +
                                 std::to_string(summary.vv) + " vv contacts; "
                           : " ee contacts; ") +
      std::to_string(summary.crossing_steps) + " steps began crossing\n";
  if (summary.first)
    lines += "first contact: step " + std::to_string(summary.first->step) + " at " +
             numberText(summary.first->toc_lo, 9) + '\n';
  if (summary.slowest_ms >= 0)
    lines += "slowest: step " + std::to_string(summary.slowest_step) + " with " +
             numberText(summary.slowest_ms, 4) + " ms\n";
  return lines;
}

std::string contactsHead(const ContactColumns& columns) {
  std::string head = "step,kind,i0,i1,i2,i3,toc_lo,toc_hi";
  if (columns.triangles) head += ",t0,t1";
  if (columns.position) head += ",x,y,z";
  if (columns.normal) head += ",nx,ny,nz";
  return head + '\n';
}

std::string contactLines(const StepReport& report, const ContactColumns& columns) {
  std::string lines;
  const std::string step = std::to_string(report.index);
  const auto addNumbers = [&](const std::array<double, 3>& numbers) {
    for (const double x : numbers) lines.append(1, ',').append(numberText(x));
  };
  for (const SceneContact& contact : report.result.contacts) {
    lines.append(step).append(1, ',').append(nameOf(contact.kind));
    const auto num_vertices = static_cast<std::size_t>(contact.num_vertices);
    for (std::size_t i = 0; i < 4; ++i)
      lines.append(1, ',').append(i < num_vertices ? nameOf(contact.vertices[i]) : "");
    lines.append(1, ',').append(numberText(contact.toc_lo));
    lines.append(1, ',').append(numberText(contact.toc_hi));
    if (columns.triangles)
      // The first and the last vertex tell the mesh of each feature.
      for (const std::size_t i : {0u, 1u})
        lines.append(contact.vertices[i * (num_vertices - 1)].of_b ? ",b" : ",")
            .append(nameOf(contact.triangle_kinds[i]))
            .append(std::to_string(contact.triangles[i]));
    if (columns.position) addNumbers(contact.position);
    if (columns.normal) addNumbers(contact.normal);
    lines += '\n';
  }
  return lines;
}

std::string stepLine(const StepReport& report) {
  const StepResult& result = report.result;
  Json first = nullptr;
  // The report does not tell which of several crossings was found: this depends on the
  // previous steps.
  if (result.crossing)
    first = {{"kind", "crossing"}, {"toc_lo", 0.0}, {"toc_hi", 0.0}};
  else if (result.first() != nullptr)
    first = toJson(*result.first());
  const Json line = {{"step", report.index},
                     {"files", namesInJson(report.files)},
                     {"contacts", countsOf(result)},
                     {"initially_crossing", result.initially_crossing},
                     {"first", first}};
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
  summary.crossing_steps = result.initially_crossing ? 1 : 0;
  if (const SceneContact* first = result.first())
    summary.first = RunSummary::First{report.index, first->toc_lo};
  summary.slowest_step = report.index;
  summary.slowest_ms = milliseconds(result.times.total());
  return summary;
}

RunSummary summaryOf(const Json& step_line) {
  RunSummary summary;
  summary.steps = 1;
  summary.vf = step_line.at("contacts").at("vf");
  const Json& counts = step_line.at("contacts");
  summary.ee = counts.at("ee");
  summary.at_distance = counts.contains("ve");
  summary.ve = counts.value("ve", std::size_t{0});
  summary.vv = counts.value("vv", std::size_t{0});
  summary.crossing_steps = step_line.at("initially_crossing").get<bool>() ? 1 : 0;
  const Json& first = step_line.at("first");
  if (!first.is_null())
    summary.first = RunSummary::First{step_line.at("step"), first.at("toc_lo")};
  return summary;
}

void RunSummary::add(const RunSummary& step) {
  steps += step.steps;
  vf += step.vf;
  ee += step.ee;
  at_distance |= step.at_distance;
  ve += step.ve;
  vv += step.vv;
  crossing_steps += step.crossing_steps;
  if (!first) first = step.first;
  if (step.slowest_ms > slowest_ms) {
    slowest_ms = step.slowest_ms;
    slowest_step = step.slowest_step;
  }
}

Json toJson(const RunSummary& summary) {
  Json first = nullptr;
  if (summary.first)
    first = {{"step", summary.first->step}, {"toc_lo", summary.first->toc_lo}};
  Json counts = {{"vf", summary.vf}, {"ee", summary.ee}};
  if (summary.at_distance) {
    counts["ve"] = summary.ve;
    counts["vv"] = summary.vv;
  }
  return {{"steps", summary.steps},
          {"contacts", std::move(counts)},
          {"initially_crossing", summary.crossing_steps},
          {"first", first}};
}

Json toJson(const StepReport& report) {
  const StepResult& result = report.result;
  const SceneContact* first = result.first();
  Json stages = Json::object();
  for (const StageField& stage : kStages) stages[stage.name] = result.counts.*stage.count;
  return {{"step", report.index},
          {"files", namesInJson(report.files)},
          {"vertices", report.vertices},
          {"triangles", report.triangles},
          {"contacts", countsOf(result)},
          {"initially_crossing", result.initially_crossing},
          {"first", first == nullptr ? Json(nullptr) : toJson(*first)},
          {"ms", toJson(result.times)},
          {"stages", std::move(stages)}};
}

PaintedMesh paint(const SceneTriangles& triangles, const SceneFrame& frame,
                  const StepResult& result) {
  PaintedMesh painted;
  append(*frame.a, *triangles.a, triangles.free_a, painted.mesh);
  if (frame.b != nullptr) append(*frame.b, *triangles.b, triangles.free_b, painted.mesh);
  painted.colours.assign(painted.mesh.vertices.size(), kGrey);

  const auto colour = [&](const SceneContact& contact, const Colour& value) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(contact.num_vertices); ++i) {
      const SceneVertex& vertex = contact.vertices[i];
      const std::size_t offset = vertex.of_b ? frame.a->size() : 0;
      painted.colours[offset + static_cast<std::size_t>(vertex.id)] = value;
    }
  };
  // Rare kinds are painted last, so that they stay visible.
  for (const SceneContact& contact : result.contacts)
    if (contact.kind == Kind::kEdgeEdge) colour(contact, kOrange);
  for (const SceneContact& contact : result.contacts)
    if (contact.kind != Kind::kEdgeEdge) colour(contact, kRed);
  if (result.crossing) colour(*result.crossing, kViolet);
  return painted;
}

}  // namespace fcl_ccd

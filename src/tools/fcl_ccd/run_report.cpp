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

/// The library decides every contact exactly; a reader of the table is told so.
constexpr int kNumUncertain = 0;

const char* nameOf(Kind kind) {
  switch (kind) {
    case Kind::kVertexFace:
      return "vf";
    case Kind::kEdgeEdge:
      return "ee";
    case Kind::kCrossing:
      break;
  }
  return "crossing";
}

std::string nameOf(const SceneVertex& vertex) {
  return (vertex.of_b ? "b" : "") + std::to_string(vertex.id);
}

std::size_t countOf(Kind kind, const StepResult& result) {
  return static_cast<std::size_t>(std::count_if(
      result.contacts.begin(), result.contacts.end(),
      [kind](const SceneContact& contact) { return contact.kind == kind; }));
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

void append(const Mesh& part, Mesh& whole) {
  const int offset = static_cast<int>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& t : part.triangles)
    whole.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

}  // namespace

std::string tableHead() {
  return "step  triangles        vf        ee    first time          ms  uncertain  "
         "initially crossing\n";
}

std::string tableRow(const StepReport& report) {
  const StepResult& result = report.result;
  const SceneContact* first = result.first();
  const std::string first_time = first == nullptr ? "-" : numberText(first->toc_lo, 9);
  char row[256];  // eight fields of at most 20 characters
  std::snprintf(row, sizeof row, "%4zu  %9zu  %8zu  %8zu  %12s  %10.3f  %9d  %s\n",
                report.index, report.triangles, countOf(Kind::kVertexFace, result),
                countOf(Kind::kEdgeEdge, result), first_time.c_str(),
                milliseconds(result.times.total()), kNumUncertain,
                result.initially_crossing ? "yes" : "no");
  return row;
}

std::string contactsHead() { return "step,kind,i0,i1,i2,i3,toc_lo,toc_hi\n"; }

std::string contactLines(const StepReport& report) {
  std::string lines;
  const std::string step = std::to_string(report.index);
  for (const SceneContact& contact : report.result.contacts) {
    lines.append(step).append(1, ',').append(nameOf(contact.kind));
    for (std::size_t i = 0; i < 4; ++i)
      lines.append(1, ',').append(nameOf(contact.vertices[i]));
    lines.append(1, ',').append(numberText(contact.toc_lo));
    lines.append(1, ',').append(numberText(contact.toc_hi)).append(1, '\n');
  }
  return lines;
}

Json toJson(const StepReport& report) {
  const StepResult& result = report.result;
  const SceneContact* first = result.first();
  Json stages = Json::object();
  for (const StageField& stage : kStages) stages[stage.name] = result.counts.*stage.count;
  return {{"vertices", report.vertices},
          {"triangles", report.triangles},
          {"contacts",
           {{"vf", countOf(Kind::kVertexFace, result)},
            {"ee", countOf(Kind::kEdgeEdge, result)}}},
          {"initially_crossing", result.initially_crossing},
          {"first", first == nullptr ? Json(nullptr) : toJson(*first)},
          {"ms", toJson(result.times)},
          {"stages", std::move(stages)}};
}

PaintedMesh paint(const SceneFrame& frame, const StepResult& result) {
  PaintedMesh painted;
  append(*frame.a, painted.mesh);
  if (frame.b != nullptr) append(*frame.b, painted.mesh);
  painted.colours.assign(painted.mesh.vertices.size(), kGrey);

  const auto colour = [&](const SceneContact& contact, const Colour& value) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(contact.num_vertices); ++i) {
      const SceneVertex& vertex = contact.vertices[i];
      const std::size_t offset = vertex.of_b ? frame.a->vertices.size() : 0;
      painted.colours[offset + static_cast<std::size_t>(vertex.id)] = value;
    }
  };
  // What is rarer comes last and stays visible.
  for (const SceneContact& contact : result.contacts)
    if (contact.kind == Kind::kEdgeEdge) colour(contact, kOrange);
  for (const SceneContact& contact : result.contacts)
    if (contact.kind == Kind::kVertexFace) colour(contact, kRed);
  if (result.crossing) colour(*result.crossing, kViolet);
  return painted;
}

}  // namespace fcl_ccd

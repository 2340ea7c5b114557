// SPDX-License-Identifier: BSD-3-Clause
#include "candidates_command.h"

#include <algorithm>
#include <cstddef>

#include "contact_text.h"
#include "counted.h"
#include "number_text.h"
#include "one_step.h"
#include "output_set.h"

namespace fcl_ccd {
namespace {

template <std::size_t i>
void appendVertex(const SceneCandidate& candidate, std::string& line) {
  line.append(vertexName(candidate, i));
}

template <std::size_t i>
void appendTriangle(const SceneCandidate& candidate, std::string& line) {
  line.append(triangleName(candidate, i));
}

constexpr CsvColumn<SceneCandidate> kCandidateColumns[] = {
    {"kind", [](const SceneCandidate& candidate,
                std::string& line) { line.append(nameOf(candidate.kind)); }},
    {"i0", appendVertex<0>},
    {"i1", appendVertex<1>},
    {"i2", appendVertex<2>},
    {"i3", appendVertex<3>},
    {"t_lo", [](const SceneCandidate& candidate,
                std::string& line) { line.append(numberText(candidate.window_lo)); }},
    {"t_hi", [](const SceneCandidate& candidate,
                std::string& line) { line.append(numberText(candidate.window_hi)); }},
    {"t0", appendTriangle<0>},
    {"t1", appendTriangle<1>}};

/// "12 vf and 1 ee candidate".
std::string summaryOf(const std::vector<SceneCandidate>& candidates, bool at_distance) {
  using Kind = fcl::ContinuousContactKind;
  const auto count = [&](Kind kind) {
    return static_cast<std::size_t>(std::count_if(
        candidates.begin(), candidates.end(),
        [kind](const SceneCandidate& candidate) { return candidate.kind == kind; }));
  };
  const std::string vf = std::to_string(count(Kind::kVertexFace)) + " vf";
  if (!at_distance) return vf + " and " + counted(count(Kind::kEdgeEdge), "ee candidate");
  return vf + ", " + std::to_string(count(Kind::kEdgeEdge)) + " ee, " +
         std::to_string(count(Kind::kVertexEdge)) + " ve and " +
         counted(count(Kind::kVertexVertex), "vv candidate");
}

}  // namespace

std::vector<std::string> candidateColumns() { return namesOf(kCandidateColumns); }

void candidatesCommand(const CandidatesOptions& options) {
  OneStep step(options.step);
  OutputSet outputs(step.files());
  OutputFile* const file = outputs.open(options.output_path);
  step.read();
  const std::vector<SceneCandidate> candidates = step.candidates();

  const ColumnNumbers columns =
      options.columns.value_or(ColumnNumbers{0, 1, 2, 3, 4, 5, 6});
  file->write(csvHead(kCandidateColumns, columns));
  constexpr std::size_t kBlock = 1 << 20;
  std::string lines;
  for (const SceneCandidate& candidate : candidates) {
    appendCsvLine(kCandidateColumns, columns, candidate, lines);
    if (lines.size() < kBlock) continue;
    file->write(lines);
    lines.clear();
  }
  file->write(lines);
  outputs.publish();
  print(summaryOf(candidates, options.step.settings.min_distance > 0) + '\n',
        outputs.hasStandardOutput());
}

}  // namespace fcl_ccd

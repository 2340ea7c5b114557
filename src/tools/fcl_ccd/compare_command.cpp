// SPDX-License-Identifier: BSD-3-Clause
#include "compare_command.h"

#include <algorithm>
#include <cstddef>

#include "comparison.h"
#include "mesh_io.h"
#include "output_set.h"

namespace fcl_ccd {
namespace {

/// The names above the figures.
std::string table(const ComparisonRow& row) {
  std::string names, figures;
  for (const auto& [name, figure] : row.columns) {
    const std::size_t width = std::max(name.size(), figure.size());
    const std::string gap = names.empty() ? "" : "  ";
    names.append(gap).append(width - name.size(), ' ').append(name);
    figures.append(gap).append(width - figure.size(), ' ').append(figure);
  }
  return names + '\n' + figures + '\n';
}

bool areFrames(const std::vector<std::string>& inputs) {
  return std::all_of(inputs.begin(), inputs.end(), [](const std::string& input) {
    return isMeshFormat(extensionOf(input));
  });
}

}  // namespace

void compareCommand(const CompareOptions& options) {
  const std::unique_ptr<Comparison> comparison =
      areFrames(options.inputs) ? frameComparison(options) : queryComparison(options);
  OutputSet outputs(comparison->files());
  OutputFile* const json_file = outputs.open(options.json_path);
  const ComparisonRow row = comparison->run();
  print(table(row), outputs.hasStandardOutput());
  if (json_file != nullptr) json_file->write(row.json.dump(2) + '\n');
  outputs.publish();
}

}  // namespace fcl_ccd

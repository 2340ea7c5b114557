// SPDX-License-Identifier: BSD-3-Clause
#include "csv_columns.h"

#include <algorithm>
#include <stdexcept>

#include "suggestion.h"

namespace fcl_ccd {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& column : known)
    list.append(list.empty() ? "" : ", ").append(column);
  const std::string nearest = nearestName(name, known);
  throw std::runtime_error("'" + name + "' is not a column. " +
                           (nearest.empty() ? "" : "Did you mean '" + nearest + "'? ") +
                           "The columns are: " + list);
}

}  // namespace

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field.append(c == '"' ? 2 : 1, c);
  return field + '"';
}

ColumnNumbers parseColumns(const std::string& list,
                           const std::vector<std::string>& known) {
  ColumnNumbers columns;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = list.substr(begin, end - begin);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) refuse(name, known);
    columns.push_back(static_cast<std::size_t>(found - known.begin()));
    begin = end + 1;
  }
  requireNoneTwice(columns, known);
  return columns;
}

void requireNoneTwice(const ColumnNumbers& columns,
                      const std::vector<std::string>& known) {
  for (auto column = columns.begin(); column != columns.end(); ++column)
    if (std::find(columns.begin(), column, *column) != column)
      throw std::runtime_error("'" + known[*column] + "' is there twice");
}

}  // namespace fcl_ccd

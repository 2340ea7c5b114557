// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CSV_COLUMNS_H
#define FCL_CCD_CSV_COLUMNS_H

#include <cassert>
#include <cstddef>
#include <string>
#include <vector>

namespace fcl_ccd {

/// @brief A column of a CSV output.
template <typename Row>
struct CsvColumn {
  const char* name;
  void (*append)(const Row& row, std::string& line);  ///< appends the value
};

/// @brief Columns that an output has, by their numbers among those that it can have.
using ColumnNumbers = std::vector<std::size_t>;

/// @brief Reads a list of names that are separated by commas.
/// @throws std::runtime_error that lists the known names, if a name is unknown or is
/// there twice.
ColumnNumbers parseColumns(const std::string& list,
                           const std::vector<std::string>& known);

/// @throws std::runtime_error that names the first column that is there twice.
void requireNoneTwice(const ColumnNumbers& columns,
                      const std::vector<std::string>& known);

/// @brief A text as a value: in quotes if it needs them.
std::string csvField(const std::string& text);

template <typename Row, std::size_t n>
std::vector<std::string> namesOf(const CsvColumn<Row> (&columns)[n]) {
  std::vector<std::string> names;
  for (const CsvColumn<Row>& column : columns) names.emplace_back(column.name);
  return names;
}

/// @brief The first line: the names.
template <typename Row, std::size_t n>
std::string csvHead(const CsvColumn<Row> (&columns)[n], const ColumnNumbers& chosen) {
  std::string line;
  for (const std::size_t i : chosen)
    line.append(line.empty() ? "" : ",").append(columns[i].name);
  return line + '\n';
}

/// @brief Appends the line of a row.
template <typename Row, std::size_t n>
void appendCsvLine(const CsvColumn<Row> (&columns)[n], const ColumnNumbers& chosen,
                   const Row& row, std::string& lines) {
  assert(!chosen.empty());
  for (const std::size_t i : chosen) {
    assert(i < n);
    columns[i].append(row, lines);
    lines += ',';
  }
  lines.back() = '\n';
}

}  // namespace fcl_ccd

#endif

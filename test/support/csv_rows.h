// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_CSV_ROWS_H
#define FCL_TEST_SUPPORT_CSV_ROWS_H

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace fcl {
namespace test {

/// @brief A row of a table, with values by the names of columns.
using CsvRow = std::map<std::string, std::string>;

inline std::vector<std::string> csvFields(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

/// @brief The rows of a file, whose first line must be `columns`.
inline std::vector<CsvRow> readCsv(const std::string& path, const std::string& columns) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, columns);
  const std::vector<std::string> names = csvFields(line);
  std::vector<CsvRow> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = csvFields(line);
    EXPECT_EQ(fields.size(), names.size()) << line;
    CsvRow row;
    for (std::size_t i = 0; i < names.size() && i < fields.size(); ++i)
      row[names[i]] = fields[i];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace test
}  // namespace fcl

#endif

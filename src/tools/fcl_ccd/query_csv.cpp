// SPDX-License-Identifier: BSD-3-Clause
#include "query_csv.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "counted.h"
#include "file_bytes.h"
#include "rational_text.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

constexpr std::size_t kRowsAQuery = 8;

struct Row {
  double position[3];
  bool has_truth{false};
  bool truth{false};
};

std::string_view trimmed(std::string_view field) {
  std::string_view token;
  takeToken(field, token);
  std::string_view rest;
  if (takeToken(field, rest))
    throw std::runtime_error("a field has two words; fields are separated by commas");
  return token;
}

void splitFields(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
}

Row parseRow(const std::vector<std::string_view>& fields, std::size_t& num_rounded) {
  if (fields.size() != 6 && fields.size() != 7)
    throw std::runtime_error("expected 6 or 7 fields, found " +
                             std::to_string(fields.size()));
  Row row;
  for (std::size_t k = 0; k < 3; ++k) {
    const NearestDouble nearest = nearestDouble(fields[2 * k], fields[2 * k + 1]);
    row.position[k] = nearest.value;
    if (!nearest.exact) ++num_rounded;
  }
  row.has_truth = fields.size() == 7;
  if (row.has_truth && fields[6] != "0" && fields[6] != "1")
    throw std::runtime_error("the seventh field is " + quoted(fields[6]) +
                             ", expected 0 or 1");
  row.truth = row.has_truth && fields[6] == "1";
  return row;
}

/// @brief Makes queries from the rows of one file.
class QueryBuilder {
 public:
  explicit QueryBuilder(QueryList& list) : list_(list) {}

  void add(const Row& row) {
    const std::size_t point = num_rows_ % kRowsAQuery;
    if (point == 0) {
      query_ = ElementaryQuery{};
      query_.truth = row.truth;
    }
    if (list_.queries.empty() && point == 0) list_.has_truth = row.has_truth;
    if (row.has_truth != list_.has_truth)
      throw std::runtime_error(
          "some rows have a seventh field and some do not; give it in all rows or in "
          "none");
    if (row.truth != query_.truth)
      throw std::runtime_error("the rows of one query differ in the seventh field");
    auto& path = query_.x[point % 4];
    auto& target = point < 4 ? path.t0 : path.t1;
    for (std::size_t k = 0; k < 3; ++k) target[k] = row.position[k];
    ++num_rows_;
    if (point + 1 == kRowsAQuery) list_.queries.push_back(query_);
  }

  void finish() const {
    if (num_rows_ == 0) throw std::runtime_error("the file has no queries");
    if (num_rows_ % kRowsAQuery != 0)
      throw std::runtime_error("the file has " + counted(num_rows_, "row") +
                               ", which is not a multiple of 8: it is cut short");
  }

 private:
  QueryList& list_;
  ElementaryQuery query_;
  std::size_t num_rows_{0};
};

void readFile(const std::string& path, QueryList& list) {
  const std::string bytes = readBytes(path);
  std::string_view text = bytes, line;
  std::vector<std::string_view> fields;
  QueryBuilder builder(list);
  for (std::size_t line_no = 1; takeLine(text, line); ++line_no) {
    const auto place = [&] { return "line " + std::to_string(line_no); };
    namingPlace(place, [&] {
      splitFields(line, fields);
      if (fields.size() == 1 && fields[0].empty()) return;
      builder.add(parseRow(fields, list.num_rounded));
    });
  }
  builder.finish();
}

}  // namespace

QueryList readQueries(const std::vector<std::string>& paths) {
  QueryList list;
  for (const std::string& path : paths)
    namingPlace([&] { return path; }, [&] { readFile(path, list); });
  return list;
}

}  // namespace fcl_ccd

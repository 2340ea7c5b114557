// SPDX-License-Identifier: BSD-3-Clause
#include "query_csv.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <stdexcept>
#include <string_view>

#include "counted.h"
#include "file_bytes.h"
#include "rational_points.h"
#include "rational_text.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

constexpr std::size_t kRowsAQuery = 8;

using Fields = std::vector<std::string_view>;

/// The names of the fields of a row of decimals, and of one of fractions.
using Names = std::vector<std::string_view>;
const Names kDecimals{"x", "y", "z", "truth", "toc"};
const Names kFractions{"x_num", "x_den", "y_num", "y_den",
                       "z_num", "z_den", "truth", "toc"};

/// @brief What the fields of a row are, which their number tells.
struct RowForm {
  std::size_t num_fields{0};

  bool isDecimal() const { return num_fields <= kDecimals.size(); }
  const Names& names() const { return isDecimal() ? kDecimals : kFractions; }
  std::size_t numCoordinates() const { return isDecimal() ? 3 : 6; }
  bool hasTruth() const { return num_fields > numCoordinates(); }
  bool hasToc() const { return num_fields > numCoordinates() + 1; }
};

RowForm formOf(const Fields& fields) {
  constexpr std::size_t kFewest = 3;
  if (fields.size() < kFewest || fields.size() > kFractions.size())
    throw std::runtime_error(
        "has " + counted(fields.size(), "field") +
        ". A row has 3 decimal numbers or 6 integers (three numerators and denominators),"
        " then perhaps the truth, 0 or 1, and the true time");
  return {fields.size()};
}

struct Row {
  double position[3];
  Rational exact[3];
  std::size_t num_not_doubles{0};
  bool truth{false};
  std::optional<double> toc;
};

/// @param number  of the field, from 1
std::string_view trimmed(std::string_view field, std::size_t number) {
  std::string_view token;
  takeToken(field, token);
  std::string_view rest;
  if (takeToken(field, rest))
    throw std::runtime_error("field " + std::to_string(number) +
                             " has two words; fields are separated by commas");
  return token;
}

void splitFields(std::string_view line, Fields& fields) {
  fields.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin), fields.size() + 1));
    begin = end + 1;
  }
}

/// @brief Whether a line has the names of columns: no field is a number, nan or inf.
bool isHeader(const Fields& fields) {
  return std::all_of(fields.begin(), fields.end(), [](std::string_view field) {
    return !field.empty() &&
           (std::isalpha(static_cast<unsigned char>(field[0])) != 0 || field[0] == '_') &&
           classifyNumber(field) == NumberToken::kNotANumber;
  });
}

/// @brief Whether two names are the same but for the case of their letters.
bool isSameName(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char c, char d) { return lower(c) == lower(d); });
}

/// @brief Refuses a header that has one of our names at another place: the columns have
/// another order.
void requireOrder(const Fields& header) {
  const Names& names = formOf(header).names();
  for (std::size_t i = 0; i < header.size(); ++i) {
    const auto found =
        std::find_if(names.begin(), names.end(),
                     [&](std::string_view name) { return isSameName(name, header[i]); });
    if (found == names.end() || found == names.begin() + static_cast<std::ptrdiff_t>(i))
      continue;
    throw std::runtime_error("column " + std::to_string(i + 1) + " is named " +
                             quoted(header[i]) + ", which is the name of column " +
                             std::to_string(found - names.begin() + 1) +
                             ". Bring the columns into the order of the format");
  }
}

/// @brief The true first time of contact; nothing if the field is empty.
std::optional<double> parseToc(std::string_view field, bool truth) {
  if (field.empty()) return std::nullopt;
  const double toc =
      namingPlace([] { return std::string("toc"); },
                  [&] { return nearestDouble(parseDecimal(field)).value; });
  if (!truth)
    throw std::runtime_error("there is a time, " + quoted(field) +
                             ", but the truth is 0: no contact");
  if (!(toc >= 0 && toc <= 1))
    throw std::runtime_error("the time is " + quoted(field) +
                             ", expected a fraction of the step, from 0 to 1");
  return toc;
}

/// @brief Reads the k-th coordinate of a row.
void parseCoordinate(const RowForm& form, const Fields& fields, std::size_t k, Row& row) {
  namingPlace([&] { return std::string(kDecimals[k]); },
              [&] {
                row.exact[k] = form.isDecimal()
                                   ? parseDecimal(fields[k])
                                   : parseFraction(fields[2 * k], fields[2 * k + 1]);
                const NearestDouble nearest = nearestDouble(row.exact[k]);
                row.position[k] = nearest.value;
                if (!nearest.exact) ++row.num_not_doubles;
              });
}

Row parseRow(const RowForm& form, const Fields& fields) {
  assert(fields.size() == form.num_fields);
  Row row;
  for (std::size_t k = 0; k < 3; ++k) parseCoordinate(form, fields, k, row);
  if (!form.hasTruth()) return row;
  const std::string_view truth = fields[form.numCoordinates()];
  if (truth != "0" && truth != "1")
    throw std::runtime_error("the truth is " + quoted(truth) + ", expected 0 or 1");
  row.truth = truth == "1";
  if (form.hasToc()) row.toc = parseToc(fields.back(), row.truth);
  return row;
}

/// @brief Makes queries from the rows of a file.
class QueryBuilder {
 public:
  explicit QueryBuilder(QueryList& list) : list_(list) {}

  /// @brief Takes the names of the columns.
  void addHeader(const Fields& fields) {
    requireOrder(fields);
    form_ = formOf(fields);
  }

  void add(const Fields& fields) {
    if (form_.num_fields == 0) form_ = formOf(fields);
    if (fields.size() != form_.num_fields)
      throw std::runtime_error("has " + counted(fields.size(), "field") +
                               "; the lines before have " +
                               std::to_string(form_.num_fields));
    list_.has_truth = form_.hasTruth();
    add(parseRow(form_, fields));
  }

  void finish() const {
    if (num_rows_ == 0) throw std::runtime_error("the file has no queries");
    if (num_rows_ % kRowsAQuery != 0)
      throw std::runtime_error("the file has " + counted(num_rows_, "row") +
                               ", which is not a multiple of 8: it is cut short");
  }

 private:
  void add(const Row& row) {
    const std::size_t point = num_rows_ % kRowsAQuery;
    if (point == 0) {
      query_ = ElementaryQuery{};
      query_.truth = row.truth;
      query_.toc = row.toc;
    }
    const bool same_truth = row.truth == query_.truth;
    if (!same_truth || row.toc != query_.toc)
      throw std::runtime_error(std::string("differs from the row before in the ") +
                               (same_truth ? "time" : "truth") +
                               ". The eight rows of a query have the same");
    auto& path = query_.x[point % 4];
    auto& target = point < 4 ? path.t0 : path.t1;
    for (std::size_t k = 0; k < 3; ++k) {
      target[k] = row.position[k];
      exact_.set(point % 4, point / 4, k, row.exact[k]);
    }
    query_.num_not_doubles += row.num_not_doubles;
    ++num_rows_;
    if (point + 1 < kRowsAQuery) return;
    if (query_.num_not_doubles > 0)
      query_.exact = std::make_shared<const RationalPoints>(exact_);
    list_.queries.push_back(query_);
  }

  QueryList& list_;
  RowForm form_;
  ElementaryQuery query_;
  RationalPoints exact_;
  std::size_t num_rows_{0};
};

void readFile(const std::string& path, QueryList& list) {
  const std::string bytes = readBytes(path);
  std::string_view text = bytes, line;
  Fields fields;
  QueryBuilder builder(list);
  bool is_first = true;
  for (std::size_t line_no = 1; takeLine(text, line); ++line_no) {
    const auto place = [&] { return "line " + std::to_string(line_no); };
    namingPlace(place, [&] {
      splitFields(line, fields);
      if (fields.size() == 1 && fields[0].empty()) return;
      if (is_first && isHeader(fields))
        builder.addHeader(fields);
      else
        builder.add(fields);
      is_first = false;
    });
  }
  builder.finish();
}

}  // namespace

QueryList readQueries(const std::string& path) {
  QueryList list;
  namingPlace([&] { return path; }, [&] { readFile(path, list); });
  return list;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "contact_list.h"

#include <algorithm>

#include "contact_text.h"
#include "number_text.h"

namespace fcl_ccd {
namespace {

/// A row of the contact list.
struct ContactRow {
  const std::string& step;
  const SceneContact& contact;
};

template <std::size_t i>
void appendVertex(const ContactRow& row, std::string& line) {
  line.append(vertexName(row.contact, i));
}

template <std::size_t i>
void appendTriangle(const ContactRow& row, std::string& line) {
  line.append(triangleName(row.contact, i));
}

template <std::size_t k>
void appendPosition(const ContactRow& row, std::string& line) {
  line.append(numberText(row.contact.position[k]));
}

template <std::size_t k>
void appendNormal(const ContactRow& row, std::string& line) {
  line.append(numberText(row.contact.normal[k]));
}

constexpr CsvColumn<ContactRow> kContactColumns[] = {
    {"step", [](const ContactRow& row, std::string& line) { line.append(row.step); }},
    {"kind", [](const ContactRow& row,
                std::string& line) { line.append(nameOf(row.contact.kind)); }},
    {"i0", appendVertex<0>},
    {"i1", appendVertex<1>},
    {"i2", appendVertex<2>},
    {"i3", appendVertex<3>},
    {"toc_lo", [](const ContactRow& row,
                  std::string& line) { line.append(numberText(row.contact.toc_lo)); }},
    {"toc_hi", [](const ContactRow& row,
                  std::string& line) { line.append(numberText(row.contact.toc_hi)); }},
    {"t0", appendTriangle<0>},
    {"t1", appendTriangle<1>},
    {"x", appendPosition<0>},
    {"y", appendPosition<1>},
    {"z", appendPosition<2>},
    {"nx", appendNormal<0>},
    {"ny", appendNormal<1>},
    {"nz", appendNormal<2>},
    // The last one, so that the others are where they were before there was a fifth id.
    {"i4", appendVertex<4>}};
constexpr std::size_t kNumAlways = 8;
constexpr std::size_t kFirstOfPoints = 10, kLastOfPoints = 15;
constexpr std::size_t kNumColumns = sizeof kContactColumns / sizeof *kContactColumns;

/// Columns that have a name together, and those that they are.
struct ColumnGroup {
  const char* name;
  ColumnNumbers columns;
};
const ColumnGroup kGroups[] = {
    {"triangles", {8, 9}}, {"position", {10, 11, 12}}, {"normal", {13, 14, 15}}};

/// kContactColumns and kGroups.
std::vector<std::string> knownNames() {
  std::vector<std::string> names = namesOf(kContactColumns);
  for (const ColumnGroup& group : kGroups) names.emplace_back(group.name);
  return names;
}

}  // namespace

ContactColumns::ContactColumns() {
  for (std::size_t i = 0; i < kNumAlways; ++i) numbers_.push_back(i);
  numbers_.push_back(kNumColumns - 1);
}

ContactColumns::ContactColumns(const std::string& list) {
  ColumnNumbers words = parseColumns(list, knownNames());
  const bool adds = std::all_of(words.begin(), words.end(),
                                [](std::size_t word) { return word >= kNumColumns; });
  if (adds) {
    std::sort(words.begin(), words.end());
    numbers_ = ContactColumns().numbers_;
    numbers_.pop_back();
  }
  for (const std::size_t word : words)
    if (word < kNumColumns)
      numbers_.push_back(word);
    else
      for (const std::size_t column : kGroups[word - kNumColumns].columns)
        numbers_.push_back(column);
  if (adds) numbers_.push_back(kNumColumns - 1);
  requireNoneTwice(numbers_, knownNames());
}

std::optional<std::size_t> ContactColumns::placeOfStep() const {
  const auto found = std::find(numbers_.begin(), numbers_.end(), 0u);
  if (found == numbers_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - numbers_.begin());
}

bool ContactColumns::needPoints() const {
  return std::any_of(numbers_.begin(), numbers_.end(), [](std::size_t column) {
    return column >= kFirstOfPoints && column <= kLastOfPoints;
  });
}

std::string contactsHead(const ContactColumns& columns) {
  return csvHead(kContactColumns, columns.numbers());
}

std::string contactLines(const StepReport& report, const ContactColumns& columns) {
  std::string lines;
  const std::string step = std::to_string(report.number);
  for (const SceneContact& contact : report.result.contacts)
    appendCsvLine(kContactColumns, columns.numbers(), ContactRow{step, contact}, lines);
  return lines;
}

}  // namespace fcl_ccd

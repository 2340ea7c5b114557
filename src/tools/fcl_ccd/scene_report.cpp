// SPDX-License-Identifier: BSD-3-Clause
#include "scene_report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <utility>

#include "contact_text.h"
#include "counted.h"
#include "csv_columns.h"
#include "number_text.h"
#include "sentence.h"

namespace fcl_ccd {
namespace {

using fcl::ContinuousContactd;
using Kind = fcl::ContinuousContactKind;

std::array<double, 3> toArray(const fcl::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// A row of the contact list.
struct ObjectsContactRow {
  const ObjectsStep& step;
  const ObjectsInContact& pair;
  const ContinuousContactd& contact;
  const SceneObjects& objects;
};
using Row = ObjectsContactRow;

template <int k>
void appendPlace(const Row& row, std::string& line) {
  line.append(numberText(row.contact.pos[k]));
}
template <int k>
void appendDirection(const Row& row, std::string& line) {
  line.append(numberText(row.contact.normal[k]));
}

constexpr CsvColumn<Row> kObjectsColumns[] = {
    {"step", [](const Row& row,
                std::string& line) { line.append(std::to_string(row.step.number)); }},
    {"o1",
     [](const Row& row, std::string& line) {
       line.append(csvField(row.objects.nameOf(row.pair.o1)));
     }},
    {"o2",
     [](const Row& row, std::string& line) {
       line.append(csvField(row.objects.nameOf(row.pair.o2)));
     }},
    {"kind",
     [](const Row& row, std::string& line) { line.append(nameOf(row.contact.kind)); }},
    {"b1",
     [](const Row& row, std::string& line) {
       line.append(row.objects.partName(row.pair.o1, row.contact.b1));
     }},
    {"b2",
     [](const Row& row, std::string& line) {
       line.append(row.objects.partName(row.pair.o2, row.contact.b2));
     }},
    {"toc_lo", [](const Row& row,
                  std::string& line) { line.append(numberText(row.contact.toc_lo)); }},
    {"toc_hi", [](const Row& row,
                  std::string& line) { line.append(numberText(row.contact.toc_hi)); }},
    {"x", appendPlace<0>},
    {"y", appendPlace<1>},
    {"z", appendPlace<2>},
    {"nx", appendDirection<0>},
    {"ny", appendDirection<1>},
    {"nz", appendDirection<2>}};

const ColumnNumbers& allColumns() {
  static const ColumnNumbers numbers = [] {
    ColumnNumbers all(std::size(kObjectsColumns));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }();
  return numbers;
}

/// The number of other contacts of the step whose brackets overlap that of the first.
std::size_t asEarlyAs(const ContinuousContactd& first, const ObjectsStep& step) {
  std::size_t num = 0;
  for (const ObjectsInContact& pair : step.pairs)
    num += static_cast<std::size_t>(std::count_if(
        pair.contacts.begin(), pair.contacts.end(),
        [&](const ContinuousContactd& other) { return other.toc_lo <= first.toc_hi; }));
  return num - 1;
}

/// "vertex 3 of triangle 1 of arm", "sphere ball", "cell 9 of map".
std::string featureText(const ObjectsInContact& pair, const ContinuousContactd& contact,
                        bool first_feature, const SceneObjects& objects) {
  // Of two edges and of two shapes the first is that of o1.
  const bool is_in_order = contact.first_on_o1 || contact.kind == Kind::kEdgeEdge ||
                           contact.kind == Kind::kShapes,
             of_o1 = first_feature == is_in_order;
  const std::size_t object = of_o1 ? pair.o1 : pair.o2;
  const std::size_t num_first = firstFeatureSize(contact.kind),
                    begin = first_feature ? 0 : num_first,
                    end = first_feature ? num_first
                                        : static_cast<std::size_t>(contact.numVertices());
  std::string text = featureName(end - begin);
  for (std::size_t i = begin; i < end; ++i)
    text += ' ' + std::to_string(contact.vertices[i]);
  const std::string part = objects.partWords(object, of_o1 ? contact.b1 : contact.b2),
                    name = unbroken(objects.nameOf(object));
  if (!part.empty()) text += (text.empty() ? "" : " of ") + part;
  if (text.empty()) return objects.kindOf(object) + ' ' + name;
  return pair.o1 == pair.o2 ? text : text + " of " + name;
}

std::string sentenceOf(const ObjectsStep& step, const SceneObjects& objects,
                       fcl::ContinuousQuery query) {
  const ObjectsInContact& pair = step.pairs.front();
  const ContinuousContactd& contact = pair.contacts.front();
  const std::string name = unbroken(objects.nameOf(pair.o1));
  const bool is_any = query == fcl::ContinuousQuery::kAny,
             is_crossing = contact.kind == Kind::kCrossing;
  std::string text =
      (is_any ? "a contact: step " : "first contact: step ") +
      std::to_string(step.number) + " at " + numberText(pair.time, 9) + ", " +
      (pair.o1 == pair.o2
           ? "of " + name + " with itself"
           : "between " + name + " and " + unbroken(objects.nameOf(pair.o2))) +
      ": " + wordsOf(contact.kind) + ", " + featureText(pair, contact, true, objects) +
      (is_crossing                                ? " passes through "
       : objects.distanceOf(pair.o1, pair.o2) > 0 ? " comes near "
                                                  : " meets ") +
      featureText(pair, contact, false, objects) + " at " +
      pointText(toArray(contact.pos)) + ", " + normalText(toArray(contact.normal));
  const std::size_t as_early = asEarlyAs(contact, step);
  if (as_early > 0) text += "; " + counted(as_early, "other") + " may be as early";
  return wrapped(text);
}

Json partInJson(const std::string& part) {
  return part.empty() ? Json(nullptr) : numberOrName(part);
}

Json contactInJson(const ObjectsStep& step, const SceneObjects& objects) {
  const ObjectsInContact& pair = step.pairs.front();
  const ContinuousContactd& contact = pair.contacts.front();
  const std::vector<int> vertices(contact.vertices.begin(),
                                  contact.vertices.begin() + contact.numVertices());
  return {{"step", step.number},
          {"o1", objects.nameOf(pair.o1)},
          {"o2", objects.nameOf(pair.o2)},
          {"time", pair.time},
          {"kind", nameOf(contact.kind)},
          {"vertices", vertices},
          {"first_on_o1", contact.first_on_o1},
          {"b1", partInJson(objects.partName(pair.o1, contact.b1))},
          {"b2", partInJson(objects.partName(pair.o2, contact.b2))},
          {"toc_lo", contact.toc_lo},
          {"toc_hi", contact.toc_hi},
          {"position", toArray(contact.pos)},
          {"normal", toArray(contact.normal)},
          {"as_early", asEarlyAs(contact, step)}};
}

}  // namespace

std::size_t ObjectsStep::numContacts() const {
  std::size_t num = 0;
  for (const ObjectsInContact& pair : pairs) num += pair.contacts.size();
  return num;
}

ObjectsStep toStep(std::size_t number, fcl::ContinuousManagerResultd result,
                   const SceneObjects& objects) {
  ObjectsStep step;
  step.number = number;
  step.num_box_pairs = result.num_box_pairs;
  for (auto& found : result.pairs) {
    fcl::ContinuousContactResultd& answer = found.result;
    ObjectsInContact pair{objects.numberOf(found.o1), objects.numberOf(found.o2),
                          answer.time_of_contact, std::move(answer.crossings)};
    // A query for any contact names one crossing, and has no list of them.
    if (pair.contacts.empty() && answer.initially_crossing && answer.contacts.empty())
      pair.contacts.push_back(answer.crossing);
    pair.contacts.insert(pair.contacts.end(), answer.contacts.begin(),
                         answer.contacts.end());
    step.pairs.push_back(std::move(pair));
  }
  return step;
}

void ObjectsSummary::add(const ObjectsStep& step, const SceneObjects& objects,
                         fcl::ContinuousQuery query) {
  ++steps;
  contacts += step.numContacts();
  if (first.is_null() && !step.pairs.empty()) {
    first_sentence = sentenceOf(step, objects, query);
    first = contactInJson(step, objects);
  }
  if (step.ms > slowest_ms) {
    slowest_ms = step.ms;
    slowest_step = step.number;
  }
}

std::string objectsTableHead(fcl::ContinuousQuery query) {
  return std::string("step  box pairs  pairs in contact  contacts  ") +
         (query == fcl::ContinuousQuery::kAny ? "    a time" : "first time") +
         "        ms\n";
}

std::string objectsTableRow(const ObjectsStep& step) {
  constexpr std::size_t kTimeWidth = 10;
  std::string time = "-";
  if (!step.pairs.empty()) {
    time = numberText(step.pairs.front().time, 8);
    if (time.size() > kTimeWidth) time = numberText(step.pairs.front().time, 5);
  }
  char row[256];  // six fields of at most 24 characters
  std::snprintf(row, sizeof row, "%4zu  %9zu  %16zu  %8zu  %10s  %8.3f\n", step.number,
                step.num_box_pairs, step.pairs.size(), step.numContacts(), time.c_str(),
                step.ms);
  return row;
}

std::string summaryLines(const ObjectsSummary& summary, fcl::ContinuousQuery query) {
  std::string lines =
      counted(summary.steps, "step") + ", " + counted(summary.contacts, "contact");
  if (query == fcl::ContinuousQuery::kFirst) lines += " that may be the first";
  if (query == fcl::ContinuousQuery::kAny) lines += ", at most one a step";
  lines += '\n' + (summary.first.is_null()
                       ? "no contact in " + counted(summary.steps, "step") + '\n'
                       : summary.first_sentence);
  return lines + "slowest: step " + std::to_string(summary.slowest_step) + " with " +
         numberText(summary.slowest_ms, 4) + " ms\n";
}

std::string objectsContactsHead() { return csvHead(kObjectsColumns, allColumns()); }

std::string contactLines(const ObjectsStep& step, const SceneObjects& objects) {
  std::string lines;
  for (const ObjectsInContact& pair : step.pairs)
    for (const ContinuousContactd& contact : pair.contacts)
      appendCsvLine(kObjectsColumns, allColumns(), Row{step, pair, contact, objects},
                    lines);
  return lines;
}

Json objectsJson(const SceneObjects& objects) {
  Json list = Json::array();
  for (std::size_t i = 0; i < objects.size(); ++i)
    list.push_back({{"name", objects.nameOf(i)},
                    {"geometry", objects.kindOf(i)},
                    {"triangles", objects.numTriangles(i)}});
  return list;
}

Json toJson(const ObjectsStep& step, const SceneObjects& objects) {
  Json pairs = Json::array();
  for (const ObjectsInContact& pair : step.pairs)
    pairs.push_back({{"o1", objects.nameOf(pair.o1)},
                     {"o2", objects.nameOf(pair.o2)},
                     {"time", pair.time},
                     {"contacts", pair.contacts.size()}});
  return {{"step", step.number},
          {"box_pairs", step.num_box_pairs},
          {"pairs", std::move(pairs)},
          {"contacts", step.numContacts()},
          {"ms", step.ms}};
}

Json toJson(const ObjectsSummary& summary) {
  return {
      {"steps", summary.steps}, {"contacts", summary.contacts}, {"first", summary.first}};
}

}  // namespace fcl_ccd

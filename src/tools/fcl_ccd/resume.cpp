// SPDX-License-Identifier: BSD-3-Clause
#include "resume.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "counted.h"
#include "json.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

/// @brief Reads complete lines of a file, and tells where they end.
class LineFile {
 public:
  explicit LineFile(const std::string& path) : in_(path, std::ios::binary) {}

  /// @return false at the end of the file, or at a line without an end.
  bool next() {
    if (!std::getline(in_, line_) || in_.eof()) return false;
    end_ += line_.size() + 1;
    return true;
  }

  const std::string& line() const { return line_; }
  std::uint64_t end() const { return end_; }

 private:
  std::ifstream in_;
  std::string line_;
  std::uint64_t end_{0};
};

/// @brief Reads the head of a file. Returns false if there is no file or no complete
/// head.
bool takeHead(LineFile& file, const std::string& path, const std::string& head,
              const char* other) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return false;
  if (!std::filesystem::is_regular_file(path, error))
    throw std::runtime_error(path + ": is not a regular file, which --resume needs");
  if (!file.next()) return false;
  if (file.line() + '\n' != head)
    throw std::runtime_error(
        path + ": cannot go on: it was written with other " + other +
        ". Name another file, or leave out --resume to overwrite it");
  return true;
}

struct ContactRows {
  std::uint64_t begin{0};  ///< offset of the step's first row
  std::size_t count{0};
};

/// @brief The rows of each step that has any, and the end of the last complete row.
struct ContactList {
  std::map<std::size_t, ContactRows> steps;
  std::uint64_t end{0};

  std::size_t rowsOf(std::size_t step) const {
    const auto found = steps.find(step);
    return found == steps.end() ? 0 : found->second.count;
  }

  /// The offset of the first row of this step or of a later one.
  std::uint64_t beginOf(std::size_t step) const {
    const auto found = steps.lower_bound(step);
    return found == steps.end() ? end : found->second.begin;
  }
};

/// A field of a line; empty if it has fewer.
std::string_view fieldOf(std::string_view line, std::size_t field) {
  for (; field > 0; --field) {
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos) return {};
    line.remove_prefix(comma + 1);
  }
  return line.substr(0, line.find(','));
}

ContactList scanContacts(const GrowingOutputs& outputs) {
  const std::string& path = outputs.contacts_path;
  ContactList list;
  LineFile file(path);
  if (!takeHead(file, path, outputs.contacts_head, "columns")) return list;
  list.end = file.end();
  for (std::uint64_t begin = file.end(); file.next(); begin = file.end()) {
    long long step = -1;
    const std::string& line = file.line();
    const bool valid =
        parseInteger(fieldOf(line, outputs.step_column), step) && step >= 0;
    const std::optional<std::size_t> found =
        outputs.numbers.frameOf(static_cast<std::size_t>(step));
    const std::size_t index = found.value_or(0);
    if (!valid || !found || (!list.steps.empty() && index < list.steps.rbegin()->first))
      throw std::runtime_error(path + ": " + fcl_ccd::quoted(line) +
                               " is not a row of a contact list of these frames. Leave " +
                               "out --resume to overwrite the file");
    ContactRows& rows = list.steps[index];
    if (rows.count++ == 0) rows.begin = begin;
    list.end = file.end();
  }
  return list;
}

struct StepLine {
  std::uint64_t end{0};
  RunSummary summary;
};

/// @brief The lines of a list of steps.
std::vector<StepLine> scanSteps(const GrowingOutputs& outputs) {
  const std::string& path = outputs.steps_path;
  std::vector<StepLine> steps;
  LineFile file(path);
  if (!takeHead(file, path, outputs.steps_head, "options or by another version"))
    return steps;

  while (file.next()) {
    const Json line = Json::parse(file.line(), nullptr, false);
    if (line.is_object() && line.contains("summary")) break;
    const std::size_t step = steps.size();
    const std::size_t number = outputs.numbers[step];
    const auto refuse = [&] {
      throw std::runtime_error(path + ": " + fcl_ccd::quoted(file.line()) +
                               " is not step " + std::to_string(number) +
                               ". Leave out --resume to overwrite the file");
    };
    if (!line.is_object() || line.value("step", Json()) != number) refuse();
    if (step >= outputs.num_steps ||
        line.value("files", Json()) != namesInJson(outputs.filesOf(step)))
      throw std::runtime_error(path + ": step " + std::to_string(number) +
                               " was of other frames than it is now. Give --resume the " +
                               "frames and options of the run that it continues");
    try {
      steps.push_back({file.end(), summaryOf(line)});
    } catch (const Json::exception&) {
      refuse();
    }
  }
  return steps;
}

}  // namespace

ResumePoint findResumePoint(const GrowingOutputs& outputs, std::size_t latest) {
  ResumePoint point;
  std::vector<StepLine> steps;
  ContactList contacts;
  if (!outputs.steps_path.empty()) steps = scanSteps(outputs);
  if (!outputs.contacts_path.empty()) contacts = scanContacts(outputs);
  if (!contacts.steps.empty() && contacts.steps.rbegin()->first >= outputs.num_steps)
    throw std::runtime_error(
        outputs.contacts_path + ": has step " +
        std::to_string(outputs.numbers[contacts.steps.rbegin()->first]) +
        ", but these frames have only " + counted(outputs.num_steps, "step") +
        ". Give --resume the frames of the run that it continues");
  if (outputs.steps_path.empty()) {
    if (!contacts.steps.empty()) point.step = contacts.steps.rbegin()->first;
  } else if (outputs.contacts_path.empty()) {
    point.step = steps.size();
  } else if (contacts.end > 0) {
    while (point.step < steps.size() &&
           contacts.rowsOf(point.step) == steps[point.step].summary.contacts())
      ++point.step;
  }
  point.step = std::min(point.step, latest);
  if (point.step == 0) return point;
  point.contacts_size = contacts.beginOf(point.step);
  if (!contacts.steps.empty() && contacts.steps.begin()->first < point.step)
    point.first_contact = contacts.steps.begin()->first;
  assert(point.contacts_size <= contacts.end);
  if (steps.empty()) return point;
  assert(point.step <= steps.size());
  point.steps_size = steps[point.step - 1].end;
  for (std::size_t i = 0; i < point.step; ++i) {
    point.summary.add(steps[i].summary);
    if (!point.first_contact && point.summary.first) point.first_contact = i;
  }
  return point;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "json_tree.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "file_bytes.h"
#include "number_text.h"
#include "suggestion.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

using nlohmann::json;

/// Reads the bytes of a text, and counts those that were read.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, std::size_t* num_read)
      : at_(at), num_read_(num_read) {}

  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    ++at_;
    ++*num_read_;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  std::size_t* num_read_;
};

/// The end of a text of the JSON library, without its own numbers of line and error.
std::string causeOf(const std::string& message) {
  const std::size_t column = message.find(", column "),
                    begin = message.find(column == std::string::npos ? "] " : ": ",
                                         column == std::string::npos ? 0 : column);
  return begin == std::string::npos ? message : message.substr(begin + 2);
}

/// Makes the tree from the events of the parser.
class TreeMaker {
 public:
  TreeMaker(const std::string& path, const std::string& bytes, JsonValue& root)
      : path_(path), bytes_(bytes), root_(root) {}

  std::size_t* numRead() { return &num_read_; }

  bool null() { return add(nullptr, 0); }
  bool boolean(bool value) { return add(value, 0); }
  // The byte behind a number was read, too.
  bool number_integer(std::int64_t value) { return add(static_cast<double>(value), 1); }
  bool number_unsigned(std::uint64_t value) { return add(static_cast<double>(value), 1); }
  bool number_float(double value, const std::string&) { return add(value, 1); }
  bool string(std::string& value) { return add(std::move(value), 0); }
  bool binary(json::binary_t&) { return false; }
  bool start_object(std::size_t) { return open(JsonValue::Members()); }
  bool start_array(std::size_t) { return open(JsonValue::List()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    auto& members = std::get<JsonValue::Members>(open_.back()->value);
    members.push_back({std::move(name), lineOf(num_read_), {}});
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) {
    const std::size_t at = std::min(position == 0 ? 0 : position - 1, bytes_.size());
    const std::size_t line = lineOf(at), column = at + 1 - std::min(at, lineBegin(at));
    throw std::runtime_error(path_ + ": line " + std::to_string(line) + ", column " +
                             std::to_string(column) + ": " + explain(at, error.what()));
  }

 private:
  /// The word around an offset.
  std::string wordAt(std::size_t at) const {
    const auto isOfWord = [&](std::size_t i) {
      return i < bytes_.size() && (std::isalnum(static_cast<unsigned char>(bytes_[i])) ||
                                   bytes_[i] == '-' || bytes_[i] == '+');
    };
    std::size_t begin = at, end = at;
    while (begin > 0 && isOfWord(begin - 1)) --begin;
    while (isOfWord(end)) ++end;
    return bytes_.substr(begin, end - begin);
  }

  std::string explain(std::size_t at, const std::string& message) const {
    std::string word = wordAt(at), lower;
    for (const char c : word)
      if (c != '-' && c != '+')
        lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (lower == "nan" || lower == "inf" || lower == "infinity")
      return word + " is not a number of JSON. Write a finite number";
    if (message.find("number overflow") != std::string::npos)
      return "the number is too large for a double. Write a finite number";
    return "broken JSON: " + causeOf(message) + ". Correct it here or just before";
  }

  std::size_t lineBegin(std::size_t at) const {
    const std::size_t end = at == 0 ? std::string::npos : bytes_.rfind('\n', at - 1);
    return end == std::string::npos ? 0 : end + 1;
  }

  /// The line of an offset. Offsets come in ascending order, so that each byte is looked
  /// at once.
  std::size_t lineOf(std::size_t at) {
    if (at < counted_) counted_ = 0, line_ = 1;
    line_ += static_cast<std::size_t>(
        std::count(bytes_.data() + counted_, bytes_.data() + at, '\n'));
    counted_ = at;
    return line_;
  }

  JsonValue& place() {
    if (open_.empty()) return root_;
    JsonValue& parent = *open_.back();
    if (auto* members = std::get_if<JsonValue::Members>(&parent.value))
      return members->back().value;
    return std::get<JsonValue::List>(parent.value).emplace_back();
  }

  /// @param num_behind  how many bytes behind the value were read
  template <typename T>
  bool add(T value, std::size_t num_behind) {
    JsonValue& added = place();
    added.value = std::move(value);
    added.line = lineOf(num_read_ - std::min(num_behind, num_read_));
    return true;
  }

  template <typename T>
  bool open(T value) {
    // A tree of this depth can be destroyed in any stack.
    constexpr std::size_t kDeepest = 64;
    if (open_.size() == kDeepest)
      throw std::runtime_error(path_ + ": line " + std::to_string(lineOf(num_read_)) +
                               ": lists and objects are nested too deeply here");
    JsonValue& added = place();
    added.value = std::move(value);
    added.line = lineOf(num_read_);
    open_.push_back(&added);
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& path_;
  const std::string& bytes_;
  JsonValue& root_;
  std::vector<JsonValue*> open_;
  std::size_t num_read_{0};
  std::size_t counted_{0}, line_{1};
};

/// "objects[2].poses" for a value of the tree; empty for its root, nothing if it is not
/// in the tree.
std::optional<std::string> pathTo(const JsonValue& value, const JsonValue& tree) {
  if (&value == &tree) return "";
  if (const auto* list = tree.as<JsonValue::List>())
    for (std::size_t i = 0; i < list->size(); ++i)
      if (auto rest = pathTo(value, (*list)[i]))
        return '[' + std::to_string(i) + ']' +
               (rest->empty() || (*rest)[0] == '[' ? "" : ".") + *rest;
  if (const auto* members = tree.as<JsonValue::Members>())
    for (const JsonMember& member : *members)
      if (auto rest = pathTo(value, member.value))
        return member.name + (rest->empty() || (*rest)[0] == '[' ? "" : ".") + *rest;
  return std::nullopt;
}

const char* kindOf(const JsonValue& value) {
  constexpr const char* kKinds[] = {"null",   "true or false", "a number",
                                    "a text", "a list",        "an object"};
  return kKinds[value.value.index()];
}

std::string refusal(const std::string& path, std::size_t line, const std::string& field,
                    const std::string& cause) {
  return path + ": line " + std::to_string(line) + ": " +
         (field.empty() ? "" : field + ": ") + cause;
}

}  // namespace

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0                  ? ""
             : i + 1 == names.size() ? " and "
                                     : ", ") +
            ('\'' + names[i]) + '\'';
  return text;
}

std::string didYouMean(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearestName(name, known);
  return nearest.empty() ? "" : "Did you mean '" + nearest + "'? ";
}

JsonFile::JsonFile(std::string path) : path_(std::move(path)) {
  const std::string bytes =
      namingPlace([&] { return path_; }, [&] { return readRegularFile(path_); });
  TreeMaker maker(path_, bytes, root_);
  json::sax_parse(CountingIterator(bytes.data(), maker.numRead()),
                  CountingIterator(bytes.data() + bytes.size(), maker.numRead()), &maker);
}

void JsonFile::refuse(const JsonValue& value, const std::string& cause) const {
  throw std::runtime_error(
      refusal(path_, value.line, pathTo(value, root_).value_or(""), cause));
}

void JsonFile::refuseKind(const JsonValue& value, const char* expected) const {
  refuse(value, "is " + std::string(kindOf(value)) + ". Write " + expected);
}

const std::string& JsonFile::text(const JsonValue& value) const {
  const auto* text = value.as<std::string>();
  if (text == nullptr) refuseKind(value, "a text in quotes");
  if (text->empty()) refuse(value, "the text is empty. Write a name");
  // Names are parts of paths and of lines.
  if (std::any_of(text->begin(), text->end(),
                  [](unsigned char c) { return c < ' ' || c == 127; }))
    refuse(value, "has a control character, such as a line end. Leave it out");
  return *text;
}

bool JsonFile::boolean(const JsonValue& value) const {
  const auto* boolean = value.as<bool>();
  if (boolean == nullptr) refuseKind(value, "true or false");
  return *boolean;
}

double JsonFile::number(const JsonValue& value) const {
  const auto* number = value.as<double>();
  if (number == nullptr) refuseKind(value, "a number");
  // Far below the limits of the library, which know no lines.
  constexpr double kLargest = 1e100;
  if (!(*number >= -kLargest && *number <= kLargest))
    refuse(value,
           "is " + numberText(*number, 6) + ". Use larger units: numbers go up to 1e100");
  return *number;
}

double JsonFile::notNegative(const JsonValue& value) const {
  const double found = number(value);
  if (found < 0)
    refuse(value, "is " + numberText(found, 6) + ". Write a number from 0 on");
  return found;
}

double JsonFile::positive(const JsonValue& value) const {
  const double found = number(value);
  if (!(found > 0))
    refuse(value, "is " + numberText(found, 6) + ". Write a number above 0");
  return found;
}

int JsonFile::wholeNumber(const JsonValue& value, int least, int most) const {
  const double found = number(value);
  const bool is_in_range = found >= least && found <= most;
  if (!is_in_range || found != static_cast<int>(found))
    refuse(value, "is " + numberText(found, 6) + ". Write " +
                      (least == most ? std::to_string(least)
                                     : "a whole number from " + std::to_string(least) +
                                           " to " + std::to_string(most)));
  return static_cast<int>(found);
}

const JsonValue::List& JsonFile::list(const JsonValue& value) const {
  const auto* list = value.as<JsonValue::List>();
  if (list == nullptr) refuseKind(value, "a list");
  if (list->empty()) refuse(value, "the list is empty. Write at least one entry");
  return *list;
}

const JsonValue::List& JsonFile::list(const JsonValue& value, std::size_t size) const {
  const JsonValue::List& entries = list(value);
  if (entries.size() != size)
    refuse(value, "the list has " + std::to_string(entries.size()) +
                      (entries.size() == 1 ? " entry" : " entries") + ". Write " +
                      std::to_string(size));
  return entries;
}

const JsonValue::Members& JsonFile::fields(const JsonValue& value,
                                           const std::vector<std::string>& known) const {
  const auto* members = value.as<JsonValue::Members>();
  if (members == nullptr) refuseKind(value, "an object: fields in braces");
  const auto refuseName = [&](const JsonMember& member, const std::string& cause) {
    throw std::runtime_error(
        refusal(path_, member.line, pathTo(value, root_).value_or(""), cause));
  };
  for (const JsonMember& member : *members) {
    if (std::find(known.begin(), known.end(), member.name) == known.end())
      refuseName(member, "there is no field '" + member.name + "' here. " +
                             didYouMean(member.name, known) +
                             "The fields are: " + listed(known));
    if (find(value, member.name) != &member.value)
      refuseName(member, "the field '" + member.name + "' is there twice. Leave one out");
  }
  return *members;
}

const JsonValue* JsonFile::find(const JsonValue& object, const std::string& name) const {
  const auto* members = object.as<JsonValue::Members>();
  if (members == nullptr) return nullptr;
  for (const JsonMember& member : *members)
    if (member.name == name) return &member.value;
  return nullptr;
}

const JsonValue& JsonFile::require(const JsonValue& object,
                                   const std::string& name) const {
  const JsonValue* found = find(object, name);
  if (found == nullptr) refuse(object, "the field '" + name + "' is missing. Add it");
  return *found;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
//
// JSON whose values know their lines, so that a message can name them.
#ifndef FCL_CCD_JSON_TREE_H
#define FCL_CCD_JSON_TREE_H

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace fcl_ccd {

struct JsonMember;

/// @brief A value of a JSON file.
struct JsonValue {
  using List = std::vector<JsonValue>;
  using Members = std::vector<JsonMember>;

  std::size_t line{0};  ///< where it begins, counted from 1
  std::variant<std::nullptr_t, bool, double, std::string, List, Members> value{nullptr};

  template <typename T>
  const T* as() const {
    return std::get_if<T>(&value);
  }
};

/// @brief A field of a JSON object.
struct JsonMember {
  std::string name;
  std::size_t line{0};  ///< of the name
  JsonValue value;
};

/// @brief A JSON file that is read whole. All functions throw std::runtime_error with the
/// file, the line and the field, as in "scene.json: line 4: objects[0].group: CAUSE".
class JsonFile {
 public:
  /// @throws std::runtime_error with line and column, if it is no JSON.
  explicit JsonFile(std::string path);
  JsonFile(const JsonFile&) = delete;
  JsonFile& operator=(const JsonFile&) = delete;

  const std::string& path() const { return path_; }
  const JsonValue& root() const { return root_; }

  /// @brief Says what is wrong with a value of the file.
  [[noreturn]] void refuse(const JsonValue& value, const std::string& cause) const;

  /// @name Values of a kind; any other is refused
  /// @{
  const std::string& text(const JsonValue& value) const;
  bool boolean(const JsonValue& value) const;
  double number(const JsonValue& value) const;
  double notNegative(const JsonValue& value) const;
  double positive(const JsonValue& value) const;
  int wholeNumber(const JsonValue& value, int least, int most) const;
  /// @brief A list with at least one entry.
  const JsonValue::List& list(const JsonValue& value) const;
  /// @brief A list of this length.
  const JsonValue::List& list(const JsonValue& value, std::size_t size) const;
  /// @brief An object whose fields are all known, and each is there once.
  const JsonValue::Members& fields(const JsonValue& value,
                                   const std::vector<std::string>& known) const;
  /// @}

  /// @brief The field of an object, or null.
  const JsonValue* find(const JsonValue& object, const std::string& name) const;
  /// @brief The field of an object.
  const JsonValue& require(const JsonValue& object, const std::string& name) const;

 private:
  [[noreturn]] void refuseKind(const JsonValue& value, const char* expected) const;

  std::string path_;
  JsonValue root_;
};

/// @brief "a, b and c", each in quotes.
std::string listed(const std::vector<std::string>& names);

/// @brief "Did you mean 'radius'? ", or nothing if no known name is like this one.
std::string didYouMean(const std::string& name, const std::vector<std::string>& known);

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TEXT_CURSOR_H
#define FCL_CCD_TEXT_CURSOR_H

#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "text_scan.h"

namespace fcl_ccd {

/// @brief What a character of a text is.
enum class TextKind : std::uint8_t { kOther, kBlank, kLineEnd, kHash, kBackslash };

template <bool kComments, bool kContinuations>
constexpr std::array<TextKind, 256> makeTextKinds() {
  std::array<TextKind, 256> kinds{};
  for (const char blank : {' ', '\t', '\v', '\f'})
    kinds[static_cast<unsigned char>(blank)] = TextKind::kBlank;
  for (const char end : {'\n', '\r'})
    kinds[static_cast<unsigned char>(end)] = TextKind::kLineEnd;
  if (kComments) kinds['#'] = TextKind::kHash;
  if (kContinuations) kinds['\\'] = TextKind::kBackslash;
  return kinds;
}

/// @brief Reads the words and numbers of a text, from the front to the back and once.
/// Lines end with LF, CR LF or CR. Nothing is kept of a line, not even its number: an
/// error counts the lines before it.
///
/// A function that takes a word expects that the cursor is at one, as skipBlanks() says.
/// @tparam kComments  whether `#` begins a comment, up to the end of the line
/// @tparam kContinuations  whether a backslash before the end of a line is a blank
template <bool kComments, bool kContinuations>
class TextCursor {
 public:
  explicit TextCursor(std::string_view text)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()) {}

  bool atEnd() const { return at_ == end_; }
  std::size_t bytesLeft() const { return static_cast<std::size_t>(end_ - at_); }
  std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }

  /// @brief The number of the current line, from 1 on.
  std::size_t lineNo() const { return lineNo(offset()); }
  std::size_t lineNo(std::size_t offset) const {
    assert(offset <= static_cast<std::size_t>(end_ - begin_));
    std::size_t line_no = 1;
    for (const char* c = begin_; c != begin_ + offset; ++c)
      if (*c == '\n' || (*c == '\r' && (c + 1 == end_ || c[1] != '\n'))) ++line_no;
    return line_no;
  }
  std::string place() const { return "line " + std::to_string(lineNo()); }

  /// @brief Skips blanks within the line. Returns whether a word follows.
  bool skipBlanks() {
    while (at_ != end_) {
      const Kind kind = kindOf(*at_);
      if (kind == Kind::kOther) return true;
      if (kind == Kind::kBlank)
        ++at_;
      else if (kind == Kind::kBackslash && isContinuation(at_))
        skipLineEnd(at_ + 1);
      else
        return kind == Kind::kBackslash;
    }
    return false;
  }

  /// @brief Goes to the beginning of the next line.
  void nextLine() {
    while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
    if (at_ != end_) skipLineEnd(at_);
  }

  /// @brief Skips blanks, comments and ends of lines. Returns whether a word follows.
  bool skipToWord() {
    while (!skipBlanks()) {
      if (at_ == end_) return false;
      nextLine();
    }
    return true;
  }

  std::string_view takeWord() {
    const std::string_view word = peekWord();
    at_ += word.size();
    return word;
  }

  std::string_view peekWord() const {
    const char* end = at_;
    while (!endsWord(end)) ++end;
    return {at_, static_cast<std::size_t>(end - at_)};
  }

  /// @brief Takes a number. Throws if the word is no number, or not a finite one.
  template <typename Value>
  Value takeNumber() {
    Value value{};
    const auto parsed = parseDecimal(at_, end_, value);
    if (parsed.ec == std::errc() && endsWord(parsed.ptr) && std::isfinite(value)) {
      requireNoHashBehindPoint(parsed.ptr);
      at_ = parsed.ptr;
      return value;
    }
    const std::string_view word = peekWord();
    value = requireNumber<Value>(word);
    at_ += word.size();
    return value;
  }

  /// @brief Takes the coordinates of a vertex, which are in one line.
  std::array<double, 3> takeVertex() {
    std::array<double, 3> vertex{};
    for (double& x : vertex) {
      if (!skipBlanks()) throw std::runtime_error("a vertex needs three coordinates");
      x = takeNumber<double>();
    }
    return vertex;
  }

  /// @brief Takes an integer with an optional sign. Returns false if the word is none, or
  /// does not fit a long long; the cursor then stays.
  bool takeInteger(long long& value) {
    const auto parsed = std::from_chars(at_, end_, value);
    if (parsed.ec == std::errc() && endsWord(parsed.ptr)) {
      at_ = parsed.ptr;
      return true;
    }
    const std::string_view word = peekWord();
    if (!parseInteger(word, value)) return false;
    at_ += word.size();
    return true;
  }

 private:
  using Kind = TextKind;
  static constexpr std::array<Kind, 256> kKinds =
      makeTextKinds<kComments, kContinuations>();

  static Kind kindOf(char c) { return kKinds[static_cast<unsigned char>(c)]; }

  bool endsWord(const char* at) const {
    if (at == end_) return true;
    const Kind kind = kindOf(*at);
    return kind != Kind::kOther && (kind != Kind::kBackslash || isContinuation(at));
  }

  /// A backslash at the end of the text continues into nothing.
  bool isContinuation(const char* at) const {
    return at + 1 == end_ || at[1] == '\n' || at[1] == '\r';
  }

  void skipLineEnd(const char* at) {
    const bool is_pair = at != end_ && *at == '\r' && at + 1 != end_ && at[1] == '\n';
    at_ = at == end_ ? end_ : at + (is_pair ? 2 : 1);
  }

  /// Some programs write 1.#QNAN, -1.#IND and 1.#INF. This is no 1 with a comment.
  void requireNoHashBehindPoint(const char* at) const {
    if (kComments && at != end_ && *at == '#' && at[-1] == '.') {
      const char* end = at;
      while (end != end_ && static_cast<unsigned char>(*end) > ' ') ++end;
      const std::string_view word(at_, static_cast<std::size_t>(end - at_));
      throw BadWord(quoted(word) + " is not finite", word);
    }
  }

  const char* begin_;
  const char* at_;
  const char* end_;
};

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "text_scan.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace fcl_ccd {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

std::size_t takeDigits(std::string_view& token) {
  std::size_t n = 0;
  while (n < token.size() && isDigit(token[n])) ++n;
  token.remove_prefix(n);
  return n;
}

void takeSign(std::string_view& token) {
  if (!token.empty() && (token[0] == '+' || token[0] == '-')) token.remove_prefix(1);
}

bool isDecimal(std::string_view token) {
  takeSign(token);
  std::size_t digits = takeDigits(token);
  if (!token.empty() && token[0] == '.') {
    token.remove_prefix(1);
    digits += takeDigits(token);
  }
  if (digits == 0) return false;
  if (token.empty()) return true;
  if (std::string_view("eEdD").find(token[0]) == std::string_view::npos) return false;
  token.remove_prefix(1);
  takeSign(token);
  return takeDigits(token) > 0 && token.empty();
}

/// A decimal with an exponent as strtod() reads it.
std::string asInC(std::string_view decimal) {
  std::string text(decimal);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  return text;
}

template <typename Value>
Value parseInC(const std::string& text);
template <>
float parseInC<float>(const std::string& text) {
  return std::strtof(text.c_str(), nullptr);
}
template <>
double parseInC<double>(const std::string& text) {
  return std::strtod(text.c_str(), nullptr);
}

}  // namespace

bool takeLine(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const std::size_t end = text.find('\n');
  line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

bool takeToken(std::string_view& text, std::string_view& token) {
  std::size_t begin = 0;
  while (begin < text.size() && isBlank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !isBlank(text[end])) ++end;
  token = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return !token.empty();
}

void splitTokens(std::string_view line, std::vector<std::string_view>& tokens) {
  tokens.clear();
  for (std::string_view token; takeToken(line, token);) tokens.push_back(token);
}

NumberToken classifyNumber(std::string_view token) {
  if (isDecimal(token))
    return std::isfinite(parseInC<double>(asInC(token))) ? NumberToken::kFinite
                                                         : NumberToken::kNotFinite;
  takeSign(token);
  std::string word(token.substr(0, 9));
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  // The last one is how some programs write them: 1.#INF, 1.#QNAN, 1.#IND.
  const bool named = word == "inf" || word == "infinity" || word.rfind("nan", 0) == 0 ||
                     word.rfind("1.#", 0) == 0;
  return named ? NumberToken::kNotFinite : NumberToken::kNotANumber;
}

bool parseInteger(std::string_view token, long long& value) {
  if (token.size() > 1 && token[0] == '+' && isDigit(token[1])) token.remove_prefix(1);
  const auto end = token.data() + token.size();
  const auto parsed = std::from_chars(token.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

template <typename Value>
Value requireNumber(std::string_view token) {
  switch (classifyNumber(token)) {
    case NumberToken::kFinite:
      break;
    case NumberToken::kNotFinite:
      throw BadWord(quoted(token) + " is not finite", token);
    case NumberToken::kNotANumber:
      throw BadWord(quoted(token) + " is not a number", token);
  }
  const Value value = parseInC<Value>(asInC(token));
  if (!std::isfinite(value))
    throw BadWord(quoted(token) + " does not fit its type", token);
  return value;
}
template float requireNumber<float>(std::string_view);
template double requireNumber<double>(std::string_view);

std::string quoted(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string shown(token.substr(0, kLongest));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + shown + (token.size() > kLongest ? "...'" : "'");
}

}  // namespace fcl_ccd

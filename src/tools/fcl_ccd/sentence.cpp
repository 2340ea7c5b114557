// SPDX-License-Identifier: BSD-3-Clause
#include "sentence.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "number_text.h"

namespace fcl_ccd {
namespace {

/// A blank that is no line break is this character, which no name has.
constexpr char kBlank = '\1';

}  // namespace

std::string unbroken(std::string text) {
  std::replace(text.begin(), text.end(), ' ', kBlank);
  return text;
}

std::string pointText(const std::array<double, 3>& point) {
  constexpr int kDigits = 6;
  std::string text;
  for (const double x : point)
    // -0 becomes 0.
    text += (text.empty() ? "(" : ", ") + numberText(x + 0.0, kDigits);
  return unbroken(text + ')');
}

std::string normalText(const std::array<double, 3>& normal) {
  return normal == std::array<double, 3>{} ? "no normal" : "normal " + pointText(normal);
}

std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 80;
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > kWidth) {
      lines += line + '\n';
      line = " ";
    }
    line += (line.empty() ? "" : " ") + word;
  }
  lines += line + '\n';
  std::replace(lines.begin(), lines.end(), kBlank, ' ');
  return lines;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "frame_list.h"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>

#include "mesh_io.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;

bool isDigit(char c) { return c >= '0' && c <= '9'; }

bool isPattern(const std::string& text) {
  return text.find_first_of("*?[") != std::string::npos;
}

/// @brief Throws if a folder is named by a pattern.
void requirePlainFolder(const std::string& word) {
  const fs::path folder = fs::path(word).parent_path();
  std::error_code error;
  if (isPattern(folder.string()) && !fs::exists(folder, error))
    throw std::runtime_error(
        word + ": cannot open: there is no folder " + folder.string() +
        ". *, ? and [...] stand for the name of a file, not for " + "that of a folder");
}

/// @brief The names of the files of a folder.
std::vector<std::string> filesIn(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder.empty() ? fs::path(".") : folder, error);
  if (error)
    throw std::runtime_error(folder.string() + ": cannot open: " + error.message());
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : entries)
    if (!entry.is_directory(error)) names.push_back(entry.path().filename().string());
  return names;
}

std::vector<std::string> sortedPaths(const fs::path& folder,
                                     std::vector<std::string> names) {
  std::sort(names.begin(), names.end(), isBeforeNaturally);
  for (std::string& name : names) name = (folder / name).string();
  return names;
}

std::vector<std::string> meshesIn(const std::string& word, bool is_growing) {
  std::vector<std::string> meshes;
  std::set<std::string> formats;
  for (const std::string& name : filesIn(word)) {
    const std::string format = extensionOf(name);
    if (name[0] == '.' || !isMeshFormat(format)) continue;
    meshes.push_back(name);
    formats.insert(format);
  }
  if (meshes.empty() && !is_growing)
    throw std::runtime_error(word + ": the folder has no .obj, .ply, .off or .stl file");
  if (formats.size() > 1)
    throw std::runtime_error(word + ": the folder has ." + *formats.begin() + " and ." +
                             *formats.rbegin() +
                             " files. Name one format by a pattern: '" +
                             (fs::path(word) / ("*." + *formats.begin())).string() + "'");
  return sortedPaths(word, std::move(meshes));
}

std::vector<std::string> matchesOf(const std::string& word, bool is_growing) {
  const fs::path path(word), folder = path.parent_path();
  const std::string pattern = path.filename().string();
  std::vector<std::string> matches;
  for (const std::string& name : filesIn(folder))
    if (fnmatch(pattern.c_str(), name.c_str(), FNM_PERIOD) == 0) matches.push_back(name);
  if (matches.empty() && !is_growing)
    throw std::runtime_error(word + ": no file matches this pattern");
  return sortedPaths(folder, std::move(matches));
}

/// @brief A name with a number, as frame_%04d.ply: the parts before and after the number,
/// and its least number of digits.
struct NumberedName {
  std::string before, after;
  std::size_t width{0};

  std::string operator()(long long number) const {
    std::string digits = std::to_string(number);
    if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
    return before + digits + after;
  }

  /// The number of a file, if it has this name.
  std::optional<long long> numberOf(const std::string& name) const {
    const std::optional<long long> number = numberIn(name);
    if (!number || (*this)(*number) != name) return std::nullopt;
    return number;
  }

  /// The number of a file, with any number of digits. The parts before and after it are
  /// not compared.
  std::optional<long long> numberIn(const std::string& name) const {
    if (name.size() <= before.size() + after.size()) return std::nullopt;
    const std::string digits =
        name.substr(before.size(), name.size() - before.size() - after.size());
    long long number = 0;
    const bool decimal = std::all_of(digits.begin(), digits.end(), isDigit);
    if (!decimal || !parseInteger(digits, number)) return std::nullopt;
    return number;
  }
};

/// @brief The parts that all names have before and after a number in which they differ.
NumberedName commonName(const std::vector<std::string>& names) {
  NumberedName common{names[0], names[0], 0};
  for (const std::string& name : names) {
    const auto before = std::mismatch(common.before.begin(), common.before.end(),
                                      name.begin(), name.end());
    common.before.erase(before.first, common.before.end());
    const auto after = std::mismatch(common.after.rbegin(), common.after.rend(),
                                     name.rbegin(), name.rend());
    common.after.erase(common.after.begin(), after.first.base());
  }
  while (!common.before.empty() && isDigit(common.before.back()))
    common.before.pop_back();
  while (!common.after.empty() && isDigit(common.after.front()))
    common.after.erase(common.after.begin());
  return common;
}

std::optional<NumberedName> parseNumbered(const std::string& name) {
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return std::nullopt;
  std::size_t end = percent + 1;
  while (end < name.size() && isDigit(name[end])) ++end;
  if (end == name.size() || name[end] != 'd') return std::nullopt;
  NumberedName numbered{name.substr(0, percent), name.substr(end + 1), 0};
  const std::string width = name.substr(percent + 1, end - percent - 1);
  if (width.size() > 3 || (!width.empty() && width[0] != '0'))
    throw std::runtime_error(name +
                             ": write the number as %d, or with leading zeros as %04d");
  if (!width.empty()) numbered.width = std::stoul(width);
  return numbered;
}

std::vector<std::string> numbersOf(const std::string& word, const FrameRange& range,
                                   FrameNumbers& numbers) {
  const fs::path path(word), folder = path.parent_path();
  const NumberedName name = *parseNumbered(path.filename().string());
  std::optional<long long> lowest, highest;
  for (const std::string& file : filesIn(folder)) {
    const std::optional<long long> number = name.numberOf(file);
    if (!number) continue;
    lowest = std::min(lowest.value_or(*number), *number);
    highest = std::max(highest.value_or(*number), *number);
  }
  std::vector<std::string> paths;
  if (!lowest && range.is_growing) return paths;
  if (!lowest) throw std::runtime_error(word + ": no file matches this name");
  numbers.first = range.start.value_or(*lowest);
  const long long end = range.end.value_or(*highest);
  for (long long number = range.start.value_or(*lowest); number <= end;
       number += range.stride) {
    const fs::path frame = folder / name(number);
    const bool is_there = fs::exists(frame);
    if (!is_there && range.is_growing) break;
    if (!is_there)
      throw std::runtime_error(frame.string() + ": is missing (the files are numbered " +
                               std::to_string(*lowest) + " to " +
                               std::to_string(*highest) + ")");
    paths.push_back(frame.string());
  }
  if (paths.empty() && !range.is_growing)
    throw std::runtime_error(
        word + ": no number is between --start and --end. The files " + "are numbered " +
        std::to_string(*lowest) + " to " + std::to_string(*highest));
  return paths;
}

std::vector<std::string> select(const std::string& word,
                                const std::vector<std::string>& paths,
                                const FrameRange& range) {
  const long long last = static_cast<long long>(paths.size()) - 1;
  const long long end = range.end.value_or(last);
  if (end > last && !range.is_growing)
    throw std::runtime_error(word + ": has files 0 to " + std::to_string(last) +
                             ", so that --end " + std::to_string(*range.end) +
                             " is too high");
  std::vector<std::string> taken;
  for (long long i = range.start.value_or(0); i <= std::min(end, last); i += range.stride)
    taken.push_back(paths[static_cast<std::size_t>(i)]);
  if (taken.empty() && !range.is_growing)
    throw std::runtime_error(word + ": no file is between --start and --end. It has " +
                             "files 0 to " + std::to_string(last));
  return taken;
}

void requireNotNegative(const char* option, std::optional<long long> frame) {
  if (frame.value_or(0) < 0)
    throw std::runtime_error(option + (" " + std::to_string(*frame)) +
                             ": frames are counted from 0");
}

}  // namespace

bool mayGrow(const std::vector<std::string>& words) {
  if (words.size() != 1) return false;
  const std::string name = fs::path(words[0]).filename().string();
  std::error_code error;
  return fs::exists(words[0], error) ? fs::is_directory(words[0], error)
                                     : parseNumbered(name) || isPattern(name);
}

bool isNamedBy(const std::string& word, const std::string& file) {
  const fs::path path(file);
  const std::string name = path.filename().string();
  std::error_code error;
  const bool is_folder = fs::is_directory(word, error);
  const fs::path folder = is_folder ? fs::path(word) : fs::path(word).parent_path();
  const auto resolved = [&](const fs::path& of) {
    return fs::weakly_canonical(fs::absolute(of.empty() ? "." : of, error), error);
  };
  if (resolved(folder / name) != resolved(path.parent_path() / name)) return false;
  if (is_folder) return name[0] != '.' && isMeshFormat(extensionOf(name));
  const std::string last = fs::path(word).filename().string();
  if (const auto numbered = parseNumbered(last))
    return numbered->numberOf(name).has_value();
  return isPattern(last) && fnmatch(last.c_str(), name.c_str(), FNM_PERIOD) == 0;
}

bool isBeforeNaturally(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!isDigit(a[i]) || !isDigit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto takeNumber = [](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t begin = at;
      while (at < text.size() && isDigit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    const std::string m = takeNumber(a, i), n = takeNumber(b, j);
    if (m.size() != n.size()) return m.size() < n.size();
    if (m != n) return m < n;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // equal numbers, as in f1 and f01
}

bool hasNumber(const std::string& name) { return parseNumbered(name).has_value(); }

std::string withNumber(const std::string& name, std::size_t number) {
  const std::optional<NumberedName> numbered = parseNumbered(name);
  return numbered ? (*numbered)(static_cast<long long>(number)) : name;
}

std::string noteOnGaps(const std::vector<std::string>& frames) {
  if (frames.size() < 3) return "";
  const NumberedName name = commonName(frames);
  std::vector<long long> steps;
  std::optional<long long> last;
  for (const std::string& frame : frames) {
    const std::optional<long long> number = name.numberIn(frame);
    if (!number || *number <= last.value_or(-1)) return "";
    if (last) steps.push_back(*number - *last);
    last = number;
  }
  const long long usual = *std::min_element(steps.begin(), steps.end());
  const auto num_usual = std::count(steps.begin(), steps.end(), usual);
  const auto num_gaps = static_cast<std::ptrdiff_t>(steps.size()) - num_usual;
  if (num_gaps == 0 || num_gaps >= num_usual) return "";
  const auto gap = std::find_if(steps.begin(), steps.end(),
                                [usual](long long step) { return step > usual; });
  const auto before = static_cast<std::size_t>(gap - steps.begin());
  return frames[before] + ": the next file is " + frames[before + 1] +
         "; numbers between them are missing" +
         (num_gaps > 1 ? ". There are " + std::to_string(num_gaps) + " such places" : "");
}

std::optional<std::size_t> FrameNumbers::frameOf(std::size_t number) const {
  const auto begin = static_cast<std::size_t>(first);
  const auto step = static_cast<std::size_t>(stride);
  if (number < begin || (number - begin) % step != 0) return std::nullopt;
  return (number - begin) / step;
}

std::vector<std::string> listFrames(const std::vector<std::string>& words,
                                    const FrameRange& range, FrameNumbers* numbers) {
  requireNotNegative("--start", range.start);
  requireNotNegative("--end", range.end);
  std::vector<std::string> frames;
  FrameNumbers of_word;
  bool has_list = false;
  for (const std::string& word : words) {
    const std::string name = fs::path(word).filename().string();
    std::error_code error;
    std::vector<std::string> found;
    const bool is_there = fs::exists(word, error);
    if (!is_there) requirePlainFolder(word);
    of_word = {range.start.value_or(0), range.stride};
    if (fs::is_directory(word, error)) {
      found = select(word, meshesIn(word, range.is_growing), range);
    } else if (!is_there && parseNumbered(name)) {
      found = numbersOf(word, range, of_word);
    } else if (!is_there && isPattern(name)) {
      found = select(word, matchesOf(word, range.is_growing), range);
    } else {
      if (!is_there)
        throw std::runtime_error(word + ": cannot open: there is no such file or folder");
      frames.push_back(word);
      continue;
    }
    has_list = true;
    frames.insert(frames.end(), found.begin(), found.end());
  }
  if (!has_list && !range.isWhole())
    throw std::runtime_error(
        "--start, --end and --stride select frames of a folder, a pattern or a name with "
        "%d, but these files were named one by one");
  if (numbers != nullptr && has_list && words.size() == 1) *numbers = of_word;
  return frames;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "output_set.h"

#include <sys/stat.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "write_error.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;

/// Whether two paths name the same file, or would if it existed. Devices and pipes do not
/// count: nothing in them is overwritten.
bool isSameFile(const std::string& a, const std::string& b) {
  if (isStandardOutput(a) || isStandardOutput(b)) return a == b;
  std::error_code error;
  const fs::file_status status = fs::status(a, error);
  // Paths are only compared if both are new: this looks up each folder in them, and a new
  // output is compared with every frame.
  if (fs::exists(status) != fs::exists(b, error)) return false;
  if (fs::exists(status))
    return fs::is_regular_file(status) && fs::equivalent(a, b, error);
  return fs::weakly_canonical(fs::absolute(a, error), error) ==
         fs::weakly_canonical(fs::absolute(b, error), error);
}

[[noreturn]] void refuseTaken(const std::string& path, const std::string& taken) {
  throw std::runtime_error(nameOfOutput(path) + ": cannot write: " +
                           (isStandardOutput(path) ? "it can take one output only"
                                                   : "it is also given as " + taken));
}

}  // namespace

void print(std::string_view text) { print(text, false); }

void print(std::string_view text, bool to_stderr) {
  std::FILE* const stream = to_stderr ? stderr : stdout;
  if (std::fwrite(text.data(), 1, text.size(), stream) != text.size() ||
      std::fflush(stream) != 0)
    throw WriteError(to_stderr ? "standard error" : "standard output", "writing failed",
                     errno);
}

void requireNotAmong(const std::vector<std::string>& inputs, const std::string& output) {
  std::error_code error;
  if (output.empty() || !fs::is_regular_file(output, error)) return;
  const auto input =
      std::find_if(inputs.begin(), inputs.end(),
                   [&](const std::string& name) { return isSameFile(output, name); });
  if (input != inputs.end())
    throw WriteError(output + ": cannot write: another program wrote the frame " +
                     *input + " under this name");
}

void OutputSet::reserve(const std::string& path) {
  if (path.empty()) return;
  const auto taken =
      std::find_if(taken_.begin(), taken_.end(),
                   [&](const std::string& other) { return isSameFile(path, other); });
  if (taken != taken_.end()) refuseTaken(path, *taken);
  requireWritable(path);
  locks_.push_back(std::make_unique<OutputLock>(path));
  taken_.push_back(path);
}

void OutputSet::requireNotTaken(const std::vector<std::string>& outputs) const {
  std::map<std::pair<dev_t, ino_t>, const std::string*> files;
  const auto idOf = [](const std::string& path) {
    struct stat found {};
    const bool is_file = stat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode);
    return is_file ? std::make_optional(std::make_pair(found.st_dev, found.st_ino))
                   : std::nullopt;
  };
  for (const std::string& path : taken_)
    if (const auto id = idOf(path)) files.emplace(*id, &path);
  for (const std::string& path : outputs) {
    const auto id = idOf(path);
    const auto found = id ? files.find(*id) : files.end();
    if (found != files.end()) refuseTaken(path, *found->second);
  }
}

const OutputLock& OutputSet::lockOf(const std::string& path) const {
  const auto found = std::find_if(locks_.begin(), locks_.end(),
                                  [&](const auto& lock) { return lock->path() == path; });
  assert(found != locks_.end());
  return **found;
}

bool OutputSet::hasStandardOutput() const {
  return std::any_of(locks_.begin(), locks_.end(),
                     [](const auto& lock) { return isStandardOutput(lock->path()); });
}

OutputFile* OutputSet::open(const std::string& path) {
  if (path.empty()) return nullptr;
  reserve(path);
  files_.push_back(std::make_unique<OutputFile>(path));
  return files_.back().get();
}

void OutputSet::publish() {
  for (const auto& file : files_) file->finish();
  for (const auto& file : files_) file->publish();
}

}  // namespace fcl_ccd

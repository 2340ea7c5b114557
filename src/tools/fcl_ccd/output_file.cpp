// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;

/// Names of the temporary files that exist, where a signal handler may read them: a slot
/// is in use while its first character is not 0, and that one is written last.
struct TemporaryList {
  static constexpr std::size_t kSlots = 8;
  static constexpr std::size_t kLongest = 4096;
  char names[kSlots][kLongest]{};

  void add(const std::string& name) {
    if (name.size() >= kLongest) return;
    for (char(&slot)[kLongest] : names) {
      if (slot[0] != '\0') continue;
      std::memcpy(slot + 1, name.c_str() + 1, name.size());
      std::atomic_signal_fence(std::memory_order_seq_cst);
      slot[0] = name[0];
      return;
    }
  }

  void remove(const std::string& name) {
    for (char(&slot)[kLongest] : names)
      if (name == slot) slot[0] = '\0';
  }
};

TemporaryList temporaries;

/// @brief The standard stream (its descriptor) that writes to this file, or -1. It has a
/// position of its own there, which a second opening of the file would not follow.
int standardStream(const struct stat& file) {
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat stream {};
    if (fstat(descriptor, &stream) == 0 && stream.st_dev == file.st_dev &&
        stream.st_ino == file.st_ino)
      return descriptor;
  }
  return -1;
}

extern "C" void removeTemporariesAndRaise(int signal_number) {
  for (const auto& name : temporaries.names)
    if (name[0] != '\0') unlink(name);
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path), target_(path) {
  if (path.empty()) fail("cannot write", ENOENT);
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    // A link to a file that does not exist yet.
    std::error_code error;
    const fs::path link = fs::read_symlink(path, error);
    if (!error) target_ = (fs::path(path).parent_path() / link).string();
    openTemporary();
    return;
  }
  if (S_ISDIR(status.st_mode)) fail("cannot write", EISDIR);
  const int stream = standardStream(status);
  if (stream >= 0) {
    file_ = fdopen(dup(stream), "wb");
    if (file_ == nullptr) fail("cannot write", errno);
  } else if (!S_ISREG(status.st_mode)) {
    file_ = std::fopen(path.c_str(), "wb");
    if (file_ == nullptr) fail("cannot write", errno);
  } else {
    // Renaming would replace a file that its owner protected against writing.
    if (access(path.c_str(), W_OK) != 0) fail("cannot write", errno);
    std::error_code error;
    const fs::path resolved = fs::canonical(path, error);
    if (!error) target_ = resolved.string();
    openTemporary();
    fs::permissions(temporary_, static_cast<fs::perms>(status.st_mode & 07777), error);
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (temporary_.empty()) return;
  std::remove(temporary_.c_str());
  temporaries.remove(temporary_);
}

void OutputFile::openTemporary() {
  const fs::path target(target_);
  constexpr int kAttempts = 100;  // left-overs of processes that had the same id
  for (int i = 0; i < kAttempts; ++i) {
    // Room for the rest in the 255 characters that a name may have.
    const std::string name = "." + target.filename().string().substr(0, 200) + "." +
                             std::to_string(getpid()) + "." + std::to_string(i) + ".tmp";
    const std::string candidate = (target.parent_path() / name).string();
    file_ = std::fopen(candidate.c_str(), "wbx");
    if (file_ != nullptr) {
      temporary_ = candidate;
      temporaries.add(temporary_);
      return;
    }
    if (errno != EEXIST) fail("cannot write", errno);
  }
  fail("cannot write", EEXIST);
}

void OutputFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    fail("writing failed", errno);
}

void OutputFile::finish() {
  const bool flushed = std::fflush(file_) == 0;
  const int flush_error = errno;
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  if (!flushed) fail("writing failed", flush_error);
  if (!closed) fail("writing failed", errno);
}

void OutputFile::publish() {
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot write", errno);
  temporaries.remove(temporary_);
  temporary_.clear();
}

void OutputFile::fail(const std::string& what, int error) const {
  throw std::runtime_error(path_ + ": " + what + ": " +
                           std::generic_category().message(error));
}

void removeTemporariesOnSignal() {
  // A file that grows too large is an error of writing.
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    const auto previous = std::signal(signal_number, removeTemporariesAndRaise);
    if (previous == SIG_IGN) std::signal(signal_number, SIG_IGN);
  }
}

}  // namespace fcl_ccd

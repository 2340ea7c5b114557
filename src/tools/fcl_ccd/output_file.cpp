// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "write_error.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;

/// Names of the existing temporary files, for the signal handler. A slot is in use if its
/// first character is not 0. The first character is written last.
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

int standardStream(const struct stat& file) {
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat stream {};
    if (fstat(descriptor, &stream) == 0 && stream.st_dev == file.st_dev &&
        stream.st_ino == file.st_ino)
      return descriptor;
  }
  return -1;
}

/// @brief The target of a link to a file that does not exist yet; for any other path, the
/// path itself.
std::string targetOf(const std::string& path) {
  std::error_code error;
  const fs::path link = fs::read_symlink(path, error);
  return error ? path : (fs::path(path).parent_path() / link).string();
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
  if (isStandardOutput(path)) {
    path_ = nameOfOutput(path);
    file_ = fdopen(dup(STDOUT_FILENO), "wb");
    if (file_ == nullptr) fail("cannot write", errno);
    return;
  }
  if (stat(path.c_str(), &status) != 0) {
    target_ = targetOf(path);
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
    // Renaming would replace a file that its owner has protected against writing.
    if (access(path.c_str(), W_OK) != 0) fail("cannot write", errno);
    std::error_code error;
    const fs::path resolved = fs::canonical(path, error);
    if (!error) target_ = resolved.string();
    openTemporary();
    if (fchmod(fileno(file_), status.st_mode & 07777) != 0) fail("cannot write", errno);
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (temporary_.empty()) return;
  std::remove(temporary_.c_str());
  temporaries.remove(temporary_);
}

void OutputFile::openTemporary() {
  if (openNameless()) return;
  makeTemporary([this](const char* name) {
    file_ = std::fopen(name, "wbx");
    return file_ != nullptr;
  });
}

bool OutputFile::openNameless() {
#ifdef O_TMPFILE
  const fs::path folder = fs::path(target_).parent_path();
  constexpr mode_t kReadWriteForAll = 0666;  // minus the umask
  const int file = open(folder.empty() ? "." : folder.c_str(),
                        O_TMPFILE | O_RDWR | O_CLOEXEC, kReadWriteForAll);
  if (file < 0) return false;
  // Without /proc it cannot get a name later.
  is_nameless_ = access(("/proc/self/fd/" + std::to_string(file)).c_str(), F_OK) == 0;
  if (is_nameless_) file_ = fdopen(file, "wb");
  if (file_ == nullptr) close(file);
#endif
  return is_nameless_ && file_ != nullptr;
}

void OutputFile::nameTemporary() {
  const std::string handle = "/proc/self/fd/" + std::to_string(fileno(file_));
  makeTemporary([&](const char* name) {
    return linkat(AT_FDCWD, handle.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
  });
  is_nameless_ = false;
}

template <typename Make>
void OutputFile::makeTemporary(Make make) {
  const fs::path target(target_);
  constexpr int kAttempts = 100;  // files may be left from processes that had the same id
  for (int i = 0; i < kAttempts; ++i) {
    // A name has at most 255 characters: leaves room for the rest of it.
    const std::string name = "." + target.filename().string().substr(0, 200) + "." +
                             std::to_string(getpid()) + "." + std::to_string(i) + ".tmp";
    const std::string candidate = (target.parent_path() / name).string();
    if (make(candidate.c_str())) {
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
  if (flushed && is_nameless_) nameTemporary();
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
  throw WriteError(path_, what, error);
}

void requireWritable(const std::string& path) {
  const auto refuse = [&](int error) {
    throw WriteError(nameOfOutput(path), "cannot write", error);
  };
  if (isStandardOutput(path)) {
    const int flags = fcntl(STDOUT_FILENO, F_GETFL);
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) refuse(EBADF);
    return;
  }
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) refuse(EISDIR);
    if (standardStream(status) < 0 && access(path.c_str(), W_OK) != 0) refuse(errno);
    return;
  }
  const fs::path parent = fs::path(targetOf(path)).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  if (stat(folder.c_str(), &status) != 0) refuse(errno);
  if (!S_ISDIR(status.st_mode)) refuse(ENOTDIR);
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse(errno);
}

int standardStreamOf(const std::string& path) {
  if (isStandardOutput(path)) return STDOUT_FILENO;
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? standardStream(status) : -1;
}

void removeTemporariesOnSignal() {
  // A file that grows too large becomes an error of writing.
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    const auto previous = std::signal(signal_number, removeTemporariesAndRaise);
    if (previous == SIG_IGN) std::signal(signal_number, SIG_IGN);
  }
}

}  // namespace fcl_ccd

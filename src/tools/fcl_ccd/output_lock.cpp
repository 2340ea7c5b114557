// SPDX-License-Identifier: BSD-3-Clause
#include "output_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "output_file.h"

namespace fcl_ccd {
namespace {

namespace fs = std::filesystem;

bool isTaken(int file) {
  return flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

/// A short text for a path: equal for equal files, also before they exist. Two files of
/// one folder have the same text with a probability of 2^-64.
std::string textOf(const std::string& path) {
  std::error_code error;
  const fs::path file = fs::weakly_canonical(fs::absolute(path, error), error);
  struct stat folder {};
  if (error || stat(file.parent_path().c_str(), &folder) != 0) return "";
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const char c : file.filename().string())
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return "fcl-ccd output " + std::to_string(folder.st_dev) + ' ' +
         std::to_string(folder.st_ino) + ' ' + std::to_string(hash);
}

}  // namespace

OutputLock::OutputLock(std::string path) : path_(std::move(path)) {
  if (isStandardOutput(path_)) return;
  struct stat status {};
  const bool is_there = stat(path_.c_str(), &status) == 0;
  if (is_there && (!S_ISREG(status.st_mode) || standardStreamOf(path_) >= 0)) return;
  lockName();
  if (!is_there) return;
  // A network file system may lock only files that are open for writing.
  file_ = open(path_.c_str(), O_RDWR | O_CLOEXEC);
  if (file_ < 0 || !isTaken(file_)) return;
  release();
  refuse();
}

OutputLock::~OutputLock() { release(); }

void OutputLock::lock(int file) const {
  // A lock belongs to an opened file: the process would wait for itself.
  if (isOfFile(file)) return;
  if (isTaken(file)) refuse();
}

bool OutputLock::isOfFile(int file) const {
  struct stat mine {
  }, other{};
  return file_ >= 0 && fstat(file_, &mine) == 0 && fstat(file, &other) == 0 &&
         mine.st_dev == other.st_dev && mine.st_ino == other.st_ino;
}

void OutputLock::lockName() {
#ifdef __linux__
  const std::string text = textOf(path_);
  sockaddr_un address{};
  // An abstract name begins with a zero.
  if (text.empty() || text.size() >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, text.data(), text.size());
  const auto size =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  name_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (name_ < 0) return;
  const bool is_taken =
      bind(name_, reinterpret_cast<const sockaddr*>(&address), size) != 0 &&
      errno == EADDRINUSE;
  if (!is_taken) return;
  release();
  refuse();
#endif
}

void OutputLock::refuse() const {
  throw std::runtime_error(path_ +
                           ": cannot write: another run of fcl-ccd is writing it. Wait "
                           "for its end, or name another file");
}

void OutputLock::release() noexcept {
  for (int* descriptor : {&file_, &name_}) {
    if (*descriptor >= 0) close(*descriptor);
    *descriptor = -1;
  }
}

}  // namespace fcl_ccd

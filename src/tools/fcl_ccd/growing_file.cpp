// SPDX-License-Identifier: BSD-3-Clause
#include "growing_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <stdexcept>

#include "output_file.h"
#include "write_error.h"

namespace fcl_ccd {

GrowingFile::GrowingFile(const OutputLock& lock, std::uint64_t kept_size)
    : path_(lock.path()), size_(kept_size), committed_(kept_size) {
  const int stream = standardStreamOf(path_);
  constexpr mode_t kReadWriteForAll = 0666;  // minus the umask
  // Appending: text never goes behind the end of a file that another program has cut.
  file_ = stream >= 0 ? dup(stream)
                      : open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC,
                             kReadWriteForAll);
  struct stat status {};
  if (file_ < 0 || fstat(file_, &status) != 0)
    throw WriteError(path_, "cannot write", errno);
  is_regular_ = S_ISREG(status.st_mode) && stream < 0;
  path_ = nameOfOutput(path_);
  if (!is_regular_) return;
  try {
    lock.lock(file_);
  } catch (const std::runtime_error& error) {
    throw WriteError(error.what());
  }
  // It would become longer, with bytes that nobody wrote.
  if (fstat(file_, &status) == 0 && status.st_size < static_cast<off_t>(kept_size))
    throw WriteError(path_ + ": was changed by another program while this run read it");
  if (ftruncate(file_, static_cast<off_t>(kept_size)) != 0)
    throw WriteError(path_, "cannot write", errno);
}

GrowingFile::~GrowingFile() {
  if (file_ >= 0) close(file_);
}

void GrowingFile::append(std::string_view bytes) {
  assert(file_ >= 0 && committed_ <= size_);
  // A line that another program has cut would go on with this text.
  if (size_ == committed_) requireIntact();
  while (!bytes.empty()) {
    const ssize_t written = write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw WriteError(path_, "writing failed", errno);
    size_ += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void GrowingFile::requireIntact() {
  if (!is_regular_) return;
  struct stat opened {
  }, named{};
  if (fstat(file_, &opened) != 0) throw WriteError(path_, "writing failed", errno);
  const bool is_named = stat(path_.c_str(), &named) == 0;
  const char* change = nullptr;
  if (!is_named)
    change = "deleted or moved";
  else if (named.st_dev != opened.st_dev || named.st_ino != opened.st_ino)
    change = "replaced";
  else if (static_cast<std::uint64_t>(opened.st_size) != size_)
    change = "changed";
  if (change == nullptr) return;
  is_lost_ = true;
  throw WriteError(path_ + ": was " + change +
                   " by another program while this run wrote it");
}

void GrowingFile::commit() {
  requireIntact();
  committed_ = size_;
}

void GrowingFile::rollBack() noexcept {
  if (!is_regular_ || size_ == committed_ || file_ < 0) return;
  struct stat status {};
  if (fstat(file_, &status) != 0) return;
  // A file that another program has cut must not become longer again, and one that was
  // made longer stays.
  const auto now = static_cast<std::uint64_t>(status.st_size);
  if (now > size_ || now <= committed_) return;
  if (ftruncate(file_, static_cast<off_t>(committed_)) == 0) size_ = committed_;
}

void GrowingFile::finish() {
  // A network file system may report only now that its disk is full.
  if (is_regular_ && fsync(file_) != 0) throw WriteError(path_, "writing failed", errno);
  requireIntact();
  const bool closed = close(file_) == 0;
  file_ = -1;
  if (!closed) throw WriteError(path_, "writing failed", errno);
}

}  // namespace fcl_ccd

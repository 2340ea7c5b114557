// SPDX-License-Identifier: BSD-3-Clause
#include "growing_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "output_file.h"
#include "write_error.h"

namespace fcl_ccd {

GrowingFile::GrowingFile(const std::string& path, std::uint64_t kept_size)
    : path_(path), size_(kept_size), committed_(kept_size) {
  const int stream = standardStreamOf(path);
  constexpr mode_t kReadWriteForAll = 0666;  // minus the umask
  file_ = stream >= 0
              ? dup(stream)
              : open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, kReadWriteForAll);
  struct stat status {};
  if (file_ < 0 || fstat(file_, &status) != 0)
    throw WriteError(path, "cannot write", errno);
  is_regular_ = S_ISREG(status.st_mode) && stream < 0;
  if (!is_regular_) return;
  const auto size = static_cast<off_t>(kept_size);
  if (ftruncate(file_, size) != 0 || lseek(file_, size, SEEK_SET) != size)
    throw WriteError(path, "cannot write", errno);
}

GrowingFile::~GrowingFile() {
  if (file_ >= 0) close(file_);
}

void GrowingFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw WriteError(path_, "writing failed", errno);
    size_ += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void GrowingFile::rollBack() noexcept {
  if (!is_regular_ || size_ == committed_) return;
  const auto size = static_cast<off_t>(committed_);
  if (ftruncate(file_, size) == 0 && lseek(file_, size, SEEK_SET) == size)
    size_ = committed_;
}

void GrowingFile::finish() {
  // A network file system may report only now that its disk is full.
  const bool accepted = !is_regular_ || fsync(file_) == 0;
  const int error = errno;
  const bool closed = close(file_) == 0;
  file_ = -1;
  if (!accepted) throw WriteError(path_, "writing failed", error);
  if (!closed) throw WriteError(path_, "writing failed", errno);
}

}  // namespace fcl_ccd

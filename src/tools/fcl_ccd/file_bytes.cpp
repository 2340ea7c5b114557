// SPDX-License-Identifier: BSD-3-Clause
#include "file_bytes.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace fcl_ccd {
namespace {

/// @brief The number of bytes by the file's size; nothing for a pipe.
std::string readAtOnce(std::FILE* file) {
  struct stat status {};
  if (fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file));
  return bytes;
}

}  // namespace

std::string readBytes(const std::string& path) {
  const auto reason = [] { return std::generic_category().message(errno); };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(path.c_str(), "rb"), std::fclose);
  if (file == nullptr) throw std::runtime_error("cannot open: " + reason());
  std::string bytes = readAtOnce(file.get());
  char block[1 << 16];
  while (const std::size_t n = std::fread(block, 1, sizeof block, file.get()))
    bytes.append(block, n);
  if (std::ferror(file.get())) throw std::runtime_error("cannot read: " + reason());
  // The byte order mark that some editors put before text.
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (bytes.compare(0, kByteOrderMark.size(), kByteOrderMark) == 0)
    bytes.erase(0, kByteOrderMark.size());
  if (bytes.empty()) throw std::runtime_error("the file is empty");
  return bytes;
}

std::string readRegularFile(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    throw std::runtime_error("cannot read: it is not a regular file");
  return readBytes(path);
}

}  // namespace fcl_ccd

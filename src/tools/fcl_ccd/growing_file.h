// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_GROWING_FILE_H
#define FCL_CCD_GROWING_FILE_H

#include <cstdint>
#include <string>
#include <string_view>

namespace fcl_ccd {

/// @brief A file that others may read while it grows: what is appended goes to the file
/// at once. All functions but rollBack() throw WriteError.
class GrowingFile {
 public:
  /// @brief Opens or makes the file and cuts it to `kept_size` bytes. What is no regular
  /// file (a device, a pipe, /dev/stdout wherever it leads) is appended to.
  GrowingFile(const std::string& path, std::uint64_t kept_size);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();

  void append(std::string_view bytes);

  /// @brief What was appended so far stays.
  void commit() { committed_ = size_; }

  /// @brief Takes away what was appended after commit(), if it can be taken away.
  void rollBack() noexcept;

  /// @brief Closes the file; returns only if every byte was accepted.
  void finish();

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int file_{-1};
  bool is_regular_{false};
  std::uint64_t size_{0};
  std::uint64_t committed_{0};
};

}  // namespace fcl_ccd

#endif

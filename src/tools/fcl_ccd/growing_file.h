// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_GROWING_FILE_H
#define FCL_CCD_GROWING_FILE_H

#include <cstdint>
#include <string>
#include <string_view>

#include "output_lock.h"

namespace fcl_ccd {

/// @brief A file that other programs may read while it grows: appended text goes to the
/// file at once. All functions but rollBack() throw WriteError.
class GrowingFile {
 public:
  /// @brief Opens or makes the file, locks it, and cuts it to `kept_size` bytes. If it is
  /// not a regular file (a device, a pipe, /dev/stdout wherever it leads), text is
  /// appended to it. "-" is standard output.
  GrowingFile(const OutputLock& lock, std::uint64_t kept_size);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();

  void append(std::string_view bytes);

  /// @brief Keeps the text that has been appended. Throws if the file is no longer the
  /// one that the path names, or has another size than it should: another program has
  /// deleted, replaced or changed it.
  void commit();

  /// @brief Removes the text that was appended after commit(), if this is possible.
  void rollBack() noexcept;

  /// @brief Closes the file. Returns only if every byte was accepted, and the file is as
  /// commit() wants it.
  void finish();

  /// @brief Whether another program has taken away what was written.
  bool isLost() const { return is_lost_; }

 private:
  void requireIntact();

  std::string path_;
  int file_{-1};
  bool is_regular_{false};
  bool is_lost_{false};
  std::uint64_t size_{0};
  std::uint64_t committed_{0};
};

}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OUTPUT_LOCK_H
#define FCL_CCD_OUTPUT_LOCK_H

#include <string>

namespace fcl_ccd {

/// @brief Keeps other runs of the program from an output, until the object or the process
/// ends. A process that is killed leaves no lock.
///
/// There are two locks. The one of the file (flock) also holds between machines that
/// share a folder, if its file system has such locks. The one of the name (an abstract
/// socket of Linux) also holds before the file exists, on one machine. Devices, pipes and
/// standard streams have none.
class OutputLock {
 public:
  /// @throws std::runtime_error that names the path if another run has it. Makes and
  /// changes no file.
  explicit OutputLock(std::string path);
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  ~OutputLock();

  /// @brief Locks a file that was made, or has taken the place of another one, since the
  /// constructor.
  /// @param file  a descriptor of it, which has the lock.
  /// @throws std::runtime_error as the constructor.
  void lock(int file) const;

  const std::string& path() const { return path_; }

 private:
  void lockName();
  bool isOfFile(int file) const;
  [[noreturn]] void refuse() const;
  void release() noexcept;

  std::string path_;
  int file_{-1};  ///< has the lock of the file that was there before
  int name_{-1};  ///< the socket
};

}  // namespace fcl_ccd

#endif

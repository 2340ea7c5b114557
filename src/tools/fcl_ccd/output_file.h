// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OUTPUT_FILE_H
#define FCL_CCD_OUTPUT_FILE_H

#include <cstdio>
#include <string>
#include <string_view>

namespace fcl_ccd {

/// @brief A file that is seen whole or not at all: what is written goes to a temporary
/// file in the same folder, which publish() renames. Whoever writes several files
/// finishes all of them before publishing the first. On Linux the temporary file has no
/// name before finish(), so that nothing is left of it when the program is killed.
///
/// What cannot be renamed over (a device, a pipe, /dev/stdout wherever it leads) is
/// written in place. All functions throw WriteError.
class OutputFile {
 public:
  /// @brief Opens the temporary file, so that a path that cannot be written is refused
  /// before the work is done.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// @brief Removes the temporary file unless it was published.
  ~OutputFile();

  void write(std::string_view bytes);

  /// @brief Closes the file; returns only if every byte was accepted.
  void finish();

  /// @brief Gives the file its name, after finish().
  void publish();

  const std::string& path() const { return path_; }

 private:
  void openTemporary();
  bool openNameless();
  void nameTemporary();
  template <typename Make>
  void makeTemporary(Make make);
  [[noreturn]] void fail(const std::string& what, int error) const;

  std::string path_;       ///< as given
  std::string target_;     ///< where it leads
  std::string temporary_;  ///< empty when written in place, or still nameless
  bool is_nameless_{false};
  std::FILE* file_{nullptr};
};

/// @brief Throws WriteError unless the file can be written, as far as can be seen without
/// changing anything.
void requireWritable(const std::string& path);

/// @brief The standard stream (its descriptor) that writes to this file, or -1. It has a
/// position of its own there, which a second opening of the file would not follow.
int standardStreamOf(const std::string& path);

/// @brief From here on SIGINT, SIGTERM, SIGHUP and SIGPIPE remove the temporary files
/// before they end the program.
void removeTemporariesOnSignal();

}  // namespace fcl_ccd

#endif

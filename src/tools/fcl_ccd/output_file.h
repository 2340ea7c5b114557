// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_OUTPUT_FILE_H
#define FCL_CCD_OUTPUT_FILE_H

#include <cstdio>
#include <string>
#include <string_view>

namespace fcl_ccd {

/// @brief A file that other programs see complete or not at all. The text goes to a
/// temporary file in the same folder, which publish() renames. To write several files,
/// finish all of them before the first is published. On Linux the temporary file has no
/// name before finish(), so that nothing is left of it if the program is killed.
///
/// A file that cannot be replaced (a device, a pipe, /dev/stdout wherever it leads, "-"
/// for standard output) is written in place. All functions throw WriteError.
class OutputFile {
 public:
  /// @brief Opens the temporary file. So an error in the path is found before the work is
  /// done.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// @brief Removes the temporary file if it was not published.
  ~OutputFile();

  void write(std::string_view bytes);

  /// @brief Closes the file. Returns only if every byte was accepted.
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
  std::string target_;     ///< where the path leads, without links
  std::string temporary_;  ///< empty if written in place, or still without a name
  bool is_nameless_{false};
  std::FILE* file_{nullptr};
};

/// @brief Throws WriteError if the file cannot be written, as far as this is known
/// without changing anything.
void requireWritable(const std::string& path);

/// @brief Whether the path stands for standard output: "-". (./- is a file of this name.)
inline bool isStandardOutput(const std::string& path) { return path == "-"; }

/// @brief What messages call an output.
inline std::string nameOfOutput(const std::string& path) {
  return isStandardOutput(path) ? "standard output" : path;
}

/// @brief The descriptor of the standard stream that writes to this file, or -1. The
/// stream has its own position in the file. If the file were opened a second time, it
/// would not follow that position.
int standardStreamOf(const std::string& path);

/// @brief After this call SIGINT, SIGTERM, SIGHUP and SIGPIPE remove the temporary files
/// before they end the program.
void removeTemporariesOnSignal();

}  // namespace fcl_ccd

#endif

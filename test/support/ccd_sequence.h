// SPDX-License-Identifier: BSD-3-Clause
//
// Shared by the tests of the program fcl-ccd on sequences of frames.
#ifndef FCL_CCD_TEST_CCD_SEQUENCE_H
#define FCL_CCD_TEST_CCD_SEQUENCE_H

#include <signal.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "ccd_tool.h"

namespace fcl {
namespace test {

/// @brief The drop of the tip in a frame. It goes through the floor and back, so that
/// some steps have a contact, some begin crossing, and some have neither.
inline double dropOf(std::size_t frame) {
  constexpr std::array<double, 5> kDrops{0, 0.5, 2, 1.5, 0.25};
  return kDrops[frame % kDrops.size()];
}

/// @brief The files that grow with each step.
inline const std::string kOutputs =
    " --contacts c.csv --steps s.jsonl --columns triangles,position,normal";

/// @brief The lines of a page's shell blocks that begin with a word.
inline std::vector<std::string> commandsOf(const fs::path& page,
                                           const std::string& word) {
  std::vector<std::string> commands;
  bool in_commands = false;
  for (const std::string& line : linesOf(readText(page))) {
    if (line.rfind("```", 0) == 0) in_commands = line == "```sh";
    if (in_commands && line.rfind(word, 0) == 0) commands.push_back(line);
  }
  return commands;
}

#ifdef FCL_CCD_TOOL
/// @brief Starts the program with the arguments; the test's folder is its working folder.
inline pid_t start(const fs::path& folder, std::vector<std::string> arguments) {
  // Nothing that waits for a line finds one of the last run.
  for (const char* name : {"out.txt", "err.txt"}) fs::remove(folder / name);
  const pid_t child = fork();
  if (child != 0) return child;
  if (chdir(folder.c_str()) != 0 || std::freopen("out.txt", "w", stdout) == nullptr ||
      std::freopen("err.txt", "w", stderr) == nullptr)
    _exit(99);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  signal(SIGINT, SIG_DFL);
  execv(FCL_CCD_TOOL, argv.data());
  _exit(99);
}
#endif

class CcdSequence : public CcdToolTest {
 protected:
  std::string frameName(std::size_t frame) const {
    return "f/tip" + std::to_string(frame) + ".ply";
  }

  void writeFrame(std::size_t frame) const {
    writeText(path(frameName(frame)),
              toBinaryPly<double>(floorAndTip(dropOf(frame)), false));
  }

  /// @brief Frames f/tip0.ply ...: names without leading zeros.
  void writeFrames(std::size_t count) const {
    fs::create_directory(path("f"));
    for (std::size_t frame = 0; frame < count; ++frame) writeFrame(frame);
  }

  /// @brief Runs the program, returns the contents of c.csv and s.jsonl, and removes
  /// them.
  std::pair<std::string, std::string> outputsOf(const std::string& arguments) const {
    const Outcome outcome = run(arguments + kOutputs);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return takeOutputs();
  }

  /// @brief The files that the pages of the manual name.
  void writeFramesOfThePages() const {
    writeFrames(12);
    fs::create_directory(path("frames"));
    for (int frame = 0; frame < 12; ++frame) {
      std::string number = std::to_string(frame);
      number.insert(0, 4 - number.size(), '0');
      fs::copy(path(frameName(static_cast<std::size_t>(frame))),
               path("frames/frame_" + number + ".ply"));
    }
    writeText(path("body.obj"), toObj(edgeAlongX()));
  }

  std::pair<std::string, std::string> takeOutputs() const {
    std::pair<std::string, std::string> outputs{readText(path("c.csv")),
                                                readText(path("s.jsonl"))};
    fs::remove(path("c.csv"));
    fs::remove(path("s.jsonl"));
    return outputs;
  }
};

}  // namespace test
}  // namespace fcl

#endif

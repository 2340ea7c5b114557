// SPDX-License-Identifier: BSD-3-Clause
//
// A cloth falls over a spinning ball and folds. Each step of the simulation asks for the
// contacts on the way, and examples/contact_response.h answers them.
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cloth_over_ball.h"
#include "demo_pictures.h"
#include "demo_table.h"
#include "output_file.h"

namespace {

using namespace fcl::test;

const char kUsage[] =
    "usage: fcl_ccd_demo [OUTPUT_FOLDER] [--frames N] [--resolution N] [--states]\n"
    "                    [--from STATE]\n"
    "A cloth of 2 x resolution^2 triangles (default 104: 21632) falls over a spinning\n"
    "ball for N frames (default 30). Writes frames.png, busiest.png, busiest.ply,\n"
    "last.ply and frames.csv to OUTPUT_FOLDER (default: the current one).\n"
    "--states also writes the state after each frame, such as 12.state. --from goes on\n"
    "from such a file, N frames more, to the same bits.\n";

struct DemoOptions {
  std::filesystem::path folder{"."};
  int frames{30};
  int resolution{104};
  bool keeps_states{false};
  std::string first_state;  // a file, or none
  bool help{false};
};

/// The command line is wrong: exit code 2 and the usage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

int parseNumber(const std::string& option, const char* text, int lo, int hi) {
  const std::string range =
      " needs a number from " + std::to_string(lo) + " to " + std::to_string(hi);
  if (text == nullptr) throw UsageError(option + range);
  int number = 0;
  const char* end = text + std::strlen(text);
  const auto parsed = std::from_chars(text, end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end || number < lo || number > hi)
    throw UsageError(option + range + ", not '" + text + "'");
  return number;
}

DemoOptions parseOptions(int argc, char** argv) {
  DemoOptions options;
  bool has_folder = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") {
      options.help = true;
    } else if (argument == "--frames") {
      options.frames = parseNumber(argument, argv[++i], 1, 100000);
    } else if (argument == "--resolution") {
      options.resolution = parseNumber(argument, argv[++i], 2, 1000);
    } else if (argument == "--states") {
      options.keeps_states = true;
    } else if (argument == "--from") {
      if (argv[++i] == nullptr) throw UsageError("--from needs a file");
      options.first_state = argv[i];
    } else if (argument.empty() || argument[0] == '-' || has_folder) {
      throw UsageError("unexpected argument '" + argument + "'");
    } else {
      options.folder = argument;
      has_folder = true;
    }
  }
  return options;
}

/// One line that is rewritten on a terminal; elsewhere a line now and then.
class Progress {
 public:
  explicit Progress(int frames) : frames_(frames), is_terminal_(isatty(STDERR_FILENO)) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (is_open_) std::fputc('\n', stderr);
  }

  void show(int frame, const DemoFrame& report) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - begin_).count();
    const bool is_due = is_terminal_ || seconds >= next_ || frame == frames_;
    if (!is_due) return;
    next_ = seconds + 5;
    is_open_ = is_terminal_;
    std::fprintf(stderr, "%sframe %d of %d: %zu contacts, %.1f s%s",
                 is_terminal_ ? "\r\033[K" : "", frame, frames_, report.contacts.size(),
                 seconds, is_open_ ? "" : "\n");
    std::fflush(stderr);
  }

 private:
  int frames_;
  bool is_terminal_;
  bool is_open_{false};  // a line waits for its end
  double next_{0};
  std::chrono::steady_clock::time_point begin_{std::chrono::steady_clock::now()};
};

/// What a run leaves behind.
struct Run {
  std::vector<DemoFrame> frames;  // without their contacts
  std::vector<Snapshot> sheet;    // up to four frames, the last one included
  Snapshot busiest;
};

void writeFile(const std::filesystem::path& path, const std::string& bytes) {
  fcl_ccd::OutputFile file(path.string());
  file.write(bytes);
  file.finish();
  file.publish();
}

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

Run simulate(ClothOverBall& scene, const DemoOptions& options) {
  Run run;
  Progress progress(options.frames);
  for (int i = 1; i <= options.frames; ++i) {
    DemoFrame frame = scene.advanceFrame();
    if (options.keeps_states)
      writeFile(options.folder / (std::to_string(scene.frame()) + ".state"),
                scene.state());
    const Snapshot snapshot = takeSnapshot(scene, frame);
    // The last of each third and half way between: 1/3, 1/2, 2/3, 1.
    for (const int sixth : {2, 3, 4, 6})
      if (i == (options.frames * sixth + 5) / 6 &&
          (run.sheet.empty() || run.sheet.back().frame != snapshot.frame))
        run.sheet.push_back(snapshot);
    if (run.busiest.frame == 0 || snapshot.contacts.size() > run.busiest.contacts.size())
      run.busiest = snapshot;
    progress.show(i, frame);
    frame.contacts = {};
    run.frames.push_back(std::move(frame));
  }
  return run;
}

/// The demo's files, opened before the work so that a folder that cannot be written is
/// noticed at once, and seen only when all of them are complete.
class Files {
 public:
  explicit Files(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    for (const char* name :
         {"frames.png", "busiest.png", "busiest.ply", "last.ply", "frames.csv"})
      files_.emplace_back((folder / name).string());
  }

  void publish(const ClothOverBall& scene, const Run& run) {
    const std::string contents[] = {
        encodePng(drawSheet(scene, run.sheet, 960, 720)),
        encodePng(drawSnapshot(scene, run.busiest, 1600, 1200)),
        encodeSnapshot(scene, run.busiest), encodeSnapshot(scene, run.sheet.back()),
        formatCsv(run.frames)};
    for (std::size_t i = 0; i < files_.size(); ++i) {
      files_[i].write(contents[i]);
      files_[i].finish();
    }
    for (fcl_ccd::OutputFile& file : files_) file.publish();
  }

  void list(const Run& run) const {
    const std::string busiest =
        "frame " + std::to_string(run.busiest.frame) + ", the one with the most contacts";
    const std::string meanings[] = {std::to_string(run.sheet.size()) + " frame(s)",
                                    busiest, busiest + ", as a mesh",
                                    "the last frame, as a mesh", "the table"};
    for (std::size_t i = 0; i < files_.size(); ++i)
      std::printf("%s: %s\n", files_[i].path().c_str(), meanings[i].c_str());
  }

 private:
  std::deque<fcl_ccd::OutputFile> files_;  // not movable
};

/// A cloth that ends on the wrong side of anything means that a contact was missed. Each
/// step looks for crossings at its beginning; the last state is looked at here.
void requireNoCrossing(ClothOverBall& scene, const Run& run) {
  for (const DemoFrame& frame : run.frames)
    if (frame.crossing || frame.unresolved > 0)
      throw std::runtime_error("surfaces cross in frame " + std::to_string(frame.number));
  if (scene.hasCrossing()) throw std::runtime_error("surfaces cross at the end");
}

void demo(const DemoOptions& options) {
  fcl_ccd::removeTemporariesOnSignal();
  Files files(options.folder);
  ClothOverBall scene(options.resolution);
  if (!options.first_state.empty()) scene.setState(readFile(options.first_state));
  std::printf(
      "A cloth of %d triangles falls over a ball: %zu triangles in all, %d frames of %d "
      "steps.\n",
      2 * options.resolution * options.resolution, scene.mesh().triangles.size(),
      options.frames, ClothOverBall::kStepsPerFrame);
  std::fflush(stdout);
  const Run run = simulate(scene, options);
  std::printf("\n%s\n", formatTable(run.frames).c_str());
  files.publish(scene, run);
  files.list(run);
  requireNoCrossing(scene, run);
  std::printf("No step began with surfaces that cross.\n");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const DemoOptions options = parseOptions(argc, argv);
    if (options.help)
      std::fputs(kUsage, stdout);
    else
      demo(options);
    if (std::fflush(stdout) != 0) throw std::runtime_error("cannot write the output");
    return 0;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "fcl_ccd_demo: %s\n%s", error.what(), kUsage);
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_ccd_demo: %s\n", error.what());
    return 1;
  }
}

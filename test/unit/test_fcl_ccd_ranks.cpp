// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the program fcl-ccd with mpirun: the outputs are those of one process, and a run
// whose ranks stop or die can be continued.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <regex>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "ccd_sequence.h"
#include "sanitizer.h"
#include "step_share.h"

namespace {

using namespace fcl::test;

TEST(StepShare, SharesAreAPartOfTheStepsInOrder) {
  for (std::size_t num_ranks = 1; num_ranks <= 5; ++num_ranks)
    for (std::size_t end = 0; end < 50; ++end) {
      constexpr std::size_t kFirst = 3;
      std::vector<int> owners(50, -1);
      for (std::size_t rank = 0; rank < num_ranks; ++rank) {
        const fcl_ccd::StepShare share{kFirst, end, rank, num_ranks};
        for (std::size_t i = 0; i < share.size(); ++i) {
          ASSERT_LT(share[i], end);
          ASSERT_TRUE(share.has(share[i]));
          ASSERT_EQ(owners[share[i]], -1);
          owners[share[i]] = static_cast<int>(rank);
          if (i > 0) {
            ASSERT_LT(share[i - 1], share[i]);
          }
        }
        ASSERT_GE(share[share.size()], end);
      }
      for (std::size_t step = 0; step < 50; ++step)
        ASSERT_EQ(owners[step] >= 0, step >= kFirst && step < end);
    }
}

#ifdef FCL_CCD_USE_MPI
constexpr const char* kTool = FCL_CCD_TOOL;

/// @brief A run's files and table, without times.
struct Results {
  std::string contacts, steps, json, painted, table;

  bool operator==(const Results& other) const {
    return contacts == other.contacts && steps == other.steps && json == other.json &&
           painted == other.painted && table == other.table;
  }
};

class CcdRanks : public CcdSequence {
 protected:
  void SetUp() override {
    CcdSequence::SetUp();
    const auto set = [](const char* name, const char* value) { setenv(name, value, 1); };
    // What mpirun needs as root, and with more ranks than cores.
    set("OMPI_ALLOW_RUN_AS_ROOT", "1");
    set("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    set("OMPI_MCA_rmaps_base_oversubscribe", "1");                   // OpenMPI 4
    set("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe");  // OpenMPI 5
    // One machine, whose ranks in a container may not read each other's memory.
    set("OMPI_MCA_pml", "ob1");
    set("OMPI_MCA_btl", "self,vader");
    set("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
    setSecondsToEnd("0");
    // OpenMPI keeps memory until its end.
    const char* options = std::getenv("ASAN_OPTIONS");
    set("ASAN_OPTIONS",
        ((options ? std::string(options) + ':' : "") + "detect_leaks=0").c_str());
  }

  /// @brief The time that mpirun gives ranks to end when one has died or ends with a code
  /// that is not 0. It waits for all of it. Its default is 1.
  static void setSecondsToEnd(const char* seconds) {
    setenv("OMPI_MCA_odls_base_sigkill_timeout", seconds, 1);
    setenv("PRTE_MCA_odls_base_sigkill_timeout", seconds, 1);
  }

  static std::string onRanks(int count, const std::string& arguments) {
    return "mpirun -n " + std::to_string(count) + " '" + kTool + "' " + arguments;
  }

  /// @brief A frame with so many triangles that its picture is a large message.
  void writeLargeFrame(std::size_t frame) const {
    Mesh mesh = floorAndTip(dropOf(frame));
    for (int i = 0; i < 2000; ++i) {
      const double x = 10.0 * i;
      const int begin = static_cast<int>(mesh.vertices.size());
      for (const double z : {10.0, 11.0, 12.0}) mesh.vertices.push_back({x + z, x, z});
      mesh.triangles.push_back({begin, begin + 1, begin + 2});
    }
    writeText(path(frameName(frame)), toBinaryPly<float>(mesh, false));
  }

  Results resultsOf(const std::string& command) const {
    const Outcome outcome = runShell(command + kOutputs + " --json r.json --paint p.ply");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    Results results;
    std::tie(results.contacts, results.steps) = takeOutputs();
    results.json = std::regex_replace(readText(path("r.json")),
                                      std::regex("\"ms\":\\{[^}]*\\}"), "");
    results.painted = readText(path("p.ply"));
    // The time is the number with three decimals.
    results.table = std::regex_replace(
        outcome.out, std::regex(" *[0-9]+\\.[0-9]{3}  |slowest.*\n"), "");
    for (const char* name : {"r.json", "p.ply"}) fs::remove(path(name));
    return results;
  }
};

TEST_F(CcdRanks, GiveTheBytesOfOneProcess) {
  fs::create_directory(path("f"));
  // So many that the eighth rank has steps.
  constexpr std::size_t kSteps = 7 * fcl_ccd::StepShare::kBlock + 2;
  for (std::size_t frame = 0; frame <= kSteps; ++frame) writeLargeFrame(frame);
  const Results one = resultsOf(std::string("'") + kTool + "' run f --jobs 1");
  EXPECT_EQ(linesOf(one.steps).size(), 1 + kSteps + 1);
  // The head, the steps, and a summary of four lines.
  EXPECT_EQ(linesOf(one.table).size(), 1 + kSteps + 4) << one.table;
  EXPECT_GT(one.painted.size(), 100'000u);
  for (const int count : {2, 3, 8})
    EXPECT_TRUE(resultsOf(onRanks(count, "run f")) == one) << count;
  EXPECT_TRUE(resultsOf(onRanks(4, "run f --jobs 2")) == one);
  // Ranks without a step.
  const Results step = resultsOf(std::string("'") + kTool + "' run f --end 1");
  EXPECT_TRUE(resultsOf(onRanks(3, "run f --end 1")) == step);
}

TEST_F(CcdRanks, ABadFrameLeavesTheStepsBefore) {
  writeFrames(12);
  const auto whole = outputsOf("run f");
  Mesh bad = floorAndTip(dropOf(8));
  bad.vertices[4][1] = HUGE_VAL;
  writeText(path(frameName(8)), toBinaryPly<double>(bad, false));
  // Step 7 is of rank 1.
  const Outcome outcome = runShell(onRanks(3, "run f --json r.json" + kOutputs));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("fcl-ccd: rank 1 on "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("f/tip8.ply: vertex 4"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("stopped after 7 of 11 steps; they are in c.csv and s.jsonl."
                             " --resume continues from there"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(linesOf(readText(path("s.jsonl"))).size(), 8u);
  EXPECT_EQ(whole.first.rfind(readText(path("c.csv")), 0), 0u);
  EXPECT_NE(readText(path("r.json")).find("\"complete\":false"), std::string::npos);
  EXPECT_EQ(files(), (std::set<std::string>{"c.csv", "f", "r.json", "s.jsonl"}));
  writeFrame(8);
  EXPECT_EQ(runShell(onRanks(2, "run f --resume" + kOutputs)).exit_code, 0);
  EXPECT_EQ(takeOutputs(), whole);
}

TEST_F(CcdRanks, AHalfWrittenLastFrameLeavesTheStepsBefore) {
  writeFrames(12);
  const auto whole = outputsOf("run f");
  const std::string last = readText(path(frameName(11)));
  writeText(path(frameName(11)), last.substr(0, 300));
  const Outcome outcome = runShell(onRanks(3, "run f" + kOutputs));
  EXPECT_EQ(outcome.exit_code, 6) << outcome.err;
  EXPECT_NE(outcome.err.find("f/tip11.ply: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("stopped after 10 of 11 steps"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(linesOf(readText(path("s.jsonl"))).size(), 11u);
  writeText(path(frameName(11)), last);
  EXPECT_EQ(runShell(onRanks(2, "run f --resume" + kOutputs)).exit_code, 0);
  EXPECT_EQ(takeOutputs(), whole);
}

TEST_F(CcdRanks, AnOutputThatCannotBeWrittenEndsAllRanks) {
  writeFrames(12);
  const Outcome outcome =
      runShell(onRanks(2, "run f --contacts /dev/full --steps s.jsonl"));
  EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("/dev/full: writing failed"), std::string::npos);
}

// Each cause is told once, by rank 0.
TEST_F(CcdRanks, RefuseBeforeTheFirstStep) {
  writeFrames(4);
  const auto expectRefused = [&](const std::string& command, const std::string& cause) {
    SCOPED_TRACE(command);
    const Outcome outcome = runShell(command);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    const std::size_t at = outcome.err.find(cause);
    EXPECT_NE(at, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(cause, at + 1), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), (std::set<std::string>{"f"}));
  };
  expectRefused(onRanks(2, "queries q.csv --kind ee"), "runs in one process");
  expectRefused(onRanks(2, "run f --follow=0" + kOutputs),
                "--follow runs in one process");
  expectRefused(onRanks(1, "run f --steps s.jsonl") + " : -n 1 '" + kTool +
                    "' run f --steps t.jsonl",
                "another command line than on rank 0");
  writeText(path(frameName(2)), toBinaryPly<double>(edgeAlongX(), false));
  expectRefused(onRanks(2, "run f" + kOutputs), "f/tip2.ply: has 3 vertices");
}

TEST_F(CcdRanks, AnOutputOfAnotherRunIsRefused) {
  writeFrames(4);
  const pid_t other =
      start(path(""), {"fcl-ccd", "run", "f", "--follow", "--steps", "s.jsonl"});
  while (linesOf(readText(path("s.jsonl"))).size() < 4 &&
         waitpid(other, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const std::string before = readText(path("s.jsonl"));
  const Outcome outcome = runShell(onRanks(2, "run f --steps s.jsonl"), "out2.txt");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("s.jsonl: cannot write: another run"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(readText(path("s.jsonl")), before);
  kill(other, SIGINT);
  EXPECT_EQ(waitpid(other, nullptr, 0), other);
}

/// @brief The processes that a process has started.
std::vector<pid_t> childrenOf(pid_t parent) {
  std::vector<pid_t> children;
  const fs::path tasks = "/proc/" + std::to_string(parent) + "/task";
  for (const auto& task : fs::directory_iterator(tasks)) {
    std::istringstream list(readText(task.path() / "children"));
    for (pid_t child = 0; list >> child;) children.push_back(child);
  }
  return children;
}

/// @brief A rank of an mpirun, or 0.
pid_t processOf(pid_t mpirun, int rank) {
  const std::string variable = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
  for (const pid_t child : childrenOf(mpirun)) {
    const std::string variables = readText("/proc/" + std::to_string(child) + "/environ");
    if (variables.find(variable + '\0') != std::string::npos) return child;
  }
  return 0;
}

/// @brief Starts a run on three ranks. It has many short steps and would take seconds.
pid_t startLongRun(const fs::path& folder) {
  const pid_t child = fork();
  if (child != 0) return child;
  if (chdir(folder.c_str()) != 0 || std::freopen("out.txt", "w", stdout) == nullptr ||
      std::freopen("err.txt", "w", stderr) == nullptr)
    _exit(99);
  execlp("mpirun", "mpirun", "-n", "3", kTool, "run", "f", "--repeat", "2000",
         "--contacts", "c.csv", "--steps", "s.jsonl", "--columns",
         "triangles,position,normal", static_cast<char*>(nullptr));
  _exit(99);
}

TEST_F(CcdRanks, ARankThatDiesLeavesTheStepsThatWereDone) {
  const std::size_t num_frames = rounds(600);
  writeFrames(num_frames);
  const auto whole = outputsOf("run f");
  constexpr int kMpirun = -1;
  for (const auto& [victim, signal_number] :
       {std::pair{kMpirun, SIGTERM}, {1, SIGKILL}, {0, SIGKILL}}) {
    SCOPED_TRACE(victim);
    setSecondsToEnd(victim == 0 ? "0" : "1");
    const pid_t mpirun = startLongRun(path(""));
    while (linesOf(readText(path("s.jsonl"))).size() < 3 &&
           waitpid(mpirun, nullptr, WNOHANG) == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const pid_t process = victim == kMpirun ? mpirun : processOf(mpirun, victim);
    ASSERT_GT(process, 0) << readText(path("err.txt"));
    kill(process, signal_number);
    int status = 0;
    ASSERT_EQ(waitpid(mpirun, &status, 0), mpirun) << readText(path("err.txt"));
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), victim == kMpirun ? 1 : 128 + SIGKILL);
    const std::string err = readText(path("err.txt"));
    const auto expectTold = [&err](const std::string& text) {
      EXPECT_NE(err.find(text), std::string::npos) << err;
    };
    if (victim != kMpirun) expectTold("process rank " + std::to_string(victim));
    // Rank 0 tells what was done.
    if (victim != 0)
      expectTold("of " + std::to_string(num_frames - 1) +
                 " steps; they are in c.csv and s.jsonl. --resume continues");
    EXPECT_LT(linesOf(readText(path("s.jsonl"))).size(), num_frames);
    EXPECT_EQ(files(),
              (std::set<std::string>{"c.csv", "err.txt", "f", "out.txt", "s.jsonl"}));
    EXPECT_EQ(outputsOf("run f --resume"), whole);
  }
}

// The commands of the page, in its order, in a folder with the files that it names.
TEST_F(CcdRanks, ThePagesCommandsWork) {
  writeFramesOfThePages();
  const std::vector<std::string> commands =
      commandsOf(FCL_CCD_SOURCE_DIR "/doc/sequences.md", "mpirun ");
  const std::string bin = fs::path(kTool).parent_path().string();
  for (const std::string& command : commands) {
    const Outcome outcome = runShell("PATH='" + bin + "':\"$PATH\" " + command);
    EXPECT_EQ(outcome.exit_code, 0) << command << '\n' << outcome.err;
  }
  EXPECT_EQ(commands.size(), 3u);
}

#else

TEST_F(CcdSequence, AProgramWithoutMpiRefusesSeveralRanks) {
  writeFrames(2);
  setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
  expectFailure("run f" + kOutputs, "built without MPI");
  setenv("OMPI_COMM_WORLD_SIZE", "1", 1);
  EXPECT_EQ(run("run f").exit_code, 0);
}

#endif

}  // namespace

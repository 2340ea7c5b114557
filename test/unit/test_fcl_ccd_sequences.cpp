// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the program fcl-ccd on sequences of frames: how frames are named, how runs are
// stopped and continued, and how faces and vertices are changed on the way.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ccd_sequence.h"
#include "csv_rows.h"
#include "frame_list.h"
#include "mesh_files.h"
#include "mesh_io.h"
#include "sanitizer.h"
#include "triangulate.h"

namespace {

using namespace fcl::test;
using fcl_ccd::Triangles;
using fcl_ccd::Vertices;

TEST_F(CcdSequence, ListsFramesInNaturalOrder) {
  for (const char* name : {"f9.ply", "f10.ply", "f1.ply", "f010.ply", ".f2.ply", "n.txt"})
    writeText(path(name), "");
  const auto names = [&](const std::string& word, const fcl_ccd::FrameRange& range) {
    std::vector<std::string> listed;
    for (const std::string& frame : fcl_ccd::listFrames(
             {word.empty() ? path("").string() : path(word).string()}, range))
      listed.push_back(fs::path(frame).filename().string());
    return listed;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names("", {}), (Names{"f1.ply", "f9.ply", "f010.ply", "f10.ply"}));
  EXPECT_EQ(names("*", {}), (Names{"f1.ply", "f9.ply", "f010.ply", "f10.ply", "n.txt"}));
  EXPECT_EQ(names("f?.p*", {}), (Names{"f1.ply", "f9.ply"}));
  EXPECT_EQ(names("", {1, 3, 2}), (Names{"f9.ply", "f10.ply"}));
  EXPECT_EQ(names("f%d.ply", {1, 10, 9}), (Names{"f1.ply", "f10.ply"}));
  EXPECT_EQ(names("f%03d.ply", {}), (Names{"f010.ply"}));
  EXPECT_EQ(names("f1.ply", {}), (Names{"f1.ply"}));
  EXPECT_TRUE(fcl_ccd::isBeforeNaturally("a2b10", "a10b2"));
  EXPECT_FALSE(fcl_ccd::isBeforeNaturally("a10", "a9"));
}

TEST_F(CcdSequence, RefusesListsOfFramesByNameAndCause) {
  writeFrames(3);
  fs::remove(path("f/tip1.ply"));
  fs::create_directory(path("empty"));
  fs::create_directory(path("mixed"));
  writeText(path("mixed/a.obj"), "");
  writeText(path("mixed/a.off"), "");
  expectFailure("run f/tip%d.ply", "f/tip1.ply: is missing");
  expectFailure("run f/tip%d.ply --start 1 --end 2", "f/tip1.ply: is missing");
  expectFailure("run f --end 2", "f: has files 0 to 1, so that --end 2 is too high");
  expectFailure("run f --end 0", "A needs two frames or more");
  expectFailure("run 'f/no*.ply'", "f/no*.ply: no file matches");
  for (const char* word : {"f", "'f/*.ply'", "f/tip%d.ply"})
    for (const std::string option : {"--start -3", "--end -1"})
      expectFailure("run " + (word + (" " + option)),
                    option + ": frames are counted from 0");
  for (const char* word : {"'?/tip*.ply'", "'?/tip%d.ply'", "'?/tip0.ply'"})
    expectFailure("run " + std::string(word), "there is no folder ?. *, ? and [...]");
  expectFailure("run empty", "empty: the folder has no");
  expectFailure("run mixed", "mixed: the folder has .obj and .off files");
  expectFailure("run f/tip0.ply f/tip2.ply --start 0", "named one by one");
  expectFailure("run f/tip0.ply f/tip2.ply --against f f/tip0.ply",
                "A has 2 frames and B 3");
}

TEST_F(CcdSequence, NotesNumbersThatAreMissing) {
  const auto noteOn = [](const std::vector<std::string>& numbers) {
    std::vector<std::string> frames;
    for (const std::string& number : numbers)
      frames.push_back("f2/a" + number + "_9.ply");
    return fcl_ccd::noteOnGaps(frames);
  };
  const std::string missing =
      "f2/a1_9.ply: the next file is f2/a3_9.ply; numbers between them are missing";
  EXPECT_EQ(noteOn({"0", "1", "3", "4"}), missing);
  EXPECT_EQ(noteOn({"0", "1", "3", "4", "5", "8"}),
            missing + ". There are 2 such places");
  EXPECT_NE(noteOn({"000", "010", "020", "040"}), "");
  EXPECT_EQ(noteOn({"8", "9", "10", "11"}), "");
  EXPECT_EQ(noteOn({"0", "10", "20"}), "");
  EXPECT_EQ(noteOn({"0", "7", "11", "30"}), "");  // of no rule
  EXPECT_EQ(noteOn({"1", "2", "1", "2"}), "");
  EXPECT_EQ(noteOn({"a", "b", "c"}), "");
  EXPECT_EQ(noteOn({"", "", ""}), "");

  writeFrames(6);
  fs::remove(path("f/tip4.ply"));
  const Outcome outcome = run("run f");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err,
            "fcl-ccd: f/tip3.ply: the next file is f/tip5.ply; numbers between them are "
            "missing\n");
}

// A pipe would be waited for without end.
TEST_F(CcdSequence, RefusesFramesThatAreNoRegularFiles) {
  const std::string outputs = " --contacts c.csv --steps s.jsonl";
  for (const std::size_t frame : {0u, 2u}) {
    writeFrames(3);
    fs::remove(path(frameName(frame)));
    ASSERT_EQ(mkfifo(path(frameName(frame)).c_str(), 0600), 0);
    expectFailure("run f" + outputs, frameName(frame) + ": cannot read: it is not a");
    expectFailure("run f --weld" + outputs,
                  frameName(frame) + ": cannot read: it is not a");
    fs::remove(path(frameName(frame)));
    fs::create_symlink("/dev/null", path(frameName(frame)));
    expectFailure("run f" + outputs, frameName(frame) + ": cannot read: it is not a");
    fs::remove(path(frameName(frame)));
  }
  writeText(path("a.obj"), toObj(floorAndTip(0)));
  ASSERT_EQ(mkfifo(path("b.obj").c_str(), 0600), 0);
  expectFailure("run a.obj b.obj" + outputs, "b.obj: cannot read: it is not a regular");
  // A link to a regular file is one.
  fs::create_symlink("a.obj", path("c.obj"));
  EXPECT_EQ(run("run a.obj c.obj").exit_code, 0);
}

TEST_F(CcdSequence, NamesThatAreNotUtf8AreWrittenAndResumed) {
  writeFrames(4);
  fs::rename(path("f"), path("f\xff\xfe"));
  const auto whole = outputsOf("run f\xff\xfe --json r.json");
  ASSERT_EQ(linesOf(whole.second).size(), 5u);
  for (const std::string& text : {whole.second, readText(path("r.json"))})
    EXPECT_NE(text.find("\"f\xEF\xBF\xBD\xEF\xBF\xBD/tip0.ply\""), std::string::npos)
        << text;
  const std::vector<std::string> lines = linesOf(whole.second);
  writeText(path("s.jsonl"), lines[0] + '\n' + lines[1] + '\n');
  writeText(path("c.csv"), whole.first);
  EXPECT_EQ(outputsOf("run f\xff\xfe --resume"), whole);
}

// All frames are checked before the first step.
TEST_F(CcdSequence, NamesTheFileThatDiffers) {
  writeFrames(8);
  const auto expectNamed = [&](const std::string& bytes, const std::string& cause) {
    writeText(path(frameName(6)), bytes);
    expectFailure("run f" + kOutputs, "f/tip6.ply: " + cause);
    expectFailure("run f --jobs 1" + kOutputs, "f/tip6.ply: " + cause);
  };
  Mesh turned = floorAndTip(0);
  turned.triangles[1] = {4, 3, 5};
  const std::string whole = toBinaryPly<double>(floorAndTip(0), false);
  expectNamed(toBinaryPly<double>(turned, false),
              "its faces differ from those of f/tip0");
  expectNamed(whole.substr(0, whole.size() - 1), "face 1 of 2");
  expectNamed(toBinaryPly<double>(edgeAlongX(), false), "has 3 vertices, but");
  expectNamed("ply\n", "the file ends before 'end_header'");
  // The same mesh in another form is accepted as the same mesh.
  writeText(path(frameName(6)), toAsciiPly(floorAndTip(dropOf(6))));
  EXPECT_EQ(run("run f").exit_code, 0);
}

TEST_F(CcdSequence, ABodyThatStandsStillIsGivenOnce) {
  writeFrames(6);
  Mesh body = floorAndTip(0);
  body.vertices.resize(3);
  body.triangles.resize(1);
  for (auto& p : body.vertices) p[2] -= 0.25;
  writeText(path("body.obj"), toObj(body));
  std::string repeated = "run f --against";
  for (int i = 0; i < 6; ++i) repeated += " body.obj";
  const auto once = outputsOf("run f --against body.obj"), often = outputsOf(repeated);
  EXPECT_EQ(once.first, often.first);
  EXPECT_NE(once.first.find(",b0,"), std::string::npos);
}

TEST_F(CcdSequence, JobsAndThreadsGiveTheSameBytes) {
  writeFrames(23);
  const auto one = outputsOf("run f --jobs 1");
  EXPECT_GT(linesOf(one.first).size(), 5u);
  EXPECT_EQ(linesOf(one.second).size(), 1u + 22u + 1u);
  for (const char* cores : {"", " --jobs 2", " --jobs 7", " --jobs 0", " --threads 2"})
    EXPECT_EQ(outputsOf("run f" + std::string(cores)), one) << cores;
  const auto any = outputsOf("run f --jobs 1 --query any");
  EXPECT_EQ(outputsOf("run f --jobs 3 --query any"), any);
}

// The tip meets the floor at the origin.
TEST_F(CcdSequence, ColumnsTellTrianglesPositionAndNormal) {
  writeTip();
  ASSERT_EQ(run("run tip0.obj tip1.obj --toc-err 1e-9" + kOutputs).exit_code, 0);
  const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "step,kind,i0,i1,i2,i3,toc_lo,toc_hi,t0,t1,x,y,z,nx,ny,nz,i4");
  const std::vector<std::string> fields = fcl::test::csvFields(lines[1]);
  ASSERT_EQ(fields.size(), 17u);
  EXPECT_EQ(fields[8], "1");
  EXPECT_EQ(fields[9], "0");
  for (const std::size_t i : {10u, 11u, 12u, 13u, 14u})
    EXPECT_NEAR(std::stod(fields[i]), 0, 1e-8) << i;
  EXPECT_NEAR(std::abs(std::stod(fields[15])), 1, 1e-8);
}

// A run may end at any point: its files are then the beginning of the complete ones.
TEST_F(CcdSequence, ResumeEqualsARunThatWasNotStopped) {
  writeFrames(12);
  const auto whole = outputsOf("run f");
  const std::string &contacts = whole.first, &steps = whole.second;
  const auto expectResumed = [&](std::size_t contacts_left, std::size_t steps_left) {
    writeText(path("c.csv"), contacts.substr(0, contacts_left));
    writeText(path("s.jsonl"), steps.substr(0, steps_left));
    const auto resumed = outputsOf("run f --resume");
    EXPECT_EQ(resumed.first, contacts) << contacts_left << ' ' << steps_left;
    EXPECT_EQ(resumed.second, steps) << contacts_left << ' ' << steps_left;
  };
  for (std::size_t i = 0; i <= 16; ++i)
    expectResumed(contacts.size() * i / 16, steps.size() * i / 16);
  expectResumed(0, steps.size());  // a disk that lost the first bytes
  expectResumed(contacts.size() / 2, steps.size());
  expectResumed(contacts.size(), 0);
}

TEST_F(CcdSequence, ResumesEitherFileAlone) {
  writeFrames(12);
  const auto [contacts, steps] = outputsOf("run f");
  for (std::size_t i = 0; i <= 8; ++i) {
    writeText(path("c.csv"), contacts.substr(0, contacts.size() * i / 8));
    const std::string columns = " --columns triangles,position,normal";
    ASSERT_EQ(run("run f --resume --contacts c.csv" + columns).exit_code, 0);
    EXPECT_EQ(readText(path("c.csv")), contacts);
    writeText(path("s.jsonl"), steps.substr(0, steps.size() * i / 8));
    ASSERT_EQ(run("run f --resume --steps s.jsonl").exit_code, 0);
    EXPECT_EQ(readText(path("s.jsonl")), steps);
  }
  takeOutputs();
  // Without a file, the run begins at the start. With more frames than before, it
  // continues with these.
  ASSERT_EQ(run("run f --end 6 --resume" + kOutputs).exit_code, 0);
  ASSERT_EQ(run("run f --resume" + kOutputs).exit_code, 0);
  EXPECT_EQ(takeOutputs(), std::make_pair(contacts, steps));
}

// The rows of a step tell whether all of them were written.
TEST_F(CcdSequence, ResumeCountsContactsOfEveryKind) {
  writeFrames(12);
  const std::string command = "run f --thickness 2.5";
  const auto whole = outputsOf(command);
  EXPECT_NE(whole.first.find("\n0,ve,"), std::string::npos) << whole.first;
  writeText(path("c.csv"), whole.first);
  std::string steps;
  const std::vector<std::string> lines = linesOf(whole.second);
  for (std::size_t i = 0; i < 1 + 6; ++i) steps += lines[i] + '\n';
  writeText(path("s.jsonl"), steps);
  const Outcome outcome = run(command + " --resume" + kOutputs);
  EXPECT_EQ(linesOf(outcome.out)[1].substr(0, 5), "   6 ") << outcome.out;
  EXPECT_EQ(takeOutputs(), whole);
}

// A frame that comes later may part vertices that were joined in the steps before.
TEST_F(CcdSequence, ResumeOfWeldedFramesNeedsAllOfThem) {
  writeFrames(6);
  ASSERT_EQ(run("run f --weld --end 3" + kOutputs).exit_code, 0);
  expectFailure("run f --weld --resume" + kOutputs, "s.jsonl: cannot go on");
  EXPECT_EQ(run("run f --weld --end 3 --resume" + kOutputs).exit_code, 0);
}

// The JSON report has the steps of the last run, and a summary of all.
TEST_F(CcdSequence, JsonAfterResumeSummarisesAllSteps) {
  writeFrames(12);
  const auto jsonLinesOf = [&](const std::string& arguments) {
    EXPECT_EQ(run(arguments + " --json r.json" + kOutputs).exit_code, 0);
    return linesOf(std::regex_replace(readText(path("r.json")),
                                      std::regex("\"ms\":\\{[^}]*\\}"), ""));
  };
  const std::vector<std::string> whole = jsonLinesOf("run f");
  ASSERT_EQ(whole.size(), 1u + 11u + 2u);
  ASSERT_EQ(run("run f --end 7" + kOutputs).exit_code, 0);
  std::vector<std::string> expected{whole[0]};
  expected.insert(expected.end(), whole.begin() + 8, whole.end());
  EXPECT_EQ(jsonLinesOf("run f --resume"), expected);
  EXPECT_NE(expected.back().find("\"steps\":11"), std::string::npos);
}

TEST_F(CcdSequence, ResumeRefusesWhatAnotherRunWrote) {
  writeFrames(6);
  ASSERT_EQ(run("run f" + kOutputs).exit_code, 0);
  const std::string contacts = readText(path("c.csv")), steps = readText(path("s.jsonl"));
  expectFailure("run f --resume --contacts c.csv", "c.csv: cannot go on");
  expectFailure("run f --resume --query first" + kOutputs, "s.jsonl: cannot go on");
  expectFailure("run f --resume --stride 2" + kOutputs,
                "s.jsonl: step 0 was of other frames");
  expectFailure("run f --resume --end 3" + kOutputs, "s.jsonl: step 3 was of other");
  expectFailure("run f --resume --contacts f/../c.csv --steps c.csv", "also given as");
  writeText(path("n.jsonl"), linesOf(steps)[0] + "\n{\"step\":1}\n");
  expectFailure("run f --resume --steps n.jsonl", "is not step 0");
  // Lines of an older form: with another head, and with this one.
  const std::string without = ". Leave out --resume to overwrite";
  for (const std::string part : {"\"format\":4,", ",\"crossing\":0", "\"vf\":0"}) {
    std::string old = steps;
    const std::size_t at = old.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    old.replace(at, part.size(), part[1] == 'v' ? "\"vf\":[]" : "");
    writeText(path("n.jsonl"), old);
    expectFailure("run f --resume --steps n.jsonl",
                  part[1] == 'f' ? "written with other options or by another" : without);
  }
  EXPECT_EQ(readText(path("c.csv")), contacts);
  EXPECT_EQ(readText(path("s.jsonl")), steps);
}

TEST_F(CcdSequence, ABadFrameLeavesTheStepsBefore) {
  writeFrames(12);
  const auto whole = outputsOf("run f");
  Mesh bad = floorAndTip(dropOf(7));
  bad.vertices[4][1] = HUGE_VAL;  // no check of the layout sees it
  writeText(path(frameName(7)), toBinaryPly<double>(bad, false));
  for (const char* jobs : {" --jobs 1", " --jobs 3"}) {
    const Outcome outcome = run("run f --json r.json --paint p.ply" + kOutputs + jobs);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_NE(outcome.err.find("f/tip7.ply: vertex 4"), std::string::npos) << outcome.err;
    EXPECT_EQ(linesOf(outcome.err).back(),
              "fcl-ccd: stopped after 6 of 11 steps; they are in c.csv and s.jsonl. "
              "--resume continues from there");
    EXPECT_EQ(linesOf(readText(path("s.jsonl"))).size(), 7u);
    EXPECT_EQ(whole.first.rfind(readText(path("c.csv")), 0), 0u);
    EXPECT_NE(readText(path("r.json")).find("\"complete\":false"), std::string::npos);
    // The first contact is in step 1.
    EXPECT_EQ(files(),
              (std::set<std::string>{"c.csv", "f", "p.ply", "r.json", "s.jsonl"}));
    fs::remove(path("r.json"));
    fs::remove(path("p.ply"));
  }
  writeFrame(7);
  EXPECT_EQ(outputsOf("run f --resume"), whole);
}

// A file that may not grow simulates a full disk.
TEST_F(CcdSequence, AFullDiskLeavesWholeSteps) {
  writeFrames(40);
  const auto whole = outputsOf("run f");
  ASSERT_GT(whole.second.size(), 4096u);
  const std::string command = "cd '" + path("").string() + "' && ulimit -f 8 && '" +
                              FCL_CCD_TOOL "' run f" + kOutputs + " >out.txt 2>err.txt";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 4);
  const std::string error = readText(path("err.txt"));
  EXPECT_NE(error.find("s.jsonl: writing failed"), std::string::npos) << error;
  const std::string steps = readText(path("s.jsonl")), contacts = readText(path("c.csv"));
  EXPECT_EQ(steps.back(), '\n');
  EXPECT_EQ(contacts.back(), '\n');
  EXPECT_EQ(whole.second.rfind(steps, 0), 0u);
  EXPECT_EQ(whole.first.rfind(contacts, 0), 0u);
  EXPECT_EQ(outputsOf("run f --resume"), whole);
}

/// @brief Starts a run, or continues it, and kills it when the list of steps has some
/// lines and then some time is over.
/// @param repeat  each step is done so many times
/// @return the exit status
int killRun(const fs::path& folder, int signal_number, const char* repeat,
            std::size_t num_lines, std::chrono::microseconds delay) {
  const pid_t child =
      start(folder,
            {"fcl-ccd", "run", "f", "--repeat", repeat, "--contacts", "c.csv", "--steps",
             "s.jsonl", "--columns", "triangles,position,normal", "--json", "r.json"});
  while (linesOf(readText(folder / "s.jsonl")).size() < num_lines) {
    siginfo_t ended{};
    EXPECT_EQ(
        waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT), 0);
    if (ended.si_pid == child) break;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  std::this_thread::sleep_for(delay);
  kill(child, signal_number);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child) << readText(folder / "err.txt");
  return status;
}

TEST_F(CcdSequence, SignalsLeaveTheStepsThatWereDone) {
  writeFrames(60);
  const auto whole = outputsOf("run f");
  // The whole run would take seconds.
  constexpr const char* kRepeat = kHasAddressSanitizer ? "500" : "5000";
  for (const int signal_number : {SIGINT, SIGTERM, SIGKILL}) {
    SCOPED_TRACE(signal_number);
    const int status =
        killRun(path(""), signal_number, kRepeat, 3, std::chrono::microseconds(0));
    std::set<std::string> left{"c.csv", "err.txt", "f", "out.txt", "s.jsonl"};
    if (signal_number == SIGKILL) {
      EXPECT_TRUE(WIFSIGNALED(status));
    } else {
      ASSERT_TRUE(WIFEXITED(status));
      EXPECT_EQ(WEXITSTATUS(status), 128 + signal_number);
      EXPECT_NE(readText(path("err.txt")).find("of 59 steps; they are in c.csv"),
                std::string::npos);
      left.insert("r.json");
    }
    EXPECT_EQ(files(), left);  // no temporary file
    for (const char* name : {"r.json", "out.txt", "err.txt"}) fs::remove(path(name));
    EXPECT_EQ(outputsOf("run f --resume"), whole);
  }
}

/// @brief Sends SIGTERM to a run, and again after some time.
/// @param repeat  each step is done so many times
/// @param delay   from the start of the list of steps to the first signal
/// @return the exit status
int terminateTwice(const fs::path& folder, const char* repeat,
                   std::chrono::milliseconds delay, std::chrono::milliseconds between) {
  const pid_t child = start(folder, {"fcl-ccd", "run", "f", "--repeat", repeat,
                                     "--contacts", "c.csv", "--steps", "s.jsonl"});
  while (linesOf(readText(folder / "s.jsonl")).empty())
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  std::this_thread::sleep_for(delay);
  kill(child, SIGTERM);
  std::this_thread::sleep_for(between);
  kill(child, SIGTERM);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

// timeout(1) sends SIGTERM to the program, then to its group.
TEST_F(CcdSequence, TwoSignalsAtOnceAreOne) {
  writeFrames(20);
  // A step lasts until the second signal has come.
  const char* repeats = kHasAddressSanitizer ? "5000" : "50000";
  for (const int between : {0, 1, 20}) {
    const int status = terminateTwice(path(""), repeats, std::chrono::milliseconds(0),
                                      std::chrono::milliseconds(between));
    ASSERT_TRUE(WIFEXITED(status)) << between;
    EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
    EXPECT_NE(readText(path("err.txt")).find("of 19 steps"), std::string::npos);
    fs::remove(path("s.jsonl"));
  }
}

TEST_F(CcdSequence, ALaterSignalEndsTheProgramAtOnce) {
  writeFrames(3);
  // A step would take minutes. Where the first signal comes before the first step, the
  // program ends without it: then the test tries again, and waits longer.
  int status = 0;
  for (int i = 0; i < 10; ++i) {
    status = terminateTwice(path(""), "100000000", std::chrono::milliseconds(100 * i),
                            std::chrono::seconds(1));
    if (!WIFEXITED(status)) break;
    ASSERT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
    ASSERT_NE(readText(path("err.txt")).find("0 of 2 steps"), std::string::npos);
    fs::remove(path("s.jsonl"));
  }
  ASSERT_TRUE(WIFSIGNALED(status)) << status;
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
}

// The moments are random: before the first step, between two, in the middle of one. Each
// run is killed four times, and goes on each time from what was left.
TEST_F(CcdSequence, RunsThatAreKilledAtTwentyMomentsAreResumed) {
  writeFrames(60);
  const auto whole = outputsOf("run f");
  std::mt19937 random(20);
  std::size_t num_killed = 0, num_reports = 0;
  const std::size_t num_runs = kHasAddressSanitizer ? 1 : 5;
  for (std::size_t run = 0; run < num_runs; ++run) {
    for (int i = 0; i < 4; ++i) {
      const std::size_t num_lines = 15 * static_cast<std::size_t>(i) + random() % 15;
      const std::chrono::microseconds delay(random() % 3000);
      SCOPED_TRACE(std::to_string(num_lines) + " lines, then " +
                   std::to_string(delay.count()) + " us");
      if (WIFSIGNALED(killRun(path(""), SIGKILL, "100", num_lines, delay))) ++num_killed;
      for (const char* name : {"r.json", "out.txt", "err.txt"}) fs::remove(path(name));
      for (const std::string& name : files()) {
        // The instant in which the report gets its name.
        const bool is_report = name.rfind(".r.json.", 0) == 0;
        EXPECT_TRUE(name == "c.csv" || name == "f" || name == "s.jsonl" || is_report)
            << name;
        if (!is_report) continue;
        ++num_reports;
        fs::remove(path(name));
      }
    }
    EXPECT_EQ(outputsOf("run f --resume"), whole) << run;
  }
  EXPECT_GT(num_killed, 2 * num_runs);
  EXPECT_LE(num_reports, 2u);
}

/// @brief Every triangle with three vertices of its own.
Mesh toSoup(const Mesh& mesh) {
  Mesh soup;
  for (const auto& triangle : mesh.triangles) {
    const int begin = static_cast<int>(soup.vertices.size());
    for (const int id : triangle)
      soup.vertices.push_back(mesh.vertices[static_cast<std::size_t>(id)]);
    soup.triangles.push_back({begin, begin + 1, begin + 2});
  }
  return soup;
}

std::string toAsciiStl(const Mesh& mesh) {
  std::string text = "solid made by a test\n";
  for (const auto& triangle : mesh.triangles) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const int id : triangle) {
      const auto& p = mesh.vertices[static_cast<std::size_t>(id)];
      text += "  vertex " + exactText(p[0]) + ' ' + exactText(p[1]) + ' ' +
              exactText(p[2]) + '\n';
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

std::string toBinaryStl(const Mesh& mesh) {
  std::string bytes = "solid, says this title, but it is binary";
  bytes.resize(80, ' ');
  appendBytes(static_cast<std::uint32_t>(mesh.triangles.size()), false, bytes);
  for (const auto& triangle : mesh.triangles) {
    bytes.append(12, '\0');
    for (const int id : triangle)
      for (const double x : mesh.vertices[static_cast<std::size_t>(id)])
        appendBytes(static_cast<float>(x), false, bytes);
    bytes.append(2, '\0');
  }
  return bytes;
}

/// @brief A strip of squares along x. Over its middle a spike is lowered by `drop`.
Mesh stripAndSpike(double drop) {
  Mesh mesh;
  for (int i = 0; i <= 4; ++i)
    for (const double y : {-1.0, 1.0}) mesh.vertices.push_back({i - 2.25, y, 0});
  for (int i = 0; i < 4; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    mesh.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  for (const auto& p : floorAndTip(drop).vertices) mesh.vertices.push_back(p);
  mesh.vertices.erase(mesh.vertices.begin() + 10, mesh.vertices.begin() + 13);
  mesh.triangles.push_back({10, 11, 12});
  return mesh;
}

TEST_F(CcdSequence, ReadsStlOfBothKinds) {
  const Mesh soup = toSoup(stripAndSpike(0.25));
  writeText(path("a.stl"), toAsciiStl(soup));
  writeText(path("b.STL"), toBinaryStl(soup));
  for (const char* name : {"a.stl", "b.STL"}) {
    const Mesh read = readMesh(path(name).string());
    EXPECT_EQ(read.vertices, soup.vertices) << name;
    EXPECT_EQ(read.triangles, soup.triangles) << name;
  }
  const std::string ascii = toAsciiStl(soup), binary = toBinaryStl(soup);
  const std::vector<std::pair<std::string, const char*>> broken{
      {ascii.substr(0, ascii.rfind(" endloop")), "cut short"},
      {ascii.substr(0, ascii.rfind("  vertex")) + " endloop\n", "three vertices"},
      {binary.substr(0, binary.size() - 1), "The file is not ascii STL: its beginning"},
      {"solid\nendsolid\n", "no faces"},
      {"solid\nfacet\nouter loop\nvertex 0 0 nan\n", "line 4: 'nan' is not finite"}};
  for (const auto& [bytes, cause] : broken) {
    writeText(path("c.stl"), bytes);
    try {
      readMesh(path("c.stl").string());
      FAIL() << cause;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
  }
}

TEST_F(CcdSequence, SoupIsNoticedAndWelded) {
  const Mesh from = stripAndSpike(0), to = stripAndSpike(1.25);
  writeText(path("0.obj"), toObj(from));
  writeText(path("1.obj"), toObj(to));
  writeText(path("0.stl"), toBinaryStl(toSoup(from)));
  writeText(path("1.stl"), toAsciiStl(toSoup(to)));
  const auto rowsOf = [&](const std::string& arguments, const std::string& note) {
    const Outcome outcome = run("run " + arguments + kOutputs);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, note);
    return linesOf(takeOutputs().first).size() - 1;
  };
  EXPECT_EQ(rowsOf("0.obj 1.obj", ""), 1u);
  EXPECT_GT(
      rowsOf("0.stl 1.stl",
             "fcl-ccd: 0.stl: 27 vertices, none shared: neighbours will be reported "
             "as contacts; pass --weld to join them\n"),
      10u);
  for (const char* weld : {"--weld", "--weld 0", "--weld 1e-3"})
    EXPECT_EQ(rowsOf("0.stl 1.stl " + std::string(weld),
                     "fcl-ccd: 0.stl: 14 of 27 vertices joined\n"),
              1u);
}

double areaXY(const Vertices& vertices, const std::array<int, 3>& t) {
  const auto& a = vertices[static_cast<std::size_t>(t[0])];
  const auto& b = vertices[static_cast<std::size_t>(t[1])];
  const auto& c = vertices[static_cast<std::size_t>(t[2])];
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

/// @brief The faces of one polygon through all vertices.
fcl_ccd::Faces polygon(std::size_t size) {
  fcl_ccd::Faces faces;
  for (std::size_t i = 0; i < size; ++i) faces.corners.push_back(static_cast<int>(i));
  EXPECT_TRUE(faces.endFace());
  return faces;
}

// Positive areas that add up to the polygon's: the triangles cover it once.
TEST(CcdTriangulate, ConcavePolygonsAreCoveredOnce) {
  Vertices comb;  // teeth upwards, one after the other
  for (int i = 0; i < 6; ++i) {
    comb.push_back({double(i), 0, 0.1 * i});
    comb.push_back({i + 0.5, 5.0, 0.1 * i});
  }
  comb.push_back({6, 0, 0});
  comb.push_back({6, -1, 0});
  comb.push_back({0, -1, 0});
  std::reverse(comb.begin(), comb.end());
  const std::vector<Vertices> shapes{
      {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}},  // a dart
      {{0.5, 0.5, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}},  // from its notch
      {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}},  // an L
      comb};
  for (const Vertices& shape : shapes) {
    double area = 0, covered = 0;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const auto &p = shape[i], &q = shape[(i + 1) % shape.size()];
      area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
    }
    const Triangles triangles = fcl_ccd::triangulate(shape, polygon(shape.size()));
    EXPECT_EQ(triangles.size(), shape.size() - 2);
    for (const auto& triangle : triangles) {
      EXPECT_GT(areaXY(shape, triangle), 0);
      covered += areaXY(shape, triangle);
    }
    EXPECT_NEAR(covered, area, 1e-12);
  }
}

TEST(CcdTriangulate, ConvexPolygonsBecomeFans) {
  const Vertices square{{0, 0, 1}, {1, 0, 2}, {1, 1, 3}, {0, 1, 2}};
  EXPECT_EQ(fcl_ccd::triangulate(square, polygon(4)), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  // A face without an ear becomes a fan, too.
  const Vertices point(5, {1, 1, 1});
  EXPECT_EQ(fcl_ccd::triangulate(point, polygon(5)).size(), 3u);
}

Eigen::Vector3d point(const Vertices& vertices, int id) {
  return Eigen::Vector3d(vertices[static_cast<std::size_t>(id)].data());
}

double distanceToEdge(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b) {
  const double along = (p - a).dot(b - a) / (b - a).squaredNorm();
  return (p - a - std::clamp(along, 0.0, 1.0) * (b - a)).norm();
}

/// @brief Expects that triangles cover a polygon of this area once, and that no corner is
/// near an edge of a triangle, except where it is an end of the edge.
void expectConforming(const Vertices& shape, double area, double distance) {
  const Triangles triangles = fcl_ccd::triangulate(shape, polygon(shape.size()));
  EXPECT_EQ(triangles.size(), shape.size() - 2);
  double covered = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector3d a = point(shape, t[0]);
    covered += 0.5 * (point(shape, t[1]) - a).cross(point(shape, t[2]) - a).norm();
    for (std::size_t k = 0; k < 3; ++k) {
      const int end0 = t[k], end1 = t[(k + 1) % 3];
      for (int corner = 0; corner < static_cast<int>(shape.size()); ++corner)
        if (corner != end0 && corner != end1) {
          const double found = distanceToEdge(point(shape, corner), point(shape, end0),
                                              point(shape, end1));
          EXPECT_GT(found, distance);
        }
    }
  }
  EXPECT_NEAR(covered, area, 0.01);
}

/// @brief Stairs up and down, with a corner at every unit of length.
Vertices stairs(const std::vector<int>& heights) {
  Vertices ends{{0, 0, 0}};
  for (std::size_t i = 0; i < heights.size(); ++i)
    for (const std::size_t x : {i, i + 1})
      ends.push_back({double(x), double(heights[i]), 0});
  ends.push_back({double(heights.size()), 0, 0});
  Vertices corners;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto &a = ends[i], &b = ends[(i + 1) % ends.size()];
    const double length = std::abs(b[0] - a[0]) + std::abs(b[1] - a[1]);
    for (double s = 0; s < length; ++s)
      corners.push_back(
          {a[0] + (b[0] - a[0]) * s / length, a[1] + (b[1] - a[1]) * s / length, 0});
  }
  return corners;
}

// Corners on straight runs, also straight up to the rounding to double and to four
// decimals. Points of a grid of this size are at least 0.09 from a line through others.
TEST(CcdTriangulate, NoCornerIsOnAnEdgeOfAnotherTriangle) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<int> heights(1 + random() % 6);
    for (int& height : heights) height = 1 + static_cast<int>(random() % 4);
    Vertices corners = stairs(heights);
    if (i % 2 == 1) std::reverse(corners.begin(), corners.end());
    std::rotate(corners.begin(),
                corners.begin() + static_cast<std::ptrdiff_t>(random() % corners.size()),
                corners.end());
    const double area = std::accumulate(heights.begin(), heights.end(), 0.0);
    expectConforming(corners, area, 0.09);
    const Eigen::Vector3d axis(number(random), number(random), number(random));
    const Eigen::AngleAxisd rotation(3 * number(random), axis.normalized());
    Vertices turned = corners, rounded = corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector3d p = rotation * point(corners, static_cast<int>(k)) + axis;
      turned[k] = {p[0], p[1], p[2]};
      for (std::size_t j = 0; j < 3; ++j) rounded[k][j] = std::round(1e4 * p[j]) / 1e4;
    }
    expectConforming(turned, area, 0.09);
    expectConforming(rounded, area, 0.09);
  }
}

// The corners in the middle of the sides touched triangles of the fan.
TEST_F(CcdSequence, StraightCornersOfAFaceAreNoContacts) {
  const auto square = [](double z) {
    std::string text;
    for (const char* xy : {"0 0", "1 0", "2 0", "2 1", "2 2", "1 2", "0 2", "0 1"})
      text += std::string("v ") + xy + ' ' + exactText(z) + '\n';
    return text + "f 1 2 3 4 5 6 7 8\n";
  };
  writeText(path("a.obj"), square(0));
  writeText(path("b.obj"), square(0.1));
  const Outcome outcome = run("run a.obj b.obj --contacts c.csv");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(linesOf(readText(path("c.csv"))).size(), 1u);
}

// The second frame alone would be divided along the other diagonal.
TEST_F(CcdSequence, FacesAreDividedAsInTheFirstFrame) {
  const auto frame = [](double x) {
    return "v 0 0 0\nv 2 0 0\nv " + exactText(x) + ' ' + exactText(x) +
           " 0\nv 0 2 0\nf 2 3 4 1\n";
  };
  writeText(path("a.obj"), frame(0.5));
  writeText(path("b.obj"), frame(1.5));
  ASSERT_EQ(run("run a.obj b.obj --paint p.ply").exit_code, 0);
  const Mesh painted = readMesh(path("p.ply").string());
  const Mesh a = readMesh(path("a.obj").string());
  const Mesh b = readMesh(path("b.obj").string());
  EXPECT_NE(a.triangles, b.triangles);
  EXPECT_EQ(painted.triangles, a.triangles);
}

TEST_F(CcdSequence, BinaryPlyIsReadWithWhatElseItHas) {
  // Vertices with more properties, a second list in faces, polygons, another element.
  std::string ply =
      "ply\nformat binary_big_endian 1.0\nelement note 1\nproperty list uchar uchar "
      "text\n"
      "element vertex 5\nproperty uchar red\nproperty float x\nproperty double y\n"
      "property float z\nproperty short s\nelement face 2\nproperty uchar flag\n"
      "property list ushort uint vertex_index\nproperty list uchar float "
      "uv\nend_header\n";
  ply += std::string("\3abc");
  const Vertices vertices{{0, 0, 0}, {1, 0, 0}, {1, 1.1, 0}, {0, 1, 0}, {0, 2, 0.5}};
  for (const auto& p : vertices) {
    ply += 'r';
    appendBytes(static_cast<float>(p[0]), true, ply);
    appendBytes(p[1], true, ply);
    appendBytes(static_cast<float>(p[2]), true, ply);
    appendBytes(std::int16_t{7}, true, ply);
  }
  for (const std::vector<std::uint32_t>& face :
       {std::vector<std::uint32_t>{0, 1, 2, 3}, {3, 2, 4}}) {
    ply += 'f';
    appendBytes(static_cast<std::uint16_t>(face.size()), true, ply);
    for (const std::uint32_t id : face) appendBytes(id, true, ply);
    ply += '\1';
    appendBytes(0.5f, true, ply);
  }
  writeText(path("m.ply"), ply);
  const Mesh mesh = readMesh(path("m.ply").string());
  EXPECT_EQ(mesh.vertices, vertices);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {3, 2, 4}}));
}

/// @brief Eight rows of a vertex that falls through a face, or of an edge that falls
/// through another one.
std::string fallingRows(const char* resting, const char* from, const char* to,
                        const char* truth) {
  std::string rows;
  for (const char* falling : {from, to})
    for (const std::string& row : linesOf(std::string(falling) + resting))
      rows.append(row).append(truth).append(1, '\n');
  return rows;
}

/// @brief Writes the files of queries and of their truth that the page names.
void writeQueriesOfThePage(const fs::path& folder) {
  for (const char* name :
       {"folder", "Sample-Queries", "cloth-funnel/queries", "cloth-funnel/mma_bool",
        "cloth-funnel/boxes", "cloth-funnel/frames"})
    fs::create_directories(folder / name);
  const auto vf = [](const char* truth) {
    return fallingRows("-8,-8,0\n8,-8,0\n0,8,0\n", "0,0,2\n", "0,0,-2\n", truth);
  };
  const auto ee = [](const char* truth) {
    return fallingRows("-8,0,0\n8,0,0\n", "0,-8,2\n0,8,2\n", "0,-8,-2\n0,8,-2\n", truth);
  };
  writeText(folder / "vertex-face.csv", vf(",1"));
  writeText(folder / "points.csv", ee(""));
  for (const char* name : {"folder", "Sample-Queries"}) {
    writeText(folder / name / "a_vf.csv", vf(",1"));
    writeText(folder / name / "a_ee.csv", ee(",1"));
  }
  const fs::path funnel = folder / "cloth-funnel";
  writeText(funnel / "queries/227vf.csv", vf(""));
  writeText(funnel / "mma_bool/227vf_mma_bool.json", "[true]");
  // Vertices 0 to 5, edges 6 to 11, faces 12 and 13.
  writeText(funnel / "boxes/227vf.json", "[[3, 12]]");
  writeText(folder / "pairs_vf.json", "[[3, 12]]");
  writeText(folder / "pairs_ee.json", "[[6, 9]]");
  for (const char* name : {"a.ply", "cloth-funnel/frames/227.ply"})
    writeText(folder / name, toAsciiPly(floorAndTip(0)));
  for (const char* name : {"b.ply", "cloth-funnel/frames/228.ply"})
    writeText(folder / name, toAsciiPly(floorAndTip(2)));
}

// The commands of the page, in its order, in a folder with the files that it names.
TEST_F(CcdSequence, TheManualsCommandsWork) {
  if (kHasAddressSanitizer) GTEST_SKIP() << "The other tests have these commands";
  writeFramesOfThePages();
  writeQueriesOfThePage(path(""));
  fs::copy_file(FCL_CCD_SOURCE_DIR "/examples/scene.json", path("scene.json"));
  writeText(path("scan_0.stl"), toBinaryStl(toSoup(stripAndSpike(0))));
  writeText(path("scan_1.stl"), toBinaryStl(toSoup(stripAndSpike(2))));
  const std::vector<std::string> commands =
      commandsOf(FCL_CCD_SOURCE_DIR "/doc/program.md", "fcl-ccd ");
  for (const std::string& command : commands) {
    const Outcome outcome = run(command.substr(command.find(' ')));
    EXPECT_EQ(outcome.exit_code, 0) << command << '\n' << outcome.err;
  }
  for (const char* name : {"run", "candidates", "queries", "compare"})
    EXPECT_TRUE(std::any_of(commands.begin(), commands.end(), [&](const auto& command) {
      return command.rfind(std::string("fcl-ccd ") + name, 0) == 0;
    })) << name;
}

}  // namespace

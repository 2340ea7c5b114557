// SPDX-License-Identifier: BSD-3-Clause
//
// Runs of the program fcl-ccd beside other programs: two runs on one output, outputs that
// are deleted or cut, pipes, and frames that are still being written.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ccd_sequence.h"
#include "mesh_files.h"
#include "sanitizer.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// @brief Waits until something holds, at most for half a minute.
void awaitThat(const std::function<bool()>& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!holds() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(holds());
}

/// @brief The exit code of a process that was started, or minus its signal.
int exitCodeOf(pid_t child) {
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

class CcdOutputs : public CcdSequence {
 protected:
  /// @brief Starts a run that waits for more frames, and waits until it has done all that
  /// there are.
  pid_t startWaitingRun(std::vector<std::string> options, std::size_t num_steps) const {
    std::vector<std::string> arguments{"fcl-ccd", "run", "f", "--follow"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const pid_t child = start(path(""), arguments);
    // The head and the steps.
    awaitThat([&] { return linesOf(readText(path("out.txt"))).size() > num_steps; });
    return child;
  }

  std::size_t numLines(const std::string& name) const {
    return linesOf(readText(path(name))).size();
  }

  void cutFrame(std::size_t frame, std::size_t size) const {
    writeText(path(frameName(frame)), readText(path(frameName(frame))).substr(0, size));
  }
};

TEST_F(CcdOutputs, ASecondRunOnAnOutputIsRefusedByName) {
  writeFrames(5);
  const auto whole = outputsOf("run f");
  writeText(path("old.json"), "old");
  // Outputs that grow, that exist before, and that do not exist before the end.
  for (const std::string option : {"--contacts c.csv", "--steps s.jsonl", "--json r.json",
                                   "--json old.json", "--paint p.ply"}) {
    SCOPED_TRACE(option);
    const std::string name = option.substr(option.find(' ') + 1);
    const pid_t first = startWaitingRun({option.substr(0, option.find(' ')), name}, 4);
    const std::string before = readText(path(name));
    for (const std::string other : {"", " --resume", " --query first --jobs 2"}) {
      const bool grows = option[2] == 'c' || option[2] == 's';
      if (other == " --resume" && !grows) continue;
      const Outcome second = run("run f " + option + other, "out2.txt");
      EXPECT_EQ(second.exit_code, 2);
      EXPECT_EQ(second.out, "");
      EXPECT_TRUE(contains(second.err, name + ": cannot write: another run"))
          << second.err;
    }
    EXPECT_EQ(readText(path(name)), before);
    // A process that is killed leaves no lock, and no file but those that grow.
    kill(first, SIGKILL);
    EXPECT_EQ(exitCodeOf(first), -SIGKILL);
    EXPECT_EQ(run("run f " + option).exit_code, 0);
    if (name != "old.json") fs::remove(path(name));
  }
  // By another name, too.
  fs::create_directory(path("g"));
  fs::create_symlink("../c.csv", path("g/link.csv"));
  const pid_t first = startWaitingRun({"--contacts", "c.csv"}, 4);
  for (const std::string name : {"f/../c.csv", "g/link.csv"})
    EXPECT_TRUE(contains(run("run f --contacts " + name, "out2.txt").err,
                         name + ": cannot write: another run"));
  // Others go on.
  EXPECT_EQ(run("run f --contacts d.csv", "out2.txt").exit_code, 0);
  kill(first, SIGINT);
  EXPECT_EQ(exitCodeOf(first), 128 + SIGINT);
  fs::remove(path("c.csv"));
  EXPECT_EQ(outputsOf("run f"), whole);
}

TEST_F(CcdOutputs, ARunWhoseOutputIsTakenAwayFails) {
  using Path = fs::path;
  const std::vector<std::pair<std::string, std::function<void(const Path&)>>> changes{
      {"deleted or moved", [](const Path& file) { fs::remove(file); }},
      {"deleted or moved",
       [](const Path& file) { fs::rename(file, file.string() + ".old"); }},
      {"changed", [](const Path& file) { fs::resize_file(file, 0); }},
      {"changed", [](const Path& file) { fs::resize_file(file, 40); }},
      {"changed",
       [](const Path& file) { std::ofstream(file, std::ios::app) << "other\n"; }},
      {"replaced", [](const Path& file) {
         const std::string text = readText(file);
         fs::remove(file);
         writeText(file, text);
       }}};
  for (const std::string name : {"c.csv", "s.jsonl"})
    for (const auto& [change, apply] : changes) {
      SCOPED_TRACE(name + " is " + change);
      fs::remove_all(path("f"));
      writeFrames(5);
      const pid_t child = startWaitingRun(
          {"--contacts", "c.csv", "--steps", "s.jsonl", "--json", "r.json"}, 4);
      awaitThat([&] { return numLines("s.jsonl") == 5; });
      apply(path(name));
      writeFrame(5);
      EXPECT_EQ(exitCodeOf(child), 4);
      const std::string err = readText(path("err.txt"));
      EXPECT_TRUE(contains(err, name + ": was " + change + " by another program")) << err;
      EXPECT_EQ(linesOf(err).back(), "fcl-ccd: stopped after 4 of 5 steps") << err;
      // No bytes that nobody wrote, and no report of a run that has no steps.
      for (const char* file : {"c.csv", "s.jsonl"})
        EXPECT_FALSE(contains(readText(path(file)), std::string(1, '\0')));
      EXPECT_FALSE(fs::exists(path("r.json")));
      fs::remove(path("c.csv"));
      fs::remove(path("s.jsonl"));
    }
}

// What is cut ends in a part of a row. No row of the next step goes on with it.
TEST_F(CcdOutputs, ARunWhoseOutputIsCutIsResumed) {
  writeFrames(6);
  const std::string files = " --contacts c.csv --steps s.jsonl";
  const auto outputs = [this] {
    return std::make_pair(readText(path("c.csv")), readText(path("s.jsonl")));
  };
  EXPECT_EQ(run("run f" + files).exit_code, 0);
  const auto whole = outputs();
  for (const std::string name : {"c.csv", "s.jsonl"})
    for (const std::uintmax_t cut : {4, 90}) {
      SCOPED_TRACE(name + " without " + std::to_string(cut) + " bytes");
      for (const char* old : {"f", "c.csv", "s.jsonl"}) fs::remove_all(path(old));
      writeFrames(3);
      const pid_t child =
          startWaitingRun({"--contacts", "c.csv", "--steps", "s.jsonl"}, 2);
      awaitThat([&] { return numLines("s.jsonl") == 3; });
      fs::resize_file(path(name), fs::file_size(path(name)) - cut);
      writeFrame(3);  // its step has contacts
      EXPECT_EQ(exitCodeOf(child), 4);
      writeFrames(6);
      EXPECT_EQ(run("run f" + files + " --resume").exit_code, 0);
      EXPECT_EQ(outputs(), whole);
    }
}

// A word that is whole stays wrong, whatever comes behind it.
TEST_F(CcdOutputs, AFrameWithAWrongWordIsNotHalfWritten) {
  fs::create_directory(path("g"));
  for (int frame = 0; frame < 4; ++frame)
    writeText(path("g/tip" + std::to_string(frame) + ".obj"),
              toObj(floorAndTip(1 - .1 * frame)));
  const std::string good = readText(path("g/tip3.obj"));
  const std::size_t line = good.find("v ");
  for (const std::string word : {"nan", "x", "1e999"}) {
    SCOPED_TRACE(word);
    const std::string wrong =
        good.substr(0, line) + "v 0 " + word + " 0\n" + good.substr(line);
    writeText(path("g/tip3.obj"), wrong);
    const Outcome refused = run("run g --contacts c.csv");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_TRUE(contains(refused.err, "'" + word + "' is not")) << refused.err;
    EXPECT_EQ(run("run g --follow 2 --end 3").exit_code, 2);
    // Cut in this word it may become a right one.
    writeText(path("g/tip3.obj"), wrong.substr(0, line + 4 + word.size()));
    EXPECT_EQ(run("run g --contacts c.csv").exit_code, 6);
  }
}

// Also if it is noticed only at the end.
TEST_F(CcdOutputs, AnOutputThatIsGoneAtTheEndFails) {
  writeFrames(5);
  const pid_t child = startWaitingRun({"--contacts", "c.csv"}, 4);
  fs::remove(path("c.csv"));
  kill(child, SIGTERM);
  EXPECT_EQ(exitCodeOf(child), 4);
}

TEST_F(CcdOutputs, StandardOutputTakesOneOutput) {
  writeFrames(12);
  const auto [contacts, steps] = outputsOf("run f");
  const std::string columns = " --columns triangles,position,normal";
  const Outcome of_contacts = run("run f --contacts -" + columns);
  EXPECT_EQ(of_contacts.exit_code, 0);
  EXPECT_EQ(of_contacts.out, contacts);
  EXPECT_EQ(linesOf(of_contacts.err).size(), 1u + 11u + 5u) << of_contacts.err;
  EXPECT_EQ(run("run f --steps -").out, steps);
  EXPECT_EQ(Json::parse(run("run f --json -").out).at("steps").size(), 11u);
  EXPECT_EQ(run("run f --paint -").out.substr(0, 4), "ply\n");
  EXPECT_EQ(files(), std::set<std::string>{"f"});
  expectFailure("run f --contacts - --steps -", "standard output: cannot write: it can");
  expectFailure("run f --contacts - --resume",
                "--resume cannot continue standard output");
  // A file of this name is not meant.
  writeText(path("-"), "old");
  EXPECT_EQ(run("run f --contacts -" + columns).out, contacts);
  EXPECT_EQ(readText(path("-")), "old");
  EXPECT_EQ(run("run f --contacts ./-" + columns).exit_code, 0);
  EXPECT_EQ(readText(path("-")), contacts);
  const Outcome closed = run("run f --contacts -", "&-");
  EXPECT_EQ(closed.exit_code, 2);
  EXPECT_TRUE(contains(closed.err, "standard output: cannot write")) << closed.err;
}

TEST_F(CcdOutputs, APipeThatIsClosedEndsTheRun) {
  writeFrames(300);
  const auto whole = outputsOf("run f");
  const std::string tool = "'" FCL_CCD_TOOL "' run f";
  const Outcome outcome =
      runShell("{ { " + tool +
               " --contacts - --steps s.jsonl --columns triangles,position,normal; echo "
               "$? >code.txt; } | head -c 100; }");
  EXPECT_EQ(readText(path("code.txt")), "4\n");
  const std::vector<std::string> lines = linesOf(outcome.err);
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines[lines.size() - 2],
            "fcl-ccd: standard output: the program that reads it has ended");
  EXPECT_EQ(lines.back().rfind("fcl-ccd: stopped after ", 0), 0u) << lines.back();
  // Whole steps.
  const std::string steps = readText(path("s.jsonl"));
  EXPECT_EQ(steps.back(), '\n');
  EXPECT_EQ(whole.second.rfind(steps, 0), 0u);
}

struct Format {
  const char* name;
  std::function<std::string(const Mesh&)> encode;
};

/// @brief An ascii PLY with its faces before its vertices.
std::string facesFirst(const std::string& text, const Mesh& mesh) {
  const std::string end = "end_header\n";
  const std::size_t head = text.find("element vertex"),
                    head_faces = text.find("element face"), head_end = text.find(end),
                    body = head_end + end.size();
  std::size_t faces = body;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    faces = text.find('\n', faces) + 1;
  return text.substr(0, head) + text.substr(head_faces, head_end - head_faces) +
         text.substr(head, head_faces - head) + end + text.substr(faces) +
         text.substr(body, faces - body);
}

/// @brief The mesh and a triangle far away, whose ids have two digits.
Mesh withManyVertices(Mesh mesh) {
  while (mesh.vertices.size() < 30)
    mesh.vertices.push_back({static_cast<double>(mesh.vertices.size()), 100, 100});
  mesh.vertices.back()[1] = 200;
  mesh.triangles.push_back({27, 28, 29});
  return mesh;
}

const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {"obj", toObj},
      {"obj", [](const Mesh& mesh) { return toObj(mesh) + "l 1 2 4\np 1\nl 5 6\n"; }},
      {"off", toOff},
      {"ply", toAsciiPly},
      {"ply", [](const Mesh& mesh) { return toBinaryPly<double>(mesh, false); }},
      {"ply", [](const Mesh& mesh) { return toBinaryPly<float>(mesh, true); }},
      // Vertices behind the faces: the last number may be cut.
      {"obj",
       [](const Mesh& mesh) {
         const std::string text = toObj(mesh);
         const std::size_t faces = text.find("\nf ") + 1,
                           vertices = text.find("\nv ") + 1;
         return text.substr(faces) + text.substr(vertices, faces - vertices);
       }},
      {"ply", [](const Mesh& mesh) { return facesFirst(toAsciiPly(mesh), mesh); }},
      // The last id of a face has two digits.
      {"off", [](const Mesh& mesh) { return toOff(withManyVertices(mesh)); }},
      {"ply", [](const Mesh& mesh) { return toAsciiPly(withManyVertices(mesh)); }}};
  return all;
}

/// @brief A mesh whose numbers all have several digits.
Mesh longNumbers(double drop) {
  Mesh mesh = floorAndTip(drop);
  for (auto& p : mesh.vertices)
    for (double& x : p) x = x * 1.0625 + 0.015625;
  return mesh;
}

// Wherever the last frame is cut, the run does the steps before it, or takes it as whole
// if only an end of line is missing.
TEST_F(CcdOutputs, AHalfWrittenLastFrameLeavesTheStepsBefore) {
  // With the sanitizer, which starts slowly, every third format.
  for (std::size_t at = 0; at < formats().size(); at += kHasAddressSanitizer ? 3 : 1) {
    const Format& format = formats()[at];
    fs::remove_all(path("f"));
    fs::create_directory(path("f"));
    const auto frame = [&](int i) {
      return "f/" + std::to_string(i) + '.' + format.name;
    };
    for (const int i : {0, 1, 2})
      writeText(path(frame(i)),
                format.encode(longNumbers(dropOf(static_cast<std::size_t>(i)))));
    const auto two = outputsOf("run f --end 1"), three = outputsOf("run f");
    const std::string steps = two.second.substr(0, two.second.find("{\"summary"));
    const std::string text = readText(path(frame(2)));
    std::size_t num_whole = 0;
    // Every cut of the last number, or every eighth.
    const std::size_t step = kHasAddressSanitizer ? 8 : 1;
    const bool is_text = text.back() == '\n';
    const std::size_t fine = text.size() - (is_text ? 14 : 2);
    for (std::size_t size = 0; size < text.size();
         size = size < fine ? std::min(fine, size + text.size() / 6) : size + step) {
      SCOPED_TRACE(frame(2) + " with " + std::to_string(size) + " of " +
                   std::to_string(text.size()) + " bytes");
      writeText(path(frame(2)), text.substr(0, size));
      const Outcome outcome = run("run f" + kOutputs);
      if (outcome.exit_code == 0) {
        ++num_whole;
        EXPECT_EQ(takeOutputs(), three);
        continue;
      }
      EXPECT_EQ(outcome.exit_code, 6) << outcome.err;
      EXPECT_TRUE(contains(outcome.err, frame(2) + ": ")) << outcome.err;
      EXPECT_TRUE(contains(outcome.err, "stopped after 1 of 2 steps; they are in c.csv"))
          << outcome.err;
      EXPECT_EQ(takeOutputs(), std::make_pair(two.first, steps));
    }
    EXPECT_LE(num_whole, 1u) << format.name;
  }
}

TEST_F(CcdOutputs, ResumeDoesTheGoodStepsBeforeAHalfWrittenFrame) {
  writeFrames(12);
  const auto whole = outputsOf("run f");
  ASSERT_EQ(run("run f --end 3" + kOutputs).exit_code, 0);
  const std::string last = readText(path(frameName(11)));
  cutFrame(11, 300);
  for (const char* jobs : {" --jobs 1", " --jobs 3"}) {
    const Outcome outcome =
        run("run f --resume --json r.json --paint p.ply --at-step 9 --at-time 1" +
            kOutputs + jobs);
    EXPECT_EQ(outcome.exit_code, 6) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "f/tip11.ply: ")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "stopped after 10 of 11 steps")) << outcome.err;
    EXPECT_EQ(numLines("s.jsonl"), 11u);
    EXPECT_TRUE(contains(readText(path("r.json")), "\"complete\":false"));
    EXPECT_EQ(readMesh(path("p.ply").string()).vertices,
              floorAndTip(dropOf(10)).vertices);
  }
  fs::remove(path("r.json"));
  fs::remove(path("p.ply"));
  writeText(path(frameName(11)), last);
  EXPECT_EQ(outputsOf("run f --resume"), whole);
}

// Two frames at once, and a body that moves.
TEST_F(CcdOutputs, SeveralFramesMayBeHalfWritten) {
  writeFrames(8);
  fs::copy(path("f"), path("b"));
  const auto expected = outputsOf("run f --against b --end 4");
  cutFrame(7, 0);
  cutFrame(6, 300);
  writeText(path("b/tip5.ply"), "ply\n");
  writeText(path("b/tip6.ply"), "");
  writeText(path("b/tip7.ply"), "");
  const Outcome outcome = run("run f --against b" + kOutputs);
  EXPECT_EQ(outcome.exit_code, 6);
  EXPECT_TRUE(contains(outcome.err, "b/tip5.ply: ")) << outcome.err;
  EXPECT_EQ(takeOutputs().first, expected.first);
  // A frame in the middle is not half-written: later ones are there.
  writeFrame(7);
  expectFailure("run f" + kOutputs, "f/tip6.ply: ");
  // No step is left.
  cutFrame(1, 300);
  expectFailure("run f/tip0.ply f/tip1.ply" + kOutputs, "f/tip1.ply: ");
  // Welding needs all frames.
  cutFrame(7, 300);
  writeFrame(6);
  writeFrame(1);
  expectFailure("run f --weld" + kOutputs, "f/tip7.ply: ");
}

TEST_F(CcdOutputs, FollowWaitsForFrames) {
  writeFrames(9);
  const auto whole = outputsOf("run f");
  fs::remove_all(path("f"));
  fs::create_directory(path("f"));
  // It begins before the first frame.
  std::vector<std::string> arguments{
      "fcl-ccd",    "run",   "f",         "--follow",
      "--contacts", "c.csv", "--steps",   "s.jsonl",
      "--end",      "8",     "--columns", "triangles,position,normal",
      "--paint",    "p.ply", "--at-step", "7",
      "--at-time",  "1"};
  const pid_t child = start(path(""), arguments);
  for (std::size_t frame = 0; frame < 9; ++frame) {
    writeFrame(frame);
    const std::string bytes = readText(path(frameName(frame)));
    // In parts.
    if (frame % 3 == 2) {
      cutFrame(frame, bytes.size() / 2);
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
      std::ofstream(path(frameName(frame)), std::ios::binary | std::ios::app)
          << bytes.substr(bytes.size() / 2);
    }
    if (frame > 0) awaitThat([&] { return numLines("s.jsonl") >= frame + 1; });
  }
  EXPECT_EQ(exitCodeOf(child), 0) << readText(path("err.txt"));
  EXPECT_EQ(readText(path("err.txt")), "");
  EXPECT_EQ(takeOutputs(), whole);
  EXPECT_EQ(readMesh(path("p.ply").string()).vertices, floorAndTip(dropOf(8)).vertices);
}

TEST_F(CcdOutputs, FollowEndsAsItSays) {
  writeFrames(9);
  const auto whole = outputsOf("run f");
  // After the time without a frame.
  EXPECT_EQ(outputsOf("run f --follow 0.2"), whole);
  EXPECT_EQ(outputsOf("run f/tip%d.ply --follow=0"), whole);
  const auto half = outputsOf("run f --end 4");
  EXPECT_EQ(outputsOf("run f --end 4 --follow"), half);
  // With a frame that was begun.
  cutFrame(8, 300);
  const Outcome unfinished = run("run f --follow 0.2" + kOutputs);
  EXPECT_EQ(unfinished.exit_code, 6) << unfinished.err;
  EXPECT_TRUE(contains(unfinished.err, "f/tip8.ply: ")) << unfinished.err;
  writeFrame(8);
  EXPECT_EQ(outputsOf("run f --resume --follow=0.1"), whole);
  // By a signal.
  const pid_t child = startWaitingRun({"--contacts", "c.csv", "--steps", "s.jsonl",
                                       "--columns", "triangles,position,normal"},
                                      8);
  awaitThat([&] { return numLines("s.jsonl") == 9; });
  kill(child, SIGINT);
  EXPECT_EQ(exitCodeOf(child), 128 + SIGINT);
  EXPECT_EQ(outputsOf("run f --resume"), whole);
  // With frames that do not come at all, or are of another mesh.
  fs::create_directory(path("g"));
  expectFailure("run g --follow 0.1",
                "g: A needs two frames or more. There are 0, and "
                "none came in 0.1 seconds");
  writeText(path(frameName(8)), toBinaryPly<double>(edgeAlongX(), false));
  expectFailure("run f --follow 0.1", "f/tip8.ply: has 3 vertices");
  for (const std::string arguments :
       {"f/tip0.ply f/tip1.ply", "f f", "f --weld", "none", "f --follow=x"})
    EXPECT_EQ(run("run --follow=0.1 " + arguments).exit_code, 2) << arguments;
  // With a range of one frame.
  for (const std::string range : {"--end 0", "--start 3 --end 3", "--end 2 --stride 3"})
    for (const std::string word : {"f", "f/tip%d.ply", "'f/t*'"})
      expectFailure("run " + word + " --follow " + range, "not more than one is between");
}

TEST_F(CcdOutputs, FollowTellsWhatItWaitsFor) {
  writeFrames(3);
  fs::create_directory(path("b"));
  fs::copy(path("f/tip0.ply"), path("b/tip0.ply"));
  expectFailure("run f --against b --follow=0.1",
                "b: B needs two frames or more. There is 1, and none came");
  const pid_t child = start(path(""), {"fcl-ccd", "run", "f/typ*", "--follow"});
  const std::string line =
      "fcl-ccd: waiting for frames: f/typ*: A needs two frames or more. There are 0\n";
  awaitThat([&] { return readText(path("err.txt")) == line; });
  kill(child, SIGINT);
  EXPECT_EQ(exitCodeOf(child), 128 + SIGINT);
  // expectFailure() compares the files that there are.
  for (const char* name : {"out.txt", "err.txt"}) fs::remove(path(name));
  // A first frame that is bad, and one that is still being written.
  cutFrame(0, 300);
  expectFailure("run f --follow", "f/tip0.ply: ");
  cutFrame(1, 0);
  expectFailure("run f --follow=0.1", "and nothing came in 0.1 seconds");
  const pid_t other = start(path(""), {"fcl-ccd", "run", "f", "--follow", "--end", "2"});
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  writeFrame(0);
  writeFrame(1);
  EXPECT_EQ(exitCodeOf(other), 0) << readText(path("err.txt"));
}

// Also if they are seen at the same time.
TEST_F(CcdOutputs, FollowDoesTheStepsBeforeABadFrame) {
  writeFrames(8);
  const auto expected = outputsOf("run f --end 6");
  const auto late = [&](std::size_t frame) {
    return path("late" + std::to_string(frame));
  };
  for (std::size_t frame = 3; frame < 8; ++frame)
    fs::rename(path(frameName(frame)), late(frame));
  const pid_t child =
      startWaitingRun({"--jobs", "100000", "--contacts", "c.csv", "--steps", "s.jsonl",
                       "--columns", "triangles,position,normal"},
                      2);
  writeText(late(7), toBinaryPly<double>(edgeAlongX(), false));
  for (std::size_t frame = 3; frame < 8; ++frame)
    fs::rename(late(frame), path(frameName(frame)));
  EXPECT_EQ(exitCodeOf(child), 3);
  const std::string error = readText(path("err.txt"));
  EXPECT_TRUE(contains(error, "f/tip7.ply: has 3 vertices")) << error;
  EXPECT_TRUE(contains(error, "stopped after 6 of 6 steps")) << error;
  const auto outputs = takeOutputs();
  EXPECT_EQ(outputs.first, expected.first);
  EXPECT_EQ(expected.second.rfind(outputs.second, 0), 0u);
}

// The names of files that are gone, and of frames that are links to an output.
TEST_F(CcdOutputs, FollowNamesTheFileThatOthersChanged) {
  writeFrames(4);
  fs::copy(path("f"), path("b"));
  const pid_t child = startWaitingRun({"--against", "b"}, 3);
  fs::remove(path("b/tip3.ply"));
  EXPECT_EQ(exitCodeOf(child), 3);
  EXPECT_TRUE(contains(readText(path("err.txt")), "b/tip3.ply: was taken away"))
      << readText(path("err.txt"));

  const pid_t other = startWaitingRun({"--end", "4", "--paint", "p.ply"}, 3);
  const std::string frame = toBinaryPly<double>(floorAndTip(dropOf(4)), false);
  writeText(path("p.ply"), frame);
  fs::create_symlink("../p.ply", path(frameName(4)));
  EXPECT_EQ(exitCodeOf(other), 4);
  EXPECT_TRUE(contains(readText(path("err.txt")), "p.ply: cannot write: another"))
      << readText(path("err.txt"));
  EXPECT_EQ(readText(path("p.ply")), frame);
}

// A number that is missing is waited for; in a folder the frames come in their order.
TEST_F(CcdOutputs, FollowTakesFramesInOrder) {
  writeFrames(6);
  const auto whole = outputsOf("run f");
  fs::rename(path(frameName(3)), path("late.ply"));
  const pid_t child =
      start(path(""),
            {"fcl-ccd", "run", "f/tip%d.ply", "--follow", "--end", "5", "--contacts",
             "c.csv", "--steps", "s.jsonl", "--columns", "triangles,position,normal"});
  awaitThat([&] { return numLines("s.jsonl") == 3; });
  fs::rename(path("late.ply"), path(frameName(3)));
  EXPECT_EQ(exitCodeOf(child), 0) << readText(path("err.txt"));
  EXPECT_EQ(takeOutputs(), whole);

  fs::rename(path(frameName(3)), path("late.ply"));
  const pid_t other = startWaitingRun({"--steps", "s.jsonl"}, 4);
  awaitThat([&] { return numLines("s.jsonl") == 5; });
  fs::rename(path("late.ply"), path(frameName(3)));
  EXPECT_EQ(exitCodeOf(other), 3);
  EXPECT_TRUE(contains(readText(path("err.txt")), "f/tip3.ply: came when later frames"))
      << readText(path("err.txt"));
}

}  // namespace

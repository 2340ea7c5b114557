// SPDX-License-Identifier: BSD-3-Clause
//
// What the program fcl-ccd says about a run, in its table, summary and files: is it true
// for each query, and complete? Also the form of its lines and options.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ccd_sequence.h"
#include "csv_rows.h"
#include "mesh_files.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class CcdAnswers : public CcdSequence {
 protected:
  Json json(const std::string& name) const { return Json::parse(readText(path(name))); }

  /// @brief The rows of c.csv, without its head.
  std::vector<std::vector<std::string>> rows() const {
    std::vector<std::vector<std::string>> all;
    for (const std::string& line : linesOf(readText(path("c.csv"))))
      all.push_back(csvFields(line));
    EXPECT_FALSE(all.empty());
    if (!all.empty()) all.erase(all.begin());
    return all;
  }

  std::string outputOf(const std::string& arguments) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << '\n' << outcome.err;
    return outcome.out;
  }
};

Mesh moved(Mesh mesh, double x, double z) {
  for (auto& p : mesh.vertices) {
    p[0] += x;
    p[2] += z;
  }
  return mesh;
}

TEST_F(CcdAnswers, AnyContactOfCrossingMeshesIsTheCrossing) {
  writeTip();
  const std::string out =
      outputOf("run tip1.obj tip0.obj --query any --json r.json --steps s.jsonl");
  EXPECT_TRUE(
      contains(out, "a contact: step 0 at 0, between tip1.obj and tip0.obj: crossing,"))
      << out;
  EXPECT_TRUE(contains(out, "1 step began crossing")) << out;
  EXPECT_FALSE(contains(out, "first")) << out;
  const Json step = json("r.json").at("steps").at(0);
  EXPECT_EQ(step.at("initially_crossing"), true);
  EXPECT_EQ(step.at("any").at("kind"), "crossing");
  EXPECT_EQ(step.at("first"), step.at("any"));
  EXPECT_EQ(json("r.json").at("summary").at("undecided"), 0);
}

// A touches itself at 1/2, and B crosses it from the start.
TEST_F(CcdAnswers, WhatAnyDidNotDecideIsSaid) {
  writeTip();
  writeText(path("b.obj"), toObj(moved(edgeAlongX(), -1.5, 1)));
  const std::string pair =
      "run tip0.obj tip1.obj --against b.obj --contacts c.csv "
      "--json r.json --steps s.jsonl --query ";
  outputOf(pair + "first");
  ASSERT_EQ(json("r.json").at("steps").at(0).at("initially_crossing"), true);

  const std::string out = outputOf(pair + "any");
  EXPECT_EQ(linesOf(out)[1].substr(linesOf(out)[1].size() - 11), "not decided") << out;
  EXPECT_TRUE(contains(out, "0 steps began crossing\nnot decided: whether 1 other step"))
      << out;
  EXPECT_TRUE(contains(out, "\nnot decided: whether it is the first\n")) << out;
  EXPECT_FALSE(contains(out, "first contact")) << out;
  const Json report = json("r.json");
  for (const Json& step :
       {report.at("steps").at(0), Json::parse(linesOf(readText(path("s.jsonl")))[1])}) {
    EXPECT_EQ(step.at("initially_crossing"), "undecided");
    EXPECT_EQ(step.at("first"), "undecided");
    EXPECT_EQ(step.at("any").at("kind"), "vf");
  }
  EXPECT_EQ(report.at("summary").at("undecided"), 1);
  EXPECT_EQ(report.at("summary").at("initially_crossing"), 0);
  EXPECT_EQ(report.at("summary").at("first"), "undecided");
  EXPECT_EQ(report.at("summary").at("any").at("step"), 0);
  EXPECT_EQ(rows().size(), 1u);
  // Continued from the list of steps, the summary says the same.
  EXPECT_EQ(json("r.json").at("summary"),
            (outputOf(pair + "any --resume"), json("r.json").at("summary")));

  EXPECT_TRUE(contains(outputOf(pair + "any --no-self"), "1 step began crossing"));
}

TEST_F(CcdAnswers, AnyIsTheSameInEveryRunAndOneOfAll) {
  writeFrames(23);
  const auto all = outputsOf("run f"), any = outputsOf("run f --query any");
  for (const char* options : {" --jobs 1", " --jobs 5", " --threads 2"})
    EXPECT_EQ(outputsOf("run f --query any" + std::string(options)), any) << options;
  std::set<std::string> steps;
  for (const std::string& row : linesOf(any.first)) {
    const std::vector<std::string> fields = csvFields(row);
    EXPECT_TRUE(steps.insert(fields[0]).second) << row;
    const auto sameContact = [&](const std::string& other) {
      const std::vector<std::string> of_all = csvFields(other);
      return std::equal(fields.begin(), fields.begin() + 6, of_all.begin());
    };
    const std::vector<std::string> rows = linesOf(all.first);
    EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), sameContact)) << row;
  }
  std::set<std::string> steps_of_all;
  for (const std::string& row : linesOf(all.first))
    steps_of_all.insert(csvFields(row)[0]);
  EXPECT_EQ(steps, steps_of_all);
}

TEST_F(CcdAnswers, TheFirstContactsAreNotTakenForAll) {
  writeTip();
  EXPECT_TRUE(contains(outputOf("run tip0.obj tip1.obj --query first"),
                       "0 ee contacts that may be the first;"));
  EXPECT_TRUE(contains(outputOf("run tip0.obj tip1.obj --query any"),
                       "0 ee contacts, at most one a step;"));
}

/// @brief A grid of squares of two triangles in the plane of two axes.
Mesh grid(int count, const Eigen::Vector3d& origin, const Eigen::Vector3d& u,
          const Eigen::Vector3d& v) {
  Mesh mesh;
  for (int i = 0; i <= count; ++i)
    for (int j = 0; j <= count; ++j) {
      const Eigen::Vector3d p = origin + (double(i) * u + double(j) * v) / count;
      mesh.vertices.push_back({p[0], p[1], p[2]});
    }
  const int row = count + 1;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      const int a = i * row + j;
      mesh.triangles.push_back({a, a + row, a + 1});
      mesh.triangles.push_back({a + 1, a + row, a + row + 1});
    }
  return mesh;
}

using EdgeAndFace = std::pair<std::set<int>, std::set<int>>;

/// @brief All edges and faces that cross, each once, by the volumes of tetrahedra. The
/// positions are general, so that none is near 0.
std::set<EdgeAndFace> crossingsOf(const Mesh& mesh) {
  const auto at = [&](int id) {
    return Eigen::Vector3d(mesh.vertices[static_cast<std::size_t>(id)].data());
  };
  const auto isLeft = [&](int a, int b, int c, int d) {
    const double volume = (at(b) - at(a)).cross(at(c) - at(a)).dot(at(d) - at(a));
    EXPECT_GT(std::abs(volume), 1e-12);
    return volume > 0;
  };
  std::set<EdgeAndFace> found;
  for (const auto& t : mesh.triangles)
    for (const auto& f : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (std::count(f.begin(), f.end(), a) + std::count(f.begin(), f.end(), b) > 0)
          continue;
        const double far = 0.5;  // longer than two edges: also skips coplanar ones
        if ((at(a) - at(f[0])).norm() > far) continue;
        if (at(a)[2] == at(f[0])[2] && at(b)[2] == at(f[0])[2]) continue;
        if (at(a)[0] == at(f[0])[0] && at(b)[0] == at(f[0])[0]) continue;
        if (isLeft(f[0], f[1], f[2], a) == isLeft(f[0], f[1], f[2], b)) continue;
        const bool side = isLeft(a, b, f[0], f[1]);
        if (isLeft(a, b, f[1], f[2]) == side && isLeft(a, b, f[2], f[0]) == side)
          found.insert({{a, b}, {f[0], f[1], f[2]}});
      }
  return found;
}

/// @brief Two flat sheets that cross along a line, at rest.
Mesh crossingSheets() {
  Mesh mesh = grid(10, {0, 0, 0.013}, {1, 0, 0}, {0, 1, 0.0});
  const Mesh upright = grid(10, {0.4071, 0.0173, -0.4}, {0, 1, 0}, {0, 0, 1});
  const int offset = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), upright.vertices.begin(),
                       upright.vertices.end());
  for (const auto& t : upright.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return mesh;
}

TEST_F(CcdAnswers, EveryCrossingIsARowAndPainted) {
  const Mesh mesh = crossingSheets();
  const std::set<EdgeAndFace> expected = crossingsOf(mesh);
  ASSERT_GT(expected.size(), 20u);
  writeText(path("a.obj"), toObj(mesh));
  const std::string out = outputOf(
      "run a.obj a.obj --contacts c.csv --columns triangles,position --steps s.jsonl "
      "--json r.json --paint p.ply");
  EXPECT_TRUE(contains(out, "1 step, 0 vf and 0 ee contacts; 1 step began crossing"));

  std::set<EdgeAndFace> found;
  std::set<int> ids;
  for (const auto& row : rows()) {
    ASSERT_EQ(row.size(), 14u);
    EXPECT_EQ(row[1], "crossing");
    EXPECT_EQ(row[6] + ' ' + row[7], "0 0");
    const auto id = [&](std::size_t column) { return std::stoi(row[column]); };
    const EdgeAndFace pair{{id(2), id(3)}, {id(4), id(5), id(13)}};
    EXPECT_TRUE(found.insert(pair).second);
    const auto& face = mesh.triangles[static_cast<std::size_t>(id(9))];
    EXPECT_EQ(std::set<int>(face.begin(), face.end()), pair.second);
    for (const int vertex : face) ids.insert(vertex);
    ids.insert({id(2), id(3)});
    // The point is on both sheets.
    EXPECT_NEAR(std::stod(row[10]), 0.4071, 1e-12);
    EXPECT_NEAR(std::stod(row[12]), 0.013, 1e-12);
  }
  EXPECT_EQ(found, expected);

  const Json line = Json::parse(linesOf(readText(path("s.jsonl")))[1]);
  EXPECT_EQ(line.at("contacts"),
            Json({{"vf", 0}, {"ee", 0}, {"crossing", expected.size()}}));
  const std::vector<std::string> row = rows()[0];
  EXPECT_EQ(line.at("first").at("kind"), "crossing");
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(std::to_string(line.at("first").at("vertices").at(i).get<int>()),
              row[i < 4 ? 2 + i : 13]);
  EXPECT_EQ(json("r.json").at("steps").at(0).at("first"), line.at("first"));

  const std::string file = readText(path("p.ply"));
  const std::size_t body = file.find("end_header\n") + 11;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    EXPECT_EQ(file.substr(body + 27 * v + 24, 3) == std::string("\x96\x00\xc8", 3),
              ids.count(static_cast<int>(v)) > 0)
        << v;
}

// The same, for each way to ask, and whichever mesh has the edge.
TEST_F(CcdAnswers, CrossingsOfTwoMeshesNameBoth) {
  const Mesh whole = floorAndTip(2);
  writeText(path("floor.obj"),
            toObj({{whole.vertices.begin(), whole.vertices.begin() + 3}, {{0, 1, 2}}}));
  writeText(path("tip.obj"),
            toObj({{whole.vertices.begin() + 3, whole.vertices.end()}, {{0, 1, 2}}}));
  for (const char* query : {"all", "first", "any"}) {
    outputOf("run floor.obj floor.obj --against tip.obj --contacts c.csv --query " +
             std::string(query));
    const auto of_b = rows();
    ASSERT_EQ(of_b.size(), std::string(query) == "any" ? 1u : 2u);
    for (const auto& row : of_b) {
      EXPECT_EQ(row[2][0], 'b');
      EXPECT_EQ(row[3][0], 'b');
      for (const std::size_t i : {4u, 5u, 8u}) EXPECT_NE(row[i][0], 'b');
    }
    outputOf("run tip.obj tip.obj --against floor.obj --contacts c.csv --query " +
             std::string(query));
    for (const auto& row : rows()) {
      EXPECT_NE(row[2][0], 'b');
      for (const std::size_t i : {4u, 5u, 8u}) EXPECT_EQ(row[i][0], 'b');
    }
  }
}

// Nothing is before a crossing, so that later contacts are not among the first ones.
TEST_F(CcdAnswers, TheFirstOfACrossingStepAreItsCrossings) {
  const Mesh crossing = moved(floorAndTip(2), 100, 0);
  Mesh from = floorAndTip(0), to = floorAndTip(2);
  for (Mesh* mesh : {&from, &to}) {
    for (const auto& p : crossing.vertices) mesh->vertices.push_back(p);
    for (const auto& t : crossing.triangles)
      mesh->triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  writeText(path("from.obj"), toObj(from));
  writeText(path("to.obj"), toObj(to));
  outputOf("run from.obj to.obj --contacts c.csv");
  EXPECT_EQ(rows().size(), 3u);
  outputOf("run from.obj to.obj --contacts c.csv --query first");
  ASSERT_EQ(rows().size(), 2u);
  for (const auto& row : rows()) EXPECT_EQ(row[1], "crossing");
}

// Steps have the numbers of the frames where they begin.
TEST_F(CcdAnswers, StartKeepsTheNumbersOfFrames) {
  writeFrames(12);
  const std::string range = " --start 2 --end 10 --stride 2";
  for (const std::string word : {"f/tip%d.ply", "f", "'f/*.ply'"}) {
    const std::string out = outputOf("run " + word + range + kOutputs);
    std::vector<std::string> numbers;
    const std::vector<std::string> table = linesOf(out),
                                   steps = linesOf(readText(path("s.jsonl")));
    ASSERT_EQ(steps.size(), 6u);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t number = 2 + 2 * i;
      EXPECT_EQ(table[1 + i].substr(0, 5), "   " + std::to_string(number) + ' ') << out;
      EXPECT_EQ(Json::parse(steps[1 + i]).at("step"), number);
    }
    for (const auto& row : rows()) EXPECT_GE(std::stoi(row[0]), 2);
    EXPECT_TRUE(contains(
        out, "first contact: step 2 at 0, between f/tip2.ply and f/tip4.ply: crossing,"))
        << out;
    const auto whole = takeOutputs();
    // Continued in the middle.
    writeText(path("c.csv"), whole.first.substr(0, whole.first.size() / 2));
    writeText(path("s.jsonl"), whole.second.substr(0, whole.second.size() * 3 / 4));
    EXPECT_EQ(outputsOf("run " + word + range + " --resume"), whole);
    writeText(path("c.csv"), whole.first);
    EXPECT_EQ(run("run " + word + range +
                  " --resume --contacts c.csv --columns "
                  "triangles,position,normal")
                  .exit_code,
              0);
    EXPECT_EQ(readText(path("c.csv")), whole.first);
    writeText(path("c.csv"), whole.first);
    expectFailure("run " + word +
                      " --start 1 --resume --contacts c.csv --columns "
                      "triangles,position,normal --stride 2",
                  "of these frames");
    fs::remove(path("c.csv"));
  }
}

TEST_F(CcdAnswers, TheTableFitsEightyColumns) {
  writeTip();
  writeText(path("b.obj"), toObj(moved(edgeAlongX(), -1.5, 1)));
  for (const std::string distance : {"", " --thickness 0.5"})
    for (const std::string query : {"all", "first", "any"})
      for (const std::string frames : {"tip0.obj tip1.obj", "tip1.obj tip0.obj"}) {
        const std::vector<std::string> lines = linesOf(
            outputOf("run " + frames + " --against b.obj --query " + query + distance));
        for (const std::string& line : lines) EXPECT_LE(line.size(), 80u) << line;
        // A word of the head ends where the number below it ends.
        const std::size_t ms = lines[0].find(" ms ");
        ASSERT_NE(ms, std::string::npos);
        EXPECT_EQ(lines[1][ms + 3], ' ') << lines[0] << '\n' << lines[1];
        EXPECT_NE(lines[1][ms + 2], ' ') << lines[0] << '\n' << lines[1];
      }
}

/// @brief Runs the program with a terminal of some columns as its stderr; returns what it
/// shows there.
std::string shownOn(int columns, const fs::path& folder) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  EXPECT_GE(terminal, 0);
  EXPECT_EQ(grantpt(terminal), 0);
  EXPECT_EQ(unlockpt(terminal), 0);
  const int screen = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  winsize size{};
  size.ws_col = static_cast<unsigned short>(columns);
  size.ws_row = 24;
  EXPECT_EQ(ioctl(screen, TIOCSWINSZ, &size), 0);
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder.c_str()) != 0 || std::freopen("out.txt", "w", stdout) == nullptr ||
        dup2(screen, STDERR_FILENO) < 0)
      _exit(99);
    execl(FCL_CCD_TOOL, "fcl-ccd", "run", "f", static_cast<char*>(nullptr));
    _exit(99);
  }
  close(screen);
  std::string shown;
  char block[4096];
  for (ssize_t n; (n = read(terminal, block, sizeof block)) > 0;)
    shown.append(block, static_cast<std::size_t>(n));
  close(terminal);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return shown;
}

TEST_F(CcdAnswers, TheProgressLineFitsTheTerminal) {
  writeFrames(20);
  for (const int columns : {200, 80, 60, 30, 10}) {
    const std::string shown = shownOn(columns, path(""));
    EXPECT_TRUE(contains(shown, columns < 30 ? "of 19" : "of 19 steps")) << shown;
    std::istringstream lines(shown);
    for (std::string line; std::getline(lines, line, '\r');) {
      const std::string text = line.substr(0, line.find('\x1b'));
      EXPECT_LT(text.size(), static_cast<std::size_t>(std::min(columns, 80))) << text;
    }
    if (columns >= 80) {
      EXPECT_TRUE(contains(shown, " left")) << shown;
    }
  }
}

TEST_F(CcdAnswers, OneHasNoPlural) {
  writeFrames(2);
  Mesh bad = floorAndTip(0);
  bad.vertices[4][1] = HUGE_VAL;  // no check of the layout sees it
  writeText(path(frameName(1)), toBinaryPly<double>(bad, false));
  const Outcome outcome = run("run f" + kOutputs);
  EXPECT_EQ(outcome.exit_code, 3);
  // No step is anywhere.
  EXPECT_EQ(linesOf(outcome.err).back(), "fcl-ccd: stopped after 0 of 1 step");
  writeEdges();
  EXPECT_TRUE(contains(outputOf("run x0.off x1.off --against y0.ply y1.ply"),
                       "0 vf and 1 ee contact; 0 steps began"));
}

TEST_F(CcdAnswers, MistypedWordsGetASuggestion) {
  writeTip();
  for (const auto& [arguments, suggestion] :
       {std::pair<std::string, std::string>{"rnu tip0.obj tip1.obj", "mean 'run'?"},
        {"querys q.csv", "mean 'queries'?"},
        {"run tip0.obj tip1.obj --contcts c.csv", "mean --contacts?"},
        {"run tip0.obj tip1.obj --thikness=1", "mean --thickness?"},
        {"queries q.csv --kind vf --prnt", "mean --print?"}}) {
    SCOPED_TRACE(arguments);
    expectFailure(arguments, suggestion);
  }
  const Outcome far = run("walk tip0.obj tip1.obj");
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_FALSE(contains(far.err, "mean")) << far.err;
  EXPECT_TRUE(contains(far.err, "run, candidates, queries, compare")) << far.err;
}

TEST_F(CcdAnswers, APictureIsAPly) {
  writeTip();
  for (const char* name : {"p.obj", "p.png", "p.PLYX"})
    expectFailure("run tip0.obj tip1.obj --paint " + std::string(name),
                  std::string(name) + ": cannot write: this option writes PLY");
  outputOf("run tip0.obj tip1.obj --paint p.PLY");
  EXPECT_EQ(readText(path("p.PLY")).substr(0, 4), "ply\n");
  outputOf("run tip0.obj tip1.obj --paint /dev/null");
}

// The contact is at 1/2: a bracket of a few units in the last place.
TEST_F(CcdAnswers, ATocErrOfZeroIsTheNarrowestBracket) {
  writeTip();
  outputOf("run tip0.obj tip1.obj --toc-err 0 --contacts c.csv");
  ASSERT_EQ(rows().size(), 1u);
  const double lo = std::stod(rows()[0][6]), hi = std::stod(rows()[0][7]);
  EXPECT_LE(lo, 0.5);
  EXPECT_GE(hi, 0.5);
  EXPECT_LE(hi - lo, 1e-14);
}

TEST_F(CcdAnswers, JobsWithThreadsSayWhatTheyDo) {
  writeFrames(5);
  const auto noteOf = [&](const std::string& options) {
    return run("run f " + options).err;
  };
  EXPECT_EQ(noteOf("--jobs 2 --threads 3"),
            "fcl-ccd: 2 steps at the same time, with 3 threads each\n");
  EXPECT_EQ(noteOf("--jobs 1 --threads 1"),
            "fcl-ccd: 1 step at the same time, with 1 thread each\n");
  EXPECT_EQ(noteOf("--jobs 2"), "");
}

}  // namespace

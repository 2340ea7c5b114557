// SPDX-License-Identifier: BSD-3-Clause
//
// What the program fcl-ccd says about the first contact of a run: its sentence and its
// data name the frames, the time, the features and their triangles, and the place.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "ccd_sequence.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;

/// A text with every run of white space as one blank.
std::string inOneLine(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Eigen::Vector3d vectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

class CcdFirstContact : public CcdSequence {
 protected:
  std::string outputOf(const std::string& arguments) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << '\n' << outcome.err;
    return outcome.out;
  }

  Json summaryOf(const std::string& name) const {
    return Json::parse(readText(path(name))).at("summary");
  }

  /// @brief Expects that `out` has the sentence, and that its lines are not too long.
  static void expectSentence(const std::string& out, const std::string& sentence) {
    EXPECT_TRUE(contains(inOneLine(out), sentence)) << out;
    for (const std::string& line : linesOf(out)) EXPECT_LE(line.size(), 80u) << line;
  }
};

TEST_F(CcdFirstContact, VertexFaceIsNamedWithItsPlace) {
  writeTip();
  const std::string out =
      outputOf("run tip0.obj tip0.obj tip1.obj --json r.json --toc-err 0");
  expectSentence(out,
                 "first contact: step 1 at 0.5, between tip0.obj and tip1.obj: "
                 "vertex-face, vertex 3 of triangle 1 meets face 0 1 2 of triangle 0 at "
                 "(0, 0, 0), normal (0, 0, -1)");
  const Json first = summaryOf("r.json").at("first");
  EXPECT_EQ(first.at("step"), 1);
  EXPECT_EQ(first.at("files"), Json({"tip0.obj", "tip1.obj"}));
  EXPECT_EQ(first.at("kind"), "vf");
  EXPECT_EQ(first.at("vertices"), Json({3, 0, 1, 2}));
  EXPECT_EQ(first.at("triangles"), Json({1, 0}));
  EXPECT_LE(first.at("toc_lo"), 0.5);
  EXPECT_GE(first.at("toc_hi"), 0.5);
  EXPECT_LT(vectorOf(first.at("position")).norm(), 1e-12);
  EXPECT_LT((vectorOf(first.at("normal")) + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_EQ(first.at("as_early"), 0);
}

TEST_F(CcdFirstContact, EdgesOfBothMeshesAreNamed) {
  writeEdges();
  const std::string out =
      outputOf("run y0.ply y1.ply --against x0.off --json r.json --toc-err 0");
  EXPECT_TRUE(contains(inOneLine(out), "edge-edge, edge 0 1 of triangle 0 meets edge b"))
      << out;
  EXPECT_TRUE(contains(inOneLine(out), " of triangle b0 at (0, 0, 0), normal (0, 0, -1)"))
      << out;
  const Json first = summaryOf("r.json").at("first");
  EXPECT_EQ(first.at("kind"), "ee");
  EXPECT_EQ(first.at("triangles"), Json({0, "b0"}));
  EXPECT_EQ(first.at("files"), Json({"y0.ply", "y1.ply", "x0.off"}));
}

TEST_F(CcdFirstContact, CrossingPassesThroughAFace) {
  writeTip();
  const std::string out = outputOf("run tip1.obj tip1.obj");
  EXPECT_TRUE(contains(inOneLine(out),
                       "first contact: step 0 at 0, between tip1.obj and "
                       "tip1.obj: crossing, edge 3 "))
      << out;
  EXPECT_TRUE(contains(inOneLine(out),
                       " of triangle 1 passes through face 0 1 2 of triangle 0 at ("))
      << out;
  // Two edges of the tip are below the floor.
  EXPECT_TRUE(contains(inOneLine(out), "; 1 other may be as early")) << out;
}

TEST_F(CcdFirstContact, NearFeaturesAndFreePointsAreNamed) {
  const std::string point = "v 0 0 ", floor = toObj(edgeAlongX());
  writeText(path("p0.obj"), point + "3\np 1\n");
  writeText(path("p1.obj"), point + "0.5\np 1\n");
  writeText(path("b.obj"), floor);
  const std::string out =
      outputOf("run p0.obj p1.obj --against b.obj --no-self --thickness 1 --json r.json");
  EXPECT_TRUE(
      contains(inOneLine(out), "vertex-edge, vertex 0 of free point 0 comes near edge b"))
      << out;
  const Json first = summaryOf("r.json").at("first");
  EXPECT_EQ(first.at("triangles"), Json({"p0", "b0"}));
  EXPECT_NEAR(first.at("toc_lo").get<double>(), 0.8, 1e-3);
}

TEST_F(CcdFirstContact, NoContactIsSaid) {
  writeTip();
  const std::string out = outputOf("run tip0.obj tip0.obj tip0.obj --json r.json");
  EXPECT_TRUE(contains(out, "\nno contact in 2 steps\n")) << out;
  EXPECT_FALSE(contains(out, "first contact")) << out;
  EXPECT_TRUE(summaryOf("r.json").at("first").is_null());
}

// The contact was found before the run was stopped: the list of steps has all of it.
TEST_F(CcdFirstContact, ResumedRunNamesTheContactOfBefore) {
  writeFrames(6);
  const std::string all = "run f --json r.json --steps s.jsonl";
  const std::string whole = outputOf(all);
  const Json summary = summaryOf("r.json");
  EXPECT_EQ(summary.at("first").at("step"), 1);
  const std::vector<std::string> lines = linesOf(readText(path("s.jsonl")));
  ASSERT_EQ(lines.size(), 7u);
  std::string beginning;
  for (std::size_t i = 0; i < 4; ++i) beginning += lines[i] + '\n';
  writeText(path("s.jsonl"), beginning);
  const std::string resumed = outputOf(all + " --resume");
  EXPECT_EQ(summaryOf("r.json"), summary);
  const auto sentence = [](const std::string& out) {
    return out.substr(out.find("first contact:"),
                      out.find("slowest:") - out.find("first contact:"));
  };
  EXPECT_EQ(sentence(resumed), sentence(whole));
}

}  // namespace

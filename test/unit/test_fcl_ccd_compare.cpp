// SPDX-License-Identifier: BSD-3-Clause
//
// The command `compare` of fcl-ccd: it counts what differs from the truth, in the layouts
// of the public data.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "ccd_tool.h"
#include "shared_data.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;

class CcdCompare : public fcl::test::CcdToolTest {
 protected:
  /// @brief The figures of a comparison, and those of its row by their names.
  Json compare(const std::string& arguments) {
    const Outcome outcome = run("compare " + arguments + " --json r.json");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    Json figures = Json::parse(readText(path("r.json")));
    const std::vector<std::string> lines = linesOf(outcome.out);
    EXPECT_EQ(lines.size(), 2u) << outcome.out;
    if (lines.size() == 2) row_ = lines[1];
    return figures;
  }

  /// @brief The last row as words.
  std::vector<std::string> row() const {
    std::istringstream in(row_);
    return {std::istream_iterator<std::string>(in), std::istream_iterator<std::string>()};
  }

  /// @brief Writes frames/tip7.obj and frames/tip8.obj, whose vertex 3 meets the face of
  /// the floor.
  void writeFrames() const {
    for (const char* folder : {"frames", "boxes", "mma_bool"})
      fs::create_directories(path(folder));
    writeText(path("frames/tip7.obj"), toObj(floorAndTip(0)));
    writeText(path("frames/tip8.obj"), toObj(floorAndTip(2)));
  }

 private:
  std::string row_;
};

const std::string kFrames = "frames/tip7.obj frames/tip8.obj";

/// @brief Eight rows: a vertex falls through a triangle at t = 1/2, or past it.
std::string queryRows(bool hit, const std::string& truth) {
  std::string rows;
  for (const char* z : {"2", "-2"}) {
    rows += (hit ? "0,0," : "50,0,") + std::string(z) + truth + '\n';
    for (const char* corner : {"-8,-8,0", "8,-8,0", "0,8,0"})
      rows.append(corner).append(truth).append(1, '\n');
  }
  return rows;
}

TEST_F(CcdCompare, CountsQueriesThatDifferFromTheirRows) {
  writeText(path("a_vf.csv"), queryRows(true, ",1") + queryRows(false, ",0") +
                                  queryRows(false, ",1") + queryRows(true, ",0") +
                                  queryRows(true, ",0"));
  const Json figures = compare("a_vf.csv");
  EXPECT_EQ(figures.at("files"), Json({"a_vf.csv"}));
  EXPECT_EQ(figures.at("queries"), 5);
  EXPECT_EQ(figures.at("true"), 2);
  EXPECT_EQ(figures.at("contacts"), 3);
  EXPECT_EQ(figures.at("false_negatives"), 1);
  EXPECT_EQ(figures.at("false_positives"), 2);
  EXPECT_EQ(figures.at("uncertain"), 0);
  EXPECT_EQ(figures.at("queries_not_doubles"), 0);
  EXPECT_TRUE(figures.at("wrong_times").is_null());
  EXPECT_TRUE(figures.at("time_error").is_null());
  const double mean = figures.at("us_per_query").at("mean"),
               max = figures.at("us_per_query").at("max");
  EXPECT_TRUE(0 < mean && mean <= max) << mean << ' ' << max;
  const std::vector<std::string> words = row();
  ASSERT_EQ(words.size(), 10u);
  EXPECT_EQ(std::vector<std::string>(words.begin(), words.begin() + 8),
            (std::vector<std::string>{"5", "2", "3", "1", "2", "0", "-", "-"}));
}

TEST_F(CcdCompare, TellsTheLargestTimeError) {
  writeText(path("a_vf.csv"),
            queryRows(true, ",1,0.5") + queryRows(true, ",1,") + queryRows(false, ",0,"));
  const double narrow = compare("a_vf.csv --toc-err 0").at("time_error");
  EXPECT_GE(narrow, 0);
  EXPECT_LE(narrow, 1e-15);
  const double wide = compare("a_vf.csv --toc-err 0.1").at("time_error");
  EXPECT_GT(wide, narrow);
  EXPECT_LE(wide, 0.1);
  EXPECT_EQ(compare("a_vf.csv --toc-err 0").at("wrong_times"), 0);
  writeText(path("a_vf.csv"), queryRows(true, ",1,0.5") + queryRows(true, ",1,0.75"));
  const Json wrong = compare("a_vf.csv --toc-err 0");
  EXPECT_NEAR(wrong.at("time_error").get<double>(), 0.25, 1e-15);
  EXPECT_EQ(wrong.at("wrong_times"), 1);
  EXPECT_EQ(row().at(6), "1");
}

TEST_F(CcdCompare, ReadsAnswersBesideTheQueries) {
  for (const char* folder : {"s/queries", "s/mma_bool"})
    fs::create_directories(path(folder));
  const std::string hit = queryRows(true, ""), miss = queryRows(false, "");
  writeText(path("s/queries/92vf.csv"), hit + miss);
  writeText(path("s/mma_bool/92vf_mma_bool.json"), "[true,\n false]");
  writeText(path("s/queries/7vf.csv"), hit + hit);
  writeText(path("s/mma_bool/7vf_mma_bool.json"), "[false, true]");
  const Json figures = compare("s");
  EXPECT_EQ(figures.at("files"),
            Json({"s/queries/7vf.csv", "s/mma_bool/7vf_mma_bool.json",
                  "s/queries/92vf.csv", "s/mma_bool/92vf_mma_bool.json"}));
  EXPECT_EQ(figures.at("queries"), 4);
  EXPECT_EQ(figures.at("true"), 2);
  EXPECT_EQ(figures.at("false_negatives"), 0);
  EXPECT_EQ(figures.at("false_positives"), 1);
  // In the order of the files, whatever their names.
  writeText(path("all.json"), "[true, true]");
  writeText(path("none.json"), "[false, false]");
  const Json named = compare("s --truth all.json none.json");
  EXPECT_EQ(named.at("false_negatives"), 0);
  EXPECT_EQ(named.at("false_positives"), 1);
}

TEST_F(CcdCompare, RefusesAnswersThatDoNotFit) {
  writeText(path("q_vf.csv"), queryRows(true, ""));
  expectFailure("compare q_vf.csv",
                "q_vf.csv: does not tell the truth, and there is no "
                "file of answers");
  const auto expectRefused = [&](const std::string& json, const std::string& cause) {
    writeText(path("t.json"), json);
    expectFailure("compare q_vf.csv --truth t.json --json r.json", "t.json: " + cause);
  };
  expectRefused("", "the file is empty");
  expectRefused("[true", "is not JSON: ");
  expectRefused("{\"a\": true}", "is not an array of JSON");
  expectRefused("[1]", "entry 0: '1' is not true or false");
  expectRefused("[true, false]", "has 2 answers; q_vf.csv has 1 queries");
  expectRefused("[]", "has 0 answers; q_vf.csv has 1 queries");
  expectFailure("compare q_vf.csv --truth missing.json", "missing.json: cannot open");
  writeText(path("t.json"), "[true]");
  expectFailure("compare q_vf.csv --truth t.json t.json",
                "--truth names 2 files and there are 1 files of queries");
  expectFailure("compare q_vf.csv --truth t.json --json t.json",
                "t.json: cannot write: it is also given");
  writeText(path("q_vf.csv"), queryRows(true, ",0"));
  expectFailure("compare q_vf.csv --truth t.json",
                "t.json: entry 0 differs from the truth "
                "in the rows of q_vf.csv");
}

TEST_F(CcdCompare, CountsCandidatesAndContactsOfFrames) {
  writeFrames();
  // Six vertices; six edges, 6 to 11; the floor is face 12. Vertex 4 stays above it.
  writeText(path("boxes/7vf.json"), "[[4, 12], [3, 12]]");
  writeText(path("mma_bool/7vf_mma_bool.json"), "[false, true]");
  Json figures = compare(kFrames);
  EXPECT_EQ(figures.at("files"), Json({"frames/tip7.obj", "frames/tip8.obj",
                                       "boxes/7vf.json", "mma_bool/7vf_mma_bool.json"}));
  EXPECT_EQ(figures.at("listed"), 2);
  EXPECT_EQ(figures.at("true"), 1);
  EXPECT_EQ(figures.at("candidates"), 1);
  EXPECT_EQ(figures.at("found"), 1);
  EXPECT_EQ(figures.at("missing"), 1);
  EXPECT_EQ(figures.at("contacts"), 1);
  EXPECT_EQ(figures.at("false_negatives"), 0);
  EXPECT_EQ(figures.at("false_positives"), 0);
  EXPECT_GT(figures.at("ms").get<double>(), 0);
  const std::vector<std::string> words = row();
  ASSERT_EQ(words.size(), 9u);
  EXPECT_EQ(std::vector<std::string>(words.begin(), words.begin() + 8),
            (std::vector<std::string>{"2", "1", "1", "1", "1", "1", "0", "0"}));

  writeText(path("mma_bool/7vf_mma_bool.json"), "[true, false]");
  figures = compare(kFrames);
  EXPECT_EQ(figures.at("false_negatives"), 1);
  EXPECT_EQ(figures.at("false_positives"), 1);
}

TEST_F(CcdCompare, AContactThatIsNotListedIsAFalsePositive) {
  writeFrames();
  writeText(path("boxes/7vf.json"), "[[4, 12]]");
  writeText(path("boxes/7vf_mma_bool.json"), "[false]");
  const Json figures = compare(kFrames);
  EXPECT_EQ(figures.at("contacts"), 1);
  EXPECT_EQ(figures.at("false_negatives"), 0);
  EXPECT_EQ(figures.at("false_positives"), 1);
}

TEST_F(CcdCompare, WithoutAnswersContactsAreNotJudged) {
  writeFrames();
  writeText(path("7_vf.json"), "[[3, 12]]");
  const Json figures = compare(kFrames + " --truth 7_vf.json");
  EXPECT_EQ(figures.at("found"), 1);
  EXPECT_EQ(figures.at("contacts"), 1);
  for (const char* name : {"true", "false_negatives", "false_positives"})
    EXPECT_TRUE(figures.at(name).is_null()) << name;
  EXPECT_EQ(row().at(1), "-");
}

// Edges are numbered by their higher vertex first: 1 2 comes before 0 3.
TEST_F(CcdCompare, NumbersEdgesByTheirHigherVertex) {
  for (const double drop : {0., 2.}) {
    // A square, and above its edge 1 2 the edge 4 5 of a triangle.
    const Mesh mesh{{{0, 0, 0},
                     {4, 0, 0},
                     {4, 4, 0},
                     {0, 4, 0},
                     {3, 2, 1 - drop},
                     {5, 2, 1 - drop},
                     {4, 2, 5 - drop}},
                    {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}};
    writeText(path(drop == 0 ? "f0.obj" : "f1.obj"), toObj(mesh));
  }
  // Seven vertices. Edges: 7: 0 1, 8: 0 2, 9: 1 2, 10: 0 3, 11: 2 3, 12: 4 5.
  writeText(path("a_ee.json"), "[[9, 12], [10, 12]]");
  writeText(path("a_ee_mma_bool.json"), "[true, false]");
  // 15 to 17 are the faces; vertex 4 falls into the square.
  writeText(path("a_vf.json"), "[[4, 15], [4, 16]]");
  writeText(path("a_vf_mma_bool.json"), "[true, false]");
  const Json edges = compare("f0.obj f1.obj --truth a_ee.json");
  EXPECT_EQ(edges.at("true"), 1);
  EXPECT_EQ(edges.at("contacts"), 1);
  EXPECT_EQ(edges.at("false_negatives"), 0);
  EXPECT_EQ(edges.at("false_positives"), 0);
  const Json both = compare("f0.obj f1.obj --truth a_ee.json a_vf.json");
  EXPECT_EQ(both.at("listed"), 4);
  EXPECT_EQ(both.at("true"), 2);
  EXPECT_EQ(both.at("contacts"), 2);
  EXPECT_EQ(both.at("false_negatives"), 0);
  EXPECT_EQ(both.at("false_positives"), 0);
  EXPECT_EQ(compare("f0.obj f1.obj --truth a_ee.json a_vf.json --kind vf").at("listed"),
            2);
}

TEST_F(CcdCompare, RefusesListsThatDoNotFit) {
  writeFrames();
  const auto expectRefused = [&](const std::string& json, const std::string& cause) {
    writeText(path("t_vf.json"), json);
    expectFailure("compare " + kFrames + " --truth t_vf.json", "t_vf.json: " + cause);
  };
  expectFailure("compare " + kFrames, "frames/tip7.obj: no list of pairs was found");
  expectRefused("[[1, 2], [3]]", "entry 1: '[3]' is not a pair of whole numbers");
  expectRefused("[[1, 2.5]]", "entry 0: '[1,2.5]' is not a pair of whole numbers");
  expectRefused("[[6, 12]]",
                "entry 0: 6 is not the number of a vertex: they have 0 to 5");
  expectRefused("[[3, 11]]",
                "entry 0: 11 is not the number of a face: they have 12 to 13");
  expectRefused("[[-1, 12]]", "entry 0: -1 is not the number of a vertex");
  expectRefused("[[3, -9223372036854775808]]",
                "entry 0: -9223372036854775808 is not the number of a face");
  writeText(path("t_ee.json"), "[[6, 12]]");
  expectFailure("compare " + kFrames + " --truth t_ee.json",
                "t_ee.json: entry 0: 12 is not the number of an edge: they have 6 to 11");
  writeText(path("t_vf.json"), "[[3, 12]]");
  writeText(path("t_vf_mma_bool.json"), "[true, true]");
  expectFailure("compare " + kFrames + " --truth t_vf.json",
                "t_vf_mma_bool.json: has 2 answers to 1 pair of t_vf.json");
  expectFailure("compare " + kFrames + " --truth t_vf_mma_bool.json", "no list of pairs");
  expectFailure("compare " + kFrames + " --truth t_vf.json t_vf.json",
                "t_vf.json: is for the same pairs as t_vf.json");
  expectFailure("compare " + kFrames + " --truth tree.json",
                "tree.json: its name does not");
  expectFailure("compare frames/tip7.obj --truth t_vf.json",
                "A needs two frames or more");
  expectFailure("compare " + kFrames + " frames/tip7.obj --truth t_vf.json",
                "A has 3 frames");
}

TEST_F(CcdCompare, PublicQueriesHaveNoError) {
  const auto folder = fcl::test::sharedData("queries");
  if (!folder) GTEST_SKIP() << fcl::test::kNoSharedData;
  const Json figures = compare("'" + *folder + "'");
  EXPECT_EQ(figures.at("queries"), 4120);
  EXPECT_EQ(figures.at("true"), 160);
  EXPECT_EQ(figures.at("contacts"), 160);
  EXPECT_EQ(figures.at("false_negatives"), 0);
  EXPECT_EQ(figures.at("false_positives"), 0);
  EXPECT_EQ(figures.at("queries_not_doubles"), 0);
}

}  // namespace

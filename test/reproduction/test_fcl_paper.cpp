// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the paper's experiments on tiny scenes: the tables must be complete, the library
// without an error, and frames in which something breaks like any other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "csv_rows.h"

namespace fcl {
namespace test {
namespace {

const std::string kFolder = std::string(FCL_CCD_BINARY_DIR) + "/paper_short";

void runProgram(const std::string& command) {
  const std::string line = command + " 2>'" + kFolder + "/errors.txt'";
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
}

/// Of each a few frames are measured, in which things touch; letters break in the eighth.
void makeTables() {
  std::filesystem::remove_all(kFolder);
  std::filesystem::create_directories(kFolder);
  const std::string scenes = "'" FCL_CCD_SCENES "' '" + kFolder + "' --meshes";
  runProgram(scenes + " --scenes cloth flamenco --scale 0.01 --frames 24");
  runProgram(scenes + " --scenes alphabets --scale 0.2 --frames 30");
  runProgram("'" FCL_CCD_PAPER "' '" + kFolder + "' --frames '" + kFolder +
             "' --scenes alphabets cloth flamenco --every 7 --repeats 1 --sample 500");
}

/// The simulator has answered all contacts of its own steps.
void checkAnsweredFrames() {
  const std::string folder = kFolder + "/answered";
  runProgram("'" FCL_CCD_PAPER "' '" + folder + "' --frames '" + kFolder +
             "' --kind answered --scenes alphabets cloth flamenco --every 7 --repeats 1 "
             "--sample 500");
  const auto scenes = readCsv(folder + "/paper_scenes.csv",
                              "scene,paper_triangles,triangles,vertices,frames,every,"
                              "contacts_a_frame,contacts_a_triangle,machine");
  EXPECT_EQ(scenes.size(), 3u);
  for (CsvRow row : scenes) EXPECT_EQ(row["contacts_a_frame"], "0") << row["scene"];
  double none = 0, plain = 0;
  for (CsvRow row : readCsv(folder + "/figure8.csv",
                            "scene,frames,boxes,filter,elementary_tests,reduction,"
                            "reduction_from_rtriangles,missed,extra")) {
    EXPECT_EQ(row["missed"], "0");
    if (row["boxes"] != "iccd") continue;
    EXPECT_EQ(row["extra"], "0");
    (row["filter"] == "none" ? none : plain) += std::stod(row["elementary_tests"]);
  }
  EXPECT_GT(none, 4 * plain);
}

void checkTable1() {
  std::map<std::string, std::map<std::string, CsvRow>> scenes;
  for (CsvRow row :
       readCsv(kFolder + "/table1.csv",
               "scene,triangles,frames,method,filter,kernels,query_ms,speedup_over_iccd,"
               "speedup_over_rtriangles,elementary_tests,missed,extra")) {
    const std::string name = row["method"] + "/" + row["filter"] + "/" + row["kernels"];
    SCOPED_TRACE(row["scene"] + ", " + name);
    EXPECT_TRUE(scenes[row["scene"]].emplace(name, row).second);
    EXPECT_EQ(row["frames"], row["scene"] == "alphabets" ? "4" : "3");
    EXPECT_GT(std::stod(row["query_ms"]), 0);
    // These scenes are free of what the methods of the papers are wrong about.
    EXPECT_EQ(row["missed"], "0");
    EXPECT_EQ(row["extra"], "0");
  }
  EXPECT_EQ(scenes.size(), 3u);
  for (auto& [scene, rows] : scenes) {
    SCOPED_TRACE(scene);
    std::set<std::string> expected{"feature boxes/none/scalar",
                                   "feature boxes/plain/scalar"};
    for (const std::string method : {"r-triangles", "iccd"})
      for (const char* variant : {"none/scalar", "plain/scalar", "none/vector",
                                  "plain/vector", "certified/vector"})
        expected.insert(method + "/" + variant);
    std::set<std::string> found;
    for (const auto& entry : rows)
      if (entry.first.rfind("ours", 0) != 0) found.insert(entry.first);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(rows.size(), expected.size() + 2);
    const auto tests = [&rows = rows](const std::string& name) {
      return std::stod(rows.at(name)["elementary_tests"]);
    };
    for (const std::string method : {"feature boxes", "r-triangles", "iccd"})
      EXPECT_LE(tests(method + "/plain/scalar"), tests(method + "/none/scalar"));
    EXPECT_EQ(std::stod(rows.at("iccd/none/scalar")["speedup_over_iccd"]), 1);
    EXPECT_EQ(std::stod(rows.at("r-triangles/none/scalar")["speedup_over_rtriangles"]),
              1);
  }
}

void checkFigures() {
  std::map<std::string, double> tests;
  for (CsvRow row : readCsv(kFolder + "/figure8.csv",
                            "scene,frames,boxes,filter,elementary_tests,reduction,"
                            "reduction_from_rtriangles,missed,extra")) {
    tests[row["scene"] + "/" + row["boxes"] + "/" + row["filter"]] =
        std::stod(row["elementary_tests"]);
    EXPECT_EQ(row["missed"], "0");
  }
  EXPECT_EQ(tests.size(), 3u * 7);
  for (const std::string scene : {"alphabets", "cloth", "flamenco"}) {
    EXPECT_GT(tests[scene + "/ours/certified"], 0);
    EXPECT_LE(tests[scene + "/ours/plain"], tests[scene + "/ours/none"]);
    EXPECT_LE(tests[scene + "/ours/none"], tests[scene + "/r-triangles/none"]);
  }
  EXPECT_EQ(readCsv(kFolder + "/figure6.csv",
                    "scene,frame,culling,edge_pairs,edges,share_of_pairs")
                .size(),
            3u);
  EXPECT_GT(std::filesystem::file_size(kFolder + "/figure6.png"), 10000u);
  EXPECT_EQ(readCsv(kFolder + "/figure9.csv",
                    "scene,frame,method,filter,kernels,query_ms,missed,extra")
                .size(),
            5u * 3);
  for (CsvRow row : readCsv(kFolder + "/figure10.csv",
                            "scene,frame,boxes,filter,feature_pairs,without_penetration,"
                            "ratio,missed,extra"))
    EXPECT_LE(std::stoi(row["without_penetration"]), std::stoi(row["feature_pairs"]));
}

void checkFilter() {
  const auto rows = readCsv(
      kFolder + "/filter.csv",
      "scene,pairs,filter_ns,newton_ns,newton_to_filter,left,newton_left_ns,"
      "newton_left_to_filter,filter_additions,filter_multiplications,newton_additions,"
      "newton_multiplications,newton_divisions,filter_missed,newton_missed,newton_extra");
  EXPECT_EQ(rows.size(), 3u);
  for (CsvRow row : rows) {
    EXPECT_EQ(row["pairs"], "500");
    EXPECT_LE(std::stoi(row["left"]), 500);
    EXPECT_EQ(row["filter_missed"], "0");
    // No branch: the same operations for every pair.
    EXPECT_EQ(row["filter_additions"], "35.0");
    EXPECT_EQ(row["filter_multiplications"], "36.0");
    EXPECT_GT(std::stod(row["newton_additions"]), 35);
  }
}

void checkTopologies() {
  int most = 0;
  for (CsvRow row : readCsv(kFolder + "/paper_topologies.csv",
                            "scene,method,filter,kernels,topologies,take_ms")) {
    if (row["scene"] == "alphabets")
      most = std::max(most, std::stoi(row["topologies"]));
    else
      EXPECT_EQ(row["topologies"], "1");
  }
  EXPECT_GT(most, 1) << "no frame in which something breaks was measured";
}

TEST(FCL_PAPER, tablesAreCompleteAndWithoutErrors) {
  ASSERT_NO_FATAL_FAILURE(makeTables());
  checkTable1();
  checkFigures();
  checkFilter();
  checkTopologies();
  checkAnsweredFrames();
}

}  // namespace
}  // namespace test
}  // namespace fcl

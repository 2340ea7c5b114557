// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the benchmark of speed on small scenes. Its tables must be complete, and its error
// figures must be those that are promised. The answers that it compares with are right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "csv_rows.h"
#include "kernels/kernels.h"
#include "machine.h"
#include "speed/distance_truth.h"

namespace fcl {
namespace test {
namespace {

const char* const kColumns =
    "scene,triangles,query,boxes,filter,kernels,threads,ms_build,ms_update,ms_traverse,"
    "ms_test,ms_total,contacts,missed,extra,hash,peak_mb,machine";

const std::string kPaper = "scalar (paper)";

bool hasScalarKernels() {
  const auto all = detail::deformable::allKernels();
  return std::any_of(all.begin(), all.end(),
                     [](const auto* set) { return areScalar(set->name); });
}

/// Runs the benchmark on small scenes.
/// @return the folder of the tables
std::string runShort(const std::string& name, const std::string& options) {
  const std::string folder = std::string(FCL_CCD_BINARY_DIR) + "/" + name;
  std::filesystem::create_directories(folder);
  const std::string command = "'" FCL_CCD_SPEED "' '" + folder + "' --short " + options +
                              " 2>'" + folder + "/errors.txt'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return folder;
}

TEST(FCL_SPEED, figuresAreConsistent) {
  const std::string folder = runShort("speed_short", "");

  std::map<std::string, int> rows_of;
  std::map<std::string, std::string> hash_of;
  std::string kernels, threads;
  for (CsvRow row : readCsv(folder + "/speed.csv", kColumns)) {
    const std::string name = row["scene"] + ", " + row["query"] + ", " + row["boxes"] +
                             ", " + row["filter"] + ", " + row["kernels"] + ", " +
                             row["threads"];
    SCOPED_TRACE(name);
    ++rows_of[row["scene"]];
    EXPECT_TRUE(hash_of.emplace(name, row["hash"]).second);
    if (kernels.empty()) kernels = row["kernels"];
    if (threads.empty() || row["threads"] != "1") threads = row["threads"];
    EXPECT_GT(std::stoi(row["triangles"]), 0);
    EXPECT_NEAR(std::stod(row["ms_update"]) + std::stod(row["ms_traverse"]) +
                    std::stod(row["ms_test"]),
                std::stod(row["ms_total"]), 0.01);
    EXPECT_EQ(row["hash"].size(), 16u);
    EXPECT_FALSE(row["machine"].empty());
    // The generated scenes avoid the weakness of the paper's method.
    for (const char* errors : {"missed", "extra"})
      if (row["kernels"] == kPaper || row[errors] != "-") {
        EXPECT_EQ(row[errors], "0");
      }
  }
  // If there is more than one thread, or more than one set of kernels, there are more
  // rows.
  const int n = threads == "1" ? 1 : 2,
            again = kernels == "scalar" || !hasScalarKernels() ? 0 : 2;
  const std::map<std::string, int> expected{{"smooth cloth 1K", 3 * n + 13 + again},
                                            {"smooth cloth 2K", 3 * n + 13 + again},
                                            {"smooth cloth 4K", 3 * n + 13 + again},
                                            {"tiles", 2 * n + 1},
                                            {"meeting bodies", 3 * n},
                                            {"smooth cloth 8K", 3 * n},
                                            {"cloth at the origin", 2 * n},
                                            {"cloth at 1e6", 2 * n + 1},
                                            {"crumple (kept tree)", 1},
                                            {"crumple (fresh tree)", 1},
                                            {"unfold (kept tree)", 1},
                                            {"unfold (fresh tree)", 1},
                                            {"wave (kept tree)", 1},
                                            {"wave (fresh tree)", 1},
                                            {"mix (kept tree)", 1},
                                            {"mix (fresh tree)", 1}};
  EXPECT_EQ(rows_of, expected);
  const auto hashOf = [&](const std::string& row) {
    return hash_of.at("smooth cloth 1K, all, " + row);
  };
  EXPECT_EQ(hashOf("swept, plain, " + kPaper + ", 1"),
            hashOf("moving, none, " + kPaper + ", 1"));
  EXPECT_EQ(hashOf("swept, plain, " + kPaper + ", 1"),
            hashOf("swept, certified, " + kernels + ", 1"));
  const std::string answer = hashOf("moving, certified, " + kernels + ", 1");
  EXPECT_EQ(hashOf("moving, certified, " + kernels + ", " + threads), answer);
  if (hasScalarKernels()) {
    EXPECT_EQ(hashOf("moving, certified, scalar, 1"), answer);
  }
  EXPECT_EQ(hash_of["cloth at the origin, all, moving, certified, " + kernels + ", 1"],
            hash_of["cloth at 1e6, all, moving, certified, " + kernels + ", " + threads]);

  std::map<std::string, int> baselines_of;
  std::map<std::string, std::string> tests_of;
  for (CsvRow row : readCsv(folder + "/speed_baselines.csv",
                            "scene,triangles,technique,filter,kernels,ms_build,ms_update,"
                            "ms_traverse,ms_test,ms_total,triangle_pairs,feature_pairs,"
                            "elementary_tests,contacts,missed,extra,machine")) {
    const std::string name = row["scene"] + ", " + row["technique"] + ", " +
                             row["filter"] + ", " + row["kernels"];
    SCOPED_TRACE(name);
    ++baselines_of[row["scene"]];
    tests_of[name] = row["elementary_tests"];
    EXPECT_EQ(row["missed"], "0");
    EXPECT_EQ(row["extra"], "0");
    EXPECT_LE(std::stoi(row["elementary_tests"]), std::stoi(row["feature_pairs"]));
  }
  const std::map<std::string, int> expected_baselines{{"smooth cloth 2K", 15},
                                                      {"tiles", 15}};
  EXPECT_EQ(baselines_of, expected_baselines);
  EXPECT_EQ(tests_of["tiles, r-triangles, none, scalar"],
            tests_of["tiles, r-triangles, none, vector"]);

  std::map<std::string, int> steps_of;
  for (CsvRow row : readCsv(folder + "/speed_sequence.csv",
                            "sequence,frame,contacts,ms_update,ms_kept,ms_fresh_build,"
                            "ms_fresh,ratio,ms_fresh_update,restructured,machine")) {
    EXPECT_EQ(std::stoi(row["frame"]), steps_of[row["sequence"]]++);
    EXPECT_GT(std::stod(row["ratio"]), 0);
  }
  const std::map<std::string, int> expected_steps{
      {"crumple", 3}, {"unfold", 3}, {"wave", 3}, {"mix", 3}};
  EXPECT_EQ(steps_of, expected_steps);
}

TEST(FCL_SPEED, optionsHaveNoErrors) {
  const std::string folder = runShort("speed_options", "--groups options");
  std::map<std::string, int> rows_of;
  for (CsvRow row : readCsv(folder + "/speed_options.csv",
                            "scene,triangles,option,query,ms_off,ms_on,ratio,contacts,"
                            "missed,extra,machine")) {
    SCOPED_TRACE(row["scene"] + ", " + row["option"] + ", " + row["query"]);
    ++rows_of[row["scene"]];
    EXPECT_EQ(row["missed"], "0");
    EXPECT_EQ(row["extra"], "0");
    if (row["option"].rfind("min_distance", 0) == 0 ||
        row["option"] == "safe displacements") {
      EXPECT_NE(row["contacts"], "0");
    }
  }
  const std::map<std::string, int> expected{
      {"smooth cloth 2K", 12}, {"layers", 1}, {"thrown spheres", 1}};
  EXPECT_EQ(rows_of, expected);
}

/// A triangle moves towards the same one below it, or away from it. Each feature of one
/// is as far from each feature of the other as their planes are.
TEST(FCL_SPEED, pairsWithinADistance) {
  using V = Vector3<double>;
  const auto pairsOf = [](double to, double d, bool ignores_initially_closer) {
    FramePairMesh mesh;
    for (const double height : {0., 1.})
      for (const V& p : {V(0, 0, 0), V(1, 0, 0), V(0, 1, 0)}) {
        mesh.previous.push_back(p + V(0, 0, height));
        mesh.current.push_back(p + V(0, 0, height * to));
      }
    mesh.triangles = {Triangle(0, 1, 2), Triangle(3, 4, 5)};
    return findPairsWithin(mesh, d, ignores_initially_closer);
  };
  constexpr std::size_t kPairs = 6 + 9;
  const auto reached = pairsOf(0.1, 0.25, false);
  EXPECT_EQ(reached.size(), kPairs);
  for (const PairWithin& pair : reached) EXPECT_NEAR(pair.toc, 0.75 / 0.9, 1e-6);
  EXPECT_TRUE(pairsOf(0.1, 0.0999999, false).empty());
  const auto nearer = pairsOf(0.1, 2, true);
  EXPECT_EQ(nearer.size(), kPairs);
  for (const PairWithin& pair : nearer) {
    EXPECT_GT(pair.toc, 0);
    EXPECT_LT(pair.toc, 1e-5);
  }
  EXPECT_EQ(pairsOf(1.1, 2, false).size(), kPairs);
  EXPECT_TRUE(pairsOf(1.1, 2, true).empty());
  // Through each other: the pairs are near for a sixteenth of the step.
  EXPECT_EQ(pairsOf(-1, 1. / 16, false).size(), kPairs);
}

}  // namespace
}  // namespace test
}  // namespace fcl

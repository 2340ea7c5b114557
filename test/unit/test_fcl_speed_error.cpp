// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the reports of speed against error on tiny sets. Their error figures must be those
// that are promised, and outside solvers must be read correctly.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "csv_rows.h"

namespace {

namespace fs = std::filesystem;
using fcl::test::CsvRow;
using fcl::test::readCsv;

const std::string kAnswerNo =
    FCL_CCD_SOURCE_DIR "/test/benchmark/speed_error/answer_no.sh";

class FCL_SPEED_ERROR : public ::testing::Test {
 protected:
  /// @return the program's exit code; its messages go to errors().
  int run(const std::string& options) const {
    const std::string command = "'" FCL_CCD_SPEED_ERROR "' '" + folder_.string() +
                                "' --short " + options + " 2>'" + path("errors.txt") +
                                "'";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string errors() const {
    std::ostringstream text;
    text << std::ifstream(path("errors.txt")).rdbuf();
    return text.str();
  }

  std::vector<CsvRow> readTable(const std::string& name,
                                const std::string& columns) const {
    return readCsv(path(name), columns);
  }

  std::vector<CsvRow> readMethods() const {
    return readTable("speed_error.csv",
                     "set,method,setting,queries,contacts,false_negatives,"
                     "false_positives,max_late,max_early,ns_mean,ns_median,ns_p999,"
                     "decided_box,decided_filter,decided_solver,decided_exact,machine");
  }

  /// A solver of one command, which finds the query file in $1.
  std::string solver(const std::string& name, const std::string& command) const {
    std::ofstream(path(name + ".sh")) << command << '\n';
    return " --solver " + name + "='sh " + path(name + ".sh") + "'";
  }

 private:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void SetUp() override { fs::create_directories(folder_); }

  const fs::path folder_ =
      fs::path(FCL_CCD_BINARY_DIR) / "speed_error_short" /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(FCL_SPEED_ERROR, figuresAreConsistent) {
  ASSERT_EQ(run("--solver no='" + kAnswerNo + "'" +
                solver("clocked", "'" + kAnswerNo + "' \"$1\"; echo ns_mean,42")),
            0)
      << errors();
  std::map<std::string, int> rows_of;
  std::string contacts;
  for (CsvRow row : readMethods()) {
    const std::string name = row["method"] + " " + row["setting"];
    SCOPED_TRACE(name);
    ++rows_of[row["method"]];
    EXPECT_EQ(row["set"], "generated");
    EXPECT_EQ(row["queries"], "2000");
    if (contacts.empty()) contacts = row["contacts"];
    EXPECT_EQ(row["contacts"], contacts);
    EXPECT_GT(std::stod(row["ns_mean"]), 0);
    EXPECT_GE(std::stod(row["max_late"]), 0);
    EXPECT_GE(std::stod(row["max_early"]), 0);
    EXPECT_FALSE(row["machine"].empty());

    double decided = 0;
    for (const char* stage : {"box", "filter", "solver", "exact"}) {
      const std::string share = row[std::string("decided_") + stage];
      if (!share.empty()) decided += std::stod(share);
    }
    const bool has_stages = row["method"].rfind("ours", 0) == 0;
    EXPECT_NEAR(decided, has_stages ? 1 : 0, 1e-5);
    if (has_stages) {
      EXPECT_EQ(row["false_negatives"], "0");
      EXPECT_EQ(row["max_late"], "0");
    }
    if (row["method"] == "ours") {
      EXPECT_EQ(row["false_positives"], "0");
      EXPECT_LE(std::stod(row["max_early"]), std::stod(row["setting"]));
    }
    if (row["method"] == "no" || row["method"] == "clocked") {
      EXPECT_EQ(row["false_negatives"], contacts);
      EXPECT_EQ(row["false_positives"], "0");
      EXPECT_EQ(row["setting"], row["method"] == "no" ? "wall clock" : "own clock");
    }
    if (row["method"] == "clocked") {
      EXPECT_EQ(row["ns_mean"], "42.0");
    }
  }
  EXPECT_GT(std::stoi(contacts), 100);
  EXPECT_LT(std::stoi(contacts), 1900);
  const std::map<std::string, int> expected{{"fcl-stock", 1},
                                            {"cubic", 3},
                                            {"interval-newton", 3},
                                            {"filter+interval-newton", 3},
                                            {"ours-without-exact", 2},
                                            {"ours", 4},
                                            {"no", 1},
                                            {"clocked", 1}};
  EXPECT_EQ(rows_of, expected);

  std::map<std::string, int> rows_of_stage;
  for (CsvRow row : readTable("filter_ratio.csv",
                              "set,stage,setting,queries,culled_rightly,culled_wrongly,"
                              "share_of_plain,ns_mean,cost_to_plain,additions,"
                              "multiplications,divisions,machine")) {
    SCOPED_TRACE(row["stage"]);
    ++rows_of_stage[row["stage"]];
    EXPECT_GT(std::stod(row["cost_to_plain"]), 0);
    EXPECT_LE(std::stoi(row["culled_rightly"]) + std::stoi(contacts), 2000);
    if (row["stage"].find("certified") != std::string::npos) {
      EXPECT_EQ(row["culled_wrongly"], "0");
    }
    if (row["stage"] == "plain") {
      EXPECT_EQ(row["share_of_plain"], "1.000000");
      EXPECT_EQ(row["additions"], "35.0");
      EXPECT_EQ(row["multiplications"], "36.0");
    }
  }
  const std::map<std::string, int> expected_stages{{"plain", 1},
                                                   {"certified", 1},
                                                   {"boxes+certified", 1},
                                                   {"cubic", 3},
                                                   {"interval-newton", 3}};
  EXPECT_EQ(rows_of_stage, expected_stages);
}

TEST_F(FCL_SPEED_ERROR, querySetsAreGivenInFull) {
  // Answers yes at t = 1 to the queries that it can read completely, which are all.
  const std::string yes =
      "awk -F, '!/^#/ && NF == 26 && ($2 == \"vf\" || $2 == \"ee\") "
      "{ print $1 \",1,1\" }' \"$1\"";
  ASSERT_EQ(run(solver("yes", yes)), 0) << errors();
  CsvRow row = readMethods().front();
  EXPECT_EQ(row["method"], "yes");
  EXPECT_EQ(row["false_negatives"], "0");
  EXPECT_EQ(std::stoi(row["false_positives"]), 2000 - std::stoi(row["contacts"]));
  EXPECT_EQ(row["max_early"], "0");
}

TEST_F(FCL_SPEED_ERROR, aSolverThatFailsIsNamed) {
  const struct {
    const char* command;
    const char* says;
  } cases[] = {{"exit 3", "the program failed"},
               {"true", "it answered 0 of 2000"},
               {"echo 0,0,; echo 0,0,", "line 2"},
               {"echo 2000,0,", "line 1"},
               {"echo 0,1,", "line 1"},
               {"echo 0,1,nan", "line 1"},
               {"echo 0,1,1.5", "line 1"},
               {"echo 0,maybe", "line 1"}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.command);
    EXPECT_EQ(run(solver("broken", c.command)), 1);
    EXPECT_NE(errors().find("solver broken, set generated: "), std::string::npos);
    EXPECT_NE(errors().find(c.says), std::string::npos) << errors();
  }
  EXPECT_EQ(run("--solver nothing"), 1);
  EXPECT_NE(errors().find("NAME=COMMAND"), std::string::npos);
}

TEST(FCL_DISTANCES, figuresAreThosePromised) {
  const std::string folder = FCL_CCD_BINARY_DIR "/distances";
  const std::string command =
      "'" FCL_CCD_DISTANCES "' '" + folder + "' --queries 20 --repeats 1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::map<std::string, int> rows_of;
  for (CsvRow row : readCsv(folder + "/distances.csv",
                            "set,method,setting,queries,contacts,false_negatives,"
                            "false_positives,false_positives_far,max_late,max_early,"
                            "ns_mean,machine")) {
    SCOPED_TRACE(row["set"] + ", " + row["method"] + ", " + row["setting"]);
    ++rows_of[row["method"]];
    EXPECT_EQ(row["queries"], "20");
    EXPECT_GT(std::stoi(row["contacts"]), 0);
    EXPECT_GT(std::stod(row["ns_mean"]), 0);
    if (row["method"] != "ours") continue;
    EXPECT_EQ(row["false_negatives"], "0");
    EXPECT_EQ(row["false_positives_far"], "0");
    EXPECT_EQ(row["max_late"], "0");
  }
  const std::map<std::string, int> expected{
      {"ours", 4}, {"inclusion", 4}, {"additive", 4}};
  EXPECT_EQ(rows_of, expected);
}

}  // namespace

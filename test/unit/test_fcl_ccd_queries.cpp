// SPDX-License-Identifier: BSD-3-Clause
//
// The command `queries` of fcl-ccd: what it reads, what it answers, and its lists of
// columns, which the contact list has too.
#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ccd_json.h"
#include "ccd_tool.h"
#include "csv_rows.h"
#include "shared_data.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;

class CcdQueries : public fcl::test::CcdJsonTest {};

/// @brief One query in the format of the CSV files: points x denominators `den`.
std::string queryRows(const std::vector<std::array<int, 3>>& points, const char* den,
                      const std::string& truth) {
  std::string rows;
  for (const auto& p : points) {
    for (std::size_t k = 0; k < 3; ++k)
      rows += (k > 0 ? "," : "") + std::to_string(p[k]) + ',' + den;
    rows += (truth.empty() ? "" : ",") + truth + '\n';
  }
  return rows;
}

/// @brief A vertex falls through a triangle (at t = 1/2), or past it.
std::string vertexFaceRows(bool hit, const char* den, const std::string& truth) {
  const int x = hit ? 0 : 50;
  return queryRows({{x, 0, 2},
                    {-8, -8, 0},
                    {8, -8, 0},
                    {0, 8, 0},
                    {x, 0, -2},
                    {-8, -8, 0},
                    {8, -8, 0},
                    {0, 8, 0}},
                   den, truth);
}

TEST_F(CcdQueries, CountsWrongAnswersOfQueries) {
  // The second and the third query have a wrong truth.
  writeText(path("q.csv"),
            vertexFaceRows(true, "4", "1") + vertexFaceRows(false, "4", "1"));
  writeText(path("r.csv"), vertexFaceRows(true, "18014398509481984", "0"));
  const Outcome outcome = run("queries q.csv r.csv --kind vf --json r.json --repeat 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Json report = json("r.json");
  EXPECT_EQ(keysOf(report),
            (std::set<std::string>{"queries", "true", "false_negatives",
                                   "false_positives", "wrong_times", "uncertain",
                                   "queries_not_doubles", "ns_per_query"}));
  EXPECT_EQ(report.at("queries"), 3);
  EXPECT_EQ(report.at("true"), 2);
  EXPECT_EQ(report.at("false_negatives"), 1);
  EXPECT_EQ(report.at("false_positives"), 1);
  EXPECT_TRUE(report.at("wrong_times").is_null());
  EXPECT_EQ(report.at("uncertain"), 0);
  EXPECT_GT(report.at("ns_per_query").get<double>(), 0);
}

TEST_F(CcdQueries, PrintsAnswersOfQueriesWithoutTruth) {
  writeText(path("q.csv"),
            vertexFaceRows(true, "4", "") + vertexFaceRows(false, "4", ""));
  const Outcome outcome = run("queries q.csv --kind vf --print --json r.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = linesOf(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  const std::vector<std::string> fields = fcl::test::csvFields(lines[0]);
  ASSERT_EQ(fields.size(), 4u);
  EXPECT_EQ(fields[0] + fields[1], "0yes");
  EXPECT_LE(std::stod(fields[2]), 0.5);
  EXPECT_GE(std::stod(fields[3]), 0.5);
  EXPECT_EQ(lines[1], "1,no,,");
  EXPECT_TRUE(json("r.json").at("true").is_null());
  EXPECT_TRUE(json("r.json").at("false_negatives").is_null());
  EXPECT_TRUE(json("r.json").at("false_positives").is_null());
}

TEST_F(CcdQueries, TestsEdgeEdgeQueries) {
  writeText(path("q.csv"), queryRows({{-1, 0, 0},
                                      {1, 0, 0},
                                      {0, -1, 1},
                                      {0, 1, 1},
                                      {-1, 0, 0},
                                      {1, 0, 0},
                                      {0, -1, -1},
                                      {0, 1, -1}},
                                     "1", "1"));
  const Outcome outcome = run("queries q.csv --kind ee --print");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.rfind("0,yes,", 0), 0u) << outcome.out;
}

/// @brief Eight rows of decimals; the vertex (x, x, z) falls to (x, x, -z) through a
/// triangle in the plane z = 0.
std::string decimalRows(const std::string& x, const std::string& z,
                        const std::string& rest = "") {
  std::string rows;
  for (const char* sign : {"", "-"}) {
    rows.append(x).append(1, ',').append(x).append(1, ',').append(sign).append(z);
    rows += rest + '\n';
    for (const char* corner : {"-8,-8,0", "8,-8,0", "0,8,0"})
      rows.append(corner).append(rest).append(1, '\n');
  }
  return rows;
}

TEST_F(CcdQueries, ReadsDecimals) {
  // 0.75, 2 and 8 in all ways to write them.
  const std::string x[] = {"0.75", "+.75", "75e-2", "0.0075E+2", "7.5D-1", "000.7500"};
  for (const std::string& text : x) {
    SCOPED_TRACE(text);
    writeText(path("q_vf.csv"), decimalRows(text, "2.", ",1"));
    const Outcome outcome = run("queries q_vf.csv --json r.json");
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(json("r.json").at("true"), 1);
    EXPECT_EQ(json("r.json").at("false_negatives"), 0);
  }
}

// The numbers of points are those of their text, so that a tenth is between two doubles.
TEST_F(CcdQueries, TakesDecimalsForExactNumbers) {
  const std::pair<const char*, bool> numbers[] = {
      {"0.1", false},
      {"0.1000000000000000055511151231257827021181583404541015625", true},
      {"0.1000000000000000055511151231257827021181583404541015624", false},
      {"0.5", true},
      {"1e23", false},
      {"99999999999999991611392", true},
      {"1e-400", false},
      {"1e-4999", false},
      {"0e-400", true},
      {"0e99999999999999999999", true},
      {"4.9406564584124654e-324", false},
      {"9007199254740993", false},
      {"9007199254740992", true}};
  for (const auto& [text, is_double] : numbers) {
    SCOPED_TRACE(text);
    writeText(path("q_vf.csv"),
              "0,0," + std::string(text) + '\n' + decimalRows("0", "2").substr(6));
    const Outcome outcome = run("queries q_vf.csv --json r.json");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(json("r.json").at("queries_not_doubles"), is_double ? 0 : 1);
  }
}

// A tenth as a decimal, as a fraction, and as the nearest double: the same query.
TEST_F(CcdQueries, DecimalsAndFractionsAreTheSameNumbers) {
  writeText(path("decimal_vf.csv"), decimalRows("0.1", "2"));
  writeText(path("double_vf.csv"), decimalRows("0.1000000000000000055511151231257827"
                                               "021181583404541015625",
                                               "2"));
  std::string fractions;
  for (const char* z : {"20", "-20"})
    fractions += "1,10,1,10," + std::string(z) + ",10\n-80,10,-80,10,0,10\n" +
                 "80,10,-80,10,0,10\n0,10,80,10,0,10\n";
  writeText(path("fraction_vf.csv"), fractions);
  const Outcome decimal = run("queries decimal_vf.csv --print"),
                fraction = run("queries fraction_vf.csv --print"),
                rounded = run("queries double_vf.csv --print");
  EXPECT_EQ(decimal.out.rfind("0,yes,", 0), 0u) << decimal.out;
  EXPECT_EQ(fraction.out, decimal.out);
  EXPECT_EQ(rounded.out.rfind("0,yes,", 0), 0u) << rounded.out;
}

// The vertex meets the face at t = 1/2. The last time is not compared: there is no
// contact.
TEST_F(CcdQueries, CountsTimesOutsideOfTheirBrackets) {
  const std::string rows = decimalRows("0", "2", ",1,0.5") +
                           decimalRows("0", "2", ",1,.9") + decimalRows("0", "2", ",1,") +
                           decimalRows("0", "2", ",1,0.499999") +
                           decimalRows("50", "2", ",1,0.25");
  writeText(path("q_vf.csv"), rows);
  const Outcome outcome = run("queries q_vf.csv --toc-err 1e-9 --json r.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json("r.json").at("wrong_times"), 2);
  EXPECT_EQ(json("r.json").at("false_negatives"), 1);
  const std::vector<std::string> lines = linesOf(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  const std::string::size_type end = lines[0].find("wrong times") + 11;
  EXPECT_EQ(lines[1].substr(end - 4, 4), "   2") << outcome.out;
  // A bracket that is wide has the times nearby.
  EXPECT_EQ(run("queries q_vf.csv --toc-err 0.1 --json r.json").exit_code, 0);
  EXPECT_EQ(json("r.json").at("wrong_times"), 1);
}

TEST_F(CcdQueries, SkipsALineOfNames) {
  writeText(path("q_vf.csv"), "\n x , y, z ,hit\n" + decimalRows("0", "2", ",1"));
  EXPECT_EQ(run("queries q_vf.csv --json r.json").exit_code, 0);
  EXPECT_EQ(json("r.json").at("queries"), 1);
  writeText(path("q_vf.csv"),
            "x_num,x_den,y_num,y_den,z_num,z_den\n" + vertexFaceRows(true, "4", ""));
  EXPECT_EQ(run("queries q_vf.csv --json r.json").exit_code, 0);
  EXPECT_EQ(json("r.json").at("queries"), 1);
}

TEST_F(CcdQueries, RefusesALineOfNamesThatDoesNotFit) {
  const auto expectRefused = [&](const std::string& text, const std::string& cause) {
    writeText(path("q_vf.csv"), text);
    expectFailure("queries q_vf.csv --json r.json", "q_vf.csv: " + cause);
  };
  const std::string rows = decimalRows("0", "2", ",1");
  expectRefused("truth,x,y,z\n" + rows,
                "line 1: column 1 is named 'truth', which is the "
                "name of column 4");
  expectRefused("Z,Y,X,hit\n" + rows,
                "line 1: column 1 is named 'Z', which is the name of column 3");
  expectRefused("x,y,z\n" + rows, "line 2: has 4 fields; the lines before have 3");
  expectRefused("x,y\n" + rows, "line 1: has 2 fields. A row has 3 decimal numbers");
  expectRefused("x,y,z,truth\n", "the file has no queries");
  expectRefused("x,y,z,truth\n" + ("x,y,z,truth\n" + rows),
                "line 2: x: 'x' is not a number");
}

// As narrow as numbers allow: the bracket is around 1/3, which no double is.
TEST_F(CcdQueries, BracketsMayBeAsNarrowAsNumbersAllow) {
  std::string rows;
  for (const char* z : {"1", "-2"})
    rows += "0,0," + std::string(z) + "\n-8,-8,0\n8,-8,0\n0,8,0\n";
  writeText(path("q_vf.csv"), rows);
  const Outcome outcome = run("queries q_vf.csv --print --toc-err 0");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> fields = csvFields(linesOf(outcome.out).at(0));
  ASSERT_EQ(fields.size(), 4u);
  const double lo = std::stod(fields[2]), hi = std::stod(fields[3]);
  const double third = 1. / 3;  // rounds down
  EXPECT_LE(lo, third);
  EXPECT_GT(hi, third);
  EXPECT_LE(hi - lo, 8 * std::numeric_limits<double>::epsilon());
}

TEST_F(CcdQueries, ChoosesColumnsInTheirOrder) {
  writeText(path("q_vf.csv"),
            decimalRows("0", "2", ",1,0.5") + decimalRows("50.1", "2", ",0,"));
  const Outcome outcome = run(
      "queries q_vf.csv --print --columns not_doubles,toc,index,truth,kind,answer,file");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(linesOf(outcome.out),
            (std::vector<std::string>{"not_doubles,toc,index,truth,kind,answer,file",
                                      "0,0.5,0,yes,vf,yes,q_vf.csv",
                                      "4,,1,no,vf,no,q_vf.csv"}));
  // A name with a comma is one field.
  writeText(path("a,b_vf.csv"), decimalRows("0", "2"));
  EXPECT_EQ(run("queries a,b_vf.csv --print --columns file").out,
            "file\n\"a,b_vf.csv\"\n");
}

TEST_F(CcdQueries, RefusesColumnsByName) {
  writeText(path("q_vf.csv"), decimalRows("0", "2"));
  const std::string print = "queries q_vf.csv --print --columns ";
  expectFailure(print + "index,colour",
                "'colour' is not a column. The columns are: index, "
                "answer, toc_lo, toc_hi, kind, truth, toc, "
                "not_doubles, file");
  expectFailure(print + "anwser", "Did you mean 'answer'?");
  expectFailure(print + "index,,answer", "'' is not a column");
  expectFailure(print + "index,answer,index", "'index' is there twice");
  expectFailure("queries q_vf.csv --columns index", "--columns requires --print");
}

TEST_F(CcdQueries, ContactColumnsAreChosenInTheirOrder) {
  writeTip();
  const std::string contacts = "run tip0.obj tip1.obj --contacts c.csv --columns ";
  ASSERT_EQ(run(contacts + "toc_hi,i0,normal,kind,t0").exit_code, 0);
  const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "toc_hi,i0,nx,ny,nz,kind,t0");
  const std::vector<std::string> fields = csvFields(lines[1]);
  ASSERT_EQ(fields.size(), 7u);
  EXPECT_GE(std::stod(fields[0]), 0.5);
  EXPECT_EQ(fields[1], "3");
  EXPECT_EQ(fields[4], "-1");
  EXPECT_EQ(fields[5] + fields[6], "vf1");
  // These alone are added to the columns that are always there, in one order.
  for (const char* list : {"normal,triangles", "triangles,normal"}) {
    ASSERT_EQ(run(contacts + list).exit_code, 0);
    EXPECT_EQ(linesOf(readText(path("c.csv"))).at(0),
              "step,kind,i0,i1,i2,i3,toc_lo,toc_hi,t0,t1,nx,ny,nz,i4");
  }
}

TEST_F(CcdQueries, RefusesContactColumnsByName) {
  writeTip();
  const std::string contacts = "run tip0.obj tip1.obj --contacts c.csv --columns ";
  expectFailure(contacts + "step,colour",
                "'colour' is not a column. The columns are: step");
  expectFailure(contacts + "nx,normal", "'nx' is there twice");
  expectFailure(contacts + "i0,toc_lo --resume", "--resume needs the column step");
}

// The column may be anywhere.
TEST_F(CcdQueries, ResumeFindsTheColumnStep) {
  writeTip();
  const std::string contacts = " --jobs 1 --contacts c.csv --columns kind,toc_lo,step,i0";
  ASSERT_EQ(run("run tip0.obj tip1.obj tip0.obj" + contacts).exit_code, 0);
  const std::string whole = readText(path("c.csv"));
  ASSERT_EQ(linesOf(whole).size(), 5u) << whole;
  writeText(path("c.csv"), whole.substr(0, whole.size() - 3));
  const Outcome outcome = run("run tip0.obj tip1.obj tip0.obj --resume" + contacts);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(readText(path("c.csv")), whole);
  EXPECT_NE(outcome.err.find("the summary has the steps from 1 on"), std::string::npos)
      << outcome.err;
}

// In natural order: a2 comes before a10.
TEST_F(CcdQueries, ReadsFoldersOfQueries) {
  for (const char* folder : {"s/vertex-face", "s/edge-edge", "s/queries"})
    fs::create_directories(path(folder));
  const std::string hit = vertexFaceRows(true, "4", "1");
  writeText(path("s/vertex-face/a10.csv"), hit);
  writeText(path("s/vertex-face/a2.csv"), hit + hit);
  writeText(path("s/queries/92vf.csv"), hit);
  writeText(path("s/edge-edge/tree.csv"), hit);
  writeText(path("s/queries/notes.txt"), "no queries");
  const std::string columns = " --print --columns file,kind";
  EXPECT_EQ(run("queries s" + columns).out,
            "file,kind\n"
            "s/edge-edge/tree.csv,ee\n"
            "s/queries/92vf.csv,vf\n"
            "s/vertex-face/a2.csv,vf\ns/vertex-face/a2.csv,vf\n"
            "s/vertex-face/a10.csv,vf\n");
  EXPECT_EQ(run("queries s --kind ee" + columns).out,
            "file,kind\ns/edge-edge/tree.csv,ee\n");
  // What a user says of a file counts more than its name.
  EXPECT_EQ(run("queries s/edge-edge/tree.csv --kind vf" + columns).out,
            "file,kind\ns/edge-edge/tree.csv,vf\n");
  expectFailure("queries s/vertex-face --kind ee",
                "s/vertex-face: the folder has no CSV "
                "file of kind ee");
  writeText(path("s/tree.csv"), hit);
  expectFailure("queries s", "s/tree.csv: its name does not tell the kind");
  expectFailure("queries s/tree.csv", "s/tree.csv: its name does not tell the kind");
}

TEST_F(CcdQueries, AllFilesTellTheTruthOrNone) {
  writeText(path("a_vf.csv"), vertexFaceRows(true, "4", "1"));
  writeText(path("b_vf.csv"), vertexFaceRows(true, "4", ""));
  expectFailure("queries a_vf.csv b_vf.csv",
                "b_vf.csv: does not tell the truth, unlike a_vf.csv");
}

TEST_F(CcdQueries, PublicQueriesAreDoublesAndHaveNoError) {
  const auto folder = fcl::test::sharedData("queries");
  if (!folder) GTEST_SKIP() << fcl::test::kNoSharedData;
  const Outcome outcome = run("queries '" + *folder + "' --toc-err 0 --json r.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Json report = json("r.json");
  EXPECT_EQ(report.at("queries"), 4120);
  EXPECT_EQ(report.at("true"), 160);
  EXPECT_EQ(report.at("queries_not_doubles"), 0);
  EXPECT_EQ(report.at("false_negatives"), 0);
  EXPECT_EQ(report.at("false_positives"), 0);
}

/// @brief The rows of a file of fractions, with 1/3 added to each coordinate.
std::string movedByAThird(const std::string& text) {
  using boost::multiprecision::cpp_int;
  std::string moved;
  for (const std::string& line : linesOf(text)) {
    std::vector<std::string> fields = csvFields(line);
    for (std::size_t k = 0; k < 6; k += 2) {
      const cpp_int num(fields[k]), den(fields[k + 1]);
      fields[k] = cpp_int(3 * num + den).str();
      fields[k + 1] = cpp_int(3 * den).str();
    }
    for (const std::string& field : fields) moved.append(field).append(1, ',');
    moved.back() = '\n';
  }
  return moved;
}

// Rounding would decide hard queries. These are the figures of doc/data.md.
TEST_F(CcdQueries, PublicQueriesOfFractionsHaveNoError) {
  const auto folder = fcl::test::sharedData("queries");
  if (!folder) GTEST_SKIP() << fcl::test::kNoSharedData;
  for (const auto& entry : fs::recursive_directory_iterator(*folder)) {
    if (entry.path().extension() != ".csv") continue;
    const fs::path moved = path("moved") / fs::relative(entry.path(), *folder);
    fs::create_directories(moved.parent_path());
    writeText(moved, movedByAThird(readText(entry.path())));
  }
  const Outcome outcome = run("queries moved --json r.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json report = json("r.json");
  EXPECT_EQ(report.at("queries"), 4120);
  EXPECT_EQ(report.at("queries_not_doubles"), 4120);
  EXPECT_EQ(report.at("false_negatives"), 0);
  EXPECT_EQ(report.at("false_positives"), 0);
}

/// @brief n / 3e30, which is 1/3 for n = 10^30. No double is between those of a test.
std::string nearAThird(const char* n) {
  return std::string(n) + ",3000000000000000000000000000000,";
}
constexpr const char* kLess = "999999999999999999999999999999";
constexpr const char* kThird = "1000000000000000000000000000000";
constexpr const char* kMore = "1000000000000000000000000000001";

// Two points of 1/3 that differ by 3e-31: whether a vertex falls on the border of a face
// or beside it, and whether an edge that falls meets the end of another.
TEST_F(CcdQueries, FractionsAreDecidedExactly) {
  std::string vf, ee;
  for (const auto& [n, touches] :
       {std::pair{kLess, true}, {kThird, true}, {kMore, false}})
    for (const char* sign : {"", "-"}) {
      // The sides of the face are x = 0, y = 0 and x + y = 2/3; the edges lie along x and
      // y.
      const std::string z = std::string(sign) + "1,7", end = touches ? ",1\n" : ",0\n";
      vf += nearAThird(n) + "1,3," + z + end + "0,1,0,1,0,1" + end + "2,3,0,1,0,1" + end +
            "0,1,2,3,0,1" + end;
      ee += nearAThird(n) + "-1,1," + z + end + nearAThird(n) + "1,1," + z + end +
            "-1,1,0,1,0,1" + end + "1,3,0,1,0,1" + end;
    }
  writeText(path("q_vf.csv"), vf);
  writeText(path("q_ee.csv"), ee);
  for (const char* file : {"q_vf.csv", "q_ee.csv"}) {
    SCOPED_TRACE(file);
    const Outcome outcome =
        run(std::string("queries ") + file + " --print --toc-err 1e-9 --json r.json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json report = json("r.json");
    EXPECT_EQ(report.at("queries_not_doubles"), 3);
    EXPECT_EQ(report.at("true"), 2);
    EXPECT_EQ(report.at("false_negatives"), 0);
    EXPECT_EQ(report.at("false_positives"), 0);
    // Half way, found exactly.
    EXPECT_EQ(linesOf(outcome.out),
              (std::vector<std::string>{"0,yes,0.5,0.5", "1,yes,0.5,0.5", "2,no,,"}));
  }
}

TEST_F(CcdQueries, BadQueriesExitWithTwo) {
  const std::string good = vertexFaceRows(true, "4", "1");
  const auto expectRefused = [&](const std::string& text, const std::string& cause) {
    writeText(path("q.csv"), text);
    expectFailure("queries q.csv --kind vf --json r.json", "q.csv: " + cause);
  };
  expectRefused("", "the file is empty");
  expectRefused("\n\n", "the file has no queries");
  expectRefused(good.substr(0, good.rfind("0,4,8")), "the file has 7 rows");
  expectRefused("1,2\n" + good, "line 1: has 2 fields. A row has 3 decimal numbers");
  expectRefused("1,2,3,4,5,6,7,8,9\n" + good, "line 1: has 9 fields");
  expectRefused("1,2,3\n" + good, "line 2: has 7 fields; the lines before have 3");
  expectRefused(good + "1,1,1,1,1,1\n", "line 9: has 6 fields; the lines before have 7");
  expectRefused(good + "1,0,1,1,1,1,1\n", "line 9: x: the denominator is 0");
  expectRefused(good + "1,1,1.5,1,1,1,1\n", "line 9: y: '1.5' is not an integer");
  expectRefused(good + "nan,1,1,1,1,1,1\n", "line 9: x: 'nan' is not an integer");
  expectRefused(good + ",1,1,1,1,1,1\n", "line 9: x: '' is not an integer");
  expectRefused(good + "1,1 2,1,1,1,1,1\n", "line 9: field 2 has two words");
  expectRefused(good + "1" + std::string(400, '0') + ",1,1,1,1,1,1\n",
                "line 9: x: the coordinate is beyond double's range");
  expectRefused(good + "1,1,1,1,1,1,2\n", "line 9: the truth is '2', expected 0 or 1");
  expectRefused(good + "1,1,1,1,1,1,1\n1,1,1,1,1,1,0\n",
                "line 10: differs from the row before in the truth");
  expectRefused("1,1,1,1,1,1,1,.5\n1,1,1,1,1,1,1,.25\n",
                "line 2: differs from the row before in the time");
  expectFailure("queries missing.csv --kind vf", "missing.csv: cannot open");
}

TEST_F(CcdQueries, BadDecimalsExitWithTwo) {
  const std::string good = decimalRows("0", "2", ",1,0.5");
  const auto expectRefused = [&](const std::string& row, const std::string& cause) {
    SCOPED_TRACE(row);
    writeText(path("q.csv"), good + row);
    expectFailure("queries q.csv --kind vf --json r.json", "q.csv: line 9: " + cause);
  };
  for (const char* text : {"1x", "1e", "1.2.3", "--1", "0x10", "1/2", ""})
    expectRefused("1," + std::string(text) + ",1,1,\n",
                  "y: '" + std::string(text) + "' is not a number");
  for (const char* text : {"nan", "-inf", "1e400", "1.#INF"})
    expectRefused(
        std::string(text) + ",1,1,1,\n",
        "x: '" + std::string(text) + "' is not finite, or beyond double's range");
  expectRefused("1,1,1,1,x\n", "toc: 'x' is not a number");
  expectRefused("1,1,1,1,1.5\n", "the time is '1.5', expected a fraction of the step");
  expectRefused("1,1,1,1,-0.5\n", "the time is '-0.5', expected a fraction of the step");
  expectRefused("1,1,1,0,0.5\n", "there is a time, '0.5', but the truth is 0");
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
//
// The command `candidates` of fcl-ccd: no pair that touches is missing, and the list is
// always the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "ccd_tool.h"
#include "csv_rows.h"
#include "scene_data.h"
#include "shared_data.h"

namespace {

using namespace fcl::test;
using Kind = fcl::ContinuousContactKind;

class CcdCandidates : public fcl::test::CcdToolTest {
 protected:
  std::vector<CsvRow> rows(const std::string& arguments) const {
    const Outcome outcome = run("candidates " + arguments + " --output c.csv");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return readCsv(path("c.csv").string(), "kind,i0,i1,i2,i3,t_lo,t_hi");
  }

  /// @brief Writes the frames wave0.obj and wave1.obj of a strip that folds over itself.
  void writeWave() const {
    constexpr int kLength = 40, kWidth = 4;
    for (const double amount : {0., 1.}) {
      Mesh mesh;
      for (int i = 0; i < kLength; ++i)
        for (int j = 0; j < kWidth; ++j) {
          const double turn = 0.3 + 0.17 * amount, x = turn * i;
          mesh.vertices.push_back(
              {std::sin(x) * (1 + 0.02 * i), std::cos(x) * (1 + 0.01 * i), 0.4 * j});
        }
      for (int i = 0; i + 1 < kLength; ++i)
        for (int j = 0; j + 1 < kWidth; ++j) {
          const int a = i * kWidth + j, b = a + kWidth;
          mesh.triangles.push_back({a, b, a + 1});
          mesh.triangles.push_back({a + 1, b, b + 1});
        }
      writeText(path(amount == 0 ? "wave0.obj" : "wave1.obj"), toObj(mesh));
    }
  }
};

/// @brief The order of the list: by kind, then by ids, those of A before those of B.
using Key = std::tuple<std::size_t, std::vector<std::pair<bool, int>>>;

Key keyOf(const CsvRow& row) {
  const std::string kinds = "vfeevevv";
  std::vector<std::pair<bool, int>> ids;
  for (const char* name : {"i0", "i1", "i2", "i3"}) {
    const std::string& text = row.at(name);
    if (text.empty()) continue;
    const bool of_b = text[0] == 'b';
    ids.emplace_back(of_b, std::stoi(text.substr(of_b ? 1 : 0)));
  }
  return {kinds.find(row.at("kind")), ids};
}

void expectSorted(const std::vector<CsvRow>& rows) {
  for (std::size_t i = 1; i < rows.size(); ++i)
    ASSERT_LT(keyOf(rows[i - 1]), keyOf(rows[i])) << "line " << i + 2;
}

TEST_F(CcdCandidates, HaveEveryContactOnceAndInOrder) {
  writeWave();
  const std::vector<CsvRow> candidates = rows("wave0.obj wave1.obj");
  expectSorted(candidates);
  std::map<Key, const CsvRow*> found;
  for (const CsvRow& row : candidates) {
    const double lo = std::stod(row.at("t_lo")), hi = std::stod(row.at("t_hi"));
    EXPECT_TRUE(0 <= lo && lo <= hi && hi <= 1) << lo << ' ' << hi;
    found[keyOf(row)] = &row;
  }
  ASSERT_EQ(run("run wave0.obj wave1.obj --contacts k.csv --columns "
                "kind,i0,i1,i2,i3,toc_lo,toc_hi")
                .exit_code,
            0);
  std::size_t num_contacts = 0;
  for (const CsvRow& contact :
       readCsv(path("k.csv").string(), "kind,i0,i1,i2,i3,toc_lo,toc_hi")) {
    if (contact.at("kind") == "crossing") continue;
    ++num_contacts;
    const auto candidate = found.find(keyOf(contact));
    ASSERT_NE(candidate, found.end());
    EXPECT_LE(std::stod(candidate->second->at("t_lo")), std::stod(contact.at("toc_hi")));
    EXPECT_GE(std::stod(candidate->second->at("t_hi")), std::stod(contact.at("toc_lo")));
  }
  EXPECT_GT(num_contacts, 100u);
  EXPECT_GT(candidates.size(), num_contacts);
}

TEST_F(CcdCandidates, AreTheSameEachTime) {
  writeWave();
  const Outcome first = run("candidates wave0.obj wave1.obj");
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_EQ(first.err.find("warning"), std::string::npos) << first.err;
  EXPECT_EQ(run("candidates wave0.obj wave1.obj").out, first.out);
  const Outcome to_file = run("candidates wave0.obj wave1.obj --output c.csv");
  EXPECT_EQ(readText(path("c.csv")), first.out);
  const std::vector<CsvRow> all = rows("wave0.obj wave1.obj");
  const auto num_vf = std::count_if(
      all.begin(), all.end(), [](const CsvRow& row) { return row.at("kind") == "vf"; });
  EXPECT_EQ(to_file.out, std::to_string(num_vf) + " vf and " +
                             std::to_string(static_cast<long>(all.size()) - num_vf) +
                             " ee candidates\n");
}

TEST_F(CcdCandidates, HaveTheWindowOfThePair) {
  writeTip();
  const std::vector<CsvRow> candidates = rows("tip0.obj tip1.obj");
  ASSERT_FALSE(candidates.empty());
  const CsvRow& row = candidates[0];
  EXPECT_EQ(row.at("kind") + row.at("i0") + row.at("i1") + row.at("i2") + row.at("i3"),
            "vf3012");
  // The tip falls through the plane of the floor at t = 1/2, and is in no other box.
  EXPECT_LE(std::stod(row.at("t_lo")), 0.5);
  EXPECT_GE(std::stod(row.at("t_hi")), 0.5);
  EXPECT_NEAR(std::stod(row.at("t_lo")), 0.5, 1e-5);
  EXPECT_NEAR(std::stod(row.at("t_hi")), 0.5, 1e-5);
}

TEST_F(CcdCandidates, OfTwoMeshesNameThoseOfB) {
  writeEdges();
  const std::string edges = "x0.off x1.off --against y0.ply y1.ply";
  const auto kinds = [&](const std::string& arguments) {
    std::set<std::string> found;
    for (const CsvRow& row : rows(arguments))
      found.insert(row.at("kind") + ' ' + row.at("i0") + ' ' + row.at("i2"));
    return found;
  };
  EXPECT_EQ(kinds(edges).count("ee 0 b0"), 1u);
  EXPECT_EQ(kinds(edges), kinds(edges + " --no-self"));
  // A mesh that stands still has one frame.
  EXPECT_EQ(kinds("y0.ply y1.ply --against x0.off").count("ee 0 b0"), 1u);
  writeTip();
  EXPECT_EQ(kinds("tip0.obj tip1.obj").count("vf 3 1"), 1u);
  EXPECT_EQ(kinds("tip0.obj tip1.obj --against y0.ply --no-self").count("vf 3 1"), 0u);
}

TEST_F(CcdCandidates, AtADistanceHaveFreePoints) {
  const auto write = [&](const char* name, double z) {
    writeText(path(name), "v 0 0 0\nv 1 0 0\nv 0.5 0 " + exactText(z) +
                              "\nv 5 0 0\nv 5 0 " + exactText(z) +
                              "\nl 1 2\np 3\np 4\np 5\n");
  };
  write("p0.obj", 1);
  write("p1.obj", 0.05);
  EXPECT_TRUE(rows("p0.obj p1.obj").empty());
  const std::vector<CsvRow> near = rows("p0.obj p1.obj --thickness 0.1");
  ASSERT_EQ(near.size(), 2u);
  EXPECT_EQ(near[0].at("kind") + near[0].at("i0") + near[0].at("i1") + near[0].at("i2") +
                near[0].at("i3"),
            "ve201");
  EXPECT_EQ(near[1].at("kind") + near[1].at("i0") + near[1].at("i1") + near[1].at("i2"),
            "vv34");
}

TEST_F(CcdCandidates, HaveTheColumnsOfTheList) {
  writeTip();
  const std::vector<std::string> lines =
      linesOf(run("candidates tip0.obj tip1.obj --columns t1,kind,t0,i0").out);
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines[0], "t1,kind,t0,i0");
  EXPECT_EQ(lines[1], "0,vf,1,3");
}

TEST_F(CcdCandidates, RefusalsNameTheCause) {
  writeTip();
  const std::string step = "candidates tip0.obj tip1.obj";
  expectFailure("candidates", "A is required");
  expectFailure("candidates tip0.obj",
                "A needs two frames or more; there is only tip0.obj");
  expectFailure(step + " tip0.obj", "A has 3 frames, but this command has one step");
  expectFailure("candidates tip0.obj missing.obj", "missing.obj: cannot open");
  expectFailure(step + " --no-self", "--no-self requires --against");
  expectFailure(step + " --thickness 0", "'0' is not a positive number");
  expectFailure(step + " --columns kind,window",
                "'window' is not a column. The columns are: kind, i0, i1, i2, i3, t_lo, "
                "t_hi, t0, t1");
  expectFailure(step + " --output tip1.obj", "tip1.obj: cannot write: it is also given");
  expectFailure(step + " --output missing/c.csv", "missing/c.csv: cannot write");
  Mesh turned = floorAndTip(2);
  turned.triangles[1] = {4, 3, 5};
  writeText(path("turned.obj"), toObj(turned));
  expectFailure("candidates tip0.obj turned.obj", "turned.obj: its faces differ");
  Mesh broken = floorAndTip(0);
  broken.vertices[3][2] = std::nan("");
  writeText(path("broken.ply"), toBinaryPly<double>(broken, false));
  writeText(path("whole.ply"), toBinaryPly<double>(floorAndTip(2), false));
  expectFailure("candidates whole.ply broken.ply", "broken.ply: ");
}

TEST_F(CcdCandidates, HaveEveryTruePairOfThePublicScenes) {
  for (const char* scene : {"scenes/cloth-ball", "scenes/n-body"}) {
    const auto folder = fcl::test::sharedData(scene);
    if (!folder) GTEST_SKIP() << fcl::test::kNoSharedData;
    ASSERT_EQ(run("candidates '" + *folder + "' --output c.csv").exit_code, 0);
    const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
    std::set<PairName> candidates;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      std::array<int, 4> ids{};
      ASSERT_EQ(std::sscanf(lines[i].c_str() + 2, ",%d,%d,%d,%d", &ids[0], &ids[1],
                            &ids[2], &ids[3]),
                4);
      candidates.insert(
          pairName(lines[i][0] == 'v' ? Kind::kVertexFace : Kind::kEdgeEdge, ids));
    }
    EXPECT_EQ(candidates.size(), lines.size() - 1);
    const std::set<PairName> truth = readTruePairs(*folder + "/true_pairs.csv.gz");
    EXPECT_TRUE(
        std::includes(candidates.begin(), candidates.end(), truth.begin(), truth.end()));
  }
}

}  // namespace

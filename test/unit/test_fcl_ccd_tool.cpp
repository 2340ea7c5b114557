// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the program fcl-ccd as a user does, on meshes that are small enough to know the
// answer. Runs its mesh reader on files of every format, complete and broken.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ccd_json.h"
#include "ccd_tool.h"
#include "csv_rows.h"
#include "mesh_files.h"
#include "mesh_io.h"
#include "output_file.h"

namespace {

using namespace fcl::test;
using Json = nlohmann::json;

class CcdTool : public fcl::test::CcdJsonTest {};

/// @brief Coordinates that need all 17 digits.
Mesh unevenMesh() {
  return {{{0.1, 1.0 / 3, 0.30000000000000004},
           {1e-300, -123456.78901234567, 2.5},
           {1e22, 4.9406564584124654e-324, -0.0}},
          {{0, 1, 2}, {2, 1, 0}}};
}

void expectSame(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  // Bit for bit: -0.0 and 0.0 differ.
  EXPECT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(),
                        a.vertices.size() * sizeof a.vertices[0]),
            0);
}

TEST_F(CcdTool, ReadsEveryFormatWithFullPrecision) {
  const Mesh mesh = unevenMesh();
  const std::vector<std::pair<std::string, std::string>> encodings = {
      {"a.obj", toObj(mesh)},
      {"a.off", toOff(mesh)},
      {"a.ply", toAsciiPly(mesh)},
      {"le.ply", toBinaryPly<double>(mesh, false)},
      {"be.PLY", toBinaryPly<double>(mesh, true)}};
  for (const auto& [name, text] : encodings) {
    SCOPED_TRACE(name);
    writeText(path(name), text);
    expectSame(readMesh(path(name).string()), mesh);
  }
}

TEST_F(CcdTool, ReadsFloatsExactly) {
  Mesh mesh = floorAndTip(0.25);
  for (auto& p : mesh.vertices) p[0] = static_cast<double>(static_cast<float>(p[0] / 3));
  for (const bool big_endian : {false, true}) {
    writeText(path("f.ply"), toBinaryPly<float>(mesh, big_endian));
    expectSame(readMesh(path("f.ply").string()), mesh);
  }
}

TEST_F(CcdTool, ReadsVariantsOfTheFormats) {
  const Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<std::pair<std::string, std::string>> encodings = {
      {"quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"},
      {"relative.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n"},
      {"full.obj",
       "mtllib m.mtl\r\no square\r\nv\t0 0 0 1\r\nv 1 0 0 1\r\nv 1 1 0 1\r\nv 0 1 0 1\r\n"
       "vt 0 0\r\nvn 0 0 1\r\nusemtl red\r\nf\t1/1/1 2//1 \\\r\n 3/1 4 # done\r\nl 1 2"},
      {"comments.obj",
       "# from C:\\meshes\\\nv 0 0 0 # \\\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 4\n"},
      {"mark.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"},
      {"quad.off",
       "# c\nCOFF 4 1 0\n0 0 0 255 0 0\n1 0 0 1 1 1\n\n1 1 0 # here\n"
       "0 1 0\n4 0 1 2 3 0.5 0.5 0.5\n"},
      {"quad.ply",
       "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement vertex 4\r\nproperty uchar "
       "red\r\n"
       "property float32 x\r\nproperty float64 y\r\nproperty double z\r\n"
       "element material 1\r\nproperty int shine\r\nelement face 1\r\n"
       "property list int uint vertex_index\r\nproperty list uchar float texcoord\r\n"
       "end_header\r\n9 0 0 0\r\n9 1 0 0\r\n9 1 1 0\r\n9 0 1 0\r\n7\r\n"
       "4 0 1 2 3 2 .5 .5\r\n"}};
  for (const auto& [name, text] : encodings) {
    SCOPED_TRACE(name);
    writeText(path(name), text);
    expectSame(readMesh(path(name).string()), square);
  }
}

struct BrokenFile {
  const char* name;
  std::string text;
  const char* cause;
};

std::vector<BrokenFile> brokenFiles() {
  const Mesh mesh = floorAndTip(0);
  const std::string obj = toObj(mesh), off = toOff(mesh), ply = toAsciiPly(mesh);
  const std::string binary = toBinaryPly<float>(mesh, false);
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  Mesh infinite = mesh;
  infinite.vertices[4][1] = HUGE_VAL;
  return {
      {"empty.obj", "", "empty"},
      {"empty.ply", "", "empty"},
      {"noise.obj", "\x01\xff noise\n", "not an OBJ statement"},
      {"noise.off", "\x01\xff noise\n", "begins with OFF"},
      {"noise.ply", "\x01\xff noise\n", "begins with 'ply'"},
      {"mesh.stl", obj, "line 1: '#' is not a word of STL"},
      {"mesh.gltf", obj, "unknown mesh format"},
      {"mesh", obj, "unknown mesh format"},
      {"faceless.obj", obj.substr(0, obj.find("f ")), "no faces"},
      {"cut.obj", obj.substr(0, obj.size() - 4), "at least three vertices"},
      {"cut.off", off.substr(0, off.size() - 4), "ends before the face's 3 vertex ids"},
      {"cut_early.off", off.substr(0, off.size() - 9), "ends before face 1 of 2"},
      {"cut_header.off", "OFF\n", "ends before the number of vertices"},
      {"cut.ply", ply.substr(0, ply.size() - 4), "face 1 of 2"},
      {"cut_header.ply", ply.substr(0, ply.find("end_header")), "'end_header'"},
      {"cut_binary.ply", binary.substr(0, binary.size() - 1), "face 1 of 2"},
      {"cut_vertices.ply", binary.substr(0, binary.find("end_header") + 40),
       "vertex 2 of"},
      {"longer.off", off + "1 2 3\n", "more lines"},
      {"longer.ply", ply + "1\n", "more data"},
      {"longer_binary.ply", binary + "xyz", "more data"},
      {"huge.off", with(off, "6 2 0", "2000000000 2 0"), "ends before vertex"},
      {"huge.ply", with(binary, "vertex 6", "vertex 9000000000000000000"), "vertex "},
      {"id.obj", with(obj, "f 4 5 6", "f 4 5 7"), "vertex id 7 is out of range"},
      {"zero.obj", with(obj, "f 4 5 6", "f 4 5 0"), "out of range"},
      {"back.obj", with(obj, "f 4 5 6", "f 4 5 -7"), "out of range"},
      {"overflow.obj", with(obj, "f 4 5 6", "f 4 5 6 99999999999"), "out of range"},
      {"word.obj", with(obj, "f 4 5 6", "f 4 5 6 x"), "'x' is not a vertex id"},
      {"id.off", with(off, "3 3 4 5", "3 3 4 6"), "out of range"},
      {"negative.off", with(off, "3 3 4 5", "3 3 4 -1"), "out of range"},
      {"fraction.off", with(off, "3 3 4 5", "3 3 4 4.5"), "is not a vertex id"},
      {"id.ply", with(ply, "3 3 4 5", "3 3 4 6"), "face 1 (counted from 0)"},
      {"negative.ply", with(ply, "3 3 4 5", "3 3 4 -1"), "face 1 (counted from 0)"},
      {"two.ply", with(ply, "3 3 4 5", "2 3 4"), "fewer than three vertices"},
      {"nan.obj", with(obj, "v 4 -4 0", "v 4 nan 0"), "'nan' is not finite"},
      {"inf.off", with(off, "4 -4 0", "4 1e999 0"), "'1e999' is not finite"},
      {"nan.ply", with(ply, "4 -4 0", "4 -NaN 0"), "'-NaN' is not finite"},
      {"inf.ply", toBinaryPly<double>(infinite, true), "vertex 4"},
      {"word.ply", with(ply, "4 -4 0", "4 -4x 0"), "'-4x' is not a number"},
      {"count.ply", with(ply, "3 3 4 5", "259 3 4 5"), "'259' does not fit its type"},
      {"large_id.ply",
       with(with(ply, "uchar int", "uchar uint"), "3 3 4 5", "3 3 4 -4294967291"),
       "'-4294967291' does not fit its type"},
      {"large.ply", with(with(ply, "double z", "float z"), "4 -4 0", "4 -4 1e300"),
       "does not fit its type"},
      {"name.ply",
       with(ply, "element face 2", "element \x1b[31m 99\nproperty int x\nelement face 2"),
       "'?[31m'"},
      {"no_z.ply", with(ply, "property double z\n", ""), "no coordinate z"},
      {"type.ply", with(ply, "property double z", "property float80 z"), "'float80'"},
      {"no_faces.ply", with(ply, "element face 2", "element fake 2"), "element 'face'"}};
}

TEST_F(CcdTool, RefusesBrokenFilesByNameAndCause) {
  for (const BrokenFile& file : brokenFiles()) {
    SCOPED_TRACE(file.name);
    writeText(path(file.name), file.text);
    try {
      readMesh(path(file.name).string());
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.rfind(path(file.name).string() + ": ", 0), 0u) << what;
      EXPECT_NE(what.find(file.cause), std::string::npos) << what;
    }
  }
  EXPECT_THROW(readMesh(path("missing.ply").string()), std::runtime_error);
  fs::create_directory(path("folder.ply"));
  EXPECT_THROW(readMesh(path("folder.ply").string()), std::runtime_error);
}

TEST_F(CcdTool, PaintedPlyReadsBack) {
  const Mesh mesh = unevenMesh();
  const std::vector<fcl_ccd::Colour> colours(mesh.vertices.size(), {1, 2, 3});
  writePaintedPly(path("p.ply").string(), mesh, colours);
  expectSame(readMesh(path("p.ply").string()), mesh);
  EXPECT_EQ(files(), std::set<std::string>{"p.ply"});
  EXPECT_THROW(writePaintedPly(path("q.ply").string(), mesh, {}), std::invalid_argument);
  EXPECT_THROW(writePaintedPly(path("no/q.ply").string(), mesh, colours),
               std::runtime_error);
  EXPECT_EQ(files(), std::set<std::string>{"p.ply"});
}

TEST_F(CcdTool, FindsAVertexFaceContact) {
  writeTip();
  const Outcome outcome =
      run("run tip0.obj tip1.obj --contacts c.csv --json r.json --toc-err 1e-6");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");  // no progress line unless stderr is a terminal
  const std::vector<std::string> table = linesOf(outcome.out);
  ASSERT_EQ(table.size(), 7u) << outcome.out;
  EXPECT_EQ(table[2], "1 step, 1 vf and 0 ee contacts; 0 steps began crossing");
  EXPECT_EQ(files(), (std::set<std::string>{"c.csv", "r.json", "tip0.obj", "tip1.obj"}));

  const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "step,kind,i0,i1,i2,i3,toc_lo,toc_hi,i4");
  const std::vector<std::string> fields = fcl::test::csvFields(lines[1]);
  ASSERT_EQ(fields.size(), 9u);
  EXPECT_EQ(fields[0], "0");
  EXPECT_EQ(fields[1], "vf");
  EXPECT_EQ(fields[2], "3");
  EXPECT_EQ((std::set<std::string>{fields[3], fields[4], fields[5]}),
            (std::set<std::string>{"0", "1", "2"}));
  const double toc_lo = std::stod(fields[6]), toc_hi = std::stod(fields[7]);
  EXPECT_LE(toc_lo, 0.5);
  EXPECT_GE(toc_hi, 0.5);
  EXPECT_LE(toc_hi - toc_lo, 1e-6);

  const Json first = json("r.json").at("steps").at(0).at("first");
  EXPECT_EQ(first.at("kind"), "vf");
  EXPECT_EQ(first.at("vertices").at(0), 3);
  EXPECT_EQ(first.at("toc_lo").get<double>(), toc_lo);  // both files hold every digit
  EXPECT_EQ(first.at("toc_hi").get<double>(), toc_hi);
}

TEST_F(CcdTool, JsonHasExactlyThePromisedFields) {
  writeTip();
  const Outcome outcome = run("run tip0.obj tip1.obj tip1.obj --json r.json --repeat 3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json report = json("r.json");
  EXPECT_EQ(keysOf(report), (std::set<std::string>{"steps", "summary"}));
  ASSERT_EQ(report.at("steps").size(), 2u);
  for (const Json& step : report.at("steps")) {
    EXPECT_EQ(keysOf(step),
              (std::set<std::string>{"step", "files", "vertices", "triangles", "contacts",
                                     "initially_crossing", "first", "ms", "stages"}));
    EXPECT_EQ(step.at("vertices"), 6);
    EXPECT_EQ(step.at("triangles"), 2);
    EXPECT_EQ(keysOf(step.at("contacts")),
              (std::set<std::string>{"vf", "ee", "crossing"}));
    const Json& ms = step.at("ms");
    EXPECT_EQ(keysOf(ms),
              (std::set<std::string>{"build", "update", "traverse", "test", "total"}));
    EXPECT_DOUBLE_EQ(ms.at("total").get<double>(), ms.at("update").get<double>() +
                                                       ms.at("traverse").get<double>() +
                                                       ms.at("test").get<double>());
    const Json& stages = step.at("stages");
    EXPECT_EQ(keysOf(stages),
              (std::set<std::string>{"node_pairs", "triangle_pairs", "adjacent_pairs",
                                     "fan_culled", "plane_culled", "feature_pairs",
                                     "box_culled", "mask_culled", "filter_culled",
                                     "solver_culled", "exact_culled", "exact_tests",
                                     "contacts", "crossing_tests"}));
    int left = stages.at("feature_pairs").get<int>();
    for (const char* culled :
         {"box_culled", "mask_culled", "filter_culled", "solver_culled", "exact_culled"})
      left -= stages.at(culled).get<int>();
    EXPECT_EQ(left, stages.at("contacts").get<int>());
  }
  EXPECT_EQ(report.at("summary"),
            Json({{"steps", 2},
                  {"contacts", {{"vf", 1}, {"ee", 0}, {"crossing", 2}}},
                  {"initially_crossing", 1},
                  {"first", report["summary"]["first"]},
                  {"complete", true}}));
  EXPECT_EQ(report.at("summary").at("first").at("step"), 0);
  const Json& moving = report.at("steps").at(0);
  EXPECT_EQ(moving.at("step"), 0);
  EXPECT_EQ(moving.at("files"), Json({"tip0.obj", "tip1.obj"}));
  EXPECT_EQ(moving.at("contacts"), Json({{"vf", 1}, {"ee", 0}, {"crossing", 0}}));
  EXPECT_EQ(moving.at("initially_crossing"), false);
  EXPECT_EQ(keysOf(moving.at("first")),
            (std::set<std::string>{"kind", "vertices", "triangles", "toc_lo", "toc_hi",
                                   "position", "normal", "as_early"}));
  EXPECT_GT(moving.at("ms").at("build").get<double>(), 0);
  EXPECT_EQ(report.at("steps").at(1).at("ms").at("build").get<double>(), 0);
}

TEST_F(CcdTool, CrossingAtRestIsFirst) {
  writeTip();
  ASSERT_EQ(run("run tip1.obj tip1.obj --json r.json --contacts c.csv").exit_code, 0);
  const Json step = json("r.json").at("steps").at(0);
  EXPECT_EQ(step.at("initially_crossing"), true);
  EXPECT_EQ(step.at("contacts"), Json({{"vf", 0}, {"ee", 0}, {"crossing", 2}}));
  const Json& first = step.at("first");
  EXPECT_EQ(first.at("kind"), "crossing");
  EXPECT_EQ(first.at("vertices").size(), 5u);
  EXPECT_EQ(first.at("toc_lo"), 0.0);
  EXPECT_EQ(first.at("toc_hi"), 0.0);
  EXPECT_EQ(linesOf(readText(path("c.csv"))).size(), 3u);
}

// For every query, and for every later contact.
TEST_F(CcdTool, CrossingComesBeforeContacts) {
  Mesh from = floorAndTip(0), to = floorAndTip(2);
  const Mesh crossing = floorAndTip(2);
  for (Mesh* frame : {&from, &to}) {
    for (const auto& p : crossing.vertices)
      frame->vertices.push_back({p[0] + 100, p[1], p[2]});
    for (const auto& t : crossing.triangles)
      frame->triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  writeText(path("from.obj"), toObj(from));
  writeText(path("to.obj"), toObj(to));
  for (const char* query : {"all", "first", "any"}) {
    SCOPED_TRACE(query);
    ASSERT_EQ(
        run("run from.obj to.obj --json r.json --query " + std::string(query)).exit_code,
        0);
    const Json step = json("r.json").at("steps").at(0);
    EXPECT_EQ(step.at("initially_crossing"), true);
    EXPECT_EQ(step.at("first").at("kind"), "crossing");
    EXPECT_EQ(step.at("first").at("toc_lo"), 0.0);
  }
}

TEST_F(CcdTool, FirstOfTwoMeshesIsTheFirstOfAll) {
  writeTip();
  // A second floor, which the tip meets after its own.
  const Mesh whole = floorAndTip(0);
  Mesh floor{{whole.vertices.begin(), whole.vertices.begin() + 3}, {{0, 1, 2}}};
  for (auto& p : floor.vertices) p[2] -= 0.25;
  writeText(path("floor.obj"), toObj(floor));
  const std::string pair =
      "run tip0.obj tip1.obj --against floor.obj floor.obj --contacts c.csv --query ";
  ASSERT_EQ(run(pair + "all").exit_code, 0);
  const std::vector<std::string> all = linesOf(readText(path("c.csv")));
  ASSERT_EQ(all.size(), 3u);
  ASSERT_EQ(run(pair + "first").exit_code, 0);
  const std::vector<std::string> first = linesOf(readText(path("c.csv")));
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[1], all[1]);
}

TEST_F(CcdTool, WithoutContactFirstIsNull) {
  writeTip();
  const Outcome outcome = run("run tip0.obj tip0.obj --json r.json --contacts c.csv");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json step = json("r.json").at("steps").at(0);
  EXPECT_TRUE(step.at("first").is_null());
  EXPECT_EQ(step.at("initially_crossing"), false);
  EXPECT_EQ(linesOf(readText(path("c.csv"))).size(), 1u);
}

TEST_F(CcdTool, TestsTwoMeshes) {
  writeEdges();
  const Outcome outcome =
      run("run x0.off x1.off --against y0.ply y1.ply --contacts c.csv --json r.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
  ASSERT_EQ(lines.size(), 2u);
  const std::vector<std::string> fields = fcl::test::csvFields(lines[1]);
  ASSERT_EQ(fields.size(), 9u);
  EXPECT_EQ(fields[1], "ee");
  EXPECT_EQ((std::set<std::string>{fields[2], fields[3]}),
            (std::set<std::string>{"0", "1"}));
  EXPECT_EQ((std::set<std::string>{fields[4], fields[5]}),
            (std::set<std::string>{"b0", "b1"}));
  const Json step = json("r.json").at("steps").at(0);
  EXPECT_EQ(step.at("vertices"), 6);
  EXPECT_EQ(step.at("triangles"), 2);
  EXPECT_EQ(step.at("first").at("kind"), "ee");
  EXPECT_TRUE(step.at("first").at("vertices").at(0).is_number_integer());
  EXPECT_EQ(step.at("first").at("vertices").at(2).get<std::string>()[0], 'b');
}

TEST_F(CcdTool, PrefixesTheVertexOfB) {
  // The floor is A, the falling triangle B: its vertex 0 meets A's face.
  const Mesh whole0 = floorAndTip(0), whole1 = floorAndTip(2);
  const Mesh floor{{whole0.vertices.begin(), whole0.vertices.begin() + 3}, {{0, 1, 2}}};
  writeText(path("floor.obj"), toObj(floor));
  writeText(path("tip0.obj"),
            toObj({{whole0.vertices.begin() + 3, whole0.vertices.end()}, {{0, 1, 2}}}));
  writeText(path("tip1.obj"),
            toObj({{whole1.vertices.begin() + 3, whole1.vertices.end()}, {{0, 1, 2}}}));
  const auto contactOf = [&](const std::string& arguments) {
    const Outcome outcome = run("run " + arguments + " --contacts c.csv");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
    EXPECT_EQ(lines.size(), 2u);
    return fcl::test::csvFields(lines.back());
  };
  std::vector<std::string> fields =
      contactOf("floor.obj floor.obj --against tip0.obj tip1.obj");
  EXPECT_EQ(fields[2], "b0");
  EXPECT_NE(fields[3][0], 'b');
  fields = contactOf("tip0.obj tip1.obj --against floor.obj floor.obj --no-self");
  EXPECT_EQ(fields[2], "0");
  EXPECT_EQ(fields[3][0], 'b');
}

TEST_F(CcdTool, NoSelfLeavesOnlyPairs) {
  writeTip();
  Mesh far = edgeAlongX();
  for (auto& p : far.vertices) p[2] += 100;
  writeText(path("far.obj"), toObj(far));
  const std::string pair =
      "run tip0.obj tip1.obj --against far.obj far.obj --json r.json";
  ASSERT_EQ(run(pair).exit_code, 0);
  EXPECT_EQ(json("r.json").at("steps").at(0).at("contacts").at("vf"), 1);
  ASSERT_EQ(run(pair + " --no-self").exit_code, 0);
  EXPECT_EQ(json("r.json").at("steps").at(0).at("contacts").at("vf"), 0);
}

TEST_F(CcdTool, FirstAndAnyAgreeWithAll) {
  writeTip();
  double toc_lo[3];
  int i = 0;
  for (const char* query : {"all", "first", "any"}) {
    ASSERT_EQ(run("run tip0.obj tip1.obj --json r.json --query " + std::string(query))
                  .exit_code,
              0);
    const Json step = json("r.json").at("steps").at(0);
    EXPECT_EQ(step.at("contacts"), Json({{"vf", 1}, {"ee", 0}, {"crossing", 0}}))
        << query;
    toc_lo[i++] = step.at("first").at("toc_lo").get<double>();
  }
  EXPECT_EQ(toc_lo[0], toc_lo[1]);
  EXPECT_EQ(toc_lo[0], toc_lo[2]);  // there is only one to find
}

TEST_F(CcdTool, PaintsTheVerticesOfContacts) {
  writeTip();
  ASSERT_EQ(run("run tip0.obj tip1.obj --paint p.ply --at-time 1").exit_code, 0);
  expectSame(readMesh(path("p.ply").string()), floorAndTip(2));
  const std::string file = readText(path("p.ply"));
  const std::string end = "end_header\n";
  const std::size_t body = file.find(end) + end.size();
  constexpr std::size_t kVertexBytes = 27, kColourOffset = 24;
  const auto colourOf = [&](std::size_t v) {
    return file.substr(body + v * kVertexBytes + kColourOffset, 3);
  };
  for (const std::size_t v : {0u, 1u, 2u}) EXPECT_EQ(colourOf(v), colourOf(3));
  EXPECT_EQ(colourOf(4), colourOf(5));
  EXPECT_NE(colourOf(3), colourOf(4));
}

TEST_F(CcdTool, BadInputsExitWithTwoAndWriteNothing) {
  writeTip();
  const Mesh tip = floorAndTip(0);
  Mesh turned = tip;
  turned.triangles[1] = {4, 3, 5};
  Mesh smaller = tip;
  smaller.vertices.pop_back();
  smaller.triangles.pop_back();
  writeText(path("turned.obj"), toObj(turned));
  writeText(path("smaller.obj"), toObj(smaller));
  writeText(path("cut.off"), toOff(tip).substr(0, 30));
  writeText(path("nan.obj"), toObj(tip) + "v nan 0 0\n");
  const std::string outputs = " --contacts c.csv --json r.json --paint p.ply";
  expectFailure("run tip0.obj missing.obj" + outputs, "missing.obj: cannot open");
  expectFailure("run missing.obj tip0.obj" + outputs, "missing.obj: cannot open");
  expectFailure("run tip0.obj turned.obj" + outputs, "turned.obj: its faces differ");
  expectFailure("run tip0.obj smaller.obj" + outputs, "smaller.obj: has 5 vertices");
  expectFailure("run tip0.obj cut.off" + outputs, "cut.off: ");
  expectFailure("run tip0.obj nan.obj" + outputs, "nan.obj: line ");
  // The error is found before the first step, which would succeed.
  expectFailure("run tip0.obj tip1.obj turned.obj" + outputs, "turned.obj: ");
}

TEST_F(CcdTool, BadOutputsAreRefusedAndNothingIsWritten) {
  writeTip();
  const std::string good = "run tip0.obj tip1.obj --contacts c.csv";
  expectFailure(good + " --json no/r.json", "no/r.json: cannot write");
  expectFailure(good + " --json .", ".: cannot write");
  expectFailure(good + " --json c.csv", "c.csv: cannot write");
  expectFailure(good + " --json ./c.csv", "c.csv: cannot write");
  expectFailure(good + " --json ''", "no file is named");
  expectFailure(good + " --paint tip1.obj", "tip1.obj: cannot write");
  EXPECT_EQ(readText(path("tip1.obj")), toObj(floorAndTip(2)));
  // Closed: no file may take its place.
  const Outcome closed = run(good, "&-");
  EXPECT_EQ(closed.exit_code, 2);
  EXPECT_NE(closed.err.find("standard output"), std::string::npos) << closed.err;
  EXPECT_FALSE(fs::exists(path("c.csv")));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  expectFailure("run tip0.obj tip1.obj --json /dev/full", "/dev/full: writing failed", 4);
  const Outcome outcome = run(good, "/dev/full");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("standard output"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(path("c.csv")));
}

// Tried as a user who may not write there; root may.
TEST_F(CcdTool, NamesTheCauseIfAFileMayNotBeWritten) {
  fs::create_directory(path("shut"));
  writeText(path("shut/c.csv"), "old");
  for (const char* name : {"shut", "shut/c.csv"})
    fs::permissions(
        path(name),
        fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write,
        fs::perm_options::remove);
  const auto tryAsOther = [&](const std::string& name) {
    if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(2);
    errno = 0;
    try {
      fcl_ccd::requireWritable(path(name).string());
    } catch (const std::exception& error) {
      std::fputs(error.what(), stderr);
      _exit(1);
    }
    _exit(0);
  };
  for (const char* name : {"shut/c.csv", "shut/new.csv"})
    EXPECT_EXIT(tryAsOther(name), ::testing::ExitedWithCode(1),
                std::string(name) + ": cannot write: Permission denied");
  EXPECT_EXIT(tryAsOther("no/c.csv"), ::testing::ExitedWithCode(1),
              "no/c.csv: cannot write: No such file");
  EXPECT_EXIT(tryAsOther("shut/c.csv/c.csv"), ::testing::ExitedWithCode(1),
              "cannot write: Not a directory");
}

TEST_F(CcdTool, FailureLeavesAnExistingFileAlone) {
  writeTip();
  writeText(path("r.json"), "old");
  EXPECT_EQ(run("run tip0.obj missing.obj --json r.json").exit_code, 2);
  EXPECT_EQ(readText(path("r.json")), "old");
  EXPECT_EQ(run("run tip0.obj tip1.obj --json r.json").exit_code, 0);
  EXPECT_EQ(json("r.json").count("steps"), 1u);
}

TEST_F(CcdTool, FollowsLinksAndKeepsPermissions) {
  writeTip();
  writeText(path("r.json"), "old");
  fs::permissions(path("r.json"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("r.json", path("link.json"));
  ASSERT_EQ(run("run tip0.obj tip1.obj --json link.json").exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(path("link.json")));
  EXPECT_EQ(json("r.json").count("steps"), 1u);
  EXPECT_EQ(fs::status(path("r.json")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  // To a file that does not exist yet.
  fs::create_symlink("new.json", path("new_link.json"));
  ASSERT_EQ(run("run tip0.obj tip1.obj --json new_link.json").exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(path("new_link.json")));
  EXPECT_EQ(json("new.json").count("steps"), 1u);
}

TEST_F(CcdTool, WritesToTheLongestName) {
  writeTip();
  const std::string name = std::string(250, 'r') + ".json";
  ASSERT_EQ(run("run tip0.obj tip1.obj --json " + name).exit_code, 0);
  EXPECT_EQ(json(name).count("steps"), 1u);
}

TEST_F(CcdTool, WritesToStdoutInPlace) {
  if (!fs::exists("/dev/stdout")) GTEST_SKIP() << "no /dev/stdout here";
  writeTip();
  const Outcome outcome = run("run tip0.obj tip1.obj --contacts /dev/stdout");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = linesOf(outcome.out);
  // Two of the table, two of the contacts, five of the summary.
  ASSERT_EQ(lines.size(), 9u) << outcome.out;
  EXPECT_NE(
      std::find(lines.begin(), lines.end(), "step,kind,i0,i1,i2,i3,toc_lo,toc_hi,i4"),
      lines.end());
}

TEST_F(CcdTool, UsageErrorsExitWithTwo) {
  writeTip();
  for (const char* arguments :
       {"",
        "walk",
        "run",
        "run tip0.obj",
        "run tip0.obj tip1.obj --jobs -1",
        "run tip0.obj tip1.obj --weld -1",
        "run tip0.obj tip1.obj --weld nan",
        "run tip0.obj tip1.obj --resume",
        "run tip0.obj tip1.obj --contacts c.csv --columns colour",
        "run tip0.obj tip1.obj --columns normal",
        "run tip0.obj tip1.obj --start 0",
        "run tip0.obj tip1.obj tip0.obj --against tip0.obj tip1.obj",
        "run tip0.obj tip1.obj --no-self",
        "run tip0.obj tip1.obj --query some",
        "run tip0.obj tip1.obj --repeat 0",
        "run tip0.obj tip1.obj --repeat x",
        "run tip0.obj tip1.obj --toc-err -1",
        "run tip0.obj tip1.obj --toc-err nan",
        "run tip0.obj tip1.obj --toc-err inf",
        "run tip0.obj tip1.obj --colour red",
        "queries --kind vf",
        "queries q.csv",
        "queries q.csv --kind fv",
        "queries q.csv --kind 0",
        "run tip0.obj tip1.obj --query 1"}) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err, "");
    EXPECT_EQ(outcome.out, "");
  }
}

TEST_F(CcdTool, HelpAndVersionExitWithZero) {
  for (const char* arguments : {"--help", "run --help", "candidates --help",
                                "queries --help", "compare --help"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.out.find("Examples:"), std::string::npos) << arguments;
  }
  const Outcome version = run("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("fcl-ccd ", 0), 0u) << version.out;
}

}  // namespace

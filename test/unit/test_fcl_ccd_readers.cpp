// SPDX-License-Identifier: BSD-3-Clause
//
// Mesh files as other programs write them, cut files, and files of cables and points.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ccd_tool.h"
#include "csv_rows.h"
#include "mesh_io.h"
#include "triangulate.h"

namespace {

using namespace fcl::test;
using fcl_ccd::PolygonMesh;
using fcl_ccd::readPolygonMesh;

using NamedText = std::pair<std::string, std::string>;

class CcdReaders : public fcl::test::CcdToolTest {
 protected:
  /// @brief The mesh of a file that is not written to the disk.
  static PolygonMesh parse(const NamedText& file) {
    return fcl_ccd::parsePolygonMesh(file.first, file.second);
  }

  /// @brief The message of the error; empty if the file is read.
  static std::string errorOf(const NamedText& file) {
    try {
      parse(file);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  static void expectMesh(const NamedText& file, const Mesh& mesh) {
    SCOPED_TRACE(file.first + ": " + file.second);
    try {
      const PolygonMesh read = parse(file);
      EXPECT_EQ(read.vertices, mesh.vertices);
      EXPECT_EQ(fcl_ccd::triangulate(read.vertices, read.faces), mesh.triangles);
    } catch (const std::runtime_error& error) {
      ADD_FAILURE() << error.what();
    }
  }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// @brief The file with the three ends of lines.
std::vector<NamedText> withLineEnds(const NamedText& file) {
  return {file,
          {file.first, replaced(file.second, "\n", "\r\n")},
          {file.first, replaced(file.second, "\n", "\r")}};
}

const Mesh& square() {
  static const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, -1.5}},
                         {{0, 1, 2}, {0, 2, 3}}};
  return mesh;
}

TEST_F(CcdReaders, ObjAsOthersWriteIt) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 -1.5\n";
  for (const std::string& text : std::vector<std::string>{
           vertices + "f 1 2 3 4\n", vertices + "f 1//1 2//1 3//1 4//1",
           vertices + "f 1/1 2/2 3/3 4/4\n\n\n", vertices + "fo 1 2 3 4\n",
           vertices + "f -4 -3 -2 -1\n", "f 1 2 3 4\n" + vertices,
           "v 0 0 0 .5 .5 .5\nv +1 0 0 1 1 1\nv 1e+0 1.E0 0 1 1 1\nv 0 1 -15D-1 1 1 1\n"
           "f 1 +2 3 4\n",
           "v\t0\t0 0 1#c\n v 1 0  0\t1 #\nv 1 \\\n1 0\\\n\nv 0. .1e1 -1.5\n# \\\n"
           "g a#b\nusemtl x y\nf 1 2 \\\n 3\\\n 4",
           vertices + "s off\nf 1 2 3 4\ncurv2 1 2\nparm u 0 1\nend\n"})
    for (const NamedText& file : withLineEnds({"m.obj", text}))
      expectMesh(file, square());
}

TEST_F(CcdReaders, OffAsOthersWriteIt) {
  const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 -1.5\n4 0 1 2 3\n";
  for (const std::string& text : std::vector<std::string>{
           "OFF\n4 1 0\n" + body, "OFF 4 1 0\n" + body, "OFF4 1 0\n" + body,
           "4 1 0\n" + body, "off\n4 1\n" + body,
           "\n# c\nOFF # c\n\n4 1 0 # c\n\n" + replaced(body, "\n", " # c\n\n"),
           "NCOFF\n4 1 0\n" + replaced(body, "\n", " 0 0 1 .5 .5 .5 1\n"),
           "CNOFF 4 1 0\n" + replaced(body, "\n", " 255 0 0\n"),
           "STCNOFF\n4 1 0\n" + replaced(body, "\n", " 0 0\n"),
           "COFF4 1 0\n" + replaced(body, "\n", "\t255 0 0 255\n")})
    for (const NamedText& file : withLineEnds({"m.off", text}))
      expectMesh(file, square());
}

/// @brief A PLY of the square with these types: of coordinates, and of ids.
std::string plySquare(const std::string& scalar, const std::string& id) {
  return "ply\nformat ascii 1.0\nelement camera 1\nproperty float view\n"
         "element vertex 4\nproperty " +
         scalar + " x\nproperty float nx\nproperty " + scalar +
         " y\nproperty list uchar int tags\nproperty double z\n"
         "element face 1\nproperty float quality\nproperty list " +
         id + ' ' + id +
         " vertex_indices\nend_header\n"
         "nan\n0 nan 0 0 0\n1 inf 0 1 7 0\n1 -NaN 1 2 7\n8 0\n0 1.#QNAN 1 0 -1.5\nnan\n"
         "4\n0 1 2 3\n";
}

TEST_F(CcdReaders, AsciiPlyAsOthersWriteIt) {
  for (const char* scalar :
       {"float", "double", "char", "uint8", "short", "ushort", "int"})
    for (const char* id : {"char", "uchar", "int16", "ushort", "int", "uint32"})
      for (const NamedText& file : withLineEnds({"m.ply", plySquare(scalar, id)}))
        expectMesh(file, square());
}

template <typename Coordinate, typename Id>
std::string binarySquare(bool big_endian, const std::string& coordinate,
                         const std::string& id, const std::string& line_end) {
  std::string ply = replaced(
      std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
          "_endian 1.0\nelement vertex 4\nproperty " + coordinate + " x\nproperty " +
          coordinate + " y\nproperty float z\nelement face 1\nproperty list uchar " + id +
          " vertex_index\nend_header\n",
      "\n", line_end);
  for (const auto& p : square().vertices) {
    for (std::size_t k = 0; k < 2; ++k)
      appendBytes(static_cast<Coordinate>(p[k]), big_endian, ply);
    appendBytes(static_cast<float>(p[2]), big_endian, ply);
  }
  ply += '\4';
  for (int i = 0; i < 4; ++i) appendBytes(static_cast<Id>(i), big_endian, ply);
  return ply;
}

TEST_F(CcdReaders, BinaryPlyAsOthersWriteIt) {
  for (const bool big : {false, true})
    for (const char* end : {"\n", "\r\n", "\r"}) {
      expectMesh({"m.ply", binarySquare<float, int>(big, "float", "int", end)}, square());
      expectMesh(
          {"m.ply", binarySquare<std::int32_t, std::uint8_t>(big, "int", "uchar", end)},
          square());
      expectMesh(
          {"m.ply", binarySquare<std::int8_t, std::int16_t>(big, "char", "short", end)},
          square());
      expectMesh({"m.ply", binarySquare<std::uint16_t, std::uint16_t>(big, "ushort",
                                                                      "uint16", end)},
                 square());
    }
}

std::string plyOfStrips(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
         "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
}

// -1 begins a new strip. A corner that is repeated leads to the next part of a strip.
TEST_F(CcdReaders, PlyOfTriangleStrips) {
  Mesh mesh;
  for (int i = 0; i < 6; ++i) mesh.vertices.push_back({double(i / 2), double(i % 2), 0});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}, {0, 2, 1}};
  const std::vector<int> strip{0, 2, 1, 3, -1, 2, 4, 3, 5, 5, 0, 0, 2, 1};
  std::string ascii = plyOfStrips("ascii");
  for (const auto& p : mesh.vertices)
    ascii += exactText(p[0]) + ' ' + exactText(p[1]) + " 0\n";
  ascii += std::to_string(strip.size());
  for (const int id : strip) ascii += ' ' + std::to_string(id);
  const PolygonMesh read = parse({"s.ply", ascii + '\n'});
  EXPECT_EQ(read.faces.corners,
            (std::vector<int>{0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5, 0, 2, 1}));
  EXPECT_TRUE(read.faces.ends.empty());
  for (const bool big : {false, true}) {
    std::string ply = plyOfStrips(big ? "binary_big_endian" : "binary_little_endian");
    for (const auto& p : mesh.vertices)
      for (const double x : p) appendBytes(static_cast<float>(x), big, ply);
    appendBytes(static_cast<int>(strip.size()), big, ply);
    for (const int id : strip) appendBytes(id, big, ply);
    expectMesh({"s.ply", ply}, mesh);
  }
  EXPECT_NE(errorOf({"s.ply", replaced(ascii, " 4 ", " 6 ")})
                .find("vertex id 6 is out of range; there are 6"),
            std::string::npos);
}

const Mesh& twoFacets() {
  static const Mesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
      {{0, 1, 2}, {3, 4, 5}}};
  return mesh;
}

std::string stlOfTwo(const std::string& between) {
  std::string text = "solid one\n";
  for (int i = 0; i < 2; ++i) {
    if (i == 1) text += between;
    text += "facet normal 0 0 1\n outer loop\n";
    for (const char* xy : {"0 0", "1 0", "0 1"})
      text += std::string("  vertex ") + xy + ' ' + std::to_string(i) + '\n';
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid one\n";
}

TEST_F(CcdReaders, StlAsOthersWriteIt) {
  const std::string plain = stlOfTwo(""), several = stlOfTwo("endsolid one\nsolid two\n");
  std::string upper = plain;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  for (const std::string& text : std::vector<std::string>{
           plain, several, upper, replaced(plain, "endsolid one", "endsolidone"),
           replaced(plain, "solid one", "solidone"),
           replaced(replaced(plain, "endl", "end l"), "ends", "end s"),
           replaced(plain, "endfacet", "end facet"),
           replaced(plain, "normal 0 0 1", "normal nan nan -nan(ind)"),
           replaced(plain, " normal 0 0 1", ""), replaced(plain, "solid one", "solid"),
           replaced(plain, "solid one", "solid facet of a vertex"),
           replaced(plain, "loop\n", "loop "), replaced(plain, "\n", "\n\n\t")})
    for (const NamedText& file : withLineEnds({"m.stl", text}))
      expectMesh(file, twoFacets());

  for (const char* const title : {"solid of a binary file", "COLOR=RGBA", ""}) {
    std::string bytes = title;
    bytes.resize(80, bytes.empty() ? '\0' : ' ');
    appendBytes(std::uint32_t{2}, false, bytes);
    for (std::size_t i = 0; i < 2; ++i) {
      for (int k = 0; k < 3; ++k) appendBytes(std::nanf(""), false, bytes);
      for (std::size_t k = 0; k < 3; ++k)
        for (const double x : twoFacets().vertices[3 * i + k])
          appendBytes(static_cast<float>(x), false, bytes);
      bytes += "\x1f\xfc";  // a colour
    }
    expectMesh({"b.stl", bytes}, twoFacets());
    for (const std::size_t size : {1u, 2u, 49u, 50u, 1000u})
      expectMesh({"b.stl", bytes + std::string(size, 'x')}, twoFacets());
    for (std::size_t size = 1; size < bytes.size(); ++size)
      EXPECT_NE(errorOf({"b.stl", bytes.substr(0, size)}), "") << size;
    EXPECT_NE(errorOf({"b.stl", bytes.substr(0, 150)})
                  .find("ends before facet 1 of 2 (counted from 0): it is cut short"),
              std::string::npos);
    bytes[80] = '\0';
    EXPECT_NE(errorOf({"b.stl", bytes}).find("promises no facets"), std::string::npos);
  }
}

// A file that is cut anywhere is refused, unless all of its mesh is there. All numbers
// have one digit, so that none can be cut.
TEST_F(CcdReaders, CutFilesAreRefused) {
  const std::string stl = stlOfTwo("endsolid one\nsolid two\n");
  const std::size_t first_end = stl.find("endsolid") + 8, last_end = stl.rfind("one\n");
  const std::string off = toOff(floorAndTip(0)), ply = toAsciiPly(floorAndTip(0));
  const std::string binary = toBinaryPly<double>(floorAndTip(0), false);
  const auto expectRefused = [&](const NamedText& file) {
    const std::string error = errorOf(file);
    EXPECT_NE(error, "") << file.second;
    EXPECT_EQ(error.rfind(file.first + ": ", 0), 0u) << error;
  };
  for (std::size_t size = 1; size < stl.size(); ++size) {
    const bool is_whole = (size >= first_end && size < stl.find("solid two") + 5 - 4) ||
                          size >= last_end - 1;
    const NamedText file{"m.stl", stl.substr(0, size)};
    if (is_whole)
      EXPECT_EQ(errorOf(file), "") << file.second;
    else
      expectRefused(file);
  }
  for (std::size_t size = 1; size + 1 < off.size(); ++size)
    expectRefused({"m.off", off.substr(0, size)});
  for (std::size_t size = 1; size + 1 < ply.size(); ++size)
    expectRefused({"m.ply", ply.substr(0, size)});
  for (std::size_t size = 1; size < binary.size(); ++size)
    expectRefused({"m.ply", binary.substr(0, size)});
}

struct Broken {
  const char* name;
  std::string text;
  const char* cause;
};

TEST_F(CcdReaders, ErrorsNameTheLineAndTheCause) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string ply = plySquare("float", "int");
  const std::string edges = replaced(
      ply, "end_header\n",
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n");
  const std::vector<Broken> files{
      {"m.obj", obj + "v nan 0 0\n", "line 4: 'nan' is not finite"},
      {"m.obj", obj + "v 0 0 -1.#IND\nf 1 2 3\n", "line 4: '-1.#IND' is not finite"},
      {"m.obj", obj + "v 0 1e999 0\n", "line 4: '1e999' is not finite"},
      {"m.obj", obj + "v 0 0x1 0\n", "line 4: '0x1' is not a number"},
      {"m.obj", obj + "v 0 1,5 0\n", "line 4: '1,5' is not a number"},
      {"m.obj", obj + "surf 0 1 0 1 1 2 3\n", "'surf' is geometry that is not read"},
      {"m.obj", obj + "call other.obj\n", "'call' is geometry that is not read"},
      {"m.obj", obj + "l 1\n", "line 4: a line needs at least two vertices"},
      {"m.obj", obj + "p\n", "line 4: 'p' needs at least one vertex"},
      {"m.obj", obj + "l 1 4\n", "line 4: vertex id 4 is out of range; there are 3"},
      {"m.obj", obj, "has no faces, lines or points. Free points are 'p'"},
      {"m.obj", std::string("\xff\xfe") + "v", "UTF-16"},
      {"m.off", "4OFF\n1 0 0\n", "line 1: '4OFF' is a mesh in more than three"},
      {"m.off", "nOFF 4\n", "line 1: 'nOFF' is a mesh in more than three"},
      {"m.off", "OFF BINARY\n1 0 0\n", "binary OFF is not supported"},
      {"m.off", "OFF\n3 -1 0\n", "negative"},
      {"m.off", "OFF\n3\n", "line 2: expected the numbers of vertices and faces"},
      {"m.off", "OFF9999999999 1 0\n", "more than 2,147,483,647 vertices"},
      {"m.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", "ends before vertex 1 of"},
      {"m.ply", replaced(ply, "\n4\n0 1 2 3", "\n2000000000\n0 1 2 3"), "face 0 of 1"},
      {"m.ply", replaced(ply, "0 1 2 3\n", "0 1 2 4\n"), "face 0 (counted from 0) has"},
      {"m.ply", replaced(ply, "1 inf 0", "inf inf 0"), "vertex 1 of 4"},
      {"m.ply", replaced(ply, "1 inf 0", "inf inf 0"), "line 17: 'inf' is not finite"},
      {"m.ply", replaced(ply, "1 inf 0", "1 x 0"), "'x' is not a number"},
      {"m.ply", replaced(ply, "int vertex_indices", "float vertex_indices"),
       "has no list vertex_indices or vertex_index of integers"},
      {"m.ply", edges + "0 4\n", "'edge' 0 of 1 (counted from 0), line"},
      {"m.ply", replaced(edges, "vertex2", "vertex_2") + "0 1\n", "no property vertex2"},
      {"m.stl", replaced(stlOfTwo(""), "endloop", ""), "line 8: expected endloop"},
      {"m.stl", replaced(stlOfTwo(""), " outer loop\n", ""),
       "a vertex outside of a loop"},
      {"m.stl", replaced(stlOfTwo(""), "solid one\n", "").substr(4),
       "is not a word of STL"},
      {"m.stl", replaced(stlOfTwo(""), "vertex 1 0 1", "vertex 1 0 inf"),
       "line 12: 'inf' is not finite"}};
  for (const Broken& broken : files)
    for (const NamedText& file : withLineEnds({broken.name, broken.text})) {
      if (std::strcmp(broken.cause, "UTF-16") == 0 && file.second != broken.text)
        continue;
      const std::string error = errorOf(file);
      EXPECT_NE(error.find(broken.cause), std::string::npos)
          << broken.text << "\nsays: " << error;
    }
}

// Against the C library, which rounds to the nearest double.
TEST_F(CcdReaders, NumbersAreRoundedOnce) {
  std::mt19937_64 random(5);
  std::vector<std::string> words{"1e-400",
                                 "-1e-400",
                                 "4.9406564584124654e-324",
                                 "2.4703282292062327e-324",
                                 "2.2250738585072011e-308",
                                 "1.7976931348623157e308",
                                 "9007199254740993",
                                 "0.1e1",
                                 "+.5",
                                 "-5.",
                                 "00012.50",
                                 "1E+05",
                                 "100000000000000000000000000000000000000000000000.1"};
  for (int i = 0; i < 3000; ++i) {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    char text[64];
    std::snprintf(text, sizeof text, "%.*e", static_cast<int>(random() % 25), value);
    if (std::isfinite(std::strtod(text, nullptr))) words.emplace_back(text);
  }
  while (words.size() % 3 != 0) words.emplace_back("0");
  std::string obj,
      ply = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(words.size() / 3) +
            "\nproperty double x\nproperty double y\nproperty double z\n"
            "element face 1\nproperty list int int vertex_index\nend_header\n";
  for (std::size_t i = 0; i < words.size(); i += 3) {
    const std::string line = words[i] + ' ' + words[i + 1] + ' ' + words[i + 2] + '\n';
    obj += "v " + line;
    ply += line;
  }
  for (const NamedText& file :
       {NamedText{"n.obj", obj + "f 1 2 3\n"}, NamedText{"n.ply", ply + "3 0 1 2\n"}}) {
    const PolygonMesh mesh = parse(file);
    ASSERT_EQ(mesh.vertices.size(), words.size() / 3);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const double expected = std::strtod(words[i].c_str(), nullptr);
      EXPECT_EQ(std::memcmp(&mesh.vertices[i / 3][i % 3], &expected, sizeof expected), 0)
          << words[i];
    }
  }
  // A float is rounded from the text, not from a double.
  const std::string halfway = "1.00000005960464477539062500001";
  const PolygonMesh floats = parse(
      {"f.ply",
       replaced(replaced(ply.substr(0, ply.find("end_header") + 11), "double", "float"),
                "vertex " + std::to_string(words.size() / 3), "vertex 1") +
           halfway + " 0.1 0\n3 0 0 0\n"});
  EXPECT_EQ(floats.vertices[0][0], double(std::strtof(halfway.c_str(), nullptr)));
  EXPECT_EQ(floats.vertices[0][1], double(0.1f));
}

std::string cable(double height) {
  return "v 0 0 " + exactText(1 - height) + "\nv 0 0 " + exactText(0.5 - height) +
         "\nl 1 2\n";
}

const char* const kPlate =
    "v -1 -1 .25\nv 1 -1 .25\nv 1 1.5 .25\nv -1 1 .25\nf 1 2 3\nf 1 3 4\n";

// The lower end meets the plate at .25, the upper end at .75.
TEST_F(CcdReaders, CablesMeetPlates) {
  writeText(path("plate.obj"), kPlate);
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
      "property float y\nproperty float z\nelement edge 1\n"
      "property uchar vertex1\nproperty uchar vertex2\nend_header\n";
  writeText(path("c0.obj"), cable(0));
  writeText(path("c1.obj"), cable(1));
  writeText(path("c0.ply"), head + "0 0 1\n0 0 .5\n0 1\n");
  writeText(path("c1.ply"), head + "0 0 0\n0 0 -.5\n0 1\n");
  for (const char* frames : {"c0.obj c1.obj", "c0.ply c1.ply"})
    for (const char* weld : {"", " --weld"}) {
      const Outcome outcome = run("run " + std::string(frames) + weld +
                                  " --against plate.obj --contacts c.csv --columns "
                                  "triangles --paint p.ply");
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
      ASSERT_EQ(lines.size(), 3u);
      const std::vector<std::string> lower = csvFields(lines[1]);
      EXPECT_EQ(lower[1], "vf");
      EXPECT_EQ(lower[2], "1");
      EXPECT_LE(std::stod(lower[6]), 0.25);
      EXPECT_GE(std::stod(lower[7]), 0.25);
      EXPECT_EQ(lower[8], "e0");
      EXPECT_EQ(lower[9][0], 'b');
      EXPECT_EQ(csvFields(lines[2])[2], "0");
      const PolygonMesh painted = readPolygonMesh(path("p.ply").string());
      EXPECT_EQ(painted.vertices.size(), 6u);
      EXPECT_EQ(painted.faces.size(), 2u);
      EXPECT_EQ(painted.free.edges, (fcl_ccd::FreeEdges{{0, 1}}));
    }
  // As the body that is met.
  ASSERT_EQ(run("run plate.obj plate.obj --against c0.obj c1.obj --contacts c.csv "
                "--columns triangles")
                .exit_code,
            0);
  const std::vector<std::string> lines = linesOf(readText(path("c.csv")));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(csvFields(lines[1])[8], "be0");
}

// Two ropes that cross, and a point that falls through a triangle of the same mesh.
TEST_F(CcdReaders, RopesAndPointsAreMeshes) {
  const auto ropes = [](double z) {
    return "v -1 0 0\nv 0 .5 0\nv 1 0 0\nl 1 2 3\nv 0 0 " + exactText(z) + "\nv 0 1 " +
           exactText(z) + "\nl -2 -1\n";
  };
  writeText(path("r0.obj"), ropes(1));
  writeText(path("r1.obj"), ropes(-1));
  ASSERT_EQ(run("run r0.obj r1.obj --contacts c.csv --columns triangles --json r.json")
                .exit_code,
            0);
  std::vector<std::string> lines = linesOf(readText(path("c.csv")));
  ASSERT_GE(lines.size(), 2u);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(csvFields(lines[i])[1], "ee");
    EXPECT_EQ(csvFields(lines[i])[8][0], 'e');
    EXPECT_NEAR(std::stod(csvFields(lines[i])[6]), 0.5, 1e-3);
  }
  const auto point = [](double z) {
    return "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\nv 0 0 " + exactText(z) +
           "\nv 5 5 5\np 4 5\n";
  };
  writeText(path("p0.obj"), point(1));
  writeText(path("p1.obj"), point(-3));
  ASSERT_EQ(run("run p0.obj p1.obj --contacts c.csv --columns triangles").exit_code, 0);
  lines = linesOf(readText(path("c.csv")));
  ASSERT_EQ(lines.size(), 2u);
  const std::vector<std::string> fields = csvFields(lines[1]);
  EXPECT_EQ(fields[1], "vf");
  EXPECT_EQ(fields[2], "3");
  EXPECT_EQ(fields[8], "p0");
  EXPECT_EQ(fields[9], "0");
}

// Joined ends make a point of an edge. It keeps its number, and so do the others.
TEST_F(CcdReaders, WeldedEdgesKeepTheirNumbers) {
  const auto frame = [](double z) {
    std::string text;
    for (const char* xy : {"0 0", "0 0", ".5 .25", ".5 .5"})
      text += std::string("v ") + xy + ' ' + exactText(z) + '\n';
    return text + "l 1 2\nl 3 4\np 4\n";
  };
  writeText(path("plate.obj"), kPlate);
  writeText(path("f0.obj"), frame(1));
  writeText(path("f1.obj"), frame(0));
  const Outcome outcome =
      run("run f0.obj f1.obj --weld --against plate.obj --contacts c.csv --columns "
          "triangles");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::set<std::string> first;
  for (const std::string& line : linesOf(readText(path("c.csv"))))
    if (csvFields(line)[1] == "vf") first.insert(csvFields(line)[2] + csvFields(line)[8]);
  EXPECT_EQ(first, (std::set<std::string>{"0e0", "2e1", "3e1"}));
}

TEST_F(CcdReaders, FramesHaveTheSameLines) {
  writeText(path("a.obj"), cable(0) + "v 3 3 3\n");
  writeText(path("b.obj"), replaced(cable(1), "l 1 2", "l 1 3") + "v 3 3 3\n");
  writeText(path("c.obj"), cable(1) + "v 3 3 3\np 3\n");
  expectFailure("run a.obj b.obj",
                "b.obj: its lines or points differ from those of a.obj");
  expectFailure("run a.obj c.obj",
                "c.obj: its lines or points differ from those of a.obj");
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
//
// Shared by the tests of the program fcl-ccd: meshes as text, and a folder to run it in.
#ifndef FCL_CCD_TEST_CCD_TOOL_H
#define FCL_CCD_TEST_CCD_TOOL_H

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "mesh_io.h"

namespace fcl {
namespace test {

namespace fs = std::filesystem;
using fcl_ccd::Mesh;

inline std::string readText(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void writeText(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// @brief A number with 17 digits, which identify a double.
inline std::string exactText(double value) {
  std::ostringstream out;
  out.precision(17);
  out << value;
  return out.str();
}

inline std::string toObj(const Mesh& mesh) {
  std::string text = "# made by a test\n";
  for (const auto& p : mesh.vertices)
    text += "v " + exactText(p[0]) + ' ' + exactText(p[1]) + ' ' + exactText(p[2]) + '\n';
  for (const auto& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + ' ' + std::to_string(t[1] + 1) + ' ' +
            std::to_string(t[2] + 1) + '\n';
  return text;
}

/// @brief Vertices and faces in the form of OFF and ascii PLY.
inline std::string asciiBody(const Mesh& mesh) {
  std::string text;
  for (const auto& p : mesh.vertices)
    text += exactText(p[0]) + ' ' + exactText(p[1]) + ' ' + exactText(p[2]) + '\n';
  for (const auto& t : mesh.triangles)
    text += "3 " + std::to_string(t[0]) + ' ' + std::to_string(t[1]) + ' ' +
            std::to_string(t[2]) + '\n';
  return text;
}

inline std::string toOff(const Mesh& mesh) {
  return "OFF\n" + std::to_string(mesh.vertices.size()) + ' ' +
         std::to_string(mesh.triangles.size()) + " 0\n" + asciiBody(mesh);
}

inline std::string plyHeader(const Mesh& mesh, const std::string& format,
                             const std::string& scalar) {
  std::string text = "ply\nformat " + format + " 1.0\ncomment made by a test\n";
  text += "element vertex " + std::to_string(mesh.vertices.size()) + '\n';
  for (const char* name : {"x", "y", "z"})
    text += "property " + scalar + ' ' + name + '\n';
  text += "element face " + std::to_string(mesh.triangles.size()) + '\n';
  return text + "property list uchar int vertex_indices\nend_header\n";
}

inline std::string toAsciiPly(const Mesh& mesh) {
  return plyHeader(mesh, "ascii", "double") + asciiBody(mesh);
}

template <typename T>
inline void appendBytes(T value, bool big_endian, std::string& out) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  const std::uint16_t probe = 1;
  unsigned char first_byte = 0;
  std::memcpy(&first_byte, &probe, 1);
  const bool host_is_big_endian = first_byte == 0;
  if (big_endian != host_is_big_endian) bytes.assign(bytes.rbegin(), bytes.rend());
  out += bytes;
}

template <typename Scalar>
inline std::string toBinaryPly(const Mesh& mesh, bool big_endian) {
  std::string out =
      plyHeader(mesh, big_endian ? "binary_big_endian" : "binary_little_endian",
                sizeof(Scalar) == sizeof(float) ? "float" : "double");
  for (const auto& p : mesh.vertices)
    for (const double x : p) appendBytes(static_cast<Scalar>(x), big_endian, out);
  for (const auto& t : mesh.triangles) {
    out += '\3';
    for (const int id : t) appendBytes(static_cast<std::int32_t>(id), big_endian, out);
  }
  return out;
}

/// @brief A floor (vertices 0 1 2) in the plane z = 0, and over it a triangle (3 4 5)
/// that points down and is lowered by `drop`. With drop 2 its tip, vertex 3, meets the
/// floor at t = 1/2, and nothing else touches.
inline Mesh floorAndTip(double drop) {
  return {{{-4, -4, 0},
           {4, -4, 0},
           {0, 4, 0},
           {0, 0, 1 - drop},
           {-1, 0, 3 - drop},
           {1, 0, 3 - drop}},
          {{0, 1, 2}, {3, 4, 5}}};
}

/// @brief A triangle whose edge 0 1 lies on the x axis.
inline Mesh edgeAlongX() { return {{{-1, 0, 0}, {1, 0, 0}, {0, -1, -5}}, {{0, 1, 2}}}; }

/// @brief A triangle whose edge 0 1, parallel to the y axis and at height 1, is lowered
/// by `drop`. With drop 2 it meets the edge of edgeAlongX() at t = 1/2, and nothing else
/// touches.
inline Mesh edgeAlongY(double drop) {
  return {{{0, -1, 1 - drop}, {0, 1, 1 - drop}, {0, 0, 3 - drop}}, {{0, 1, 2}}};
}

class CcdToolTest : public ::testing::Test {
 protected:
  struct Outcome {
    int exit_code;
    std::string out;
    std::string err;
  };

  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("fcl_ccd_tool_" + std::to_string(getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  void TearDown() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }

  /// @brief Runs the program in the test's folder. `arguments` has the shell's syntax.
  /// `out_name` is the file for its stdout.
  Outcome run(const std::string& arguments,
              const std::string& out_name = "out.txt") const {
    return runShell("'" FCL_CCD_TOOL "' " + arguments, out_name);
  }

  /// @brief Runs a command of the shell in the test's folder.
  Outcome runShell(const std::string& command,
                   const std::string& out_name = "out.txt") const {
    const fs::path out = path(out_name), err = path("err.txt");
    const int status = std::system(
        ("cd '" + folder_.string() + "' && " + command + " >" + out_name + " 2>err.txt")
            .c_str());
    Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", readText(err)};
    fs::remove(err);
    if (!fs::is_regular_file(out)) return outcome;
    outcome.out = readText(out);
    fs::remove(out);
    return outcome;
  }

  /// @brief Writes the frames tip0.obj and tip1.obj: the tip falls through the floor.
  void writeTip() const {
    writeText(path("tip0.obj"), toObj(floorAndTip(0)));
    writeText(path("tip1.obj"), toObj(floorAndTip(2)));
  }

  /// @brief Writes the frames x0.off, x1.off (at rest) and y0.ply, y1.ply (falling onto
  /// it).
  void writeEdges() const {
    writeText(path("x0.off"), toOff(edgeAlongX()));
    writeText(path("x1.off"), toOff(edgeAlongX()));
    writeText(path("y0.ply"), toAsciiPly(edgeAlongY(0)));
    writeText(path("y1.ply"), toBinaryPly<float>(edgeAlongY(2), true));
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.insert(entry.path().filename().string());
    return names;
  }

  /// @brief Expects that the program fails with this exit code, names `cause`, and leaves
  /// the folder's files as they were.
  void expectFailure(const std::string& arguments, const std::string& cause,
                     int exit_code = 2) const {
    SCOPED_TRACE(arguments);
    const std::set<std::string> before = files();
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code);
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), before);
  }

 private:
  fs::path folder_;
};

}  // namespace test
}  // namespace fcl

#endif

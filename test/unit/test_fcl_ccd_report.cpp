// SPDX-License-Identifier: BSD-3-Clause
//
// What the program fcl-ccd shows of a run: the page of --report, whose data are read back
// here, and the files of --picture and --paint. A browser opens the page in the test
// report_page.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ccd_sequence.h"
#include "csv_rows.h"
#include "mesh_files.h"
#include "render.h"
#include "sanitizer.h"

namespace {

using namespace fcl::test;
using fcl_ccd::Triangles;
using fcl_ccd::Vertices;
using Json = nlohmann::json;

/// The texts of the script elements of a class.
std::vector<std::string> elementsOf(const std::string& page, const std::string& name) {
  std::vector<std::string> texts;
  const std::string begin = "class=\"" + name + "\">", end = "</script>";
  for (std::size_t at = page.find(begin); at != std::string::npos;
       at = page.find(begin, at)) {
    at += begin.size();
    texts.push_back(page.substr(at, page.find(end, at) - at));
  }
  return texts;
}

std::string fromBase64(const std::string& text) {
  const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes += static_cast<char>(bits >> num_bits & 255u);
  }
  return bytes;
}

std::string unpacked(const std::string& text) {
  const std::string bytes = fromBase64(text);
  std::string all(1 << 20, '\0');
  uLongf size = all.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(all.data()), &size,
                       reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
            Z_OK);
  all.resize(size);
  return all;
}

/// The whole numbers of a block from a place on, seven bits a byte.
std::vector<long long> numbersOf(const std::string& bytes, std::size_t begin) {
  std::vector<long long> numbers;
  unsigned long long rest = 0;
  int shift = 0;
  for (std::size_t i = begin; i < bytes.size(); ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    rest |= (byte & 127ull) << shift;
    shift += 7;
    if (byte > 127) continue;
    numbers.push_back(rest % 2 == 1 ? -static_cast<long long>(rest / 2) - 1
                                    : static_cast<long long>(rest / 2));
    rest = 0;
    shift = 0;
  }
  return numbers;
}

/// The data of a page, read as its script reads them.
struct Page {
  explicit Page(const std::string& text)
      : mesh(Json::parse(elementsOf(text, "mesh").at(0))),
        summary(Json::parse(elementsOf(text, "summary").at(0))),
        picture(fromBase64(elementsOf(text, "picture").at(0))) {
    const std::size_t num_ids = 3 * mesh.at("triangles").get<std::size_t>() +
                                2 * mesh.at("edges").get<std::size_t>();
    const std::vector<long long> numbers =
        numbersOf(unpacked(elementsOf(text, "mesh-block").at(0)), 0);
    long long id = 0;
    for (std::size_t i = 0; i < num_ids; ++i)
      ids.push_back(static_cast<int>(id += numbers[i]));
    addFrame({numbers.begin() + static_cast<std::ptrdiff_t>(num_ids), numbers.end()});
    for (const std::string& step : elementsOf(text, "step"))
      steps.push_back(Json::parse(step));
    const std::vector<std::string> blocks = elementsOf(text, "step-block");
    EXPECT_EQ(blocks.size(), steps.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) addBlock(unpacked(blocks[i]), i);
  }

  void addBlock(const std::string& bytes, std::size_t i) {
    const std::size_t text = steps[i].at("sizes").at(0), num = steps[i].at("sizes").at(1),
                      key = steps[i].at("sizes").at(2);
    contacts.push_back(Json::parse(bytes.substr(0, text)));
    times.push_back(bytes.substr(text, num));
    if (key > 0) {
      // The frame as it is equals the one that was added up.
      addFrame(numbersOf(bytes.substr(0, text + num + key), text + num), true);
      EXPECT_EQ(nodes[nodes.size() - 2], nodes.back());
      nodes.pop_back();
      ++num_keys;
    }
    addFrame(numbersOf(bytes, text + num + key));
  }

  void addFrame(const std::vector<long long>& differences, bool is_key = false) {
    const std::size_t count = mesh.at("vertices");
    ASSERT_EQ(differences.size(), 3 * count);
    std::vector<std::array<long long, 3>> frame(count);
    for (std::size_t k = 0; k < 3; ++k) {
      long long moved = 0;
      for (std::size_t v = 0; v < count; ++v)
        frame[v][k] = (moved += differences[k * count + v]) +
                      (nodes.empty() || is_key ? 0 : nodes.back()[v][k]);
    }
    nodes.push_back(frame);
  }

  double at(std::size_t frame, std::size_t v, std::size_t k) const {
    return mesh.at("origin").at(k).get<double>() +
           mesh.at("spacing").get<double>() * static_cast<double>(nodes[frame][v][k]);
  }

  Json mesh, summary;
  std::string picture;
  std::vector<int> ids;  ///< of triangles, then of free edges
  std::vector<std::vector<std::array<long long, 3>>> nodes;  ///< of each frame
  std::vector<Json> steps, contacts;
  std::vector<std::string> times;
  int num_keys{0};
};

/// The part of the program's files that only --report adds.
class CcdReport : public CcdSequence {
 protected:
  std::string outputOf(const std::string& arguments) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments << '\n' << outcome.err;
    return outcome.out;
  }

  Mesh painted(const std::string& name) const { return readMesh(path(name).string()); }

  /// @brief Whether a vertex of a painted mesh is not grey.
  bool isColoured(const std::string& name, std::size_t vertex) const {
    const std::string file = readText(path(name)), end = "end_header\n";
    constexpr std::size_t kVertexBytes = 27, kColourOffset = 24;
    const std::size_t at =
        file.find(end) + end.size() + vertex * kVertexBytes + kColourOffset;
    return file[at] != file[at + 1] || file[at] != file[at + 2];
  }
};

TEST_F(CcdReport, PageHasEveryFrameToHalfACell) {
  writeFrames(36);
  writeText(path("b.obj"), toObj(edgeAlongX()));
  outputOf("run f --against b.obj --report r.html");
  const Page page(readText(path("r.html")));
  const Mesh a = floorAndTip(0), b = edgeAlongX();
  const std::size_t num_a = a.vertices.size();
  EXPECT_EQ(page.mesh.at("vertices"), num_a + b.vertices.size());
  EXPECT_EQ(page.mesh.at("triangles_of_a"), a.triangles.size());
  EXPECT_EQ(page.ids, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  const double spacing = page.mesh.at("spacing");
  EXPECT_LT(spacing, 1e-3);
  EXPECT_EQ(spacing, std::exp2(std::round(std::log2(spacing))));
  EXPECT_EQ(page.num_keys, 2);
  ASSERT_EQ(page.nodes.size(), 36u);
  for (std::size_t frame = 0; frame < 36; ++frame) {
    Vertices expected = floorAndTip(dropOf(frame)).vertices;
    expected.insert(expected.end(), b.vertices.begin(), b.vertices.end());
    for (std::size_t v = 0; v < expected.size(); ++v)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(page.at(frame, v, k), expected[v][k], 0.5 * spacing);
  }
}

TEST_F(CcdReport, PageHasStepsAndContactsWithAllDigits) {
  writeFrames(12);
  const std::string out = outputOf(
      "run f --report r.html --contacts c.csv --columns triangles,position,normal --json "
      "r.json");
  const Page page(readText(path("r.html")));
  EXPECT_EQ(page.summary.at("complete"), true);
  const std::string sentence = page.summary.at("sentence");
  EXPECT_NE(sentence.find("first contact: step 1 at "), std::string::npos);
  EXPECT_NE(out.find(sentence), std::string::npos);
  const Json report = Json::parse(readText(path("r.json")));
  ASSERT_EQ(page.steps.size(), report.at("steps").size());
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : linesOf(readText(path("c.csv"))))
    rows.push_back(csvFields(line));
  std::size_t row = 1;
  for (std::size_t i = 0; i < page.steps.size(); ++i) {
    for (const char* field : {"step", "files", "contacts", "first", "ms"})
      EXPECT_EQ(page.steps[i].at(field), report.at("steps").at(i).at(field)) << field;
    EXPECT_GT(page.steps[i].at("memory_mb"), 1);
    const bool touches = !page.contacts[i].empty();
    EXPECT_EQ(
        page.times[i],
        touches
            ? std::string(
                  2,
                  static_cast<char>(
                      1 + std::floor(254 *
                                     page.contacts[i].at(0).at("toc_lo").get<double>())))
            : std::string(2, '\0'));
    for (const Json& contact : page.contacts[i]) {
      EXPECT_EQ(contact.at("kind"), rows[row][1]);
      EXPECT_EQ(contact.at("toc_lo").get<double>(), std::stod(rows[row][6]));
      EXPECT_EQ(contact.at("toc_hi").get<double>(), std::stod(rows[row][7]));
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(contact.at("position").at(k).get<double>(),
                  std::stod(rows[row][10 + k]));
      ++row;
    }
  }
  EXPECT_EQ(row, rows.size());
}

// A page that is opened from the disk has nothing else.
TEST_F(CcdReport, PageLoadsNothing) {
  if (kHasAddressSanitizer) GTEST_SKIP() << "Each picture takes long";
  writeTip();
  outputOf("run tip0.obj tip1.obj --report r.html");
  const std::string page = readText(path("r.html"));
  for (const char* part : {"<link", "src=\"", "@import", "fetch(", "XMLHttpRequest"})
    EXPECT_EQ(page.substr(0, page.find("three.js")).find(part), std::string::npos)
        << part;
  EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_EQ(page.substr(page.size() - 8), "</html>\n");
  EXPECT_EQ(outputOf("run tip0.obj tip1.obj --report -").rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_FALSE(fs::exists(path("-")));
}

TEST_F(CcdReport, FilesWithMarkupInTheirNamesStayText) {
  if (kHasAddressSanitizer) GTEST_SKIP() << "Each picture takes long";
  fs::create_directory(path("<script>"));
  writeText(path("<script>/a0.obj"), toObj(floorAndTip(0)));
  writeText(path("<script>/a1.obj"), toObj(floorAndTip(2)));
  outputOf("run '<script>' --report r.html");
  const Page page(readText(path("r.html")));
  EXPECT_EQ(page.steps.at(0).at("files").at(0), "<script>/a0.obj");
}

TEST_F(CcdReport, FolderHasWhatBelongsToThePage) {
  if (kHasAddressSanitizer) GTEST_SKIP() << "Each picture takes long";
  writeFrames(6);
  outputOf("run f --report out");
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(path("out")))
    names.insert(entry.path().filename().string());
  EXPECT_EQ(names,
            (std::set<std::string>{"contacts.csv", "first_contact.ply",
                                   "first_contact.png", "report.html", "run.json"}));
  EXPECT_EQ(linesOf(readText(path("out/contacts.csv")))[0],
            "step,kind,i0,i1,i2,i3,toc_lo,toc_hi,t0,t1,x,y,z,nx,ny,nz,i4");
  EXPECT_EQ(readText(path("out/first_contact.png")),
            Page(readText(path("out/report.html"))).picture);
  // Names that are given stay.
  outputOf("run f --report more --contacts c.csv --picture p.png --at-step 3");
  EXPECT_TRUE(fs::exists(path("c.csv")));
  EXPECT_FALSE(fs::exists(path("more/contacts.csv")));
  EXPECT_FALSE(fs::exists(path("more/first_contact.png")));
  // No folder is left of a run that was refused.
  expectFailure("run f --report new --contacts f/tip0.ply", "f/tip0.ply: cannot write");
  writeText(path("text.txt"), "");
  expectFailure("run f --report text.txt", "text.txt");
}

TEST_F(CcdReport, RunWithoutContactHasAPageAndPictures) {
  writeTip();
  outputOf("run tip0.obj tip0.obj --report out");
  const Page page(readText(path("out/report.html")));
  EXPECT_NE(page.summary.at("sentence").get<std::string>().find("no contact in 1 step"),
            std::string::npos);
  EXPECT_TRUE(page.contacts.at(0).empty());
  EXPECT_EQ(page.picture.substr(1, 3), "PNG");
  EXPECT_EQ(painted("out/first_contact.ply").vertices, floorAndTip(0).vertices);
}

// The tip meets the floor at 1/3 of step 1, and below it is where the frames tell.
TEST_F(CcdReport, PaintShowsTheFirstContact) {
  writeFrames(6);
  for (const char* jobs : {" --jobs 1", " --jobs 4"}) {
    outputOf(std::string("run f --toc-err 0 --paint p.ply") + jobs);
    const Vertices vertices = painted("p.ply").vertices;
    EXPECT_NEAR(vertices[3][2], 0, 1e-15);
    EXPECT_NEAR(vertices[4][2], 2, 1e-15);
    EXPECT_TRUE(isColoured("p.ply", 3));
    EXPECT_FALSE(isColoured("p.ply", 4));
  }
  // Before it there is nothing to colour.
  outputOf("run f --paint p.ply --at-step 1 --at-time 0.25");
  EXPECT_NEAR(painted("p.ply").vertices[3][2], 0.5 - 0.25 * 1.5, 1e-15);
  EXPECT_FALSE(isColoured("p.ply", 3));
  // Step 0 has no contact: its end.
  outputOf("run f --paint p.ply --at-step 0");
  EXPECT_EQ(painted("p.ply").vertices, floorAndTip(dropOf(1)).vertices);
}

TEST_F(CcdReport, ANumberInTheNameIsAFileAStep) {
  writeFrames(6);
  outputOf("run f --paint p_%03d.ply --at-time 1");
  for (std::size_t step = 0; step < 5; ++step)
    EXPECT_EQ(painted("p_00" + std::to_string(step) + ".ply").vertices,
              floorAndTip(dropOf(step + 1)).vertices);
  outputOf("run f --picture q%d.png --at-step 1,3 --jobs 3");
  std::set<std::string> pictures;
  for (const std::string& name : files())
    if (name[0] == 'q') pictures.insert(name);
  EXPECT_EQ(pictures, (std::set<std::string>{"q1.png", "q3.png"}));
  expectFailure("run f --paint p.ply --at-step 1,3",
                "of several steps needs a name with a number, such as contact_%04d.ply");
  expectFailure("run f --paint p.ply --at-step 5",
                "--at-step 5: the run has no such step. The first is 0, the last 4");
  expectFailure("run f --at-step 1", "needs --picture or --paint");
  expectFailure("run f --paint p.ply --at-time 1.5", "'1.5' is not a time from 0 to 1");
  expectFailure("run f --paint p_%4d.ply", "write the number as %d");
  expectFailure("run f --picture p.ply", "this option writes PNG");
}

// The file of step 1 would be the first frame. The folder that was made does not stay.
TEST_F(CcdReport, NoFrameIsOverwrittenByAFileAStep) {
  fs::create_directories(path("g"));
  for (const char* name : {"g/f1.ply", "g/f2.ply", "g/f3.ply"})
    writeText(path(name), toAsciiPly(floorAndTip(0)));
  expectFailure("run g --paint g/f%d.ply --report new/r",
                "g/f1.ply: cannot write: it is also given as g/f1.ply");
  EXPECT_FALSE(fs::exists(path("g/f0.ply")));
  EXPECT_FALSE(fs::exists(path("new")));
}

// Resuming goes back to the step that the picture shows.
TEST_F(CcdReport, PaintAfterResumeIsThatOfTheWholeRun) {
  writeFrames(12);
  outputOf("run f --paint whole.ply" + kOutputs);
  const auto whole = takeOutputs();
  for (const char* outputs :
       {" --contacts c.csv --columns triangles,position,normal", " --steps s.jsonl"}) {
    outputOf(std::string("run f --end 8") + outputs);
    outputOf(std::string("run f --resume --paint p.ply") + outputs);
    EXPECT_EQ(readText(path("p.ply")), readText(path("whole.ply")));
    const auto [contacts, steps] = takeOutputs();
    EXPECT_TRUE(contacts == whole.first || steps == whole.second) << outputs;
  }
}

// Of a file a step those that are there stay, and one that is missing is made.
TEST_F(CcdReport, ResumeKeepsTheFilesOfEarlierSteps) {
  writeFrames(12);
  outputOf("run f --paint whole_%d.ply" + kOutputs);
  const auto whole = takeOutputs();
  const std::string paint = " --paint p_%d.ply" + kOutputs;
  outputOf("run f --end 8" + paint);
  writeText(path("p_5.ply"), "kept");
  const std::string json = " --resume --json r.json";
  outputOf("run f" + json + paint);
  EXPECT_EQ(takeOutputs(), whole);
  EXPECT_EQ(Json::parse(readText(path("r.json"))).at("steps").at(0).at("step"), 8);
  EXPECT_EQ(readText(path("p_5.ply")), "kept");
  outputOf("run f --end 8" + kOutputs);
  fs::remove(path("p_5.ply"));
  outputOf("run f" + json + paint);
  EXPECT_EQ(Json::parse(readText(path("r.json"))).at("steps").at(0).at("step"), 5);
  for (std::size_t step = 0; step < 11; ++step) {
    const std::string name = std::to_string(step) + ".ply";
    EXPECT_EQ(readText(path("p_" + name)), readText(path("whole_" + name)));
  }
}

// Each file would be the next frame.
TEST_F(CcdReport, FollowRefusesOutputsAmongTheFrames) {
  writeFrames(3);
  const std::string cause = ": cannot write: --follow would take it for a frame";
  for (const char* run : {"f --paint f/p.ply", "f --paint ./f/../f/p.ply",
                          "'f/*.ply' --paint f/p.ply", "f/tip%d.ply --paint f/tip9.ply"})
    expectFailure(std::string("run --follow=0.1 ") + run, cause);
  expectFailure("run --follow=0.1 f --paint f/p%d.ply", "f/p0.ply" + cause);
  EXPECT_EQ(std::distance(fs::directory_iterator(path("f")), {}), 3);
  for (const char* run : {"f --paint p.ply", "f --picture f/p.png",
                          "f/tip%d.ply --paint f/p.ply", "'f/t*.ply' --json -"})
    outputOf(std::string("run --follow=0.1 ") + run);
}

TEST_F(CcdReport, PictureHasTheContactInItsMiddle) {
  writeTip();
  outputOf("run tip0.obj tip1.obj --picture p.png");
  const fcl_ccd::picture::Image image = fcl_ccd::picture::readPng(path("p.png").string());
  const fcl_ccd::picture::Colour red = fcl_ccd::picture::colourFromHex(0xe63946);
  EXPECT_LT((image.at(image.width / 2, image.height / 2) - red).norm(), 0.02f);
  // The floor is there, and the corner with the whole scene.
  int other = 0;
  for (const auto& colour : image.pixels)
    other += (colour - fcl_ccd::picture::RenderOptions().background).norm() > 0.05f;
  EXPECT_GT(other, image.width * image.height / 20);
}

}  // namespace

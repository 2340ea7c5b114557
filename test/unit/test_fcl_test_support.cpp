// SPDX-License-Identifier: BSD-3-Clause
//
// The scenes and pictures on which other tests, the demo and the benchmarks rely.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cloth_over_ball.h"
#include "fcl/common/exception.h"
#include "mesh_generators.h"
#include "pictures.h"

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;

void expectIndicesInRange(const TestMesh& mesh) {
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      ASSERT_LT(t[k], mesh.vertices.size());
      ASSERT_NE(t[k], t[(k + 1) % 3]);
    }
}

/// Every directed edge once, and its opposite too: closed and consistently wound.
void expectClosed(const TestMesh& mesh) {
  std::map<std::pair<std::size_t, std::size_t>, int> uses;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  for (const auto& use : uses) {
    EXPECT_EQ(use.second, 1);
    EXPECT_EQ(uses.count({use.first.second, use.first.first}), 1u);
  }
}

double volume(const TestMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6;
  return sum;
}

double area(const TestMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += (mesh.vertices[t[1]] - mesh.vertices[t[0]])
               .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
               .norm() /
           2;
  return sum;
}

TEST(FCL_TEST_SUPPORT, sheet_covers_its_square) {
  const TestMesh sheet = makeSheet(7, 4);
  EXPECT_EQ(sheet.vertices.size(), 40u);
  EXPECT_EQ(sheet.triangles.size(), 56u);
  expectIndicesInRange(sheet);
  EXPECT_NEAR(area(sheet), 1, 1e-12);
  for (const Triangle& t : sheet.triangles) {
    const Vec normal = (sheet.vertices[t[1]] - sheet.vertices[t[0]])
                           .cross(sheet.vertices[t[2]] - sheet.vertices[t[0]]);
    EXPECT_GT(normal[2], 0);
  }
}

TEST(FCL_TEST_SUPPORT, sheet_uses_the_position_given) {
  const TestMesh sheet =
      makeSheet(3, 3, [](double u, double v) { return Vec(2 * u, v, u * v); });
  EXPECT_EQ(sheet.vertices.back(), Vec(2, 1, 1));
}

TEST(FCL_TEST_SUPPORT, closed_meshes_are_closed_and_wound_outwards) {
  const double sphere_volume = 4 * std::acos(-1.0) / 3;
  const TestMesh uv = makeUvSphere(48, 32, 1);
  EXPECT_EQ(uv.triangles.size(), 2u * 48 * 31);
  EXPECT_NEAR(volume(uv), sphere_volume, 0.05);
  const TestMesh ico = makeIcosphere(4, 1);
  EXPECT_EQ(ico.triangles.size(), 5120u);
  EXPECT_NEAR(volume(ico), sphere_volume, 0.02);
  const TestMesh box = makeBox(Vec(1, 2, 3), 4);
  EXPECT_EQ(box.triangles.size(), 192u);
  EXPECT_NEAR(volume(box), 48, 1e-9);
  const TestMesh soup = makeTetrahedronSoup(20, 1, 0.3, 5);
  EXPECT_EQ(soup.triangles.size(), 80u);
  for (const TestMesh& mesh : {uv, ico, box, soup}) {
    expectIndicesInRange(mesh);
    expectClosed(mesh);
    EXPECT_GT(volume(mesh), 0);
  }
}

TEST(FCL_TEST_SUPPORT, soups_depend_on_the_seed_only) {
  const TestMesh a = makeTriangleSoup(50, 1, 0.2, 7);
  EXPECT_EQ(a.vertices, makeTriangleSoup(50, 1, 0.2, 7).vertices);
  EXPECT_NE(a.vertices, makeTriangleSoup(50, 1, 0.2, 8).vertices);
  expectIndicesInRange(a);
}

TEST(FCL_TEST_SUPPORT, random_numbers_stay_in_range_and_are_the_known_ones) {
  // The first outputs of splitmix64 for seed 1234567.
  Random known(1234567);
  EXPECT_EQ(known.next(), 6457827717110365317u);
  EXPECT_EQ(known.next(), 3203168211198807973u);
  Random random(1);
  double mean = 0;
  for (int i = 0; i < 10000; ++i) {
    const double x = random.uniform(-2, 6);
    ASSERT_GE(x, -2);
    ASSERT_LT(x, 6);
    ASSERT_LT(random.index(5), 5u);
    mean += x / 10000;
  }
  EXPECT_NEAR(mean, 2, 0.1);
}

TEST(FCL_TEST_SUPPORT, append_and_transform) {
  TestMesh mesh = makeSheet(1, 1);
  Transform3<double> up = Transform3<double>::Identity();
  up.translation() = Vec(0, 0, 2);
  append(mesh, transformed(makeSheet(1, 1), up));
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_GE(mesh.triangles[2][0], 4u);
  EXPECT_EQ(mesh.vertices[7][2], 2);
  EXPECT_EQ(uniqueEdges(mesh.triangles).size(), 10u);
}

TEST(FCL_TEST_SUPPORT, clothTouchesFoldsAndStaysWhole) {
  ClothOverBall scene(32);
  const std::vector<Vec> rest = scene.mesh().vertices;
  bool was_free = false, has_touched = false;
  std::size_t self = 0;
  for (int i = 1; i <= 24; ++i) {
    const DemoFrame frame = scene.advanceFrame();
    EXPECT_FALSE(frame.crossing) << "frame " << i;
    EXPECT_EQ(frame.unresolved, 0u) << "frame " << i;
    EXPECT_EQ(frame.vertex_face + frame.edge_edge, frame.contacts.size());
    EXPECT_EQ(frame.first_contact < 1, !frame.contacts.empty());
    was_free |= frame.contacts.empty();
    has_touched |= !frame.contacts.empty();
    self += frame.self;
  }
  EXPECT_FALSE(scene.hasCrossing());
  EXPECT_TRUE(was_free && has_touched);
  EXPECT_GT(self, 0u);
  const TestMesh& mesh = scene.mesh();
  // Position based dynamics stretches while an impact spreads. An unstable cloth goes far
  // beyond that.
  for (const auto& e : uniqueEdges(mesh.triangles)) {
    const auto v = static_cast<std::size_t>(e[0]), w = static_cast<std::size_t>(e[1]);
    EXPECT_LT((mesh.vertices[v] - mesh.vertices[w]).norm(),
              2 * (rest[v] - rest[w]).norm());
  }
  // The cloth lies on ground and ball: above the ground, not above the ball's top.
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (scene.bodyOf(v) == ClothOverBall::kCloth) {
      EXPECT_GT(mesh.vertices[v][2], 0);
      EXPECT_LT(mesh.vertices[v][2], .6);
    }
}

TEST(FCL_TEST_SUPPORT, clothGoesOnFromAnyFrame) {
  ClothOverBall scene(16);
  std::vector<std::string> states{scene.state()};
  std::size_t contacts = 0;
  for (int frame = 0; frame < 12; ++frame) {
    contacts += scene.advanceFrame().contacts.size();
    states.push_back(scene.state());
  }
  EXPECT_GT(contacts, 0u);
  for (const std::size_t first : {0, 6, 9}) {
    ClothOverBall other(16);
    other.setState(states[first]);
    for (std::size_t frame = first + 1; frame < states.size(); ++frame) {
      other.advanceFrame();
      ASSERT_EQ(other.state(), states[frame]) << "from " << first << " to " << frame;
    }
  }
  EXPECT_THROW(ClothOverBall(17).setState(states[0]), std::runtime_error);
  EXPECT_THROW(scene.setState(""), std::runtime_error);
}

PaintedMesh paintedSphere() {
  PaintedMesh scene;
  scene.mesh = toSurface(makeIcosphere(3, 0.5));
  scene.paints.assign(scene.mesh.triangles.size(),
                      {colourFromHex(0x2a9d8f), colourFromHex(0xe9c46a), false});
  return scene;
}

int countOther(const Image& image, const Colour& background) {
  int count = 0;
  for (const Colour& c : image.pixels)
    count += (c - background).cwiseAbs().maxCoeff() > 0.02f;
  return count;
}

TEST(FCL_TEST_SUPPORT, renderer_draws_what_the_camera_sees) {
  Camera camera;
  camera.eye = Vec(0, -4, 0);
  RenderOptions options;
  options.width = 160;
  options.height = 120;
  options.sky_lights = 4;
  const Image image = render(paintedSphere(), {}, camera, options);
  // The sphere's outline has the angular radius asin(0.5 / 4).
  const double radius = 60 * std::tan(std::asin(0.125)) / std::tan(0.3);
  EXPECT_NEAR(countOther(image, options.background), std::acos(-1.0) * radius * radius,
              0.05 * std::acos(-1.0) * radius * radius);
  // Lit from above, green outside.
  const Colour& top = image.at(80, 60 - static_cast<int>(0.7 * radius));
  const Colour& bottom = image.at(80, 60 + static_cast<int>(0.7 * radius));
  EXPECT_GT(top[1], bottom[1]);
  EXPECT_GT(top[1], top[0]);
}

TEST(FCL_TEST_SUPPORT, markers_are_hidden_behind_surfaces) {
  Camera camera;
  camera.eye = Vec(0, -4, 0);
  RenderOptions options;
  options.width = 80;
  options.height = 60;
  options.sky_lights = 1;
  const Colour red(1, 0, 0);
  const auto reds = [&](const Vec& position) {
    const Image image = render(paintedSphere(), {{position, red}}, camera, options);
    int count = 0;
    for (const Colour& c : image.pixels) count += c[0] > 0.9f && c[1] < 0.1f;
    return count;
  };
  EXPECT_GT(reds(Vec(0, -0.5, 0)), 0);
  EXPECT_EQ(reds(Vec(0, 0.5, 0)), 0);
  EXPECT_GT(reds(Vec(0.8, 0.5, 0)), 0);
}

TEST(FCL_TEST_SUPPORT, png_comes_back_as_it_was) {
  Image image(37, 23, colourFromHex(0xf4f5f7));
  image.at(3, 5) = colourFromHex(0xe63946);
  drawText(image, "0 A", 10, 8, 1, colourFromHex(0x1d3557));
  const std::string path =
      testing::TempDir() + "fcl_ccd_test_support_" + std::to_string(image.width) + ".png";
  std::ofstream(path, std::ios::binary) << encodePng(image);
  const Image back = readPng(path);
  std::remove(path.c_str());
  ASSERT_EQ(back.width, image.width);
  ASSERT_EQ(back.height, image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    ASSERT_LT((back.pixels[i] - image.pixels[i]).cwiseAbs().maxCoeff(), 0.01f);
  EXPECT_GT(countOther(back, colourFromHex(0xf4f5f7)), 20);
}

TEST(FCL_TEST_SUPPORT, png_errors_name_the_file) {
  try {
    readPng("/nowhere/picture.png");
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/picture.png"), std::string::npos);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The scenes and pictures on which other tests, the demo and the benchmarks rely.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>

#include "cloth_simulator.h"
#include "fcl/common/exception.h"
#include "mesh_generators.h"
#include "pictures.h"
#include "proximity.h"
#include "scenes.h"

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

TEST(FCL_TEST_SUPPORT, near_pairs_are_those_of_all_pairs) {
  const TestMesh mesh = makeTriangleSoup(120, 0.5, 0.3, 3);
  std::vector<char> is_movable(mesh.vertices.size(), 1);
  for (std::size_t v = 0; v < 180; ++v) is_movable[v] = 0;
  const double distance = 0.04;
  std::vector<std::pair<int, int>> expected;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Triangle& t = mesh.triangles[f];
      if (v == t[0] || v == t[1] || v == t[2]) continue;
      if (!is_movable[v] && !is_movable[t[0]]) continue;
      const Vec w = closestWeights(mesh.vertices[v], mesh.vertices[t[0]],
                                   mesh.vertices[t[1]], mesh.vertices[t[2]]);
      const Vec closest = w[0] * mesh.vertices[t[0]] + w[1] * mesh.vertices[t[1]] +
                          w[2] * mesh.vertices[t[2]];
      if ((closest - mesh.vertices[v]).norm() < distance)
        expected.emplace_back(static_cast<int>(v), static_cast<int>(f));
    }
  ASSERT_GT(expected.size(), 20u);
  for (const double cell_size : {0.02, 0.1, 2.0}) {
    std::vector<std::pair<int, int>> found;
    for (const NearPair& pair :
         findNearPairs(mesh.vertices, mesh.triangles, is_movable, distance, cell_size))
      found.emplace_back(pair.vertex, pair.triangle);
    EXPECT_EQ(found, expected) << "cell size " << cell_size;
  }
}

TEST(FCL_TEST_SUPPORT, closest_point_is_not_farther_than_any_sample) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Vec a = random.point(1), b = random.point(1), c = random.point(1);
    const Vec p = random.point(2);
    const Vec w = closestWeights(p, a, b, c);
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_NEAR(w.sum(), 1, 1e-12);
    const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    for (int s = 0; s < 50; ++s) {
      const double x = random.uniform(0, 1);
      const double y = random.uniform(0, 1 - x);
      EXPECT_LE(distance, ((1 - x - y) * a + x * b + y * c - p).norm() + 1e-12);
    }
  }
}

TEST(FCL_TEST_SUPPORT, simulation_is_deterministic) {
  ClothSimulator first = makeClothOverBall(16);
  ClothSimulator second = makeClothOverBall(16);
  ClothSimulator other_seed = makeClothOverBall(16, 2);
  std::size_t contacts = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const FrameReport a = first.advanceFrame();
    const FrameReport b = second.advanceFrame();
    contacts += a.contacts.size();
    other_seed.advanceFrame();
    ASSERT_EQ(first.mesh().vertices, second.mesh().vertices) << "frame " << frame;
    ASSERT_EQ(a.contacts.size(), b.contacts.size()) << "frame " << frame;
    ASSERT_EQ(a.first_contact, b.first_contact) << "frame " << frame;
  }
  EXPECT_GT(contacts, 0u);
  EXPECT_NE(first.mesh().vertices, other_seed.mesh().vertices);
}

TEST(FCL_TEST_SUPPORT, cloth_touches_folds_and_stays_whole) {
  ClothSimulator simulator = makeClothOverBall(32);
  bool was_free = false;
  bool has_touched = false;
  std::size_t self = 0;
  for (int frame = 1; frame <= 24; ++frame) {
    const FrameReport report = simulator.advanceFrame();
    EXPECT_FALSE(report.crossing) << "frame " << frame;
    EXPECT_EQ(report.unresolved, 0u) << "frame " << frame;
    EXPECT_EQ(report.vertex_face + report.edge_edge, report.contacts.size());
    EXPECT_LE(report.first_contact, 1);
    EXPECT_EQ(report.first_contact < 1, !report.contacts.empty());
    was_free = was_free || report.contacts.empty();
    has_touched = has_touched || !report.contacts.empty();
    self += report.self;
    for (const Vec& v : simulator.mesh().vertices) ASSERT_TRUE(v.allFinite());
    // PBD stretches while an impact spreads. An unstable cloth goes far beyond that.
    EXPECT_LT(simulator.maxStretch(), 2) << "frame " << frame;
  }
  EXPECT_TRUE(was_free);
  EXPECT_TRUE(has_touched);
  EXPECT_GT(self, 0u);
  // The cloth lies on ground and ball: above the ground, not above the ball's top.
  for (std::size_t v = 0; v < simulator.mesh().vertices.size(); ++v)
    if (simulator.bodyOf(v) == kCloth) {
      EXPECT_GT(simulator.mesh().vertices[v][2], 0);
      EXPECT_LT(simulator.mesh().vertices[v][2], 0.6);
    }
}

TEST(FCL_TEST_SUPPORT, bodies_cannot_be_added_to_a_running_scene) {
  ClothSimulator simulator = makeClothOverBall(4);
  simulator.advanceFrame();
  EXPECT_THROW(simulator.addObstacle(makeBox(Vec(1, 1, 1))), Exception);
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

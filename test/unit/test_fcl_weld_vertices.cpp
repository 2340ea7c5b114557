// SPDX-License-Identifier: BSD-3-Clause
//
// Triangle soup: the result of a self-collision tells it, and weldVertices() gives the
// map that joins its vertices.
#include "fcl/geometry/bvh/weld_vertices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/AABB.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Map = std::vector<int>;
using Frame = std::vector<double>;

Map weld(const std::vector<Frame>& frames, double eps = 0) {
  std::vector<const double*> pointers;
  for (const Frame& frame : frames) pointers.push_back(frame.data());
  return weldVertices(pointers, frames[0].size() / 3, eps);
}

/// Vertices on the x axis.
Frame along(const std::vector<double>& xs) {
  Frame frame;
  for (const double x : xs) frame.insert(frame.end(), {x, 0, 0});
  return frame;
}

TEST(FCL_WELD_VERTICES, joinsWhatCoincidesInAllFrames) {
  const Frame first = along({1, 0, 1, -0.0, 1}), second = along({1, 5, 2, 5, 2});
  EXPECT_EQ(weld({first}), (Map{0, 1, 0, 1, 0}));
  EXPECT_EQ(weld({first, second}), (Map{0, 1, 2, 1, 2}));
  EXPECT_EQ(weld({second, first}), (Map{0, 1, 2, 1, 2}));
  EXPECT_EQ(weld({first, second, first}), (Map{0, 1, 2, 1, 2}));
  const std::vector<float> floats{1, 0, 0, 0, 0, 0, 1, 0, 0};
  EXPECT_EQ(weldVertices<float>({floats.data()}, 3), (Map{0, 1, 0}));
}

// A mesh that has no size in its first frame.
TEST(FCL_WELD_VERTICES, separatesAPointIntoMany) {
  constexpr std::size_t kCount = 20000;
  std::vector<double> xs(kCount), twice(kCount);
  for (std::size_t i = 0; i < kCount; ++i) twice[i] = static_cast<double>(i / 2);
  const Map map = weld({along(xs), along(twice)});
  for (std::size_t i = 0; i < kCount; ++i)
    ASSERT_EQ(map[i], static_cast<int>(i - i % 2)) << i;
}

TEST(FCL_WELD_VERTICES, joinsToOneThatIsNear) {
  // In a chain of steps of 0.75 the third is not near the first.
  EXPECT_EQ(weld({along({0, 0.75, 1.5})}, 1), (Map{0, 0, 2}));
  EXPECT_EQ(weld({{1.5, 0, 0, 1.5, 1, -1, 1.5, 1.25, 0}}, 1), (Map{0, 0, 2}));
  // The grid must not change the answer: neighbouring cells, far from the origin and near
  // it, and cells without a number.
  for (const double at : {-1e9, -1.0, 0.0, 1.0, 1e9}) {
    const std::vector<Frame> pair{{at, at, at, at + 0.5, at - 0.5, at}};
    EXPECT_EQ(weld(pair, 0.5), (Map{0, 0})) << at;
    EXPECT_EQ(weld(pair, 0.25), (Map{0, 1})) << at;
  }
  EXPECT_EQ(weld({along({1e300, 1e300, -1e300})}, 1e-300), (Map{0, 0, 2}));
}

// Vertices 1 and 2 leave vertex 0 together, but were not near each other before.
TEST(FCL_WELD_VERTICES, looksAgainAtFramesBefore) {
  const Frame first = along({0, -0.75, 0.75, -0.75}), second = along({0, 5, 5, 5});
  EXPECT_EQ(weld({first, second}, 1), (Map{0, 1, 2, 1}));
  EXPECT_EQ(weld({second, first}, 1), (Map{0, 1, 2, 1}));
}

// With a distance: what is joined coincides in every frame.
TEST(FCL_WELD_VERTICES, keepsItsPromisesOnRandomFrames) {
  Random random(7);
  constexpr std::size_t kCount = 200;
  for (const double eps : {0.0, 0.1, 0.4}) {
    std::vector<Frame> frames(4);
    for (Frame& frame : frames)
      for (std::size_t i = 0; i < kCount; ++i) {
        // Several vertices near each place. They part here and there.
        const Vector3<double> jump = random.point(random.index(40) == 0 ? 1 : 0),
                              p = random.point(0.6 * eps) + jump;
        frame.insert(frame.end(), {p[0] + 0.5 * static_cast<double>(i % 50), p[1], p[2]});
      }
    const Map map = weld(frames, eps);
    std::size_t num_joined = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto head = static_cast<std::size_t>(map[i]);
      ASSERT_LE(head, i);
      ASSERT_EQ(map[head], map[i]);
      if (head != i) ++num_joined;
      for (const Frame& frame : frames)
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_LE(std::abs(frame[3 * i + k] - frame[3 * head + k]), eps);
    }
    EXPECT_GT(num_joined, 0u) << eps;
  }
}

TEST(FCL_WELD_VERTICES, refusesBadInput) {
  const auto expectRefused = [](const std::vector<const double*>& frames, double eps,
                                const std::string& cause) {
    try {
      weldVertices(frames, 2, eps);
      ADD_FAILURE() << cause;
    } catch (const Exception& error) {
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
  };
  const Frame good = along({0, 1}), bad = along({0, HUGE_VAL});
  expectRefused({}, 0, "there is no frame");
  expectRefused({good.data(), nullptr}, 0, "frame 1 is null");
  expectRefused({good.data(), bad.data()}, 0, "frame 1: vertex 1 is not finite");
  for (const double eps : {-1.0, HUGE_VAL, std::numeric_limits<double>::quiet_NaN()})
    expectRefused({good.data()}, eps, "eps is ");
}

// ---- Self-collision

TestMesh toSoup(const TestMesh& mesh) {
  TestMesh soup;
  for (const Triangle& triangle : mesh.triangles) {
    const std::size_t begin = soup.vertices.size();
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(mesh.vertices[triangle[k]]);
    soup.triangles.emplace_back(begin, begin + 1, begin + 2);
  }
  return soup;
}

/// As a program does it: the triangles get the ids of the map.
template <typename S>
TestMesh welded(TestMesh soup, const TestMesh& later) {
  const std::vector<Vector3<S>> first = pointsAs<S>(soup.vertices),
                                second = pointsAs<S>(later.vertices);
  const Map map = weldVertices<S>({first[0].data(), second[0].data()}, first.size());
  for (Triangle& triangle : soup.triangles)
    triangle.set(static_cast<std::size_t>(map[triangle[0]]),
                 static_cast<std::size_t>(map[triangle[1]]),
                 static_cast<std::size_t>(map[triangle[2]]));
  return soup;
}

template <typename S>
void expectSoupIsTold() {
  const TestMesh flat = bentSheet(6), bent = moved(bentSheet(6, 0.5), 0.125, 0, 0);
  const TestMesh soup = toSoup(flat), later = toSoup(bent);
  using Model = DeformableBVHModel<AABB<S>>;
  const auto cloth = makeModel<Model>(flat, bent), parts = makeModel<Model>(soup, later);
  const auto joined = makeModel<Model>(welded<S>(soup, later));
  EXPECT_EQ(update(*joined, later), BVH_OK);

  const auto right = selfContacts<S>(*cloth), wrong = selfContacts<S>(*parts),
             mended = selfContacts<S>(*joined);
  EXPECT_FALSE(right.is_triangle_soup);
  EXPECT_TRUE(right.contacts.empty());
  EXPECT_TRUE(wrong.is_triangle_soup);
  EXPECT_GT(wrong.contacts.size(), 100u);
  EXPECT_FALSE(mended.is_triangle_soup);
  EXPECT_TRUE(mended.contacts.empty());

  // Every kind of model, and a result that is used again.
  ContinuousContactResult<S> result;
  const ContinuousContactRequest<S> request;
  const auto rigid = makeModel<BVHModel<OBBRSS<S>>>(soup);
  continuousSelfCollide(rigid.get(), request, result);
  EXPECT_TRUE(result.is_triangle_soup);
  const auto plain = makeModel<BVHModel<OBBRSS<S>>>(soup, later);
  continuousSelfCollide(plain.get(), request, result);
  EXPECT_TRUE(result.is_triangle_soup);
  const Transform3<S> still = Transform3<S>::Identity();
  continuousCollide(parts.get(), still, still, plain.get(), still, still, request,
                    result);
  EXPECT_FALSE(result.is_triangle_soup);
  TestMesh one = soup;
  one.triangles.resize(1);
  EXPECT_FALSE(selfContacts<S>(*makeModel<Model>(one)).is_triangle_soup);
}

TEST(FCL_TRIANGLE_SOUP, isToldAndWeldedInDouble) { expectSoupIsTold<double>(); }
TEST(FCL_TRIANGLE_SOUP, isToldAndWeldedInFloat) { expectSoupIsTold<float>(); }

}  // namespace
}  // namespace test
}  // namespace fcl

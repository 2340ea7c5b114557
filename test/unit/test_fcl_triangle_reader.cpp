// SPDX-License-Identifier: BSD-3-Clause
//
// Triangles that are posed when they are read stay valid as long as they have to, and are
// found again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <deque>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "model/fcl_tree.h"
#include "moving_mesh.h"
#include "query/triangle_reader.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

struct ReadTriangle {
  int number;
  const TreeTriangle* triangle;
  std::array<const TreeVertex*, 3> x;
};

ReadTriangle readFrom(TriangleReader& reader, int number) {
  ReadTriangle out{number, nullptr, {}};
  const TreeVertex* x[3];
  out.triangle = reader.read(number, x);
  std::copy(x, x + 3, out.x.begin());
  return out;
}

void expectPosed(const MeshInstance& mesh, const ReadTriangle& read) {
  const auto& stored = mesh.tree->triangles()[static_cast<std::size_t>(read.number)];
  ASSERT_EQ(read.triangle->index, stored.index);
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_EQ(read.triangle->id[k], stored.id[k]);
    const VertexPath path = mesh.frames[stored.id[k]];
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(read.x[k]->t0[i], path.t0[i]);
      ASSERT_EQ(read.x[k]->t1[i], path.t1[i]);
    }
  }
}

TEST(FCL_TRIANGLE_READER, trianglesStayAndAreFoundAgain) {
  Random random(5);
  const MovingMesh mesh = randomSoup(random, 3000, 1500, 1, 0.1);
  Pose begin, end;
  begin.translation[0] = 0.5;
  end.translation[1] = 0.25;
  const PreparedMovingMesh prepared(mesh, begin, end);
  TriangleReader reader(prepared.instance());
  std::deque<ReadTriangle> valid;
  int num_found = 0;
  for (int round = 0; round < 100000; ++round) {
    // Now and then far away, else one of those that were read before.
    const bool is_new = valid.empty() || random.index(3) == 0;
    const int number = is_new ? static_cast<int>(random.index(3000))
                              : valid[random.index(valid.size())].number;
    valid.push_back(readFrom(reader, number));
    if (valid.size() > TriangleReader::kStored) valid.pop_front();
    expectPosed(prepared.instance(), valid.front());
    expectPosed(prepared.instance(), valid[random.index(valid.size())]);
    if (HasFatalFailure()) return;
    for (std::size_t i = 0; i + 1 < valid.size(); ++i)
      if (valid[i].triangle == valid.back().triangle) {
        ++num_found;
        break;
      }
  }
  EXPECT_GT(num_found, 30000);
}

// A vertex that was posed for another triangle is copied. Its numbers are the same.
TEST(FCL_TRIANGLE_READER, trianglesShareTheirVertices) {
  const TestMesh sphere = makeIcosphere(4, 1);
  const auto model = makeModel<BVHModel<OBBRSS<double>>>(sphere);
  Pose begin, end;
  begin.translation[0] = 0.5;
  end.translation[1] = 0.25;
  const Bend bend{{0.1, 0, 0, 0, 0.1, 0, 0, 0, 0}, {0, 0.2, 0}};
  for (const Bend* of : {static_cast<const Bend*>(nullptr), &bend}) {
    MeshInstance mesh;
    mesh.frames = VertexFrames(sphere.vertices[0].data(), sphere.vertices[0].data(),
                               sphere.vertices.size());
    mesh.frames.setPoses(begin, end);
    mesh.rigid = RigidTree(fclTree(*model), begin).turned(begin, end);
    mesh.triangles = model->tri_indices;
    mesh.bend = of;
    for (int k = 0; k < 3; ++k) {
      mesh.translation[0][k] = begin.translation[k];
      mesh.translation[1][k] = end.translation[k];
    }
    Random random(6);
    TriangleReader reader(mesh);
    for (int round = 0; round < rounds(20000); ++round) {
      // Most are near the last ones.
      const int number =
          round % 50 == 0 ? static_cast<int>(random.index(5120))
                          : (round / 50 * 37 + static_cast<int>(random.index(60))) % 5120;
      const ReadTriangle found = readFrom(reader, number);
      TriangleReader alone(mesh);
      const ReadTriangle expected = readFrom(alone, number);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(found.triangle->id[k], expected.triangle->id[k]);
        ASSERT_EQ(std::memcmp(found.x[k], expected.x[k], sizeof(TreeVertex)), 0)
            << round << ", " << k;
      }
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

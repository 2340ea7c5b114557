// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_MOVING_MESH_H
#define FCL_TEST_SUPPORT_MOVING_MESH_H

#include <cstddef>
#include <vector>

#include "mesh_generators.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace test {

/// @brief Triangles whose vertices move from one position to another, without a tree.
struct MovingMesh {
  std::vector<Vector3<double>> t0, t1;
  std::vector<Triangle> triangles;

  const double* previous() const { return t0[0].data(); }
  const double* current() const { return t1[0].data(); }
  /// Corner k of triangle i.
  std::size_t id(std::size_t i, int k) const { return triangles[i][k]; }
};

/// @brief A mesh at rest.
inline MovingMesh still(const TestMesh& mesh) {
  return {mesh.vertices, mesh.vertices, mesh.triangles};
}

/// @brief Adds a mesh with vertices of its own.
inline void append(MovingMesh& mesh, const MovingMesh& other) {
  const std::size_t first = mesh.t0.size();
  mesh.t0.insert(mesh.t0.end(), other.t0.begin(), other.t0.end());
  mesh.t1.insert(mesh.t1.end(), other.t1.begin(), other.t1.end());
  for (const Triangle& t : other.triangles)
    mesh.triangles.emplace_back(first + t[0], first + t[1], first + t[2]);
}

/// @brief The data of a mesh that a query needs, made by the functions of the stages. The
/// mesh must stay at its address.
class PreparedMovingMesh {
 public:
  explicit PreparedMovingMesh(
      const MovingMesh& mesh,
      const detail::deformable::Pose& beginning = detail::deformable::Pose(),
      const detail::deformable::Pose& end = detail::deformable::Pose())
      : features_(detail::deformable::assignFeatures(
            mesh.triangles.data(), mesh.triangles.size(), mesh.t0.size())) {
    const detail::deformable::VertexFrames own(mesh.previous(), mesh.current(),
                                               mesh.t0.size());
    tree_.build(mesh.triangles.data(), mesh.triangles.size(), own);
    tree_.refit(own);
    instance_.frames = own;
    instance_.frames.setPoses(beginning, end);
    instance_.tree = &tree_;
    for (int k = 0; k < 3; ++k) {
      instance_.translation[0][k] = beginning.translation[k];
      instance_.translation[1][k] = end.translation[k];
    }
  }
  PreparedMovingMesh(const PreparedMovingMesh&) = delete;
  PreparedMovingMesh& operator=(const PreparedMovingMesh&) = delete;

  const detail::deformable::MeshInstance& instance() const { return instance_; }
  const detail::deformable::MovingKdopTree& tree() const { return tree_; }
  const std::vector<detail::deformable::MeshTriangle>& features() const {
    return features_;
  }

 private:
  std::vector<detail::deformable::MeshTriangle> features_;
  detail::deformable::MovingKdopTree tree_;
  detail::deformable::MeshInstance instance_;
};

/// @brief `count` triangles between `vertices` random points in [-half, half]^3. Each
/// point moves by up to `step` along an axis. Many triangles share vertices, and some
/// have repeated ones.
inline MovingMesh randomSoup(Random& random, std::size_t count, std::size_t vertices,
                             double half, double step) {
  MovingMesh mesh;
  for (std::size_t i = 0; i < vertices; ++i) {
    mesh.t0.push_back(random.point(half));
    mesh.t1.push_back(mesh.t0.back() + random.point(step));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t a = random.index(vertices);
    mesh.triangles.emplace_back(a, random.index(vertices), random.index(vertices));
  }
  return mesh;
}

/// @brief A sheet whose vertices start near z = 0 and are moved at random.
inline MovingMesh crumpledSheet(Random& random, int n, double step) {
  const TestMesh sheet = makeSheet(n, n);
  MovingMesh mesh;
  mesh.triangles = sheet.triangles;
  for (const auto& p : sheet.vertices) {
    mesh.t0.push_back(p + random.point(0.3 / n));
    mesh.t1.push_back(mesh.t0.back() + random.point(step));
  }
  return mesh;
}

}  // namespace test
}  // namespace fcl

#endif

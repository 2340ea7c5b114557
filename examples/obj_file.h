// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of the examples in an OBJ file, which draw_meshes.py draws. Coordinates have six
// digits after the point: they are for a picture.
#ifndef OBJ_FILE_H
#define OBJ_FILE_H

#include <cstddef>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

class ObjFile {
 public:
  template <typename Vertices, typename Triangles>
  void addMesh(const Vertices& vertices, const Triangles& triangles,
               const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    for (const Eigen::Vector3d& vertex : vertices) {
      const Eigen::Vector3d p = pose * vertex;
      vertices_ += "v " + std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' +
                   std::to_string(p.z()) + '\n';
    }
    for (const auto& t : triangles)
      triangles_ += "f " + std::to_string(first_ + t[0]) + ' ' +
                    std::to_string(first_ + t[1]) + ' ' + std::to_string(first_ + t[2]) +
                    '\n';
    first_ += std::size(vertices);
  }

  /// A plate of no thickness across z.
  void addPlate(double x, double y, const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d corners[] = {
        {-x / 2, -y / 2, 0}, {x / 2, -y / 2, 0}, {x / 2, y / 2, 0}, {-x / 2, y / 2, 0}};
    const std::size_t triangles[][3] = {{0, 1, 2}, {0, 2, 3}};
    addMesh(corners, triangles, pose);
  }

  /// @throws std::runtime_error  the file cannot be written
  void write(const std::string& path) const {
    std::ofstream file(path);
    file << vertices_ << triangles_;
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
  }

 private:
  std::string vertices_, triangles_;
  std::size_t first_{1};
};

#endif

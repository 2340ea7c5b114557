// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_SEQUENCE_H
#define FCL_CCD_MESH_SEQUENCE_H

#include <cstddef>
#include <string>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief The frames of one mesh: files with the same faces and different positions of
/// the vertices. Only the first frame is kept in memory.
///
/// Faces are divided into triangles by their shape in the first frame, and in the same
/// way in all others. All functions throw std::runtime_error that names the file and the
/// cause. Several threads may call const functions at the same time.
class MeshSequence {
 public:
  /// @brief Reads the first frame.
  /// @param paths  at least one.
  explicit MeshSequence(std::vector<std::string> paths);

  std::size_t size() const { return paths_.size(); }
  const std::string& path(std::size_t frame) const { return paths_[frame]; }
  const Triangles& triangles() const { return triangles_; }
  const Vertices& firstVertices() const { return vertices_; }

  /// @brief The vertices of a frame. It must fit the first one.
  Vertices read(std::size_t frame) const;

  /// @brief Throws if the frame does not fit the first one. If a binary PLY has the
  /// layout of the first frame, its vertices are not read, only the rest.
  void check(std::size_t frame) const;

  /// @brief Tells the operating system that the frame will be read soon.
  void announce(std::size_t frame) const;

  /// @brief Joins vertices: after this call the triangles have other ids.
  void join(const std::vector<int>& map);

 private:
  std::vector<std::string> paths_;
  Faces faces_;
  Triangles triangles_;
  Vertices vertices_;
  /// For a binary PLY that begins with its vertices: the bytes before and behind them.
  std::string head_, tail_;
  std::size_t tail_begin_{0};
};

}  // namespace fcl_ccd

#endif

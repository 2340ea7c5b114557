// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_SEQUENCE_H
#define FCL_CCD_MESH_SEQUENCE_H

#include <cstddef>
#include <string>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief The frames of one mesh: files whose faces are the same, and that differ in the
/// positions of the vertices. Only the first frame is held.
///
/// Faces are divided into triangles as they are in the first frame, and the same way in
/// all others. All functions throw std::runtime_error that names the file and the cause;
/// those that are const may be called by several threads at once.
class MeshSequence {
 public:
  /// @brief Reads the first frame.
  /// @param paths  at least one.
  explicit MeshSequence(std::vector<std::string> paths);

  std::size_t size() const { return paths_.size(); }
  const std::string& path(std::size_t frame) const { return paths_[frame]; }
  const Triangles& triangles() const { return triangles_; }
  const Vertices& firstVertices() const { return vertices_; }

  /// @brief The vertices of a frame, which fits the first one.
  Vertices read(std::size_t frame) const;

  /// @brief Throws unless the frame fits the first one. Of a binary PLY that is laid out
  /// as the first frame the vertices are not looked at, all else is read.
  void check(std::size_t frame) const;

  /// @brief Tells the system that the frame is read soon.
  void announce(std::size_t frame) const;

  /// @brief Joins vertices: from here on the triangles have other ids.
  void join(const std::vector<int>& map);

 private:
  std::vector<std::string> paths_;
  Faces faces_;
  Triangles triangles_;
  Vertices vertices_;
  /// Of a binary PLY that begins with its vertices: the bytes before and behind them.
  std::string head_, tail_;
  std::size_t tail_begin_{0};
};

}  // namespace fcl_ccd

#endif

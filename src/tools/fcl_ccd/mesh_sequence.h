// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_SEQUENCE_H
#define FCL_CCD_MESH_SEQUENCE_H

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief The frames of one mesh: files with the same faces and different positions of
/// the vertices. The first frame is kept in memory. Frames in text and STL that check()
/// has read are kept, up to 64 MB, until read() takes them.
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
  const FreeElements& free() const { return joined_free_; }
  const Vertices& firstVertices() const { return vertices_; }

  /// @brief The vertices of a frame. It must fit the first one. The first frame is not
  /// read again, and no frame that check() has kept.
  Vertices read(std::size_t frame) const;

  /// @brief Throws if the frame does not fit the first one. If a binary PLY has the
  /// layout of the first frame, its vertices are not read, only the rest. A frame of any
  /// other kind is read, and kept for read().
  void check(std::size_t frame) const;

  /// @brief Whether a frame may be the beginning of one that fits, or fits: a regular
  /// file that another program may still be writing. Reads the frame.
  bool mayBeginAFrame(std::size_t frame) const;

  /// @brief Whether a frame that fits may end in a number that is cut: it is a text that
  /// ends in the line of a vertex, without the end of line that the first frame has.
  bool mayEndInACutNumber(std::size_t frame) const;

  /// @brief Adds frames that came later. They are not checked.
  void add(const std::vector<std::string>& paths) {
    paths_.insert(paths_.end(), paths.begin(), paths.end());
  }

  /// @brief Keeps the first frames only, at least one.
  void shorten(std::size_t size);

  /// @brief Tells the operating system that the frame will be read soon.
  void announce(std::size_t frame) const;

  /// @brief Joins vertices: after this call the triangles have other ids.
  void join(const std::vector<int>& map);

 private:
  /// Frames that are read and wait to be used.
  struct Kept {
    std::mutex mutex;
    std::map<std::size_t, Vertices> frames;
    std::size_t bytes{0};
  };

  bool hasFastLayout(const std::string& path) const;
  Vertices readWhole(const std::string& path) const;
  std::optional<Vertices> takeKept(std::size_t frame) const;

  std::vector<std::string> paths_;
  Faces faces_;
  FreeElements free_;         ///< as in the files
  FreeElements joined_free_;  ///< as join() has left them
  Triangles triangles_;
  Vertices vertices_;
  /// For a binary PLY that begins with its vertices: the bytes before and behind them.
  std::string head_, tail_;
  std::size_t tail_begin_{0};
  std::unique_ptr<Kept> kept_{std::make_unique<Kept>()};
};

}  // namespace fcl_ccd

#endif

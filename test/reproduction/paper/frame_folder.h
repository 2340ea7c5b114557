// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_PAPER_FRAME_FOLDER_H
#define FCL_BENCHMARK_PAPER_FRAME_FOLDER_H

#include <cstddef>
#include <string>
#include <vector>

#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief What a frame's motion is.
enum class FrameKind {
  /// from where the frame begins to where it leads if nothing is in the way
  kProposed,
  /// the last of the simulator's own steps in the frame, whose contacts were answered
  kAnswered
};

/// @brief The frames of a scene as `fcl_ccd_scenes --meshes` writes them, read one by
/// one.
class FrameFolder {
 public:
  /// @param every  only each frame whose number is a multiple of this: frames 3, 6, 9,
  /// ... if it is 3
  /// @throws std::runtime_error if there is no such frame
  FrameFolder(const std::string& path, FrameKind kind, int every);

  std::size_t size() const { return numbers_.size(); }
  /// @brief The number of a frame in the scene, counted from 1.
  int number(std::size_t i) const { return numbers_[i]; }
  /// @throws std::runtime_error if it cannot be read
  FramePairMesh read(std::size_t i) const;

 private:
  std::string file(int number, const char* ending) const;

  std::string path_;
  /// of the files of the two ends
  const char *begin_, *end_;
  std::vector<int> numbers_;
};

/// @brief Tells the frames that do not have the topology of the one before.
class TopologyWatch {
 public:
  /// @brief True for the first frame, too.
  bool isNew(const FramePairMesh& frame);

 private:
  std::vector<Triangle> triangles_;
  std::size_t num_vertices_{0};
};

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "frame_folder.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace fcl {
namespace test {

FrameFolder::FrameFolder(const std::string& path, FrameKind kind, int every)
    : path_(path),
      begin_(kind == FrameKind::kProposed ? "_begin.ply" : "_step.ply"),
      end_(kind == FrameKind::kProposed ? "_end.ply" : "_accepted.ply") {
  for (int n = every; std::filesystem::exists(file(n, end_)); n += every)
    numbers_.push_back(n);
  if (numbers_.empty())
    throw std::runtime_error(path +
                             ": has no frame to measure; fcl_ccd_scenes --meshes "
                             "writes them");
}

FramePairMesh FrameFolder::read(std::size_t i) const {
  return readFramePair(file(numbers_[i], begin_), file(numbers_[i], end_));
}

std::string FrameFolder::file(int number, const char* ending) const {
  char name[32];
  std::snprintf(name, sizeof name, "/%04d", number);
  return path_ + name + ending;
}

bool TopologyWatch::isNew(const FramePairMesh& frame) {
  const bool is_same =
      num_vertices_ == frame.previous.size() &&
      std::equal(frame.triangles.begin(), frame.triangles.end(), triangles_.begin(),
                 triangles_.end(), [](const Triangle& s, const Triangle& t) {
                   return s[0] == t[0] && s[1] == t[1] && s[2] == t[2];
                 });
  if (is_same) return false;
  triangles_ = frame.triangles;
  num_vertices_ = frame.previous.size();
  return true;
}

}  // namespace test
}  // namespace fcl

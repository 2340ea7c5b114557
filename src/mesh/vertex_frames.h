// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_VERTEX_FRAMES_H
#define FCL_CCD_MESH_VERTEX_FRAMES_H

#include <cassert>
#include <cstddef>

#include "base/prefetch.h"
#include "numerics/moving_vector.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A vertex that moves on the straight line from t0 (t = 0) to t1 (t = 1).
struct VertexPath {
  double t0[3];
  double t1[3];
};

/// @brief A row-major linear map and a translation: x -> rotation * x + translation.
struct Pose {
  double rotation[9]{1, 0, 0, 0, 1, 0, 0, 0, 1};
  double translation[3]{0, 0, 0};

  bool isTranslation() const {
    static const Pose identity;
    for (int i = 0; i < 9; ++i)
      if (rotation[i] != identity.rotation[i]) return false;
    return true;
  }

  bool isIdentity() const {
    return isTranslation() && translation[0] == 0 && translation[1] == 0 &&
           translation[2] == 0;
  }
};

inline Vec vecOf(const double (&v)[3]) { return {v[0], v[1], v[2]}; }
inline void set(double (&out)[3], const Vec& v) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

/// @brief The matrix times the vector; the matrix is a rotation or its derivative.
inline Vec rotated(const double (&m)[9], const Vec& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

/// @brief The transposed matrix times the vector.
inline Vec rotatedBack(const double (&m)[9], const Vec& v) {
  return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
          m[2] * v.x + m[5] * v.y + m[8] * v.z};
}

/// @brief A point under a pose: ((r0 x + r1 y) + r2 z) + translation. All points are
/// posed by this function, or by its form for eight (advance/turning_kernels.cpp).
inline Vec posed(const Pose& pose, const Vec& x) {
  return rotated(pose.rotation, x) + vecOf(pose.translation);
}

/// @brief The paths of a mesh's vertices: two coordinate arrays (float or double, x y z
/// per vertex, not owned) and the pose of each frame.
class VertexFrames {
 public:
  VertexFrames() = default;
  VertexFrames(const double* previous, const double* current, std::size_t count)
      : double_{previous, current}, count_(count) {}
  VertexFrames(const float* previous, const float* current, std::size_t count)
      : float_{previous, current}, count_(count) {}

  void setPoses(const Pose& beginning, const Pose& end) {
    pose_[0] = beginning;
    pose_[1] = end;
    posed_ = !(beginning.isIdentity() && end.isIdentity());
  }

  std::size_t size() const { return count_; }

  /// @brief Whether both frames are the same array and have no pose. Then nothing moves.
  bool isStill() const {
    return !posed_ && double_[0] == double_[1] && float_[0] == float_[1];
  }
  bool isPosed() const { return posed_; }
  const Pose& pose(int frame) const { return pose_[frame]; }

  /// @brief Path of vertex i in the world: what posed() gives is what every contact
  /// refers to.
  VertexPath operator[](std::size_t i) const {
    VertexPath path;
    assert(i < count_);
    at(0, i, path.t0);
    at(1, i, path.t1);
    return path;
  }

  /// @brief Prefetches vertex i.
  void prefetch(std::size_t i) const {
    assert(i < count_);
    for (int frame = 0; frame < 2; ++frame) {
      if (double_[frame])
        prefetchMemory(double_[frame] + 3 * i);
      else
        prefetchMemory(float_[frame] + 3 * i);
    }
  }

  /// @brief Position of vertex i in one frame.
  void at(int frame, std::size_t i, double (&out)[3]) const {
    assert((frame == 0 || frame == 1) && i < count_);
    for (std::size_t k = 0; k < 3; ++k)
      out[k] =
          double_[frame] ? double_[frame][3 * i + k] : double{float_[frame][3 * i + k]};
    if (posed_) set(out, posed(pose_[frame], vecOf(out)));
  }

 private:
  const double* double_[2]{nullptr, nullptr};
  const float* float_[2]{nullptr, nullptr};
  std::size_t count_{0};
  bool posed_{false};
  Pose pose_[2];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

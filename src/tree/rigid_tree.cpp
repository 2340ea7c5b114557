// SPDX-License-Identifier: BSD-3-Clause
#include "tree/rigid_tree.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/prefetch.h"
#include "tree/float4.h"
#include "tree/open_binary.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr float kFloatUnit = 0x1p-24f;

/// A half-axis as roundUp() returns it: infinity in place of NaN, at least kLeastHalf.
Float4 bounded(const Float4& half) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const Float4 number = half == half ? half : Float4{kInf, kInf, kInf, kInf};
  return larger(number, Float4{kLeastHalf, kLeastHalf, kLeastHalf, kLeastHalf});
}

/// Eight boxes in lanes, rounded to float. Centers are relative to the tree's origin.
struct EightBoxes {
  float center[3][MovingKdopNode::kWidth];
  float half_axis[3][3][MovingKdopNode::kWidth];
};

void rotateVector(const double (&r)[9], double (&v)[3]) {
  const double x = v[0], y = v[1], z = v[2];
  for (int k = 0; k < 3; ++k) v[k] = r[3 * k] * x + r[3 * k + 1] * y + r[3 * k + 2] * z;
}

/// Rotates the half axes.
void rotateAxes(const double (&rotation)[9], EightBoxes& boxes) {
  float r[9];
  for (int k = 0; k < 9; ++k) r[k] = static_cast<float>(rotation[k]);
  for (auto& axis : boxes.half_axis)
    for (int q = 0; q < MovingKdopNode::kWidth; q += 4) {
      const Float4 v[3] = {load(axis[0] + q), load(axis[1] + q), load(axis[2] + q)};
      for (int k = 0; k < 3; ++k)
        store(v[0] * r[3 * k] + v[1] * r[3 * k + 1] + v[2] * r[3 * k + 2], axis[k] + q);
    }
}

/// The largest distance of a point of the box from its center, along x, y or z.
double spreadOf(const OrientedBox& box) {
  double most = 0;
  for (int k = 0; k < 3; ++k) {
    double spread = 0;
    for (int i = 0; i < 3; ++i) spread += std::abs(box.axis[i][k] * box.extent[i]);
    most = std::max(most, spread);
  }
  return most;
}

/// Half-axes of 16-DOPs around the boxes, without rounding outward. Along a direction d a
/// box reaches from its center by the sum of |d . half axis|.
void fitBoxes(const EightBoxes& boxes, float (&rows)[16][MovingKdopNode::kWidth]) {
  for (int q = 0; q < MovingKdopNode::kWidth; q += 4) {
    const auto alongDirections = [q](const float(&v)[3][MovingKdopNode::kWidth],
                                     Float4(&d)[8]) {
      const Float4 p[3] = {load(v[0] + q), load(v[1] + q), load(v[2] + q)};
      kdopCoordinates(p, d);
    };
    Float4 center[8], axis[3][8];
    alongDirections(boxes.center, center);
    for (int k = 0; k < 3; ++k) alongDirections(boxes.half_axis[k], axis[k]);
    for (int j = 0; j < 8; ++j) {
      const Float4 spread = abs(axis[0][j]) + abs(axis[1][j]) + abs(axis[2][j]);
      store(spread - center[j], rows[2 * j] + q);
      store(spread + center[j], rows[2 * j + 1] + q);
    }
  }
}

}  // namespace

RigidTree::RigidTree(const VolumeTree& volumes, const Pose& beginning, const Pose& end)
    : volumes_(volumes),
      turns_(!std::equal(beginning.rotation, beginning.rotation + 9, end.rotation)) {
  assert(volumes.reader.boxes && volumes.reader.stride >= sizeof(int) && slack() >= 0);
  OrientedBox whole;
  orientedBox(0, whole);
  is_rotated_ = !beginning.isTranslation() || !end.isTranslation();
  std::copy(beginning.rotation, beginning.rotation + 9, rotation_[0]);
  std::copy(end.rotation, end.rotation + 9, rotation_[1]);
  setOrigin(0);
  if (turns_)
    setOrigin(1);
  else
    std::copy(origin_[0], origin_[0] + 3, origin_[1]);
  largest_coordinate_ *= 1 + slack();
  if (!turns_) return;
  // The difference of both rotations, applied to any point, whose length is below `size`.
  double size = 0, square = 0;
  for (int k = 0; k < 9; ++k) {
    const double change = rotation_[1][k] - rotation_[0][k];
    square += change * change;
  }
  for (int k = 0; k < 3; ++k) size += std::abs(whole.center[k]) + whole.extent[k];
  size *= 1 + 2 * slack();
  assert(largest_coordinate_ >= 0 && square >= 0);
  displacement_ = roundUp(std::sqrt(square) * size, 0.f);
}

/// The origin is in the middle of the mesh. If one of its halves is tiny relative to the
/// whole, the origin is in the middle of this half: a vertex may be far away from all
/// others, and floats relative to the middle of the mesh would be rounding only (as in
/// MovingKdopTree::refit()).
void RigidTree::setOrigin(int frame) {
  constexpr double kSpeck = 0x1p-10;
  double(&origin)[3] = origin_[frame];
  OrientedBox whole, part;
  orientedBox(0, whole, frame);
  double least = kSpeck * spreadOf(whole);
  std::copy(whole.center, whole.center + 3, origin);
  for (int child = link(0); child >= 0 && child < link(0) + 2; ++child) {
    orientedBox(child, part, frame);
    if (!(spreadOf(part) < least)) continue;
    least = spreadOf(part);
    std::copy(part.center, part.center + 3, origin);
  }
  // Twice the size: together with a center relative to the origin it then bounds the
  // center itself.
  const double size = std::abs(origin[0]) + std::abs(origin[1]) + std::abs(origin[2]);
  origin_size_ = std::max(origin_size_, roundUp(2 * size, 0.f));
  for (int k = 0; k < 3; ++k)
    largest_coordinate_ = std::max(
        largest_coordinate_, spreadOf(whole) + std::abs(whole.center[k] - origin[k]));
}

void RigidTree::rotate(int frame, OrientedBox& box) const {
  rotateVector(rotation_[frame], box.center);
  for (auto& axis : box.axis) rotateVector(rotation_[frame], axis);
}

void RigidTree::orientedBox(int node, OrientedBox& box, int frame) const {
  const void* address = volumes_.at(node);
  volumes_.reader.boxes(&address, 1, &box);
  if (is_rotated_) rotate(frame, box);
}

/// Fills the rows of both frames with the 16-DOPs of eight nodes.
void RigidTree::setRows(const std::int32_t (&nodes)[kWidth], MovingKdopNode& out) const {
  const void* addresses[kWidth];
  for (int lane = 0; lane < kWidth; ++lane) addresses[lane] = volumes_.at(nodes[lane]);
  if (volumes_.reader.slabs && !is_rotated_) {
    double origin[8];
    kdopCoordinates(origin_[0], origin);
    Slabs slabs[kWidth];
    volumes_.reader.slabs(addresses, kWidth, slabs);
    for (int lane = 0; lane < kWidth; ++lane) {
      for (int j = 0; j < 8; ++j) {
        out.t0[2 * j][lane] = static_cast<float>(origin[j] - slabs[lane].lo[j]);
        out.t0[2 * j + 1][lane] = static_cast<float>(slabs[lane].hi[j] - origin[j]);
      }
    }
    // The bounds along x, y, z are coordinates, without error. Bounds along other
    // directions are sums of two coordinates; the slack contains their rounding.
    roundOutward(0.f, out.t0);
    std::memcpy(out.t1, out.t0, sizeof(out.t0));
    return;
  }
  OrientedBox stored[kWidth];
  volumes_.reader.boxes(addresses, kWidth, stored);
  const int num_frames = turns_ ? 2 : 1;
  EightBoxes boxes[2];
  for (int lane = 0; lane < kWidth; ++lane) {
    const OrientedBox& box = stored[lane];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        boxes[0].half_axis[i][k][lane] =
            static_cast<float>(box.axis[i][k] * box.extent[i]);
    for (int frame = 0; frame < num_frames; ++frame) {
      double center[3] = {box.center[0], box.center[1], box.center[2]};
      if (is_rotated_) rotateVector(rotation_[frame], center);
      for (int k = 0; k < 3; ++k)
        boxes[frame].center[k][lane] = static_cast<float>(center[k] - origin_[frame][k]);
    }
  }
  if (turns_)
    std::memcpy(boxes[1].half_axis, boxes[0].half_axis, sizeof(boxes[0].half_axis));
  // A half-axis is a sum of components of the center and of the half axes. Those of the
  // center are rounded to float. A half axis v and the rotation are rounded to float,
  // then products and two sums of them: 5 units of kFloatUnit times |v|, which is at most
  // the sum of its components. Adding two components is 1 + 2 and 1 + 2 * 5 units, the
  // spread 2, the last sum 1. 3 more cover the rounding of the padding itself. The slack
  // of the fit is far larger than the few 2^-53 of the rotation of the center.
  for (int frame = 0; frame < num_frames; ++frame) {
    auto& rows = frame == 0 ? out.t0 : out.t1;
    if (is_rotated_) rotateAxes(rotation_[frame], boxes[frame]);
    fitBoxes(boxes[frame], rows);
    roundOutward(20 * kFloatUnit, rows);
  }
  if (!turns_) std::memcpy(out.t1, out.t0, sizeof(out.t0));
  for (int lane = 0; lane < kWidth; ++lane)
    assert(containsBox(0, lane, nodes[lane], out) &&
           containsBox(1, lane, nodes[lane], out));
}

/// Whether rows that were computed in floats contain an oriented box, by doubles. These
/// round by less than 2^-40 of the numbers. What is not finite does not count.
bool RigidTree::containsBox(int frame, int lane, int node,
                            const MovingKdopNode& rows) const {
  OrientedBox box;
  orientedBox(node, box, frame);
  double center[3], along_center[8], spread[8] = {}, size = 0;
  for (int k = 0; k < 3; ++k) {
    center[k] = box.center[k] - origin_[frame][k];
    size += std::abs(box.center[k]) + std::abs(origin_[frame][k]);
  }
  kdopCoordinates(center, along_center);
  for (int i = 0; i < 3; ++i) {
    double along[8];
    kdopCoordinates(box.axis[i], along);
    for (int j = 0; j < 8; ++j) spread[j] += std::abs(along[j]) * box.extent[i];
  }
  size += spread[0] + spread[1] + spread[2];
  const auto& half = frame == 0 ? rows.t0 : rows.t1;
  for (int j = 0; j < 8; ++j) {
    const double reach = spread[j] - 0x1p-40 * size;
    if (reach - along_center[j] > double{half[2 * j][lane]} ||
        reach + along_center[j] > double{half[2 * j + 1][lane]})
      return false;
  }
  return true;
}

/// Pads rows whose half-axes are set: by `rounding`, relative to the sum of the
/// components, and by the slack of the volumes' fit.
void RigidTree::roundOutward(float rounding, float (&rows)[16][kWidth]) const {
  const auto relative = static_cast<float>(slack());
  for (int q = 0; q < kWidth; q += 4) {
    // The sum over x, y and z of the center's distance from the origin and half the
    // width.
    Float4 size{};
    for (int r = 0; r < 6; r += 2)
      size += larger(abs(load(rows[r] + q)), abs(load(rows[r + 1] + q)));
    const Float4 pad = size * rounding + (size + origin_size_) * relative + FLT_MIN;
    for (int r = 0; r < 16; ++r) {
      const Float4 half = load(rows[r] + q);
      store(bounded(half + (abs(half) * kOutward + pad)), rows[r] + q);
    }
  }
}

void RigidTree::open(int i, MovingKdopNode& out) const {
  assert(volumes_.nodes && i >= 0);
  // `nodes` has FCL's nodes, for their boxes. `out.child` has the links to what is below
  // them.
  std::int32_t nodes[kWidth];
  std::fill(nodes, nodes + kWidth, i);
  // Most nodes are not in the cache.
  out.count = openBinary(i, nodes, out.child, [this](std::int32_t k) {
    const int left = link(k);
    if (left >= 0)
      for (const int child : {left, left + 1}) prefetchMemory(volumes_.at(child));
    return left;
  });
  for (int lane = 0; lane < out.count; ++lane) prefetch(nodes[lane]);
  out.markTriangles();
  setRows(nodes, out);
  if (bent_boxes_) bent_boxes_->enlarge(out);
  std::fill(out.displacement, out.displacement + kWidth, displacement_);
  out.clearRest();
  assert(out.isComparable());
}

MovingKdop RigidTree::box(int node) const {
  std::int32_t nodes[kWidth];
  std::fill(nodes, nodes + kWidth, node);
  MovingKdopNode out;
  setRows(nodes, out);
  return out.box(0);
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

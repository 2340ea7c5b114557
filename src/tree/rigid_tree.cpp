// SPDX-License-Identifier: BSD-3-Clause
#include "tree/rigid_tree.h"

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <limits>

#include "fcl/geometry/bvh/BVH_model.h"
#include "tree/fcl_volumes.h"
#include "tree/float4.h"
#include "tree/open_binary.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Bounds along our directions.
struct Slabs {
  double lo[8];
  double hi[8];
};

template <typename S>
Slabs slabsOf(const AABB<S>& bv) {
  const double lo[3] = {double{bv.min_[0]}, double{bv.min_[1]}, double{bv.min_[2]}};
  const double hi[3] = {double{bv.max_[0]}, double{bv.max_[1]}, double{bv.max_[2]}};
  Slabs slabs;
  kdopCoordinates(lo, slabs.lo);
  kdopCoordinates(hi, slabs.hi);
  for (int k = 1; k < 3; ++k) {  // x - y and x - z
    slabs.lo[5 + k] = lo[0] - hi[k];
    slabs.hi[5 + k] = hi[0] - lo[k];
  }
  return slabs;
}

/// The first 8 directions of all of FCL's KDOPs are ours. The bounds are private, and FCL
/// needs a function call for each. So they are read from memory: a KDOP consists of its
/// bounds only.
template <typename S, std::size_t N>
Slabs slabsOf(const KDOP<S, N>& bv) {
  static_assert(std::is_standard_layout_v<KDOP<S, N>> && sizeof(bv) == N * sizeof(S));
  const S* bounds = reinterpret_cast<const S*>(&bv);
  Slabs slabs;
  for (std::size_t j = 0; j < 8; ++j) {
    slabs.lo[j] = double{bounds[j]};
    slabs.hi[j] = double{bounds[j + N / 2]};
  }
  return slabs;
}

/// A box that contains all finite points.
constexpr OrientedBox kUnbounded = {
    {0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {DBL_MAX, DBL_MAX, DBL_MAX}};

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

int RigidTree::link(int node) const { return at(node)->first_child; }

template <typename BV>
RigidTree::Volumes RigidTree::volumesOf() {
  return {sizeof(BVNode<BV>), kFitSlack<typename BV::S>, kHasSlabs<BV>,
          &RigidTree::setBox<BV>, &RigidTree::setRows<BV>};
}

template <typename BV>
RigidTree::RigidTree(const BVHModel<BV>& model, const Pose& pose)
    : RigidTree(&model.getBV(0), volumesOf<BV>(), pose, pose) {}

RigidTree::RigidTree(const BVNodeBase* nodes, const Volumes& volumes,
                     const Pose& beginning, const Pose& end)
    : nodes_(nodes),
      volumes_(volumes),
      turns_(!std::equal(beginning.rotation, beginning.rotation + 9, end.rotation)) {
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

/// The box of a node in the body's frame: of an AABB or a KDOP that of the first three
/// slabs.
template <typename BV>
OrientedBox RigidTree::storedBox(int node) const {
  const BV& bv = static_cast<const BVNode<BV>*>(at(node))->bv;
  OrientedBox box;
  if constexpr (kHasSlabs<BV>) {
    const Slabs slabs = slabsOf(bv);
    for (int k = 0; k < 3; ++k) {
      box.center[k] = 0.5 * (slabs.lo[k] + slabs.hi[k]);
      for (int i = 0; i < 3; ++i) box.axis[i][k] = i == k;
      box.extent[k] = 0.5 * (slabs.hi[k] - slabs.lo[k]);
    }
  } else {
    box = orientedBoxOf(bv);
    if (!isBox(box, volumes_.slack)) box = kUnbounded;
  }
  return box;
}

template <typename BV>
void RigidTree::setBox(int node, int frame, OrientedBox& box) const {
  box = storedBox<BV>(node);
  if (is_rotated_) rotate(frame, box);
}

template <typename BV>
void RigidTree::setRows(const std::int32_t (&nodes)[kWidth], MovingKdopNode& out) const {
  if constexpr (kHasSlabs<BV>)
    if (!is_rotated_) {
      double origin[8];
      kdopCoordinates(origin_[0], origin);
      for (int lane = 0; lane < kWidth; ++lane) {
        const Slabs slabs = slabsOf(static_cast<const BVNode<BV>*>(at(nodes[lane]))->bv);
        for (int j = 0; j < 8; ++j) {
          out.t0[2 * j][lane] = static_cast<float>(origin[j] - slabs.lo[j]);
          out.t0[2 * j + 1][lane] = static_cast<float>(slabs.hi[j] - origin[j]);
        }
      }
      // The bounds along x, y, z are coordinates, without error. Bounds along other
      // directions are sums of two coordinates; the slack contains their rounding.
      roundOutward(0.f, out.t0);
      std::memcpy(out.t1, out.t0, sizeof(out.t0));
      return;
    }
  const int num_frames = turns_ ? 2 : 1;
  EightBoxes boxes[2];
  for (int lane = 0; lane < kWidth; ++lane) {
    const OrientedBox box = storedBox<BV>(nodes[lane]);
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
}

/// Pads rows whose half-axes are set: by `rounding`, relative to the sum of the
/// components, and by the slack of the volumes' fit.
void RigidTree::roundOutward(float rounding, float (&rows)[16][kWidth]) const {
  const auto slack = static_cast<float>(volumes_.slack);
  for (int q = 0; q < kWidth; q += 4) {
    // The sum over x, y and z of the center's distance from the origin and half the
    // width.
    Float4 size{};
    for (int r = 0; r < 6; r += 2)
      size += larger(abs(load(rows[r] + q)), abs(load(rows[r + 1] + q)));
    const Float4 pad = size * rounding + (size + origin_size_) * slack + FLT_MIN;
    for (int r = 0; r < 16; ++r) {
      const Float4 half = load(rows[r] + q);
      store(bounded(half + (abs(half) * kOutward + pad)), rows[r] + q);
    }
  }
}

void RigidTree::open(int i, MovingKdopNode& out) const {
  assert(nodes_ && i >= 0);
  // `nodes` has FCL's nodes, for their boxes. `out.child` has the links to what is below
  // them.
  std::int32_t nodes[kWidth];
  std::fill(nodes, nodes + kWidth, i);
  // Most nodes are not in the cache.
  out.count = openBinary(i, nodes, out.child, [this](std::int32_t k) {
    const int left = link(k);
    if (left >= 0)
      for (const int child : {left, left + 1}) __builtin_prefetch(at(child));
    return left;
  });
  for (int lane = 0; lane < out.count; ++lane) prefetch(nodes[lane]);
  out.markTriangles();
  (this->*volumes_.set_rows)(nodes, out);
  if (bent_boxes_) bent_boxes_->enlarge(out);
  std::fill(out.displacement, out.displacement + kWidth, displacement_);
  out.clearRest();
}

MovingKdop RigidTree::box(int node) const {
  std::int32_t nodes[kWidth];
  std::fill(nodes, nodes + kWidth, node);
  MovingKdopNode out;
  (this->*volumes_.set_rows)(nodes, out);
  return out.box(0);
}

#define FCL_CCD_INSTANTIATE(BV) \
  template RigidTree::RigidTree(const BVHModel<BV>&, const Pose&);
#define FCL_CCD_COMMA ,
FCL_CCD_INSTANTIATE(AABB<double>)
FCL_CCD_INSTANTIATE(AABB<float>)
FCL_CCD_INSTANTIATE(OBB<double>)
FCL_CCD_INSTANTIATE(OBB<float>)
FCL_CCD_INSTANTIATE(RSS<double>)
FCL_CCD_INSTANTIATE(RSS<float>)
FCL_CCD_INSTANTIATE(OBBRSS<double>)
FCL_CCD_INSTANTIATE(OBBRSS<float>)
FCL_CCD_INSTANTIATE(kIOS<double>)
FCL_CCD_INSTANTIATE(kIOS<float>)
FCL_CCD_INSTANTIATE(KDOP<double FCL_CCD_COMMA 16>)
FCL_CCD_INSTANTIATE(KDOP<float FCL_CCD_COMMA 16>)
FCL_CCD_INSTANTIATE(KDOP<double FCL_CCD_COMMA 18>)
FCL_CCD_INSTANTIATE(KDOP<float FCL_CCD_COMMA 18>)
FCL_CCD_INSTANTIATE(KDOP<double FCL_CCD_COMMA 24>)
FCL_CCD_INSTANTIATE(KDOP<float FCL_CCD_COMMA 24>)
#undef FCL_CCD_COMMA
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

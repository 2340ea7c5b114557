// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/rigid_tree.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <type_traits>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// FCL fits its volumes in S with rounding to nearest, so that a point can stand out of
/// its volume by a few units in the last place of its coordinates, and merges add a few
/// more on each level; 2^12 units cover any depth that a tree in memory can have (two
/// units a level would take 2000 levels). Too large a margin costs only a box test.
template <typename S>
constexpr double kFitSlack = 0x1p12 * std::numeric_limits<S>::epsilon();

template <typename S>
void set(double (&out)[3], const Vector3<S>& v, double scale = 1) {
  for (int k = 0; k < 3; ++k) out[k] = scale * double{v[k]};
}

}  // namespace

// An axis-aligned box from the first three slabs of an AABB or a KDOP.
template <typename BV>
RigidTree::OrientedBox RigidTree::boxOf(const void* node) {
  using S = typename BV::S;
  const BV& bv = static_cast<const BVNode<BV>*>(node)->bv;
  OrientedBox box{};
  const Vector3<S> center = bv.center();
  const double size[3] = {double{bv.width()}, double{bv.height()}, double{bv.depth()}};
  set<S>(box.center, center);
  for (int k = 0; k < 3; ++k) box.half_axis[k][k] = 0.5 * size[k];
  box.slack = kFitSlack<S>;
  return box;
}

namespace {

template <typename Box, typename S>
Box fromObb(const OBB<S>& obb) {
  Box box{};
  set<S>(box.center, obb.To);
  for (int k = 0; k < 3; ++k)
    set<S>(box.half_axis[k], obb.axis.col(k), double{obb.extent[k]});
  box.slack = kFitSlack<S>;
  return box;
}

}  // namespace

#define FCL_CCD_BOX_OF(BV, EXPRESSION)                                       \
  template <>                                                                \
  RigidTree::OrientedBox RigidTree::boxOf<BV<double>>(const void* node) {    \
    const BV<double>& bv = static_cast<const BVNode<BV<double>>*>(node)->bv; \
    return EXPRESSION;                                                       \
  }                                                                          \
  template <>                                                                \
  RigidTree::OrientedBox RigidTree::boxOf<BV<float>>(const void* node) {     \
    const BV<float>& bv = static_cast<const BVNode<BV<float>>*>(node)->bv;   \
    return EXPRESSION;                                                       \
  }
FCL_CCD_BOX_OF(OBB, fromObb<OrientedBox>(bv))
FCL_CCD_BOX_OF(OBBRSS, fromObb<OrientedBox>(bv.obb))
FCL_CCD_BOX_OF(kIOS, fromObb<OrientedBox>(bv.obb))
#undef FCL_CCD_BOX_OF

template <typename S, std::size_t N>
constexpr std::size_t halfSlabCount(const KDOP<S, N>*) {
  return N / 2;
}

// The first 8 directions of every KDOP of FCL's are ours.
template <typename BV>
RigidTree::SlabsOf RigidTree::slabsOf() {
  using S = typename BV::S;
  return [](const void* node) {
    const BV& bv = static_cast<const BVNode<BV>*>(node)->bv;
    Slabs slabs;
    if constexpr (std::is_same_v<BV, AABB<S>>) {
      const double lo[3] = {double{bv.min_[0]}, double{bv.min_[1]}, double{bv.min_[2]}};
      const double hi[3] = {double{bv.max_[0]}, double{bv.max_[1]}, double{bv.max_[2]}};
      kdopCoordinates(lo, slabs.lo);
      kdopCoordinates(hi, slabs.hi);
      for (int k = 1; k < 3; ++k) {  // x - y and x - z
        slabs.lo[5 + k] = lo[0] - hi[k];
        slabs.hi[5 + k] = hi[0] - lo[k];
      }
    } else {
      constexpr std::size_t kHalf = halfSlabCount(static_cast<const BV*>(nullptr));
      for (std::size_t j = 0; j < 8; ++j) {
        slabs.lo[j] = double{bv.dist(j)};
        slabs.hi[j] = double{bv.dist(j + kHalf)};
      }
    }
    slabs.slack = kFitSlack<S>;
    return slabs;
  };
}

#define FCL_CCD_NO_SLABS(BV)                            \
  template <>                                           \
  RigidTree::SlabsOf RigidTree::slabsOf<BV<double>>() { \
    return nullptr;                                     \
  }                                                     \
  template <>                                           \
  RigidTree::SlabsOf RigidTree::slabsOf<BV<float>>() {  \
    return nullptr;                                     \
  }
FCL_CCD_NO_SLABS(OBB)
FCL_CCD_NO_SLABS(OBBRSS)
FCL_CCD_NO_SLABS(kIOS)
#undef FCL_CCD_NO_SLABS

#define FCL_CCD_INSTANTIATE(BV)                                      \
  template RigidTree::OrientedBox RigidTree::boxOf<BV>(const void*); \
  template RigidTree::SlabsOf RigidTree::slabsOf<BV>();
#define FCL_CCD_COMMA ,
FCL_CCD_INSTANTIATE(AABB<double>)
FCL_CCD_INSTANTIATE(AABB<float>)
FCL_CCD_INSTANTIATE(KDOP<double FCL_CCD_COMMA 16>)
FCL_CCD_INSTANTIATE(KDOP<float FCL_CCD_COMMA 16>)
FCL_CCD_INSTANTIATE(KDOP<double FCL_CCD_COMMA 18>)
FCL_CCD_INSTANTIATE(KDOP<float FCL_CCD_COMMA 18>)
FCL_CCD_INSTANTIATE(KDOP<double FCL_CCD_COMMA 24>)
FCL_CCD_INSTANTIATE(KDOP<float FCL_CCD_COMMA 24>)
#undef FCL_CCD_COMMA
#undef FCL_CCD_INSTANTIATE

RigidTree::RigidTree(const BVNodeBase* nodes, std::size_t stride, BoxOf box_of,
                     SlabsOf slabs_of, const Pose& pose)
    : nodes_(nodes),
      stride_(stride),
      box_of_(box_of),
      is_rotated_(!pose.isTranslation()) {
  if (!is_rotated_) slabs_of_ = slabs_of;
  std::copy(pose.rotation, pose.rotation + 9, rotation_);
  const OrientedBox root = rotated(0);
  std::copy(root.center, root.center + 3, origin_);
  // Twice, so that with a center relative to it it bounds the center itself too.
  origin_size_ = roundUp(
      2 * (std::abs(origin_[0]) + std::abs(origin_[1]) + std::abs(origin_[2])), 0.f);
  for (int k = 0; k < 3; ++k)
    reach_ =
        std::max(reach_, std::abs(root.half_axis[0][k]) + std::abs(root.half_axis[1][k]) +
                             std::abs(root.half_axis[2][k]));
  reach_ *= 1 + root.slack;
}

RigidTree::OrientedBox RigidTree::rotated(int node) const {
  OrientedBox box = box_of_(at(node));
  if (!is_rotated_) return box;
  const auto turn = [this](double(&v)[3]) {
    const double x = v[0], y = v[1], z = v[2];
    for (int k = 0; k < 3; ++k)
      v[k] = rotation_[3 * k] * x + rotation_[3 * k + 1] * y + rotation_[3 * k + 2] * z;
  };
  turn(box.center);
  for (auto& axis : box.half_axis) turn(axis);
  return box;
}

void RigidTree::fromSlabs(const Slabs& slabs, MovingKdop& box) const {
  double origin[8];
  kdopCoordinates(origin_, origin);
  // The bounds along x, y, z are those of coordinates, without error; a sum of two was
  // rounded to within the slack of its terms.
  double size = 0;
  for (int k = 0; k < 3; ++k)
    size += std::abs(origin_[k]) + std::max(std::abs(slabs.lo[k]), std::abs(slabs.hi[k]));
  const float pad = roundUp(size * slabs.slack, 0.f);
  for (int j = 0; j < 8; ++j) {
    box.t0.half[j] = roundUp(origin[j] - slabs.lo[j], pad);
    box.t0.half[j + 8] = roundUp(slabs.hi[j] - origin[j], pad);
  }
  box.t1 = box.t0;
}

void RigidTree::open(int i, MovingKdopNode& out) const {
  // The boxes are needed of FCL's nodes, the links of what is below them.
  std::int32_t nodes[MovingKdopNode::kWidth];
  out.count = openBinary(i, nodes, out.child, [this](std::int32_t k) { return link(k); });
  out.clearRest();
  MovingKdop box;
  for (int lane = 0; lane < out.count; ++lane) {
    makeBox(nodes[lane], box);
    out.setBox(lane, box);
  }
}

namespace {

constexpr float kFloatUnit = 0x1p-24f;

/// One lane in all four.
template <int kLane>
Float4 lane(const Float4& v) {
  return __builtin_shufflevector(v, v, kLane, kLane, kLane, kLane);
}
Float4 abs(const Float4& v) {
  constexpr int kAllButSign = 0x7fffffff;
  return Float4(Mask4(v) & kAllButSign);
}

/// As roundUp() leaves a half-axis: infinite in place of a NaN, never below kLeastHalf.
Float4 bounded(const Float4& half) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const Float4 number = half == half ? half : Float4{kInf, kInf, kInf, kInf};
  return number > kLeastHalf ? number
                             : Float4{kLeastHalf, kLeastHalf, kLeastHalf, kLeastHalf};
}

/// The 8 directions applied to a vector, rounded to float: each entry is within 2 units
/// of kFloatUnit of the sum of the terms it is made of. What overflows is infinite or
/// NaN.
void kdopCoordinates(const double (&p)[3], Float4 (&d)[2]) {
  const Float4 v = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                    static_cast<float>(p[2]), 0.f};
  d[0] = __builtin_shufflevector(v, v, 0, 1, 2, 0) +
         __builtin_shufflevector(v, v, 3, 3, 3, 1);
  d[1] = __builtin_shufflevector(v, v, 0, 1, 0, 0) +
         __builtin_shufflevector(v, -v, 2, 2, 5, 6);
}

}  // namespace

void RigidTree::makeBox(int node, MovingKdop& box) const {
  if (slabs_of_) return fromSlabs(slabs_of_(at(node)), box);
  OrientedBox bv = rotated(node);
  for (int k = 0; k < 3; ++k) bv.center[k] -= origin_[k];

  Float4 center[2], axis[2], spread[2] = {};
  kdopCoordinates(bv.center, center);
  for (const auto& half_axis : bv.half_axis) {
    kdopCoordinates(half_axis, axis);
    for (int q = 0; q < 2; ++q) spread[q] += abs(axis[q]);
  }
  // Sum of the components of the center and of all half axes. A bound is a sum of such:
  // 2 units for the directions, 2 for the spread, 1 for the last sum, and 3 more than
  // cover the rounding of size and pad. The fit's slack is far above the few 2^-53 of the
  // rotation and of the center.
  const Float4 reach = spread[0] + abs(center[0]);
  const Float4 size = lane<0>(reach) + lane<1>(reach) + lane<2>(reach);
  const Float4 pad = size * (8 * kFloatUnit) +
                     (size + origin_size_) * static_cast<float>(bv.slack) + FLT_MIN;
  for (int q = 0; q < 2; ++q) {
    const Float4 lower = spread[q] - center[q], upper = spread[q] + center[q];
    const Float4 half[2] = {bounded(lower + (abs(lower) * kOutward + pad)),
                            bounded(upper + (abs(upper) * kOutward + pad))};
    for (int side = 0; side < 2; ++side)
      for (Kdop16* frame : {&box.t0, &box.t1})
        __builtin_memcpy(frame->half + 8 * side + 4 * q, &half[side], sizeof(Float4));
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

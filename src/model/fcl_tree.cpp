// SPDX-License-Identifier: BSD-3-Clause
#include "model/fcl_tree.h"

#include <cassert>
#include <cfloat>
#include <cstddef>
#include <type_traits>

#include "fcl/geometry/bvh/BVH_model.h"
#include "mesh/moving_kdop.h"
#include "model/fcl_volumes.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

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

template <typename BV>
const BV& volumeOf(const void* node) {
  return static_cast<const BVNode<BV>*>(node)->bv;
}

template <typename BV>
void readSlabs(const void* const* nodes, int count, Slabs* out) {
  for (int i = 0; i < count; ++i) out[i] = slabsOf(volumeOf<BV>(nodes[i]));
}

/// The box of an AABB or a KDOP is that of the first three slabs.
template <typename BV>
void readBoxes(const void* const* nodes, int count, OrientedBox* out) {
  for (int n = 0; n < count; ++n) {
    OrientedBox& box = out[n];
    if constexpr (kHasSlabs<BV>) {
      const Slabs slabs = slabsOf(volumeOf<BV>(nodes[n]));
      for (int k = 0; k < 3; ++k) {
        box.center[k] = 0.5 * (slabs.lo[k] + slabs.hi[k]);
        for (int i = 0; i < 3; ++i) box.axis[i][k] = i == k;
        box.extent[k] = 0.5 * (slabs.hi[k] - slabs.lo[k]);
      }
    } else {
      box = orientedBoxOf(volumeOf<BV>(nodes[n]));
      if (!isBox(box, kFitSlack<typename BV::S>)) box = kUnbounded;
    }
  }
}

}  // namespace

template <typename BV>
VolumeTree fclTree(const BVHModel<BV>& model) {
  static_assert(
      std::is_standard_layout_v<BVNodeBase> && offsetof(BVNodeBase, first_child) == 0,
      "a node begins with its link");
  assert(model.getNumBVs() > 0);
  VolumeTree tree;
  // The address of the base, with which a node begins.
  tree.nodes = &model.getBV(0);
  tree.reader.stride = sizeof(BVNode<BV>);
  tree.reader.slack = kFitSlack<typename BV::S>;
  if constexpr (kHasSlabs<BV>) tree.reader.slabs = &readSlabs<BV>;
  tree.reader.boxes = &readBoxes<BV>;
  return tree;
}

#define FCL_CCD_INSTANTIATE(BV) template VolumeTree fclTree(const BVHModel<BV>&);
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

// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"

namespace fcl {

#define FCL_CCD_INSTANTIATE(S)                    \
  template class DeformableBVHModel<AABB<S>>;     \
  template class DeformableBVHModel<OBB<S>>;      \
  template class DeformableBVHModel<RSS<S>>;      \
  template class DeformableBVHModel<kIOS<S>>;     \
  template class DeformableBVHModel<OBBRSS<S>>;   \
  template class DeformableBVHModel<KDOP<S, 16>>; \
  template class DeformableBVHModel<KDOP<S, 18>>; \
  template class DeformableBVHModel<KDOP<S, 24>>;
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace fcl

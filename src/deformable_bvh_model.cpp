// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/geometry/bvh/deformable_bvh_model.h"

#include <memory>

#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "per_thread_fitting.h"

namespace fcl {

template <typename BV>
void DeformableBVHModel<BV>::fitPerThread() {
  this->bv_splitter = std::make_shared<detail::PerThreadSplitter<BV>>();
  this->bv_fitter = std::make_shared<detail::PerThreadFitter<BV>>();
}

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

// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/geometry/bvh/refit_top_down.h"

#include "model/sound_tree.h"

namespace fcl {
namespace detail {

template <typename BV>
void markFittedFromTheTop(BVHModel<BV>& model) {
  deformable::markFittedFromTheTop(model);
}

#define FCL_CCD_COMMA ,
#define FCL_CCD_INSTANTIATE(BV) template void markFittedFromTheTop(BVHModel<BV>&);
#define FCL_CCD_INSTANTIATE_ALL(S)              \
  FCL_CCD_INSTANTIATE(AABB<S>)                  \
  FCL_CCD_INSTANTIATE(OBB<S>)                   \
  FCL_CCD_INSTANTIATE(RSS<S>)                   \
  FCL_CCD_INSTANTIATE(OBBRSS<S>)                \
  FCL_CCD_INSTANTIATE(kIOS<S>)                  \
  FCL_CCD_INSTANTIATE(KDOP<S FCL_CCD_COMMA 16>) \
  FCL_CCD_INSTANTIATE(KDOP<S FCL_CCD_COMMA 18>) \
  FCL_CCD_INSTANTIATE(KDOP<S FCL_CCD_COMMA 24>)
FCL_CCD_INSTANTIATE_ALL(double)
FCL_CCD_INSTANTIATE_ALL(float)
#undef FCL_CCD_INSTANTIATE_ALL
#undef FCL_CCD_INSTANTIATE
#undef FCL_CCD_COMMA

}  // namespace detail
}  // namespace fcl

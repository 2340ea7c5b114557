// SPDX-License-Identifier: BSD-3-Clause
//
// The models that the library has: of each of FCL's bounding volumes, in both scalars.
// Their members are defined in two files, each of which compiles its own.
#ifndef FCL_CCD_API_MODEL_INSTANCES_H
#define FCL_CCD_API_MODEL_INSTANCES_H

#define FCL_CCD_INSTANTIATE_MODELS_IN(S)          \
  template class DeformableBVHModel<AABB<S>>;     \
  template class DeformableBVHModel<OBB<S>>;      \
  template class DeformableBVHModel<RSS<S>>;      \
  template class DeformableBVHModel<kIOS<S>>;     \
  template class DeformableBVHModel<OBBRSS<S>>;   \
  template class DeformableBVHModel<KDOP<S, 16>>; \
  template class DeformableBVHModel<KDOP<S, 18>>; \
  template class DeformableBVHModel<KDOP<S, 24>>;

#define FCL_CCD_INSTANTIATE_MODELS      \
  FCL_CCD_INSTANTIATE_MODELS_IN(double) \
  FCL_CCD_INSTANTIATE_MODELS_IN(float)

#endif

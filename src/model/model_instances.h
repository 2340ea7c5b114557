// SPDX-License-Identifier: BSD-3-Clause
//
// The models that the library has: one for each of FCL's bounding volumes, in both
// scalars. FCL's part of them is compiled once, in fcl_models.cpp, since libfcl has only
// some of it, in double. The members of this library's class are defined in two files.
// Each file compiles those that it defines.
#ifndef FCL_CCD_MODEL_MODEL_INSTANCES_H
#define FCL_CCD_MODEL_MODEL_INSTANCES_H

#include <vector>

#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"

/// Calls DO(S, BV) for each model. The name of a KDOP contains a comma, so that the
/// preprocessor takes it for two arguments: DO accepts any number of them.
#define FCL_CCD_FOR_VOLUMES_IN(S, DO) \
  DO(S, AABB<S>)                      \
  DO(S, OBB<S>)                       \
  DO(S, RSS<S>)                       \
  DO(S, kIOS<S>)                      \
  DO(S, OBBRSS<S>)                    \
  DO(S, KDOP<S, 16>)                  \
  DO(S, KDOP<S, 18>)                  \
  DO(S, KDOP<S, 24>)
#define FCL_CCD_FOR_VOLUMES(DO)      \
  FCL_CCD_FOR_VOLUMES_IN(double, DO) \
  FCL_CCD_FOR_VOLUMES_IN(float, DO)

#define FCL_CCD_INSTANTIATE_MODEL(S, ...) template class DeformableBVHModel<__VA_ARGS__>;

/// The members of FCL's model that are used. The whole class does not compile.
#define FCL_CCD_MEMBERS_OF_FCL(TEMPLATE, S, ...)                                        \
  TEMPLATE class detail::BVFitter<__VA_ARGS__>;                                         \
  TEMPLATE class detail::BVSplitter<__VA_ARGS__>;                                       \
  TEMPLATE BVHModel<__VA_ARGS__>::BVHModel();                                           \
  TEMPLATE BVHModel<__VA_ARGS__>::BVHModel(const BVHModel<__VA_ARGS__>&);               \
  TEMPLATE BVHModel<__VA_ARGS__>::~BVHModel();                                          \
  TEMPLATE int BVHModel<__VA_ARGS__>::beginModel(int, int);                             \
  TEMPLATE int BVHModel<__VA_ARGS__>::addVertex(const Vector3<S>&);                     \
  TEMPLATE int BVHModel<__VA_ARGS__>::addTriangle(const Vector3<S>&, const Vector3<S>&, \
                                                  const Vector3<S>&);                   \
  TEMPLATE int BVHModel<__VA_ARGS__>::addSubModel(const std::vector<Vector3<S>>&);      \
  TEMPLATE int BVHModel<__VA_ARGS__>::addSubModel(const std::vector<Vector3<S>>&,       \
                                                  const std::vector<Triangle>&);        \
  TEMPLATE int BVHModel<__VA_ARGS__>::endModel();                                       \
  TEMPLATE int BVHModel<__VA_ARGS__>::beginUpdateModel();                               \
  TEMPLATE int BVHModel<__VA_ARGS__>::updateSubModel(const std::vector<Vector3<S>>&);   \
  TEMPLATE int BVHModel<__VA_ARGS__>::endUpdateModel(bool, bool);                       \
  TEMPLATE int BVHModel<__VA_ARGS__>::buildTree();                                      \
  TEMPLATE int BVHModel<__VA_ARGS__>::refitTree(bool);                                  \
  TEMPLATE NODE_TYPE BVHModel<__VA_ARGS__>::getNodeType() const;                        \
  TEMPLATE void BVHModel<__VA_ARGS__>::computeLocalAABB();                              \
  TEMPLATE Vector3<S> BVHModel<__VA_ARGS__>::computeCOM() const;                        \
  TEMPLATE S BVHModel<__VA_ARGS__>::computeVolume() const;                              \
  TEMPLATE Matrix3<S> BVHModel<__VA_ARGS__>::computeMomentofInertia() const;

#define FCL_CCD_INSTANTIATE_FCL(S, ...) FCL_CCD_MEMBERS_OF_FCL(template, S, __VA_ARGS__)
#define FCL_CCD_DECLARE_FCL(S, ...) \
  FCL_CCD_MEMBERS_OF_FCL(extern template, S, __VA_ARGS__)

namespace fcl {
FCL_CCD_FOR_VOLUMES(FCL_CCD_DECLARE_FCL)
}  // namespace fcl

#endif

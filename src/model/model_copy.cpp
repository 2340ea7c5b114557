// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "fcl/narrowphase/detail/query_numbers.h"
#include "model/model_instances.h"

namespace fcl {
namespace detail {
namespace {

template <typename BV>
std::shared_ptr<const CollisionGeometry<typename BV::S>> copyAs(
    const CollisionGeometry<typename BV::S>& o) {
  auto copy = std::make_shared<BVHModel<BV>>(static_cast<const BVHModel<BV>&>(o));
  copy->bv_splitter = std::make_shared<BVSplitter<BV>>(SPLIT_METHOD_MEAN);
  copy->bv_fitter = std::make_shared<BVFitter<BV>>();
  return copy;
}

}  // namespace

template <typename S>
std::shared_ptr<const CollisionGeometry<S>> copyModel(const CollisionGeometry<S>& o) {
  switch (o.getNodeType()) {
    case BV_AABB:
      return copyAs<AABB<S>>(o);
    case BV_OBB:
      return copyAs<OBB<S>>(o);
    case BV_RSS:
      return copyAs<RSS<S>>(o);
    case BV_kIOS:
      return copyAs<kIOS<S>>(o);
    case BV_OBBRSS:
      return copyAs<OBBRSS<S>>(o);
    case BV_KDOP16:
      return copyAs<KDOP<S, 16>>(o);
    case BV_KDOP18:
      return copyAs<KDOP<S, 18>>(o);
    case BV_KDOP24:
      return copyAs<KDOP<S, 24>>(o);
    default:
      return {std::shared_ptr<const CollisionGeometry<S>>(), &o};
  }
}

template std::shared_ptr<const CollisionGeometry<double>> copyModel(
    const CollisionGeometry<double>& o);
template std::shared_ptr<const CollisionGeometry<float>> copyModel(
    const CollisionGeometry<float>& o);

}  // namespace detail
}  // namespace fcl

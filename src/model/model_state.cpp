// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>

#include "fcl/geometry/bvh/deformable_bvh_model.h"

namespace fcl {
namespace detail {

bool ModelArrays::operator==(const ModelArrays& other) const {
  return vertices == other.vertices && prev_vertices == other.prev_vertices &&
         tri_indices == other.tri_indices && num_vertices == other.num_vertices &&
         num_tris == other.num_tris && build_state == other.build_state;
}

// Every change through the base class leaves other arrays or another state. An update
// ends in the UPDATED state, a replacement deletes prev_vertices, and a rebuild does both
// or changes the sizes. A change after an update that failed leaves another state than
// UPDATE_BEGUN.
ModelState::Phase ModelState::phase(const ModelArrays& now) const {
  if (made_ == Made::kTree && made_for_ == now) return Phase::kInStep;
  switch (now.build_state) {
    case BVH_BUILD_STATE_UPDATE_BEGUN:
      return made_ == Made::kHalfATree ? Phase::kHalfUpdated : Phase::kUnbuilt;
    case BVH_BUILD_STATE_BEGUN:
      return made_ == Made::kNothing ? Phase::kUnbuilt : Phase::kGrown;
    case BVH_BUILD_STATE_PROCESSED:
    case BVH_BUILD_STATE_UPDATED:
      return now.vertices && now.num_tris > 0 ? Phase::kChangedThroughBase
                                              : Phase::kUnbuilt;
    default:
      return Phase::kUnbuilt;
  }
}

bool ModelState::isPreviousShort(const ModelArrays& now) const {
  return now.prev_vertices && made_for_.prev_vertices == now.prev_vertices &&
         made_for_.num_vertices < now.num_vertices;
}

ModelState ModelState::ofCopy(const ModelArrays& now, const ModelArrays& copied) const {
  ModelState copy = *this;
  const bool is_in_step = phase(now) == Phase::kInStep;
  copy.made_for_ = is_in_step ? copied : ModelArrays{};
  if (made_ == Made::kTree && !is_in_step) copy.made_ = Made::kNothing;
  copy.opened_on_ = opened_on_ == now ? copied : ModelArrays{};
  assert((copy.phase(copied) == Phase::kInStep) == is_in_step);
  return copy;
}

void ModelState::beginUpdate(OpenUpdate what, const ModelArrays& now) {
  assert(what != OpenUpdate::kNone);
  open_ = what;
  opened_on_ = now;
}

bool ModelState::endUpdate(const ModelArrays& now) {
  assert(open_ != OpenUpdate::kNone);
  open_ = OpenUpdate::kNone;
  return opened_on_ == now;
}

void ModelState::beginBuild() {
  open_ = OpenUpdate::kNone;
  // No built model has this state.
  made_for_.build_state = BVH_BUILD_STATE_EMPTY;
}

void ModelState::beginChange() { made_ = Made::kHalfATree; }

void ModelState::setPrevious(const ModelArrays& now) {
  assert(made_ != Made::kTree || !(made_for_ == now));
  assert(now.prev_vertices && now.prev_vertices != now.vertices && now.num_vertices > 0);
  made_for_.prev_vertices = now.prev_vertices;
  made_for_.num_vertices = now.num_vertices;
}

void ModelState::setCurrent(const ModelArrays& now) {
  assert(made_ == Made::kTree);
  made_for_.vertices = now.vertices;
}

BVHBuildState ModelState::builtState() const {
  return fcl_tree_ == FclTreeIs::kMissing ? BVH_BUILD_STATE_BEGUN
                                          : BVH_BUILD_STATE_PROCESSED;
}

void ModelState::seal(const ModelArrays& now) {
  assert(now.vertices && now.prev_vertices && now.num_vertices > 0);
  assert(now.tri_indices || now.num_tris == 0);
  assert(now.build_state == builtState());
  assert(now.vertices != now.prev_vertices);
  made_ = Made::kTree;
  made_for_ = now;
}

}  // namespace detail
}  // namespace fcl

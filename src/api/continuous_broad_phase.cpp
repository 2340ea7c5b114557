// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_set>

#include "api/meeting_query.h"
#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "broadphase/broad_phase.h"
#include "fcl/broadphase/detail/pair_answers.h"
#include "fcl/broadphase/swept_collision_object.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "prepare/object_bounds.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {

using deformable::BoundsList;
using deformable::BroadPhase;
using deformable::DefaultFloatingPoint;
using deformable::MeetingObjects;
using deformable::MeetingQuery;
using deformable::NearestQuery;
using deformable::NearObjects;

template <typename S>
class ContinuousBroadPhase<S>::Boxes : public BroadPhase {
 public:
  /// What the last change read. Its memory is used again.
  BoundsList read;
  /// DeformableMesh::lastRevision() when all objects were found to be up to date.
  std::atomic<std::uint64_t> up_to_date{0};
};

namespace {

void prefetchNothing(const void*) {}

/// The bounds of objects. An error names the object by its place in the list.
/// @param prefetch  called for an object some time after its own memory was asked for
template <typename S, typename Read>
void readBounds(void* const* objects, std::size_t count, Read read,
                void (*prefetch)(const void*), BoundsList& bounds) {
  constexpr std::size_t kAheadOfObjects = 12, kAheadOfMotions = 6, kLine = 64;
  bounds.clear();
  bounds.items.reserve(count);
  bounds.boxes.reserve(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAheadOfObjects < count) {
      const auto* object = static_cast<const char*>(objects[i + kAheadOfObjects]);
      deformable::prefetchMemory(object);
      deformable::prefetchMemory(object + kLine);
    }
    if (i + kAheadOfMotions < count) prefetch(objects[i + kAheadOfMotions]);
    try {
      appendBounds<S>(read(objects[i]), bounds);
    } catch (const Exception& error) {
      if (count == 1) throw;
      throw Exception(std::string(error.what()) + " (object " + std::to_string(i) +
                      " of the list)");
    }
    assert(bounds.items.size() == i + 1);
  }
}

std::vector<BroadPhasePair> toPairs(const std::vector<MeetingObjects>& meeting) {
  std::vector<BroadPhasePair> pairs;
  pairs.reserve(meeting.size());
  for (const MeetingObjects& pair : meeting) {
    assert(!pair.window.isEmpty());
    pairs.push_back({pair.window.lo, pair.window.hi, pair.o1, pair.o2});
  }
  return pairs;
}

NearestQuery nearestQueryOf(const NearestSettings& settings) {
  NearestQuery query;
  query.latest = settings.t_max;
  query.limit = settings.limit;
  query.visit = [&settings](const NearObjects& pair) {
    return settings.visit({pair.distance, pair.o1, pair.o2});
  };
  return query;
}

void requireRegistered(const BroadPhase& boxes, const void* object) {
  if (!boxes.contains(object))
    throw Exception(
        "the object is not registered in this manager. Call registerObject() first");
}

}  // namespace

template <typename S>
ContinuousBroadPhase<S>::ContinuousBroadPhase() : boxes_(new Boxes) {}

template <typename S>
ContinuousBroadPhase<S>::~ContinuousBroadPhase() = default;

template <typename S>
void ContinuousBroadPhase<S>::insert(void* const* objects, std::size_t count, Read read,
                                     Prefetch prefetch) {
  const DefaultFloatingPoint mode;
  std::unordered_set<const void*> seen;
  for (std::size_t i = 0; i < count; ++i)
    if (boxes_->contains(objects[i]) || !seen.insert(objects[i]).second)
      throw Exception("object " + std::to_string(i) +
                      " of the list is registered already, or twice in the list. After a "
                      "change call update()");
  readBounds<S>(objects, count, read, prefetch, boxes_->read);
  boxes_->insert(objects, boxes_->read);
}

template <typename S>
void ContinuousBroadPhase<S>::update(void* const* objects, std::size_t count, Read read,
                                     Prefetch prefetch) {
  const DefaultFloatingPoint mode;
  const std::vector<std::int32_t> slots = boxes_->find(objects, count);
  const auto missing = std::find(slots.begin(), slots.end(), -1);
  if (missing != slots.end())
    requireRegistered(*boxes_, objects[missing - slots.begin()]);
  readBounds<S>(objects, count, read, prefetch, boxes_->read);
  boxes_->update(slots, boxes_->read);
}

template <typename S>
void ContinuousBroadPhase<S>::remove(const void* object) {
  requireRegistered(*boxes_, object);
  boxes_->remove(object);
}

template <typename S>
void ContinuousBroadPhase<S>::rebuild() {
  boxes_->rebuild();
}

template <typename S>
void ContinuousBroadPhase<S>::clear() {
  boxes_->clear();
}

template <typename S>
void ContinuousBroadPhase<S>::setFilter(const void* object, std::uint32_t group,
                                        std::uint32_t mask) {
  requireRegistered(*boxes_, object);
  boxes_->setFilter(object, {group, mask});
}

template <typename S>
void ContinuousBroadPhase<S>::setSelf(const void* object, bool self) {
  requireRegistered(*boxes_, object);
  boxes_->setSelf(object, self);
}

template <typename S>
void ContinuousBroadPhase<S>::setMargin(const void* object, double margin) {
  requireRegistered(*boxes_, object);
  boxes_->setMargin(object, margin);
}

template <typename S>
std::size_t ContinuousBroadPhase<S>::size() const {
  return boxes_->size();
}

template <typename S>
bool ContinuousBroadPhase<S>::contains(const void* object) const {
  return boxes_->contains(object);
}

template <typename S>
std::vector<void*> ContinuousBroadPhase<S>::objects() const {
  return boxes_->objects();
}

template <typename S>
void ContinuousBroadPhase<S>::requireUpToDate(const void* except) const {
  const std::uint64_t last = DeformableMesh::lastRevision();
  if (boxes_->up_to_date == last) return;
  if (const void* changed = boxes_->findChanged(except)) {
    const std::vector<void*> all = objects();
    throw Exception(
        "object " +
        std::to_string(std::find(all.begin(), all.end(), changed) - all.begin()) +
        ": its mesh was changed after the manager had read it. Call "
        "update() after a change");
  }
  if (!except) boxes_->up_to_date = last;
}

template <typename S>
const BroadPhase& ContinuousBroadPhase<S>::boxes() const {
  return *boxes_;
}

template <typename S>
StepBox ContinuousBroadPhase<S>::stepBox(const void* object, Read read) {
  const DefaultFloatingPoint mode;
  BoundsList list;
  appendBounds<S>(read(object), list);
  StepBox out;
  for (int k = 0; k < 3; ++k) {
    double below = list.boxes.front().half[k], above = list.boxes.front().half[k + 3];
    for (const deformable::HalfAxisBox& box : list.boxes) {
      below = std::max(below, box.half[k]);
      above = std::max(above, box.half[k + 3]);
    }
    // Each side moves outward by one unit in the last place of S, which covers the
    // rounding to S.
    const auto step = [](double x, double to) {
      const S rounded = static_cast<S>(x);
      return static_cast<double>(std::nextafter(rounded, static_cast<S>(to)));
    };
    out.lower[k] = step(-below, -HUGE_VAL);
    out.upper[k] = step(above, HUGE_VAL);
    assert(out.lower[k] <= -below && above <= out.upper[k]);
    assert(out.lower[k] <= out.upper[k]);
  }
  return out;
}

template <typename S>
std::vector<BroadPhasePair> ContinuousBroadPhase<S>::pairs(
    const BroadPhaseSettings& settings) const {
  const DefaultFloatingPoint mode;
  requireUpToDate();
  return toPairs(boxes_->pairs(meetingQueryOf(settings)));
}

template <typename S>
std::vector<BroadPhasePair> ContinuousBroadPhase<S>::pairsOf(
    void* object, Read read, const BroadPhaseSettings& settings) const {
  const DefaultFloatingPoint mode;
  requireUpToDate(object);
  const MeetingQuery query = meetingQueryOf(settings);
  BoundsList bounds;
  readBounds<S>(&object, 1, read, &prefetchNothing, bounds);
  return toPairs(boxes_->pairsOf(object, bounds.at(0), query));
}

template <typename S>
std::vector<BroadPhasePair> ContinuousBroadPhase<S>::pairsWith(
    const ContinuousBroadPhase& other, const BroadPhaseSettings& settings) const {
  const DefaultFloatingPoint mode;
  requireUpToDate();
  other.requireUpToDate();
  return toPairs(boxes_->pairsWith(*other.boxes_, meetingQueryOf(settings)));
}

template <typename S>
void ContinuousBroadPhase<S>::visitNearest(const NearestSettings& settings) const {
  const DefaultFloatingPoint mode;
  requireUpToDate();
  boxes_->visitNearest(nearestQueryOf(settings));
}

template <typename S>
void ContinuousBroadPhase<S>::visitNearestOf(void* object, Read read,
                                             const NearestSettings& settings) const {
  const DefaultFloatingPoint mode;
  requireUpToDate(object);
  BoundsList bounds;
  readBounds<S>(&object, 1, read, &prefetchNothing, bounds);
  boxes_->visitNearestOf(object, bounds.at(0), nearestQueryOf(settings));
}

template <typename S>
void ContinuousBroadPhase<S>::visitNearestWith(const ContinuousBroadPhase& other,
                                               const NearestSettings& settings) const {
  const DefaultFloatingPoint mode;
  requireUpToDate();
  other.requireUpToDate();
  boxes_->visitNearestWith(*other.boxes_, nearestQueryOf(settings));
}

void visitInThreads(std::size_t count, int num_threads,
                    const std::function<void(std::size_t)>& visit) {
  deformable::parallelFor(count, num_threads, visit);
}

template <typename S>
bool areStraightMeshes(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2) {
  const DefaultFloatingPoint mode;
  const auto isStraight = [](const MovingGeometry<S>& o) {
    const PlacedGeometry<S> placed(o);
    return placed.isMesh() && placed.goesStraight();
  };
  return isStraight(o1) && isStraight(o2);
}

#define FCL_CCD_INSTANTIATE(S)            \
  template class ContinuousBroadPhase<S>; \
  template bool areStraightMeshes(const MovingGeometry<S>&, const MovingGeometry<S>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/prepared_shapes.h"

#include <utility>

#include "curved/overlap_at_start.h"
#include "prepare/convex_shapes.h"
#include "prepare/query_range.h"

namespace fcl {
namespace detail {
namespace {

using deformable::ConvexShape;
using deformable::convexShapeOf;

/// "o1" or "o2", for errors.
const char* nameOf(int k) { return k == 0 ? "o1" : "o2"; }

/// Whether the path of a shape begins in its first pose as it is given, and nothing about
/// the path has to be checked but its size.
template <typename S>
bool beginsAsGiven(const PlacedGeometry<S>& o) {
  if (!o.isShape() || !o.areRotations() || o.hasReplacedRotation()) return false;
  const MovingGeometry<S>& moving = o.moving();
  if (moving.path == PathKind::kTurn)
    return moving.reference[0] == 0 && moving.reference[1] == 0 &&
           moving.reference[2] == 0;
  return moving.path == PathKind::kStraight || moving.path == PathKind::kScrew;
}

}  // namespace

/// @param first  the one that is checked first
/// @param[out] shapes  those that were converted
template <typename S>
bool PreparedShapes::areFoundToOverlap(const PlacedGeometry<S>* const (&object)[2],
                                       int first, Shapes& shapes) {
  for (const auto* o : object)
    if (!beginsAsGiven(*o)) return false;
  for (const int k : {first, 1 - first}) {
    shapes[k].emplace(convexShapeOf(object[k]->geometry(), nameOf(k), 0));
    // PreparedMotion refuses some of the others.
    if (!isWellInRange(*object[k], *shapes[k])) return false;
  }
  return deformable::overlapDeeplyAtStart(*shapes[0], object[0]->beginning(), *shapes[1],
                                          object[1]->beginning());
}

/// Makes the bodies.
template <typename S>
void PreparedShapes::prepare(const PlacedGeometry<S>* const (&object)[2], int first,
                             Shapes& shapes) {
  double other_radius = 0;
  for (const int k : {first, 1 - first}) {
    motion_[k].emplace(*object[k], nameOf(k), options_.toc_err, options_.num_threads,
                       other_radius, scale_, std::move(shapes[k]));
    if (motion_[k]->isEmpty())
      are_empty_ = true;
    else
      other_radius = motion_[k]->body().size();
  }
}

template <typename S>
PreparedShapes::PreparedShapes(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                               const deformable::QueryOptions& options)
    : options_(options) {
  const PlacedGeometry<S>* const object[2] = {&o1, &o2};
  // The part of an unbounded shape that matters depends on the other object.
  const int first = deformable::isUnbounded(o1.geometry()) ? 1 : 0;
  Shapes shapes;
  overlap_at_start_ = options.only_time && areFoundToOverlap(object, first, shapes);
  if (overlap_at_start_) return;
  prepare(object, first, shapes);
  if (are_empty_) return;
  scale_ =
      scaleOf(o1.moving(), *motion_[0], o2.moving(), *motion_[1], options.min_distance);
  if (scale_ == 1) return;
  options_.min_distance *= scale_;
  for (const int k : {0, 1}) shapes[k].emplace(*motion_[k]->body().shape());
  const MovingGeometry<S> moving1 = scaledPath(o1.moving(), scale_),
                          moving2 = scaledPath(o2.moving(), scale_);
  const PlacedGeometry<S> scaled1(moving1), scaled2(moving2);
  prepare<S>({&scaled1, &scaled2}, first, shapes);
}

void PreparedShapes::unscale(deformable::QueryAnswer& answer) const {
  if (scale_ == 1) return;
  for (auto& contact : answer.shape_contacts)
    contact.position = (1 / scale_) * contact.position;
}

double PreparedShapes::updateTime() const {
  return motion_[0]->updateTime() + motion_[1]->updateTime();
}

template PreparedShapes::PreparedShapes(const PlacedGeometry<double>&,
                                        const PlacedGeometry<double>&,
                                        const deformable::QueryOptions&);
template PreparedShapes::PreparedShapes(const PlacedGeometry<float>&,
                                        const PlacedGeometry<float>&,
                                        const deformable::QueryOptions&);

}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/geometry/compound_geometry.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/default_floating_point.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "prepare/class_cast.h"
#include "prepare/compound_parts.h"
#include "prepare/object_bounds.h"
#include "prepare/query_arguments.h"
#include "prepare/required_pose.h"

namespace fcl {
namespace detail {
namespace {

using deformable::BodyBox;
using deformable::DefaultFloatingPoint;
using deformable::Pose;
using deformable::vecOf;

/// More than the rounding of a box that is turned and joined with others, in its size.
constexpr double kRounding = 0x1p-44;

/// A box of a part in the frame of the compound.
BodyBox placed(const BodyBox& box, const Pose& offset) {
  BodyBox out = box;
  set(out.center, posed(offset, vecOf(box.center)));
  for (int i = 0; i < 3; ++i)
    set(out.axis[i], rotated(offset.rotation, vecOf(box.axis[i])));
  const double rounding = kRounding * (deformable::norm(box.center) +
                                       deformable::norm(offset.translation) + box.radius);
  out.pad += rounding;
  out.radius += rounding;
  return out;
}

/// Half of the width of a box along a coordinate.
double halfWidth(const BodyBox& box, int k) {
  double half = box.pad;
  for (int i = 0; i < 3; ++i) half += std::abs(box.axis[i][k]) * box.extent[i];
  return half;
}

#ifndef NDEBUG
template <typename Parts>
bool containsAll(const BodyBox& whole, const Parts& parts) {
  return std::all_of(parts.begin(), parts.end(), [&](const auto& part) {
    for (int k = 0; k < 3; ++k) {
      const double half = halfWidth(whole, k), half_of_part = halfWidth(part.box, k);
      if (whole.center[k] - half > part.box.center[k] - half_of_part ||
          whole.center[k] + half < part.box.center[k] + half_of_part)
        return false;
    }
    return true;
  });
}
#endif

/// The least box along the axes of the compound.
template <typename S>
BodyBox boxAround(const std::vector<typename CompoundParts<S>::Part>& parts) {
  BodyBox out{};
  for (int k = 0; k < 3; ++k) {
    double lower = HUGE_VAL, upper = -HUGE_VAL;
    for (const auto& part : parts) {
      const double half = halfWidth(part.box, k);
      lower = std::min(lower, part.box.center[k] - half);
      upper = std::max(upper, part.box.center[k] + half);
    }
    out.center[k] = 0.5 * (lower + upper);
    out.extent[k] = 0.5 * (upper - lower);
    out.axis[k][k] = 1;
  }
  const double size = deformable::norm(out.extent);
  out.pad = kRounding * (deformable::norm(out.center) + size);
  out.radius = (size + out.pad) * deformable::kUpward;
  assert(containsAll(out, parts));
  return out;
}

std::string nameOfPart(std::size_t number) {
  return "part " + std::to_string(number) + " of a CompoundGeometry";
}

template <typename S>
typename CompoundParts<S>::Part readPart(
    const std::shared_ptr<const CollisionGeometry<S>>& geometry, const Pose& offset,
    const std::string& name) {
  require(geometry.get(), (name + ": the geometry").c_str());
  if (compoundPartsOf(*geometry))
    throw Exception(name +
                    " is a compound too. Add its parts, with the products of both "
                    "offsets");
  requireRigidPart(*geometry, name);
  const MovingGeometry<S> moving = unmoved(geometry.get());
  const PlacedGeometry<S> at_rest(moving);
  if (!at_rest.isKnown())
    throw Exception(name + " is " + kindOf(*geometry) +
                    ", not a triangle mesh, a shape or an octree. Give one of these");
  const DeformableMesh* model = deformable::meshClassOf(*geometry).model;
  typename CompoundParts<S>::Part part{
      geometry, offset, isBounded(at_rest),
      {},       model,  model ? model->revision()->load() : 0};
  if (part.has_box)
    part.box = placed(boundedBodyOf(at_rest, name.c_str()).box[0], offset);
  else
    deformable::convexShapeOf(*geometry, name, 0);  // refuses a normal of length 0
  return part;
}

template <typename S>
std::shared_ptr<const CompoundParts<S>> joined(
    std::vector<typename CompoundParts<S>::Part> parts) {
  auto out = std::make_shared<CompoundParts<S>>();
  out->has_box = std::all_of(parts.begin(), parts.end(),
                             [](const auto& part) { return part.has_box; });
  if (out->has_box && !parts.empty()) out->box = boxAround<S>(parts);
  out->parts = std::move(parts);
  return out;
}

template <typename S>
const typename CompoundParts<S>::Part& partOf(const CompoundParts<S>& parts, int number) {
  if (number < 0 || static_cast<std::size_t>(number) >= parts.parts.size())
    throw Exception("CompoundGeometry: there is no part " + std::to_string(number) +
                    ". It has " + std::to_string(parts.parts.size()) + " parts");
  return parts.parts[static_cast<std::size_t>(number)];
}

}  // namespace

// FCL calls each shape OT_GEOM, and none BV_UNKNOWN.
template <typename S>
const CompoundParts<S>* compoundPartsOf(const CollisionGeometry<S>& o) {
  if (o.getObjectType() != OT_GEOM || o.getNodeType() != BV_UNKNOWN) return nullptr;
  const auto* compound = classCast<CompoundGeometry<S>>(o);
  return compound ? &compound->parts() : nullptr;
}

template <typename S>
void requireParts(const CompoundParts<S>& compound, const std::string& name) {
  if (compound.parts.empty())
    throw Exception(name + " is a compound without parts. Call addPart() first");
  // Also of parts that are far: a box that was read before a mesh deformed may be wrong.
  for (std::size_t i = 0; i < compound.parts.size(); ++i) {
    const auto& part = compound.parts[i];
    if (part.geometry->getObjectType() != OT_BVH) continue;
    const deformable::MeshClass mesh = deformable::meshClassOf(*part.geometry);
    if (mesh.kind == deformable::MeshKind::kDeforming)
      requireRigidPart(*part.geometry, nameOfPart(i) + ", " + name + ",");
    if (mesh.model != part.model ||
        (mesh.model && *mesh.model->revision() != part.revision))
      throw Exception(nameOfPart(i) + ", " + name +
                      ", is a mesh that was changed after the compound had read it. Call "
                      "update() of the compound");
  }
}

template <typename S>
void requireRigidPart(const CollisionGeometry<S>& part, const std::string& name) {
  if (deformable::meshKindOf(part) == deformable::MeshKind::kDeforming)
    throw Exception(name +
                    " is a mesh that deforms, and parts of a compound are rigid. Make it "
                    "an object of its own, or set both of its frames to one");
}

template const CompoundParts<double>* compoundPartsOf(const CollisionGeometry<double>&);
template const CompoundParts<float>* compoundPartsOf(const CollisionGeometry<float>&);
template void requireParts(const CompoundParts<double>&, const std::string&);
template void requireParts(const CompoundParts<float>&, const std::string&);
template void requireRigidPart(const CollisionGeometry<double>&, const std::string&);
template void requireRigidPart(const CollisionGeometry<float>&, const std::string&);

}  // namespace detail

template <typename S>
CompoundGeometry<S>::CompoundGeometry() : parts_(detail::joined<S>({})) {}
template <typename S>
CompoundGeometry<S>::CompoundGeometry(const CompoundGeometry& other) = default;
template <typename S>
CompoundGeometry<S>& CompoundGeometry<S>::operator=(const CompoundGeometry& other) =
    default;
template <typename S>
CompoundGeometry<S>::~CompoundGeometry() = default;

template <typename S>
int CompoundGeometry<S>::addPlaced(const Geometry& geometry,
                                   const BoundedMotion::Placement& offset) {
  const detail::DefaultFloatingPoint mode;
  auto parts = parts_->parts;
  const std::string name = detail::nameOfPart(parts.size());
  parts.push_back(detail::readPart<S>(
      geometry, detail::requirePose(offset, name + ": its offset"), name));
  parts_ = detail::joined<S>(std::move(parts));
  computeLocalAABB();
  return numParts() - 1;
}

template <typename S>
void CompoundGeometry<S>::update() {
  const detail::DefaultFloatingPoint mode;
  std::vector<typename detail::CompoundParts<S>::Part> parts;
  for (const auto& part : parts_->parts)
    parts.push_back(detail::readPart<S>(part.geometry, part.offset,
                                        detail::nameOfPart(parts.size())));
  parts_ = detail::joined<S>(std::move(parts));
  computeLocalAABB();
}

template <typename S>
int CompoundGeometry<S>::numParts() const {
  return static_cast<int>(parts_->parts.size());
}

template <typename S>
const typename CompoundGeometry<S>::Geometry& CompoundGeometry<S>::part(
    int number) const {
  return detail::partOf(*parts_, number).geometry;
}

template <typename S>
BoundedMotion::Placement CompoundGeometry<S>::offset(int number) const {
  const detail::Pose& pose = detail::partOf(*parts_, number).offset;
  BoundedMotion::Placement out;
  std::copy(pose.rotation, pose.rotation + 9, out.rotation);
  std::copy(pose.translation, pose.translation + 3, out.translation);
  return out;
}

template <typename S>
OBJECT_TYPE CompoundGeometry<S>::getObjectType() const {
  return OT_GEOM;
}

template <typename S>
NODE_TYPE CompoundGeometry<S>::getNodeType() const {
  return BV_UNKNOWN;
}

template <typename S>
void CompoundGeometry<S>::computeLocalAABB() {
  constexpr S kMost = std::numeric_limits<S>::max();
  const detail::deformable::BodyBox& box = parts_->box;
  for (int k = 0; k < 3; ++k) {
    const double half = detail::halfWidth(box, k);
    // Each side moves outward, which covers the rounding to S.
    this->aabb_local.min_[k] =
        parts_->has_box ? std::nextafter(static_cast<S>(box.center[k] - half), -kMost)
                        : -kMost;
    this->aabb_local.max_[k] =
        parts_->has_box ? std::nextafter(static_cast<S>(box.center[k] + half), kMost)
                        : kMost;
  }
  this->aabb_center = this->aabb_local.center();
  this->aabb_radius = (this->aabb_local.min_ - this->aabb_center).norm();
}

template class CompoundGeometry<double>;
template class CompoundGeometry<float>;

}  // namespace fcl

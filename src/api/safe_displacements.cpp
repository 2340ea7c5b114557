// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/safe_displacements.h"

#include <cmath>
#include <string>
#include <utility>

#include "base/default_floating_point.h"
#include "fcl/common/exception.h"
#include "prepare/prepared_mesh.h"
#include "prepare/query_arguments.h"
#include "query/safe_displacement.h"

namespace fcl {
namespace detail {
namespace {

using deformable::FeatureOwners;
using deformable::PreparedMesh;

void requireLengths(double max_displacement, double min_distance) {
  if (!(max_displacement > 0) || !std::isfinite(max_displacement))
    throw Exception(
        "max_displacement is not above 0 or not finite. Give the largest displacement "
        "that is of use, in the unit of the coordinates");
  requireDistance(min_distance, "min_distance");
}

}  // namespace

template <typename S>
void findSafeDisplacements(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                           double max_displacement, double min_distance,
                           SafeDisplacements& bounds) {
  require(o1.geometry, "o1");
  require(o2.geometry, "o2");
  requireLengths(max_displacement, min_distance);
  requireMesh(*o1.geometry, "safeDisplacements", "o1");
  requireMesh(*o2.geometry, "safeDisplacements", "o2");
  const deformable::DefaultFloatingPoint mode;
  const auto prepared = [](const MovingGeometry<S>& o, const char* name) {
    const deformable::Pose pose = toPose(o.pose[1]);
    deformable::requireFinite(pose, pose, name);
    return PreparedMesh(*o.geometry, pose, pose, name, 1, FeatureOwners::kAlways);
  };
  const PreparedMesh mesh1 = prepared(o1, "o1"), mesh2 = prepared(o2, "o2");
  SafeDisplacements found;
  found.of_o1.assign(mesh1.instance().frames.size(), max_displacement);
  found.of_o2.assign(mesh2.instance().frames.size(), max_displacement);
  answerOf([&] {
    lowerToSafe(mesh1.instance(), mesh2.instance(), min_distance, max_displacement,
                found.of_o1, found.of_o2);
  });
  bounds = std::move(found);
}

template <typename S>
void findSafeSelfDisplacements(const CollisionGeometry<S>* o, double max_displacement,
                               double min_distance, std::vector<double>& bounds) {
  require(o, "o");
  requireLengths(max_displacement, min_distance);
  requireMesh(*o, "safeSelfDisplacements");
  const deformable::DefaultFloatingPoint mode;
  const PreparedMesh mesh(*o, {}, {}, "o", 1, FeatureOwners::kAlways);
  std::vector<double> found(mesh.instance().frames.size(), max_displacement);
  answerOf([&] {
    lowerToSafe(mesh.instance(), mesh.instance(), min_distance, max_displacement, found,
                found);
  });
  bounds = std::move(found);
}

#define FCL_CCD_INSTANTIATE(S)                                                         \
  template void findSafeDisplacements(const MovingGeometry<S>&,                        \
                                      const MovingGeometry<S>&, double, double,        \
                                      SafeDisplacements&);                             \
  template void findSafeSelfDisplacements(const CollisionGeometry<S>*, double, double, \
                                          std::vector<double>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/posed_flat.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "fcl/common/exception.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "paths/posed_vector.h"
#include "prepare/prepared_motion.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

template <typename Shape>
PosedFlat flatOf(const Shape& shape, const Pose& beginning, const Pose& end) {
  const Vec n = {static_cast<double>(shape.n[0]), static_cast<double>(shape.n[1]),
                 static_cast<double>(shape.n[2])};
  // The plane through the foot, which a matrix that scales moves.
  const Vec posed_n = rotated(beginning.rotation, n);
  const double posed_length = norm(posed_n),
               offset = static_cast<double>(shape.d) * (posed_length / dot(n, n));
  PosedFlat out{(1 / posed_length) * posed_n, {}, false, false, 0};
  for (int k = 0; k < 2; ++k) {
    const double(&t)[3] = (k == 0 ? beginning : end).translation;
    out.offset[k] = dot(out.normal, vecOf(t)) + offset;
    out.size = std::max(out.size, std::hypot(t[0], t[1], t[2]) + std::abs(offset));
  }
  return out;
}

}  // namespace

template <typename S>
PosedFlat posedFlatOf(const PlacedGeometry<S>& placed, const char* name) {
  requireRotations(placed, name);
  const CollisionGeometry<S>& shape = placed.geometry();
  convexShapeOf(shape, name, 1);
  const bool is_plane = shape.getNodeType() == GEOM_PLANE;
  PosedFlat flat = is_plane ? flatOf(static_cast<const Plane<S>&>(shape),
                                     placed.beginning(), placed.end())
                            : flatOf(static_cast<const Halfspace<S>&>(shape),
                                     placed.beginning(), placed.end());
  // Differences of offsets are finite then.
  constexpr double kMostSize = 0x1p500;
  if (!(flat.size < kMostSize))
    throw Exception(std::string(name) + ": its path has coordinates beyond 2^500. Use " +
                    "larger units of length or a smaller translation");
  flat.is_solid = !is_plane;
  flat.goes_straight = placed.goesStraight();
  return flat;
}

template PosedFlat posedFlatOf(const PlacedGeometry<double>&, const char*);
template PosedFlat posedFlatOf(const PlacedGeometry<float>&, const char*);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

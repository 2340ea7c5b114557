// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/posed_flat.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "fcl/common/exception.h"
#include "paths/posed_vector.h"
#include "prepare/prepared_motion.h"

namespace fcl {
namespace detail {
namespace deformable {

template <typename S>
PosedFlat posedFlatOf(const PlacedGeometry<S>& placed, const char* name) {
  requireRotations(placed, name);
  const ConvexShape shape = convexShapeOf(placed.geometry(), name, 1);
  const FlatShape& flat = *shape.flat();
  // The plane through the foot, which a matrix that scales moves.
  const Vec normal = rotated(placed.beginning().rotation, flat.normal);
  const double length = norm(normal), offset = flat.offset * length;
  PosedFlat out{(1 / length) * normal, {}, flat.is_solid, placed.goesStraight(), 0};
  assert(isUnit(out.normal));
  for (int k = 0; k < 2; ++k) {
    const double(&t)[3] = (k == 0 ? placed.beginning() : placed.end()).translation;
    out.offset[k] = dot(out.normal, vecOf(t)) + offset;
    out.size = std::max(out.size, std::hypot(t[0], t[1], t[2]) + std::abs(offset));
  }
  // Differences of offsets are finite then.
  constexpr double kMostSize = 0x1p500;
  if (!(out.size < kMostSize))
    throw Exception(std::string(name) + ": its path has coordinates beyond 2^500. Use " +
                    "larger units of length or a smaller translation");
  return out;
}

template PosedFlat posedFlatOf(const PlacedGeometry<double>&, const char*);
template PosedFlat posedFlatOf(const PlacedGeometry<float>&, const char*);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

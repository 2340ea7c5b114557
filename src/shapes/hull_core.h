// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_HULL_CORE_H
#define FCL_CCD_SHAPES_HULL_CORE_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "paths/posed_vector.h"
#include "shapes/core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The hull of points, which are its pieces.
struct HullCore : Core {
  /// @pre all points are finite; there is one at least, but for the core of a flat
  explicit HullCore(std::vector<Vec> vertices)
      : Core{{0, 0, 0}}, points(std::move(vertices)) {}

  int pieceAt(const Vec& d) const {
    assert(!points.empty());
    std::size_t farthest = 0;
    double most = dot(points.front(), d);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double along = dot(points[i], d);
      if (!(along > most)) continue;
      most = along;
      farthest = i;
    }
    return static_cast<int>(farthest);
  }
  Vec supportOf(int piece, const Vec&) const {
    assert(0 <= piece && static_cast<std::size_t>(piece) < points.size());
    return points[static_cast<std::size_t>(piece)];
  }
  double reach(const Vec& d) const { return dot(supportOf(pieceAt(d), d), d); }

  CoreBox box() const {
    constexpr Vec kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double center[3], half_side[3];
    for (int i = 0; i < 3; ++i) {
      const double upper = reach(kAxes[i]), lower = -reach(-1. * kAxes[i]);
      assert(lower <= upper);
      center[i] = 0.5 * (upper + lower);
      half_side[i] = 0.5 * (upper - lower);
    }
    return {vecOf(center), vecOf(half_side)};
  }
  /// Whether each corner of the box is a point.
  bool fills(const BodyBox& of) const {
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec p = vecOf(of.center);
      for (unsigned i = 0; i < 3; ++i)
        p = p +
            ((corner >> i & 1U) != 0 ? of.extent[i] : -of.extent[i]) * vecOf(of.axis[i]);
      if (std::none_of(points.begin(), points.end(),
                       [&](const Vec& x) { return norm(x - p) <= of.pad; }))
        return false;
    }
    return true;
  }
  /// The center may be outside.
  bool containsCenter() const { return false; }

  double largestLength() const {
    double most = 0;
    for (const Vec& p : points) most = std::max(most, maxNorm(p));
    return most;
  }
  void scale(double factor) {
    for (Vec& p : points) p = factor * p;
  }

  std::vector<Vec> points;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

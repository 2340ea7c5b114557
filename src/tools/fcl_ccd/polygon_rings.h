// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_POLYGON_RINGS_H
#define FCL_CCD_POLYGON_RINGS_H

#include <array>
#include <cstddef>
#include <vector>

#include "mesh_io.h"

namespace fcl_ccd {

/// @brief Three corners of a polygon, by their places in its list.
using PolygonTriangle = std::array<int, 3>;

/// @brief The position of a corner.
struct CornerPoint {
  double x[3];
};

/// @brief A polygon in the plane as rings of corners, the inside to the left of each
/// edge. (1) Two consecutive corners of a ring are at different places, and so are the
/// two neighbours of a corner. Corners that are against this are removed. Each leaves a
/// triangle without area, so that nothing of the polygon is lost.
/// (2) No edge goes back along another edge between the same vertices: the two are
/// removed. So a face with holes that are cut open has a ring for each hole.
class PolygonRings {
 public:
  /// @param axis, turns_left  see addSweptTriangles()
  PolygonRings(const Vertices& vertices, const std::vector<int>& ids, int axis,
               bool turns_left);

  /// @brief The number of corners that the polygon was given with.
  std::size_t size() const { return points_.size(); }
  /// @brief The corners of all rings.
  std::vector<int> corners() const;
  /// @brief The triangles without area.
  const std::vector<PolygonTriangle>& removed() const { return removed_; }

  int next(int corner) const { return next_[static_cast<std::size_t>(corner)]; }
  int before(int corner) const { return before_[static_cast<std::size_t>(corner)]; }
  const CornerPoint& point(int corner) const {
    return points_[static_cast<std::size_t>(corner)];
  }

  /// @brief Whether a is to the left of b, or straight below it.
  bool isBefore(int a, int b) const {
    const double(&p)[3] = point(a).x, (&q)[3] = point(b).x;
    return p[u_] != q[u_] ? p[u_] < q[u_] : p[v_] < q[v_];
  }
  bool isAtSamePlace(int a, int b) const { return !isBefore(a, b) && !isBefore(b, a); }

  /// @brief 1 if a b c turns to the left, -1 if it turns to the right, else 0. Exact.
  int turn(int a, int b, int c) const;

 private:
  bool isRemoved(int corner) const { return next(corner) < 0; }
  void remove(int corner);
  void removeFrom(std::vector<int> candidates);
  void removePairsOfEdges(const std::vector<int>& ids);

  std::vector<CornerPoint> points_;
  int axis_;
  int sign_;
  std::size_t u_, v_;  ///< the coordinates to the right and upwards
  std::vector<int> next_, before_;
  std::vector<PolygonTriangle> removed_;
};

}  // namespace fcl_ccd

#endif

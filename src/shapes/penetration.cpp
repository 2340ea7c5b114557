// SPDX-License-Identifier: BSD-3-Clause
//
// A translation of b along a unit direction n parts the sets if it is as long as the
// reach of their difference, h(n) = max n . (a - b). The least h(n) is looked for on the
// sphere of directions, which is divided into triangles: cells.
//
// At the corners of a cell the farthest points of the difference are known. In the whole
// cell h is at least the largest n . s of these points s. On the part of a cell where one
// s is the largest, n . s is least at a corner of that part: the directions with n . s >=
// c form a convex cone if c is not negative. So the least value of a cell is that at one
// of a few directions. Where the sets have flat sides, it is exact as soon as the points
// of a side are known.
#include "shapes/penetration.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// A direction, a point of the difference that is farthest along it, and how far it is.
struct Reach {
  Vec direction, point;
  double length;
};

/// A triangle of directions, by the right-hand rule from outside.
struct Cell {
  Reach corner[3];
  /// One more point of the difference, of a direction that was tried inside.
  Vec extra;
  /// The reach along all directions of the cell is at least this.
  double least;
  /// Where the known points reach least.
  Vec where;

  bool operator<(const Cell& other) const { return least > other.least; }

  void setLeast();
};

/// The least of the known points' reach in a cell.
class LeastReach {
 public:
  explicit LeastReach(const Cell& cell)
      : n_{cell.corner[0].direction, cell.corner[1].direction, cell.corner[2].direction} {
    for (const Reach& corner : cell.corner) addPoint(corner.point);
    addPoint(cell.extra);
    for (const Vec& n : n_) tryAt(n);
    for (int i = 0; i < count_; ++i)
      for (int j = 0; j < i; ++j) {
        tryEdges(s_[i] - s_[j]);
        for (int k = 0; k < j; ++k) tryInside(cross(s_[i] - s_[k], s_[j] - s_[k]));
      }
  }

  double value() const { return least_; }
  const Vec& direction() const { return where_; }

  /// A bound that needs less work: along all directions of the cell, each point reaches
  /// at least as far as along the worst corner, if that is not negative.
  static double lowerBound(const Cell& cell) {
    double most = 0;
    for (const Reach& of : cell.corner) {
      double least = HUGE_VAL;
      for (const Reach& along : cell.corner)
        least = std::min(least, dot(along.direction, of.point));
      most = std::max(most, least);
    }
    return most;
  }

 private:
  void addPoint(const Vec& point) {
    for (int i = 0; i < count_; ++i)
      if (maxNorm(s_[i] - point) == 0) return;
    assert(count_ < 4);
    s_[count_++] = point;
  }

  void tryAt(const Vec& n) {
    const double length = norm(n);
    if (!(length > 0)) return;
    double most = -HUGE_VAL;
    for (int i = 0; i < count_; ++i) most = std::max(most, dot(n, s_[i]));
    most /= length;
    if (!(most < least_)) return;
    least_ = most;
    where_ = (1 / length) * n;
  }

  /// Where two points reach equally far, on the edges.
  void tryEdges(const Vec& between) {
    for (int k = 0; k < 3; ++k) {
      const Vec &from = n_[k], &to = n_[(k + 1) % 3];
      const double at_from = dot(from, between), at_to = dot(to, between);
      if ((at_from < 0) == (at_to < 0)) continue;
      tryAt(from + (at_from / (at_from - at_to)) * (to - from));
    }
  }

  /// Where three points reach equally far.
  void tryInside(const Vec& normal) {
    bool is_inside = true, is_opposite = true;
    for (int k = 0; k < 3; ++k) {
      const double side = dot(normal, cross(n_[k], n_[(k + 1) % 3]));
      is_inside &= side >= 0;
      is_opposite &= side <= 0;
    }
    if (is_inside) tryAt(normal);
    if (is_opposite) tryAt(-1. * normal);
  }

  Vec n_[3];
  /// The points that differ.
  Vec s_[4];
  int count_{0};
  double least_{HUGE_VAL};
  Vec where_{0, 0, 0};
};

void Cell::setLeast() {
  const LeastReach found(*this);
  least = std::max(least, found.value());
  where = found.direction();
}

class PenetrationSearch {
 public:
  PenetrationSearch(const PosedConvex& a, const PosedConvex& b) : a_(a), b_(b) {}

  Penetration run() {
    for (const PosedConvex* set : {&a_, &b_}) tryFlats(*set);
    cells_.reserve(kMostCells);
    addOctants();
    const double near = (isCurved() ? 0x1p-14 : 0x1p-34) * size_;
    for (int i = 0; i < kMostCells && !cells_.empty(); ++i) {
      std::pop_heap(cells_.begin(), cells_.end());
      const Cell cell = cells_.back();
      cells_.pop_back();
      if (!(cell.least < best_.depth - near)) break;
      divide(cell, near);
    }
    if (best_cell_ && !polish()) sharpen(*best_cell_);
    assert(isUnit(best_.direction) || !(best_.depth < HUGE_VAL));
    return best_;
  }

 private:
  /// A ring of directions that are all as good is left after so many.
  static constexpr int kMostCells = 512;

  bool isCurved() const { return a_.isCurved() || b_.isCurved(); }

  /// Also notes it if it is the least until now.
  Reach reachAlong(const Vec& n) {
    int id;
    const Vec point = a_.support(n, id) - b_.support(-1. * n, id);
    const double length = dot(n, point);
    size_ = std::max(size_, norm(point));
    if (length < best_.depth) best_ = {n, length};
    return {n, point, length};
  }

  /// The directions at right angles to flat sides.
  void tryFlats(const PosedConvex& set) {
    constexpr Vec kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const Vec& axis : kAxes) {
      const Vec n = set.shape ? rotated(set.pose.rotation, axis) : set.flatNormal(axis);
      if (!(norm(n) > 0x1p-500)) continue;
      reachAlong(unit(n));
      reachAlong(-1. * unit(n));
    }
  }

  void addOctants() {
    Reach along[3][2];
    for (int axis = 0; axis < 3; ++axis)
      for (int sign = 0; sign < 2; ++sign) {
        double n[3] = {0, 0, 0};
        n[axis] = sign == 0 ? 1 : -1;
        along[axis][sign] = reachAlong(vecOf(n));
      }
    for (int octant = 0; octant < 8; ++octant) {
      const int x = octant & 1, y = octant >> 1 & 1, z = octant >> 2;
      const bool is_odd = (x + y + z) % 2 == 1;
      add({{along[0][x], along[is_odd ? 2 : 1][is_odd ? z : y],
            along[is_odd ? 1 : 2][is_odd ? y : z]},
           along[0][x].point,
           0,
           {0, 0, 0}},
          0);
    }
  }

  void add(Cell cell, double near) {
    // By the right-hand rule, up to rounding.
    assert(!(dot(cell.corner[0].direction,
                 cross(cell.corner[1].direction, cell.corner[2].direction)) < -0x1p-48));
    const double enough = best_.depth - near;
    if (!(LeastReach::lowerBound(cell) < enough)) return;
    cell.setLeast();
    assert(!(LeastReach::lowerBound(cell) > cell.least + 0x1p-30 * size_));
    if (!(cell.least < enough)) return;
    cells_.push_back(cell);
    std::push_heap(cells_.begin(), cells_.end());
  }

  /// Divides a cell in two at its longest edge. The direction that looked best in it is
  /// tried first, and its point is known in both.
  void halve(const Cell& cell, Cell (&half)[2]) {
    int longest = 0;
    double least_cosine = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      const double cosine =
          dot(cell.corner[k].direction, cell.corner[(k + 1) % 3].direction);
      if (!(cosine < least_cosine)) continue;
      least_cosine = cosine;
      longest = k;
    }
    const Reach &from = cell.corner[longest], &to = cell.corner[(longest + 1) % 3],
                &opposite = cell.corner[(longest + 2) % 3];
    const Vec extra = reachAlong(cell.where).point;
    const Reach middle = reachAlong(unit(from.direction + to.direction));
    half[0] = {{from, middle, opposite}, extra, cell.least, {0, 0, 0}};
    half[1] = {{middle, to, opposite}, extra, cell.least, {0, 0, 0}};
  }

  void divide(const Cell& cell, double near) {
    const double before = best_.depth;
    Cell half[2];
    halve(cell, half);
    if (best_.depth < before) best_cell_ = cell;
    for (const Cell& part : half) add(part, near);
  }

  /// Goes to the least reach near the best direction by Newton's method.
  /// @return whether it is found; not where pieces of the support functions meet
  bool polish() {
    constexpr int kMostRounds = 6;
    constexpr double kFarthest = 0.25, kNearest = 0x1p-22;
    if (!isCurved()) return false;
    for (int round = 0; round < kMostRounds; ++round) {
      const Vec n = best_.direction, back = -1. * n,
                side = std::abs(n.x) < 0.6 ? Vec{1, 0, 0} : Vec{0, 1, 0},
                across = unit(cross(n, side));
      const Vec axis[2] = {across, cross(n, across)};
      const Vec point = reachAlong(n).point;
      double of_a[3], of_b[3];
      a_.setCurvature(a_.pieceAt(n), n, axis, of_a);
      b_.setCurvature(b_.pieceAt(back), back, axis, of_b);
      // On the unit sphere a second derivative is that in space minus the reach.
      const double m[3] = {of_a[0] + of_b[0] - best_.depth, of_a[1] + of_b[1],
                           of_a[2] + of_b[2] - best_.depth},
                   determinant = m[0] * m[2] - m[1] * m[1], g0 = dot(axis[0], point),
                   g1 = dot(axis[1], point);
      if (!(m[0] > 0) || !(determinant > 0)) return false;
      const Vec step = ((m[1] * g1 - m[2] * g0) / determinant) * axis[0] +
                       ((m[1] * g0 - m[0] * g1) / determinant) * axis[1];
      const double length = norm(step), before = best_.depth;
      if (!(length < kFarthest)) return false;
      reachAlong(unit(n + step));
      if (length < kNearest) return true;
      if (!(best_.depth < before)) return false;
    }
    return false;
  }

  /// Goes down to the best direction of a cell.
  void sharpen(Cell cell) {
    constexpr int kMostHalves = 60;
    for (int i = 0; i < kMostHalves && cell.least < best_.depth - 0x1p-40 * size_; ++i) {
      Cell half[2];
      halve(cell, half);
      for (Cell& part : half) part.setLeast();
      cell = half[half[1].least < half[0].least ? 1 : 0];
    }
  }

  const PosedConvex &a_, &b_;
  std::vector<Cell> cells_;
  /// Where the best direction was found, unless it is one of the first ones.
  std::optional<Cell> best_cell_;
  /// The largest distance of two points, about.
  double size_{0};
  Penetration best_{{0, 0, 0}, HUGE_VAL};
};

}  // namespace

Penetration penetrationOf(const PosedConvex& a, const PosedConvex& b) {
  assert(!(a.shape && a.shape->flat()) && !(b.shape && b.shape->flat()));
  return PenetrationSearch(a, b).run();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

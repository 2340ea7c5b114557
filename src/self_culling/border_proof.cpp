// SPDX-License-Identifier: BSD-3-Clause
#include "self_culling/border_proof.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/bits.h"
#include "numerics/error_bounds.h"
#include "tree/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Two vectors with entries 1, 0 and -1 that are perpendicular to d, and whose cross
/// product points along d. They are the unit vectors of the zero entries of d, and one
/// vector for each two nonzero entries that follow each other.
struct PlaneAxes {
  int axes[2][3]{};

  explicit PlaneAxes(const int (&d)[3]) {
    int count = 0, before = -1;
    for (int k = 0; k < 3; ++k) {
      if (d[k] == 0) {
        axes[count++][k] = 1;
        continue;
      }
      if (before >= 0) {
        axes[count][before] = d[before];
        axes[count++][k] = -d[k];
      }
      before = k;
    }
    const auto& [u, v] = axes;
    const int along = d[0] * (u[1] * v[2] - u[2] * v[1]) +
                      d[1] * (u[2] * v[0] - u[0] * v[2]) +
                      d[2] * (u[0] * v[1] - u[1] * v[0]);
    assert(count == 2 && along != 0);
    if (along < 0) std::swap(axes[0], axes[1]);
    for ([[maybe_unused]] const auto& axis : axes)
      assert(axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2] == 0);
  }
};

}  // namespace

void directionOf(int bit, int (&d)[3]) {
  assert(bit >= 0 && bit < 2 * static_cast<int>(kNumAxes));
  const int axis = bit % static_cast<int>(kNumAxes);
  for (int k = 0; k < 3; ++k) d[k] = bit == axis ? kAxes[axis][k] : -kAxes[axis][k];
}

bool BorderProof::isEmbedded(const RegionBorder& border, std::uint32_t directions) {
  assert(border.size() > 0 && border.points.size() > border.begins.back() + 1);
  border_ = &border;
  const double size = tree_.largestCoordinate() * tree_.largestCoordinate();
  if (directions == 0 || !isInRange(size)) return false;
  assert(directions >> 2 * kNumAxes == 0);
  direction_ = widest(directions);
  assert((directions >> direction_ & 1U) != 0);
  project(direction_);
  return isSimple() && windsOnce();
}

/// The direction in which the projection of the region is largest. The area vector of a
/// surface is that of its border.
int BorderProof::widest(std::uint32_t directions) const {
  const TreeVertex& origin = tree_.vertices()[border_->from(0)];
  double area[3] = {0, 0, 0};
  for (std::size_t i = 0; i < border_->size(); ++i)
    for (int frame = 0; frame < 2; ++frame) {
      const TreeVertex &a = tree_.vertices()[border_->from(i)],
                       &b = tree_.vertices()[border_->to(i)];
      double p[3], q[3];
      for (int k = 0; k < 3; ++k) {
        p[k] = frame == 0 ? a.t0[k] - origin.t0[k] : a.t1[k] - origin.t1[k];
        q[k] = frame == 0 ? b.t0[k] - origin.t0[k] : b.t1[k] - origin.t1[k];
      }
      for (int k = 0; k < 3; ++k)
        area[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
    }
  assert(directions != 0);
  int best = lowestBit(directions);
  double most = 0;
  for (; directions != 0; directions &= directions - 1) {
    int d[3];
    directionOf(lowestBit(directions), d);
    const double seen = (area[0] * d[0] + area[1] * d[1] + area[2] * d[2]) /
                        std::sqrt(double(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    if (seen > most) {
      most = seen;
      best = lowestBit(directions);
    }
  }
  return best;
}

void BorderProof::project(int direction) {
  int d[3];
  directionOf(direction, d);
  const PlaneAxes plane(d);
  const auto& [u, v] = plane.axes;
  products_[0] = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
  products_[1] = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  products_[2] = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  points_.clear();
  for (const std::uint32_t place : border_->points) {
    assert(place < tree_.vertices().size());
    const TreeVertex& vertex = tree_.vertices()[place];
    MovingPoint point;
    for (int frame = 0; frame < 2; ++frame) {
      const double(&p)[4] = frame == 0 ? vertex.t0 : vertex.t1;
      const double(&o)[3] = tree_.origin(frame);
      const double q[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
      const auto along = [&q](const int(&u)[3]) {
        return u[0] * q[0] + u[1] * q[1] + u[2] * q[2];
      };
      point.at[frame] = {along(plane.axes[0]), along(plane.axes[1])};
      // The third coordinate in fitPoints() is not exceeded.
      assert(!(std::abs(point.at[frame].x) > 2 * tree_.largestCoordinate()) &&
             !(std::abs(point.at[frame].y) > 2 * tree_.largestCoordinate()));
    }
    points_.push_back(point);
  }
}

/// Sets the boxes of the points. The third coordinate is the same for all points: twice
/// the largest coordinate C of the tree. So the pad of Kernels::fitPoints, which is
/// relative to the largest coordinate of a point, is 2^-48 C. The error of coordinates is
/// 2^-51 C. That of a box's numbers is four times as large, and less than 2^-50 C more
/// where two are added.
void BorderProof::fitPoints() {
  boxes_.points.resize(points_.size());
  for (std::size_t first = 0; first < points_.size(); first += 8) {
    const std::size_t count = std::min<std::size_t>(8, points_.size() - first);
    double offsets[2][3][8] = {};
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t frame = 0; frame < 2; ++frame) {
        const Point& p = points_[first + i].at[frame];
        offsets[frame][0][i] = p.x;
        offsets[frame][1][i] = p.y;
        offsets[frame][2][i] = 2 * tree_.largestCoordinate();
      }
      // The displacement of an edge is not used.
      boxes_.points[first + i].t0[3] = std::numeric_limits<double>::infinity();
    }
    for (int frame = 0; frame < 2; ++frame)
      kernels_.fitPoints(offsets[frame], frame, count, &boxes_.points[first]);
    for (std::size_t i = 0; i < count; ++i) {
      [[maybe_unused]] const auto& [at_0, at_1] = points_[first + i].at;
      [[maybe_unused]] const double third = 2 * tree_.largestCoordinate();
      assert(containsPoint(boxes_.points[first + i].box.t0, {at_0.x, at_0.y, third}));
      assert(containsPoint(boxes_.points[first + i].box.t1, {at_1.x, at_1.y, third}));
    }
  }
}

/// Makes the tree of the edges. Each of its lowest nodes has eight consecutive edges,
/// each of the next nodes eight of the lowest ones, and so on. The root is the first
/// node.
void BorderProof::fitTree() {
  fitPoints();
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  // The number of nodes of each level, the lowest level first.
  std::vector<std::size_t> levels;
  std::size_t num_nodes = 0;
  for (std::size_t count = border_->size(); levels.empty() || count > 1;) {
    count = (count + kWidth - 1) / kWidth;
    levels.push_back(count);
    num_nodes += count;
  }
  boxes_.nodes.resize(num_nodes);
  std::size_t first = num_nodes, below = border_->size(), first_below = 0;
  for (const std::size_t count : levels) {
    first -= count;
    const bool is_lowest = first + count == num_nodes;
    for (std::size_t i = 0; i < count; ++i) {
      MovingKdopNode& node = boxes_.nodes[first + i];
      node.count = static_cast<std::int32_t>(std::min(kWidth, below - i * kWidth));
      for (int lane = 0; lane < node.count; ++lane) {
        const std::size_t child = i * kWidth + static_cast<std::size_t>(lane);
        node.child[lane] = static_cast<std::int32_t>(first_below + child);
        if (!is_lowest) continue;
        node.child[lane] = ~node.child[lane];
        node.places[0][lane] = border_->begins[child];
        node.places[1][lane] = node.places[2][lane] = border_->begins[child] + 1;
      }
      node.markTriangles();
      float extents[kWidth];
      kernels_.fitNode(boxes_.points.data(), boxes_.nodes.data(), false, node, extents);
      assert(node.isComparable());
    }
    below = count;
    first_below = first;
  }
  assert(first == 0 && below == 1);  // the root
}

/// Calls visit(i, j) for the pairs of edges whose boxes overlap, until it is false.
/// @param shift  added to boxes; null: none
template <typename Visit>
void BorderProof::visitPairs(const KdopShift* shift, Visit&& visit) const {
  Traversal<true, const BorderTree, const BorderTree> traversal(
      boxes_, boxes_, shift, SelfCulling(), nullptr, kernels_, false);
  bool goes_on = true;
  WorkList open;
  traversal.start(open);
  while (open.size() > 0 && goes_on) {
    open.cut(open.size() - 1);
    traversal.step(*(open.data() + open.size()), open, [&](int i, int j, float) {
      assert(i != j);
      goes_on =
          goes_on && visit(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    });
  }
}

bool BorderProof::isSimple() {
  fitTree();
  bool simple = true;
  visitPairs(nullptr, [&](std::size_t i, std::size_t j) {
    return simple = meetOnlyAtVertices(i, j);
  });
  return simple;
}

void BorderProof::markNear(const RegionBorder& border, int direction, double distance,
                           std::vector<std::uint8_t>& is_apart) {
  assert(border.size() > 0 && distance >= 0 &&
         is_apart.size() == tree_.vertices().size());
  // Each edge meets some dozens of others where the distance is ten times its length.
  constexpr std::size_t kMostPairsOfEdge = 64;
  border_ = &border;
  direction_ = direction;
  project(direction);
  fitTree();
  const KdopShift shift = shiftFor(distance);
  std::size_t left = kMostPairsOfEdge * border.size();
  visitPairs(&shift, [&](std::size_t i, std::size_t j) {
    if (left-- == 0) {
      for (const std::uint32_t v : border.points) is_apart[v] = 0;
      return false;
    }
    const std::uint32_t ends[4] = {border.from(i), border.to(i), border.from(j),
                                   border.to(j)};
    const bool has_common = ends[0] == ends[2] || ends[0] == ends[3] ||
                            ends[1] == ends[2] || ends[1] == ends[3];
    const auto is_marked = [&](std::uint32_t v) { return is_apart[v] == 0; };
    if (!has_common && !std::all_of(ends, ends + 4, is_marked) &&
        !areApart(planarEdge(i), planarEdge(j), distance))
      for (const std::uint32_t v : ends) is_apart[v] = 0;
    return true;
  });
}

/// The length of w, as a vector of space: its product with a point is that of w with the
/// point's coordinates in the plane.
double BorderProof::lengthOf(const Point& w) const {
  return std::sqrt(products_[0] * w.x * w.x + 2 * products_[1] * w.x * w.y +
                   products_[2] * w.y * w.y);
}

/// What enlarges boxes by a distance, by the length of each of their directions. The
/// third coordinate is the same for all points.
KdopShift BorderProof::shiftFor(double distance) const {
  constexpr Point kDirections[8] = {{1, 0}, {0, 1}, {0, 0},  {1, 1},
                                    {1, 0}, {0, 1}, {1, -1}, {1, 0}};
  KdopShift shift;
  for (int j = 0; j < 16; ++j)
    shift.t0.half[j] = shift.t1.half[j] =
        roundUp(distance * lengthOf(kDirections[j % 8]), 0.f);
  return shift;
}

/// Whether it is proved that two edges never meet, except in a vertex that they share.
bool BorderProof::meetOnlyAtVertices(std::size_t i, std::size_t j) const {
  const std::uint32_t from_i = border_->from(i), to_i = border_->to(i),
                      from_j = border_->from(j), to_j = border_->to(j);
  const PlanarEdge x = planarEdge(i), y = planarEdge(j);
  const bool ff = from_i == from_j, ft = from_i == to_j, tf = to_i == from_j,
             tt = to_i == to_j;
  if (ff + ft + tf + tt == 0) return areApart(x, y, 0);
  if (ff + ft + tf + tt > 1) return false;
  // Vectors along both edges, away from the common vertex. They must never point the same
  // way.
  Point p[2], q[2];
  double length = 0;
  for (int k = 0; k < 2; ++k) {
    p[k] = ff || ft ? x.to.at[k] - x.from.at[k] : x.from.at[k] - x.to.at[k];
    q[k] = ff || tf ? y.to.at[k] - y.from.at[k] : y.from.at[k] - y.to.at[k];
    for (const Point& a : {p[k], q[k]})
      length = std::max(length, std::max(std::abs(a.x), std::abs(a.y)));
  }
  const double size = tree_.largestCoordinate() * length, bound = kBorderTurnBound * size;
  if (!(size >= kTiny)) return false;
  const double turn[3] = {cross(p[0], q[0]), cross(p[0], q[1]) + cross(p[1], q[0]),
                          cross(p[1], q[1])};
  const double same[3] = {dot(p[0], q[0]), dot(p[0], q[1]) + dot(p[1], q[0]),
                          dot(p[1], q[1])};
  const auto all_below = [bound](const double(&c)[3], int sign) {
    return sign * c[0] < -bound && sign * c[1] < -bound && sign * c[2] < -bound;
  };
  return all_below(turn, 1) || all_below(turn, -1) || all_below(same, 1);
}

/// Whether a strip of this width separates two edges at all times. It turns as the edges
/// do.
bool BorderProof::areApart(const PlanarEdge& e, const PlanarEdge& f,
                           double distance) const {
  Point across_e[2], across_f[2], between[2];
  for (int k = 0; k < 2; ++k) {
    const Point along_e = e.to.at[k] - e.from.at[k], along_f = f.to.at[k] - f.from.at[k];
    across_e[k] = {-along_e.y, along_e.x};
    across_f[k] = {-along_f.y, along_f.x};
    between[k] = (f.from.at[k] + f.to.at[k]) - (e.from.at[k] + e.to.at[k]);
  }
  return areApart(e, f, across_e, distance) || areApart(e, f, across_f, distance) ||
         areApart(e, f, between, distance);
}

/// Whether e stays on one side and f on the other along a direction. The direction is
/// w[0] at t = 0 and w[1] at t = 1.
bool BorderProof::areApart(const PlanarEdge& e, const PlanarEdge& f, const Point (&w)[2],
                           double distance) const {
  assert(distance >= 0);
  double size = 0;
  for (const Point& p : w) size = std::max(size, std::max(std::abs(p.x), std::abs(p.y)));
  size *= tree_.largestCoordinate();
  if (!(size >= kTiny)) return false;
  const double bound = kBorderSideBound * size;
  // A strip is as wide as its sides are apart along the direction. The length of this is
  // largest at an end of the step. The factor is more than the rounding of the product.
  const double width =
      distance > 0 ? distance * kUpward * std::max(lengthOf(w[0]), lengthOf(w[1])) : 0;
  // Bernstein coefficients in t, the middle one twice.
  const auto along = [&w](const MovingPoint& p) -> std::array<double, 3> {
    return {dot(w[0], p.at[0]), dot(w[0], p.at[1]) + dot(w[1], p.at[0]),
            dot(w[1], p.at[1])};
  };
  const auto a = along(e.from), b = along(e.to), c = along(f.from), d = along(f.to);
  bool above = true, below = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const double least = bound + (k == 1 ? 2 : 1) * width;
    above = above && std::min(a[k], b[k]) - std::max(c[k], d[k]) > least;
    below = below && std::min(c[k], d[k]) - std::max(a[k], b[k]) > least;
  }
  return above || below;
}

/// A simple loop winds once around its inside, and the triangles' areas are positive. For
/// other borders the winding number on the left of each path is computed: along a path it
/// does not change.
bool BorderProof::windsOnce() const {
  if (border_->is_one_loop) return true;
  return std::all_of(border_->paths.begin(), border_->paths.end(),
                     [this](std::size_t i) { return windsOnceLeftOf(i); });
}

/// Whether it is proved that the border winds once around a point just left of the middle
/// of edge i at t = 0. It counts the edges that cross a ray from this point.
bool BorderProof::windsOnceLeftOf(std::size_t i) const {
  const Point a = planarEdge(i).from.at[0], b = planarEdge(i).to.at[0], e = b - a;
  // A ray to the left, in a direction that edges of a regular mesh do not have.
  constexpr double kTilt = 0.2360679774997897;
  const Point ray = {kTilt * e.x - e.y, kTilt * e.y + e.x};
  const double largest = tree_.largestCoordinate();
  const double size = std::max(std::abs(ray.x), std::abs(ray.y)) * largest;
  if (!(size >= kTiny)) return false;
  const double ray_bound = kBorderRayBound * size,
               half_bound = kBorderHalfBound * (largest * largest);
  // The side of the ray's line on which a point lies; 0: unknown.
  const auto side = [&](const Point& p) {
    const double s = cross(ray, (p - a) + (p - b));
    return s > ray_bound ? 1 : s < -ray_bound ? -1 : 0;
  };
  if (side(a) != 1 || side(b) != -1) return false;
  int winding = 0;
  for (std::size_t j = 0; j < border_->size(); ++j) {
    if (j == i) continue;
    const Point &p = planarEdge(j).from.at[0], &q = planarEdge(j).to.at[0];
    const int from = side(p), to = side(q);
    if (from == 0 || to == 0) return false;
    if (from == to) continue;
    // The middle is on the left of an edge that crosses the ray itself from right to
    // left.
    const double left = cross(q - p, (a - p) + (b - p)) * to;
    if (!(std::abs(left) > half_bound)) return false;
    if (left > 0) winding += to;
  }
  return winding == 1;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

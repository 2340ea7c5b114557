// SPDX-License-Identifier: BSD-3-Clause
#include "region_border.h"

#include <algorithm>
#include <cmath>

#include "error_bounds.h"
#include "fcl/narrowphase/detail/deformable/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Direction `bit` of a set.
void directionOf(int bit, int (&d)[3]) {
  const int axis = bit % static_cast<int>(kNumAxes);
  for (int k = 0; k < 3; ++k) d[k] = bit == axis ? kAxes[axis][k] : -kAxes[axis][k];
}

/// Two vectors of 1, 0 and -1 that are perpendicular to d and whose cross product points
/// along it: the unit vectors along which d has nothing, and one for each two entries
/// that follow each other.
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
    if (along < 0) std::swap(axes[0], axes[1]);
  }
};

/// The same half-axis bounds for what is in either.
void extend(MovingKdop& box, const MovingKdop& by) {
  for (int j = 0; j < 16; ++j) {
    box.t0.half[j] = std::max(box.t0.half[j], by.t0.half[j]);
    box.t1.half[j] = std::max(box.t1.half[j], by.t1.half[j]);
  }
}

}  // namespace

bool RegionBorder::find(const Region& region, std::uint8_t* interior) {
  markInterior(region, interior);
  // Edges of a vertex inside cancel: its triangles form a closed fan.
  const auto is_interior = [&](std::uint32_t place) {
    return place >= region.first_place && interior[place];
  };
  keys_.clear();
  for (std::uint32_t i = region.first; i < region.last; ++i) {
    const std::uint32_t(&v)[3] = tree_.triangles()[i].place;
    const bool outer[3] = {!is_interior(v[0]), !is_interior(v[1]), !is_interior(v[2])};
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (!(outer[k] && outer[next])) continue;
      const std::uint64_t low = std::min(v[k], v[next]), high = std::max(v[k], v[next]);
      keys_.push_back(low << 32 | high << 1 | std::uint64_t{v[k] > v[next]});
    }
  }
  return cancelOpposites() && linkPaths();
}

void RegionBorder::markInterior(const Region& region, std::uint8_t* interior) const {
  std::fill(interior + region.first_place, interior + region.last_place, 0);
  for (std::uint32_t i = region.first; i < region.last; ++i)
    for (const std::uint32_t place : tree_.triangles()[i].place)
      if (place >= region.first_place) ++interior[place];
  // A count that is too large for its byte is of a vertex without a fan.
  for (std::uint32_t v = region.first_place; v < region.last_place; ++v) {
    const VertexFan fan = tree_.fans()[v];
    interior[v] = fan.is_closed && interior[v] == fan.count;
  }
}

bool RegionBorder::cancelOpposites() {
  std::sort(keys_.begin(), keys_.end());
  edges_.clear();
  for (std::size_t i = 0; i < keys_.size();) {
    const std::uint64_t edge = keys_[i] >> 1;
    int left = 0;
    for (; i < keys_.size() && keys_[i] >> 1 == edge; ++i) left += keys_[i] & 1 ? -1 : 1;
    if (left == 0) continue;
    if (left != 1 && left != -1) return false;
    const auto low = static_cast<std::uint32_t>(edge >> 31),
               high = static_cast<std::uint32_t>(edge & 0x7fffffff);
    edges_.push_back(left > 0 ? Edge{low, high} : Edge{high, low});
  }
  return !edges_.empty();
}

/// Puts the edges in the order of paths. As many edges leave a vertex as come to it.
bool RegionBorder::linkPaths() {
  std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  const std::vector<Edge>& edges = unlinked_;
  unlinked_.swap(edges_);
  taken_.assign(edges.size(), 0);
  const auto begins_path = [&edges](std::size_t i) {
    return (i > 0 && edges[i - 1].from == edges[i].from) ||
           (i + 1 < edges.size() && edges[i + 1].from == edges[i].from);
  };
  edges_.clear();
  paths_.clear();
  const auto take = [&](std::size_t i) {
    paths_.push_back(edges_.size());
    while (!taken_[i]) {
      taken_[i] = 1;
      edges_.push_back(edges[i]);
      const std::uint32_t at = edges[i].to;
      i = static_cast<std::size_t>(
          std::lower_bound(edges.begin(), edges.end(), at,
                           [](const Edge& e, std::uint32_t v) { return e.from < v; }) -
          edges.begin());
      if (i == edges.size() || edges[i].from != at) return false;
      if (begins_path(i)) break;
    }
    return true;
  };
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (begins_path(i) && !take(i)) return false;
  is_one_loop_ = paths_.empty();
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (!taken_[i] && !take(i)) return false;
  is_one_loop_ &= paths_.size() == 1;
  return true;
}

bool RegionBorder::isEmbedded(std::uint32_t directions) {
  const double size = tree_.reach() * tree_.reach();
  if (directions == 0 || !(size >= kTiny && size <= kHuge)) return false;
  project(widest(directions));
  return isSimple() && windsOnce();
}

/// The direction along which most of the region is seen: the area vector of a surface is
/// that of its border.
int RegionBorder::widest(std::uint32_t directions) const {
  const TreeVertex& origin = tree_.vertices()[edges_[0].from];
  double area[3] = {0, 0, 0};
  for (const Edge& edge : edges_)
    for (int frame = 0; frame < 2; ++frame) {
      const TreeVertex &a = tree_.vertices()[edge.from], &b = tree_.vertices()[edge.to];
      double p[3], q[3];
      for (int k = 0; k < 3; ++k) {
        p[k] = frame == 0 ? a.t0[k] - origin.t0[k] : a.t1[k] - origin.t1[k];
        q[k] = frame == 0 ? b.t0[k] - origin.t0[k] : b.t1[k] - origin.t1[k];
      }
      for (int k = 0; k < 3; ++k)
        area[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
    }
  int best = __builtin_ctz(directions);
  double most = 0;
  for (; directions != 0; directions &= directions - 1) {
    int d[3];
    directionOf(__builtin_ctz(directions), d);
    const double seen = (area[0] * d[0] + area[1] * d[1] + area[2] * d[2]) /
                        std::sqrt(double(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    if (seen > most) {
      most = seen;
      best = __builtin_ctz(directions);
    }
  }
  return best;
}

void RegionBorder::project(int direction) {
  int d[3];
  directionOf(direction, d);
  const PlaneAxes plane(d);
  const auto at = [&](const double* p, int frame) {
    const double(&o)[3] = tree_.origin(frame);
    const double q[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
    const auto along = [&q](const int(&u)[3]) {
      return u[0] * q[0] + u[1] * q[1] + u[2] * q[2];
    };
    return Point{along(plane.axes[0]), along(plane.axes[1])};
  };
  planar_.clear();
  for (const Edge& edge : edges_) {
    const TreeVertex &a = tree_.vertices()[edge.from], &b = tree_.vertices()[edge.to];
    planar_.push_back({{at(a.t0, 0), at(a.t1, 1)}, {at(b.t0, 0), at(b.t1, 1)}});
  }
}

/// The box of a point that moves in the plane, whose third coordinate is there for two
/// more directions.
MovingKdop RegionBorder::boxOf(const Point (&path)[2]) const {
  // Coordinates are 2^-51 of the reach off, those of a box four times that, and less than
  // 2^-50 more where two are added.
  const float pad = roundUp(tree_.reach() * 0x1p-48, 0.f);
  const double zero[3] = {0, 0, 0};
  const double p[3] = {path[0].x, path[0].y, 2 * path[0].y},
               q[3] = {path[1].x, path[1].y, 2 * path[1].y};
  MovingKdop box;
  fitPoint(p, zero, pad, box.t0);
  fitPoint(q, zero, pad, box.t1);
  return box;
}

/// Makes node i, of edges [first, last), and what is below it.
void RegionBorder::makeNode(std::size_t i, std::size_t first, std::size_t last,
                            MovingKdop& box) {
  constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  std::size_t length = 1;
  while (length * kWidth < last - first) length *= kWidth;
  MovingKdop boxes[kWidth], end;
  std::int32_t numbers[kWidth];
  int count = 0;
  for (; first < last; ++count, first += length) {
    numbers[count] = ~static_cast<std::int32_t>(first);
    if (length == 1) {
      // Most edges begin where the one before ends.
      const bool goes_on = count > 0 && edges_[first].from == edges_[first - 1].to;
      boxes[count] = goes_on ? end : boxOf(planar_[first].from);
      end = boxOf(planar_[first].to);
      extend(boxes[count], end);
    } else {
      numbers[count] = static_cast<std::int32_t>(boxes_.nodes.size());
      boxes_.nodes.emplace_back();
      makeNode(boxes_.nodes.size() - 1, first, std::min(first + length, last),
               boxes[count]);
    }
    if (count == 0)
      box = boxes[0];
    else
      extend(box, boxes[count]);
  }
  MovingKdopNode& node = boxes_.nodes[i];
  node.count = count;
  std::copy(numbers, numbers + count, node.child);
  node.markTriangles();
  for (int lane = 0; lane < count; ++lane) node.setBox(lane, boxes[lane]);
  // Nobody asks how far its edges go.
  std::fill(node.displacement, node.displacement + count,
            std::numeric_limits<float>::infinity());
  node.clearRest();
}

bool RegionBorder::isSimple() {
  boxes_.nodes.clear();
  boxes_.nodes.emplace_back();
  MovingKdop box;
  makeNode(0, 0, planar_.size(), box);
  Traversal<true, const BorderTree, const BorderTree> traversal(
      boxes_, boxes_, nullptr, nullptr, nullptr, nullptr, kernels_, false);
  bool simple = true;
  WorkList open;
  traversal.start(open);
  while (open.size() > 0 && simple) {
    open.cut(open.size() - 1);
    traversal.step(*(open.data() + open.size()), open, [&](int i, int j, float) {
      simple = simple && meetOnlyAtVertices(static_cast<std::size_t>(i),
                                            static_cast<std::size_t>(j));
    });
  }
  return simple;
}

/// Whether two edges provably meet at no time but in a vertex that they share.
bool RegionBorder::meetOnlyAtVertices(std::size_t i, std::size_t j) const {
  const Edge &e = edges_[i], &f = edges_[j];
  const PlanarEdge &x = planar_[i], &y = planar_[j];
  const bool ff = e.from == f.from, ft = e.from == f.to, tf = e.to == f.from,
             tt = e.to == f.to;
  if (ff + ft + tf + tt == 0) return areApart(x, y);
  if (ff + ft + tf + tt > 1) return false;
  // Away from the common vertex; they must never point the same way.
  Point p[2], q[2];
  double length = 0;
  for (int k = 0; k < 2; ++k) {
    p[k] = ff || ft ? x.to[k] - x.from[k] : x.from[k] - x.to[k];
    q[k] = ff || tf ? y.to[k] - y.from[k] : y.from[k] - y.to[k];
    for (const Point& a : {p[k], q[k]})
      length = std::max(length, std::max(std::abs(a.x), std::abs(a.y)));
  }
  const double size = tree_.reach() * length, bound = kBorderTurnBound * size;
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

/// Whether a fixed line separates two edges at all times.
bool RegionBorder::areApart(const PlanarEdge& e, const PlanarEdge& f) const {
  const Point along_e = (e.to[0] - e.from[0]) + (e.to[1] - e.from[1]);
  const Point along_f = (f.to[0] - f.from[0]) + (f.to[1] - f.from[1]);
  const Point between = ((f.from[0] + f.to[0]) + (f.from[1] + f.to[1])) -
                        ((e.from[0] + e.to[0]) + (e.from[1] + e.to[1]));
  return areApart(e, f, {-along_e.y, along_e.x}) ||
         areApart(e, f, {-along_f.y, along_f.x}) || areApart(e, f, between);
}

/// Whether e stays on one side and f on the other along w.
bool RegionBorder::areApart(const PlanarEdge& e, const PlanarEdge& f,
                            const Point& w) const {
  const double size = std::max(std::abs(w.x), std::abs(w.y)) * tree_.reach();
  if (!(size >= kTiny)) return false;
  const double bound = kBorderSideBound * size;
  bool above = true, below = true;
  for (int k = 0; k < 2; ++k) {
    const double a = dot(w, e.from[k]), b = dot(w, e.to[k]), c = dot(w, f.from[k]),
                 d = dot(w, f.to[k]);
    above = above && std::min(a, b) - std::max(c, d) > bound;
    below = below && std::min(c, d) - std::max(a, b) > bound;
  }
  return above || below;
}

/// A simple loop winds once round what is inside, and the triangles' areas are positive.
/// Else the winding number is looked at on the left of each path, along which it does not
/// change.
bool RegionBorder::windsOnce() const {
  if (is_one_loop_) return true;
  return std::all_of(paths_.begin(), paths_.end(),
                     [this](std::size_t i) { return windsOnceLeftOf(i); });
}

/// Whether the border provably winds once round a point just left of the middle of edge i
/// at t = 0: counts what crosses a ray from there.
bool RegionBorder::windsOnceLeftOf(std::size_t i) const {
  const Point a = planar_[i].from[0], b = planar_[i].to[0], e = b - a;
  // To the left, and in no direction that edges of a regular mesh have.
  constexpr double kTilt = 0.2360679774997897;
  const Point ray = {kTilt * e.x - e.y, kTilt * e.y + e.x};
  const double reach = tree_.reach();
  const double size = std::max(std::abs(ray.x), std::abs(ray.y)) * reach;
  if (!(size >= kTiny)) return false;
  const double ray_bound = kBorderRayBound * size,
               half_bound = kBorderHalfBound * (reach * reach);
  // On which side of the ray's line a point lies; 0: unknown.
  const auto side = [&](const Point& p) {
    const double s = cross(ray, (p - a) + (p - b));
    return s > ray_bound ? 1 : s < -ray_bound ? -1 : 0;
  };
  if (side(a) != 1 || side(b) != -1) return false;
  int winding = 0;
  for (std::size_t j = 0; j < planar_.size(); ++j) {
    if (j == i) continue;
    const Point &p = planar_[j].from[0], &q = planar_[j].to[0];
    const int from = side(p), to = side(q);
    if (from == 0 || to == 0) return false;
    if (from == to) continue;
    // The middle lies on the left of what crosses the ray itself from right to left.
    const double left = cross(q - p, (a - p) + (b - p)) * to;
    if (!(std::abs(left) > half_bound)) return false;
    if (left > 0) winding += to;
  }
  return winding == 1;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

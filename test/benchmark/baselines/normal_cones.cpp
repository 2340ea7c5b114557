// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/normal_cones.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fcl {
namespace test {
namespace {

using Vec3 = std::array<double, 3>;

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3 sum(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec3 scaled(const Vec3& a, double by) { return {a[0] * by, a[1] * by, a[2] * by}; }
Vec3 difference(const double (&a)[3], const double (&b)[3]) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// Not less than the angle whose cosine is given, and less than 2e-4 more: the polynomial
/// of Abramowitz and Stegun 4.4.45 is off by up to 7e-5; what unit vectors and their
/// product are rounded by, 2^-51, is less than 1e-7 of an angle, and so is what a normal
/// is off that is accepted below.
double angleOf(double cosine) {
  const double x = std::min(1., std::abs(cosine));
  const double angle =
      std::sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
  return (cosine < 0 ? 3.14159266 - angle : angle) + 1e-4;
}

const NormalCone kFullCone = {{1, 0, 0}, 4};

/// A quadratic in t by its Bernstein coefficients, the middle one times 2.
struct Quadratic {
  double b0, twice_b1, b2;

  bool isAbove(double margin) const {
    return b0 > margin && twice_b1 > 2 * margin && b2 > margin;
  }
  bool isBelow(double margin) const {
    return b0 < -margin && twice_b1 < -2 * margin && b2 < -margin;
  }
  /// The half before or after t = 1/2, as a function on [0, 1].
  Quadratic half(bool later) const {
    const double middle = 0.25 * (b0 + twice_b1 + b2);
    return later ? Quadratic{middle, 0.5 * twice_b1 + b2, b2}
                 : Quadratic{b0, b0 + 0.5 * twice_b1, middle};
  }
};

using Point = double[2];

double crossAt(const Point& o, const Point& a, const Point& b) {
  return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

}  // namespace

NormalCone continuousNormalCone(const detail::deformable::VertexPath& a,
                                const detail::deformable::VertexPath& b,
                                const detail::deformable::VertexPath& c) {
  const Vec3 v0 = difference(b.t0, a.t0), w0 = difference(c.t0, a.t0);
  const Vec3 v1 = difference(b.t1, a.t1), w1 = difference(c.t1, a.t1);
  Vec3 n[3] = {cross(v0, w0), sum(cross(v0, w1), cross(v1, w0)), cross(v1, w1)};
  // Each component is a sum of at most four products of factors that are off by 2^-53 of
  // themselves: by less than 2^-48 of the longest product of lengths. A normal of at
  // least 2^-20 of that is turned by less than 2^-27.
  const double longest =
      std::sqrt(std::max(dot(v0, v0), dot(v1, v1)) * std::max(dot(w0, w0), dot(w1, w1)));
  Vec3 axis{};
  for (Vec3& normal : n) {
    const double length = std::sqrt(dot(normal, normal));
    if (!(length > 0x1p-20 * longest)) return kFullCone;
    normal = scaled(normal, 1 / length);
    axis = sum(axis, normal);
  }
  const double length = std::sqrt(dot(axis, axis));
  if (!(length > 0x1p-10)) return kFullCone;
  axis = scaled(axis, 1 / length);
  double least = 1;
  for (const Vec3& normal : n) least = std::min(least, dot(axis, normal));
  // A cone of less than a right angle is convex: with three directions it contains their
  // positive combinations.
  if (!(least > 0)) return kFullCone;
  return {axis, angleOf(least)};
}

NormalCone merged(const NormalCone& a, const NormalCone& b) {
  if (a.isFull() || b.isFull()) return kFullCone;
  const double between = angleOf(dot(a.axis, b.axis));
  if (between + b.angle <= a.angle) return a;
  if (between + a.angle <= b.angle) return b;
  const double angle = 0.5 * (a.angle + b.angle + between);
  if (!(angle < NormalCone::kFull)) return kFullCone;
  // Near the axis of the smallest cone; the angles are those from where it is.
  const double turn = (angle - a.angle) / between;
  const Vec3 mean = sum(scaled(a.axis, 1 - turn), scaled(b.axis, turn));
  const Vec3 axis = scaled(mean, 1 / std::sqrt(dot(mean, mean)));
  return {axis, std::max(angleOf(dot(axis, a.axis)) + a.angle,
                         angleOf(dot(axis, b.axis)) + b.angle)};
}

NormalCones::NormalCones(const Regions& regions, const MeshConnectivity& mesh,
                         std::size_t least_triangles)
    : regions_(regions), mesh_(mesh), cones_(regions.size()), contours_(1) {
  // Children first, as their contours are needed; stored parents first.
  std::vector<std::vector<DirectedEdge>> contours(regions.size());
  std::vector<std::size_t> count(regions.size(), 0);
  for (std::size_t i = regions.size(); i-- > 0;) {
    std::vector<DirectedEdge> all;
    for (auto c = regions.starts[i]; c < regions.starts[i + 1]; ++c) {
      const std::int32_t child = regions.children[c];
      if (child >= 0) {
        const auto& of_child = contours[static_cast<std::size_t>(child)];
        all.insert(all.end(), of_child.begin(), of_child.end());
        count[i] += count[static_cast<std::size_t>(child)];
        continue;
      }
      ++count[i];
      const auto& v = mesh.triangle(~child).v;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = v[k], to = v[(k + 1) % 3];
        if (from != to)
          all.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
      }
    }
    std::sort(all.begin(), all.end(), [](const DirectedEdge& e, const DirectedEdge& f) {
      return std::make_pair(e.low, e.high) < std::make_pair(f.low, f.high);
    });
    std::vector<DirectedEdge>& left = contours[i];
    for (std::size_t e = 0; e < all.size();) {
      DirectedEdge edge = all[e];
      while (++e < all.size() && all[e].low == edge.low && all[e].high == edge.high)
        edge.turns += all[e].turns;
      if (edge.turns != 0) left.push_back(edge);
    }
  }
  for (std::size_t i = 0; i < regions.size(); ++i)
    addContour(count[i] < least_triangles ? std::vector<DirectedEdge>() : contours[i]);
}

void NormalCones::addContour(const std::vector<DirectedEdge>& edges) {
  // An edge on which the contour runs twice has two layers beside it.
  const bool is_plain =
      std::all_of(edges.begin(), edges.end(),
                  [](const DirectedEdge& e) { return e.turns == 1 || e.turns == -1; });
  if (is_plain) {
    std::vector<std::uint32_t> ids;
    for (const DirectedEdge& e : edges) ids.insert(ids.end(), {e.low, e.high});
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    const auto place = [&](std::uint32_t id) {
      return static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), id) -
                                        ids.begin());
    };
    const std::size_t first = edges_.size();
    constexpr std::uint32_t kNone = ~0U;
    // The edge that leaves a vertex, and how many do. As many arrive, since the contour
    // is a sum of closed curves.
    std::vector<std::uint32_t> leaving(ids.size(), kNone), count(ids.size(), 0);
    for (const DirectedEdge& e : edges) {
      const bool is_forward = e.turns > 0;
      const ContourEdge edge = {place(is_forward ? e.low : e.high),
                                place(is_forward ? e.high : e.low)};
      leaving[edge.from] = static_cast<std::uint32_t>(edges_.size() - first);
      ++count[edge.from];
      edges_.push_back(edge);
    }
    std::vector<bool> is_seen(edges.size(), false);
    const auto follow = [&](std::uint32_t e) {
      seeds_.push_back(e);
      while (!is_seen[e]) {
        is_seen[e] = true;
        const std::uint32_t v = edges_[first + e].to;
        if (count[v] != 1) break;
        e = leaving[v];
      }
    };
    for (std::uint32_t e = 0; e < edges.size(); ++e)
      if (count[edges_[first + e].from] != 1) follow(e);
    for (std::uint32_t e = 0; e < edges.size(); ++e)
      if (!is_seen[e]) follow(e);
    vertices_.insert(vertices_.end(), ids.begin(), ids.end());
  }
  contours_.push_back({edges_.size(), vertices_.size(), seeds_.size()});
}

void NormalCones::update(const std::vector<VertexPath>& paths) {
  paths_ = &paths;
  const auto coneOf = [&](std::int32_t child) {
    if (child >= 0) return cones_[static_cast<std::size_t>(child)];
    const auto& v = mesh_.triangle(~child).v;
    return continuousNormalCone(paths[v[0]], paths[v[1]], paths[v[2]]);
  };
  for (std::size_t i = regions_.size(); i-- > 0;) {
    const auto first = regions_.starts[i], last = regions_.starts[i + 1];
    if (first == last) continue;
    NormalCone& cone = cones_[i] = coneOf(regions_.children[first]);
    for (auto c = first + 1; c < last && !cone.isFull(); ++c)
      cone = merged(cone, coneOf(regions_.children[c]));
  }
}

bool NormalCones::isFreeOfSelfContact(std::size_t region) {
  if (cones_[region].isFull() ||
      contours_[region].first_edge == contours_[region + 1].first_edge)
    return false;
  project(region);
  return windsOnce(region) && isContourSimple(region);
}

/// The contour's vertices in a plane orthogonal to the cone's axis.
void NormalCones::project(std::size_t region) {
  const Vec3& axis = cones_[region].axis;
  std::size_t least = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(axis[k]) < std::abs(axis[least])) least = k;
  Vec3 x = {0, 0, 0};
  x[least] = 1;
  x = sum(x, scaled(axis, -axis[least]));
  // Turned a little: edges along a coordinate axis would run along the ray of
  // windsOnce().
  x = sum(scaled(x, 0.8 / std::sqrt(dot(x, x))), scaled(cross(axis, x), 0.6));
  x = scaled(x, 1 / std::sqrt(dot(x, x)));
  const Vec3 y = cross(axis, x);

  const std::size_t first = contours_[region].first_vertex,
                    last = contours_[region + 1].first_vertex;
  const VertexPath& center = (*paths_)[vertices_[first]];
  plane_.resize(last - first);
  double reach = 0;
  for (std::size_t i = 0; i < plane_.size(); ++i) {
    const VertexPath& path = (*paths_)[vertices_[first + i]];
    const Vec3 p = difference(path.t0, center.t0), q = difference(path.t1, center.t0);
    plane_[i] = {{dot(p, x), dot(p, y)}, {dot(q, x), dot(q, y)}};
    for (std::size_t k = 0; k < 3; ++k)
      reach = std::max(reach, std::max(std::abs(p[k]), std::abs(q[k])));
  }
  // With u = 2^-53 and the largest difference L a projected coordinate is off by less
  // than 6 sqrt(3) L u (a difference, three products, two additions), a difference of two
  // is below 2 sqrt(3) L. A sum of two products of such differences, or of four, the
  // middle coefficient, is off by less than 600 u L^2 by what the coordinates are, and
  // rounded by less than 200 u L^2.
  margin_ = 0x1p-43 * reach * reach;
}

/// Separates edges without a common vertex by a fixed line, or by one along an edge that
/// has the other always on one side; edges with a common vertex by the turn or, where
/// they are nearly in line, by pointing away from each other. Of disjoint edges one of
/// these holds at any time, but not one and the same need hold at all times: the step is
/// divided.
bool NormalCones::areApart(const ContourEdge& e, const ContourEdge& f) const {
  const auto turnOf = [&](std::uint32_t o, std::uint32_t a, std::uint32_t b) {
    const PlanePath &p = plane_[o], &q = plane_[a], &r = plane_[b];
    const double v0[2] = {q.t0[0] - p.t0[0], q.t0[1] - p.t0[1]},
                 v1[2] = {q.t1[0] - p.t1[0], q.t1[1] - p.t1[1]},
                 w0[2] = {r.t0[0] - p.t0[0], r.t0[1] - p.t0[1]},
                 w1[2] = {r.t1[0] - p.t1[0], r.t1[1] - p.t1[1]};
    return Quadratic{v0[0] * w0[1] - v0[1] * w0[0],
                     (v0[0] * w1[1] - v0[1] * w1[0]) + (v1[0] * w0[1] - v1[1] * w0[0]),
                     v1[0] * w1[1] - v1[1] * w1[0]};
  };
  constexpr int kMaxDepth = 3;
  const bool is_first = e.from == f.from || e.from == f.to;
  if (is_first || e.to == f.from || e.to == f.to) {
    const std::uint32_t o = is_first ? e.from : e.to, a = is_first ? e.to : e.from,
                        b = f.from == o ? f.to : f.from;
    if (a == b) return false;
    const PlanePath &p = plane_[o], &q = plane_[a], &r = plane_[b];
    Quadratic along{0, 0, 0};
    for (int k = 0; k < 2; ++k) {
      const double v0 = q.t0[k] - p.t0[k], v1 = q.t1[k] - p.t1[k], w0 = r.t0[k] - p.t0[k],
                   w1 = r.t1[k] - p.t1[k];
      along.b0 += v0 * w0;
      along.twice_b1 += v0 * w1 + v1 * w0;
      along.b2 += v1 * w1;
    }
    const auto isApart = [&](const auto& self, const Quadratic& turn,
                             const Quadratic& cosine, int depth) -> bool {
      if (cosine.isBelow(margin_) || turn.isAbove(margin_) || turn.isBelow(margin_))
        return true;
      return depth < kMaxDepth &&
             self(self, turn.half(false), cosine.half(false), depth + 1) &&
             self(self, turn.half(true), cosine.half(true), depth + 1);
    };
    return isApart(isApart, turnOf(o, a, b), along, 0);
  }
  // Along the line between the middles, linear in time.
  const PlanePath &a = plane_[e.from], &b = plane_[e.to], &c = plane_[f.from],
                  &d = plane_[f.to];
  double line[2];
  for (int k = 0; k < 2; ++k)
    line[k] = ((c.t0[k] + d.t0[k]) + (c.t1[k] + d.t1[k])) -
              ((a.t0[k] + b.t0[k]) + (a.t1[k] + b.t1[k]));
  const auto along = [&](const Point& p) { return line[0] * p[0] + line[1] * p[1]; };
  const auto isParted = [&](const Point& p, const Point& q, const Point& r,
                            const Point& s) {
    // The line is a sum of four differences, as long as four of those the margin is for.
    return std::max(along(p), along(q)) + 4 * margin_ < std::min(along(r), along(s));
  };
  if (isParted(a.t0, b.t0, c.t0, d.t0) && isParted(a.t1, b.t1, c.t1, d.t1)) return true;
  const auto isApart = [&](const auto& self, const Quadratic(&q)[4], int depth) -> bool {
    for (int i = 0; i < 4; i += 2)
      if ((q[i].isAbove(margin_) && q[i + 1].isAbove(margin_)) ||
          (q[i].isBelow(margin_) && q[i + 1].isBelow(margin_)))
        return true;
    if (depth == kMaxDepth) return false;
    for (const bool later : {false, true}) {
      const Quadratic halves[4] = {q[0].half(later), q[1].half(later), q[2].half(later),
                                   q[3].half(later)};
      if (!self(self, halves, depth + 1)) return false;
    }
    return true;
  };
  const Quadratic turns[4] = {turnOf(e.from, e.to, f.from), turnOf(e.from, e.to, f.to),
                              turnOf(f.from, f.to, e.from), turnOf(f.from, f.to, e.to)};
  return isApart(isApart, turns, 0);
}

/// Whether the contour never touches itself during the step: edges in the order in which
/// their sweeps begin along x, each against those that begin before it ends.
bool NormalCones::isContourSimple(std::size_t region) {
  const std::size_t first = contours_[region].first_edge;
  const std::size_t count = contours_[region + 1].first_edge - first;
  extents_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const PlanePath &a = plane_[edges_[first + i].from],
                    &b = plane_[edges_[first + i].to];
    Extent extent;
    extent.edge = static_cast<std::uint32_t>(i);
    for (int k = 0; k < 2; ++k) {
      extent.lo[k] = std::min(std::min(a.t0[k], a.t1[k]), std::min(b.t0[k], b.t1[k]));
      extent.hi[k] = std::max(std::max(a.t0[k], a.t1[k]), std::max(b.t0[k], b.t1[k]));
    }
    extents_.push_back(extent);
  }
  std::sort(extents_.begin(), extents_.end(),
            [](const Extent& a, const Extent& b) { return a.lo[0] < b.lo[0]; });
  // What coordinates are off by is far below the square root of the margin.
  const double slack = std::sqrt(margin_) * 0x1p-20;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const Extent &a = extents_[i], &b = extents_[j];
      if (b.lo[0] > a.hi[0] + slack) break;
      if (b.lo[1] > a.hi[1] + slack || a.lo[1] > b.hi[1] + slack) continue;
      if (!areApart(edges_[first + a.edge], edges_[first + b.edge])) return false;
    }
  return true;
}

/// Whether the contour winds once around what lies to the left of it, at t = 0: around
/// the middle of each seed, by the edges that a ray along y meets.
bool NormalCones::windsOnce(std::size_t region) const {
  const Contour &begin = contours_[region], &end = contours_[region + 1];
  for (std::size_t s = begin.first_seed; s < end.first_seed; ++s) {
    const ContourEdge& seed = edges_[begin.first_edge + seeds_[s]];
    const Point &p = plane_[seed.from].t0, &q = plane_[seed.to].t0;
    const Point middle = {0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])};
    if ((p[0] <= middle[0]) == (q[0] <= middle[0])) return false;  // along the ray
    // Along y the ray begins to the right of an edge that runs towards smaller x.
    int turns = p[0] > q[0] ? 1 : 0;
    for (std::size_t e = begin.first_edge; e < end.first_edge; ++e) {
      const Point &a = plane_[edges_[e].from].t0, &b = plane_[edges_[e].to].t0;
      const bool is_a_before = a[0] <= middle[0];
      if (e == begin.first_edge + seeds_[s] || is_a_before == (b[0] <= middle[0]))
        continue;
      const double side = crossAt(middle, a, b);
      if (std::abs(side) <= margin_) return false;
      // An edge above the ray's beginning that runs towards smaller x has it on its left.
      if (is_a_before ? side < 0 : side > 0) turns += is_a_before ? -1 : 1;
    }
    if (turns != 1) return false;
  }
  return true;
}

}  // namespace test
}  // namespace fcl

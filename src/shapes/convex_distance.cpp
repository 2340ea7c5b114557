// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/convex_distance.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "paths/posed_vector.h"
#include "shapes/curved_gap.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The support points of a and b, and the second minus the first.
struct SupportPair {
  Vec point[2];
  int id[2];
  Vec between;
};

/// Up to four differences, and weights of the point of their hull nearest to the origin.
struct Simplex {
  SupportPair vertex[4];
  double weight[4];
  int count{0};
};

/// The point of the hull of some differences that is nearest to the origin.
struct Nearest {
  double square{HUGE_VAL};
  Vec point{0, 0, 0};
  int count{0};
  int vertex[3]{};
  double weight[3]{};
};

void keep(const Nearest& candidate, Nearest& best) {
  if (candidate.square < best.square) best = candidate;
}

Nearest onVertex(const Simplex& s, int i) {
  Nearest out;
  out.point = s.vertex[i].between;
  out.square = dot(out.point, out.point);
  out.count = 1;
  out.vertex[0] = i;
  out.weight[0] = 1;
  return out;
}

Nearest onEdge(const Simplex& s, int i, int j) {
  const Vec &p = s.vertex[i].between, edge = s.vertex[j].between - p;
  const double square = dot(edge, edge), t = square > 0 ? -dot(p, edge) / square : 0;
  if (!(t > 0)) return onVertex(s, i);
  if (!(t < 1)) return onVertex(s, j);
  Nearest out;
  out.point = p + t * edge;
  out.square = dot(out.point, out.point);
  out.count = 2;
  out.vertex[0] = i;
  out.vertex[1] = j;
  out.weight[0] = 1 - t;
  out.weight[1] = t;
  return out;
}

Nearest onFace(const Simplex& s, int i, int j, int k) {
  const Vec x[3] = {s.vertex[i].between, s.vertex[j].between, s.vertex[k].between};
  const int id[3] = {i, j, k};
  const Vec n = cross(x[1] - x[0], x[2] - x[0]);
  const double square = dot(n, n);
  double weight[3];
  bool is_inside = square > 0;
  for (int e = 0; e < 3 && is_inside; ++e) {
    const Vec &from = x[(e + 1) % 3], to = x[(e + 2) % 3];
    weight[e] = dot(cross(to - from, -1. * from), n) / square;
    is_inside = weight[e] > 0;
  }
  Nearest best;
  if (is_inside) {
    best.point = (dot(n, x[0]) / square) * n;
    best.square = dot(best.point, best.point);
    best.count = 3;
    for (int e = 0; e < 3; ++e) {
      best.vertex[e] = id[e];
      best.weight[e] = weight[e];
    }
    return best;
  }
  for (int e = 0; e < 3; ++e) keep(onEdge(s, id[e], id[(e + 1) % 3]), best);
  return best;
}

Nearest nearestTo(const Simplex& s) {
  switch (s.count) {
    case 1:
      return onVertex(s, 0);
    case 2:
      return onEdge(s, 0, 1);
    case 3:
      return onFace(s, 0, 1, 2);
    default:
      break;
  }
  Nearest best;
  for (int i = 0; i < 4; ++i)
    keep(onFace(s, (i + 1) % 4, (i + 2) % 4, (i + 3) % 4), best);
  return best;
}

/// Keeps the vertices that hold the nearest point, in their order.
void reduce(const Nearest& nearest, Simplex& s) {
  assert(1 <= nearest.count && nearest.count <= 3);
  constexpr double kNone = -1;
  double weight[4] = {kNone, kNone, kNone, kNone};
  for (int i = 0; i < nearest.count; ++i) {
    assert(nearest.vertex[i] < s.count && nearest.weight[i] > 0);
    weight[nearest.vertex[i]] = nearest.weight[i];
  }
  int count = 0;
  for (int i = 0; i < s.count; ++i) {
    if (weight[i] == kNone) continue;
    if (count < i) s.vertex[count] = s.vertex[i];
    s.weight[count++] = weight[i];
  }
  s.count = count;
}

/// Whether a gap is proved and the distance is met: no direction shows more than how far
/// two points are apart, up to rounding. For assertions.
[[maybe_unused]] bool isConsistent(const PosedConvex& a, const PosedConvex& b,
                                   const ConvexGap& gap) {
  double size = norm(gap.point[0]) + norm(gap.point[1]);
  for (const PosedConvex* set : {&a, &b}) {
    size += norm(set->pose.translation);
    for (const Vec& corner : set->corner) size += norm(corner);
    if (set->shape) size += norm(set->shape->center()) + set->shape->box().radius;
    if (set->box) size += norm(set->box->center) + set->box->radius;
  }
  // Squares of smaller sizes underflow; a query promises no accuracy for them.
  if (!(size > 0x1p-140)) return true;
  return !(gap.gap > gap.distance + 0x1p-40 * size);
}

class GapSearch {
 public:
  GapSearch(const PosedConvex& a, const PosedConvex& b, double enough, double contact)
      : set_{&a, &b}, enough_(enough), contact_(contact) {
    out_.direction = {0, 0, 0};
    out_.gap = -HUGE_VAL;
    out_.depth = 0;
  }

  ConvexGap run(const Vec& guess, const NearestCorners& known) {
    constexpr int kMostRounds = 200, kRoundsToFlats = 3;
    if (searchCurved(guess)) return out_;
    if (!begin(known) && !add(guess)) add({1, 0, 0});
    Nearest nearest = nearestTo(simplex_);
    for (int round = 0; round < kMostRounds; ++round) {
      reduce(nearest, simplex_);
      const double distance = std::sqrt(nearest.square);
      setPoints(distance);
      if (round >= kRoundsToFlats) tryFlats(nearest.point);
      if (distance <= contact_) measureGuess(guess);
      if (distance <= contact_ || isEnough()) return out_;
      const bool is_new = addAlong(nearest.point);
      if (isEnough()) return out_;
      if (!is_new) break;
      if (simplex_.count == 4) {
        out_.depth = depthOfSimplex();
        if (out_.depth > 0) {
          setPoints(0);
          return out_;
        }
      }
      const Nearest next = nearestTo(simplex_);
      if (!(next.square < nearest.square)) break;
      nearest = next;
    }
    measureGuess(guess);
    // Near the end it rounds by more than the other method.
    if (!searchCurved(out_.direction)) tryAll();
    return out_;
  }

 private:
  /// @return whether there are corners to begin with
  bool begin(const NearestCorners& known) {
    for (int k = 0; k < known.count; ++k) {
      SupportPair& d = simplex_.vertex[simplex_.count];
      for (int side = 0; side < 2; ++side) {
        assert(!set_[side]->box && !set_[side]->isCurved());
        d.id[side] = known.corner[k][side];
        d.point[side] = set_[side]->supportOf(d.id[side], {0, 0, 0});
      }
      d.between = d.point[1] - d.point[0];
      if (isNew(d)) ++simplex_.count;
    }
    return simplex_.count > 0;
  }

  /// Newton's method. A box of a tree is far away or overlaps, as a rule, so that a few
  /// rounds of the other method are enough.
  /// @return whether there is an answer
  bool searchCurved(const Vec& guess) {
    const double length = norm(guess);
    if (set_[0]->box || set_[1]->box || !(length > 0x1p-500) ||
        !(set_[0]->isCurved() || set_[1]->isCurved()))
      return false;
    ConvexGap found = out_;
    const bool is_found = CurvedGapSearch(*set_[0], *set_[1], enough_, contact_)
                              .run((1 / length) * guess, found);
    out_.direction = found.direction;
    out_.gap = found.gap;
    if (is_found) out_ = found;
    return is_found;
  }

  double depthOfSimplex() {
    Vec corner[4];
    for (int i = 0; i < 4; ++i) corner[i] = simplex_.vertex[i].between;
    return depthInside(corner, simplex_.weight);
  }

  bool isEnough() const {
    return out_.gap - enough_ >= 0.5 * (out_.distance - enough_) && out_.gap > enough_;
  }

  /// The difference that is least along a direction, which is noted if it shows more.
  SupportPair measure(const Vec& n) {
    SupportPair d;
    d.point[0] = set_[0]->support(n, d.id[0]);
    d.point[1] = set_[1]->support(-1. * n, d.id[1]);
    d.between = d.point[1] - d.point[0];
    const double gap = dot(n, d.between);
    if (gap > out_.gap) {
      out_.gap = gap;
      out_.direction = n;
    }
    return d;
  }

  bool isNew(const SupportPair& d) const {
    return std::none_of(simplex_.vertex, simplex_.vertex + simplex_.count,
                        [&](const SupportPair& other) {
                          return maxNorm(d.between - other.between) == 0;
                        });
  }

  /// The search from known corners has not looked along the guess.
  void measureGuess(const Vec& guess) {
    const double length = norm(guess);
    if (length > 0x1p-500) measure((1 / length) * guess);
  }

  /// @return whether the simplex has grown
  bool add(const Vec& direction) {
    const double length = norm(direction);
    if (!(length > 0x1p-500)) return false;
    const SupportPair d = measure((1 / length) * direction);
    if (!isNew(d)) return false;
    assert(simplex_.count < 4);
    simplex_.vertex[simplex_.count++] = d;
    return true;
  }

  /// The direction of a simplex has less rounding than the line to its nearest point.
  bool addAlong(const Vec& nearest) {
    const Vec exact = perpendicular(nearest);
    return add(exact) || (maxNorm(exact - nearest) > 0 && add(nearest));
  }

  Vec perpendicular(const Vec& nearest) const {
    const auto vertex = [this](int i) -> const Vec& {
      return simplex_.vertex[i].between;
    };
    Vec n = nearest;
    if (simplex_.count == 2) {
      const Vec edge = vertex(1) - vertex(0);
      n = cross(edge, cross(vertex(0), edge));
    } else if (simplex_.count == 3) {
      n = cross(vertex(1) - vertex(0), vertex(2) - vertex(0));
    }
    if (!(norm(n) > 0x1p-500)) return nearest;
    return dot(n, nearest) < 0 ? -1. * n : n;
  }

  /// Flat sides that nearly touch are parallel to them up to rounding, and the line
  /// between nearest points is not.
  void tryFlats(const Vec& nearest) {
    constexpr double kLeastCosine = 0.5;
    const double length = norm(nearest);
    for (const PosedConvex* set : set_) {
      const Vec n = set->flatNormal(nearest);
      const double size = norm(n), cosine = dot(n, nearest);
      if (!(size > 0x1p-500) || !(std::abs(cosine) > kLeastCosine * size * length))
        continue;
      measure(((cosine > 0 ? 1 : -1) / size) * n);
    }
  }

  /// Directions that are at right angles to edges or faces of the simplex.
  void tryAll() {
    const auto vertex = [this](int i) -> const Vec& {
      return simplex_.vertex[i].between;
    };
    const auto both = [this](const Vec& n) {
      const double length = norm(n);
      if (!(length > 0x1p-500)) return;
      measure((1 / length) * n);
      measure((-1 / length) * n);
    };
    const int count = simplex_.count;
    for (int i = 0; i < count; ++i) {
      both(vertex(i));
      for (int j = i + 1; j < count; ++j) {
        const Vec edge = vertex(j) - vertex(i);
        both(cross(edge, cross(vertex(i), edge)));
        for (int k = j + 1; k < count; ++k) both(cross(edge, vertex(k) - vertex(i)));
      }
    }
  }

  /// The weights of a thin simplex round so much that their sum is not 1, and a point of
  /// it would be outside.
  void setPoints(double distance) {
    double sum = 0;
    for (int i = 0; i < simplex_.count; ++i) sum += simplex_.weight[i];
    assert(!(sum <= 0));
    for (int side = 0; side < 2; ++side) {
      Vec point{0, 0, 0};
      unsigned corners = 0;
      for (int i = 0; i < simplex_.count; ++i) {
        point = point + (simplex_.weight[i] / sum) * simplex_.vertex[i].point[side];
        if (!set_[side]->shape && !set_[side]->box)
          corners |= 1U << simplex_.vertex[i].id[side];
      }
      out_.point[side] = point;
      out_.corners[side] = corners;
    }
    noteCorners();
    // A thin face may round to less.
    out_.distance = std::max(distance, norm(out_.point[1] - out_.point[0]));
  }

  void noteCorners() {
    NearestCorners& nearest = out_.nearest;
    nearest.count = 0;
    if (simplex_.count > 3) return;
    for (const PosedConvex* set : set_)
      if (set->box || set->isCurved()) return;
    for (; nearest.count < simplex_.count; ++nearest.count)
      for (int side = 0; side < 2; ++side)
        nearest.corner[nearest.count][side] = simplex_.vertex[nearest.count].id[side];
  }

  const PosedConvex* set_[2];
  double enough_, contact_;
  Simplex simplex_;
  ConvexGap out_{};
};

}  // namespace

ConvexGap convexGap(const PosedConvex& a, const PosedConvex& b, const Vec& guess,
                    double enough, double contact, const NearestCorners& known) {
  assert(!(enough < 0));
  const ConvexGap gap = GapSearch(a, b, enough, contact).run(guess, known);
  assert(isConsistent(a, b, gap));
  assert(isUnit(gap.direction) || maxNorm(gap.direction) == 0);
  assert(!(gap.distance < 0) && !(gap.depth < 0));
  return gap;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

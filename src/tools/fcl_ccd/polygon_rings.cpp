// SPDX-License-Identifier: BSD-3-Clause
#include "polygon_rings.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "elementary/predicates.h"

namespace fcl_ccd {
namespace {

/// An edge between two vertices, whichever way it goes.
struct Side {
  int low, high;  ///< ids of the vertices
  bool is_upward;
  int corner;  ///< where the edge begins
};

}  // namespace

PolygonRings::PolygonRings(const Vertices& vertices, const std::vector<int>& ids,
                           int axis, bool turns_left)
    : axis_(axis),
      sign_(turns_left ? 1 : -1),
      u_(static_cast<std::size_t>((axis + 1) % 3)),
      v_(static_cast<std::size_t>((axis + 2) % 3)) {
  if (!turns_left) std::swap(u_, v_);
  const int size = static_cast<int>(ids.size());
  points_.reserve(ids.size());
  for (int i = 0; i < size; ++i) {
    const auto& p = vertices[static_cast<std::size_t>(ids[static_cast<std::size_t>(i)])];
    points_.push_back({{p[0], p[1], p[2]}});
    next_.push_back((i + 1) % size);
    before_.push_back((i + size - 1) % size);
  }
  removePairsOfEdges(ids);
  removeFrom(corners());
}

std::vector<int> PolygonRings::corners() const {
  std::vector<int> corners;
  for (int i = 0; i < static_cast<int>(size()); ++i)
    if (!isRemoved(i)) corners.push_back(i);
  return corners;
}

int PolygonRings::turn(int a, int b, int c) const {
  return sign_ * fcl::detail::deformable::crossSign(point(a).x, point(b).x, point(a).x,
                                                    point(c).x, axis_);
}

void PolygonRings::remove(int corner) {
  const int a = before(corner), b = next(corner);
  assert(next(a) == corner && before(b) == corner);
  next_[static_cast<std::size_t>(a)] = b;
  before_[static_cast<std::size_t>(b)] = a;
  next_[static_cast<std::size_t>(corner)] = -1;
}

/// Removes corners that are against (1), until there are none. Each removal may make its
/// neighbours so.
void PolygonRings::removeFrom(std::vector<int> candidates) {
  while (!candidates.empty()) {
    const int corner = candidates.back();
    candidates.pop_back();
    if (isRemoved(corner)) continue;
    const int a = before(corner), b = next(corner);
    if (a == b) {  // what is left of a ring without area
      next_[static_cast<std::size_t>(a)] = next_[static_cast<std::size_t>(corner)] = -1;
      continue;
    }
    if (!isAtSamePlace(a, corner) && !isAtSamePlace(a, b)) continue;
    removed_.push_back({a, corner, b});
    remove(corner);
    candidates.push_back(a);
    candidates.push_back(b);
  }
}

void PolygonRings::removePairsOfEdges(const std::vector<int>& ids) {
  std::vector<Side> sides;
  sides.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const int from = ids[i], to = ids[(i + 1) % ids.size()];
    sides.push_back(
        {std::min(from, to), std::max(from, to), from < to, static_cast<int>(i)});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::array<int, 4>{a.low, a.high, a.is_upward, a.corner} <
           std::array<int, 4>{b.low, b.high, b.is_upward, b.corner};
  });
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &there = sides[i], &back = sides[i + 1];
    // Two edges between these vertices, not more, one there and one back.
    const auto isSame = [&](std::size_t k) {
      return k < sides.size() && sides[k].low == there.low && sides[k].high == there.high;
    };
    if (!isSame(i + 1) || isSame(i + 2) || (i > 0 && isSame(i - 1)) ||
        there.is_upward == back.is_upward)
      continue;
    const int p = there.corner, q_again = back.corner;
    if (isRemoved(p) || isRemoved(q_again)) continue;
    const int q = next(p), p_again = next(q_again);
    // A spike, which removeFrom() removes.
    if (q == q_again || p == p_again) continue;
    // p takes what comes after p_again, and q_again what comes after q.
    const int after_p = next(p_again), after_q = next(q);
    next_[static_cast<std::size_t>(p)] = after_p;
    before_[static_cast<std::size_t>(after_p)] = p;
    next_[static_cast<std::size_t>(q_again)] = after_q;
    before_[static_cast<std::size_t>(after_q)] = q_again;
    next_[static_cast<std::size_t>(p_again)] = next_[static_cast<std::size_t>(q)] = -1;
  }
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
//
// The last stage of the elementary test: the definition itself, evaluated with integers.
// Coordinates are doubles, hence integers times a common power of two; everything below
// is a polynomial in t with integer coefficients, and times of contact are its roots.
#include "elementary/exact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "elementary/in_plane.h"
#include "elementary/predicates.h"
#include "numerics/exact_polynomial.h"
#include "numerics/integer_coordinates.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using MovingPoint = std::array<Polynomial, 3>;

MovingPoint operator-(const MovingPoint& a, const MovingPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Polynomial crossComponent(const MovingPoint& a, const MovingPoint& b, std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  return a[i] * b[j] - a[j] * b[i];
}

MovingPoint cross(const MovingPoint& a, const MovingPoint& b) {
  return {crossComponent(a, b, 0), crossComponent(a, b, 1), crossComponent(a, b, 2)};
}

/// The four paths as integers, and the clock that they run by.
///
/// All coordinates of a frame share a power of two. Frames of very different size have
/// one each: (1 - t) 2^p a + t 2^q b is, up to its length, which decides nothing, (1 - s)
/// a + s b for s / (1 - s) = 2^(q - p) t / (1 - t), and s runs from 0 to 1 as t does.
struct IntegerPaths {
  std::array<MovingPoint, 4> points;
  /// q - p; 0 where s = t.
  int clock_exponent{0};

  explicit IntegerPaths(const FeaturePoints& x) {
    // The larger numbers of one power for both cost less than fractions for t.
    constexpr int kMaxCommonSpread = 64;
    DigitRange range[2];
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        range[0].add(x[i].t0[k]);
        range[1].add(x[i].t1[k]);
      }
    int lowest[2];
    lowest[0] = lowest[1] = std::min(range[0].lowest, range[1].lowest);
    if (!range[0].isEmpty() && !range[1].isEmpty() &&
        std::abs(range[0].highest - range[1].highest) > kMaxCommonSpread) {
      for (int frame = 0; frame < 2; ++frame) lowest[frame] = range[frame].lowest;
      clock_exponent = lowest[1] - lowest[0];
    }
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        const Integer from = toInteger<Integer>(x[i].t0[k], lowest[0]);
        points[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
            Polynomial{from, toInteger<Integer>(x[i].t1[k], lowest[1]) - from};
      }
  }
};

/// The conditions of a contact.
///
/// With u, v, w, n = v x w as in elementary.cpp, the features' points are coplanar
/// where u . n = 0. Seen along an axis k in which n does not vanish, their plane is seen
/// one to one, and the weights of the contact are quotients of components k: VF u = beta
/// v + gamma w with beta = (u x w)_k / n_k, gamma = (v x u)_k / n_k, 1 - beta - gamma =
/// ((b-p) x (c-p))_k / n_k; EE u = s v - r w with s = (u x w)_k / n_k, 1 - s = ((b-c) x
/// w)_k / n_k, r = (u x v)_k / n_k, 1 - r = (v x (d-a))_k / n_k. All have to be >= 0.
///
/// Where n = 0, a triangle without area is the union of its edges, and two parallel edges
/// touch in an end of one of them.
class ExactPair {
 public:
  ExactPair(ContinuousContactKind kind, const FeaturePoints& x, const IntegerPaths& paths)
      : kind_(kind), p_(paths.points) {
    const auto& [a, b, c, d] = p_;
    u_ = isVertexFace() ? a - b : c - a;
    v_ = isVertexFace() ? c - b : b - a;
    w_ = isVertexFace() ? d - b : d - c;
    if (const int axis = axisOfCommonPlane(x); axis >= 0) {
      const auto k = static_cast<std::size_t>(axis);
      n_[k] = crossComponent(v_, w_, k);
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      n_[k] = crossComponent(v_, w_, k);
      volume_ += u_[k] * n_[k];
    }
  }

  /// Times one of which is the first contact after 0, if there is any.
  std::vector<Root> candidates() const {
    std::vector<Root> times;
    const auto addRootsOf = [&times](const Polynomial& p) {
      if (p.degree() < 1) return;
      for (Root& root : rootsInUnitInterval(p)) times.push_back(std::move(root));
    };
    if (!volume_.isZero()) {
      addRootsOf(volume_);
      return times;
    }
    // Always coplanar: contacts begin where a weight changes its sign.
    for (std::size_t k = 0; k < 3; ++k)
      if (!n_[k].isZero()) {
        addRootsOf(n_[k]);
        for (std::size_t i = 0; i < numWeights(); ++i) addRootsOf(weight(i, k));
        return times;
      }
    // Always parallel, or without area. Parallel edges touch only while a is on the line
    // of cd, or c is d.
    if (!isVertexFace())
      for (const Polynomial& off : cross(u_, w_))
        if (!off.isZero()) {
          addRootsOf(off);
          return times;
        }
    for (const auto& [p, q, r] : pointsOnSegments()) {
      const MovingPoint off = cross(p - q, r - q);
      const auto not_zero =
          std::find_if(off.begin(), off.end(), [](const auto& o) { return !o.isZero(); });
      if (not_zero != off.end()) {
        addRootsOf(*not_zero);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        addRootsOf(p[k] - q[k]);
        addRootsOf(p[k] - r[k]);
      }
    }
    return times;
  }

  /// Whether the features touch at one of the candidates().
  bool touchAt(Root& t) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const int sign = t.signOf(n_[k]);
      if (sign == 0) continue;
      for (std::size_t i = 0; i < numWeights(); ++i)
        if (sign * t.signOf(weight(i, k)) < 0) return false;
      return true;
    }
    for (const auto& [p, q, r] : pointsOnSegments())
      if (isOnSegmentAt(t, p, q, r)) return true;
    return false;
  }

 private:
  struct PointAndSegment {
    const MovingPoint &p, &q, &r;
  };

  bool isVertexFace() const { return kind_ == ContinuousContactKind::kVertexFace; }
  std::size_t numWeights() const { return isVertexFace() ? 3 : 4; }

  /// Component k of the cross product that gives weight i.
  Polynomial weight(std::size_t i, std::size_t k) const {
    const auto& [a, b, c, d] = p_;
    const auto component = [k](const MovingPoint& x, const MovingPoint& y) {
      return crossComponent(x, y, k);
    };
    if (i == 0) return component(u_, w_);
    if (isVertexFace()) return i == 1 ? component(v_, u_) : component(c - a, d - a);
    return i == 1   ? component(b - c, w_)
           : i == 2 ? component(u_, v_)
                    : component(v_, d - a);
  }

  std::vector<PointAndSegment> pointsOnSegments() const {
    const auto& [a, b, c, d] = p_;
    if (isVertexFace()) return {{a, b, c}, {a, c, d}, {a, d, b}};
    return {{a, c, d}, {b, c, d}, {c, a, b}, {d, a, b}};
  }

  static bool isOnSegmentAt(Root& t, const MovingPoint& p, const MovingPoint& q,
                            const MovingPoint& r) {
    for (std::size_t k = 0; k < 3; ++k)
      if (t.signOf(p[k] - q[k]) * t.signOf(p[k] - r[k]) > 0) return false;
    const MovingPoint off = cross(p - q, r - q);
    return std::all_of(off.begin(), off.end(),
                       [&t](const Polynomial& o) { return t.signOf(o) == 0; });
  }

  ContinuousContactKind kind_;
  std::array<MovingPoint, 4> p_;
  MovingPoint u_, v_, w_, n_;
  Polynomial volume_;
};

}  // namespace

ElementaryResult decideExactly(ContinuousContactKind kind, const FeaturePoints& x,
                               double toc_err) {
  const bool touch_at_start = kind == ContinuousContactKind::kVertexFace
                                  ? isOnTriangle(x[0].t0, x[1].t0, x[2].t0, x[3].t0)
                                  : doSegmentsTouch(x[0].t0, x[1].t0, x[2].t0, x[3].t0);
  if (touch_at_start) return {Answer::kYes, 0, 0, DecidedBy::kExact};
  const IntegerPaths paths(x);
  const ExactPair pair(kind, x, paths);
  std::vector<Root> times = pair.candidates();
  std::sort(times.begin(), times.end(),
            [](const Root& a, const Root& b) { return a.lowerBound() < b.lowerBound(); });
  bool touch = false;
  double lo = 1, hi = 1, latest = 1;
  for (Root& t : times) {
    if (t.lowerBound() > latest) break;
    if (!pair.touchAt(t)) continue;
    const auto [t_lo, t_hi] = t.bracket(toc_err, paths.clock_exponent);
    lo = touch ? std::min(lo, t_lo) : t_lo;
    hi = touch ? std::min(hi, t_hi) : t_hi;
    latest = std::min(latest, t.upperBound());
    touch = true;
  }
  if (!touch) return {Answer::kNo, 0, 0, DecidedBy::kExact};
  return {Answer::kYes, lo, hi, DecidedBy::kExact};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

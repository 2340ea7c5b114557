// SPDX-License-Identifier: BSD-3-Clause
//
// The filter before the root solve, after Tang, Manocha, Tong 2010, section 3.3. The
// paper uses the signs of coefficients without regard to rounding.
#include "elementary/coplanarity_filter.h"

#include <cstdint>
#include <cstring>

#include "base/attributes.h"
#include "base/short_vector.h"
#include "elementary/accurate_pair.h"
#include "elementary/pair_table.h"
#include "numerics/error_bounds.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

FramePair swapped(const FramePair& a) { return shuffle<1, 0>(a, a); }
FramePair max(const FramePair& a, const FramePair& b) { return a > b ? a : b; }
FramePair abs(const FramePair& a) { return FramePair(Long2(a) & INT64_MAX); }
double smaller(const FramePair& a) { return a[0] < a[1] ? a[0] : a[1]; }
double larger(const FramePair& a) { return a[0] > a[1] ? a[0] : a[1]; }

/// The difference of two vertices at both ends of the step, or of the window.
struct DifferencePair {
  FramePair x, y, z;

  void restrict(const FramePair& window) {
    const FramePair rest = 1 - window;
    for (FramePair* c : {&x, &y, &z})
      *c = rest * shuffle<0, 0>(*c, *c) + window * shuffle<1, 1>(*c, *c);
  }
};

DifferencePair swapped(const DifferencePair& a) {
  return {swapped(a.x), swapped(a.y), swapped(a.z)};
}
FramePair dot(const DifferencePair& a, const DifferencePair& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
DifferencePair cross(const DifferencePair& a, const DifferencePair& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// @param most  raised to the absolute values of the coordinates
DifferencePair differenceOf(const VertexPath& p, const VertexPath& q, FramePair& most) {
  static_assert(sizeof(VertexPath) == 3 * sizeof(FramePair), "t0 and t1 in a row");
  const auto part = [](const VertexPath& path, int i) {
    FramePair v;
    std::memcpy(&v, reinterpret_cast<const char*>(&path) + 16 * i, sizeof(v));
    return v;
  };
  const FramePair a = part(p, 0) - part(q, 0), b = part(p, 1) - part(q, 1),
                  c = part(p, 2) - part(q, 2);
  most = max(most, max(max(abs(a), abs(b)), abs(c)));
  return {shuffle<0, 3>(a, b), shuffle<1, 2>(a, c), shuffle<0, 3>(b, c)};
}

/// coplanarityInDoubles() in a form that this file can inline. Both frames are computed
/// side by side: reversed time turns the coefficients of the volume u . (v x w) into each
/// other. coplanarity() in kernels/ has the same operations for eight pairs.
Coplanarity inDoubles(ContinuousContactKind kind, const FeaturePoints& x,
                      double window_lo, double window_hi) {
  const PairTable& table = pairTable(kind);
  FramePair most_coordinate = {0, 0};
  const auto difference = [&](PairDifference i) {
    const auto [to, from] = table.difference[i];
    return differenceOf(x[to], x[from], most_coordinate);
  };
  DifferencePair u = difference(kU), v = difference(kV), w = difference(kW);
  if (window_lo != 0 || window_hi != 1)
    for (DifferencePair* d : {&u, &v, &w}) d->restrict(FramePair{window_lo, window_hi});
  const DifferencePair n = cross(v, w), half = cross(v, swapped(w));
  const DifferencePair middle = {half.x + swapped(half.x), half.y + swapped(half.y),
                                 half.z + swapped(half.z)};
  const FramePair outer = dot(u, n), inner = dot(swapped(u), n) + dot(u, middle);

  // A NaN coordinate makes both inner coefficients NaN. A comparison with NaN selects the
  // right operand here, so that least and most are NaN, and nothing is proved.
  const FramePair scaled = kInnerScale * inner;
  const double least = smaller(outer < scaled ? outer : scaled),
               most = larger(outer > scaled ? outer : scaled);
  const double norm = larger(most_coordinate), bound = kOuterBound * (norm * norm * norm);
  const bool is_sure = least > bound || most < -bound;
  if (!is_sure && !(least > 0 || most < 0)) return Coplanarity::kPossible;
  if (!(norm > kLeastFilterNorm && norm < kMostFilterNorm)) return Coplanarity::kPossible;
  return is_sure ? Coplanarity::kNever : Coplanarity::kUnclear;
}

}  // namespace

Coplanarity coplanarityInDoubles(ContinuousContactKind kind, const FeaturePoints& x,
                                 double window_lo, double window_hi) {
  return inDoubles(kind, x, window_lo, window_hi);
}

// Not inlined, so that it does not slow down the filter in doubles.
FCL_CCD_NOINLINE bool mayBecomeCoplanarAccurately(ContinuousContactKind kind,
                                                  const FeaturePoints& x,
                                                  double window_lo, double window_hi) {
  return !AccuratePair(kind, x).hasNoRoot(window_lo, window_hi);
}

bool mayBecomeCoplanar(ContinuousContactKind kind, const FeaturePoints& x,
                       double window_lo, double window_hi) {
  const Coplanarity coplanarity = inDoubles(kind, x, window_lo, window_hi);
  if (coplanarity == Coplanarity::kUnclear)
    return mayBecomeCoplanarAccurately(kind, x, window_lo, window_hi);
  return coplanarity == Coplanarity::kPossible;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "curved/curved_candidates.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <tuple>
#include <utility>
#include <vector>

#include "base/bits.h"
#include "curved/curved_query.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The corners of two triangles at both ends of a span. In between, no corner is further
/// from the straight line between its two places than the deviation of its body.
struct SpannedPair {
  /// By end of the span, then a's corners 0-2 and b's 3-5.
  double corner[2][6][3];
  double deviation[2];

  SpannedPair(const MovingBody& a, const BodyTriangle& of_a, const MovingBody& b,
              const BodyTriangle& of_b, double t0, double t1) {
    span(a, of_a, t0, t1, 0);
    span(b, of_b, t0, t1, 1);
  }

  /// Whether the features of a pair are further apart than the margin along a coordinate
  /// during the whole span. The gap of two points that go straight is linear in time, so
  /// that both ends decide.
  bool areApart(int bit, double margin) const {
    const unsigned char(&point)[4] = kFeaturePoints[bit];
    const int num_first = bit < kNumVertexFacePairs ? 1 : 2;
    const double apart = margin + deviation[0] + deviation[1];
    assert(!(apart < margin));
    for (int k = 0; k < 3; ++k) {
      bool is_below = true, is_above = true;
      for (const auto& at : corner)
        for (int i = 0; i < num_first; ++i)
          for (int j = num_first; j < 4; ++j) {
            const double gap = at[point[j]][k] - at[point[i]][k];
            is_below &= gap > apart;
            is_above &= -gap > apart;
          }
      if (is_below || is_above) return true;
    }
    return false;
  }

 private:
  void span(const MovingBody& body, const BodyTriangle& triangle, double t0, double t1,
            int side) {
    const AccelerationBound bound = body.path().acceleration(t0, t1);
    deviation[side] = 0.125 * (t1 - t0) * (t1 - t0) * accelerationOf(bound, triangle);
    for (int end = 0; end < 2; ++end) {
      const double t = end == 0 ? t0 : t1;
      const Pose pose = body.path().pose(t);
      for (int i = 0; i < 3; ++i)
        set(corner[end][3 * side + i],
            posed(pose, triangle.corner[0][i], triangle.corner[1][i], t));
    }
  }
};

/// A pair of features has the same name whichever triangles it was found in.
using Name = std::array<std::uint32_t, 6>;

Name nameOf(const FeatureCandidate& candidate) {
  std::uint32_t v[4];
  std::copy(candidate.vertices, candidate.vertices + 4, v);
  std::sort(v + (candidate.kind == ContinuousContactKind::kVertexFace ? 1 : 2), v + 4);
  return {static_cast<std::uint32_t>(candidate.kind),
          static_cast<std::uint32_t>(!candidate.first_on_a),
          v[0],
          v[1],
          v[2],
          v[3]};
}

class CandidateList {
 public:
  CandidateList(const MovingBody& a, const MovingBody& b, double min_distance)
      : a_(a),
        b_(b),
        at_distance_(min_distance > 0),
        margin_(min_distance + BodyTolerance(a, b, min_distance).touching) {}

  void add(const NearTriangles& near) {
    assert(0 <= near.t0 && near.t0 <= near.t1 && near.t1 <= 1);
    const BodyTriangle a = a_.triangle(near.place[0]), b = b_.triangle(near.place[1]);
    const SpannedPair spanned(a_, a, b_, b, near.t0, near.t1);
    for (unsigned pairs = wantedPairs(a.owned, b.owned, at_distance_); pairs != 0;
         pairs &= pairs - 1) {
      const int bit = lowestBit(pairs);
      if (!spanned.areApart(bit, margin_)) add(bit, a, b, near);
    }
  }

  /// Each pair of features once, with a window that contains all its windows.
  std::vector<FeatureCandidate> take() {
    std::sort(list_.begin(), list_.end(), [](const auto& x, const auto& y) {
      return std::tie(x.first, x.second.triangles[0], x.second.triangles[1],
                      x.second.window_lo) < std::tie(y.first, y.second.triangles[0],
                                                     y.second.triangles[1],
                                                     y.second.window_lo);
    });
    std::vector<FeatureCandidate> out;
    const Name* last = nullptr;
    for (const auto& [name, candidate] : list_) {
      if (!last || *last != name) {
        out.push_back(candidate);
      } else {
        out.back().window_lo = std::min(out.back().window_lo, candidate.window_lo);
        out.back().window_hi = std::max(out.back().window_hi, candidate.window_hi);
      }
      last = &name;
      assert(isPartOfStep(out.back().window_lo, out.back().window_hi));
    }
    return out;
  }

 private:
  void add(int bit, const BodyTriangle& a, const BodyTriangle& b,
           const NearTriangles& near) {
    const FeatureCandidate candidate{idsOf(bit, a, b), near.t0, near.t1, {}};
    list_.emplace_back(nameOf(candidate), candidate);
  }

  const MovingBody& a_;
  const MovingBody& b_;
  bool at_distance_;
  double margin_;
  std::vector<std::pair<Name, FeatureCandidate>> list_;
};

}  // namespace

bool curvedCandidates(const MovingBody& a, const MovingBody& b,
                      const FeatureCandidateSink& sink, double min_distance) {
  constexpr std::size_t kBlock = 1024;
  const BodiesNearOrigin near(a, b);
  CandidateList list(near.a, near.b, min_distance);
  for (const NearTriangles& triangles : nearTriangles(near.a, near.b, min_distance))
    list.add(triangles);
  const std::vector<FeatureCandidate> all = list.take();
  for (std::size_t i = 0; i < all.size(); i += kBlock)
    if (!sink(all.data() + i, std::min(kBlock, all.size() - i))) return false;
  return true;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The points of eight pairs of features, side by side.
//
// Included once for each of Highway's targets. So it has no ordinary include guard.
#include "elementary/pair_table.h"
#include "kernels/kernels.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"

#if defined(FCL_CCD_EIGHT_FEATURES_INCLUDED) == defined(HWY_TARGET_TOGGLE)
#ifdef FCL_CCD_EIGHT_FEATURES_INCLUDED
#undef FCL_CCD_EIGHT_FEATURES_INCLUDED
#else
#define FCL_CCD_EIGHT_FEATURES_INCLUDED
#endif

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// Eight pairs of features, given by codes (featureCode()).
class EightFeatures {
 public:
  FCL_CCD_INLINE EightFeatures(const TrianglePair* pairs, const std::uint32_t* codes) {
    for (std::size_t lane = 0; lane < kEight; ++lane) {
      vertices_[lane] = pairs[codePair(codes[lane])].x;
      corners_[lane] = kFeaturePoints[codeBit(codes[lane])];
    }
  }
  FCL_CCD_INLINE const TreeVertex& point(std::size_t i, std::size_t lane) const {
    return *vertices_[lane][corners_[lane][i]];
  }

 private:
  /// For each pair, the six vertices of both triangles, and the indices of the four
  /// points among them.
  const TreeVertex* const* vertices_[kEight];
  const unsigned char* corners_[kEight];
};

/// The points of eight pairs at t = 0 and at t = 1.
struct Points {
  static constexpr bool kHaveEnd = true;
  Vectors t0[4], t1[4];

  FCL_CCD_INLINE explicit Points(const EightPoints& pairs) {
    load([&pairs](std::size_t i, std::size_t lane)
             HWY_ATTR -> const TreeVertex& { return *pairs.x[i][lane]; });
  }

  FCL_CCD_INLINE explicit Points(const EightFeatures& features) {
    load([&features](std::size_t i, std::size_t lane)
             HWY_ATTR -> const TreeVertex& { return features.point(i, lane); });
  }

 private:
  /// @param vertex  vertex(i, lane) is point i of the pair in a lane
  template <typename Vertex>
  FCL_CCD_INLINE void load(const Vertex& vertex) {
    for (std::size_t i = 0; i < 4; ++i) {
      const TreeVertex* x[kEight];
      for (std::size_t lane = 0; lane < kEight; ++lane) x[lane] = &vertex(i, lane);
      // The columns are loaded into their final place: a copy of them, as loadPaths()
      // makes it, would cost 2% of a test.
      loadColumns([&x](std::size_t lane) HWY_ATTR { return x[lane]->t0; }, t0[i].x,
                  t0[i].y, t0[i].z);
      loadColumns([&x](std::size_t lane) HWY_ATTR { return x[lane]->t1; }, t1[i].x,
                  t1[i].y, t1[i].z);
    }
  }
};

/// The points of eight pairs at t = 0.
struct StartPoints {
  static constexpr bool kHaveEnd = false;
  Vectors t0[4];

  FCL_CCD_INLINE explicit StartPoints(const EightFeatures& features) {
    for (std::size_t i = 0; i < 4; ++i)
      loadColumns([&features, i](std::size_t lane)
                      HWY_ATTR { return features.point(i, lane).t0; },
                  t0[i].x, t0[i].y, t0[i].z);
  }
};

/// As Difference::at() in moving_pair.h. There is no special case for 0 and 1. So if a
/// number is not finite in one frame, the result is not finite at any time.
FCL_CCD_INLINE Vectors at(const Vectors& t0, const Vectors& t1, const Doubles& t) {
  const Doubles s = broadcast<kEight>(1.) - t;
  return {s * t0.x + t * t1.x, s * t0.y + t * t1.y, s * t0.z + t * t1.z};
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#endif

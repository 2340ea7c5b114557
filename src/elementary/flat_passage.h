// SPDX-License-Identifier: BSD-3-Clause
//
// Features inside of a flat part of a mesh. A vertex, or an edge, whose triangles lie
// around it in one plane is a place of a flat disc like any other. Nothing passes through
// the disc but along its normal. So what meets such a feature from the side, as the side
// face of a box that slides over a floor does, need not stop.
#ifndef FCL_CCD_ELEMENTARY_FLAT_PASSAGE_H
#define FCL_CCD_ELEMENTARY_FLAT_PASSAGE_H

#include <cstdint>
#include <vector>

#include "elementary/moving_pair.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A triangle at a vertex: its two other vertices.
struct StarTriangle {
  std::uint32_t ids[2];
  VertexPath x[2];
};

/// @brief The triangles at the vertices of a pair of features, and the ids of these.
struct PairStars {
  std::uint32_t ids[4];
  /// Empty if they are not known.
  std::vector<StarTriangle> at[4];
};

/// @brief A pair of which one feature may be inside of a flat part of its mesh, from the
/// first touch on.
///
/// The normal of the disc is that of the largest triangle at the feature at toc_lo. With
/// s the speed, e = 2^-20 s, and t the time, the proofs of passes() are:
/// - the triangles at the feature keep within e of the plane with this normal through it,
///   and lie around it on all sides. An end of an edge that may be touched has such
///   triangles as well;
/// - all points of the other feature are on one side of the plane, or beyond it by up to
///   e + s t, and one is above it. The side is that of the point which is furthest from
///   the plane at toc_lo. Points that move faster than s towards the plane are beyond it
///   by e at most;
/// - or they are within e + s t of the plane, on either side, and move no faster than s.
/// Then the other feature is no deeper in the disc than 2 e + s t. All numbers have
/// bounds on their rounding.
class FlatPassage {
 public:
  /// @param flat  0 or 1: the feature that may be flat
  /// @param pair, x, stars  kept by reference
  FlatPassage(const MovingPair& pair, const FeaturePoints& x, const PairStars& stars,
              int flat, double toc_lo, double speed);

  enum class Answer {
    kUnknown,
    kBeside,  ///< a part of it stays on its side, by more than e
    kAcross   ///< it is not deep, but may be on the other side as a whole
  };

  /// @param sideOf  sideOf(i) is the sign of inside condition i in [lo, hi]
  template <typename SideOf>
  Answer passes(double lo, double hi, SideOf&& sideOf) const {
    const Answer answer = besideOrAcross(lo, hi);
    if (answer == Answer::kUnknown || !isFlatAtFeature(lo, hi)) return Answer::kUnknown;
    for (int i = 0; is_edge_ && i < 2; ++i)
      // The condition of a place along an edge is positive if it is not at this end.
      if (sideOf(first_ + i) != Side::kPositive && !isFlatAtVertex(first_ + i, lo, hi))
        return Answer::kUnknown;
    return answer;
  }

 private:
  Answer besideOrAcross(double lo, double hi) const;
  bool isFlatAtFeature(double lo, double hi) const {
    return is_edge_ ? isFlatAtEdge(lo, hi) : isFlatAtVertex(first_, lo, hi);
  }
  bool isFlatAtVertex(int point, double lo, double hi) const;
  bool isFlatAtEdge(double lo, double hi) const;
  void setNormal();
  void setSide();
  bool isInPlane(const StepSegment& from_first) const;
  int turnOf(const StepSegment& v, const StepSegment& w) const;

  const FeaturePoints& x_;
  const PairStars& stars_;
  /// Points first_ to first_ + 1 (of an edge) are those of the flat feature, points
  /// other_ to other_end_ - 1 those of the other one.
  bool is_edge_;
  int first_, other_, other_end_;
  double toc_lo_, speed_, tolerance_;
  Vec normal_{0, 0, 0};
  /// Of the other feature; 0: not known.
  double side_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

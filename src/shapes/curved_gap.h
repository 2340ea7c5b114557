// SPDX-License-Identifier: BSD-3-Clause
//
// The gap of two convex sets of which one is curved, by Newton's method. Gilbert's,
// Johnson's and Keerthi's method comes near to the nearest points of curved surfaces in
// small steps: it takes 30 to 80 rounds where this one takes three.
#ifndef FCL_CCD_SHAPES_CURVED_GAP_H
#define FCL_CCD_SHAPES_CURVED_GAP_H

#include "shapes/posed_convex.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The search for the direction n with the largest gap, min n . (b - a). The
/// support function of a set consists of smooth pieces (PosedConvex::pieceAt()). The gap
/// is the least of those of some pairs of pieces. Each of them has a quadratic model
/// around a direction. The direction at which the least model is largest comes next, as
/// in the bundle methods of nonsmooth optimization.
class CurvedGapSearch {
 public:
  /// @param enough, contact  as those of convexGap()
  CurvedGapSearch(const PosedConvex& a, const PosedConvex& b, double enough,
                  double contact)
      : set_{&a, &b}, enough_(enough), contact_(contact) {}

  /// @param guess  a direction from a to b
  /// @param[in,out] out  the answer; if there is none, the direction with the largest gap
  /// that was met and that gap, if it is larger
  /// @return whether there is an answer: the gap is enough, the points are near enough,
  /// the sets overlap, or rounding allows no better gap
  bool run(const Vec& guess, ConvexGap& out);

 private:
  /// A pair of pieces, its points at the direction, and its share of the nearest points.
  struct Piece {
    int of[2];
    Vec point[2], between;
    double weight;
  };
  /// The gaps of the pieces at a direction n + x e0 + y e1, as far as they are linear,
  /// and the matrix of the quadratic term that they have in common.
  struct Model {
    Vec axis[2];
    double gap[4], slope[4][2];
    double m[3];
  };
  /// A step, and the weights of the pieces that limit it.
  struct Step {
    double x, y, value;
    double weight[4];
  };
  /// A point of each set.
  struct Corner {
    Vec point[2];
  };
  static constexpr int kMostPieces = 4;

  void setPoints(const Vec& n, Piece& piece) const;
  Piece pieceAt(const Vec& n) const;
  bool isKnown(const Piece& piece) const;
  bool haveAllWeight() const;
  void keepActive(const Step& step);
  bool note(ConvexGap& out) const;
  double residualAt(const Vec& n) const;
  Model modelAt(const Vec& n, double damping) const;
  Step bestStep(const Model& model) const;
  static Vec between(const Corner& corner) { return corner.point[1] - corner.point[0]; }
  Corner cornerAt(const Vec& n) const;
  void setCorners(const Vec& n, const Model& model, double gap,
                  Corner (&corner)[4]) const;
  bool overlaps(const Vec& n, const Model& model, double gap, ConvexGap& out) const;
  double sizeOf() const;

  bool finish(const Vec& n, const Model& model, double gap, ConvexGap& out) const;

  const PosedConvex* set_[2];
  double enough_, contact_;
  Piece piece_[kMostPieces];
  int count_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

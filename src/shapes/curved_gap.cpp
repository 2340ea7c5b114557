// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/curved_gap.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "paths/posed_vector.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Whether unit vectors are at right angles to each other, up to rounding; also if they
/// are NaN. For assertions.
[[maybe_unused]] bool areAtRightAngles(const Vec& x, const Vec& y, const Vec& z) {
  constexpr double kMost = 0x1p-46;
  return isUnit(x) && isUnit(y) && isUnit(z) && !(std::abs(dot(x, y)) > kMost) &&
         !(std::abs(dot(y, z)) > kMost) && !(std::abs(dot(z, x)) > kMost);
}

/// Two unit vectors at right angles to a unit vector and to each other. Those of the
/// opposite vector are their opposites, so that the order of the sets does not matter.
void setAxes(const Vec& n, Vec (&axis)[2]) {
  // The cross products of a vector with the coordinate axes, but for that of its largest
  // coordinate.
  Vec across[2] = {{-n.z, 0, n.x}, {n.y, -n.x, 0}};
  if (std::abs(n.y) > std::abs(n.x)) across[0] = {0, n.z, -n.y};
  if (std::abs(n.z) > std::max(std::abs(n.x), std::abs(n.y))) {
    across[0] = {0, n.z, -n.y};
    across[1] = {-n.z, 0, n.x};
  }
  axis[0] = unit(across[0]);
  axis[1] = unit(across[1] - dot(across[1], axis[0]) * axis[0]);
  assert(areAtRightAngles(n, axis[0], axis[1]));
}

}  // namespace

void CurvedGapSearch::setPoints(const Vec& n, Piece& piece) const {
  piece.point[0] = set_[0]->supportOf(piece.of[0], n);
  piece.point[1] = set_[1]->supportOf(piece.of[1], -1. * n);
  piece.between = piece.point[1] - piece.point[0];
}

CurvedGapSearch::Piece CurvedGapSearch::pieceAt(const Vec& n) const {
  Piece piece{};
  piece.of[0] = set_[0]->pieceAt(n);
  piece.of[1] = set_[1]->pieceAt(-1. * n);
  setPoints(n, piece);
  return piece;
}

bool CurvedGapSearch::isKnown(const Piece& piece) const {
  return std::any_of(piece_, piece_ + count_, [&](const Piece& known) {
    return known.of[0] == piece.of[0] && known.of[1] == piece.of[1];
  });
}

/// Keeps the pieces that limit a step: three at most.
void CurvedGapSearch::keepActive(const Step& step) {
  int count = 0;
  for (int i = 0; i < count_; ++i) {
    if (!(step.weight[i] > 0)) continue;
    piece_[count] = piece_[i];
    piece_[count++].weight = step.weight[i];
  }
  count_ = count;
  assert(count_ == 0 || (count_ < kMostPieces && haveAllWeight()));
}

/// Whether the weights of the pieces are shares of one. For assertions.
bool CurvedGapSearch::haveAllWeight() const {
  double sum = 0;
  bool are_shares = true;
  for (int i = 0; i < count_; ++i) {
    sum += piece_[i].weight;
    are_shares &= 0 <= piece_[i].weight && piece_[i].weight <= 1;
  }
  return are_shares && std::abs(sum - 1) <= 0x1p-48;
}

/// Notes the points.
/// @return whether the search ends
bool CurvedGapSearch::note(ConvexGap& out) const {
  assert(haveAllWeight());
  for (int side = 0; side < 2; ++side) {
    Vec point{0, 0, 0};
    out.corners[side] = 0;
    for (int i = 0; i < count_; ++i) {
      if (!(piece_[i].weight > 0)) continue;
      point = point + piece_[i].weight * piece_[i].point[side];
      if (!set_[side]->shape) out.corners[side] |= 1U << piece_[i].of[side];
    }
    out.point[side] = point;
  }
  out.distance = norm(out.point[1] - out.point[0]);
  out.depth = 0;
  return out.distance <= contact_ ||
         (out.gap > enough_ && out.gap - enough_ >= 0.5 * (out.distance - enough_));
}

CurvedGapSearch::Model CurvedGapSearch::modelAt(const Vec& n, double damping) const {
  // Where no piece is curved along a line, the model is given this share of curvature, so
  // that it has a maximum. The weights of the pieces lose as many digits as it has.
  constexpr double kLeastCurvature = 0x1p-13;
  Model model{};
  setAxes(n, model.axis);
  double most = 0;
  for (int i = 0; i < count_; ++i) {
    const Piece& piece = piece_[i];
    model.gap[i] = dot(n, piece.between);
    for (int k = 0; k < 2; ++k) model.slope[i][k] = dot(model.axis[k], piece.between);
    most = i == 0 ? model.gap[i] : std::min(most, model.gap[i]);
    if (!(piece.weight > 0)) continue;
    double of[2][3];
    set_[0]->setCurvature(piece.of[0], n, model.axis, of[0]);
    set_[1]->setCurvature(piece.of[1], -1. * n, model.axis, of[1]);
    for (int k = 0; k < 3; ++k) model.m[k] += piece.weight * (of[0][k] + of[1][k]);
  }
  // A direction that is not of length 1 makes the gap too large.
  const double more = std::max(most, 0.) + kLeastCurvature * (model.m[0] + model.m[2]);
  model.m[0] = damping * (model.m[0] + more);
  model.m[1] *= damping;
  model.m[2] = damping * (model.m[2] + more);
  return model;
}

/// Tries all sets of one, two and three pieces whose models are equal and largest.
CurvedGapSearch::Step CurvedGapSearch::bestStep(const Model& model) const {
  const double(&m)[3] = model.m;
  const double m_determinant = m[0] * m[2] - m[1] * m[1];
  assert(m[0] + m[2] > 0 && m_determinant >= 0);
  Step best{0, 0, -HUGE_VAL, {}};
  const auto keep = [&](double x, double y, const int(&id)[3], const double(&weight)[3]) {
    double least = HUGE_VAL;
    for (int i = 0; i < count_; ++i)
      least =
          std::min(least, model.gap[i] + (model.slope[i][0] * x + model.slope[i][1] * y));
    const double value =
        least - 0.5 * (x * (m[0] * x + m[1] * y) + y * (m[1] * x + m[2] * y));
    if (!(value > best.value)) return;
    best = {x, y, value, {}};
    for (int k = 0; k < 3; ++k)
      if (weight[k] > 0) best.weight[id[k]] = weight[k];
  };
  for (int i = 0; i < count_; ++i) {
    const double(&p)[2] = model.slope[i];
    keep((m[2] * p[0] - m[1] * p[1]) / m_determinant,
         (m[0] * p[1] - m[1] * p[0]) / m_determinant, {i, i, i}, {1, 0, 0});
    for (int j = i + 1; j < count_; ++j) {
      const double(&q)[2] = model.slope[j];
      // Along the difference d the step makes both equal; across it the mean is best.
      const double d[2] = {p[0] - q[0], p[1] - q[1]}, square = d[0] * d[0] + d[1] * d[1],
                   m_across[2] = {m[1] * d[0] - m[0] * d[1], m[2] * d[0] - m[1] * d[1]},
                   along = (model.gap[j] - model.gap[i]) / square,
                   across = ((d[0] * q[1] - d[1] * q[0]) -
                             along * (d[0] * m_across[0] + d[1] * m_across[1])) /
                            (d[0] * m_across[1] - d[1] * m_across[0]);
      const double x = along * d[0] - across * d[1], y = along * d[1] + across * d[0],
                   w = (d[0] * (m[0] * x + m[1] * y - q[0]) +
                        d[1] * (m[1] * x + m[2] * y - q[1])) /
                       square;
      if (w > 0 && w < 1) keep(x, y, {i, j, j}, {w, 1 - w, 0});
      for (int k = j + 1; k < count_; ++k) {
        // The step at which the three models are equal.
        const double(&r)[2] = model.slope[k];
        const double u[2] = {p[0] - r[0], p[1] - r[1]}, v[2] = {q[0] - r[0], q[1] - r[1]},
                     determinant = u[0] * v[1] - u[1] * v[0];
        const double c = model.gap[k] - model.gap[i], e = model.gap[k] - model.gap[j];
        const double x3 = (c * v[1] - e * u[1]) / determinant,
                     y3 = (u[0] * e - v[0] * c) / determinant;
        const double f = m[0] * x3 + m[1] * y3 - r[0], g = m[1] * x3 + m[2] * y3 - r[1];
        const double w0 = (f * v[1] - g * v[0]) / determinant,
                     w1 = (u[0] * g - u[1] * f) / determinant;
        if (w0 > 0 && w1 > 0 && w0 + w1 < 1)
          keep(x3, y3, {i, j, k}, {w0, w1, 1 - w0 - w1});
      }
    }
  }
  return best;
}

/// How far the line between the nearest points is from the direction.
double CurvedGapSearch::residualAt(const Vec& n) const {
  Vec way{0, 0, 0};
  for (int i = 0; i < count_; ++i) way = way + piece_[i].weight * piece_[i].between;
  return norm(cross(n, way));
}

double CurvedGapSearch::sizeOf() const {
  return norm(piece_[0].point[0]) + norm(piece_[0].point[1]);
}

/// The point of each set, in the shares of the weights, at a direction.
CurvedGapSearch::Corner CurvedGapSearch::cornerAt(const Vec& n) const {
  Corner out{};
  for (int i = 0; i < count_; ++i) {
    Piece at = piece_[i];
    setPoints(n, at);
    for (int side = 0; side < 2; ++side)
      out.point[side] = out.point[side] + at.weight * at.point[side];
  }
  return out;
}

/// Four corners, of which some are below the origin along a direction and the others
/// above. Around the direction, the points of a piece are higher in proportion to the
/// square of the change. One piece: its lowest point, and three above. Two pieces: both
/// lowest points, and two above, to the sides. Three: their lowest points, and the
/// highest one of all. They are drawn towards the nearest points, so that the tetrahedron
/// is about as wide in all directions.
void CurvedGapSearch::setCorners(const Vec& n, const Model& model, double gap,
                                 Corner (&corner)[4]) const {
  constexpr double kAround[3][2] = {
      {1, 0}, {-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386}};
  // The height above the lowest points: three quarters are above the origin.
  const double height = -4 * gap;
  const Corner nearest = cornerAt(n);
  const auto above = [&](double x, double y) {
    const double bend = x * (model.m[0] * x + model.m[1] * y) +
                        y * (model.m[1] * x + model.m[2] * y),
                 scale = std::sqrt(2 * height / bend);
    return cornerAt(unit(n + (scale * x * model.axis[0] + scale * y * model.axis[1])));
  };
  const auto drawn = [&](const Vec& a, const Vec& b, double share) -> Corner {
    share = std::min(std::max(share, 0.), 1.);
    return {{nearest.point[0] + share * (a - nearest.point[0]),
             nearest.point[1] + share * (b - nearest.point[1])}};
  };
  if (count_ == 1) {
    corner[3] = nearest;
    for (int i = 0; i < 3; ++i) corner[i] = above(kAround[i][0], kAround[i][1]);
    return;
  }
  double share;
  if (count_ == 2) {
    const Vec along = piece_[0].between - piece_[1].between;
    const double x = dot(model.axis[0], along), y = dot(model.axis[1], along);
    corner[2] = above(-y, x);
    corner[3] = above(y, -x);
    share = norm(between(corner[2]) - between(nearest)) / norm(along);
  } else {
    const Piece highest = pieceAt(-1. * n);
    share = height / (dot(n, highest.between) - gap);
    corner[3] = drawn(highest.point[0], highest.point[1], share);
    // It is far to one side.
    share *= 16;
  }
  for (int i = 0; i < count_; ++i)
    corner[i] = drawn(piece_[i].point[0], piece_[i].point[1], share);
}

/// Looks for a tetrahedron around the origin.
bool CurvedGapSearch::overlaps(const Vec& n, const Model& model, double gap,
                               ConvexGap& out) const {
  assert(!(gap > 0) && 1 <= count_ && count_ <= 3);
  Corner corner[4];
  setCorners(n, model, gap, corner);
  Vec vertex[4];
  for (int i = 0; i < 4; ++i) vertex[i] = between(corner[i]);
  double weight[4];
  const double depth = depthInside(vertex, weight);
  if (!(depth > 0)) return false;
  out.depth = depth;
  const double sum = weight[0] + weight[1] + weight[2] + weight[3];
  assert(!(sum <= 0));
  for (int side = 0; side < 2; ++side) {
    out.point[side] = {0, 0, 0};
    for (int i = 0; i < 4; ++i)
      out.point[side] = out.point[side] + (weight[i] / sum) * corner[i].point[side];
  }
  out.distance = norm(out.point[1] - out.point[0]);
  return true;
}

/// Where no direction is better than this one.
bool CurvedGapSearch::finish(const Vec& n, const Model& model, double gap,
                             ConvexGap& out) const {
  return note(out) || gap > 0 || overlaps(n, model, gap, out);
}

bool CurvedGapSearch::run(const Vec& guess, ConvexGap& out) {
  constexpr int kMostRounds = 16;
  // The search ends where neither the gap nor the residual becomes better. The points
  // should have most of their digits then.
  constexpr double kRounding = 0x1p-48, kSmallResidual = 0x1p-36,
                   kLeastResidual = 0x1p-46;
  // The share of the curvature from which on the sets overlap too much for this method.
  constexpr double kDeep = 0x1p-2;
  assert(isUnit(guess));
  Vec n = guess;
  piece_[0] = pieceAt(n);
  piece_[0].weight = 1;
  count_ = 1;
  double gap = dot(n, piece_[0].between), damping = 1;
  for (int round = 0; round < kMostRounds; ++round) {
    if (gap > out.gap) {
      out.gap = gap;
      out.direction = n;
    }
    if (note(out)) return true;
    const double size = sizeOf();
    const Model model = modelAt(n, damping);
    const double trace = model.m[0] + model.m[2];
    if (!(trace > 0) || !(model.m[0] * model.m[2] > model.m[1] * model.m[1]) ||
        gap < -kDeep * trace)
      return false;
    const Step step = bestStep(model);
    keepActive(step);
    if (count_ == 0) return false;
    const double residual = residualAt(n);
    const bool is_best = !(step.value > gap + kRounding * size);
    if (is_best && residual <= kLeastResidual * size) return finish(n, model, gap, out);
    const Vec next = unit(n + (step.x * model.axis[0] + step.y * model.axis[1]));
    Piece met = pieceAt(next);
    const double there = dot(next, met.between);
    for (int i = 0; i < count_; ++i) setPoints(next, piece_[i]);
    const bool is_better =
        is_best ? there >= gap - kRounding * size && 2 * residualAt(next) < residual
                : there > gap;
    if (!is_better)
      for (int i = 0; i < count_; ++i) setPoints(n, piece_[i]);
    if (!is_better && is_best && residual <= kSmallResidual * size)
      return finish(n, model, gap, out);
    if (!isKnown(met)) {
      met.weight = 0;
      if (!is_better) setPoints(n, met);
      assert(count_ < kMostPieces);
      piece_[count_++] = met;
    } else if (!is_better) {
      if (is_best) return false;
      damping *= 4;
    }
    if (!is_better) continue;
    n = next;
    gap = there;
    damping = 1;
  }
  return false;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

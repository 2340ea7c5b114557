// SPDX-License-Identifier: BSD-3-Clause
#include "tree/bent_boxes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "tree/float4.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// What is added to a half-axis: 0 in place of a negative number, infinity in place of
/// a NaN.
Float4 outward(const Float4& change) {
  const Float4 least = change < 0.f ? Float4{} : change;
  return least == least ? least : Float4{} + std::numeric_limits<float>::infinity();
}

/// Adds to four half-axes, as shifted(). The sum is not below kLeastHalf, since a
/// half-axis is not.
void move(const Float4& by, float* half) {
  const Float4 before = load(half), sum = before + by;
  assert(!isAny((before < kLeastHalf) | (before != before) | (by < 0.f)));
  store(sum + abs(sum) * kOutward, half);
  assert(!isAny(load(half) < before));  // a box is only enlarged
}

/// The bend of a point in the middle of its straight path.
void bendAt(const Bend& bend, const double (&middle)[3], double (&out)[3]) {
  const double(&m)[9] = bend.matrix;
  for (int i = 0; i < 3; ++i)
    out[i] = m[3 * i] * middle[0] + m[3 * i + 1] * middle[1] + m[3 * i + 2] * middle[2] +
             bend.offset[i];
}

/// The sum of the sizes of all numbers that bendAt() adds up. All its components
/// together, each a few times, are rounded by less than 2^-48 of it.
double sizeOf(const Bend& bend, const double (&middle)[3]) {
  double size = 0;
  for (int i = 0; i < 3; ++i) {
    size += std::abs(bend.offset[i]);
    for (int k = 0; k < 3; ++k) size += std::abs(bend.matrix[3 * i + k] * middle[k]);
  }
  return size;
}

}  // namespace

// With p the mean of the origins and translations the bend is M (p + r) + offset.
BentBoxes::BentBoxes(const Bend& bend, const double (&origin)[2][3],
                     const double (&translation)[2][3]) {
  double center[3], size[3], s[3], change = 0, diagonal = 0;
  for (int k = 0; k < 3; ++k) {
    center[k] = size[k] = 0;
    for (auto frame : {0, 1})
      for (const double x : {origin[frame][k], translation[frame][k]}) {
        center[k] += 0.5 * x;
        size[k] += 0.5 * std::abs(x);
      }
  }
  bendAt(bend, center, s);
  for (int i = 0; i < 3; ++i) at_origin_[i] = static_cast<float>(s[i]);
  for (int k = 0; k < 3; ++k) {
    double along[8];
    kdopCoordinates({bend.matrix[k], bend.matrix[3 + k], bend.matrix[6 + k]}, along);
    for (int j = 0; j < 8; ++j) {
      double& most = j < 3 ? change : diagonal;
      most = std::max(most, std::abs(along[j]));
    }
    for (int i = 0; i < 3; ++i)
      matrix_[3 * i + k] = static_cast<float>(bend.matrix[3 * i + k]);
  }
  change_ = roundUp(change, 0.f);
  diagonal_change_ = roundUp(std::max(diagonal, change), 0.f);
  // As floats they lose 2^-24 of themselves, and four sums with each of them the same.
  rounding_ = roundUp(0x1p-20 * (std::abs(s[0]) + std::abs(s[1]) + std::abs(s[2])) +
                          0x1p-48 * sizeOf(bend, size),
                      0.f);
}

// The box has the center c and the half widths e along x, y and z, with the sums C of all
// |c| and E of all e. Along a direction the bend of a point differs from that of the
// center by at most `change` E. Rounding, in units u = 2^-24 of `change` (C + E): the
// center 6, since the means of half-axes of at most C + E round by u, and so do a
// difference and a half; the matrix 1, a product 1, three sums 3. These are 11, along a
// diagonal 22 and 1 more for its sum. The spread has less than 8 for the sums and the
// product, and the sum with it 2. 64 u are more than all.
void BentBoxes::enlarge(MovingKdopNode& node) const {
  constexpr float kRounding = 0x1p-18f;
  for (int q = 0; q < MovingKdopNode::kWidth; q += 4) {
    Float4 center[3], width{}, size{};
    for (int k = 0; k < 3; ++k) {
      const auto mean = [&](int r) {
        return 0.5f * load(node.t0[r] + q) + 0.5f * load(node.t1[r] + q);
      };
      const Float4 below = mean(2 * k), above = mean(2 * k + 1);
      center[k] = 0.5f * (above - below);
      width += 0.5f * (above + below);
      size += abs(center[k]);
    }
    const Float4 rounding = (size + width) * (diagonal_change_ * kRounding) + rounding_;
    const Float4 spread[2] = {width * change_ + rounding,
                              width * diagonal_change_ + rounding};
    Float4 s[3], along[8];
    for (int i = 0; i < 3; ++i)
      s[i] = matrix_[3 * i] * center[0] + matrix_[3 * i + 1] * center[1] +
             matrix_[3 * i + 2] * center[2] + at_origin_[i];
    kdopCoordinates(s, along);
    for (int j = 0; j < 8; ++j) {
      const Float4 down = outward(spread[j >= 3] - along[j]),
                   up = outward(spread[j >= 3] + along[j]);
      for (auto* rows : {node.t0, node.t1}) {
        move(down, rows[2 * j] + q);
        move(up, rows[2 * j + 1] + q);
      }
    }
  }
}

// As a float a bend loses 2^-24 of itself, and so does the sum with the pad. The sum of
// two coordinates is at most that of their sizes.
void enlarge(const Bend& bend, TreeVertex& vertex) {
  double middle[3], size[3], s[3], along[8];
  for (int k = 0; k < 3; ++k) {
    middle[k] = 0.5 * (vertex.t0[k] + vertex.t1[k]);
    size[k] = 0.5 * (std::abs(vertex.t0[k]) + std::abs(vertex.t1[k]));
  }
  bendAt(bend, middle, s);
  kdopCoordinates(s, along);
  const float rounding =
      roundUp(0x1p-48 * sizeOf(bend, size) +
                  0x1p-22 * (std::abs(s[0]) + std::abs(s[1]) + std::abs(s[2])),
              0.f);
  for (int j = 0; j < 8; j += 4) {
    const Float4 to = {static_cast<float>(along[j]), static_cast<float>(along[j + 1]),
                       static_cast<float>(along[j + 2]),
                       static_cast<float>(along[j + 3])};
    const Float4 down = outward(rounding - to), up = outward(rounding + to);
    for (Kdop16* box : {&vertex.box.t0, &vertex.box.t1}) {
      move(down, box->half + j);
      move(up, box->half + j + 8);
    }
  }
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// Sine, cosine and rotation angles with the same bits on all machines. libm chooses its
// functions by the instruction set, and they differ in the last place.
#ifndef FCL_CCD_PATHS_SINE_H
#define FCL_CCD_PATHS_SINE_H

#include <cassert>
#include <cmath>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Largest angle of sineCosine().
constexpr double kMostAngle = 0x1p20;

struct SineCosine {
  double sine, cosine;
};

constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
/// @brief pi / 2 as a sum: the first two have 33 bits.
constexpr double kHalfPi[3] = {0x1.921fb54400000p+0, 0x1.0b4611a600000p-34,
                               0x1.3198a2e037073p-69};
/// @brief 1 / k! of odd k, with its sign, from 17 to 3.
constexpr double kSineSeries[8] = {
    1 / 355687428096000., -1 / 1307674368000., 1 / 6227020800., -1 / 39916800.,
    1 / 362880.,          -1 / 5040.,          1 / 120.,        -1 / 6.};
/// @brief The same of even k, from 18 to 4.
constexpr double kCosineSeries[8] = {
    -1 / 6402373705728000., 1 / 20922789888000., -1 / 87178291200., 1 / 479001600.,
    -1 / 3628800.,          1 / 40320.,          -1 / 720.,         1 / 24.};

/// @brief Sine and cosine of |x| <= kMostAngle, each within 4 u (u = 2^-53); the sine of
/// |x| <= pi / 4 also within 4 u of itself.
///
/// The angle is reduced with pi / 2 = h1 + h2 + h3, of which h1 and h2 have 33 bits, so
/// that their products with the quadrant, below 2^20, are exact. The first difference is
/// exact (Sterbenz), the other two and the product with h3 round by 2^-54 + 2^-54 +
/// 2^-102: 1 u. Taylor's series up to x^17 and x^18 leave (pi / 4)^19 / 19! < 2^-63. The
/// sum of the first two terms rounds by u / 2, what is below them by less than u.
inline SineCosine sineCosine(double x) {
  // A bound on an angle may round.
  assert(!(std::abs(x) > kMostAngle * (1 + 0x1p-40)));
  const double quadrant = std::nearbyint(x * kTwoOverPi);
  const double r =
      ((x - quadrant * kHalfPi[0]) - quadrant * kHalfPi[1]) - quadrant * kHalfPi[2];
  const double q = r * r;
  double s = kSineSeries[0], c = kCosineSeries[0];
  for (int k = 1; k < 8; ++k) {
    s = s * q + kSineSeries[k];
    c = c * q + kCosineSeries[k];
  }
  s = r + r * (q * s);
  c = 1 - (0.5 * q - (q * q) * c);
  assert(!(std::abs(s * s + c * c - 1) > 0x1p-48));
  switch (static_cast<int>(quadrant) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// @brief The sine, and 1 - cosine in place of the cosine, which is within 8.2 u. Below 1
/// it is computed from half of the angle: within 11 u of itself.
inline SineCosine sineAndOneMinusCosine(double x) {
  const SineCosine at = sineCosine(x);
  if (std::abs(x) >= 1) return {at.sine, 1 - at.cosine};
  const double half = sineCosine(0.5 * x).sine;
  return {at.sine, 2 * half * half};
}

/// @brief The angle in [0, pi / 2] of a unit vector (cosine, sine), both not negative, to
/// a few u. The first estimate is within 0.005. Then Newton's method of third order is
/// applied twice: 2e-8, 1e-24.
inline double angleOf(double cosine, double sine) {
  assert(!(cosine < 0) && !(sine < 0));
  const bool steep = sine > cosine;
  const double ratio = steep ? cosine / sine : sine / cosine;
  const double guess = ratio * (0.7853981633974483 + 0.273 * (1 - ratio));
  double angle = steep ? 1.5707963267948966 - guess : guess;
  for (int i = 0; i < 2; ++i) {
    const SineCosine at = sineCosine(angle);
    const double off = sine * at.cosine - cosine * at.sine;
    angle += off + off * off * off / 6;
  }
  assert(!(angle < 0 || angle > 1.5708));
  return angle;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

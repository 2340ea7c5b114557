// SPDX-License-Identifier: BSD-3-Clause
//
// Bounds on the rounding of the elementary test, in doubles rounded to nearest.
#ifndef FCL_CCD_NUMERICS_ERROR_BOUNDS_H
#define FCL_CCD_NUMERICS_ERROR_BOUNDS_H

#include <cfloat>

#if defined(__FAST_MATH__) || FLT_EVAL_METHOD != 0
#error "the bounds are of IEEE's operations, each rounded to its own type"
#endif

namespace fcl {
namespace detail {
namespace deformable {

/// Half of the distance from 1 to the next double: u in all comments about rounding.
constexpr double kUnit = 0x1p-53;
/// A factor for an upper bound: more than the rounding of the bound itself, of thousands
/// of operations.
constexpr double kUpward = 1 + 0x1p-40;

// Error analysis. u = 2^-53. A difference of two coordinates is rounded once (relative
// error u). Interpolated at a time t, its components have an absolute error of at most 4
// u times its norm (the larger max-norm of both frames): difference, weight 1 - t,
// product, sum. U, V, W below are such norms. Second-order terms are below 2^-40 of the
// bounds. Each constant is rounded up by more than that.
//
// A component of v x w: two products of size VW, error (4 + 4 + 1) u VW each, and a sum
// of size 2 VW: 20 u VW; its size is 2 VW. Of v0 x w1 + v1 x w0: size 4 VW, error 44 u
// VW. Outer coefficients u.(v x w): three products of size 2 UVW, error (4 * 2 + 20 + 2)
// u = 30 u, and sums of size 4 and 6: 100 u UVW. Inner ones, u1.(v0 x w0) + u0.(v0 x w1 +
// v1 x w0): 100 u for the first, 3 (16 + 44 + 4) + 20 = 212 u for the second, 18 u for
// the sum: 330 u UVW.
// u . (v x w) with differences and products that are rounded once only: a component of v
// x w has an error of 2 (2 + 1) + 2 = 8 u VW, the volume of 3 (2 + 8 + 2) + 10 = 46 u
// UVW.
constexpr double kVolumeBound = 48 * kUnit;
constexpr double kOuterBound = 104 * kUnit;
constexpr double kInnerBound = 344 * kUnit;
// d . (x - o), for a direction of norm D and points at most N from o: an error of 12 u
// DN; the difference of two such numbers 24 u DN, and it rounds by 6 u DN.
constexpr double kPlaneBound = 32 * kUnit;
// A factor for D in three coordinates: more than the rounding of this product.
constexpr double kPlaneApproach = 3 * (1 + 8 * kUnit);
// The filter takes the largest norm N for all of U, V, W and makes the inner coefficients
// smaller, so that all four have one bound, kOuterBound N^3. This computation rounds by 4
// u of their own size, which the constant includes.
constexpr double kInnerScale = 0.302;
static_assert(kInnerScale * kInnerBound < kOuterBound, "the inner bound, made smaller");
// Between these norms an underflow is below 2^-150 of that bound, and nothing overflows.
constexpr double kLeastFilterNorm = 0x1p-290;
constexpr double kMostFilterNorm = 0x1p290;
// Inside conditions (x y cross product)(v w cross product), coefficients of degree 4:
// outer 3 (80 + 4) + 20 = 272 u; next 2 * (3 (168 + 8) + 40) + 48 = 1184 u; middle 2 *
// 272 + 3 (352 + 16) + 80 + 96 = 1824 u, all of XYVW.
constexpr double kInsideBound = 2048 * kUnit;
// A cross product as a MovingCross: half of its inner component is below 2 VW and within
// 22 u VW.
constexpr double kCrossBound = 22.5 * kUnit;
// The same conditions for cross products of sizes Q, N with errors e, d, whatever digits
// they have. Of the five coefficients the middle one, q0.n2 + q2.n0 + q1.n1 with c1 of
// twice the size, is the largest, 18 QN: errors of the factors 18 (Q d + e N + e d),
// rounding 6 (3 + 5) u QN in the dot products and (6 + 18) u QN in their sums.
constexpr double kInsideTerms = 18.5;
constexpr double kInsideRounding = 74 * kUnit;
// d . x for a direction d taken as exact: three products of size DX, error (4 + 1) u,
// sums of size 2 and 3: 20 u DX.
constexpr double kSideBound = 32 * kUnit;
// Normal . d for exact d: components of v x w as above, though its differences are
// rounded once only; the middle one: three products of size 4 VWD, error (44 + 4) u, sums
// of size 8 and 12: 164 u VWD. The bound also holds for a d with entries 1, 0 and -1,
// where sums take the place of products.
constexpr double kFanBound = 192 * kUnit;
// u . (r x d) for exact r and d: components of the cross product of size 2 RD, error 4 u
// RD; three products, error (4 + 2 + 2) u each, sums of size 4 and 6: 34 u URD.
constexpr double kRayBound = 64 * kUnit;
// Points in a plane. A coordinate is the sum of two differences to an origin. No vertex
// is further than R from the origin. So a coordinate is below 2 R and has an error of 4 u
// R. A difference of two coordinates that is below L has an error of 12 u R.
//
// A cross or dot product of two such differences: at most four products, each with an
// error of 28 u R L that includes its own rounding (L is below 4 R), and sums of sizes 2,
// 2 and 4 L^2 with 32 u R L: 144 u R L. A value above the bound has L > 40 u R. So
// products of two errors, (12 u R)^2 each, add less than 15 u R L.
constexpr double kBorderTurnBound = 192 * kUnit;
// w . x for exact w of size W: products 4 + 2, sum 4: 16 u W R. If both vectors move, the
// middle coefficient is the sum of two such products: 40 u W R, of size 8 W R. Two of
// these are compared.
constexpr double kBorderSideBound = 96 * kUnit;
// w x (2 p - a - b): the second vector has an error of 32 u R and the size 8 R; products
// (32 + 8) u W R, sum 16: 96 u W R.
constexpr double kBorderRayBound = 112 * kUnit;
// (q - p) x (a + b - 2 p), of sizes 4 R and 8 R: products (12 * 8 + 4 * 32 + 32) u R^2,
// sum 64: 576 u R^2.
constexpr double kBorderHalfBound = 640 * kUnit;
// The bounds hold while no product that matters underflows or overflows: an underflow
// adds at most 2^-1074 to a product, below 2^-170 of numbers in this range.
constexpr double kTiny = 0x1p-900;
constexpr double kHuge = 0x1p900;
inline bool isInRange(double size) { return size >= kTiny && size <= kHuge; }
// The least norm that is used. Then an underflow in the products with 1 - t and t,
// 2^-1074 each, is below the 4 u of the bounds.
constexpr double kLeastNorm = 0x1p-1010;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

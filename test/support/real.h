// SPDX-License-Identifier: BSD-3-Clause
//
// The numbers of the references, at least 11 bits longer than double. Where long double
// is double (macOS on arm64, Windows) they are Boost's, which are slower.
#ifndef FCL_TEST_SUPPORT_REAL_H
#define FCL_TEST_SUPPORT_REAL_H

#include <Eigen/Core>
#include <cfloat>
#include <cmath>
#include <cstdlib>

// To try Boost's numbers on any machine: -DCMAKE_CXX_FLAGS=-DFCL_CCD_TEST_BOOST_REAL.
#if LDBL_MANT_DIG >= 64 && !defined(FCL_CCD_TEST_BOOST_REAL)
namespace fcl {
namespace test {
using Real = long double;
}  // namespace test
}  // namespace fcl
#else
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
namespace fcl {
namespace test {
/// 113 bits. With Boost's 64 bits the sine of an angle of 2^20 has an error of 4e-14.
using Real = boost::multiprecision::cpp_bin_float_quad;
}  // namespace test
}  // namespace fcl
#endif

namespace fcl {
namespace test {

using RealVector = Eigen::Matrix<Real, 3, 1>;
using RealMatrix = Eigen::Matrix<Real, 3, 3>;

// Without std:: a call finds the function of either type.
using std::abs;
using std::atan;
using std::atan2;
using std::copysign;
using std::cos;
using std::ldexp;
using std::pow;
using std::sin;
using std::sqrt;

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_DOUBLE_WORD_H
#define FCL_CCD_BASE_DOUBLE_WORD_H

#if !defined(__SIZEOF_INT128__)
#include <boost/multiprecision/cpp_int.hpp>
#endif

namespace fcl {
namespace detail {
namespace deformable {

/// @brief An unsigned integer of 128 bits.
#if defined(__SIZEOF_INT128__)
__extension__ typedef unsigned __int128 DoubleWord;
#else
using DoubleWord = boost::multiprecision::uint128_t;
#endif

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_FLOAT4_H
#define FCL_CCD_TREE_FLOAT4_H

#include <cstring>

#include "mesh/moving_kdop.h"

namespace fcl {
namespace detail {
namespace deformable {

inline Float4 load(const float* from) {
  Float4 v;
  std::memcpy(&v, from, sizeof(v));
  return v;
}

inline void store(const Float4& v, float* to) { std::memcpy(to, &v, sizeof(v)); }

inline Float4 abs(const Float4& v) {
  constexpr int kAllButSign = 0x7fffffff;
  return Float4(Mask4(v) & kAllButSign);
}

inline Float4 larger(const Float4& x, const Float4& y) { return x > y ? x : y; }

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

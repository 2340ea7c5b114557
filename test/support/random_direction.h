// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_RANDOM_DIRECTION_H
#define FCL_TEST_SUPPORT_RANDOM_DIRECTION_H

#include "mesh_generators.h"

namespace fcl {
namespace test {

inline Vector3<double> randomDirection(Random& random) {
  Vector3<double> v;
  do v = random.point(1);
  while (v.norm() > 1 || v.norm() < 0.1);
  return v.normalized();
}

}  // namespace test
}  // namespace fcl

#endif

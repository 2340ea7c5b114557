// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_FRAGILE_DESIGNS_H
#define FCL_TEST_SUPPORT_FRAGILE_DESIGNS_H

#include "fragile_shell.h"

namespace fcl {
namespace test {

/// @brief Number of letters that makeLetter() knows.
int numLetters();

/// @brief A block letter, upright in the plane y = 0 around the origin, 7 squares high.
/// @param letter  0, 1, ..., taken modulo numLetters()
/// @param square  metres
/// @param divisions  of a square along each side; 2 divisions^2 triangles a layer
/// @param pieces  at most this number, of about the same size
ShellDesign makeLetter(int letter, double square, int divisions, int pieces,
                       Random& random);

/// @brief A lion that sits on a plinth, about 1 m high, standing on z = 0 and looking
/// along -y, of 40 frequency^2 triangles. The stone is thick, and hollow inside.
/// @param frequency  of the geodesic sphere that it is made from
/// @param pieces  cells of the points on its surface that are closest to the seeds
ShellDesign makeLion(int frequency, int pieces, Random& random);

}  // namespace test
}  // namespace fcl

#endif

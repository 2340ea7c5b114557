// SPDX-License-Identifier: BSD-3-Clause
//
// Queries of bodies that turn against answers from outside of the library: dense
// sampling, certified advancement, closed forms. The number of a case is its seed.
#ifndef FCL_TEST_SUPPORT_MOTION_REFERENCES_H
#define FCL_TEST_SUPPORT_MOTION_REFERENCES_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "turning_bodies.h"

namespace fcl {
namespace test {

/// @brief The distance of two triangles that do not cross, in Real.
Real triangleDistance(const RealVector (&a)[3], const RealVector (&b)[3]);

/// @brief Whether an edge of one triangle passes through the other, in Real.
bool doTrianglesCross(const RealVector (&a)[3], const RealVector (&b)[3]);

/// @brief A time before which two bodies are provably apart: conservative advancement by
/// their distance (FCL's) over a bound on their speeds from the formulas of the motions.
/// It ends within `near` of a contact. 2: they are apart in the whole step.
double provedApart(const Body& a, const ReferenceMotion& motion_a, const Body& b,
                   const ReferenceMotion& motion_b, double near);

/// @brief What a series of cases consisted of.
struct MotionTally {
  std::size_t cases{0}, contacts{0}, grazes{0};
  /// Contacts of triangles that cross at the beginning.
  std::size_t crossings{0};
  /// Cases that each reference saw as a contact.
  std::size_t sampled{0}, advanced{0};
  /// By the kind of motion (ReferenceMotion::Kind), of points that rest in the body and
  /// of those that move in it: the largest part of the bound M that was reached.
  double worst_bound[3][2]{};
};

/// @brief Case `number` of the bound M on the acceleration: a span of a motion of each
/// kind. A point is compared with the straight line between its ends.
/// @return what is wrong; empty if nothing
std::string spanDisagreement(std::uint64_t number, MotionTally& tally);

/// @brief Case `number` of two triangles, of which one turns about a fixed axis and the
/// other rests. For vertex and face, and for two edges, the volume is A + B cos(v) + C
/// sin(v), of degree 2 in tan(v / 2): its roots in closed form, in Real, are the
/// reference. Half of the cases graze: they hit as deep, or pass at a distance, of 1e-2
/// to 1e-6.
/// @return what is wrong; empty if nothing
std::string turnDisagreement(std::uint64_t number, MotionTally& tally);

/// @brief Case `number` of two meshes; every odd one grazes. The time is not before that
/// of certified advancement and not after that of dense samples of exact discrete
/// queries. The pair that is named touches. The query gives the same with its objects
/// swapped, one rigid motion on top of both, 1e6 from the origin, and a contact with time
/// reversed.
/// @param samples  dense samples of the step
/// @return what is wrong; empty if nothing
std::string meshDisagreement(const std::vector<Body>& bodies, std::uint64_t number,
                             int samples, MotionTally& tally);

}  // namespace test
}  // namespace fcl

#endif

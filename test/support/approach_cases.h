// SPDX-License-Identifier: BSD-3-Clause
//
// Least distances of random pairs against answers from outside of the library: dense
// samples, and points that are checked to be on both objects. The number of a case is its
// seed.
#ifndef FCL_TEST_SUPPORT_APPROACH_CASES_H
#define FCL_TEST_SUPPORT_APPROACH_CASES_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace fcl {
namespace test {

/// @brief What a series of cases consisted of.
struct ApproachTally {
  std::size_t cases{0}, contacts{0}, cut_off{0};
  /// By the kinds of both objects.
  std::map<std::string, std::size_t> kinds;
  /// The widest bracket as a share of the requested width.
  double widest{0};
};

/// @brief Case `number`: two objects of random kinds - meshes that are rigid, deform, or
/// have free edges and points; all shapes; octrees - on motions of all kinds.
///
/// No sample of the distance is below distance_lo. The nearest points are on both objects
/// at the time, and no further apart than distance_hi. The bracket is as narrow as
/// requested. is_collide is what continuousCollide() says. With the objects swapped, and
/// with two threads, the brackets agree.
/// @param samples  of the step
/// @return what is wrong; empty if nothing
std::string approachDisagreement(std::uint64_t number, int samples, ApproachTally& tally);

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MOTION_MOTION_QUERY_H
#define FCL_CCD_MOTION_MOTION_QUERY_H

#include <vector>

#include "motion/motion_body.h"
#include "motion/triangle_advance.h"

namespace fcl {
namespace detail {
namespace deformable {

struct MotionQueryOptions {
  /// Every pair of triangles with its first time; else the first contact only.
  bool all{false};
  /// Width of a contact's time bracket.
  double toc_err{1e-4};
  /// Nothing later matters.
  double last{1};
  /// Bodies are in contact at this distance.
  double distance{0};
  /// Steps of one pair of triangles, after which it is given up and counts as contact:
  /// where surfaces slide at a distance g about sqrt(M / 2 g) are taken.
  int max_steps{10000};
};

struct MotionAnswer {
  /// Sorted by (toc_lo, triangles).
  std::vector<MotionContact> contacts;
  MotionCounts counts;
  /// Largest distance of what is reported, but for the distance asked for.
  double touching{0};
};

/// @brief The bodies in a frame whose origin is near them, where coordinates round less;
/// in the middle, so that neither comes first.
struct BodiesNearOrigin {
  BodiesNearOrigin(const MotionBody& from_a, const MotionBody& from_b);
  MotionBody a, b;
};

/// @brief The contacts of two bodies during t in [0, 1]. (1) Never misses: surfaces that
/// come within the distance have a contact. (2) Never late: toc_lo is not after the first
/// time at which they do. (3) What is reported comes within distance + `touching`, unless
/// it is marked kGivenUp.
/// @pre the floating-point mode is the default one
MotionAnswer queryMotions(const MotionBody& a, const MotionBody& b,
                          const MotionQueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

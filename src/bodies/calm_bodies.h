// SPDX-License-Identifier: BSD-3-Clause
//
// A body of revolution that turns about its own axis always takes the same place, and so
// does a sphere that turns about its center. What moves beside it may turn about the same
// axis: a nut about a bolt without a thread. Such a turn changes no distance.
#ifndef FCL_CCD_BODIES_CALM_BODIES_H
#define FCL_CCD_BODIES_CALM_BODIES_H

#include "bodies/moving_body.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Two bodies with the turns left out that change no distance.
///
/// Property: at every time parts of the bodies are nearer to each other than the same
/// parts of these by no more than `deviation`. So what proves these further apart than a
/// distance and the deviation, proves that the bodies are further apart than the
/// distance. A shape counts as one part.
class CalmBodies {
 public:
  CalmBodies(const MovingBody& a, const MovingBody& b);

  /// @brief Whether a turn was left out. If not, they are the bodies themselves.
  bool areCalmer() const { return are_calmer_; }
  const MovingBody& body(int k) const { return body_[k]; }
  double deviation() const { return deviation_; }

 private:
  bool dropSpin(int k);
  bool dropCommonTurn(int k);
  bool keep(int k, const MotionPath& path, double deviation);

  MovingBody body_[2];
  bool are_calmer_{false};
  double deviation_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

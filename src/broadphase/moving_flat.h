// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BROADPHASE_MOVING_FLAT_H
#define FCL_CCD_BROADPHASE_MOVING_FLAT_H

#include <vector>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A plane or a halfspace that moves. The height of a point x above it is
/// normal . (x - pivot) - offset; the halfspace is where this is at most 0. Normals are
/// not longer than `stretch`, and of about this length. The height of a point that moves
/// straight has a bounded second derivative.
struct MovingFlat {
  /// At one of equally spaced times.
  struct Knot {
    double normal[3];
    double offset;
  };

  /// One knot more than spans. The number of spans is a power of two.
  std::vector<Knot> knots;
  bool is_solid;
  double pivot[3];
  double stretch;
  /// Bound on the second derivative of the height of a point x that moves straight with
  /// the velocity v: bend + bend_per_distance |x - pivot| + bend_per_speed |v|.
  double bend, bend_per_distance, bend_per_speed;
  /// What rounding and the tolerance of a query add to a height: room +
  /// room_per_distance |x - pivot|.
  double room, room_per_distance;

  int numSpans() const { return static_cast<int>(knots.size()) - 1; }
  bool goesStraight() const {
    return bend == 0 && bend_per_distance == 0 && bend_per_speed == 0;
  }
  bool rests() const;

  /// @brief The knot at time i of n + 1 equally spaced times.
  /// @pre n is numSpans(), unless it goes straight
  Knot knotAt(int i, int n) const;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CURVED_FLAT_CONTACTS_H
#define FCL_CCD_CURVED_FLAT_CONTACTS_H

#include "numerics/moving_vector.h"
#include "query/query_answer.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A plane that is posed in the world, all x with normal . x = offset; or the
/// halfspace below it.
struct PosedFlat {
  /// At t = 0; a unit vector, up to rounding.
  Vec normal;
  /// At t = 0 and t = 1. The second one counts if it goes straight.
  double offset[2];
  bool is_solid;
  bool goes_straight;
  /// Of the coordinates: offsets round by a few u of it.
  double size;
};

/// @brief The contact of two planes, two halfspaces, or one of each. They meet at once
/// unless they are parallel during the whole step, which means here: up to 2^-48, and no
/// rotation changes.
QueryAnswer queryFlats(const PosedFlat& a, const PosedFlat& b,
                       const QueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

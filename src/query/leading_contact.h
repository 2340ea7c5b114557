// SPDX-License-Identifier: BSD-3-Clause
//
// The bracket of the first contact, by which simulations advance: narrow beside the time
// itself, however early that is. With a bracket [0, toc_err] they would stand still.
#ifndef FCL_CCD_QUERY_LEADING_CONTACT_H
#define FCL_CCD_QUERY_LEADING_CONTACT_H

#include <algorithm>
#include <deque>
#include <limits>
#include <vector>

#include "elementary/feature_points.h"
#include "query/contact_sink.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Width of a tight bracket, as a share of its upper end. An eighth is enough to
/// step by; what is later than the leading contact by more than this is not looked at,
/// and narrowing a bracket costs the same to either width.
constexpr double kTightShare = 0x1p-10;

struct TimeBracket {
  double lo, hi;

  bool isTight() const { return hi - lo <= kTightShare * hi; }
};

/// @brief A contact whose tight bracket begins no later than first_hi, the end of
/// another's tight bracket, begins before this: the time t of a contact is at most hi,
/// lo >= (1 - kTightShare) hi, and 1 / (1 - kTightShare) < 1 + 2 kTightShare. The sum of
/// these rounds by 2^-53.
inline double latestLeading(double first_hi) {
  return first_hi * (1 + 2.5 * kTightShare) + std::numeric_limits<double>::denorm_min();
}

/// @brief The bracket of a contact, tight or, where no double lies between its ends, as
/// it is. Depends on nothing but the arguments.
/// @pre the features first touch in [bracket.lo, bracket.hi]
TimeBracket tightened(ContinuousContactKind kind, const FeaturePoints& x,
                      TimeBracket bracket);

/// @brief Makes the brackets tight of all contacts that may be the first, and those of
/// the others begin no earlier than that one's end. The answer does not depend on the
/// order of the contacts.
/// @param first_hi  the earliest end of a bracket
/// @param a, b  the meshes that the contacts are between
void tightenLeading(const MeshInstance& a, const MeshInstance& b, double first_hi,
                    std::vector<std::deque<FeatureContact>>& contacts);

/// @brief Puts the first contact among the earliest ones that were kept, whose brackets
/// all begin before others end, so that it may have been dropped: in place of itself, or
/// of the latest one.
void putLeading(const FeatureContact& first,
                std::vector<std::deque<FeatureContact>>& contacts);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

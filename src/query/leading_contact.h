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

/// @brief The tight bracket of the first of some contacts, whatever their order.
/// @pre there is a contact; first_hi is the earliest end of a bracket
/// @param a, b  the meshes that the contacts are between
TimeBracket bracketOfFirst(const MeshInstance& a, const MeshInstance& b, double first_hi,
                           const std::vector<std::deque<FeatureContact>>& contacts);

/// @brief The tight bracket of the first of contacts that come one by one.
class FirstBracket {
 public:
  /// @param bracket  of a contact
  /// @return whether the contact may be the first, so that its tight bracket is wanted
  bool wants(const TimeBracket& bracket) const { return bracket.lo <= first_hi_; }
  void add(const TimeBracket& tight);

  /// @brief Upper end of the earliest tight bracket; 1 without one.
  double firstHi() const { return first_hi_; }
  /// @brief The one that begins first; [1, 1] without one.
  const TimeBracket& get() const { return first_; }

 private:
  double first_hi_{1};
  TimeBracket first_{1, 1};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// The bracket of the first contact. Simulations advance to its lower end. So its width is
// small relative to the time itself, however early that is: with a bracket [0, toc_err] a
// simulation would not advance at all.
#ifndef FCL_CCD_QUERY_LEADING_CONTACT_H
#define FCL_CCD_QUERY_LEADING_CONTACT_H

#include <algorithm>
#include <deque>
#include <vector>

#include "elementary/feature_points.h"
#include "query/contact_sink.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The width of a tight bracket, relative to its upper end. An eighth would be
/// enough for a simulation to advance. A smaller share costs the same for each bracket,
/// and fewer contacts are early enough to need one.
constexpr double kTightShare = 0x1p-10;

struct TimeBracket {
  double lo, hi;

  bool isTight() const { return hi - lo <= kTightShare * hi; }
};

/// @brief Let first_hi be the upper end of a tight bracket. If another tight bracket
/// begins no later than first_hi, its contact is before the time that this function
/// returns. Proof: the contact is no later than hi, lo >= (1 - kTightShare) hi, and 1 /
/// (1 - kTightShare) < 1 + 2 kTightShare. The sum and the product round by 2^-53 each. If
/// first_hi is 0, any number above 0 would do. 2^-200 is earlier than any time that
/// matters, and its products with coordinates above 2^-800 are normal numbers, with which
/// a processor is several times as fast as with subnormal ones.
inline double latestLeading(double first_hi) {
  return first_hi * (1 + 2.5 * kTightShare) + 0x1p-200;
}

/// @brief A tight bracket of a contact, or the narrowest that doubles allow. It depends
/// on nothing but the arguments.
/// @pre the features first touch in [bracket.lo, bracket.hi]
TimeBracket tightened(ContinuousContactKind kind, const FeaturePoints& x,
                      TimeBracket bracket);

/// @brief The tight bracket of the first of several contacts. It does not depend on their
/// order.
/// @pre there is a contact, and first_hi is the earliest upper end of a bracket
/// @param a, b  the meshes of the contacts
TimeBracket bracketOfFirst(const MeshInstance& a, const MeshInstance& b, double first_hi,
                           const std::vector<std::deque<FeatureContact>>& contacts);

/// @brief Finds the tight bracket of the first contact, from contacts that come one by
/// one.
class FirstBracket {
 public:
  /// @brief Whether a contact with this bracket may be the first. If so, call add() with
  /// its tight bracket.
  bool wants(const TimeBracket& bracket) const { return bracket.lo <= first_hi_; }
  void add(const TimeBracket& tight);

  /// @brief The earliest upper end of a tight bracket; 1 without contacts.
  double firstHi() const { return first_hi_; }
  /// @brief The tight bracket that begins first; [1, 1] without contacts.
  const TimeBracket& get() const { return first_; }

 private:
  double first_hi_{1};
  TimeBracket first_{1, 1};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "query/leading_contact.h"

#include <cassert>
#include <limits>

#include "elementary/elementary.h"
#include "elementary/exact.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The paths of a contact's vertices.
class ContactPaths {
 public:
  ContactPaths(const FeatureContact& contact, const MeshInstance& a,
               const MeshInstance& b) {
    for (unsigned i = 0; i < 4; ++i) {
      const bool on_a = isPointOfA(contact.kind, contact.first_on_a, i);
      path_[i] = (on_a ? a : b).frames[contact.vertices[i]];
    }
  }
  FeaturePoints points() const { return {{&path_[0], &path_[1], &path_[2], &path_[3]}}; }

 private:
  VertexPath path_[4];
};

/// Whether the features may touch in [lo, latest]; false is a proof that they do not.
bool mayTouchUntil(ContinuousContactKind kind, const FeaturePoints& x, double lo,
                   double latest) {
  constexpr double kCoarse = 0x1p-3;
  assert(0 <= lo && lo <= latest && 0 < latest && latest <= 1);
  return solveCoplanarity(kind, x, lo, latest, kCoarse * latest).answer != Answer::kNo;
}

}  // namespace

TimeBracket tightened(ContinuousContactKind kind, const FeaturePoints& x,
                      TimeBracket bracket) {
  assert(0 <= bracket.lo && bracket.lo <= bracket.hi && bracket.hi <= 1);
  // Each round makes the bracket tight, or its upper end less than half of what it was.
  while (!bracket.isTight()) {
    const double width = std::max(0.25 * kTightShare * bracket.hi,
                                  std::numeric_limits<double>::denorm_min());
    ElementaryResult found = solveCoplanarity(kind, x, bracket.lo, bracket.hi, width);
    if (found.answer != Answer::kYes) found = decideExactly(kind, x, width);
    assert(found.answer == Answer::kYes);
    const TimeBracket next{std::max(bracket.lo, found.toc_lo),
                           std::min(bracket.hi, found.toc_hi)};
    // Both contain the first time.
    assert(next.lo <= next.hi);
    if (next.lo == bracket.lo && next.hi == bracket.hi) break;
    bracket = next;
  }
  return bracket;
}

void FirstBracket::add(const TimeBracket& tight) {
  assert(0 <= tight.lo && tight.lo <= tight.hi && tight.hi <= 1);
  first_hi_ = std::min(first_hi_, tight.hi);
  const bool is_earlier =
      tight.lo != first_.lo ? tight.lo < first_.lo : tight.hi < first_.hi;
  if (is_earlier) first_ = tight;
  assert(first_.lo <= first_hi_ && first_hi_ <= first_.hi);
}

TimeBracket bracketOfFirst(const MeshInstance& a, const MeshInstance& b, double first_hi,
                           const std::vector<std::deque<FeatureContact>>& contacts) {
  // A contact at t = 0 has the bracket [0, 0].
  if (first_hi == 0) return {0, 0};
  FirstBracket first;
  for (const std::deque<FeatureContact>& list : contacts)
    for (const FeatureContact& contact : list) {
      const TimeBracket bracket{contact.toc_lo, contact.toc_hi};
      first_hi = std::min(first_hi, first.firstHi());
      if (bracket.lo > first_hi) continue;
      if (bracket.isTight()) {
        first.add(bracket);
        continue;
      }
      const ContactPaths paths(contact, a, b);
      const double latest = std::min(bracket.hi, latestLeading(first_hi));
      if (mayTouchUntil(contact.kind, paths.points(), bracket.lo, latest))
        first.add(tightened(contact.kind, paths.points(), bracket));
    }
  // The first contact is among them.
  assert(first.get().lo <= first_hi);
  return first.get();
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

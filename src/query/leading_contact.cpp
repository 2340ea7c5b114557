// SPDX-License-Identifier: BSD-3-Clause
#include "query/leading_contact.h"

#include <cassert>
#include <cmath>
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
    const int num_first = contact.kind == ContinuousContactKind::kVertexFace ? 1 : 2;
    for (int i = 0; i < 4; ++i) {
      const bool on_a = (i < num_first) == contact.first_on_a;
      path_[i] = (on_a ? a : b).frames[contact.vertices[i]];
    }
  }
  FeaturePoints points() const { return {{&path_[0], &path_[1], &path_[2], &path_[3]}}; }

 private:
  VertexPath path_[4];
};

/// False proves that the features do not touch in [lo, latest].
bool mayTouchUntil(ContinuousContactKind kind, const FeaturePoints& x, double lo,
                   double latest) {
  constexpr double kCoarse = 0x1p-3;
  return solveCoplanarity(kind, x, lo, latest, kCoarse * latest).answer != Answer::kNo;
}

/// Beside contacts that touch at t = 0: those that do not begin later than 0.
void separateFromStart(const MeshInstance& a, const MeshInstance& b,
                       std::vector<std::deque<FeatureContact>>& contacts) {
  constexpr double kEarlyShare = 0x1p-20;
  for (std::deque<FeatureContact>& list : contacts)
    for (FeatureContact& contact : list) {
      if (contact.toc_lo > 0 || contact.toc_hi == 0) continue;
      const ContactPaths paths(contact, a, b);
      TimeBracket bracket{kEarlyShare * contact.toc_hi, contact.toc_hi};
      if (mayTouchUntil(contact.kind, paths.points(), 0, bracket.lo))
        bracket = tightened(contact.kind, paths.points(), {0, contact.toc_hi});
      contact.toc_lo = bracket.lo;
      contact.toc_hi = bracket.hi;
    }
}

/// A contact that may be the first, and its tight bracket.
struct Leading {
  FeatureContact* contact;
  TimeBracket bracket;
};

}  // namespace

TimeBracket tightened(ContinuousContactKind kind, const FeaturePoints& x,
                      TimeBracket bracket) {
  // Each time the end comes down to less than half of itself, or the bracket is tight.
  while (!bracket.isTight()) {
    const double width = std::max(0.25 * kTightShare * bracket.hi,
                                  std::numeric_limits<double>::denorm_min());
    ElementaryResult found = solveCoplanarity(kind, x, bracket.lo, bracket.hi, width);
    if (found.answer != Answer::kYes) found = decideExactly(kind, x, width);
    assert(found.answer == Answer::kYes);
    const TimeBracket next{std::max(bracket.lo, found.toc_lo),
                           std::min(bracket.hi, found.toc_hi)};
    if (next.lo == bracket.lo && next.hi == bracket.hi) break;
    bracket = next;
  }
  return bracket;
}

void tightenLeading(const MeshInstance& a, const MeshInstance& b, double first_hi,
                    std::vector<std::deque<FeatureContact>>& contacts) {
  if (first_hi == 0) return separateFromStart(a, b, contacts);
  std::vector<Leading> leading;
  for (std::deque<FeatureContact>& list : contacts)
    for (FeatureContact& contact : list) {
      if (contact.toc_lo > first_hi) continue;
      TimeBracket bracket{contact.toc_lo, contact.toc_hi};
      if (!bracket.isTight()) {
        const ContactPaths paths(contact, a, b);
        const double latest = std::min(bracket.hi, latestLeading(first_hi));
        if (!mayTouchUntil(contact.kind, paths.points(), bracket.lo, latest)) continue;
        bracket = tightened(contact.kind, paths.points(), bracket);
      }
      first_hi = std::min(first_hi, bracket.hi);
      leading.push_back({&contact, bracket});
    }
  // None of the others touches before the next double: they do not touch until
  // latestLeading(), or their tight brackets begin later.
  const double next = std::nextafter(first_hi, 1.);
  const double others = next < latestLeading(first_hi) ? next : first_hi;
  for (std::deque<FeatureContact>& list : contacts)
    for (FeatureContact& contact : list)
      contact.toc_lo = std::max(contact.toc_lo, others);
  for (const Leading& lead : leading)
    if (lead.bracket.lo <= first_hi) {
      lead.contact->toc_lo = lead.bracket.lo;
      lead.contact->toc_hi = lead.bracket.hi;
    }
}

void putLeading(const FeatureContact& first,
                std::vector<std::deque<FeatureContact>>& contacts) {
  FeatureContact *same = nullptr, *latest = nullptr;
  for (std::deque<FeatureContact>& list : contacts)
    for (FeatureContact& contact : list) {
      if (keyOf(contact) == keyOf(first)) same = &contact;
      if (!latest || isEarlier(*latest, contact)) latest = &contact;
    }
  assert(latest);
  *(same ? same : latest) = first;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

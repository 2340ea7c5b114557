// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of features that integers have decided, for meshes without owners: these meet a
// pair in up to four pairs of triangles. An exact decision takes some 5 us or more.
#ifndef FCL_CCD_QUERY_DECIDED_PAIRS_H
#define FCL_CCD_QUERY_DECIDED_PAIRS_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "elementary/feature_points.h"
#include "mesh/feature_pairs.h"
#include "query/feature_candidate.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Remembers the decisions of some pairs. A decision is used again only if all
/// that it depends on is the same, so that no answer and no count depends on what is
/// remembered. A pair is forgotten when another one takes its slot.
class DecidedPairs {
 public:
  /// @brief The decision of the same pair with the same t_stop, or null.
  const ElementaryResult* find(const FeatureCandidate& pair, double t_stop) const {
    if (slots_.empty()) return nullptr;
    const Slot& slot = slots_[slotOf(pair)];
    return slot.is_taken && slot.t_stop == t_stop && isSame(slot, pair) ? &slot.result
                                                                        : nullptr;
  }

  void add(const FeatureCandidate& pair, double t_stop, const ElementaryResult& result) {
    if (slots_.empty()) slots_.resize(kSlots);
    Slot& slot = slots_[slotOf(pair)];
    slot.is_taken = true;
    slot.kind = pair.kind;
    slot.first_on_a = pair.first_on_a;
    std::copy(pair.vertices, pair.vertices + 4, slot.vertices);
    slot.window_lo = pair.window_lo;
    slot.window_hi = pair.window_hi;
    slot.t_stop = t_stop;
    slot.result = result;
  }

 private:
  /// 320 KB. The triangles of a block are neighbours, and meet a pair again soon.
  static constexpr std::size_t kSlots = 4096;

  struct Slot {
    bool is_taken{false};
    bool first_on_a;
    ContinuousContactKind kind;
    std::uint32_t vertices[4];
    double window_lo, window_hi, t_stop;
    ElementaryResult result;
  };

  /// The bits of a decision may depend on the order of the vertices of a face.
  static bool isSame(const Slot& slot, const FeatureCandidate& pair) {
    return slot.kind == pair.kind && slot.first_on_a == pair.first_on_a &&
           slot.window_lo == pair.window_lo && slot.window_hi == pair.window_hi &&
           std::equal(slot.vertices, slot.vertices + 4, pair.vertices);
  }
  static std::size_t slotOf(const FeatureCandidate& pair) {
    return FeatureKey(pair).hash() % kSlots;
  }

  std::vector<Slot> slots_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of features that integers have decided, for meshes without owners: these meet a
// pair in up to four pairs of triangles. An exact decision takes some 5 us or more.
#ifndef FCL_CCD_QUERY_DECIDED_PAIRS_H
#define FCL_CCD_QUERY_DECIDED_PAIRS_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "base/slot_cache.h"
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
    return decided_ ? decided_->find(slotOf(pair), Key(pair, t_stop)) : nullptr;
  }

  void add(const FeatureCandidate& pair, double t_stop, const ElementaryResult& result) {
    if (!decided_) decided_ = std::make_unique<Decided>(Key(FeatureCandidate{}, -1));
    decided_->put(slotOf(pair), Key(pair, t_stop)) = result;
  }

 private:
  /// What a decision depends on. Its bits may depend on the order of the vertices of a
  /// face.
  struct Key {
    Key() = default;
    Key(const FeatureCandidate& pair, double t_stop)
        : kind(pair.kind),
          first_on_a(pair.first_on_a),
          times{pair.window_lo, pair.window_hi, t_stop} {
      std::copy(pair.vertices, pair.vertices + 4, vertices.begin());
    }
    bool operator==(const Key& x) const {
      return kind == x.kind && first_on_a == x.first_on_a && times == x.times &&
             vertices == x.vertices;
    }

    ContinuousContactKind kind{};
    bool first_on_a{false};
    std::array<std::uint32_t, 4> vertices{};
    std::array<double, 3> times{};
  };

  /// 320 KB. The triangles of a block are neighbours, and meet a pair again soon.
  using Decided = SlotCache<Key, ElementaryResult, 4096>;

  static std::size_t slotOf(const FeatureCandidate& pair) {
    return FeatureKey(pair).hash() % Decided::kSlots;
  }

  std::unique_ptr<Decided> decided_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

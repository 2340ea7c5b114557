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
#include "query/feature_batch.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Remembers the decisions of some pairs. A decision is used again only if all
/// that it depends on is the same, so that no answer and no count depends on what is
/// remembered. A pair is forgotten when another one takes its place.
class DecidedPairs {
 public:
  /// @brief The decision of the same pair with the same t_stop, or null.
  const ElementaryResult* find(const FeatureCandidate& pair, double t_stop) const {
    if (places_.empty()) return nullptr;
    const Place& place = places_[placeOf(pair)];
    return place.is_taken && place.t_stop == t_stop && isSame(place, pair) ? &place.result
                                                                           : nullptr;
  }

  void add(const FeatureCandidate& pair, double t_stop, const ElementaryResult& result) {
    if (places_.empty()) places_.resize(kPlaces);
    Place& place = places_[placeOf(pair)];
    place.is_taken = true;
    place.kind = pair.kind;
    place.first_on_a = pair.first_on_a;
    std::copy(pair.vertices, pair.vertices + 4, place.vertices);
    place.window_lo = pair.window_lo;
    place.window_hi = pair.window_hi;
    place.t_stop = t_stop;
    place.result = result;
  }

 private:
  /// 320 KB. The triangles of a block are neighbours, and meet a pair again soon.
  static constexpr std::size_t kPlaces = 4096;

  struct Place {
    bool is_taken{false};
    bool first_on_a;
    ContinuousContactKind kind;
    std::uint32_t vertices[4];
    double window_lo, window_hi, t_stop;
    ElementaryResult result;
  };

  static bool isSame(const Place& place, const FeatureCandidate& pair) {
    return place.kind == pair.kind && place.first_on_a == pair.first_on_a &&
           place.window_lo == pair.window_lo && place.window_hi == pair.window_hi &&
           std::equal(place.vertices, place.vertices + 4, pair.vertices);
  }
  static std::size_t placeOf(const FeatureCandidate& pair) {
    // After FNV-1a, by words.
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const std::uint32_t v : pair.vertices) hash = (hash ^ v) * 0x100000001b3;
    return static_cast<std::size_t>(hash ^ (hash >> 32)) % kPlaces;
  }

  std::vector<Place> places_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

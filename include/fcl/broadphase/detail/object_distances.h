// SPDX-License-Identifier: BSD-3-Clause
//
// The distances at which the objects of a manager are in contact.
#ifndef FCL_BROADPHASE_DETAIL_OBJECT_DISTANCES_H
#define FCL_BROADPHASE_DETAIL_OBJECT_DISTANCES_H

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

#include "fcl/common/exception.h"

namespace fcl {
namespace detail {

template <typename S>
void requireNotNegative(S number, const char* name, const char* unit) {
  if (!(number >= 0) || !std::isfinite(number))
    throw Exception(std::string(name) +
                    " is negative or not finite. Give 0 or more, in " + unit);
}

/// @brief What each object adds to the distance of a query, and pairs that have a
/// distance of their own in place of both. Without any it takes no memory and no time.
template <typename S>
class ObjectDistances {
 public:
  bool empty() const { return thickness_.empty() && pairs_of_.empty(); }

  void setThickness(const void* object, S thickness) {
    if (thickness > 0)
      thickness_[object] = thickness;
    else
      thickness_.erase(object);
  }
  S thicknessOf(const void* object) const {
    const auto entry = thickness_.find(object);
    return entry == thickness_.end() ? S(0) : entry->second;
  }

  void setPair(const void* o1, const void* o2, S distance) {
    pairs_of_[o1][o2] = distance;
    pairs_of_[o2][o1] = distance;
  }
  void forgetPair(const void* o1, const void* o2) {
    forgetSide(o1, o2);
    forgetSide(o2, o1);
  }

  /// @return the objects that had a distance of their own from this one
  std::vector<const void*> forget(const void* object) {
    std::vector<const void*> others;
    thickness_.erase(object);
    const auto entry = pairs_of_.find(object);
    if (entry == pairs_of_.end()) return others;
    for (const auto& pair : entry->second)
      if (pair.first != object) others.push_back(pair.first);
    pairs_of_.erase(entry);
    for (const void* other : others) forgetSide(other, object);
    return others;
  }
  void clear() {
    thickness_.clear();
    pairs_of_.clear();
  }

  /// What is added to the distance of a query for two objects.
  S of(const void* o1, const void* o2) const {
    const auto pairs = pairs_of_.find(o1);
    if (pairs != pairs_of_.end()) {
      const auto pair = pairs->second.find(o2);
      if (pair != pairs->second.end()) return pair->second;
    }
    return thicknessOf(o1) + thicknessOf(o2);
  }

  /// A margin for the box of an object: the margins of two objects add up to of() or
  /// more.
  S marginOf(const void* object) const {
    S margin = thicknessOf(object);
    const auto pairs = pairs_of_.find(object);
    if (pairs != pairs_of_.end())
      for (const auto& pair : pairs->second) margin = std::max(margin, pair.second / 2);
    return margin;
  }

 private:
  void forgetSide(const void* object, const void* other) {
    const auto pairs = pairs_of_.find(object);
    if (pairs == pairs_of_.end()) return;
    pairs->second.erase(other);
    if (pairs->second.empty()) pairs_of_.erase(pairs);
  }

  std::unordered_map<const void*, S> thickness_;
  /// Each pair is in the lists of both objects.
  std::unordered_map<const void*, std::unordered_map<const void*, S>> pairs_of_;
};

}  // namespace detail
}  // namespace fcl

#endif

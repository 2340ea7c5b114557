// SPDX-License-Identifier: BSD-3-Clause
//
// The distances at which the objects of a manager are in contact.
#ifndef FCL_BROADPHASE_DETAIL_OBJECT_DISTANCES_H
#define FCL_BROADPHASE_DETAIL_OBJECT_DISTANCES_H

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "fcl/common/exception.h"

namespace fcl {
namespace detail {

template <typename S>
void requireThickness(S distance, const char* name) {
  if (!(distance >= 0) || !std::isfinite(distance))
    throw Exception(std::string(name) +
                    " is negative or not finite. Give 0 or more, in the unit of the "
                    "coordinates");
}

/// @brief What each object adds to the distance of a query, and pairs that have a
/// distance of their own in place of both. Without any it takes no memory and no time.
template <typename S>
class ObjectDistances {
 public:
  bool empty() const { return thickness_.empty() && pairs_.empty(); }

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
    pairs_[inOrder(o1, o2)] = distance;
  }
  void forgetPair(const void* o1, const void* o2) { pairs_.erase(inOrder(o1, o2)); }

  void forget(const void* object) {
    thickness_.erase(object);
    for (auto it = pairs_.begin(); it != pairs_.end();)
      it = it->first.first == object || it->first.second == object ? pairs_.erase(it)
                                                                   : std::next(it);
  }
  void clear() {
    thickness_.clear();
    pairs_.clear();
  }

  /// What is added to the distance of a query for two objects.
  S of(const void* o1, const void* o2) const {
    const auto entry = pairs_.empty() ? pairs_.end() : pairs_.find(inOrder(o1, o2));
    return entry == pairs_.end() ? thicknessOf(o1) + thicknessOf(o2) : entry->second;
  }

  /// A margin for the box of an object: the margins of two objects add up to of() or
  /// more.
  S marginOf(const void* object) const {
    S margin = thicknessOf(object);
    for (const auto& pair : pairs_)
      if (pair.first.first == object || pair.first.second == object)
        margin = std::max(margin, pair.second / 2);
    return margin;
  }

 private:
  using ObjectPair = std::pair<const void*, const void*>;

  static ObjectPair inOrder(const void* o1, const void* o2) {
    return std::less<const void*>()(o2, o1) ? ObjectPair(o2, o1) : ObjectPair(o1, o2);
  }

  std::unordered_map<const void*, S> thickness_;
  std::map<ObjectPair, S> pairs_;
};

}  // namespace detail
}  // namespace fcl

#endif

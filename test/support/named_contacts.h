// SPDX-License-Identifier: BSD-3-Clause
//
// The contacts of queries by the ids of their features, for comparisons.
#ifndef FCL_TEST_SUPPORT_NAMED_CONTACTS_H
#define FCL_TEST_SUPPORT_NAMED_CONTACTS_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "query/deformable_query.h"

namespace fcl {
namespace test {

using Ids = std::vector<std::uint32_t>;
/// Kind, whether the vertex of a VF pair is in mesh b, ids of both features.
using PairName = std::tuple<ContinuousContactKind, bool, Ids, Ids>;

inline Ids sorted(Ids ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// A mesh as a query uses it, with its triangles by the user's ids.
struct Body {
  const detail::deformable::MeshInstance& instance;
  const std::vector<Triangle>& triangles;

  Ids ids(std::size_t i) const {
    const Triangle& t = triangles[i];
    return {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
            static_cast<std::uint32_t>(t[2])};
  }
};

inline PairName nameOf(const detail::deformable::FeatureContact& c, bool self) {
  const std::uint32_t* v = c.vertices;
  if (c.kind == ContinuousContactKind::kVertexFace)
    return {c.kind, !c.first_on_a, {v[0]}, sorted({v[1], v[2], v[3]})};
  Ids x = sorted({v[0], v[1]}), y = sorted({v[2], v[3]});
  if (self && y < x) std::swap(x, y);
  return {c.kind, false, x, y};
}

/// The contacts of a self-collision, by name, with their brackets.
inline std::vector<std::tuple<double, double, PairName>> listOf(
    const detail::deformable::QueryAnswer& answer) {
  std::vector<std::tuple<double, double, PairName>> list;
  for (const detail::deformable::FeatureContact& c : answer.contacts)
    list.emplace_back(c.toc_lo, c.toc_hi, nameOf(c, true));
  return list;
}

inline detail::deformable::QueryAnswer query(
    const Body& a, const Body& b, const detail::deformable::QueryOptions& options) {
  return &a == &b ? detail::deformable::querySelf(a.instance, options)
                  : detail::deformable::queryPair(a.instance, b.instance, options);
}

}  // namespace test
}  // namespace fcl

#endif

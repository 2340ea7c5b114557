// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_BENCHMARK_MOTIONS_CONTACT_FEATURES_H
#define FCL_TEST_BENCHMARK_MOTIONS_CONTACT_FEATURES_H

#include <algorithm>
#include <array>
#include <map>

#include "fcl/math/triangle.h"
#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {
namespace test {

/// @brief The pairs of features that have a contact, and when.
class ContactFeatures {
 public:
  explicit ContactFeatures(const ContinuousContactResult<double>& result) {
    for (const auto& contact : result.contacts) {
      const Features features =
          featuresOf(contact.kind, contact.first_on_o1, contact.vertices);
      const auto it = first_.emplace(features, contact.toc_lo).first;
      it->second = std::min(it->second, contact.toc_lo);
    }
  }

  /// @brief Whether features of two triangles have a contact until a time.
  bool haveBy(double time, const Triangle& a, const Triangle& b) const {
    const auto id = [](const Triangle& x, int k) { return static_cast<int>(x[k % 3]); };
    const auto has = [&](const Features& features) {
      const auto it = first_.find(features);
      return it != first_.end() && it->second <= time;
    };
    for (int i = 0; i < 3; ++i) {
      const std::array<int, 5> of_a{id(a, i), id(b, 0), id(b, 1), id(b, 2), -1},
          of_b{id(b, i), id(a, 0), id(a, 1), id(a, 2), -1};
      if (has(featuresOf(ContinuousContactKind::kVertexFace, true, of_a)) ||
          has(featuresOf(ContinuousContactKind::kVertexFace, false, of_b)))
        return true;
      for (int j = 0; j < 3; ++j)
        if (has(featuresOf(ContinuousContactKind::kEdgeEdge, true,
                           {id(a, i), id(a, i + 1), id(b, j), id(b, j + 1), -1})))
          return true;
    }
    return false;
  }

 private:
  /// The kind of features, then their vertices, sorted.
  using Features = std::array<int, 5>;

  static Features featuresOf(ContinuousContactKind kind, bool is_first,
                             const std::array<int, 5>& v) {
    if (kind == ContinuousContactKind::kEdgeEdge)
      return {0, std::min(v[0], v[1]), std::max(v[0], v[1]), std::min(v[2], v[3]),
              std::max(v[2], v[3])};
    Features out{is_first ? 1 : 2, v[0], v[1], v[2], v[3]};
    std::sort(out.begin() + 2, out.end());
    return out;
  }

  std::map<Features, double> first_;
};

}  // namespace test
}  // namespace fcl

#endif

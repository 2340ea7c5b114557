// SPDX-License-Identifier: BSD-3-Clause
//
// Which pairs of triangles count in a query, by bits of groups and masks and by a
// function of the caller's. A feature is part of several triangles, of which one owns it
// (mesh_topology.h): a pair of features counts if any two triangles that hold them do.
#ifndef FCL_CCD_QUERY_PAIR_FILTER_H
#define FCL_CCD_QUERY_PAIR_FILTER_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "mesh/feature_pairs.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The groups that the triangles of a mesh are in and those that they meet.
struct TriangleMarks {
  std::uint32_t group{1};
  std::uint32_t mask{~std::uint32_t{0}};
  /// For each triangle, in place of the above; null: none.
  const std::uint32_t* groups{nullptr};
  const std::uint32_t* masks{nullptr};

  std::uint32_t groupOf(std::int32_t triangle) const {
    return groups ? groups[triangle] : group;
  }
  std::uint32_t maskOf(std::int32_t triangle) const {
    return masks ? masks[triangle] : mask;
  }
  bool areAllEqual() const { return !groups && !masks; }
};

/// @brief What counts: of mesh a and b, twice the same for a mesh with itself.
struct PairRules {
  TriangleMarks marks[2];
  /// Of a triangle of a and one of b; null: all count.
  const std::function<bool(std::intptr_t, std::intptr_t)>* accepts{nullptr};

  /// @brief Whether the groups and masks of two triangles, and then the function, accept
  /// them.
  bool accept(std::int32_t a, std::int32_t b) const {
    return (marks[0].groupOf(a) & marks[1].maskOf(b)) != 0 &&
           (marks[1].groupOf(b) & marks[0].maskOf(a)) != 0 &&
           (!accepts || (*accepts)(a, b));
  }
  /// @brief Whether all pairs get one answer; accept() of any two triangles gives it.
  bool areAllEqual() const {
    return marks[0].areAllEqual() && marks[1].areAllEqual() && !accepts;
  }
};

/// @brief A vertex, an edge or a face, and a triangle that holds it.
struct HeldFeature {
  const std::uint32_t* ids;
  unsigned count;
  std::int32_t triangle;
};

/// @brief The triangles at each vertex of a mesh whose features have owners.
class TrianglesAtVertices {
 public:
  /// @param mesh  of one without a moving tree nothing is kept: each of its triangles
  /// meets with all its features
  explicit TrianglesAtVertices(const MeshInstance& mesh);

  /// @brief Calls visit with the triangles that hold the feature, lowest number first,
  /// until it returns true.
  /// @return whether it did
  template <typename Visit>
  bool anyOf(const HeldFeature& feature, Visit&& visit) const {
    if (first_.empty()) return visit(feature.triangle);
    for (std::uint32_t i = first_[feature.ids[0]]; i < first_[feature.ids[0] + 1]; ++i)
      if (holds(corners_[i], feature) && visit(corners_[i].triangle)) return true;
    return false;
  }

 private:
  struct Corner {
    std::int32_t triangle;
    std::uint32_t ids[3];
  };
  static bool holds(const Corner& corner, const HeldFeature& feature);

  std::vector<std::uint32_t> first_;
  std::vector<Corner> corners_;
};

/// @brief The rules for the pairs of features of two meshes; safe to use from threads as
/// far as the function in the rules is.
class PairFilter {
 public:
  /// @param a, b  the same object twice for a self-collision
  /// @param rules  copied; what it points to is not
  PairFilter(const MeshInstance& a, const MeshInstance& b, const PairRules& rules)
      : rules_(rules), holders_of_a_(a) {
    if (&a != &b) holders_of_b_.emplace(b);
  }

  const PairRules& rules() const { return rules_; }

  /// @brief Finds two triangles that count and hold the features of a and of b: the ones
  /// given, or else those with the lowest numbers.
  /// @param[out] triangles  of a and b; unchanged without any
  bool find(const HeldFeature& a, const HeldFeature& b,
            std::int32_t (&triangles)[2]) const;

  /// @brief The same for a pair of features.
  bool find(const FeatureIds& pair, std::int32_t (&triangles)[2]) const;

 private:
  PairRules rules_;
  TrianglesAtVertices holders_of_a_;
  /// Empty: the same mesh.
  std::optional<TrianglesAtVertices> holders_of_b_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Which pairs of triangles count in a query: bits of groups and masks decide, and a
// function of the caller. Several triangles hold a feature; one of them owns it
// (mesh_topology.h). A pair of features counts if any two triangles that hold the
// features count.
#ifndef FCL_CCD_QUERY_PAIR_FILTER_H
#define FCL_CCD_QUERY_PAIR_FILTER_H

#include <cassert>
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

/// @brief For the triangles of a mesh, the groups to which they belong (a bit each), and
/// the groups with which they are tested.
struct TriangleMarks {
  std::uint32_t group{1};
  std::uint32_t mask{~std::uint32_t{0}};
  /// One number for each triangle, instead of the one above; null: the one above.
  const std::uint32_t* groups{nullptr};
  const std::uint32_t* masks{nullptr};

  std::uint32_t groupOf(std::int32_t triangle) const {
    assert(!groups || triangle >= 0);
    return groups ? groups[triangle] : group;
  }
  std::uint32_t maskOf(std::int32_t triangle) const {
    assert(!masks || triangle >= 0);
    return masks ? masks[triangle] : mask;
  }
  bool areAllEqual() const { return !groups && !masks; }
};

/// @brief The rules that decide which pairs of triangles count.
struct PairRules {
  /// Of mesh a and mesh b; twice the same for a mesh with itself.
  TriangleMarks marks[2];
  /// Whether a triangle of a and one of b count; null: all do.
  const std::function<bool(std::intptr_t, std::intptr_t)>* accepts{nullptr};

  /// @brief Whether the groups and masks of two triangles, and then the function, accept
  /// them.
  bool accept(std::int32_t a, std::int32_t b) const {
    return (marks[0].groupOf(a) & marks[1].maskOf(b)) != 0 &&
           (marks[1].groupOf(b) & marks[0].maskOf(a)) != 0 &&
           (!accepts || (*accepts)(a, b));
  }
  /// @brief Whether accept() is the same for all pairs of triangles.
  bool areAllEqual() const {
    return marks[0].areAllEqual() && marks[1].areAllEqual() && !accepts;
  }
};

/// @brief A vertex, an edge or a face, by its vertex ids, and a triangle that holds it.
struct HeldFeature {
  const std::uint32_t* ids;
  unsigned count;
  std::int32_t triangle;
};

/// @brief The triangles at each vertex of a mesh.
class TrianglesAtVertices {
 public:
  /// Lists none: of a mesh whose features have no owners each triangle is tested with all
  /// its features.
  TrianglesAtVertices() = default;
  explicit TrianglesAtVertices(const MeshInstance& mesh);

  /// @brief Calls visit(triangle) for the triangles that hold the feature, lowest number
  /// first, until it returns true.
  /// @return whether visit has returned true
  template <typename Visit>
  bool anyOf(const HeldFeature& feature, Visit&& visit) const {
    if (first_.empty()) return visit(feature.triangle);
    assert(feature.count > 0 && std::size_t{feature.ids[0]} + 1 < first_.size());
    for (std::uint32_t i = first_[feature.ids[0]]; i < first_[feature.ids[0] + 1]; ++i)
      if (holds(corners_[i], feature) && visit(corners_[i].triangle)) return true;
    return false;
  }

  /// @brief Calls visit(ids) for the triangles at a vertex, lowest number first. A
  /// triangle that has the vertex several times is visited as often.
  template <typename Visit>
  void forEachAt(std::uint32_t vertex, Visit&& visit) const {
    assert(std::size_t{vertex} + 1 < first_.size());
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i)
      visit(corners_[i].ids);
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

/// @brief The rules, for pairs of features of two meshes. Several threads may call find()
/// at the same time, if they may call the function in the rules.
class PairFilter {
 public:
  /// @param a, b  the same object for a self-collision
  /// @param rules  copied, but not what its pointers refer to
  PairFilter(const MeshInstance& a, const MeshInstance& b, const PairRules& rules)
      : rules_(rules), holders_of_a_(holdersOf(a)) {
    if (&a != &b) holders_of_b_ = holdersOf(b);
  }

  const PairRules& rules() const { return rules_; }

  /// @brief Finds two triangles that hold the features of a and b and that count. It
  /// tries the triangles of `a` and `b` first, then others from the lowest numbers on.
  /// @param[out] triangles  of mesh a and mesh b; unchanged if there are none
  /// @return whether there are any
  bool find(const HeldFeature& a, const HeldFeature& b,
            std::int32_t (&triangles)[2]) const;

  /// @brief The same for a pair of features.
  bool find(const FeatureIds& pair, std::int32_t (&triangles)[2]) const;

 private:
  static TrianglesAtVertices holdersOf(const MeshInstance& mesh) {
    return mesh.tree ? TrianglesAtVertices(mesh) : TrianglesAtVertices();
  }

  PairRules rules_;
  TrianglesAtVertices holders_of_a_;
  /// Empty for a self-collision.
  std::optional<TrianglesAtVertices> holders_of_b_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

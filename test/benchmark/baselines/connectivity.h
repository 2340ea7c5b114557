// SPDX-License-Identifier: BSD-3-Clause
//
// Which triangles have a feature, which of them owns it (Curtis, Tamstorf, Manocha 2008),
// and what adjacent triangles need not test because other triangles do (Tang, Curtis,
// Yoon, Manocha 2009).
#ifndef FCL_BENCHMARK_BASELINES_CONNECTIVITY_H
#define FCL_BENCHMARK_BASELINES_CONNECTIVITY_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "mesh/feature_pairs.h"

namespace fcl {
namespace test {

/// @brief Two triangles and the pairs of their features that are meant, a bit each, as
/// feature_pairs.h counts them.
struct TrianglePairMask {
  int a, b;
  std::uint16_t pairs;
};

/// @brief Triangles as a tree counts them, and their features.
class MeshConnectivity {
 public:
  using Edge = std::array<std::uint32_t, 2>;
  using MeshTriangle = detail::deformable::MeshTriangle;

  /// @param triangles  in the tree's order; owners are found here. The first triangle
  /// that has a feature owns it, as assignFeatures() has it.
  MeshConnectivity(std::vector<std::array<std::uint32_t, 3>> triangles,
                   std::size_t num_vertices);

  std::size_t size() const { return triangles_.size(); }
  const MeshTriangle& triangle(int i) const {
    return triangles_[static_cast<std::size_t>(i)];
  }
  /// @brief Each edge once, in the order of its owners.
  const std::vector<Edge>& edges() const { return edges_; }
  /// @brief The edge of triangle i from its vertex k to the next.
  std::uint32_t edgeOf(int i, unsigned k) const {
    return edge_of_[3 * static_cast<std::size_t>(i) + k];
  }

  bool areAdjacent(int i, int j) const {
    return detail::deformable::doShareVertex(ids(i), ids(j));
  }

  /// @brief Of two triangles every pair of features without a common vertex.
  unsigned allPairs(int i, int j) const {
    return withoutShared(i, j, detail::deformable::ownedPairs(present(i), present(j)));
  }
  /// @brief Those of them that they own: over all triangles, each pair of features once.
  unsigned ownedPairs(int i, int j) const {
    return withoutShared(
        i, j, detail::deformable::ownedPairs(triangle(i).owned, triangle(j).owned));
  }

  /// @brief Of two triangles that are not adjacent the pairs of features that they test
  /// for all triangles that have them: as the first ones that are not adjacent, in the
  /// order of the triangles around one feature, then around the other. Decided when they
  /// meet (procedural representative triangles), since it depends on both features.
  unsigned representedPairs(int i, int j) const;

  /// @brief Pairs of features which only adjacent triangles have: each pair once, with
  /// the triangles that own it.
  std::vector<TrianglePairMask> findOrphans() const;

 private:
  /// The triangles around one feature, in ascending order.
  struct Range {
    const int *first, *last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
  };
  Range around(const std::vector<std::uint32_t>& starts, const std::vector<int>& list,
               std::uint32_t feature) const {
    return {list.data() + starts[feature], list.data() + starts[feature + 1]};
  }
  Range aroundVertex(std::uint32_t v) const {
    return around(vertex_starts_, vertex_triangles_, v);
  }
  Range aroundEdge(std::uint32_t e) const {
    return around(edge_starts_, edge_triangles_, e);
  }

  /// Those of the pairs of features that share no vertex.
  unsigned withoutShared(int i, int j, unsigned pairs) const {
    return areAdjacent(i, j) ? pairs & ~detail::deformable::pairsAt(shared(i, j)) : pairs;
  }

  detail::deformable::ThreeIds ids(int i) const {
    static_assert(sizeof(MeshTriangle) == sizeof(detail::deformable::ThreeIds),
                  "one more number is read");
    detail::deformable::ThreeIds ids;
    std::memcpy(&ids, &triangle(i), sizeof(ids));
    return ids;
  }
  unsigned shared(int i, int j) const {
    return detail::deformable::sharedVertices(triangle(i).v, triangle(j).v);
  }
  unsigned present(int i) const { return present_[static_cast<std::size_t>(i)]; }
  bool isRepresentative(int i, int j, int bit) const;

  /// The first two triangles that have the features of a pair of i and j and are not
  /// adjacent.
  /// @return whether there are any
  bool findRepresentative(int i, int j, int bit, int& first, int& second) const;

  /// The vertices of the owners of a triangle's features, hashed to a bit each. Owners
  /// whose sets have no bit in common are not adjacent; with seven vertices on average
  /// one of six other pairs has one.
  struct OwnersVertices {
    std::uint64_t bits[4];

    void add(std::uint32_t v) { bits[v % 4] |= std::uint64_t{1} << v / 4 % 64; }
    bool mayMeet(const OwnersVertices& other) const {
      std::uint64_t common = 0;
      for (int k = 0; k < 4; ++k) common |= bits[k] & other.bits[k];
      return common != 0;
    }
  };

  std::vector<MeshTriangle> triangles_;
  std::vector<OwnersVertices> owners_vertices_;
  /// As MeshTriangle::owned, the features that the triangle has: each once, and no face
  /// that repeats another.
  std::vector<std::uint8_t> present_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> edge_of_;
  std::vector<std::uint32_t> vertex_starts_, edge_starts_;
  std::vector<int> vertex_triangles_, edge_triangles_;
};

}  // namespace test
}  // namespace fcl

#endif

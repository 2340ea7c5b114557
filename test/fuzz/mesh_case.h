// SPDX-License-Identifier: BSD-3-Clause
//
// Small random meshes that go straight, and the names of their contacts.
#ifndef FCL_FUZZ_MESH_CASE_H
#define FCL_FUZZ_MESH_CASE_H

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "moving_mesh.h"

namespace fcl {
namespace test {

/// @brief A mesh with itself, or with another one, and what is asked.
struct MeshCase {
  MovingMesh a;
  std::optional<MovingMesh> b;
  double min_distance{0};
  bool ignores_initially_closer{false};
  double t_max{1};
  double toc_err{1e-6};
  /// Coordinates are multiples of a power of two that halves and shifts keep exact.
  bool is_on_grid{false};

  const MovingMesh& other() const { return b ? *b : a; }
};

/// @brief A case of 4 to 200 triangles a mesh, most of them small: soups, crumpled
/// sheets and closed bodies, with collapsed and repeated triangles, coinciding vertices,
/// and often on a coarse grid, where much touches exactly.
MeshCase randomMeshCase(Random& random);

/// @brief A mesh of such a case.
MovingMesh randomFuzzMesh(Random& random, std::size_t most_triangles);

/// @brief Kind, whether the first feature is of o1, and the ids of both features, sorted;
/// unused ones are -1. Of two edges or vertices of one mesh the lower name is first.
using ContactId = std::array<int, 7>;

struct NamedBracket {
  ContactId id;
  double toc_lo, toc_hi;

  bool operator==(const NamedBracket& o) const {
    return id == o.id && toc_lo == o.toc_lo && toc_hi == o.toc_hi;
  }
  bool operator<(const NamedBracket& o) const {
    return id != o.id           ? id < o.id
           : toc_lo != o.toc_lo ? toc_lo < o.toc_lo
                                : toc_hi < o.toc_hi;
  }
};

/// @param first, second  ids, with -1 after the last one
ContactId contactId(int kind, bool first_on_o1, bool is_self, std::array<int, 2> first,
                    std::array<int, 3> second);

std::string nameOf(const ContactId& id);

/// @brief Removes triangles, then vertices without one, while the case fails.
void minimise(MeshCase& mesh_case, const std::function<bool(const MeshCase&)>& fails);

/// @brief The mesh as C++.
std::string asCode(const MovingMesh& mesh, const std::string& name);

/// @brief The case as the body of a test.
/// @param expected  what the test expects of the `result`
std::string asTest(const MeshCase& mesh_case, const std::string& expected);

}  // namespace test
}  // namespace fcl

#endif

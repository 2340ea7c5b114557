// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/non_finite_vertex.h"

#include <string>

namespace fcl {
namespace detail {
namespace deformable {

NonFiniteVertex::NonFiniteVertex(const char* mesh, std::size_t vertex)
    : std::domain_error(std::string(mesh) + ": vertex " + std::to_string(vertex) +
                        " is not finite. Correct it"),
      mesh_(mesh),
      vertex_(vertex) {}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

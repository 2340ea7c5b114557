// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MESH_NON_FINITE_VERTEX_H
#define FCL_CCD_MESH_NON_FINITE_VERTEX_H

#include <cstddef>
#include <stdexcept>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The error for a vertex whose coordinates are not finite.
class NonFiniteVertex : public std::domain_error {
 public:
  /// @param mesh  the name of the mesh for the user
  NonFiniteVertex(const char* mesh, std::size_t vertex);

  const char* mesh() const { return mesh_; }
  std::size_t vertex() const { return vertex_; }

 private:
  const char* mesh_;
  std::size_t vertex_;
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Tests and bounds of whole frames: arrays of float or double, x y z for each vertex.
#ifndef FCL_CCD_MODEL_COORDINATE_ARRAYS_H
#define FCL_CCD_MODEL_COORDINATE_ARRAYS_H

#include <cstddef>

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The first vertex with a coordinate that is not finite; num_vertices if there is
/// none.
template <typename S>
std::size_t findNotFinite(const S* coordinates, std::size_t num_vertices,
                          int num_threads);

/// @brief The box around the vertices of both frames (without vertices it goes from the
/// largest number to its negative, as in FCL), its center, and the largest distance of a
/// vertex from there.
template <typename S>
struct FrameBounds {
  S lo[3], hi[3], center[3];
  S radius;
};

template <typename S>
FrameBounds<S> boundFrames(const S* previous, const S* current, std::size_t num_vertices,
                           int num_threads);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

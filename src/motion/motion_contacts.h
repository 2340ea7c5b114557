// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_MOTION_MOTION_CONTACTS_H
#define FCL_CCD_MOTION_MOTION_CONTACTS_H

#include "motion/motion_query.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The contacts of two bodies, of each pair of features once: a vertex and a face,
/// or two edges, that come within the tolerance of each other (MotionAnswer::touching);
/// toc_lo is not after the first time at which they touch, and toc_hi a time at which the
/// two triangles provably cross, or toc_lo where none is found within toc_err. Features
/// touch where their triangles do: found are the triangles first. What crosses at t = 0
/// is told by signs of the vertices posed there, as for straight paths.
/// @param options  with stop_at_crossing contacts are triangles' only: the first one,
/// with the pair of features that is nearest then
/// @pre the floating-point mode is the default one
/// @throws NonFiniteVertex, fcl::Exception  a triangle that refers to no vertex
QueryAnswer queryMotionContacts(const MotionBody& a, const MotionBody& b,
                                const QueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

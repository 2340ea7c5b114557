// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CURVED_CURVED_CONTACTS_H
#define FCL_CCD_CURVED_CURVED_CONTACTS_H

#include "curved/curved_query.h"
#include "query/query_answer.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Finds the contacts of two bodies, each pair of features once: a vertex and a
/// face, two edges, or with a distance a free point and a free edge or point, that come
/// within the tolerance of each other (CurvedAnswer::touching). toc_lo is not after the
/// first time at which they touch. toc_hi is a time at which the two triangles provably
/// cross; it is toc_lo if no such time is found within toc_err. Features touch only where
/// their triangles touch, so that triangles are found first. Crossings at t = 0 are
/// decided by signs of the vertices posed there, as for straight paths.
///
/// With a distance in the options features are in contact when they come within it, and a
/// contact is that of the nearest parts, as for straight paths (distance_advance.h).
/// toc_hi is then a time at which the features provably are within it.
/// @param options  with only_time the answer is the first contact of triangles,
/// with the pair of features that is nearest at that time
/// @pre the floating-point mode is the default one
/// @throws NonFiniteVertex; fcl::Exception when a vertex id of a triangle is out of range
QueryAnswer queryCurvedContacts(const MovingBody& a, const MovingBody& b,
                                const QueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CURVED_SHAPE_CONTACTS_H
#define FCL_CCD_CURVED_SHAPE_CONTACTS_H

#include "bodies/moving_body.h"
#include "query/query_answer.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The contacts of two bodies, of which one is a shape or an octree at least: one
/// for each pair of triangles, shapes and cells (QueryAnswer::shape_contacts). As in
/// queryCurved(), no contact is missed, and no time is late. Shapes and cells are solid:
/// what is inside of one at t = 0 touches it then.
/// @param options  with only_time only the time of a contact is given
/// @pre the floating-point mode is the default one
/// @throws NonFiniteVertex; fcl::Exception when a vertex id of a triangle is out of range
QueryAnswer queryShapeContacts(const MovingBody& a, const MovingBody& b,
                               const QueryOptions& options);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_API_CONTACT_CONVERSION_H
#define FCL_CCD_API_CONTACT_CONVERSION_H

#include "curved/shape_contacts.h"
#include "fcl/narrowphase/contact.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "prepare/prepared_motion.h"
#include "query/contact_sink.h"
#include "query/crossing.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A contact between meshes a and b (the same object twice for a self-collision)
/// as the public type, without o1 and o2.
/// @param at_distance  whether features that only come near are in contact
template <typename S>
ContinuousContact<S> toContinuousContact(const FeatureContact& contact,
                                         const MeshInstance& a, const MeshInstance& b,
                                         bool with_geometry, bool at_distance = false);

/// @overload
/// Position and normal are computed from positions and velocities of the vertices at
/// toc_lo.
template <typename S>
ContinuousContact<S> toContinuousContact(const FeatureContact& contact,
                                         const PreparedMotion& a, const PreparedMotion& b,
                                         bool with_geometry, bool at_distance = false);

/// @brief A crossing at t = 0 as the public type, without o1 and o2. Its position is the
/// point where the edge crosses the plane of the face.
template <typename S>
ContinuousContact<S> toContinuousContact(const Crossing& crossing, const MeshInstance& a,
                                         const MeshInstance& b, bool with_geometry);

/// @overload
template <typename S>
ContinuousContact<S> toContinuousContact(const ShapeContact& contact, bool with_geometry);

/// @brief The contact as FCL's type; penetration depth 0.
template <typename S>
Contact<S> toContact(const ContinuousContact<S>& contact);

/// @brief A time in [0, 1] as S, not later than t.
template <typename S>
S roundTimeDown(double t);

/// @brief A time in [0, 1] as S, not earlier than t.
template <typename S>
S roundTimeUp(double t);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// The answer of a query in FCL's types.
#ifndef FCL_CCD_API_CONTACT_CONVERSION_H
#define FCL_CCD_API_CONTACT_CONVERSION_H

#include "fcl/narrowphase/contact.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "prepare/prepared_motion.h"
#include "query/query_answer.h"
#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Describes the contacts of a query. It refers to what was queried.
class ContactDescriber {
 public:
  /// @brief With a shape or an octree: contacts are described already.
  explicit ContactDescriber(const QueryOptions& options);

  /// @brief Of meshes a and b on straight paths; the same one twice for a self-collision.
  ContactDescriber(const MeshInstance& a, const MeshInstance& b,
                   const QueryOptions& options);

  /// @brief Of meshes of which one turns. Positions and normals are computed from
  /// positions and velocities of the vertices at toc_lo.
  ContactDescriber(const PreparedMotion& a, const PreparedMotion& b,
                   const QueryOptions& options);

  DescribedContact operator()(const FeatureContact& contact) const;
  /// @brief Its position is the point where the edge crosses the plane of the face.
  DescribedContact operator()(const Crossing& crossing) const;
  const DescribedContact& operator()(const DescribedContact& contact) const {
    return contact;
  }

 private:
  void addGeometry(const FeatureContact& contact, DescribedContact& out) const;

  /// Of a and b. On other paths than straight ones: at t = 0.
  MeshInstance mesh_[2];
  /// Null: the paths are straight.
  const PreparedMotion* motion_[2]{nullptr, nullptr};
  bool with_geometry_;
  /// Whether features that only come near are in contact.
  bool at_distance_;
};

/// @brief A contact of two objects, or of one twice, as the public type.
template <typename S>
ContinuousContact<S> toContinuousContact(const DescribedContact& contact,
                                         const CollisionGeometry<S>& o1,
                                         const CollisionGeometry<S>& o2);

/// @brief The contact as FCL's type; penetration depth 0.
template <typename S>
Contact<S> toContact(const ContinuousContact<S>& contact);

/// @brief What FCL's own result says.
template <typename S>
QueryOutcome<S> outcomeOf(const QueryAnswer& answer);

/// @brief The fields that a query for contacts adds.
/// @throws std::bad_alloc  the result is unchanged then
template <typename S>
void fillContacts(const QueryAnswer& answer, const ContactDescriber& describe,
                  const CollisionGeometry<S>& o1, const CollisionGeometry<S>& o2,
                  const QueryOptions& options, ContinuousContacts<S>& result);

/// @brief A time in [0, 1] as S, not later than t, or not earlier.
template <typename S>
S roundTimeDown(double t);
template <typename S>
S roundTimeUp(double t);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

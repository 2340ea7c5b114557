// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_CHECKED_REQUEST_H
#define FCL_CCD_PREPARE_CHECKED_REQUEST_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "fcl/narrowphase/continuous_contact.h"
#include "query/pair_filter.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {

/// @brief A request of either type, checked. It refers to what the request owns.
struct CheckedRequest {
  /// @brief The first contact.
  /// @throws fcl::Exception  a field is out of range; the text names it
  template <typename S>
  explicit CheckedRequest(const ContinuousCollisionRequest<S>& request);

  /// @brief Contacts.
  /// @throws fcl::Exception  as above
  template <typename S>
  explicit CheckedRequest(const ContinuousContactRequest<S>& request);

  /// Without the filter, which depends on the triangles: see RequestFilter.
  deformable::QueryOptions options;
  /// Of o1 and o2; null: none.
  const ContinuousFilter* filter[2]{nullptr, nullptr};
  const std::function<bool(std::intptr_t, std::intptr_t)>* accepts_triangles{nullptr};
};

/// @brief The filters of a request as a query uses them.
class RequestFilter {
 public:
  /// @brief For two objects, or for one twice.
  /// @throws fcl::Exception  a filter has another number of entries than its object has
  /// triangles
  template <typename S>
  RequestFilter(const CheckedRequest& request, const CollisionGeometry<S>& o1,
                const CollisionGeometry<S>& o2, bool is_self);

  /// @brief Whether no pair counts, whatever the triangles.
  bool rejectsAll() const { return rejects_all_; }

  /// @brief The filter for two meshes; null where all pairs count.
  const deformable::PairFilter* prepare(const deformable::MeshInstance& a,
                                        const deformable::MeshInstance& b);

  /// @brief The same for objects whose triangles stand for all their features.
  const deformable::PairFilter* prepare();

 private:
  deformable::PairRules rules_;
  bool accepts_all_{true};
  bool rejects_all_{false};
  std::optional<deformable::PairFilter> filter_;
};

}  // namespace detail
}  // namespace fcl

#endif

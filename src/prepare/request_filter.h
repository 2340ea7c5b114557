// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_REQUEST_FILTER_H
#define FCL_CCD_PREPARE_REQUEST_FILTER_H

#include <cstddef>
#include <optional>

#include "fcl/narrowphase/detail/query_numbers.h"
#include "query/pair_filter.h"

namespace fcl {
namespace detail {

/// @brief The filters of a request as a query uses them.
class RequestFilter {
 public:
  /// @brief Accepts all pairs.
  RequestFilter() = default;

  /// @brief For two objects, or for one twice.
  /// @param size1, size2  their numbers of triangles
  /// @throws fcl::Exception  a filter has another number of entries than its object has
  /// triangles
  RequestFilter(const QuerySettings& settings, std::size_t size1, std::size_t size2,
                bool is_self);

  /// @brief Whether no pair counts, whatever the triangles.
  bool rejectsAll() const { return rejects_all_; }

  /// @brief The filter for two meshes; null where all pairs count.
  const deformable::PairFilter* prepare(const deformable::MeshInstance& a,
                                        const deformable::MeshInstance& b);

 private:
  deformable::PairRules rules_;
  bool accepts_all_{true};
  bool rejects_all_{false};
  std::optional<deformable::PairFilter> filter_;
};

}  // namespace detail
}  // namespace fcl

#endif

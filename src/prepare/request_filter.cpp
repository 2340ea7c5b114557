// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/request_filter.h"

#include <string>
#include <vector>

#include "fcl/common/exception.h"

namespace fcl {
namespace detail {
namespace {

using deformable::TriangleMarks;

const std::uint32_t* entriesOf(const std::vector<std::uint32_t>& entries,
                               std::size_t num_triangles, const std::string& name) {
  if (entries.empty()) return nullptr;
  if (entries.size() != num_triangles)
    throw Exception(name + " has " + std::to_string(entries.size()) +
                    " entries, and the object has " + std::to_string(num_triangles) +
                    " triangles; leave it empty or give one entry for each triangle");
  return entries.data();
}

TriangleMarks marksOf(const ContinuousFilter& filter, std::size_t num_triangles,
                      const std::string& name) {
  return {filter.group, filter.mask,
          entriesOf(filter.triangle_groups, num_triangles, name + ".triangle_groups"),
          entriesOf(filter.triangle_masks, num_triangles, name + ".triangle_masks")};
}

}  // namespace

RequestFilter::RequestFilter(const QuerySettings& settings, std::size_t size1,
                             std::size_t size2, bool is_self) {
  if (settings.filter1)
    rules_.marks[0] = marksOf(*settings.filter1, size1, "request.filter1");
  if (is_self)
    rules_.marks[1] = rules_.marks[0];
  else if (settings.filter2)
    rules_.marks[1] = marksOf(*settings.filter2, size2, "request.filter2");
  rules_.accepts = settings.accepts_triangles;
  accepts_all_ = rules_.areAllEqual() && rules_.accept(0, 0);
  rejects_all_ = rules_.areAllEqual() && !accepts_all_;
}

const deformable::PairFilter* RequestFilter::prepare(const deformable::MeshInstance& a,
                                                     const deformable::MeshInstance& b) {
  if (accepts_all_ || rejects_all_) return nullptr;
  return &filter_.emplace(a, b, rules_);
}

}  // namespace detail
}  // namespace fcl

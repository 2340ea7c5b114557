// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/checked_request.h"

#include <string>
#include <vector>

#include "fcl/common/exception.h"
#include "prepare/query_arguments.h"

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

template <typename S>
CheckedRequest::CheckedRequest(const ContinuousCollisionRequest<S>& request) {
  options.query = ContinuousQuery::kFirst;
  options.max_contacts = 1;
  options.only_time = true;
  options.toc_err =
      requireTocErr(static_cast<double>(request.toc_err), "request.toc_err");
}

template <typename S>
CheckedRequest::CheckedRequest(const ContinuousContactRequest<S>& request) {
  options.toc_err =
      requireTocErr(static_cast<double>(request.toc_err), "request.toc_err");
  if (request.num_max_contacts == 0)
    throw Exception(
        "request.num_max_contacts is 0. Give 1 or more, or ask with "
        "ContinuousQuery::kAny");
  options.query = request.query;
  options.max_contacts = request.num_max_contacts;
  options.with_geometry = request.enable_contact;
  if (request.num_threads < 0)
    throw Exception(
        "request.num_threads is negative. Give a number of threads, or 0 for all "
        "threads of the task arena");
  options.num_threads = request.num_threads;
  options.t_max = static_cast<double>(request.t_max);
  requireTimeLimit(options.t_max, "request.t_max");
  if (request.enable_crossings && request.query == ContinuousQuery::kAny)
    throw Exception(
        "request.enable_crossings lists all crossings, which ContinuousQuery::kAny does "
        "not look for: use kFirst or kAll");
  options.all_crossings = request.enable_crossings;
  options.min_distance = static_cast<double>(request.min_distance);
  requireDistance(options.min_distance, "request.min_distance");
  if (request.ignore_initially_closer && !(options.min_distance > 0))
    throw Exception(
        "request.ignore_initially_closer is about pairs that are nearer than "
        "request.min_distance, which is 0. Give a distance");
  options.ignores_initially_closer = request.ignore_initially_closer;
  options.min_approach_speed = static_cast<double>(request.min_approach_speed);
  requireDistance(options.min_approach_speed, "request.min_approach_speed");
  filter[0] = &request.filter1;
  filter[1] = &request.filter2;
  if (request.accepts_triangles) accepts_triangles = &request.accepts_triangles;
}

template <typename S>
RequestFilter::RequestFilter(const CheckedRequest& request,
                             const CollisionGeometry<S>& o1,
                             const CollisionGeometry<S>& o2, bool is_self) {
  if (!request.filter[0]) return;
  using deformable::numTrianglesOf;
  rules_.marks[0] = marksOf(*request.filter[0], numTrianglesOf(o1), "request.filter1");
  rules_.marks[1] =
      is_self ? rules_.marks[0]
              : marksOf(*request.filter[1], numTrianglesOf(o2), "request.filter2");
  rules_.accepts = request.accepts_triangles;
  accepts_all_ = rules_.areAllEqual() && rules_.accept(0, 0);
  rejects_all_ = rules_.areAllEqual() && !accepts_all_;
}

const deformable::PairFilter* RequestFilter::prepare(const deformable::MeshInstance& a,
                                                     const deformable::MeshInstance& b) {
  if (accepts_all_ || rejects_all_) return nullptr;
  return &filter_.emplace(a, b, rules_);
}

const deformable::PairFilter* RequestFilter::prepare() {
  if (accepts_all_ || rejects_all_) return nullptr;
  const deformable::MeshInstance without_owners;
  return prepare(without_owners, without_owners);
}

#define FCL_CCD_INSTANTIATE(S)                                                   \
  template CheckedRequest::CheckedRequest(const ContinuousCollisionRequest<S>&); \
  template CheckedRequest::CheckedRequest(const ContinuousContactRequest<S>&);   \
  template RequestFilter::RequestFilter(const CheckedRequest&,                   \
                                        const CollisionGeometry<S>&,             \
                                        const CollisionGeometry<S>&, bool);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

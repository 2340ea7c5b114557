// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_candidates.h"

#include <cfenv>
#include <cstddef>
#include <string>
#include <vector>

#include "fcl/common/exception.h"
#include "fcl/narrowphase/detail/deformable/default_floating_point.h"
#include "fcl/narrowphase/detail/deformable/deformable_query.h"
#include "fcl/narrowphase/detail/deformable/prepared_mesh.h"
#include "query_arguments.h"

namespace fcl {
namespace {

using detail::Placement;
using detail::deformable::FeatureCandidate;
using detail::deformable::FeatureKind;
using detail::deformable::FeatureOwners;
using detail::deformable::PreparedMesh;

ContinuousCandidate toContinuousCandidate(const FeatureCandidate& candidate) {
  ContinuousCandidate out;
  out.kind = candidate.kind == FeatureKind::kVertexFace
                 ? ContinuousContactKind::kVertexFace
                 : ContinuousContactKind::kEdgeEdge;
  out.first_on_o1 = candidate.first_on_a;
  for (std::size_t i = 0; i < 4; ++i)
    out.vertices[i] = static_cast<int>(candidate.vertices[i]);
  out.b1 = candidate.triangles[0];
  out.b2 = candidate.triangles[1];
  out.window_lo = candidate.window_lo;
  out.window_hi = candidate.window_hi;
  return out;
}

/// Runs query(inner sink), whose blocks reach the caller's sink in public form and in the
/// caller's floating-point mode.
template <typename Query>
bool handOut(const ContinuousCandidateSink& sink, Query&& query) {
  std::fenv_t callers_mode;
  std::fegetenv(&callers_mode);
  std::vector<ContinuousCandidate> block;
  return detail::answerOf([&] {
    return query([&](const FeatureCandidate* candidates, std::size_t count) {
      block.clear();
      for (std::size_t i = 0; i < count; ++i)
        block.push_back(toContinuousCandidate(candidates[i]));
      const detail::deformable::CallersFloatingPoint mode(callers_mode);
      return sink(block.data(), block.size());
    });
  });
}

void require(const ContinuousCandidateSink& sink) {
  if (!sink) throw Exception("sink is null");
}

template <typename S>
PreparedMesh prepared(const CollisionGeometry<S>& o, const Placement<S>& placement,
                      const char* name) {
  const detail::deformable::DefaultFloatingPoint mode;
  return PreparedMesh(o, placement.beginning, placement.end, name, 1,
                      FeatureOwners::kAlways);
}

template <typename S>
bool selfCandidates(const CollisionGeometry<S>* o, const ContinuousCandidateSink& sink) {
  detail::require(o, "o");
  require(sink);
  detail::requireMesh(*o, "continuousSelfCandidates");
  const Transform3<S> still = Transform3<S>::Identity();
  const PreparedMesh mesh = prepared(*o, {still, still}, "o");
  return handOut(sink, [&](const auto& inner) {
    return detail::deformable::candidatesSelf(mesh.instance(), inner);
  });
}

template <typename S>
bool pairCandidates(const CollisionGeometry<S>* o1, const Placement<S>& placement1,
                    const CollisionGeometry<S>* o2, const Placement<S>& placement2,
                    const ContinuousCandidateSink& sink) {
  detail::require(o1, "o1");
  detail::require(o2, "o2");
  require(sink);
  const Placement<S> placed1 = detail::withoutRounding(*o1, placement1),
                     placed2 = detail::withoutRounding(*o2, placement2);
  if (!detail::isAnsweredHere(*o1, placed1.isRotating(), *o2, placed2.isRotating())) {
    detail::requireFinite(*o1, placement1, *o2, placement2);
    throw Exception(std::string("candidates") + detail::kNotAnsweredHere);
  }
  const PreparedMesh mesh1 = prepared(*o1, placed1, "o1"),
                     mesh2 = prepared(*o2, placed2, "o2");
  return handOut(sink, [&](const auto& inner) {
    return detail::deformable::candidatesPair(mesh1.instance(), mesh2.instance(), inner);
  });
}

}  // namespace

#define FCL_CCD_DEFINE_CANDIDATES(S)                                                    \
  bool continuousSelfCandidates(const CollisionGeometry<S>* o,                          \
                                const ContinuousCandidateSink& sink) {                  \
    return selfCandidates(o, sink);                                                     \
  }                                                                                     \
  bool continuousCandidates(const CollisionGeometry<S>* o1,                             \
                            const Transform3<S>& tf1_beg, const Transform3<S>& tf1_end, \
                            const CollisionGeometry<S>* o2,                             \
                            const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end, \
                            const ContinuousCandidateSink& sink) {                      \
    return pairCandidates<S>(o1, {tf1_beg, tf1_end}, o2, {tf2_beg, tf2_end}, sink);     \
  }
FCL_CCD_DEFINE_CANDIDATES(double)
FCL_CCD_DEFINE_CANDIDATES(float)
#undef FCL_CCD_DEFINE_CANDIDATES

}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_candidates.h"

#include <cstddef>
#include <string>
#include <vector>

#include "base/default_floating_point.h"
#include "curved/curved_candidates.h"
#include "fcl/common/exception.h"
#include "prepare/prepared_mesh.h"
#include "prepare/prepared_motion.h"
#include "prepare/query_arguments.h"
#include "prepare/query_range.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace {

using deformable::FeatureCandidate;
using deformable::FeatureOwners;
using deformable::PreparedMesh;
using deformable::PreparedMotion;

ContinuousCandidate toContinuousCandidate(const FeatureCandidate& candidate) {
  ContinuousCandidate out;
  out.kind = candidate.kind;
  out.first_on_o1 = candidate.first_on_a;
  for (std::size_t i = 0; i < 4; ++i)
    out.vertices[i] = static_cast<int>(candidate.vertices[i]);
  out.b1 = candidate.triangles[0];
  out.b2 = candidate.triangles[1];
  out.window_lo = candidate.window_lo;
  out.window_hi = candidate.window_hi;
  return out;
}

/// Runs query(inner sink). The inner sink converts its blocks to the public type and
/// hands them to the caller's sink in the caller's floating-point mode.
template <typename Query>
bool handOut(const ContinuousCandidateSink& sink, Query&& query) {
  const deformable::FloatingPointMode callers_mode = deformable::floatingPointMode();
  std::vector<ContinuousCandidate> block;
  return answerOf([&] {
    return query([&](const FeatureCandidate* candidates, std::size_t count) {
      block.clear();
      for (std::size_t i = 0; i < count; ++i)
        block.push_back(toContinuousCandidate(candidates[i]));
      const deformable::CallersFloatingPoint mode(callers_mode);
      return sink(block.data(), block.size());
    });
  });
}

void require(const ContinuousCandidateSink& sink) {
  if (!sink) throw Exception("sink is null. Give a function that takes the candidates");
}

template <typename S>
PreparedMesh prepared(const PlacedGeometry<S>& placed, const char* name) {
  const deformable::DefaultFloatingPoint mode;
  return PreparedMesh(placed.geometry(), placed.beginning(), placed.end(), name, 1,
                      FeatureOwners::kAlways);
}

template <typename S>
PreparedMotion preparedMotion(const PlacedGeometry<S>& placed, const char* name) {
  // A reference point that rounds by more than this part of the step is refused.
  constexpr double kStrictTocErr = 1e-9;
  const deformable::DefaultFloatingPoint mode;
  return PreparedMotion(placed, name, kStrictTocErr, 1);
}

template <typename S>
void requireSurface(const PlacedGeometry<S>& o, const char* name) {
  if (!o.isMesh())
    throw Exception(std::string("continuousCandidates: ") + name +
                    " is not a triangle mesh but " + kindOf(o.geometry()) +
                    ", and candidates need two triangle meshes. Give a mesh of its "
                    "surface");
}

/// The candidates of two meshes, one of which turns.
template <typename S>
bool motionCandidates(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                      const CandidateSink& sink, double min_distance) {
  const PreparedMotion motion1 = preparedMotion(o1, "o1"),
                       motion2 = preparedMotion(o2, "o2");
  requireLeastSize(motion1, motion2);
  return handOut(sink, [&](const auto& inner) {
    const deformable::DefaultFloatingPoint mode;
    return deformable::curvedCandidates(motion1.body(), motion2.body(), inner,
                                        min_distance);
  });
}

}  // namespace

template <typename S>
bool answerSelfCandidates(const CollisionGeometry<S>* o, const CandidateSink& sink,
                          double min_distance) {
  require(o, "o");
  require(sink);
  requireDistance(min_distance, "min_distance");
  requireMesh(*o, "continuousSelfCandidates");
  const MovingGeometry<S> still = unmoved(o);
  const PreparedMesh mesh = prepared(PlacedGeometry<S>(still), "o");
  return handOut(sink, [&](const auto& inner) {
    return deformable::candidatesSelf(mesh.instance(), inner, min_distance);
  });
}

template <typename S>
bool answerCandidates(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                      const CandidateSink& sink, double min_distance) {
  require(o1.geometry, "o1");
  require(o2.geometry, "o2");
  require(sink);
  requireDistance(min_distance, "min_distance");
  const auto placed = [](const MovingGeometry<S>& o) {
    const deformable::DefaultFloatingPoint mode;
    return PlacedGeometry<S>(o);
  };
  const PlacedGeometry<S> placed1 = placed(o1), placed2 = placed(o2);
  const Answerer answerer = answererOf(placed1, placed2);
  if (answerer == Answerer::kFcl || answerer == Answerer::kShapes) {
    requireSurface(placed1, "o1");
    requireSurface(placed2, "o2");
    throw Exception("continuousCandidates: " + whyFclAnswers(placed1, placed2) +
                    ". Give one of FCL's motions, or derive the class from BoundedMotion "
                    "too");
  }
  if (answerer == Answerer::kCurvedPaths)
    return motionCandidates(placed1, placed2, sink, min_distance);
  const PreparedMesh mesh1 = prepared(placed1, "o1"), mesh2 = prepared(placed2, "o2");
  return handOut(sink, [&](const auto& inner) {
    return deformable::candidatesPair(mesh1.instance(), mesh2.instance(), inner,
                                      min_distance);
  });
}

#define FCL_CCD_INSTANTIATE(S)                                                          \
  template bool answerSelfCandidates(const CollisionGeometry<S>*, const CandidateSink&, \
                                     double);                                           \
  template bool answerCandidates(const MovingGeometry<S>&, const MovingGeometry<S>&,    \
                                 const CandidateSink&, double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

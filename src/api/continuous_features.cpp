// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_features.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <string>

#include "api/contact_conversion.h"
#include "base/default_floating_point.h"
#include "elementary/distance_advance.h"
#include "elementary/elementary.h"
#include "fcl/common/exception.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace {

using detail::deformable::advanceToDistance;
using detail::deformable::Answer;
using detail::deformable::DistanceContact;
using detail::deformable::DistanceRequest;
using detail::deformable::ElementaryResult;
using detail::deformable::VertexPath;

/// The points of a pair in one frame; as many as its kind has.
template <typename S>
using Points = std::array<const Vector3<S>*, 4>;

template <typename S>
void read(const Points<S>& from, const std::array<const char*, 4>& names,
          const char* frame, double (VertexPath::*to)[3], VertexPath (&x)[4]) {
  for (std::size_t i = 0; i < 4 && from[i]; ++i)
    for (int k = 0; k < 3; ++k) {
      const S value = (*from[i])[k];
      if (!std::isfinite(value))
        throw Exception(std::string(names[i]) + frame + " is not finite");
      (x[i].*to)[k] = static_cast<double>(value);
    }
}

/// The exact test, which knows vertices and edges as faces without area.
ElementaryResult touchingTest(ContinuousContactKind kind, VertexPath (&x)[4],
                              double toc_err) {
  if (kind == ContinuousContactKind::kVertexVertex) x[2] = x[1];
  if (kind == ContinuousContactKind::kVertexVertex ||
      kind == ContinuousContactKind::kVertexEdge) {
    x[3] = x[2];
    kind = ContinuousContactKind::kVertexFace;
  }
  return detail::deformable::elementaryTest(kind, x, 0, 1, toc_err);
}

template <typename S>
ContinuousFeatureTestResult<S> test(ContinuousContactKind kind,
                                    const std::array<const char*, 4>& names,
                                    const Points<S>& t0, const Points<S>& t1,
                                    double toc_err, double min_distance) {
  using detail::deformable::roundTimeDown;
  using detail::deformable::roundTimeUp;
  // Set before floats are converted: other modes may flush subnormal floats to zero.
  const detail::deformable::DefaultFloatingPoint mode;
  toc_err = detail::requireTocErr(toc_err, "toc_err");
  detail::requireDistance(min_distance, "min_distance");
  VertexPath x[4];
  read<S>(t0, names, "_t0", &VertexPath::t0, x);
  read<S>(t1, names, "_t1", &VertexPath::t1, x);
  if (min_distance > 0) {
    DistanceRequest request;
    request.distance = min_distance;
    request.toc_err = toc_err;
    const DistanceContact found =
        advanceToDistance(kind, {{&x[0], &x[1], &x[2], &x[3]}}, request);
    if (!found.is_contact) return {};
    assert(found.toc_lo <= found.toc_hi);
    return {true, roundTimeDown<S>(found.toc_lo), roundTimeUp<S>(found.toc_hi)};
  }
  const ElementaryResult result = touchingTest(kind, x, toc_err);
  if (result.answer == Answer::kNo) return {};
  assert(result.answer == Answer::kYes && result.toc_lo <= result.toc_hi);
  return {true, roundTimeDown<S>(result.toc_lo), roundTimeUp<S>(result.toc_hi)};
}

}  // namespace

template <typename S>
ContinuousFeatureTestResult<S> vertexFaceWithin(
    const Vector3<S>& v_t0, const Vector3<S>& f0_t0, const Vector3<S>& f1_t0,
    const Vector3<S>& f2_t0, const Vector3<S>& v_t1, const Vector3<S>& f0_t1,
    const Vector3<S>& f1_t1, const Vector3<S>& f2_t1, double toc_err,
    double min_distance) {
  return test<S>(ContinuousContactKind::kVertexFace, {"v", "f0", "f1", "f2"},
                 {&v_t0, &f0_t0, &f1_t0, &f2_t0}, {&v_t1, &f0_t1, &f1_t1, &f2_t1},
                 toc_err, min_distance);
}

template <typename S>
ContinuousFeatureTestResult<S> vertexFace(const Vector3<S>& v_t0, const Vector3<S>& f0_t0,
                                          const Vector3<S>& f1_t0,
                                          const Vector3<S>& f2_t0, const Vector3<S>& v_t1,
                                          const Vector3<S>& f0_t1,
                                          const Vector3<S>& f1_t1,
                                          const Vector3<S>& f2_t1, double toc_err) {
  return vertexFaceWithin(v_t0, f0_t0, f1_t0, f2_t0, v_t1, f0_t1, f1_t1, f2_t1, toc_err,
                          0);
}

template <typename S>
ContinuousFeatureTestResult<S> edgeEdgeWithin(
    const Vector3<S>& ea0_t0, const Vector3<S>& ea1_t0, const Vector3<S>& eb0_t0,
    const Vector3<S>& eb1_t0, const Vector3<S>& ea0_t1, const Vector3<S>& ea1_t1,
    const Vector3<S>& eb0_t1, const Vector3<S>& eb1_t1, double toc_err,
    double min_distance) {
  return test<S>(ContinuousContactKind::kEdgeEdge, {"ea0", "ea1", "eb0", "eb1"},
                 {&ea0_t0, &ea1_t0, &eb0_t0, &eb1_t0},
                 {&ea0_t1, &ea1_t1, &eb0_t1, &eb1_t1}, toc_err, min_distance);
}

template <typename S>
ContinuousFeatureTestResult<S> edgeEdge(
    const Vector3<S>& ea0_t0, const Vector3<S>& ea1_t0, const Vector3<S>& eb0_t0,
    const Vector3<S>& eb1_t0, const Vector3<S>& ea0_t1, const Vector3<S>& ea1_t1,
    const Vector3<S>& eb0_t1, const Vector3<S>& eb1_t1, double toc_err) {
  return edgeEdgeWithin(ea0_t0, ea1_t0, eb0_t0, eb1_t0, ea0_t1, ea1_t1, eb0_t1, eb1_t1,
                        toc_err, 0);
}

template <typename S>
ContinuousFeatureTestResult<S> vertexEdgeWithin(
    const Vector3<S>& v_t0, const Vector3<S>& e0_t0, const Vector3<S>& e1_t0,
    const Vector3<S>& v_t1, const Vector3<S>& e0_t1, const Vector3<S>& e1_t1,
    double toc_err, double min_distance) {
  return test<S>(ContinuousContactKind::kVertexEdge, {"v", "e0", "e1", ""},
                 {&v_t0, &e0_t0, &e1_t0, nullptr}, {&v_t1, &e0_t1, &e1_t1, nullptr},
                 toc_err, min_distance);
}

template <typename S>
ContinuousFeatureTestResult<S> vertexVertexWithin(const Vector3<S>& v_t0,
                                                  const Vector3<S>& w_t0,
                                                  const Vector3<S>& v_t1,
                                                  const Vector3<S>& w_t1, double toc_err,
                                                  double min_distance) {
  return test<S>(ContinuousContactKind::kVertexVertex, {"v", "w", "", ""},
                 {&v_t0, &w_t0, nullptr, nullptr}, {&v_t1, &w_t1, nullptr, nullptr},
                 toc_err, min_distance);
}

#define FCL_CCD_EIGHT(S)                                                      \
  const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&
#define FCL_CCD_INSTANTIATE(S)                                                       \
  template ContinuousFeatureTestResult<S> vertexFace(FCL_CCD_EIGHT(S), double);      \
  template ContinuousFeatureTestResult<S> edgeEdge(FCL_CCD_EIGHT(S), double);        \
  template ContinuousFeatureTestResult<S> vertexFaceWithin(FCL_CCD_EIGHT(S), double, \
                                                           double);                  \
  template ContinuousFeatureTestResult<S> edgeEdgeWithin(FCL_CCD_EIGHT(S), double,   \
                                                         double);                    \
  template ContinuousFeatureTestResult<S> vertexEdgeWithin(                          \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&,    \
      const Vector3<S>&, const Vector3<S>&, double, double);                         \
  template ContinuousFeatureTestResult<S> vertexVertexWithin(                        \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&,    \
      double, double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE
#undef FCL_CCD_EIGHT

}  // namespace fcl

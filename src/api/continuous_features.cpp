// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_features.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "api/contact_conversion.h"
#include "api/query_arguments.h"
#include "base/default_floating_point.h"
#include "elementary/elementary.h"
#include "fcl/common/exception.h"

namespace fcl {
namespace {

using detail::deformable::Answer;
using detail::deformable::ElementaryResult;
using detail::deformable::VertexPath;

template <typename S>
using Points = std::array<const Vector3<S>*, 4>;

template <typename S>
void read(const Points<S>& from, const std::array<const char*, 4>& names,
          const char* frame, double (VertexPath::*to)[3], VertexPath (&x)[4]) {
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      const S value = (*from[i])[k];
      if (!std::isfinite(value))
        throw Exception(std::string(names[i]) + frame + " is not finite");
      (x[i].*to)[k] = static_cast<double>(value);
    }
}

template <typename S>
ContinuousFeatureTestResult<S> test(ContinuousContactKind kind,
                                    const std::array<const char*, 4>& names,
                                    const Points<S>& t0, const Points<S>& t1,
                                    double toc_err) {
  // Set before floats are converted: other modes may flush subnormal floats to zero.
  const detail::deformable::DefaultFloatingPoint mode;
  toc_err = detail::requireTocErr(toc_err, "toc_err");
  VertexPath x[4];
  read<S>(t0, names, "_t0", &VertexPath::t0, x);
  read<S>(t1, names, "_t1", &VertexPath::t1, x);
  const ElementaryResult result =
      detail::deformable::elementaryTest(kind, x, 0, 1, toc_err);
  if (result.answer == Answer::kNo) return {};
  return {true, detail::deformable::roundTimeDown<S>(result.toc_lo),
          detail::deformable::roundTimeUp<S>(result.toc_hi)};
}

}  // namespace

template <typename S>
ContinuousFeatureTestResult<S> vertexFace(const Vector3<S>& v_t0, const Vector3<S>& f0_t0,
                                          const Vector3<S>& f1_t0,
                                          const Vector3<S>& f2_t0, const Vector3<S>& v_t1,
                                          const Vector3<S>& f0_t1,
                                          const Vector3<S>& f1_t1,
                                          const Vector3<S>& f2_t1, double toc_err) {
  return test<S>(ContinuousContactKind::kVertexFace, {"v", "f0", "f1", "f2"},
                 {&v_t0, &f0_t0, &f1_t0, &f2_t0}, {&v_t1, &f0_t1, &f1_t1, &f2_t1},
                 toc_err);
}

template <typename S>
ContinuousFeatureTestResult<S> edgeEdge(
    const Vector3<S>& ea0_t0, const Vector3<S>& ea1_t0, const Vector3<S>& eb0_t0,
    const Vector3<S>& eb1_t0, const Vector3<S>& ea0_t1, const Vector3<S>& ea1_t1,
    const Vector3<S>& eb0_t1, const Vector3<S>& eb1_t1, double toc_err) {
  return test<S>(ContinuousContactKind::kEdgeEdge, {"ea0", "ea1", "eb0", "eb1"},
                 {&ea0_t0, &ea1_t0, &eb0_t0, &eb1_t0},
                 {&ea0_t1, &ea1_t1, &eb0_t1, &eb1_t1}, toc_err);
}

#define FCL_CCD_INSTANTIATE(S)                                                    \
  template ContinuousFeatureTestResult<S> vertexFace(                             \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, \
      double);                                                                    \
  template ContinuousFeatureTestResult<S> edgeEdge(                               \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, \
      const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, const Vector3<S>&, \
      double);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace fcl

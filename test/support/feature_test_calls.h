// SPDX-License-Identifier: BSD-3-Clause
//
// vertexFace() and edgeEdge() on the pairs that tests generate.
#ifndef FCL_TEST_SUPPORT_FEATURE_TEST_CALLS_H
#define FCL_TEST_SUPPORT_FEATURE_TEST_CALLS_H

#include "fcl/narrowphase/continuous_features.h"
#include "feature_pair_generators.h"

namespace fcl {
namespace test {

/// @brief The public test of a pair's kind, on coordinates converted to S.
template <typename S>
ContinuousFeatureTestResult<S> featureTest(const MovingPair& pair, double toc_err) {
  Vector3<S> t0[4], t1[4];
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      t0[i][k] = static_cast<S>(pair.x[i].t0[k]);
      t1[i][k] = static_cast<S>(pair.x[i].t1[k]);
    }
  const auto test =
      pair.kind == fcl::ContinuousContactKind::kVertexFace ? vertexFace<S> : edgeEdge<S>;
  return test(t0[0], t0[1], t0[2], t0[3], t1[0], t1[1], t1[2], t1[3], toc_err);
}

/// @brief The pair with coordinates that float holds exactly.
inline MovingPair floatPair(const MovingPair& pair) {
  // volatile: see floatMesh().
  return mapped(pair, [](double c) {
    const volatile float rounded = static_cast<float>(c);
    return static_cast<double>(rounded);
  });
}

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_BRUTE_FORCE_H
#define FCL_TEST_SUPPORT_BRUTE_FORCE_H

#include <vector>

#include "elementary/elementary.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief The library's exact decision of one pair.
bool doTouch(fcl::ContinuousContactKind kind, const detail::deformable::FeaturePoints& x);

/// @brief All VF and EE pairs of a mesh, without a common vertex, that touch during the
/// step. Each pair is tested separately; the result is sorted. A vertex without a
/// triangle is not a feature.
std::vector<PairName> bruteForceSelfContacts(const FramePairMesh& mesh);

}  // namespace test
}  // namespace fcl

#endif

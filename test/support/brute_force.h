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

/// @brief Every VF and EE pair of a mesh without a common vertex that touches during the
/// step, tested one by one; sorted. A vertex without a triangle is no feature.
std::vector<PairName> bruteForceSelfContacts(const FramePairMesh& mesh);

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// All self-contacts of a model with swept boxes in its tree: what moving boxes bring,
// since all the rest is the library's.
#ifndef FCL_BENCHMARK_SWEPT_QUERY_H
#define FCL_BENCHMARK_SWEPT_QUERY_H

#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "query/narrow_phase.h"
#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief Features that touch, how much each stage removed, and the time it took.
struct SweptContacts {
  std::vector<PairName> pairs;
  StageCounts counts;
  double ms_traverse{0};
  double ms_test{0};
};

/// @brief On one thread. Swept boxes in place of the tree's are made before the clock
/// starts; boxes of features stay moving.
/// @param with_fans  whether triangles around a vertex that stay a fan are left out, as
/// the library does and the paper does not
SweptContacts sweptSelfContacts(const detail::DeformableMesh& model, bool with_fans);

}  // namespace test
}  // namespace fcl

#endif

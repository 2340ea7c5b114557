// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_SCENE_DATA_H
#define FCL_TEST_SUPPORT_SCENE_DATA_H

#include <array>
#include <set>
#include <string>
#include <vector>

#include "fcl/common/types.h"
#include "fcl/math/triangle.h"
#include "fcl/narrowphase/continuous_contact.h"

namespace fcl {
namespace test {

/// @brief A VF or EE pair in a form that does not depend on the order of ids: 0 for VF or
/// 1 for EE, then the vertex and the sorted face, or two sorted edges in ascending order.
using PairName = std::array<int, 5>;

PairName pairName(ContinuousContactKind kind, std::array<int, 4> vertices);

template <typename S>
PairName pairName(const ContinuousContact<S>& contact) {
  return pairName(contact.kind, {contact.vertices[0], contact.vertices[1],
                                 contact.vertices[2], contact.vertices[3]});
}

/// @brief The pairs of a gzipped file of lines `vf,v,f0,f1,f2` and `ee,ea0,ea1,eb0,eb1`.
/// @throws std::runtime_error if it cannot be read
std::set<PairName> readTruePairs(const std::string& path);

/// @brief Two frames of a mesh.
struct FramePairMesh {
  std::vector<Vector3<double>> previous;
  std::vector<Vector3<double>> current;
  std::vector<Triangle> triangles;
};

/// @brief Reads two mesh files of the same topology.
/// @throws std::runtime_error if one cannot be read or the topology differs
FramePairMesh readFramePair(const std::string& previous, const std::string& current);

}  // namespace test
}  // namespace fcl

#endif

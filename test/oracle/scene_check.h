// SPDX-License-Identifier: BSD-3-Clause
//
// What the stages of a self-collision throw away: none of it may be a contact, at any
// time of the step.
#ifndef FCL_TEST_ORACLE_SCENE_CHECK_H
#define FCL_TEST_ORACLE_SCENE_CHECK_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "scene_data.h"

namespace fcl {
namespace test {

struct CullCheckOptions {
  /// Feature pairs of each stage that the oracle is asked about, drawn at random.
  std::size_t oracle_samples{1000};
  /// All culled feature pairs through decideExactly(); otherwise only those.
  bool decide_all{false};
  std::uint64_t seed{1};
};

struct CulledByStage {
  const char* name;
  /// Feature pairs.
  std::size_t culled{0};
  std::size_t decided{0};
  std::size_t asked{0};
  /// Wrongly culled.
  std::size_t contacts{0};
};

struct CullReport {
  /// Far apart: of triangle pairs drawn at random, under node pairs whose boxes never
  /// meet. Near: triangle pairs whose boxes around the whole step meet, while their
  /// moving boxes, or those of nodes above, never do. Then the feature pairs of visited
  /// triangle pairs, by the stage that culls them.
  std::array<CulledByStage, 7> stages{{{"nodes, far"},
                                       {"nodes, near"},
                                       {"fans"},
                                       {"moving boxes"},
                                       {"filter"},
                                       {"solver"},
                                       {"integers"}}};
  /// A contact that was culled, if there is any.
  std::string example;

  std::size_t contacts() const;
};

CullReport checkCulledPairs(const FramePairMesh& mesh, const CullCheckOptions& options);

}  // namespace test
}  // namespace fcl

#endif

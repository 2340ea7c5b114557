// SPDX-License-Identifier: BSD-3-Clause
//
// Scenes of any size for measurements of speed. Each is a function of a size and a seed.
// Coordinates are multiples of 2^-30, so that a scene moved by 1e6 is the same scene.
#ifndef FCL_TEST_SUPPORT_GENERATED_SCENES_H
#define FCL_TEST_SUPPORT_GENERATED_SCENES_H

#include <cstdint>
#include <utility>
#include <vector>

#include "scene_data.h"

namespace fcl {
namespace test {

/// @brief A waving cloth of about `triangles` triangles and 1.4 m x 1 m. One end is
/// folded back over it, and the lip sinks onto the layer below. At t = 0 nothing touches.
/// In the last third of the step less than 1% of the triangles do.
FramePairMesh makeSmoothCloth(int triangles, std::uint64_t seed = 1);

/// @brief At least `triangles` triangles in tiles of kTileTriangles. Each tile is a pair
/// of waving sheets that come to touch in one place, with a random rotation and waves.
/// The number of contacts per triangle does not depend on the size. Nothing touches at t
/// = 0, and tiles do not touch each other.
FramePairMesh makeTiles(int triangles, std::uint64_t seed = 1);
constexpr int kTileTriangles = 1024;

/// @brief Two bumpy spheres of 20 * 4^subdivisions triangles that change their shape and
/// meet in the second half of the step.
std::pair<FramePairMesh, FramePairMesh> makeMeetingBodies(int subdivisions);

/// @brief Two rough layers of at least `triangles` triangles each, 1e-6 apart. The upper
/// one falls through the lower one, and each vertex has its own speed. All pairs meet in
/// the first 2e-6 of the step.
std::pair<FramePairMesh, FramePairMesh> makeLayers(int triangles, std::uint64_t seed = 1);

/// @brief Two spheres of 20 * 4^subdivisions triangles side by side. Each vertex moves to
/// a place of its own, within 1e4 times their size.
std::pair<FramePairMesh, FramePairMesh> makeThrownSpheres(int subdivisions,
                                                          std::uint64_t seed = 1);

/// @brief The scene at another place.
void move(FramePairMesh& mesh, const Vector3<double>& by);

/// @brief Frames of one mesh.
struct FrameSequence {
  std::vector<Triangle> triangles;
  std::vector<std::vector<Vector3<double>>> frames;

  /// @brief Frames i and i + 1.
  FramePairMesh pair(std::size_t i) const {
    return {frames[i], frames[i + 1], triangles};
  }
};

/// @brief A flat sheet of 20,480 triangles that is pushed together into eight pleats,
/// tighter and tighter, and twisted. Towards the end neighbouring pleats touch in some
/// places. No simulation keeps them apart, so they pass a little into each other.
FrameSequence makeCrumplingSheet(int frames);

/// @brief The smooth cloth, of about 20,000 triangles: a wave runs through it, and the
/// lip rises and sinks.
FrameSequence makeWavingCloth(int frames, std::uint64_t seed = 1);

/// @brief 340 balls on orbits of different speed, which mix them. A tree that was made
/// for the first frame keeps together balls that have moved apart, unless they are large
/// enough for trees of their own.
/// @param slices  of each ball; a slice has ten triangles
FrameSequence makeMixingBalls(int frames, int slices = 6);

}  // namespace test
}  // namespace fcl

#endif
